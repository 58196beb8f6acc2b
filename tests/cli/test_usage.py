#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The command line itself: help, version, and every wrong use of an option."""
import re

from cli import OK, USAGE, case, cases, check, equal, main, matches, write_exr
from scene import Scene

EXAMPLE = 'example: vkao '

WRONG_VALUES = [
    ('--slices', ('0', '65', '1.5'), '>= 1 and <= 64'),
    ('--steps', ('0', '257', '-1'), '>= 1 and <= 256'),
    ('--thickness', ('0', '9', 'nan'), '> 0 and <= 8'),
    ('--quality', ('ultra', '1'), 'want fast, default, high or best'),
    ('--samples', ('0', '1025', '-1', '1.5', 'many', '1e9', '99999999999999999999'),
     'whole number'),
    ('--radius', ('0', '-1', 'nan', 'inf', '1e-50', '1e39', 'far', '1m', '0px', '-5%',
                  'px', '%', '25 px', '5%%', '1e39px'), 'finite number > 0'),
    ('--bias', ('-0.1', '1.1', 'nan', 'x'), '>= 0 and <= 1'),
    ('--blocking-scale', ('0', '-3', 'inf'), '> 0'),
    ('--noise-index', ('-1', '4294967296', '0.5'), 'whole number >= 0 and <= 4294967295'),
    ('--intensity', ('-1', '8.1', 'nan'), '>= 0 and <= 8'),
    ('--power', ('0', '-1', '8.5'), '> 0 and <= 8'),
    ('--blur', ('17', '-1', '2.5', 'on'), 'whole number >= 0 and <= 16'),
    ('--blur-sharpness', ('-1', '10001', 'nan'), '>= 0 and <= 10000'),
    ('--blur-normal-power', ('-1', '129'), '>= 0 and <= 128'),
    ('--strength', ('-0.1', '1.1', 'nan'), '>= 0 and <= 1'),
    ('--tint', ('0', '0,0', '0,0,0,0', '0,0,2', '0,-1,0', 'a,b,c', '0,,0', '0,0,0,'),
     'R,G,B, each >= 0 and <= 1'),
    ('--threads', ('-1', '257', '1.5'), 'whole number >= 0 and <= 256'),
    ('--ortho', ('0', '-1', 'inf', 'nan'), '> 0'),
    ('--near', ('0', '-1', 'nan', 'x'), '> 0'),
    ('--far', ('0', '-1', 'nan', 'x'), '> 0'),
    ('--fov', ('0', '180', '-5', 'nan', '40:x', '40:', 'wide'), 'want degrees > 0 and < 180'),
    ('--mode', ('AO', 'both'), 'want ao, append or comp'),
    ('--pixel-type', ('uint', 'HALF'), 'want half or float'),
    ('--compression', ('lzma', 'ZIP', 'htj2k32'), 'none, rle, zips, zip, piz'),
    ('--overwrite', ('yes', 'no'), 'want never, always or skip'),
    ('--frames-syntax', ('nuke',), 'want vfx or openjd'),
    ('--depth-type', ('linear', 'z'), 'want auto, planar, radial, radial-near, inverse, device or '
     'normalized'),
    ('--normal-space', ('view', 'tangent'), 'want auto, world or camera'),
    ('--normal-encoding', ('octahedral',), 'want auto, signed or unsigned'),
    ('--method', ('ssao', 'spheres'), 'want sphere, hemisphere, hbao, gtao, vbao or raymarch'),
    ('--sphere-form', ('crytek',), 'want rescaled or literal'),
    ('--falloff', ('linear',), 'want smooth or threshold'),
]
TEXTS = ('--output', '--preview', '--part-name', '--depth', '--normal', '--color', '--view',
         '--camera', '--frames', '--device', '--thickness-channel', '--back-depth', '--layer2',
         '--channel', '--depth-file', '--normal-file', '--color-file', '--indirect', '--albedo',
         '--specular', '--roughness', '--holdout', '--no-cast')
FLAGS = ('--continue-on-error', '--validation', '--verbose', '--quiet')


def fails(scratch, message, *arguments, hint=None):
    return scratch.fails(USAGE, message, *arguments, hint=hint)


@cases(WRONG_VALUES)
def values_are_checked(scratch, option, values, wanted):
    for value in values:
        result = fails(scratch, rf"{option} is '?{re.escape(value)}'?, want",
                       'in.exr', '-o', 'out.exr', option, value)
        check(wanted in result.stderr, f'{option} {value}: "{wanted}" is not in: {result.stderr}')


@cases([(o, 'x') for o in TEXTS])
def texts_are_not_empty(scratch, option, _):
    fails(scratch, rf'{option} is empty', 'in.exr', '-o', 'out.exr', option, '')


@cases([('--channel', 'x'), ('--part-name', 'x')])
def names_are_no_longer_than_exr_has_them(scratch, option, _):
    fails(scratch, rf'{option} is of 256 bytes, want at most 255', 'in.exr', '-o', 'out.exr',
          option, 'n' * 256)


@case
def input_is_not_empty(scratch):
    fails(scratch, 'INPUT is empty', '', '-o', 'out.exr')


@cases([(o, 'x') for o in [w[0] for w in WRONG_VALUES] + list(TEXTS)])
def arguments_are_needed(scratch, option, _):
    fails(scratch, rf"option '{option}' needs an argument", 'in.exr', option, hint=EXAMPLE)


@cases(FLAGS)
def flags_take_no_argument(scratch, flag):
    fails(scratch, f"option '{flag}=1' takes no argument", 'in.exr', f'{flag}=1')


@cases([('--raduis', '--radius'), ('--radious', '--radius'), ('--normals', '--normal'),
        ('--smaples', '--samples'), ('--colour', '--color'), ('--overwrit', None),
        ('--framse', '--frames'), ('--intesity', '--intensity')])
def misspelt_options_are_suggested(scratch, wrong, right):
    if right is None:  # an unambiguous beginning is the option
        fails(scratch, "--overwrite is 'maybe'", 'in.exr', '-o', 'out.exr', wrong, 'maybe')
        return
    fails(scratch, rf"unknown option '{wrong}' \(did you mean {right}\?\)", 'in.exr', '-o',
          'out.exr', wrong, '0.5', hint=EXAMPLE)


@cases([('png', 'ao.png', '-o ao.exr --preview ao.png'), ('upper case', 'AO.PNG', '--preview'),
        ('directory', 'out/x.tif', '-o out/x.tif.exr'), ('none', 'ao', '-o ao.exr'),
        ('pipe', '-', '-o ao.exr'), ('dots alone', '.exr', '-o ao.exr')])
def output_must_be_called_exr(scratch, _, name, remedy):
    fails(scratch, f"--output is '{name}', want a name that ends in .exr", 'in.exr', '-o', name,
          hint=re.escape(remedy))


@cases(['ao.jpg', 'ao', 'mine.exr', 'ao.png.tif'])
def preview_must_be_called_png(scratch, name):
    write_exr(scratch.path('in.exr'), {'Z': Scene(32, 18).depth()})
    scratch.write('mine.exr', 'mine')
    fails(scratch, f"--preview is '{name}', want a name that ends in .png: PNG is what is written",
          'in.exr', '-o', 'ao.exr', '--preview', name, '--overwrite', 'always',
          hint=f'--preview {name}.png')
    scratch.render('in.exr', '-o', 'ao.exr', '--preview', 'AO.PNG')


@case
def extension_may_be_upper_case(scratch):
    write_exr(scratch.path('in.exr'), {'Z': Scene(32, 18).depth()})
    scratch.render('in.exr', '-o', 'AO.EXR')
    equal(scratch.files(), ['AO.EXR', 'in.exr'], 'files')


@case
def unknown_options_without_likeness(scratch):
    fails(scratch, "unknown option '--gobbledygook'$", 'in.exr', '--gobbledygook', hint='--help')
    fails(scratch, "unknown option '-z'$", 'in.exr', '-z', hint='--help')


@cases([
    ('nothing', (), 'no INPUT given'),
    ('no output', ('in.exr',), 'no output given: -o FILE'),
    ('no input', ('-o', 'out.exr'), 'no INPUT given'),
    ('two inputs', ('a.exr', 'b.exr', '-o', 'out.exr'), "one INPUT at a time, got 'a.exr' and"),
    ('command', ('inspct', 'in.exr'), r"unknown command 'inspct' \(did you mean inspect\?\)"),
    ('devices', ('devices', 'in.exr'), "takes no INPUT, got 'in.exr'"),
    ('inspect -o', ('inspect', 'in.exr', '-o', 'x.exr'), "'--output' has no meaning for"),
    ('render --json', ('render', 'in.exr', '--json'), "'--json' has no meaning for 'vkao render'"),
    ('cameras', ('in.exr', '-o', 'x.exr', '--fov', '40', '--ortho', '2'), 'exclude each other'),
    ('thickness twice', ('in.exr', '-o', 'x.exr', '--thickness-channel', 'T', '--back-depth', 'B'),
     '--thickness-channel and --back-depth exclude each other'),
    ('thickness of gtao', ('in.exr', '-o', 'x.exr', '-m', 'gtao', '--thickness-channel', 'T'),
     '--thickness-channel needs --method vbao or raymarch'),
    ('back depth of hbao', ('in.exr', '-o', 'x.exr', '-m', 'hbao', '--back-depth', 'B'),
     '--back-depth needs --method vbao or raymarch'),
    ('layer2 of sphere', ('in.exr', '-o', 'x.exr', '-m', 'sphere', '--layer2', 'L'),
     '--layer2 needs --method vbao or raymarch'),
])
def command_lines_are_checked(scratch, _, arguments, message):
    fails(scratch, message, *arguments)


@cases([('-r', '.3'), ('--bias', '.1'), ('-m', 'gtao')])
def inspect_says_which_options_it_takes(scratch, *option):
    fails(scratch, "has no meaning for 'vkao inspect'", 'inspect', 'in.exr', *option,
          hint='takes the options that say what the file holds')


@case
def help_explains_every_option(scratch):
    for arguments in (('--help',), ('-h',), ('render', '--help'), ('inspect', '--help'),
                      ('in.exr', '--help')):
        run = scratch.run(*arguments)
        equal((run.code, run.stderr), (OK, ''), f'{arguments}: exit code and stderr')
        matches('^Usage: vkao ', run.stdout, 'stdout')
        for option in [w[0] for w in WRONG_VALUES] + list(TEXTS) + list(FLAGS):
            matches(rf'(?m)^  (-., |    ){option}\b', run.stdout, f'help of {option}')
        longest = max(len(line) for line in run.stdout.splitlines())
        check(longest <= 80, f'a line of {longest} columns')


def defaults_in_help(text):
    """Option by option, what stands in '(default: ...)'."""
    found = {}
    for block in re.split(r'\n(?=  (?:-., |    )--)', text):
        option = re.match(r'  (?:-., |    )(--[a-z-]+)', block)
        value = re.search(r'\(default:\s+([^)]+)\)', block)
        if option and value:
            found[option.group(1)] = value.group(1)
    return found


@case
def help_tells_the_defaults_that_hold(scratch):
    defaults = defaults_in_help(scratch.run('--help').stdout)
    for option in ('--samples', '--bias', '--quality', '--method', '--mode', '--compression'):
        check(option in defaults, f'no default of {option} in {defaults}')
    scene = Scene(64, 36)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals()})
    explicit = [word for pair in defaults.items() for word in pair]
    scratch.render('in.exr', '-o', 'a.exr')
    scratch.render('in.exr', '-o', 'b.exr', *explicit)
    equal(scratch.bytes('a.exr'), scratch.bytes('b.exr'), f'the output with {explicit}')


@case
def version_names_the_libraries(scratch):
    for option in ('--version', '-V'):
        run = scratch.run(option)
        equal((run.code, run.stderr), (OK, ''), 'exit code and stderr')
        matches(r'^vkao \d+\.\d+\.\d+\n', run.stdout, 'stdout')
        matches(r'OpenEXR \d+\.\d+\.\d+, reads and writes none .*dwab', run.stdout, 'stdout')
        matches(r'Vulkan loader 1\.\d+\.\d+', run.stdout, 'stdout')


@case
def render_may_be_left_out_and_options_stand_anywhere(scratch):
    scene = Scene(32, 18)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth()})
    lines = (('in.exr', '-o', '1.exr'), ('render', 'in.exr', '--output', '2.exr'),
             ('-o', '3.exr', 'in.exr'), ('in.exr', '--output=4.exr'), ('in.exr', '-o5.exr'),
             ('-o', '6.exr', '--', 'in.exr'))
    for line in lines:
        scratch.render(*line)
    first = scratch.bytes('1.exr')
    for i in range(2, 7):
        equal(scratch.bytes(f'{i}.exr'), first, f'output {i}')


@case
def last_of_an_option_wins(scratch):
    scene = Scene(32, 18)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals()})
    scratch.render('in.exr', '-o', 'a.exr', '--radius', 9, '--normal', 'N', '--radius', 0.5,
                   '--normal', 'none')
    scratch.render('in.exr', '-o', 'b.exr', '--radius', 0.5, '--normal', 'none')
    equal(scratch.bytes('a.exr'), scratch.bytes('b.exr'), 'output')


if __name__ == '__main__':
    main()
