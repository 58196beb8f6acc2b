/* SPDX-License-Identifier: MIT
 *
 * Slices: planes through the eye direction V and a direction on screen. Angles in a slice are
 * measured from V, positive on the side of the screen direction; the hemisphere's cosine-weighted
 * measure in a slice is L cos(theta - n) |sin theta| dtheta. */
#ifndef VKAO_TESTS_REF_HORIZON_H_
#define VKAO_TESTS_REF_HORIZON_H_

#include "ref_noise.h"
#include "ref_view.h"

struct ref_slice {
    const struct ref_scene *scene;
    const struct ao_ssao *params;
    int x, y;
    struct ref_noise noise;
    double p[3], n[3], plane[3], to_eye[3]; /* plane: normal of the depth image */
    double direction[2];                    /* on screen, unit */
    double outward[3], across[3];           /* orthonormal with to_eye */
    double length, angle;                   /* L and n of the projected normal */
    double fall;                            /* of that plane, against V, per length outwards */
    double steepest;    /* cosine to the eye at which it stops getting steeper */
    double guard;       /* how far a height may be off */
    double per_unit[2]; /* texels of a scene unit along the direction, as deep as p */
};

/* Slice k of params->slice_count through texel (x, y), turned by the noise. */
void ref_slice_init(struct ref_slice *slice, const struct ref_scene *scene,
                    const struct ao_ssao *params, int x, int y, const double p[3],
                    const double n[3], uint32_t k);
/* The slice of a given angle on screen, with nothing but its geometry. */
void ref_slice_turn(struct ref_slice *slice, double angle);

/* One step outwards on one side. */
struct ref_sample {
    int x, y;        /* texel */
    double v[3];     /* from the shaded point */
    double out, up;  /* in the slice, out on that side */
    double distance; /* of that point: hypot(out, up) */
};
/* reach in scene units. False where nothing is known: it is then as deep as
 * the shaded point. */
bool ref_slice_sample(const struct ref_slice *slice, double side, uint32_t step, double reach,
                      struct ref_sample *sample);

/* 1 - (d/R)^2 within R, or 1 within R. */
double ref_falloff(const struct ao_ssao *params, double distance);

/* What params->thickness is relative to, falloff and all. */
double ref_thickness_scale(const struct ao_ssao *params);

/* Integrals from a to b over theta: of the measure without L, and of the measure
 * times (sin theta, cos theta). */
double ref_slice_integral(double n, double a, double b);
void ref_slice_moment(double n, double a, double b, double out[2]);

#endif
