/* SPDX-License-Identifier: MIT
 *
 * What the kinds of scenes differ in. */
#ifndef VKAO_VIEW_SCENE_DESIGN_H_
#define VKAO_VIEW_SCENE_DESIGN_H_

#include "orbit.h"
#include "scene_mesh.h"

struct live_design {
    const char *name;
    struct orbit camera;
    float radius;        /* scene units, for ssao.radius */
    float background[3]; /* linear */
    void (*build_still)(struct mesh *mesh);
    /* In its own coordinates, which motion() takes to the world's. */
    void (*build_moving)(struct mesh *mesh);
    struct mesh_place (*motion)(double time); /* seconds */
};

extern const struct live_design live_cubes, live_room;

#endif
