#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The shared library exports the header's functions and nothing else, and links no Vulkan.
The static one has no name that could meet a name of its user's.

usage: test_symbols.py LIBRARY ARCHIVE HEADER
"""

import re
import shutil
import subprocess
import sys

from cases import Skip, run, without_comments

LIBRARY, ARCHIVE, HEADER = sys.argv[1:4]


def symbols(which):
    if not shutil.which("nm"):
        raise Skip("no nm")
    if not re.search(r"\.(so|dylib)", LIBRARY):
        raise Skip("no shared library in this build")
    done = subprocess.run(["nm", "-D", which, LIBRARY], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    names = [line.split()[-1].split("@")[0] for line in done.stdout.splitlines() if line.strip()]
    assert names, "nm lists nothing"
    return set(names)


def declared():
    text = without_comments(open(HEADER, encoding="utf-8").read())
    text = re.sub(r"^\s*#(?:.*\\\n)*.*$", "", text, flags=re.M)
    defaults = re.findall(r"^VKAO_DEFAULT\((\w+)\)", text, re.M)
    return set(re.findall(r"\bVKAO_API\b[^;{]*?\b(\w+)\s*\(", text)) | \
        {f"{name}_init" for name in defaults}


def every_declared_function_is_exported_and_nothing_else():
    names = declared()
    assert len(names) >= 14, f"only {sorted(names)} found in the header"
    # What instrumented builds add begins with two underscores.
    exported = {name for name in symbols("--defined-only") if not name.startswith("__")}
    assert exported == names, \
        f"extra: {sorted(exported - names)}, missing: {sorted(names - exported)}"


def every_export_begins_with_vkao():
    wrong = [name for name in symbols("--defined-only") if not name.startswith(("vkao_", "__"))]
    assert not wrong, wrong


def every_external_symbol_of_the_static_library_begins_with_vkao():
    """Hidden symbols too: in an archive they are as visible as others."""
    if not shutil.which("nm"):
        raise Skip("no nm")
    done = subprocess.run(["nm", "-g", "--defined-only", ARCHIVE], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in done.stdout.splitlines() if len(line.split()) == 3]
    names = {name for _, _, name in rows}
    assert names > declared(), f"missing: {sorted(declared() - names)}"
    wrong = sorted(name for name in names if not name.startswith(("vkao_", "__")))
    assert not wrong, wrong


def no_vulkan_function_is_linked():
    wrong = [name for name in symbols("--undefined-only") if re.match(r"vk(?!ao_)", name)]
    assert not wrong, wrong


def the_library_keeps_no_global_state():
    if any(re.match(r"__(a|t|ub|m)san_", name) for name in symbols("--undefined-only")):
        raise Skip("sanitizers bring state of their own")
    done = subprocess.run(["nm", "--format=sysv", LIBRARY], capture_output=True, text=True)
    lines = [line for line in done.stdout.splitlines() if line.count("|") == 6]
    rows = [[cell.strip() for cell in line.split("|")] for line in lines]
    if not rows:
        raise Skip("stripped")
    # The C runtime has a little: names that begin with an underscore, and completed.N.
    wrong = [row[0] for row in rows if row[6] in (".data", ".bss", "*COM*") and row[3] == "OBJECT"
             and not re.match(r"_|completed\.", row[0])]
    assert not wrong, wrong


if __name__ == "__main__":
    run([(f.__name__, f) for f in (every_declared_function_is_exported_and_nothing_else,
                                   every_export_begins_with_vkao,
                                   every_external_symbol_of_the_static_library_begins_with_vkao,
                                   no_vulkan_function_is_linked,
                                   the_library_keeps_no_global_state)])
