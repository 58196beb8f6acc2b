/* SPDX-License-Identifier: MIT
 *
 * The frame of every SSAO method: TEXELS of the rect per invocation, background exactly 1. The includer defines
 *     Visibility visibility(ivec2 texel, Real3 position, Real3 normal)
 * for them, texel being the first, and VKAO_SIDE_BY_SIDE if it profits from more than one. */
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
#define VKAO_UNPROJECT
#include "lanes.glsl"
#ifdef VKAO_BUFFERS
#ifdef VKAO_STORAGE_16BIT
#ifndef VKAO_SIDE_BY_SIDE
#error two codes at once are those of two texels
#endif
layout(binding = VKAO_BINDING_PACKED_WORDS) writeonly buffer Packed { uint16_t packed_pairs[]; };
#else
layout(binding = TEXELS == 1 ? VKAO_BINDING_PACKED_WRITE : VKAO_BINDING_PACKED_WRITE2) uniform writeonly
    uimageBuffer packed_codes;
#endif
layout(binding = VKAO_BINDING_TILES) readonly buffer Tiles { vkao_tiles_head head; uint tiles[]; };
#endif
#include "view.glsl"
#include "normals.glsl"
#include "noise.glsl"

struct Visibility {
    Real3 bent; /* if BENT_NORMALS: mean visible direction, of any length */
    real open;
};

/* These are at least 1. Loops over them test at their end, as a driver in software goes through a body once more to find
 * that no lane is left. */
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
void tangents(Real3 n, out Real3 t, out Real3 b)
{
    real s = choose(real(1.0), real(-1.0), above(real(0.0), n.z));
    real a = -1.0 / (s + n.z);
    real c = n.x * n.y * a;
    t = Real3(1.0 + s * n.x * n.x * a, s * c, -s * n.x);
    b = Real3(c, s + n.y * n.y * a, -n.y);
}

/* How far a view z may be off through the precision of the depth that it came from. */
real depth_error(real z)
{
    real line = params.depth_error.x + params.depth_error.y * z;
    return orthographic() ? line : z * line;
}

/* Length of a point of the kernel in radii, u uniform in [0,1). A point at length l is hidden if its ray hits anything
 * within l, so the distribution of l carries the falloff: P(l > t) = 1 - t^2 for l = sqrt(u), the smooth one. For the
 * threshold a ray counts alike wherever it hits, so the lengths crowd towards 1. */
float point_length(float u)
{
    return flag(VKAO_FLAG_THRESHOLD) ? sqrt(sqrt(u)) : sqrt(u);
}

/* How much an occluder counts whose view z is dz off the shaded point's: all within the radius, then less and less, as
 * the surface in front need not reach down to the point behind it. */
reals range_weight(reals dz, float radius)
{
    reals t = radius / greater(abs(dz), reals(radius));
    return t * t * (3.0 - 2.0 * t);
}

/* Is the point at height point_height over the tangent plane behind the scene at occluder? Heights are compared, not
 * depths: the depth image knows the scene at texel centres only, and on a tilted wall half a texel sideways moves z,
 * but not the height, which is 0 all over the wall. A wall is open at any tilt that way. */
bool stands_in_front(vec3 occluder, vec3 position, vec3 normal, float point_height)
{
    return dot(normal, occluder - position) > point_height;
}

struct Noise {
    real turn, jitter;
};

/* slices: of each texel, 1 in methods that have none. */
Noise texel_noise(ivec2 texel, uint slices)
{
    float turn[TEXELS], jitter[TEXELS];
    [[unroll]] for (int i = 0; i < TEXELS; ++i) {
        vec2 noise = tile_noise(uvec2(texel + ivec2(i, 0)), slices, params.noise_index);
        turn[i] = noise.x;
        jitter[i] = noise.y;
    }
    return Noise(join(turn), join(jitter));
}

Visibility visibility(ivec2 texel, Real3 position, Real3 normal);

void store_noisy(ivec2 texel, Visibility v)
{
#ifdef VKAO_BUFFERS
    /* All of the texels at once, those beyond the rect as well: what they are does not depend on it. */
    if (flag(VKAO_FLAG_PACKED)) {
        whole code = whole(clamp((v.open + VKAO_CODE_OFFSET) * VKAO_CODE_SCALE, 0.0, 255.0) + 0.5);
        int at = (buffer_row(texel.y) + texel.x) / TEXELS;
#ifdef VKAO_STORAGE_16BIT
        packed_pairs[at] = uint16_t(pack_codes(code));
#else
        imageStore(packed_codes, at, uvec4(pack_codes(code)));
#endif
        return;
    }
#endif
    [[unroll]] for (int i = 0; i < TEXELS; ++i) {
        ivec2 at = texel + ivec2(i, 0);
        vec4 result = vec4(lane3(v.bent, i), lane(v.open, i));
        if (in_rect(at, params.rect))
            imageStore(noisy_image, at, BENT_NORMALS ? result : result.wwww);
    }
}

void main()
{
#ifdef VKAO_BUFFERS
    /* Straight on, also where there is nothing to do: a driver in software runs both sides of a branch anyway. */
    ivec2 texel = unpack_texel(tiles[gl_WorkGroupID.y]);
    texel += ivec2(int(gl_LocalInvocationID.x) * TEXELS, gl_WorkGroupID.x);
#else
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + unpack_texel(params.rect.x);
#endif
    real z = load_view_zs(texel);
#ifndef VKAO_BUFFERS
    if (z <= 0.0) {
        store_noisy(texel, Visibility(Real3(0.0, 0.0, 0.0), 1.0));
        return;
    }
#endif
    Real3 position = view_positions(texel, z);
    Visibility v = visibility(texel, position, view_normals(texel, position));
    /* Where numbers fail, by a radius of 1e-9 of the distance for one, nothing is known to occlude. */
    v.open = sane(choose(real(1.0), v.open, above(z, real(0.0))), real(1.0));
    if (BENT_NORMALS) {
        v.bent.x = sane(choose(real(0.0), v.bent.x, above(z, real(0.0))), real(0.0));
        v.bent.y = sane(choose(real(0.0), v.bent.y, above(z, real(0.0))), real(0.0));
        v.bent.z = sane(choose(real(0.0), v.bent.z, above(z, real(0.0))), real(0.0));
    }
    if (all(lessThan(texel, unpack_texel(params.rect.y))))
        store_noisy(texel, v);
}

#endif
