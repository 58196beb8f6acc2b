/* SPDX-License-Identifier: MIT
 *
 * ../ssao.glsl for two texels side by side. The includer defines
 *     Visibility visibility(ivec2 texel, Real3 position, Real3 normal, Planes plane)
 * for them, texel being the first; plane is that of the depth image. An invocation has texels of a
 * tile from the list, and writes codes into the buffer or texels into an image. With
 * VKAO_STORAGE_16BIT two codes are one store to a storage buffer, which costs less than a texel
 * buffer. */
#ifndef VKAO_PAIRED_SSAO_GLSL_
#define VKAO_PAIRED_SSAO_GLSL_

#include "lanes.glsl"
layout(local_size_x = VKAO_ROW_GROUP_WIDTH) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "view.glsl"
#include "normals.glsl"
#include "noise.glsl"
#include "falloff.glsl"
#define VKAO_CODES TEXELS
#include "codes.glsl"
#include "noisy_images.glsl"

struct Visibility {
    Real3 bent; /* if BENT_NORMALS: mean visible direction, of any length */
    real open;
};

struct Noise {
    real turn, jitter;
};

/* slices: 1 in methods that have none. */
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

/* Any two unit vectors that make an orthonormal basis with n (Duff et al., JCGT 6(1), 2017). */
void tangents(Real3 n, out Real3 t, out Real3 b)
{
    real s = choose(real(1.0), real(-1.0), above(real(0.0), n.z));
    real a = -1.0 / (s + n.z);
    real c = n.x * n.y * a;
    t = Real3(1.0 + s * n.x * n.x * a, s * c, -s * n.x);
    b = Real3(c, s + n.y * n.y * a, -n.y);
}

/* Of any view z. */
Real3 view_positions(ivec2 texel, real z)
{
    real x = (float(texel.x) + BESIDE) * params.unproject.x + params.unproject.z;
    real y = real(float(texel.y)) * params.unproject.y + params.unproject.w;
    return ORTHOGRAPHIC ? Real3(x, y, z) : Real3(x * z, y * z, z);
}

real load_view_zs(ivec2 texel)
{
    float z[TEXELS];
    [[unroll]] for (int i = 0; i < TEXELS; ++i)
        z[i] = load_view_z(texel + ivec2(i, 0));
    return join(z);
}

/* From where border_view_z counts. */
reals border_view_zs(ints x, ints y)
{
    reals z;
    [[unroll]] for (int i = 0; i < 2 * TEXELS; ++i)
        z[i] = border_view_z(ivec2(x[i], y[i]));
    return z;
}

/* Of the depth image; see Plane. */
struct Planes {
    Real3 normal;
    real steepest;
};

/* Depth's own normals are always computed and seldom taken: that costs less than the branch. */
Real3 view_normals(ivec2 texel, vec3 given[TEXELS], Real3 position, out Planes plane)
{
    vec3 n[TEXELS], planes[TEXELS];
    float steepest[TEXELS];
    [[unroll]] for (int i = 0; i < TEXELS; ++i) {
        ivec2 at = texel + ivec2(i, 0);
        vec3 center = lane3(position, i), stored = to_view(given[i]);
        Facet own = facet_of(at, center.z);
        n[i] = trusted_normal(stored, own.normal, center);
        Plane p = plane_of(own, n[i]);
        planes[i] = p.normal;
        steepest[i] = p.steepest;
    }
    plane = Planes(join3(planes), join(steepest));
    return join3(n);
}

Visibility visibility(ivec2 texel, Real3 position, Real3 normal, Planes plane);

/* What is not seen, background, is open. */
Visibility shade(ivec2 texel)
{
    /* The caller's normals first: their memory is the farthest away. */
    vec3 given[TEXELS];
    [[unroll]] for (int i = 0; i < TEXELS; ++i)
        given[i] = decode_normal(texel + ivec2(i, 0) << GRID_SHIFT);
    real z = load_view_zs(texel);
    Real3 position = view_positions(texel, z);
    Planes plane;
    Real3 normal = view_normals(texel, given, position, plane);
    Visibility v = visibility(texel, position, normal, plane);
    /* Where numbers fail, by a radius of 1e-9 of the distance for one, nothing is known to
     * occlude. */
    v.open = sane(choose(real(1.0), v.open, above(z, real(0.0))), real(1.0));
    if (BENT_NORMALS) {
        v.bent.x = sane(choose(real(0.0), v.bent.x, above(z, real(0.0))), real(0.0));
        v.bent.y = sane(choose(real(0.0), v.bent.y, above(z, real(0.0))), real(0.0));
        v.bent.z = sane(choose(real(0.0), v.bent.z, above(z, real(0.0))), real(0.0));
    }
    return v;
}

void store_noisy(ivec2 texel, Visibility v)
{
    /* Both texels at once, those beyond the rect as well: what they are does not depend on it. */
    if ((PATH & VKAO_PATH_PACKED) != 0u) {
        store_codes(texel, code_of(v.open.x) | code_of(v.open.y) << 8);
        return;
    }
    [[unroll]] for (int i = 0; i < TEXELS; ++i) {
        ivec2 at = texel + ivec2(i, 0);
        if (in_rect(at, here.rect))
            store_images(at, lane3(v.bent, i), lane(v.open, i));
    }
}

void main()
{
    /* Straight on, also where there is nothing to do: a driver in software runs both sides of a
     * branch anyway. */
    ivec2 texel = tile_texel() + ivec2(int(gl_LocalInvocationID.x) * TEXELS, gl_WorkGroupID.x);
    Visibility v = shade(texel);
    if (all(lessThan(texel, unpack_texel(here.rect.y))))
        store_noisy(texel, v);
}

#endif
