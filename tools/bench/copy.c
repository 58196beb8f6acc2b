/* SPDX-License-Identifier: MIT
 *
 * vkao-bench copy: how fast the device moves bytes. No stage that reads and writes as many can be
 * faster. */
#include "commands.h"

#include "arguments.h"
#include "clock.h"
#include "driver.h"
#include "gpu.h"
#include "json.h"
#include "report.h"
#include "runs.h"
#include "sizes.h"
#include "stage_clock.h"
#include "text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <vulkan/vulkan.h>

struct copy_options {
    const char *size, *json, *device;
    unsigned runs;
    bool text;
};

#define AT(member) offsetof(struct copy_options, member)

static const struct argument rows[] = {
    {"size", "LIST", "comma-separated: WxH, 720p, 1080p, 2160p or 8k (1080p,2160p,8k)",
     ARGUMENT_TEXT, AT(size), 0, 0, NULL},
    {"runs", "N", "of each size, after one that does not count (99)", ARGUMENT_COUNT, AT(runs), 1,
     MAX_RUNS, NULL},
    {"text", NULL, "print a table (default, unless JSON goes there)", ARGUMENT_FLAG, AT(text), 0, 0,
     NULL},
    {"json", "FILE", "write the device, its driver and the times; - = standard output",
     ARGUMENT_TEXT, AT(json), 0, 0, NULL},
    {"device", "NAME", "auto, cpu, a number from 'vkao devices' or part of a name", ARGUMENT_TEXT,
     AT(device), 0, 0, NULL},
};

static const char usage[] =
    "Usage: vkao-bench copy [OPTION]...\n\n"
    "Device time of copying a buffer, 4 bytes a texel, as 'speed' measures a stage.\n\n";

static const struct argument_list arguments = {"copy", usage, rows, sizeof rows / sizeof rows[0]};

static const struct copy_options default_options = {
    .size = "1080p,2160p,8k", .runs = 99, .device = "auto"};

enum { BYTES_PER_TEXEL = 8 }; /* of R32_SFLOAT, read and written */

struct copy_bench {
    const struct copy_options *options;
    struct size_list sizes;
    double median_ms[MAX_SIZES], least_ms[MAX_SIZES]; /* NAN = does not fit the device */
    struct gpu gpu;
    struct stage_clock clock;
    struct driver_name driver;
};

/* --- Measuring --- */

/* Device memory of an R32_SFLOAT image's bytes. Copies of images are no yardstick: on an H100 they
 * go at a twentieth of what its memory does. */
struct block {
    VkBuffer buffer;
    VkDeviceMemory memory;
    VkDeviceSize bytes;
};

static bool block_create(struct gpu *gpu, VkExtent2D size, struct block *block,
                         struct tool_error *err)
{
    block->bytes = BYTES_PER_TEXEL / 2 * (VkDeviceSize)size.width * size.height;
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = block->bytes,
        .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
    };
    if (!gpu_ok(err, "vkCreateBuffer", vkCreateBuffer(gpu->device, &info, NULL, &block->buffer))) {
        block->buffer = VK_NULL_HANDLE;
        return false;
    }
    VkMemoryRequirements need;
    vkGetBufferMemoryRequirements(gpu->device, block->buffer, &need);
    return gpu_allocate(gpu, &need, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &block->memory, err) &&
           gpu_ok(err, "vkBindBufferMemory",
                  vkBindBufferMemory(gpu->device, block->buffer, block->memory, 0));
}

static void block_destroy(struct gpu *gpu, struct block *block)
{
    if (block->buffer)
        vkDestroyBuffer(gpu->device, block->buffer, NULL);
    if (block->memory)
        vkFreeMemory(gpu->device, block->memory, NULL);
}

/* Timed as vkao-bench speed times a stage: one command between two timestamps, and a wait. */
static bool copy_once(struct copy_bench *b, const struct block *from, const struct block *to,
                      double *ms, struct tool_error *err)
{
    double stages[STAGES];
    VkCommandBuffer cmd = gpu_begin(&b->gpu, err);
    if (!cmd)
        return false;
    stage_clock_start(&b->clock, cmd);
    vkCmdCopyBuffer(cmd, from->buffer, to->buffer, 1, &(VkBufferCopy){.size = from->bytes});
    stage_clock_stop(&b->clock);
    const double start = now_ms();
    const bool submitted = gpu_submit(&b->gpu, cmd, err);
    const double wall = now_ms() - start;
    if (!submitted || !stage_clock_read(&b->clock, wall, stages, err))
        return false;
    *ms = stages[STAGE_TOTAL];
    return true;
}

static bool copy_runs(struct copy_bench *b, size_t i, const struct block *from,
                      const struct block *to, struct tool_error *err)
{
    float values[MAX_RUNS];
    const unsigned runs = b->options->runs;
    b->least_ms[i] = INFINITY;
    for (int run = -1; run < (int)runs; run++) {
        double ms;
        if (!copy_once(b, from, to, &ms, err))
            return false;
        if (run < 0)
            continue;
        values[run] = (float)ms;
        b->least_ms[i] = fmin(b->least_ms[i], ms);
    }
    b->median_ms[i] = runs_median(values, runs);
    return true;
}

static bool copy_size(struct copy_bench *b, size_t i, struct tool_error *err)
{
    struct block from = {0}, to = {0};
    const VkExtent2D size = b->sizes.sizes[i];
    const bool ok = block_create(&b->gpu, size, &from, err) &&
                    block_create(&b->gpu, size, &to, err) && copy_runs(b, i, &from, &to, err);
    block_destroy(&b->gpu, &from);
    block_destroy(&b->gpu, &to);
    return ok;
}

/* A size that the device cannot hold is left out, if there are others. */
static bool copy_sizes(struct copy_bench *b, struct tool_error *err)
{
    struct tool_error last = {0};
    size_t done = 0;
    for (size_t i = 0; i < b->sizes.count && !last.ends_run; i++) {
        struct tool_error once = {0};
        b->median_ms[i] = b->least_ms[i] = NAN;
        if (copy_size(b, i, &once))
            done++;
        else
            last = once;
    }
    if (done > 0 && !last.ends_run)
        return true;
    *err = last;
    return false;
}

static bool measure(struct copy_bench *b, struct tool_error *err)
{
    const struct gpu_options options = {.device = b->options->device};
    if (!sizes_choose(b->options->size, &b->sizes, err) || !gpu_create(&options, &b->gpu, err))
        return false;
    b->driver = driver_name(&b->gpu);
    return stage_clock_create(&b->gpu, &b->clock, err) && copy_sizes(b, err);
}

/* --- Results --- */

static double gb_per_s(const struct copy_bench *b, size_t i)
{
    const VkExtent2D size = b->sizes.sizes[i];
    return BYTES_PER_TEXEL * (double)size.width * size.height / (b->median_ms[i] * 1e6);
}

static bool print_table(const struct copy_bench *b, struct tool_error *err)
{
    struct text text = {0};
    text_add(
        &text,
        "%s, %s: a buffer to another, 4 bytes a texel, medians of %u runs; GB are 10^9 bytes, read "
        "and written\n",
        b->gpu.properties.deviceName, b->driver.text, b->options->runs);
    for (size_t i = 0; i < b->sizes.count; i++) {
        const VkExtent2D size = b->sizes.sizes[i];
        char ms[32];
        runs_format_ms(b->median_ms[i], ms, sizeof ms);
        text_add(&text, "%5u x %-5u %10s ms", size.width, size.height, ms);
        if (isnan(b->median_ms[i]))
            text_add(&text, ": does not fit the device\n");
        else
            text_add(&text, " %8.1f GB/s\n", gb_per_s(b, i));
    }
    const bool ok =
        text.out_of_memory ? fail(err, EXIT_MEMORY, "out of memory") : report_text(text.data, err);
    text_free(&text);
    return ok;
}

static cJSON *to_json(const struct copy_bench *b)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "device", b->gpu.properties.deviceName);
    cJSON_AddStringToObject(root, "device_type",
                            gpu_device_type_name(b->gpu.properties.deviceType));
    cJSON_AddStringToObject(root, "driver", b->driver.text);
    cJSON_AddNumberToObject(root, "runs", b->options->runs);
    cJSON *list = cJSON_AddArrayToObject(root, "copies");
    for (size_t i = 0; i < b->sizes.count; i++) {
        cJSON *object = cJSON_CreateObject();
        cJSON_AddItemToArray(list, object);
        cJSON_AddNumberToObject(object, "width", b->sizes.sizes[i].width);
        cJSON_AddNumberToObject(object, "height", b->sizes.sizes[i].height);
        json_add_number(object, "median_ms", b->median_ms[i]);
        json_add_number(object, "least_ms", b->least_ms[i]);
        json_add_number(object, "gb_per_s", gb_per_s(b, i));
    }
    return root;
}

static bool put_out(const struct copy_bench *b, struct tool_error *err)
{
    const struct copy_options *o = b->options;
    const bool json_on_stdout = o->json && strcmp(o->json, "-") == 0;
    if ((o->text || !json_on_stdout) && !print_table(b, err))
        return false;
    const unsigned begun = json_begin();
    return !o->json || json_write(o->json, to_json(b), begun, err);
}

int command_copy(int argc, char **argv)
{
    struct copy_options options = default_options;
    struct copy_bench b = {.options = &options};
    struct tool_error err = {0};
    const bool ok = arguments_take(&arguments, argc, argv, &options, NULL, &err) &&
                    measure(&b, &err) && put_out(&b, &err);
    if (b.gpu.device)
        stage_clock_destroy(&b.clock);
    gpu_destroy(&b.gpu);
    return arguments_end(&arguments, ok, &err);
}
