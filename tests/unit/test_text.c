/* SPDX-License-Identifier: MIT
 *
 * What a terminal or a JSON parser sees of strings that anybody may have written. */
#include "json_text.h"
#include "text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* --- What is allowed, said in another way than in text.c --- */

struct range {
    unsigned char low, high;
};

/* Table 3-7 of the Unicode Standard: well-formed byte sequences. */
static const struct {
    size_t length;
    struct range bytes[4];
} well_formed[] = {
    {1, {{0x00, 0x7f}}},
    {2, {{0xc2, 0xdf}, {0x80, 0xbf}}},
    {3, {{0xe0, 0xe0}, {0xa0, 0xbf}, {0x80, 0xbf}}},
    {3, {{0xe1, 0xec}, {0x80, 0xbf}, {0x80, 0xbf}}},
    {3, {{0xed, 0xed}, {0x80, 0x9f}, {0x80, 0xbf}}},
    {3, {{0xee, 0xef}, {0x80, 0xbf}, {0x80, 0xbf}}},
    {4, {{0xf0, 0xf0}, {0x90, 0xbf}, {0x80, 0xbf}, {0x80, 0xbf}}},
    {4, {{0xf1, 0xf3}, {0x80, 0xbf}, {0x80, 0xbf}, {0x80, 0xbf}}},
    {4, {{0xf4, 0xf4}, {0x80, 0x8f}, {0x80, 0xbf}, {0x80, 0xbf}}},
};

static size_t character_length(const unsigned char *s)
{
    for (size_t row = 0; row < sizeof well_formed / sizeof *well_formed; row++) {
        size_t i = 0;
        while (i < well_formed[row].length && s[i] >= well_formed[row].bytes[i].low &&
               s[i] <= well_formed[row].bytes[i].high)
            i++;
        if (i == well_formed[row].length)
            return i;
    }
    return 0;
}

/* By the bytes of UTF-8. */
static bool is_forbidden(const unsigned char *s)
{
    if (s[0] < 0x20 || s[0] == 0x7f || (s[0] == 0xc2 && s[1] < 0xa0))
        return true;
    if (s[0] != 0xe2 || (s[1] != 0x80 && s[1] != 0x81))
        return false;
    return s[1] == 0x80 ? s[2] >= 0xa8 && s[2] <= 0xae : s[2] >= 0xa6 && s[2] <= 0xa9;
}

static bool is_clean(const char *text)
{
    const unsigned char *s = (const unsigned char *)text;
    while (*s) {
        const size_t length = character_length(s);
        if (length == 0 || is_forbidden(s))
            return false;
        s += length;
    }
    return true;
}

static int hex_digit(char c)
{
    static const char digits[] = "0123456789abcdef";
    const char *found = c ? strchr(digits, c) : NULL;
    return found ? (int)(found - digits) : -1;
}

/* Takes the escapes back, in place. */
static void unescape(char *text)
{
    char *out = text;
    while (*text) {
        const bool escape =
            text[0] == '\\' && text[1] == 'x' && hex_digit(text[2]) >= 0 && hex_digit(text[3]) >= 0;
        *out++ = (char)(escape ? hex_digit(text[2]) << 4 | hex_digit(text[3]) : *text);
        text += escape ? 4 : 1;
    }
    *out = '\0';
}

static void check_printable(const char *string)
{
    char out[256];
    const size_t length = text_printable(out, sizeof out, string);
    if (length != strlen(out) || !is_clean(out))
        fail_msg("'%s' is not what a terminal should see", out);
    unescape(out);
    if (strcmp(out, string) != 0)
        fail_msg("the escapes of %02x %02x %02x tell another string", (unsigned char)string[0],
                 (unsigned char)string[1], (unsigned char)string[2]);
}

/* --- text_printable --- */

static void every_string_of_up_to_three_bytes_is_clean_and_told_apart(void **state)
{
    (void)state;
    for (unsigned a = 1; a < 256; a++) {
        for (unsigned b = 0; b < 256; b++) {
            for (unsigned c = 0; c < (b ? 256u : 1u); c += a < 0x80 ? 17 : 1)
                check_printable((const char[]){(char)a, (char)b, (char)c, '\0'});
        }
    }
}

static void encode(uint32_t c, char out[5])
{
    if (c < 0x80)
        snprintf(out, 5, "%c", (int)c);
    else if (c < 0x800)
        snprintf(out, 5, "%c%c", (int)(0xc0 | c >> 6), (int)(0x80 | (c & 63)));
    else if (c < 0x10000)
        snprintf(out, 5, "%c%c%c", (int)(0xe0 | c >> 12), (int)(0x80 | (c >> 6 & 63)),
                 (int)(0x80 | (c & 63)));
    else
        snprintf(out, 5, "%c%c%c%c", (int)(0xf0 | c >> 18), (int)(0x80 | (c >> 12 & 63)),
                 (int)(0x80 | (c >> 6 & 63)), (int)(0x80 | (c & 63)));
}

static void every_character_that_does_not_steer_stays_as_it_is(void **state)
{
    (void)state;
    unsigned changed = 0;
    for (uint32_t c = 1; c <= 0x1fffff; c++) {
        char in[5], out[64];
        encode(c, in);
        text_printable(out, sizeof out, in);
        const bool kept = strcmp(in, out) == 0;
        const bool legal = c <= 0x10ffff && !(c >= 0xd800 && c <= 0xdfff);
        changed += legal && !kept;
        if (!legal && kept)
            fail_msg("U+%06X is no character and stays", c);
        check_printable(in);
    }
    /* C0 without NUL, DEL and C1, U+2028, U+2029, U+202A to E, U+2066 to 9. */
    assert_int_equal(changed, 31 + 33 + 2 + 5 + 4);
}

static void escapes_are_visible_and_none_can_be_forged(void **state)
{
    (void)state;
    static const struct {
        const char *in, *out;
    } rows[] = {
        {"\x1b]0;owned\x07", "\\x1b]0;owned\\x07"},
        {"a\nb\tc\x7f", "a\\x0ab\\x09c\\x7f"},
        {"\xc2\x9b"
         "31m",
         "\\xc2\\x9b31m"},
        {"\xe2\x80\xae"
         "gpj",
         "\\xe2\\x80\\xaegpj"},
        {"caf\xe9", "caf\\xe9"},
        {"\xc0\xaf\xed\xa0\x80\xf4\x90\x80\x80", "\\xc0\\xaf\\xed\\xa0\\x80\\xf4\\x90\\x80\\x80"},
        {"\\x1b", "\\x5cx1b"},
        {"\\\\x1b", "\\\\x5cx1b"},
        {"C:\\xyz\\new \\x1", "C:\\xyz\\new \\x1"},
        {"L\xc3\xa4nge \xe6\xb7\xb1\xe5\xba\xa6 \xf0\x9f\x92\xa1",
         "L\xc3\xa4nge \xe6\xb7\xb1\xe5\xba\xa6 \xf0\x9f\x92\xa1"},
        {"", ""},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct text text = {0};
        text_add(&text, "<");
        text_add_printable(&text, rows[i].in);
        text_add(&text, ">");
        assert_int_equal(text.data[0], '<');
        assert_int_equal(text.data[text.length - 1], '>');
        text.data[text.length - 1] = '\0';
        assert_string_equal(text.data + 1, rows[i].out);
        text_free(&text);
    }
}

static void cut_text_ends_between_characters(void **state)
{
    (void)state;
    static const char in[] = "a\xc3\xa4\x1b\xf0\x9f\x92\xa1\xff";
    static const char whole[] = "a\xc3\xa4\\x1b\xf0\x9f\x92\xa1\\xff";
    for (size_t size = 0; size <= sizeof whole; size++) {
        char out[sizeof whole + 1];
        memset(out, '#', sizeof out);
        assert_int_equal(text_printable(size ? out : NULL, size, in), strlen(whole));
        assert_int_equal(out[size], '#');
        if (size == 0)
            continue;
        assert_true(strlen(out) < size && is_clean(out));
        assert_memory_equal(out, whole, strlen(out));
        const size_t length = strlen(out);
        assert_true(length == 0 || length == 1 || length == 3 || length == 7 || length == 11 ||
                    length == 15);
    }
}

/* --- JSON --- */

/* ASCII below DEL is what cJSON is trusted with. */
static void check_json(const char *string)
{
    const unsigned begun = json_begin();
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "name", string);
    char *json = json_text(root, false, begun);
    cJSON_Delete(root);
    if (!json || !is_clean(json))
        fail_msg("'%s' is not what a terminal should see", json ? json : "");
    root = cJSON_Parse(json);
    const char *parsed = cJSON_GetStringValue(cJSON_GetObjectItem(root, "name"));
    if (!parsed)
        fail_msg("'%s' is not JSON", json);
    char back[64];
    snprintf(back, sizeof back, "%s", parsed ? parsed : "");
    unescape(back);
    if (strcmp(back, string) != 0)
        fail_msg("'%s' tells another string", json);
    cJSON_Delete(root);
    free(json);
}

static void every_string_becomes_json_that_tells_it(void **state)
{
    (void)state;
    uint32_t random = 1;
    for (unsigned a = 1; a < 256; a++)
        for (unsigned b = 0; b < 256; b++)
            check_json((const char[]){(char)a, (char)b, '\0'});
    for (uint32_t c = 1; c <= 0x1fffff; c += c < 0x3000 ? 1 : 251) {
        char in[5];
        encode(c, in);
        check_json(in);
    }
    for (int i = 0; i < 200000; i++) {
        static const char letters[] = "\\\\\\xx15bu\x1b\xe2\x80\xae\xff\"\n";
        char in[8] = "";
        for (size_t k = 0; k + 1 < sizeof in; k++) {
            random = random * 1664525u + 1013904223u;
            in[k] = letters[(random >> 16) % (sizeof letters - 1)];
        }
        check_json(in);
        check_printable(in);
    }
}

static void json_keeps_characters_and_spells_those_that_steer(void **state)
{
    (void)state;
    const unsigned begun = json_begin();
    cJSON *root = cJSON_CreateArray();
    cJSON_AddItemToArray(
        root, cJSON_CreateString("\x1b\xc2\x9b\x7f\xe2\x80\xae \xc3\xa4 \xff \\xff C:\\a"));
    char *json = json_text(root, false, begun);
    assert_string_equal(json,
                        "[\"\\u001b\\u009b\\u007f\\u202e \xc3\xa4 \\\\xff \\\\x5cxff C:\\\\a\"]");
    free(json);
    cJSON_Delete(root);
}

static void paths_have_names_and_extensions(void **state)
{
    (void)state;
    assert_string_equal(text_base_name("a/b.c/d.exr"), "d.exr");
    assert_string_equal(text_base_name("d.exr"), "d.exr");
    assert_string_equal(text_base_name("a/"), "");
    assert_true(text_has_extension("a/d.ExR", ".exr"));
    assert_false(text_has_extension(".exr", ".exr"));
    assert_false(text_has_extension("d.exr.png", ".exr"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_string_of_up_to_three_bytes_is_clean_and_told_apart),
        cmocka_unit_test(every_character_that_does_not_steer_stays_as_it_is),
        cmocka_unit_test(escapes_are_visible_and_none_can_be_forged),
        cmocka_unit_test(cut_text_ends_between_characters),
        cmocka_unit_test(every_string_becomes_json_that_tells_it),
        cmocka_unit_test(json_keeps_characters_and_spells_those_that_steer),
        cmocka_unit_test(paths_have_names_and_extensions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
