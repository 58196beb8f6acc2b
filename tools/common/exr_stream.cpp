/* SPDX-License-Identifier: MIT
 *
 * Bytes of a file, and the errors of the exr_*.cpp files. */
#include "exr_internal.h"

#include <OpenEXRConfig.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace exr
{

const char *const damaged_hint = "render or copy the file again";

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

input_stream::input_stream(const char *path, const char *shown) : Imf::IStream(shown ? shown : path)
{
    struct stat status = {};
    /* O_NONBLOCK: a pipe without a writer must not hang us before we can refuse it. */
    const int fd = ::open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        raise(EXIT_INPUT, nullptr, "%s: cannot open: %s", fileName(), strerror(errno));
    const int error = fstat(fd, &status) != 0       ? errno
                      : S_ISDIR(status.st_mode)     ? EISDIR
                      : !(file_ = fdopen(fd, "rb")) ? errno
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
        raise(EXIT_INPUT, damaged_hint, "%s: truncated or damaged: ends early", fileName());
    errno = 0;
    if (fread(data, 1, size_t(bytes), file_) != size_t(bytes))
        raise(EXIT_INPUT, nullptr, "%s: cannot read: %s", fileName(),
              errno ? strerror(errno) : "the file became shorter meanwhile");
    const uint64_t end = position_ + uint64_t(bytes), patch_end = patch_at_ + patch_.size();
    const uint64_t from = std::max(position_, patch_at_), to = std::min(end, patch_end);
    if (from < to)
        memcpy(data + (from - position_), patch_.data() + (from - patch_at_), size_t(to - from));
    position_ = end;
    return position_ < size_;
}

void input_stream::patch(uint64_t position, std::vector<char> bytes)
{
    patch_at_ = position;
    patch_ = std::move(bytes);
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
        raise(EXIT_INPUT, damaged_hint, "%s: truncated or damaged: ends early", fileName());
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

} // namespace exr

const char *exr_library_version(void)
{
    return OPENEXR_PACKAGE_STRING;
}
