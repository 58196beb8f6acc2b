/* SPDX-License-Identifier: MIT
 *
 * The frame of every SSAO method: TEXELS of the rect per invocation, background exactly 1. The includer defines
 *     Visibility visibility(ivec2 texel, Real3 position, Real3 normal)
 * for them, texel being the first, and VKAO_SIDE_BY_SIDE if it profits from more than one. Where results go, and which
 * texels an invocation has, invocation.glsl says. */
#ifndef VKAO_SSAO_GLSL_
#define VKAO_SSAO_GLSL_

layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "lanes.glsl"
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
    return SLICES != 0u ? SLICES : params.slices;
}

uint step_count()
{
    return STEPS != 0u ? STEPS : params.steps;
}

uint sample_count()
{
    return SAMPLES != 0u ? SAMPLES : params.samples;
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
    return ORTHOGRAPHIC ? line : z * line;
}

/* Length of a point of the kernel in radii, u uniform in [0,1). A point at length l is hidden if its ray hits anything
 * within l, so the distribution of l carries the falloff: P(l > t) = 1 - t^2 for l = sqrt(u), the smooth one. For the
 * threshold a ray counts alike wherever it hits, so the lengths crowd towards 1. */
float point_length(float u)
{
    return THRESHOLD ? sqrt(sqrt(u)) : sqrt(u);
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

/* What is not seen, background, is open. */
Visibility shade(ivec2 texel)
{
    real z = load_view_zs(texel);
    Real3 position = view_positions(texel, z);
    Visibility v = visibility(texel, position, view_normals(texel, position));
    /* Where numbers fail, by a radius of 1e-9 of the distance for one, nothing is known to occlude. */
    v.open = sane(choose(real(1.0), v.open, above(z, real(0.0))), real(1.0));
    if (BENT_NORMALS) {
        v.bent.x = sane(choose(real(0.0), v.bent.x, above(z, real(0.0))), real(0.0));
        v.bent.y = sane(choose(real(0.0), v.bent.y, above(z, real(0.0))), real(0.0));
        v.bent.z = sane(choose(real(0.0), v.bent.z, above(z, real(0.0))), real(0.0));
    }
    return v;
}

#include "invocation.glsl"

#endif
