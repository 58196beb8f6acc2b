/* SPDX-License-Identifier: MIT */
#include "cryptomatte.h"

#include "text.h"

#include <cjson/cJSON.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* --- Names --- */

static uint32_t rotate(uint32_t x, int bits)
{
    return x << bits | x >> (32 - bits);
}

static uint32_t mix(uint32_t word)
{
    return rotate(word * 0xcc9e2d51u, 15) * 0x1b873593u;
}

/* MurmurHash3_x86_32 with seed 0. */
static uint32_t hash(const char *name, size_t length)
{
    uint32_t h = 0, tail = 0;
    for (size_t i = 0; i < length; i++) {
        tail |= (uint32_t)(unsigned char)name[i] << i % 4 * 8;
        if (i % 4 < 3)
            continue;
        h = rotate(h ^ mix(tail), 13) * 5 + 0xe6546b64u;
        tail = 0;
    }
    h ^= mix(tail) ^ (uint32_t)length;
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return h ^ h >> 16;
}

/* What a name of so many bytes is stored as. */
static float id_of(const char *name, size_t length)
{
    uint32_t bits = hash(name, length);
    const uint32_t exponent = bits >> 23 & 255;
    float id;
    /* Neither denormal, which is flushed, nor infinite or no number. */
    if (exponent == 0 || exponent == 255)
        bits ^= 1u << 23;
    memcpy(&id, &bits, sizeof id);
    return id;
}

bool cryptomatte_has(const struct cryptomatte *matte, float id)
{
    for (size_t i = 0; i < matte->id_count; i++)
        if (memcmp(&matte->ids[i], &id, sizeof id) == 0)
            return true;
    return false;
}

/* --- Channels --- */

/* The text of an attribute 'cryptomatte/ID/KEY', or NULL. */
static const char *matte_attribute(const struct exr_attribute *a, const char *key)
{
    static const char prefix[] = "cryptomatte/";
    const char *end = strrchr(a->name, '/');
    return text_starts_with(a->name, prefix) && end && strcmp(end + 1, key) == 0 ? a->text : NULL;
}

/* 'CryptoObject00.R' of layer CryptoObject: what stands behind the digits and the dot, or NULL. */
static const char *component_of(const char *channel, const char *layer)
{
    const size_t length = strlen(layer);
    if (strncmp(channel, layer, length) != 0)
        return NULL;
    const size_t digits = strspn(channel + length, "0123456789");
    return digits && channel[length + digits] == '.' ? channel + length + digits + 1 : NULL;
}

static const struct exr_channel *find_channel(const struct exr_part *part, const char *name)
{
    for (size_t c = 0; c < part->channel_count; c++)
        if (strcmp(part->channels[c].name, name) == 0)
            return &part->channels[c];
    return NULL;
}

/* The pair of which a channel is the identifier. */
static void add_rank(const struct exr_part *part, size_t index, const struct exr_channel *channel,
                     const char *component, struct cryptomatte *matte)
{
    static const char *const pairs[][2] = {{"R", "G"}, {"B", "A"},       {"r", "g"},
                                           {"b", "a"}, {"red", "green"}, {"blue", "alpha"}};
    char name[512];
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        if (strcmp(component, pairs[i][0]) != 0 || matte->rank_count == CRYPTOMATTE_MAX_RANKS)
            continue;
        snprintf(name, sizeof name, "%.*s%s", (int)(strlen(channel->name) - strlen(component)),
                 channel->name, pairs[i][1]);
        const struct exr_channel *coverage = find_channel(part, name);
        if (coverage)
            matte->ranks[matte->rank_count++] = (struct cryptomatte_rank){index, channel, coverage};
    }
}

/* Channels without a layer are those of the part's name. */
static void add_layer(const struct exr_info *info, const char *view, const char *layer,
                      struct cryptomatte *matte)
{
    char whole[512];
    for (size_t p = 0; p < info->part_count; p++) {
        const struct exr_part *part = &info->parts[p];
        if (part->deep || (*view && *part->view && strcmp(part->view, view) != 0))
            continue;
        for (size_t c = 0; c < part->channel_count; c++) {
            const char *name = part->channels[c].name, *component = component_of(name, layer);
            snprintf(whole, sizeof whole, "%s.%s", part->name, name);
            if (!component && !strchr(name, '.') && component_of(whole, layer))
                component = name;
            if (component)
                add_rank(part, p, &part->channels[c], component, matte);
        }
    }
}

static bool is_known_layer(const struct exr_info *info, size_t part, size_t attribute)
{
    const char *layer = matte_attribute(&info->parts[part].attributes[attribute], "name");
    for (size_t p = 0; p <= part; p++)
        for (size_t i = 0; i < info->parts[p].attribute_count && (p < part || i < attribute); i++) {
            const char *other = matte_attribute(&info->parts[p].attributes[i], "name");
            if (other && strcmp(other, layer) == 0)
                return true;
        }
    return false;
}

static void add_layers(const struct exr_info *info, const char *view, struct cryptomatte *matte)
{
    for (size_t p = 0; p < info->part_count; p++)
        for (size_t i = 0; i < info->parts[p].attribute_count; i++) {
            const char *layer = matte_attribute(&info->parts[p].attributes[i], "name");
            if (layer && !is_known_layer(info, p, i))
                add_layer(info, view, layer, matte);
        }
}

/* --- Manifests --- */

/* What the file says is in it: whether it says so at all, whether the name is there, and some. */
struct manifest {
    bool is_there, has_name;
    struct text some;
};

/* As it is given. */
static void add_name(struct text *list, const char *name)
{
    text_add(list, "%s", list->length ? ", " : "");
    for (; *name; name++)
        text_add(list, "%s%c", *name == ',' ? "\\" : "", *name);
}

static void look_up(const struct exr_info *info, const char *name, struct manifest *m)
{
    enum { ENOUGH = 200 };
    for (size_t p = 0; p < info->part_count; p++)
        for (size_t i = 0; i < info->parts[p].attribute_count; i++) {
            const char *json = matte_attribute(&info->parts[p].attributes[i], "manifest");
            cJSON *root = json ? cJSON_Parse(json) : NULL;
            m->is_there |= root != NULL;
            for (const cJSON *item = root ? root->child : NULL; item; item = item->next) {
                m->has_name |= item->string && strcmp(item->string, name) == 0;
                if (item->string && m->some.length < ENOUGH)
                    add_name(&m->some, item->string);
            }
            cJSON_Delete(root);
        }
}

static bool check_name(const struct exr_info *info, const char *name, struct tool_error *err)
{
    struct manifest m = {0};
    look_up(info, name, &m);
    const bool ok = !m.is_there || m.has_name;
    if (!ok) {
        fail_hint(err, "there are %s", m.some.data ? m.some.data : "none");
        fail(err, EXIT_CHANNELS, "%s: no object '%s' in its Cryptomatte", info->path, name);
    }
    text_free(&m.some);
    return ok;
}

/* Up to the next comma that no backslash precedes; *at is moved there. Returns its length. */
static size_t read_name(const char **at, char *name, size_t size)
{
    size_t length = 0;
    for (; **at && **at != ','; (*at)++) {
        *at += (*at)[0] == '\\' && (*at)[1] == ',';
        if (length + 1 < size)
            name[length++] = **at;
    }
    name[length] = '\0';
    return length;
}

bool cryptomatte_find(const struct exr_info *info, const char *view, const char *names,
                      struct cryptomatte *matte, struct tool_error *err)
{
    *matte = (struct cryptomatte){0};
    add_layers(info, view, matte);
    if (matte->rank_count == 0)
        return fail(err, EXIT_CHANNELS, "%s: no Cryptomatte, which '%s%s' needs", info->path,
                    CRYPTOMATTE_PREFIX, names);
    for (size_t i = 0; i < matte->rank_count; i++)
        if (matte->ranks[i].id->type != EXR_FLOAT)
            return fail(err, EXIT_CHANNELS,
                        "%s: '%s' is not stored as 32-bit floats: the names in it are lost",
                        info->path, matte->ranks[i].id->name);
    for (const char *at = names; *at; at += *at == ',') {
        char name[512];
        const size_t length = read_name(&at, name, sizeof name);
        if (!length || matte->id_count == CRYPTOMATTE_MAX_NAMES)
            continue;
        if (!check_name(info, name, err))
            return false;
        matte->ids[matte->id_count++] = id_of(name, length);
    }
    return matte->id_count > 0 || fail(err, EXIT_CHANNELS, "%s: '%s%s' names no object", info->path,
                                       CRYPTOMATTE_PREFIX, names);
}
