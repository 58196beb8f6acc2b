/* SPDX-License-Identifier: MIT
 *
 * Thickness that the caller gives, or where things end, into the last bits of view z: where
 * width.comp leaves it if nobody knows. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_VIEW_Z_WRITE, r32f) uniform image2D view_z_image;
#include "columns.glsl"
#include "depth.glsl"
#include "thickness.glsl"

/* In scene units; what is not above 0 is unknown. */
float given_thickness(ivec2 texel, float z)
{
    if (THICKNESS_INPUT == VKAO_GLSL_THICKNESS_GIVEN)
        return texelFetch(depth_image, texel, 0).x;
    return view_z_from_depth(texel) - z;
}

void main()
{
    ivec2 low = unpack_texel(params.valid.x), high = unpack_texel(params.valid.y);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + low;
    if (any(greaterThanEqual(texel, high)))
        return;
    ivec2 place = view_z_place(texel);
    float z = imageLoad(view_z_image, place).x;
    float thickness = given_thickness(texel << GRID_SHIFT, z) * params.inverse_radius;
    bool is_known = thickness > 0.0 && thickness < VKAO_THICKNESS_MOST;
    if (z > 0.0)
        imageStore(view_z_image, place,
                   vec4(with_code(z, is_known ? thickness : VKAO_THICKNESS_MOST)));
}
