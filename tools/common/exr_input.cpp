/* SPDX-License-Identifier: MIT
 *
 * Opening of files, and the errors of the exr_*.cpp files. */
#include "exr_internal.h"

#include <Iex.h>
#include <ImfThreading.h>

#include <cerrno>
#include <cstdarg>
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

/* The bytes of the UTF-8 sequence at i, 0 if there is none. */
static size_t utf8_length(const std::string &text, size_t i)
{
    const uint8_t lead = uint8_t(text[i]);
    const size_t length = lead < 0x80                   ? 1
                          : lead >= 0xc2 && lead < 0xe0 ? 2
                          : lead >= 0xe0 && lead < 0xf0 ? 3
                          : lead >= 0xf0 && lead < 0xf5 ? 4
                                                        : 0;
    if (length > text.size() - i)
        return 0;
    for (size_t k = 1; k < length; k++) {
        if ((uint8_t(text[i + k]) & 0xc0) != 0x80)
            return 0;
    }
    return length;
}

std::string printable(const std::string &text)
{
    std::string clean;
    for (size_t i = 0; i < text.size() && clean.size() < 255;) {
        const size_t length = utf8_length(text, i);
        const bool control = uint8_t(text[i]) < 32 || text[i] == 127;
        clean += length && !control ? text.substr(i, length) : "?";
        i += length ? length : 1;
    }
    return clean;
}

std::string library_message(const std::exception &error)
{
    std::string text = error.what();
    const size_t name_end = text.rfind("\". ");
    if (name_end != std::string::npos)
        text.erase(0, name_end + 3);
    while (!text.empty() && (text.back() == '.' || text.back() == '\n' || text.back() == ' '))
        text.pop_back();
    return printable(text);
}

input_stream::input_stream(const char *path) : Imf::IStream(path)
{
    struct stat status = {};
    /* O_NONBLOCK: a pipe without a writer must not hang us before we can refuse it. */
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        raise(EXIT_INPUT, nullptr, "%s: cannot open: %s", path, strerror(errno));
    const int error = fstat(fd, &status) != 0          ? errno
                      : S_ISDIR(status.st_mode)        ? EISDIR
                      : !(file_ = fdopen(fd, "rb"))    ? errno
                                                       : 0;
    if (!file_)
        close(fd);
    if (error)
        raise(EXIT_INPUT, nullptr, "%s: cannot open: %s", path, strerror(error));
    if (!S_ISREG(status.st_mode)) {
        fclose(file_);
        raise(EXIT_INPUT, "write it to a file first: OpenEXR needs to seek",
              "%s: cannot open: not a regular file", path);
    }
    size_ = uint64_t(status.st_size);
}

input_stream::~input_stream()
{
    fclose(file_);
}

bool input_stream::read(char data[], int bytes)
{
    if (bytes < 0 || uint64_t(bytes) > size_ - position_)
        raise(EXIT_INPUT, "render or copy the file again", "%s: truncated or damaged: ends early",
              fileName());
    errno = 0;
    if (fread(data, 1, size_t(bytes), file_) != size_t(bytes))
        raise(EXIT_INPUT, nullptr, "%s: cannot read: %s", fileName(),
              errno ? strerror(errno) : "the file became shorter meanwhile");
    position_ += uint64_t(bytes);
    return position_ < size_;
}

uint64_t input_stream::tellg()
{
    return position_;
}

void input_stream::seekg(uint64_t position)
{
    if (position > size_)
        raise(EXIT_INPUT, "render or copy the file again", "%s: truncated or damaged: ends early",
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

/* No reconstruction: OpenEXR would search an unfinished file for chunks, and we would show an image
 * with holes. */
input_file::input_file(const char *path)
try : stream(path), layout(read_layout(stream)),
      file(stream, Imf::globalThreadCount(), false)
{
    if (file.parts() != int(layout.parts.size()))
        raise(EXIT_BUG, nullptr, "%s: headers read in two ways disagree", path);
    for (int i = 0; i < file.parts(); i++) {
        if (!file.partComplete(i))
            raise(EXIT_INPUT, "render or copy the file again",
                  "%s: truncated: part %d lacks chunks", path, i);
    }
} catch (const Iex::BaseExc &e) {
    raise(EXIT_INPUT, "render or copy the file again", "%s: damaged: %s", path,
          library_message(e).c_str());
}

} // namespace exr
