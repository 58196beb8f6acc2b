/* SPDX-License-Identifier: MIT
 *
 * The record in EXR files: it holds every parameter, reads back to the bit, and is believed
 * nothing. */
#include "record.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint32_t state = 1;

static double uniform(void)
{
    state = state * 1664525u + 1013904223u;
    return (state >> 8) / 16777216.0;
}

static bool is_one_of(const char *name, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(name, names[i]) == 0)
            return true;
    return false;
}

/* Anything that the table allows and options can ask for, floats with all of their digits. */
static struct setting any_setting(void)
{
    static const char *const fixed[] = {"depth_bits",   "noisy_ao", "composite_mode",
                                        "multi_bounce", "specular", "debug_distance"};
    struct setting s = setting_default();
    uint32_t count;
    const vkao_parameter *all = vkao_parameters(&count);
    for (uint32_t i = 0; i < count; i++) {
        const vkao_parameter *p = &all[i];
        if (is_one_of(p->name, fixed, sizeof fixed / sizeof *fixed))
            continue;
        const double most = fmin(p->most, 1e6), value = p->least + (most - p->least) * uniform();
        float numbers[3] = {(float)value, (float)uniform(), (float)uniform()};
        uint32_t word = (uint32_t)(value + 0.5);
        const bool is_number = p->type == VKAO_PARAMETER_FLOAT || p->type == VKAO_PARAMETER_COLOR;
        memcpy(parameter_of(&s, p), is_number ? (const void *)numbers : &word, parameter_bytes(p));
    }
    s.effect.bent_normals = s.effect.bent_normals && method_has_bent(s.effect.method);
    if (s.effect.method != VKAO_SSAO_VBAO && s.effect.method != VKAO_SSAO_RAYMARCH) {
        s.effect.thickness_input = VKAO_THICKNESS_AS_SEEN;
        s.effect.second_layer = VK_FALSE;
    }
    return s;
}

static struct gbuffer any_gbuffer(void)
{
    struct gbuffer g = {.depth_type = (enum depth_type)(1 + (int)(uniform() * 5))};
    g.normal_space = (enum normal_space)(int)(uniform() * 3);
    g.normal_encoding = (enum normal_encoding)(1 + (int)(uniform() * 2));
    snprintf(g.roles.kind[ROLE_DEPTH].label, ROLE_LABEL_MAX, "part \"1\"/left.Z");
    snprintf(g.roles.kind[ROLE_NORMAL].label, ROLE_LABEL_MAX, "N\xc3\xa4");
    snprintf(g.roles.kind[ROLE_COLOR].label, ROLE_LABEL_MAX, "beauty");
    snprintf(g.roles.kind[ROLE_THICKNESS].label, ROLE_LABEL_MAX, "thickness.T");
    snprintf(g.roles.kind[ROLE_BACK_DEPTH].label, ROLE_LABEL_MAX, "back/Z");
    snprintf(g.roles.kind[ROLE_LAYER2].label, ROLE_LABEL_MAX, "second.Z");
    g.camera.type = uniform() < 0.5 ? CAMERA_PERSPECTIVE : CAMERA_ORTHOGRAPHIC;
    g.camera.half_width = exp(uniform() * 20 - 10);
    g.camera.half_height = exp(uniform() * 20 - 10);
    g.camera.shift_x = uniform() - 0.5;
    g.camera.shift_y = uniform() - 0.5;
    g.camera.near_plane = uniform() < 0.3 ? 0 : uniform() < 0.3 ? INFINITY : uniform() + 1e-9;
    g.camera.far_plane = uniform() < 0.3 ? 0 : uniform() * 1e9 + 1;
    g.camera.has_rotation = uniform() < 0.5;
    g.camera.axis_certain = g.camera.has_rotation && uniform() < 0.5;
    for (int i = 0; g.camera.has_rotation && i < 9; i++)
        g.camera.world_to_view[i] = uniform() * 2 - 1;
    snprintf(g.camera.source, sizeof g.camera.source, "%s", uniform() < 0.5 ? "" : "--fov");
    g.camera.is_assumed = !g.camera.source[0];
    if (g.camera.has_rotation)
        snprintf(g.camera.rotation_source, sizeof g.camera.rotation_source, "camera file");
    return g;
}

static void every_parameter_of_the_table_is_in_it(void **unused)
{
    const struct setting s = setting_default();
    const struct gbuffer g = any_gbuffer();
    const struct options o = {.compression = "zip", .pixel_type = EXR_HALF};
    uint32_t count;
    const vkao_parameter *all = vkao_parameters(&count);
    (void)unused;
    char *json = record_write(&o, &s, "", &g, "device");
    cJSON *root = cJSON_Parse(json);
    const cJSON *parameters = cJSON_GetObjectItemCaseSensitive(root, "parameters");
    for (uint32_t i = 0; i < count; i++)
        if (!cJSON_GetObjectItemCaseSensitive(parameters, all[i].name))
            fail_msg("%s is not in %s", all[i].name, json);
    assert_int_equal(cJSON_GetArraySize(parameters), (int)count);
    cJSON_Delete(root);
    free(json);
}

static void record_reads_back_to_the_bit(void **unused)
{
    (void)unused;
    for (int round = 0; round < 3000; round++) {
        const struct setting s = any_setting();
        const struct gbuffer g = any_gbuffer();
        const struct options o = {.compression = round % 2 ? "zip" : "dwab",
                                  .mode = (enum output_mode)(round % 3),
                                  .pixel_type = round % 2 ? EXR_HALF : EXR_FLOAT};
        struct record r;
        struct tool_error err = {0};
        char *json = record_write(&o, &s, "left", &g, "some device");
        if (!record_parse(json, "a.exr", &r, &err))
            fail_msg("%s\n%s", err.message, json);
        assert_memory_equal(&r.setting, &s, sizeof s);
        assert_memory_equal(&r.camera, &g.camera, sizeof g.camera);
        assert_string_equal(r.view, "left");
        assert_string_equal(r.device, "some device");
        assert_string_equal(r.depth, g.roles.kind[ROLE_DEPTH].label);
        assert_int_equal(r.depth_type, g.depth_type);
        assert_int_equal(r.mode, o.mode);
        assert_int_equal(r.pixel_type, o.pixel_type);
        assert_string_equal(r.compression, o.compression);
        if (g.normal_space == NORMAL_SPACE_AUTO) {
            assert_null(r.normal);
        } else {
            assert_string_equal(r.normal, g.roles.kind[ROLE_NORMAL].label);
            assert_int_equal(r.normal_space, g.normal_space);
            assert_int_equal(r.normal_encoding, g.normal_encoding);
        }
        assert_int_equal(r.color != NULL, o.mode == OUTPUT_COMP);
        if (s.effect.thickness_input)
            assert_string_equal(r.thickness, s.effect.thickness_input == VKAO_THICKNESS_GIVEN
                                                 ? "thickness.T"
                                                 : "back/Z");
        assert_int_equal(r.thickness != NULL, s.effect.thickness_input != VKAO_THICKNESS_AS_SEEN);
        assert_int_equal(r.second_depth != NULL, s.effect.second_layer);
        record_free(&r);
        free(json);
    }
}

/* A good record in which one text is another. */
static void refuse(const char *from, const char *to, const char *message)
{
    const struct setting s = setting_default();
    struct gbuffer g = {.depth_type = DEPTH_PLANAR,
                        .normal_space = NORMAL_SPACE_WORLD,
                        .normal_encoding = NORMAL_ENCODING_SIGNED,
                        .camera = {.type = CAMERA_PERSPECTIVE,
                                   .half_width = 0.5,
                                   .half_height = 0.25,
                                   .near_plane = 0.5,
                                   .has_rotation = true,
                                   .world_to_view = {1, 0, 0, 0, 1, 0, 0, 0, 1}}};
    const struct options o = {.compression = "zip", .pixel_type = EXR_HALF};
    struct record r;
    struct tool_error err = {0};
    struct text changed = {0};
    char *json = record_write(&o, &s, "", &g, "device"), *at = strstr(json, from);
    if (!at)
        fail_msg("%s is not in %s", from, json);
    text_add(&changed, "%.*s%s%s", (int)(at - json), json, to, at + strlen(from));
    assert_false(record_parse(changed.data, "a.exr", &r, &err));
    assert_int_equal(err.code, EXIT_INPUT);
    assert_string_equal(err.message, message);
    assert_true(err.hint[0]);
    text_free(&changed);
    free(json);
}

static void damaged_values_are_named_with_file_field_and_range(void **unused)
{
    (void)unused;
    refuse(
        "\"radius\":0.5", "\"radius\":-1",
        "a.exr: vkao/params: 'parameters.radius' is -1, want a number > 0 and <= 3.402823466e+38");
    refuse("\"radius\":0.5", "\"radius\":1e300",
           "a.exr: vkao/params: 'parameters.radius' is 1e+300, want a number > 0 and <= "
           "3.402823466e+38");
    refuse("\"radius\":0.5", "\"radius\":1e-300",
           "a.exr: vkao/params: 'parameters.radius' is 1e-300, want a number > 0 and <= "
           "3.402823466e+38");
    refuse("\"radius\":0.5", "\"radius\":null",
           "a.exr: vkao/params: 'parameters.radius' is something else, want a number > 0 and <= "
           "3.402823466e+38");
    refuse("\"radius\":0.5,", "",
           "a.exr: vkao/params: 'parameters.radius' is missing, want a number > 0 and <= "
           "3.402823466e+38");
    refuse(
        "\"step_count\":9", "\"step_count\":8.5",
        "a.exr: vkao/params: 'parameters.step_count' is 8.5, want a whole number >= 0 and <= 256");
    refuse(
        "\"step_count\":9", "\"step_count\":257",
        "a.exr: vkao/params: 'parameters.step_count' is 257, want a whole number >= 0 and <= 256");
    refuse("\"smooth\"", "\"soft\"",
           "a.exr: vkao/params: 'parameters.falloff' is 'soft', want smooth or threshold");
    refuse("\"half_resolution\":false", "\"half_resolution\":2",
           "a.exr: vkao/params: 'parameters.half_resolution' is 2, want true or false");
    refuse("\"tint\":[0,0,0]", "\"tint\":[0,0]",
           "a.exr: vkao/params: 'parameters.tint' is something else, want a list of 3 numbers");
    refuse("\"tint\":[0,0,0]", "\"tint\":[0,2,0]",
           "a.exr: vkao/params: 'parameters.tint' is 2, want a number >= 0 and <= 1");
    refuse("\"half_width\":0.5", "\"half_width\":0",
           "a.exr: vkao/params: 'camera.half_width' is 0, want a number > 0 and < inf");
    refuse(
        "[1,0,0]", "[1,0]",
        "a.exr: vkao/params: 'camera.world_to_view' is something else, want 3 lists of 3 numbers "
        "from -1 to 1");
    refuse(
        "[1,0,0]", "[1,0,7]",
        "a.exr: vkao/params: 'camera.world_to_view' is 7, want 3 lists of 3 numbers from -1 to 1");
    refuse("\"near\":0.5", "\"near\":-0.5",
           "a.exr: vkao/params: 'camera.near' is -0.5, want a number > 0 and < inf");
    refuse("\"depth\":\"\"", "\"depth\":7", "a.exr: vkao/params: 'depth' is 7, want a string");
    refuse("\"zip\"", "\"7z\"",
           "a.exr: vkao/params: 'compression' is '7z', want none, rle, zips, zip, piz, pxr24, b44, "
           "b44a, dwaa or dwab");
    refuse("\"noisy_ao\":false", "\"noisy_ao\":true",
           "a.exr: vkao/params: 'parameters.noisy_ao' is true, want 0");
    refuse("\"composite_mode\":\"multiply\"", "\"composite_mode\":\"view-z\"",
           "a.exr: vkao/params: 'parameters.composite_mode' is 'view-z', want multiply");
    refuse("\"depth_bits\":0", "\"depth_bits\":17",
           "a.exr: vkao/params: 'parameters.depth_bits' is 17, want 0");
    refuse("\"thickness_input\":\"as-seen\"", "\"thickness_input\":\"given\"",
           "a.exr: vkao/params: 'thickness_channel' is missing, want a string");
    refuse("\"second_layer\":false", "\"second_layer\":true",
           "a.exr: vkao/params: 'layer2' is missing, want a string");
    refuse("\"parameters\":{", "\"parameters\":7,\"x\":{",
           "a.exr: vkao/params: 'parameters' is 7, want an object { ... }");
}

static void bent_normals_and_thickness_need_their_method(void **unused)
{
    (void)unused;
    struct setting s = setting_default();
    const struct gbuffer g = any_gbuffer();
    const struct options o = {.compression = "zip", .pixel_type = EXR_HALF};
    struct record r;
    struct tool_error err = {0};
    s.effect.bent_normals = VK_TRUE;
    s.effect.method = VKAO_SSAO_HBAO;
    char *json = record_write(&o, &s, "", &g, "device");
    assert_false(record_parse(json, "a.exr", &r, &err));
    assert_string_equal(err.message, "a.exr: vkao/params: 'parameters.bent_normals' is true, want "
                                     "false with this method");
    free(json);
    s.effect.bent_normals = VK_FALSE;
    s.effect.thickness_input = VKAO_THICKNESS_GIVEN;
    err = (struct tool_error){0};
    json = record_write(&o, &s, "", &g, "device");
    assert_false(record_parse(json, "a.exr", &r, &err));
    assert_string_equal(err.message, "a.exr: vkao/params: 'parameters.thickness_input' is 'given', "
                                     "want as-seen with this method");
    free(json);
}

static void other_versions_are_refused(void **unused)
{
    (void)unused;
    refuse("\"record\":1", "\"record\":2", "a.exr: vkao/params: 'record' is 2, want 1");
    refuse("\"record\":1,", "", "a.exr: vkao/params: 'record' is missing, want 1");
}

static void what_is_no_record_is_refused(void **unused)
{
    static const char *const texts[] = {"",   "{",    "[]",     "7",          "\"x\"",
                                        "{}", "null", "{\"a\"", "{} trailing"};
    (void)unused;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct record r;
        struct tool_error err = {0};
        assert_false(record_parse(texts[i], "a.exr", &r, &err));
        assert_int_equal(err.code, EXIT_INPUT);
        assert_true(strncmp(err.message, "a.exr: vkao/params: ", 20) == 0);
        assert_true(err.hint[0]);
    }
    /* Deep nesting, and more than any record has. */
    char *deep = calloc(1 << 17, 1);
    memset(deep, '[', (1 << 17) - 1);
    for (int length = 1 << 16; length > 0; length -= 1 << 15) {
        struct record r;
        struct tool_error err = {0};
        deep[length] = '\0';
        assert_false(record_parse(deep, "a.exr", &r, &err));
        assert_int_equal(err.code, EXIT_INPUT);
    }
    free(deep);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_parameter_of_the_table_is_in_it),
        cmocka_unit_test(record_reads_back_to_the_bit),
        cmocka_unit_test(damaged_values_are_named_with_file_field_and_range),
        cmocka_unit_test(bent_normals_and_thickness_need_their_method),
        cmocka_unit_test(other_versions_are_refused),
        cmocka_unit_test(what_is_no_record_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
