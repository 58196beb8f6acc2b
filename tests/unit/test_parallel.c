/* SPDX-License-Identifier: MIT
 *
 * effect.parallel: passes compiled through the caller's callback, in any order and in any threads,
 * are those that are compiled one after the other. */
#include "world.h"

#include <pthread.h>

enum { MOST = 16, THREADS = 4 };

enum way { FORWARD, BACKWARD, THREADED, WAYS };

/* What the callback was asked for. */
struct caller {
    enum way way;
    unsigned calls;
    uint32_t count;
    unsigned ran[MOST]; /* jobs, by index */
};

struct share {
    struct caller *caller;
    uint32_t first;
    void (*job)(void *data, uint32_t i);
    void *data;
};

static void *run_share(void *argument)
{
    const struct share *s = argument;
    for (uint32_t i = s->first; i < s->caller->count; i += THREADS) {
        s->caller->ran[i]++;
        s->job(s->data, i);
    }
    return NULL;
}

static void run_threads(struct caller *caller, void (*job)(void *data, uint32_t i), void *data)
{
    pthread_t threads[THREADS];
    struct share shares[THREADS];
    for (uint32_t t = 0; t < THREADS; ++t) {
        shares[t] = (struct share){caller, t, job, data};
        assert_int_equal(pthread_create(&threads[t], NULL, run_share, &shares[t]), 0);
    }
    for (uint32_t t = 0; t < THREADS; ++t)
        pthread_join(threads[t], NULL);
}

static void parallel(void *user_data, uint32_t count, void (*job)(void *data, uint32_t i),
                     void *data)
{
    struct caller *caller = user_data;
    caller->calls++;
    caller->count = count;
    assert_true(count <= MOST);
    if (caller->way == THREADED) {
        run_threads(caller, job, data);
        return;
    }
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t k = caller->way == FORWARD ? i : count - 1 - i;
        caller->ran[k]++;
        job(data, k);
    }
}

static void every_job_runs_once_in_any_order(void **state)
{
    (void)state;
    for (int way = 0; way < WAYS; ++way) {
        struct world w;
        struct caller caller = {.way = (enum way)way};
        world_open(&w);
        w.effect_info.parallel = parallel;
        w.effect_info.parallel_user_data = &caller;
        world_create_frame(&w);
        assert_int_equal(caller.calls, 1);
        assert_int_equal(caller.count, 4);
        for (uint32_t i = 0; i < caller.count; ++i)
            assert_int_equal(caller.ran[i], 1);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), 5);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        world_close(&w);
    }
}

static void failing_nth_call_leaks_nothing(void **state)
{
    (void)state;
    for (int way = 0; way < WAYS; ++way) {
        for (unsigned n = 1;; ++n) {
            struct world w;
            struct caller caller = {.way = (enum way)way};
            world_open(&w);
            w.effect_info.parallel = parallel;
            w.effect_info.parallel_user_data = &caller;
            w.fake.fail_at = w.fake.result_calls + n;
            vkao_result result = vkao_effect_create(w.ctx, &w.effect_info, &w.effect);
            const bool failed = w.fake.failed;
            assert_int_equal(result == VKAO_SUCCESS, !failed);
            assert_true((w.effect != NULL) == !failed);
            world_close(&w);
            if (!failed)
                break;
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_job_runs_once_in_any_order),
        cmocka_unit_test(failing_nth_call_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
