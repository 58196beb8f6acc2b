/* SPDX-License-Identifier: MIT
 *
 * The command line: what is understood, what is refused and in which words. */
#include "options.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MAX_WORDS = 32 };

/* Words separated by blanks, behind 'vkao'. Options point into the buffer, so it stays. */
static bool parse(const char *line, struct options *options, struct tool_error *err)
{
    static char buffer[1024];
    char *argv[MAX_WORDS + 1] = {NULL};
    static char program[] = "vkao";
    int argc = 0;
    argv[argc++] = program;
    snprintf(buffer, sizeof buffer, "%s", line);
    for (char *word = strtok(buffer, " "); word && argc < MAX_WORDS; word = strtok(NULL, " "))
        argv[argc++] = word;
    *err = (struct tool_error){0};
    return options_parse(argc, argv, options, err);
}

static struct options accept(const char *line)
{
    struct options options;
    struct tool_error err;
    if (!parse(line, &options, &err))
        fail_msg("'%s': %s", line, err.message);
    return options;
}

static void refuse(const char *line, const char *message)
{
    struct options options;
    struct tool_error err;
    assert_false(parse(line, &options, &err));
    assert_int_equal(err.code, EXIT_USAGE);
    assert_string_equal(err.message, message);
}

static void defaults_are_those_of_the_library(void **state)
{
    const struct options o = accept("in.exr -o out.exr");
    const struct setting standard = setting_default();
    (void)state;
    assert_memory_equal(&o.setting, &standard, sizeof standard);
    assert_true(o.radius_is_auto);
    assert_false(o.bias_is_given);
    assert_int_equal(o.mode, OUTPUT_AO);
    assert_int_equal(o.pixel_type, EXR_HALF);
    assert_string_equal(o.compression, "zip");
    assert_int_equal(o.overwrite, OVERWRITE_NEVER);
}

static void every_option_reaches_its_member(void **state)
{
    const struct options o =
        accept("render in.exr -o out.exr -m sphere --sphere-form literal -r 2.5 --falloff "
               "threshold -s 33 -i 2 "
               "-p 0.5 --bias 0.1 --blur off --blur-sharpness 7 --mode append --pixel-type float");
    (void)state;
    assert_string_equal(o.input, "in.exr");
    assert_string_equal(o.output, "out.exr");
    const vkao_effect_info *e = &o.setting.effect;
    const vkao_params *p = &o.setting.params;
    assert_int_equal(e->method, VKAO_SSAO_SPHERE);
    assert_int_equal(e->sphere_form, VKAO_SPHERE_LITERAL);
    assert_true(p->radius == 2.5f && !o.radius_is_auto);
    assert_int_equal(e->falloff, VKAO_FALLOFF_THRESHOLD);
    assert_int_equal(e->sample_count, 33);
    assert_true(p->intensity == 2.0f && p->power == 0.5f && p->sharpness == 7.0f);
    assert_true(o.bias_is_given);
    assert_int_equal(e->blur_radius, 0);
    assert_int_equal(o.mode, OUTPUT_APPEND);
    assert_int_equal(o.pixel_type, EXR_FLOAT);
}

/* What has no option of its own: images decide it, --quality, --mode, options that name channels,
 * or the tools have no such image. */
static void every_parameter_has_an_option_but_these(void **state)
{
    static const char *const others[] = {"half_resolution", "depth_bits",      "noisy_ao",
                                         "composite_mode",  "multi_bounce",    "specular",
                                         "debug_distance",  "thickness_input", "second_layer"};
    uint32_t count;
    const vkao_parameter *all = vkao_parameters(&count);
    (void)state;
    for (uint32_t i = 0; i < count; i++) {
        bool is_known = parameter_is_of_images(&all[i]);
        for (size_t k = 0; k < sizeof others / sizeof *others; k++)
            is_known = is_known || strcmp(all[i].name, others[k]) == 0;
        if (is_known == (option_of_parameter(&all[i]) != NULL))
            fail_msg("%s %s an option", all[i].name, is_known ? "has" : "lacks");
    }
}

/* Both ends of what the table allows are taken, and reach the member to the bit. */
static void ranges_are_those_of_the_table(void **state)
{
    (void)state;
    for (size_t i = 0; i < option_table_count; i++) {
        const vkao_parameter *p = option_parameter(&option_table[i]);
        if (!p || (p->type != VKAO_PARAMETER_UINT && p->type != VKAO_PARAMETER_FLOAT))
            continue;
        char line[128];
        struct options o;
        struct tool_error err;
        snprintf(line, sizeof line, "i.exr -o o.exr --%s %.10g", option_table[i].name, p->most);
        o = accept(line);
        const void *at = parameter_of_const(&o.setting, p);
        const double most = p->type == VKAO_PARAMETER_UINT ? (double)*(const uint32_t *)at
                                                           : (double)*(const float *)at;
        assert_true(most == p->most);
        snprintf(line, sizeof line, "i.exr -o o.exr --%s %.9g", option_table[i].name,
                 p->most * 1.001 + 1);
        assert_false(parse(line, &o, &err));
        snprintf(line, sizeof line, "i.exr -o o.exr --%s 0", option_table[i].name);
        assert_int_equal(parse(line, &o, &err), !p->above_least && !p->zero_is_standard);
    }
}

static void presets_fill_what_is_left(void **state)
{
    struct setting best = setting_default();
    (void)state;
    setting_apply_preset(&best, VKAO_QUALITY_BEST);
    struct options o = accept("i.exr -o o.exr --quality best");
    assert_memory_equal(&o.setting, &best, sizeof best);
    o = accept("i.exr -o o.exr --steps 5 --quality best --blur 2 --blur auto -m gtao");
    best.effect.step_count = 5;
    best.effect.method = VKAO_SSAO_GTAO;
    assert_memory_equal(&o.setting, &best, sizeof best);
}

static void bent_normals_need_a_method_that_has_them(void **state)
{
    (void)state;
    accept("i.exr -o o.exr --bent-normals -m gtao");
    refuse("i.exr -o o.exr --bent-normals -m hbao",
           "--bent-normals needs --method gtao, vbao or raymarch");
}

static void thickness_and_layers_decide_what_is_compiled(void **state)
{
    (void)state;
    struct options o = accept("i.exr -o o.exr --thickness-channel T --layer2 Z2");
    assert_int_equal(o.setting.effect.thickness_input, VKAO_THICKNESS_GIVEN);
    assert_true(o.setting.effect.second_layer);
    assert_string_equal(o.gbuffer.roles.name[ROLE_THICKNESS], "T");
    assert_string_equal(o.gbuffer.roles.name[ROLE_LAYER2], "Z2");
    o = accept("i.exr -o o.exr --back-depth B -m raymarch");
    assert_int_equal(o.setting.effect.thickness_input, VKAO_THICKNESS_BACK_DEPTH);
    assert_false(o.setting.effect.second_layer);
    o = accept("i.exr -o o.exr --thickness-channel T --thickness-channel none --layer2 none");
    assert_int_equal(o.setting.effect.thickness_input, VKAO_THICKNESS_AS_SEEN);
    assert_false(o.setting.effect.second_layer);
    refuse("i.exr -o o.exr --back-depth B --thickness-channel T",
           "--thickness-channel and --back-depth exclude each other");
    refuse("i.exr -o o.exr --back-depth B -m gtao", "--back-depth needs --method vbao or raymarch");
    refuse("i.exr -o o.exr --thickness-channel B -m hbao",
           "--thickness-channel needs --method vbao or raymarch");
    refuse("i.exr -o o.exr --layer2 B -m sphere", "--layer2 needs --method vbao or raymarch");
}

/* What another file brings stands behind what was said, before and after --like. */
static void options_come_before_what_is_taken(void **state)
{
    struct setting like = setting_default();
    struct tool_error err = {0};
    (void)state;
    like.params.radius = 3.0f;
    like.params.power = 2.0f;
    like.effect.step_count = 21;
    struct options o = accept("i.exr -o o.exr --power 1.5 --like f.exr --falloff threshold");
    assert_true(options_settle(&o, &like, &err));
    like.params.power = 1.5f;
    like.effect.falloff = VKAO_FALLOFF_THRESHOLD;
    assert_memory_equal(&o.setting, &like, sizeof like);
    assert_true(!o.radius_is_auto && o.bias_is_given);
    o = accept("i.exr -o o.exr --like f.exr --radius auto --steps auto");
    assert_true(options_settle(&o, &like, &err));
    assert_true(o.radius_is_auto);
    assert_int_equal(o.setting.effect.step_count, setting_default().effect.step_count);
    o = accept("i.exr -o o.exr --like f.exr --bent-normals");
    like.effect.method = VKAO_SSAO_HBAO;
    assert_false(options_settle(&o, &like, &err));
    assert_int_equal(err.code, EXIT_USAGE);
}

static void camera_and_channel_options_reach_the_gbuffer(void **state)
{
    struct options o = accept("in.exr -o o.exr --depth A/Z --depth-type radial-near --normal none "
                              "--fov 40:v --near 0.5 --far inf --color beauty --mode comp");
    (void)state;
    assert_string_equal(o.gbuffer.roles.name[ROLE_DEPTH], "A/Z");
    assert_string_equal(o.gbuffer.roles.name[ROLE_COLOR], "beauty");
    assert_int_equal(o.gbuffer.depth_type, DEPTH_RADIAL_NEAR);
    assert_true(o.gbuffer.roles.no_normals);
    assert_true(o.gbuffer.camera.fov_deg == 40.0 && o.gbuffer.camera.fov_is_vertical);
    assert_true(o.gbuffer.camera.near_plane == 0.5 && isinf(o.gbuffer.camera.far_plane));
    assert_true(o.gbuffer.want_color);
    o = accept("in.exr -o o.exr --normal none --normal N --fov 40:v --fov 30");
    assert_false(o.gbuffer.roles.no_normals);
    assert_string_equal(o.gbuffer.roles.name[ROLE_NORMAL], "N");
    assert_false(o.gbuffer.camera.fov_is_vertical);
}

static void numbers_out_of_range_are_named_with_the_range(void **state)
{
    (void)state;
    refuse("i.exr -o o.exr --radius -1", "--radius is -1, want a finite number > 0");
    refuse("i.exr -o o.exr --radius 0", "--radius is 0, want a finite number > 0");
    refuse("i.exr -o o.exr --radius inf", "--radius is inf, want a finite number > 0");
    refuse("i.exr -o o.exr --radius nan", "--radius is nan, want a finite number > 0");
    refuse("i.exr -o o.exr --radius 1m", "--radius is 1m, want a finite number > 0");
    refuse("i.exr -o o.exr --radius 1e-60", "--radius is 1e-60, want a finite number > 0");
    refuse("i.exr -o o.exr --radius 1e60", "--radius is 1e60, want a finite number > 0");
    refuse("i.exr -o o.exr --samples 1025",
           "--samples is 1025, want a whole number >= 1 and <= 1024");
    refuse("i.exr -o o.exr --samples 1.5",
           "--samples is 1.5, want a whole number >= 1 and <= 1024");
    refuse("i.exr -o o.exr --power 0", "--power is 0, want a finite number > 0 and <= 8");
    refuse("i.exr -o o.exr --blur 17", "--blur is 17, want a whole number >= 0 and <= 16");
    refuse("i.exr -o o.exr --fov 180",
           "--fov is 180, want degrees > 0 and < 180, followed by :h or :v or nothing");
    refuse("i.exr -o o.exr --fov 40:x",
           "--fov is 40:x, want degrees > 0 and < 180, followed by :h or :v or nothing");
}

static void unknown_words_list_the_known_ones(void **state)
{
    (void)state;
    refuse("i.exr -o o.exr --mode add", "--mode is 'add', want ao, append or comp");
    refuse("i.exr -o o.exr --falloff hard", "--falloff is 'hard', want smooth or threshold");
    refuse(
        "i.exr -o o.exr --compression htj2k",
        "--compression is 'htj2k', want none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa or dwab");
}

static void misspelt_options_get_a_suggestion(void **state)
{
    (void)state;
    refuse("i.exr -o o.exr --raduis 1", "unknown option '--raduis' (did you mean --radius?)");
    refuse("i.exr -o o.exr --raduis=1", "unknown option '--raduis' (did you mean --radius?)");
    refuse("i.exr --ouput o.exr", "unknown option '--ouput' (did you mean --output?)");
    refuse("i.exr -o o.exr --depth-tpye planar",
           "unknown option '--depth-tpye' (did you mean --depth-type?)");
    refuse("i.exr -o o.exr --zzzzzzzz", "unknown option '--zzzzzzzz'");
    refuse("i.exr -o o.exr -z", "unknown option '-z'");
    refuse("--bent-normals -zq i.exr -o o.exr", "unknown option '-z'");
    refuse("i.exr -o o.exr --radius", "option '--radius' needs an argument");
    refuse("i.exr -o o.exr --quiet=1", "option '--quiet=1' takes no argument");
    refuse("inpsect i.exr", "unknown command 'inpsect' (did you mean inspect?)");
}

static void missing_and_contradicting_arguments_are_refused(void **state)
{
    (void)state;
    refuse("", "no INPUT given");
    refuse("i.exr", "no output given: -o FILE");
    refuse("-o o.exr", "no INPUT given");
    refuse("a.exr b.exr -o o.exr", "one INPUT at a time, got 'a.exr' and 'b.exr'");
    refuse("i.exr -o o.exr --fov 40 --ortho 3", "--fov and --ortho exclude each other");
    refuse("devices i.exr", "'vkao devices' takes no INPUT, got 'i.exr'");
    refuse("inspect i.exr --radius 1", "option '--radius' has no meaning for 'vkao inspect'");
    refuse("i.exr -o o.exr --json", "option '--json' has no meaning for 'vkao render'");
}

static void commands_are_words_in_front_only(void **state)
{
    (void)state;
    assert_int_equal(accept("inspect i.exr --json").command, COMMAND_INSPECT);
    assert_int_equal(accept("devices").command, COMMAND_DEVICES);
    assert_int_equal(accept("-o o.exr inspect").command, COMMAND_RENDER);
    assert_true(accept("--help").help);
    assert_true(accept("inspect --version").version);
}

static void negative_numbers_and_order_of_words_do_not_matter(void **state)
{
    (void)state;
    refuse("i.exr -o o.exr --bias -0.5", "--bias is -0.5, want a finite number >= 0 and <= 1");
    assert_string_equal(accept("-o o.exr -r 1 i.exr -q").input, "i.exr");
    assert_string_equal(accept("-o o.exr -- -odd.exr").input, "-odd.exr");
}

static void help_names_every_option_within_80_columns(void **state)
{
    struct text text = {0};
    (void)state;
    options_help(&text);
    for (size_t i = 0; i < option_table_count; i++) {
        char name[64];
        snprintf(name, sizeof name, "--%s", option_table[i].name);
        assert_non_null(strstr(text.data, name));
    }
    for (const char *line = text.data; *line;) {
        size_t length = strcspn(line, "\n");
        assert_in_range(length, 0, 80);
        line += length + 1;
    }
    text_free(&text);
}

static void man_page_has_every_option_and_method(void **state)
{
    struct text text = {0};
    uint32_t count;
    const vkao_method *methods = vkao_methods(&count);
    (void)state;
    options_man(&text);
    for (size_t i = 0; i < option_table_count; i++) {
        char name[64];
        snprintf(name, sizeof name, "*--%s*", option_table[i].name);
        assert_non_null(strstr(text.data, name));
    }
    for (uint32_t i = 0; i < count; i++) {
        char name[64];
        snprintf(name, sizeof name, "*%s*: %s", methods[i].name, methods[i].help);
        assert_non_null(strstr(text.data, name));
    }
    text_free(&text);
}

static void names_and_letters_of_options_are_unique(void **state)
{
    (void)state;
    for (size_t i = 0; i < option_table_count; i++)
        for (size_t j = i + 1; j < option_table_count; j++) {
            assert_string_not_equal(option_table[i].name, option_table[j].name);
            if (option_table[i].letter)
                assert_int_not_equal(option_table[i].letter, option_table[j].letter);
        }
}

static void distance_counts_edits_and_swaps(void **state)
{
    (void)state;
    assert_int_equal(text_distance("radius", "radius"), 0);
    assert_int_equal(text_distance("raduis", "radius"), 1);
    assert_int_equal(text_distance("kitten", "sitting"), 3);
    assert_int_equal(text_distance("", "abc"), 3);
}

#define TEST(name) cmocka_unit_test(name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(defaults_are_those_of_the_library),
        TEST(every_option_reaches_its_member),
        TEST(every_parameter_has_an_option_but_these),
        TEST(ranges_are_those_of_the_table),
        TEST(presets_fill_what_is_left),
        TEST(bent_normals_need_a_method_that_has_them),
        TEST(thickness_and_layers_decide_what_is_compiled),
        TEST(options_come_before_what_is_taken),
        TEST(camera_and_channel_options_reach_the_gbuffer),
        TEST(numbers_out_of_range_are_named_with_the_range),
        TEST(unknown_words_list_the_known_ones),
        TEST(misspelt_options_get_a_suggestion),
        TEST(missing_and_contradicting_arguments_are_refused),
        TEST(commands_are_words_in_front_only),
        TEST(negative_numbers_and_order_of_words_do_not_matter),
        TEST(help_names_every_option_within_80_columns),
        TEST(man_page_has_every_option_and_method),
        TEST(names_and_letters_of_options_are_unique),
        TEST(distance_counts_edits_and_swaps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
