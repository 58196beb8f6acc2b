#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao from Python, with nothing but ctypes: defaults, and the table that describes them.

usage: bindings.py LIBVKAO.SO
"""

import ctypes
import struct
import sys
from ctypes import POINTER, c_char_p, c_double, c_uint32

FLOAT, COLOR = 0, 4


class Parameter(ctypes.Structure):
    """vkao_parameter"""
    _fields_ = [("name", c_char_p), ("unit", c_char_p), ("help", c_char_p), ("type", c_uint32),
                ("is_compiled", c_uint32), ("offset", c_uint32), ("above_least", c_uint32),
                ("zero_is_standard", c_uint32), ("padding", c_uint32),
                ("least", c_double), ("most", c_double), ("standard", c_double),
                ("choices", POINTER(c_char_p)), ("stages", c_uint32), ("methods", c_uint32)]


class Params(ctypes.Structure):
    """vkao_params, of which the table tells what lies where"""
    _fields_ = [("bytes", c_uint32 * 14)]


class EffectInfo(ctypes.Structure):
    """vkao_effect_info, likewise"""
    _fields_ = [("bytes", c_uint32 * 28)]


def main():
    vkao = ctypes.CDLL(sys.argv[1])
    vkao.vkao_parameters.restype = POINTER(Parameter)
    structs = []
    for function, kind in ((vkao.vkao_params_init, Params),
                           (vkao.vkao_effect_info_init, EffectInfo)):
        struct_ = kind()
        function(ctypes.byref(struct_), ctypes.sizeof(struct_))
        structs.append(bytes(struct_))
        size = struct.unpack_from("I", structs[-1])[0]
        assert size == ctypes.sizeof(kind), f"{kind.__name__}: struct_size {size}"
    count = c_uint32()
    table = vkao.vkao_parameters(ctypes.byref(count))
    assert count.value > 20, f"{count.value} parameters"
    for row in table[:count.value]:
        code = "f" if row.type in (FLOAT, COLOR) else "I"
        value = struct.unpack_from(code, structs[row.is_compiled], row.offset)[0]
        assert abs(value - row.standard) < 1e-6, \
            f"{row.name.decode()}: default {value}, the table says {row.standard}"
    print(", ".join(row.name.decode() for row in table[:count.value]))


if __name__ == "__main__":
    main()
