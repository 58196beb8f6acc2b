/* SPDX-License-Identifier: MIT
 *
 * The public header alone, as a C++11 program sees it. */
#include "vkao.h"

int main()
{
    const vkao_images images = vkao_images_default();
    const vkao_view view = vkao_view_default();
    const vkao_ssao_params ssao = vkao_ssao_params_default();
    const vkao_blur_params blur = vkao_blur_params_default();
    const vkao_composite_params composite = vkao_composite_params_default();
    vkao_frame_info frame = vkao_frame_info();
    vkao_context_info context = vkao_context_info();
    frame.images = &images;
    frame.struct_size = sizeof frame;
    context.struct_size = sizeof context;
    return frame.images->struct_size == sizeof images && view.struct_size == sizeof view &&
                   ssao.struct_size == sizeof ssao && blur.struct_size == sizeof blur &&
                   composite.struct_size == sizeof composite &&
                   context.struct_size == sizeof context
               ? 0
               : 1;
}
