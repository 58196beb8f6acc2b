/* SPDX-License-Identifier: MIT */
#include "trace_camera.h"

void trace_camera_look_at(struct trace_camera *camera, struct vec3 eye, struct vec3 target)
{
    struct vec3 back = normalize(sub(eye, target));
    struct vec3 right = normalize(cross(vec3(0, 1, 0), back));
    camera->rotation = (struct mat3){right, cross(back, right), back};
    camera->translation = scale(mul_mat(camera->rotation, eye), -1.0);
}

static struct vec3 eye_of(const struct trace_camera *camera)
{
    return scale(mul_transposed(camera->rotation, camera->translation), -1.0);
}

/* Half the width of the picture: at z = 1 for perspective cameras, everywhere for orthographic
 * ones. */
static double half_width(const struct trace_camera *camera)
{
    return camera->orthographic ? 0.5 * camera->ortho_width : tan(camera->fov_x_deg * (PI / 360.0));
}

struct trace_ray trace_camera_ray(const struct trace_camera *camera, double x, double y, int width,
                                  int height)
{
    double half = half_width(camera);
    double u = (2.0 * x / width - 1.0) * half;
    double v = (1.0 - 2.0 * y / height) * half * height / width;
    struct vec3 eye = eye_of(camera);
    if (camera->orthographic) {
        return (struct trace_ray){
            .origin = add(eye, mul_transposed(camera->rotation, vec3(u, v, 0))),
            .direction = scale(camera->rotation.z, -1.0),
            .z_per_t = 1.0,
        };
    }
    struct vec3 d = vec3(u, v, -1.0);
    return (struct trace_ray){
        .origin = eye,
        .direction = normalize(mul_transposed(camera->rotation, d)),
        .z_per_t = 1.0 / length(d),
    };
}

static void multiply(const double a[16], const double b[16], float out[16])
{
    for (int r = 0; r < 4; r++) {
        for (int c = 0; c < 4; c++) {
            double sum = 0;
            for (int k = 0; k < 4; k++)
                sum += a[r * 4 + k] * b[k * 4 + c];
            out[r * 4 + c] = (float)sum;
        }
    }
}

void trace_camera_exr_matrices(const struct trace_camera *camera, int width, int height,
                               float world_to_camera[16], float world_to_ndc[16])
{
    const struct mat3 *m = &camera->rotation;
    /* OpenEXR's camera space looks along +z: the third column is mirrored. */
    const double view[16] = {
        m->x.x,
        m->y.x,
        -m->z.x,
        0,
        m->x.y,
        m->y.y,
        -m->z.y,
        0,
        m->x.z,
        m->y.z,
        -m->z.z,
        0,
        camera->translation.x,
        camera->translation.y,
        -camera->translation.z,
        1,
    };
    double sx = 0.5 / half_width(camera), sy = -sx * width / height;
    double n = camera->near, f = camera->far;
    double perspective[16] = {sx, 0, 0, 0, 0, sy, 0, 0, 0.5, 0.5, 1, 1, 0, 0, -n, 0};
    double orthographic[16] = {sx, 0, 0, 0, 0, sy, 0, 0, 0, 0, 0, 0, 0.5, 0.5, 0, 1};
    /* Depth 0..1 over near..far; OpenEXR leaves it undefined. */
    if (isfinite(f)) {
        perspective[10] = f / (f - n);
        perspective[14] = -n * f / (f - n);
        orthographic[10] = 1.0 / (f - n);
        orthographic[14] = -n / (f - n);
    }
    static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    multiply(view, identity, world_to_camera);
    multiply(view, camera->orthographic ? orthographic : perspective, world_to_ndc);
}
