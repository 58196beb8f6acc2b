/* SPDX-License-Identifier: MIT
 *
 * The CPU's passes have no second layer: those of GPUs run where there is one. */
float load_second_z(ivec2 texel)
{
    return 0.0;
}
