/* SPDX-License-Identifier: MIT
 *
 * Chunks: where the tables say that they lie, whether they are the ones that belong there, and what
 * they decode to. OpenEXR names no chunk that is missing, and makes up what one lacks. */
#include "exr_internal.h"

#include <IlmThreadPool.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstring>
#include <map>

namespace exr
{

namespace
{

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
    auto across = level_sizes(part.data.width(), part),
         down = level_sizes(part.data.height(), part);
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

/* Calls f(k, chunk) for the place of every chunk that the table of a part should name, in its
 * order; where it lies is left open. */
template <typename F> void each_place(const file_layout &layout, size_t index, F &&f)
{
    const part_layout &part = layout.parts[index];
    const int32_t number = layout.multi_part ? int32_t(index) : 0;
    const int64_t lines = part.chunk_lines;
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
    const int64_t lines = part.tiled ? part.tile_height : part.chunk_lines;
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
    void execute() override
    {
        count = is_runs ? count_runs(data) : count_inflated(data);
    }
    std::vector<char> data;
    bool is_runs;
    int64_t &count;
};

} // namespace

int64_t count_chunks(const part_layout &part)
{
    int64_t count = 0;
    if (!part.tiled)
        return divide_up(part.data.height(), part.chunk_lines);
    for (const tile_level &level : tile_levels(part))
        count += level.columns * level.rows;
    return count;
}

namespace
{

/* Where a chunk belongs: part, level, row and column. */
using place_key = std::array<int32_t, 5>;

place_key key_of(const chunk &c)
{
    return {c.part, c.level_y, c.level_x, c.y, c.x};
}

bool tables_are_zero(input_stream &stream, const file_layout &layout)
{
    for (size_t i = 0; i < layout.parts.size(); i++) {
        for (const uint64_t offset : read_table(stream, layout, i)) {
            if (offset != 0)
                return false;
        }
    }
    return true;
}

/* Chunks name their own places: a walk over all of them finds what the tables lack. Offsets that
 * are not found stay 0. */
std::vector<uint64_t> walk_chunks(input_stream &stream, const file_layout &layout)
{
    std::map<place_key, size_t> places;
    size_t count = 0;
    for (size_t i = 0; i < layout.parts.size(); i++) {
        each_place(layout, i,
                   [&](size_t k, const chunk &place) { places.emplace(key_of(place), count + k); });
        count += size_t(layout.parts[i].chunk_count);
    }
    std::vector<uint64_t> offsets(count);
    uint64_t at = first_data(layout);
    for (size_t found = 0; found < count && at + 4 <= stream.size(); found++) {
        int32_t part = 0;
        if (layout.multi_part) {
            stream.seekg(at);
            part = stream.get_i32();
        }
        chunk c;
        if (part < 0 || size_t(part) >= layout.parts.size() ||
            !read_chunk(stream, layout, layout.parts[size_t(part)], at, c))
            break;
        const auto place = places.find(key_of(c));
        if (place == places.end())
            break;
        offsets[place->second] = at;
        at = c.end;
    }
    return offsets;
}

void rebuild_tables(input_stream &stream, const file_layout &layout)
{
    std::vector<char> bytes;
    for (const uint64_t offset : walk_chunks(stream, layout)) {
        for (int i = 0; i < 8; i++)
            bytes.push_back(char(offset >> (8 * i)));
    }
    stream.patch(layout.table_offset, std::move(bytes));
}

} // namespace

uint64_t check_tables(input_stream &stream, const file_layout &layout)
{
    if (tables_are_zero(stream, layout))
        rebuild_tables(stream, layout);
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

/* OpenEXR leaves what is missing as it was in its buffers: other pixels, or whatever else was in
 * that memory. The decoders that are not counted here find out themselves, but for no bytes at
 * all. */
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
                IlmThread::ThreadPool::addGlobalTask(
                    new count_task(&group, std::move(data), part.compression == rle, counts[i]));
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

} // namespace exr
