#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""An output is whole or not there, whoever interrupts, reads or writes at the same time."""
import os
import re
import signal
import threading
import time

import numpy as np

from cli import (INTERRUPTED, OK, OUTPUT, TERMINATED, TIMEOUT, case, cases, check, check_ao, equal,
                 main, matches, read_ao, rename_shim, wait_for_stop, write_exr)
from exr_raw import read_raw
from scene import Scene

# Cheap to compute and slow to write: what is interrupted is the writing.
SLOW = ('--samples', 1, '--blur', 'off', '--pixel-type', 'float', '--compression', 'zip',
        '--threads', 1, '--radius', 0.5, '--fov', 60)
ATTEMPTS = 8
HANGUP = 129


def large(scratch):
    """Noise does not compress, and depth alone is quick to read."""
    rng = np.random.default_rng(7)
    depth = (4 + 0.4 * rng.random((1200, 1600))).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth}, compression='none')


def small(scratch):
    scene = Scene(160, 90)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals()})


def default_signals():
    """Shells let the children of background jobs ignore SIGINT."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def temporary(scratch):
    return [f for f in scratch.files() if f.endswith('.tmp')]


def wait_for_temporary(scratch, process):
    """True once the output is being written; False if the process was faster."""
    end = time.monotonic() + TIMEOUT
    while process.poll() is None and time.monotonic() < end:
        names = temporary(scratch)
        if names:
            matches(r'^\.out\.exr\.vkao-.+-\d+-[0-9a-f]{16}\.tmp$', names[0], 'temporary name')
            return True
        time.sleep(0.0005)
    return False


def interrupt_writing(scratch, number, *options):
    """The exit code of a run that got the signal while it wrote."""
    for _ in range(ATTEMPTS):
        if '--overwrite' in options:
            scratch.write('out.exr', 'old')
        elif os.path.exists(scratch.path('out.exr')):
            os.remove(scratch.path('out.exr'))
        arguments = [str(a) for a in ('in.exr', '-o', 'out.exr', *SLOW, *options)]
        process = scratch.start(*arguments, preexec_fn=default_signals)
        found = wait_for_temporary(scratch, process)
        process.send_signal(number)
        process.communicate(timeout=TIMEOUT)
        if found and process.returncode != OK:
            return process.returncode
    check(False, f'no signal arrived while the output was written, in {ATTEMPTS} attempts')


SIGNALS = [('SIGTERM', TERMINATED), ('SIGINT', INTERRUPTED), ('SIGHUP', HANGUP)]


@cases(SIGNALS)
def signal_while_writing_leaves_nothing(scratch, name, code):
    large(scratch)
    equal(interrupt_writing(scratch, getattr(signal, name)), code, 'exit code')
    equal(scratch.files(), ['in.exr'], 'files')


@cases(SIGNALS)
def signal_while_overwriting_leaves_the_old_file(scratch, name, code):
    large(scratch)
    run = interrupt_writing(scratch, getattr(signal, name), '--overwrite', 'always')
    equal(run, code, 'exit code')
    equal(scratch.files(), ['in.exr', 'out.exr'], 'files')
    equal(scratch.bytes('out.exr'), b'old', 'the old file')


@case
def kill_leaves_no_output(scratch):
    large(scratch)
    equal(interrupt_writing(scratch, signal.SIGKILL), -signal.SIGKILL, 'exit code')
    check('out.exr' not in scratch.files(), 'an unfinished output')
    scratch.write('keep', '')
    for name in temporary(scratch):  # nobody can remove it but the user
        os.remove(scratch.path(name))
    scratch.render('in.exr', '-o', 'out.exr', *SLOW)
    check_ao(read_ao(scratch.path('out.exr')), 'the next run')


@case
def kill_while_overwriting_leaves_the_old_file(scratch):
    large(scratch)
    code = interrupt_writing(scratch, signal.SIGKILL, '--overwrite', 'always')
    equal(code, -signal.SIGKILL, 'exit code')
    equal(scratch.bytes('out.exr'), b'old', 'the old file')


def outputs(scratch):
    return {name: scratch.bytes(os.path.join(folder, name)) for folder in ('.', 'png')
            for name in scratch.files(folder) if name.startswith(('out.', '.out.'))}


def stereo(scratch):
    os.mkdir(scratch.path('png'))
    depth = Scene(32, 18).depth()
    for n in (1, 2):
        write_exr(scratch.path(f'in.{n}.exr'), ({'Z': depth}, {'name': 'Z.l', 'view': 'l'}),
                  ({'Z': depth}, {'name': 'Z.r', 'view': 'r'}))


PAIR = ('in.@.exr', '-o', 'out.@.exr', '--view', 'all', '--fov', 60, '--radius', 0.5)


@cases([*((f'here: {n}', '', n) for n in range(1, 7)),
        *((f'apart: {n}', 'png/', n) for n in (2, 3))])
def kill_between_renames_is_mended_by_the_next_run(scratch, _, folder, number):
    """A frame whose EXR file is there has its previews, and one that lacks it is made anew, with
    previews that say whose they are."""
    shim = rename_shim()
    stereo(scratch)
    line = (*PAIR, '--preview', f'{folder}out.@.png', '--overwrite', 'skip')
    scratch.render(*line)
    wanted = outputs(scratch)
    equal(len(wanted), 6, 'outputs')
    for name in wanted:
        os.remove(scratch.path(folder if name.endswith('png') else '', name))
    run = scratch.run(*line, env={**shim, 'VKAO_KILL_AT': str(number)})
    equal(run.code, -signal.SIGKILL, 'exit code')
    left = outputs(scratch)
    equal(len([name for name in left if not name.endswith('.tmp')]), number - 1, 'files renamed')
    for n in (1, 2):
        check(f'out.{n}.exr' not in left or {f'out.{n}.l.png', f'out.{n}.r.png'} <= {*left},
              f'{n} has lost a preview: {[*left]}')
    for name in [name for name in left if name.endswith('.tmp')]:
        os.remove(scratch.path(folder if '.png.' in name else '', name))
    scratch.render(*line)
    equal(outputs(scratch), wanted, 'what the next run makes of it')


@cases([*((f'{n}, the other all', n, 7) for n in range(1, 7)), ('1 and 2', 1, 2),
        ('1 and 3', 1, 3), ('2 and 1', 2, 1), ('2 and 2', 2, 2), ('3 and 2', 3, 2),
        ('3 and 3', 3, 3), ('4 and 2', 4, 2)])
def runs_that_share_a_sequence_leave_what_the_other_has_made(scratch, _, first, second):
    """Each stops before a rename until the other has ended, or has stopped too."""
    shim, line = rename_shim(), (*PAIR, '--preview', 'out.@.png', '--overwrite', 'skip')
    stereo(scratch)
    scratch.render(*line)
    wanted = outputs(scratch)
    for name in wanted:
        os.remove(scratch.path(name))
    runs = []
    for number in first, second:
        runs.append(scratch.start(*(str(a) for a in line),
                                  env={**shim, 'VKAO_STOP_AT': str(number)}))
        if number < 7:
            wait_for_stop(runs[-1])
        else:
            runs[-1].said = runs[-1].communicate(timeout=TIMEOUT)[1]
    for run in runs:
        if run.returncode is None:
            run.send_signal(signal.SIGCONT)
            run.said = run.communicate(timeout=TIMEOUT)[1]
    for run in runs:
        equal(run.returncode, OK, run.said)
    equal(outputs(scratch), wanted, 'what they have made')


@cases([('of another output', ('-o', 'other.1.exr')), ('without a note', ('by hand',)),
        ('pipe', ('pipe',))])
def previews_of_others_stop_the_run(scratch, _, maker):
    stereo(scratch)
    line = ('in.1.exr', *PAIR[3:], '--preview', 'out.png', '-o')
    if maker[0] == '-o':
        scratch.render(*line, 'other.1.exr')
        os.remove(scratch.path('other.1.exr'))
    elif maker[0] == 'pipe':
        os.mkfifo(scratch.path('out.l.png'))
    else:
        scratch.write('out.l.png', b'\x89PNG\r\n\x1a\n')
    scratch.fails(OUTPUT, r'out\.l\.png: exists, not overwritten', *line, 'out.1.exr',
                  '--overwrite', 'skip', hint='remove it', timeout=20)


@case
def leftovers_of_a_killed_run_do_not_disturb(scratch):
    small(scratch)
    scratch.write('.out.exr.vkao-host-1-0123456789abcdef.tmp', 'left')
    run = scratch.run('in.exr', '-o', 'out.exr')
    equal(run.code, OK, f'exit code of {run}')
    equal(len(temporary(scratch)), 1, 'number of temporary files')


@case
def signals_at_any_time_leave_nothing(scratch):
    small(scratch)
    whole = scratch.render('in.exr', '-o', 'out.exr').seconds
    os.remove(scratch.path('out.exr'))
    codes = []
    for i in range(12):
        process = scratch.start('in.exr', '-o', 'out.exr', preexec_fn=default_signals)
        time.sleep(whole * i / 10)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=TIMEOUT)
        codes.append(process.returncode)
        # -SIGTERM: before main() could ask for it, or while a driver was being loaded.
        check(process.returncode in (OK, TERMINATED, -signal.SIGTERM), f'exit code {codes}')
        check(not temporary(scratch), f'{temporary(scratch)} after {codes}')
        exists = os.path.exists(scratch.path('out.exr'))
        if exists:
            check_ao(read_ao(scratch.path('out.exr')), 'an interrupted output')
            os.remove(scratch.path('out.exr'))
        check(exists or process.returncode != OK, 'exit code 0 without an output')
    check(TERMINATED in codes, f'no run was interrupted: {codes}')


@case
def ignored_signals_stay_ignored(scratch):
    small(scratch)

    def ignore():
        signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does
    process = scratch.start('in.exr', '-o', 'out.exr', preexec_fn=ignore)
    while process.poll() is None:
        process.send_signal(signal.SIGHUP)
        time.sleep(0.005)
    process.communicate(timeout=TIMEOUT)
    equal(process.returncode, OK, 'exit code')
    check('out.exr' in scratch.files(), 'no output')


@case
def readers_see_whole_files_alone(scratch):
    small(scratch)
    whole = []
    for radius in (0.3, 0.6):
        scratch.render('in.exr', '-o', 'out.exr', '--radius', radius, '--overwrite', 'always')
        whole.append(scratch.bytes('out.exr'))
    seen, stop, wrong = [0, 0], threading.Event(), []

    def read():
        while not stop.is_set():
            try:
                seen[whole.index(scratch.bytes('out.exr'))] += 1
            except (OSError, ValueError) as error:
                wrong.append(str(error)[:200])
                return
    reader = threading.Thread(target=read)
    reader.start()
    try:
        for i in range(10):
            scratch.render('in.exr', '-o', 'out.exr', '--radius', (0.3, 0.6)[i % 2],
                           '--overwrite', 'always')
    finally:
        stop.set()
        reader.join()
    check(not wrong, f'a reader met something else: {wrong}')
    check(min(seen) > 20, f'a reader saw {seen} files of each kind')


@case
def one_of_many_writers_wins(scratch):
    small(scratch)
    for _ in range(3):
        radii = [0.1, 0.2, 0.3, 0.4]
        processes = [scratch.start('in.exr', '-o', 'out.exr', '--radius', str(r)) for r in radii]
        for process in processes:
            _, process.text = process.communicate(timeout=TIMEOUT)
        codes = [p.returncode for p in processes]
        equal(sorted(codes), [OK] + [OUTPUT] * 3, 'exit codes')
        for process in processes:
            if process.returncode == OUTPUT:
                matches(r'vkao: out\.exr: exists, not overwritten', process.text, 'a loser')
        parameters = read_raw(scratch.bytes('out.exr'))[0].text('vkao/params')
        radius = re.search(r'"radius":([0-9.]+)', parameters).group(1)
        equal(float(radius), radii[codes.index(OK)], 'radius in the file of the winner')
        equal(scratch.files(), ['in.exr', 'out.exr'], 'files')
        os.remove(scratch.path('out.exr'))


@case
def overwriting_through_a_link_keeps_the_link(scratch):
    small(scratch)
    os.mkdir(scratch.path('disk'))
    scratch.write('disk/real.exr', 'old')
    os.symlink('disk/real.exr', scratch.path('out.exr'))
    scratch.render('in.exr', '-o', 'out.exr', '--overwrite', 'always')
    check(os.path.islink(scratch.path('out.exr')), 'the link became a file')
    check_ao(read_ao(scratch.path('disk', 'real.exr')), 'the file behind the link')
    equal(scratch.files('disk'), ['real.exr'], 'files on the other disk')


@case
def permissions_of_an_overwritten_file_stay(scratch):
    small(scratch)
    scratch.write('out.exr', 'old')
    os.chmod(scratch.path('out.exr'), 0o640)
    scratch.render('in.exr', '-o', 'out.exr', '--overwrite', 'always')
    equal(oct(os.stat(scratch.path('out.exr')).st_mode & 0o777), '0o640', 'permissions')
    mask = os.umask(0o027)
    try:
        scratch.render('in.exr', '-o', 'new.exr')
    finally:
        os.umask(mask)
    equal(oct(os.stat(scratch.path('new.exr')).st_mode & 0o777), '0o640', 'umask')


if __name__ == '__main__':
    main()
