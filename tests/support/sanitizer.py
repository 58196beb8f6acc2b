# SPDX-License-Identifier: MIT
"""What programs built with AddressSanitizer want of their environment."""
import functools
import os


@functools.lru_cache
def is_sanitized(program):
    with open(program, 'rb') as file:
        return b'__asan_init' in file.read()


def loaded_driver(program):
    """For the environment of a sanitized program: the driver stays loaded, or what its globals hold
    would seem lost once the instance unloads it."""
    if not is_sanitized(program):
        return {}
    return {'LD_PRELOAD': 'libvulkan_lvp.so',
            'ASAN_OPTIONS': os.environ.get('ASAN_OPTIONS', '') + ':verify_asan_link_order=0'}
