/* SPDX-License-Identifier: MIT
 *
 * vkao-bench: how good and how fast the library is. */
#include "commands.h"

#include "atomic_file.h"
#include "error.h"
#include "report.h"
#include "vector_width.h"
#include "vkao.h"

#include <stdio.h>
#include <string.h>

static const struct command {
    const char *name, *help;
    int (*run)(int argc, char **argv);
} commands[] = {
    {"quality", "error against ray-traced truth over a folder of G-buffers", command_quality},
    {"cost", "instructions of every pass on AMD GPUs that need not be there", command_cost},
    {"copy", "how fast the device moves bytes: the floor under every stage", command_copy},
    {"speed", "time of every stage, at any size, beside other programs", command_speed},
};
enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static void print_help(void)
{
    printf("Usage: vkao-bench COMMAND [OPTION]...\n\nCommands:\n");
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        printf("  %-10s %s\n", commands[i].name, commands[i].help);
    printf("\n'vkao-bench COMMAND --help' lists the options of one.\n\n"
           "Exit status: 0 done, 1 some files failed, 2 usage, 3 input, 4 channels or\n"
           "conventions, 5 Vulkan device, 6 output, 33 out of memory.\n");
}

static int fail_usage(const char *word)
{
    struct tool_error err = {0};
    if (word)
        fail(&err, EXIT_USAGE, "unknown command '%s'", word);
    else
        fail(&err, EXIT_USAGE, "no command given");
    fail_hint(&err, "'vkao-bench --help' lists the commands");
    report_error(&err);
    return err.code;
}

static int run(int argc, char **argv)
{
    if (argc < 2)
        return fail_usage(NULL);
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        print_help();
        return EXIT_OK;
    }
    if (strcmp(argv[1], "--version") == 0) {
        uint32_t v = vkao_version();
        printf("vkao-bench %u.%u.%u\n", VK_API_VERSION_MAJOR(v), VK_API_VERSION_MINOR(v),
               VK_API_VERSION_PATCH(v));
        return EXIT_OK;
    }
    choose_vector_width();
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        if (strcmp(argv[1], commands[i].name) == 0)
            return commands[i].run(argc - 1, argv + 1);
    return fail_usage(argv[1]);
}

int main(int argc, char **argv)
{
    struct tool_error err = {0};
    atomic_file_catch_signals();
    int code = run(argc, argv);
    /* A full disk behind 'vkao-bench quality > x' shows only here. */
    if ((fflush(stdout) != 0 || ferror(stdout)) && code == EXIT_OK) {
        fail(&err, EXIT_OUTPUT, "standard output: cannot write");
        report_error(&err);
        return err.code;
    }
    return code;
}
