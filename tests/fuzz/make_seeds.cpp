/* SPDX-License-Identifier: MIT
 *
 * make_seeds FILE...: small EXR files of every structure that OpenEXR knows, where the fuzzer of
 * fuzz_exr.c begins. The name of each says what it is: COMPRESSION-STRUCTURE.exr. */
#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledOutputPart.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfMatrixAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfPreviewImage.h>
#include <ImfStringAttribute.h>
#include <ImfStringVectorAttribute.h>
#include <ImfTiledOutputPart.h>
#include <ImfTimeCodeAttribute.h>
#include <half.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{

namespace Imf = OPENEXR_IMF_NAMESPACE;

const char *const compressions[] = {"none",  "rle", "zips", "zip",  "piz",
                                    "pxr24", "b44", "b44a", "dwaa", "dwab"};

/* Depth rises, normals face the eye and turn, colour is a ramp; the rest is noise. */
double value_of(const std::string &channel, int x, int y)
{
    const char last = channel.empty() ? ' ' : channel.back();
    if (channel.find("N.") != std::string::npos)
        return last == 'Z' ? 0.8 : 0.6 * (last == 'X' ? std::cos(0.3 * x) : std::sin(0.3 * x));
    if (last == 'Z')
        return x % 11 == 10 ? 1e10 : 2.0 + 0.1 * x + 0.05 * y * y;
    if (last == 'd')
        return (x * 7 + y * 13) % 5;
    return 0.05 * ((x + 3 * y) % 20);
}

/* The pixels of all channels in one box, and slices that show them to OpenEXR. */
struct pixels {
    std::vector<std::vector<char>> memory;
    Imf::FrameBuffer frame;

    pixels(const Imf::ChannelList &channels, const Imath::Box2i &box)
    {
        const size_t width = size_t(box.max.x - box.min.x) + 1;
        const size_t height = size_t(box.max.y - box.min.y) + 1;
        for (auto c = channels.begin(); c != channels.end(); ++c) {
            const Imf::PixelType type = c.channel().type;
            const size_t bytes = type == Imf::HALF ? 2 : 4;
            memory.emplace_back(width * height * bytes);
            for (size_t i = 0; i < width * height; i++) {
                const double value = value_of(c.name(), int(i % width), int(i / width));
                const half as_half = half(float(std::min(value, 65504.0)));
                const float as_float = float(value);
                const uint32_t as_uint = uint32_t(std::min(value, 1e9));
                const void *from = type == Imf::HALF    ? static_cast<const void *>(&as_half)
                                   : type == Imf::FLOAT ? static_cast<const void *>(&as_float)
                                                        : &as_uint;
                memcpy(&memory.back()[i * bytes], from, bytes);
            }
            frame.insert(c.name(),
                         Imf::Slice::Make(type, memory.back().data(), box, bytes, bytes * width));
        }
    }
};

/* One sample in every second pixel, two in every fifth. */
struct deep_pixels {
    std::vector<unsigned> counts;
    std::vector<std::vector<float>> samples;
    std::vector<const float *> pointers;
    Imf::DeepFrameBuffer frame;

    deep_pixels(const Imf::ChannelList &channels, const Imath::Box2i &box)
    {
        const size_t width = size_t(box.max.x - box.min.x) + 1;
        const size_t height = size_t(box.max.y - box.min.y) + 1, count = width * height;
        const ptrdiff_t first = box.min.x + box.min.y * ptrdiff_t(width);
        samples.assign(count, {1.0f, 2.0f});
        for (size_t i = 0; i < count; i++) {
            counts.push_back(i % 5 == 0 ? 2 : i % 2);
            pointers.push_back(samples[i].data());
        }
        frame.insertSampleCountSlice(
            Imf::Slice(Imf::UINT, reinterpret_cast<char *>(counts.data() - first), 4, 4 * width));
        for (auto c = channels.begin(); c != channels.end(); ++c)
            frame.insert(c.name(),
                         Imf::DeepSlice(Imf::FLOAT,
                                        reinterpret_cast<char *>(pointers.data() - first),
                                        sizeof(float *), sizeof(float *) * width, sizeof(float)));
    }
};

void add_channels(Imf::Header &header, const std::string &prefix, bool color)
{
    const auto add = [&](const char *name, Imf::PixelType type) {
        header.channels().insert((prefix + name).c_str(), Imf::Channel(type));
    };
    add("Z", Imf::FLOAT);
    for (const char *name : {"N.X", "N.Y", "N.Z"})
        add(name, Imf::HALF);
    for (const char *name : {"R", "G", "B", "A"}) {
        if (color)
            add(name, Imf::HALF);
    }
    add("id", Imf::UINT);
}

void add_attributes(Imf::Header &header)
{
    header.insert("owner", Imf::StringAttribute("somebody"));
    header.insert("cameraFov", Imf::FloatAttribute(50.0f));
    header.insert("worldToCamera",
                  Imf::M44fAttribute(Imath::M44f(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 1, 2, 3, 1)));
    header.insert("worldToNDC", Imf::M44fAttribute(
                                    Imath::M44f(2, 0, 0, 0, 0, 0, 1, 1, 0, -2, 0, 0, 0, 0, -1, 0)));
    header.insert("timeCode", Imf::TimeCodeAttribute(Imf::TimeCode(0x12345678)));
    header.insert("chromaticities", Imf::ChromaticitiesAttribute(Imf::Chromaticities()));
    header.setPreviewImage(Imf::PreviewImage(2, 2));
}

Imf::Header make_header(Imf::Compression compression, const std::string &structure)
{
    Imath::Box2i display({0, 0}, {19, 12}), data = display;
    if (structure == "crop") {
        display = Imath::Box2i({-5, 3}, {30, 20});
        data = Imath::Box2i({-2, 4}, {20, 15});
    }
    if (structure == "beyond")
        data = Imath::Box2i({-7, -3}, {25, 9});
    Imf::Header header(display, data, 1.0f, {0, 0}, 1.0f,
                       structure == "crop" ? Imf::DECREASING_Y : Imf::INCREASING_Y, compression);
    header.setType(Imf::SCANLINEIMAGE);
    if (structure == "tiled" || structure == "mip" || structure == "rip" || structure == "mipup") {
        const Imf::LevelMode mode = structure == "tiled" ? Imf::ONE_LEVEL
                                    : structure == "rip" ? Imf::RIPMAP_LEVELS
                                                         : Imf::MIPMAP_LEVELS;
        header.setTileDescription(Imf::TileDescription(
            8, 5, mode, structure == "mipup" ? Imf::ROUND_UP : Imf::ROUND_DOWN));
        header.setType(Imf::TILEDIMAGE);
    }
    if (structure == "deep" || structure == "deeptile") {
        header.setType(structure == "deep" ? Imf::DEEPSCANLINE : Imf::DEEPTILE);
        header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
        header.channels().insert("A", Imf::Channel(Imf::FLOAT));
        if (structure == "deeptile")
            header.setTileDescription(Imf::TileDescription(8, 5));
        return header;
    }
    add_channels(header, "", structure != "views");
    if (structure == "scan" || structure == "crop")
        add_attributes(header);
    return header;
}

/* The headers of the file; a structure of several parts is made of those of one. */
std::vector<Imf::Header> make_headers(Imf::Compression compression, const std::string &structure)
{
    std::vector<Imf::Header> headers;
    if (structure == "multi") {
        for (const char *part : {"beauty", "tiled", "mip", "deep", "deeptile"}) {
            const std::string kind = part;
            const Imf::Compression deep =
                compression > Imf::ZIPS_COMPRESSION ? Imf::ZIPS_COMPRESSION : compression;
            headers.push_back(make_header(kind.rfind("deep", 0) == 0 ? deep : compression, kind));
            headers.back().setName(kind);
        }
    } else if (structure == "views") {
        for (const char *view : {"left", "right"}) {
            headers.push_back(make_header(compression, structure));
            headers.back().setName(std::string("depth_") + view);
            headers.back().setView(view);
        }
    } else {
        headers.push_back(make_header(compression, structure));
        if (structure == "stereo") {
            headers.back().insert("multiView", Imf::StringVectorAttribute({"left", "right"}));
            add_channels(headers.back(), "right.", true);
        }
    }
    return headers;
}

void write_tiles(Imf::MultiPartOutputFile &file, int part)
{
    Imf::TiledOutputPart out(file, part);
    for (int ly = 0; ly < out.numYLevels(); ly++) {
        for (int lx = 0; lx < out.numXLevels(); lx++) {
            if (!out.isValidLevel(lx, ly))
                continue;
            const pixels level(file.header(part).channels(), out.dataWindowForLevel(lx, ly));
            out.setFrameBuffer(level.frame);
            out.writeTiles(0, out.numXTiles(lx) - 1, 0, out.numYTiles(ly) - 1, lx, ly);
        }
    }
}

void write_deep(Imf::MultiPartOutputFile &file, int part)
{
    const Imf::Header &header = file.header(part);
    const Imath::Box2i &box = header.dataWindow();
    const deep_pixels deep(header.channels(), box);
    if (header.type() == Imf::DEEPSCANLINE) {
        Imf::DeepScanLineOutputPart out(file, part);
        out.setFrameBuffer(deep.frame);
        out.writePixels(box.max.y - box.min.y + 1);
    } else {
        Imf::DeepTiledOutputPart out(file, part);
        out.setFrameBuffer(deep.frame);
        out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
    }
}

void write_seed(const char *path)
{
    const char *slash = strrchr(path, '/');
    const std::string name = slash ? slash + 1 : path;
    const size_t dash = name.find('-'), dot = name.find('.');
    int compression = 0;
    while (compression < 10 && name.substr(0, dash) != compressions[compression])
        compression++;
    if (compression == 10 || dot == std::string::npos || dash > dot)
        throw std::runtime_error("not COMPRESSION-STRUCTURE.exr");
    const auto headers =
        make_headers(Imf::Compression(compression), name.substr(dash + 1, dot - dash - 1));
    Imf::MultiPartOutputFile file(path, headers.data(), int(headers.size()));
    for (int part = 0; part < file.parts(); part++) {
        const std::string type = file.header(part).type();
        if (type == Imf::TILEDIMAGE) {
            write_tiles(file, part);
        } else if (type != Imf::SCANLINEIMAGE) {
            write_deep(file, part);
        } else {
            const Imath::Box2i &box = file.header(part).dataWindow();
            const pixels all(file.header(part).channels(), box);
            Imf::OutputPart out(file, part);
            out.setFrameBuffer(all.frame);
            out.writePixels(box.max.y - box.min.y + 1);
        }
    }
}

} // namespace

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        try {
            write_seed(argv[i]);
        } catch (const std::exception &e) {
            fprintf(stderr, "make_seeds: %s: %s\n", argv[i], e.what());
            return 1;
        }
    }
    return 0;
}
