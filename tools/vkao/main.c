/* SPDX-License-Identifier: MIT */
#include "atomic_file.h"
#include "commands.h"
#include "options.h"
#include "vector_width.h"

#include <stdio.h>

static void print_version(void)
{
    char version[VERSION_BYTES];
    uint32_t loader = VK_API_VERSION_1_0;
    vkEnumerateInstanceVersion(&loader);
    version_string(version);
    printf("vkao %s\n", version);
    printf("%s, reads and writes none rle zips zip piz pxr24 b44 b44a dwaa dwab\n",
           exr_library_version());
    printf("Vulkan loader %u.%u.%u\n", VK_API_VERSION_MAJOR(loader), VK_API_VERSION_MINOR(loader),
           VK_API_VERSION_PATCH(loader));
}

static int print_help(void)
{
    struct text text = {0};
    options_help(&text);
    if (text.data && !text.out_of_memory)
        fputs(text.data, stdout);
    text_free(&text);
    return EXIT_OK;
}

static int run(const struct options *options)
{
    struct report report = {.verbosity = options->verbosity};
    if (options->help)
        return print_help();
    if (options->version) {
        print_version();
        return EXIT_OK;
    }
    choose_vector_width();
    if (options->command == COMMAND_DEVICES)
        return command_devices(options);
    exr_set_threads(options->threads);
    return options->command == COMMAND_INSPECT ? command_inspect(options, &report)
                                               : command_render(options, &report);
}

int main(int argc, char **argv)
{
    struct options options;
    struct tool_error err = {0};
    atomic_file_catch_signals();
    if (!options_parse(argc, argv, &options, &err)) {
        report_error(&err);
        return err.code;
    }
    int code = run(&options);
    /* A full disk behind 'vkao inspect > x' shows only here. */
    if ((fflush(stdout) != 0 || ferror(stdout)) && code == EXIT_OK) {
        fail(&err, EXIT_OUTPUT, "standard output: cannot write");
        report_error(&err);
        return err.code;
    }
    return code;
}
