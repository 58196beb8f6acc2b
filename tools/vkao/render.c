/* SPDX-License-Identifier: MIT */
#include "commands.h"

#include "ao.h"
#include "automatic.h"
#include "clock.h"
#include "gpu.h"
#include "light.h"
#include "output.h"
#include "parallel.h"
#include "placement.h"
#include "plan.h"
#include "summary.h"
#include "views.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What stays from frame to frame. */
struct session {
    const struct options *options;
    struct report *report;
    struct gpu gpu;
    struct ao_session *ao; /* NULL until the driver has started, beside the first view */
    float auto_radius;     /* 0 = not known yet */
    struct frame_memory memory[MAX_VIEWS]; /* by view */
    bool summarised, is_sequence;
    struct record_set made; /* what the output tells that is left and computed again */
    bool has_picture;       /* some frame has shown something */
    bool awaits_picture;    /* and one that shows nothing waits for it */
};

struct times {
    double read, compute, write; /* milliseconds */
};

/* --- Device --- */

static bool session_start(struct session *s, struct tool_error *err)
{
    if (s->ao)
        return true;
    const struct gpu_options options = {.device = s->options->device,
                                        .validation = s->options->validation};
    if (!gpu_create(&options, &s->gpu, err))
        return false;
    s->ao = ao_session_create(&s->gpu, err);
    if (!s->ao)
        gpu_destroy(&s->gpu);
    return s->ao != NULL;
}

static void session_end(struct session *s)
{
    if (!s->ao)
        return;
    ao_session_destroy(s->ao);
    if (s->gpu.validation_messages > 0)
        report_warn(s->report, "validation", "%u messages of the validation layers",
                    s->gpu.validation_messages);
    gpu_destroy(&s->gpu);
    s->ao = NULL;
}

/* "llvmpipe" of "llvmpipe (LLVM 15.0.6, 256 bits)" */
static void device_name(const struct session *s, char *name, size_t size)
{
    snprintf(name, size, "%s", s->gpu.properties.deviceName);
    char *bracket = strstr(name, " (");
    if (bracket)
        *bracket = '\0';
}

/* --- Parameters --- */

/* One radius for all frames: AO must not flicker. */
static float choose_radius(struct session *s, const struct options *o, const struct gbuffer *g)
{
    if (!o->radius_is_auto)
        return o->setting.params.radius;
    if (s->auto_radius > 0)
        return s->auto_radius;
    const float radius = relative_radius_of(&o->relative_radius, g);
    if (g->median_z > 0)
        s->auto_radius = radius;
    return radius;
}

static void summarise(struct session *s, const struct options *o, const struct rendered_view *view)
{
    char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    if (s->summarised)
        return;
    s->summarised = true;
    device_name(s, device, sizeof device);
    struct text reading = {0}, radius = {0};
    text_add_summary(&reading, &view->gbuffer);
    text_add_float(&radius, view->setting.params.radius);
    const char *digits = radius.data ? radius.data : "";
    report_note(s->report, "using: %s radius=%s%s device=%s", reading.data ? reading.data : "",
                digits,
                !o->radius_is_auto              ? ""
                : o->relative_radius.amount > 0 ? " (by --radius)"
                                                : " (auto)",
                device);
    if (o->radius_is_auto && s->is_sequence)
        report_note(s->report, "other parts of the sequence get the same with --radius %s", digits);
    text_free(&reading);
    text_free(&radius);
}

static void tell_details(const struct session *s, const struct frame_source *source,
                         const struct rendered_view *view)
{
    const struct gbuffer *g = &view->gbuffer;
    for (int k = 0; k < ROLE_KINDS; k++)
        if (g->roles.kind[k].found)
            report_detail(s->report, "%s: %s%s%s: %s (part %zu)", g->roles.kind[k].info->path,
                          view->name, *view->name ? ": " : "", role_names[k].said,
                          g->roles.kind[k].label, g->roles.kind[k].part);
    report_detail(s->report, "%s: view z %.5g to %.5g, median %.5g; background %.3g %%",
                  source->info.path, g->min_z, g->max_z, g->median_z, g->background_share * 100.0);
}

/* --- One frame --- */

static bool compute(struct session *s, struct rendered_view *view, struct tool_error *err)
{
    struct gbuffer *g = &view->gbuffer;
    struct placement placement;
    if (!placement_expand(g, &placement, err))
        return false;
    const struct ao_job job = {
        .width = g->width + placement.left,
        .height = g->height + placement.top,
        .depth = g->depth,
        .normals = g->normals,
        .color = g->color,
        .thickness = g->thickness,
        .second_depth = g->second_depth,
        .albedo = g->albedo,
        .specular = g->specular,
        .view = g->view,
        .setting = view->setting,
    };
    if (!ao_run(s->ao, &job, &view->result, err))
        return false;
    placement_crop(&placement, g, &view->result);
    light_finish(g, &view->result);
    return placement_widen(g, &view->result, err);
}

/* Pixels of a view, and the driver before the first one: neither waits for the other. */
struct opening {
    struct session *session;
    const struct options *options; /* of the view */
    const struct frame_source *source;
    const struct view *view;
    struct gbuffer *gbuffer;
    uint64_t held_bytes;
    double read_ms;
    bool is_read, is_started;
    struct tool_error read_err, start_err;
};

enum opening_part { OPENING_PIXELS, OPENING_DEVICE, OPENING_PARTS };

static void open_part(void *data, uint32_t part)
{
    struct opening *o = data;
    if (part == OPENING_DEVICE) {
        o->is_started = session_start(o->session, &o->start_err);
        return;
    }
    struct gbuffer_options options = view_options(o->options, o->view);
    view_reserve_work(&options, &o->options->setting.effect);
    options.held_bytes = o->held_bytes;
    options.memory = &o->session->memory[o->view - o->source->views];
    options.empty = o->session->has_picture      ? EMPTY_IS_OPEN
                    : o->session->awaits_picture ? EMPTY_IS_LATE
                                                 : EMPTY_IS_MISTAKE;
    const double start = now_ms();
    o->is_read = gbuffer_load(&o->source->info, &options, o->view->camera, o->session->report,
                              o->gbuffer, &o->read_err);
    o->read_ms = now_ms() - start;
}

static bool open_view(struct session *s, const struct options *options,
                      const struct frame_source *source, const struct view *view,
                      uint64_t held_bytes, struct gbuffer *g, struct times *times,
                      struct tool_error *err)
{
    struct opening o = {
        .session = s,
        .options = options,
        .source = source,
        .view = view,
        .gbuffer = g,
        .held_bytes = held_bytes,
        .is_started = s->ao != NULL,
    };
    const uint32_t parts = o.is_started ? 1 : OPENING_PARTS; /* the device, the last, but once */
    if (s->options->validation) {
        /* Its layers are set up through the environment, which threads must not see change. */
        for (uint32_t part = 0; part < parts; part++)
            open_part(&o, part);
    } else {
        parallel_run(NULL, parts, open_part, &o);
    }
    times->read += o.read_ms;
    o.start_err.ends_run = !o.is_started;
    if (!o.is_read || !o.is_started)
        *err = o.is_read ? o.start_err : o.read_err;
    return o.is_read && o.is_started;
}

/* What the views of a frame keep until they are written. */
static uint64_t held_by(const struct rendered_view *views, size_t count)
{
    uint64_t bytes = 0;
    for (size_t i = 0; i < count; i++) {
        const struct ao_result *r = &views[i].result;
        const uint64_t vectors = (views[i].gbuffer.color ? UINT64_C(1) : 0) +
                                 (r->output ? UINT64_C(1) : 0) + (r->bent ? UINT64_C(1) : 0);
        const struct exr_box *w = &views[i].gbuffer.color_window;
        const uint64_t wide = ((uint64_t)((int64_t)w->x_max - w->x_min) + 1) *
                              ((uint64_t)((int64_t)w->y_max - w->y_min) + 1);
        const uint64_t texels = (uint64_t)views[i].gbuffer.width * views[i].gbuffer.height;
        if (texels > 0)
            bytes += sizeof(float) * (texels + 4 * vectors * (wide > texels ? wide : texels));
    }
    return bytes;
}

/* The same bits come from the same code on the same device only. */
static void compare_makers(struct session *s, const struct record *record)
{
    char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE], version[VERSION_BYTES];
    device_name(s, device, sizeof device);
    version_string(version);
    if (strcmp(record->device, device) != 0 || strcmp(record->version, version) != 0)
        report_warn(
            s->report, "like",
            "--like: made by vkao %s on %s, now vkao %s on %s: AO may differ in its last bits",
            record->version, record->device, version, device);
}

static void compare_settings(const struct session *s, const struct record *made,
                             const struct setting *setting)
{
    struct text others = {0};
    uint32_t count;
    const vkao_parameter *parameters = vkao_parameters(&count);
    for (uint32_t i = 0; i < count; i++)
        if (!parameter_is_of_images(&parameters[i]) &&
            !parameter_equals(&parameters[i], &made->setting, setting))
            text_add(&others, "%s%s", others.length ? ", " : "", parameters[i].name);
    if (others.length && others.data)
        report_warn(s->report, "settings",
                    "frames that exist were made with other settings than the rest will be, in "
                    "%s (--like FRAME takes those of a frame that exists)",
                    others.data);
    text_free(&others);
}

static bool render_view(struct session *s, const struct options *frame_options,
                        const struct frame_source *source, const struct view *view,
                        uint64_t held_bytes, struct rendered_view *out, struct times *times,
                        struct tool_error *err)
{
    struct gbuffer *g = &out->gbuffer;
    struct options options = *frame_options;
    out->name = view->name;
    if (view->record && !options_take_record(&options, view->record, err))
        return false;
    if (!open_view(s, &options, source, view, held_bytes, g, times, err))
        return false;
    if (view->record)
        compare_makers(s, view->record);
    s->has_picture |= s->is_sequence && g->median_z > 0;
    out->setting = options.setting;
    out->setting.params.radius = choose_radius(s, &options, g);
    check_radius(g, out->setting.params.radius, s->report);
    if (!options.bias_is_given)
        out->setting.params.bias =
            settled_bias(g, out->setting.params.radius, out->setting.params.bias, s->report);
    ao_view_describe(&g->view, &out->setting.effect);
    const struct record *made = record_set_find(&s->made, view->name);
    if (made)
        compare_settings(s, made, &out->setting);
    summarise(s, &options, out);
    tell_details(s, source, out);
    double start = now_ms();
    bool ok = compute(s, out, err);
    times->compute += now_ms() - start;
    gbuffer_free_inputs(g);
    return ok;
}

/* The header, its views, and what --like says of them: options as they are for this frame. */
static bool open_frame(const struct plan_frame *frame, struct options *options,
                       struct frame_source *source, struct tool_error *err)
{
    if (!plan_check_outputs(options, frame, err) ||
        !frame_source_read_header(frame->input, source, err) ||
        !frame_source_read_files((const char *const *)frame->file, source, err) ||
        (frame->like && !frame_source_read_like(frame->like, source, err)) ||
        !frame_source_choose_views(options, frame->camera, source, err))
        return false;
    const struct record *record = source->views[0].record;
    return (!record || options_take_record(options, record, err)) &&
           output_check_names(options, frame, source, err);
}

static bool render_frame(struct session *s, const struct plan_frame *frame, struct tool_error *err)
{
    struct options options = *s->options;
    struct frame_source source = {0};
    struct rendered_view views[MAX_VIEWS];
    struct times times = {0};
    memset(views, 0, sizeof views);
    double start = now_ms();
    bool ok = open_frame(frame, &options, &source, err);
    times.read = now_ms() - start;
    for (size_t i = 0; ok && i < source.view_count; i++)
        ok = render_view(s, &options, &source, &source.views[i], held_by(views, i), &views[i],
                         &times, err) ||
             plan_fail_of_frame(frame, err);
    start = now_ms();
    char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    device_name(s, device, sizeof device);
    const bool is_written = ok && !frame->is_left;
    ok = ok && (!is_written || output_write(&options, frame, &source, views, device, err));
    times.write = now_ms() - start;
    if (ok && is_written)
        report_detail(s->report, "%s: read %.0f ms, compute %.0f ms, write %.0f ms", frame->output,
                      times.read, times.compute, times.write);
    for (size_t i = 0; i < MAX_VIEWS; i++) {
        gbuffer_free(&views[i].gbuffer);
        ao_result_free(&views[i].result);
    }
    frame_source_close(&source);
    return ok;
}

/* A missing file of a sequence: say which ones there are. */
static void hint_at_frames(const struct plan *plan, const struct plan_frame *frame,
                           const struct options *options, struct tool_error *err)
{
    if (err->code == EXIT_INPUT && plan->is_sequence && access(frame->input, F_OK) != 0)
        fail_hint(err, "frames found: %s (pattern %s)", plan->found[0] ? plan->found : "none",
                  options->input);
}

/* Its record has the radius. What else is kept from frame to frame, as a camera that is estimated,
 * is found by computing it again. */
static void learn_from(struct session *s, const struct plan_frame *frame)
{
    struct tool_error err = {0};
    if (!record_set_read(frame->output, &s->made, &err)) {
        report_warn(s->report, "left", "%s: left as it is, whatever made it", err.message);
        return;
    }
    if (s->options->radius_is_auto && s->auto_radius <= 0)
        s->auto_radius = s->made.records[0].setting.params.radius;
    report_note(s->report, "%s: exists, computed again for what all frames share", frame->output);
    if (!render_frame(s, frame, &err) && !err.shows_nothing)
        report_warn(s->report, "left", "%s: it is not known what all frames share but the radius",
                    err.message);
    record_set_free(&s->made);
}

/* Frames are made like those that are there: the first of these that shows something tells how. */
static void learn_from_left(struct session *s, const struct plan *plan)
{
    size_t left = 0;
    for (size_t i = 0; i < plan->count; i++)
        left += plan->frames[i].is_left;
    s->awaits_picture = true; /* one that shows nothing is no mistake */
    for (size_t i = 0; left < plan->count && i < plan->count && !s->has_picture; i++)
        if (plan->frames[i].is_left)
            learn_from(s, &plan->frames[i]);
}

/* False if the run ends, with *code. */
static bool try_frame(struct session *s, const struct plan *plan, struct plan_frame *frame,
                      size_t *failed, int *code)
{
    struct tool_error err = {0};
    s->report->frame++;
    if (plan->is_sequence)
        report_note(s->report, "frame %zu/%zu (%" PRId64 "): %s",
                    (size_t)(frame - plan->frames) + 1, plan->count, frame->number, frame->output);
    frame->is_late = false;
    frame->is_left = frame->is_left || plan_leaves(s->options, frame->output);
    if (frame->is_left) {
        report_note(s->report, "%s: exists, left as it is", frame->output);
        return true;
    }
    if (render_frame(s, frame, &err))
        return true;
    /* Another machine of a farm that works on the same frames, say. */
    if (err.code == EXIT_OUTPUT && plan_leaves(s->options, frame->output)) {
        report_note(s->report, "%s: somebody else has made it meanwhile, left as it is",
                    frame->output);
        return true;
    }
    if (err.shows_nothing) {
        frame->is_late = true;
        report_note(s->report, "%s: it is made after the first frame that shows something",
                    err.message);
        return true;
    }
    hint_at_frames(plan, frame, s->options, &err);
    report_error(&err);
    ++*failed;
    *code = err.code;
    return s->options->continue_on_error && !err.ends_run;
}

/* What is kept from frame to frame, as the radius, is that of the first frame that shows something:
 * those before it come after it, or are mistakes if there is none. */
static int render_plan(struct session *s, struct plan *plan)
{
    size_t failed = 0, first_late = 0;
    int code = EXIT_OK;
    if (plan->is_sequence)
        learn_from_left(s, plan);
    s->awaits_picture = plan->is_sequence && plan->count > 1;
    for (size_t i = 0; i < plan->count; i++) {
        if (!try_frame(s, plan, &plan->frames[i], &failed, &code))
            return code;
        const bool is_last = i + 1 == plan->count;
        s->awaits_picture &= !is_last;
        for (; first_late <= i && (s->has_picture || is_last); first_late++)
            if (plan->frames[first_late].is_late &&
                !try_frame(s, plan, &plan->frames[first_late], &failed, &code))
                return code;
    }
    if (failed)
        report_note(s->report, "%zu of %zu frames failed", failed, plan->count);
    return failed ? EXIT_SOME_FRAMES : EXIT_OK;
}

int command_render(const struct options *options, struct report *report)
{
    struct session session = {.options = options, .report = report};
    struct tool_error err = {0};
    struct plan plan;
    if (!plan_make(options, &plan, &err)) {
        report_error(&err);
        return err.code;
    }
    session.is_sequence = plan.is_sequence;
    plan_say_cameras(&plan, report);
    int code = render_plan(&session, &plan);
    session_end(&session);
    plan_free(&plan);
    return code;
}
