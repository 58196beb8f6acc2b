#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What the README says about memory is what vkao_frame_scratch says.

usage: test_readme_tables.py README.md VKAO_BENCH
"""

import os
import re
import subprocess
import sys

from cases import Skip, run

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from sanitizer import loaded_driver  # noqa: E402, after its directory is known

README, BENCH = sys.argv[1:]


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def readme_table(first):
    """Rows of the table whose header begins with this cell: lists of cells, the header first."""
    lines = open(README, encoding="utf-8").read().splitlines()
    for begin, line in enumerate(lines):
        if line.startswith("|") and cells(line)[0] == first:
            end = begin
            while end < len(lines) and lines[end].startswith("|"):
                end += 1
            return [cells(line) for line in lines[begin:end]]
    raise Skip(f"README.md has no table that begins with '{first}'")


def memory_table_is_what_vkao_frame_scratch_says():
    said = readme_table("scratch, MB")
    sizes = ",".join(re.sub(r"\s*[x×]\s*", "x", cell) for cell in said[0][1:])
    done = subprocess.run([BENCH, "speed", "--memory", "--markdown", "--device", "cpu", "--size",
                           sizes], capture_output=True, text=True,
                          env={**os.environ, **loaded_driver(BENCH)})
    assert done.returncode == 0, done.stderr
    table = [cells(line) for line in done.stdout.splitlines()]
    assert len(said) > 2, f"the table has no rows: {said}"
    for row in said[:1] + said[2:]:
        assert row in table, f"the README says {row}; vkao-bench speed --memory says {table}"


if __name__ == "__main__":
    run([(f.__name__, f) for f in (memory_table_is_what_vkao_frame_scratch_says,)])
