/* SPDX-License-Identifier: MIT
 *
 * Sectors of vbao. With c = cos theta, the slice's density cos(theta - n) |sin theta| dtheta
 * becomes (cos n * c + sin n * sqrt(1 - c^2)) dc, whose integral is
 *     G(c) = cos n * c^2 / 2 + sin n * g(c),   g(c) = (c sqrt(1 - c^2) + asin c) / 2.
 * Each side has its own mask of 31 sectors of equal mass between the tangent plane, c = -sin n, and
 * V, c = 1: a bound costs a polynomial and no angle. */
#ifndef VKAO_SECTORS_GLSL_
#define VKAO_SECTORS_GLSL_

#include "product.glsl"

const float SECTORS = float(VKAO_VBAO_SECTORS);

/* c (G1 + G3 c^2) fits g(c) over [-1, 1]. Its largest error is .0053. On the side that the normal
 * leans to that moves a sector bound by .21 of a sector at most. On the other side sectors are
 * small: there it moves by .0104 of the slice's integral at most. */
const float G1 = 1.0225, G3 = -0.232;

reals g(reals c)
{
    return c * (G1 + c * c * G3);
}

/* Sector bound of cosine c is the polynomial k0 + k1 c + k2 c^2 + k3 c^3, inside the side's
 * mass. */
struct Masks {
    reals low; /* cosine of the tangent plane */
    reals mass;
    reals k0, k1, k2, k3;
};

/* sin_n: of the normal's angle towards each side. */
Masks make_masks(reals sin_n, reals cos_n)
{
    Masks m;
    reals cn = 0.5 * cos_n;
    m.low = -sin_n;
    reals below = cn * m.low * m.low + sin_n * g(m.low);
    m.mass = max(cn + sin_n * (G1 + G3) - below, reals(1.0e-4));
    reals scale = SECTORS / m.mass;
    m.k0 = VKAO_VBAO_ROUND - below * scale;
    m.k2 = product(cn, scale);
    m.k1 = product(reals(G1), sin_n * scale);
    m.k3 = product(reals(G3), sin_n * scale);
    return m;
}

#endif
