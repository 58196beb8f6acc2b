/* SPDX-License-Identifier: MIT
 *
 * One frame: from what is known of parameters and files to a picture in the window. */
#include "viewer.h"

#include "png_file.h"
#include "widgets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

static bool wait_idle(struct viewer *v, struct tool_error *err)
{
    return gpu_ok(err, "vkDeviceWaitIdle", vkDeviceWaitIdle(v->gpu.device));
}

/* --- Results of earlier frames --- */

static uint32_t first_query(enum side side, uint32_t frame)
{
    return ((uint32_t)side * FRAMES_IN_FLIGHT + frame) * (STAGES + 1);
}

/* AO as it is shown: that of what is held out is less. */
static void finish_probe(struct viewer *v)
{
    const struct gbuffer *g = &v->source.now.gbuffer;
    const VkOffset2D offset = viewer_image_offset(v);
    struct probe_result *r = &v->probed;
    const size_t texel = (size_t)(r->y - offset.y) * g->width + (size_t)(r->x - offset.x);
    for (int i = 0; g->holdout && i < 2; i++)
        r->ao[i] += (1.0f - r->ao[i]) * g->holdout[texel];
}

static bool collect(struct viewer *v, uint32_t frame, struct tool_error *err)
{
    for (int s = 0; s < SIDES; s++) {
        if (v->stamped[s][frame] &&
            read_stage_times(&v->gpu, v->timestamps, first_query((enum side)s, frame), &v->times[s],
                             err))
            v->stamped[s][frame] = false;
    }
    if (probe_read(&v->probe, frame, &v->probed))
        finish_probe(v);
    return err->code == EXIT_OK;
}

/* --- Making what is missing --- */

static void destroy_results(struct viewer *v)
{
    for (int s = 0; s < SIDES; s++)
        for (int f = 0; f < FRAMES_IN_FLIGHT; f++)
            computation_destroy(&v->results[s][f]);
    display_forget(&v->display);
}

static bool ensure_targets(struct viewer *v, struct tool_error *err)
{
    const VkExtent2D wanted = viewer_area(v).extent;
    if (!v->live ||
        (v->live->extent.width == wanted.width && v->live->extent.height == wanted.height))
        return true;
    if (!wait_idle(v, err))
        return false;
    destroy_results(v);
    return live_resize(v->live, wanted, err);
}

static struct inputs inputs_of(const struct viewer *v, uint32_t frame)
{
    return v->live ? live_inputs(v->live, frame) : source_inputs(&v->source);
}

static bool ensure_result(struct viewer *v, enum side side, uint32_t frame, struct tool_error *err)
{
    struct computation *c = &v->results[side][v->live ? frame : 0];
    const struct inputs inputs = inputs_of(v, frame);
    if (computation_fits(c, &inputs, &v->settings[side], v->view))
        return true;
    if (!wait_idle(v, err))
        return false;
    v->stale[side] = true;
    display_forget(&v->display);
    return computation_create(c, &v->gpu, v->context, &inputs, &v->settings[side], v->view, err);
}

/* --- Recording --- */

static bool record_side(struct viewer *v, enum side side, uint32_t frame, VkCommandBuffer cmd,
                        struct tool_error *err)
{
    const struct inputs inputs = inputs_of(v, frame);
    const struct computation *c = &v->results[side][v->live ? frame : 0];
    if (!v->live && !v->stale[side])
        return true;
    v->stale[side] = false;
    v->error[side] = -1;
    v->stamped[side][frame] = v->timestamps != VK_NULL_HANDLE;
    return computation_record(c, cmd, &inputs, &v->settings[side], v->view, v->timestamps,
                              first_query(side, frame), err);
}

/* The texel under the mouse, from the corner of what is shown. */
static bool texel_at(const struct viewer *v, double x, double y, VkOffset2D *texel)
{
    const VkExtent2D extent = viewer_image_extent(v);
    const struct placing *p = &v->placing;
    double column = floor((x - p->x) / p->zoom), row = floor((y - p->y) / p->zoom);
    if (!(column >= 0 && row >= 0 && column < extent.width && row < extent.height))
        return false;
    *texel = (VkOffset2D){(int32_t)column, (int32_t)row};
    return true;
}

static void record_probe(struct viewer *v, uint32_t frame, VkCommandBuffer cmd)
{
    const struct input *in = &v->window.input;
    VkOffset2D texel, offset = viewer_image_offset(v);
    if (!in->inside || !viewer_has_mouse(v, in->x) || !texel_at(v, in->x, in->y, &texel)) {
        v->probed.valid = false;
        v->probe.requests[frame].pending = false;
        return;
    }
    const struct inputs inputs = inputs_of(v, frame);
    const struct computation *a = viewer_result(v, viewer_needs(v, SIDE_A) ? SIDE_A : SIDE_B);
    const struct computation *b = viewer_result(v, viewer_needs(v, SIDE_B) ? SIDE_B : SIDE_A);
    const VkImage ao[2] = {a->ao.image, b->ao.image};
    probe_record(&v->probe, frame, cmd, &inputs, ao, texel.x + offset.x, texel.y + offset.y);
}

/* Both sides but for the mode. */
static struct display_block picture_block(const struct viewer *v)
{
    const VkExtent2D extent = viewer_image_extent(v);
    const VkOffset2D offset = viewer_image_offset(v);
    const double width = v->swapchain.extent.width;
    const struct tone tone = viewer_tone(v, v->active);
    return (struct display_block){
        .origin_x = (float)v->placing.x,
        .origin_y = (float)v->placing.y,
        .zoom = (float)v->placing.zoom,
        /* Left of it is A. Without a wipe there is one side only. */
        .wipe = (float)(v->wipe               ? floor(v->wipe_at * width)
                        : v->active == SIDE_A ? 1e9
                                              : -1e9),
        .offset_x = offset.x,
        .offset_y = offset.y,
        .width = (int32_t)extent.width,
        .height = (int32_t)extent.height,
        .line = v->wipe,
        .gain = (float)tone.gain,
        .low = (float)tone.low,
        .high = (float)tone.high,
        .exposure = (float)tone.exposure,
        .is_kept = v->source.now.kept.image != VK_NULL_HANDLE,
    };
}

static void record_picture(struct viewer *v, uint32_t frame, VkCommandBuffer cmd, bool there)
{
    struct display_block block = picture_block(v);
    struct display_images images = {0};
    if (there && viewer_needs(v, SIDE_A)) {
        block.mode_a = viewer_tone(v, SIDE_A).mode;
        images.bindings[DISPLAY_BINDING_A] = computation_result(viewer_result(v, SIDE_A), v->view);
    }
    if (there && viewer_needs(v, SIDE_B)) {
        block.mode_b = viewer_tone(v, SIDE_B).mode;
        images.bindings[DISPLAY_BINDING_B] = computation_result(viewer_result(v, SIDE_B), v->view);
    }
    images.bindings[DISPLAY_BINDING_REFERENCE] = v->source.now.reference.view;
    images.bindings[DISPLAY_BINDING_KEPT] = v->source.now.kept.view;
    images.bindings[DISPLAY_BINDING_BEFORE] = v->source.now.before.view;
    display_bind(&v->display, frame, &images);
    display_draw(&v->display, cmd, frame, &block);
}

/* Without memory or the device nothing can be drawn, in the next frame neither. */
static void tell(struct viewer *v, const struct tool_error *err)
{
    if (err->code == EXIT_MEMORY || err->code == EXIT_DEVICE)
        viewer_fail(v, err);
    else
        viewer_say_error(v, err);
}

/* Makes what this frame will need, before there is an image that waits for it. */
static bool prepare(struct viewer *v, uint32_t frame)
{
    struct tool_error err = {0};
    bool ok = ensure_targets(v, &err);
    for (int s = 0; ok && s < SIDES; s++)
        ok = !viewer_needs(v, (enum side)s) || ensure_result(v, (enum side)s, frame, &err);
    if (!ok)
        tell(v, &err);
    return ok;
}

static bool record_results(struct viewer *v, uint32_t frame, VkCommandBuffer cmd)
{
    struct tool_error err = {0};
    bool ok = true;
    if (v->live)
        live_record(v->live, frame, cmd);
    for (int s = 0; ok && s < SIDES; s++)
        ok = !viewer_needs(v, (enum side)s) || record_side(v, (enum side)s, frame, cmd, &err);
    if (ok)
        record_probe(v, frame, cmd);
    else
        tell(v, &err);
    return ok;
}

/* --- Captures --- */

static bool write_capture(struct viewer *v, uint32_t frame, VkExtent2D extent,
                          const struct gpu_buffer *buffer, const char *path, struct tool_error *err)
{
    const uint8_t *from = buffer->mapped;
    const size_t texels = (size_t)extent.width * extent.height;
    const bool blue_first = v->swapchain.format == VK_FORMAT_B8G8R8A8_UNORM;
    VkResult result =
        vkWaitForFences(v->gpu.device, 1, &v->swapchain.frames[frame].done, VK_TRUE, UINT64_MAX);
    if (!gpu_ok(err, "vkWaitForFences", result))
        return false;
    uint8_t *rgb = malloc(texels * 3);
    if (!rgb)
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    for (size_t i = 0; i < texels; i++) {
        rgb[i * 3] = from[i * 4 + (blue_first ? 2 : 0)];
        rgb[i * 3 + 1] = from[i * 4 + 1];
        rgb[i * 3 + 2] = from[i * 4 + (blue_first ? 0 : 2)];
    }
    const struct png_picture picture = {extent.width, extent.height, 3, rgb, NULL, NULL};
    bool ok = png_file_write(path, &picture, true, err);
    free(rgb);
    return ok;
}

static bool create_capture(struct viewer *v, struct gpu_buffer *buffer, struct tool_error *err)
{
    const VkExtent2D extent = v->swapchain.extent;
    if (!v->swapchain.can_capture)
        return fail(err, EXIT_DEVICE, "this display's images cannot be copied: no --screenshot");
    return gpu_buffer_create(&v->gpu, (uint64_t)extent.width * extent.height * 4,
                             VK_BUFFER_USAGE_TRANSFER_DST_BIT, buffer, err);
}

static void capture_barrier(VkCommandBuffer cmd)
{
    /* The copy -> write_capture. */
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &(VkMemoryBarrier){
                             .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                             .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                             .dstAccessMask = VK_ACCESS_HOST_READ_BIT,
                         },
                         0, NULL, 0, NULL);
}

/* --- The frame --- */

/* New images if the window has another size. False without an error: it has none now. */
static bool follow_window(struct viewer *v, struct tool_error *err)
{
    const VkExtent2D window = window_framebuffer(&v->window), now = v->swapchain.extent;
    if (v->swapchain.handle && !v->swapchain.is_stale && window.width == now.width &&
        window.height == now.height)
        return true;
    return swapchain_resize(&v->swapchain, window, err);
}

static bool record_frame(struct viewer *v, VkCommandBuffer cmd, bool there,
                         const struct gpu_buffer *capture, struct tool_error *err)
{
    static const float clear[4] = {0, 0, 0, 1};
    const uint32_t frame = v->swapchain.frame;
    there = there && record_results(v, frame, cmd);
    swapchain_begin_pass(&v->swapchain, cmd, clear);
    record_picture(v, frame, cmd, there);
    if (!widgets_end_frame(cmd, err))
        return false;
    vkCmdEndRenderPass(cmd);
    if (capture->buffer) {
        swapchain_capture(&v->swapchain, cmd, capture->buffer);
        capture_barrier(cmd);
    }
    enum swapchain_status status = swapchain_end(&v->swapchain, err);
    v->swapchain.is_stale = status == SWAPCHAIN_STALE;
    return status != SWAPCHAIN_FAILED;
}

bool viewer_draw(struct viewer *viewer, const char *capture, struct tool_error *err)
{
    struct viewer *v = viewer;
    struct gpu_buffer buffer = {0};
    VkCommandBuffer cmd;
    if (!follow_window(v, err) || !swapchain_wait(&v->swapchain, err))
        return false;
    const uint32_t frame = v->swapchain.frame;
    if (!viewer_measure(v, err) || !collect(v, frame, err))
        return false;
    viewer_choose_scale(v);
    struct button_event event;
    const bool is_event = window_take_button_event(&v->window, &event);
    if (v->window.button_event_count > 0)
        viewer_draw_more(v);
    widgets_begin_frame(v->scale, is_event ? &event : NULL);
    viewer_panel(v);
    const bool there = viewer_has_image(v) && prepare(v, frame);
    /* A live scene has the window's size from here on. */
    if (v->placing.fit)
        viewer_fit(v);
    const VkExtent2D extent = v->swapchain.extent;
    if (capture && !create_capture(v, &buffer, err)) {
        widgets_end_frame(VK_NULL_HANDLE, err);
        return false;
    }
    enum swapchain_status status = swapchain_begin(&v->swapchain, &cmd, err);
    bool ok = status == SWAPCHAIN_OK;
    v->swapchain.is_stale = status == SWAPCHAIN_STALE;
    if (ok)
        ok = record_frame(v, cmd, there, &buffer, err);
    else
        widgets_end_frame(VK_NULL_HANDLE, err);
    if (ok && capture)
        ok = write_capture(v, frame, extent, &buffer, capture, err);
    if (capture) /* the copy may still be under way where the presentation failed */
        ok = wait_idle(v, err) && ok;
    gpu_buffer_destroy(&v->gpu, &buffer);
    return ok;
}
