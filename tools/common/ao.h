/* SPDX-License-Identifier: MIT
 *
 * Images in host memory in, ambient occlusion in host memory out: the public header of the library,
 * driven the way any engine would drive it. */
#ifndef VKAO_TOOLS_AO_H_
#define VKAO_TOOLS_AO_H_

#include "error.h"
#include "gpu.h"
#include "setting.h"

struct ao_job {
    uint32_t width, height;
    const float *depth; /* width * height, rows from the top; what view.depth_encoding says */
    /* width * height * 4 (xyz and padding), or NULL; what view.normal_encoding says */
    const float *normals;
    const float *color; /* width * height * 4 linear RGBA, or NULL = no composite */
    /* width * height each, where setting.effect asks for them: what its thickness_input says, and
     * depth as that above */
    const float *thickness, *second_depth;
    /* width * height * 4 each, where setting.effect has multi_bounce and specular */
    const float *albedo, *specular;
    struct ao_view view;
    struct setting setting; /* the job itself decides stages, encodings, projection and ao_format */
};

struct ao_result {
    float *ao;     /* width * height visibility in [0,1] */
    float *bent;   /* width * height * 4: mean open direction and padding, NULL if not asked for */
    float *output; /* width * height * 4 RGBA of the composite, NULL without color */
    /* device time of all stages, by timestamps; of the whole submit where the queue has none */
    double gpu_ms;
};

/* Memory that a job takes per texel beside its own images, on host and device together. */
uint64_t ao_job_texel_bytes(bool has_normals, bool has_color, const vkao_effect_info *effect);

/* A session keeps device objects from one frame to the next: create once, run per frame of the same
 * or of another size. What is compiled is compiled anew when the job's settings change. */
struct ao_session;
struct ao_session *ao_session_create(struct gpu *gpu, struct tool_error *err);
void ao_session_destroy(struct ao_session *session);

/* result's arrays are malloc'ed; ao_result_free frees them. On failure *result is empty, and the
 * session is as good as new unless err->ends_run. Errors: EXIT_DEVICE, EXIT_MEMORY; EXIT_CHANNELS
 * if the library refuses view or parameters, whose reason it prints. */
bool ao_run(struct ao_session *session, const struct ao_job *job, struct ao_result *result,
            struct tool_error *err);
void ao_result_free(struct ao_result *result);

#endif
