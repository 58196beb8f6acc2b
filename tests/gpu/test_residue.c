/* SPDX-License-Identifier: MIT
 *
 * Nothing is read that nothing has written: whatever lay in the scratch memory and in the output
 * images before, the same bytes come out inside the rect, and none are touched outside it. */
#include "fixture.h"
#include "hostile.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(array) (uint32_t)(sizeof(array) / sizeof(array)[0])

/* 0 and NaN are both background to who reads view z; 3.0f, 0x40404040, is a depth. */
static const unsigned char fills[] = {0x00, 0xff, 0x40};
enum { FILLS = sizeof fills };

/* Everything that frames here ask for. */
static struct memory {
    VkDeviceMemory memory;
    VkBuffer buffer;
    VkDeviceSize bytes;
} scratch;

static void scratch_open(void)
{
    VkMemoryRequirements need;
    scratch.bytes = 1u << 20;
    assert_int_equal(vkCreateBuffer(fixture.gpu.device,
                                    &(VkBufferCreateInfo){
                                        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                        .size = scratch.bytes,
                                        .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                                 VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                        .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                    },
                                    NULL, &scratch.buffer),
                     VK_SUCCESS);
    vkGetBufferMemoryRequirements(fixture.gpu.device, scratch.buffer, &need);
    scratch.memory = fixture_allocate(&need, need.size);
    assert_int_equal(vkBindBufferMemory(fixture.gpu.device, scratch.buffer, scratch.memory, 0),
                     VK_SUCCESS);
}

static void scratch_close(void)
{
    vkDestroyBuffer(fixture.gpu.device, scratch.buffer, NULL);
    vkFreeMemory(fixture.gpu.device, scratch.memory, NULL);
    scratch = (struct memory){.bytes = 0};
}

/* --- One case --- */

static bool is_output(const struct picture *p, enum picture_slot slot)
{
    return p->formats[slot] != VK_FORMAT_UNDEFINED &&
           (slot == SLOT_AO || slot == SLOT_BENT || slot == SLOT_OUTPUT || slot == SLOT_NOISY);
}

static size_t slot_bytes(const struct picture *p, enum picture_slot slot)
{
    return picture_texels(p) * gpu_format_bytes(p->formats[slot]);
}

static void fill_memory(const struct picture *p, struct picture_gpu *g, unsigned char value)
{
    vkao_frame_info info;
    VkMemoryRequirements need;
    picture_frame_info(p, g, &info);
    check_vkao(vkao_frame_scratch(g->effect, &info, &need));
    assert_true(need.size <= scratch.bytes);
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    check(cmd != NULL);
    gpu_full_barrier(cmd);
    vkCmdFillBuffer(cmd, scratch.buffer, 0, (need.size + 3) & ~(VkDeviceSize)3,
                    value * 0x01010101u);
    gpu_full_barrier(cmd);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    for (int i = 0; i < SLOT_COUNT; ++i) {
        if (!is_output(p, (enum picture_slot)i))
            continue;
        const size_t bytes = slot_bytes(p, (enum picture_slot)i);
        void *data = test_alloc(bytes, 1);
        memset(data, value, bytes);
        check(gpu_image_upload(&fixture.gpu, &g->images[i], data, bytes, &fixture.error));
        free(data);
    }
}

static VkRect2D rect_of(const struct picture *p)
{
    if (p->view.rect.extent.width)
        return p->view.rect;
    if (p->view.valid.extent.width)
        return p->view.valid;
    return (VkRect2D){{0, 0}, {p->width, p->height}};
}

/* Whether they are equal inside the rect, and outside as they were filled. ao_noisy is written
 * beyond the rect too. */
static bool bytes_agree(const struct picture *p, enum picture_slot slot, const unsigned char *bytes,
                        const unsigned char *want, unsigned char value, const char *what)
{
    const VkRect2D rect = rect_of(p);
    const size_t texel = gpu_format_bytes(p->formats[slot]);
    for (size_t i = 0; i < picture_texels(p); ++i) {
        const uint32_t x = (uint32_t)(i % p->width), y = (uint32_t)(i / p->width);
        const bool inside = x - (uint32_t)rect.offset.x < rect.extent.width &&
                            y - (uint32_t)rect.offset.y < rect.extent.height;
        bool wrong = inside && memcmp(bytes + i * texel, want + i * texel, texel) != 0;
        for (size_t b = 0; !inside && slot != SLOT_NOISY && b < texel; ++b)
            wrong = wrong || bytes[i * texel + b] != value;
        if (!wrong)
            continue;
        print_error("%s: texel (%u,%u) of slot %d %s, fill 0x%02x\n", what, x, y, (int)slot,
                    inside ? "depends on what memory held" : "was written", value);
        return false;
    }
    return true;
}

static uint32_t cases, failed;

/* With all fills. The picture has scratch.memory. */
static void check_case(const struct picture *p, const char *what)
{
    struct picture_gpu g;
    unsigned char *first[SLOT_COUNT] = {NULL};
    bool agree = true;
    picture_open(p, &g);
    for (int f = 0; f < FILLS && agree; ++f) {
        fill_memory(p, &g, fills[f]);
        VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
        check(cmd != NULL);
        picture_record(p, &g, cmd);
        check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
        for (int i = 0; i < SLOT_COUNT; ++i) {
            if (!is_output(p, (enum picture_slot)i))
                continue;
            const size_t bytes = slot_bytes(p, (enum picture_slot)i);
            unsigned char *data = test_alloc(bytes, 1);
            check(gpu_image_download(&fixture.gpu, &g.images[i], data, bytes, &fixture.error));
            if (!first[i])
                first[i] = data;
            agree = agree && bytes_agree(p, (enum picture_slot)i, data, first[i], fills[f], what);
            if (first[i] != data)
                free(data);
        }
    }
    for (int i = 0; i < SLOT_COUNT; ++i)
        free(first[i]);
    picture_close(&g);
    ++cases;
    failed += !agree;
}

/* --- Cases --- */

#define NOWHERE                                                                                    \
    {                                                                                              \
        {0, 0},                                                                                    \
        {                                                                                          \
            0, 0                                                                                   \
        }                                                                                          \
    }
/* Whole images of all remainders, parts of images, parts of parts, and what lies in several strips
 * or tiles. A software driver compiles once more for each extent that is a power of two, as 1 is:
 * of the thin images an effect has few. No other image, nor half of it, has such an extent, nor has
 * the image of view z, see vkao_view_z_extent(): what is thin within them costs nothing. */
static const struct edge {
    const char *name;
    uint32_t width, height;
    VkRect2D valid, rect, viewport; /* empty = the default */
} edges[] = {
    {"one texel", 1, 1, NOWHERE, NOWHERE, NOWHERE},
    {"column", 1, 41, NOWHERE, NOWHERE, NOWHERE},
    {"row", 39, 1, NOWHERE, NOWHERE, NOWHERE},
    {"valid texel", 39, 33, {{18, 14}, {1, 1}}, NOWHERE, NOWHERE},
    {"valid column", 37, 35, {{12, 2}, {1, 31}}, NOWHERE, NOWHERE},
    {"valid row", 49, 37, {{4, 22}, {39, 1}}, NOWHERE, NOWHERE},
    {"whole", 37, 29, NOWHERE, NOWHERE, NOWHERE},
    {"valid", 49, 35, {{0, 0}, {33, 27}}, NOWHERE, NOWHERE},
    {"valid in the middle", 50, 36, {{6, 4}, {31, 23}}, NOWHERE, NOWHERE},
    {"rect", 40, 33, NOWHERE, {{13, 9}, {17, 11}}, NOWHERE},
    {"rect in valid", 50, 38, {{4, 2}, {39, 33}}, {{4, 20}, {23, 15}}, NOWHERE},
    {"texel in valid", 40, 33, {{2, 2}, {25, 21}}, {{26, 22}, {1, 1}}, NOWHERE},
    {"overscan", 39, 33, NOWHERE, NOWHERE, {{-5, -7}, {61, 47}}},
    {"strips", 17, 300, NOWHERE, {{1, 5}, {5, 290}}, NOWHERE},
    {"tiles", 270, 9, {{0, 0}, {267, 7}}, {{3, 1}, {264, 6}}, NOWHERE},
};
enum { THIN = 3 };

enum kind { FULL, HALF, BENT, HALF_BENT, NOISY, LIT, KINDS };
static const char *const kind_names[KINDS] = {"full",       "half",     "bent",
                                              "half, bent", "ao_noisy", "lit"};

static void use_normals(struct picture *p, struct chance *settings, struct chance *chance)
{
    p->view.normal_encoding = (vkao_normal_encoding)chance_below(settings, 5);
    picture_fill(p, SLOT_NORMALS, VK_FORMAT_R32G32B32A32_SFLOAT, 0.0);
    for (size_t i = 0; i < picture_texels(p) * 4; ++i)
        p->values[SLOT_NORMALS][i] = chance_between(chance, -1.0, 1.0);
    hostile_spread(chance, (enum hostile_pattern)chance_below(chance, HOSTILE_BLOCKS + 1),
                   p->values[SLOT_NORMALS], p->width, p->height, 4);
}

static void make_depth(struct picture *p, struct chance *settings, struct chance *chance)
{
    const struct scene scenes[] = {scene_corner(), scene_fence(), scene_open_sky()};
    const double aspect = (double)p->width / p->height;
    const struct lens lens = chance_yes(settings, 0.7) ? lens_perspective(0.8 * aspect, 0.8)
                                                       : lens_orthographic(2.0 * aspect, 2.0);
    picture_render_scene(p, &scenes[chance_below(chance, COUNT(scenes))], &lens,
                         VK_FORMAT_R32_SFLOAT, VK_FORMAT_UNDEFINED);
    if (chance_yes(chance, 0.9))
        hostile_spread(chance, (enum hostile_pattern)chance_below(chance, HOSTILE_PATTERNS),
                       p->values[SLOT_DEPTH], p->width, p->height, 1);
}

static void make_outputs(struct picture *p, struct chance *settings, struct chance *chance,
                         enum kind kind)
{
    /* A software driver compiles for each format: one of them a kind. */
    static const VkFormat ao[KINDS] = {VK_FORMAT_R8_UNORM,   VK_FORMAT_R32_SFLOAT,
                                       VK_FORMAT_R16_SFLOAT, VK_FORMAT_R32_SFLOAT,
                                       VK_FORMAT_R16_UNORM,  VK_FORMAT_R32_SFLOAT};
    picture_set(p, SLOT_AO, ao[kind], NULL);
    p->staged = chance_yes(chance, 0.6);
    p->half_resolution = kind == HALF || kind == HALF_BENT;
    if (kind == BENT || kind == HALF_BENT)
        picture_set(p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    if (kind == NOISY)
        picture_set(p, SLOT_NOISY, VK_FORMAT_R16_SFLOAT, NULL);
    if (kind == LIT || kind == HALF_BENT) {
        static const vkao_composite_mode modes[] = {VKAO_COMPOSITE_AO_ONLY, VKAO_COMPOSITE_NORMALS,
                                                    VKAO_COMPOSITE_VIEW_Z, VKAO_COMPOSITE_NOISY_AO};
        p->stages |= VKAO_STAGE_COMPOSITE;
        picture_set(p, SLOT_OUTPUT, VK_FORMAT_R16G16B16A16_SFLOAT, NULL);
        p->composite.mode = modes[chance_below(settings, kind == LIT ? 4 : 3)];
        if (kind == LIT && p->composite.mode == VKAO_COMPOSITE_AO_ONLY && chance_yes(settings, 0.5))
            p->formats[SLOT_AO] = VK_FORMAT_UNDEFINED; /* in scratch */
    }
}

/* turn: 0 or 1, two blurs for each kind of frame. */
static void make_blur(struct picture *p, enum kind kind, uint32_t turn, struct chance *chance)
{
    static const uint32_t radii[KINDS] = {0, 1, 2, 3, 5, 16};
    static const float sharpness[] = {0.0f, 0x1p-149f, 1.0f, 200.0f, 10000.0f},
                       powers[] = {0.0f, 8.0f, 2.5f};
    p->blur.radius = radii[(kind + 3 * turn) % KINDS];
    p->blur.sharpness = sharpness[chance_below(chance, COUNT(sharpness))];
    p->blur.normal_power = powers[(kind + turn) % COUNT(powers)];
    p->blur.intensity = chance_yes(chance, 0.7) ? 1.0f : 1.7f;
}

/* settings and turn: what is compiled, the same for all pictures of an effect. */
static void make(struct picture *p, struct chance *settings, struct chance *chance,
                 const struct edge *edge, enum kind kind, uint32_t turn)
{
    picture_init(p, edge->width, edge->height, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->view.valid = edge->valid;
    p->view.rect = edge->rect;
    p->view.viewport = edge->viewport;
    p->view.depth_encoding = (vkao_depth_encoding)chance_below(settings, 4);
    p->scratch_memory = scratch.memory;
    make_depth(p, settings, chance);
    use_normals(p, settings, chance);
    make_outputs(p, settings, chance, kind);
    make_blur(p, kind, turn, chance);
}

/* In the order of vkao_ssao_method, and the second form of SPHERE. */
static const char *const method_names[] = {"sphere", "hemisphere", "hbao",           "gtao",
                                           "vbao",   "raymarch",   "sphere, literal"};
enum { METHODS = sizeof method_names / sizeof method_names[0] };

static void choose_method(struct picture *p, uint32_t method)
{
    const bool literal = method == METHODS - 1;
    p->ssao.method = literal ? VKAO_SSAO_SPHERE : (vkao_ssao_method)method;
    p->ssao.sphere_form = literal ? VKAO_SPHERE_LITERAL : VKAO_SPHERE_RESCALED;
    p->ssao.sample_count = 8;
    p->ssao.step_count = 4;
}

static bool has_bent_normals(uint32_t method)
{
    return method >= VKAO_SSAO_GTAO && method <= VKAO_SSAO_RAYMARCH;
}

/* Every edge, of the thin ones those in the set of bits; all have the same effect. Frees the
 * pictures. */
static void check_edges(struct picture pictures[COUNT(edges)], uint32_t thin, const char *what)
{
    char name[128];
    for (uint32_t e = 0; e < COUNT(edges); ++e) {
        snprintf(name, sizeof name, "%s, %s", what, edges[e].name);
        if (e >= THIN || thin >> e & 1)
            check_case(&pictures[e], name);
        picture_free(&pictures[e]);
    }
}

static void check_none_failed(void)
{
    const uint32_t wrong = failed;
    print_message("    %u cases, each with %d fills: %u wrong\n", cases, FILLS, wrong);
    cases = failed = 0;
    assert_int_equal(wrong, 0);
}

/* Which method has each of the thin images, of those with one turn: every kind of frame has all
 * of them, and every method one. */
static const uint32_t thin_methods[KINDS][THIN] = {
    [FULL] = {VKAO_SSAO_SPHERE, VKAO_SSAO_HBAO, VKAO_SSAO_VBAO},
    [HALF] = {VKAO_SSAO_HEMISPHERE, VKAO_SSAO_GTAO, VKAO_SSAO_RAYMARCH},
    [BENT] = {VKAO_SSAO_GTAO, VKAO_SSAO_RAYMARCH, VKAO_SSAO_GTAO},
    [HALF_BENT] = {VKAO_SSAO_VBAO, VKAO_SSAO_VBAO, VKAO_SSAO_VBAO},
    [NOISY] = {METHODS - 1, VKAO_SSAO_SPHERE, VKAO_SSAO_HBAO},
    [LIT] = {VKAO_SSAO_RAYMARCH, VKAO_SSAO_RAYMARCH, VKAO_SSAO_RAYMARCH},
};

static uint32_t thin_of(uint32_t method, uint32_t kind)
{
    uint32_t thin = 0;
    for (uint32_t e = 0; e < THIN; ++e)
        thin |= (uint32_t)(thin_methods[kind][e] == method) << e;
    return thin;
}

/* A method does not know what its AO lights: of LIT one for each turn will do. */
static bool is_of_kind(uint32_t method, uint32_t kind)
{
    if (kind == BENT || kind == HALF_BENT)
        return has_bent_normals(method);
    return kind != LIT || method >= VKAO_SSAO_RAYMARCH;
}

/* Every method with every kind of frame that is another to it, each of them with every edge, and
 * whatever else chance brings. What comes before and after the methods knows nothing of them: for
 * each kind of frame it is compiled in two ways, not in one for each method, which took most of the
 * time. */
static void methods_forget_what_memory_held(void **state)
{
    (void)state;
    scratch_open();
    for (uint32_t i = 0; i < METHODS * KINDS; ++i) {
        const uint32_t method = i % METHODS, kind = i / METHODS, turn = method % 2;
        struct picture pictures[COUNT(edges)];
        char what[96];
        if (!is_of_kind(method, kind))
            continue;
        for (uint32_t e = 0; e < COUNT(edges); ++e) {
            struct chance settings = chance_of(1000 + 2 * kind + turn),
                          chance = chance_of(2000 + COUNT(edges) * i + e);
            make(&pictures[e], &settings, &chance, &edges[e], (enum kind)kind, turn);
            choose_method(&pictures[e], method);
        }
        snprintf(what, sizeof what, "%u: %s, %s", i, method_names[method], kind_names[kind]);
        check_edges(pictures, thin_of(method, kind), what);
    }
    scratch_close();
    check_none_failed();
}

/* Each of the presets' effects with two pictures for every edge. */
static void presets_forget_what_memory_held(void **state)
{
    (void)state;
    scratch_open();
    for (uint32_t i = 0; i < 4 * 2; ++i) {
        struct picture pictures[COUNT(edges)];
        char what[96];
        for (uint32_t e = 0; e < COUNT(edges); ++e) {
            struct picture *p = &pictures[e];
            struct chance settings = chance_of(7000 + i % 4),
                          chance = chance_of(8000 + COUNT(edges) * i + e);
            make(p, &settings, &chance, &edges[e], FULL, 0);
            const float sharpness = p->blur.sharpness;
            picture_preset(p, (vkao_quality)(i % 4));
            p->blur.sharpness = e % 2 ? sharpness : p->blur.sharpness;
        }
        snprintf(what, sizeof what, "%u: preset %u", i, i % 4);
        check_edges(pictures, 1u << i % 4 % THIN, what);
    }
    scratch_close();
    check_none_failed();
}

/* Blurs that a CPU is offered in strips and tiles of their own. */
static const struct special {
    uint32_t radius;
    float normal_power;
    bool half, staged;
} specials[] = {
    {3, 0.0f, true, true}, {3, 0.0f, false, true}, {1, 8.0f, false, false}, {6, 0.0f, true, false}};

static void make_special(struct picture *p, struct chance *chance, const struct special *special,
                         const struct edge *edge)
{
    static const float sharpness[] = {0.0f, 1.0f, 200.0f};
    const struct scene scene = scene_fence();
    const struct lens lens = lens_perspective(0.8 * edge->width / edge->height, 0.8);
    picture_init(p, edge->width, edge->height, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->view.valid = edge->valid;
    p->view.rect = edge->rect;
    p->view.viewport = edge->viewport;
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, &scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    hostile_spread(chance, (enum hostile_pattern)chance_below(chance, HOSTILE_PATTERNS),
                   p->values[SLOT_DEPTH], p->width, p->height, 1);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    p->scratch_memory = scratch.memory;
    p->half_resolution = special->half;
    p->staged = special->staged;
    p->ssao.method = VKAO_SSAO_HBAO;
    p->ssao.step_count = 2;
    p->blur.radius = special->radius;
    p->blur.normal_power = special->normal_power;
    p->blur.sharpness = sharpness[chance_below(chance, COUNT(sharpness))];
}

static void blurs_forget_what_memory_held(void **state)
{
    (void)state;
    scratch_open();
    for (uint32_t i = 0; i < COUNT(specials) * 3; ++i) {
        struct picture pictures[COUNT(edges)];
        char what[96];
        for (uint32_t e = 0; e < COUNT(edges); ++e) {
            struct chance chance = chance_of(9000 + COUNT(edges) * i + e);
            make_special(&pictures[e], &chance, &specials[i % COUNT(specials)], &edges[e]);
        }
        snprintf(what, sizeof what, "%u: blur radius %u", i, pictures[0].blur.radius);
        check_edges(pictures, 1u << i % COUNT(specials) % THIN, what);
    }
    scratch_close();
    check_none_failed();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(methods_forget_what_memory_held),
        gpu_test(presets_forget_what_memory_held),
        gpu_test(blurs_forget_what_memory_held),
    };
    return fixture_run(tests);
}
