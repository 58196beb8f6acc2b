/* SPDX-License-Identifier: MIT */
#include "scene_mesh.h"

#include <stdlib.h>
#include <string.h>

/* As many as make a silhouette look round at the distances that the scenes are seen from. */
enum { SECTORS = 48, RINGS = 24 };

/* Room for `more` elements; the new address, or NULL with mesh->failed set. */
static void *grow(struct mesh *mesh, void *array, size_t size, uint32_t count, uint32_t more,
                  uint32_t *capacity)
{
    if (count + more <= *capacity)
        return array;
    uint32_t wanted = *capacity ? 2 * *capacity : 1024;
    void *larger = realloc(array, wanted * size);
    if (larger)
        *capacity = wanted;
    else
        mesh->failed = true;
    return larger;
}

/* Two triangles; the corners go round counter-clockwise to the eye. */
static void add_quad(struct mesh *mesh, const struct mesh_vertex corners[4])
{
    static const uint32_t order[6] = {0, 1, 2, 0, 2, 3};
    if (mesh->failed)
        return;
    struct mesh_vertex *vertices =
        grow(mesh, mesh->vertices, sizeof *vertices, mesh->vertex_count, 4, &mesh->vertex_capacity);
    if (vertices)
        mesh->vertices = vertices;
    uint32_t *indices =
        grow(mesh, mesh->indices, sizeof *indices, mesh->index_count, 6, &mesh->index_capacity);
    if (indices)
        mesh->indices = indices;
    if (mesh->failed)
        return;
    for (int i = 0; i < 6; ++i)
        mesh->indices[mesh->index_count++] = mesh->vertex_count + order[i];
    memcpy(mesh->vertices + mesh->vertex_count, corners, 4 * sizeof *corners);
    mesh->vertex_count += 4;
}

static struct mesh_vertex vertex(struct vec3 position, struct vec3 normal, struct vec3 albedo)
{
    return (struct mesh_vertex){
        {(float)position.x, (float)position.y, (float)position.z},
        {(float)normal.x, (float)normal.y, (float)normal.z},
        {(float)albedo.x, (float)albedo.y, (float)albedo.z},
    };
}

struct face {
    struct vec3 normal, across, up; /* across x up = normal */
};

static const struct face faces[6] = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
    {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
    {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}},
};
enum { FACE_UP = 2, FACE_DOWN = 3 };
static const double quad_across[4] = {-1, 1, 1, -1}, quad_up[4] = {-1, -1, 1, 1};

static void add_box(struct mesh *mesh, const struct mesh_place *place, struct vec3 half,
                    const struct vec3 *albedo)
{
    for (int f = 0; f < 6; ++f) {
        struct mesh_vertex corners[4];
        for (int i = 0; i < 4; ++i) {
            struct vec3 unit =
                mad(faces[f].across, quad_across[i], mad(faces[f].up, quad_up[i], faces[f].normal));
            struct vec3 local = mad(unit, 0.5, vec3(0.5, 0.5, 0.5));
            corners[i] =
                vertex(add(mul_transposed(place->axes, mul(unit, half)), place->position),
                       mul_transposed(place->axes, faces[f].normal), albedo ? *albedo : local);
        }
        add_quad(mesh, corners);
    }
}

void mesh_box(struct mesh *mesh, struct mesh_place place, struct vec3 half, struct vec3 albedo)
{
    add_box(mesh, &place, half, &albedo);
}

void mesh_color_box(struct mesh *mesh, struct mesh_place place, struct vec3 half)
{
    add_box(mesh, &place, half, NULL);
}

void mesh_room(struct mesh *mesh, struct vec3 size, struct vec3 floor, struct vec3 walls)
{
    struct vec3 center = vec3(0, 0.5 * size.y, 0);
    for (int f = 0; f < 6; ++f) {
        struct mesh_vertex corners[4];
        /* The other way round, to be seen from inside. */
        for (int i = 0; i < 4; ++i) {
            struct vec3 unit = mad(faces[f].across, quad_across[3 - i],
                                   mad(faces[f].up, quad_up[3 - i], faces[f].normal));
            corners[i] = vertex(mad(mul(unit, size), 0.5, center), scale(faces[f].normal, -1),
                                f == FACE_DOWN ? floor : walls);
        }
        if (f != FACE_UP)
            add_quad(mesh, corners);
    }
}

/* On the unit sphere: sector counts round +y, ring from the bottom up. */
static struct vec3 sphere_point(int sector, int ring)
{
    double around = 2 * PI * sector / SECTORS, up = PI * ring / RINGS - PI / 2;
    return vec3(cos(up) * sin(around), sin(up), cos(up) * cos(around));
}

void mesh_sphere(struct mesh *mesh, struct vec3 center, double radius, struct vec3 even,
                 struct vec3 odd)
{
    for (int i = 0; i < SECTORS * RINGS; ++i) {
        int sector = i % SECTORS, ring = i / SECTORS;
        struct vec3 albedo = sector / (SECTORS / 8) % 2 ? odd : even;
        struct mesh_vertex corners[4];
        for (int c = 0; c < 4; ++c) {
            struct vec3 n = sphere_point(sector + (quad_across[c] > 0), ring + (quad_up[c] > 0));
            corners[c] = vertex(mad(n, radius, center), n, albedo);
        }
        add_quad(mesh, corners);
    }
}

void mesh_cylinder(struct mesh *mesh, struct vec3 base, double radius, double height,
                   struct vec3 albedo)
{
    struct vec3 up = vec3(0, 1, 0), top = mad(up, height, base);
    for (int sector = 0; sector < SECTORS; ++sector) {
        struct vec3 n0 = sphere_point(sector, RINGS / 2), n1 = sphere_point(sector + 1, RINGS / 2);
        add_quad(mesh, (struct mesh_vertex[4]){
                           vertex(mad(n0, radius, base), n0, albedo),
                           vertex(mad(n1, radius, base), n1, albedo),
                           vertex(mad(n1, radius, top), n1, albedo),
                           vertex(mad(n0, radius, top), n0, albedo),
                       });
        /* The second triangle of a top's sector has no area. */
        add_quad(mesh, (struct mesh_vertex[4]){
                           vertex(mad(n0, radius, top), up, albedo),
                           vertex(mad(n1, radius, top), up, albedo),
                           vertex(top, up, albedo),
                           vertex(top, up, albedo),
                       });
    }
}

void mesh_free(struct mesh *mesh)
{
    free(mesh->vertices);
    free(mesh->indices);
    *mesh = (struct mesh){0};
}
