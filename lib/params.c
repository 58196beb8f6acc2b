/* SPDX-License-Identifier: MIT
 *
 * Range checks of parameter structs: pure, table-driven, each refusal names field, value and range. */
#include "internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

vkao_result vkao_import(const struct vkao_logger *log, const char *name, const void *src, void *dst,
                        size_t known)
{
    if (!src)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "%s is NULL", name);
    uint32_t size;
    memcpy(&size, src, sizeof size);
    if (size < known)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s.struct_size is %u, want at least %u", name, size, (unsigned)known);
    const unsigned char *bytes = src;
    for (size_t i = known; i < size; ++i) {
        if (bytes[i])
            return vkao_refuse(
                log, VKAO_ERROR_INVALID_ARGUMENT,
                "%s.struct_size is %u, this version knows %u bytes and byte %u is not zero", name,
                size, (unsigned)known, (unsigned)i);
    }
    memcpy(dst, src, known);
    return VKAO_SUCCESS;
}

struct float_range {
    const char *name;
    size_t offset;
    float min, max;
    bool open_min; /* min itself is out */
};

static vkao_result check_floats(const struct vkao_logger *log, const void *params,
                                const struct float_range *ranges, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        const struct float_range *r = &ranges[i];
        float v;
        memcpy(&v, (const unsigned char *)params + r->offset, sizeof v);
        bool above = r->open_min ? v > r->min : v >= r->min;
        if (above && v <= r->max) /* false for NaN */
            continue;
        if (r->max < FLT_MAX)
            return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "%s is %g, want %c%g,%g]", r->name,
                               (double)v, r->open_min ? '(' : '[', (double)r->min, (double)r->max);
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "%s is %g, want a finite value > %g",
                           r->name, (double)v, (double)r->min);
    }
    return VKAO_SUCCESS;
}

static vkao_result check_uint(const struct vkao_logger *log, const char *name, uint32_t v,
                              uint32_t min, uint32_t max)
{
    if (v >= min && v <= max)
        return VKAO_SUCCESS;
    return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "%s is %u, want %u..%u", name, v, min,
                       max);
}

vkao_result ssao_params_check(const vkao_context *ctx, const struct vkao_logger *log, bool bent,
                              const vkao_ssao_params *in, vkao_ssao_params *out)
{
    static const struct float_range ranges[] = {
        {"ssao.radius", offsetof(vkao_ssao_params, radius), 0.0f, FLT_MAX, true},
        {"ssao.bias", offsetof(vkao_ssao_params, bias), 0.0f, 1.0f, false},
        {"ssao.blocking_scale", offsetof(vkao_ssao_params, blocking_scale), 0.0f, FLT_MAX, true},
        {"ssao.thickness", offsetof(vkao_ssao_params, thickness), 0.0f, 8.0f, false},
    };
    vkao_result result = vkao_import(log, "ssao", in, out, sizeof *out);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "ssao.method", (uint32_t)out->method, 0, VKAO_METHOD_COUNT - 1);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "ssao.falloff", (uint32_t)out->falloff, 0, VKAO_FALLOFF_THRESHOLD);
    if (result == VKAO_SUCCESS)
        result =
            check_uint(log, "ssao.sphere_form", (uint32_t)out->sphere_form, 0, VKAO_SPHERE_LITERAL);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "ssao.sample_count", out->sample_count, 1, 1024);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "ssao.slice_count", out->slice_count, 0, 64);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "ssao.step_count", out->step_count, 0, 256);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "ssao.reserved", out->reserved | out->reserved_too, 0, 0);
    if (result == VKAO_SUCCESS)
        result = check_floats(log, out, ranges, sizeof ranges / sizeof ranges[0]);
    if (result == VKAO_SUCCESS && !(ctx->method_mask >> out->method & 1u))
        result = vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                             "ssao.method is %d, but the context was created with method_mask 0x%x",
                             (int)out->method, ctx->method_mask);
    if (result == VKAO_SUCCESS && bent && !(VKAO_BENT_METHODS >> out->method & 1u))
        result = vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                             "ssao.method is %d, which has no bent normals for images.bent_normals",
                             (int)out->method);
    /* Zero is from before the field existed. */
    const vkao_ssao_params standard = vkao_ssao_params_default();
    out->slice_count = out->slice_count ? out->slice_count : standard.slice_count;
    out->step_count = out->step_count ? out->step_count : standard.step_count;
    out->thickness = out->thickness > 0.0f ? out->thickness : standard.thickness;
    /* Beyond that all depth is near, or all far: nothing changes but that squares are floats. */
    if (result == VKAO_SUCCESS)
        out->radius = fminf(fmaxf(out->radius, (float)VKAO_NEAREST_Z), (float)VKAO_FARTHEST_Z);
    return result;
}

vkao_result blur_params_check(const struct vkao_logger *log, const vkao_blur_params *in,
                              vkao_blur_params *out)
{
    static const struct float_range ranges[] = {
        {"blur.sharpness", offsetof(vkao_blur_params, sharpness), 0.0f, 10000.0f, false},
        {"blur.normal_power", offsetof(vkao_blur_params, normal_power), 0.0f, 128.0f, false},
        {"blur.intensity", offsetof(vkao_blur_params, intensity), 0.0f, 8.0f, false},
        {"blur.power", offsetof(vkao_blur_params, power), 0.0f, 8.0f, true},
    };
    vkao_result result = vkao_import(log, "blur", in, out, sizeof *out);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "blur.radius", out->radius, 0, 16);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "blur.reserved", out->reserved, 0, 0);
    if (result == VKAO_SUCCESS)
        result = check_floats(log, out, ranges, sizeof ranges / sizeof ranges[0]);
    /* Devices may take denormal numbers for 0, and no power of 0 is that. */
    if (result == VKAO_SUCCESS)
        out->power = fmaxf(out->power, 1e-30f);
    return result;
}

/* What a composite reads must have been given. */
static vkao_result composite_slots_check(const vkao_frame *frame, const vkao_composite_params *p)
{
    const vkao_images *images = &frame->images;
    const bool lit = p->mode == VKAO_COMPOSITE_MULTIPLY || p->mode == VKAO_COMPOSITE_INDIRECT;
    const bool debug = p->mode > VKAO_COMPOSITE_AO_ONLY;
    /* At half resolution the blur puts its result where the noise was. */
    const bool noisy = (frame->stages & VKAO_STAGE_BLUR) && !frame_has_bent_normals(frame) &&
                       !frame->half_resolution;
    const struct {
        bool needed, given;
        const char *name;
    } slots[] = {
        {lit, images->color.format != VK_FORMAT_UNDEFINED, "images.color"},
        {p->mode == VKAO_COMPOSITE_INDIRECT, images->direct.format != VK_FORMAT_UNDEFINED,
         "images.direct"},
        {p->multi_bounce, images->albedo.format != VK_FORMAT_UNDEFINED, "images.albedo"},
        {lit && p->specular, images->specular.format != VK_FORMAT_UNDEFINED, "images.specular"},
        {lit && p->specular, images->normals.format != VK_FORMAT_UNDEFINED, "images.normals"},
        {p->mode == VKAO_COMPOSITE_BENT_NORMALS || (lit && p->specular == VKAO_SPECULAR_FROM_BENT),
         images->bent_normals.format != VK_FORMAT_UNDEFINED, "images.bent_normals"},
        {debug, frame->stages & VKAO_STAGE_SSAO, "the SSAO stage"},
        {p->mode == VKAO_COMPOSITE_NOISY_AO, noisy,
         "the BLUR stage at full resolution, without bent normals"},
    };
    for (size_t i = 0; i < sizeof slots / sizeof slots[0]; ++i) {
        if (slots[i].needed && !slots[i].given)
            return vkao_refuse(
                &frame->ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                "composite.mode %d (specular %d, multi_bounce %u) needs %s in the frame",
                (int)p->mode, (int)p->specular, p->multi_bounce, slots[i].name);
    }
    return VKAO_SUCCESS;
}

vkao_result composite_params_check(const vkao_frame *frame, const vkao_composite_params *in,
                                   vkao_composite_params *out)
{
    static const struct float_range ranges[] = {
        {"composite.strength", offsetof(vkao_composite_params, strength), 0.0f, 1.0f, false},
        {"composite.tint[0]", offsetof(vkao_composite_params, tint[0]), 0.0f, 1.0f, false},
        {"composite.tint[1]", offsetof(vkao_composite_params, tint[1]), 0.0f, 1.0f, false},
        {"composite.tint[2]", offsetof(vkao_composite_params, tint[2]), 0.0f, 1.0f, false},
        {"composite.debug_distance", offsetof(vkao_composite_params, debug_distance), 0.0f, FLT_MAX,
         false},
    };
    const struct vkao_logger *log = &frame->ctx->log;
    vkao_result result = vkao_import(log, "composite", in, out, sizeof *out);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "composite.mode", (uint32_t)out->mode, 0, VKAO_COMPOSITE_VIEW_Z);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "composite.multi_bounce", out->multi_bounce, 0, 1);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "composite.specular", (uint32_t)out->specular, 0,
                            VKAO_SPECULAR_FROM_BENT);
    if (result == VKAO_SUCCESS)
        result = check_uint(log, "composite.reserved", out->reserved, 0, 0);
    if (result == VKAO_SUCCESS)
        result = check_floats(log, out, ranges, sizeof ranges / sizeof ranges[0]);
    if (result != VKAO_SUCCESS)
        return result;
    out->debug_distance =
        out->debug_distance > 0.0f ? fmaxf(out->debug_distance, (float)VKAO_NEAREST_Z) : 100.0f;
    return composite_slots_check(frame, out);
}
