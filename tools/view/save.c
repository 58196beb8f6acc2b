/* SPDX-License-Identifier: MIT
 *
 * Save: the picture as PNG, the values as EXR, and the command line of vkao that makes them; of a
 * live scene its G-buffer and camera too. Files are written as vkao itself writes them. */
#include "atomic_file.h"
#include "png_file.h"
#include "shell.h"
#include "values.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <vulkan/vulkan.h>

/* --- Names --- */

enum { SAVE_STEM_MAX = ATOMIC_FILE_PATH_MAX - 32 }; /* leaves room for number and extension */

/* The files of a save in the order in which they appear; the first two are of live scenes. */
enum { SAVE_GBUFFER, SAVE_CAMERA, SAVE_PNG, SAVE_EXR, SAVE_SCRIPT, SAVE_FILES };

/* Of one save. */
struct save_names {
    char exr[ATOMIC_FILE_PATH_MAX], png[ATOMIC_FILE_PATH_MAX], script[ATOMIC_FILE_PATH_MAX];
    char gbuffer[ATOMIC_FILE_PATH_MAX], camera[ATOMIC_FILE_PATH_MAX]; /* of live scenes */
};

static bool exists(const char *path)
{
    struct stat s;
    return lstat(path, &s) == 0;
}

static void fill_names(struct save_names *n, const char *stem, unsigned number)
{
    char tail[16] = "";
    if (number > 1)
        snprintf(tail, sizeof tail, ".%u", number);
    snprintf(n->exr, sizeof n->exr, "%.*s%s.exr", SAVE_STEM_MAX, stem, tail);
    snprintf(n->png, sizeof n->png, "%.*s%s.png", SAVE_STEM_MAX, stem, tail);
    snprintf(n->script, sizeof n->script, "%.*s%s.sh", SAVE_STEM_MAX, stem, tail);
    snprintf(n->gbuffer, sizeof n->gbuffer, "%.*s%s.gbuffer.exr", SAVE_STEM_MAX, stem, tail);
    snprintf(n->camera, sizeof n->camera, "%.*s%s.camera.json", SAVE_STEM_MAX, stem, tail);
}

/* The first number whose files are not there yet: nothing is overwritten. */
static bool choose_names(const struct viewer *v, struct save_names *n, struct tool_error *err)
{
    char stem[SAVE_STEM_MAX];
    const char *path = v->live ? live_scene_name(v->live->kind) : v->source.now.path;
    const char *name = text_base_name(path);
    size_t length = strlen(name);
    if (text_ends_with(name, ".exr"))
        length -= strlen(".exr");
    if (v->arguments->save)
        snprintf(stem, sizeof stem, "%s", v->arguments->save);
    else
        snprintf(stem, sizeof stem, "%.*s.view", (int)length, name);
    for (unsigned i = 1; i < 10000; i++) {
        fill_names(n, stem, i);
        if (!exists(n->exr) && !exists(n->png) && !exists(n->script) &&
            (!v->live || (!exists(n->gbuffer) && !exists(n->camera))))
            return true;
    }
    return fail(err, EXIT_OUTPUT, "%s: no name is free for another picture", stem);
}

/* --- Command line --- */

static bool shows_colour(const struct viewer *v)
{
    return v->view == VIEW_COMPOSITE && !v->live && v->source.now.color.image;
}

/* Options that change nothing are mistakes to vkao: those of light are for the composite, and for
 * what of it is switched on; those of what lies behind, for methods that read it. */
static bool is_role_read(const struct viewer *v, enum role_kind kind)
{
    const vkao_effect_info *e = &last_result(v, v->active)->shape.effect;
    switch (kind) {
    case ROLE_INDIRECT:
        return shows_colour(v);
    case ROLE_ALBEDO:
        return shows_colour(v) && e->multi_bounce;
    case ROLE_SPECULAR:
    case ROLE_ROUGHNESS:
        return shows_colour(v) && e->specular;
    case ROLE_THICKNESS:
        return e->thickness_input == VKAO_THICKNESS_GIVEN;
    case ROLE_BACK_DEPTH:
        return e->thickness_input == VKAO_THICKNESS_BACK_DEPTH;
    case ROLE_LAYER2:
        return e->second_layer;
    default:
        return true;
    }
}

static bool is_option_read(const struct viewer *v, const struct option_row *row)
{
    const struct options *none = NULL;
    for (int kind = 0; kind < ROLE_KINDS; kind++)
        if (row->offset == offsetof(struct options, gbuffer.roles.name) +
                               (size_t)kind * sizeof none->gbuffer.roles.name[0])
            return is_role_read(v, (enum role_kind)kind);
    return true;
}

/* Files of the frame that is shown stand for a pattern; those that were dropped have none. */
static const char *file_of_frame(const struct viewer *v, const struct option_row *row)
{
    static const char *const names[ROLE_FILES] = {"depth-file", "normal-file", "color-file"};
    const struct loaded_frame *l = &v->source.now;
    for (int kind = 0; kind < ROLE_FILES; kind++)
        if (strcmp(names[kind], row->name) == 0)
            return l->files->files[kind].path ? l->files->files[kind].path : "";
    return NULL;
}

/* Options of vkao that read the file as it was read here. */
static void add_file_options(const struct viewer *v, struct text *out)
{
    const struct arguments *a = v->arguments;
    const struct loaded_frame *l = &v->source.now;
    bool has_view = false;
    for (size_t i = 0; i < a->file_word_count; i++) {
        const struct option_row *row = a->file_words[i].row;
        const char *file = file_of_frame(v, row), *word = a->file_words[i].word;
        const bool is_option = strncmp(word, "--", 2) == 0;
        if (file && *file && is_option) {
            text_add(out, " --%s ", row->name);
            text_add_quoted(out, file);
        }
        if (file || !is_option_read(v, row))
            continue;
        text_add(out, " ");
        text_add_quoted(out, word);
        has_view = has_view || strcmp(row->name, "view") == 0;
    }
    if (l->camera_path) {
        text_add(out, " --camera ");
        text_add_quoted(out, l->camera_path);
    } else if (v->source.options.camera_file) {
        text_add(out, " --camera none");
    }
    if (!has_view && *l->files->views[l->view].name) {
        text_add(out, " --view ");
        text_add_quoted(out, l->files->views[l->view].name);
    }
}

/* Views of which vkao itself writes the picture. It knows no direct light, as live scenes have, and
 * no exposure. */
static bool vkao_draws(const struct viewer *v)
{
    const bool is_exposed = v->exposure > 0 || v->exposure < 0;
    return v->view == VIEW_RAW || v->view == VIEW_AO ||
           (v->view == VIEW_COMPOSITE && !v->live && !is_exposed);
}

static bool build_command(const struct viewer *v, const struct save_names *n, struct text *command,
                          struct text *unsaid, struct tool_error *err)
{
    text_add(command, "vkao ");
    if (v->live) {
        text_add_quoted(command, n->gbuffer);
        text_add(command, " --normal-space camera --camera ");
        text_add_quoted(command, n->camera);
    } else {
        text_add_quoted(command, v->source.now.path);
        add_file_options(v, command);
    }
    struct setting said = v->settings[v->active];
    if (v->source.now.albedo.image)
        said.effect.multi_bounce = VK_FALSE; /* options that name channels say so */
    if (v->source.now.specular.image)
        said.effect.specular = VKAO_SPECULAR_NONE;
    /* Of a composite that vkao does not draw the AO is said. */
    setting_add_options(&said, v->view == VIEW_COMPOSITE && v->live ? VIEW_AO : v->view, command,
                        unsaid);
    if (shows_colour(v))
        text_add(command, " --mode comp");
    if (last_result(v, v->active)->shape.bent)
        text_add(command, " --bent-normals");
    text_add(command, " --pixel-type float --overwrite always -o ");
    text_add_quoted(command, n->exr);
    if (vkao_draws(v)) {
        text_add(command, " --preview ");
        text_add_quoted(command, n->png);
    }
    return (!command->out_of_memory && !unsaid->out_of_memory) ||
           fail(err, EXIT_MEMORY, "%s: out of memory", n->script);
}

/* Frees the text. */
static bool prepare_text(struct atomic_file *file, const char *path, struct text *text,
                         struct tool_error *err)
{
    bool ok = !text->out_of_memory || fail(err, EXIT_MEMORY, "%s: out of memory", path);
    ok = ok && atomic_file_open(file, path, false, err) &&
         atomic_file_write(file, text->data, text->length, err);
    text_free(text);
    return ok;
}

static bool prepare_script(const struct viewer *v, const struct save_names *n, const char *command,
                           const char *unsaid, struct atomic_file *file, struct tool_error *err)
{
    struct text text = {0};
    text_add(&text, "#!/bin/sh\n");
    if (!vkao_draws(v) && shows_colour(v))
        text_add(&text, "# The picture is exposed by %+g stops, which vkao does not do.\n",
                 v->exposure);
    else if (!vkao_draws(v))
        text_add(&text, "# vkao writes no picture of this view (%s); this is the AO behind it.\n",
                 view_names[v->view].word);
    if (unsaid)
        text_add(&text, "# Set in the viewer, and without an option of vkao: %s\n", unsaid);
    text_add(&text, "%s\n", command);
    return prepare_text(file, n->script, &text, err);
}

/* --- Pictures --- */

/* The picture as the display shows it, of values without padding: width and height are those of the
 * G-buffer. */
static bool prepare_picture(struct viewer *viewer, const struct rendered_view *view,
                            const char *path, struct atomic_file *file, struct tool_error *err)
{
    const struct gbuffer *g = &view->gbuffer;
    const size_t texels = (size_t)g->width * g->height;
    uint8_t *rgb = malloc(texels * 3 + 1);
    if (!rgb)
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    const struct tone tone = viewer_tone(viewer, viewer->active);
    for (size_t i = 0; i < texels; i++) {
        double color[3];
        values_color(viewer, &tone, view, i, color);
        for (size_t c = 0; c < 3; c++)
            rgb[i * 3 + c] = byte_of(color[c]);
    }
    const struct png_picture picture = {g->width, g->height, 3, rgb, NULL, NULL};
    bool ok = png_file_prepare(file, path, &picture, false, err);
    free(rgb);
    return ok;
}

/* --- Values of a file --- */

/* The options as vkao would have parsed them from the command line. */
static struct options output_options(const struct viewer *v, const struct save_names *n)
{
    struct options o = v->source.options;
    o.mode = shows_colour(v) ? OUTPUT_COMP : OUTPUT_AO;
    o.pixel_type = EXR_FLOAT;
    o.output = n->exr;
    o.part_name = NULL;
    o.overwrite = OVERWRITE_NEVER;
    o.setting = setting_as_said(&v->settings[v->active], v->view);
    const vkao_effect_info *made = &last_result(v, v->active)->shape.effect;
    o.setting.effect.bent_normals = made->bent_normals;
    o.setting.effect.multi_bounce = shows_colour(v) && made->multi_bounce;
    o.setting.effect.specular = shows_colour(v) ? made->specular : VKAO_SPECULAR_NONE;
    return o;
}

static bool prepare_file_values(struct viewer *viewer, const struct save_names *names,
                                struct atomic_file *files, struct tool_error *err)
{
    struct viewer *v = viewer;
    struct loaded_frame *l = &v->source.now;
    struct options options = output_options(v, names);
    struct frame_source source = *l->files;
    struct rendered_view r;
    char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE], input[ATOMIC_FILE_PATH_MAX];
    char exr[ATOMIC_FILE_PATH_MAX], png[ATOMIC_FILE_PATH_MAX];
    bool ok = values_take(v, v->active, &r, err);
    for (int kind = 0; kind < ROLE_KINDS; kind++)
        if (!is_role_read(v, (enum role_kind)kind))
            r.gbuffer.roles.kind[kind] = (struct role){0}; /* as without their options */
    snprintf(input, sizeof input, "%s", l->path);
    snprintf(exr, sizeof exr, "%s", names->exr);
    snprintf(png, sizeof png, "%s", names->png);
    snprintf(device, sizeof device, "%s", v->gpu.properties.deviceName);
    device[strcspn(device, "(") > 1 ? strcspn(device, "(") - 1 : 0] = '\0';
    source.views[0] = l->files->views[l->view];
    source.view_count = 1;
    r.name = source.views[0].name;
    r.setting = options.setting;
    ao_view_describe(&l->gbuffer.view, &r.setting.effect);
    const struct plan_frame frame = {
        .input = input, .output = exr, .preview = vkao_draws(v) ? png : NULL};
    ok = ok && (vkao_draws(v) || prepare_picture(v, &r, names->png, &files[SAVE_PNG], err)) &&
         placement_widen(&r.gbuffer, &r.result, err) &&
         output_prepare(&options, &frame, &source, &r, device,
                        &files[vkao_draws(v) ? SAVE_PNG : SAVE_EXR], err);
    values_free(&r);
    return ok;
}

/* --- A live scene --- */

/* All arrays without what lies beyond the part that was rendered. */
struct live_values {
    uint32_t width, height;
    float *z;       /* view z, 0 = background */
    float *normals; /* 3, view space */
    float *color;   /* 3, direct and indirect light */
};

static uint32_t last_frame(const struct viewer *v)
{
    return (v->swapchain.frame + FRAMES_IN_FLIGHT - 1) % FRAMES_IN_FLIGHT;
}

static void change_layout(VkCommandBuffer cmd, const struct gpu_image *image, VkImageLayout from,
                          VkImageLayout to)
{
    const bool is_depth = image->format == VK_FORMAT_D32_SFLOAT;
    vkCmdPipelineBarrier(
        cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0,
        NULL, 1,
        &(VkImageMemoryBarrier){
            .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
            .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT,
            .oldLayout = from,
            .newLayout = to,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .image = image->image,
            .subresourceRange = {is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT,
                                 0, 1, 0, 1},
        });
}

static bool move(struct viewer *v, const struct gpu_image *image, VkImageLayout from,
                 VkImageLayout to, struct tool_error *err)
{
    VkCommandBuffer cmd = gpu_begin(&v->gpu, err);
    if (!cmd)
        return false;
    change_layout(cmd, image, from, to);
    return gpu_submit(&v->gpu, cmd, err);
}

/* Of an image in the layout that vkao reads it in. */
static void *fetch(struct viewer *v, const struct gpu_image *image, VkImageLayout layout,
                   struct tool_error *err)
{
    if (!move(v, image, layout, VK_IMAGE_LAYOUT_GENERAL, err))
        return NULL;
    void *values = download_image(&v->gpu, image, err);
    if (move(v, image, VK_IMAGE_LAYOUT_GENERAL, layout, err))
        return values;
    free(values);
    return NULL;
}

static float from_half(uint16_t half)
{
    const int exponent = half >> 10 & 31, mantissa = half & 1023;
    double value = exponent == 0 ? ldexp(mantissa, -24) : ldexp(1024 + mantissa, exponent - 25);
    return (float)(half & 0x8000 ? -value : value);
}

static void convert_normal(uint32_t packed, const float rotation[9], float normal[3])
{
    float world[3];
    for (int i = 0; i < 3; i++)
        world[i] = (float)(packed >> 10 * i & 1023u) / 1023.0f * 2.0f - 1.0f;
    for (int row = 0; row < 3; row++) {
        normal[row] = 0;
        for (int column = 0; column < 3; column++)
            normal[row] += rotation[column * 3 + row] * world[column];
    }
}

struct fetched {
    float *depth;
    uint32_t *normals;
    uint16_t *indirect, *direct;
};

static void convert(const struct fetched *f, const struct inputs *inputs, struct live_values *out)
{
    for (uint32_t y = 0; y < out->height; y++) {
        for (uint32_t x = 0; x < out->width; x++) {
            const size_t from = (size_t)y * inputs->extent.width + x;
            const size_t to = (size_t)y * out->width + x;
            double position[3];
            bool there =
                unproject(&inputs->view, inputs->extent, x, y, (double)f->depth[from], position);
            out->z[to] = there ? (float)fabs(position[2]) : 0.0f;
            convert_normal(f->normals[from], inputs->view.normal_to_view, out->normals + to * 3);
            for (size_t c = 0; c < 3; c++)
                out->color[to * 3 + c] =
                    from_half(f->indirect[from * 4 + c]) + from_half(f->direct[from * 4 + c]);
        }
    }
}

static bool take_gbuffer(struct viewer *v, const struct inputs *inputs, struct live_values *out,
                         struct tool_error *err)
{
    const struct live_target *t = &v->live->targets[last_frame(v)];
    const size_t texels = (size_t)out->width * out->height;
    struct fetched f = {0};
    f.depth = fetch(v, &t->depth, inputs->images.depth.layout, err);
    if (f.depth)
        f.normals = fetch(v, &t->normals, inputs->images.normals.layout, err);
    if (f.normals)
        f.indirect = fetch(v, &t->indirect, inputs->images.color.layout, err);
    if (f.indirect)
        f.direct = fetch(v, &t->direct, inputs->images.direct.layout, err);
    bool ok = f.direct != NULL;
    if (ok) {
        out->z = calloc(texels, sizeof *out->z);
        out->normals = calloc(texels * 3, sizeof *out->normals);
        out->color = calloc(texels * 3, sizeof *out->color);
        ok = (out->z && out->normals && out->color) ||
             fail(err, EXIT_MEMORY, "out of memory for a G-buffer");
    }
    if (ok)
        convert(&f, inputs, out);
    free(f.depth);
    free(f.normals);
    free(f.indirect);
    free(f.direct);
    return ok;
}

static bool prepare_live_exr(struct atomic_file *file, const char *path, uint32_t width,
                             uint32_t height, const struct exr_write *channels, size_t count,
                             struct tool_error *err)
{
    const struct exr_box box = {0, 0, (int32_t)width - 1, (int32_t)height - 1};
    const struct exr_new_part part = {
        .name = "",
        .data_window = box,
        .display_window = box,
        .pixel_aspect = 1.0f,
        .compression = "zip",
        .channels = channels,
        .channel_count = count,
    };
    return exr_prepare_file(file, path, NULL, &part, 1, false, err);
}

static bool prepare_gbuffer(struct atomic_file *file, const char *path, const struct live_values *g,
                            struct tool_error *err)
{
    const struct exr_write channels[] = {
        {"R", EXR_HALF, g->color, 3},          {"G", EXR_HALF, g->color + 1, 3},
        {"B", EXR_HALF, g->color + 2, 3},      {"Z", EXR_FLOAT, g->z, 1},
        {"N.X", EXR_FLOAT, g->normals, 3},     {"N.Y", EXR_FLOAT, g->normals + 1, 3},
        {"N.Z", EXR_FLOAT, g->normals + 2, 3},
    };
    return prepare_live_exr(file, path, g->width, g->height, channels,
                            sizeof channels / sizeof *channels, err);
}

static bool prepare_camera(struct atomic_file *file, const char *path, const struct orbit *camera,
                           VkExtent2D used, struct tool_error *err)
{
    const double aspect = (double)used.width / used.height, degrees = 45 / atan(1);
    const double half = tan(camera->fov_y / 2) * aspect;
    struct text text = {0};
    if (camera->orthographic)
        text_add(&text, "{\"type\": \"orthographic\", \"ortho_width\": %.17g}\n",
                 2 * half * camera->distance);
    else
        text_add(&text, "{\"type\": \"perspective\", \"fov_x_deg\": %.17g}\n",
                 2 * atan(half) * degrees);
    return prepare_text(file, path, &text, err);
}

static bool prepare_results(struct viewer *v, const struct save_names *names,
                            struct atomic_file *files, struct tool_error *err)
{
    struct rendered_view r;
    bool ok = values_take(v, v->active, &r, err);
    const struct exr_write channel = {"AO", EXR_FLOAT, r.result.ao, 1};
    ok = ok &&
         prepare_live_exr(&files[SAVE_EXR], names->exr, r.gbuffer.width, r.gbuffer.height, &channel,
                          1, err) &&
         prepare_picture(v, &r, names->png, &files[SAVE_PNG], err);
    values_free(&r);
    return ok;
}

static bool prepare_live_values(struct viewer *viewer, const struct save_names *names,
                                struct atomic_file *files, struct tool_error *err)
{
    struct live *live = viewer->live;
    const uint32_t frame = last_frame(viewer);
    const VkExtent2D used = live->shown_used[frame];
    struct inputs inputs = live_inputs(live, frame);
    struct live_values values = {.width = used.width, .height = used.height};
    live_scene_view(&live->shown[frame], used, &inputs.view);
    bool ok = take_gbuffer(viewer, &inputs, &values, err) &&
              prepare_gbuffer(&files[SAVE_GBUFFER], names->gbuffer, &values, err) &&
              prepare_camera(&files[SAVE_CAMERA], names->camera, &live->shown[frame], used, err) &&
              prepare_results(viewer, names, files, err);
    free(values.z);
    free(values.normals);
    free(values.color);
    return ok;
}

/* --- Save --- */

static bool check_saveable(const struct viewer *v, struct tool_error *err)
{
    if (viewer_has_image(v) && last_result(v, v->active)->frame)
        return true;
    return fail(err, EXIT_INPUT, "there is no picture that could be saved");
}

/* The script is the last: where it is, the save is whole. */
static bool write_all(struct viewer *v, const struct save_names *names, const char *command,
                      const char *unsaid, struct tool_error *err)
{
    const size_t first = v->live ? SAVE_GBUFFER : SAVE_PNG, count = SAVE_FILES - first;
    struct atomic_file *files = calloc(SAVE_FILES, sizeof *files);
    if (!files)
        return fail(err, EXIT_MEMORY, "%s: out of memory", names->script);
    bool ok = (v->live ? prepare_live_values(v, names, files, err)
                       : prepare_file_values(v, names, files, err)) &&
              prepare_script(v, names, command, unsaid, &files[SAVE_SCRIPT], err);
    if (ok) {
        const size_t done = atomic_files_commit(files + first, count, err);
        ok = done == count;
        if (!ok)
            atomic_files_withdraw(files + first, done);
    }
    for (size_t i = 0; i < SAVE_FILES; i++)
        atomic_file_abort(&files[i]);
    free(files);
    return ok;
}

bool viewer_save(struct viewer *viewer, struct tool_error *err)
{
    struct viewer *v = viewer;
    struct save_names *names = calloc(1, sizeof *names);
    struct text command = {0}, unsaid = {0};
    bool ok = (names || fail(err, EXIT_MEMORY, "out of memory")) && check_saveable(v, err) &&
              choose_names(v, names, err) && build_command(v, names, &command, &unsaid, err) &&
              write_all(v, names, command.data, unsaid.data, err);
    if (ok) {
        viewer_say(v, "saved %s, .exr and .png\n%s", names->script, command.data);
        ok = report_text(command.data, err);
        printf("\n");
        fflush(stdout);
    }
    free(names);
    text_free(&command);
    text_free(&unsaid);
    return ok;
}

bool viewer_copy_command(struct viewer *viewer, struct tool_error *err)
{
    struct save_names *names = calloc(1, sizeof *names);
    struct text command = {0}, unsaid = {0};
    bool ok = (names || fail(err, EXIT_MEMORY, "out of memory")) && check_saveable(viewer, err) &&
              choose_names(viewer, names, err) &&
              build_command(viewer, names, &command, &unsaid, err);
    if (ok) {
        window_set_clipboard(&viewer->window, command.data);
        viewer_say(viewer, "in the clipboard:\n%s", command.data);
    }
    free(names);
    text_free(&command);
    text_free(&unsaid);
    return ok;
}
