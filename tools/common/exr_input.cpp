/* SPDX-License-Identifier: MIT
 *
 * Opening of files, and the errors of the exr_*.cpp files. */
#include "exr_internal.h"

#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfThreading.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace exr {

void raise(exit_code code, const char *hint, const char *format, ...)
{
    tool_exception e;
    va_list args;
    va_start(args, format);
    vsnprintf(e.error.message, sizeof e.error.message, format, args);
    va_end(args);
    e.error.code = code;
    if (hint)
        snprintf(e.error.hint, sizeof e.error.hint, "%s", hint);
    throw e;
}

std::string excerpt(const std::string &text)
{
    size_t length = 255;
    if (text.size() <= length)
        return text;
    for (int i = 0; i < 3 && (uint8_t(text[length]) & 0xc0) == 0x80; i++)
        length--; /* not in the middle of a character */
    return text.substr(0, length);
}

std::string library_message(const std::exception &error)
{
    std::string text = error.what();
    const size_t name_end = text.rfind("\". ");
    if (name_end != std::string::npos)
        text.erase(0, name_end + 3);
    while (!text.empty() && (text.back() == '.' || text.back() == '\n' || text.back() == ' '))
        text.pop_back();
    return excerpt(text);
}

input_stream::input_stream(const char *path, const char *shown)
    : Imf::IStream(shown ? shown : path)
{
    struct stat status = {};
    /* O_NONBLOCK: a pipe without a writer must not hang us before we can refuse it. */
    const int fd = ::open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        raise(EXIT_INPUT, nullptr, "%s: cannot open: %s", fileName(), strerror(errno));
    const int error = fstat(fd, &status) != 0          ? errno
                      : S_ISDIR(status.st_mode)        ? EISDIR
                      : !(file_ = fdopen(fd, "rb"))    ? errno
                                                       : 0;
    if (!file_)
        close(fd);
    if (error)
        raise(EXIT_INPUT, nullptr, "%s: cannot open: %s", fileName(), strerror(error));
    if (!S_ISREG(status.st_mode)) {
        fclose(file_);
        raise(EXIT_INPUT, "write it to a file first: OpenEXR needs to seek",
              "%s: cannot open: not a regular file", fileName());
    }
    size_ = uint64_t(status.st_size);
    modified_ = status.st_mtim;
}

input_stream::~input_stream()
{
    fclose(file_);
}

bool input_stream::read(char data[], int bytes)
{
    if (bytes < 0 || uint64_t(bytes) > size_ - position_)
        raise(EXIT_INPUT, damaged_hint, "%s: truncated or damaged: ends early",
              fileName());
    errno = 0;
    if (fread(data, 1, size_t(bytes), file_) != size_t(bytes))
        raise(EXIT_INPUT, nullptr, "%s: cannot read: %s", fileName(),
              errno ? strerror(errno) : "the file became shorter meanwhile");
    position_ += uint64_t(bytes);
    return position_ < size_;
}

void input_stream::read_all(char data[], size_t bytes)
{
    for (size_t done = 0; done < bytes;) {
        const int part = int(std::min(bytes - done, size_t{1} << 30));
        read(data + done, part);
        done += size_t(part);
    }
}

void input_stream::check_unchanged() const
{
    struct stat now = {};
    if (fstat(fileno(file_), &now) != 0)
        raise(EXIT_INPUT, nullptr, "%s: cannot read: %s", fileName(), strerror(errno));
    if (uint64_t(now.st_size) != size_ || now.st_mtim.tv_sec != modified_.tv_sec ||
        now.st_mtim.tv_nsec != modified_.tv_nsec)
        raise(EXIT_INPUT, "run again when it is written; writers should rename a finished file",
              "%s: somebody has written to it while it was read", fileName());
}

uint64_t input_stream::tellg()
{
    return position_;
}

void input_stream::seekg(uint64_t position)
{
    if (position > size_)
        raise(EXIT_INPUT, damaged_hint, "%s: truncated or damaged: ends early",
              fileName());
    if (fseeko(file_, off_t(position), SEEK_SET) != 0)
        raise(EXIT_INPUT, nullptr, "%s: cannot read: %s", fileName(), strerror(errno));
    position_ = position;
}

uint8_t input_stream::get_u8()
{
    char byte;
    read(&byte, 1);
    return uint8_t(byte);
}

int32_t input_stream::get_i32()
{
    unsigned char b[4];
    read(reinterpret_cast<char *>(b), sizeof b);
    return int32_t(uint32_t(b[0]) | uint32_t(b[1]) << 8 | uint32_t(b[2]) << 16 |
                   uint32_t(b[3]) << 24);
}

uint64_t input_stream::get_u64()
{
    const uint64_t low = uint32_t(get_i32());
    return low | uint64_t(uint32_t(get_i32())) << 32;
}

namespace {

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
    raise(EXIT_INPUT, damaged_hint,
          "%s: damaged header: two readings of part %zu disagree: %s", stream.fileName(), part,
          what);
}

} // namespace

} // namespace exr

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
    using namespace exr;
    try {
        stream.check_unchanged();
        stream.seekg(0);
        auto file =
            std::make_unique<Imf::MultiPartInputFile>(stream, useful_threads(), false);
        stream.check_unchanged();
        if (file->parts() != int(layout.parts.size()))
            disagree(stream, 0, "number of parts");
        for (int i = 0; i < file->parts(); i++) {
            const char *difference = find_difference(file->header(i), layout.parts[size_t(i)]);
            if (difference)
                disagree(stream, size_t(i), difference);
            if (!file->partComplete(i))
                raise(EXIT_INPUT, damaged_hint,
                      "%s: truncated: part %d lacks chunks", stream.fileName(), i);
        }
        return file;
    } catch (const Iex::BaseExc &e) {
        raise(EXIT_INPUT, damaged_hint, "%s: damaged: %s", stream.fileName(),
              library_message(e).c_str());
    }
}
