/* SPDX-License-Identifier: MIT
 *
 * The walk over headers and chunk tables before OpenEXR sees a file: OpenEXR allocates what a
 * header asks for, and names neither the compression it does not know nor the chunks that are
 * missing. */
#include "exr_internal.h"

#include <IlmThreadPool.h>
#include <zlib.h>

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
constexpr int64_t tile_slack_bytes = 1 << 25; /* a small image may lie in one tile of usual size */

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

/* The bytes that an attribute has in any file, by its type. */
const struct {
    const char *type;
    int64_t bytes;
} natural_sizes[] = {
    {"box2i", 16},   {"box2f", 16},      {"chromaticities", 32}, {"compression", 1},
    {"double", 8},   {"envmap", 1},      {"float", 4},           {"int", 4},
    {"keycode", 28}, {"lineOrder", 1},   {"m33f", 36},           {"m33d", 72},
    {"m44f", 64},    {"m44d", 128},      {"rational", 8},        {"deepImageState", 1},
    {"tiledesc", 9}, {"timecode", 8},    {"v2i", 8},             {"v2f", 8},
    {"v2d", 16},     {"v3i", 12},        {"v3f", 12},            {"v3d", 24},
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
    bool terminated = false;
    std::set<std::string> names;
    while (!terminated && stream.tellg() < end) {
        channel_layout c = {read_name(stream, "a channel name"), 0, 0, 0};
        terminated = c.name.empty();
        if (terminated)
            continue;
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
    if (!terminated || stream.tellg() != end)
        raise(EXIT_INPUT, damaged_hint, "%s: damaged header: the list of channels does not end "
                                        "where it says",
              stream.fileName());
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

struct tile_level {
    int32_t x, y; /* numbers of the level across and down */
    int64_t columns, rows;
};

/* In the order of the chunk table. */
std::vector<tile_level> tile_levels(const part_layout &part)
{
    enum { one_level, mipmap, ripmap };
    auto across = level_sizes(part.data.width(), part), down = level_sizes(part.data.height(), part);
    std::vector<tile_level> levels;
    const auto add = [&](size_t x, size_t y) {
        levels.push_back({int32_t(x), int32_t(y), divide_up(across[x], part.tile_width),
                          divide_up(down[y], part.tile_height)});
    };
    if (part.level_mode == one_level) {
        add(0, 0);
    } else if (part.level_mode == mipmap) {
        /* As many levels as the longer axis has; the shorter one stays at 1 pixel. */
        const size_t count = std::max(across.size(), down.size());
        across.resize(count, 1);
        down.resize(count, 1);
        for (size_t i = 0; i < count; i++)
            add(i, i);
    } else {
        for (size_t y = 0; y < down.size(); y++) {
            for (size_t x = 0; x < across.size(); x++)
                add(x, y);
        }
    }
    return levels;
}

int64_t count_chunks(const part_layout &part)
{
    int64_t count = 0;
    if (!part.tiled)
        return divide_up(part.data.height(), compressions[part.compression].lines);
    for (const tile_level &level : tile_levels(part))
        count += level.columns * level.rows;
    return count;
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
              compression_names[part.compression]);
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
              excerpt(part.name).c_str(), excerpt(part.type).c_str());
    read_compression(stream, all, part);
    read_windows(stream, all, part);
    read_channels(stream, all, part);
    if (part.tiled)
        read_tiles(stream, all, part);
    const int64_t chunk_pixels =
        part.tiled ? part.tile_width * part.tile_height
                   : part.data.width() * compressions[part.compression].lines;
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

/* --- Chunks --- */

struct chunk {
    int32_t part, x, y, level_x, level_y; /* y: the first line; the rest is 0 without tiles */
    uint64_t begin, end;
    uint64_t bytes; /* of them without what stands in front */
};

/* False if there is no whole chunk at the offset. */
bool read_chunk(input_stream &stream, const file_layout &layout, const part_layout &part,
                uint64_t offset, chunk &c)
{
    const uint64_t leader =
        (layout.multi_part ? 4u : 0u) + (part.tiled ? 16u : 4u) + (part.deep ? 24u : 4u);
    c = {};
    if (offset > stream.size() || leader > stream.size() - offset)
        return false;
    stream.seekg(offset);
    if (layout.multi_part)
        c.part = stream.get_i32();
    if (part.tiled)
        c.x = stream.get_i32();
    c.y = stream.get_i32();
    if (part.tiled) {
        c.level_x = stream.get_i32();
        c.level_y = stream.get_i32();
    }
    const uint64_t room = stream.size() - offset - leader;
    uint64_t bytes = 0;
    if (part.deep) {
        const uint64_t counts = stream.get_u64(), samples = stream.get_u64();
        if (counts > room || samples > room - counts)
            return false;
        bytes = counts + samples;
    } else {
        const int32_t size = stream.get_i32();
        if (size < 0 || uint64_t(size) > room || size > part.chunk_bytes)
            return false;
        bytes = uint64_t(size);
    }
    c.begin = offset;
    c.end = offset + leader + bytes;
    c.bytes = bytes;
    return true;
}

/* Calls f(k, chunk) for the place of every chunk that the table of a part should name, in its order;
 * where it lies is left open. */
template <typename F> void each_place(const file_layout &layout, size_t index, F &&f)
{
    const part_layout &part = layout.parts[index];
    const int32_t number = layout.multi_part ? int32_t(index) : 0;
    const int64_t lines = compressions[part.compression].lines;
    size_t k = 0;
    for (int64_t i = 0; !part.tiled && i < part.chunk_count; i++)
        f(k++, chunk{number, 0, int32_t(part.data.y_min + i * lines), 0, 0, 0, 0, 0});
    if (!part.tiled)
        return;
    for (const tile_level &level : tile_levels(part)) {
        for (int64_t y = 0; y < level.rows; y++) {
            for (int64_t x = 0; x < level.columns; x++)
                f(k++, chunk{number, int32_t(x), int32_t(y), level.x, level.y, 0, 0, 0});
        }
    }
}

bool same_place(const chunk &a, const chunk &b)
{
    return a.part == b.part && a.x == b.x && a.y == b.y && a.level_x == b.level_x &&
           a.level_y == b.level_y;
}

/* The offsets of a part's chunks, as its table has them. */
std::vector<uint64_t> read_table(input_stream &stream, const file_layout &layout, size_t index)
{
    uint64_t position = layout.table_offset;
    for (size_t i = 0; i < index; i++)
        position += 8 * uint64_t(layout.parts[i].chunk_count);
    std::vector<uint64_t> offsets(size_t(layout.parts[index].chunk_count));
    stream.seekg(position);
    for (uint64_t &offset : offsets)
        offset = stream.get_u64();
    return offsets;
}

/* Offset of the first byte behind all tables. read_layout has checked that there is one. */
uint64_t first_data(const file_layout &layout)
{
    uint64_t data = layout.table_offset;
    for (const part_layout &part : layout.parts)
        data += 8 * uint64_t(part.chunk_count);
    return data;
}

/* Of a file whose end is missing, the chunk that lies last is the one which was cut: so that one is
 * looked at, and of the others only where they begin. Returns the offset of the chunk that lies
 * first. */
uint64_t check_tables(input_stream &stream, const file_layout &layout)
{
    const uint64_t data = first_data(layout);
    uint64_t first = UINT64_MAX;
    for (size_t i = 0; i < layout.parts.size(); i++) {
        const std::vector<uint64_t> offsets = read_table(stream, layout, i);
        int64_t there = 0;
        uint64_t last = 0;
        chunk c;
        for (const uint64_t offset : offsets) {
            const bool inside = offset >= data && offset < stream.size();
            there += inside;
            first = std::min(first, offset);
            last = inside ? std::max(last, offset) : last;
        }
        if (there > 0 && !read_chunk(stream, layout, layout.parts[i], last, c))
            there--;
        if (there != layout.parts[i].chunk_count)
            raise(EXIT_INPUT, damaged_hint,
                  "%s: truncated: the chunk table of part %zu has %" PRId64 " of %" PRId64
                  " chunks",
                  stream.fileName(), i, there, layout.parts[i].chunk_count);
    }
    return first;
}

/* Multiples of step from first to last. */
int64_t count_multiples(int64_t first, int64_t last, int64_t step)
{
    const auto below = [step](int64_t x) { return x >= 0 ? x / step : -divide_up(-x, step); };
    return below(last) - below(first - 1);
}

/* What the pixels of a chunk of level 0 take when decoded. */
int64_t decoded_bytes(const part_layout &part, const chunk &place)
{
    const window &w = part.data;
    const int64_t x = w.x_min + place.x * part.tile_width;
    const int64_t y = part.tiled ? w.y_min + place.y * part.tile_height : place.y;
    const int64_t lines = part.tiled ? part.tile_height : compressions[part.compression].lines;
    const int64_t x_end = part.tiled ? std::min(x + part.tile_width - 1, w.x_max) : w.x_max;
    const int64_t y_end = std::min(y + lines - 1, w.y_max);
    int64_t bytes = 0;
    for (const channel_layout &c : part.channels)
        bytes += count_multiples(x, x_end, c.x_sampling) * count_multiples(y, y_end, c.y_sampling) *
                 (c.type == EXR_HALF ? 2 : 4);
    return bytes;
}

int64_t count_inflated(const std::vector<char> &data)
{
    unsigned char scratch[32768];
    z_stream z = {};
    if (inflateInit(&z) != Z_OK)
        return -1;
    z.next_in = reinterpret_cast<unsigned char *>(const_cast<char *>(data.data()));
    z.avail_in = unsigned(data.size());
    int result = Z_OK;
    while (result == Z_OK) {
        z.next_out = scratch;
        z.avail_out = sizeof scratch;
        result = inflate(&z, Z_NO_FLUSH);
    }
    const int64_t count = result == Z_STREAM_END ? int64_t(z.total_out) : -1;
    inflateEnd(&z);
    return count;
}

/* A negative count is followed by as many bytes, another by one byte for count + 1. */
int64_t count_runs(const std::vector<char> &data)
{
    int64_t count = 0;
    for (size_t i = 0; i < data.size();) {
        const int run = static_cast<signed char>(data[i]);
        count += run < 0 ? -run : run + 1;
        i += run < 0 ? size_t(1 - run) : 2;
    }
    return count;
}

struct count_task : IlmThread::Task {
    count_task(IlmThread::TaskGroup *group, std::vector<char> bytes, bool runs, int64_t &to)
        : Task(group), data(std::move(bytes)), is_runs(runs), count(to)
    {
    }
    void execute() override { count = is_runs ? count_runs(data) : count_inflated(data); }
    std::vector<char> data;
    bool is_runs;
    int64_t &count;
};

} // namespace

/* OpenEXR leaves what is missing as it was in its buffers: other pixels, or whatever else was in that
 * memory. The decoders that are not counted here find out themselves, but for no bytes at all. */
void check_decoded(input_stream &stream, const file_layout &layout, size_t index)
{
    constexpr size_t most_at_once = 256; /* chunks in memory, as they are in the file */
    enum { none, rle, zips, zip };
    const part_layout &part = layout.parts[index];
    const std::vector<uint64_t> offsets = read_table(stream, layout, index);
    std::vector<std::pair<size_t, chunk>> places;
    each_place(layout, index, [&](size_t k, const chunk &place) {
        if (place.level_x == 0 && place.level_y == 0)
            places.emplace_back(k, place);
    });
    for (size_t first = 0; first < places.size(); first += most_at_once) {
        const size_t count = std::min(most_at_once, places.size() - first);
        std::vector<int64_t> counts(count, -1), wants(count);
        {
            IlmThread::TaskGroup group; /* waits at its end */
            for (size_t i = 0; i < count; i++) {
                const auto &[k, place] = places[first + i];
                chunk c;
                wants[i] = decoded_bytes(part, place);
                if (!read_chunk(stream, layout, part, offsets[k], c) || !same_place(c, place))
                    continue;
                counts[i] = int64_t(c.bytes);
                /* As they are, if coding would have made them more. */
                if (counts[i] >= wants[i] || counts[i] == 0 || part.compression == none)
                    continue;
                counts[i] = wants[i];
                if (part.compression > zip)
                    continue;
                std::vector<char> data(size_t(c.bytes));
                stream.seekg(c.end - c.bytes);
                stream.read_all(data.data(), data.size());
                IlmThread::ThreadPool::addGlobalTask(new count_task(
                    &group, std::move(data), part.compression == rle, counts[i]));
            }
        }
        for (size_t i = 0; i < count; i++) {
            if (counts[i] < wants[i])
                raise(EXIT_INPUT, damaged_hint,
                      "%s: damaged: chunk %zu of part %zu does not hold the pixels that it should",
                      stream.fileName(), places[first + i].first, index);
        }
    }
}

void check_chunks(input_stream &stream, const file_layout &layout)
{
    for (size_t i = 0; i < layout.parts.size(); i++) {
        const part_layout &part = layout.parts[i];
        const std::vector<uint64_t> offsets = read_table(stream, layout, i);
        /* Tiles of a lone part are copied from wherever the stream is, in the order of the file. */
        const bool in_file_order = part.tiled && !layout.multi_part;
        std::vector<std::pair<uint64_t, uint64_t>> spans;
        each_place(layout, i, [&](size_t k, const chunk &place) {
            chunk c;
            if (!read_chunk(stream, layout, part, offsets[k], c))
                raise(EXIT_INPUT, damaged_hint, "%s: damaged: chunk %zu of part %zu is not whole",
                      stream.fileName(), k, i);
            if (!same_place(c, place))
                raise(EXIT_INPUT, damaged_hint,
                      "%s: damaged: chunk %zu of part %zu says that it belongs elsewhere",
                      stream.fileName(), k, i);
            if (in_file_order)
                spans.emplace_back(c.begin, c.end);
        });
        std::sort(spans.begin(), spans.end());
        for (size_t k = 1; k < spans.size(); k++) {
            if (spans[k].first != spans[k - 1].second)
                raise(EXIT_INPUT, "rewrite it first: oiiotool IN.exr -o OUT.exr",
                      "%s: the tiles do not follow each other; they cannot be copied",
                      stream.fileName());
        }
    }
}

void check_same_chunks(input_stream &a, const file_layout &a_layout, input_stream &b,
                       const file_layout &b_layout, size_t part)
{
    const std::vector<uint64_t> from = read_table(a, a_layout, part);
    const std::vector<uint64_t> to = read_table(b, b_layout, part);
    std::vector<char> bytes, copy;
    bool same = from.size() == to.size();
    for (size_t k = 0; same && k < from.size(); k++) {
        chunk c, d;
        same = read_chunk(a, a_layout, a_layout.parts[part], from[k], c) &&
               read_chunk(b, b_layout, b_layout.parts[part], to[k], d);
        /* What follows the part number, which a lone part does not have. */
        const uint64_t skip_c = a_layout.multi_part ? 4 : 0, skip_d = b_layout.multi_part ? 4 : 0;
        same = same && c.end - c.begin - skip_c == d.end - d.begin - skip_d;
        if (!same)
            break;
        bytes.resize(size_t(c.end - c.begin - skip_c));
        copy.resize(bytes.size());
        a.seekg(c.begin + skip_c);
        a.read_all(bytes.data(), bytes.size());
        b.seekg(d.begin + skip_d);
        b.read_all(copy.data(), copy.size());
        same = bytes == copy;
    }
    if (!same)
        raise(EXIT_OUTPUT, nullptr, "%s: part %zu was not copied as it is", b.fileName(), part);
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
    layout.first_chunk = check_tables(stream, layout);
    stream.seekg(0);
    return layout;
}

} // namespace exr
