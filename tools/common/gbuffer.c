/* SPDX-License-Identifier: MIT */
#include "gbuffer.h"

#include "gbuffer_internal.h"
#include "placement.h"
#include "text.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *normal_space_name(enum normal_space space)
{
    static const char *const names[] = {"auto", "world", "camera"};
    return names[space];
}

const char *pixel_type_name(enum exr_pixel_type type)
{
    static const char *const names[] = {"uint", "half", "float"};
    return names[type];
}

static bool check_role(const struct role *role, struct tool_error *err)
{
    for (size_t i = 0; i <= ROLE_MAX_COMPONENTS; i++) {
        const struct exr_channel *c = role->channels[i];
        if (c && (c->x_sampling != 1 || c->y_sampling != 1))
            return fail(err, EXIT_INPUT,
                        "%s: channel '%s' is sub-sampled %dx%d, want full resolution",
                        role->info->path, c->name, (int)c->x_sampling, (int)c->y_sampling);
    }
    return true;
}

/* Of a depth that is none, and where anything is left to be told. */
static bool wants_positions(const struct gbuffer *g, const struct gbuffer_options *options)
{
    const bool is_told = options->depth_type != DEPTH_AUTO || options->roles.name[ROLE_DEPTH];
    return g->depth_type == DEPTH_POSITION ||
           (g->roles.kind[ROLE_POSITION].found && !(is_told && g->camera.source[0]));
}

static const struct role *role_of_positions(const struct gbuffer *g)
{
    return &g->roles.kind[g->depth_type == DEPTH_POSITION ? ROLE_DEPTH : ROLE_POSITION];
}

/* *positions: malloc'ed, or NULL where none are wanted. */
static bool read_positions(const struct gbuffer *g, const struct gbuffer_options *options,
                           float **positions, struct tool_error *err)
{
    *positions = NULL;
    if (!wants_positions(g, options))
        return true;
    *positions = gbuffer_read_role(g, role_of_positions(g), 4, 0.0f, err);
    return *positions != NULL;
}

static bool use_positions(struct gbuffer *g, const struct gbuffer_options *options,
                          float *positions, struct report *report, struct tool_error *err)
{
    return !positions || gbuffer_use_positions(g, options, positions,
                                               role_of_positions(g)->info->path, report, err);
}

static const struct exr_channel *alpha_channel(const struct gbuffer *g)
{
    const struct role *color = &g->roles.kind[ROLE_COLOR];
    return color->found ? color->channels[ROLE_MAX_COMPONENTS] : NULL;
}

/* With alpha, if it lies beside it: to decode a part twice takes twice as long. */
static bool read_depth(struct gbuffer *g, struct tool_error *err)
{
    const struct role *role = &g->roles.kind[ROLE_DEPTH], *color = &g->roles.kind[ROLE_COLOR];
    const bool has_alpha = alpha_channel(g) && color->info == role->info &&
                           color->part == role->part && g->depth_type != DEPTH_POSITION;
    g->depth = gbuffer_allocate(gbuffer_texels(g), 1, role->info->path, err);
    if (g->depth && g->depth_type == DEPTH_POSITION)
        return true; /* filled when the camera is known */
    if (g->depth && has_alpha)
        g->alpha = gbuffer_allocate(gbuffer_texels(g), 1, role->info->path, err);
    struct exr_read reads[2] = {{role->channels[0]->name, g->depth, 1}};
    if (has_alpha)
        reads[1] = (struct exr_read){alpha_channel(g)->name, g->alpha, 1};
    return g->depth && (!has_alpha || g->alpha) &&
           exr_read_channels(role->info, role->part, reads, has_alpha ? 2 : 1, err);
}

/* A picture in colours is no depth, whatever its red is. Lossy compression leaves grey nearly so;
 * a green of zero is none that anybody wrote. */
static bool check_grey(const struct gbuffer *g, struct report *report, struct tool_error *err)
{
    const struct role *depth = &g->roles.kind[ROLE_DEPTH];
    const size_t texels = gbuffer_texels(g);
    size_t colored = 0, used = 0;
    if (!depth->twin)
        return true;
    if (depth->is_guessed)
        report_warn(report, "grey depth",
                    "%s: no channel is called depth, but the file is: '%s' of its grey image is "
                    "taken (--depth NAME says another)",
                    depth->info->path, depth->channels[0]->name);
    const struct role role = {.info = depth->info, .part = depth->part, .channels = {depth->twin}};
    float *twin = gbuffer_read_role(g, &role, 1, 0.0f, err);
    for (size_t i = 0; twin && i < texels; i++) {
        const float a = g->depth[i], b = twin[i];
        colored += fabsf(a - b) > 0.01f * fmaxf(fabsf(a), fabsf(b));
        used += fabsf(b) > 0.0f;
    }
    free(twin);
    if (!twin || colored * 100 <= texels || (!depth->is_guessed && used == 0))
        return twin != NULL;
    fail_hint(err, "give the file of the depth; or if one channel is depth, say which: --depth %s",
              depth->channels[0]->name);
    return fail(err, EXIT_CHANNELS, "%s: '%s' and '%s' differ: a picture in colours, no depth",
                depth->info->path, depth->channels[0]->name, depth->twin->name);
}

/* Of 10 bits, say, the largest is far below the one that is taken for 1. */
static void warn_about_bits(const struct gbuffer *g, double most, double full,
                            struct report *report)
{
    const struct role *role = &g->roles.kind[ROLE_DEPTH];
    const struct depth_range *r = &g->depth_range;
    char remedy[96] = "";
    const double white = gbuffer_all_bits(most, 1.0);
    const double end = r->zero + (r->one - r->zero) * full / white;
    if (most * 4.0 > full + 1.0)
        return;
    if (r->is_given && end >= 0)
        snprintf(remedy, sizeof remedy, ", or --depth-range %.6g,%.6g%s", fmin(r->zero, end),
                 fmax(r->zero, end), r->one < r->zero ? ",inverted" : "");
    report_warn(report, "few bits",
                "%s: depth '%s' is whole numbers up to %.10g, and parts of %.10g are read: if "
                "%.10g is 1, distances and AO are wrong; write it in 8, 16, 24 or 32 bits%s",
                role->info->path, role->label, most, full, white, remedy);
}

static double largest_whole(const struct gbuffer *g)
{
    float most = 0;
    for (size_t i = 0; i < gbuffer_texels(g); i++)
        most = fmaxf(most, g->depth[i]);
    return (double)most;
}

/* Whole numbers are units, millimetres say, or parts of the largest that fits into 8, 16, 24 or 32
 * bits. Of a depth buffer or a range that somebody names they are the latter, and become 0 to 1. */
static bool settle_whole_numbers(struct gbuffer *g, const struct gbuffer_options *options,
                                 struct report *report, struct tool_error *err)
{
    static const float far_off = 1048576.0f; /* a kilometre in millimetres */
    const struct role *role = &g->roles.kind[ROLE_DEPTH];
    const bool is_part =
        options->depth_type == DEPTH_DEVICE || options->depth_type == DEPTH_NORMALIZED;
    size_t seen = 0, far = 0;
    if (g->depth_type == DEPTH_POSITION || role->channels[0]->type != EXR_UINT)
        return true;
    const double most = largest_whole(g), full = gbuffer_full_range(most);
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const float d = g->depth[i];
        seen += d > 0 && d < 4294967295.0f;
        far += d > far_off && d < 4294967295.0f;
    }
    for (size_t i = 0; is_part && i < gbuffer_texels(g); i++)
        g->depth[i] /= (float)full;
    if (options->depth_type == DEPTH_NORMALIZED)
        warn_about_bits(g, most, full, report);
    if (options->depth_type != DEPTH_AUTO || far * 2 <= seen)
        return true;
    fail_hint(err,
              "--depth-type normalized --depth-range NEAR,FAR[,inverted], or device with --near "
              "and --far, take %.10g for 1; planar if these are scene units",
              full);
    return fail(err, EXIT_CHANNELS,
                "%s: depth '%s' is whole numbers up to %.6g: parts of a range or a depth "
                "buffer, not in scene units?",
                role->info->path, role->label, most);
}

/* Alpha of another part is only read if depth does not say by itself where there is nothing. */
static bool read_alpha(struct gbuffer *g, struct tool_error *err)
{
    const struct role *color = &g->roles.kind[ROLE_COLOR];
    const struct exr_channel *alpha = alpha_channel(g);
    bool is_known = g->alpha || !alpha;
    for (size_t i = 0; !is_known && i < gbuffer_texels(g); i++)
        is_known = !gbuffer_is_measurable(fabs((double)g->depth[i]));
    if (is_known)
        return true;
    const struct role role = {.info = color->info, .part = color->part, .channels = {alpha}};
    g->alpha = gbuffer_read_role(g, &role, 1, 1.0f, err);
    return g->alpha != NULL;
}

/* --- Frames that show nothing --- */

static bool look_for_nothing(struct gbuffer *g, const struct gbuffer_options *options,
                             const float *positions, bool *is_empty, struct tool_error *err)
{
    *is_empty = false;
    if (options->empty == EMPTY_IS_MISTAKE)
        return true;
    if (g->depth_type == DEPTH_POSITION) {
        *is_empty = gbuffer_is_one_point(g, positions);
        return true;
    }
    if (!read_alpha(g, err))
        return false;
    *is_empty = gbuffer_is_empty(g, options);
    return true;
}

/* Such a frame tells nothing of camera and conventions, and all that could be said of it is said by
 * this: *as_read and *memory, which is not that of the frames before, are for what follows. */
static bool take_nothing(struct gbuffer *g, const struct gbuffer_options *options,
                         struct gbuffer_options *as_read, struct frame_memory *memory,
                         struct report *report, struct tool_error *err)
{
    const struct role *depth = &g->roles.kind[ROLE_DEPTH];
    const char *what = g->depth_type == DEPTH_POSITION ? "positions" : "depth";
    if (options->empty == EMPTY_IS_LATE) {
        err->shows_nothing = true;
        return fail(err, EXIT_CHANNELS, "%s: %s '%s' is all background", depth->info->path, what,
                    depth->label);
    }
    report_warn_of_frame(report, "empty frame",
                         "%s: %s '%s' is all background: this frame shows nothing, and AO is 1",
                         depth->info->path, what, depth->label);
    *as_read = *options;
    if (options->memory) {
        *memory = *options->memory;
        as_read->memory = memory;
    }
    as_read->normal_space = NORMAL_SPACE_AUTO;
    if (options->depth_type == DEPTH_AUTO || g->depth_type == DEPTH_POSITION) {
        as_read->depth_type = g->depth_type = DEPTH_PLANAR;
        g->depth_source = DEPTH_BY_OPTION;
        memset(g->depth, 0, gbuffer_texels(g) * sizeof *g->depth);
    }
    return true;
}

/* What is known beside the depth. A window that lacks a texel knows nothing of it: NaN. */
static bool read_behind(struct gbuffer *g, enum role_kind kind, float **values,
                        struct layer_signs *signs, struct tool_error *err)
{
    const struct role *role = &g->roles.kind[kind];
    if (!role->found)
        return true;
    *values = gbuffer_read_role(g, role, 1, NAN, err);
    if (*values)
        *signs = gbuffer_look_at_signs(g, *values, kind != ROLE_THICKNESS && g->depth_is_negated);
    return *values != NULL;
}

static bool read_color(struct gbuffer *g, struct tool_error *err)
{
    const struct role *role = &g->roles.kind[ROLE_COLOR];
    g->color = gbuffer_read_role(g, role, 4, 0.0f, err);
    if (!g->color)
        return false;
    g->color_has_alpha = role->channels[ROLE_MAX_COMPONENTS] != NULL;
    gbuffer_complete_alpha(g, g->color, gbuffer_texels(g));
    return true;
}

/* What of the colour AO is to darken, and what belongs to that. */
static bool read_light(struct gbuffer *g, struct tool_error *err)
{
    const struct role *roles = g->roles.kind;
    const size_t texels = gbuffer_texels(g);
    float *indirect = NULL, *roughness = NULL;
    bool ok = read_color(g, err);
    if (ok && roles[ROLE_INDIRECT].found)
        ok = (indirect = gbuffer_read_role(g, &roles[ROLE_INDIRECT], 4, 0.0f, err)) != NULL;
    if (ok && roles[ROLE_ALBEDO].found)
        ok = (g->albedo = gbuffer_read_role(g, &roles[ROLE_ALBEDO], 4, 0.0f, err)) != NULL;
    if (ok && roles[ROLE_SPECULAR].found)
        ok = (g->specular = gbuffer_read_role(g, &roles[ROLE_SPECULAR], 4, 0.0f, err)) != NULL;
    if (ok && roles[ROLE_ROUGHNESS].found)
        ok = (roughness = gbuffer_read_role(g, &roles[ROLE_ROUGHNESS], 1, 0.5f, err)) != NULL;
    for (size_t i = 0; ok && g->specular && i < texels; i++)
        g->specular[i * 4 + 3] = roughness ? roughness[i] : 0.5f;
    if (ok && (indirect || g->specular))
        ok = (g->kept = gbuffer_allocate(texels, 4, roles[ROLE_COLOR].info->path, err)) != NULL;
    for (size_t i = 0; ok && g->kept && i < texels * 4; i++) {
        const float specular = g->specular ? g->specular[i] : 0.0f;
        const float darkened = indirect ? indirect[i] : g->color[i] - specular;
        if (i % 4 == 3)
            continue; /* alpha stays */
        g->kept[i] = g->color[i] - darkened - specular;
        g->color[i] = darkened;
    }
    free(indirect);
    free(roughness);
    return ok;
}

/* Bytes per texel of a role with so many components, and what reading it takes for a while: the
 * decoder and, if its window is another, an image of that. */
static void add_role(const struct gbuffer *g, const struct role *role, uint64_t components,
                     uint64_t *texel_bytes, uint64_t *for_a_while)
{
    const struct exr_part *part = &role->info->parts[role->part];
    const bool same = gbuffer_same_box(&part->data_window, &g->data_window);
    const uint64_t role_bytes = components * sizeof(float);
    const uint64_t bytes =
        part->decode_bytes +
        (same ? 0 : (uint64_t)gbuffer_box_texels(&part->data_window) * role_bytes);
    *texel_bytes += role_bytes;
    *for_a_while = bytes > *for_a_while ? bytes : *for_a_while;
}

/* Sizes are at most 2^30 texels of less than 2^10 bytes: nothing here overflows. */
static bool check_budget(const struct exr_info *info, const struct gbuffer_options *options,
                         const struct gbuffer *g, struct tool_error *err)
{
    const struct role *depth = &g->roles.kind[ROLE_DEPTH], *normal = &g->roles.kind[ROLE_NORMAL],
                      *color = &g->roles.kind[ROLE_COLOR];
    const struct exr_part *color_part = color->found ? &color->info->parts[color->part] : NULL;
    const struct placement placement = placement_of(&g->data_window, &g->display_window);
    const uint64_t work_texels =
        ((uint64_t)g->width + placement.left) * (g->height + placement.top);
    uint64_t texel_bytes = sizeof(float),
             for_a_while = depth->info->parts[depth->part].decode_bytes;
    if (!budget_allows_pixels(&options->budget, info->path, g->width, g->height, err))
        return false;
    if (normal->found)
        add_role(g, normal, 4, &texel_bytes, &for_a_while);
    if (wants_positions(g, options))
        add_role(g, &g->roles.kind[ROLE_POSITION], 4, &texel_bytes, &for_a_while);
    if (options->want_color)
        add_role(g, color, 4, &texel_bytes, &for_a_while);
    const struct exr_box *window = color_part ? &color_part->data_window : &g->data_window;
    /* Colour and composite once more, see placement_widen. */
    const uint64_t wide = options->want_color && !gbuffer_same_box(window, &g->data_window)
                              ? (uint64_t)gbuffer_box_texels(window) * 8 * sizeof(float)
                              : 0;
    if (alpha_channel(g))
        add_role(g, color, 1, &texel_bytes, &for_a_while);
    for (int kind = ROLE_THICKNESS; kind < ROLE_KINDS; kind++)
        if (g->roles.kind[kind].found)
            add_role(g, &g->roles.kind[kind], role_is_scalar((enum role_kind)kind) ? 1 : 4,
                     &texel_bytes, &for_a_while);
    for (int kind = ROLE_HOLDOUT; kind <= ROLE_NO_CAST; kind++)
        if (g->roles.kind[kind].label[0] && !g->roles.kind[kind].found)
            texel_bytes += 3 * sizeof(float); /* objects: covered, and a pair at a time */
    if (g->roles.kind[ROLE_INDIRECT].found || g->roles.kind[ROLE_SPECULAR].found)
        texel_bytes += 4 * sizeof(float); /* what is kept of the colour */
    const uint64_t work = work_texels * (options->work_texel_bytes +
                                         (normal->found ? options->work_normals_texel_bytes : 0));
    const uint64_t bytes = options->held_bytes + wide + work_texels * texel_bytes +
                           (for_a_while > work ? for_a_while : work);
    return budget_allows_memory(&options->budget, info->path, g->width, g->height, bytes, err);
}

/* What lies in several files must be one picture. */
static bool check_file(const struct exr_info *info, size_t part, const struct gbuffer *g,
                       struct tool_error *err)
{
    const struct exr_box *is = &info->parts[part].display_window, *want = &g->display_window;
    const char *depth = g->roles.kind[ROLE_DEPTH].info->path;
    if (gbuffer_same_box(is, want))
        return true;
    fail_hint(err, "give files of one frame and size, rendered by one camera");
    return fail(err, EXIT_INPUT,
                "%s: display window (%d %d) - (%d %d), but the depth in %s has (%d %d) - (%d %d)",
                info->path, is->x_min, is->y_min, is->x_max, is->y_max, depth, want->x_min,
                want->y_min, want->x_max, want->y_max);
}

static bool check_files(const struct exr_info *info, const struct gbuffer_options *options,
                        const struct gbuffer *g, struct tool_error *err)
{
    for (int kind = ROLE_DEPTH; kind < ROLE_FILES; kind++) {
        const struct role *role = &g->roles.kind[kind];
        const bool is_read = role->found && (kind != ROLE_COLOR || options->want_color);
        if (is_read && role->info != info && !check_file(role->info, role->part, g, err))
            return false;
    }
    return g->roles.kind[ROLE_DEPTH].info == info || check_file(info, 0, g, err);
}

static bool fail_without_color(const struct exr_info *info, const struct gbuffer_options *options,
                               struct tool_error *err)
{
    struct text list = {0};
    roles_list_colors(info, &options->roles, &list);
    fail_hint(err, "say which it is: --color NAME");
    fail(err, EXIT_CHANNELS,
         "%s: no colour found, which --mode comp needs; layers with colours: %s", info->path,
         list.data ? list.data : "none");
    text_free(&list);
    return false;
}

static bool check_light(const struct gbuffer *g, struct tool_error *err)
{
    const struct role *specular = &g->roles.kind[ROLE_SPECULAR];
    if (!specular->found || g->roles.kind[ROLE_NORMAL].found)
        return true;
    fail_hint(err, "name the normals with --normal, or leave --specular out");
    return fail(err, EXIT_CHANNELS, "%s: --specular needs normals, and there are none",
                specular->info->path);
}

static bool has_channel(const struct role *role, const struct exr_channel *channel)
{
    for (size_t i = 0; role->found && i < ROLE_MAX_COMPONENTS; i++)
        if (role->channels[i] == channel)
            return true;
    return false;
}

/* Depth is not behind itself, and neither it nor normals cover anything. */
static bool check_meaning(const struct gbuffer *g, struct tool_error *err)
{
    static const struct {
        enum role_kind kind;
        const char *option;
    } named[] = {{ROLE_THICKNESS, "thickness-channel"},
                 {ROLE_BACK_DEPTH, "back-depth"},
                 {ROLE_LAYER2, "layer2"},
                 {ROLE_HOLDOUT, "holdout"},
                 {ROLE_NO_CAST, "no-cast"}};
    static const struct {
        enum role_kind kind;
        const char *what;
    } taken[] = {{ROLE_DEPTH, "the depth itself"},
                 {ROLE_NORMAL, "a component of the normals"},
                 {ROLE_POSITION, "a component of the positions"}};
    for (size_t n = 0; n < sizeof named / sizeof *named; n++)
        for (size_t t = 0; t < sizeof taken / sizeof *taken; t++) {
            const struct role *role = &g->roles.kind[named[n].kind];
            if (!role->found || !has_channel(&g->roles.kind[taken[t].kind], role->channels[0]))
                continue;
            fail_hint(err, "name another channel, or leave --%s out", named[n].option);
            return fail(err, EXIT_CHANNELS, "%s: --%s '%s' is %s", role->info->path,
                        named[n].option, role->label, taken[t].what);
        }
    return true;
}

/* Everything that the header alone decides. */
static bool resolve(const struct exr_info *info, const struct gbuffer_options *options,
                    const struct camera *camera_file, struct gbuffer *g, struct tool_error *err)
{
    enum { MAX_EXTENT = 65536 };
    if (!roles_resolve(info, &options->roles, &g->roles, err))
        return false;
    const struct role *depth = &g->roles.kind[ROLE_DEPTH];
    const struct exr_part *part = &depth->info->parts[depth->part];
    int64_t width = (int64_t)part->data_window.x_max - part->data_window.x_min + 1;
    int64_t height = (int64_t)part->data_window.y_max - part->data_window.y_min + 1;
    if (width < 1 || height < 1 || width > MAX_EXTENT || height > MAX_EXTENT)
        return fail(err, EXIT_INPUT, "%s: data window is %lld x %lld, want 1 to %d texels",
                    depth->info->path, (long long)width, (long long)height, MAX_EXTENT);
    g->width = (uint32_t)width;
    g->height = (uint32_t)height;
    g->data_window = g->color_window = part->data_window;
    g->display_window = part->display_window;
    g->pixel_aspect = part->pixel_aspect;
    camera_resolve(&options->camera, camera_file, depth->info, depth->part, &g->camera);
    if (!g->camera.source[0] && depth->info != info)
        camera_resolve(&options->camera, camera_file, info, 0, &g->camera);
    if (g->camera.unsupported[0]) {
        fail_hint(err, "if it is one after all: --fov, --ortho or --camera");
        return fail(err, EXIT_CHANNELS,
                    "%s: %s in the header: no perspective and no orthographic camera took this",
                    info->path, g->camera.unsupported);
    }
    g->depth_type = options->depth_type != DEPTH_AUTO ? options->depth_type
                    : depth->depth_type != DEPTH_AUTO ? depth->depth_type
                                                      : DEPTH_PLANAR;
    g->depth_range = options->depth_range;
    if (depth->depth_type == DEPTH_POSITION)
        g->depth_type = DEPTH_POSITION; /* whatever --depth-type says of numbers */
    if (options->want_color && !g->roles.kind[ROLE_COLOR].found)
        return fail_without_color(info, options, err);
    for (int kind = ROLE_THICKNESS; kind < ROLE_KINDS; kind++)
        if (!check_role(&g->roles.kind[kind], err))
            return false;
    return check_files(info, options, g, err) && check_role(depth, err) &&
           check_role(&g->roles.kind[ROLE_NORMAL], err) &&
           (!options->want_color || check_role(&g->roles.kind[ROLE_COLOR], err)) &&
           check_light(g, err) && check_meaning(g, err) && check_budget(info, options, g, err);
}

/* Curved things alone say nothing; normals that agree with the depth do. */
static void warn_about_assumption(const struct gbuffer *g, struct report *report)
{
    const struct role *depth = &g->roles.kind[ROLE_DEPTH];
    if (g->depth_source == DEPTH_ASSUMED && g->normal_agreement < 0.5 && g->median_z > 0)
        report_warn(report, "assumed depth",
                    "%s: depth '%s' is taken for planar: nothing shows what it measures "
                    "(--depth-type planar, radial or inverse says it)",
                    depth->info->path, depth->label);
}

/* What is odd about the file itself, whatever its pixels are. */
static void warn_about_file(const struct exr_info *info, struct report *report)
{
    if (info->table_rebuilt)
        report_warn(report, "chunk table",
                    "%s: the chunk table is empty, its writer did not finish: rebuilt from the "
                    "chunks",
                    info->path);
    for (size_t p = 0; p < info->part_count; p++)
        for (size_t i = 0; i < info->parts[p].attribute_count; i++)
            if (strcmp(info->parts[p].attributes[i].name, "multiView") == 0 &&
                strcmp(info->parts[p].attributes[i].type, "stringvector") != 0)
                report_warn(report, "multiView",
                            "%s: attribute multiView is of type %s, want stringvector: the file "
                            "is read as one without views",
                            info->path, info->parts[p].attributes[i].type);
}

bool gbuffer_load(const struct exr_info *info, const struct gbuffer_options *options,
                  const struct camera *camera_file, struct report *report, struct gbuffer *gbuffer,
                  struct tool_error *err)
{
    *gbuffer = (struct gbuffer){.view = ao_view_default()};
    struct gbuffer *g = gbuffer;
    struct gbuffer_options with_type;
    warn_about_file(info, report);
    const bool tells_type =
        options->depth_type == DEPTH_AUTO && camera_file && camera_file->depth_type != DEPTH_AUTO;
    if (tells_type) {
        with_type = *options;
        with_type.depth_type = camera_file->depth_type;
        options = &with_type;
    }
    if (!resolve(info, options, camera_file, g, err))
        return false;
    g->camera.depth_type = tells_type ? options->depth_type : DEPTH_AUTO;
    const struct role *depth = &g->roles.kind[ROLE_DEPTH], *normal = &g->roles.kind[ROLE_NORMAL];
    const struct exr_info *normals = normal->found ? normal->info : info;
    struct gbuffer_options as_read;
    struct frame_memory memory;
    struct report unheard = {.verbosity = REPORT_QUIET};
    struct layer_signs thickness = {0}, second = {0};
    float *positions = NULL;
    enum depth_type by_ends;
    bool is_empty;
    if (g->camera.remark[0])
        report_warn(report, "camera remark", "%s: %s", info->path, g->camera.remark);
    if (!read_depth(g, err) || !check_grey(g, report, err))
        goto failed;
    gbuffer_compare_depths(g, options, report);
    if (!settle_whole_numbers(g, options, report, err))
        goto failed;
    if (normal->found) {
        g->normals = gbuffer_read_role(g, normal, 4, 0.0f, err);
        if (!g->normals)
            goto failed;
    }
    if (!read_positions(g, options, &positions, err) ||
        !look_for_nothing(g, options, positions, &is_empty, err) ||
        (is_empty && !take_nothing(g, options, &as_read, &memory, report, err)))
        goto failed;
    if (is_empty) {
        options = &as_read;
        report = &unheard;
    }
    if ((!is_empty && !use_positions(g, options, positions, report, err)) || !read_alpha(g, err) ||
        !gbuffer_decode_normals(g, options->normal_encoding, normals->path, report, err))
        goto failed;
    free(positions);
    positions = NULL;
    if (!gbuffer_find_told_ends(g, options, &by_ends, report, err))
        goto failed;
    if (by_ends != DEPTH_AUTO) {
        with_type = *options;
        with_type.depth_type = by_ends;
        options = &with_type;
    }
    gbuffer_turn_depth(g, options, report);
    if (!gbuffer_find_camera(g, options, depth->info->path, report, err) ||
        !read_behind(g, ROLE_THICKNESS, &g->thickness, &thickness, err) ||
        (!g->thickness && !read_behind(g, ROLE_BACK_DEPTH, &g->thickness, &thickness, err)) ||
        !read_behind(g, ROLE_LAYER2, &g->second_depth, &second, err) ||
        !gbuffer_prepare_depth(g, depth->info, options, report, err) ||
        !gbuffer_check_behind(g, &thickness, &second, report, err) ||
        !gbuffer_prepare_normals(g, options, normals->path, report, err))
        goto failed;
    warn_about_assumption(g, report);
    gbuffer_warn_of_frame(g, options->memory, depth->info->path, report);
    gbuffer_warn_of_ramps(g, depth->info->path, report);
    if (!gbuffer_run_checks(g, normals->path, report, err))
        goto failed;
    /* What is taken out is no fault of the file, and may be held out as well. */
    if (!gbuffer_read_holdout(info, g, options, report, err) ||
        !gbuffer_take_out(info, g, options, report, err))
        goto failed;
    free(g->alpha);
    g->alpha = NULL;
    if (options->want_color && !read_light(g, err))
        goto failed;
    return true;
failed:
    free(positions);
    gbuffer_free(g);
    return false;
}

void gbuffer_free_inputs(struct gbuffer *gbuffer)
{
    float **planes[] = {&gbuffer->depth,        &gbuffer->normals, &gbuffer->thickness,
                        &gbuffer->second_depth, &gbuffer->kept,    &gbuffer->albedo,
                        &gbuffer->specular,     &gbuffer->holdout, &gbuffer->alpha};
    for (size_t i = 0; i < sizeof planes / sizeof *planes; i++) {
        free(*planes[i]);
        *planes[i] = NULL;
    }
}

void gbuffer_free(struct gbuffer *gbuffer)
{
    gbuffer_free_inputs(gbuffer);
    free(gbuffer->color);
    gbuffer->color = NULL;
}
