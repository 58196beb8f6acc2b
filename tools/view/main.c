/* SPDX-License-Identifier: MIT
 *
 * vkao-view: ambient occlusion in a window. */
#include "viewer.h"

#include "atomic_file.h"

#include <stdio.h>
#include <stdlib.h>

static int print_version(void)
{
    uint32_t v = vkao_version();
    printf("vkao-view %u.%u.%u\n", VK_API_VERSION_MAJOR(v), VK_API_VERSION_MINOR(v),
           VK_API_VERSION_PATCH(v));
    return EXIT_OK;
}

static int run(const struct arguments *arguments)
{
    struct tool_error err = {0};
    struct viewer *viewer = calloc(1, sizeof *viewer);
    if (!viewer) {
        fail(&err, EXIT_MEMORY, "out of memory");
        report_error(&err);
        return err.code;
    }
    if (!viewer_open(viewer, arguments, &err) || !viewer_run(viewer, &err))
        report_error(&err);
    viewer_close(viewer);
    if (err.code == EXIT_OK && viewer->failure.code != EXIT_OK) {
        err = viewer->failure;
        report_error(&err);
    }
    /* Counted to the end: what outlives its device is reported as that goes. */
    uint32_t messages = viewer->gpu.validation_messages;
    free(viewer);
    if (messages > 0 && err.code == EXIT_OK) {
        fail(&err, EXIT_BUG, "%u messages of the validation layers", messages);
        report_error(&err);
    }
    return err.code;
}

int main(int argc, char **argv)
{
    struct arguments arguments;
    struct tool_error err = {0};
    atomic_file_catch_signals();
    if (!arguments_parse(argc, argv, &arguments, &err)) {
        report_error(&err);
        return err.code;
    }
    int code = EXIT_OK;
    if (arguments.help)
        fputs(arguments_help, stdout);
    else if (arguments.version)
        code = print_version();
    else
        code = run(&arguments);
    if ((fflush(stdout) != 0 || ferror(stdout)) && code == EXIT_OK) {
        fail(&err, EXIT_OUTPUT, "standard output: cannot write");
        report_error(&err);
        return err.code;
    }
    return code;
}
