/* SPDX-License-Identifier: MIT */
#include "viewer.h"

#include "automatic.h"
#include "summary.h"
#include "widgets.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <vulkan/vulkan.h>

/* --- What the steps share --- */

void viewer_say(struct viewer *viewer, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(viewer->status.text, sizeof viewer->status.text, format, args);
    va_end(args);
    viewer->status.bad = false;
    viewer->status.is_new = true;
}

void viewer_fail(struct viewer *viewer, const struct tool_error *err)
{
    if (viewer->failure.code == EXIT_OK)
        viewer->failure = *err;
}

void viewer_say_error(struct viewer *viewer, const struct tool_error *err)
{
    if (err->ends_run) {
        viewer_fail(viewer, err);
        return;
    }
    viewer_say(viewer, "%s%s%s", err->message, err->hint[0] ? "\n" : "", err->hint);
    viewer->status.bad = true;
    report_error(err); /* the panel may be hidden, and says one thing at a time */
}

bool viewer_has_image(const struct viewer *viewer)
{
    return viewer->live || source_is_loaded(&viewer->source);
}

VkExtent2D viewer_image_extent(const struct viewer *viewer)
{
    const struct gbuffer *g = &viewer->source.now.gbuffer;
    if (viewer->live)
        return live_used(viewer->live);
    return source_is_loaded(&viewer->source) ? (VkExtent2D){g->width, g->height} : (VkExtent2D){0};
}

VkOffset2D viewer_image_offset(const struct viewer *viewer)
{
    const struct placement *p = &viewer->source.now.placement;
    return viewer->live ? (VkOffset2D){0} : (VkOffset2D){(int32_t)p->left, (int32_t)p->top};
}

/* On a monitor that does not tell how dense it is, a large window has a larger panel too. */
static double scale_for(const struct viewer *v, double content_scale, VkExtent2D window)
{
    enum { ROOMY_WIDTH = 1600, ROOMY_HEIGHT = 1000 };
    if (v->arguments->panel_scale > 0)
        return widgets_scale(v->arguments->panel_scale);
    const double roomy = fmin(window.width / (ROOMY_WIDTH * content_scale),
                              window.height / (ROOMY_HEIGHT * content_scale));
    return widgets_scale(content_scale * fmin(fmax(roomy, 1), 2));
}

void viewer_choose_scale(struct viewer *viewer)
{
    viewer->scale = scale_for(viewer, viewer->window.content_scale, viewer->swapchain.extent);
}

uint32_t viewer_panel_width(const struct viewer *viewer)
{
    return (uint32_t)(PANEL_WIDTH * viewer->scale + 0.5);
}

VkRect2D viewer_area(const struct viewer *viewer)
{
    const VkExtent2D whole = viewer->swapchain.extent;
    const uint32_t panel = viewer_panel_width(viewer);
    VkRect2D area = {.extent = whole};
    if (viewer->show_panel && whole.width > panel) {
        area.offset.x = (int32_t)panel;
        area.extent.width = whole.width - panel;
    }
    return area;
}

void viewer_fit(struct viewer *viewer)
{
    const VkRect2D area = viewer_area(viewer);
    const VkExtent2D image = viewer_image_extent(viewer);
    struct placing *p = &viewer->placing;
    p->fit = true;
    if (image.width == 0 || image.height == 0)
        return;
    p->zoom =
        fmin((double)area.extent.width / image.width, (double)area.extent.height / image.height);
    /* Texels of one size each; a live picture rather fills its window. */
    if (p->zoom > 1 && !viewer->live)
        p->zoom = floor(p->zoom);
    p->x = area.offset.x + floor((area.extent.width - image.width * p->zoom) / 2);
    p->y = area.offset.y + floor((area.extent.height - image.height * p->zoom) / 2);
}

void viewer_mark_stale(struct viewer *viewer)
{
    for (int s = 0; s < SIDES; s++) {
        viewer->stale[s] = true;
        viewer->error[s] = -1;
    }
    viewer_mark_seen(viewer);
}

void viewer_mark_seen(struct viewer *viewer)
{
    viewer->histogram.is_known = false;
    viewer_draw_more(viewer);
}

void viewer_draw_more(struct viewer *viewer)
{
    viewer->frames_wanted = FRAMES_IN_FLIGHT + 1;
}

bool viewer_needs(const struct viewer *viewer, enum side side)
{
    return viewer->wipe || viewer->active == side;
}

const struct computation *viewer_result(const struct viewer *viewer, enum side side)
{
    return &viewer->results[side][viewer->live ? viewer->swapchain.frame : 0];
}

unsigned viewer_images_there(const struct viewer *viewer)
{
    if (viewer->live)
        return NEEDS_COLOR | NEEDS_DIRECT | NEEDS_ALBEDO;
    const struct loaded_frame *l = &viewer->source.now;
    return (l->color.image ? NEEDS_COLOR : 0u) | (l->albedo.image ? NEEDS_ALBEDO : 0u) |
           (l->specular.image ? NEEDS_SPECULAR : 0u);
}

void side_title(const struct viewer *viewer, enum side side, char *text, size_t size)
{
    const struct setting *s = &viewer->settings[side];
    snprintf(text, size, "%c %s%s", side == SIDE_A ? 'A' : 'B', method_name(s->effect.method),
             s->effect.half_resolution ? " half" : "");
}

static uint32_t display_mode(const struct viewer *v, enum side side)
{
    static const uint32_t modes[VIEW_KINDS] = {[VIEW_RAW] = DISPLAY_AO,
                                               [VIEW_AO] = DISPLAY_AO,
                                               [VIEW_COMPOSITE] = DISPLAY_SRGB,
                                               [VIEW_DEPTH] = DISPLAY_DEPTH,
                                               [VIEW_NORMALS] = DISPLAY_PLAIN,
                                               [VIEW_BENT] = DISPLAY_PLAIN,
                                               [VIEW_DIFFERENCE] = DISPLAY_DIFFERENCE};
    const struct computation *c = viewer_result(v, side);
    if (v->view == VIEW_BENT && !method_has_bent(v->settings[side].effect.method))
        return DISPLAY_NOTHING;
    if (v->view == VIEW_DIFFERENCE && (v->live || !v->source.now.reference.image))
        return DISPLAY_NOTHING;
    if (v->view == VIEW_COMPOSITE && c->shape.effect.composite_mode == VKAO_COMPOSITE_MULTIPLY)
        return DISPLAY_LIT;
    return modes[v->view];
}

struct tone viewer_tone(const struct viewer *viewer, enum side side)
{
    const struct viewer *v = viewer;
    const double unit = (double)v->settings[side].params.debug_distance;
    return (struct tone){.mode = display_mode(v, side),
                         .gain = v->gain,
                         .low = v->depth_shown.near / unit,
                         .high = v->depth_shown.far / unit,
                         .exposure = exp2(v->exposure)};
}

/* --- Files --- */

static void drop_results(struct viewer *viewer)
{
    struct tool_error err = {0};
    if (!gpu_ok(&err, "vkDeviceWaitIdle", vkDeviceWaitIdle(viewer->gpu.device)))
        viewer_fail(viewer, &err);
    for (int s = 0; s < SIDES; s++)
        for (int f = 0; f < FRAMES_IN_FLIGHT; f++)
            computation_destroy(&viewer->results[s][f]);
    if (viewer->display.gpu)
        display_forget(&viewer->display);
    viewer->probed.valid = false;
    for (int f = 0; f < FRAMES_IN_FLIGHT; f++)
        viewer->probe.requests[f].pending = false;
    viewer_mark_stale(viewer);
}

/* What follows from the frame at hand, as vkao has it for each: the bias, unless somebody has set
 * it. */
static void settle_frame(struct viewer *viewer)
{
    struct viewer *v = viewer;
    const struct gbuffer *g = &v->source.now.gbuffer;
    for (int i = 0; i < SIDES; i++) {
        struct vkao_params *p = &v->settings[i].params;
        const float settled = v->bias_settled[i];
        /* The panel says it of the radius as it will be by then. */
        v->report.heard = NULL;
        check_radius(g, p->radius, &v->report);
        v->report.heard = viewer_hear;
        if (v->bias_is_given[i] || (settled > 0 && (p->bias < settled || p->bias > settled)))
            continue;
        p->bias = settled_bias(g, p->radius, v->arguments->settings[i].params.bias, &v->report);
        v->bias_settled[i] = p->bias;
    }
}

/* What the options left to the file. */
static void complete_settings(struct viewer *viewer)
{
    const struct gbuffer *g = &viewer->source.now.gbuffer;
    const struct relative_radius *relative = &viewer->arguments->options.relative_radius;
    const float radius = viewer->source.radius > 0 || viewer->live
                             ? viewer->source.radius
                             : relative_radius_of(relative, g);
    for (int i = 0; i < SIDES; i++) {
        struct setting *s = &viewer->settings[i];
        if (!(s->params.radius > 0) && viewer->live)
            s->params.radius = live_scene_radius(viewer->live->kind);
        else if (!(s->params.radius > 0))
            s->params.radius = radius;
        /* The colour of a live scene is its indirect light. */
        if (viewer->live && s->effect.composite_mode == VKAO_COMPOSITE_MULTIPLY)
            s->effect.composite_mode = VKAO_COMPOSITE_INDIRECT;
        double far = viewer->live ? viewer->live->camera.distance * 2 : g->max_z;
        if (far > 0)
            s->params.debug_distance = (float)far;
    }
    if (!viewer->live)
        settle_frame(viewer);
    viewer_fit_depth(viewer);
}

void viewer_fit_depth(struct viewer *viewer)
{
    const struct loaded_frame *l = &viewer->source.now;
    struct depth_shown *d = &viewer->depth_shown;
    if (!d->is_automatic)
        return;
    d->near = viewer->live ? 0 : l->near_z;
    d->far = viewer->live ? viewer->live->camera.distance * 2 : l->far_z;
    if (!(d->far > d->near * (1 + 1e-6))) /* all of it is as far */
        *d = (struct depth_shown){.is_automatic = true, .far = d->far > 0 ? d->far * 2 : 1};
    viewer_mark_seen(viewer);
}

/* A range that follows from the files is none that was chosen. */
struct history_state viewer_state(const struct viewer *viewer)
{
    const struct depth_shown *d = &viewer->depth_shown;
    struct history_state state = {.shown = {viewer->gain, viewer->exposure, d->is_automatic,
                                            d->is_automatic ? 0 : d->near,
                                            d->is_automatic ? 0 : d->far}};
    memcpy(state.settings, viewer->settings, sizeof state.settings);
    return state;
}

void viewer_take_state(struct viewer *viewer, const struct history_state *state)
{
    const double *shown = state->shown;
    memcpy(viewer->settings, state->settings, sizeof state->settings);
    viewer->gain = shown[0];
    viewer->exposure = shown[1];
    viewer->depth_shown =
        (struct depth_shown){.is_automatic = shown[2] > 0, .near = shown[3], .far = shown[4]};
    viewer_fit_depth(viewer);
    viewer_mark_stale(viewer);
}

/* As vkao says it, but for what the panel can change. */
static void say_summary(struct viewer *viewer)
{
    struct text summary = {0};
    text_add_summary(&summary, &viewer->source.now.gbuffer);
    if (summary.data)
        report_note(&viewer->report, "using: %s", summary.data);
    text_free(&summary);
}

bool viewer_load(struct viewer *viewer, size_t frame, size_t view)
{
    struct tool_error err = {0};
    const bool other_files = !(viewer->source.radius > 0);
    const VkExtent2D before = viewer_image_extent(viewer);
    struct text warnings = viewer->warnings;
    viewer->warnings = (struct text){0};
    viewer->report.frame++;
    /* What the results were made of goes away below. */
    drop_results(viewer);
    const bool loaded = source_load(&viewer->source, frame, view, &viewer->report, &err);
    text_free(loaded ? &warnings : &viewer->warnings);
    if (!loaded) {
        viewer->warnings = warnings;
        viewer_say_error(viewer, &err);
        return false;
    }
    for (int i = 0; other_files && i < SIDES; i++) {
        if (!(viewer->arguments->settings[i].params.radius > 0))
            viewer->settings[i].params.radius = 0;
        viewer->bias_settled[i] = 0;
    }
    if (other_files) {
        say_summary(viewer);
        complete_settings(viewer);
        const struct history_state now = viewer_state(viewer);
        history_reset(&viewer->history, &now);
    } else {
        settle_frame(viewer);
        const struct history_state now = viewer_state(viewer);
        history_amend(&viewer->history, &now);
    }
    const VkExtent2D after = viewer_image_extent(viewer);
    if (before.width != after.width || before.height != after.height)
        viewer_fit(viewer);
    viewer->status.text[0] = '\0';
    return true;
}

/* --- Opening --- */

static bool open_images(struct viewer *viewer, struct tool_error *err)
{
    const struct arguments *a = viewer->arguments;
    if (a->scene) {
        viewer->live = live_create(&viewer->gpu, a->scene, err);
        if (!viewer->live)
            return false;
        if (a->time >= 0)
            viewer->live->running = false;
        viewer->live->seconds = fmax(a->time, 0);
        complete_settings(viewer);
        return true;
    }
    if (!source_open(&viewer->source, &viewer->gpu, &a->options, a->reference, err))
        return false;
    if (!a->options.input)
        return true;
    plan_say_cameras(&viewer->source.plan, &viewer->report);
    if (!source_load(&viewer->source, 0, 0, &viewer->report, err))
        return false;
    say_summary(viewer);
    complete_settings(viewer);
    return true;
}

/* The image at 1:1 beside the panel, or as much of it as the screen holds. */
static VkExtent2D window_size(const struct viewer *viewer)
{
    const struct arguments *a = viewer->arguments;
    VkExtent2D image = viewer_image_extent(viewer), largest = window_largest();
    const double scale = scale_for(viewer, window_system_scale(), image);
    const uint32_t panel = viewer->show_panel ? (uint32_t)(PANEL_WIDTH * scale + 0.5) : 0;
    const uint32_t panel_height = (uint32_t)(PANEL_HEIGHT * scale);
    if (a->width)
        return (VkExtent2D){a->width, a->height};
    if (viewer->live || image.width == 0)
        image = (VkExtent2D){(uint32_t)(960 * scale), (uint32_t)(600 * scale)};
    image.width += panel;
    if (panel && image.height < panel_height)
        image.height = panel_height;
    if (image.width > largest.width)
        image.width = largest.width;
    if (image.height > largest.height)
        image.height = largest.height;
    return image;
}

static bool open_window(struct viewer *viewer, struct tool_error *err)
{
    struct swapchain *s = &viewer->swapchain;
    return window_create(&viewer->window, window_size(viewer), "vkao-view", err) &&
           window_surface(&viewer->window, viewer->gpu.instance, &viewer->surface, err) &&
           swapchain_create(&viewer->gpu, viewer->surface, s, err) &&
           (swapchain_resize(s, window_framebuffer(&viewer->window), err) || !err->code) &&
           display_create(&viewer->gpu, s->render_pass, &viewer->display, err) &&
           probe_create(&viewer->gpu, &viewer->probe, err);
}

static bool open_panel(struct viewer *viewer, struct tool_error *err)
{
    viewer->panel_is_ready =
        widgets_create(viewer->window.handle, &viewer->gpu, viewer->swapchain.render_pass,
                       viewer->swapchain.image_count, err);
    return viewer->panel_is_ready;
}

static bool create_timestamps(struct viewer *viewer, struct tool_error *err)
{
    if (viewer->gpu.timestamp_bits == 0)
        return true;
    VkResult result = vkCreateQueryPool(viewer->gpu.device,
                                        &(VkQueryPoolCreateInfo){
                                            .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                            .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                            .queryCount = SIDES * FRAMES_IN_FLIGHT * (STAGES + 1),
                                        },
                                        NULL, &viewer->timestamps);
    if (result != VK_SUCCESS)
        viewer->timestamps = VK_NULL_HANDLE;
    return gpu_ok(err, "vkCreateQueryPool", result);
}

void viewer_hear(void *data, const char *warning)
{
    struct text *warnings = data;
    text_add(warnings, "%s", warnings->length ? "\n" : "");
    text_add_printable(warnings, warning);
}

bool viewer_open(struct viewer *viewer, const struct arguments *arguments, struct tool_error *err)
{
    struct viewer *v = viewer;
    *v = (struct viewer){.arguments = arguments,
                         .report = {.verbosity = arguments->options.verbosity,
                                    .heard = viewer_hear,
                                    .heard_data = &v->warnings},
                         .view = arguments->view,
                         .wipe = arguments->wipe >= 0,
                         .wipe_at = arguments->wipe,
                         .wipe_is_placed = arguments->wipe >= 0,
                         .gain = 4,
                         .exposure = arguments->exposure,
                         .depth_shown = {.is_automatic = !(arguments->far > 0),
                                         .near = arguments->near,
                                         .far = arguments->far},
                         .show_panel = !arguments->no_panel,
                         .placing = {.fit = true, .zoom = 1}};
    memcpy(v->settings, arguments->settings, sizeof v->settings);
    memcpy(v->bias_is_given, arguments->bias_is_given, sizeof v->bias_is_given);
    struct gpu_presentation presentation;
    if (!window_system_start(&presentation, err))
        return false;
    const struct gpu_options options = {.device = arguments->options.device,
                                        .validation = arguments->options.validation,
                                        .presentation = &presentation};
    if (!gpu_create(&options, &v->gpu, err))
        return false;
    v->context = gpu_context(&v->gpu, err);
    if (!v->context || !open_images(v, err) || !open_window(v, err) || !open_panel(v, err) ||
        !create_timestamps(v, err))
        return false;
    const struct history_state first = viewer_state(v);
    history_reset(&v->history, &first);
    viewer_mark_stale(v);
    viewer_choose_scale(v);
    viewer_fit(v);
    if (arguments->zoom > 0) {
        const VkRect2D area = viewer_area(v);
        const VkExtent2D image = viewer_image_extent(v);
        v->placing = (struct placing){
            .zoom = arguments->zoom,
            .x = area.offset.x + floor((area.extent.width - image.width * arguments->zoom) / 2),
            .y = area.offset.y + floor((area.extent.height - image.height * arguments->zoom) / 2)};
    }
    return true;
}

void viewer_close(struct viewer *viewer)
{
    struct viewer *v = viewer;
    if (v->gpu.device)
        drop_results(v);
    if (v->panel_is_ready)
        widgets_destroy();
    probe_destroy(&v->probe);
    display_destroy(&v->display);
    swapchain_destroy(&v->swapchain);
    if (v->surface)
        vkDestroySurfaceKHR(v->gpu.instance, v->surface, NULL);
    window_destroy(&v->window);
    source_close(&v->source);
    browser_close(&v->browser);
    text_free(&v->warnings);
    live_destroy(v->live);
    vkao_context_destroy(v->context);
    if (v->timestamps)
        vkDestroyQueryPool(v->gpu.device, v->timestamps, NULL);
    gpu_destroy(&v->gpu);
    window_system_stop();
}
