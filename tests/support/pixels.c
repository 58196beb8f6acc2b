/* SPDX-License-Identifier: MIT */
#include "pixels.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

enum kind { UNORM, UNORM24, SNORM, HALF, FLOAT, PACKED };

static const struct pixel_format {
    VkFormat format;
    uint32_t components;
    enum kind kind;
    uint32_t bytes; /* of one component; of the texel if PACKED */
} formats[] = {
    {VK_FORMAT_R8_UNORM, 1, UNORM, 1},
    {VK_FORMAT_R16_UNORM, 1, UNORM, 2},
    {VK_FORMAT_D16_UNORM, 1, UNORM, 2},
    {VK_FORMAT_X8_D24_UNORM_PACK32, 1, UNORM24, 4},
    {VK_FORMAT_R16_SFLOAT, 1, HALF, 2},
    {VK_FORMAT_R32_SFLOAT, 1, FLOAT, 4},
    {VK_FORMAT_D32_SFLOAT, 1, FLOAT, 4},
    {VK_FORMAT_R16G16_UNORM, 2, UNORM, 2},
    {VK_FORMAT_R16G16_SNORM, 2, SNORM, 2},
    {VK_FORMAT_R16G16_SFLOAT, 2, HALF, 2},
    {VK_FORMAT_R8G8B8A8_UNORM, 4, UNORM, 1},
    {VK_FORMAT_R8G8B8A8_SNORM, 4, SNORM, 1},
    {VK_FORMAT_R16G16B16A16_UNORM, 4, UNORM, 2},
    {VK_FORMAT_R16G16B16A16_SFLOAT, 4, HALF, 2},
    {VK_FORMAT_R32G32B32A32_SFLOAT, 4, FLOAT, 4},
    {VK_FORMAT_A2B10G10R10_UNORM_PACK32, 4, PACKED, 4},
};

static const struct pixel_format *find(VkFormat format)
{
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; ++i) {
        if (formats[i].format == format)
            return &formats[i];
    }
    return NULL;
}

uint32_t pixels_components(VkFormat format)
{
    const struct pixel_format *f = find(format);
    return f ? f->components : 0;
}

/* Of exponents that are those of normal numbers. ldexp(1, exponent) is the same, and takes most of
 * the time of a test that has many images. */
static double power_of_two(int exponent)
{
    const uint64_t bits = (uint64_t)(exponent + 1023) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

static uint16_t to_half(double v)
{
    uint16_t sign = signbit(v) ? 0x8000u : 0u;
    if (isnan(v))
        return (uint16_t)(sign | 0x7e00u);
    v = fabs(v);
    if (v == 0.0)
        return sign;
    if (v >= 65520.0)
        return (uint16_t)(sign | 0x7c00u);
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    const int exponent = (int)(bits >> 52) - 1023; /* v = 1.m * 2^exponent */
    const int e = exponent < -14 ? -14 : exponent;
    /* A mantissa that rounds up to 2048 carries into the exponent by itself. */
    uint32_t mantissa = (uint32_t)nearbyint(v * power_of_two(10 - e));
    return (uint16_t)(sign | (((uint32_t)(e + 14) << 10) + mantissa));
}

static double from_half(uint16_t h)
{
    int exponent = h >> 10 & 31;
    double mantissa = h & 1023, sign = h & 0x8000 ? -1.0 : 1.0;
    if (exponent == 31)
        return mantissa != 0.0 ? (double)NAN : sign * INFINITY;
    return sign * (exponent ? (mantissa + 1024.0) * power_of_two(exponent - 25)
                            : mantissa * power_of_two(-24));
}

static double clamp(double v, double low, double high)
{
    return v > low ? (v < high ? v : high) : low; /* NaN becomes low */
}

static void put(unsigned char *bytes, uint32_t value, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        bytes[i] = (unsigned char)(value >> (8 * i));
}

static uint32_t get(const unsigned char *bytes, uint32_t count)
{
    uint32_t value = 0;
    for (uint32_t i = 0; i < count; ++i)
        value |= (uint32_t)bytes[i] << (8 * i);
    return value;
}

static uint32_t encode_component(const struct pixel_format *f, double v)
{
    double unorm_max = power_of_two((int)f->bytes * 8) - 1.0,
           snorm_max = power_of_two((int)f->bytes * 8 - 1) - 1.0;
    switch (f->kind) {
    case UNORM:
        return (uint32_t)nearbyint(clamp(v, 0.0, 1.0) * unorm_max);
    case UNORM24:
        return (uint32_t)nearbyint(clamp(v, 0.0, 1.0) * 16777215.0);
    case SNORM:
        return (uint32_t)(int32_t)nearbyint(clamp(v, -1.0, 1.0) * snorm_max);
    default:
        return to_half(v);
    }
}

static double decode_component(const struct pixel_format *f, uint32_t word)
{
    double unorm_max = power_of_two((int)f->bytes * 8) - 1.0,
           snorm_max = power_of_two((int)f->bytes * 8 - 1) - 1.0;
    switch (f->kind) {
    case UNORM:
        return word / unorm_max;
    case UNORM24:
        return (word & 0xffffffu) / 16777215.0;
    case SNORM:
        return fmax(-1.0, (word > snorm_max ? word - 2.0 * snorm_max - 2.0 : word) / snorm_max);
    default:
        return from_half((uint16_t)word);
    }
}

/* Most images of the tests are of floats, and most of the time of some is spent here. */
static void encode_floats(const double *values, uint64_t texels, uint32_t components, void *bytes)
{
    float *out = bytes;
    for (uint64_t i = 0; i < texels; ++i, values += 4)
        for (uint32_t c = 0; c < components; ++c)
            *out++ = (float)values[c];
}

static void decode_floats(const void *bytes, uint64_t texels, uint32_t components, double *values)
{
    const float *in = bytes;
    for (uint64_t i = 0; i < texels; ++i, values += 4) {
        values[0] = values[1] = values[2] = 0.0;
        values[3] = 1.0;
        for (uint32_t c = 0; c < components; ++c)
            values[c] = (double)*in++;
    }
}

void pixels_encode(VkFormat format, const double *values, uint64_t texels, void *bytes)
{
    const struct pixel_format *f = find(format);
    unsigned char *out = bytes;
    if (f && f->kind == FLOAT) {
        encode_floats(values, texels, f->components, bytes);
        return;
    }
    for (uint64_t i = 0; f && i < texels; ++i, values += 4) {
        if (f->kind == PACKED) {
            uint32_t word = (uint32_t)nearbyint(clamp(values[3], 0.0, 1.0) * 3.0) << 30;
            for (int c = 0; c < 3; ++c)
                word |= (uint32_t)nearbyint(clamp(values[c], 0.0, 1.0) * 1023.0) << (10 * c);
            put(out, word, 4);
            out += 4;
            continue;
        }
        for (uint32_t c = 0; c < f->components; ++c, out += f->bytes)
            put(out, encode_component(f, values[c]), f->bytes);
    }
}

void pixels_decode(VkFormat format, const void *bytes, uint64_t texels, double *values)
{
    const struct pixel_format *f = find(format);
    const unsigned char *in = bytes;
    if (f && f->kind == FLOAT) {
        decode_floats(bytes, texels, f->components, values);
        return;
    }
    for (uint64_t i = 0; f && i < texels; ++i, values += 4) {
        values[0] = values[1] = values[2] = 0.0;
        values[3] = 1.0;
        if (f->kind == PACKED) {
            uint32_t word = get(in, 4);
            for (int c = 0; c < 3; ++c)
                values[c] = (word >> (10 * c) & 1023u) / 1023.0;
            values[3] = (word >> 30) / 3.0;
            in += 4;
            continue;
        }
        for (uint32_t c = 0; c < f->components; ++c, in += f->bytes)
            values[c] = decode_component(f, get(in, f->bytes));
    }
}
