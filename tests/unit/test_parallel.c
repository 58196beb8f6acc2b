/* SPDX-License-Identifier: MIT
 *
 * context.parallel: pipelines compiled through the caller's callback, in any order and in any
 * threads, are those that are compiled one after the other. */
#include "pipelines.h"
#include "settings.h"

#include <pthread.h>
#include <string.h>

enum { MOST = 64, THREADS = 4 };

enum way { ALONE, FORWARD, BACKWARD, THREADED, WAYS };

/* What the callback was asked for. */
struct caller {
    enum way way;
    unsigned calls;
    uint32_t count;
    unsigned ran[MOST]; /* jobs, by index */
};

struct worker {
    struct caller *caller;
    void (*job)(void *data, uint32_t i);
    void *data;
    uint32_t first;
    pthread_t thread;
};

static void *work(void *user_data)
{
    const struct worker *w = user_data;
    for (uint32_t i = w->first; i < w->caller->count; i += THREADS) {
        w->job(w->data, i);
        ++w->caller->ran[i];
    }
    return NULL;
}

static void in_threads(struct caller *caller, void (*job)(void *data, uint32_t i), void *data)
{
    struct worker workers[THREADS];
    for (uint32_t t = 0; t < THREADS; ++t) {
        workers[t] = (struct worker){.caller = caller, .job = job, .data = data, .first = t};
        assert_int_equal(pthread_create(&workers[t].thread, NULL, work, &workers[t]), 0);
    }
    for (uint32_t t = 0; t < THREADS; ++t)
        assert_int_equal(pthread_join(workers[t].thread, NULL), 0);
}

static void parallel(void *user_data, uint32_t count, void (*job)(void *data, uint32_t i),
                     void *data)
{
    struct caller *caller = user_data;
    ++caller->calls;
    caller->count = count;
    assert_true(count <= MOST);
    if (caller->way == THREADED) {
        in_threads(caller, job, data);
        return;
    }
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t k = caller->way == BACKWARD ? count - 1 - i : i;
        job(data, k);
        ++caller->ran[k];
    }
}

/* With one variant, to be compiled in the caller's way. */
static void init(struct world *w, struct settings *s, struct caller *caller, enum way way, bool cpu)
{
    settings_init(w, s, cpu);
    *caller = (struct caller){.way = way};
    s->variant.half_resolution = VK_TRUE;
    w->fake.debug_utils = true;
    w->info.debug_labels = VK_TRUE;
    w->info.variants = &s->variant;
    w->info.variant_count = 1;
    if (way != ALONE) {
        w->info.parallel = parallel;
        w->info.parallel_user_data = caller;
    }
}

static void every_job_runs_once(void **state)
{
    (void)state;
    for (int i = 0; i < WAYS * 2; ++i) {
        const bool cpu = i & 1;
        const enum way way = (enum way)(i / 2);
        struct world w;
        struct settings s;
        struct caller caller;
        init(&w, &s, &caller, way, cpu);
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        const uint32_t pipelines = cpu ? 23 + 6 : 18 + 5;
        assert_int_equal(fake_count(&w.fake, "vkCreateComputePipelines"), pipelines);
        assert_int_equal(caller.calls, way == ALONE ? 0 : 1);
        assert_int_equal(caller.count, way == ALONE ? 0 : pipelines);
        for (uint32_t k = 0; k < caller.count; ++k)
            assert_int_equal(caller.ran[k], 1);
        assert_int_equal(w.log.lines, 0);
        /* Only creation calls it. */
        assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(caller.calls, way == ALONE ? 0 : 1);
        world_close(&w);
    }
}

static void check_same(const struct world *a, const struct world *b)
{
    const struct pipelines *p = &a->ctx->pipelines, *q = &b->ctx->pipelines;
    assert_int_equal(p->count, q->count);
    for (uint32_t i = 0; i < p->count; ++i) {
        const struct fake_object *x = fake_find(&a->fake, entry_handle(&p->entries[i]));
        const struct fake_object *y = fake_find(&b->fake, entry_handle(&q->entries[i]));
        assert_non_null(x);
        assert_non_null(y);
        assert_int_equal(p->entries[i].which, q->entries[i].which);
        assert_int_equal(p->entries[i].bent, q->entries[i].bent);
        assert_memory_equal(&p->entries[i].key, &q->entries[i].key, sizeof p->entries[i].key);
        assert_non_null(x->code);
        assert_ptr_equal(x->code, y->code);
        assert_memory_equal(x->constants, y->constants, sizeof x->constants);
        /* And they are what the entry says. */
        assert_memory_equal(&x->constants[VKAO_CONSTANT_FLAGS], &p->entries[i].key,
                            sizeof p->entries[i].key);
        assert_int_equal(x->constants[VKAO_CONSTANT_BENT_NORMALS], p->entries[i].bent);
        for (uint32_t k = 0; k < i; ++k)
            assert_true(p->entries[k].pipeline != p->entries[i].pipeline);
    }
}

static void every_way_makes_the_same_pipelines(void **state)
{
    (void)state;
    for (int cpu = 0; cpu < 2; ++cpu) {
        struct world alone;
        struct settings s, s2;
        struct caller caller;
        init(&alone, &s, &caller, ALONE, cpu);
        assert_int_equal(vkao_context_create(&alone.info, &alone.ctx), VKAO_SUCCESS);
        for (enum way way = FORWARD; way < WAYS; ++way) {
            struct world w;
            init(&w, &s2, &caller, way, cpu);
            assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
            check_same(&alone, &w);
            assert_int_equal(vkao_context_has_variant(w.ctx, &s.variant), VK_TRUE);
            vkao_context_destroy(w.ctx);
            w.ctx = NULL;
            world_check_empty(&w);
            fake_release(&w.fake);
            host_calloc = (struct host_memory){0};
        }
        world_close(&alone);
    }
}

/* host: an allocation fails, else a call. */
static unsigned fail_everywhere(enum way way, bool cpu, bool host)
{
    unsigned n = 0;
    for (bool done = false; !done;) {
        struct world w;
        struct settings s;
        struct caller caller;
        init(&w, &s, &caller, way, cpu);
        w.info.debug_labels = VK_FALSE; /* failing to name is no error */
        w.fake.fail_at = host ? 0 : ++n;
        w.host.fail_at = host ? ++n : 0;
        w.ctx = (vkao_context *)&w;
        const vkao_result result = vkao_context_create(&w.info, &w.ctx);
        done = host ? w.host.total < n : !w.fake.failed;
        if (done) {
            assert_int_equal(result, VKAO_SUCCESS);
        } else {
            assert_null(w.ctx);
            assert_int_equal(result, host ? VKAO_ERROR_OUT_OF_HOST_MEMORY : VKAO_ERROR_VULKAN);
            assert_int_equal(w.log.errors, 1);
            if (!host)
                assert_non_null(strstr(w.log.last_error, w.fake.failed));
        }
        /* The others are compiled nevertheless, each once. */
        for (uint32_t k = 0; k < caller.count; ++k)
            assert_int_equal(caller.ran[k], 1);
        world_close(&w);
    }
    return n;
}

static void a_failing_compile_is_reported_and_leaks_nothing(void **state)
{
    (void)state;
    for (int i = 0; i < (WAYS - 1) * 4; ++i) {
        const bool cpu = i & 1, host = i & 2;
        const unsigned n = fail_everywhere((enum way)(FORWARD + i / 4), cpu, host);
        /* Two layouts, a module for each pipeline; on the host two blocks too. */
        assert_int_equal(n, 1u + 2u + 2u * (cpu ? 29 : 23) + (host ? 2u : 0u));
    }
}

/* The first in the list is returned, whichever fails first; the log has them all. */
static void all_failing_compiles_are_logged(void **state)
{
    (void)state;
    for (enum way way = ALONE; way <= BACKWARD; ++way) {
        struct world w;
        struct settings s;
        struct caller caller;
        init(&w, &s, &caller, way, true);
        w.fake.fail_at = 2 + 2 * 3; /* the fourth pipeline's module, and all that follows */
        w.fake.fail_from = true;
        const vkao_result result = vkao_context_create(&w.info, &w.ctx);
        assert_null(w.ctx);
        assert_int_equal(result, VKAO_ERROR_VULKAN);
        assert_true(way == ALONE ? w.log.errors == 1 : w.log.errors > 20);
        world_close(&w);
    }
}

/* No jobs at all: SSAO alone, of variants alone, of which there are none. */
static void there_may_be_no_jobs(void **state)
{
    (void)state;
    for (enum way way = ALONE; way < WAYS; ++way) {
        struct world w;
        struct settings s;
        struct caller caller;
        init(&w, &s, &caller, way, true);
        w.info.variant_count = 0;
        w.info.variants_only = VK_TRUE;
        w.info.stage_mask = VKAO_STAGE_SSAO;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), 0);
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_job_runs_once),
        cmocka_unit_test(every_way_makes_the_same_pipelines),
        cmocka_unit_test(a_failing_compile_is_reported_and_leaks_nothing),
        cmocka_unit_test(all_failing_compiles_are_logged),
        cmocka_unit_test(there_may_be_no_jobs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
