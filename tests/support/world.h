/* SPDX-License-Identifier: MIT
 *
 * What a unit test starts from: a fake driver, watched host memory, a log that is kept, and infos
 * that are right until the test makes them wrong. */
#ifndef WORLD_H_
#define WORLD_H_

#include "fake_vulkan.h"
#include "host_memory.h"

#include "vkao.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

struct kept_log {
    unsigned lines, errors;
    vkao_log_level last_level;
    char last[1024];
    char last_error[1024];
};

struct world {
    struct fake_vulkan fake;
    struct host_memory host;
    struct kept_log log;
    VkAllocationCallbacks callbacks;
    VkPhysicalDeviceFeatures2 features;
    VkPhysicalDevice16BitStorageFeatures storage_features; /* in no chain yet */
    vkao_context_info info;
    vkao_context *ctx;

    /* All stages; every slot used but bent_normals, which shuns noisy_ao. */
    vkao_effect_info effect_info;
    vkao_effect *effect;

    /* Each slot with its own format; the extent is 100x60. */
    vkao_images images;
    vkao_image bent_normals; /* for world_use_bent_normals */
    vkao_frame_info frame_info;
    vkao_frame *frame;

    vkao_view view; /* perspective, right-handed, standard depth */
    vkao_params params;
};

/* Without a context yet. with_callbacks: through VkAllocationCallbacks. */
vkao_effect_info settings_of(const vkao_effect *effect);
void world_init(struct world *w, bool with_callbacks);
/* world_init and a context. */
void world_open(struct world *w);
/* An effect and a frame of it, for infos that are right. What was there is destroyed. */
void world_create_effect(struct world *w);
void world_create_frame(struct world *w);
vkao_result world_try_effect(struct world *w);
vkao_result world_try_frame(struct world *w);
/* And a frame for the stages. */
void world_open_frame(struct world *w, vkao_stage_flags stages);
/* Bent normals instead of ao_noisy, before the frame is created. */
void world_use_bent_normals(struct world *w);
/* Neither ao_noisy nor bent normals. */
void world_use_scratch_noise(struct world *w);
/* A CPU, before the context is created. */
void world_be_cpu(struct world *w);
/* Destroys frame, effect and context, and checks that nothing was left and the API was not
 * misused. */
void world_close(struct world *w);
void world_forget_log(struct world *w);
VkCommandBuffer world_cmd(struct world *w);

/* The one error line of the last call contains both. */
void expect_refused(struct world *w, vkao_result want, vkao_result got, const char *name,
                    const char *value);
/* Nothing was recorded since fake_forget_calls. */
void expect_nothing_recorded(const struct world *w);

/* The slots of vkao_images in order of declaration. */
enum { SLOT_COUNT = 10, SLOT_BENT_NORMALS = 7 };
extern const char *const world_slot_names[SLOT_COUNT];
vkao_image *world_slot(vkao_images *images, size_t index);

/* vkao_cmd_record. */
vkao_result world_record_all(struct world *w);

#endif
