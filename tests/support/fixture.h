/* SPDX-License-Identifier: MIT
 *
 * What GPU tests stand on: a device with core, synchronization and queue-submit validation, whose
 * silence every test ends with; and pictures, which are images in doubles with the parameters to
 * run them by. */
#ifndef VKAO_TESTS_FIXTURE_H_
#define VKAO_TESTS_FIXTURE_H_

#include "gpu.h"
#include "stage_setting.h"
#include "lens.h"
#include "ref_scene.h"
#include "scenes.h"

/* cmocka.h wants these before it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define FIXTURE_UNAVAILABLE 77 /* what meson takes for a skipped test */

struct fixture {
    struct gpu gpu;
    vkao_context *context;
    struct tool_error error;
};
extern struct fixture fixture;

/* False if there is no device or no validation layer here. VKAO_TEST_DEVICE chooses the device as
 * --device does. */
bool fixture_open(void);
int fixture_close(void **state);
/* Fails the test that has just run if the validation layers said anything. */
int fixture_after_test(void **state);

#define gpu_test(function) cmocka_unit_test_teardown(function, fixture_after_test)
/* The exit code of main. */
#define fixture_run(tests)                                                                         \
    (fixture_open() ? cmocka_run_group_tests(tests, NULL, fixture_close) : FIXTURE_UNAVAILABLE)

/* What a further context on the fixture's device starts from: silent. */
vkao_context_info fixture_context_info(void);

/* Of the fixture's context, which keeps the last ones: a software driver takes longer to compile an
 * effect than to run it. Not the caller's to destroy; valid until 31 others have been asked for. */
vkao_effect *fixture_effect(const vkao_effect_info *info);
/* Before fixture.context is another. */
void fixture_forget_effects(void);

/* Fails the test with the tool's error if ok is false. */
void check(bool ok);
#define check_vkao(call)                                                                           \
    assert_string_equal(vkao_result_string(call), vkao_result_string(VKAO_SUCCESS))

/* Zeroed; fails the test when there is no memory. */
void *test_alloc(size_t count, size_t size);
VkDeviceMemory fixture_allocate(const VkMemoryRequirements *requirements, VkDeviceSize size);

enum picture_slot {
    SLOT_DEPTH,
    SLOT_NORMALS,
    SLOT_NOISY,
    SLOT_AO,
    SLOT_COLOR,
    SLOT_DIRECT,
    SLOT_OUTPUT,
    SLOT_BENT,
    SLOT_ALBEDO,
    SLOT_SPECULAR,
    SLOT_THICKNESS,
    SLOT_SECOND,
    SLOT_COUNT
};

struct picture {
    uint32_t width, height;
    vkao_stage_flags stages;
    VkFormat formats[SLOT_COUNT]; /* UNDEFINED = slot not used */
    double *values[SLOT_COUNT];   /* as the image holds them: depth, ao_noisy, ao 1 a texel, the
                                      others 4 */
    bool output_is_color;         /* composite in place */
    bool half_resolution;
    vkao_thickness_input thickness_input;
    bool staged;                   /* ao.image is given, as by default */
    VkDeviceMemory scratch_memory; /* null = the library's own */
    VkDeviceSize scratch_offset;
    struct ao_view view;
    struct ao_ssao ssao;
    struct ao_blur blur;
    struct ao_composite composite;
};

/* What a picture is on the device. */
struct picture_gpu {
    struct gpu_image images[SLOT_COUNT];
    vkao_images slots;
    vkao_effect *effect; /* the fixture's */
    vkao_frame *frame;
};

/* Default parameters, no slots. */
void picture_init(struct picture *p, uint32_t width, uint32_t height, vkao_stage_flags stages);
/* What vkao_preset decides. */
void picture_preset(struct picture *p, vkao_quality quality);
void picture_free(struct picture *p);
uint32_t picture_channels(enum picture_slot slot);
size_t picture_texels(const struct picture *p);
/* AO inside the part's rect is the whole's, bit for bit, and untouched outside. what: for the
 * message. */
void picture_check_part(const struct picture *part, const struct picture *whole, double untouched,
                        const char *what);
vkao_image *picture_slot_image(vkao_images *images, enum picture_slot slot);
/* Uses the slot, with these values rounded to the format, or with canaries if NULL. */
void picture_set(struct picture *p, enum picture_slot slot, VkFormat format, const double *values);
/* Every texel and channel of the slot. */
void picture_fill(struct picture *p, enum picture_slot slot, VkFormat format, double value);
/* Renders the scene into the depth slot (as view.depth_encoding) and, if a format is given, the
 * normals slot (as view.normal_encoding), and sets the projection. */
void picture_render_scene(struct picture *p, const struct scene *scene, const struct lens *lens,
                          VkFormat depth_format, VkFormat normals_format);

/* What lies behind the first layer, of a picture whose depth is view z: the slots of thickness, as
 * thickness_input says, and of the second layer. */
void picture_render_behind(struct picture *p, const struct scene *scene, const struct lens *lens);

/* 80x60, SSAO and whatever else is asked for, the scene from a right-handed perspective camera as
 * view z in R32F, given normals in RGBA32F, AO in R32F. */
void picture_make(struct picture *p, vkao_stage_flags stages, const struct scene *scene);

/* What the picture's frame is an effect of. */
vkao_effect_info picture_effect_info(const struct picture *p);
/* Compiled for the context, the caller's to destroy. */
vkao_effect *picture_effect(const struct picture *p, const vkao_context *context);
void picture_open(const struct picture *p, struct picture_gpu *g);
/* These stages alone. */
void picture_record_stages(const struct picture *p, const struct picture_gpu *g,
                           VkCommandBuffer cmd, vkao_stage_flags stages);
void picture_frame_info(const struct picture *p, const struct picture_gpu *g,
                        vkao_frame_info *info);
void picture_record(const struct picture *p, const struct picture_gpu *g, VkCommandBuffer cmd);
/* Replaces the values of the slots that the stages write. */
void picture_download(struct picture *p, struct picture_gpu *g);
void picture_close(struct picture_gpu *g);
/* The four above around one submit. */
void picture_run(struct picture *p);
/* The scene that the references work on; ref_scene_free frees. */
void picture_reference_scene(const struct picture *p, struct ref_scene *scene);

struct difference {
    double max, mean, p99;
};
struct difference difference_of(const double *a, const double *b, size_t count);
/* Prints the three figures and fails if one exceeds its limit; NaN is never equal to anything. */
void check_close(const char *what, const double *a, const double *b, size_t count, double mean,
                 double p99, double max);
/* Bit for bit, NaN never. */
void check_equal(const char *what, const double *a, const double *b, size_t count);
double mean_of(const double *v, size_t count);

#endif
