/* SPDX-License-Identifier: MIT
 *
 * A live scene and vkao in one command buffer, with two frames in flight: what a viewer does,
 * without its window. */
#ifndef VKAO_TESTS_LIVE_RIG_H_
#define VKAO_TESTS_LIVE_RIG_H_

#include "fixture.h"
#include "scene.h"

enum { RIG_FLIGHTS = 2, RIG_PROJECTIONS = 2 };

struct rig_flight {
    struct live_target target;
    struct gpu_image ao, output;
    vkao_effect *effects[RIG_PROJECTIONS]; /* by vkao_projection */
    vkao_frame *frames[RIG_PROJECTIONS];
    VkCommandBuffer cmd; /* null while nothing is pending */
    VkFence fence;
};

struct rig {
    struct live_scene *scene;
    enum live_kind kind;
    bool multi_bounce;
    struct rig_flight flights[RIG_FLIGHTS];
};

/* What came out, row by row; only the used texels. */
struct shot {
    uint32_t width, height;
    struct ao_view view;
    double *depth;                                /* 1 a texel, as stored */
    double *ao;                                   /* 1 a texel */
    double *normals, *indirect, *direct, *output; /* 4 a texel, as stored */
};

void rig_open(struct rig *rig, enum live_kind kind, uint32_t width, uint32_t height);
/* Waits for what is pending, then makes targets and frames anew. */
void rig_resize(struct rig *rig, uint32_t width, uint32_t height);
void rig_close(struct rig *rig);

/* The scene, then all of vkao. */
void rig_record(const struct rig *rig, int flight, VkCommandBuffer cmd, const struct orbit *camera,
                double time, VkExtent2D used);
/* Submits and returns at once. Waits first for what the flight had pending. */
void rig_submit(struct rig *rig, int flight, const struct orbit *camera, double time,
                VkExtent2D used);
void rig_wait(struct rig *rig, int flight);
/* Waits for the flight's submit and takes its images; shot_free frees. */
void rig_take(struct rig *rig, int flight, const struct orbit *camera, VkExtent2D used,
              struct shot *shot);

/* rig_submit and rig_take of flight 0, all texels used. */
void rig_shoot(struct rig *rig, const struct orbit *camera, double time, struct shot *shot);
size_t shot_texels(const struct shot *shot);
void shot_free(struct shot *shot);
/* Every image, bit for bit. */
void shot_check_equal(const struct shot *a, const struct shot *b);
/* The texel that a world point falls into; -1 if something hides it or it is outside of the
 * image. */
long shot_texel_of(const struct shot *shot, const struct orbit *camera, const double world[3]);

#endif
