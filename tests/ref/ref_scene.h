/* SPDX-License-Identifier: MIT
 *
 * A picture as the SSAO methods see it, from what is stored of it. */
#ifndef VKAO_TESTS_REF_SCENE_H_
#define VKAO_TESTS_REF_SCENE_H_

#include "ref_view.h"

/* normals: components of the stored image, 4 a texel, or NULL. ref_scene_free frees. */
void ref_scene_init(struct ref_scene *scene, const struct ao_view *view, uint32_t width,
                    uint32_t height, VkFormat depth_format, const double *depth,
                    const double *normals);
void ref_scene_free(struct ref_scene *scene);

#endif
