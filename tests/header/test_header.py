#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao.h compiles alone, as C11 and C++11, by every compiler here; and its comments are true.

usage: test_header.py INCLUDE_DIR [SYSTEM_INCLUDE_DIR...]
"""

import os
import re
import shutil
import subprocess
import sys

from cases import Skip, run, without_comments

HERE = os.path.dirname(os.path.abspath(__file__))
INCLUDE, SYSTEM = sys.argv[1], sys.argv[2:]
HEADER = open(os.path.join(INCLUDE, "vkao.h"), encoding="utf-8").read()
FLAGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wpadded", "-Wconversion", "-Wshadow",
         "-Wundef", "-Werror"]
COMPILERS = [
    ("gcc", "c11", "header_c11.c"),
    ("gcc", "c17", "header_c11.c"),
    ("clang", "c11", "header_c11.c"),
    ("g++", "c++11", "header_cpp11.cpp"),
    ("g++", "c++20", "header_cpp11.cpp"),
    ("clang++", "c++11", "header_cpp11.cpp"),
]


def compiles(compiler, standard, source):
    def case():
        if not shutil.which(compiler):
            raise Skip(f"no {compiler}")
        command = [compiler, f"-std={standard}", "-fsyntax-only", *FLAGS, f"-I{INCLUDE}"]
        for directory in filter(None, SYSTEM):
            command += ["-isystem", directory]
        command.append(os.path.join(HERE, source))
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    return f"{compiler}_{standard}_compiles_the_header_without_warning".replace("+", "p"), case


def default_functions():
    return re.findall(r"^VKAO_DEFAULT\((vkao_\w+)\)", HEADER, re.M)


def every_default_function_is_compiled_here():
    assert len(default_functions()) >= 6
    for source in ("header_c11.c", "header_cpp11.cpp"):
        text = open(os.path.join(HERE, source), encoding="utf-8").read()
        for name in default_functions():
            assert f"{name}_default()" in text, f"{source} does not call {name}_default"


def defaults_are_those_the_comments_state():
    """'Default N' in a member's comment is what the library's table of parameters has."""
    table = open(os.path.join(INCLUDE, "..", "parameters.c"), encoding="utf-8").read()
    given = {}
    for row in re.findall(r"\{(?:SWITCH|CHOICE|COMPILED|FREE)\(.*?\},\n", table, re.S):
        name = re.match(r"\{\w+\((\w+)", row).group(1)
        value = re.search(r"\.standard = ([\d.]+)", row)
        given[name] = float(value.group(1)) if value else 0.0
    checked = 0
    for name in ("vkao_effect_info", "vkao_params"):
        struct = re.search(rf"struct {name} \{{(.*?)\n\}}", HEADER, re.S).group(1)
        # A member is documented behind it on its line, or in the comment before it.
        comment = r"(/\*(?:(?!\*/).)*\*/)?"
        declaration = comment + r"\s*\w+ (\w+)(?:\[\d+\])?;[ \t]*" + comment
        for member in re.finditer(declaration, struct, re.S):
            text = " ".join((member.group(3) or member.group(1) or "").split())
            value = re.search(r"Default (\d+(?:\.\d+)?)", text)
            if value:
                assert given.get(member.group(2)) == float(value.group(1)), \
                    f"{name}.{member.group(2)}: stated {value.group(1)}, the table has " \
                    f"{given.get(member.group(2))}"
                checked += 1
    assert checked >= 12, f"only {checked} defaults found"


def no_line_is_longer_than_100():
    for number, line in enumerate(HEADER.split("\n"), 1):
        assert len(line) <= 100, f"vkao.h:{number} has {len(line)} columns"


def every_enum_can_grow():
    """A MAX_ENUM member keeps each enum 32 bits wide in every compiler."""
    enums = re.findall(r"typedef enum (vkao_\w+) \{(.*?)\}", without_comments(HEADER), re.S)
    assert len(enums) >= 8
    for name, body in enums:
        assert "_MAX_ENUM = 0x7fffffff" in body, f"{name} has no MAX_ENUM"


def the_barrier_of_the_contract_compiles():
    """From its declaration to the end of the call, in a function that has its names."""
    code = re.search(r"const VkImageMemoryBarrier anew = .*?&anew\);", HEADER, re.S)
    assert code, "vkao.h shows no barrier"
    text = re.sub(r"^ \*", "", code.group(0), flags=re.M)
    source = ('#include "vkao.h"\nvoid prepare(PFN_vkCmdPipelineBarrier vkCmdPipelineBarrier,\n'
              f"VkCommandBuffer cmd, VkImage ao_image);\nvoid prepare(PFN_vkCmdPipelineBarrier "
              f"vkCmdPipelineBarrier,\nVkCommandBuffer cmd, VkImage ao_image)\n{{\n{text}\n}}\n")
    for compiler, language in (("cc", "c"), ("c++", "c++")):
        if not shutil.which(compiler):
            continue
        command = [compiler, "-fsyntax-only", *FLAGS, f"-I{INCLUDE}"]
        for directory in filter(None, SYSTEM):
            command += ["-isystem", directory]
        done = subprocess.run([*command, f"-x{language}", "-"], input=source, capture_output=True,
                              text=True)
        assert done.returncode == 0, done.stderr


if __name__ == "__main__":
    run([compiles(*row) for row in COMPILERS] +
        [(f.__name__, f) for f in (every_default_function_is_compiled_here,
                                   defaults_are_those_the_comments_state,
                                   no_line_is_longer_than_100, every_enum_can_grow,
                                   the_barrier_of_the_contract_compiles)])
