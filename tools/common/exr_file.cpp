/* SPDX-License-Identifier: MIT
 *
 * Opening and reading: the C functions for headers and pixels. */
#include "exr_internal.h"

#include <Iex.h>
#include <ImfBoxAttribute.h>
#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfStringVectorAttribute.h>
#include <ImfThreading.h>
#include <ImfVecAttribute.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <unistd.h>

using namespace exr;

/* --- Opening --- */

namespace
{

bool same_window(const Imath::Box2i &box, const window &w)
{
    return box.min.x == w.x_min && box.min.y == w.y_min && box.max.x == w.x_max &&
           box.max.y == w.y_max;
}

bool same_channels(const Imf::ChannelList &list, const std::vector<channel_layout> &channels)
{
    size_t count = 0;
    for (auto i = list.begin(); i != list.end(); ++i)
        count++;
    for (const channel_layout &c : channels) {
        const Imf::Channel *other = list.findChannel(c.name.c_str());
        if (!other || int(other->type) != c.type || other->xSampling != c.x_sampling ||
            other->ySampling != c.y_sampling)
            return false;
    }
    return count == channels.size();
}

bool same_tiles(const Imf::Header &header, const part_layout &part)
{
    if (!part.tiled)
        return true;
    if (!header.hasTileDescription())
        return false;
    const Imf::TileDescription &t = header.tileDescription();
    return t.xSize == part.tile_width && t.ySize == part.tile_height &&
           int(t.mode) == part.level_mode && int(t.roundingMode) == part.level_rounding;
}

/* What OpenEXR understood differently from the walk; NULL if nothing. */
const char *find_difference(const Imf::Header &header, const part_layout &part)
{
    if (!same_window(header.dataWindow(), part.data))
        return "data window";
    if (!same_window(header.displayWindow(), part.display))
        return "display window";
    if (int(header.compression()) != part.compression)
        return "compression";
    if (header.hasType() && header.type() != part.type)
        return "type";
    if (header.hasName() && header.name() != part.name)
        return "name";
    if (!same_channels(header.channels(), part.channels))
        return "channels";
    return same_tiles(header, part) ? nullptr : "tiles";
}

/* No header may make the two disagree: a fuzzer stops here. Anybody else is told that the file is
 * damaged, which it is. */
[[noreturn]] void disagree(const input_stream &stream, size_t part, const char *what)
{
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
    fprintf(stderr, "two readings of the headers disagree: part %zu: %s\n", part, what);
    abort();
#endif
    raise(EXIT_INPUT, damaged_hint, "%s: damaged header: two readings of part %zu disagree: %s",
          stream.fileName(), part, what);
}

} // namespace

exr_input::exr_input(const char *path, const char *shown)
    : stream(path, shown), layout(exr::read_layout(stream))
{
}

int exr_input::useful_threads() const
{
    int64_t most = 1;
    for (const exr::part_layout &part : layout.parts)
        most = std::max(most, part.chunk_count);
    return int(std::min(int64_t{exr::Imf::globalThreadCount()}, most));
}

/* No reconstruction: OpenEXR would search an unfinished file for chunks, and we would show an image
 * with holes. */
std::unique_ptr<exr::Imf::MultiPartInputFile> exr_input::open()
{
    try {
        stream.check_unchanged();
        stream.seekg(0);
        auto file = std::make_unique<Imf::MultiPartInputFile>(stream, useful_threads(), false);
        stream.check_unchanged();
        if (file->parts() != int(layout.parts.size()))
            disagree(stream, 0, "number of parts");
        for (int i = 0; i < file->parts(); i++) {
            const char *difference = find_difference(file->header(i), layout.parts[size_t(i)]);
            if (difference)
                disagree(stream, size_t(i), difference);
            if (!file->partComplete(i))
                raise(EXIT_INPUT, damaged_hint, "%s: truncated: part %d lacks chunks",
                      stream.fileName(), i);
        }
        return file;
    } catch (const Iex::BaseExc &e) {
        raise(EXIT_INPUT, damaged_hint, "%s: damaged: %s", stream.fileName(),
              library_message(e).c_str());
    }
}

/* --- Reading --- */

namespace
{

template <typename T> T *allocate(size_t count)
{
    void *memory = calloc(count ? count : 1, sizeof(T));
    if (!memory)
        throw std::bad_alloc();
    return static_cast<T *>(memory);
}

char *copy_string(const std::string &text)
{
    char *copy = allocate<char>(text.size() + 1);
    memcpy(copy, text.c_str(), text.size() + 1);
    return copy;
}

void set_numbers(exr_attribute &out, const double *values, size_t count)
{
    out.numbers = allocate<double>(count);
    memcpy(out.numbers, values, count * sizeof *values);
    out.number_count = count;
}

/* One function per shape of attribute: true if it was that. */
template <typename T> bool scalar(const Imf::Attribute &attribute, exr_attribute &out)
{
    const auto *typed = dynamic_cast<const Imf::TypedAttribute<T> *>(&attribute);
    if (typed) {
        const double value = double(typed->value());
        set_numbers(out, &value, 1);
    }
    return typed;
}

template <typename T> bool vec(const Imf::Attribute &attribute, exr_attribute &out)
{
    const auto *typed = dynamic_cast<const Imf::TypedAttribute<T> *>(&attribute);
    if (typed) {
        double values[4];
        for (unsigned i = 0; i < T::dimensions(); i++)
            values[i] = double(typed->value()[int(i)]);
        set_numbers(out, values, T::dimensions());
    }
    return typed;
}

template <typename T> bool matrix(const Imf::Attribute &attribute, exr_attribute &out)
{
    const auto *typed = dynamic_cast<const Imf::TypedAttribute<T> *>(&attribute);
    if (typed) {
        const unsigned n = T::dimensions();
        double values[16];
        for (unsigned i = 0; i < n * n; i++)
            values[i] = double(typed->value().x[i / n][i % n]);
        set_numbers(out, values, n * n);
    }
    return typed;
}

template <typename T> bool box(const Imf::Attribute &attribute, exr_attribute &out)
{
    const auto *typed = dynamic_cast<const Imf::TypedAttribute<T> *>(&attribute);
    if (typed) {
        const T &b = typed->value();
        const double values[] = {double(b.min.x), double(b.min.y), double(b.max.x),
                                 double(b.max.y)};
        set_numbers(out, values, 4);
    }
    return typed;
}

void fill_attribute(const char *name, const Imf::Attribute &attribute, exr_attribute &out)
{
    static bool (*const shapes[])(const Imf::Attribute &, exr_attribute &) = {
        scalar<int>,         scalar<float>,       scalar<double>,      vec<Imath::V2i>,
        vec<Imath::V2f>,     vec<Imath::V2d>,     vec<Imath::V3i>,     vec<Imath::V3f>,
        vec<Imath::V3d>,     matrix<Imath::M33f>, matrix<Imath::M33d>, matrix<Imath::M44f>,
        matrix<Imath::M44d>, box<Imath::Box2i>,   box<Imath::Box2f>,
    };
    out.name = copy_string(name);
    out.type = copy_string(attribute.typeName());
    const auto *text = dynamic_cast<const Imf::StringAttribute *>(&attribute);
    if (text) {
        out.text = copy_string(text->value());
        return;
    }
    for (const auto &shape : shapes) {
        if (shape(attribute, out))
            return;
    }
}

exr_box to_box(const window &w)
{
    return {int32_t(w.x_min), int32_t(w.y_min), int32_t(w.x_max), int32_t(w.y_max)};
}

void fill_channels(const Imf::ChannelList &channels, exr_part &part)
{
    size_t count = 0;
    for (auto i = channels.begin(); i != channels.end(); ++i)
        count++;
    part.channels = allocate<exr_channel>(count);
    for (auto i = channels.begin(); i != channels.end(); ++i) {
        exr_channel &out = part.channels[part.channel_count++];
        out.name = copy_string(i.name());
        out.type = exr_pixel_type(i.channel().type);
        out.x_sampling = i.channel().xSampling;
        out.y_sampling = i.channel().ySampling;
    }
}

void fill_attributes(const Imf::Header &header, exr_part &part)
{
    size_t count = 0;
    for (auto i = header.begin(); i != header.end(); ++i)
        count++;
    part.attributes = allocate<exr_attribute>(count);
    for (auto i = header.begin(); i != header.end(); ++i)
        fill_attribute(i.name(), i.attribute(), part.attributes[part.attribute_count++]);

    /* By hand, because OpenEXR's view functions trip over an empty list (CVE-2026-61555). */
    const auto *views = header.findTypedAttribute<Imf::StringVectorAttribute>("multiView");
    if (views) {
        part.multi_view = allocate<char *>(views->value().size());
        for (const std::string &view : views->value())
            part.multi_view[part.multi_view_count++] = copy_string(view);
    }
}

/* threads: of OpenEXR. A chunk is in memory as stored, decoded, and once more while it is
 * decoded. */
uint64_t decode_bytes(const part_layout &layout, int threads)
{
    return layout.deep ? 0 : 3 * 2 * uint64_t(std::max(threads, 1)) * uint64_t(layout.chunk_bytes);
}

void fill_part(const Imf::Header &header, const part_layout &layout, exr_part &part)
{
    const auto *view = header.findTypedAttribute<Imf::StringAttribute>("view");
    part.name = copy_string(layout.name);
    part.view = copy_string(view ? view->value() : "");
    part.type = copy_string(layout.type);
    part.compression = exr_compression_names[layout.compression];
    part.line_order = line_order_names[header.lineOrder()];
    part.data_window = to_box(layout.data);
    part.display_window = to_box(layout.display);
    part.pixel_aspect = header.pixelAspectRatio();
    part.deep = layout.deep;
    fill_channels(header.channels(), part);
    fill_attributes(header, part);
}

void read_info(const char *path, exr_info *info)
{
    info->input = new exr_input(path);
    const auto file = info->input->open();
    const std::vector<part_layout> &parts = info->input->layout.parts;
    info->path = copy_string(path);
    info->table_rebuilt = info->input->stream.is_patched();
    info->parts = allocate<exr_part>(parts.size());
    for (const part_layout &layout : parts) {
        const int i = int(info->part_count++);
        fill_part(file->header(i), layout, info->parts[i]);
        info->parts[i].decode_bytes = decode_bytes(layout, info->input->useful_threads());
    }
}

/* Refuses channels that are not there or not one value per pixel. */
void check_channel(const char *path, size_t part, const Imf::Header &header, const char *name)
{
    const Imf::Channel *channel = header.channels().findChannel(name);
    if (!channel)
        raise(EXIT_CHANNELS, nullptr, "%s: part %zu has no channel '%s'", path, part, name);
    if (channel->xSampling != 1 || channel->ySampling != 1)
        raise(EXIT_INPUT, "resample it to full resolution first",
              "%s: channel '%s' is subsampled %dx%d, which is not supported", path, name,
              channel->xSampling, channel->ySampling);
}

void read_channels(const exr_info *info, size_t index, const exr_read *reads, size_t count)
{
    const char *path = info->path;
    exr_input &in = *info->input;
    if (index >= in.layout.parts.size())
        raise(EXIT_CHANNELS, nullptr, "%s: no part %zu; the file has %zu", path, index,
              in.layout.parts.size());
    const part_layout &layout = in.layout.parts[index];
    if (layout.deep) {
        const std::string hint =
            std::string("flatten first: oiiotool ") + path + " --flatten -o flat.exr";
        raise(EXIT_INPUT, hint.c_str(), "%s: deep data (part %zu '%s') is not supported", path,
              index, layout.type.c_str());
    }
    in.stream.check_unchanged();
    if (!in.decoded.count(index))
        check_decoded(in.stream, in.layout, index);
    in.decoded.insert(index);
    const auto file = in.open();
    Imf::InputPart part(*file, int(index));
    const Imath::Box2i window = part.header().dataWindow();
    const size_t width = size_t(layout.data.width()), height = size_t(layout.data.height());
    Imf::FrameBuffer frame;
    for (size_t i = 0; i < count; i++) {
        check_channel(path, index, part.header(), reads[i].channel);
        const size_t x_stride = reads[i].stride * sizeof(float);
        if (!frame.findSlice(reads[i].channel))
            frame.insert(reads[i].channel, Imf::Slice::Make(Imf::FLOAT, reads[i].values, window,
                                                            x_stride, x_stride * width));
    }
    if (count == 0)
        return;
    part.setFrameBuffer(frame);
    part.readPixels(window.min.y, window.max.y);
    in.stream.check_unchanged();

    /* A frame buffer holds each channel once; whoever asked again gets a copy. */
    std::map<std::string, const exr_read *> first;
    for (size_t i = 0; i < count; i++) {
        const exr_read &from = *first.emplace(reads[i].channel, &reads[i]).first->second;
        for (size_t k = 0; &from != &reads[i] && k < width * height; k++)
            reads[i].values[k * reads[i].stride] = from.values[k * from.stride];
    }
}

} // namespace

void exr::set_limits()
{
    static const bool done = [] {
        Imf::Header::setMaxImageSize(65536, 65536);
        Imf::Header::setMaxTileSize(65536, 65536);
        return true;
    }();
    (void)done;
}

bool exr_info_read(const char *path, struct exr_info *info, struct tool_error *err)
{
    *info = {};
    set_limits();
    if (at_border(err, EXIT_INPUT, path, "damaged", [&] { read_info(path, info); }))
        return true;
    exr_info_free(info);
    return false;
}

void exr_info_free(struct exr_info *info)
{
    for (size_t i = 0; i < info->part_count; i++) {
        exr_part &part = info->parts[i];
        for (size_t k = 0; k < part.channel_count; k++)
            free(part.channels[k].name);
        for (size_t k = 0; k < part.attribute_count; k++) {
            free(part.attributes[k].name);
            free(part.attributes[k].type);
            free(part.attributes[k].text);
            free(part.attributes[k].numbers);
        }
        for (size_t k = 0; k < part.multi_view_count; k++)
            free(part.multi_view[k]);
        free(part.channels);
        free(part.attributes);
        free(part.multi_view);
        free(part.name);
        free(part.view);
        free(part.type);
    }
    free(info->parts);
    free(info->path);
    delete info->input;
    *info = {};
}

bool exr_read_channels(const struct exr_info *info, size_t part, const struct exr_read *reads,
                       size_t count, struct tool_error *err)
{
    return at_border(err, EXIT_INPUT, info->path, "damaged",
                     [&] { read_channels(info, part, reads, count); });
}

void exr_set_threads(unsigned count)
{
    const long threads = count ? long(count) : sysconf(_SC_NPROCESSORS_ONLN);
    /* The pool stays as it is if its threads cannot be made: slower, not wrong. */
    try {
        Imf::setGlobalThreadCount(threads > 1 ? int(std::min(threads, long{EXR_MOST_THREADS})) : 0);
    } catch (...) {
    }
}
