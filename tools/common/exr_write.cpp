/* SPDX-License-Identifier: MIT
 *
 * Writing: new files, and copies of files with parts appended. */
#include "atomic_file.h"
#include "exr_internal.h"

#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledInputPart.h>
#include <ImfDeepTiledOutputPart.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfMatrixAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfTiledInputPart.h>
#include <ImfTiledOutputPart.h>
#include <half.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>
#include <set>

#include <unistd.h>

using namespace exr;

namespace
{

/* OpenEXR writes in crumbs and seeks back for the chunk tables, where its destructors swallow
 * errors: so the first error is kept here, and finish() tells. */
class output_stream : public Imf::OStream
{
public:
    output_stream(atomic_file &file, const char *path, bool replace)
        : Imf::OStream(path), file_(file)
    {
        if (!atomic_file_open(&file_, path, replace, &error_))
            throw_error();
    }
    void write(const char data[], int bytes) override
    {
        throw_error();
        buffer_.insert(buffer_.end(), data, data + bytes);
        if (buffer_.size() >= buffer_bytes)
            flush();
    }
    uint64_t tellp() override
    {
        return position_ + buffer_.size();
    }
    void seekp(uint64_t position) override;
    void throw_error() const
    {
        if (error_.code == EXIT_OK)
            return;
        tool_exception e;
        e.error = error_;
        throw e;
    }
    /* What is written so far can be read at this path. */
    const char *written()
    {
        flush();
        return file_.temp;
    }

private:
    static constexpr size_t buffer_bytes = 1 << 18;
    void flush();
    atomic_file &file_;
    tool_error error_ = {};
    std::vector<char> buffer_;
    uint64_t position_ = 0; /* in the file, of the buffer's first byte */
};

void output_stream::flush()
{
    throw_error();
    if (!atomic_file_write(&file_, buffer_.data(), buffer_.size(), &error_))
        throw_error();
    position_ += buffer_.size();
    buffer_.clear();
}

void output_stream::seekp(uint64_t position)
{
    flush();
    if (lseek(file_.fd, off_t(position), SEEK_SET) < 0)
        fail(&error_, EXIT_OUTPUT, "%s: cannot seek: %s", fileName(), strerror(errno));
    throw_error();
    position_ = position;
}

Imath::Box2i from_box(const exr_box &b)
{
    return {{b.x_min, b.y_min}, {b.x_max, b.y_max}};
}

/* By hand: erase of 3.1 leaks the attribute, which is as long as the file says. */
Imf::Header without(const Imf::Header &header, const char *name)
{
    Imf::Header left;
    for (auto i = header.begin(); i != header.end(); ++i) {
        if (strcmp(i.name(), name) != 0)
            left.insert(i.name(), i.attribute());
    }
    return left;
}

void insert(Imf::Header &header, const char *name, const Imf::Attribute &attribute)
{
    /* insert refuses to change the type of an attribute. */
    const auto old = header.find(name);
    if (old != header.end() && strcmp(old.attribute().typeName(), attribute.typeName()) != 0)
        header = without(header, name);
    header.insert(name, attribute);
}

/* What describes the pixels of the part it is in, and not the picture. */
bool is_structural(const char *name)
{
    static const std::set<std::string> names = {
        "channels",
        "chunkCount",
        "compression",
        "dataWindow",
        "deepImageState",
        "displayWindow",
        "dwaCompressionLevel",
        "idManifest",
        "lineOrder",
        "maxSamplesPerPixel",
        "multiView",
        "name",
        "pixelAspectRatio",
        "preview",
        "tiles",
        "type",
        "version",
        "view",
    };
    return names.count(name) || strncmp(name, "cryptomatte/", strlen("cryptomatte/")) == 0;
}

/* The format wants the parts of a file to agree on these, and on displayWindow and
 * pixelAspectRatio. */
const char *const shared_names[] = {"timeCode", "chromaticities"};

bool is_shared(const char *name)
{
    return std::any_of(std::begin(shared_names), std::end(shared_names),
                       [name](const char *shared) { return strcmp(shared, name) == 0; });
}

/* first: the header of the file's first part, NULL if this becomes the first. */
void copy_attributes(const Imf::Header *from, const Imf::Header *first, Imf::Header &to)
{
    if (from) {
        for (auto i = from->begin(); i != from->end(); ++i) {
            if (!is_structural(i.name()) && !(first && is_shared(i.name())))
                insert(to, i.name(), i.attribute());
        }
    }
    for (const char *name : shared_names) {
        if (first && first->find(name) != first->end())
            insert(to, name, first->find(name).attribute());
    }
}

Imf::Compression compression_number(const char *path, const char *name)
{
    for (int i = 0; i < int(EXR_COMPRESSIONS); i++) {
        if (strcmp(exr_compression_names[i], name) == 0)
            return Imf::Compression(i);
    }
    raise(EXIT_OUTPUT, nullptr, "%s: unknown compression '%s'", path, name);
}

Imf::Header new_header(const char *path, const exr_new_part &part, const Imf::Header *from,
                       const Imf::Header *first)
{
    const exr_box &w = part.data_window;
    if (w.x_max < w.x_min || w.y_max < w.y_min)
        raise(EXIT_OUTPUT, nullptr, "%s: the new part has an empty dataWindow", path);
    Imf::Header header(first ? first->displayWindow() : from_box(part.display_window), from_box(w),
                       first ? first->pixelAspectRatio() : part.pixel_aspect);
    copy_attributes(from, first, header);
    header.compression() = compression_number(path, part.compression);
    if (part.level > 0) {
        header.zipCompressionLevel() = std::min(int(part.level), 9);
        header.dwaCompressionLevel() = part.level;
    }
    header.setType(Imf::SCANLINEIMAGE);
    if (part.name && part.name[0])
        header.setName(part.name);
    if (part.view && part.view[0])
        header.setView(part.view);
    for (size_t i = 0; i < part.channel_count; i++)
        header.channels().insert(part.channels[i].channel,
                                 Imf::Channel(Imf::PixelType(part.channels[i].type)));
    for (size_t i = 0; i < part.string_count; i++)
        insert(header, part.strings[i].name, Imf::StringAttribute(part.strings[i].value));
    for (size_t i = 0; i < part.matrix_count; i++) {
        Imath::M44f m;
        std::copy_n(part.matrices[i].m, 16, m.getValue());
        insert(header, part.matrices[i].name, Imf::M44fAttribute(m));
    }
    return header;
}

/* A part of a single-part file may lack what a multi-part file demands. One without a name keeps
 * that: Blender, Nuke and others put the name of a part before its layers, and would call them
 * something else. */
void promote(Imf::Header &header, const part_layout &layout)
{
    header.setType(layout.type);
    if (!layout.tiled)
        /* stray ones make OpenEXR take the part for a tiled one */
        header = without(header, "tiles");
    if (!header.hasName())
        header.setName("");
}

/* copies: how many of the headers are those of a file; they may be called anything. */
void check_names(const char *path, const std::vector<Imf::Header> &headers, size_t copies)
{
    std::set<std::string> names;
    for (const Imf::Header &header : headers) {
        const bool is_new = size_t(&header - headers.data()) >= copies;
        if (is_new && (!header.hasName() || header.name().empty()))
            raise(EXIT_OUTPUT, nullptr, "%s: a part of a multi-part file needs a name", path);
        if (!names.insert(header.name()).second)
            raise(EXIT_OUTPUT, "choose another name for the new part",
                  "%s: there would be two parts named '%s'", path, excerpt(header.name()).c_str());
    }
}

/* The header whose attributes a new part takes. */
std::unique_ptr<Imf::Header> attributes_of(const exr_new_part &part)
{
    const exr_info *from = part.attributes_from;
    if (!from)
        return nullptr;
    if (part.attributes_from_part >= from->part_count)
        raise(EXIT_INPUT, nullptr, "%s: no part %zu", from->path, part.attributes_from_part);
    return std::make_unique<Imf::Header>(
        from->input->open()->header(int(part.attributes_from_part)));
}

/* What is copied: the open file, and OpenEXR's view of it. */
struct source_file {
    const exr_info &info;
    exr_input &input;
    std::unique_ptr<Imf::MultiPartInputFile> file;
    explicit source_file(const exr_info &from) : info(from), input(*from.input), file(input.open())
    {
        check_chunks(input.stream, input.layout);
    }
};

std::vector<Imf::Header> make_headers(const char *path, const source_file *source,
                                      const exr_new_part *parts, size_t count)
{
    std::vector<Imf::Header> headers;
    const size_t copies = source ? source->info.part_count : 0;
    for (size_t i = 0; i < copies; i++) {
        headers.push_back(source->file->header(int(i)));
        if (copies + count > 1)
            promote(headers.back(), source->input.layout.parts[i]);
    }
    for (size_t i = 0; i < count; i++) {
        const auto from = attributes_of(parts[i]);
        headers.push_back(
            new_header(path, parts[i], from.get(), headers.empty() ? nullptr : &headers.front()));
    }
    if (headers.empty())
        raise(EXIT_OUTPUT, nullptr, "%s: no parts to write", path);
    if (headers.size() > 1)
        check_names(path, headers, copies);
    return headers;
}

/* Compressed chunks as they are; nothing is decoded. */
void copy_part(source_file &source, Imf::MultiPartOutputFile &file, int i)
{
    const part_layout &layout = source.input.layout.parts[size_t(i)];
    /* In single-part files OpenEXR copies tiles from wherever the stream is, in the order of the
     * file. */
    source.input.stream.seekg(source.input.layout.first_chunk);
    if (layout.deep && layout.tiled) {
        Imf::DeepTiledInputPart in(*source.file, i);
        Imf::DeepTiledOutputPart(file, i).copyPixels(in);
    } else if (layout.deep) {
        Imf::DeepScanLineInputPart in(*source.file, i);
        Imf::DeepScanLineOutputPart(file, i).copyPixels(in);
    } else if (layout.tiled) {
        Imf::TiledInputPart in(*source.file, i);
        Imf::TiledOutputPart(file, i).copyPixels(in);
    } else {
        Imf::InputPart in(*source.file, i);
        Imf::OutputPart(file, i).copyPixels(in);
    }
}

uint16_t to_half(float value)
{
    /* Clamped, because an infinity in an image spreads with every filter; NaN stays NaN. */
    return Imath::half(std::clamp(value, -65504.0f, 65504.0f)).bits();
}

uint32_t to_uint(float value)
{
    if (!(value > 0.0f))
        return 0;
    return value >= 4294967040.0f ? UINT32_MAX : uint32_t(std::nearbyint(value));
}

/* OpenEXR converts on reading only: makes the pixels of one channel in lines [first, first + count)
 * of the part. */
template <typename T>
void convert(const exr_write &channel, size_t width, size_t first, size_t count, T (*to)(float),
             std::vector<char> &band)
{
    band.resize(width * count * sizeof(T));
    for (size_t i = 0; i < width * count; i++) {
        const T value = to(channel.values[(first * width + i) * channel.stride]);
        memcpy(&band[i * sizeof(T)], &value, sizeof(T));
    }
}

/* Lines that are written and read back at once: a multiple of the lines per chunk of every
 * compression. */
constexpr size_t band_lines = 256;

struct band {
    size_t first, lines; /* of the part */
    Imath::Box2i window;
};

template <typename F> void each_band(const exr_new_part &part, F &&f)
{
    const exr_box &w = part.data_window;
    const size_t height = size_t(int64_t{w.y_max} - w.y_min + 1);
    for (size_t first = 0; first < height; first += band_lines) {
        const size_t lines = std::min(band_lines, height - first);
        const int y = w.y_min + int(first);
        f(band{first, lines, {{w.x_min, y}, {w.x_max, y + int(lines) - 1}}});
    }
}

size_t width_of(const exr_new_part &part)
{
    return size_t(int64_t{part.data_window.x_max} - part.data_window.x_min + 1);
}

void write_part(const exr_new_part &part, Imf::MultiPartOutputFile &file, int index)
{
    const size_t width = width_of(part);
    std::vector<std::vector<char>> bands(part.channel_count);
    Imf::OutputPart out(file, index);
    each_band(part, [&](const band &b) {
        Imf::FrameBuffer frame;
        for (size_t i = 0; i < part.channel_count; i++) {
            const exr_write &channel = part.channels[i];
            const void *pixels = channel.values + b.first * width * channel.stride;
            size_t x_stride = channel.stride * sizeof(float);
            if (channel.type == EXR_HALF) {
                convert(channel, width, b.first, b.lines, to_half, bands[i]);
                x_stride = sizeof(uint16_t);
            } else if (channel.type == EXR_UINT) {
                convert(channel, width, b.first, b.lines, to_uint, bands[i]);
                x_stride = sizeof(uint32_t);
            }
            if (channel.type != EXR_FLOAT)
                pixels = bands[i].data();
            frame.insert(channel.channel, Imf::Slice::Make(Imf::PixelType(channel.type), pixels,
                                                           b.window, x_stride, x_stride * width));
        }
        out.setFrameBuffer(frame);
        out.writePixels(int(b.lines));
    });
}

void write_parts(output_stream &stream, source_file *source,
                 const std::vector<Imf::Header> &headers, const exr_new_part *parts, size_t count)
{
    Imf::MultiPartOutputFile file(stream, headers.data(), int(headers.size()), false,
                                  Imf::globalThreadCount());
    const int copies = int(headers.size() - count);
    for (int i = 0; i < copies; i++) {
        try {
            copy_part(*source, file, i);
        } catch (const Iex::BaseExc &e) {
            stream.throw_error();
            raise(EXIT_INPUT, damaged_hint, "%s: damaged: cannot copy part %d: %s",
                  source->info.path, i, library_message(e).c_str());
        }
    }
    for (size_t i = 0; i < count; i++)
        write_part(parts[i], file, copies + int(i));
}

/* --- Reading back --- */

/* Whether float values of this type come back bit for bit. */
bool is_lossless(const char *compression, exr_pixel_type type)
{
    static const std::set<std::string> always = {"none", "rle", "zips", "zip", "piz"};
    return always.count(compression) || (type != EXR_FLOAT && strcmp(compression, "pxr24") == 0);
}

/* The bits that a value has in the file. */
uint32_t stored_bits(exr_pixel_type type, float value)
{
    uint32_t bits;
    if (type == EXR_HALF)
        return to_half(value);
    if (type == EXR_UINT)
        return to_uint(value);
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

void check_band(const exr_new_part &part, const exr_write &channel, const band &b,
                const std::vector<char> &pixels, const char *path)
{
    const size_t width = width_of(part), bytes = channel.type == EXR_HALF ? 2 : 4;
    if (!is_lossless(part.compression, channel.type))
        return;
    for (size_t i = 0; i < width * b.lines; i++) {
        /* of a half the first two bytes: the format's machines are little-endian */
        uint32_t bits = 0;
        memcpy(&bits, &pixels[i * bytes], bytes);
        const float value = channel.values[(b.first * width + i) * channel.stride];
        if (bits != stored_bits(channel.type, value))
            raise(EXIT_OUTPUT, nullptr, "%s: pixels of channel '%s' did not come back as written",
                  path, channel.channel);
    }
}

void check_part(const exr_new_part &part, Imf::MultiPartInputFile &file, int index,
                const char *path)
{
    const size_t width = width_of(part);
    std::vector<std::vector<char>> pixels(part.channel_count);
    Imf::InputPart in(file, index);
    each_band(part, [&](const band &b) {
        Imf::FrameBuffer frame;
        for (size_t i = 0; i < part.channel_count; i++) {
            const exr_write &channel = part.channels[i];
            const size_t bytes = channel.type == EXR_HALF ? 2 : 4;
            pixels[i].assign(width * b.lines * bytes, 0);
            frame.insert(channel.channel,
                         Imf::Slice::Make(Imf::PixelType(channel.type), pixels[i].data(), b.window,
                                          bytes, bytes * width));
        }
        in.setFrameBuffer(frame);
        in.readPixels(b.window.min.y, b.window.max.y);
        for (size_t i = 0; i < part.channel_count; i++)
            check_band(part, part.channels[i], b, pixels[i], path);
    });
}

/* Before anybody sees the file: it opens, its copies are those of the source, and its new parts
 * decode. */
void check_written(const char *path, const char *written, source_file *source,
                   const exr_new_part *parts, size_t count)
{
    exr_input back(written, path);
    const auto file = back.open();
    const size_t copies = source ? source->info.part_count : 0;
    if (back.layout.parts.size() != copies + count)
        raise(EXIT_OUTPUT, nullptr, "%s: has %zu parts when read back, want %zu", path,
              back.layout.parts.size(), copies + count);
    check_chunks(back.stream, back.layout);
    for (size_t i = 0; i < copies; i++)
        check_same_chunks(source->input.stream, source->input.layout, back.stream, back.layout, i);
    for (size_t i = 0; i < count; i++)
        check_part(parts[i], *file, int(copies + i), path);
}

void write_file(atomic_file &file, const char *path, const exr_info *copy_from,
                const exr_new_part *parts, size_t count, bool replace)
{
    std::unique_ptr<source_file> source;
    if (copy_from)
        source = std::make_unique<source_file>(*copy_from);
    const std::vector<Imf::Header> headers = make_headers(path, source.get(), parts, count);
    output_stream stream(file, path, replace);
    try {
        write_parts(stream, source.get(), headers, parts, count);
    } catch (const tool_exception &) {
        throw;
    } catch (const Iex::BaseExc &) {
        stream.throw_error(); /* OpenEXR's wrapping of it has lost the reason */
        throw;
    }
    const char *written = stream.written();
    try {
        check_written(path, written, source.get(), parts, count);
    } catch (const tool_exception &e) {
        raise(EXIT_OUTPUT, "the disk or its memory may be at fault: nothing was left behind",
              "%s: what was written cannot be read back: %s", path, e.error.message);
    }
    if (source)
        source->input.stream.check_unchanged();
}

} // namespace

bool exr_prepare_file(struct atomic_file *file, const char *path, const struct exr_info *copy_from,
                      const struct exr_new_part *parts, size_t count, bool replace,
                      struct tool_error *err)
{
    set_limits();
    const bool ok = at_border(err, EXIT_OUTPUT, path, "cannot write",
                              [&] { write_file(*file, path, copy_from, parts, count, replace); });
    if (!ok)
        atomic_file_abort(file);
    return ok;
}

bool exr_write_file(const char *path, const struct exr_info *copy_from,
                    const struct exr_new_part *parts, size_t count, bool replace,
                    struct tool_error *err)
{
    atomic_file file = {};
    return exr_prepare_file(&file, path, copy_from, parts, count, replace, err) &&
           atomic_file_commit(&file, err);
}
