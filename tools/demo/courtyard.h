/* SPDX-License-Identifier: MIT
 *
 * The demo's scene: a courtyard with corners, gaps, thin rails and clutter, all that ambient
 * occlusion is good and bad at. Units are metres, +y is up. */
#ifndef VKAO_DEMO_COURTYARD_H_
#define VKAO_DEMO_COURTYARD_H_

#include "trace_camera.h"
#include "trace.h"

/* Adds the primitives and sets scene->albedo; the caller builds. */
void courtyard_add(struct trace_scene *scene);
struct trace_camera courtyard_camera(void);

#endif
