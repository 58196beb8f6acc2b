/* SPDX-License-Identifier: MIT */
#include "recording.h"

#include "pipelines.h"

struct vkao_rect vkao_area(const struct vkao_recording *r, enum vkao_area area)
{
    const vkao_effect_info *e = &r->frame->program->settings;
    const uint32_t shift = e->half_resolution;
    const uint32_t radius = e->stages & VKAO_STAGE_BLUR ? e->blur_radius : 0;
    switch (area) {
    case VKAO_AREA_WHOLE:
        return (struct vkao_rect){0, 0, (r->frame->extent.width + shift) >> shift,
                                  (r->frame->extent.height + shift) >> shift};
    case VKAO_AREA_VALID:
        return r->grid.valid;
    case VKAO_AREA_AROUND:
        return vkao_rect_grow(r->grid.rect, radius, radius, r->grid.valid);
    case VKAO_AREA_ABOVE_BELOW:
        return vkao_rect_grow(r->grid.rect, 0, radius, r->grid.valid);
    case VKAO_AREA_RECT:
        return r->grid.rect;
    default:
        return r->image.rect;
    }
}

void vkao_barrier(const struct vkao_recording *r, enum vkao_access before, enum vkao_access after)
{
    static const struct {
        VkPipelineStageFlags stages;
        VkAccessFlags writes, all;
    } what[] = {
        [VKAO_SHADERS] = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                          VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT},
        [VKAO_TRANSFER] = {VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                           VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT},
        [VKAO_INDIRECT] = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                               VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
                           VK_ACCESS_SHADER_WRITE_BIT,
                           VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                               VK_ACCESS_INDIRECT_COMMAND_READ_BIT},
    };
    const VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = what[before].writes,
        .dstAccessMask = what[after].all,
    };
    r->frame->ctx->vk.CmdPipelineBarrier(r->cmd, what[before].stages, what[after].stages, 0, 1,
                                         &barrier, 0, NULL, 0, NULL);
}

void vkao_bind(const struct vkao_recording *r, uint32_t pass, const void *push, size_t bytes)
{
    const struct vk_table *vk = &r->frame->ctx->vk;
    const struct vkao_pipelines *p = r->frame->program->steps[pass].pipelines;
    vk->CmdBindPipeline(r->cmd, VK_PIPELINE_BIND_POINT_COMPUTE,
                        p->forms[r->form & (p->row->forms - 1)]);
    vk->CmdBindDescriptorSets(r->cmd, VK_PIPELINE_BIND_POINT_COMPUTE, p->layout, 0, 1,
                              &r->frame->sets[pass], 0, NULL);
    vk->CmdPushConstants(r->cmd, p->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, (uint32_t)bytes, push);
}

void vkao_dispatch(const struct vkao_recording *r, uint32_t pass, struct vkao_rect rect)
{
    const struct vkao_pass *row = r->frame->program->steps[pass].row;
    const uint32_t width = row->texels.width * row->group.width,
                   height = row->texels.height * row->group.height;
    const uint32_t x0 = rect.x0 - rect.x0 % row->texels.width,
                   y0 = rect.y0 - (row->on_rows ? rect.y0 % row->texels.height : 0);
    r->frame->ctx->vk.CmdDispatch(r->cmd, (rect.x1 - x0 + width - 1) / width,
                                  (rect.y1 - y0 + height - 1) / height, 1);
}
