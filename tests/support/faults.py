# SPDX-License-Identifier: MIT
"""Makes the n-th Vulkan call of a tool fail, through the layer of fault_layer.c."""
import json
import os
import re

DEVICE_LOST, OUT_OF_HOST_MEMORY, OUT_OF_DEVICE_MEMORY = -4, -1, -2
NAMES = {DEVICE_LOST: 'device lost', OUT_OF_HOST_MEMORY: 'out of host memory',
         OUT_OF_DEVICE_MEMORY: 'out of device memory'}
# What the tools are to say: the device 5, memory 33.
CODES = {DEVICE_LOST: 5, OUT_OF_HOST_MEMORY: 33, OUT_OF_DEVICE_MEMORY: 33}


def environment(layer, directory, log=None, fault=None):
    """fault: (name of the function or '*', number of the call from 1, VkResult)."""
    manifest = os.path.join(directory, 'fault.json')
    if not os.path.exists(manifest):
        os.makedirs(directory, exist_ok=True)
        with open(manifest, 'w', encoding='utf-8') as file:
            json.dump({'file_format_version': '1.1.2',
                       'layer': {'name': 'VK_LAYER_VKAO_fault', 'type': 'INSTANCE',
                                 'library_path': os.path.abspath(layer), 'api_version': '1.1.0',
                                 'implementation_version': '1', 'description': 'one call fails'}},
                      file)
    env = {'VK_LAYER_PATH': directory, 'VK_INSTANCE_LAYERS': 'VK_LAYER_VKAO_fault'}
    if log:
        env['VKAO_FAULT_LOG'] = log
    if fault:
        env['VKAO_FAULT'] = ':'.join(map(str, fault))
    return env


def without_leaks(env):
    """Not asked for here: drivers and layers are unloaded before the sanitizer looks, and what Dear
    ImGui had when it was left goes with the process."""
    return {**env, 'ASAN_OPTIONS': env.get('ASAN_OPTIONS', '') +
            ':detect_leaks=0:verify_asan_link_order=0'}


def is_message(stderr):
    """One line, before it at most that of the library, whose log the tools show; then a hint."""
    return re.fullmatch(r'(vkao: \S.*\n){1,2}( +\S.*\n)?', stderr) is not None


def read_log(path):
    with open(path, encoding='utf-8') as file:
        return file.read().split()


def first_and_last_calls(log):
    """(function, number among its own calls) of the first and the last of each."""
    rows = []
    for name in dict.fromkeys(log):
        rows += [(name, n) for n in dict.fromkeys((1, log.count(name)))]
    return rows


def taking_turns(log):
    """One fault a function, for tests that are short: first and last calls and results in turn."""
    results = (DEVICE_LOST, OUT_OF_HOST_MEMORY, DEVICE_LOST, OUT_OF_DEVICE_MEMORY)
    names = list(dict.fromkeys(log))
    return [(name, 1 if i // 2 % 2 else log.count(name), results[i % 4])
            for i, name in enumerate(names)]
