#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The README's engine example compiles as it stands, in C and in C++.

usage: test_readme.py README.md INCLUDE_DIR [SYSTEM_INCLUDE_DIR...]
"""

import os
import re
import shutil
import subprocess
import sys

from cases import Skip, run

HERE = os.path.dirname(os.path.abspath(__file__))
README, INCLUDE, SYSTEM = sys.argv[1], sys.argv[2], sys.argv[3:]


def example():
    text = open(README, encoding="utf-8").read()
    section = re.search(r"^## In an engine[ \t]*$(.*?)(?=^## |\Z)", text, re.M | re.S)
    assert section, "README.md has no section '## In an engine'"
    block = re.search(r"^```c[ \t]*\n(.*?)^```", section.group(1), re.M | re.S)
    assert block, "the section '## In an engine' has no ```c block"
    return block.group(1)


def engine_example_is_there():
    assert "vkao_frame_create" in example() and "vkao_cmd_" in example()


def engine_example_compiles(compiler, language, standard):
    def case():
        if not shutil.which(compiler):
            raise Skip(f"no {compiler}")
        lines = example().splitlines()
        includes = [line for line in lines if line.lstrip().startswith("#include")]
        body = [line for line in lines if line not in includes]
        source = "\n".join(['#include "readme_prelude.h"', *includes, "bool engine(void)", "{",
                            *body])
        if not re.search(r"\breturn\b[^;]*;\s*\Z", "\n".join(body)):
            source += "\nreturn true;"
        command = [compiler, f"-std={standard}", "-Wall", "-Wextra", "-Wpedantic", "-Werror",
                   "-fsyntax-only", f"-I{INCLUDE}", f"-I{HERE}"]
        for directory in filter(None, SYSTEM):
            command += ["-isystem", directory]
        done = subprocess.run([*command, f"-x{language}", "-"], input=source + "\n}\n",
                              capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    name = standard.replace("+", "p")
    return f"engine_example_compiles_as_{name}_with_{compiler.replace('+', 'p')}", case


if __name__ == "__main__":
    run([("engine_example_is_there", engine_example_is_there),
         *(engine_example_compiles(compiler, language, standard) for compiler, language, standard in (
             ("cc", "c", "c11"), ("c++", "c++", "c++17"), ("c++", "c++", "c++20"),
             ("clang++", "c++", "c++17"), ("clang++", "c++", "c++20")))])
