# SPDX-License-Identifier: MIT
"""OpenEXR files byte by byte: attributes and chunks as stored, without any library.

https://openexr.com/en/latest/OpenEXRFileLayout.html"""
import struct

TILED, LONG_NAMES, DEEP, MULTI_PART = 0x200, 0x400, 0x800, 0x1000
LINES_PER_CHUNK = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)
COMPRESSIONS = ('none', 'rle', 'zips', 'zip', 'piz', 'pxr24', 'b44', 'b44a', 'dwaa', 'dwab')


class RawPart:
    def __init__(self):
        self.attributes = {}  # name: (type, bytes)
        self.value_at = {}    # name: offset of the value in the file
        self.chunks = []      # in the order of the offset table, without the part number

    def text(self, name):
        return self.attributes[name][1].decode()

    def box(self, name):
        return struct.unpack('<4i', self.attributes[name][1])


def _text(data, at):
    end = data.index(0, at)
    return data[at:end].decode('utf-8', 'replace'), end + 1


def _read_header(data, at):
    part = RawPart()
    while data[at]:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        size, = struct.unpack_from('<i', data, at)
        part.attributes[name] = (kind, data[at + 4:at + 4 + size])
        part.value_at[name] = at + 4
        at += 4 + size
    return part, at + 1


def _chunk_count(part, tiled):
    if 'chunkCount' in part.attributes:
        return struct.unpack('<i', part.attributes['chunkCount'][1])[0]
    left, top, right, bottom = part.box('dataWindow')
    width, height = right - left + 1, bottom - top + 1
    if not tiled:
        return -(-height // LINES_PER_CHUNK[part.attributes['compression'][1][0]])
    across, down, mode = struct.unpack('<IIB', part.attributes['tiles'][1])
    assert mode == 0, 'one level only'
    return -(-width // across) * -(-height // down)


def read_raw(data):
    """Flat files alone."""
    magic, version = struct.unpack_from('<II', data)
    assert magic == 20000630 and not version & DEEP
    parts, at = [], 8
    while True:
        part, at = _read_header(data, at)
        parts.append(part)
        if not version & MULTI_PART:
            break
        if data[at] == 0:
            at += 1
            break
    for part in parts:
        tiled = bool(version & TILED) or part.attributes.get('type', ('', b''))[1] == b'tiledimage'
        count = _chunk_count(part, tiled)
        offsets = struct.unpack_from(f'<{count}Q', data, at)
        at += 8 * count
        for offset in offsets:
            begin = offset + (4 if version & MULTI_PART else 0)
            leader = 16 if tiled else 4
            size, = struct.unpack_from('<i', data, begin + leader)
            part.chunks.append(data[begin:begin + leader + 4 + size])
    return parts


def patched(data, attribute, value, part=0):
    """The file with the bytes of one attribute replaced."""
    at = read_raw(data)[part].value_at[attribute]
    return data[:at] + value + data[at + len(value):]
