# SPDX-License-Identifier: MIT
"""Named cases that report as cmocka does. Exit status: 0 passed, 1 failed, 77 all skipped."""

import re
import sys


class Skip(Exception):
    """Raised by a case that cannot run here."""


def run(cases):
    """Runs (name, function) pairs, prints a line for each and exits."""
    failed, passed = [], 0
    for name, case in cases:
        try:
            case()
            passed += 1
            print(f"[       OK ] {name}")
        except Skip as reason:
            print(f"[  SKIPPED ] {name}: {reason}")
        except AssertionError as reason:
            failed.append(name)
            print(f"{reason}\n[  FAILED  ] {name}")
    sys.stdout.flush()
    sys.exit(1 if failed else 0 if passed else 77)


def without_comments(source):
    """C source less its comments."""
    return re.sub(r"/\*.*?\*/|//[^\n]*", " ", source, flags=re.S)
