/* SPDX-License-Identifier: MIT */
#include "summary.h"

void text_add_summary(struct text *text, const struct gbuffer *gbuffer)
{
    const struct gbuffer *g = gbuffer;
    const struct role *depth = &g->roles.kind[ROLE_DEPTH], *normal = &g->roles.kind[ROLE_NORMAL];
    text_add(text, "depth=%s (%s, %s) normal=", depth->label, depth_type_name(g->depth_type),
             pixel_type_name(depth->channels[0]->type));
    if (g->normal_space == NORMAL_SPACE_AUTO)
        text_add(text, "from depth");
    else
        text_add(text, "%s (%s%s)", normal->label, normal_space_name(g->normal_space),
                 g->normal_encoding == NORMAL_ENCODING_UNSIGNED ? ", 0..1" : "");
    const char *source = g->camera.source[0] ? g->camera.source : "assumed";
    if (g->camera.type == CAMERA_ORTHOGRAPHIC)
        text_add(text, " ortho=%.5g (%s)", g->camera.half_width * 2.0, source);
    else
        text_add(text, " fov=%.3gh (%s)", camera_fov_x_deg(&g->camera), source);
}
