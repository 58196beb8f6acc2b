/* SPDX-License-Identifier: MIT */
#include "ref_scene.h"

#include "ref_normal.h"

#include <stdlib.h>

void ref_scene_init(struct ref_scene *scene, const struct ao_view *view, uint32_t width,
                    uint32_t height, VkFormat depth_format, const double *depth,
                    const double *normals)
{
    size_t texels = (size_t)width * height;
    *scene = (struct ref_scene){.width = width, .height = height};
    scene->z = malloc(texels * sizeof *scene->z);
    scene->normals = malloc(texels * 3 * sizeof *scene->normals);
    scene->planes = malloc(texels * 3 * sizeof *scene->planes);
    if (!scene->z || !scene->normals || !scene->planes)
        abort();
    ref_view_init(&scene->view, view, width, height, depth_format);
    for (size_t i = 0; i < texels; ++i)
        scene->z[i] = ref_view_z(&scene->view, (double)(i % width), (double)(i / width), depth[i]);
    for (size_t i = 0; i < texels; ++i)
        ref_scene_normal(scene, view, (int)(i % width), (int)(i / width),
                         normals ? &normals[i * 4] : NULL, &scene->normals[i * 3],
                         &scene->planes[i * 3]);
}

void ref_scene_free(struct ref_scene *scene)
{
    free(scene->z);
    free(scene->normals);
    free(scene->planes);
    *scene = (struct ref_scene){0};
}
