/* SPDX-License-Identifier: MIT
 *
 * The image slots of a frame: which stages need which, formats, layouts, what the device can do
 * with them, and pointing a frame at other images. The table is vkao.h's in other words; it does
 * not look into lib/slots.c. */
#include "frame.h"
#include "world.h"

#include <stdio.h>
#include <string.h>

enum { DEPTH, NORMALS, AO_NOISY, AO, COLOR, DIRECT, OUTPUT, BENT_NORMALS, ALBEDO, SPECULAR };

/* A letter per slot: r read, w written, b both, - not touched, ! refused. */
static const struct {
    const char *access, *required;
} combinations[VKAO_STAGE_ALL + 1] = {
    [VKAO_STAGE_SSAO] = {"rr-w---!--", "x--x------"},
    [VKAO_STAGE_BLUR] = {"rrrw---!--", "x-xx------"},
    [VKAO_STAGE_SSAO | VKAO_STAGE_BLUR] = {"rrbw---w--", "x--x------"},
    [VKAO_STAGE_COMPOSITE] = {"-r-rrrwrrr", "---x--x---"},
    [VKAO_STAGE_SSAO | VKAO_STAGE_COMPOSITE] = {"rr-brrw!rr", "x-----x---"},
    [VKAO_STAGE_BLUR | VKAO_STAGE_COMPOSITE] = {"rrrbrrw!rr", "x-x---x---"},
    [VKAO_STAGE_ALL] = {"rrbbrrwbrr", "x-----x---"},
};

/* Each stage combination twice: with ao_noisy, and with bent normals where they
 * may be. */
enum { CASES = (VKAO_STAGE_ALL + 1) * 2 };

static bool set_case(struct world *w, unsigned i)
{
    const vkao_stage_flags stages = i / 2;
    if (stages == 0 || (i % 2 && combinations[stages].access[BENT_NORMALS] == '!'))
        return false;
    w->effect_info.stages = stages;
    w->effect_info.noisy_ao = (stages & 3u) == 3u;
    /* All that a composite can read. */
    w->effect_info.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    w->effect_info.composite_mode = VKAO_COMPOSITE_INDIRECT;
    w->effect_info.multi_bounce = VK_TRUE;
    w->effect_info.specular =
        i % 2 && stages >= VKAO_STAGE_COMPOSITE ? VKAO_SPECULAR_FROM_BENT : VKAO_SPECULAR_FROM_AO;
    if (i % 2)
        world_use_bent_normals(w);
    w->effect_info.bent_normals = i % 2 && (stages & 3u) == 3u;
    return true;
}

static bool writes(char access)
{
    return access == 'w' || access == 'b';
}

static bool reads(char access)
{
    return access == 'r' || access == 'b';
}

/* Creates the frame and, on success, destroys it. */
static vkao_result attempt(struct world *w)
{
    vkao_result result = world_try_frame(w);
    assert_true((result == VKAO_SUCCESS) == (w->frame != NULL));
    vkao_frame_destroy(w->frame);
    vkao_effect_destroy(w->effect);
    w->frame = NULL;
    w->effect = NULL;
    return result;
}

static void expect_result(struct world *w, vkao_result want, const char *name, const char *value)
{
    size_t before = fake_live(&w->fake);
    fake_forget_calls(&w->fake);
    vkao_result result = attempt(w);
    if (want != VKAO_SUCCESS)
        expect_refused(w, want, result, name, value);
    else if (result != VKAO_SUCCESS)
        fail_msg("stages 0x%x: %s refused: %s", w->effect_info.stages, name, w->log.last_error);
    assert_int_equal(fake_live(&w->fake), before);
}

static void slots_are_required_as_the_stages_say(void **state)
{
    (void)state;
    for (unsigned i = 0; i < CASES; ++i) {
        struct world w;
        world_open(&w);
        for (size_t slot = 0; slot < SLOT_COUNT && set_case(&w, i); ++slot) {
            const vkao_image was = *world_slot(&w.images, slot);
            if (was.format == VK_FORMAT_UNDEFINED)
                continue;
            *world_slot(&w.images, slot) = (vkao_image){0};
            /* Settings that read a slot require it; noisy AO and AO may lie in scratch. */
            bool required = combinations[i / 2].required[slot] == 'x';
            if (slot != AO && slot != AO_NOISY)
                required = combinations[i / 2].access[slot] != '-';
            if (slot == AO_NOISY && w.effect_info.noisy_ao)
                required = true;
            expect_result(&w, required ? VKAO_ERROR_INVALID_ARGUMENT : VKAO_SUCCESS,
                          world_slot_names[slot], required ? "required" : "");
            /* What has no format is not there, and then has nothing else either. */
            const struct {
                vkao_image image;
                const char *has;
            } halves[] = {{{.view = was.view}, "a view but no format"},
                          {{.image = (VkImage)(uintptr_t)1}, "an image but no format"}};
            for (size_t half = 0; half < COUNT(halves); ++half) {
                *world_slot(&w.images, slot) = halves[half].image;
                expect_result(&w, VKAO_ERROR_INVALID_ARGUMENT, world_slot_names[slot],
                              halves[half].has);
            }
            *world_slot(&w.images, slot) = was;
        }
        world_close(&w);
    }
}

/* What lies behind the first layer is asked for by settings, not by stages. */
static void layers_are_required_where_they_are_read(void **state)
{
    (void)state;
    struct world w;
    world_open(&w);
    set_case(&w, 2 * (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR));
    w.effect_info.thickness_input = VKAO_THICKNESS_GIVEN;
    expect_result(&w, VKAO_ERROR_INVALID_ARGUMENT, "thickness_input", "method VBAO or RAYMARCH");
    w.effect_info.method = VKAO_SSAO_VBAO;
    expect_result(&w, VKAO_ERROR_INVALID_ARGUMENT, "images.thickness",
                  "required by effect.thickness_input");
    w.images.thickness = w.images.depth;
    expect_result(&w, VKAO_SUCCESS, "images.thickness", "");
    w.effect_info.second_layer = VK_TRUE;
    expect_result(&w, VKAO_ERROR_INVALID_ARGUMENT, "images.second_depth",
                  "required by effect.second_layer");
    w.images.second_depth = w.images.depth;
    expect_result(&w, VKAO_SUCCESS, "images.second_depth", "");
    w.images.thickness.format = VK_FORMAT_R8G8B8A8_UNORM;
    expect_result(&w, VKAO_ERROR_INVALID_ARGUMENT, "images.thickness", "37");
    w.effect_info.stages = VKAO_STAGE_BLUR;
    w.effect_info.noisy_ao = VK_FALSE;
    expect_result(&w, VKAO_ERROR_INVALID_ARGUMENT, "thickness_input", "stage SSAO");
    world_close(&w);
}

static void used_slots_need_views(void **state)
{
    (void)state;
    for (unsigned i = 0; i < CASES; ++i) {
        struct world w;
        world_open(&w);
        for (size_t slot = 0; slot < SLOT_COUNT && set_case(&w, i); ++slot) {
            const VkImageView was = world_slot(&w.images, slot)->view;
            if (!was)
                continue;
            world_slot(&w.images, slot)->view = VK_NULL_HANDLE;
            bool used = combinations[i / 2].access[slot] != '-';
            expect_result(&w, used ? VKAO_ERROR_INVALID_ARGUMENT : VKAO_SUCCESS,
                          world_slot_names[slot], used ? "view" : "");
            world_slot(&w.images, slot)->view = was;
        }
        world_close(&w);
    }
}

static void layouts_fit_what_is_done(void **state)
{
    (void)state;
    static const struct {
        VkImageLayout layout;
        bool read, written;
    } layouts[] = {
        {VK_IMAGE_LAYOUT_GENERAL, true, true},
        {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, true, false},
        {VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL, true, false},
        {VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL, true, false},
        {VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL, true, false},
        {VK_IMAGE_LAYOUT_UNDEFINED, false, false},
        {VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, false, false},
        {VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, false, false},
        {VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_STENCIL_READ_ONLY_OPTIMAL, false, false},
        {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, false, false},
        {VK_IMAGE_LAYOUT_PREINITIALIZED, false, false},
    };
    for (unsigned c = 0; c < CASES; ++c) {
        struct world w;
        world_open(&w);
        for (size_t i = 0; i < SLOT_COUNT * COUNT(layouts) && set_case(&w, c); ++i) {
            const size_t slot = i / COUNT(layouts), l = i % COUNT(layouts);
            const char access = combinations[c / 2].access[slot];
            if (world_slot(&w.images, slot)->format == VK_FORMAT_UNDEFINED)
                continue;
            bool fits =
                (!reads(access) || layouts[l].read) && (!writes(access) || layouts[l].written);
            char name[64], value[32];
            snprintf(name, sizeof name, "%s.layout", world_slot_names[slot]);
            snprintf(value, sizeof value, "%d", (int)layouts[l].layout);
            world_slot(&w.images, slot)->layout = layouts[l].layout;
            expect_result(&w, fits ? VKAO_SUCCESS : VKAO_ERROR_INVALID_ARGUMENT, name, value);
            world_slot(&w.images, slot)->layout = VK_IMAGE_LAYOUT_GENERAL;
        }
        world_close(&w);
    }
}

static void device_abilities_decide_about_formats(void **state)
{
    (void)state;
    const VkFormatFeatureFlags sampled = VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT;
    const VkFormatFeatureFlags storage = VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT;
    const VkFormatFeatureFlags abilities[][2] = {
        {0, 0}, {sampled, 0}, {storage, 0}, {sampled | storage, 0}, {0, sampled | storage},
    };
    for (unsigned c = 0; c < CASES; ++c) {
        struct world w;
        world_open(&w);
        for (size_t i = 0; i < SLOT_COUNT * COUNT(abilities) && set_case(&w, c); ++i) {
            const size_t slot = i / COUNT(abilities), a = i % COUNT(abilities);
            const char access = combinations[c / 2].access[slot];
            if (world_slot(&w.images, slot)->format == VK_FORMAT_UNDEFINED)
                continue;
            const VkFormatFeatureFlags either = abilities[a][0] | abilities[a][1];
            bool can =
                (!reads(access) || (either & sampled)) && (!writes(access) || (either & storage));
            char value[32];
            snprintf(value, sizeof value, "%d", (int)world_slot(&w.images, slot)->format);
            w.fake.format_count = 0; /* the scratch formats stay able: no slot has them */
            fake_limit_format(&w.fake, world_slot(&w.images, slot)->format, abilities[a][0],
                              abilities[a][1]);
            expect_result(&w, can ? VKAO_SUCCESS : VKAO_ERROR_UNSUPPORTED, world_slot_names[slot],
                          value);
        }
        world_close(&w);
    }
}

static const VkFormat integer_formats[] = {
    VK_FORMAT_R8_UINT,
    VK_FORMAT_R8G8B8A8_UINT,
    VK_FORMAT_R8G8B8A8_SINT,
    VK_FORMAT_B8G8R8A8_UINT,
    VK_FORMAT_R16_UINT,
    VK_FORMAT_R16G16_SINT,
    VK_FORMAT_R16G16B16A16_UINT,
    VK_FORMAT_R32_UINT,
    VK_FORMAT_R32_SINT,
    VK_FORMAT_R32G32B32A32_UINT,
    VK_FORMAT_R32G32B32A32_SINT,
    VK_FORMAT_A2B10G10R10_UINT_PACK32,
    VK_FORMAT_R64_UINT,
    VK_FORMAT_R64G64B64A64_SINT,
    VK_FORMAT_S8_UINT,
    VK_FORMAT_R64_SFLOAT,
    VK_FORMAT_G8_B8_R8_3PLANE_420_UNORM,
};

/* want: how the words begin that say what the slot wants; NULL if the formats fit. */
static void expect_formats(const VkFormat *formats, size_t count, size_t slot, const char *want)
{
    struct world w;
    world_open(&w);
    set_case(&w, 2 * VKAO_STAGE_ALL + (slot == BENT_NORMALS));
    const VkFormat was = world_slot(&w.images, slot)->format;
    for (size_t i = 0; i < count; ++i) {
        char name[64], value[96];
        snprintf(name, sizeof name, "%s.format", world_slot_names[slot]);
        snprintf(value, sizeof value, "(%d), want %s", (int)formats[i], want ? want : "");
        world_slot(&w.images, slot)->format = formats[i];
        expect_result(&w, want ? VKAO_ERROR_INVALID_ARGUMENT : VKAO_SUCCESS, name, value);
    }
    world_slot(&w.images, slot)->format = was;
    world_close(&w);
}

static void integer_formats_fit_no_slot(void **state)
{
    (void)state;
    for (size_t slot = 0; slot < SLOT_COUNT; ++slot)
        expect_formats(integer_formats, COUNT(integer_formats), slot, "");
}

static void formats_fit_their_slots(void **state)
{
    (void)state;
    static const VkFormat depth[] = {
        VK_FORMAT_D16_UNORM,         VK_FORMAT_X8_D24_UNORM_PACK32, VK_FORMAT_D32_SFLOAT,
        VK_FORMAT_D24_UNORM_S8_UINT, VK_FORMAT_D32_SFLOAT_S8_UINT,  VK_FORMAT_D16_UNORM_S8_UINT,
        VK_FORMAT_R16_UNORM,         VK_FORMAT_R16_SFLOAT,          VK_FORMAT_R32_SFLOAT,
    };
    static const VkFormat not_depth[] = {
        VK_FORMAT_R8G8B8A8_UNORM,
        VK_FORMAT_R32G32_SFLOAT,
        VK_FORMAT_R32G32B32A32_SFLOAT,
    };
    static const VkFormat ao[] = {
        VK_FORMAT_R8_UNORM,
        VK_FORMAT_R16_UNORM,
        VK_FORMAT_R16_SFLOAT,
        VK_FORMAT_R32_SFLOAT,
    };
    static const VkFormat not_ao[] = {
        VK_FORMAT_R8_SNORM,       VK_FORMAT_R8_SRGB,   VK_FORMAT_R16_SNORM,  VK_FORMAT_R8G8_UNORM,
        VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_D16_UNORM, VK_FORMAT_D32_SFLOAT,
    };
    static const VkFormat colors[] = {
        VK_FORMAT_R8G8B8A8_UNORM,
        VK_FORMAT_B8G8R8A8_UNORM,
        VK_FORMAT_R8G8B8A8_SRGB,
        VK_FORMAT_A2B10G10R10_UNORM_PACK32,
        VK_FORMAT_B10G11R11_UFLOAT_PACK32,
        VK_FORMAT_R16G16B16A16_SFLOAT,
        VK_FORMAT_R32G32B32A32_SFLOAT,
        VK_FORMAT_R16G16_SNORM,
        VK_FORMAT_R8_UNORM,
    };
    /* Roughness is in alpha. */
    static const VkFormat with_alpha[] = {
        VK_FORMAT_R8G8B8A8_UNORM,           VK_FORMAT_B8G8R8A8_SRGB,
        VK_FORMAT_A2B10G10R10_UNORM_PACK32, VK_FORMAT_A1R5G5B5_UNORM_PACK16,
        VK_FORMAT_R16G16B16A16_SFLOAT,      VK_FORMAT_R32G32B32A32_SFLOAT,
        VK_FORMAT_BC1_RGBA_UNORM_BLOCK,     VK_FORMAT_BC2_UNORM_BLOCK,
        VK_FORMAT_BC3_SRGB_BLOCK,           VK_FORMAT_BC7_UNORM_BLOCK,
        VK_FORMAT_ASTC_4x4_UNORM_BLOCK,     VK_FORMAT_ETC2_R8G8B8A1_UNORM_BLOCK,
    };
    static const VkFormat without_alpha[] = {
        VK_FORMAT_B10G11R11_UFLOAT_PACK32,
        VK_FORMAT_E5B9G9R9_UFLOAT_PACK32,
        VK_FORMAT_R16G16B16_SFLOAT,
        VK_FORMAT_R8G8B8_SRGB,
        VK_FORMAT_R16G16_SFLOAT,
        VK_FORMAT_BC1_RGB_UNORM_BLOCK,
        VK_FORMAT_BC6H_UFLOAT_BLOCK,
        VK_FORMAT_EAC_R11G11_UNORM_BLOCK,
        VK_FORMAT_D32_SFLOAT,
    };
    static const size_t of_color[] = {NORMALS, COLOR, DIRECT, OUTPUT, ALBEDO, SPECULAR};
    enum { DEPTH_ONLY = 6 }; /* of depth, those before formats that colour can have too */
    expect_formats(depth, COUNT(depth), DEPTH, NULL);
    expect_formats(not_depth, COUNT(not_depth), DEPTH, "a depth format");
    expect_formats(ao, COUNT(ao), AO_NOISY, NULL);
    expect_formats(not_ao, COUNT(not_ao), AO, "R8_UNORM");
    expect_formats(not_ao, COUNT(not_ao), AO_NOISY, "R8_UNORM");
    expect_formats(colors, COUNT(colors), COLOR, NULL);
    expect_formats(colors, COUNT(colors), DIRECT, NULL);
    expect_formats(colors, COUNT(colors), OUTPUT, NULL);
    expect_formats(colors, COUNT(colors), ALBEDO, NULL);
    expect_formats(with_alpha, COUNT(with_alpha), SPECULAR, NULL);
    expect_formats(without_alpha, COUNT(without_alpha), SPECULAR,
                   "a float, UNORM, SNORM or SRGB format with alpha, which is roughness");
    for (size_t i = 0; i < COUNT(of_color); ++i)
        expect_formats(depth, DEPTH_ONLY, of_color[i], "a float, UNORM");
}

/* Given and bent normals, which are of the same encoding here. */
static void normals_fit_their_encoding(void **state)
{
    (void)state;
    static const VkFormat formats[] = {
        VK_FORMAT_R8_UNORM,          VK_FORMAT_R16_SFLOAT,
        VK_FORMAT_BC4_SNORM_BLOCK,   VK_FORMAT_R16G16_SNORM,
        VK_FORMAT_R32G32_SFLOAT,     VK_FORMAT_R8G8_UNORM,
        VK_FORMAT_BC5_UNORM_BLOCK,   VK_FORMAT_EAC_R11G11_SNORM_BLOCK,
        VK_FORMAT_R8G8B8A8_UNORM,    VK_FORMAT_A2B10G10R10_UNORM_PACK32,
        VK_FORMAT_R8G8B8A8_SRGB,     VK_FORMAT_B10G11R11_UFLOAT_PACK32,
        VK_FORMAT_BC7_UNORM_BLOCK,   VK_FORMAT_R16G16B16_SFLOAT,
        VK_FORMAT_R8G8B8A8_SNORM,    VK_FORMAT_A2B10G10R10_SNORM_PACK32,
        VK_FORMAT_BC6H_SFLOAT_BLOCK, VK_FORMAT_R32G32B32A32_SFLOAT,
    };
    /* Of each format: y it fits, c it has too few components, s it has no sign, g it is sRGB. */
    static const struct {
        vkao_normal_encoding encoding;
        const char *fits, *name, *instead;
    } rows[] = {
        {VKAO_NORMALS_XYZ_SNORM, "ccccccccssgssyyyyy", "XYZ_SNORM", "XYZ_UNORM"},
        {VKAO_NORMALS_XYZ_UNORM, "ccccccccyygyyyyyyy", "XYZ_UNORM", ""},
        {VKAO_NORMALS_OCT_SNORM, "cccyyssyssgssyyyyy", "OCT_SNORM", "OCT_UNORM"},
        {VKAO_NORMALS_OCT_UNORM, "cccyyyyyyygyyyyyyy", "OCT_UNORM", ""},
    };
    for (size_t i = 0; i < COUNT(rows) * COUNT(formats) * 2; ++i) {
        const size_t row = i / 2 / COUNT(formats), format = i / 2 % COUNT(formats);
        const size_t slot = i % 2 ? BENT_NORMALS : NORMALS;
        const char fits = rows[row].fits[format];
        struct world w;
        world_open(&w);
        set_case(&w, 2 * (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR) + 1);
        w.effect_info.normal_encoding = rows[row].encoding;
        w.images.normals.format = w.images.bent_normals.format = VK_FORMAT_R32G32B32A32_SFLOAT;
        world_slot(&w.images, slot)->format = formats[format];
        char name[64];
        snprintf(name, sizeof name, "%s.format", world_slot_names[slot]);
        const vkao_result want = fits == 'y' ? VKAO_SUCCESS : VKAO_ERROR_INVALID_ARGUMENT;
        expect_result(&w, want, name,
                      fits == 'g'   ? "R8G8B8A8_SRGB (43), want a float, UNORM or SNORM"
                      : fits == 's' ? rows[row].instead
                                    : rows[row].name);
        world_close(&w);
    }
}

static void messages_name_formats_and_layouts(void **state)
{
    (void)state;
    const vkao_image integers = {.format = VK_FORMAT_R8G8B8A8_UINT,
                                 .layout = VK_IMAGE_LAYOUT_GENERAL},
                     attachment = {.format = VK_FORMAT_R8G8B8A8_UNORM,
                                   .layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
                     unknown = {.format = (VkFormat)1000156000, .layout = VK_IMAGE_LAYOUT_GENERAL},
                     srgb = {.format = VK_FORMAT_R8G8B8A8_SRGB, .layout = VK_IMAGE_LAYOUT_GENERAL};
    const struct {
        const vkao_image *image;
        vkao_result result;
        const char *words;
    } cases[] = {
        {&integers, VKAO_ERROR_INVALID_ARGUMENT, "R8G8B8A8_UINT (41)"},
        {&attachment, VKAO_ERROR_INVALID_ARGUMENT, "COLOR_ATTACHMENT_OPTIMAL (2)"},
        {&unknown, VKAO_ERROR_INVALID_ARGUMENT, "VkFormat (1000156000)"},
        {&srgb, VKAO_ERROR_UNSUPPORTED, "MUTABLE_FORMAT"},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        world_open(&w);
        set_case(&w, 2 * VKAO_STAGE_ALL);
        fake_limit_format(&w.fake, VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT, 0);
        const VkImageView view = w.images.output.view;
        w.images.output = *cases[i].image;
        w.images.output.view = view;
        expect_result(&w, cases[i].result, "images.output", cases[i].words);
        world_close(&w);
    }
}

/* Normals, thickness or bent normals that the settings leave out. What other stages need is there
 * without a word. */
static void images_that_ssao_leaves_out_are_said(void **state)
{
    (void)state;
    static const struct {
        size_t slot;
        vkao_stage_flags stages;
        vkao_normal_encoding encoding;
        const char *words; /* NULL: none */
    } cases[] = {
        {NORMALS, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, VKAO_NORMALS_FROM_DEPTH, "FROM_DEPTH"},
        {NORMALS, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, VKAO_NORMALS_XYZ_SNORM, NULL},
        {NORMALS, VKAO_STAGE_BLUR, VKAO_NORMALS_FROM_DEPTH, NULL},
        {BENT_NORMALS, VKAO_STAGE_SSAO, VKAO_NORMALS_FROM_DEPTH, "bent_normals"},
        {COLOR, VKAO_STAGE_SSAO, VKAO_NORMALS_FROM_DEPTH, NULL},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        world_open(&w);
        w.effect_info.stages = cases[i].stages;
        w.effect_info.noisy_ao = VK_FALSE;
        w.effect_info.normal_encoding = cases[i].encoding;
        const vkao_image image =
            cases[i].slot == BENT_NORMALS ? w.bent_normals : *world_slot(&w.images, cases[i].slot);
        const vkao_image depth = w.images.depth, noisy = w.images.ao_noisy, ao = w.images.ao;
        w.images = vkao_images_default();
        w.images.depth = depth;
        w.images.ao_noisy = cases[i].stages & VKAO_STAGE_SSAO ? w.images.ao_noisy : noisy;
        w.images.ao = ao;
        *world_slot(&w.images, cases[i].slot) = image;
        world_forget_log(&w);
        assert_int_equal(attempt(&w), VKAO_SUCCESS);
        assert_int_equal(w.log.lines, cases[i].words ? 1 : 0);
        if (cases[i].words) {
            assert_int_equal(w.log.last_level, VKAO_LOG_WARNING);
            assert_non_null(strstr(w.log.last, world_slot_names[cases[i].slot]));
            assert_non_null(strstr(w.log.last, cases[i].words));
        }
        /* Once: an engine may update every frame. */
        world_create_frame(&w);
        world_forget_log(&w);
        assert_int_equal(vkao_frame_update(w.frame, &w.images), VKAO_SUCCESS);
        assert_int_equal(w.log.lines, 0);
        world_close(&w);
    }
}

static void view_without_format_is_refused(void **state)
{
    (void)state;
    struct world w;
    world_open(&w);
    set_case(&w, 2 * VKAO_STAGE_ALL);
    for (size_t slot = 0; slot < SLOT_COUNT; ++slot) {
        const vkao_image was = *world_slot(&w.images, slot);
        world_slot(&w.images, slot)->format = VK_FORMAT_UNDEFINED;
        world_slot(&w.images, slot)->view = w.bent_normals.view; /* any */
        expect_result(&w, VKAO_ERROR_INVALID_ARGUMENT, world_slot_names[slot], "format");
        *world_slot(&w.images, slot) = was;
    }
    world_close(&w);
}

static void padding_is_refused(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    w.images.padding = 9;
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_frame_update(w.frame, &w.images),
                   "images.padding", "9");
    assert_int_equal(w.fake.call_count, 0);
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, world_try_frame(&w), "images.padding", "9");
    world_close(&w);
}

/* The view behind a binding of a pass. */
static uint64_t bound_view(const struct world *w, uint32_t pass, uint32_t binding)
{
    return fake_find(&w->fake, (uint64_t)w->frame->sets[pass])->views[binding];
}

/* Opens a frame with every stage, i = 1 with bent normals instead of ao_noisy. */
static void open_case(struct world *w, int i)
{
    world_open(w);
    set_case(w, 2 * VKAO_STAGE_ALL + (unsigned)i);
    w->images.depth.layout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;
    world_create_frame(w);
}

/* Every use of every pass that is a slot of the images holds it. */
static void check_bindings(const struct world *w, vkao_images images)
{
    const struct vkao_program *program = w->frame->program;
    uint32_t checked = 0;
    for (uint32_t i = 0; i < program->count; ++i) {
        for (uint32_t k = 0; k < program->steps[i].use_count; ++k) {
            const struct vkao_use *use = &program->steps[i].uses[k];
            if (use->resource >= VKAO_SLOT_COUNT || !vkao_use_is_touched(program, use) ||
                !world_slot(&images, use->resource)->format)
                continue;
            assert_int_equal(bound_view(w, i, use->binding),
                             (uint64_t)world_slot(&images, use->resource)->view);
            checked |= VKAO_BIT(use->resource);
        }
    }
    const uint32_t absent = program->settings.bent_normals ? VKAO_BIT(VKAO_RESOURCE_AO_NOISY)
                                                           : VKAO_BIT(VKAO_RESOURCE_BENT_NORMALS);
    const uint32_t layers =
        VKAO_BIT(VKAO_RESOURCE_THICKNESS) | VKAO_BIT(VKAO_RESOURCE_SECOND_DEPTH);
    assert_int_equal(checked | absent | layers, (1u << VKAO_SLOT_COUNT) - 1u);
}

static void each_binding_holds_its_slot(void **state)
{
    (void)state;
    for (int bent = 0; bent < 2; ++bent) {
        struct world w;
        open_case(&w, bent);
        check_bindings(&w, w.images);
        assert_int_equal(vkao_frame_update(w.frame, &w.images), VKAO_SUCCESS);
        const struct fake_call *call = fake_nth(&w.fake, "vkUpdateDescriptorSets", 0);
        bool found = false;
        for (uint32_t k = 0; k < call->write_count; ++k) {
            if (call->writes[k].binding != VKAO_BINDING_DEPTH)
                continue;
            assert_int_equal(call->writes[k].layout, w.images.depth.layout);
            found = true;
        }
        assert_true(found);
        world_close(&w);
    }
}

static void without_blur_ssao_writes_ao_itself(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_SSAO);
    assert_int_equal(bound_view(&w, 1, VKAO_BINDING_TARGET), (uint64_t)w.images.ao.view);
    world_close(&w);
}

/* The header asks for SAMPLED of what is read alone. */
static void bent_normals_are_sampled_where_they_are_read(void **state)
{
    (void)state;
    for (int reads_bent = 0; reads_bent < 2; ++reads_bent) {
        struct world w;
        world_open(&w);
        set_case(&w, 2 * VKAO_STAGE_ALL + 1);
        w.effect_info.specular = reads_bent ? VKAO_SPECULAR_FROM_BENT : VKAO_SPECULAR_FROM_AO;
        world_create_frame(&w);
        assert_int_equal(vkao_frame_update(w.frame, &w.images), VKAO_SUCCESS);
        uint32_t sampled = 0, stored = 0;
        for (uint32_t i = 0; i < fake_count(&w.fake, "vkUpdateDescriptorSets"); ++i) {
            const struct fake_call *call = fake_nth(&w.fake, "vkUpdateDescriptorSets", i);
            for (uint32_t k = 0; k < call->write_count; ++k) {
                if (call->writes[k].view != (uint64_t)w.images.bent_normals.view)
                    continue;
                sampled += call->writes[k].type == VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
                stored += call->writes[k].type == VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
            }
        }
        assert_true(stored > 0);
        assert_int_equal(sampled > 0, reads_bent);
        world_close(&w);
    }
}

static void point_at_other_views(struct world *w)
{
    for (size_t slot = 0; slot < SLOT_COUNT; ++slot) {
        if (world_slot(&w->images, slot)->format)
            world_slot(&w->images, slot)->view = fake_caller_view(&w->fake);
    }
}

static void update_points_at_other_images_without_allocation(void **state)
{
    (void)state;
    for (int bent = 0; bent < 2; ++bent) {
        struct world w;
        open_case(&w, bent);
        fake_forget_calls(&w.fake);
        point_at_other_views(&w);
        const unsigned host = w.host.total;
        assert_int_equal(vkao_frame_update(w.frame, &w.images), VKAO_SUCCESS);
        assert_int_equal(w.host.total, host);
        assert_int_equal(fake_count(&w.fake, "vkCreate"), 0);
        assert_int_equal(fake_count(&w.fake, "vkAllocate"), 0);
        check_bindings(&w, w.images);
        world_close(&w);
    }
}

static void refused_update_leaves_the_frame(void **state)
{
    (void)state;
    for (int bent = 0; bent < 2; ++bent) {
        struct world w;
        open_case(&w, bent);
        fake_forget_calls(&w.fake);
        const vkao_images was = w.images;
        for (size_t i = 0; i < SLOT_COUNT * 4; ++i) {
            const size_t slot = i / 4, wrong = i % 4;
            w.images = was;
            point_at_other_views(&w);
            vkao_image *image = world_slot(&w.images, slot);
            if (wrong > 0 && image->format == VK_FORMAT_UNDEFINED)
                continue; /* nothing to take away */
            if (wrong == 0)
                image->format = VK_FORMAT_R32_SFLOAT;
            if (wrong == 1)
                *image = (vkao_image){0};
            if (wrong == 2)
                image->view = VK_NULL_HANDLE;
            if (wrong == 3)
                image->layout = VK_IMAGE_LAYOUT_UNDEFINED;
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_frame_update(w.frame, &w.images),
                           world_slot_names[slot], "");
            assert_int_equal(fake_count(&w.fake, "vkUpdateDescriptorSets"), 0);
        }
        check_bindings(&w, was);
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_frame_update(w.frame, NULL),
                       "vkao_frame_update", "images is NULL");
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slots_are_required_as_the_stages_say),
        cmocka_unit_test(layers_are_required_where_they_are_read),
        cmocka_unit_test(used_slots_need_views),
        cmocka_unit_test(layouts_fit_what_is_done),
        cmocka_unit_test(device_abilities_decide_about_formats),
        cmocka_unit_test(integer_formats_fit_no_slot),
        cmocka_unit_test(formats_fit_their_slots),
        cmocka_unit_test(normals_fit_their_encoding),
        cmocka_unit_test(messages_name_formats_and_layouts),
        cmocka_unit_test(images_that_ssao_leaves_out_are_said),
        cmocka_unit_test(view_without_format_is_refused),
        cmocka_unit_test(padding_is_refused),
        cmocka_unit_test(each_binding_holds_its_slot),
        cmocka_unit_test(without_blur_ssao_writes_ao_itself),
        cmocka_unit_test(bent_normals_are_sampled_where_they_are_read),
        cmocka_unit_test(update_points_at_other_images_without_allocation),
        cmocka_unit_test(refused_update_leaves_the_frame),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
