/* SPDX-License-Identifier: MIT
 *
 * The walk over headers and chunk tables before OpenEXR sees a file: OpenEXR allocates what a
 * header asks for, and names neither the compression it does not know nor the chunks that are
 * missing. */
#include "exr_internal.h"

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstring>
#include <map>

namespace exr {

const char *const compression_names[10] = {"none",  "rle", "zips", "zip",  "piz",
                                           "pxr24", "b44", "b44a", "dwaa", "dwab"};
const char *const line_order_names[3] = {"increasing", "decreasing", "random"};

namespace {

/* By the number in the file. ratio: how many times larger than the file the pixels can be at most.
 * DEFLATE reaches 1032; PIZ a run of 256 half values in 10 bits; DWA deflates runs of 128 bytes or
 * blocks of 64 pixels. */
constexpr struct {
    int lines;
    int64_t ratio;
} compressions[10] = {
    {1, 1},     {1, 65},    {1, 1040}, {16, 1040},   {32, 520},
    {16, 1400}, {32, 12},   {32, 12},  {32, 1 << 17}, {256, 1 << 17},
};

constexpr int64_t max_axis = 65536;
constexpr int64_t max_pixels = int64_t{1} << 30;
/* The decoders of 3.1 count the bytes of a chunk in int (CVE-2026-34588). */
constexpr int64_t max_chunk_bytes = int64_t{1} << 30;
constexpr int64_t slack_bytes = 1 << 20; /* small files may pad more than any ratio allows */

constexpr uint32_t flag_tiled = 0x200, flag_non_image = 0x800, flag_multi_part = 0x1000;

const char *const damaged_hint = "render or copy the file again";

struct attribute {
    std::string type;
    uint64_t offset;
    int64_t bytes;
};

using attributes = std::map<std::string, attribute>;

int64_t divide_up(int64_t a, int64_t b)
{
    return (a + b - 1) / b;
}

[[noreturn]] void raise_not_exr(input_stream &stream)
{
    static const struct {
        const char *name;
        const char *magic;
        size_t bytes;
    } formats[] = {
        {"PNG", "\x89PNG", 4},      {"JPEG", "\xff\xd8\xff", 3}, {"TIFF", "II*\0", 4},
        {"TIFF", "MM\0*", 4},       {"Radiance HDR", "#?", 2},   {"DPX", "SDPX", 4},
        {"DPX", "XPDS", 4},         {"gzip", "\x1f\x8b", 2},     {"PFM", "PF\n", 3},
    };
    char bytes[4], hex[16] = "";
    const int count = int(std::min<uint64_t>(stream.size(), sizeof bytes));
    stream.seekg(0);
    stream.read(bytes, count);
    for (int i = 0; i < count; i++)
        snprintf(hex + strlen(hex), 4, i ? " %02X" : "%02X", uint8_t(bytes[i]));
    if (count == 4 && memcmp(bytes, "\0\0\0", 4) == 0)
        raise(EXIT_INPUT, damaged_hint, "%s: not an OpenEXR file (begins with zeros)",
              stream.fileName());
    for (const auto &format : formats) {
        if (size_t(count) >= format.bytes && memcmp(bytes, format.magic, format.bytes) == 0)
            raise(EXIT_INPUT, "convert it first: oiiotool IN -o OUT.exr",
                  "%s: not an OpenEXR file (first bytes %s = %s)", stream.fileName(), hex,
                  format.name);
    }
    raise(EXIT_INPUT, nullptr, "%s: not an OpenEXR file (first bytes %s)", stream.fileName(), hex);
}

std::string read_name(input_stream &stream, const char *what)
{
    std::string name;
    while (const uint8_t c = stream.get_u8()) {
        name += char(c);
        if (name.size() > 255)
            raise(EXIT_INPUT, damaged_hint, "%s: damaged header: %s is longer than 255 bytes",
                  stream.fileName(), what);
    }
    return name;
}

/* name is that of the first attribute, already read. */
attributes read_attributes(input_stream &stream, std::string name)
{
    attributes found;
    for (; !name.empty(); name = read_name(stream, "an attribute name")) {
        attribute a;
        a.type = read_name(stream, "an attribute type");
        a.bytes = stream.get_i32();
        a.offset = stream.tellg();
        if (a.bytes < 0 || uint64_t(a.bytes) > stream.size() - a.offset)
            raise(EXIT_INPUT, damaged_hint,
                  "%s: truncated or damaged: attribute '%s' claims %" PRId64
                  " bytes of the %" PRIu64 " left",
                  stream.fileName(), printable(name).c_str(), a.bytes, stream.size() - a.offset);
        stream.seekg(a.offset + uint64_t(a.bytes));
        if (!found.emplace(name, a).second)
            raise(EXIT_INPUT, damaged_hint, "%s: damaged header: attribute '%s' occurs twice",
                  stream.fileName(), printable(name).c_str());
    }
    return found;
}

/* Goes to the value of an attribute that every file has; bytes < 0: any size. */
const attribute &seek_required(input_stream &stream, const attributes &all, const char *name,
                               const char *type, int64_t bytes)
{
    const auto found = all.find(name);
    if (found == all.end())
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: required attribute '%s' is missing",
              stream.fileName(), name);
    if (found->second.type != type || (bytes >= 0 && found->second.bytes != bytes))
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: attribute '%s' is not a valid %s",
              stream.fileName(), name, type);
    stream.seekg(found->second.offset);
    return found->second;
}

std::string read_string(input_stream &stream, const attributes &all, const char *name)
{
    const auto found = all.find(name);
    if (found == all.end() || found->second.type != "string" || found->second.bytes > 65536)
        return "";
    std::string text(size_t(found->second.bytes), '\0');
    stream.seekg(found->second.offset);
    stream.read(text.data(), int(text.size()));
    return text;
}

void read_compression(input_stream &stream, const attributes &all, part_layout &part)
{
    seek_required(stream, all, "compression", "compression", 1);
    part.compression = stream.get_u8();
    if (part.compression < 10)
        return;
    const char *name = part.compression == 10 ? "htj2k256 "
                       : part.compression == 11 ? "htj2k32 "
                                                : "";
    raise(EXIT_INPUT, "convert it with newer tools: oiiotool IN.exr --compression zip -o OUT.exr",
          "%s: compression %s(%d) needs a newer OpenEXR; this build has %s", stream.fileName(),
          name, part.compression, exr_library_version() + strlen("OpenEXR "));
}

void read_channels(input_stream &stream, const attributes &all, part_layout &part)
{
    const attribute &a = seek_required(stream, all, "channels", "chlist", -1);
    const uint64_t end = a.offset + uint64_t(a.bytes);
    const int64_t width = part.x_max - part.x_min + 1, height = part.y_max - part.y_min + 1;
    while (stream.tellg() < end) {
        const std::string name = read_name(stream, "a channel name");
        if (name.empty())
            break;
        const int32_t type = stream.get_i32();
        stream.get_i32(); /* pLinear and three reserved bytes */
        const int32_t x_sampling = stream.get_i32(), y_sampling = stream.get_i32();
        if (type < 0 || type > 2 || x_sampling < 1 || y_sampling < 1 || stream.tellg() > end)
            raise(EXIT_INPUT, damaged_hint, "%s: damaged header: channel '%s' is invalid",
                  stream.fileName(), printable(name).c_str());
        const int64_t bytes = type == EXR_HALF ? 2 : 4;
        part.pixel_bytes += bytes;
        part.level_bytes += divide_up(width, x_sampling) * divide_up(height, y_sampling) * bytes;
    }
    if (part.pixel_bytes == 0)
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: a part without channels",
              stream.fileName());
}

void read_window(input_stream &stream, const attributes &all, part_layout &part)
{
    seek_required(stream, all, "dataWindow", "box2i", 16);
    part.x_min = stream.get_i32();
    part.y_min = stream.get_i32();
    part.x_max = stream.get_i32();
    part.y_max = stream.get_i32();
    const int64_t width = part.x_max - part.x_min + 1, height = part.y_max - part.y_min + 1;
    if (width < 1 || height < 1)
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: the dataWindow is empty",
              stream.fileName());
    if (width > max_axis || height > max_axis || width * height > max_pixels)
        raise(EXIT_INPUT, nullptr,
              "%s: %" PRId64 "x%" PRId64 " pixels are more than the limit of %" PRId64
              " per side and %" PRId64 " in all",
              stream.fileName(), width, height, max_axis, max_pixels);
}

void read_tiles(input_stream &stream, const attributes &all, part_layout &part)
{
    seek_required(stream, all, "tiles", "tiledesc", 9);
    part.tile_width = uint32_t(stream.get_i32());
    part.tile_height = uint32_t(stream.get_i32());
    const uint8_t mode = stream.get_u8();
    part.level_mode = mode & 15;
    part.level_rounding = mode >> 4;
    if (part.tile_width < 1 || part.tile_height < 1 || part.tile_width > max_axis ||
        part.tile_height > max_axis || part.level_mode > 2 || part.level_rounding > 1)
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: invalid tile description",
              stream.fileName());
}

/* Sizes of one axis from level 0 down to 1 pixel. */
std::vector<int64_t> level_sizes(int64_t size, const part_layout &part)
{
    std::vector<int64_t> sizes(1, size);
    while (size > 1) {
        size = part.level_rounding ? divide_up(size, 2) : size / 2;
        sizes.push_back(size);
    }
    return sizes;
}

int64_t tile_count(const part_layout &part)
{
    enum { one_level, mipmap, ripmap };
    const int64_t width = part.x_max - part.x_min + 1, height = part.y_max - part.y_min + 1;
    int64_t count = 0;
    if (part.level_mode == one_level)
        return divide_up(width, part.tile_width) * divide_up(height, part.tile_height);
    if (part.level_mode == mipmap) {
        /* As many levels as the longer axis has; the shorter one stays at 1 pixel. */
        const auto levels = level_sizes(std::max(width, height), part).size();
        auto across = level_sizes(width, part), down = level_sizes(height, part);
        across.resize(levels, 1);
        down.resize(levels, 1);
        for (size_t i = 0; i < levels; i++)
            count += divide_up(across[i], part.tile_width) * divide_up(down[i], part.tile_height);
        return count;
    }
    for (const int64_t w : level_sizes(width, part)) {
        for (const int64_t h : level_sizes(height, part))
            count += divide_up(w, part.tile_width) * divide_up(h, part.tile_height);
    }
    return count;
}

void check_sizes(const input_stream &stream, const part_layout &part)
{
    const int64_t width = part.x_max - part.x_min + 1;
    const int64_t file_bytes = int64_t(stream.size());
    if (!part.deep &&
        part.level_bytes > compressions[part.compression].ratio * file_bytes + slack_bytes)
        raise(EXIT_INPUT, damaged_hint,
              "%s: truncated or damaged: %" PRId64 " bytes cannot hold %" PRId64 "x%" PRId64
              " pixels of %" PRId64 " bytes with compression %s",
              stream.fileName(), file_bytes, width, part.y_max - part.y_min + 1, part.pixel_bytes,
              compression_names[part.compression]);
    /* OpenEXR allocates whole tiles, also for images smaller than one. */
    const int64_t chunk_pixels = part.tiled ? part.tile_width * part.tile_height
                                            : width * compressions[part.compression].lines;
    if (chunk_pixels > max_chunk_bytes / part.pixel_bytes)
        raise(EXIT_INPUT, nullptr, "%s: chunks of %" PRId64 " pixels of %" PRId64
              " bytes are more than the limit of %" PRId64 " bytes",
              stream.fileName(), chunk_pixels, part.pixel_bytes, max_chunk_bytes);
    if (part.tiled && chunk_pixels > 4 * width * (part.y_max - part.y_min + 1) + (1 << 22))
        raise(EXIT_INPUT, damaged_hint,
              "%s: damaged header: tiles of %" PRId64 "x%" PRId64 " for so small an image",
              stream.fileName(), part.tile_width, part.tile_height);
}

/* OpenEXR sets these when it writes a copy, and then trips over others' types. */
void check_types(const input_stream &stream, const attributes &all)
{
    static const char *const types[][2] = {
        {"name", "string"}, {"type", "string"},      {"view", "string"},
        {"version", "int"}, {"chunkCount", "int"},
    };
    for (const auto &pair : types) {
        const auto found = all.find(pair[0]);
        if (found != all.end() && found->second.type != pair[1])
            raise(EXIT_INPUT, damaged_hint, "%s: damaged header: attribute '%s' is not a valid %s",
                  stream.fileName(), pair[0], pair[1]);
    }
}

/* version: the flags of the file decide what a lone part is, whatever its type attribute says, as
 * in OpenEXR. */
part_layout read_part(input_stream &stream, const attributes &all, uint32_t version)
{
    part_layout part = {};
    check_types(stream, all);
    part.name = read_string(stream, all, "name");
    part.type = read_string(stream, all, "type");
    if (!(version & (flag_multi_part | flag_non_image)))
        part.type = version & flag_tiled ? "tiledimage" : "scanlineimage";
    part.tiled = part.type == "tiledimage" || part.type == "deeptile";
    part.deep = part.type == "deepscanline" || part.type == "deeptile";
    if (!part.tiled && !part.deep && part.type != "scanlineimage")
        raise(EXIT_INPUT, "convert it with a newer OpenEXR",
              "%s: part '%s' has the unknown type '%s'", stream.fileName(),
              printable(part.name).c_str(), printable(part.type).c_str());
    read_compression(stream, all, part);
    read_window(stream, all, part);
    read_channels(stream, all, part);
    if (part.tiled)
        read_tiles(stream, all, part);
    const auto preview = all.find("preview");
    if (preview != all.end() && preview->second.type == "preview") {
        stream.seekg(preview->second.offset);
        const int64_t width = uint32_t(stream.get_i32()), height = uint32_t(stream.get_i32());
        if (width > max_axis || height > max_axis ||
            preview->second.bytes != 8 + 4 * width * height)
            raise(EXIT_INPUT, damaged_hint, "%s: damaged header: invalid preview image",
                  stream.fileName());
    }
    check_sizes(stream, part);
    part.chunk_count = part.tiled ? tile_count(part)
                                  : divide_up(part.y_max - part.y_min + 1,
                                              compressions[part.compression].lines);
    return part;
}

/* The bytes of the chunk at offset; < 0 or far too many if it is damaged. */
int64_t chunk_end(input_stream &stream, const file_layout &layout, const part_layout &part,
                  uint64_t offset)
{
    const uint64_t coordinates = (layout.multi_part ? 4u : 0u) + (part.tiled ? 16u : 4u);
    const uint64_t leader = coordinates + (part.deep ? 24 : 4);
    if (offset > stream.size() || leader > stream.size() - offset)
        return -1;
    stream.seekg(offset + coordinates);
    const uint64_t limit = uint64_t(INT64_MAX) / 4;
    uint64_t bytes = 0;
    if (part.deep) {
        const uint64_t counts = stream.get_u64(), samples = stream.get_u64();
        bytes = counts > limit || samples > limit ? limit : counts + samples;
    } else {
        const int32_t size = stream.get_i32();
        if (size < 0)
            return -1;
        bytes = uint64_t(size);
    }
    return int64_t(offset + leader + bytes);
}

/* every_chunk looks at all of them. Otherwise only at the last one that begins inside the file: if
 * the end of the file is missing, that is the one which was cut. Returns the offset of the chunk
 * that lies first. */
uint64_t check_tables(input_stream &stream, const file_layout &layout, bool every_chunk)
{
    uint64_t position = layout.table_offset, data = layout.table_offset, first = UINT64_MAX;
    for (const part_layout &part : layout.parts)
        data += 8 * uint64_t(part.chunk_count); /* the sum was checked by read_layout */
    for (size_t i = 0; i < layout.parts.size(); i++) {
        const part_layout &part = layout.parts[i];
        std::vector<uint64_t> offsets(size_t(part.chunk_count));
        stream.seekg(position);
        for (uint64_t &offset : offsets)
            offset = stream.get_u64();
        position = stream.tellg();

        std::sort(offsets.begin(), offsets.end());
        const auto beyond = std::lower_bound(offsets.begin(), offsets.end(), stream.size());
        int64_t there = part.chunk_count, gaps = 0;
        int64_t end = int64_t(offsets.front());
        for (auto offset = offsets.begin(); offset != offsets.end(); ++offset) {
            bool good = *offset >= data && offset < beyond;
            if (good && (every_chunk || offset + 1 == beyond)) {
                gaps += int64_t(*offset) != end;
                end = chunk_end(stream, layout, part, *offset);
                good = end >= 0 && uint64_t(end) <= stream.size();
            }
            there -= !good;
        }
        if (there != part.chunk_count)
            raise(EXIT_INPUT, damaged_hint,
                  "%s: truncated: the chunk table of part %zu has %" PRId64 " of %" PRId64
                  " chunks",
                  stream.fileName(), i, there, part.chunk_count);
        if (every_chunk && part.tiled && !layout.multi_part && gaps)
            raise(EXIT_INPUT, "rewrite it first: oiiotool IN.exr -o OUT.exr",
                  "%s: the tiles do not follow each other; they cannot be copied",
                  stream.fileName());
        first = std::min(first, offsets.front());
    }
    return first;
}

} // namespace

void check_chunks(input_stream &stream, const file_layout &layout)
{
    check_tables(stream, layout, true);
}

file_layout read_layout(input_stream &stream)
{
    file_layout layout = {};
    if (stream.size() == 0)
        raise(EXIT_INPUT, damaged_hint, "%s: empty file", stream.fileName());
    if (stream.size() < 4 || stream.get_i32() != 20000630)
        raise_not_exr(stream);
    const uint32_t version = uint32_t(stream.get_i32());
    if ((version & 0xff) != 2)
        raise(EXIT_INPUT, nullptr, "%s: OpenEXR file format version %" PRIu32 " is not supported",
              stream.fileName(), version & 0xff);
    layout.multi_part = version & flag_multi_part;

    do {
        const std::string name = read_name(stream, "an attribute name");
        if (name.empty() && !layout.parts.empty())
            break;
        const attributes all = read_attributes(stream, name);
        const uint64_t end = stream.tellg();
        layout.parts.push_back(read_part(stream, all, version));
        stream.seekg(end);
    } while (layout.multi_part);
    layout.table_offset = stream.tellg();

    int64_t room = int64_t(stream.size() - layout.table_offset) / 8;
    for (size_t i = 0; i < layout.parts.size(); i++) {
        const int64_t count = layout.parts[i].chunk_count;
        if (count > room)
            raise(EXIT_INPUT, damaged_hint,
                  "%s: truncated: the chunk table of part %zu has room for %" PRId64
                  " of %" PRId64 " chunks",
                  stream.fileName(), i, room, count);
        room -= count;
    }
    layout.first_chunk = check_tables(stream, layout, false);
    stream.seekg(0);
    return layout;
}

} // namespace exr
