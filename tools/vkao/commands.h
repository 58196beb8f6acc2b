/* SPDX-License-Identifier: MIT
 *
 * The three commands. Each returns the exit code of the process and has reported its errors. */
#ifndef VKAO_TOOLS_COMMANDS_H_
#define VKAO_TOOLS_COMMANDS_H_

#include "options.h"

int command_render(const struct options *options, struct report *report);
int command_inspect(const struct options *options, struct report *report);
int command_devices(const struct options *options);

#endif
