/* SPDX-License-Identifier: MIT */
#include "text.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool text_reserve(struct text *text, size_t more)
{
    if (more < text->capacity - text->length)
        return true;
    size_t capacity = text->capacity ? text->capacity : 64;
    while (capacity - text->length <= more) {
        if (capacity > SIZE_MAX / 2)
            return false;
        capacity *= 2;
    }
    char *data = realloc(text->data, capacity);
    if (!data)
        return false;
    text->data = data;
    text->capacity = capacity;
    return true;
}

void text_add(struct text *text, const char *format, ...)
{
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    int length = vsnprintf(NULL, 0, format, args);
    if (length < 0 || text->out_of_memory || !text_reserve(text, (size_t)length)) {
        text->out_of_memory = true;
    } else {
        vsnprintf(text->data + text->length, (size_t)length + 1, format, again);
        text->length += (size_t)length;
    }
    va_end(again);
    va_end(args);
}

void text_free(struct text *text)
{
    free(text->data);
    *text = (struct text){0};
}

/* --- What a terminal may see --- */

enum {
    ESCAPE_BYTES = 4, /* \xNN, and the longest character */
    JSON_BYTES = 8    /* what stands for a byte, at most */
};

/* The character at string and its bytes; 0 if there is none that UTF-8 allows (RFC 3629). */
static size_t utf8_character(const char *string, uint32_t *character)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000}; /* by length: no longer forms */
    const unsigned char *s = (const unsigned char *)string;
    const size_t length = s[0] < 0x80             ? 1
                          : (s[0] & 0xe0) == 0xc0 ? 2
                          : (s[0] & 0xf0) == 0xe0 ? 3
                          : (s[0] & 0xf8) == 0xf0 ? 4
                                                  : 0;
    uint32_t c = length == 1 ? s[0] : s[0] & (0x7fu >> length);
    for (size_t i = 1; i < length; i++) {
        if ((s[i] & 0xc0) != 0x80)
            return 0; /* also at the end of the string */
        c = c << 6 | (s[i] & 0x3f);
    }
    if (length == 0 || c < least[length] || c > 0x10ffff || (c >= 0xd800 && c <= 0xdfff))
        return 0;
    *character = c;
    return length;
}

static bool steers_terminals(uint32_t c)
{
    return c < 0x20 || (c >= 0x7f && c <= 0x9f) || c == 0x2028 || c == 0x2029 ||
           (c >= 0x202a && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

/* What follows the backslash of an escape. */
static bool is_escape_tail(const char *s)
{
    return s[0] == 'x' && isxdigit((unsigned char)s[1]) && isxdigit((unsigned char)s[2]);
}

/* One step: takes *string on, and writes what stands for it. Returns the bytes written. */
static size_t printable_step(const char **string, char out[ESCAPE_BYTES + 1])
{
    uint32_t c = 0;
    const char *s = *string;
    size_t length = utf8_character(s, &c);
    if (length > 0 && !steers_terminals(c) && !(c == '\\' && is_escape_tail(s + 1))) {
        memcpy(out, s, length);
        *string += length;
        return length;
    }
    snprintf(out, ESCAPE_BYTES + 1, "\\x%02x", (unsigned)(unsigned char)s[0]);
    *string += 1;
    return ESCAPE_BYTES;
}

size_t text_printable(char *out, size_t size, const char *string)
{
    size_t wanted = 0, written = 0;
    while (*string) {
        char step[ESCAPE_BYTES + 1];
        size_t bytes = printable_step(&string, step);
        if (wanted == written && written + bytes < size) {
            memcpy(out + written, step, bytes);
            written += bytes;
        }
        wanted += bytes;
    }
    if (size > 0)
        out[written] = '\0';
    return wanted;
}

void text_add_printable(struct text *text, const char *string)
{
    const size_t length = text_printable(NULL, 0, string);
    if (text->out_of_memory || !text_reserve(text, length)) {
        text->out_of_memory = true;
        return;
    }
    text_printable(text->data + text->length, length + 1, string);
    text->length += length;
}

void text_add_json(struct text *text, const char *json)
{
    if (text->out_of_memory || strlen(json) > SIZE_MAX / JSON_BYTES - 1 ||
        !text_reserve(text, strlen(json) * JSON_BYTES)) {
        text->out_of_memory = true;
        return;
    }
    char *out = text->data + text->length;
    while (*json) {
        uint32_t c = 0;
        size_t length = utf8_character(json, &c);
        if (length == 0) {
            out += snprintf(out, JSON_BYTES, "\\\\x%02x", (unsigned)(unsigned char)*json);
            length = 1;
        } else if (c >= 0x7f && steers_terminals(c)) { /* below, strings have none */
            out += snprintf(out, JSON_BYTES, "\\u%04x", (unsigned)c);
        } else {
            /* Both characters of an escape, so that the second begins none. */
            length = c == '\\' && json[1] ? 2 : length;
            memcpy(out, json, length);
            out += length;
            if (c == '\\' && json[1] == '\\' && is_escape_tail(json + 2))
                out += snprintf(out, JSON_BYTES, "x5c");
        }
        json += length;
    }
    *out = '\0';
    text->length = (size_t)(out - text->data);
}

/* --- Words and numbers --- */

char *text_copy(const char *string, size_t length)
{
    char *copy = malloc(length + 1);
    if (!copy)
        return NULL;
    memcpy(copy, string, length);
    copy[length] = '\0';
    return copy;
}

static int lower(char c)
{
    return tolower((unsigned char)c);
}

bool text_equal_nocase(const char *a, const char *b)
{
    while (*a && lower(*a) == lower(*b)) {
        a++;
        b++;
    }
    return lower(*a) == lower(*b);
}

bool text_starts_with(const char *string, const char *prefix)
{
    return strncmp(string, prefix, strlen(prefix)) == 0;
}

bool text_ends_with(const char *string, const char *suffix)
{
    size_t length = strlen(string), end = strlen(suffix);
    return length >= end && strcmp(string + length - end, suffix) == 0;
}

const char *text_base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

bool text_has_extension(const char *path, const char *extension)
{
    const size_t length = strlen(path), end = strlen(extension);
    return length > end && text_equal_nocase(path + length - end, extension);
}

bool text_to_number(const char *string, double *number)
{
    char *end;
    if (!*string || isspace((unsigned char)*string))
        return false;
    errno = 0;
    double value = strtod(string, &end);
    if (*end || isnan(value) || (errno == ERANGE && isinf(value)))
        return false;
    *number = value;
    return true;
}

bool text_to_integer(const char *string, int64_t *integer)
{
    char *end;
    if (!*string || isspace((unsigned char)*string))
        return false;
    errno = 0;
    long long value = strtoll(string, &end, 10);
    if (*end || errno == ERANGE)
        return false;
    *integer = value;
    return true;
}

static unsigned min3(unsigned a, unsigned b, unsigned c)
{
    unsigned ab = a < b ? a : b;
    return ab < c ? ab : c;
}

unsigned text_distance(const char *a, const char *b)
{
    enum { MAX = 63 };
    unsigned row[3][MAX + 1]; /* the last two rows of the table and the one in work */
    size_t m = strlen(a) < MAX ? strlen(a) : MAX, n = strlen(b) < MAX ? strlen(b) : MAX;
    for (size_t j = 0; j <= n; j++)
        row[0][j] = (unsigned)j;
    for (size_t i = 1; i <= m; i++) {
        unsigned *now = row[i % 3], *last = row[(i + 2) % 3], *before = row[(i + 1) % 3];
        now[0] = (unsigned)i;
        for (size_t j = 1; j <= n; j++) {
            unsigned change = a[i - 1] == b[j - 1] ? 0 : 1;
            now[j] = min3(last[j] + 1, now[j - 1] + 1, last[j - 1] + change);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
                before[j - 2] + 1 < now[j])
                now[j] = before[j - 2] + 1;
        }
    }
    return row[m % 3][n];
}

void text_percent(char out[PERCENT_BYTES], double share)
{
    const double percent = share * 100.0;
    if (percent >= 9.95 && percent < 99.5)
        snprintf(out, PERCENT_BYTES, "%.0f %%", percent);
    else if (percent >= 99.5 && percent < 99.995)
        snprintf(out, PERCENT_BYTES, "%.2f %%", percent);
    else if (percent >= 99.995 && percent < 100)
        snprintf(out, PERCENT_BYTES, "99.99 %%");
    else
        snprintf(out, PERCENT_BYTES, "%.*g %%", percent < 1 ? 1 : percent < 10 ? 2 : 3, percent);
}

bool size_multiply(size_t a, size_t b, size_t *product)
{
    if (b && a > SIZE_MAX / b)
        return false;
    *product = a * b;
    return true;
}

void text_add_wrapped(struct text *text, const char *words, size_t indent, size_t columns)
{
    size_t column = indent;
    while (*words) {
        size_t word = strcspn(words, " ");
        if (column + 1 + word > columns) {
            text_add(text, "\n%*s", (int)indent, "");
            column = indent;
        }
        text_add(text, "%s%.*s", column > indent ? " " : "", (int)word, words);
        column += word + (column > indent);
        words += word + strspn(words + word, " ");
    }
    text_add(text, "\n");
}

void text_add_list(struct text *text, const char *const *words, uint32_t chosen, const char *last)
{
    bool is_first = true;
    for (size_t i = 0; chosen >> i; i++) {
        const bool is_last = chosen >> i == 1;
        if (!(chosen >> i & 1u))
            continue;
        if (!is_first && is_last)
            text_add(text, " %s ", last);
        text_add(text, "%s%s", is_first || is_last ? "" : ", ", words[i]);
        is_first = false;
        if (is_last)
            return;
    }
}
