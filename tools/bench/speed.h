/* SPDX-License-Identifier: MIT
 *
 * What `vkao-bench speed` measures, how, and the forms in which it is put out. */
#ifndef VKAO_BENCH_SPEED_H_
#define VKAO_BENCH_SPEED_H_

#include "configs.h"
#include "error.h"
#include "gpu.h"
#include "room.h"
#include "stage_clock.h"
#include "text.h"

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { MAX_SIZES = 16, SPEED_NAME = 48, MAX_RUNS = 1000 };

/* What the frames hold beside AO. */
struct speed_features {
    bool composite, bent_normals;
};

/* --- The device --- */

struct speed_device {
    struct gpu gpu;
    vkao_context *ctx;
    vkao_effect *effects[MAX_CONFIGS]; /* by the settings that they are compiled for */
    struct config configs[MAX_CONFIGS];
    size_t effect_count;
    double context_ms; /* that vkao_context_create and vkao_effect_create took */
    struct stage_clock clock;
    struct speed_features features;
};

/* device: as of --device. Errors: EXIT_DEVICE, EXIT_MEMORY. */
bool speed_device_create(const char *device, struct speed_features features,
                         struct speed_device *d, struct tool_error *err);
/* Effects for these settings, at most MAX_CONFIGS, and no others; those before are destroyed, no
 * images may be left of them. */
bool speed_device_compile(struct speed_device *d, const struct config *configs, size_t count,
                          struct tool_error *err);
void speed_device_destroy(struct speed_device *d);

/* The room of one size on the device, and frames for it that share their scratch memory. */
struct speed_images {
    VkExtent2D extent;
    struct gpu_image depth, normals, ao, bent, color, output;
    VkDeviceMemory scratch;
    vkao_frame *frames[MAX_CONFIGS]; /* by effect */
};

/* Whether its images can have that size, before anyone draws it. Errors: EXIT_DEVICE. */
bool speed_size_check(const struct speed_device *d, VkExtent2D size, struct tool_error *err);
bool speed_images_create(struct speed_device *d, const struct room *room,
                         struct speed_images *images, struct tool_error *err);
void speed_images_destroy(struct speed_device *d, struct speed_images *images);

/* What is compiled for a setting. */
vkao_effect_info speed_effect_info(struct speed_features features, const struct config *config);
/* A frame of this extent, as vkao_frame_create wants it. info->images is images. */
void speed_frame_info(struct speed_features features, VkExtent2D extent,
                      const struct speed_images *on_device, vkao_images *images,
                      vkao_frame_info *info);

/* Records, submits and waits once. */
bool speed_run_once(struct speed_device *d, const struct speed_images *images,
                    const struct config *config, float radius, double ms[STAGES],
                    struct tool_error *err);

/* --- Results --- */

/* What varies in --scaling. */
enum speed_series { SERIES_NONE, SERIES_PIXELS, SERIES_SAMPLES, SERIES_RADIUS };
const char *speed_series_name(enum speed_series series);

/* One setting at one size. */
struct speed_row {
    char name[SPEED_NAME];
    struct config config;
    VkExtent2D extent;
    float radius;
    enum speed_series series;
    double value;      /* of what varies */
    size_t image;      /* index of the speed_images that it runs on */
    unsigned runs;     /* of those asked for, how many are done */
    float *ms[STAGES]; /* by run; all 0 for stages that the setting lacks */
    double median[STAGES], least[STAGES];
};

struct speed {
    char device[256]; /* its name */
    char threads[48]; /* ", LP_NUM_THREADS 1" if that was chosen */
    unsigned runs;
    float radius;
    struct speed_row *rows;
    size_t count;
};

/* A row more; NULL if memory runs out. Pointers to earlier rows become invalid. */
struct speed_row *speed_add_row(struct speed *speed, const struct config *config, VkExtent2D extent,
                                float radius, struct tool_error *err);
/* Fills median and least. */
void speed_finish(struct speed *speed);
void speed_free(struct speed *speed);

double speed_now_ms(void);
/* Linear between ranks, of values that are not NAN; NAN if there is none. */
double speed_median(const float *values, size_t count);

/* --- Another program --- */

enum { MAX_RIVALS = 64 };

/* A figure that the program printed; the first is the time of the whole process. */
struct rival {
    char name[SPEED_NAME];
    float ms[MAX_RUNS]; /* by run; NAN where it was not printed */
    double median;
};

struct speed_vs {
    const char *command; /* for the shell; NULL = none */
    struct rival *rivals;
    size_t count;
};

/* Runs the command and takes what it prints: lines 'NAME med X ms', or the list that --json writes.
 * Errors: EXIT_INPUT, EXIT_MEMORY. */
bool speed_vs_run(struct speed_vs *vs, unsigned run, struct tool_error *err);
/* The median over the runs of ours / theirs. */
double speed_vs_ratio(const struct speed_row *row, enum stage stage, const struct rival *rival,
                      unsigned runs);
/* The rival of the same name, as another vkao-bench prints it; NULL if there is none. */
const struct rival *speed_vs_namesake(const struct speed_vs *vs, const struct speed_row *row,
                                      enum stage stage);
void speed_vs_free(struct speed_vs *vs);

/* --- Measuring --- */

/* Runs the rows from first on, in turns, after a round that does not count; and the other program,
 * if vs names one, after each round that does. images: one for each index that a row names. */
bool speed_measure(struct speed_device *d, struct speed *speed, size_t first,
                   const struct speed_images *images, struct speed_vs *vs, struct tool_error *err);

/* Fills speed with rows of how the cost of one setting grows with pixels, samples and radius. */
bool speed_scaling(struct speed_device *d, const struct config *config, VkExtent2D extent,
                   unsigned sky, struct speed *speed, struct tool_error *err);

/* The first frame of a process, with an empty and with a filled shader cache: see speed_start.c. */
struct speed_start {
    char name[SPEED_NAME];
    struct start_times {
        /* milliseconds: instance and device, context and effect, two frames */
        double device, context, first, second;
    } cold, warm;
};
/* device: as of --device. Nothing in this process may have used Vulkan before. */
bool speed_start_measure(const char *device, const struct config *config, VkExtent2D extent,
                         unsigned runs, char device_name[256], struct speed_start *start,
                         struct tool_error *err);

/* --- Reports --- */

void speed_text(const struct speed *speed, const struct speed_vs *vs, struct text *text);
void speed_markdown(const struct speed *speed, struct text *text);
/* For json_write, which deletes it. */
cJSON *speed_json(const struct speed *speed, const struct speed_vs *vs);

void speed_scaling_report(const struct speed *speed, bool markdown, struct text *text);
void speed_start_report(const struct speed_start *starts, size_t count, const struct speed *speed,
                        VkExtent2D extent, bool markdown, struct text *text);
cJSON *speed_start_json(const struct speed_start *starts, size_t count, unsigned runs);

/* Scratch memory as vkao_frame_scratch tells it. Errors: EXIT_DEVICE, EXIT_MEMORY. */
bool speed_memory(const char *device, const VkExtent2D *sizes, size_t count, bool markdown,
                  struct text *text, struct tool_error *err);

/* Stacked bars, a setting each. Errors: EXIT_OUTPUT, EXIT_MEMORY. */
bool speed_plot(const struct speed *speed, const char *path, struct tool_error *err);
/* Time over what varies, log-log, one panel per series of --scaling. */
bool speed_scaling_plot(const struct speed *speed, const char *path, struct tool_error *err);

/* Four digits, or "-" for what is not above 0. */
void speed_format_ms(double ms, char *text, size_t size);

#endif
