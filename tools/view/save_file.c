/* SPDX-License-Identifier: MIT
 *
 * Values of a file's AO, written as vkao itself writes them; and pictures of what vkao does not
 * draw. */
#include "save.h"

#include "png_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *save_download(struct viewer *viewer, const struct gpu_image *image, struct tool_error *err)
{
    struct gpu_image from = *image;
    uint64_t bytes =
        (uint64_t)from.extent.width * from.extent.height * gpu_format_bytes(from.format);
    void *values = malloc((size_t)bytes);
    if (!values) {
        fail(err, EXIT_MEMORY, "out of memory for a picture");
        return NULL;
    }
    if (gpu_image_download(&viewer->gpu, &from, values, bytes, err))
        return values;
    free(values);
    return NULL;
}

/* --- Pictures --- */

static uint8_t to_byte(double value)
{
    return value > 0 ? (uint8_t)(fmin(value, 1) * 255 + 0.5) : 0;
}

/* IEC 61966-2-1 */
static double to_srgb(double linear)
{
    if (!(linear > 0))
        return 0;
    return linear <= 0.0031308 ? linear * 12.92 : 1.055 * pow(fmin(linear, 1), 1 / 2.4) - 0.055;
}

static void tone(const struct viewer *v, const struct rendered_view *r, size_t texel,
                 double color[3])
{
    const double ao = (double)r->result.ao[texel];
    const float *output = r->result.output ? r->result.output + texel * 4 : NULL;
    const float *reference = v->source.now.reference_values;
    for (int c = 0; c < 3; c++)
        color[c] = 0;
    if (v->view == VIEW_RAW || v->view == VIEW_AO) {
        color[0] = color[1] = color[2] = ao;
    } else if (v->view == VIEW_DIFFERENCE && reference) {
        double d = (ao - (double)reference[texel]) * v->gain;
        color[0] = d < 0 ? -d : d * 0.15;
        color[1] = d < 0 ? -d * 0.35 : d * 0.6;
        color[2] = d < 0 ? -d * 0.1 : d;
    } else if (output) {
        for (int c = 0; c < 3; c++)
            color[c] = v->view == VIEW_COMPOSITE ? to_srgb((double)output[c]) : (double)output[c];
    }
}

bool save_picture(struct viewer *viewer, const struct rendered_view *view, const char *path,
                  struct tool_error *err)
{
    const struct gbuffer *g = &view->gbuffer;
    const size_t texels = (size_t)g->width * g->height;
    uint8_t *rgb = malloc(texels * 3 + 1);
    if (!rgb)
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    for (size_t i = 0; i < texels; i++) {
        double color[3];
        tone(viewer, view, i, color);
        for (size_t c = 0; c < 3; c++)
            rgb[i * 3 + c] = to_byte(color[c]);
    }
    bool ok = png_file_write(path, g->width, g->height, 3, rgb, false, err);
    free(rgb);
    return ok;
}

/* --- Values --- */

static bool shows_colour(const struct viewer *v)
{
    return v->view == VIEW_COMPOSITE && v->source.now.color.image;
}

/* vkao would leave the others out. */
static bool vkao_draws(enum view_kind view)
{
    return view == VIEW_RAW || view == VIEW_AO || view == VIEW_COMPOSITE;
}

/* The options as vkao would have parsed them from the command line. */
static struct options output_options(const struct viewer *v, const struct save_names *n)
{
    struct options o = v->source.options;
    o.mode = shows_colour(v) ? OUTPUT_COMP : OUTPUT_AO;
    o.pixel_type = EXR_FLOAT;
    o.output = n->exr;
    o.part_name = NULL;
    o.overwrite = 0;
    o.setting = setting_as_said(&v->settings[v->active], v->view);
    o.setting.effect.bent_normals = save_result(v)->shape.bent;
    return o;
}

static bool take_values(struct viewer *v, struct rendered_view *r, struct tool_error *err)
{
    const struct computation *c = save_result(v);
    const struct gbuffer *g = &v->source.now.gbuffer;
    const size_t texels = (size_t)c->ao.extent.width * c->ao.extent.height;
    r->gbuffer = *g;
    r->gbuffer.color = NULL;
    r->result.ao = save_download(v, &c->ao, err);
    bool ok = r->result.ao != NULL;
    if (ok && c->shape.composite) {
        r->result.output = save_download(v, &c->output, err);
        ok = r->result.output != NULL;
    }
    if (ok && c->shape.bent) {
        r->result.bent = save_download(v, &c->bent, err);
        ok = r->result.bent != NULL;
    }
    /* The copy's alpha goes into the file, and cropping changes it. */
    if (ok && g->color) {
        r->gbuffer.color = malloc(texels * 4 * sizeof *g->color);
        ok = r->gbuffer.color || fail(err, EXIT_MEMORY, "out of memory for a picture");
    }
    if (ok && g->color)
        memcpy(r->gbuffer.color, g->color, texels * 4 * sizeof *g->color);
    if (ok)
        placement_crop(&v->source.now.placement, &r->gbuffer, &r->result);
    return ok;
}

bool save_file_values(struct viewer *viewer, const struct save_names *names, struct tool_error *err)
{
    struct viewer *v = viewer;
    struct loaded_frame *l = &v->source.now;
    struct options options = output_options(v, names);
    struct frame_source files = l->files;
    struct rendered_view r;
    char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE], input[ATOMIC_FILE_PATH_MAX];
    char exr[ATOMIC_FILE_PATH_MAX], png[ATOMIC_FILE_PATH_MAX];
    memset(&r, 0, sizeof r);
    snprintf(input, sizeof input, "%s", l->path);
    snprintf(exr, sizeof exr, "%s", names->exr);
    snprintf(png, sizeof png, "%s", names->png);
    snprintf(device, sizeof device, "%s", v->gpu.properties.deviceName);
    device[strcspn(device, "(") > 1 ? strcspn(device, "(") - 1 : 0] = '\0';
    files.views[0] = l->files.views[l->view];
    files.view_count = 1;
    r.name = files.views[0].name;
    r.setting = options.setting;
    ao_view_describe(&l->gbuffer.view, &r.setting.effect);
    const struct plan_frame frame = {
        .input = input, .output = exr, .preview = vkao_draws(v->view) ? png : NULL};
    bool ok = take_values(v, &r, err) && output_write(&options, &frame, &files, &r, device, err) &&
              (vkao_draws(v->view) || save_picture(v, &r, names->png, err));
    free(r.gbuffer.color);
    ao_result_free(&r.result);
    return ok;
}
