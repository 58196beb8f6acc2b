/* SPDX-License-Identifier: MIT
 *
 * The viewer's table of parameters against the command line of vkao, undo, quoting, the list of
 * files, and the probe's arithmetic. */
#include "browse.h"
#include "history.h"
#include "options.h"
#include "probe.h"
#include "settings.h"
#include "shell.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

static uint32_t state = 1;

static double uniform(void)
{
    state = state * 1664525u + 1013904223u;
    return (state >> 8) / 16777216.0;
}

/* --- Settings --- */

static void sliders_stay_in_the_range_of_the_table(void **unused)
{
    size_t count;
    const struct param *rows = panel_params(&count);
    (void)unused;
    for (size_t i = 0; i < count; i++) {
        const vkao_parameter *p = rows[i].parameter;
        const struct parameter_range r = parameter_range(p);
        const bool is_number = p->type == VKAO_PARAMETER_FLOAT || p->type == VKAO_PARAMETER_UINT;
        if (!is_number)
            continue;
        if (rows[i].low < r.low || rows[i].high > r.high ||
            (r.low_is_excluded && !(rows[i].low > r.low)))
            fail_msg("%s is offered from %g to %g", p->name, rows[i].low, rows[i].high);
        if (p->standard < rows[i].low || p->standard > rows[i].high || !(rows[i].high < 1e7))
            fail_msg("%s: default %g, offered from %g to %g", p->name, p->standard, rows[i].low,
                     rows[i].high);
    }
}

/* What the panel cannot change would be something that nobody sees. */
static void every_parameter_has_a_row_but_what_images_or_views_decide(void **unused)
{
    static const char *const hidden[] = {"depth_bits",      "bent_normals", "noisy_ao",
                                         "thickness_input", "second_layer", "debug_distance"};
    size_t count;
    uint32_t all_count;
    const struct param *rows = panel_params(&count);
    const vkao_parameter *all = vkao_parameters(&all_count);
    (void)unused;
    for (uint32_t i = 0; i < all_count; i++) {
        int found = 0;
        for (size_t k = 0; k < count; k++)
            found += rows[k].parameter == &all[i];
        bool is_hidden = parameter_is_of_images(&all[i]);
        for (size_t k = 0; k < sizeof hidden / sizeof *hidden; k++)
            is_hidden = is_hidden || strcmp(all[i].name, hidden[k]) == 0;
        assert_int_equal(found, !is_hidden);
    }
}

static void defaults_come_back(void **unused)
{
    size_t count;
    const struct param *rows = panel_params(&count);
    (void)unused;
    for (size_t i = 0; i < count; i++) {
        struct setting s = setting_default(), standard = s;
        memset(parameter_of(&s, rows[i].parameter), 0x3f, 4);
        assert_false(parameter_equals(rows[i].parameter, &s, &standard));
        param_reset(&rows[i], &s);
        assert_memory_equal(&s, &standard, sizeof s);
    }
}

static void randomise(const struct param *row, struct setting *s)
{
    const vkao_parameter *p = row->parameter;
    const double value = row->low + (row->high - row->low) * uniform();
    float numbers[3] = {(float)value, (float)uniform(), (float)uniform()};
    uint32_t word = (uint32_t)(value + 0.5);
    if (p->type == VKAO_PARAMETER_CHOICE)
        word = (uint32_t)(uniform() * (last_choice(row) + 1));
    const bool is_number = p->type == VKAO_PARAMETER_FLOAT || p->type == VKAO_PARAMETER_COLOR;
    memcpy(parameter_of(s, p), is_number ? (const void *)numbers : &word, parameter_bytes(p));
}

static void parse(char *line, struct options *options)
{
    char *words[64] = {(char[]){"vkao"}, (char[]){"in.exr"}, (char[]){"-oout.exr"}};
    size_t count = 3;
    struct tool_error err = {0};
    for (char *word = strtok(line, " "); word && count < 63; word = strtok(NULL, " "))
        words[count++] = word;
    if (!options_parse((int)count, words, options, &err))
        fail_msg("%s", err.message);
}

static void vkao_reads_back_what_save_writes(void **unused)
{
    size_t count;
    const struct param *rows = panel_params(&count);
    (void)unused;
    for (int round = 0; round < 2000; round++) {
        const enum view_kind view = round % 2 ? VIEW_COMPOSITE : VIEW_RAW;
        const struct setting standard = setting_default();
        struct setting s = standard;
        struct text line = {0}, unsaid = {0};
        struct options o;
        for (size_t i = 0; i < count; i++)
            if (uniform() < 0.4)
                randomise(&rows[i], &s);
        setting_add_options(&s, view, &line, &unsaid);
        assert_non_null(line.data);
        parse(line.data, &o);
        const struct setting said = setting_as_said(&s, view);
        for (size_t i = 0; i < count; i++) {
            const vkao_parameter *p = rows[i].parameter;
            if (!parameter_equals(p, &o.setting, &said))
                fail_msg("%s is read back otherwise", p->name);
            if (view == VIEW_COMPOSITE && rows[i].needs && !parameter_equals(p, &s, &standard))
                assert_non_null(strstr(unsaid.data, rows[i].label));
            if (view == VIEW_COMPOSITE && option_of_parameter(p) && !parameter_equals(p, &said, &s))
                fail_msg("%s is not said", p->name);
        }
        assert_true(o.bias_is_given && !o.radius_is_auto);
        text_free(&line);
        text_free(&unsaid);
    }
}

static void standard_setting_needs_radius_and_bias_alone(void **unused)
{
    struct setting s = setting_default();
    struct text line = {0}, unsaid = {0};
    (void)unused;
    setting_add_options(&s, VIEW_AO, &line, &unsaid);
    assert_string_equal(line.data, " --radius 0.5 --bias 0.005");
    assert_null(unsaid.data);
    text_free(&line);
    setting_apply_preset(&s, VKAO_QUALITY_FAST);
    setting_add_options(&s, VIEW_AO, &line, &unsaid);
    assert_string_equal(line.data, " --quality fast --radius 0.5 --bias 0.005");
    text_free(&line);
}

/* --- Quoting --- */

static void shell_reads_back_what_was_quoted(void **unused)
{
    static const char *const words[] = {"plain",      "two words", "it's", "$HOME `ls` \\ \"x\"",
                                        "*.exr",      "",          "a\tb", "~/x",
                                        "--name=v=w", "!x#y;z&",   "'''",  "\xc3\xa9.exr"};
    (void)unused;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        struct text command = {0};
        char back[256] = "";
        text_add(&command, "printf %%s ");
        text_add_quoted(&command, words[i]);
        FILE *shell = popen(command.data, "r");
        assert_non_null(shell);
        size_t length = fread(back, 1, sizeof back - 1, shell);
        back[length] = '\0';
        assert_int_equal(pclose(shell), 0);
        assert_string_equal(back, words[i]);
        text_free(&command);
    }
}

/* --- Probe --- */

/* Matrices that engines use; columns. */
static void fill_projection(int kind, float p[16])
{
    static const float perspective[16] = {1.2f, 0,     0,          0,  0, -2.1f, 0,           0,
                                          0.1f, -0.2f, -1.001001f, -1, 0, 0,     -0.1001001f, 0};
    static const float reversed[16] = {1.2f, 0,    0, 0, 0, 2.1f, 0,    0,
                                       0.1f, 0.2f, 0, 1, 0, 0,    0.1f, 0};
    static const float orthographic[16] = {0.2f, 0, 0,      0, 0,    -0.3f, 0,       0,
                                           0,    0, -0.01f, 0, 0.1f, 0.05f, -0.001f, 1};
    const float *all[] = {perspective, reversed, orthographic};
    memcpy(p, all[kind], sizeof perspective);
}

static void probe_finds_the_point_that_was_projected(void **unused)
{
    const VkExtent2D extent = {320, 200};
    (void)unused;
    for (int round = 0; round < 3000; round++) {
        const int kind = round % 3;
        struct ao_view view = ao_view_default();
        fill_projection(kind, view.projection);
        view.depth_encoding = (vkao_depth_encoding)(round / 3 % 4);
        view.axis = kind == 2 ? VKAO_VIEW_AXIS_NEGATIVE_Z : VKAO_VIEW_AXIS_FROM_MATRIX;
        if (round % 2)
            view.viewport = (VkRect2D){{-30, 12}, {400, 170}};
        const VkRect2D port = round % 2 ? view.viewport : (VkRect2D){.extent = extent};
        const double sign = kind == 1 ? 1 : -1, z = 0.5 + 40 * uniform();
        const double point[3] = {(uniform() - 0.5) * z, (uniform() - 0.5) * z, sign * z};
        double clip[4], found[3];
        for (int row = 0; row < 4; row++) {
            clip[row] = (double)view.projection[12 + row];
            for (int column = 0; column < 3; column++)
                clip[row] += (double)view.projection[column * 4 + row] * point[column];
        }
        double length = sqrt(point[0] * point[0] + point[1] * point[1] + z * z);
        const double depths[] = {clip[2] / clip[3], z, kind == 2 ? z : length, 1 / z};
        double column = (clip[0] / clip[3] + 1) / 2 * port.extent.width + port.offset.x - 0.5;
        double row = (clip[1] / clip[3] + 1) / 2 * port.extent.height + port.offset.y - 0.5;
        assert_true(unproject(&view, extent, column, row, depths[view.depth_encoding], found));
        for (int i = 0; i < 3; i++)
            if (!(fabs(found[i] - point[i]) < 1e-6 * z))
                fail_msg("round %d: %g, want %g", round, found[i], point[i]);
    }
}

static void probe_knows_background(void **unused)
{
    const VkExtent2D extent = {4, 4};
    double position[3];
    struct ao_view view = ao_view_default();
    (void)unused;
    fill_projection(0, view.projection);
    assert_false(unproject(&view, extent, 1, 1, 1.0, position));
    assert_false(unproject(&view, extent, 1, 1, NAN, position));
    for (int e = VKAO_DEPTH_VIEW_Z; e <= VKAO_DEPTH_INVERSE_Z; e++) {
        view.depth_encoding = (vkao_depth_encoding)e;
        assert_false(unproject(&view, extent, 1, 1, 0.0, position));
        assert_false(unproject(&view, extent, 1, 1, INFINITY, position));
    }
}

/* --- Undo --- */

static void undo_brings_back_what_was_and_forgets_what_was_undone(void **unused)
{
    static struct history h;
    struct history_state now = {.settings = {setting_default(), setting_default()}};
    (void)unused;
    history_reset(&h, &now);
    assert_false(history_step(&h, -1, &now));
    for (int i = 1; i <= 2 * HISTORY_STATES; i++) {
        now.settings[i % 2].params.radius = (float)i;
        history_note(&h, &now);
        history_note(&h, &now); /* no change, no state */
    }
    assert_false(history_step(&h, 1, &now));
    int steps = 0;
    while (history_step(&h, -1, &now))
        steps++;
    assert_int_equal(steps, HISTORY_STATES - 1);
    assert_true(now.settings[1].params.radius == (float)(HISTORY_STATES + 1));
    assert_true(history_step(&h, 1, &now));
    assert_true(now.settings[0].params.radius == (float)(HISTORY_STATES + 2));
    now.settings[0].effect.half_resolution = VK_TRUE;
    history_note(&h, &now);
    assert_false(history_step(&h, 1, &now));
    assert_true(history_step(&h, -1, &now));
    assert_false(now.settings[0].effect.half_resolution);
    now.shown[1] = -2;
    history_note(&h, &now);
    assert_true(history_step(&h, -1, &now));
    assert_true(now.shown[1] == 0);
    now.settings[1].params.bias = 0.25f;
    history_amend(&h, &now); /* no state */
    assert_true(history_step(&h, -1, &now) && history_step(&h, 1, &now));
    assert_true(now.settings[1].params.bias == 0.25f);
}

/* --- The list of files --- */

enum { ROOT_BYTES = 512 };
static const char *const folders[] = {"b", "b/c", "b/.hidden"};
static const char *const files[] = {"z.exr", "a 1.EXR",      "camera.json", "notes.txt",
                                    ".exr",  "b/c/shot.exr", "b/c/Shut.exr"};

static void make_tree(char root[ROOT_BYTES])
{
    char path[ROOT_BYTES + 32];
    const char *base = getenv("TMPDIR");
    snprintf(root, ROOT_BYTES, "%s/vkao-browse-XXXXXX", base && *base ? base : P_tmpdir);
    assert_non_null(mkdtemp(root));
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        snprintf(path, sizeof path, "%s/%s", root, folders[i]);
        assert_int_equal(mkdir(path, 0700), 0);
    }
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        snprintf(path, sizeof path, "%s/%s", root, files[i]);
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fclose(file);
    }
}

static void remove_tree(const char *root)
{
    char path[ROOT_BYTES + 32];
    for (size_t i = sizeof files / sizeof *files; i-- > 0;) {
        snprintf(path, sizeof path, "%s/%s", root, files[i]);
        unlink(path);
    }
    for (size_t i = sizeof folders / sizeof *folders; i-- > 0;) {
        snprintf(path, sizeof path, "%s/%s", root, folders[i]);
        rmdir(path);
    }
    assert_int_equal(rmdir(root), 0);
}

static void assert_listed(const struct browser *b, const char *names)
{
    char is[512] = "";
    for (size_t i = 0; i < b->shown_count; i++) {
        const struct browser_entry *e = &b->entries[b->shown[i]];
        snprintf(is + strlen(is), sizeof is - strlen(is), "%s%s%s|", i == b->at ? ">" : "", e->name,
                 e->is_folder ? "/" : "");
    }
    assert_string_equal(is, names);
}

static void list_of_files_is_moved_through(void **unused)
{
    char root[ROOT_BYTES], path[ROOT_BYTES + 32], chosen[ROOT_BYTES + 32];
    struct browser b = {0};
    struct tool_error err = {0};
    (void)unused;
    make_tree(root);
    snprintf(path, sizeof path, "%s/z.exr", root);
    assert_true(browser_open(&b, path, &err));
    assert_listed(&b, "../|b/|a 1.EXR|camera.json|>z.exr|");
    browser_move(&b, -2);
    assert_listed(&b, "../|b/|>a 1.EXR|camera.json|z.exr|");
    browser_move(&b, -100);
    assert_listed(&b, ">../|b/|a 1.EXR|camera.json|z.exr|");
    browser_move(&b, 100);
    assert_true(browser_choose(&b, chosen, sizeof chosen, &err));
    assert_string_equal(chosen, path);
    browser_move(&b, -3);
    assert_false(browser_choose(&b, chosen, sizeof chosen, &err));
    assert_listed(&b, ">../|c/|");
    browser_move(&b, 1);
    assert_false(browser_choose(&b, chosen, sizeof chosen, &err));
    assert_listed(&b, ">../|Shut.exr|shot.exr|");
    browser_type(&b, 'S');
    browser_type(&b, 'H');
    assert_listed(&b, ">Shut.exr|shot.exr|");
    browser_move(&b, 1);
    browser_type(&b, 'o');
    assert_listed(&b, ">shot.exr|");
    browser_type(&b, 0x1d11e);
    assert_listed(&b, "");
    assert_string_equal(b.filter, "SHo\xf0\x9d\x84\x9e");
    assert_false(browser_choose(&b, chosen, sizeof chosen, &err));
    assert_true(browser_erase(&b, &err));
    assert_listed(&b, ">shot.exr|");
    for (int i = 0; i < 3; i++)
        assert_true(browser_erase(&b, &err));
    assert_listed(&b, "../|Shut.exr|>shot.exr|");
    assert_true(browser_erase(&b, &err)); /* up */
    assert_listed(&b, "../|>c/|");
    browser_move(&b, -1);
    assert_false(browser_choose(&b, chosen, sizeof chosen, &err));
    assert_listed(&b, "../|>b/|a 1.EXR|camera.json|z.exr|");
    assert_int_equal(err.code, EXIT_OK);
    browser_close(&b);
    remove_tree(root);
}

static void list_of_the_working_directory_goes_up_and_back(void **unused)
{
    char root[ROOT_BYTES], before[ROOT_BYTES + 32], chosen[ROOT_BYTES + 32];
    struct browser b = {0};
    struct tool_error err = {0};
    (void)unused;
    make_tree(root);
    assert_non_null(getcwd(before, sizeof before));
    assert_int_equal(chdir(root), 0);
    assert_true(browser_open(&b, NULL, &err));
    browser_move(&b, 2);
    assert_true(browser_choose(&b, chosen, sizeof chosen, &err));
    assert_string_equal(chosen, "a 1.EXR");
    for (int i = 0; i < 40; i++)
        assert_true(browser_erase(&b, &err)); /* the root is above itself */
    assert_true(browser_open(&b, "b/c/gone.exr", &err));
    assert_listed(&b, ">../|Shut.exr|shot.exr|");
    assert_false(browser_open(&b, "gone/x.exr", &err));
    assert_int_equal(err.code, EXIT_INPUT);
    assert_listed(&b, ">../|Shut.exr|shot.exr|");
    browser_close(&b);
    assert_int_equal(chdir(before), 0);
    remove_tree(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sliders_stay_in_the_range_of_the_table),
        cmocka_unit_test(every_parameter_has_a_row_but_what_images_or_views_decide),
        cmocka_unit_test(defaults_come_back),
        cmocka_unit_test(vkao_reads_back_what_save_writes),
        cmocka_unit_test(standard_setting_needs_radius_and_bias_alone),
        cmocka_unit_test(undo_brings_back_what_was_and_forgets_what_was_undone),
        cmocka_unit_test(shell_reads_back_what_was_quoted),
        cmocka_unit_test(probe_finds_the_point_that_was_projected),
        cmocka_unit_test(probe_knows_background),
        cmocka_unit_test(list_of_files_is_moved_through),
        cmocka_unit_test(list_of_the_working_directory_goes_up_and_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
