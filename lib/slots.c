/* SPDX-License-Identifier: MIT */
#include "slots.h"

#include "formats.h"
#include "parameters.h"

#include <stddef.h>

enum slot_use { SLOT_DEPTH, SLOT_AO, SLOT_COLOR, SLOT_NORMALS, SLOT_SPECULAR };

static const struct slot {
    const char *name;
    size_t offset; /* in vkao_images */
    enum slot_use use;
} slots[] = {
#define ROW(NAME, member, kind) {"images." #member, offsetof(vkao_images, member), SLOT_##kind},
    VKAO_SLOTS(ROW)
#undef ROW
};

static const char *const wants[] = {
    [SLOT_DEPTH] = "a depth format, R16_UNORM, R16_SFLOAT or R32_SFLOAT",
    [SLOT_AO] = "R8_UNORM, R16_UNORM, R16_SFLOAT or R32_SFLOAT",
    [SLOT_COLOR] = "a float, UNORM, SNORM or SRGB format of colour",
    [SLOT_NORMALS] = "a float, UNORM or SNORM format of colour",
    [SLOT_SPECULAR] = "a float, UNORM, SNORM or SRGB format with alpha, which is roughness",
};

const vkao_image *vkao_slot_image(const vkao_images *images, uint32_t slot)
{
    return (const vkao_image *)(const void *)((const char *)images + slots[slot].offset);
}

static bool format_fits(enum slot_use use, VkFormat format)
{
    switch (use) {
    case SLOT_DEPTH:
        return vkao_format_is_depth(format);
    case SLOT_AO:
        return vkao_format_is_ao(format);
    case SLOT_NORMALS:
        return vkao_format_is_color(format) && !vkao_format_is_srgb(format);
    case SLOT_SPECULAR:
        return vkao_format_is_color(format) && vkao_format_has_alpha(format);
    default:
        return vkao_format_is_color(format);
    }
}

static bool read_layout(VkImageLayout layout)
{
    static const VkImageLayout allowed[] = {
        VK_IMAGE_LAYOUT_GENERAL,
        VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL,
        VK_IMAGE_LAYOUT_READ_ONLY_OPTIMAL,
    };
    for (size_t i = 0; i < sizeof allowed / sizeof allowed[0]; ++i) {
        if (layout == allowed[i])
            return true;
    }
    return false;
}

/* Must the caller give it? What the program makes itself it can keep in scratch, if nobody else is
 * to see it. */
static bool is_required(const struct vkao_program *program, uint32_t slot)
{
    const vkao_effect_info *e = &program->settings;
    if (slot == VKAO_RESOURCE_AO_NOISY)
        return !(e->stages & VKAO_STAGE_SSAO) || e->noisy_ao;
    if (slot == VKAO_RESOURCE_AO)
        return !(e->stages & VKAO_STAGE_COMPOSITE) || e->stages == VKAO_STAGE_COMPOSITE;
    return true;
}

/* Can the format hold what effect.normal_encoding or bent_encoding says? */
static vkao_result check_encoding(const struct vkao_program *program, uint32_t i,
                                  const vkao_image *image)
{
    static const struct {
        const char *name;
        uint32_t components;
        bool is_signed;
    } encodings[] = {
        [VKAO_NORMALS_FROM_DEPTH] = {"FROM_DEPTH", 0, false},
        [VKAO_NORMALS_XYZ_SNORM] = {"XYZ_SNORM", 3, true},
        [VKAO_NORMALS_XYZ_UNORM] = {"XYZ_UNORM", 3, false},
        [VKAO_NORMALS_OCT_SNORM] = {"OCT_SNORM", 2, true},
        [VKAO_NORMALS_OCT_UNORM] = {"OCT_UNORM", 2, false},
    };
    const vkao_effect_info *e = &program->settings;
    const bool is_bent = i == VKAO_RESOURCE_BENT_NORMALS;
    const vkao_normal_encoding encoding = is_bent ? e->bent_encoding : e->normal_encoding;
    const uint32_t has = vkao_format_components(image->format),
                   want = encodings[encoding].components;
    const char *member = is_bent ? "bent_encoding" : "normal_encoding";
    char is[VKAO_NAME_BYTES];
    if (has < want)
        return vkao_refuse(&program->ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s.format is %s of %u components, but effect.%s is %s, of %u",
                           slots[i].name, vkao_format_name(image->format, is), has, member,
                           encodings[encoding].name, want);
    if (encodings[encoding].is_signed && !vkao_format_is_signed(image->format))
        return vkao_refuse(&program->ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s.format is %s without a sign, but effect.%s is %s; want %.4sUNORM",
                           slots[i].name, vkao_format_name(image->format, is), member,
                           encodings[encoding].name, encodings[encoding].name);
    return VKAO_SUCCESS;
}

/* The settings that ask for an image. */
static const char *const requirers[VKAO_SLOT_COUNT] = {
    [VKAO_RESOURCE_DEPTH] = "stages SSAO and BLUR",
    [VKAO_RESOURCE_NORMALS] = "normal_encoding other than FROM_DEPTH",
    [VKAO_RESOURCE_AO_NOISY] = "noisy_ao, or stages with BLUR and without SSAO",
    [VKAO_RESOURCE_AO] = "stages, unless they make AO and composite it",
    [VKAO_RESOURCE_COLOR] = "composite_mode MULTIPLY and INDIRECT",
    [VKAO_RESOURCE_DIRECT] = "composite_mode INDIRECT",
    [VKAO_RESOURCE_OUTPUT] = "stages COMPOSITE",
    [VKAO_RESOURCE_BENT_NORMALS] = "bent_normals, or by what shows or reads them",
    [VKAO_RESOURCE_ALBEDO] = "multi_bounce",
    [VKAO_RESOURCE_SPECULAR] = "specular other than NONE",
    [VKAO_RESOURCE_THICKNESS] = "thickness_input other than AS_SEEN",
    [VKAO_RESOURCE_SECOND_DEPTH] = "second_layer",
};

static vkao_result check_slot(const struct vkao_program *program, uint32_t i,
                              const vkao_image *image, bool reads, bool writes, bool need_views)
{
    const vkao_context *ctx = program->ctx;
    const char *name = slots[i].name;
    char is[VKAO_NAME_BYTES], other[VKAO_NAME_BYTES];
    vkao_format_name(image->format, is);
    if (!image->format && (image->view || image->image))
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s has %s but no format: set format to that of the view", name,
                           image->view ? "a view" : "an image");
    if (!image->format && (reads || writes) && is_required(program, i))
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s has no format, but is required by effect.%s (effect.stages is %s)",
                           name, requirers[i], vkao_stages_name(program->settings.stages, other));
    if (!image->format)
        return VKAO_SUCCESS;
    if (image->image && i != VKAO_RESOURCE_AO)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s.image is given, want it in images.ao only", name);
    if (!format_fits(slots[i].use, image->format))
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT, "%s.format is %s, want %s", name,
                           is, wants[slots[i].use]);
    if (i == VKAO_RESOURCE_AO && writes && image->format != program->settings.ao_format)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s.format is %s, but effect.ao_format is %s", name, is,
                           vkao_format_name(program->settings.ao_format, other));
    const bool fits =
        writes ? image->layout == VK_IMAGE_LAYOUT_GENERAL : !reads || read_layout(image->layout);
    if (need_views && !fits)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT, "%s.layout is %s, want %s", name,
                           vkao_layout_name(image->layout, other),
                           writes ? "GENERAL" : "a read-only one or GENERAL");
    if ((reads || writes) && (i == VKAO_RESOURCE_NORMALS || i == VKAO_RESOURCE_BENT_NORMALS)) {
        const vkao_result result = check_encoding(program, i, image);
        if (result != VKAO_SUCCESS)
            return result;
    }
    const VkFormatFeatureFlags want = (reads ? VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT : 0u) |
                                      (writes ? VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT : 0u);
    if (!vkao_format_can(ctx, image->format, want))
        return vkao_refuse(&ctx->log, VKAO_ERROR_UNSUPPORTED,
                           "%s.format is %s, which the device cannot %s%s", name, is,
                           writes ? "use as a storage image" : "sample",
                           writes && vkao_format_is_srgb(image->format)
                               ? ": make the image with MUTABLE_FORMAT, give a UNORM view of it"
                               : "");
    if (need_views && (reads || writes) && !image->view)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT, "%s.view is VK_NULL_HANDLE",
                           name);
    return VKAO_SUCCESS;
}

void vkao_slots_warn(const struct vkao_program *program, const vkao_images *images)
{
    static const char *const members[VKAO_SLOT_COUNT] = {
        [VKAO_RESOURCE_NORMALS] = "normal_encoding is FROM_DEPTH",
        [VKAO_RESOURCE_THICKNESS] = "thickness_input is AS_SEEN, or its method needs none",
        [VKAO_RESOURCE_SECOND_DEPTH] = "second_layer is VK_FALSE, or its method knows one layer",
        [VKAO_RESOURCE_BENT_NORMALS] = "bent_normals is VK_FALSE",
    };
    if (!(program->settings.stages & VKAO_STAGE_SSAO))
        return;
    for (uint32_t i = 0; i < VKAO_SLOT_COUNT; ++i) {
        if (members[i] && vkao_slot_image(images, i)->format &&
            !vkao_program_reads(program, (enum vkao_resource)i) &&
            !vkao_program_writes(program, (enum vkao_resource)i))
            vkao_log(&program->ctx->log, VKAO_LOG_WARNING, "%s is given, but not used: effect.%s",
                     slots[i].name, members[i]);
    }
}

vkao_result vkao_slots_check(const struct vkao_program *program, const vkao_images *images,
                             bool need_views)
{
    const struct vkao_logger *log = &program->ctx->log;
    if (images->padding)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "images.padding is %u, want 0",
                           images->padding);
    for (uint32_t i = 0; i < VKAO_SLOT_COUNT; ++i) {
        const vkao_image *image = vkao_slot_image(images, i);
        const bool reads = vkao_program_reads(program, (enum vkao_resource)i),
                   writes = vkao_program_writes(program, (enum vkao_resource)i);
        vkao_result result = check_slot(program, i, image, reads, writes, need_views);
        if (result != VKAO_SUCCESS)
            return result;
    }
    return VKAO_SUCCESS;
}

const char *vkao_slot_name(uint32_t slot)
{
    return slots[slot].name;
}
