/* SPDX-License-Identifier: MIT */
#include "memory.h"

#include "engine.h"

#include <vulkan/vulkan.h>

static const struct kind {
    const char *name;
    bool bent_normals, ao_in_scratch, half_resolution;
} kinds[] = {
    {.name = "AO"},
    {.name = "AO, half resolution", .half_resolution = true},
    {.name = "bent normals", .bent_normals = true},
    {.name = "bent normals, half resolution", .bent_normals = true, .half_resolution = true},
    {.name = "composite, no AO image", .ao_in_scratch = true},
    {.name = "composite, half resolution", .ao_in_scratch = true, .half_resolution = true},
};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

static bool query(const vkao_context *ctx, const struct kind *kind, VkExtent2D extent, double *mb,
                  struct tool_error *err)
{
    const struct engine_features features = {.composite = kind->ao_in_scratch,
                                             .bent_normals = kind->bent_normals};
    const struct config config = {
        .name = "default", .is_preset = true, .quality = VKAO_QUALITY_DEFAULT};
    VkMemoryRequirements need;
    vkao_images images;
    vkao_frame_info info;
    vkao_effect *effect = NULL;
    vkao_effect_info effect_info = engine_effect_info(features, &config);
    effect_info.half_resolution = kind->half_resolution;
    engine_frame_info(features, extent, NULL, &images, &info);
    if (kind->ao_in_scratch)
        images.ao = (vkao_image){0};
    vkao_result result = vkao_effect_create(ctx, &effect_info, &effect);
    if (result == VKAO_SUCCESS)
        result = vkao_frame_scratch(effect, &info, &need);
    vkao_effect_destroy(effect);
    if (result != VKAO_SUCCESS)
        return gpu_library_failed(err, "vkao_frame_scratch", result);
    *mb = (double)need.size * 1e-6;
    return true;
}

static void add_head(const VkExtent2D *sizes, size_t count, bool markdown, struct text *text)
{
    text_add(text, markdown ? "| scratch, MB |" : "%-32s", "scratch, MB");
    for (size_t i = 0; i < count; i++)
        text_add(text, markdown ? " %u × %u |" : "  %5u x %-5u", sizes[i].width, sizes[i].height);
    text_add(text, markdown ? "\n|---|" : "\n");
    for (size_t i = 0; markdown && i < count; i++)
        text_add(text, "---:|%s", i + 1 == count ? "\n" : "");
}

static bool add_kinds(const vkao_context *ctx, const VkExtent2D *sizes, size_t count, bool markdown,
                      struct text *text, struct tool_error *err)
{
    for (size_t k = 0; k < KINDS; k++) {
        text_add(text, markdown ? "| %s |" : "%-32s", kinds[k].name);
        for (size_t i = 0; i < count; i++) {
            double mb = 0;
            if (!query(ctx, &kinds[k], sizes[i], &mb, err))
                return false;
            text_add(text, markdown ? " %.1f |" : " %11.2f  ", mb);
        }
        text_add(text, "\n");
    }
    return true;
}

bool memory_report(const char *device, const VkExtent2D *sizes, size_t count, bool markdown,
                   struct text *text, struct tool_error *err)
{
    const struct gpu_options options = {.device = device};
    struct gpu gpu;
    if (!gpu_create(&options, &gpu, err))
        return false;
    vkao_context *ctx = gpu_context(&gpu, err);
    bool ok = ctx != NULL;
    if (ok && !markdown)
        text_add(text, "%s, 10^6 bytes\n", gpu.properties.deviceName);
    if (ok) {
        add_head(sizes, count, markdown, text);
        ok = add_kinds(ctx, sizes, count, markdown, text, err);
    }
    vkao_context_destroy(ctx);
    gpu_destroy(&gpu);
    return ok;
}
