/* SPDX-License-Identifier: MIT
 *
 * The walk over headers before OpenEXR sees a file: OpenEXR allocates what a header asks for, and
 * does not name the compression it does not know. */
#include "exr_internal.h"

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstring>
#include <map>

const char *const exr_compression_names[EXR_COMPRESSIONS] = {
    "none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"};

namespace exr
{

const char *const line_order_names[3] = {"increasing", "decreasing", "random"};

namespace
{

/* By the number in the file. ratio: how many times larger than the file the pixels can be at most.
 * DEFLATE reaches 1032; PIZ a run of 256 half values in 10 bits; DWA deflates runs of 128 bytes or
 * blocks of 64 pixels. */
constexpr struct {
    int lines;
    int64_t ratio;
} compressions[10] = {
    {1, 1},     {1, 65},  {1, 1040}, {16, 1040},    {32, 520},
    {16, 1400}, {32, 12}, {32, 12},  {32, 1 << 17}, {256, 1 << 17},
};

constexpr int64_t max_axis = 65536;
constexpr int64_t max_pixels = int64_t{1} << 30;
/* The decoders of 3.1 count the bytes of a chunk in int (CVE-2026-34588). */
constexpr int64_t max_chunk_bytes = int64_t{1} << 30;
constexpr int64_t slack_bytes = 1 << 20;      /* small files may pad more than any ratio allows */
constexpr int64_t tile_slack_bytes = 1 << 25; /* a small image may lie in one tile of usual size */

constexpr uint32_t flag_tiled = 0x200, flag_non_image = 0x800, flag_multi_part = 0x1000;

struct attribute {
    std::string type;
    uint64_t offset;
    int64_t bytes;
};

using attributes = std::map<std::string, attribute>;

[[noreturn]] void raise_not_exr(input_stream &stream)
{
    static const struct {
        const char *name;
        const char *magic;
        size_t bytes;
    } formats[] = {
        {"PNG", "\x89PNG", 4}, {"JPEG", "\xff\xd8\xff", 3}, {"TIFF", "II*\0", 4},
        {"TIFF", "MM\0*", 4},  {"Radiance HDR", "#?", 2},   {"DPX", "SDPX", 4},
        {"DPX", "XPDS", 4},    {"gzip", "\x1f\x8b", 2},     {"PFM", "PF\n", 3},
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

/* The bytes that an attribute has in any file, by its type. */
const struct {
    const char *type;
    int64_t bytes;
} natural_sizes[] = {
    {"box2i", 16},
    {"box2f", 16},
    {"chromaticities", 32},
    {"compression", 1},
    {"double", 8},
    {"envmap", 1},
    {"float", 4},
    {"int", 4},
    {"keycode", 28},
    {"lineOrder", 1},
    {"m33f", 36},
    {"m33d", 72},
    {"m44f", 64},
    {"m44d", 128},
    {"rational", 8},
    {"deepImageState", 1},
    {"tiledesc", 9},
    {"timecode", 8},
    {"v2i", 8},
    {"v2f", 8},
    {"v2d", 16},
    {"v3i", 12},
    {"v3f", 12},
    {"v3d", 24},
};

/* Whether strings with their lengths in front fill the attribute to its end. */
bool is_string_vector(input_stream &stream, const attribute &a)
{
    const uint64_t end = a.offset + uint64_t(a.bytes);
    stream.seekg(a.offset);
    while (end - stream.tellg() >= 4) {
        const int64_t length = stream.get_i32();
        if (length < 0 || uint64_t(length) > end - stream.tellg())
            return false;
        stream.seekg(stream.tellg() + uint64_t(length));
    }
    return stream.tellg() == end;
}

/* Whether names with 16 bytes behind each, and an empty one, do. */
bool is_channel_list(input_stream &stream, const attribute &a)
{
    const uint64_t end = a.offset + uint64_t(a.bytes);
    stream.seekg(a.offset);
    while (stream.tellg() < end) {
        if (read_name(stream, "a channel name").empty())
            return stream.tellg() == end;
        if (stream.tellg() > end || end - stream.tellg() < 16)
            return false;
        stream.seekg(stream.tellg() + 16);
    }
    return false;
}

bool is_preview(input_stream &stream, const attribute &a)
{
    if (a.bytes < 8)
        return false;
    stream.seekg(a.offset);
    const int64_t width = uint32_t(stream.get_i32()), height = uint32_t(stream.get_i32());
    return width <= max_axis && height <= max_axis && a.bytes == 8 + 4 * width * height;
}

/* OpenEXR reads as many bytes as the type has, whatever the attribute says: after one that is
 * shorter or longer, it would take other bytes for headers than the walk. */
void check_natural_size(input_stream &stream, const std::string &name, const attribute &a)
{
    bool valid = true;
    for (const auto &natural : natural_sizes) {
        if (a.type == natural.type)
            valid = a.bytes == natural.bytes;
    }
    if (a.type == "floatvector")
        valid = a.bytes % 4 == 0;
    else if (a.type == "idmanifest")
        valid = a.bytes >= 4;
    else if (a.type == "stringvector")
        valid = is_string_vector(stream, a);
    else if (a.type == "chlist")
        valid = is_channel_list(stream, a);
    else if (a.type == "preview")
        valid = is_preview(stream, a);
    if (!valid)
        raise(EXIT_INPUT, damaged_hint,
              "%s: damaged header: attribute '%s' of %" PRId64 " bytes is not a valid %s",
              stream.fileName(), excerpt(name).c_str(), a.bytes, excerpt(a.type).c_str());
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
                  stream.fileName(), excerpt(name).c_str(), a.bytes, stream.size() - a.offset);
        if (!found.emplace(name, a).second)
            raise(EXIT_INPUT, damaged_hint, "%s: damaged header: attribute '%s' occurs twice",
                  stream.fileName(), excerpt(name).c_str());
        check_natural_size(stream, name, a);
        stream.seekg(a.offset + uint64_t(a.bytes));
    }
    return found;
}

/* Goes to the value of an attribute that every file has; bytes < 0: any size. */
void seek_required(input_stream &stream, const attributes &all, const char *name, const char *type,
                   int64_t bytes)
{
    const auto found = all.find(name);
    if (found == all.end())
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: required attribute '%s' is missing",
              stream.fileName(), name);
    if (found->second.type != type || (bytes >= 0 && found->second.bytes != bytes))
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: attribute '%s' is not a valid %s",
              stream.fileName(), name, type);
    stream.seekg(found->second.offset);
}

std::string read_string(input_stream &stream, const attributes &all, const char *name)
{
    const auto found = all.find(name);
    if (found == all.end() || found->second.type != "string")
        return "";
    if (found->second.bytes > 65536)
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: the %s of a part is too long",
              stream.fileName(), name);
    std::string text(size_t(found->second.bytes), '\0');
    stream.seekg(found->second.offset);
    stream.read(text.data(), int(text.size()));
    return text;
}

void read_compression(input_stream &stream, const attributes &all, part_layout &part)
{
    seek_required(stream, all, "compression", "compression", 1);
    part.compression = stream.get_u8();
    if (part.compression < 10) {
        part.chunk_lines = compressions[part.compression].lines;
        return;
    }
    const char *name = part.compression == 10   ? "htj2k256 "
                       : part.compression == 11 ? "htj2k32 "
                                                : "";
    raise(EXIT_INPUT, "convert it with newer tools: oiiotool IN.exr --compression zip -o OUT.exr",
          "%s: compression %s(%d) needs a newer OpenEXR; this build has %s", stream.fileName(),
          name, part.compression, exr_library_version() + strlen("OpenEXR "));
}

void read_channels(input_stream &stream, const attributes &all, part_layout &part)
{
    seek_required(stream, all, "channels", "chlist", -1);
    std::set<std::string> names;
    for (;;) {
        channel_layout c = {read_name(stream, "a channel name"), 0, 0, 0};
        if (c.name.empty())
            break; /* it ends in the attribute: is_channel_list */
        c.type = stream.get_i32();
        stream.get_i32(); /* pLinear and three reserved bytes */
        c.x_sampling = stream.get_i32();
        c.y_sampling = stream.get_i32();
        if (c.type < 0 || c.type > 2 || c.x_sampling < 1 || c.y_sampling < 1)
            raise(EXIT_INPUT, damaged_hint, "%s: damaged header: channel '%s' is invalid",
                  stream.fileName(), excerpt(c.name).c_str());
        if (!names.insert(c.name).second)
            raise(EXIT_INPUT, damaged_hint, "%s: damaged header: channel '%s' occurs twice",
                  stream.fileName(), excerpt(c.name).c_str());
        const int64_t bytes = c.type == EXR_HALF ? 2 : 4;
        part.pixel_bytes += bytes;
        part.level_bytes += divide_up(part.data.width(), c.x_sampling) *
                            divide_up(part.data.height(), c.y_sampling) * bytes;
        part.channels.push_back(c);
    }
    if (part.channels.empty())
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: a part without channels",
              stream.fileName());
}

window read_window(input_stream &stream, const attributes &all, const char *name)
{
    window w = {};
    seek_required(stream, all, name, "box2i", 16);
    w.x_min = stream.get_i32();
    w.y_min = stream.get_i32();
    w.x_max = stream.get_i32();
    w.y_max = stream.get_i32();
    if (w.width() < 1 || w.height() < 1)
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: the %s is empty", stream.fileName(),
              name);
    return w;
}

void read_windows(input_stream &stream, const attributes &all, part_layout &part)
{
    part.display = read_window(stream, all, "displayWindow");
    part.data = read_window(stream, all, "dataWindow");
    const int64_t width = part.data.width(), height = part.data.height();
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

void check_sizes(const input_stream &stream, const part_layout &part)
{
    const int64_t width = part.data.width();
    const int64_t file_bytes = int64_t(stream.size());
    if (!part.deep &&
        part.level_bytes > compressions[part.compression].ratio * file_bytes + slack_bytes)
        raise(EXIT_INPUT, damaged_hint,
              "%s: truncated or damaged: %" PRId64 " bytes cannot hold %" PRId64 "x%" PRId64
              " pixels of %" PRId64 " bytes with compression %s",
              stream.fileName(), file_bytes, width, part.data.height(), part.pixel_bytes,
              exr_compression_names[part.compression]);
    /* OpenEXR allocates whole tiles, also for images smaller than one. */
    if (part.tiled && part.chunk_bytes > 4 * part.level_bytes + tile_slack_bytes)
        raise(EXIT_INPUT, damaged_hint,
              "%s: damaged header: tiles of %" PRId64 "x%" PRId64 " for so small an image",
              stream.fileName(), part.tile_width, part.tile_height);
}

/* OpenEXR sets these when it writes a copy, and then trips over others' types. */
void check_types(const input_stream &stream, const attributes &all)
{
    static const char *const types[][2] = {
        {"name", "string"}, {"type", "string"},    {"view", "string"},
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
              excerpt(part.name).c_str(), excerpt(part.type).c_str());
    read_compression(stream, all, part);
    read_windows(stream, all, part);
    read_channels(stream, all, part);
    if (part.tiled)
        read_tiles(stream, all, part);
    const int64_t chunk_pixels =
        part.tiled ? part.tile_width * part.tile_height : part.data.width() * part.chunk_lines;
    if (chunk_pixels > max_chunk_bytes / part.pixel_bytes)
        raise(EXIT_INPUT, nullptr,
              "%s: chunks of %" PRId64 " pixels of %" PRId64
              " bytes are more than the limit of %" PRId64 " bytes",
              stream.fileName(), chunk_pixels, part.pixel_bytes, max_chunk_bytes);
    part.chunk_bytes = chunk_pixels * part.pixel_bytes;
    check_sizes(stream, part);
    part.chunk_count = count_chunks(part);
    return part;
}

} // namespace

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
                  "%s: truncated: the chunk table of part %zu has room for %" PRId64 " of %" PRId64
                  " chunks",
                  stream.fileName(), i, room, count);
        room -= count;
    }
    layout.first_chunk = check_tables(stream, layout);
    stream.seekg(0);
    return layout;
}

} // namespace exr
