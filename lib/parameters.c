/* SPDX-License-Identifier: MIT
 *
 * The structs of vkao.h as tables: one row a member, from which checks, defaults, command lines and
 * panels come. Each refusal names field, value and range. */
#include "parameters.h"

#include "vk.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- The tables --- */

/* Name of the vkao_ssao_method, word, help, bent normals. */
#define METHODS(X)                                                                                 \
    X(SPHERE, "sphere", "points in the full sphere", VK_FALSE)                                     \
    X(HEMISPHERE, "hemisphere", "points in the normal-oriented hemisphere", VK_FALSE)              \
    X(HBAO, "hbao", "horizons, true-horizon form", VK_FALSE)                                       \
    X(GTAO, "gtao", "horizons, cosine-weighted", VK_TRUE)                                          \
    X(VBAO, "vbao", "visibility bitmask: the closest to ray-traced AO for its time", VK_TRUE)      \
    X(RAYMARCH, "raymarch", "rays through the depth image: slow, the yardstick", VK_TRUE)

#define METHOD_ROW(NAME, word, words, has_bent)                                                    \
    [VKAO_SSAO_##NAME] = {.name = word, .help = words, .has_bent_normals = has_bent},
static const vkao_method methods[] = {METHODS(METHOD_ROW)};
enum { METHOD_COUNT = sizeof methods / sizeof methods[0] };

#define METHOD_WORD(NAME, word, words, has_bent) [VKAO_SSAO_##NAME] = word,
static const char *const method_words[METHOD_COUNT] = {METHODS(METHOD_WORD)};
static const char *const falloff_words[] = {"smooth", "threshold"};
static const char *const thickness_words[] = {"as-seen", "given", "back-depth"};
static const char *const form_words[] = {"rescaled", "literal"};
static const char *const depth_words[] = {"projected", "z", "distance", "inverse-z"};
static const char *const normal_words[] = {"none", "xyz-snorm", "xyz-unorm", "oct-snorm",
                                           "oct-unorm"};
static const char *const projection_words[] = {"perspective", "orthographic"};
static const char *const mode_words[] = {"multiply", "indirect",     "ao-only", "noisy-ao",
                                         "normals",  "bent-normals", "view-z"};
static const char *const specular_words[] = {"none", "from-ao", "from-bent"};

#define METHOD(name) (1u << VKAO_SSAO_##name)
#define SLICED (METHOD(HBAO) | METHOD(GTAO) | METHOD(VBAO))
#define MAKES_AO (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR)
#define ROW(structure, member, kind)                                                               \
    .name = #member, .offset = offsetof(structure, member), .type = VKAO_PARAMETER_##kind
#define COMPILED(member, kind)                                                                     \
    ROW(vkao_effect_info, member, kind), .is_compiled = VK_TRUE, .unit = ""
#define FREE(member, kind, units) ROW(vkao_params, member, kind), .unit = units
#define CHOICE(member, words)                                                                      \
    COMPILED(member, CHOICE), .choices = words, .most = sizeof words / sizeof words[0] - 1
#define SWITCH(member) COMPILED(member, BOOL), .most = 1

/* clang-format off */
static const vkao_parameter parameters[] = {
    {SWITCH(half_resolution),
     .help = "a fourth of the work, then depth- and normal-aware upsampling",
     .stages = MAKES_AO},
    {CHOICE(depth_encoding, depth_words), .help = "what depth holds", .stages = MAKES_AO},
    {COMPILED(depth_bits, UINT),
     .help = "of a projected depth before it was copied; 0: as the format",
     .most = 32, .stages = MAKES_AO},
    {CHOICE(projection, projection_words), .help = "of the camera", .stages = VKAO_STAGE_ALL},
    {CHOICE(normal_encoding, normal_words), .help = "what normals hold; none: from depth",
     .stages = VKAO_STAGE_ALL},
    {CHOICE(bent_encoding, normal_words), .help = "of bent normals; none: as the normals",
     .stages = VKAO_STAGE_BLUR | VKAO_STAGE_COMPOSITE},
    {SWITCH(bent_normals), .help = "also write bent normals", .stages = MAKES_AO,
     .methods = METHOD(GTAO) | METHOD(VBAO) | METHOD(RAYMARCH)},
    {SWITCH(noisy_ao), .help = "also write AO before the blur", .stages = MAKES_AO},
    {CHOICE(method, method_words), .help = "how occlusion is found", .standard = VKAO_SSAO_VBAO,
     .stages = VKAO_STAGE_SSAO},
    {CHOICE(falloff, falloff_words), .help = "how occluders count by distance",
     .stages = VKAO_STAGE_SSAO},
    {CHOICE(sphere_form, form_words), .help = "rescaled: a wall is open; literal: the textbook's",
     .stages = VKAO_STAGE_SSAO, .methods = METHOD(SPHERE)},
    {COMPILED(sample_count, UINT), .help = "points or rays per texel", .most = 1024, .standard = 16,
     .zero_is_standard = VK_TRUE, .stages = VKAO_STAGE_SSAO,
     .methods = METHOD(SPHERE) | METHOD(HEMISPHERE) | METHOD(RAYMARCH)},
    {COMPILED(slice_count, UINT), .help = "directions per texel, each to both sides", .most = 64,
     .standard = 1, .zero_is_standard = VK_TRUE, .stages = VKAO_STAGE_SSAO, .methods = SLICED},
    {COMPILED(step_count, UINT),
     .help = "samples on each side of a slice, or on a ray", .most = 256,
     .standard = 9, .zero_is_standard = VK_TRUE, .stages = VKAO_STAGE_SSAO,
     .methods = SLICED | METHOD(RAYMARCH)},
    {CHOICE(thickness_input, thickness_words), .help = "what is known of how thick things are",
     .stages = MAKES_AO, .methods = METHOD(VBAO) | METHOD(RAYMARCH)},
    {SWITCH(second_layer), .help = "a second layer of depth hides too", .stages = MAKES_AO,
     .methods = METHOD(VBAO) | METHOD(RAYMARCH)},
    {COMPILED(blur_radius, UINT), .help = "texels on each side; 0: intensity and power alone",
     .most = 16, .standard = 3, .stages = VKAO_STAGE_BLUR},
    {COMPILED(blur_normal_power, FLOAT),
     .help = "how strictly the blur stops where normals turn; 0: not at all", .most = 128,
     .stages = VKAO_STAGE_BLUR},
    {CHOICE(composite_mode, mode_words),
     .help = "multiply: color * ao; indirect: direct + color * ao",
     .stages = VKAO_STAGE_COMPOSITE},
    {SWITCH(multi_bounce), .help = "brighten by the light that bounces on; needs albedo",
     .stages = VKAO_STAGE_COMPOSITE},
    {CHOICE(specular, specular_words), .help = "occlusion of indirect specular light",
     .stages = VKAO_STAGE_COMPOSITE},

    {FREE(noise_index, UINT, ""), .help = "which noise pattern; 0: the static one",
     .most = UINT32_MAX, .stages = VKAO_STAGE_SSAO},
    {FREE(radius, FLOAT, "scene units"), .help = "how far occluders reach", .above_least = VK_TRUE,
     .most = FLT_MAX, .standard = 0.5,
     .stages = VKAO_STAGE_PREPARE | MAKES_AO},
    {FREE(bias, FLOAT, "radii"),
     .help = "how far the scene must stand in front to block", .most = 1,
     .standard = 0.005, .stages = MAKES_AO},
    {FREE(thickness, FLOAT, ""), .help = "of what is seen, relative to the measured default",
     .most = 8, .standard = 1, .zero_is_standard = VK_TRUE, .stages = VKAO_STAGE_SSAO,
     .methods = METHOD(VBAO) | METHOD(RAYMARCH)},
    {FREE(blocking_scale, FLOAT, "1 / scene units"), .help = "the constant of the literal form",
     .above_least = VK_TRUE, .most = FLT_MAX, .standard = 50, .stages = VKAO_STAGE_SSAO,
     .methods = METHOD(SPHERE)},
    {FREE(sharpness, FLOAT, ""),
     .help = "how strictly the blur stops at depth edges; 0: not at all",
     .most = 10000, .standard = 200, .stages = VKAO_STAGE_BLUR},
    {FREE(intensity, FLOAT, ""), .help = "scale of occlusion; 1 is physical", .most = 8,
     .standard = 1, .stages = VKAO_STAGE_BLUR},
    {FREE(power, FLOAT, ""),
     .help = "exponent on visibility; 1 is physical", .above_least = VK_TRUE,
     .most = 8, .standard = 1, .stages = VKAO_STAGE_BLUR},
    {FREE(strength, FLOAT, ""), .help = "0: as if open everywhere", .most = 1, .standard = 1,
     .stages = VKAO_STAGE_COMPOSITE},
    {FREE(tint, COLOR, ""), .help = "linear colour of full occlusion", .most = 1,
     .stages = VKAO_STAGE_COMPOSITE},
    {FREE(debug_distance, FLOAT, "scene units"), .help = "what the depth view shows as white",
     .most = FLT_MAX, .standard = 100, .zero_is_standard = VK_TRUE,
     .stages = VKAO_STAGE_COMPOSITE},
};
/* clang-format on */
enum { PARAMETER_COUNT = sizeof parameters / sizeof parameters[0] };

const vkao_parameter *vkao_parameters(uint32_t *count)
{
    if (count)
        *count = PARAMETER_COUNT;
    return parameters;
}

const vkao_method *vkao_methods(uint32_t *count)
{
    if (count)
        *count = METHOD_COUNT;
    return methods;
}

/* --- Defaults --- */

static void put(void *structure, const vkao_parameter *p)
{
    unsigned char *at = (unsigned char *)structure + p->offset;
    const float number = (float)p->standard;
    const uint32_t word = (uint32_t)p->standard;
    if (p->type == VKAO_PARAMETER_FLOAT)
        memcpy(at, &number, sizeof number);
    else if (p->type != VKAO_PARAMETER_COLOR)
        memcpy(at, &word, sizeof word);
}

static void put_all(void *structure, VkBool32 is_compiled)
{
    for (int i = 0; i < PARAMETER_COUNT; ++i) {
        if (parameters[i].is_compiled == is_compiled)
            put(structure, &parameters[i]);
    }
}

bool vkao_method_reads(vkao_ssao_method method, const char *name)
{
    for (int i = 0; i < PARAMETER_COUNT; ++i) {
        const vkao_parameter *p = &parameters[i];
        if (strcmp(p->name, name) == 0)
            return !p->methods || p->methods & 1u << method;
    }
    return false;
}

void vkao_export(const void *own, size_t own_size, void *out, uint32_t size)
{
    if (!out || size < sizeof(uint32_t))
        return;
    memset(out, 0, size);
    memcpy(out, own, own_size < size ? own_size : size);
    memcpy(out, &size, sizeof size);
}

void vkao_context_info_init(vkao_context_info *out, uint32_t size)
{
    const vkao_context_info own = {.log_level = VKAO_LOG_WARNING};
    vkao_export(&own, sizeof own, out, size);
}

void vkao_effect_info_init(vkao_effect_info *out, uint32_t size)
{
    vkao_effect_info own = {.stages = MAKES_AO, .ao_format = VK_FORMAT_R8_UNORM};
    put_all(&own, VK_TRUE);
    vkao_export(&own, sizeof own, out, size);
}

void vkao_params_init(vkao_params *out, uint32_t size)
{
    vkao_params own = {0};
    put_all(&own, VK_FALSE);
    vkao_export(&own, sizeof own, out, size);
}

void vkao_images_init(vkao_images *out, uint32_t size)
{
    const vkao_images own = {0};
    vkao_export(&own, sizeof own, out, size);
}

void vkao_frame_info_init(vkao_frame_info *out, uint32_t size)
{
    const vkao_frame_info own = {0};
    vkao_export(&own, sizeof own, out, size);
}

void vkao_view_init(vkao_view *out, uint32_t size)
{
    vkao_view own = {0};
    own.normal_to_view[0] = own.normal_to_view[4] = own.normal_to_view[8] = 1.0f;
    vkao_export(&own, sizeof own, out, size);
}

/* --- Presets: chosen on solid and thin scenes together --- */

struct preset {
    VkBool32 half_resolution;
    uint32_t slice_count, step_count, blur_radius;
    /* Normals keep the blur off edges that depth does not show, thin slats in front of a wall; on a
     * CPU they cost more than the rest of the blur. */
    float normal_power;
    float sharpness; /* what is sharper flickers more, where one slice is all there is */
};

static const struct preset presets[] = {
    [VKAO_QUALITY_FAST] = {VK_TRUE, 1, 10, 3, 0.0f, 200.0f},
    [VKAO_QUALITY_DEFAULT] = {VK_FALSE, 1, 9, 3, 0.0f, 200.0f},
    [VKAO_QUALITY_HIGH] = {VK_FALSE, 2, 9, 3, 8.0f, 400.0f},
    [VKAO_QUALITY_BEST] = {VK_FALSE, 5, 16, 1, 8.0f, 400.0f},
};

vkao_result vkao_preset(vkao_quality quality, vkao_effect_info *effect, vkao_params *params)
{
    if ((uint32_t)quality >= sizeof presets / sizeof presets[0])
        return VKAO_ERROR_INVALID_ARGUMENT;
    const struct preset *p = &presets[quality];
    if (effect) {
        effect->half_resolution = p->half_resolution;
        effect->method = VKAO_SSAO_VBAO;
        effect->slice_count = p->slice_count;
        effect->step_count = p->step_count;
        effect->blur_radius = p->blur_radius;
        effect->blur_normal_power = p->normal_power;
    }
    if (params) {
        const vkao_params standard = vkao_params_default();
        params->bias = standard.bias;
        params->thickness = standard.thickness;
        params->sharpness = p->sharpness;
    }
    return VKAO_SUCCESS;
}

/* --- The struct rule --- */

/* Bytes that no version will have: a larger size is taken for one that was never set. */
enum { MOST_BYTES = 2048 };

vkao_result vkao_import_sized(const struct vkao_logger *log, const char *name, const void *src,
                              void *dst, size_t least, size_t known)
{
    uint32_t size;
    if (!src)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "%s is NULL", name);
    memcpy(&size, src, sizeof size);
    if (size < least || size > MOST_BYTES || size % 4)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s.struct_size is %u, want sizeof, which is %u: the *_default() "
                           "functions set it",
                           name, size, (unsigned)known);
    const unsigned char *bytes = src;
    for (size_t i = known; i < size; ++i) {
        if (bytes[i])
            return vkao_refuse(
                log, VKAO_ERROR_INVALID_ARGUMENT,
                "%s.struct_size is %u, this version knows %u bytes and byte %u is not zero", name,
                size, (unsigned)known, (unsigned)i);
    }
    memset(dst, 0, known);
    memcpy(dst, src, size < known ? size : known);
    return VKAO_SUCCESS;
}

/* What 0.2.0 had. Never changes. */
static const struct {
    size_t least, known;
} sizes[VKAO_STRUCT_COUNT] = {
    [VKAO_STRUCT_CONTEXT_INFO] = {104, sizeof(vkao_context_info)},
    [VKAO_STRUCT_EFFECT_INFO] = {120, sizeof(vkao_effect_info)},
    [VKAO_STRUCT_FRAME_INFO] = {40, sizeof(vkao_frame_info)},
    [VKAO_STRUCT_IMAGES] = {296, sizeof(vkao_images)},
    [VKAO_STRUCT_VIEW] = {160, sizeof(vkao_view)},
    [VKAO_STRUCT_PARAMS] = {56, sizeof(vkao_params)},
};

vkao_result vkao_import(const struct vkao_logger *log, enum vkao_struct which, const char *name,
                        const void *src, void *dst)
{
    /* 32-bit targets have smaller pointers, and no earlier version to be compatible with. */
    const size_t least = sizeof(void *) == 8 ? sizes[which].least : sizes[which].known;
    return vkao_import_sized(log, name, src, dst, least, sizes[which].known);
}

/* --- Checks --- */

static vkao_result check_word(const struct vkao_logger *log, const char *name,
                              const vkao_parameter *p, const unsigned char *at)
{
    uint32_t v;
    memcpy(&v, at, sizeof v);
    if ((double)v >= p->least && (double)v <= p->most)
        return VKAO_SUCCESS;
    return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "%s.%s is %u, want %.0f..%.0f", name,
                       p->name, v, p->least, p->most);
}

static vkao_result check_float(const struct vkao_logger *log, const char *name, const char *suffix,
                               const vkao_parameter *p, const unsigned char *at)
{
    float v;
    memcpy(&v, at, sizeof v);
    const bool above = p->above_least ? (double)v > p->least : (double)v >= p->least;
    if (above && (double)v <= p->most) /* false for NaN */
        return VKAO_SUCCESS;
    if (p->most < (double)FLT_MAX)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "%s.%s%s is %g, want %c%g,%g]", name,
                           p->name, suffix, (double)v, p->above_least ? '(' : '[', p->least,
                           p->most);
    return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "%s.%s%s is %g, want a finite value %s %g",
                       name, p->name, suffix, (double)v, p->above_least ? ">" : ">=", p->least);
}

static vkao_result check_parameter(const struct vkao_logger *log, const char *name,
                                   const vkao_parameter *p, const void *structure)
{
    static const char *const channels[] = {"[0]", "[1]", "[2]"};
    const unsigned char *at = (const unsigned char *)structure + p->offset;
    vkao_result result = VKAO_SUCCESS;
    switch (p->type) {
    case VKAO_PARAMETER_FLOAT:
        return check_float(log, name, "", p, at);
    case VKAO_PARAMETER_COLOR:
        for (size_t i = 0; result == VKAO_SUCCESS && i < 3; ++i)
            result = check_float(log, name, channels[i], p, at + i * sizeof(float));
        return result;
    default:
        return check_word(log, name, p, at);
    }
}

static bool is_zero(const vkao_parameter *p, const void *structure)
{
    const unsigned char *at = (const unsigned char *)structure + p->offset;
    float number;
    uint32_t word;
    memcpy(&number, at, sizeof number);
    memcpy(&word, at, sizeof word);
    return p->type == VKAO_PARAMETER_FLOAT ? !(number > 0.0f) : word == 0;
}

/* Zeros that stand for a default become it. After the checks: nothing is negative. */
static void fill_zeros(VkBool32 is_compiled, void *structure)
{
    for (int i = 0; i < PARAMETER_COUNT; ++i) {
        const vkao_parameter *p = &parameters[i];
        if (p->is_compiled == is_compiled && p->zero_is_standard && is_zero(p, structure))
            put(structure, p);
    }
}

static vkao_result check_all(const struct vkao_logger *log, const char *name, VkBool32 is_compiled,
                             const void *structure)
{
    vkao_result result = VKAO_SUCCESS;
    for (int i = 0; result == VKAO_SUCCESS && i < PARAMETER_COUNT; ++i) {
        if (parameters[i].is_compiled == is_compiled)
            result = check_parameter(log, name, &parameters[i], structure);
    }
    return result;
}

/* " (hbao)" of the method 2; "" of what is no choice. */
static const char *word_of(const char *name, uint32_t value, char buffer[VKAO_NAME_BYTES])
{
    buffer[0] = '\0';
    for (int i = 0; i < PARAMETER_COUNT; ++i) {
        const vkao_parameter *p = &parameters[i];
        if (p->type == VKAO_PARAMETER_CHOICE && strcmp(p->name, name) == 0)
            snprintf(buffer, VKAO_NAME_BYTES, " (%s)", p->choices[value]);
    }
    return buffer;
}

const char *vkao_stages_name(vkao_stage_flags stages, char buffer[VKAO_NAME_BYTES])
{
    static const char *const names[] = {"SSAO", "BLUR", "COMPOSITE", "PREPARE"};
    int length = snprintf(buffer, VKAO_NAME_BYTES, "0x%x", stages);
    const char *before = " (";
    for (int i = 0; i < 4; ++i) {
        if (!(stages & 1u << i))
            continue;
        length +=
            snprintf(buffer + length, (size_t)(VKAO_NAME_BYTES - length), "%s%s", before, names[i]);
        before = " | ";
    }
    if (stages & 15u)
        snprintf(buffer + length, (size_t)(VKAO_NAME_BYTES - length), ")");
    return buffer;
}

/* Rules between members of an effect. */
static vkao_result check_combination(const struct vkao_logger *log, const vkao_effect_info *e)
{
    const bool both = (e->stages & MAKES_AO) == MAKES_AO, ssao = e->stages & VKAO_STAGE_SSAO,
               composite = e->stages & VKAO_STAGE_COMPOSITE;
    const bool lit = e->composite_mode == VKAO_COMPOSITE_MULTIPLY ||
                     e->composite_mode == VKAO_COMPOSITE_INDIRECT;
    const bool shows_bent = e->composite_mode == VKAO_COMPOSITE_BENT_NORMALS,
               has_bent = e->stages == VKAO_STAGE_COMPOSITE || e->bent_normals;
    const bool has_method = !ssao || methods[e->method].has_bent_normals,
               is_layered =
                   ssao && (e->method == VKAO_SSAO_VBAO || e->method == VKAO_SSAO_RAYMARCH);
    const struct {
        bool wrong;
        const char *name;
        uint32_t value;
        const char *want;
    } rules[] = {
        {e->half_resolution && !both, "half_resolution", e->half_resolution,
         "the stages SSAO and BLUR for it"},
        {e->half_resolution && e->noisy_ao, "half_resolution", e->half_resolution,
         "no noisy_ao with it"},
        {e->noisy_ao && !both, "noisy_ao", e->noisy_ao, "the stages SSAO and BLUR for it"},
        {e->bent_normals && !both, "bent_normals", e->bent_normals,
         "the stages SSAO and BLUR for it"},
        {e->bent_normals && e->noisy_ao, "bent_normals", e->bent_normals, "no noisy_ao with it"},
        {e->bent_normals && !has_method, "method", (uint32_t)e->method,
         "GTAO, VBAO or RAYMARCH for bent_normals"},
        {e->thickness_input && !is_layered, "thickness_input", (uint32_t)e->thickness_input,
         "the stage SSAO and the method VBAO or RAYMARCH for it"},
        {e->second_layer && !is_layered, "second_layer", e->second_layer,
         "the stage SSAO and the method VBAO or RAYMARCH for it"},
        {composite && e->composite_mode > VKAO_COMPOSITE_AO_ONLY && !ssao, "composite_mode",
         (uint32_t)e->composite_mode, "the stage SSAO for it"},
        {composite && e->composite_mode == VKAO_COMPOSITE_NOISY_AO &&
             (!both || e->half_resolution || e->bent_normals),
         "composite_mode", (uint32_t)e->composite_mode,
         "the stage BLUR at full resolution, without bent_normals"},
        {composite && shows_bent && !has_bent, "composite_mode", (uint32_t)e->composite_mode,
         "bent_normals for it"},
        {composite && lit && e->specular == VKAO_SPECULAR_FROM_BENT && !has_bent, "specular",
         (uint32_t)e->specular, "bent_normals for it"},
        {composite && lit && e->specular && !e->normal_encoding, "specular", (uint32_t)e->specular,
         "images.normals and their normal_encoding"},
        {e->depth_bits && e->depth_bits != 16 && e->depth_bits != 24 && e->depth_bits != 32,
         "depth_bits", e->depth_bits, "0, 16, 24 or 32"},
    };
    char stages[VKAO_NAME_BYTES], word[VKAO_NAME_BYTES];
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; ++i) {
        if (rules[i].wrong)
            return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                               "effect.%s is %u%s, want %s (effect.stages is %s)", rules[i].name,
                               rules[i].value, word_of(rules[i].name, rules[i].value, word),
                               rules[i].want, vkao_stages_name(e->stages, stages));
    }
    return VKAO_SUCCESS;
}

vkao_result vkao_effect_info_check(const struct vkao_logger *log, const vkao_effect_info *in,
                                   vkao_effect_info *out)
{
    char name[VKAO_NAME_BYTES], all[VKAO_NAME_BYTES];
    vkao_result result = vkao_import(log, VKAO_STRUCT_EFFECT_INFO, "effect", in, out);
    if (result != VKAO_SUCCESS)
        return result;
    if (!out->stages || (out->stages & ~VKAO_STAGE_ALL))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "effect.stages is %s, want bits of %s",
                           vkao_stages_name(out->stages, name),
                           vkao_stages_name(VKAO_STAGE_ALL, all));
    if (out->ao_format && !vkao_format_is_ao(out->ao_format))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "effect.ao_format is %s, want R8_UNORM, R16_UNORM, R16_SFLOAT or "
                           "R32_SFLOAT",
                           vkao_format_name(out->ao_format, name));
    result = check_all(log, "effect", VK_TRUE, out);
    if (result == VKAO_SUCCESS)
        result = check_combination(log, out);
    fill_zeros(VK_TRUE, out);
    out->struct_size = sizeof *out;
    out->ao_format = out->ao_format ? out->ao_format : VK_FORMAT_R8_UNORM;
    if (!out->bent_encoding)
        out->bent_encoding = out->normal_encoding ? out->normal_encoding : VKAO_NORMALS_XYZ_SNORM;
    return result;
}

void vkao_effect_info_warn(const struct vkao_logger *log, const vkao_effect_info *e)
{
    const bool composites = e->stages & VKAO_STAGE_COMPOSITE;
    const struct {
        bool unused;
        const char *name;
        uint32_t value;
        const char *because;
        uint32_t is;
    } rules[] = {
        {e->depth_bits && e->stages & MAKES_AO && e->depth_encoding != VKAO_DEPTH_PROJECTED,
         "depth_bits", e->depth_bits, "depth_encoding", (uint32_t)e->depth_encoding},
        /* Modes for a look at what the stages saw come and go, and the rest stays. */
        {e->specular && composites && e->composite_mode == VKAO_COMPOSITE_AO_ONLY, "specular",
         (uint32_t)e->specular, "composite_mode", (uint32_t)e->composite_mode},
    };
    char word[VKAO_NAME_BYTES], other[VKAO_NAME_BYTES];
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; ++i) {
        if (rules[i].unused)
            vkao_log(log, VKAO_LOG_WARNING, "effect.%s is %u%s, but not used: effect.%s is %u%s",
                     rules[i].name, rules[i].value, word_of(rules[i].name, rules[i].value, word),
                     rules[i].because, rules[i].is, word_of(rules[i].because, rules[i].is, other));
    }
}

vkao_result vkao_params_check(const struct vkao_logger *log, const vkao_params *in,
                              vkao_params *out)
{
    vkao_result result = vkao_import(log, VKAO_STRUCT_PARAMS, "params", in, out);
    if (result != VKAO_SUCCESS)
        return result;
    result = check_all(log, "params", VK_FALSE, out);
    fill_zeros(VK_FALSE, out);
    return result;
}
