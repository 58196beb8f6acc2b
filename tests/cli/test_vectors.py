#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""How many bits Mesa's lavapipe computes on at a time: 512 where that is faster."""
import os
import re

from cli import case, check, equal, main, read_ao, write_exr
from scene import FOV, RADIUS, Scene

SCENE = Scene(96, 54)
NARROW, WIDE = 256, 512
for of_the_tests in ('LP_NATIVE_VECTOR_WIDTH', 'GALLIVM_PERF'):
    os.environ.pop(of_the_tests, None)


def is_wide(scratch):
    """From the kernel: AMD's from Zen 5 on. And with the loader of Debian 12."""
    if 'Vulkan loader 1.3.239\n' not in scratch.run('--version').stdout:
        return False
    with open('/proc/cpuinfo', encoding='utf-8') as file:
        lines = [line.split(':', 1) for line in file if ':' in line]
    info = {key.strip(): value.strip() for key, value in reversed(lines)}
    flags = {'avx512f', 'avx512bw', 'avx512dq', 'avx512vl'}
    return (info.get('vendor_id') == 'AuthenticAMD' and int(info['cpu family']) >= 26 and
            flags <= set(info['flags'].split()))


def width(scratch, **more):
    result = scratch.run('devices', env=more)
    equal(result.code, 0, f'exit code of {result}')
    found = re.search(r'llvmpipe \(LLVM [\d.]+, (\d+) bits\)', result.stdout)
    check(found, f'no width in {result}')
    return int(found[1])


def render(scratch, target, **more):
    scratch.render('in.exr', '-o', target, '--fov', FOV, '--radius', RADIUS, '--device', 'cpu',
                   env=more)
    return scratch.bytes(target)


@case
def the_processor_decides(scratch):
    as_it_comes = width(scratch, GALLIVM_PERF='nopt')
    check(as_it_comes <= NARROW, f'{as_it_comes} bits when it is left alone')
    equal(width(scratch), WIDE if is_wide(scratch) else as_it_comes, 'width')


@case
def what_the_user_says_wins(scratch):
    equal(width(scratch, LP_NATIVE_VECTOR_WIDTH='128'), 128, 'width')


@case
def programs_of_another_width_may_share_the_cache(scratch):
    """Mesa's key of a shader on disk lacks the width."""
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth(), **SCENE.normals()})
    cache = {'MESA_SHADER_CACHE_DIR': scratch.path('cache')}

    def stored():
        return {name for _, _, names in os.walk(scratch.path('cache')) for name in names}

    narrow = render(scratch, 'narrow.exr', LP_NATIVE_VECTOR_WIDTH=str(NARROW), **cache)
    before = stored()
    check(before, 'nothing in the cache')
    chosen = render(scratch, 'chosen.exr', **cache)
    if is_wide(scratch):
        check(stored() > before, 'the code of another width was run')
    equal(chosen, narrow, 'the picture')
    check(read_ao(scratch.path('chosen.exr')).min() < 0.9, 'nothing is occluded')


if __name__ == '__main__':
    main()
