/* SPDX-License-Identifier: MIT
 *
 * What every consumer can do without a device, in lines that are C11, C++17 and C++20: defaults,
 * tables, and an error that says what is wrong. Exit status 0 if the library answers as its header
 * says. */
#include <stdio.h>
#include <string.h>
#include <vkao.h>

static int failures;

#define EXPECT(condition)                                                                          \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "smoke.c:%d: %s\n", __LINE__, #condition);                             \
            ++failures;                                                                            \
        }                                                                                          \
    } while (0)

static void keep(void *user_data, vkao_log_level level, const char *message)
{
    (void)level;
    snprintf((char *)user_data, 256, "%s", message);
}

int main(void)
{
    EXPECT(vkao_version() ==
           VK_MAKE_API_VERSION(0, VKAO_VERSION_MAJOR, VKAO_VERSION_MINOR, VKAO_VERSION_PATCH));

    const vkao_effect_info effect = vkao_effect_info_default();
    const vkao_params params = vkao_params_default();
    EXPECT(effect.struct_size == sizeof effect && effect.method == VKAO_SSAO_VBAO);
    EXPECT(params.struct_size == sizeof params && params.radius == 0.5f);
    EXPECT(vkao_images_default().struct_size == sizeof(vkao_images));
    EXPECT(vkao_frame_info_default().struct_size == sizeof(vkao_frame_info));
    EXPECT(vkao_view_default().normal_to_view[4] == 1.0f);

    uint32_t count = 0, found = 0;
    const vkao_parameter *table = vkao_parameters(&count);
    for (uint32_t i = 0; i < count; ++i)
        found += strcmp(table[i].name, "radius") == 0 && table[i].standard == 0.5;
    EXPECT(found == 1);

    char message[256] = "";
    vkao_context_info info = vkao_context_info_default();
    vkao_context *context = NULL;
    info.log = keep;
    info.log_user_data = message;
    EXPECT(vkao_context_create(&info, &context) == VKAO_ERROR_INVALID_ARGUMENT);
    EXPECT(context == NULL && strstr(message, "context.instance is NULL"));
    return failures ? 1 : 0;
}
