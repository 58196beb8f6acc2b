/* SPDX-License-Identifier: MIT */
#include "ref_composite.h"

#include "ref_normal.h"

#include <math.h>

void ref_composite(const struct ao_composite *params, double ao, const double color[4],
                   const double direct[4], double out[4])
{
    double strength = (double)params->strength, a = (1.0 - strength) + ao * strength;
    for (int i = 0; i < 3; ++i) {
        double tint = (double)params->tint[i], factor = tint * (1.0 - a) + a;
        switch (params->mode) {
        case VKAO_COMPOSITE_INDIRECT:
            out[i] = direct[i] + color[i] * factor;
            break;
        case VKAO_COMPOSITE_AO_ONLY:
            out[i] = factor;
            break;
        default:
            out[i] = color[i] * factor;
            break;
        }
    }
    out[3] = params->mode == VKAO_COMPOSITE_AO_ONLY ? 1.0 : color[3];
}

double ref_multi_bounce(double ao, double albedo)
{
    double a = 2.0404 * albedo - 0.3324, b = -4.7951 * albedo + 0.6417,
           c = 2.7552 * albedo + 0.6903;
    return fmax(ao, a * ao * ao * ao + b * ao * ao + c * ao);
}

static double saturate(double v)
{
    return fmax(0.0, fmin(1.0, v));
}

double ref_specular_from_ao(double ao, double roughness, const double n[3], const double v[3])
{
    double facing = fmax(0.0, ref_dot(n, v));
    return saturate(pow(facing + ao, exp2(-16.0 * roughness - 1.0)) - 1.0 + ao);
}

/* Two spherical caps of angular radius a and b, their centres apart by d: the smaller one whole
 * while it lies inside the other, nothing when they do not touch, and in between a smooth step. */
static double cap_intersection(double a, double b, double d)
{
    double inside = fabs(a - b), touch = a + b, area = 1.0 - cos(fmin(a, b));
    if (d <= inside)
        return area;
    if (d >= touch)
        return 0.0;
    double x = 1.0 - (d - inside) / (touch - inside);
    return area * x * x * (3.0 - 2.0 * x);
}

double ref_specular_from_bent(double ao, double roughness, const double n[3], const double v[3],
                              const double bent[3])
{
    /* A cone about the normal with cosine c has visibility 1 - c^2; a lobe's cone has a cosine of
     * 10^-(r^2). A mirror's is a point, which is seen or not. */
    double r = fmax(roughness, 0.01), lobe = acos(pow(10.0, -r * r)), open = acos(sqrt(1.0 - ao));
    double reflected[3];
    for (int i = 0; i < 3; ++i)
        reflected[i] = 2.0 * ref_dot(n, v) * n[i] - v[i];
    double between = acos(fmax(-1.0, fmin(1.0, ref_dot(bent, reflected))));
    return saturate(cap_intersection(open, lobe, between) / (1.0 - cos(lobe)));
}
