/* SPDX-License-Identifier: MIT */
#include "ref_width.h"

#include "params.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* View z of the k-th texel from (x, y) along an axis. Outside of the valid texels nothing is
 * known. */
static bool known(const struct ref_scene *scene, int axis, int x, int y, int k, double *z)
{
    const VkRect2D *valid = &scene->view.valid;
    x += axis == 0 ? k : 0;
    y += axis == 1 ? k : 0;
    if (x < valid->offset.x || x >= valid->offset.x + (int)valid->extent.width ||
        y < valid->offset.y || y >= valid->offset.y + (int)valid->extent.height)
        return false;
    *z = ref_scene_z(scene, x, y);
    return true;
}

/* By how much depth changes from texel k to the next; INFINITY where either has none. */
static double change(const struct ref_scene *scene, int axis, int x, int y, int k)
{
    double a, b;
    if (!known(scene, axis, x, y, k, &a) || !known(scene, axis, x, y, k + 1, &b))
        return INFINITY;
    return isnan(a) || isnan(b) ? INFINITY : fabs(b - a);
}

/* Where depth breaks between texel k and the next, which is the nearer. Background is farthest. */
enum break_kind { GOES_ON, NEXT_IS_FARTHER, NEXT_IS_NEARER };

static enum break_kind break_of(const struct ref_scene *scene, double radius, int axis, int x,
                                int y, int k)
{
    double here, next;
    if (!known(scene, axis, x, y, k, &here) || !known(scene, axis, x, y, k + 1, &next))
        return GOES_ON;
    if (isnan(here) || isnan(next))
        return isnan(next) ? NEXT_IS_FARTHER : NEXT_IS_NEARER;
    double beside = fmin(change(scene, axis, x, y, k - 1), change(scene, axis, x, y, k + 1));
    double least = scene->view.orthographic ? VKAO_VBAO_BREAK_LEAST_RADII * radius
                                            : VKAO_VBAO_BREAK_LEAST * fmin(here, next);
    if (fabs(next - here) <= VKAO_VBAO_BREAK_RISE * beside + least)
        return GOES_ON;
    return next < here ? NEXT_IS_NEARER : NEXT_IS_FARTHER;
}

/* Texels without a break, to both sides, in shares; all of 2 * most if it goes on. A side that is
 * hidden by what is nearer is as long as the other, if that is longer. */
static int shares_of_run(const struct ref_scene *scene, double radius, int axis, int x, int y,
                         int most)
{
    int ahead = 0, back = 0;
    enum break_kind end = GOES_ON, start = GOES_ON;
    while (ahead < most && !(end = break_of(scene, radius, axis, x, y, ahead)))
        ++ahead;
    while (back < most && !(start = break_of(scene, radius, axis, x, y, -back - 1)))
        ++back;
    const int longer = ahead > back ? ahead : back;
    const int texels =
        (end == NEXT_IS_NEARER ? longer : ahead) + (start == NEXT_IS_FARTHER ? longer : back);
    const bool is_hidden = end == NEXT_IS_NEARER || start == NEXT_IS_FARTHER;
    const int share = is_hidden ? VKAO_VBAO_WIDTH_HIDDEN : VKAO_VBAO_WIDTH_SHARES;
    /* What is hidden does not count as going on for being wide alone. */
    const int below_all = 2 * VKAO_VBAO_WIDTH_SHARES * most - 1;
    const int seen = texels * VKAO_VBAO_WIDTH_SHARES, limit = seen > below_all ? seen : below_all;
    return texels * share < limit ? texels * share : limit;
}

/* As few bits as view z has for it. */
static double coded(double thickness, bool is_given)
{
    const int finer = is_given ? VKAO_THICKNESS_FINER : 0, shift = VKAO_THICKNESS_SHIFT - finer;
    const int32_t mask = ((VKAO_THICKNESS_MASK + 1) << finer) - 1;
    float value = (float)fmin(thickness, 2.0);
    int32_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits = (bits - VKAO_THICKNESS_LEAST_BITS + (1 << (shift - 1))) >> shift;
    bits = bits < 0 ? 0 : bits > mask ? mask : bits;
    bits = (bits << shift) + VKAO_THICKNESS_LEAST_BITS;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* Scene units. */
static double given(const struct ref_scene *scene, double radius, int x, int y)
{
    double thickness = scene->thickness[(size_t)y * scene->width + (size_t)x];
    bool is_known = thickness > 0.0 && thickness < VKAO_THICKNESS_MOST * radius;
    return radius * coded(is_known ? thickness / radius : VKAO_THICKNESS_MOST, true);
}

double ref_width_thickness(const struct ref_scene *scene, double radius, int x, int y)
{
    if (scene->thickness)
        return given(scene, radius, x, y);
    double here[3], next[3], z = ref_scene_z(scene, x, y), width[2];
    double reach =
        scene->view.orthographic ? VKAO_VBAO_WIDTH_REACH_RADII * radius : VKAO_VBAO_WIDTH_REACH * z;
    bool goes_on = true;
    ref_view_position(&scene->view, x, y, z, here);
    ref_view_position(&scene->view, x + 1.0, y + 1.0, z, next);
    for (int axis = 0; axis < 2; ++axis) {
        double texel = fabs(next[axis] - here[axis]);
        int most = (int)fmax(1.0, reach / texel + 0.5),
            shares = shares_of_run(scene, radius, axis, x, y, most);
        goes_on = goes_on && shares == 2 * VKAO_VBAO_WIDTH_SHARES * most;
        width[axis] = (1.0 + (double)shares / VKAO_VBAO_WIDTH_SHARES) * texel;
    }
    double least = fmin(width[0], width[1]), length = fmax(width[0], width[1]) - least;
    double thickness =
        VKAO_VBAO_THICKNESS_WIDTH * (least + VKAO_VBAO_THICKNESS_LENGTH * length) / radius;
    if (goes_on)
        thickness *= VKAO_VBAO_THICKNESS_WIDER;
    return radius * coded(fmin(thickness, VKAO_VBAO_THICKNESS_WIDE), false);
}

double *ref_width_image(const struct ref_scene *scene, double radius)
{
    const size_t texels = (size_t)scene->width * scene->height;
    double *image = malloc(texels * sizeof *image);
    if (!image)
        abort();
    for (size_t i = 0; i < texels; ++i) {
        const int x = (int)(i % scene->width), y = (int)(i / scene->width);
        image[i] = isnan(ref_scene_z(scene, x, y)) ? NAN : ref_width_thickness(scene, radius, x, y);
    }
    return image;
}
