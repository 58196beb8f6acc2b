/* SPDX-License-Identifier: MIT
 *
 * Every fuzzer is one function over bytes. With -Dfuzzing=true libFuzzer drives it; without,
 * replay.c runs it over files, so that what was once found stays tested. */
#ifndef VKAO_TESTS_FUZZ_H_
#define VKAO_TESTS_FUZZ_H_

#include "error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A promise of the code under test. In place of assert, which a release build drops. */
#define FUZZ_CHECK(condition, ...)                                                                 \
    do {                                                                                           \
        if (!(condition))                                                                          \
            fuzz_broken(__FILE__, __LINE__, #condition, __VA_ARGS__);                              \
    } while (0)
_Noreturn void fuzz_broken(const char *file, int line, const char *condition, const char *format,
                           ...) TOOL_PRINTF(4, 5);

/* Sets of exit codes, for fuzz_check_refusal. */
#define FUZZ_CODE(code) (UINT64_C(1) << (code))
/* A refusal has a code of the set, and says why in one line. */
void fuzz_check_refusal(const struct tool_error *err, uint64_t codes);

/* The input as a stream of decisions: once it is used up, everything is 0. */
struct fuzz_input {
    const uint8_t *data;
    size_t size;
};
uint8_t fuzz_u8(struct fuzz_input *in);
uint32_t fuzz_u32(struct fuzz_input *in);
bool fuzz_flag(struct fuzz_input *in);
/* 0 to count - 1 */
uint32_t fuzz_below(struct fuzz_input *in, uint32_t count);
/* Often a value at which something changes: zeros, denormals, infinities, NaN, powers of two. */
double fuzz_number(struct fuzz_input *in);
int32_t fuzz_integer(struct fuzz_input *in);
/* malloc'ed, of exactly its length, so that a byte too many is seen; at most longest bytes, up to
 * the next zero of the input. */
char *fuzz_text(struct fuzz_input *in, size_t longest);

/* malloc'ed copy with a zero behind it. */
char *fuzz_copy(const void *data, size_t size);

/* A directory of this process in memory if possible, made when first asked for and removed with
 * everything in it at the end. */
const char *fuzz_directory(void);

#endif
