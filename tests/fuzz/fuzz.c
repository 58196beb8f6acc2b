/* SPDX-License-Identifier: MIT */
#include "fuzz.h"

#include <dirent.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void fuzz_broken(const char *file, int line, const char *condition, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fprintf(stderr, "%s:%d: broken promise: %s: ", file, line, condition);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    abort();
}

void fuzz_check_refusal(const struct tool_error *err, uint64_t codes)
{
    FUZZ_CHECK(err->code > 0 && err->code < 64 && codes >> err->code & 1, "code %d: %s", err->code,
               err->message);
    FUZZ_CHECK(err->message[0], "code %d without a message", err->code);
}

uint8_t fuzz_u8(struct fuzz_input *in)
{
    if (!in->size)
        return 0;
    in->size--;
    return *in->data++;
}

uint32_t fuzz_u32(struct fuzz_input *in)
{
    uint32_t value = 0;
    for (int i = 0; i < 4; i++)
        value |= (uint32_t)fuzz_u8(in) << 8 * i;
    return value;
}

bool fuzz_flag(struct fuzz_input *in)
{
    return fuzz_u8(in) & 1;
}

uint32_t fuzz_below(struct fuzz_input *in, uint32_t count)
{
    return count > 256 ? fuzz_u32(in) % count : count ? fuzz_u8(in) % count : 0;
}

double fuzz_number(struct fuzz_input *in)
{
    static const double values[] = {
        0.0,  1.0,     -1.0,    0.5,      2.0,  1e-45, 1e-40,        1.1754943508222875e-38,
        1e-9, 1e9,     3.4e38,  -3.4e38,  1e39, 1e300, 1e-300,       4.9406564584124654e-324,
        -0.0, 65504.0, 65536.0, 16777217, 90,   179.9, 180.0 - 1e-9, 360.0,
    };
    const uint32_t kind = fuzz_u8(in);
    if (kind < sizeof values / sizeof *values)
        return values[kind];
    switch (kind) {
    case 250:
        return NAN;
    case 251:
        return INFINITY;
    case 252:
        return -INFINITY;
    default:
        break;
    }
    if (kind < 128) /* everyday numbers: -128 to 127.996 */
        return ((double)fuzz_u8(in) * 256.0 + (double)fuzz_u8(in)) / 256.0 - 128.0;
    const uint32_t bits = fuzz_u32(in);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

int32_t fuzz_integer(struct fuzz_input *in)
{
    static const int32_t values[] = {
        0,   1,     -1,    2,         -2,        255,           256,
        511, 65535, 65536, INT32_MAX, INT32_MIN, INT32_MAX / 2, INT32_MIN / 2};
    const uint32_t kind = fuzz_u8(in);
    if (kind < sizeof values / sizeof *values)
        return values[kind];
    return kind < 200 ? (int32_t)kind - 100 : (int32_t)fuzz_u32(in);
}

char *fuzz_copy(const void *data, size_t size)
{
    char *copy = malloc(size + 1);
    if (!copy)
        abort();
    if (size)
        memcpy(copy, data, size);
    copy[size] = '\0';
    return copy;
}

char *fuzz_text(struct fuzz_input *in, size_t longest)
{
    size_t length = 0;
    while (length < longest && length < in->size && in->data[length])
        length++;
    char *text = fuzz_copy(in->data, length);
    in->data += length;
    in->size -= length;
    (void)fuzz_u8(in);
    return text;
}

static char directory[256];

static void remove_directory(void)
{
    DIR *dir = opendir(directory);
    if (!dir)
        return;
    for (struct dirent *entry; (entry = readdir(dir));) {
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            unlinkat(dirfd(dir), entry->d_name, 0);
    }
    closedir(dir);
    rmdir(directory);
}

const char *fuzz_directory(void)
{
    if (directory[0])
        return directory;
    const char *base = getenv("TMPDIR");
    if (!base || !base[0])
        base = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    snprintf(directory, sizeof directory, "%s/vkao-fuzz-XXXXXX", base);
    if (!mkdtemp(directory)) {
        perror(directory);
        abort();
    }
    atexit(remove_directory);
    return directory;
}
