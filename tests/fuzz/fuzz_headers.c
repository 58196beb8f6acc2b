/* SPDX-License-Identifier: MIT
 *
 * Headers without a file: parts, channels, views and attributes made from the names that renderers
 * use and from any bytes. Roles, views and cameras are read from them. */
#include "camera.h"
#include "fuzz.h"
#include "fuzz_view.h"
#include "roles.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PARTS = 4, MOST_CHANNELS = 16, MOST_ATTRIBUTES = 8, MOST_VIEWS = 3 };

/* --- Names --- */

static const char *const words[] = {
    "",      "left",       "right",       "ViewLayer", "beauty",     "rgba",
    "depth", "Depth.left", "depth_right", "crypto",    "mist",       "A",
    "R",     "Z",          "X",           "Y",         "dzdx",       "AO",
    "N",     "P",          ".",           "..",        "left.right", "View Layer.Depth",
};

static char *join(const char *a, const char *b, const char *c)
{
    const size_t size = strlen(a) + strlen(b) + strlen(c) + 3;
    char *text = malloc(size);
    if (!text)
        abort();
    snprintf(text, size, "%s%s%s%s%s", a, *a ? "." : "", b, *b ? "." : "", c);
    return text;
}

/* One of the alternatives of a row's layers, without what governs its comparison. */
static char *layer_of(struct fuzz_input *in, const struct role_row *row)
{
    const char *layers = row->layers ? row->layers : "";
    layers += strspn(layers, "~=*");
    for (uint32_t skip = fuzz_below(in, 4); skip && strchr(layers, '|'); skip--)
        layers = strchr(layers, '|') + 1;
    return fuzz_copy(layers, strcspn(layers, "|"));
}

static const char *word(struct fuzz_input *in)
{
    return words[fuzz_below(in, sizeof words / sizeof *words)];
}

/* As renderers name channels, by the table that reads them. */
static char *known_name(struct fuzz_input *in)
{
    const struct role_row *row = &role_table[fuzz_below(in, (uint32_t)role_table_count)];
    uint32_t set = fuzz_below(in, ROLE_MAX_SETS), component = fuzz_below(in, ROLE_MAX_COMPONENTS);
    while (set && !row->sets[set][0])
        set--;
    while (component && !row->sets[set][component])
        component--;
    char *layer = layer_of(in, row);
    char *name = join(fuzz_flag(in) ? word(in) : "", layer, row->sets[set][component]);
    free(layer);
    return name;
}

static char *any_name(struct fuzz_input *in)
{
    switch (fuzz_below(in, 8)) {
    case 0:
        return fuzz_text(in, 600);
    case 1:
        return join(word(in), word(in), word(in));
    case 2:
        return join("", "", word(in));
    default:
        return known_name(in);
    }
}

/* --- Headers --- */

static int compare_channels(const void *a, const void *b)
{
    const struct exr_channel *x = a, *y = b;
    return strcmp(x->name, y->name);
}

/* Sorted, each name once and none empty, as in every file that could be read. */
static void fill_channels(struct fuzz_input *in, struct exr_part *part)
{
    const size_t count = 1 + fuzz_below(in, MOST_CHANNELS);
    struct exr_channel made[MOST_CHANNELS];
    for (size_t i = 0; i < count; i++) {
        made[i] = (struct exr_channel){any_name(in), (enum exr_pixel_type)fuzz_below(in, 3), 1, 1};
        if (fuzz_below(in, 16) == 15)
            made[i].x_sampling = 2;
    }
    qsort(made, count, sizeof *made, compare_channels);
    part->channels = calloc(count, sizeof *part->channels);
    if (!part->channels)
        abort();
    for (size_t i = 0; i < count; i++) {
        const struct exr_channel *last =
            part->channel_count ? &part->channels[part->channel_count - 1] : NULL;
        if (!*made[i].name || (last && strcmp(last->name, made[i].name) == 0))
            free(made[i].name);
        else
            part->channels[part->channel_count++] = made[i];
    }
}

static const char *const attribute_names[] = {
    "worldToCamera",
    "worldToNDC",
    "cameraFov",
    "rs/camera/fov",
    "arnold/camera/fov",
    "unreal/camera/A/fov",
    "unreal/camera/A/focalLength",
    "unreal/camera/A/sensorWidth",
    "CameraFocalLength",
    "CameraFilmApertureHorizontal",
    "pinholeFocalLength",
    "sensorOverallDimensions",
    "cameraFocalLength",
    "cameraAperture",
    "near",
    "nearPlane",
    "far",
    "farPlane",
    "cameraNearClip",
    "cameraFarClip",
    "vrayInfo/x",
    "unreal/",
};

static void fill_attribute(struct fuzz_input *in, struct exr_attribute *a)
{
    static const size_t counts[] = {1, 16, 16, 2, 3, 4, 9, 1};
    const char *name =
        attribute_names[fuzz_below(in, sizeof attribute_names / sizeof *attribute_names)];
    *a = (struct exr_attribute){.name = fuzz_copy(name, strlen(name)), .type = fuzz_copy("any", 3)};
    const uint32_t kind = fuzz_below(in, 10);
    if (kind == 9)
        return;
    if (kind == 8) {
        a->text = fuzz_text(in, 100);
        return;
    }
    a->number_count = counts[kind];
    a->numbers = calloc(a->number_count, sizeof *a->numbers);
    if (!a->numbers)
        abort();
    /* Mostly matrices that are near to one that means something. */
    const bool identity = a->number_count == 16 && fuzz_flag(in);
    for (size_t i = 0; i < a->number_count; i++)
        a->numbers[i] = identity ? i % 5 == 0 : fuzz_number(in);
    for (int changes = fuzz_u8(in) % 6; identity && changes; changes--)
        a->numbers[fuzz_below(in, 16)] = fuzz_number(in);
}

/* Windows as OpenEXR lets them through. */
static struct exr_box any_window(struct fuzz_input *in)
{
    enum { LIMIT = INT32_MAX / 2 };
    int32_t v[4];
    for (int i = 0; i < 4; i++) {
        v[i] = fuzz_integer(in);
        v[i] = v[i] < -LIMIT ? -LIMIT : v[i] > LIMIT - 1 ? LIMIT - 1 : v[i];
    }
    return (struct exr_box){v[0] < v[2] ? v[0] : v[2], v[1] < v[3] ? v[1] : v[3],
                            v[0] < v[2] ? v[2] : v[0], v[1] < v[3] ? v[3] : v[1]};
}

static void fill_part(struct fuzz_input *in, struct exr_part *part, bool multi)
{
    static const float aspects[] = {1.0f, 1.0f, 2.0f, 0.5f, 1e-6f, 1e6f};
    static const char *const types[] = {"scanlineimage", "tiledimage", "deepscanline"};
    const char *type = types[fuzz_below(in, 8) % 3 * (fuzz_below(in, 4) == 3)];
    part->name = any_name(in);
    part->view = join("", "", fuzz_flag(in) ? word(in) : "");
    part->type = fuzz_copy(type, strlen(type));
    part->deep = strcmp(type, "deepscanline") == 0;
    part->compression = "zip";
    part->line_order = "increasing";
    part->display_window = any_window(in);
    part->data_window = fuzz_flag(in) ? part->display_window : any_window(in);
    part->pixel_aspect = aspects[fuzz_below(in, sizeof aspects / sizeof *aspects)];
    fill_channels(in, part);
    const size_t attributes = fuzz_below(in, MOST_ATTRIBUTES + 1);
    const size_t views = multi || fuzz_below(in, 3) ? 0 : fuzz_below(in, MOST_VIEWS + 1);
    part->attributes = calloc(MOST_ATTRIBUTES, sizeof *part->attributes);
    part->multi_view = calloc(MOST_VIEWS, sizeof *part->multi_view);
    if (!part->attributes || !part->multi_view)
        abort();
    for (; part->attribute_count < attributes; part->attribute_count++)
        fill_attribute(in, &part->attributes[part->attribute_count]);
    for (; part->multi_view_count < views; part->multi_view_count++)
        part->multi_view[part->multi_view_count] =
            fuzz_flag(in) ? fuzz_text(in, 20) : fuzz_copy("left", fuzz_below(in, 5));
}

static void make_info(struct fuzz_input *in, struct exr_info *info)
{
    const size_t count = 1 + fuzz_below(in, MOST_PARTS);
    info->path = fuzz_copy("fuzz.exr", 8);
    info->parts = calloc(count, sizeof *info->parts);
    if (!info->parts)
        abort();
    for (; info->part_count < count; info->part_count++)
        fill_part(in, &info->parts[info->part_count], count > 1);
}

/* --- Promises --- */

static bool has_channel(const struct exr_part *part, const struct exr_channel *channel)
{
    return channel >= part->channels && channel < part->channels + part->channel_count;
}

static void check_role(const struct exr_info *info, const struct role *role)
{
    if (!role->found)
        return;
    FUZZ_CHECK(role->part < info->part_count, "part %zu", role->part);
    const struct exr_part *part = &info->parts[role->part];
    FUZZ_CHECK(!part->deep, "a role in the deep part %zu", role->part);
    FUZZ_CHECK(role->channel_count >= 1 && role->channel_count <= ROLE_MAX_COMPONENTS,
               "%zu channels", role->channel_count);
    for (size_t i = 0; i < role->channel_count; i++)
        FUZZ_CHECK(has_channel(part, role->channels[i]), "channel %zu is of another part", i);
    const struct exr_channel *alpha = role->channels[ROLE_MAX_COMPONENTS];
    FUZZ_CHECK(!alpha || has_channel(part, alpha), "alpha is of another part");
    FUZZ_CHECK(role->label[0] && memchr(role->label, '\0', sizeof role->label), "no label");
}

static bool resolve(const struct exr_info *info, const struct role_request *request,
                    struct roles *roles)
{
    struct tool_error err = {0};
    if (!roles_resolve(info, request, roles, &err)) {
        fuzz_check_refusal(&err, FUZZ_CODE(EXIT_CHANNELS) | FUZZ_CODE(EXIT_INPUT));
        return false;
    }
    const struct role *depth = &roles->kind[ROLE_DEPTH];
    FUZZ_CHECK(depth->found &&
                   depth->channel_count == (depth->depth_type == DEPTH_POSITION ? 3 : 1),
               "resolved without depth");
    FUZZ_CHECK(!request->no_normals || !roles->kind[ROLE_NORMAL].found, "unwanted normals");
    for (int kind = 0; kind < ROLE_KINDS; kind++) {
        check_role(info, &roles->kind[kind]);
        FUZZ_CHECK(!request->name[kind] || roles->kind[kind].found ||
                       (kind == ROLE_NORMAL && request->no_normals),
                   "'%s' was asked for and not found", request->name[kind]);
    }
    return true;
}

static void check_view(struct fuzz_input *in, const struct exr_info *info, const char *view)
{
    struct roles roles;
    struct role_request request = {.view = view};
    if (resolve(info, &request, &roles)) {
        request.no_normals = true;
        FUZZ_CHECK(resolve(info, &request, &roles), "resolved with normals, but not without");
    }
    char *names[ROLE_KINDS];
    for (int kind = 0; kind < ROLE_KINDS; kind++)
        request.name[kind] = names[kind] = fuzz_below(in, 3) ? NULL : any_name(in);
    request.no_normals = fuzz_flag(in);
    (void)resolve(info, &request, &roles);
    for (int kind = 0; kind < ROLE_KINDS; kind++)
        free(names[kind]);
}

/* The header's windows are those of a camera, whatever they are; the numbers must be usable. */
static void check_camera(struct fuzz_input *in, const struct exr_info *info, size_t part)
{
    const struct exr_part *p = &info->parts[part];
    struct camera camera = {0};
    struct camera_flags flags = {0};
    struct ao_view view = ao_view_default();
    if (fuzz_flag(in))
        flags = (struct camera_flags){.fov_deg = 40, .fov_is_vertical = fuzz_flag(in)};
    camera_resolve(&flags, NULL, info, part, &camera);
    FUZZ_CHECK(camera.type != CAMERA_UNKNOWN, "no camera");
    FUZZ_CHECK(camera.near_plane >= 0 && isfinite(camera.near_plane) && camera.far_plane >= 0 &&
                   isfinite(camera.far_plane),
               "planes %g, %g", camera.near_plane, camera.far_plane);
    for (int i = 0; camera.has_rotation && i < 9; i++)
        FUZZ_CHECK(fabs(camera.world_to_view[i]) < 1 + 1e-6, "rotation %g",
                   camera.world_to_view[i]);
    const bool orthographic = camera.type == CAMERA_ORTHOGRAPHIC;
    const struct camera_planes planes = {orthographic ? 0 : 0.1, orthographic ? 10 : INFINITY};
    camera_project(&camera, &planes, &p->display_window, &p->data_window, &view);
    if (camera.has_rotation)
        camera_normal_to_view(&camera, view.normal_to_view);
    if (!camera_can_project(&view))
        return; /* gbuffer_load refuses it */
    FUZZ_CHECK(camera.half_width > 0 && camera.half_height > 0, "half sizes %g, %g",
               camera.half_width, camera.half_height);
    fuzz_check_job(&(struct fuzz_job){.width = 4, .height = 3, .view = &view});
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz_input in = {data, size};
    struct exr_info info = {0};
    make_info(&in, &info);
    const size_t views = roles_view_count(&info);
    for (size_t i = 0; i < views && i < 2; i++) {
        FUZZ_CHECK(roles_view_name(&info, i), "view %zu of %zu has no name", i, views);
        check_view(&in, &info, roles_view_name(&info, i));
    }
    check_view(&in, &info, "");
    check_view(&in, &info, "no such view");
    for (size_t i = 0; i < info.part_count; i++)
        check_camera(&in, &info, i);
    exr_info_free(&info);
    return 0;
}
