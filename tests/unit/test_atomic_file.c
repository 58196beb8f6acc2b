/* SPDX-License-Identifier: MIT
 *
 * Output appears whole or not at all, and takes nobody's place unasked. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "atomic_file.h"
#include "exr_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void no_temporary_is_left_when_the_disk_write_fails(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("g", "none");
    struct tool_error err = {0};
    struct rlimit old, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    small = old;
    small.rlim_cur = 4096;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    bool ok = exr_write_file(in_directory("out.exr"), NULL, &part, 1, false, &err);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
    signal(SIGXFSZ, handler);
    assert_false(ok);
    assert_int_equal(err.code, EXIT_OUTPUT);
    assert_non_null(strstr(err.message, "out.exr: cannot write: File too large"));
    assert_int_equal(files_in_directory(), 0);
}

static void missing_directory_is_an_output_error(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("g", "zip");
    struct tool_error err = {0};
    assert_false(exr_write_file(in_directory("no/out.exr"), NULL, &part, 1, false, &err));
    assert_int_equal(err.code, EXIT_OUTPUT);
    assert_non_null(strstr(err.message, "No such file or directory"));
    assert_string_not_equal(err.hint, "");
}

static void existing_output_is_not_replaced(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("g", "zip");
    struct tool_error err = {0};
    store_file(in_directory("out.exr"), "mine", 4);
    assert_false(exr_write_file(in_directory("out.exr"), NULL, &part, 1, false, &err));
    assert_int_equal(err.code, EXIT_OUTPUT);
    struct bytes file = load_file(in_directory("out.exr"));
    assert_int_equal(file.size, 4);
    free(file.data);
    assert_int_equal(files_in_directory(), 1);
}

static void output_that_appears_meanwhile_is_not_replaced(void **state)
{
    (void)state;
    struct atomic_file file;
    struct tool_error err = {0};
    assert_true(atomic_file_open(&file, in_directory("out"), false, &err));
    assert_true(atomic_file_write(&file, "new", 3, &err));
    store_file(in_directory("out"), "theirs", 6);
    assert_false(atomic_file_commit(&file, &err));
    assert_int_equal(err.code, EXIT_OUTPUT);
    struct bytes left = load_file(in_directory("out"));
    assert_int_equal(left.size, 6);
    free(left.data);
    assert_int_equal(files_in_directory(), 1);
}

static void output_is_invisible_until_the_commit(void **state)
{
    (void)state;
    struct atomic_file file;
    struct tool_error err = {0};
    assert_true(atomic_file_open(&file, in_directory("out"), true, &err));
    assert_true(atomic_file_write(&file, "new", 3, &err));
    assert_int_equal(access(in_directory("out"), F_OK), -1);
    assert_true(atomic_file_commit(&file, &err));
    assert_int_equal(access(in_directory("out"), F_OK), 0);
    atomic_file_abort(&file); /* harmless now */
    assert_int_equal(files_in_directory(), 1);
}

/* In a process of its own: the exit code of one that a signal meets with two files in progress. */
static int exit_code_of_interrupted(int number)
{
    int status = 0;
    const pid_t child = fork();
    if (child == 0) {
        struct atomic_file a, b;
        struct tool_error err = {0};
        signal(number, SIG_DFL);
        atomic_file_catch_signals();
        if (!atomic_file_open(&a, in_directory("a"), true, &err) ||
            !atomic_file_open(&b, in_directory("b"), false, &err) || files_in_directory() != 2)
            _exit(1);
        raise(number);
        _exit(0);
    }
    assert_true(child > 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void interruption_removes_every_pending_file(void **state)
{
    (void)state;
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXCPU};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        assert_int_equal(exit_code_of_interrupted(numbers[i]), 128 + numbers[i]);
        assert_int_equal(files_in_directory(), 0);
    }
    assert_int_equal(exit_code_of_interrupted(SIGXFSZ), 0); /* an error of the write instead */
}

static void replacing_through_a_link_keeps_the_link_and_the_mode(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("g", "zip");
    struct stat status;
    store_file(in_directory("real.exr"), "old", 3);
    assert_int_equal(chmod(in_directory("real.exr"), 0640), 0);
    assert_int_equal(symlink("real.exr", in_directory("link.exr")), 0);
    write_ok(in_directory("link.exr"), NULL, &part, 1);
    assert_int_equal(lstat(in_directory("link.exr"), &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_int_equal(lstat(in_directory("real.exr"), &status), 0);
    assert_true(S_ISREG(status.st_mode) && status.st_size > 3);
    assert_int_equal(status.st_mode & 0777, 0640);
}

/* As an output is of a disk that is not mounted. */
static void a_link_to_nothing_is_not_followed(void **state)
{
    (void)state;
    for (int replace = 0; replace < 2; replace++) {
        struct atomic_file file;
        struct tool_error err = {0};
        assert_int_equal(symlink("real.exr", in_directory("link.exr")), 0);
        assert_false(atomic_file_open(&file, in_directory("link.exr"), replace, &err));
        assert_int_equal(err.code, EXIT_OUTPUT);
        assert_non_null(strstr(err.message, "which is not there"));
        assert_int_equal(files_in_directory(), 1);
        assert_int_equal(unlink(in_directory("link.exr")), 0);
    }
}

static void new_files_have_the_permissions_of_the_umask(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("g", "zip");
    struct stat status;
    mode_t old = umask(027);
    write_ok(in_directory("out.exr"), NULL, &part, 1);
    umask(old);
    assert_int_equal(stat(in_directory("out.exr"), &status), 0);
    assert_int_equal(status.st_mode & 0777, 0640);
}

#define TEST(name) cmocka_unit_test_teardown(name, empty_directory)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(no_temporary_is_left_when_the_disk_write_fails),
        TEST(missing_directory_is_an_output_error),
        TEST(existing_output_is_not_replaced),
        TEST(output_that_appears_meanwhile_is_not_replaced),
        TEST(output_is_invisible_until_the_commit),
        TEST(interruption_removes_every_pending_file),
        TEST(replacing_through_a_link_keeps_the_link_and_the_mode),
        TEST(a_link_to_nothing_is_not_followed),
        TEST(new_files_have_the_permissions_of_the_umask),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
