/* SPDX-License-Identifier: MIT
 *
 * Channels as renderers name them, and the traps among them. */
#include "roles.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

enum { MAX_PARTS = 8, MAX_CHANNELS = 64, NAME_BYTES = 64 };

/* A header made of words. */
struct sheet {
    struct exr_info info;
    struct exr_part parts[MAX_PARTS];
    struct exr_channel channels[MAX_PARTS][MAX_CHANNELS];
    char names[MAX_PARTS][MAX_CHANNELS][NAME_BYTES];
    char part_names[MAX_PARTS][NAME_BYTES], part_views[MAX_PARTS][NAME_BYTES];
    struct exr_attribute attribute;
    char attribute_name[NAME_BYTES];
    char *multi_view[2];
    char multi_view_names[2][NAME_BYTES];
};

static char path[] = "x.exr", flat[] = "scanlineimage";

static int compare_channels(const void *a, const void *b)
{
    const struct exr_channel *x = a, *y = b;
    return strcmp(x->name, y->name);
}

/* channels: names separated by '|', in any order; sorted, as files have them. */
static void add_part(struct sheet *sheet, const char *name, const char *view, const char *channels)
{
    size_t p = sheet->info.part_count++;
    struct exr_part *part = &sheet->parts[p];
    char words[1024];
    snprintf(sheet->part_names[p], NAME_BYTES, "%s", name);
    snprintf(sheet->part_views[p], NAME_BYTES, "%s", view);
    *part = (struct exr_part){.name = sheet->part_names[p],
                              .view = sheet->part_views[p],
                              .type = flat,
                              .channels = sheet->channels[p],
                              .pixel_aspect = 1.0f};
    snprintf(words, sizeof words, "%s", channels);
    for (char *word = strtok(words, "|"); word; word = strtok(NULL, "|")) {
        size_t c = part->channel_count++;
        snprintf(sheet->names[p][c], NAME_BYTES, "%s", word);
        sheet->channels[p][c] = (struct exr_channel){sheet->names[p][c], EXR_FLOAT, 1, 1};
    }
    qsort(part->channels, part->channel_count, sizeof *part->channels, compare_channels);
}

static struct sheet *new_sheet(void)
{
    struct sheet *sheet = calloc(1, sizeof *sheet);
    assert_non_null(sheet);
    sheet->info.path = path;
    sheet->info.parts = sheet->parts;
    return sheet;
}

static void set_multi_view(struct sheet *sheet, const char *first, const char *second)
{
    snprintf(sheet->multi_view_names[0], NAME_BYTES, "%s", first);
    snprintf(sheet->multi_view_names[1], NAME_BYTES, "%s", second);
    sheet->multi_view[0] = sheet->multi_view_names[0];
    sheet->multi_view[1] = sheet->multi_view_names[1];
    sheet->parts[0].multi_view = sheet->multi_view;
    sheet->parts[0].multi_view_count = 2;
}

static struct roles resolve(const struct sheet *sheet, const struct role_request *request)
{
    struct roles roles;
    struct tool_error err = {0};
    if (!roles_resolve(&sheet->info, request, &roles, &err))
        fail_msg("%s", err.message);
    return roles;
}

static struct tool_error refuse(const struct sheet *sheet, const struct role_request *request)
{
    struct roles roles;
    struct tool_error err = {0};
    assert_false(roles_resolve(&sheet->info, request, &roles, &err));
    return err;
}

/* In a single part: depth, normal and colour labels; NULL = none. */
static void expect_single(const char *channels, const char *depth, const char *normal,
                          const char *color)
{
    const char *const labels[] = {depth, normal, color};
    struct sheet *sheet = new_sheet();
    add_part(sheet, "", "", channels);
    const struct roles roles = resolve(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}});
    for (int k = ROLE_DEPTH; k <= ROLE_COLOR; k++) {
        assert_int_equal(roles.kind[k].found, labels[k] != NULL);
        if (labels[k])
            assert_string_equal(roles.kind[k].label, labels[k]);
    }
    free(sheet);
}

static void blender_layers_are_found(void **state)
{
    (void)state;
    expect_single("ViewLayer.Ambient Occlusion.B|ViewLayer.Ambient Occlusion.G|"
                  "ViewLayer.Ambient Occlusion.R|ViewLayer.Combined.A|ViewLayer.Combined.B|"
                  "ViewLayer.Combined.G|ViewLayer.Combined.R|ViewLayer.Denoising Depth.Z|"
                  "ViewLayer.Denoising Normal.X|ViewLayer.Denoising Normal.Y|"
                  "ViewLayer.Denoising Normal.Z|ViewLayer.Depth.Z|ViewLayer.Mist.Z|"
                  "ViewLayer.Normal.X|ViewLayer.Normal.Y|ViewLayer.Normal.Z|ViewLayer.Position.X|"
                  "ViewLayer.Position.Y|ViewLayer.Position.Z",
                  "ViewLayer.Depth.Z", "ViewLayer.Normal", "ViewLayer.Combined");
    expect_single("R|G|B|A|Z", "Z", NULL, "(no layer)");
}

static void blender_5_parts_are_found(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "ViewLayer.Combined", "",
             "ViewLayer.Combined.A|ViewLayer.Combined.B|ViewLayer.Combined.G|ViewLayer.Combined.R");
    add_part(sheet, "ViewLayer.Depth", "", "ViewLayer.Depth.Z");
    add_part(sheet, "ViewLayer.Normal", "",
             "ViewLayer.Normal.X|ViewLayer.Normal.Y|ViewLayer.Normal.Z");
    const struct roles roles = resolve(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}});
    assert_int_equal(roles.kind[ROLE_DEPTH].part, 1);
    assert_int_equal(roles.kind[ROLE_NORMAL].part, 2);
    assert_int_equal(roles.kind[ROLE_COLOR].part, 0);
    assert_string_equal(roles.kind[ROLE_DEPTH].label, "ViewLayer.Depth.Z");
    assert_non_null(roles.kind[ROLE_COLOR].channels[ROLE_MAX_COMPONENTS]);
    free(sheet);
}

static void other_renderers_are_found(void **state)
{
    (void)state;
    /* Mitsuba */
    expect_single("R|G|B|alb.R|alb.G|alb.B|dd.y.T|gn.X|gn.Y|gn.Z|nn.X|nn.Y|nn.Z|pos.X|pos.Y|pos.Z",
                  "dd.y.T", "nn", "(no layer)");
    /* Arnold */
    expect_single("R|G|B|A|Z|N.X|N.Y|N.Z|P.X|P.Y|P.Z|N_denoise.X|N_denoise.Y|N_denoise.Z", "Z", "N",
                  "(no layer)");
    expect_single("R|G|B|A|depth.Z|N.X|N.Y|N.Z", "depth.Z", "N", "(no layer)");
    /* V-Ray */
    expect_single("R|G|B|A|VRayZDepth.R|VRayNormals.X|VRayNormals.Y|VRayNormals.Z", "VRayZDepth.R",
                  "VRayNormals", "(no layer)");
    /* RenderMan */
    expect_single("R|G|B|A|Nn.x|Nn.y|Nn.z|__depth.r|__depth.g|__depth.b|Pworld.x|Pworld.y|Pworld.z",
                  "__depth.r", "Nn", "(no layer)");
    expect_single("R|G|B|A|Z|__Nworld.r|__Nworld.g|__Nworld.b", "Z", "__Nworld", "(no layer)");
    /* Redshift, Karma */
    expect_single("R|G|B|A|Z|N.R|N.G|N.B", "Z", "N", "(no layer)");
    expect_single("C.R|C.G|C.B|C.A|depth|N.x|N.y|N.z", "depth", "N", "C");
    expect_single("R|G|B|Pz", "Pz", NULL, "(no layer)");
    /* Unreal */
    expect_single(
        "FinalImageMovieRenderQueue_Beauty.R|FinalImageMovieRenderQueue_Beauty.G|"
        "FinalImageMovieRenderQueue_Beauty.B|FinalImageMovieRenderQueue_WorldDepth.R|"
        "FinalImageMovieRenderQueue_WorldDepth.G|FinalImageMovieRenderQueue_WorldDepth.B|"
        "FinalImageMovieRenderQueue_WorldNormal.R|FinalImageMovieRenderQueue_WorldNormal.G|"
        "FinalImageMovieRenderQueue_WorldNormal.B",
        "FinalImageMovieRenderQueue_WorldDepth.R", "FinalImageMovieRenderQueue_WorldNormal",
        "FinalImageMovieRenderQueue_Beauty");
    /* pbrt: shading normals before geometric ones */
    expect_single(
        "R|G|B|Albedo.R|Albedo.G|Albedo.B|P.X|P.Y|P.Z|N.X|N.Y|N.Z|Ns.X|Ns.Y|Ns.Z|dzdx|dzdy|u|v",
        "P", "Ns", "(no layer)");
}

static void depth_type_and_normal_space_come_with_the_name(void **state)
{
    static const struct {
        const char *channels;
        enum depth_type depth;
        enum normal_space space;
    } cases[] = {
        {"dd.y.T|nn.X|nn.Y|nn.Z", DEPTH_RADIAL_NEAR, NORMAL_SPACE_AUTO},
        {"Z|Nn.X|Nn.Y|Nn.Z", DEPTH_AUTO, NORMAL_SPACE_CAMERA},
        {"Z|VRayNormals.R|VRayNormals.G|VRayNormals.B", DEPTH_AUTO, NORMAL_SPACE_CAMERA},
        {"P.X|P.Y|P.Z|Ns.X|Ns.Y|Ns.Z|dzdx", DEPTH_POSITION, NORMAL_SPACE_CAMERA},
        {"Z|__Nworld.R|__Nworld.G|__Nworld.B", DEPTH_AUTO, NORMAL_SPACE_WORLD},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct sheet *sheet = new_sheet();
        add_part(sheet, "", "", cases[i].channels);
        const struct roles roles =
            resolve(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}});
        assert_int_equal(roles.kind[ROLE_DEPTH].depth_type, cases[i].depth);
        assert_int_equal(roles.kind[ROLE_NORMAL].normal_space, cases[i].space);
        free(sheet);
    }
}

static void vray_files_have_camera_space_normals(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "", "", "R|G|B|Z|normals.X|normals.Y|normals.Z");
    assert_int_equal(resolve(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}})
                         .kind[ROLE_NORMAL]
                         .normal_space,
                     NORMAL_SPACE_AUTO);
    snprintf(sheet->attribute_name, NAME_BYTES, "vrayInfo/vrayversion");
    sheet->attribute.name = sheet->attribute_name;
    sheet->parts[0].attributes = &sheet->attribute;
    sheet->parts[0].attribute_count = 1;
    assert_int_equal(resolve(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}})
                         .kind[ROLE_NORMAL]
                         .normal_space,
                     NORMAL_SPACE_CAMERA);
    free(sheet);
}

static void z_of_a_vector_is_never_depth(void **state)
{
    static const char *const traps[] = {"nn.X|nn.Y|nn.Z",
                                        "N.X|N.Y|N.Z|Pref.X|Pref.Y|Pref.Z",
                                        "depth.X|depth.Y|depth.Z",
                                        "X|Y|Z",
                                        "ViewLayer.Mist.Z",
                                        "R|G|B|ZBack",
                                        "crypto00.R|crypto00.G",
                                        "R|G|B|A",
                                        "Y|RY|BY"};
    (void)state;
    for (size_t i = 0; i < sizeof traps / sizeof *traps; i++) {
        struct sheet *sheet = new_sheet();
        add_part(sheet, "", "", traps[i]);
        const struct tool_error err =
            refuse(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}});
        assert_int_equal(err.code, EXIT_CHANNELS);
        assert_non_null(strstr(err.message, "no depth channel found; channels: "));
        free(sheet);
    }
}

static void positions_stand_in_for_depth(void **state)
{
    const char *const P = "P";
    (void)state;
    expect_single("N.X|N.Y|N.Z|P.X|P.Y|P.Z", "P", "N", NULL);
    for (int named = 0; named < 2; named++) {
        struct sheet *sheet = new_sheet();
        add_part(sheet, "", "", named ? "Z|P.X|P.Y|P.Z" : "P.X|P.Y|P.Z");
        const struct roles roles =
            resolve(sheet, &(struct role_request){{named ? P : NULL}, NULL, false, {NULL}});
        assert_int_equal(roles.kind[ROLE_DEPTH].depth_type, DEPTH_POSITION);
        assert_int_equal(roles.kind[ROLE_DEPTH].channel_count, 3);
        free(sheet);
    }
}

static void missing_depth_lists_the_channels_with_their_parts(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "beauty", "", "R|G|B|A");
    add_part(sheet, "normals", "", "N.X|N.Y|N.Z");
    const struct tool_error err =
        refuse(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}});
    assert_string_equal(err.message,
                        "x.exr: no depth channel found; channels: A B G R (part \"beauty\"); N.X "
                        "N.Y N.Z (part \"normals\")");
    free(sheet);
}

static void two_view_layers_are_ambiguous_and_named(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(
        sheet, "", "",
        "A.Depth.Z|A.Normal.X|A.Normal.Y|A.Normal.Z|B.Depth.Z|B.Normal.X|B.Normal.Y|B.Normal.Z");
    const struct tool_error err =
        refuse(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}});
    assert_int_equal(err.code, EXIT_CHANNELS);
    assert_string_equal(err.message, "x.exr: 2 depth candidates: 'A.Depth.Z', 'B.Depth.Z'");
    assert_string_equal(err.hint, "add --depth 'A.Depth.Z' or --depth 'B.Depth.Z'");
    const struct roles roles =
        resolve(sheet, &(struct role_request){{"B.Depth.Z"}, NULL, false, {NULL}});
    assert_string_equal(roles.kind[ROLE_NORMAL].label, "B.Normal");
    free(sheet);
}

static void two_mitsuba_depths_are_ambiguous(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "", "", "a.T|b.T");
    assert_int_equal(refuse(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}}).code,
                     EXIT_CHANNELS);
    free(sheet);
}

static void equal_names_in_two_parts_are_told_apart_by_part(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "one", "", "R|G|B|Z");
    add_part(sheet, "two", "", "R|G|B|Z");
    const struct tool_error err =
        refuse(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}});
    assert_string_equal(err.hint, "add --depth 'one/Z' or --depth 'two/Z'");
    const struct roles roles =
        resolve(sheet, &(struct role_request){{"two/Z"}, NULL, false, {NULL}});
    assert_int_equal(roles.kind[ROLE_DEPTH].part, 1);
    assert_int_equal(roles.kind[ROLE_COLOR].part, 1);
    free(sheet);
}

static void parts_named_for_a_pass_hold_it(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "albedo", "", "R|G|B");
    add_part(sheet, "N", "", "R|G|B");
    add_part(sheet, "C", "", "R|G|B|A");
    add_part(sheet, "depth", "", "Y");
    const struct roles roles = resolve(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}});
    assert_int_equal(roles.kind[ROLE_DEPTH].part, 3);
    assert_int_equal(roles.kind[ROLE_NORMAL].part, 1);
    assert_int_equal(roles.kind[ROLE_COLOR].part, 2);
    free(sheet);
}

static void requests_take_channels_layers_and_parts(void **state)
{
    static const char *const names[] = {"beauty/G", "G", "beauty/Z", "pass", "my.pass", "p2"};
    static const char *const channels[] = {"G", "G", "Z", "my.pass.R", "my.pass.R", "depthish"};
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "beauty", "", "R|G|B|Z");
    add_part(sheet, "pass", "", "my.pass.R");
    add_part(sheet, "p2", "", "depthish");
    for (size_t i = 0; i < 5; i++) {
        const struct roles roles =
            resolve(sheet, &(struct role_request){{names[i]}, NULL, false, {NULL}});
        assert_string_equal(roles.kind[ROLE_DEPTH].channels[0]->name, channels[i]);
    }
    const struct tool_error err =
        refuse(sheet, &(struct role_request){{"beauty/Q"}, NULL, false, {NULL}});
    assert_int_equal(err.code, EXIT_CHANNELS);
    assert_non_null(strstr(err.message, "no channel or layer 'beauty/Q'; channels: B G R Z"));
    free(sheet);
}

/* Nuke writes the view in front, and leaves the default one out. */
static void views_may_come_first(void **state)
{
    static char *views[] = {"right", "left"};
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "", "", "N.X|N.Y|N.Z|depth.Z|left.N.X|left.N.Y|left.N.Z|left.depth.Z");
    sheet->info.parts[0].multi_view = views;
    sheet->info.parts[0].multi_view_count = 2;
    const struct roles right =
        resolve(sheet, &(struct role_request){{NULL}, "right", false, {NULL}});
    const struct roles left = resolve(sheet, &(struct role_request){{NULL}, "left", false, {NULL}});
    assert_string_equal(right.kind[ROLE_DEPTH].channels[0]->name, "depth.Z");
    assert_string_equal(right.kind[ROLE_NORMAL].channels[2]->name, "N.Z");
    assert_string_equal(left.kind[ROLE_DEPTH].channels[0]->name, "left.depth.Z");
    assert_string_equal(left.kind[ROLE_NORMAL].channels[0]->name, "left.N.X");
    assert_string_equal(left.kind[ROLE_NORMAL].channels[2]->name, "left.N.Z");
    const struct roles named =
        resolve(sheet, &(struct role_request){{"left.depth.Z"}, "right", false, {NULL}});
    assert_string_equal(named.kind[ROLE_DEPTH].channels[0]->name, "left.depth.Z");
    assert_true(named.kind[ROLE_DEPTH].of_another_view);
    const struct roles short_name =
        resolve(sheet, &(struct role_request){{"depth.Z"}, "left", false, {NULL}});
    assert_string_equal(short_name.kind[ROLE_DEPTH].channels[0]->name, "left.depth.Z");
    free(sheet);
}

/* What vkao appends has no view of its own where channels name the views. */
static void parts_may_follow_one_of_all_views(void **state)
{
    static char *views[] = {"left", "right"};
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "", "", "R|G|B|Z|beauty.R|beauty.G|beauty.B|right.Z");
    add_part(sheet, "ao.left", "", "AO");
    add_part(sheet, "ao.right", "", "AO");
    sheet->info.parts[0].multi_view = views;
    sheet->info.parts[0].multi_view_count = 2;
    assert_int_equal(roles_view_count(&sheet->info), 2);
    assert_string_equal(roles_view_name(&sheet->info, 1), "right");
    const struct roles right =
        resolve(sheet, &(struct role_request){{NULL}, "right", false, {NULL}});
    const struct roles left = resolve(sheet, &(struct role_request){{NULL}, "left", false, {NULL}});
    assert_string_equal(right.kind[ROLE_DEPTH].channels[0]->name, "right.Z");
    assert_string_equal(left.kind[ROLE_DEPTH].channels[0]->name, "Z");
    /* As in the file that was only this part. */
    assert_string_equal(left.kind[ROLE_COLOR].channels[0]->name, "R");
    free(sheet);
}

static void views_of_parts_are_kept_apart(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "rgba_right", "right", "R|G|B|A");
    add_part(sheet, "depth_left", "left", "Z");
    add_part(sheet, "rgba_left", "left", "R|G|B|A");
    add_part(sheet, "depth_right", "right", "Z");
    add_part(sheet, "mask_left", "left", "mask.a");
    assert_int_equal(roles_view_count(&sheet->info), 2);
    assert_string_equal(roles_view_name(&sheet->info, 0), "right");
    const struct roles left = resolve(sheet, &(struct role_request){{NULL}, "left", false, {NULL}});
    const struct roles right =
        resolve(sheet, &(struct role_request){{NULL}, "right", false, {NULL}});
    assert_int_equal(left.kind[ROLE_DEPTH].part, 1);
    assert_int_equal(left.kind[ROLE_COLOR].part, 2);
    assert_int_equal(right.kind[ROLE_DEPTH].part, 3);
    assert_int_equal(right.kind[ROLE_COLOR].part, 0);
    assert_int_equal(
        refuse(sheet, &(struct role_request){{"depth_left/Z"}, "right", false, {NULL}}).code,
        EXIT_CHANNELS);
    free(sheet);
}

static void views_in_channel_names_follow_both_customs(void **state)
{
    struct sheet *blender = new_sheet(), *openexr = new_sheet();
    (void)state;
    add_part(blender, "", "",
             "VL.Depth.left.Z|VL.Depth.right.Z|VL.Normal.left.X|VL.Normal.left.Y|"
             "VL.Normal.left.Z|VL.Normal.right.X|VL.Normal.right.Y|VL.Normal.right.Z");
    set_multi_view(blender, "left", "right");
    const struct roles right =
        resolve(blender, &(struct role_request){{NULL}, "right", false, {NULL}});
    assert_string_equal(right.kind[ROLE_DEPTH].channels[0]->name, "VL.Depth.right.Z");
    assert_string_equal(right.kind[ROLE_NORMAL].channels[2]->name, "VL.Normal.right.Z");
    add_part(openexr, "", "", "R|G|B|Z|left.R|left.G|left.B|left.Z");
    set_multi_view(openexr, "right", "left");
    const struct roles first =
        resolve(openexr, &(struct role_request){{NULL}, "right", false, {NULL}});
    const struct roles second =
        resolve(openexr, &(struct role_request){{NULL}, "left", false, {NULL}});
    assert_string_equal(first.kind[ROLE_DEPTH].channels[0]->name, "Z");
    assert_string_equal(second.kind[ROLE_DEPTH].channels[0]->name, "left.Z");
    assert_string_equal(second.kind[ROLE_COLOR].channels[1]->name, "left.G");
    free(blender);
    free(openexr);
}

static void deep_data_is_refused_as_such(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "", "", "A|Z|ZBack");
    sheet->parts[0].deep = true;
    const struct tool_error err =
        refuse(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}});
    assert_int_equal(err.code, EXIT_INPUT);
    assert_non_null(strstr(err.message, "deep data is not supported"));
    free(sheet);
}

static void no_normals_means_none(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "", "", "Z|N.X|N.Y|N.Z");
    assert_false(
        resolve(sheet, &(struct role_request){{NULL}, NULL, true, {NULL}}).kind[ROLE_NORMAL].found);
    free(sheet);
}

static void existing_ao_is_reported(void **state)
{
    struct sheet *sheet = new_sheet();
    (void)state;
    add_part(sheet, "", "", "Z|AO.R|AO.G|AO.B");
    assert_string_equal(
        resolve(sheet, &(struct role_request){{NULL}, NULL, false, {NULL}}).kind[ROLE_AO].label,
        "AO.R");
    free(sheet);
}

#define TEST(name) cmocka_unit_test(name)

/* A file of 800 kB can have as many; comparing each with each took two minutes. */
static void thousands_of_layers_take_no_time(void **state)
{
    enum { LAYERS = 10000, CHANNELS = 3 * LAYERS };
    struct exr_channel *channels = calloc(CHANNELS, sizeof *channels);
    char(*names)[16] = calloc(CHANNELS, sizeof *names);
    struct roles roles;
    struct tool_error err = {0};
    (void)state;
    assert_non_null(channels);
    assert_non_null(names);
    for (int i = 0; i < CHANNELS; i++) {
        snprintf(names[i], sizeof *names, "L%05d.%c", i / 3, "XYZ"[i % 3]);
        channels[i] = (struct exr_channel){names[i], EXR_FLOAT, 1, 1};
    }
    struct exr_part part = {
        .channels = channels, .channel_count = CHANNELS, .type = flat, .pixel_aspect = 1.0f};
    const struct exr_info info = {.path = path, .parts = &part, .part_count = 1};
    const struct role_request request = {.name = {"L00000.Z"}};
    const clock_t begin = clock();
    assert_true(roles_resolve(&info, &request, &roles, &err));
    assert_true(clock() - begin < 5 * CLOCKS_PER_SEC);
    free(channels);
    free(names);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(blender_layers_are_found),
        TEST(blender_5_parts_are_found),
        TEST(other_renderers_are_found),
        TEST(depth_type_and_normal_space_come_with_the_name),
        TEST(vray_files_have_camera_space_normals),
        TEST(z_of_a_vector_is_never_depth),
        TEST(positions_stand_in_for_depth),
        TEST(missing_depth_lists_the_channels_with_their_parts),
        TEST(two_view_layers_are_ambiguous_and_named),
        TEST(two_mitsuba_depths_are_ambiguous),
        TEST(equal_names_in_two_parts_are_told_apart_by_part),
        TEST(parts_named_for_a_pass_hold_it),
        TEST(requests_take_channels_layers_and_parts),
        TEST(views_may_come_first),
        TEST(parts_may_follow_one_of_all_views),
        TEST(views_of_parts_are_kept_apart),
        TEST(views_in_channel_names_follow_both_customs),
        TEST(deep_data_is_refused_as_such),
        TEST(no_normals_means_none),
        TEST(existing_ao_is_reported),
        TEST(thousands_of_layers_take_no_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
