/* SPDX-License-Identifier: MIT */
#include "probe.h"

#include <math.h>
#include <string.h>
#include <vulkan/vulkan.h>

/* The buffer: a block of up to 3x3 depths, one normal, AO of A and of B. */
enum { BLOCK = 3, AT_NORMAL = 48, AT_AO = 64, BUFFER_BYTES = 128 };

bool probe_create(struct gpu *gpu, struct probe *probe, struct tool_error *err)
{
    *probe = (struct probe){.gpu = gpu};
    for (int i = 0; i < FRAMES_IN_FLIGHT; i++) {
        if (!gpu_buffer_create(gpu, BUFFER_BYTES, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                               &probe->buffers[i], err)) {
            probe_destroy(probe);
            return false;
        }
    }
    return true;
}

void probe_destroy(struct probe *probe)
{
    if (!probe->gpu)
        return;
    for (int i = 0; i < FRAMES_IN_FLIGHT; i++)
        gpu_buffer_destroy(probe->gpu, &probe->buffers[i]);
    *probe = (struct probe){0};
}

/* --- Recording --- */

/* Both ways: what came before are reads, and so is all that follows. */
static void change_layout(VkCommandBuffer cmd, VkImage image, VkImageAspectFlags aspect,
                          VkImageLayout from, VkImageLayout to)
{
    const VkPipelineStageFlags readers = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                                         VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT |
                                         VK_PIPELINE_STAGE_TRANSFER_BIT;
    vkCmdPipelineBarrier(
        cmd, readers, readers, 0, 0, NULL, 0, NULL, 1,
        &(VkImageMemoryBarrier){
            .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
            .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT,
            .oldLayout = from,
            .newLayout = to,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .image = image,
            .subresourceRange = {aspect, 0, 1, 0, 1},
        });
}

static void copy_texels(VkCommandBuffer cmd, VkImage image, VkImageLayout layout,
                        VkImageAspectFlags aspect, VkOffset2D at, VkExtent2D extent,
                        VkBuffer buffer, VkDeviceSize offset)
{
    const VkImageLayout source = layout == VK_IMAGE_LAYOUT_GENERAL
                                     ? VK_IMAGE_LAYOUT_GENERAL
                                     : VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    if (source != layout)
        change_layout(cmd, image, aspect, layout, source);
    vkCmdCopyImageToBuffer(cmd, image, source, buffer, 1,
                           &(VkBufferImageCopy){
                               .bufferOffset = offset,
                               .imageSubresource = {aspect, 0, 0, 1},
                               .imageOffset = {at.x, at.y, 0},
                               .imageExtent = {extent.width, extent.height, 1},
                           });
    if (source != layout)
        change_layout(cmd, image, aspect, source, layout);
}

static void around(int32_t at, uint32_t size, int32_t *first, uint32_t *count)
{
    *count = size < BLOCK ? size : BLOCK;
    *first = at - 1;
    if (*first < 0)
        *first = 0;
    if (*first + (int32_t)*count > (int32_t)size)
        *first = (int32_t)size - (int32_t)*count;
}

void probe_record(struct probe *probe, uint32_t frame, VkCommandBuffer cmd,
                  const struct inputs *inputs, const VkImage ao[2], int32_t x, int32_t y)
{
    struct probe_request *r = &probe->requests[frame];
    const VkExtent2D one = {1, 1};
    const VkOffset2D at = {x, y};
    const vkao_images *images = &inputs->images;
    VkBuffer buffer = probe->buffers[frame].buffer;
    *r = (struct probe_request){.pending = true,
                                .x = x,
                                .y = y,
                                .view = inputs->view,
                                .extent = inputs->extent,
                                .normal_format =
                                    inputs->normals ? images->normals.format : VK_FORMAT_UNDEFINED};
    /* The copies of an earlier frame -> these. Its fence says so too, but validation 1.3.239
     * forgets the fence once the queue was waited for to be idle. */
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1,
                         &(VkMemoryBarrier){
                             .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                             .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                             .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                         },
                         0, NULL, 0, NULL);
    around(x, inputs->extent.width, &r->block.x, &r->block_extent.width);
    around(y, inputs->extent.height, &r->block.y, &r->block_extent.height);
    bool is_depth = images->depth.format == VK_FORMAT_D32_SFLOAT;
    copy_texels(cmd, inputs->depth, images->depth.layout,
                is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT, r->block,
                r->block_extent, buffer, 0);
    if (inputs->normals)
        copy_texels(cmd, inputs->normals, images->normals.layout, VK_IMAGE_ASPECT_COLOR_BIT, at,
                    one, buffer, AT_NORMAL);
    for (VkDeviceSize i = 0; i < 2; i++)
        copy_texels(cmd, ao[i], VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_ASPECT_COLOR_BIT, at, one, buffer,
                    AT_AO + 4 * i);
    /* The copies -> probe_read. */
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &(VkMemoryBarrier){
                             .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                             .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                             .dstAccessMask = VK_ACCESS_HOST_READ_BIT,
                         },
                         0, NULL, 0, NULL);
}

/* --- Reading --- */

static bool is_empty(const VkRect2D *rect)
{
    return rect->extent.width == 0 || rect->extent.height == 0;
}

static double axis_sign(const struct ao_view *view)
{
    const float *p = view->projection;
    if (fabsf(p[11]) > 0.0f)
        return p[11] < 0.0f ? -1 : 1;
    return view->axis == VKAO_VIEW_AXIS_POSITIVE_Z ? 1 : -1;
}

/* z of view space, NAN for background. Equations of the projection: clip = P * (x, y, z, 1). */
static double view_z(const struct ao_view *view, double depth)
{
    const float *p = view->projection;
    if (!isfinite(depth))
        return NAN;
    if (view->depth_encoding != VKAO_DEPTH_PROJECTED) {
        if (!(depth > 0))
            return NAN;
        return axis_sign(view) * (view->depth_encoding == VKAO_DEPTH_INVERSE_Z ? 1 / depth : depth);
    }
    if (!(depth > 0 && depth < 1))
        return NAN;
    return ((double)p[14] - depth * (double)p[15]) / (depth * (double)p[11] - (double)p[10]);
}

bool unproject(const struct ao_view *view, VkExtent2D extent, double column, double row,
               double depth, double position[3])
{
    const float *p = view->projection;
    const VkRect2D whole = {.extent = extent};
    const VkRect2D *port = !is_empty(&view->viewport) ? &view->viewport
                           : !is_empty(&view->valid)  ? &view->valid
                                                      : &whole;
    double nx = (column + 0.5 - port->offset.x) / port->extent.width * 2 - 1;
    double ny = (row + 0.5 - port->offset.y) / port->extent.height * 2 - 1;
    double z = view_z(view, depth);
    if (!isfinite(z))
        return false;
    const bool perspective = fabsf(p[11]) > 0.0f;
    double w = (double)p[11] * z + (double)p[15];
    position[0] = (nx * w - (double)p[8] * z - (double)p[12]) / (double)p[0];
    position[1] = (ny * w - (double)p[9] * z - (double)p[13]) / (double)p[5];
    position[2] = z;
    if (view->depth_encoding == VKAO_DEPTH_DISTANCE && perspective) {
        double length = sqrt(position[0] * position[0] + position[1] * position[1] + z * z);
        for (int i = 0; i < 3; i++)
            position[i] *= depth / length;
    }
    return true;
}

static bool normalise(double v[3])
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return isfinite(v[0]);
}

/* As stored, in view space; false if it is too short to be meant, as vkao sees it. */
static bool stored_normal(const struct probe_request *r, const unsigned char *bytes,
                          double normal[3])
{
    float stored[3];
    uint32_t word;
    if (r->normal_format == VK_FORMAT_R32G32B32A32_SFLOAT) {
        memcpy(stored, bytes, sizeof stored);
    } else if (r->normal_format == VK_FORMAT_A2B10G10R10_UNORM_PACK32) {
        memcpy(&word, bytes, sizeof word);
        for (int i = 0; i < 3; i++)
            stored[i] = (float)(word >> 10 * i & 1023u) / 1023.0f;
    } else {
        return false;
    }
    double length = 0;
    for (int i = 0; i < 3; i++) {
        if (r->view.normal_encoding == VKAO_NORMALS_XYZ_UNORM)
            stored[i] = stored[i] * 2.0f - 1.0f;
        length += (double)stored[i] * (double)stored[i];
    }
    for (int row = 0; row < 3; row++) {
        normal[row] = 0;
        for (int column = 0; column < 3; column++)
            normal[row] +=
                (double)r->view.normal_to_view[column * 3 + row] * (double)stored[column];
    }
    return length >= 0.25 && normalise(normal);
}

/* The nearer of the neighbours on both sides, less the centre. */
static bool slope(const struct probe_request *r, const float *depths, int32_t dx, int32_t dy,
                  const double centre[3], double out[3])
{
    bool found = false;
    for (int32_t side = -1; side <= 1; side += 2) {
        int32_t x = r->x + side * dx - r->block.x, y = r->y + side * dy - r->block.y;
        double p[3], d[3];
        if (x < 0 || y < 0 || x >= (int32_t)r->block_extent.width ||
            y >= (int32_t)r->block_extent.height ||
            !unproject(&r->view, r->extent, r->x + side * dx, r->y + side * dy,
                       (double)depths[y * (int32_t)r->block_extent.width + x], p))
            continue;
        for (int i = 0; i < 3; i++)
            d[i] = (p[i] - centre[i]) * side;
        if (found && fabs(d[2]) > fabs(out[2]))
            continue;
        memcpy(out, d, sizeof d);
        found = true;
    }
    return found;
}

static bool derived_normal(const struct probe_request *r, const float *depths,
                           const double centre[3], double normal[3])
{
    double h[3], v[3];
    if (!slope(r, depths, 1, 0, centre, h) || !slope(r, depths, 0, 1, centre, v))
        return false;
    for (int i = 0; i < 3; i++)
        normal[i] = h[(i + 1) % 3] * v[(i + 2) % 3] - h[(i + 2) % 3] * v[(i + 1) % 3];
    if (!normalise(normal))
        return false;
    const bool perspective = fabsf(r->view.projection[11]) > 0.0f;
    double towards = 0; /* the eye, as the normal should point */
    for (int i = 0; i < 3; i++)
        towards -= normal[i] * (perspective ? centre[i] : i == 2 ? axis_sign(&r->view) : 0);
    for (int i = 0; towards < 0 && i < 3; i++)
        normal[i] = -normal[i];
    return true;
}

bool probe_read(struct probe *probe, uint32_t frame, struct probe_result *result)
{
    struct probe_request *r = &probe->requests[frame];
    if (!r->pending)
        return false;
    r->pending = false;
    const unsigned char *bytes = probe->buffers[frame].mapped;
    float depths[BLOCK * BLOCK];
    memcpy(depths, bytes, sizeof depths);
    *result = (struct probe_result){.valid = true, .x = r->x, .y = r->y};
    memcpy(result->ao, bytes + AT_AO, sizeof result->ao);
    int32_t at = (r->y - r->block.y) * (int32_t)r->block_extent.width + r->x - r->block.x;
    result->background =
        !unproject(&r->view, r->extent, r->x, r->y, (double)depths[at], result->position);
    if (result->background || stored_normal(r, bytes + AT_NORMAL, result->normal))
        return true;
    result->normal_is_derived = true;
    if (!derived_normal(r, depths, result->position, result->normal))
        memset(result->normal, 0, sizeof result->normal);
    return true;
}
