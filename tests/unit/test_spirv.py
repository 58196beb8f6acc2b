#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""test_spirv.py HEADER...: every shader of the library, as the C sources include it, is valid
SPIR-V, and within the least that a Vulkan 1.1 device may have: invocations of a group, shared
memory, capabilities. Without spirv-val (package spirv-tools) only the first is left out."""
import re
import shutil
import struct
import subprocess
import sys

# VkPhysicalDeviceLimits, table 'Required Limits'.
MOST_INVOCATIONS, MOST_SIDE, MOST_SHARED_BYTES = 128, (128, 128, 64), 16384

# Shader, SampledBuffer, ImageBuffer and ImageQuery need no feature, and vkao_add_required_features
# asks for StorageImageWriteWithoutFormat. Nothing of subgroups is among them: their size may be
# any.
CAPABILITIES = 1, 46, 47, 50, 56
STORAGE_BUFFER_16BIT = 4433  # of what is built a second time, without it

EXECUTION_MODE, CAPABILITY, CONSTANT, SPEC_CONSTANT, VARIABLE = 16, 17, 43, 50, 59
TYPE_INT, TYPE_FLOAT, TYPE_VECTOR, TYPE_ARRAY, TYPE_STRUCT, TYPE_POINTER = 21, 22, 23, 28, 30, 32
LOCAL_SIZE, WORKGROUP = 17, 4


def read_words(path):
    with open(path, encoding='utf-8') as file:
        return [int(word, 16) for word in re.findall(r'\b0x([0-9a-f]{8})\b', file.read())]


def instructions(words):
    """(opcode, operands) of a module."""
    at = 5
    while at < len(words):
        count = words[at] >> 16
        yield words[at] & 0xffff, words[at + 1:at + count]
        at += count


def bytes_of(types, constants, of):
    opcode, operands = types[of]
    if opcode in (TYPE_INT, TYPE_FLOAT):
        return operands[0] // 8
    if opcode == TYPE_VECTOR:
        return operands[1] * bytes_of(types, constants, operands[0])
    if opcode == TYPE_ARRAY:
        return constants[operands[1]] * bytes_of(types, constants, operands[0])
    return sum(bytes_of(types, constants, member) for member in operands)


def shared_bytes(words):
    types, constants, total = {}, {}, 0
    for opcode, operands in instructions(words):
        if opcode in (TYPE_INT, TYPE_FLOAT, TYPE_VECTOR, TYPE_ARRAY, TYPE_STRUCT, TYPE_POINTER):
            types[operands[0]] = opcode, operands[1:]
        elif opcode in (CONSTANT, SPEC_CONSTANT):
            constants[operands[1]] = operands[2]
        elif opcode == VARIABLE and operands[2] == WORKGROUP:
            total += bytes_of(types, constants, types[operands[0]][1][1])
    return total


def problems_of(path):
    words = read_words(path)
    if words[:1] != [0x07230203]:
        return ['is no SPIR-V']
    found = []
    sizes = [operands[2:5] for opcode, operands in instructions(words)
             if opcode == EXECUTION_MODE and operands[1] == LOCAL_SIZE]
    if len(sizes) != 1:
        found.append(f'has {len(sizes)} group sizes')
    for x, y, z in sizes:
        if x * y * z > MOST_INVOCATIONS or any(a > b for a, b in zip((x, y, z), MOST_SIDE)):
            found.append(f'has groups of {x} x {y} x {z} invocations, want at most 128')
    if shared_bytes(words) > MOST_SHARED_BYTES:
        found.append(f'has {shared_bytes(words)} bytes of shared memory, want at most 16384')
    allowed = (*CAPABILITIES, STORAGE_BUFFER_16BIT if '_16bit' in path else 0)
    found += [f'wants capability {operands[0]}' for opcode, operands in instructions(words)
              if opcode == CAPABILITY and operands[0] not in allowed]
    return found + invalid(words)


def invalid(words):
    if not shutil.which('spirv-val'):
        return []
    run = subprocess.run(['spirv-val', '--target-env', 'vulkan1.1'], check=False,
                         input=struct.pack(f'<{len(words)}I', *words), capture_output=True)
    return [f'is invalid: {run.stdout.decode()}{run.stderr.decode()}'] if run.returncode else []


def main():
    paths = [path for path in sys.argv[1:] if path.endswith('.h')]
    failed = 0
    for path in paths:
        for problem in problems_of(path):
            failed += 1
            print(f'{path}: {problem}')
    print(f'{len(paths)} shaders, {failed} problems')
    return 1 if failed or not paths else 0


if __name__ == '__main__':
    sys.exit(main())
