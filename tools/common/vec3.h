/* SPDX-License-Identifier: MIT
 *
 * Vectors and 3x3 matrices of doubles, as much as the ray tracer and the live scenes need. */
#ifndef VKAO_TOOLS_VEC3_H_
#define VKAO_TOOLS_VEC3_H_

#include <math.h>

#define PI 3.14159265358979323846

struct vec3 {
    double x, y, z;
};

/* Rows. A rotation whose rows are an object's axes takes world directions to the object's own. */
struct mat3 {
    struct vec3 x, y, z;
};

static inline struct vec3 vec3(double x, double y, double z)
{
    return (struct vec3){x, y, z};
}

static inline struct vec3 add(struct vec3 a, struct vec3 b)
{
    return vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline struct vec3 sub(struct vec3 a, struct vec3 b)
{
    return vec3(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline struct vec3 mul(struct vec3 a, struct vec3 b)
{
    return vec3(a.x * b.x, a.y * b.y, a.z * b.z);
}

static inline struct vec3 scale(struct vec3 a, double s)
{
    return vec3(a.x * s, a.y * s, a.z * s);
}

static inline struct vec3 mad(struct vec3 a, double s, struct vec3 b)
{
    return add(scale(a, s), b);
}

static inline struct vec3 mix3(struct vec3 a, struct vec3 b, double t)
{
    return mad(sub(b, a), t, a);
}

static inline double dot(struct vec3 a, struct vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vec3 cross(struct vec3 a, struct vec3 b)
{
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline double length(struct vec3 a)
{
    return sqrt(dot(a, a));
}

static inline struct vec3 normalize(struct vec3 a)
{
    return scale(a, 1.0 / length(a));
}

static inline struct vec3 mul_mat(struct mat3 m, struct vec3 a)
{
    return vec3(dot(m.x, a), dot(m.y, a), dot(m.z, a));
}

static inline struct vec3 mul_transposed(struct mat3 m, struct vec3 a)
{
    return mad(m.x, a.x, mad(m.y, a.y, scale(m.z, a.z)));
}

static inline struct mat3 mat3_identity(void)
{
    return (struct mat3){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
}

/* The frame whose y axis is the unit vector y; x and z are any that complete it. Continuous except
 * at y = -z: Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6(1), 2017. */
static inline struct mat3 mat3_around(struct vec3 y)
{
    double sign = copysign(1.0, y.z);
    double a = -1.0 / (sign + y.z);
    double b = y.x * y.y * a;
    struct vec3 t = vec3(1.0 + sign * y.x * y.x * a, sign * b, -sign * y.x);
    return (struct mat3){t, y, cross(t, y)};
}

/* Object axes turned by yaw about +y, then by pitch about the object's x, then by roll about its z;
 * radians. */
static inline struct mat3 mat3_turned(double yaw, double pitch, double roll)
{
    double cy = cos(yaw), sy = sin(yaw), cp = cos(pitch), sp = sin(pitch);
    struct vec3 x = vec3(cy, 0, -sy), y = vec3(0, 1, 0), z = vec3(sy, 0, cy);
    struct vec3 y1 = mad(y, cp, scale(z, sp)), z1 = mad(z, cp, scale(y, -sp));
    double cr = cos(roll), sr = sin(roll);
    return (struct mat3){mad(x, cr, scale(y1, sr)), mad(y1, cr, scale(x, -sr)), z1};
}

#endif
