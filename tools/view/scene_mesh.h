/* SPDX-License-Identifier: MIT
 *
 * The geometry of the scenes, built on the host: quadrilaterals of vertices that hold their colour.
 * World space has +y up. */
#ifndef VKAO_VIEW_SCENE_MESH_H_
#define VKAO_VIEW_SCENE_MESH_H_

#include "vec3.h"

#include <stdbool.h>
#include <stdint.h>

struct mesh_vertex {
    float position[3];
    float normal[3]; /* unit */
    float albedo[3]; /* linear, [0,1] */
};

/* Front faces are counter-clockwise to the eye. Zeroed = empty. */
struct mesh {
    struct mesh_vertex *vertices;
    uint32_t vertex_count, vertex_capacity;
    uint32_t *indices; /* triangles */
    uint32_t index_count, index_capacity;
    bool failed; /* out of memory; nothing is added any more */
};

/* A rigid motion: local to world. */
struct mesh_place {
    struct mat3 axes; /* rows: the local x, y and z in world space */
    struct vec3 position;
};

static inline struct mesh_place mesh_at(struct vec3 position)
{
    return (struct mesh_place){mat3_identity(), position};
}

/* half: half extents. */
void mesh_box(struct mesh *mesh, struct mesh_place place, struct vec3 half, struct vec3 albedo);
/* Coloured by local coordinates: black where x, y and z are least, white where they are greatest.
 * */
void mesh_color_box(struct mesh *mesh, struct mesh_place place, struct vec3 half);
/* A floor at y = 0 and four walls about the origin, seen from inside. */
void mesh_room(struct mesh *mesh, struct vec3 size, struct vec3 floor, struct vec3 walls);
/* Two colours alternate, sector by sector, so that it is seen to roll. */
void mesh_sphere(struct mesh *mesh, struct vec3 center, double radius, struct vec3 even,
                 struct vec3 odd);
/* About +y, from the base, with its top and without its bottom. */
void mesh_cylinder(struct mesh *mesh, struct vec3 base, double radius, double height,
                   struct vec3 albedo);
void mesh_free(struct mesh *mesh);

#endif
