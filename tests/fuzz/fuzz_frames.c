/* SPDX-License-Identifier: MIT
 *
 * A frame list and a frame pattern of any bytes. */
#include "frames.h"
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    struct frame_list list;
    struct frame_pattern pattern;
    struct tool_error err = {0};
    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    if (frame_list_parse(text, FRAME_SYNTAX_VFX, &list, &err))
        frame_list_free(&list);
    else if (err.code == EXIT_OK || !err.message[0])
        abort(); /* a refusal must say why */
    err = (struct tool_error){0};
    if (frame_pattern_parse(text, &pattern, &err)) {
        free(frame_pattern_path(&pattern, 7));
        frame_pattern_free(&pattern);
    }
    free(text);
    return 0;
}
