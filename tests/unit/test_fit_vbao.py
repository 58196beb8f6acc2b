#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The search of tools/bench/fit-vbao: what it finds, what it changes, and what it refuses."""
import importlib.util
import math
import os
import subprocess
import sys
import tempfile
import unittest
from importlib.machinery import SourceFileLoader

sys.dont_write_bytecode = True
ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..'))
PROGRAM = os.path.join(ROOT, 'tools', 'bench', 'fit-vbao')
loader = SourceFileLoader('fit_vbao', PROGRAM)
fit_vbao = importlib.util.module_from_spec(importlib.util.spec_from_loader('fit_vbao', loader))
loader.exec_module(fit_vbao)

with open(os.path.join(ROOT, 'shaders', 'params.h'), encoding='utf-8') as params:
    PARAMS = params.read()


class Search(unittest.TestCase):
    TARGET = {'a': 0.7, 'b': 0.2, 'c': 3.0}

    def run_search(self, start, names, least=0.01, allowed=lambda values: True):
        self.asked, self.told = [], []

        def error_of(values):
            self.asked.append(tuple(values.values()))
            return 1 + sum(math.log(values[n] / self.TARGET[n]) ** 2 for n in self.TARGET)

        return fit_vbao.search(start, names, error_of, allowed, 0.2, least, 1e-7,
                               lambda values, error: self.told.append(error))

    def test_finds_the_least_error(self):
        found, error = self.run_search({'a': 0.4, 'b': 0.5, 'c': 2.9}, ['a', 'b', 'c'])
        for name, value in self.TARGET.items():
            self.assertLess(abs(found[name] / value - 1), 0.02, name)
        self.assertLess(error, 1.0003)
        self.assertEqual(len(self.asked), len(set(self.asked)), 'the same was asked twice')
        self.assertEqual(self.told, sorted(self.told, reverse=True))
        self.assertEqual(self.told[-1], error)

    def test_leaves_the_other_constants(self):
        found, _ = self.run_search({'a': 0.4, 'b': 0.5, 'c': 2.9}, ['b'])
        self.assertEqual((found['a'], found['c']), (0.4, 2.9))
        self.assertLess(abs(found['b'] / 0.2 - 1), 0.02)

    def test_does_not_leave_its_bounds(self):
        start = {'a': 0.4, 'b': 0.5, 'c': 2.9}
        found, _ = self.run_search(start, ['a', 'b', 'c'], allowed=lambda v: v['a'] <= 0.55)
        self.assertTrue(0.54 < found['a'] <= 0.55, found['a'])
        self.assertLess(abs(found['b'] / 0.2 - 1), 0.02)

    def test_a_step_of_nothing_measures(self):
        found, _ = fit_vbao.search({'a': 1.0}, ['a'], lambda values: 5.0, lambda values: True, 0,
                                   0.01, 0, lambda values, error: None)
        self.assertEqual(found, {'a': 1.0})


class Constants(unittest.TestCase):
    def test_all_fitted_ones_are_read(self):
        values = fit_vbao.read_constants(PARAMS)
        for name in ('VBAO_REACH_SMOOTH', 'STEP_LINEAR', 'VBAO_THICKNESS_WIDTH', 'VBAO_GAP_FRONT'):
            self.assertIn(name, values)
        self.assertNotIn('VBAO_MOST_AT_ONCE', values)

    def test_only_what_is_named_changes(self):
        values = fit_vbao.read_constants(PARAMS)
        self.assertEqual(fit_vbao.read_constants(fit_vbao.with_constants(PARAMS, values)), values)
        changed = fit_vbao.with_constants(PARAMS, {'VBAO_GAP_FRONT': 2})
        self.assertEqual(fit_vbao.read_constants(changed), {**values, 'VBAO_GAP_FRONT': 2.0})
        lines = [(a, b) for a, b in zip(PARAMS.splitlines(), changed.splitlines()) if a != b]
        self.assertEqual(len(lines), 1)
        self.assertTrue(lines[0][1].startswith('#define VKAO_VBAO_GAP_FRONT 2.0 '), lines[0][1])
        self.assertEqual(lines[0][0].split('/*')[1], lines[0][1].split('/*')[1])

    def test_only_files_that_name_it_are_built_again(self):
        with tempfile.TemporaryDirectory() as folder:
            source = fit_vbao.Source(os.path.join(folder, 'source'))
            before = os.stat(source.params).st_mtime_ns
            touched = [os.path.relpath(p, source.folder)
                       for p in source.set_constants({**source.values, 'THICKNESS_SLOPE': 0.5})]
            self.assertIn(os.path.join('lib', 'ssao.c'), touched)
            self.assertNotIn(os.path.join('shaders', 'blur.comp'), touched)
            self.assertEqual(os.stat(source.params).st_mtime_ns, before)
            self.assertIn('#define VKAO_THICKNESS_SLOPE 0.5\n', fit_vbao.read(source.params))
            self.assertEqual(source.set_constants(source.values), [])
        with open(os.path.join(ROOT, 'shaders', 'params.h'), encoding='utf-8') as file:
            self.assertEqual(file.read(), PARAMS)


class Scenes(unittest.TestCase):
    def test_none_is_fitted_to_and_checked_with(self):
        scenes = ['a', 'b', 'c', 'd', 'e', 'f']
        for fit, check, wanted in ((None, None, (['a', 'b', 'd', 'e'], ['c', 'f'])),
                                   (None, 'a,[de]', (['b', 'c', 'f'], ['a', 'd', 'e'])),
                                   ('c,a', None, (['a', 'c'], ['f']))):
            self.assertEqual(fit_vbao.choose_scenes(scenes, fit, check), wanted)
        with self.assertRaisesRegex(ValueError, 'both fitted to and checked with: b'):
            fit_vbao.choose_scenes(scenes, 'a,b', 'b,c')
        with self.assertRaisesRegex(ValueError, 'no G-buffer'):
            fit_vbao.choose_scenes(scenes, 'x', None)

    def test_the_command_says_what_it_would_do(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ('one.exr', 'one.camera.json', 'one.gt.exr', 'two.exr', 'two.camera.json',
                         'two.left.gt.exr', 'no_truth.exr', 'no_truth.camera.json'):
                open(os.path.join(folder, name), 'w', encoding='utf-8').close()

            def run(*words):
                return subprocess.run([sys.executable, PROGRAM, folder, '--dry-run', *words],
                                      text=True, capture_output=True)
            done = run('--check', 't*', '--constants', 'STEP_LINEAR')
            self.assertRegex(done.stdout, r'^constants: STEP_LINEAR [\d.]+\n'
                                          r'fit to: one\ncheck with: two\n$')
            done = run('--constants', 'NONE')
            self.assertEqual((done.returncode, done.stdout), (1, ''))
            self.assertRegex(done.stderr, r'^fit-vbao: --constants: no NONE .*known: .*STEP_LINEAR')


if __name__ == '__main__':
    unittest.main()
