/* SPDX-License-Identifier: MIT
 *
 * What the exr_*.cpp files share. Inside, errors are C++ exceptions; at_border() turns them into a
 * tool_error at every function that C calls. */
#ifndef VKAO_TOOLS_EXR_INTERNAL_H_
#define VKAO_TOOLS_EXR_INTERNAL_H_

#include "exr_file.h"

#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartInputFile.h>

#include <sys/stat.h>

#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace exr
{

namespace Imf = OPENEXR_IMF_NAMESPACE;

struct tool_exception : std::exception {
    tool_error error = {};
};

/* hint may be NULL. */
[[noreturn]] void raise(exit_code code, const char *hint, const char *format, ...)
    TOOL_PRINTF(3, 4);

/* Text from a file or of OpenEXR, short enough for one line; report.c escapes it. */
std::string excerpt(const std::string &text);
/* What OpenEXR said, without the file name it likes to begin with and the full stop. */
std::string library_message(const std::exception &error);

/* Runs f; whatever it throws is put into *err, OpenEXR's own complaints as `path: what: complaint`
 * with this code. */
template <typename F>
bool at_border(tool_error *err, exit_code code, const char *path, const char *what, F &&f)
{
    try {
        f();
        return true;
    } catch (const tool_exception &e) {
        fail(err, exit_code(e.error.code), "%s", e.error.message);
        if (e.error.hint[0])
            fail_hint(err, "%s", e.error.hint);
    } catch (const std::bad_alloc &) {
        fail(err, EXIT_MEMORY, "%s: out of memory", path);
    } catch (const std::exception &e) {
        fail(err, code, "%s: %s: %s", path, what, library_message(e).c_str());
    } catch (...) {
        fail(err, code, "%s: %s: unknown exception", path, what);
    }
    return false;
}

/* A regular file, opened once for both the checks here and OpenEXR, so that both see the same file
 * even if it is replaced meanwhile. shown: what messages call it, if not path. */
class input_stream : public Imf::IStream
{
public:
    explicit input_stream(const char *path, const char *shown = nullptr);
    ~input_stream() override;
    bool read(char data[], int bytes) override;
    void read_all(char data[], size_t bytes);
    uint64_t tellg() override;
    void seekg(uint64_t position) override;
    uint64_t size() const
    {
        return size_;
    }
    /* Refuses a file that somebody has written to since it was opened: what was learned from it
     * then may not hold for what is read now. */
    void check_unchanged() const;
    /* From now on these bytes are read there instead of the file's own. */
    void patch(uint64_t position, std::vector<char> bytes);
    bool is_patched() const
    {
        return !patch_.empty();
    }
    /* Little-endian, as everything in the format. */
    uint8_t get_u8();
    int32_t get_i32();
    uint64_t get_u64();

private:
    FILE *file_ = nullptr;
    uint64_t size_ = 0, position_ = 0;
    timespec modified_ = {};
    uint64_t patch_at_ = 0;
    std::vector<char> patch_;
};

struct channel_layout {
    std::string name;
    int32_t type, x_sampling, y_sampling;
};

/* Whole numbers are 64 bits wide, so that no difference of two of them overflows. */
struct window {
    int64_t x_min, y_min, x_max, y_max;
    int64_t width() const
    {
        return x_max - x_min + 1;
    }
    int64_t height() const
    {
        return y_max - y_min + 1;
    }
};

struct part_layout {
    std::string name, type;
    bool tiled, deep;
    int compression;
    window data, display;
    std::vector<channel_layout> channels; /* in the order of the file */
    int64_t tile_width, tile_height;
    int level_mode, level_rounding;
    int64_t pixel_bytes; /* of one pixel that has all channels */
    int64_t level_bytes; /* decoded size of level 0, less what subsampling saves; 0 if deep */
    int64_t chunk_count;
    int64_t chunk_lines; /* without tiles */
    /* Decoded bytes of the largest chunk: lines, or a tile with all that lies beyond the image. */
    int64_t chunk_bytes;
};

/* Where things are in a file, found by a walk of our own over the headers. */
struct file_layout {
    bool multi_part;
    uint64_t table_offset; /* of the first chunk table */
    uint64_t first_chunk;  /* offset of the chunk that lies first */
    std::vector<part_layout> parts;
};

/* Refuses what is not an OpenEXR file, what the library would not understand, whose sizes are
 * absurd for its length, or that ends early, before OpenEXR allocates anything for it. */
file_layout read_layout(input_stream &stream);
/* By the header: chunk_count. */
int64_t count_chunks(const part_layout &part);
/* Of a file whose end is missing, the chunk that lies last is the one which was cut: so that one is
 * looked at, and of the others only where they begin. Tables of zeros, which writers leave that
 * ended before they filled them in, are made anew if all chunks are there: the stream is then
 * patched. Returns the offset of the chunk that lies first. */
uint64_t check_tables(input_stream &stream, const file_layout &layout);
/* Checks that every chunk lies inside the file and is the one that its place in the table wants.
 * OpenEXR does neither before it makes raw copies. Tiles must also lie as it expects them. */
void check_chunks(input_stream &stream, const file_layout &layout);
/* Checks that the chunks of the largest level of a flat part decode to as many bytes as they have
 * pixels. OpenEXR 3.1 takes what is missing from memory that it never wrote. */
void check_decoded(input_stream &stream, const file_layout &layout, size_t part);
/* Checks that part `part` of both files has the same chunks, byte for byte. Both passed
 * check_chunks. */
void check_same_chunks(input_stream &a, const file_layout &a_layout, input_stream &b,
                       const file_layout &b_layout, size_t part);

} // namespace exr

/* An open file, and its layout as found by the walk. */
struct exr_input {
    explicit exr_input(const char *path, const char *shown = nullptr);
    exr::input_stream stream;
    exr::file_layout layout;
    std::set<size_t> decoded; /* parts that passed check_decoded */
    /* OpenEXR's view of the file, made anew: a part of one cannot be both read and copied. Whatever
     * it understands differently from the walk is an error: sizes that come from the layout then
     * hold for what OpenEXR does. */
    std::unique_ptr<exr::Imf::MultiPartInputFile> open();
    /* Of OpenEXR. Each takes buffers for two chunks: no more of them than chunks to decode. */
    int useful_threads() const;
};

namespace exr
{

/* Tells OpenEXR our own limits; cheap when repeated. */
void set_limits();

inline int64_t divide_up(int64_t a, int64_t b)
{
    return (a + b - 1) / b;
}

extern const char *const damaged_hint;
extern const char *const line_order_names[3];

} // namespace exr

#endif
