/* SPDX-License-Identifier: MIT
 *
 * Camera files: {"type": "perspective", "fov_x_deg": 58.7, "near": 0.1, "far": 100,
 * "world_to_view": [[...] x 4], "left_handed": false}, or {"views": {"left": {...}, "right":
 * {...}}}. */
#include "camera.h"

#include "json_text.h"
#include "read_file.h"
#include "text.h"

#include <cjson/cJSON.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct reader {
    const char *path;
    const char *view; /* "" or the view being read */
    struct tool_error *err;
};

static bool wrong(const struct reader *r, const char *key, const char *wanted)
{
    return fail(r->err, EXIT_INPUT, "%s: %s%s'%s' must be %s", r->path, r->view,
                r->view[0] ? ": " : "", key, wanted);
}

/* Leaves *value alone if the key is absent. */
static bool read_number(const struct reader *r, const cJSON *object, const char *key, double low,
                        double high, const char *wanted, double *value)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!item)
        return true;
    if (!cJSON_IsNumber(item) || !(item->valuedouble > low) || !(item->valuedouble < high))
        return wrong(r, key, wanted);
    *value = item->valuedouble;
    return true;
}

static bool read_matrix(const struct reader *r, const cJSON *rows, double m[16])
{
    static const char wanted[] = "a list of 4 rows of 4 numbers";
    if (!cJSON_IsArray(rows) || cJSON_GetArraySize(rows) != 4)
        return wrong(r, "world_to_view", wanted);
    int i = 0;
    const cJSON *row, *item;
    cJSON_ArrayForEach(row, rows)
    {
        if (!cJSON_IsArray(row) || cJSON_GetArraySize(row) != 4)
            return wrong(r, "world_to_view", wanted);
        cJSON_ArrayForEach(item, row)
        {
            if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
                return wrong(r, "world_to_view", wanted);
            m[i++] = item->valuedouble;
        }
    }
    return true;
}

/* Rotation and translation of a rigid (or uniformly scaled) matrix. */
static bool read_placement(const struct reader *r, const cJSON *object, struct camera *camera)
{
    const cJSON *rows = cJSON_GetObjectItemCaseSensitive(object, "world_to_view");
    const cJSON *left_handed = cJSON_GetObjectItemCaseSensitive(object, "left_handed");
    double m[16];
    if (left_handed && !cJSON_IsBool(left_handed))
        return wrong(r, "left_handed", "true or false");
    if (!rows)
        return true;
    if (!read_matrix(r, rows, m))
        return false;
    if (fabs(m[12]) + fabs(m[13]) + fabs(m[14]) > 1e-6 || fabs(m[15] - 1.0) > 1e-6)
        return wrong(r, "world_to_view", "for column vectors: its last row must be 0 0 0 1");
    for (int i = 0; i < 3; i++) {
        const double *row = m + i * 4;
        double length = sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
        if (!(length > 1e-12))
            return wrong(r, "world_to_view", "a rotation and a translation");
        for (int j = 0; j < 3; j++)
            camera->world_to_view[i * 3 + j] = row[j] / length;
        camera->translation[i] = row[3];
    }
    const double *w = camera->world_to_view;
    double skew = fabs(w[0] * w[3] + w[1] * w[4] + w[2] * w[5]) +
                  fabs(w[0] * w[6] + w[1] * w[7] + w[2] * w[8]) +
                  fabs(w[3] * w[6] + w[4] * w[7] + w[5] * w[8]);
    if (skew > 1e-3)
        return wrong(r, "world_to_view", "a rotation and a translation, without shear");
    const bool mirrors = camera_is_mirrored(camera);
    if (mirrors && !left_handed)
        fail_hint(r->err, "if the world is left-handed, say so: \"left_handed\": true");
    if (mirrors != cJSON_IsTrue(left_handed))
        return wrong(r, "world_to_view",
                     mirrors ? "a rotation: this is a mirror image"
                             : "a mirror image if \"left_handed\" is true");
    camera->has_rotation = camera->axis_certain = camera->has_translation = true;
    snprintf(camera->rotation_source, sizeof camera->rotation_source, "camera file");
    return true;
}

/* What a key is about tells it apart however it is spelt. */
struct known_key {
    const char *name, *stem;
};

/* The known key that was meant, or NULL. Of short words all are alike. */
static const char *meant_key(const char *key, const struct known_key *known, size_t count)
{
    char lower[64];
    const char *nearest = known[0].name;
    snprintf(lower, sizeof lower, "%s", key);
    for (char *c = lower; *c; c++)
        *c = (char)tolower((unsigned char)*c);
    for (size_t i = 0; i < count; i++)
        if (text_distance(lower, known[i].name) < text_distance(lower, nearest))
            nearest = known[i].name;
    const unsigned distance = text_distance(lower, nearest);
    if (distance <= 3 && distance * 2 <= strlen(lower))
        return nearest;
    for (size_t i = 0; i < count; i++)
        if (strstr(lower, known[i].stem))
            return known[i].name;
    return NULL;
}

/* A letter wrong in a key, or one key twice, and what it says would be lost without a word. Keys
 * that begin with '_' are comments. */
static bool check_keys(const struct reader *r, const cJSON *object, const struct known_key *known,
                       size_t count)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, object)
    {
        bool is_known = item->string[0] == '_';
        for (size_t i = 0; !is_known && i < count; i++) {
            is_known = strcmp(item->string, known[i].name) == 0;
            if (is_known && cJSON_GetObjectItemCaseSensitive(object, item->string) != item)
                return fail(r->err, EXIT_INPUT, "%s: %s%skey '%s' is given twice", r->path, r->view,
                            r->view[0] ? ": " : "", item->string);
        }
        if (is_known)
            continue;
        const char *meant = meant_key(item->string, known, count);
        if (meant)
            fail_hint(r->err, "did you mean \"%s\"?", meant);
        else
            fail_hint(r->err, "vkao(1) lists the keys; one that begins with _ is a comment");
        return fail(r->err, EXIT_INPUT, "%s: %s%sunknown key '%s'", r->path, r->view,
                    r->view[0] ? ": " : "", item->string);
    }
    return true;
}

static bool read_type(const struct reader *r, const cJSON *object, struct camera *camera)
{
    static const double degree = 3.14159265358979323846 / 180.0;
    const cJSON *type = cJSON_GetObjectItemCaseSensitive(object, "type");
    double fov = 0, width = 0;
    if (!read_number(r, object, "fov_x_deg", 0, 180, "a number between 0 and 180", &fov) ||
        !read_number(r, object, "ortho_width", 0, HUGE_VAL, "a number > 0", &width))
        return false;
    const char *name = cJSON_IsString(type) ? type->valuestring : type ? "" : "perspective";
    if (strcmp(name, "perspective") == 0) {
        if (!(fov > 0))
            return wrong(r, "fov_x_deg", "given for a perspective camera");
        if (width > 0)
            return wrong(r, "ortho_width", "left out of a perspective camera");
        camera->type = CAMERA_PERSPECTIVE;
        camera->half_width = tan(fov * degree / 2.0);
        return true;
    }
    if (strcmp(name, "orthographic") == 0) {
        if (!(width > 0))
            return wrong(r, "ortho_width", "given for an orthographic camera");
        if (fov > 0)
            return wrong(r, "fov_x_deg", "left out of an orthographic camera");
        camera->type = CAMERA_ORTHOGRAPHIC;
        camera->half_width = width / 2.0;
        return true;
    }
    return wrong(r, "type", "\"perspective\" or \"orthographic\"");
}

/* What --depth-type takes and needs no further numbers. */
static const struct {
    const char *name;
    enum depth_type type;
} depth_types[] = {{"planar", DEPTH_PLANAR},
                   {"radial", DEPTH_RADIAL},
                   {"radial-near", DEPTH_RADIAL_NEAR},
                   {"inverse", DEPTH_INVERSE}};
enum { DEPTH_TYPES = sizeof depth_types / sizeof *depth_types };

static bool read_depth_type(const struct reader *r, const cJSON *object, struct camera *camera)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, "depth_type");
    const char *name = cJSON_GetStringValue(item);
    for (size_t i = 0; name && i < DEPTH_TYPES; i++)
        if (strcmp(name, depth_types[i].name) == 0)
            camera->depth_type = depth_types[i].type;
    return !item || camera->depth_type != DEPTH_AUTO ||
           wrong(r, "depth_type", "\"planar\", \"radial\", \"radial-near\" or \"inverse\"");
}

static bool read_camera(const struct reader *r, const cJSON *object, struct camera *camera)
{
    *camera = (struct camera){0};
    if (!cJSON_IsObject(object))
        return fail(r->err, EXIT_INPUT, "%s: a camera must be an object { ... }", r->path);
    static const struct known_key keys[] = {{"type", "type"},         {"fov_x_deg", "fov"},
                                            {"ortho_width", "ortho"}, {"near", "near"},
                                            {"far", "far"},           {"shift_x", "shift"},
                                            {"shift_y", "shift_y"},   {"world_to_view", "world"},
                                            {"left_handed", "hand"},  {"depth_type", "depth"}};
    if (!check_keys(r, object, keys, sizeof keys / sizeof *keys) || !read_type(r, object, camera))
        return false;
    static const char positive[] = "a number > 0", shift[] = "a number between -10 and 10";
    snprintf(camera->source, sizeof camera->source, "camera file");
    return read_number(r, object, "near", 0, HUGE_VAL, positive, &camera->near_plane) &&
           read_number(r, object, "far", 0, HUGE_VAL, positive, &camera->far_plane) &&
           read_number(r, object, "shift_x", -10, 10, shift, &camera->shift_x) &&
           read_number(r, object, "shift_y", -10, 10, shift, &camera->shift_y) &&
           read_depth_type(r, object, camera) && read_placement(r, object, camera);
}

static bool add_view(struct camera_set *set, const struct reader *r, const cJSON *object)
{
    struct camera_view *view = &set->views[set->count];
    view->name = text_copy(r->view, strlen(r->view));
    if (!view->name)
        return fail(r->err, EXIT_MEMORY, "%s: out of memory", r->path);
    set->count++;
    return read_camera(r, object, &view->camera);
}

static bool read_views(const cJSON *root, struct reader *r, struct camera_set *set)
{
    const cJSON *views = cJSON_GetObjectItemCaseSensitive(root, "views");
    int count = cJSON_IsObject(views) ? cJSON_GetArraySize(views) : 1;
    if (views && (!cJSON_IsObject(views) || count < 1))
        return fail(r->err, EXIT_INPUT, "%s: 'views' must be { \"left\": {...}, ... }", r->path);
    set->views = calloc((size_t)count, sizeof *set->views);
    if (!set->views)
        return fail(r->err, EXIT_MEMORY, "%s: out of memory", r->path);
    if (!views)
        return add_view(set, r, root);
    static const struct known_key keys[] = {{"views", "view"}};
    if (!check_keys(r, root, keys, 1))
        return false;
    const cJSON *object;
    cJSON_ArrayForEach(object, views)
    {
        r->view = object->string;
        if (cJSON_GetObjectItemCaseSensitive(views, object->string) != object)
            return fail(r->err, EXIT_INPUT, "%s: view '%s' is given twice", r->path, r->view);
        if (!add_view(set, r, object))
            return false;
    }
    return true;
}

bool camera_set_parse(const char *json, const char *path, struct camera_set *set,
                      struct tool_error *err)
{
    *set = (struct camera_set){0};
    const char *end = NULL;
    const unsigned begun = json_begin();
    cJSON *root = cJSON_ParseWithOpts(json, &end, true);
    if (!root && !json_is_whole(begun))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (!root) {
        int line = 1;
        for (const char *p = json; end && p < end; p++)
            line += *p == '\n';
        return fail(err, EXIT_INPUT, "%s: not JSON (line %d)", path, line);
    }
    struct reader r = {.path = path, .view = "", .err = err};
    bool ok = read_views(root, &r, set);
    cJSON_Delete(root);
    if (!ok)
        camera_set_free(set);
    return ok;
}

/* --- Writing --- */

static bool add_rows(cJSON *object, const struct camera *camera)
{
    cJSON *rows = cJSON_AddArrayToObject(object, "world_to_view");
    for (int i = 0; i < 4; i++) {
        double row[4] = {0, 0, 0, i == 3};
        for (int j = 0; i < 3 && j < 3; j++)
            row[j] = camera->world_to_view[i * 3 + j];
        if (i < 3 && camera->has_translation)
            row[3] = camera->translation[i];
        cJSON_AddItemToArray(rows, cJSON_CreateDoubleArray(row, 4));
    }
    return rows != NULL;
}

cJSON *camera_json(const struct camera *camera)
{
    cJSON *object = cJSON_CreateObject();
    const bool ortho = camera->type == CAMERA_ORTHOGRAPHIC;
    cJSON_AddStringToObject(object, "_source", camera->source);
    cJSON_AddStringToObject(object, "type", ortho ? "orthographic" : "perspective");
    if (ortho)
        cJSON_AddNumberToObject(object, "ortho_width", camera->half_width * 2.0);
    else
        cJSON_AddNumberToObject(object, "fov_x_deg", camera_fov_x_deg(camera));
    if (camera->near_plane > 0 && isfinite(camera->near_plane))
        cJSON_AddNumberToObject(object, "near", camera->near_plane);
    if (camera->far_plane > 0 && isfinite(camera->far_plane))
        cJSON_AddNumberToObject(object, "far", camera->far_plane);
    if (fabs(camera->shift_x) + fabs(camera->shift_y) > 0) {
        cJSON_AddNumberToObject(object, "shift_x", camera->shift_x);
        cJSON_AddNumberToObject(object, "shift_y", camera->shift_y);
    }
    for (size_t i = 0; i < DEPTH_TYPES; i++)
        if (camera->depth_type == depth_types[i].type)
            cJSON_AddStringToObject(object, "depth_type", depth_types[i].name);
    if (camera->has_rotation && add_rows(object, camera) && camera_is_mirrored(camera))
        cJSON_AddBoolToObject(object, "left_handed", true);
    return object;
}

bool camera_set_read(const char *path, struct camera_set *set, struct tool_error *err)
{
    enum { MOST_BYTES = 1 << 20 };
    *set = (struct camera_set){0};
    char *json = read_file(path, MOST_BYTES, err);
    bool ok = json && camera_set_parse(json, path, set, err);
    free(json);
    return ok;
}
