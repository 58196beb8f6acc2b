/* SPDX-License-Identifier: MIT */
#include "scene_internal.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

static const struct live_design *const designs[LIVE_KIND_COUNT] = {
    [LIVE_CUBES] = &live_cubes,
    [LIVE_ROOM] = &live_room,
};

const char *live_scene_name(enum live_kind kind)
{
    return designs[kind]->name;
}

struct orbit live_scene_camera(enum live_kind kind)
{
    return designs[kind]->camera;
}

float live_scene_radius(enum live_kind kind)
{
    return designs[kind]->radius;
}

/* What Vulkan does not promise of every device. */
static bool check_device(struct gpu *gpu, struct tool_error *err)
{
    VkQueueFamilyProperties families[32];
    uint32_t count = 32;
    vkGetPhysicalDeviceQueueFamilyProperties(gpu->physical_device, &count, families);
    if (gpu->queue_family >= count ||
        !(families[gpu->queue_family].queueFlags & VK_QUEUE_GRAPHICS_BIT))
        return fail(err, EXIT_DEVICE, "%s has no queue for both graphics and compute",
                    gpu->properties.deviceName);
    VkFormatProperties depth;
    vkGetPhysicalDeviceFormatProperties(gpu->physical_device, live_formats[ATTACHMENT_DEPTH],
                                        &depth);
    if (!(depth.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT))
        return fail(err, EXIT_DEVICE, "%s cannot render to D32_SFLOAT depth",
                    gpu->properties.deviceName);
    return true;
}

/* Memory that the host writes once and the device reads: the device's own where the host sees it.
 * Some hundred kilobytes are not worth a copy. */
static uint32_t pick_memory(const struct gpu *gpu, uint32_t type_bits)
{
    const VkMemoryPropertyFlags visible =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const VkMemoryPropertyFlags wanted[2] = {visible | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                                             visible};
    for (int w = 0; w < 2; ++w) {
        for (uint32_t i = 0; i < gpu->memory.memoryTypeCount; ++i) {
            if (type_bits >> i & 1u &&
                (gpu->memory.memoryTypes[i].propertyFlags & wanted[w]) == wanted[w])
                return i;
        }
    }
    return 0; /* never: the specification promises one for every buffer */
}

static bool create_buffer(struct live_scene *scene, VkDeviceSize bytes, struct tool_error *err)
{
    VkDevice device = scene->gpu->device;
    VkMemoryRequirements need;
    VkResult result = vkCreateBuffer(
        device,
        &(VkBufferCreateInfo){
            .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
            .size = bytes,
            .usage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT,
            .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
        },
        NULL, &scene->buffer);
    if (result != VK_SUCCESS) {
        scene->buffer = VK_NULL_HANDLE;
        return gpu_ok(err, "vkCreateBuffer", result);
    }
    vkGetBufferMemoryRequirements(device, scene->buffer, &need);
    result = vkAllocateMemory(device,
                              &(VkMemoryAllocateInfo){
                                  .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                  .allocationSize = need.size,
                                  .memoryTypeIndex = pick_memory(scene->gpu, need.memoryTypeBits),
                              },
                              NULL, &scene->memory);
    if (result != VK_SUCCESS) {
        scene->memory = VK_NULL_HANDLE;
        return gpu_ok(err, "vkAllocateMemory", result);
    }
    result = vkBindBufferMemory(device, scene->buffer, scene->memory, 0);
    return gpu_ok(err, "vkBindBufferMemory", result);
}

static bool upload_mesh(struct live_scene *scene, const struct mesh *mesh, struct tool_error *err)
{
    size_t vertex_bytes = mesh->vertex_count * sizeof *mesh->vertices;
    size_t index_bytes = mesh->index_count * sizeof *mesh->indices;
    void *mapped;
    if (mesh->failed)
        return fail(err, EXIT_MEMORY, "out of memory");
    if (!create_buffer(scene, vertex_bytes + index_bytes, err))
        return false;
    VkResult result = vkMapMemory(scene->gpu->device, scene->memory, 0, VK_WHOLE_SIZE, 0, &mapped);
    if (result != VK_SUCCESS)
        return gpu_ok(err, "vkMapMemory", result);
    memcpy(mapped, mesh->vertices, vertex_bytes);
    memcpy((char *)mapped + vertex_bytes, mesh->indices, index_bytes);
    vkUnmapMemory(scene->gpu->device, scene->memory);
    scene->index_offset = vertex_bytes;
    scene->index_count = mesh->index_count;
    return true;
}

static bool create_geometry(struct live_scene *scene, struct tool_error *err)
{
    struct mesh mesh = {0};
    scene->design->build_still(&mesh);
    scene->still_count = mesh.index_count;
    scene->design->build_moving(&mesh);
    bool ok = upload_mesh(scene, &mesh, err);
    mesh_free(&mesh);
    return ok;
}

struct live_scene *live_scene_create(struct gpu *gpu, enum live_kind kind, struct tool_error *err)
{
    struct live_scene *scene = calloc(1, sizeof *scene);
    if (!scene) {
        fail(err, EXIT_MEMORY, "out of memory");
        return NULL;
    }
    scene->gpu = gpu;
    scene->design = designs[kind];
    if (check_device(gpu, err) && create_geometry(scene, err) &&
        live_pass_create(gpu, &scene->pass, err) && live_pipeline_create(scene, err))
        return scene;
    live_scene_destroy(scene);
    return NULL;
}

void live_scene_destroy(struct live_scene *scene)
{
    if (!scene)
        return;
    VkDevice device = scene->gpu->device;
    vkDestroyPipeline(device, scene->pipeline, NULL);
    vkDestroyPipelineLayout(device, scene->layout, NULL);
    vkDestroyRenderPass(device, scene->pass, NULL);
    vkDestroyBuffer(device, scene->buffer, NULL);
    vkFreeMemory(device, scene->memory, NULL);
    free(scene);
}

static double aspect_of(VkExtent2D used)
{
    return (double)used.width / used.height;
}

/* The product of two column-major matrices. */
static void multiply(const float a[16], const float b[16], float out[16])
{
    for (int i = 0; i < 16; ++i) {
        int row = i % 4, column = i / 4 * 4;
        double sum = 0;
        for (int k = 0; k < 4; ++k)
            sum += (double)a[4 * k + row] * b[column + k];
        out[i] = (float)sum;
    }
}

static void set_camera(struct live_push *push, const struct orbit *camera, VkExtent2D used)
{
    float view[16], projection[16], rotation[9];
    double eye[3];
    orbit_view_matrix(camera, view);
    orbit_projection(camera, aspect_of(used), projection);
    multiply(projection, view, push->view_projection);
    orbit_rotation(camera, rotation);
    orbit_eye(camera, eye);
    for (int i = 0; i < 3; ++i)
        push->eye[i] = camera->orthographic ? rotation[3 * i + 2] : (float)eye[i];
    push->eye[3] = camera->orthographic ? 0.0f : 1.0f;
}

static void push_and_draw(const struct live_scene *scene, VkCommandBuffer cmd,
                          struct live_push *push, struct mesh_place place, uint32_t first,
                          uint32_t count)
{
    /* Columns of the rotation: the place's axes. */
    const struct vec3 *a = &place.axes.x, *p = &place.position;
    const struct vec3 *b = &place.axes.y, *c = &place.axes.z;
    const double rows[3][4] = {
        {a->x, b->x, c->x, p->x}, {a->y, b->y, c->y, p->y}, {a->z, b->z, c->z, p->z}};
    for (int i = 0; i < 12; ++i)
        push->model[i / 4][i % 4] = (float)rows[i / 4][i % 4];
    vkCmdPushConstants(cmd, scene->layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof *push, push);
    vkCmdDrawIndexed(cmd, count, 1, first, 0, 0);
}

void live_scene_record(const struct live_scene *scene, const struct live_target *target,
                       VkCommandBuffer cmd, const struct orbit *camera, double time,
                       VkExtent2D used)
{
    struct live_push push;
    VkClearValue clears[ATTACHMENT_COUNT] = {0};
    const VkRect2D area = {{0, 0}, used};
    assert(used.width >= 1 && used.width <= target->extent.width);
    assert(used.height >= 1 && used.height <= target->extent.height);
    for (int i = 0; i < 3; ++i)
        clears[ATTACHMENT_INDIRECT].color.float32[i] = scene->design->background[i];
    set_camera(&push, camera, used);

    vkCmdBeginRenderPass(cmd,
                         &(VkRenderPassBeginInfo){
                             .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                             .renderPass = scene->pass,
                             .framebuffer = target->framebuffer,
                             .renderArea = area,
                             .clearValueCount = ATTACHMENT_COUNT,
                             .pClearValues = clears,
                         },
                         VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, scene->pipeline);
    vkCmdSetViewport(cmd, 0, 1,
                     &(VkViewport){
                         .width = (float)used.width,
                         .height = (float)used.height,
                         .maxDepth = 1.0f,
                     });
    vkCmdSetScissor(cmd, 0, 1, &area);
    vkCmdBindVertexBuffers(cmd, 0, 1, &scene->buffer, &(VkDeviceSize){0});
    vkCmdBindIndexBuffer(cmd, scene->buffer, scene->index_offset, VK_INDEX_TYPE_UINT32);
    push_and_draw(scene, cmd, &push, mesh_at(vec3(0, 0, 0)), 0, scene->still_count);
    push_and_draw(scene, cmd, &push, scene->design->motion(time), scene->still_count,
                  scene->index_count - scene->still_count);
    vkCmdEndRenderPass(cmd);
}

void live_scene_view(const struct orbit *camera, VkExtent2D used, struct ao_view *out)
{
    *out = ao_view_default();
    out->depth_encoding = VKAO_DEPTH_PROJECTED;
    out->normal_encoding = VKAO_NORMALS_XYZ_UNORM;
    out->valid.extent = used;
    orbit_projection(camera, aspect_of(used), out->projection);
    orbit_rotation(camera, out->normal_to_view);
}
