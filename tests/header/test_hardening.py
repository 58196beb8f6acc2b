#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What is installed is built so that an overwritten buffer ends the program.

`test_hardening.py FORTIFY PROGRAM...`; FORTIFY is 0 where the build has sanitizers or no optimiser.
Static libraries and other formats than ELF are skipped.
"""
import functools
import os
import re
import shutil
import subprocess
import sys

import cases


def read(option, path):
    if not shutil.which("readelf"):
        raise cases.Skip("no readelf")
    with open(path, "rb") as file:
        if file.read(4) != b"\x7fELF":
            raise cases.Skip(f"{path} is no ELF file")
    return subprocess.run(["readelf", "-W", option, path], capture_output=True, text=True,
                          check=True).stdout


def imported(path):
    """Functions of other libraries, without their versions."""
    return set(re.findall(r"\bUND\s+([A-Za-z_]\w*)", read("--dyn-syms", path)))


def relocations_are_read_only(path):
    assert "GNU_RELRO" in read("-l", path), f"{path}: no RELRO"
    assert re.search(r"\b(BIND_)?NOW\b", read("-d", path)), f"{path}: bound lazily"


def code_has_no_fixed_address(path):
    kind = re.search(r"Type:\s+(\w+)", read("-h", path))[1]
    assert kind == "DYN", f"{path}: ELF type {kind}"


def nothing_can_be_written_and_executed(path):
    segments = re.findall(r"^\s+(?:LOAD|GNU_STACK)\b.*\s([R ][W ][E ])\s+0x[0-9a-f]+$",
                          read("-l", path), re.M)
    assert len(segments) >= 3, f"{path}: segments {segments}"
    assert "RWE" not in segments, f"{path}: segments {segments}"


def stacks_are_guarded(path):
    assert "__stack_chk_fail" in imported(path), f"{path}: no stack protector"


def lengths_are_checked(path):
    checked = {name for name in imported(path) if re.fullmatch(r"__\w+_chk", name)}
    assert checked, f"{path}: no function of FORTIFY"


def main():
    checks = [relocations_are_read_only, code_has_no_fixed_address,
              nothing_can_be_written_and_executed, stacks_are_guarded]
    if sys.argv[1] == "1":
        checks.append(lengths_are_checked)
    cases.run([(f"{check.__name__}({os.path.basename(path)})", functools.partial(check, path))
               for path in sys.argv[2:] for check in checks])


if __name__ == "__main__":
    main()
