/* SPDX-License-Identifier: MIT
 *
 * The frame of every SSAO method: one invocation per texel of the rect, background exactly 1. The includer defines
 *     vec4 visibility(ivec2 texel, vec3 position, vec3 normal)
 * whose w is visibility and whose xyz, if BENT_NORMALS, is the mean visible direction, of any length. */
#ifndef VKAO_SSAO_GLSL_
#define VKAO_SSAO_GLSL_

layout(constant_id = VKAO_CONSTANT_SLICES) const uint SLICES = 0u;
layout(constant_id = VKAO_CONSTANT_STEPS) const uint STEPS = 0u;
layout(constant_id = VKAO_CONSTANT_SAMPLES) const uint SAMPLES = 0u;
#ifdef VKAO_BUFFERS
layout(local_size_x = VKAO_ROW_GROUP_WIDTH) in;
#else
layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
#endif
layout(push_constant) uniform Block { vkao_ssao_block params; };
layout(binding = VKAO_BINDING_NOISY_WRITE) uniform writeonly image2D noisy_image;
#ifdef VKAO_BUFFERS
layout(binding = VKAO_BINDING_PACKED_TEXELS) uniform writeonly uimageBuffer packed_texels;
#endif
#define VKAO_UNPROJECT
#include "view.glsl"
#include "noise.glsl"

vec4 visibility(ivec2 texel, vec3 position, vec3 normal);

uint slice_count()
{
    return SLICES != 0u ? SLICES : params.counts & 0xffu;
}

uint step_count()
{
    return STEPS != 0u ? STEPS : (params.counts >> 8) & 0xfffu;
}

uint sample_count()
{
    return SAMPLES != 0u ? SAMPLES : params.counts >> 20;
}

/* Any two unit vectors that make an orthonormal basis with n (Duff et al., JCGT 6(1), 2017). */
void tangents(vec3 n, out vec3 t, out vec3 b)
{
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float c = n.x * n.y * a;
    t = vec3(1.0 + s * n.x * n.x * a, s * c, -s * n.x);
    b = vec3(c, s + n.y * n.y * a, -n.y);
}

/* How far a view z may be off through the precision of the depth that it came from. */
float depth_error(float z)
{
    float line = params.depth_error.x + params.depth_error.y * z;
    return orthographic() ? line : z * line;
}

/* Length of a point of the kernel, u uniform in [0,1). A point at length l is hidden if its ray hits anything within l,
 * so the distribution of l carries the falloff: P(l > t) = 1 - (t/R)^2 for l = R sqrt(u), the smooth one. For the
 * threshold a ray counts alike wherever it hits, so the lengths crowd towards R. */
float point_length(float u, float radius)
{
    return radius * (flag(VKAO_FLAG_THRESHOLD) ? sqrt(sqrt(u)) : sqrt(u));
}

/* How much an occluder counts whose view z is dz off the shaded point's: all within the radius, then less and less, as
 * the surface in front need not reach down to the point behind it. */
float range_weight(float dz, float radius)
{
    float t = radius / max(abs(dz), radius);
    return t * t * (3.0 - 2.0 * t);
}

/* Is the point at height point_height over the tangent plane behind the scene at occluder? Heights are compared, not
 * depths: the depth image knows the scene at texel centres only, and on a tilted wall half a texel sideways moves z,
 * but not the height, which is 0 all over the wall. A wall is open at any tilt that way. */
bool stands_in_front(vec3 occluder, vec3 position, vec3 normal, float point_height)
{
    return dot(normal, occluder - position) > point_height;
}

void store_noisy(ivec2 texel, vec4 result)
{
#ifdef VKAO_BUFFERS
    if (flag(VKAO_FLAG_PACKED)) {
        int code = int(clamp((result.w + VKAO_CODE_OFFSET) * VKAO_CODE_SCALE, 0.0, 255.0) + 0.5);
        imageStore(packed_texels, buffer_row(texel.y) + texel.x, uvec4(code));
        return;
    }
#endif
    imageStore(noisy_image, texel, BENT_NORMALS ? result : result.wwww);
}

/* The texel whose centre is nearest, of any point within the valid texels; what lies outside stays there. Cutting off
 * the fraction is cheaper than rounding down, and the same from -1 on, where the border begins. */
ivec2 nearest_texel(vec2 point)
{
    return ivec2(point + 1.5) - 1;
}

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + unpack_texel(params.rect.x);
    /* Straight on, also where there is nothing to do: a driver in software runs both sides of a branch anyway. */
    float z = load_view_z(texel);
    vec3 position = view_position(vec2(texel), z);
    vec4 result = visibility(texel, position, view_normal(texel, position));
    result = z > 0.0 ? result : vec4(0.0, 0.0, 0.0, 1.0);
    if (all(lessThan(texel, unpack_texel(params.rect.y))))
        store_noisy(texel, result);
}

#endif
