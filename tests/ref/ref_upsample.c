/* SPDX-License-Identifier: MIT */
#include "ref_upsample.h"

#include "ref_normal.h"

#include <math.h>
#include <stdlib.h>

static VkRect2D halved(VkRect2D r)
{
    int x1 = r.offset.x + (int)r.extent.width, y1 = r.offset.y + (int)r.extent.height;
    int x0 = r.offset.x / 2, y0 = r.offset.y / 2;
    return (VkRect2D){{x0, y0}, {(uint32_t)((x1 + 1) / 2 - x0), (uint32_t)((y1 + 1) / 2 - y0)}};
}

void ref_scene_half(const struct ref_scene *full, const struct ao_view *view, const double *stored,
                    struct ref_scene *half, double **half_stored)
{
    *half = (struct ref_scene){.view = full->view,
                               .width = (full->width + 1) / 2,
                               .height = (full->height + 1) / 2,
                               .is_half = true};
    size_t texels = (size_t)half->width * half->height;
    bool given = view->normal_encoding != VKAO_NORMALS_FROM_DEPTH;
    /* Texel i lies at 2i: (2i + 1/2 - x) / w = (i + 1/2 - (x + 1/2) / 2) / (w / 2) */
    for (int i = 0; i < 2; ++i) {
        half->view.viewport[i] = (full->view.viewport[i] + 0.5) / 2.0;
        half->view.viewport[2 + i] = full->view.viewport[2 + i] / 2.0;
    }
    half->view.valid = halved(full->view.valid);
    half->view.rect = half->view.valid;
    half->z = malloc(texels * sizeof *half->z);
    half->normals = malloc(texels * 3 * sizeof *half->normals);
    half->planes = malloc(texels * 3 * sizeof *half->planes);
    *half_stored = malloc(texels * 4 * sizeof **half_stored);
    if (!half->z || !half->normals || !half->planes || !*half_stored)
        abort();
    for (size_t i = 0; i < texels; ++i) {
        size_t at = i / half->width * 2 * full->width + i % half->width * 2;
        half->z[i] = full->z[at];
        for (size_t c = 0; given && c < 4; ++c)
            (*half_stored)[i * 4 + c] = stored[at * 4 + c];
    }
    for (size_t i = 0; i < texels; ++i)
        ref_scene_normal(half, view, (int)(i % half->width), (int)(i / half->width),
                         given ? &(*half_stored)[i * 4] : NULL, &half->normals[i * 3],
                         &half->planes[i * 3]);
    if (!given) {
        free(*half_stored);
        *half_stored = NULL;
    }
}

struct upsample {
    const struct ref_scene *full, *half;
    const struct ao_blur *params;
    vkao_normal_encoding encoding;
    const double *stored;
    double nothing;
    double width; /* of the viewport in scene units */
};

/* The smaller of the differences to both neighbours, 0 without any. */
static double slope(const struct ref_scene *scene, int x, int y, int dx, int dy)
{
    double z = ref_scene_z(scene, x, y);
    double a = z - ref_scene_z(scene, x - dx, y - dy), b = ref_scene_z(scene, x + dx, y + dy) - z;
    if (isnan(a))
        return isnan(b) ? 0.0 : b;
    return isnan(b) || fabs(a) < fabs(b) ? a : b;
}

static double normal_weight(const struct upsample *u, int x, int y, int other_x, int other_y)
{
    double a[3], b[3];
    if (!u->stored || u->params->normal_power == 0.0f ||
        !ref_normal_decode(u->encoding, &u->stored[((size_t)y * u->full->width + (size_t)x) * 4],
                           a) ||
        !ref_normal_decode(u->encoding,
                           &u->stored[((size_t)other_y * u->full->width + (size_t)other_x) * 4], b))
        return 1.0;
    return pow(fmax(0.0, ref_dot(a, b)), (double)u->params->normal_power);
}

/* Of the one, two or four neighbours that bilinear weights leave, all alike, the mean by max(0, 1 -
 * off) * max(0, n.n')^power over the neighbours, off being how far a neighbour's depth is from the
 * plane that the slopes continue, in units of depth / sharpness. A ghost of a weight, which falls
 * with off, decides where those are all 0. */
static double upsampled(const struct upsample *u, const double *value, int x, int y)
{
    double z = ref_scene_z(u->full, x, y), sum = 0.0, weights = 0.0;
    double sx = slope(u->full, x, y, 1, 0), sy = slope(u->full, x, y, 0, 1);
    double scale = (double)u->params->sharpness / (u->full->view.orthographic ? u->width : z);
    for (int j = y / 2; j <= (y + 1) / 2; ++j) {
        for (int i = x / 2; i <= (x + 1) / 2; ++i) {
            double other = ref_scene_z(u->half, i, j);
            if (isnan(other))
                continue;
            double dx = 2.0 * i - x, dy = 2.0 * j - y;
            double off = scale * fabs(other - z - sx * dx - sy * dy);
            double w = fmax(0.0, 1.0 - off);
            w *= normal_weight(u, x, y, 2 * i, 2 * j);
            w += 1.0e-6 / (1.0 + off * off);
            sum += w * value[(size_t)j * u->half->width + (size_t)i];
            weights += w;
        }
    }
    return weights > 0.0 ? sum / weights : u->nothing;
}

void ref_upsample(const struct ref_scene *full, const struct ref_scene *half,
                  const struct ao_blur *params, vkao_normal_encoding encoding, const double *stored,
                  double nothing, const double *value, double *out)
{
    double left[3], right[3];
    const double *viewport = full->view.viewport;
    ref_view_position(&full->view, viewport[0] - 0.5, 0.0, 1.0, left);
    ref_view_position(&full->view, viewport[0] + viewport[2] - 0.5, 0.0, 1.0, right);
    struct upsample u = {
        full, half, params, encoding, encoding ? stored : NULL, nothing, fabs(right[0] - left[0])};
    const VkRect2D *rect = &full->view.rect;
    for (int y = rect->offset.y; y < rect->offset.y + (int)rect->extent.height; ++y) {
        for (int x = rect->offset.x; x < rect->offset.x + (int)rect->extent.width; ++x) {
            bool background = isnan(ref_scene_z(full, x, y));
            out[(size_t)y * full->width + (size_t)x] =
                background ? nothing : upsampled(&u, value, x, y);
        }
    }
}
