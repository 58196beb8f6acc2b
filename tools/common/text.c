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
