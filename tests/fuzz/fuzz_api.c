/* SPDX-License-Identifier: MIT
 *
 * Every public function of the library, in any order, with structs that are right, nearly right or
 * anything, over a driver that computes nothing, counts what is made, and fails when told. */
#include "fake_vulkan.h"
#include "fuzz.h"
#include "vkao.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CALLS = 24, MOST_CONTEXTS = 3, MOST_CLAIM = 4096, SLOTS = 10, MOST_OWNED = 64 };

struct world {
    struct fuzz_input in;
    struct fake_vulkan *fake;
    vkao_context *context;
    vkao_effect *effect;
    vkao_frame *frame;
    vkao_stage_flags stages; /* of the effect */
    VkBool32 orthographic;
    VkExtent2D extent;
    unsigned contexts;
    bool logs; /* the context has a log that hears errors */
    void *owned[MOST_OWNED];
    size_t owned_count;
    /* Host memory, counted. */
    VkAllocationCallbacks callbacks;
    size_t host_live;
    unsigned host_calls, host_fail_at;
    bool host_failed;
    /* During one call. */
    unsigned errors;
    char last_error[512];
};

/* --- Host --- */

static VKAPI_ATTR void *VKAPI_CALL host_allocate(void *user_data, size_t size, size_t alignment,
                                                 VkSystemAllocationScope scope)
{
    struct world *w = user_data;
    (void)scope;
    FUZZ_CHECK(size && alignment && !(alignment & (alignment - 1)), "%zu bytes aligned to %zu",
               size, alignment);
    if (++w->host_calls == w->host_fail_at) {
        w->host_failed = true;
        return NULL;
    }
    void *memory = aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (!memory)
        abort();
    w->host_live++;
    return memset(memory, 0xa5, size);
}

static VKAPI_ATTR void *VKAPI_CALL host_reallocate(void *user_data, void *memory, size_t size,
                                                   size_t alignment, VkSystemAllocationScope scope)
{
    (void)user_data, (void)memory, (void)size, (void)alignment, (void)scope;
    abort(); /* nothing of the library grows */
}

static VKAPI_ATTR void VKAPI_CALL host_free(void *user_data, void *memory)
{
    struct world *w = user_data;
    w->host_live -= memory != NULL;
    free(memory);
}

static void keep_log(void *user_data, vkao_log_level level, const char *message)
{
    struct world *w = user_data;
    FUZZ_CHECK(level >= VKAO_LOG_ERROR && level <= VKAO_LOG_INFO, "level %d", (int)level);
    FUZZ_CHECK(message[0] && !strchr(message, '\n'), "'%s'", message);
    if (level == VKAO_LOG_ERROR) {
        w->errors++;
        snprintf(w->last_error, sizeof w->last_error, "%s", message);
    }
}

/* Backwards: nothing may depend on the order. */
static void run_backwards(void *user_data, uint32_t count, void (*job)(void *data, uint32_t i),
                          void *data)
{
    (void)user_data;
    while (count--)
        job(data, count);
}

/* --- Structs --- */

static void *own(struct world *w, size_t size)
{
    if (w->owned_count == MOST_OWNED)
        abort();
    void *memory = calloc(1, size);
    if (!memory)
        abort();
    return w->owned[w->owned_count++] = memory;
}

static uint32_t any_word(struct fuzz_input *in)
{
    static const float floats[] = {0.0f,   -0.0f, 1.0f,    -1.0f, 0.5f,     2.0f,      1e-45f,
                                   1e-30f, 1e30f, 3.4e38f, NAN,   INFINITY, -INFINITY, 1.5f};
    const uint32_t kind = fuzz_u8(in);
    uint32_t bits;
    if (kind < 16)
        return kind;
    if (kind < 32)
        return UINT32_MAX << (kind - 16);
    if (kind < 64)
        return UINT32_C(1) << (kind - 32);
    if (kind < 200) {
        const float value = floats[kind % (sizeof floats / sizeof *floats)];
        memcpy(&bits, &value, sizeof bits);
        return bits;
    }
    return fuzz_u32(in);
}

/* Members that only the harness may change: pointers and handles. */
struct kept {
    size_t offset, size;
};
#define KEPT(type, member)                                                                         \
    {                                                                                              \
        offsetof(type, member), sizeof((type *)0)->member                                          \
    }
#define KEPT_TO(type, first, last)                                                                 \
    {                                                                                              \
        offsetof(type, first),                                                                     \
            offsetof(type, last) + sizeof((type *)0)->last - offsetof(type, first)                 \
    }

/* Changes a few words of a struct. */
static void scramble(struct fuzz_input *in, void *object, size_t size, const struct kept *kept,
                     size_t kept_count)
{
    for (uint32_t changes = fuzz_u8(in) % 16; changes > 11; changes--) {
        const size_t offset = fuzz_u8(in) % (size / 4) * 4;
        const uint32_t word = any_word(in);
        bool may = true;
        for (size_t i = 0; i < kept_count; i++)
            may &= offset + 4 <= kept[i].offset || offset >= kept[i].offset + kept[i].size;
        if (may)
            memcpy((char *)object + offset, &word, sizeof word);
    }
}

/* The struct as the library gets it: memory of exactly the size that it claims to have, so that a
 * byte read beyond it is seen; of a mad claim, as much as it takes to refuse it. */
static const void *pass(struct world *w, void *object, size_t size)
{
    static const uint32_t sizes[] = {0, 1, 3, 4, 8, 100, MOST_CLAIM, UINT32_MAX, INT32_MAX};
    const uint32_t kind = fuzz_u8(&w->in);
    uint32_t claim;
    if (kind == 255)
        return NULL;
    if (kind > 248)
        memcpy(object, &sizes[kind % (sizeof sizes / sizeof *sizes)], 4);
    else if (kind > 240)
        memcpy(object, &(uint32_t){(uint32_t)size + kind % 40 - 20}, 4);
    memcpy(&claim, object, sizeof claim);
    /* A size that was not set is that of a struct that is there. */
    const size_t room = claim == 0 ? size : claim < 4 ? 4 : claim > MOST_CLAIM ? MOST_CLAIM : claim;
    unsigned char *copy = own(w, room);
    memcpy(copy, object, size < room ? size : room);
    /* Whoever believes more has to stop here. */
    if (claim > room)
        copy[size] = 1;
    else if (room > size && fuzz_flag(&w->in))
        copy[size + fuzz_u32(&w->in) % (room - size)] = 1;
    return copy;
}

static void default_view(struct world *w, vkao_view *view)
{
    struct fuzz_input *in = &w->in;
    *view = vkao_view_default();
    view->projection[0] = 1.0f;
    view->projection[5] = -1.5f;
    if ((fuzz_u8(in) > 250) == w->orthographic) {
        view->projection[10] = -1.01f;
        view->projection[11] = -1.0f;
        view->projection[14] = -0.101f;
    } else {
        view->projection[10] = -0.01f;
        view->projection[15] = 1.0f;
        view->axis = VKAO_VIEW_AXIS_NEGATIVE_Z;
    }
    if (fuzz_flag(in)) {
        const uint32_t x = fuzz_below(in, w->extent.width), y = fuzz_below(in, w->extent.height);
        view->valid.offset = (VkOffset2D){(int32_t)x, (int32_t)y};
        view->valid.extent = (VkExtent2D){w->extent.width - x, w->extent.height - y};
    }
    if (fuzz_flag(in))
        view->rect = view->valid;
}

static const void *any_view(struct world *w)
{
    vkao_view view;
    default_view(w, &view);
    scramble(&w->in, &view, sizeof view, NULL, 0);
    return pass(w, &view, sizeof view);
}

static const void *any_params(struct world *w)
{
    vkao_params p = vkao_params_default();
    scramble(&w->in, &p, sizeof p, NULL, 0);
    return pass(w, &p, sizeof p);
}

static const void *any_effect(struct world *w)
{
    static const struct kept kept[] = {
        KEPT_TO(vkao_effect_info, pipeline_cache, parallel_user_data)};
    static const VkFormat formats[] = {VK_FORMAT_UNDEFINED, VK_FORMAT_R8_UNORM,
                                       VK_FORMAT_R16_SFLOAT, VK_FORMAT_R32_SFLOAT};
    struct fuzz_input *in = &w->in;
    vkao_effect_info e = vkao_effect_info_default();
    e.stages = 1 + fuzz_below(in, 7);
    e.half_resolution = fuzz_below(in, 4) == 3;
    e.depth_encoding = (vkao_depth_encoding)fuzz_below(in, 4);
    if (fuzz_flag(in))
        e.normal_encoding = (vkao_normal_encoding)fuzz_below(in, 5);
    e.projection = (vkao_projection)fuzz_below(in, 2);
    e.ao_format = formats[fuzz_below(in, 4)];
    e.bent_normals = fuzz_below(in, 4) == 3;
    e.noisy_ao = fuzz_below(in, 8) == 7;
    e.method = (vkao_ssao_method)fuzz_below(in, 6);
    e.slice_count = fuzz_below(in, 5);
    e.blur_radius = fuzz_below(in, 17);
    e.composite_mode = (vkao_composite_mode)fuzz_below(in, 7);
    e.specular = (vkao_specular)fuzz_below(in, 3);
    e.multi_bounce = fuzz_flag(in);
    e.parallel = fuzz_flag(in) ? run_backwards : NULL;
    scramble(in, &e, sizeof e, kept, 1);
    w->stages = e.stages;
    w->orthographic = e.projection == VKAO_PROJECTION_ORTHOGRAPHIC;
    return pass(w, &e, sizeof e);
}

static vkao_image *slot(vkao_images *images, size_t i)
{
    vkao_image *const slots[SLOTS] = {
        &images->depth,  &images->normals,  &images->ao_noisy, &images->ao,
        &images->color,  &images->direct,   &images->output,   &images->bent_normals,
        &images->albedo, &images->specular,
    };
    return slots[i];
}

static void fill_images(struct world *w, vkao_images *images)
{
    static const VkFormat formats[SLOTS][3] = {
        {VK_FORMAT_R32_SFLOAT, VK_FORMAT_D32_SFLOAT, VK_FORMAT_D16_UNORM},
        {VK_FORMAT_R16G16B16A16_SNORM, VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R16G16_SFLOAT},
        {VK_FORMAT_R8_UNORM, VK_FORMAT_R16_UNORM, VK_FORMAT_R32_SFLOAT},
        {VK_FORMAT_R8_UNORM, VK_FORMAT_R16_SFLOAT, VK_FORMAT_R32_SFLOAT},
        {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM},
        {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM},
        {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT},
        {VK_FORMAT_R16G16B16A16_SNORM, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM},
        {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM},
        {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM},
    };
    *images = vkao_images_default();
    /* Mostly what the stages need: depth, AO; colour and output. */
    const uint32_t lit = w->stages & VKAO_STAGE_COMPOSITE ? 1u << 4 | 1u << 6 : 0;
    const uint32_t more = fuzz_u32(&w->in);
    const uint32_t used = 1u | 1u << 3 | lit | (more & 0xffff & more >> 16);
    const uint32_t left_out = fuzz_u8(&w->in);
    for (size_t i = 0; i < SLOTS; i++) {
        if (!(used >> i & 1) || left_out == i)
            continue;
        const uint32_t kind = fuzz_u8(&w->in);
        *slot(images, i) = (vkao_image){fake_caller_view(w->fake), VK_IMAGE_LAYOUT_GENERAL,
                                        formats[i][kind % 3], VK_NULL_HANDLE};
        if (kind > 245)
            slot(images, i)->layout = (VkImageLayout)fuzz_below(&w->in, 9);
        if (kind > 240 && kind < 246)
            slot(images, i)->format = (VkFormat)fuzz_below(&w->in, 190);
        if (kind == 240)
            slot(images, i)->view = VK_NULL_HANDLE;
    }
    if (used >> 15 && images->ao.format) {
        images->ao.image = fake_caller_image(
            w->fake, &(VkImageCreateInfo){.format = images->ao.format,
                                          .extent = {w->extent.width, w->extent.height, 1},
                                          .mipLevels = 1,
                                          .arrayLayers = 1});
    }
}

static const void *any_images(struct world *w)
{
    static const struct kept kept[] = {KEPT_TO(vkao_images, depth, specular)};
    vkao_images images;
    fill_images(w, &images);
    scramble(&w->in, &images, sizeof images, kept, 1);
    return pass(w, &images, sizeof images);
}

static const void *any_frame_info(struct world *w)
{
    static const struct kept kept[] = {KEPT_TO(vkao_frame_info, images, scratch_memory),
                                       KEPT(vkao_frame_info, extent)};
    static const uint32_t sizes[] = {100,  1,   2,  3,  7,   16, 63,   64,        1000,
                                     4096, 128, 33, 17, 512, 0,  4097, UINT32_MAX};
    vkao_frame_info info = vkao_frame_info_default();
    w->extent.width = sizes[fuzz_u8(&w->in) % (sizeof sizes / sizeof *sizes)];
    w->extent.height = sizes[fuzz_u8(&w->in) % (sizeof sizes / sizeof *sizes)];
    info.extent = w->extent;
    info.images = any_images(w);
    if (fuzz_below(&w->in, 8) == 7) {
        info.scratch_memory = fake_caller_memory(w->fake);
        info.scratch_offset = fuzz_flag(&w->in) ? 0 : fuzz_u32(&w->in);
    }
    scramble(&w->in, &info, sizeof info, kept, 2);
    return pass(w, &info, sizeof info);
}

/* --- Promises --- */

struct before {
    size_t live;
    unsigned result_calls;
};

static struct before begin(struct world *w)
{
    const struct before before = {fake_live(w->fake), w->fake->result_calls};
    static const VkResult failures[] = {VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_DEVICE_MEMORY,
                                        VK_ERROR_DEVICE_LOST, VK_ERROR_UNKNOWN};
    fake_forget_calls(w->fake);
    w->errors = 0;
    w->host_failed = false;
    w->host_fail_at = 0;
    w->fake->fail_at = 0;
    w->fake->failed = NULL;
    w->fake->fail_from = false;
    const uint32_t kind = fuzz_u8(&w->in);
    if (kind > 200) {
        w->fake->fail_at = w->fake->result_calls + 1 + fuzz_u8(&w->in) % 200;
        w->fake->fail_from = kind & 1;
        w->fake->fail_result = failures[kind / 2 % 4];
    } else if (kind > 180) {
        w->host_fail_at = w->host_calls + 1 + fuzz_u8(&w->in) % 100;
    }
    return before;
}

static void check_code(const struct world *w, const char *call, vkao_result result)
{
    FUZZ_CHECK(result <= VKAO_SUCCESS, "%s returned %d", call, (int)result);
    const char *failed = w->fake->failed;
    /* A name is a debugging aid: that it could not be set is no error. */
    const bool matters = failed && strcmp(failed, "vkSetDebugUtilsObjectNameEXT") != 0;
    if (matters || w->host_failed)
        FUZZ_CHECK(result < 0 && result != VKAO_ERROR_INVALID_ARGUMENT,
                   "%s returned %d, though %s failed", call, (int)result,
                   failed ? failed : "host memory");
    else
        FUZZ_CHECK(result == VKAO_SUCCESS || result == VKAO_ERROR_INVALID_ARGUMENT ||
                       result == VKAO_ERROR_UNSUPPORTED,
                   "%s returned %d, and nothing failed: %s", call, (int)result, w->last_error);
}

static void check_commands(const struct world *w)
{
    for (size_t i = 0; i < w->fake->call_count; i++) {
        const struct fake_call *call = &w->fake->calls[i];
        if (strcmp(call->name, "vkCmdDispatch") != 0)
            continue;
        for (int k = 0; k < 3; k++)
            FUZZ_CHECK(call->groups[k] >= 1 && call->groups[k] <= 65535, "%u groups",
                       call->groups[k]);
    }
}

/* On an error nothing was created or recorded, and the log says why. */
static void end(struct world *w, const char *call, const struct before *before, vkao_result result,
                const void *out)
{
    check_code(w, call, result);
    FUZZ_CHECK(!w->fake->error[0], "%s: %s", call, w->fake->error);
    if (result == VKAO_SUCCESS) {
        check_commands(w);
        return;
    }
    FUZZ_CHECK(!out, "%s failed and left something in out", call);
    FUZZ_CHECK(fake_count(w->fake, "vkCmd") == 0, "%s failed and recorded %zu commands", call,
               fake_count(w->fake, "vkCmd"));
    FUZZ_CHECK(fake_live(w->fake) == before->live, "%s failed and left %zu objects, not %zu", call,
               fake_live(w->fake), before->live);
    FUZZ_CHECK(!w->logs || w->errors >= 1, "%s returned %d and logged nothing", call, (int)result);
}

/* --- Calls --- */

static void drop_frame(struct world *w)
{
    vkao_frame_destroy(w->frame);
    w->frame = NULL;
}

static void drop_effect(struct world *w)
{
    drop_frame(w);
    vkao_effect_destroy(w->effect);
    w->effect = NULL;
}

static void drop_context(struct world *w)
{
    drop_effect(w);
    vkao_context_destroy(w->context);
    w->context = NULL;
    FUZZ_CHECK(fake_live(w->fake) == 0, "%zu objects leak", fake_live(w->fake));
    FUZZ_CHECK(w->host_live == 0, "%zu blocks of host memory leak", w->host_live);
    FUZZ_CHECK(!w->fake->error[0], "%s", w->fake->error);
}

/* What a device is able to do, and what it lacks. */
static void choose_device(struct world *w)
{
    static const char *const missing[] = {
        "vkCreateBufferView",    "vkCmdDispatchIndirect",  "vkGetPhysicalDeviceProperties",
        "vkDestroyShaderModule", "vkCmdCopyBufferToImage", "vkAllocateMemory"};
    struct fuzz_input *in = &w->in;
    struct fake_vulkan *fake = w->fake;
    const uint32_t kind = fuzz_u8(in);
    fake->device_type =
        fuzz_flag(in) ? VK_PHYSICAL_DEVICE_TYPE_CPU : VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
    fake->debug_utils = fuzz_flag(in);
    fake->missing = kind < 6 ? missing[kind] : NULL;
    fake->api_version = kind == 6 ? VK_API_VERSION_1_0 : VK_API_VERSION_1_1;
    fake->max_dimension = kind == 7 ? UINT32_MAX : kind == 8 ? 128 : 4096;
    fake->max_texels = kind == 9 ? 65536 : UINT32_C(1) << 27;
    fake->max_buffer = kind == 10 ? 1 << 20 : UINT32_C(1) << 27;
    fake->buffer_features = kind == 11 ? 0 : VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT;
    fake->image_alignment = UINT64_C(1) << fuzz_u8(in) % 17;
    fake->image_type_bits = kind == 12 ? 1 : 7;
    fake->format_count = 0;
    if (kind == 13)
        fake_limit_format(fake, VK_FORMAT_R8_UNORM, 0, VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT);
}

static void create_context(struct world *w)
{
    static const struct kept kept[] = {
        KEPT_TO(vkao_context_info, instance, mark_user_data),
        KEPT(vkao_context_info, log_level),
    };
    VkPhysicalDevice16BitStorageFeatures storage = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES};
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    struct fuzz_input *in = &w->in;
    drop_context(w);
    if (w->contexts++ == MOST_CONTEXTS)
        return;
    choose_device(w);
    vkao_add_required_features(&features.features);
    if (fuzz_below(in, 16) == 15)
        features.features = (VkPhysicalDeviceFeatures){0};
    storage.storageBuffer16BitAccess = fuzz_flag(in);
    features.pNext = fuzz_flag(in) ? &storage : NULL;
    vkao_context_info info = {
        .struct_size = sizeof info,
        .instance = fake_instance(w->fake),
        .physical_device = fake_physical_device(w->fake),
        .device = fake_device(w->fake),
        .get_instance_proc_addr = fake_get_instance_proc_addr,
        .get_device_proc_addr = fake_get_device_proc_addr,
        .enabled_features = &features,
        .allocator = fuzz_flag(in) ? &w->callbacks : NULL,
        .log = fuzz_below(in, 8) == 7 ? NULL : keep_log,
        .log_user_data = w,
        .log_level = (vkao_log_level)fuzz_below(in, 4),
        .debug_labels = fuzz_flag(in),
    };
    const uint32_t broken = fuzz_u8(in);
    if (broken == 1)
        info.get_device_proc_addr = NULL;
    if (broken == 2)
        info.enabled_features = NULL;
    if (broken == 3)
        info.device = NULL;
    scramble(in, &info, sizeof info, kept, 2);
    const vkao_context_info *passed = pass(w, &info, sizeof info);
    w->fake->expected_allocator = info.allocator;
    /* Whether one was given is known only from a struct that is large enough to be read. */
    w->logs = passed && (!passed->struct_size || passed->struct_size >= sizeof info) && info.log;
    const struct before before = begin(w);
    const vkao_result result = vkao_context_create(passed, &w->context);
    end(w, "vkao_context_create", &before, result, w->context);
    FUZZ_CHECK(result != VKAO_SUCCESS || w->context, "no context");
    w->logs = w->logs && w->context;
}

static void create_effect(struct world *w)
{
    const vkao_context *context = fuzz_u8(&w->in) == 255 ? NULL : w->context;
    drop_effect(w);
    const void *info = any_effect(w);
    const bool logs = w->logs;
    const struct before before = begin(w);
    w->logs = logs && context;
    const vkao_result result = vkao_effect_create(context, info, &w->effect);
    end(w, "vkao_effect_create", &before, result, w->effect);
    FUZZ_CHECK(result != VKAO_SUCCESS || w->effect, "no effect");
    if (w->effect) {
        vkao_effect_info settings;
        vkao_effect_settings(w->effect, &settings, sizeof settings);
        w->stages = settings.stages;
        w->orthographic = settings.projection == VKAO_PROJECTION_ORTHOGRAPHIC;
    }
    w->logs = logs;
}

static void create_frame(struct world *w)
{
    drop_frame(w);
    if (!w->effect)
        create_effect(w);
    const vkao_effect *effect = fuzz_u8(&w->in) == 255 ? NULL : w->effect;
    const void *info = any_frame_info(w);
    const bool logs = w->logs;
    const struct before before = begin(w);
    w->logs = logs && effect;
    w->frame = NULL;
    const vkao_result result = vkao_frame_create(effect, info, &w->frame);
    end(w, "vkao_frame_create", &before, result, w->frame);
    FUZZ_CHECK(result != VKAO_SUCCESS || w->frame, "no frame");
    w->logs = logs;
}

/* The query is the allocation: it says the same, and leaves nothing. */
static void query_scratch(struct world *w)
{
    VkMemoryRequirements requirements;
    const void *info = any_frame_info(w);
    const bool logs = w->logs;
    const struct before before = begin(w);
    w->logs = logs && w->effect;
    const vkao_result result = vkao_frame_scratch(w->effect, info, &requirements);
    end(w, "vkao_frame_scratch", &before, result, NULL);
    FUZZ_CHECK(fake_live(w->fake) == before.live, "the query left objects behind");
    if (result == VKAO_SUCCESS && requirements.size)
        FUZZ_CHECK(requirements.alignment && requirements.memoryTypeBits,
                   "alignment %llu, types 0x%x", (unsigned long long)requirements.alignment,
                   requirements.memoryTypeBits);
    w->logs = logs;
}

static void update_frame(struct world *w)
{
    const void *images = any_images(w);
    const bool logs = w->logs;
    const struct before before = begin(w);
    w->logs = logs && w->frame;
    end(w, "vkao_frame_update", &before, vkao_frame_update(w->frame, images), NULL);
    w->logs = logs;
}

static void record(struct world *w, uint32_t which)
{
    const VkCommandBuffer cmd = fuzz_u8(&w->in) == 255 ? NULL : fake_command_buffer(w->fake);
    const vkao_frame *frame = fuzz_u8(&w->in) == 255 ? NULL : w->frame;
    const vkao_stage_flags stages = which == 4 ? fuzz_u8(&w->in) : 1u << which;
    const void *view = any_view(w);
    const void *params = any_params(w);
    const bool logs = w->logs;
    const struct before before = begin(w);
    w->logs = logs && frame;
    const bool all = fuzz_flag(&w->in);
    const char *name = all ? "vkao_cmd_record" : "vkao_cmd_stage";
    vkao_result result = all ? vkao_cmd_record(frame, cmd, view, params)
                             : vkao_cmd_stage(frame, cmd, stages, view, params);
    end(w, name, &before, result, NULL);
    FUZZ_CHECK(fake_live(w->fake) == before.live, "%s created or destroyed", name);
    w->logs = logs;
}

static void ask_preset(struct world *w)
{
    vkao_effect_info effect = vkao_effect_info_default();
    vkao_params params = vkao_params_default();
    const uint32_t given = fuzz_u8(&w->in);
    const vkao_quality quality = (vkao_quality)any_word(&w->in);
    const vkao_result result =
        vkao_preset(quality, given & 1 ? &effect : NULL, given & 2 ? &params : NULL);
    FUZZ_CHECK((result == VKAO_SUCCESS) == ((uint32_t)quality <= VKAO_QUALITY_BEST),
               "quality %d gives %d", (int)quality, (int)result);
    FUZZ_CHECK(vkao_result_string((vkao_result) - (int)fuzz_below(&w->in, 8)), "no text");
    FUZZ_CHECK(vkao_version() > 0, "no version");
}

static void one_call(struct world *w)
{
    const uint32_t kind = fuzz_below(&w->in, 20);
    switch (kind) {
    case 0:
        create_context(w);
        break;
    case 1:
    case 2:
    case 3:
        create_frame(w);
        break;
    case 4:
        query_scratch(w);
        break;
    case 5:
        update_frame(w);
        break;
    case 6:
        create_effect(w);
        break;
    case 7:
        ask_preset(w);
        break;
    case 8:
        drop_frame(w);
        break;
    default:
        record(w, kind % 5);
        break;
    }
    while (w->owned_count)
        free(w->owned[--w->owned_count]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    /* What the fake keeps of calls is megabytes: made once. */
    static struct fake_vulkan fake, fresh;
    if (!fresh.calls) {
        fake_init(&fake);
        fresh = fake;
    }
    fake = fresh;
    struct world w = {.in = {data, size}, .fake = &fake};
    w.callbacks = (VkAllocationCallbacks){.pUserData = &w,
                                          .pfnAllocation = host_allocate,
                                          .pfnReallocation = host_reallocate,
                                          .pfnFree = host_free};
    create_context(&w);
    while (w.owned_count)
        free(w.owned[--w.owned_count]);
    for (int i = 0; i < MOST_CALLS && w.in.size; i++)
        one_call(&w);
    begin(&w); /* whatever fails, destroying does not */
    drop_context(&w);
    return 0;
}
