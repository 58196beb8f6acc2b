/* SPDX-License-Identifier: MIT
 *
 * The sub-commands. argv[0] is the name of the sub-command; each returns the exit code of the
 * process and has reported its errors. */
#ifndef VKAO_BENCH_COMMANDS_H_
#define VKAO_BENCH_COMMANDS_H_

int command_copy(int argc, char **argv);
int command_cost(int argc, char **argv);
int command_quality(int argc, char **argv);
int command_speed(int argc, char **argv);

#endif
