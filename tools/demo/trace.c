/* SPDX-License-Identifier: MIT */
#include "trace.h"

#include <float.h>
#include <stdlib.h>

/* --- solids as spans of the ray --- */

/* The part of a line inside a convex solid, and the outward normals at its ends. Empty if enter >=
 * exit. */
struct span {
    double enter, exit;
    struct vec3 n_enter, n_exit;
};

static const struct span everything = {.enter = -INFINITY, .exit = INFINITY};
static const struct span nothing = {.enter = INFINITY, .exit = -INFINITY};

static struct span intersection(struct span a, struct span b)
{
    struct span s = a;
    if (b.enter > s.enter) {
        s.enter = b.enter;
        s.n_enter = b.n_enter;
    }
    if (b.exit < s.exit) {
        s.exit = b.exit;
        s.n_exit = b.n_exit;
    }
    return s;
}

/* |origin + t * direction| <= half along one axis. */
static struct span slab(double origin, double direction, double half, struct vec3 axis)
{
    if (direction == 0.0)
        return fabs(origin) <= half ? everything : nothing;
    double s = copysign(1.0, direction);
    return (struct span){
        .enter = (-s * half - origin) / direction,
        .exit = (s * half - origin) / direction,
        .n_enter = scale(axis, -s),
        .n_exit = scale(axis, s),
    };
}

/* |o + t d| <= radius, where o and d have been flattened for cylinders. */
static struct span ball(struct vec3 o, struct vec3 d, double radius)
{
    double dd = dot(d, d), c = dot(o, o) - radius * radius;
    if (dd == 0.0)
        return c <= 0.0 ? everything : nothing;
    /* The closest approach first, for o far away: o.o - r^2 would cancel. */
    double t = -dot(o, d) / dd;
    struct vec3 nearest = mad(d, t, o);
    double h2 = (radius * radius - dot(nearest, nearest)) / dd;
    if (h2 <= 0.0)
        return nothing;
    double h = sqrt(h2);
    return (struct span){
        .enter = t - h,
        .exit = t + h,
        .n_enter = scale(mad(d, t - h, o), 1.0 / radius),
        .n_exit = scale(mad(d, t + h, o), 1.0 / radius),
    };
}

static struct span box(struct vec3 o, struct vec3 d, struct vec3 half)
{
    struct span x = slab(o.x, d.x, half.x, vec3(1, 0, 0));
    struct span y = slab(o.y, d.y, half.y, vec3(0, 1, 0));
    struct span z = slab(o.z, d.z, half.z, vec3(0, 0, 1));
    return intersection(intersection(x, y), z);
}

static struct span cylinder(struct vec3 o, struct vec3 d, double radius, double half)
{
    struct span round = ball(vec3(o.x, 0, o.z), vec3(d.x, 0, d.z), radius);
    return intersection(round, slab(o.y, d.y, half, vec3(0, 1, 0)));
}

static bool nearest_end(struct span s, double t_min, double t_max, double *t, struct vec3 *n)
{
    if (!(s.enter < s.exit))
        return false;
    bool outside = s.enter > t_min;
    *t = outside ? s.enter : s.exit;
    *n = outside ? s.n_enter : s.n_exit;
    return *t > t_min && *t < t_max;
}

/* Solid less hole: what is left before the hole, then what is left behind it. */
static bool nearest_end_bored(struct span solid, struct span hole, double t_min, double t_max,
                              double *t, struct vec3 *n)
{
    if (!(hole.enter < hole.exit))
        return nearest_end(solid, t_min, t_max, t, n);
    struct span before = {-INFINITY, hole.enter, {0, 0, 0}, scale(hole.n_enter, -1.0)};
    struct span behind = {hole.exit, INFINITY, scale(hole.n_exit, -1.0), {0, 0, 0}};
    return nearest_end(intersection(solid, before), t_min, t_max, t, n) ||
           nearest_end(intersection(solid, behind), t_min, t_max, t, n);
}

static bool hit_local(const struct trace_primitive *p, struct vec3 o, struct vec3 d, double t_min,
                      double t_max, double *t, struct vec3 *n)
{
    switch (p->kind) {
    case TRACE_PLANE:
    case TRACE_DISK: {
        *t = -o.y / d.y;
        *n = vec3(0, 1, 0);
        double x = o.x + *t * d.x, z = o.z + *t * d.z;
        return *t > t_min && *t < t_max &&
               (p->kind == TRACE_PLANE || x * x + z * z <= p->size.x * p->size.x);
    }
    case TRACE_SPHERE:
        return nearest_end(ball(o, d, p->size.x), t_min, t_max, t, n);
    case TRACE_BOX:
        return nearest_end(box(o, d, p->size), t_min, t_max, t, n);
    case TRACE_CYLINDER:
        return nearest_end(cylinder(o, d, p->size.x, p->size.y), t_min, t_max, t, n);
    case TRACE_BORED_BOX: {
        struct span hole = ball(vec3(o.x, o.y - p->bore_y, 0), vec3(d.x, d.y, 0), p->bore);
        return nearest_end_bored(box(o, d, p->size), hole, t_min, t_max, t, n);
    }
    case TRACE_BORED_CYLINDER: {
        struct span hole = ball(vec3(o.x, 0, o.z), vec3(d.x, 0, d.z), p->bore);
        return nearest_end_bored(cylinder(o, d, p->size.x, p->size.y), hole, t_min, t_max, t, n);
    }
    }
    return false;
}

/* --- primitives --- */

static struct trace_primitive primitive(enum trace_kind kind, struct vec3 position,
                                        struct mat3 axes, struct vec3 size)
{
    return (struct trace_primitive){
        .kind = kind, .position = position, .axes = axes, .size = size, .albedo = {0.8, 0.8, 0.8}};
}

struct trace_primitive trace_plane(struct vec3 point, struct vec3 normal)
{
    return primitive(TRACE_PLANE, point, mat3_around(normalize(normal)), vec3(0, 0, 0));
}

struct trace_primitive trace_disk(struct vec3 center, struct vec3 normal, double radius)
{
    return primitive(TRACE_DISK, center, mat3_around(normalize(normal)), vec3(radius, 0, radius));
}

struct trace_primitive trace_sphere(struct vec3 center, double radius)
{
    return primitive(TRACE_SPHERE, center, mat3_identity(), vec3(radius, radius, radius));
}

struct trace_primitive trace_box(struct vec3 center, struct vec3 half)
{
    return primitive(TRACE_BOX, center, mat3_identity(), half);
}

struct trace_primitive trace_cylinder(struct vec3 a, struct vec3 b, double radius)
{
    struct vec3 axis = sub(b, a);
    return primitive(TRACE_CYLINDER, scale(add(a, b), 0.5), mat3_around(normalize(axis)),
                     vec3(radius, 0.5 * length(axis), radius));
}

void trace_add(struct trace_scene *scene, struct trace_primitive p)
{
    if (scene->count == scene->capacity) {
        size_t capacity = scene->capacity ? 2 * scene->capacity : 64;
        struct trace_primitive *grown = realloc(scene->primitives, capacity * sizeof(*grown));
        if (!grown) {
            scene->failed = true;
            return;
        }
        scene->primitives = grown;
        scene->capacity = capacity;
    }
    scene->primitives[scene->count++] = p;
}

void trace_scene_free(struct trace_scene *scene)
{
    free(scene->primitives);
    free(scene->nodes);
    free(scene->order);
    *scene = (struct trace_scene){0};
}

/* --- the tree: axis-aligned boxes, halved at the median --- */

struct bounds {
    struct vec3 low, high;
};

struct trace_node {
    struct bounds bounds;
    uint32_t first,
        count; /* leaf: order[first..first+count). Inner, count 0: children are next and `first` */
};

enum { LEAF_PRIMITIVES = 3, TREE_DEPTH = 48 };

static struct vec3 lower(struct vec3 a, struct vec3 b)
{
    return vec3(fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z));
}

static struct vec3 upper(struct vec3 a, struct vec3 b)
{
    return vec3(fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z));
}

static struct bounds primitive_bounds(const struct trace_primitive *p)
{
    struct mat3 m = p->axes;
    struct mat3 magnitude = {vec3(fabs(m.x.x), fabs(m.x.y), fabs(m.x.z)),
                             vec3(fabs(m.y.x), fabs(m.y.y), fabs(m.y.z)),
                             vec3(fabs(m.z.x), fabs(m.z.y), fabs(m.z.z))};
    struct vec3 size = p->size;
    if (p->kind != TRACE_BOX && p->kind != TRACE_BORED_BOX)
        size.z = size.x;
    if (p->kind == TRACE_SPHERE)
        size.y = size.x;
    if (p->kind == TRACE_DISK)
        size.y = 0;
    struct vec3 half = mul_transposed(magnitude, size);
    double slack = 1e-9 * (1.0 + length(half) + length(p->position)); /* a disk has no thickness */
    half = add(half, vec3(slack, slack, slack));
    return (struct bounds){sub(p->position, half), add(p->position, half)};
}

static double component(struct vec3 a, int axis)
{
    return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}

/* Insertion sort by position: stable, so that the tree does not depend on the C library. */
static void sort_along(const struct trace_scene *scene, uint32_t *order, uint32_t count, int axis)
{
    for (uint32_t i = 1; i < count; i++) {
        uint32_t moved = order[i];
        double key = component(scene->primitives[moved].position, axis);
        uint32_t j = i;
        for (; j > 0 && component(scene->primitives[order[j - 1]].position, axis) > key; j--)
            order[j] = order[j - 1];
        order[j] = moved;
    }
}

static void build_node(struct trace_scene *scene, uint32_t first, uint32_t count)
{
    struct trace_node *node = &scene->nodes[scene->node_count++];
    struct bounds all = {vec3(DBL_MAX, DBL_MAX, DBL_MAX), vec3(-DBL_MAX, -DBL_MAX, -DBL_MAX)};
    for (uint32_t i = first; i < first + count; i++) {
        struct bounds b = primitive_bounds(&scene->primitives[scene->order[i]]);
        all = (struct bounds){lower(all.low, b.low), upper(all.high, b.high)};
    }
    *node = (struct trace_node){all, first, count};
    if (count <= LEAF_PRIMITIVES)
        return;
    struct vec3 extent = sub(all.high, all.low);
    int axis = extent.x > extent.y && extent.x > extent.z ? 0 : extent.y > extent.z ? 1 : 2;
    sort_along(scene, scene->order + first, count, axis);
    uint32_t half = count / 2;
    build_node(scene, first, half);
    *node = (struct trace_node){all, (uint32_t)scene->node_count, 0};
    build_node(scene, first + half, count - half);
}

bool trace_build(struct trace_scene *scene)
{
    free(scene->nodes);
    free(scene->order);
    scene->node_count = scene->unbounded = 0;
    scene->order = malloc((scene->count + 1) * sizeof(*scene->order));
    scene->nodes = malloc((2 * scene->count + 1) * sizeof(*scene->nodes));
    if (!scene->order || !scene->nodes || scene->failed || scene->count > UINT32_MAX / 2)
        return false;
    size_t placed = 0;
    for (size_t i = 0; i < scene->count; i++) {
        if (scene->primitives[i].kind == TRACE_PLANE)
            scene->order[placed++] = (uint32_t)i;
    }
    scene->unbounded = placed;
    for (size_t i = 0; i < scene->count; i++) {
        if (scene->primitives[i].kind != TRACE_PLANE)
            scene->order[placed++] = (uint32_t)i;
    }
    if (placed > scene->unbounded)
        build_node(scene, (uint32_t)scene->unbounded, (uint32_t)(placed - scene->unbounded));
    return true;
}

/* --- rays --- */

struct query {
    struct vec3 origin, direction, inverse;
    double t_min, t_max;
    struct vec3 local_normal;
    size_t primitive;
    bool found;
};

static void test_primitive(const struct trace_scene *scene, uint32_t index, struct query *q)
{
    const struct trace_primitive *p = &scene->primitives[index];
    struct vec3 o = mul_mat(p->axes, sub(q->origin, p->position));
    struct vec3 d = mul_mat(p->axes, q->direction);
    double t;
    struct vec3 n;
    if (hit_local(p, o, d, q->t_min, q->t_max, &t, &n)) {
        q->t_max = t;
        q->local_normal = n;
        q->primitive = index;
        q->found = true;
    }
}

/* Comparisons instead of fmin(), which must mind NaN and is a call. NaN, 0 * infinity, comes from
 * rays that run in the plane of a face; the boxes have slack, so what they miss there is no
 * primitive's. */
static bool meets(const struct bounds *b, const struct query *q)
{
    struct vec3 a = mul(sub(b->low, q->origin), q->inverse),
                c = mul(sub(b->high, q->origin), q->inverse);
    double enter = q->t_min, exit = q->t_max;
    double near = a.x < c.x ? a.x : c.x, far = a.x < c.x ? c.x : a.x;
    enter = near > enter ? near : enter;
    exit = far < exit ? far : exit;
    near = a.y < c.y ? a.y : c.y, far = a.y < c.y ? c.y : a.y;
    enter = near > enter ? near : enter;
    exit = far < exit ? far : exit;
    near = a.z < c.z ? a.z : c.z, far = a.z < c.z ? c.z : a.z;
    enter = near > enter ? near : enter;
    exit = far < exit ? far : exit;
    return enter <= exit;
}

static void search(const struct trace_scene *scene, struct query *q, bool any)
{
    for (size_t i = 0; i < scene->unbounded; i++)
        test_primitive(scene, scene->order[i], q);
    uint32_t stack[TREE_DEPTH];
    int top = 0;
    if (scene->node_count)
        stack[top++] = 0;
    while (top && !(any && q->found)) {
        uint32_t index = stack[--top];
        const struct trace_node *node = &scene->nodes[index];
        if (!meets(&node->bounds, q))
            continue;
        for (uint32_t i = 0; i < node->count; i++)
            test_primitive(scene, scene->order[node->first + i], q);
        if (!node->count) {
            stack[top++] = node->first;
            stack[top++] = index + 1;
        }
    }
}

static struct query start(struct vec3 origin, struct vec3 direction, double t_min, double t_max)
{
    return (struct query){
        .origin = origin,
        .direction = direction,
        .inverse = vec3(1.0 / direction.x, 1.0 / direction.y, 1.0 / direction.z),
        .t_min = t_min,
        .t_max = t_max,
    };
}

bool trace_closest(const struct trace_scene *scene, struct vec3 origin, struct vec3 direction,
                   double t_min, double t_max, struct trace_hit *hit)
{
    struct query q = start(origin, direction, t_min, t_max);
    search(scene, &q, false);
    if (!q.found)
        return false;
    const struct trace_primitive *p = &scene->primitives[q.primitive];
    struct vec3 position = mad(direction, q.t_max, origin);
    *hit = (struct trace_hit){
        .t = q.t_max,
        .position = position,
        .normal = mul_transposed(p->axes, q.local_normal),
        .local = mul_mat(p->axes, sub(position, p->position)),
        .local_normal = q.local_normal,
        .primitive = q.primitive,
    };
    return true;
}

bool trace_any(const struct trace_scene *scene, struct vec3 origin, struct vec3 direction,
               double t_min, double t_max)
{
    struct query q = start(origin, direction, t_min, t_max);
    search(scene, &q, true);
    return q.found;
}

struct vec3 trace_facing(const struct trace_hit *hit, struct vec3 direction)
{
    return dot(hit->normal, direction) > 0.0 ? scale(hit->normal, -1.0) : hit->normal;
}

struct vec3 trace_albedo(const struct trace_scene *scene, const struct trace_hit *hit)
{
    return scene->albedo ? scene->albedo(scene, hit) : scene->primitives[hit->primitive].albedo;
}
