/* SPDX-License-Identifier: MIT */
#ifndef VKAO_TOOLS_VECTOR_WIDTH_H_
#define VKAO_TOOLS_VECTOR_WIDTH_H_

/* Has Mesa's lavapipe compute on 512 bits at a time where that is faster; by itself it never takes
 * more than 256. For processes that compute and never draw: at 512 compiling its fragment shaders
 * ends in a crash. To be called before the process first makes an instance, while it has one
 * thread, as it changes the environment. A user's LP_NATIVE_VECTOR_WIDTH or GALLIVM_PERF wins. */
void choose_vector_width(void);

#endif
