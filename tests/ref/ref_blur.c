/* SPDX-License-Identifier: MIT */
#include "ref_blur.h"

#include "ref_normal.h"

#include <math.h>
#include <stdlib.h>

struct blur {
    const struct ref_scene *scene;
    const struct ao_blur *params;
    vkao_normal_encoding encoding;
    const double *stored;
    double ndc_width; /* scene units across the viewport, what sharpness is relative to without
                         perspective */
    double bias;
    bool is_visibility;
};

static size_t texel_index(const struct blur *blur, int x, int y)
{
    return (size_t)y * blur->scene->width + (size_t)x;
}

/* The smaller of the two differences to the neighbours along the axis, 0 without any. */
static double slope(const struct blur *blur, int x, int y, int dx, int dy)
{
    double z = ref_scene_z(blur->scene, x, y);
    double a = z - ref_scene_z(blur->scene, x - dx, y - dy),
           b = ref_scene_z(blur->scene, x + dx, y + dy) - z;
    if (isnan(a) && isnan(b))
        return 0.0;
    if (isnan(a) || isnan(b))
        return isnan(a) ? b : a;
    return fabs(a) < fabs(b) ? a : b;
}

static bool compares_normals(const struct blur *blur)
{
    return blur->params->normal_power > 0.0f && blur->stored &&
           blur->encoding != VKAO_NORMALS_FROM_DEPTH;
}

static double normal_weight(const struct blur *blur, size_t center, size_t tap)
{
    double a[3], b[3];
    if (!compares_normals(blur) ||
        !ref_normal_decode(blur->encoding, &blur->stored[center * 4], a) ||
        !ref_normal_decode(blur->encoding, &blur->stored[tap * 4], b))
        return 1.0;
    return pow(fmax(0.0, ref_dot(a, b)), (double)blur->params->normal_power);
}

/* What is left of tap k, off whose own surface the centre lies, the blur not comparing normals. */
static double bend_weight(const struct blur *blur, int x, int y, int dx, int dy, int k)
{
    if (!(blur->params->sharpness > 0.0f))
        return 1.0;
    double z = ref_scene_z(blur->scene, x, y),
           tap_z = ref_scene_z(blur->scene, x + k * dx, y + k * dy);
    double here[3], next[3];
    ref_view_position(&blur->scene->view, x, y, z, here);
    ref_view_position(&blur->scene->view, x + dx, y + dy, z, next);
    double texel = hypot(next[0] - here[0], next[1] - here[1]);
    double off = fabs(tap_z - z - slope(blur, x + k * dx, y + k * dy, dx, dy) * k);
    double steps = 3.0 * (blur->bias + ref_view_depth_error(&blur->scene->view, z));
    return fmax(0.33, 1.0 - off / (fabs(slope(blur, x, y, dx, dy)) + 0.3 * texel + steps));
}

/* The mean of 4 neighbours that are means of 2 r - 2 each; in small blurs of 2 that are of 2 r. */
static double flat_weight(int k, int radius)
{
    int box = radius < 3 ? 2 : 4, other = 2 * radius + 2 - box, shared = 0;
    for (int i = 0; i < box; ++i) {
        int rest = k + radius - i;
        shared += rest >= 0 && rest < other;
    }
    return (double)shared / box;
}

/* flat_weight * max(0, 1 - sharpness |z_k - z - slope k| / z), times max(0, n.n_k)^normal_power or
 * bend_weight. Visibility where this leaves less than .45 of the window: at most .15 of the flat
 * mean besides; of a small radius with what normals leave, of a large one without. Where normals
 * are not compared, either side of the window counts (1 + .35 p) / 1.35 times, p being what is left
 * of the other side. */
static double blurred(const struct blur *blur, const double *ao, int x, int y, int dx, int dy)
{
    double z = ref_scene_z(blur->scene, x, y), sums[3] = {0}, weights[3] = {0};
    double near = 0.0, most = 0.0, flat = 0.0, others = 0.0;
    int radius = (int)blur->params->radius;
    if (isnan(z))
        return 1.0;
    double s = slope(blur, x, y, dx, dy);
    double scale =
        (double)blur->params->sharpness / (blur->scene->view.orthographic ? blur->ndc_width : z);
    for (int k = -radius; k <= radius; ++k) {
        double tap_z = ref_scene_z(blur->scene, x + k * dx, y + k * dy);
        double w = k ? flat_weight(k, radius) : 1.0, full = k ? w : 0.0;
        most += full;
        if (isnan(tap_z))
            continue;
        others += full;
        size_t tap = texel_index(blur, x + k * dx, y + k * dy);
        flat += full * ao[tap];
        double off = fabs(tap_z - z - s * k);
        w *= fmax(0.0, 1.0 - scale * off);
        double normals = k ? normal_weight(blur, texel_index(blur, x, y), tap) : 1.0;
        if (k != 0 && !compares_normals(blur))
            w *= bend_weight(blur, x, y, dx, dy, k);
        if (k != 0)
            near += w * (radius < 3 ? normals : 1.0);
        int side = (k > 0) - (k < 0) + 1;
        sums[side] += w * normals * ao[tap];
        weights[side] += w * normals;
    }
    double across = compares_normals(blur) ? 0.6 : 0.35, side = most > 0.0 ? most / 2.0 : 1.0;
    double before = (1.0 + across * weights[2] / side) / (1.0 + across),
           behind = (1.0 + across * weights[0] / side) / (1.0 + across);
    double sum = sums[1] + before * sums[0] + behind * sums[2];
    double all = weights[1] + before * weights[0] + behind * weights[2];
    double leak =
        radius > 0 && blur->is_visibility ? fmax(0.0, 0.15 * (1.0 - near / (0.45 * most))) : 0.0;
    return (sum + leak * flat) / (all + leak * others);
}

double ref_blur_finish(const struct ao_blur *params, double visibility)
{
    double v = fmin(1.0, fmax(0.0, 1.0 - (double)params->intensity * (1.0 - visibility)));
    return pow(v, (double)params->power);
}

void ref_blur_channel(const struct ref_scene *scene, const struct ao_blur *params,
                      vkao_normal_encoding encoding, const double *stored, const double *noisy,
                      double bias, bool is_visibility, double *out)
{
    double left[3], right[3];
    const double *viewport = scene->view.viewport;
    ref_view_position(&scene->view, viewport[0] - 0.5, 0.0, 1.0, left);
    ref_view_position(&scene->view, viewport[0] + viewport[2] - 0.5, 0.0, 1.0, right);
    struct blur blur = {scene, params,       encoding, stored, fabs(right[0] - left[0]),
                        bias,  is_visibility};
    const VkRect2D *rect = &scene->view.rect, *valid = &scene->view.valid;
    double *halfway = malloc((size_t)scene->width * scene->height * sizeof *halfway);
    if (!halfway)
        abort();
    for (int y = valid->offset.y; y < valid->offset.y + (int)valid->extent.height; ++y) {
        for (int x = rect->offset.x; x < rect->offset.x + (int)rect->extent.width; ++x)
            halfway[texel_index(&blur, x, y)] = blurred(&blur, noisy, x, y, 1, 0);
    }
    for (int y = rect->offset.y; y < rect->offset.y + (int)rect->extent.height; ++y) {
        for (int x = rect->offset.x; x < rect->offset.x + (int)rect->extent.width; ++x) {
            out[texel_index(&blur, x, y)] = blurred(&blur, halfway, x, y, 0, 1);
        }
    }
    free(halfway);
}

void ref_blur(const struct ref_scene *scene, const struct ao_blur *params,
              vkao_normal_encoding encoding, const double *stored, const double *noisy, double bias,
              double *ao)
{
    const VkRect2D *rect = &scene->view.rect;
    ref_blur_channel(scene, params, encoding, stored, noisy, bias, true, ao);
    for (int y = rect->offset.y; y < rect->offset.y + (int)rect->extent.height; ++y) {
        for (int x = rect->offset.x; x < rect->offset.x + (int)rect->extent.width; ++x) {
            size_t i = (size_t)y * scene->width + (size_t)x;
            ao[i] = ref_blur_finish(params, ao[i]);
        }
    }
}
