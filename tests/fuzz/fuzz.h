/* SPDX-License-Identifier: MIT
 *
 * Every fuzzer is one function over bytes. With -Dfuzzing=true libFuzzer drives it; without, replay.c runs it over
 * files, so that what was once found stays tested. */
#ifndef VKAO_TESTS_FUZZ_H_
#define VKAO_TESTS_FUZZ_H_

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif
