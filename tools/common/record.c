/* SPDX-License-Identifier: MIT */
#include "record.h"

#include "json_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char attribute_name[] = "vkao/params", assumed[] = "assumed";

static const char *const mode_names[] = {
    [OUTPUT_AO] = "ao", [OUTPUT_APPEND] = "append", [OUTPUT_COMP] = "comp"};
static const char *const depth_names[] = {"planar",  "radial", "radial-near",
                                          "inverse", "device", "normalized"};
static const char *const type_names[] = {"half", "float"};
static const char *const camera_names[] = {"perspective", "orthographic"};

/* --- Writing --- */

/* As few digits as bring the same double back. */
static void text_add_double(struct text *text, double value)
{
    char digits[40];
    for (int precision = 15; precision <= 17; precision++) {
        snprintf(digits, sizeof digits, "%.*g", precision, value);
        const double back = strtod(digits, NULL);
        if (memcmp(&back, &value, sizeof back) == 0)
            break;
    }
    text_add(text, "%s", digits);
}

/* JSON has no infinity. */
static void add_number(cJSON *object, const char *name, double value)
{
    struct text digits = {0};
    text_add_double(&digits, value);
    if (isfinite(value))
        cJSON_AddRawToObject(object, name, digits.data ? digits.data : "");
    else
        cJSON_AddStringToObject(object, name, "inf");
    text_free(&digits);
}

/* Rows. */
static void add_rotation(cJSON *object, const char *name, const double m[9])
{
    struct text list = {0};
    for (int i = 0; i < 9; i++) {
        text_add(&list, "%s", !i ? "[[" : i % 3 ? "," : "],[");
        text_add_double(&list, m[i]);
    }
    text_add(&list, "]]");
    cJSON_AddRawToObject(object, name, list.data ? list.data : "");
    text_free(&list);
}

static void add_parameter(cJSON *object, const vkao_parameter *p, const struct setting *setting)
{
    struct text value = {0};
    parameter_add_value(&value, p, setting);
    const char *text = value.data ? value.data : "";
    if (p->type == VKAO_PARAMETER_CHOICE) {
        cJSON_AddStringToObject(object, p->name, text);
    } else if (p->type == VKAO_PARAMETER_BOOL) {
        cJSON_AddBoolToObject(object, p->name, *text != '0');
    } else if (p->type == VKAO_PARAMETER_COLOR) {
        struct text list = {0};
        text_add(&list, "[%s]", text);
        cJSON_AddRawToObject(object, p->name, list.data ? list.data : "");
        text_free(&list);
    } else {
        cJSON_AddRawToObject(object, p->name, text);
    }
    text_free(&value);
}

/* What else options name, if they do. */
static const struct {
    enum role_kind kind;
    const char *key;
} more_channels[] = {{ROLE_ROUGHNESS, "roughness"}, {ROLE_HOLDOUT, "holdout"},
                     {ROLE_NO_CAST, "no_cast"},     {ROLE_INDIRECT, "indirect"},
                     {ROLE_ALBEDO, "albedo"},       {ROLE_SPECULAR, "specular"}};
enum { MORE_CHANNELS = sizeof more_channels / sizeof *more_channels };

static const char *thickness_key(vkao_thickness_input input)
{
    return input == VKAO_THICKNESS_GIVEN ? "thickness_channel" : "back_depth";
}

static void add_camera(cJSON *root, const struct camera *camera)
{
    cJSON *object = cJSON_AddObjectToObject(root, "camera");
    const bool is_orthographic = camera->type == CAMERA_ORTHOGRAPHIC;
    cJSON_AddStringToObject(object, "source", camera->source[0] ? camera->source : assumed);
    cJSON_AddStringToObject(object, "type", camera_names[is_orthographic]);
    /* For people; the half sizes below are exact. */
    if (is_orthographic)
        add_number(object, "ortho_width", (double)(float)(camera->half_width * 2.0));
    else
        add_number(object, "fov_x_deg", (double)(float)camera_fov_x_deg(camera));
    add_number(object, "half_width", camera->half_width);
    add_number(object, "half_height", camera->half_height);
    add_number(object, "shift_x", camera->shift_x);
    add_number(object, "shift_y", camera->shift_y);
    if (camera->near_plane > 0)
        add_number(object, "near", camera->near_plane);
    if (camera->far_plane > 0)
        add_number(object, "far", camera->far_plane);
    if (!camera->has_rotation)
        return;
    cJSON_AddStringToObject(object, "rotation_source", camera->rotation_source);
    cJSON_AddBoolToObject(object, "axis_certain", camera->axis_certain);
    add_rotation(object, "world_to_view", camera->world_to_view);
}

char *record_write(const struct options *o, const struct setting *setting, const char *view,
                   const struct gbuffer *g, const char *device)
{
    char version[VERSION_BYTES];
    uint32_t count;
    const unsigned begun = json_begin();
    const vkao_parameter *parameters = vkao_parameters(&count);
    cJSON *root = cJSON_CreateObject();
    version_string(version);
    cJSON_AddNumberToObject(root, "record", RECORD_VERSION);
    cJSON_AddStringToObject(root, "vkao", version);
    cJSON_AddStringToObject(root, "device", device);
    cJSON_AddStringToObject(root, "view", view);
    cJSON_AddStringToObject(root, "mode", mode_names[o->mode]);
    cJSON_AddStringToObject(root, "pixel_type", pixel_type_name(o->pixel_type));
    cJSON_AddStringToObject(root, "compression", o->compression);
    cJSON *object = cJSON_AddObjectToObject(root, "parameters");
    for (uint32_t i = 0; i < count; i++)
        add_parameter(object, &parameters[i], setting);
    cJSON_AddStringToObject(root, "depth", g->roles.kind[ROLE_DEPTH].label);
    cJSON_AddStringToObject(root, "depth_type", depth_type_name(g->depth_type));
    if (g->depth_type == DEPTH_NORMALIZED) {
        add_number(root, "depth_zero", g->depth_range.zero);
        add_number(root, "depth_one", g->depth_range.one);
    }
    if (o->gbuffer.background != BACKGROUND_AUTO)
        add_number(root, "background", o->gbuffer.background_value);
    bool normals = g->normal_space != NORMAL_SPACE_AUTO;
    cJSON_AddStringToObject(root, "normal", normals ? g->roles.kind[ROLE_NORMAL].label : "none");
    if (normals) {
        cJSON_AddStringToObject(root, "normal_space", normal_space_name(g->normal_space));
        cJSON_AddStringToObject(root, "normal_encoding", normal_encoding_name(g->normal_encoding));
    }
    if (o->mode == OUTPUT_COMP)
        cJSON_AddStringToObject(root, "color", g->roles.kind[ROLE_COLOR].label);
    const vkao_effect_info *effect = &setting->effect;
    const bool is_given = effect->thickness_input == VKAO_THICKNESS_GIVEN;
    if (effect->thickness_input)
        cJSON_AddStringToObject(root, thickness_key(effect->thickness_input),
                                g->roles.kind[is_given ? ROLE_THICKNESS : ROLE_BACK_DEPTH].label);
    if (effect->second_layer)
        cJSON_AddStringToObject(root, "layer2", g->roles.kind[ROLE_LAYER2].label);
    for (size_t i = 0; i < MORE_CHANNELS; i++)
        if (g->roles.kind[more_channels[i].kind].label[0])
            cJSON_AddStringToObject(root, more_channels[i].key,
                                    g->roles.kind[more_channels[i].kind].label);
    add_camera(root, &g->camera);
    char *json = json_text(root, false, begun);
    cJSON_Delete(root);
    return json;
}

/* --- Reading --- */

struct reader {
    const char *path;
    const char *place; /* "" or the object that is being read, with a dot */
    struct tool_error *err;
};

static bool wrong(const struct reader *r, const char *key, const cJSON *item, const char *wanted)
{
    char is[128] = "missing";
    if (cJSON_IsNumber(item))
        snprintf(is, sizeof is, "%.9g", item->valuedouble);
    else if (cJSON_IsString(item))
        snprintf(is, sizeof is, "'%.100s'", item->valuestring);
    else if (cJSON_IsBool(item))
        snprintf(is, sizeof is, cJSON_IsTrue(item) ? "true" : "false");
    else if (item)
        snprintf(is, sizeof is, "something else");
    fail_hint(r->err, "the record is damaged: give --like a file as vkao wrote it, or the settings "
                      "as options");
    return fail(r->err, EXIT_INPUT, "%s: %s: '%s%s' is %s, want %s", r->path, attribute_name,
                r->place, key, is, wanted);
}

static bool read_string(const struct reader *r, const cJSON *object, const char *key, char **out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!cJSON_IsString(item))
        return wrong(r, key, item, "a string");
    *out = text_copy(item->valuestring, strlen(item->valuestring));
    return *out || fail(r->err, EXIT_MEMORY, "%s: out of memory", r->path);
}

static bool read_word(const struct reader *r, const cJSON *object, const char *key,
                      const char *const *words, size_t count, uint32_t *index)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    for (size_t i = 0; cJSON_IsString(item) && i < count; i++) {
        if (strcmp(item->valuestring, words[i]) == 0) {
            *index = (uint32_t)i;
            return true;
        }
    }
    struct text wanted = {0};
    text_add_list(&wanted, words, (1u << count) - 1u, "or");
    wrong(r, key, item, wanted.data ? wanted.data : "another word");
    text_free(&wanted);
    return false;
}

static bool read_bool(const struct reader *r, const cJSON *object, const char *key, bool *value)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    *value = cJSON_IsTrue(item);
    return cJSON_IsBool(item) || wrong(r, key, item, "true or false");
}

/* A number in the range of the table, whatever a person may ask for. */
static bool number_fits(const vkao_parameter *p, const cJSON *item)
{
    if (!cJSON_IsNumber(item))
        return false;
    const double d = item->valuedouble;
    /* 1e-50 is in the range of double only. */
    const double v = p->type == VKAO_PARAMETER_UINT ? d : (double)(float)d;
    const bool is_whole = p->type != VKAO_PARAMETER_UINT || !(floor(d) < d);
    return is_whole && d <= p->most && (p->above_least ? v > p->least : v >= p->least);
}

static bool wrong_number(const struct reader *r, const vkao_parameter *p, const cJSON *item)
{
    char wanted[96];
    snprintf(wanted, sizeof wanted, "a %snumber %s %g and <= %.10g",
             p->type == VKAO_PARAMETER_UINT ? "whole " : "", p->above_least ? ">" : ">=", p->least,
             p->most);
    return wrong(r, p->name, item, wanted);
}

static bool read_parameter(const struct reader *r, const cJSON *object, const vkao_parameter *p,
                           struct setting *setting)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, p->name);
    float numbers[3] = {0};
    uint32_t word = 0;
    bool on = false;
    switch (p->type) {
    case VKAO_PARAMETER_FLOAT:
        if (!number_fits(p, item))
            return wrong_number(r, p, item);
        numbers[0] = (float)item->valuedouble;
        break;
    case VKAO_PARAMETER_COLOR:
        if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 3)
            return wrong(r, p->name, item, "a list of 3 numbers");
        for (int i = 0; i < 3; i++) {
            const cJSON *channel = cJSON_GetArrayItem(item, i);
            if (!number_fits(p, channel))
                return wrong_number(r, p, channel);
            numbers[i] = (float)channel->valuedouble;
        }
        break;
    case VKAO_PARAMETER_UINT:
        if (!number_fits(p, item))
            return wrong_number(r, p, item);
        word = (uint32_t)item->valuedouble;
        break;
    case VKAO_PARAMETER_CHOICE:
        if (!read_word(r, object, p->name, p->choices, (size_t)p->most + 1, &word))
            return false;
        break;
    default:
        if (!read_bool(r, object, p->name, &on))
            return false;
        word = on;
    }
    const bool is_number = p->type == VKAO_PARAMETER_FLOAT || p->type == VKAO_PARAMETER_COLOR;
    memcpy(parameter_of(setting, p), is_number ? (const void *)numbers : &word, parameter_bytes(p));
    return true;
}

/* What no option sets is the library's default in everything that vkao writes. The preset sets
 * half_resolution; channels that options name, the others. */
static bool can_be_asked_for(const vkao_parameter *p)
{
    return option_of_parameter(p) || parameter_is_of_images(p) ||
           p == parameter_named("half_resolution") || p == parameter_named("thickness_input") ||
           p == parameter_named("second_layer") || p == parameter_named("multi_bounce") ||
           p == parameter_named("specular");
}

/* Of what only some methods have. */
static bool check_method(const struct reader *r, const cJSON *object, const vkao_effect_info *e,
                         const char *name, bool is_on, const char *off)
{
    char wanted[48];
    if (!is_on || parameter_named(name)->methods >> e->method & 1u)
        return true;
    snprintf(wanted, sizeof wanted, "%s with this method", off);
    return wrong(r, name, cJSON_GetObjectItemCaseSensitive(object, name), wanted);
}

/* No option would make such a setting, and the library might refuse it. */
static bool check_setting(const struct reader *r, const cJSON *object,
                          const struct setting *setting)
{
    const struct setting standard = setting_default();
    uint32_t count;
    const vkao_parameter *all = vkao_parameters(&count);
    for (uint32_t i = 0; i < count; i++) {
        if (can_be_asked_for(&all[i]) || parameter_equals(&all[i], setting, &standard))
            continue;
        struct text wanted = {0};
        parameter_add_value(&wanted, &all[i], &standard);
        wrong(r, all[i].name, cJSON_GetObjectItemCaseSensitive(object, all[i].name),
              wanted.data ? wanted.data : "the default");
        text_free(&wanted);
        return false;
    }
    const vkao_effect_info *e = &setting->effect;
    return check_method(r, object, e, "bent_normals", e->bent_normals, "false") &&
           check_method(r, object, e, "thickness_input", e->thickness_input, "as-seen") &&
           check_method(r, object, e, "second_layer", e->second_layer, "false");
}

static bool read_parameters(struct reader r, const cJSON *root, struct setting *setting)
{
    uint32_t count;
    const vkao_parameter *parameters = vkao_parameters(&count);
    const cJSON *object = cJSON_GetObjectItemCaseSensitive(root, "parameters");
    if (!cJSON_IsObject(object))
        return wrong(&r, "parameters", object, "an object { ... }");
    r.place = "parameters.";
    *setting = setting_default();
    for (uint32_t i = 0; i < count; i++)
        if (!read_parameter(&r, object, &parameters[i], setting))
            return false;
    return check_setting(&r, object, setting);
}

/* In (low, high). */
static bool read_number(const struct reader *r, const cJSON *object, const char *key, double low,
                        double high, double *value)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    char wanted[64];
    *value = cJSON_IsNumber(item) ? item->valuedouble : 0;
    if (cJSON_IsNumber(item) && *value > low && *value < high)
        return true;
    snprintf(wanted, sizeof wanted, "a number > %g and < %g", low, high);
    return wrong(r, key, item, wanted);
}

/* Where it is unknown there is none. */
static bool read_plane(const struct reader *r, const cJSON *object, const char *key, double *plane)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    *plane = 0;
    if (cJSON_IsString(item) && strcmp(item->valuestring, "inf") == 0)
        *plane = INFINITY;
    return !item || isinf(*plane) || read_number(r, object, key, 0, HUGE_VAL, plane);
}

static bool read_rotation(const struct reader *r, const cJSON *object, struct camera *camera)
{
    static const char key[] = "world_to_view", wanted[] = "3 lists of 3 numbers from -1 to 1";
    const cJSON *rows = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!rows)
        return true;
    if (!cJSON_IsArray(rows) || cJSON_GetArraySize(rows) != 3)
        return wrong(r, key, rows, wanted);
    int i = 0;
    const cJSON *row, *item;
    cJSON_ArrayForEach(row, rows)
    {
        if (!cJSON_IsArray(row) || cJSON_GetArraySize(row) != 3)
            return wrong(r, key, row, wanted);
        cJSON_ArrayForEach(item, row)
        {
            if (!cJSON_IsNumber(item) || !(fabs(item->valuedouble) <= 1.0 + 1e-6))
                return wrong(r, key, item, wanted);
            camera->world_to_view[i++] = item->valuedouble;
        }
    }
    camera->has_rotation = true;
    return true;
}

/* Into a buffer of 64 bytes, as struct camera has them. */
static bool read_source(const struct reader *r, const cJSON *object, const char *key,
                        char source[64])
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!cJSON_IsString(item))
        return wrong(r, key, item, "a string");
    snprintf(source, 64, "%s", item->valuestring);
    return true;
}

static bool read_camera(struct reader r, const cJSON *root, struct camera *camera)
{
    const cJSON *object = cJSON_GetObjectItemCaseSensitive(root, "camera");
    uint32_t type;
    if (!cJSON_IsObject(object))
        return wrong(&r, "camera", object, "an object { ... }");
    r.place = "camera.";
    if (!read_source(&r, object, "source", camera->source) ||
        !read_word(&r, object, "type", camera_names, 2, &type) ||
        !read_number(&r, object, "half_width", 0, HUGE_VAL, &camera->half_width) ||
        !read_number(&r, object, "half_height", 0, HUGE_VAL, &camera->half_height) ||
        !read_number(&r, object, "shift_x", -HUGE_VAL, HUGE_VAL, &camera->shift_x) ||
        !read_number(&r, object, "shift_y", -HUGE_VAL, HUGE_VAL, &camera->shift_y) ||
        !read_plane(&r, object, "near", &camera->near_plane) ||
        !read_plane(&r, object, "far", &camera->far_plane) || !read_rotation(&r, object, camera))
        return false;
    camera->type = type ? CAMERA_ORTHOGRAPHIC : CAMERA_PERSPECTIVE;
    camera->is_assumed = strcmp(camera->source, assumed) == 0;
    if (camera->is_assumed)
        memset(camera->source, 0, sizeof camera->source);
    return !camera->has_rotation ||
           (read_source(&r, object, "rotation_source", camera->rotation_source) &&
            read_bool(&r, object, "axis_certain", &camera->axis_certain));
}

static bool read_compression(const struct reader *r, const cJSON *root, const char **compression)
{
    uint32_t index;
    if (!read_word(r, root, "compression", exr_compression_names, EXR_COMPRESSIONS, &index))
        return false;
    *compression = exr_compression_names[index];
    return true;
}

/* What only some depths need. A background of 0 is none. */
static bool read_depth_meaning(const struct reader *r, const cJSON *root, struct record *record)
{
    struct depth_range *range = &record->depth_range;
    if (cJSON_HasObjectItem(root, "background")) {
        if (!read_number(r, root, "background", -1, HUGE_VAL, &record->background_value))
            return false;
        record->background = record->background_value > 0 ? BACKGROUND_GIVEN : BACKGROUND_OFF;
    }
    range->is_given = record->depth_type == DEPTH_NORMALIZED;
    return !range->is_given || (read_number(r, root, "depth_zero", -1, HUGE_VAL, &range->zero) &&
                                read_number(r, root, "depth_one", -1, HUGE_VAL, &range->one));
}

static bool read_channels(const struct reader *r, const cJSON *root, struct record *record)
{
    static const char *const spaces[] = {"world", "camera"};
    static const char *const encodings[] = {"signed", "unsigned"};
    uint32_t depth, space = 0, encoding = 0;
    char *normal = NULL;
    if (!read_string(r, root, "depth", &record->depth) ||
        !read_word(r, root, "depth_type", depth_names, sizeof depth_names / sizeof *depth_names,
                   &depth) ||
        !read_string(r, root, "normal", &normal))
        return false;
    record->depth_type = (enum depth_type)(DEPTH_PLANAR + depth);
    if (!read_depth_meaning(r, root, record)) {
        free(normal);
        return false;
    }
    const vkao_effect_info *e = &record->setting.effect;
    if ((e->thickness_input &&
         !read_string(r, root, thickness_key(e->thickness_input), &record->thickness)) ||
        (e->second_layer && !read_string(r, root, "layer2", &record->second_depth))) {
        free(normal);
        return false;
    }
    if (strcmp(normal, "none") == 0) {
        free(normal);
        return true;
    }
    record->normal = normal;
    if (!read_word(r, root, "normal_space", spaces, 2, &space) ||
        !read_word(r, root, "normal_encoding", encodings, 2, &encoding))
        return false;
    record->normal_space = (enum normal_space)(NORMAL_SPACE_WORLD + space);
    record->normal_encoding = (enum normal_encoding)(NORMAL_ENCODING_SIGNED + encoding);
    return true;
}

static bool read_more_channels(const struct reader *r, const cJSON *root, struct record *record)
{
    for (size_t i = 0; i < MORE_CHANNELS; i++)
        if (cJSON_GetObjectItemCaseSensitive(root, more_channels[i].key) &&
            !read_string(r, root, more_channels[i].key, &record->more[more_channels[i].kind]))
            return false;
    const vkao_effect_info *e = &record->setting.effect;
    if (e->multi_bounce && !record->more[ROLE_ALBEDO])
        return wrong(r, "albedo", NULL, "a string");
    if (e->specular && !record->more[ROLE_SPECULAR])
        return wrong(r, "specular", NULL, "a string");
    return true;
}

static bool read_output(const struct reader *r, const cJSON *root, struct record *record)
{
    uint32_t mode, type;
    if (!read_word(r, root, "mode", mode_names, sizeof mode_names / sizeof *mode_names, &mode) ||
        !read_word(r, root, "pixel_type", type_names, 2, &type) ||
        !read_compression(r, root, &record->compression))
        return false;
    record->mode = (enum output_mode)mode;
    record->pixel_type = (enum exr_pixel_type)(EXR_HALF + type);
    return record->mode != OUTPUT_COMP || read_string(r, root, "color", &record->color);
}

static bool read_version(const struct reader *r, const cJSON *root)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "record");
    const cJSON *vkao = cJSON_GetObjectItemCaseSensitive(root, "vkao");
    if (cJSON_IsNumber(item) && !(item->valuedouble < RECORD_VERSION) &&
        !(item->valuedouble > RECORD_VERSION))
        return true;
    const bool is_named = cJSON_IsString(vkao);
    fail_hint(r->err, "use vkao%s%.32s, which wrote it, or give the settings as options",
              is_named ? " " : "", is_named ? vkao->valuestring : " 0.1");
    if (cJSON_IsNumber(item))
        return fail(r->err, EXIT_INPUT, "%s: %s: 'record' is %.9g, want %d", r->path,
                    attribute_name, item->valuedouble, RECORD_VERSION);
    return fail(r->err, EXIT_INPUT, "%s: %s: 'record' is missing, want %d", r->path, attribute_name,
                RECORD_VERSION);
}

bool record_parse(const char *json, const char *path, struct record *record, struct tool_error *err)
{
    enum { MOST_BYTES = 1 << 16 };
    const struct reader r = {.path = path, .place = "", .err = err};
    const unsigned begun = json_begin();
    *record = (struct record){0};
    cJSON *root = strlen(json) <= MOST_BYTES ? cJSON_ParseWithOpts(json, NULL, true) : NULL;
    if (!root && !json_is_whole(begun))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (!cJSON_IsObject(root)) {
        cJSON_Delete(root);
        fail_hint(err, "give --like a file as vkao wrote it, or the settings as options");
        return fail(err, EXIT_INPUT, "%s: %s: not the record of vkao: no JSON object", path,
                    attribute_name);
    }
    bool ok = read_version(&r, root) && read_string(&r, root, "vkao", &record->version) &&
              read_string(&r, root, "device", &record->device) &&
              read_string(&r, root, "view", &record->view) && read_output(&r, root, record) &&
              read_parameters(r, root, &record->setting) && read_channels(&r, root, record) &&
              read_more_channels(&r, root, record) && read_camera(r, root, &record->camera);
    cJSON_Delete(root);
    if (!ok)
        record_free(record);
    return ok;
}

static const char *find_record(const struct exr_part *part)
{
    for (size_t i = 0; i < part->attribute_count; i++)
        if (strcmp(part->attributes[i].name, attribute_name) == 0)
            return part->attributes[i].text ? part->attributes[i].text : "";
    return NULL;
}

/* Of two records of one view the later counts: it was appended. */
static bool add_record(const char *json, const char *path, struct record_set *set,
                       struct tool_error *err)
{
    struct record record;
    if (!record_parse(json, path, &record, err))
        return false;
    for (size_t i = 0; i < set->count; i++) {
        if (strcmp(set->records[i].view, record.view) == 0) {
            record_free(&set->records[i]);
            set->records[i] = record;
            return true;
        }
    }
    set->records[set->count++] = record;
    return true;
}

bool record_set_read(const char *path, struct record_set *set, struct tool_error *err)
{
    struct exr_info info = {0};
    *set = (struct record_set){0};
    if (!exr_info_read(path, &info, err))
        return false;
    set->records = calloc(info.part_count, sizeof *set->records);
    bool ok = set->records || fail(err, EXIT_MEMORY, "%s: out of memory", path);
    for (size_t i = 0; ok && i < info.part_count; i++) {
        const char *json = find_record(&info.parts[i]);
        ok = !json || add_record(json, path, set, err);
    }
    if (ok && !set->count) {
        fail_hint(err, "give --like a file that vkao wrote, or the settings as options");
        ok = fail(err, EXIT_INPUT, "%s: no record of vkao in it: no part has an attribute %s", path,
                  attribute_name);
    }
    exr_info_free(&info);
    if (!ok)
        record_set_free(set);
    return ok;
}

void record_free(struct record *record)
{
    free(record->view);
    free(record->version);
    free(record->device);
    free(record->depth);
    free(record->normal);
    free(record->color);
    free(record->thickness);
    free(record->second_depth);
    for (int kind = 0; kind < ROLE_KINDS; kind++)
        free(record->more[kind]);
    *record = (struct record){0};
}

void record_set_free(struct record_set *set)
{
    for (size_t i = 0; i < set->count; i++)
        record_free(&set->records[i]);
    free(set->records);
    *set = (struct record_set){0};
}

const struct record *record_set_find(const struct record_set *set, const char *view)
{
    if (set->count == 1 && !set->records[0].view[0])
        return &set->records[0];
    for (size_t i = 0; i < set->count; i++)
        if (strcmp(set->records[i].view, view) == 0)
            return &set->records[i];
    return NULL;
}

/* --- Into options --- */

/* Channels without a layer have none to name: they are found as they were. */
static const char *as_name(const char *label)
{
    return label && strcmp(label, ROLE_NO_LAYER) != 0 ? label : NULL;
}

bool options_take_record(struct options *options, const struct record *record,
                         struct tool_error *err)
{
    struct options *o = options;
    struct gbuffer_options *g = &o->gbuffer;
    if (!option_is_given(o, "mode"))
        o->mode = record->mode;
    if (!option_is_given(o, "pixel-type"))
        o->pixel_type = record->pixel_type;
    if (!option_is_given(o, "compression"))
        o->compression = record->compression;
    if (!option_is_given(o, "depth"))
        g->roles.name[ROLE_DEPTH] = as_name(record->depth);
    if (!option_is_given(o, "depth-type"))
        g->depth_type = record->depth_type;
    g->is_type_recorded = !option_is_given(o, "depth-type") && !option_is_given(o, "depth-range");
    if (!option_is_given(o, "depth-range"))
        g->depth_range = record->depth_range;
    if (!option_is_given(o, "background")) {
        g->background = record->background;
        g->background_value = record->background_value;
    }
    if (!option_is_given(o, "normal")) {
        g->roles.name[ROLE_NORMAL] = as_name(record->normal);
        g->roles.no_normals = !record->normal;
    }
    if (!option_is_given(o, "normal-space"))
        g->normal_space = record->normal_space;
    if (!option_is_given(o, "normal-encoding"))
        g->normal_encoding = record->normal_encoding;
    if (!option_is_given(o, "color"))
        g->roles.name[ROLE_COLOR] = as_name(record->color);
    /* Either option says all about thickness. */
    if (!option_is_given(o, "thickness-channel") && !option_is_given(o, "back-depth")) {
        const bool is_given = record->setting.effect.thickness_input == VKAO_THICKNESS_GIVEN;
        g->roles.name[is_given ? ROLE_THICKNESS : ROLE_BACK_DEPTH] = as_name(record->thickness);
    }
    if (!option_is_given(o, "layer2"))
        g->roles.name[ROLE_LAYER2] = as_name(record->second_depth);
    for (size_t i = 0; i < MORE_CHANNELS; i++) {
        const enum role_kind kind = more_channels[i].kind;
        if (!option_is_given(o, kind == ROLE_NO_CAST ? "no-cast" : more_channels[i].key))
            g->roles.name[kind] = as_name(record->more[kind]);
    }
    return options_settle(o, &record->setting, err);
}
