/* SPDX-License-Identifier: MIT
 *
 * A frame of a live scene as files: the G-buffer and the camera that vkao reads, and the AO that the
 * frame showed. */
#include "save.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

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

/* --- From the device --- */

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
    void *values = save_download(v, image, err);
    if (move(v, image, VK_IMAGE_LAYOUT_GENERAL, layout, err))
        return values;
    free(values);
    return NULL;
}

/* --- Into the form of files --- */

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

/* --- Files --- */

static bool write_exr(const char *path, uint32_t width, uint32_t height,
                      const struct exr_write *channels, size_t count, struct tool_error *err)
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
    return exr_write_file(path, NULL, &part, 1, false, err);
}

static bool write_gbuffer(const char *path, const struct live_values *g, struct tool_error *err)
{
    const struct exr_write channels[] = {
        {"R", EXR_HALF, g->color, 3},          {"G", EXR_HALF, g->color + 1, 3},
        {"B", EXR_HALF, g->color + 2, 3},      {"Z", EXR_FLOAT, g->z, 1},
        {"N.X", EXR_FLOAT, g->normals, 3},     {"N.Y", EXR_FLOAT, g->normals + 1, 3},
        {"N.Z", EXR_FLOAT, g->normals + 2, 3},
    };
    return write_exr(path, g->width, g->height, channels, sizeof channels / sizeof *channels, err);
}

static bool write_camera(const char *path, const struct orbit *camera, VkExtent2D used,
                         struct tool_error *err)
{
    const double aspect = (double)used.width / used.height, degrees = 45 / atan(1);
    const double half = tan(camera->fov_y / 2) * aspect;
    struct atomic_file *file = calloc(1, sizeof *file);
    struct text text = {0};
    if (camera->orthographic)
        text_add(&text, "{\"type\": \"orthographic\", \"ortho_width\": %.17g}\n",
                 2 * half * camera->distance);
    else
        text_add(&text, "{\"type\": \"perspective\", \"fov_x_deg\": %.17g}\n",
                 2 * atan(half) * degrees);
    bool ok = (file && !text.out_of_memory) || fail(err, EXIT_MEMORY, "%s: out of memory", path);
    ok = ok && atomic_file_open(file, path, false, err) &&
         atomic_file_write(file, text.data, text.length, err) && atomic_file_commit(file, err);
    if (file)
        atomic_file_abort(file);
    text_free(&text);
    free(file);
    return ok;
}

/* The rendered part of rows of `components` floats, in place. */
static void crop(float *values, uint32_t from_width, uint32_t width, uint32_t height,
                 size_t components)
{
    for (size_t y = 0; values && y < height; y++)
        memmove(values + y * width * components, values + y * from_width * components,
                width * components * sizeof *values);
}

static bool write_results(struct viewer *v, const struct save_names *names, VkExtent2D used,
                          struct tool_error *err)
{
    const struct computation *c = save_result(v);
    struct rendered_view r;
    memset(&r, 0, sizeof r);
    r.gbuffer.width = used.width;
    r.gbuffer.height = used.height;
    r.result.ao = save_download(v, &c->ao, err);
    bool ok = r.result.ao != NULL;
    if (ok && c->shape.composite) {
        r.result.output = save_download(v, &c->output, err);
        ok = r.result.output != NULL;
    }
    crop(r.result.ao, c->ao.extent.width, used.width, used.height, 1);
    crop(r.result.output, c->ao.extent.width, used.width, used.height, 4);
    const struct exr_write channel = {"AO", EXR_FLOAT, r.result.ao, 1};
    ok = ok && write_exr(names->exr, used.width, used.height, &channel, 1, err) &&
         save_picture(v, &r, names->png, err);
    ao_result_free(&r.result);
    return ok;
}

bool save_live_values(struct viewer *viewer, const struct save_names *names, struct tool_error *err)
{
    struct live *live = viewer->live;
    const uint32_t frame = last_frame(viewer);
    const VkExtent2D used = live->shown_used[frame];
    struct inputs inputs = live_inputs(live, frame);
    struct live_values values = {.width = used.width, .height = used.height};
    live_scene_view(&live->shown[frame], used, &inputs.view);
    bool ok = take_gbuffer(viewer, &inputs, &values, err) &&
              write_gbuffer(names->gbuffer, &values, err) &&
              write_camera(names->camera, &live->shown[frame], used, err) &&
              write_results(viewer, names, used, err);
    free(values.z);
    free(values.normals);
    free(values.color);
    return ok;
}
