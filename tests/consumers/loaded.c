/* SPDX-License-Identifier: MIT
 *
 * usage: loaded LIBVKAO.SO NAME...   a program that is not linked with vkao: it loads the library,
 * finds each function that is named and takes the defaults from it. */
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <vkao.h>

/* ISO C has no cast from an object pointer to a function pointer. */
#define FUNCTION(pointer, name)                                                                    \
    do {                                                                                           \
        void *address = dlsym(library, name);                                                      \
        memcpy(&(pointer), &address, sizeof address);                                              \
    } while (0)

int main(int argc, char **argv)
{
    void *library = argc > 1 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    if (!library) {
        fprintf(stderr, "%s\n", argc > 1 ? dlerror() : "which library?");
        return 1;
    }
    for (int i = 2; i < argc; ++i) {
        if (!dlsym(library, argv[i])) {
            fprintf(stderr, "%s\n", dlerror());
            return 1;
        }
    }
    uint32_t (*version)(void);
    void (*defaults)(vkao_params *, uint32_t);
    vkao_params params;
    FUNCTION(version, "vkao_version");
    FUNCTION(defaults, "vkao_params_init");
    defaults(&params, sizeof params);
    const int ok = VK_API_VERSION_MINOR(version()) == VKAO_VERSION_MINOR &&
                   params.struct_size == sizeof params && params.radius == 0.5f;
    return dlclose(library) || !ok;
}
