#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""test_spirv.py HEADER...: every shader of the library, as the C sources include it, is valid
SPIR-V, and within the least that a Vulkan 1.1 device may have: invocations of a group and
capabilities. Without spirv-val (package spirv-tools) only the first is left out. How much shared
memory a shader takes its specialization decides: see test_bench_cost.py."""
import re
import shutil
import struct
import subprocess
import sys

# VkPhysicalDeviceLimits, table 'Required Limits'.
MOST_INVOCATIONS, MOST_SIDE = 128, (128, 128, 64)

# Shader, SampledBuffer, ImageBuffer and ImageQuery need no feature, and vkao_add_required_features
# asks for StorageImageWriteWithoutFormat. Nothing of subgroups is among them: their size may be
# any.
CAPABILITIES = 1, 46, 47, 50, 56
STORAGE_BUFFER_16BIT = 4433  # of what is built a second time, without it

EXECUTION_MODE, CAPABILITY = 16, 17
LOCAL_SIZE = 17


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
