#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The README's engine example compiles as it stands, in C and in C++.

usage: test_readme.py README.md EXAMPLE.C INCLUDE_DIR [SYSTEM_INCLUDE_DIR...]
"""

import os
import re
import shutil
import subprocess
import sys

from cases import Skip, run

HERE = os.path.dirname(os.path.abspath(__file__))
README, EXAMPLE, INCLUDE, SYSTEM = *sys.argv[1:4], sys.argv[4:]


def blocks(heading):
    """Those of C in the section, which ends at the next heading."""
    text = open(README, encoding="utf-8").read()
    section = re.search(rf"^{heading}[ \t]*$(.*?)(?=^##|\Z)", text, re.M | re.S)
    assert section, f"README.md has no section '{heading}'"
    found = re.findall(r"^```c[ \t]*\n(.*?)^```", section.group(1), re.M | re.S)
    assert found, f"the section '{heading}' has no ```c block"
    return found


def example():
    return blocks("## In an engine")[0]


def excerpts_are_the_installed_examples():
    source = open(EXAMPLE, encoding="utf-8").read()
    for block in blocks("### The example"):
        assert block in source, f"{EXAMPLE} does not have\n{block}"


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
         ("excerpts_are_the_installed_examples", excerpts_are_the_installed_examples),
         *(engine_example_compiles(*row) for row in (
             ("cc", "c", "c11"), ("c++", "c++", "c++17"), ("c++", "c++", "c++20"),
             ("clang++", "c++", "c++17"), ("clang++", "c++", "c++20")))])
