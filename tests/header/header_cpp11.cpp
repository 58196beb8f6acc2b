/* SPDX-License-Identifier: MIT
 *
 * The public header alone, as a C++11 program sees it. */
#include "vkao.h"

int main()
{
    const vkao_context_info context = vkao_context_info_default();
    const vkao_effect_info effect = vkao_effect_info_default();
    const vkao_frame_info frame = vkao_frame_info_default();
    const vkao_images images = vkao_images_default();
    const vkao_view view = vkao_view_default();
    const vkao_params params = vkao_params_default();
    return context.struct_size == sizeof context && effect.struct_size == sizeof effect &&
                   frame.struct_size == sizeof frame && images.struct_size == sizeof images &&
                   view.struct_size == sizeof view && params.struct_size == sizeof params
               ? 0
               : 1;
}
