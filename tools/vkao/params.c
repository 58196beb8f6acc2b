/* SPDX-License-Identifier: MIT */
#include "output.h"

#include "json_text.h"

#include <stdio.h>

static const char *method_name(const struct options *o)
{
    static const char *const names[] = {"sphere", "hemisphere", "hbao", "gtao", "vbao", "raymarch"};
    return names[o->ssao.method];
}

/* Floats as the user wrote them: 0.6, not 0.60000002384185791. */
static void add_number(cJSON *object, const char *name, float value)
{
    char digits[32];
    snprintf(digits, sizeof digits, "%.7g", (double)value);
    cJSON_AddRawToObject(object, name, digits);
}

static void add_camera(cJSON *root, const struct camera *camera)
{
    cJSON *object = cJSON_AddObjectToObject(root, "camera");
    if (camera->type == CAMERA_ORTHOGRAPHIC)
        add_number(object, "ortho_width", (float)(camera->half_width * 2.0));
    else
        add_number(object, "fov_x_deg", (float)camera_fov_x_deg(camera));
    if (camera->near_plane > 0)
        add_number(object, "near", (float)camera->near_plane);
    cJSON_AddStringToObject(object, "source", camera->source[0] ? camera->source : "assumed");
}

char *output_params_json(const struct options *o, const struct rendered_view *view,
                         const char *device)
{
    const struct gbuffer *g = &view->gbuffer;
    const unsigned begun = json_begin();
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "method", method_name(o));
    if (o->ssao.method == VKAO_SSAO_SPHERE)
        cJSON_AddStringToObject(root, "sphere_form",
                                o->ssao.sphere_form == VKAO_SPHERE_LITERAL ? "literal"
                                                                           : "rescaled");
    add_number(root, "radius", view->ssao.radius);
    cJSON_AddStringToObject(root, "falloff",
                            o->ssao.falloff == VKAO_FALLOFF_SMOOTH ? "smooth" : "threshold");
    if (o->ssao.method <= VKAO_SSAO_HEMISPHERE || o->ssao.method == VKAO_SSAO_RAYMARCH)
        cJSON_AddNumberToObject(root, "samples", o->ssao.sample_count);
    if (o->ssao.method > VKAO_SSAO_HEMISPHERE) {
        cJSON_AddNumberToObject(root, "slices", o->ssao.slice_count);
        cJSON_AddNumberToObject(root, "steps", o->ssao.step_count);
        add_number(root, "thickness", o->ssao.thickness);
    }
    cJSON_AddBoolToObject(root, "half_resolution", o->half_resolution);
    add_number(root, "bias", view->ssao.bias);
    add_number(root, "intensity", o->blur.intensity);
    add_number(root, "power", o->blur.power);
    cJSON_AddNumberToObject(root, "blur", o->blur.radius);
    add_number(root, "blur_sharpness", o->blur.sharpness);
    cJSON_AddStringToObject(root, "depth", g->roles.kind[ROLE_DEPTH].label);
    cJSON_AddStringToObject(root, "depth_type", depth_type_name(g->depth_type));
    bool normals = g->normal_space != NORMAL_SPACE_AUTO;
    cJSON_AddStringToObject(root, "normal", normals ? g->roles.kind[ROLE_NORMAL].label : "none");
    if (normals)
        cJSON_AddStringToObject(root, "normal_space", normal_space_name(g->normal_space));
    add_camera(root, &g->camera);
    cJSON_AddStringToObject(root, "device", device);
    char *json = json_text(root, false, begun);
    cJSON_Delete(root);
    return json;
}
