/* SPDX-License-Identifier: MIT */
#include "report.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

struct heard {
    char all[256];
};

static void hear(void *data, const char *warning)
{
    struct heard *h = data;
    strncat(h->all, warning, sizeof h->all - strlen(h->all) - 1);
    strncat(h->all, ";", sizeof h->all - strlen(h->all) - 1);
}

static void what_waits_is_said_in_its_turn(void **state)
{
    (void)state;
    struct heard heard = {""};
    struct report_queue first = {0}, second = {0};
    struct report report = {.verbosity = REPORT_QUIET, .heard = hear, .heard_data = &heard};
    struct report to_first = {.queue = &first}, to_second = {.queue = &second};
    report_warn(&to_second, "c", "%d", 3);
    report_warn(&to_second, "d", "%d", 4);
    report_warn(&to_first, "b", "%d", 2);
    report_warn(&report, "a", "%d", 1);
    assert_string_equal(heard.all, "1;");
    report_warn_of_queue(&report, &first);
    report_warn_of_queue(&report, &second);
    assert_string_equal(heard.all, "1;2;3;4;");
    assert_int_equal(first.count + second.count, 0);
    report_warn_of_queue(&report, &second);
    assert_string_equal(heard.all, "1;2;3;4;");
}

static void what_was_said_is_not_said_again(void **state)
{
    (void)state;
    struct heard heard = {""};
    struct report_queue queue = {0};
    struct report report = {.verbosity = REPORT_QUIET, .heard = hear, .heard_data = &heard};
    struct report waiting = {.queue = &queue};
    report_warn(&report, "a", "before");
    report_warn(&waiting, "a", "again");
    report_warn_of_frame(&waiting, "b", "frame");
    report_warn_of_frame(&waiting, "b", "frame again");
    report_warn_of_queue(&report, &queue);
    assert_string_equal(heard.all, "before;frame;");
    report.frame++;
    report_warn(&waiting, "a", "next");
    report_warn_of_queue(&report, &queue);
    assert_string_equal(heard.all, "before;frame;next;");
}

/* How many lines of both frames reach stderr, as each frame waits and is then said. */
static int lines_of_two_frames(void (*say)(struct report *report, const char *key,
                                           const char *format, ...))
{
    struct report_queue queue = {0};
    struct report report = {.verbosity = REPORT_NORMAL}, waiting = {.queue = &queue};
    FILE *lines = tmpfile();
    const int kept = dup(STDERR_FILENO);
    int count = 0;
    assert_non_null(lines);
    assert_int_equal(dup2(fileno(lines), STDERR_FILENO), STDERR_FILENO);
    for (report.frame = 1; report.frame <= 2; report.frame++) {
        say(&waiting, "a", "line");
        report_warn_of_queue(&report, &queue);
    }
    dup2(kept, STDERR_FILENO);
    close(kept);
    rewind(lines);
    for (int c = fgetc(lines); c != EOF; c = fgetc(lines))
        count += c == '\n';
    fclose(lines);
    return count;
}

static void what_is_of_a_frame_is_said_of_each(void **state)
{
    (void)state;
    assert_int_equal(lines_of_two_frames(report_warn), 1);
    assert_int_equal(lines_of_two_frames(report_warn_of_frame), 2);
}

static void what_waits_may_be_forgotten(void **state)
{
    (void)state;
    struct heard heard = {""};
    struct report_queue queue = {0};
    struct report report = {.verbosity = REPORT_QUIET, .heard = hear, .heard_data = &heard};
    struct report waiting = {.queue = &queue};
    report_warn(&waiting, "a", "one");
    report_free_queue(&queue);
    report_warn_of_queue(&report, &queue);
    assert_string_equal(heard.all, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_waits_is_said_in_its_turn),
        cmocka_unit_test(what_was_said_is_not_said_again),
        cmocka_unit_test(what_is_of_a_frame_is_said_of_each),
        cmocka_unit_test(what_waits_may_be_forgotten),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
