#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The library, installed, in each way that programs take it.

usage: test_linking.py SOURCE_ROOT WORK_DIR MESON

Meson builds the library alone and installs it into WORK_DIR, where a further run finds it.
Consumers know of the source tree only where they build it themselves.
"""

import glob
import os
import re
import shlex
import shutil
import struct
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "header"))
from cases import Skip, run, without_comments  # noqa: E402, after its directory is known

SOURCE, WORK = map(os.path.abspath, sys.argv[1:3])
MESON = sys.argv[3]
PREFIX = os.path.join(WORK, "prefix")


def execute(command, env=None, cwd=None, ok=(0,)):
    done = subprocess.run(command, capture_output=True, text=True, cwd=cwd,
                          env={**os.environ, **(env or {})})
    assert done.returncode in ok, \
        f"{' '.join(command)}: exit status {done.returncode}\n{done.stdout}{done.stderr}"
    return done


def need(*programs):
    for program in programs:
        if not shutil.which(program):
            raise Skip(f"no {program}")


def folder(name):
    """An empty one."""
    path = os.path.join(WORK, name)
    shutil.rmtree(path, ignore_errors=True)
    os.makedirs(path)
    return path


def install(prefix=PREFIX, libdir=None, includedir="include"):
    """Builds the library alone and installs it; what was built before is used."""
    build = os.path.join(WORK, "library")
    # What meson takes by itself, said in full: another folder may have been asked for before.
    libdir = libdir or "/".join(["lib", *execute(["cc", "-print-multiarch"]).stdout.split()])
    again = ["--reconfigure"] if os.path.exists(os.path.join(build, "build.ninja")) else []
    execute([MESON, "setup", build, SOURCE, *again, f"--prefix={prefix}", f"-Dlibdir={libdir}",
             f"-Dincludedir={includedir}", "-Dtools=false", "-Ddefault_library=both",
             "-Dwerror=true"])
    execute([MESON, "compile", "-C", build])
    execute([MESON, "install", "-C", build, "--no-rebuild"])


def installed(pattern):
    found = glob.glob(os.path.join(PREFIX, pattern), recursive=True)
    assert found, f"{PREFIX} has no {pattern}"
    return found[0]


def pkg_config(*options):
    need("pkg-config")
    path = os.path.dirname(installed("**/vkao.pc"))
    others = os.environ.get("PKG_CONFIG_PATH", "")
    return execute(["pkg-config", *options, "vkao"],
                   env={"PKG_CONFIG_PATH": f"{path}:{others}"}).stdout.split()


def shared_library():
    return installed("**/libvkao.so")


def runtime(extra=None):
    return {"LD_LIBRARY_PATH": os.path.dirname(shared_library()), **(extra or {})}


def loads_libvkao(program):
    need("readelf")
    return "libvkao.so" in execute(["readelf", "-d", program]).stdout


def compile_with_pkg_config(compiler, source, output, static, *libraries):
    """static: of vkao the static library, of all others what there is."""
    flags = pkg_config("--cflags", "--libs", *(["--static"] if static else []))
    if static:
        flags = [installed("**/libvkao.a") if flag == "-lvkao" else flag for flag in flags]
    need(compiler[0])
    execute([*compiler, "-Wall", "-Wextra", "-Werror", source, "-xnone", *flags, *libraries, "-o",
             output])
    assert loads_libvkao(output) != static, f"{output}: not linked as asked"


# --- Programs without a device ---

def links_with_pkg_config(name, compiler, static):
    def case():
        output = os.path.join(folder(name), "smoke")
        compile_with_pkg_config(compiler, os.path.join(HERE, "smoke.c"), output, static)
        execute([output], env=runtime())
    return name, case


def the_package_wants_no_loader():
    """Whoever loads Vulkan at run time has its headers and no vulkan.pc."""
    need("pkg-config")
    alone = {"PKG_CONFIG_LIBDIR": os.path.dirname(installed("**/vkao.pc")), "PKG_CONFIG_PATH": ""}
    for options in (["--cflags"], ["--libs"], ["--libs", "--static"]):
        said = execute(["pkg-config", *options, "vkao"], env=alone).stdout
        assert "vulkan" not in said, said


def static_consumers_get_their_define():
    """On Windows headers must know: VKAO_STATIC comes from pkg-config and from meson."""
    build = os.path.join(WORK, "static")
    shutil.rmtree(build, ignore_errors=True)
    execute([MESON, "setup", build, SOURCE, "-Dtools=false", "-Ddefault_library=static"])
    with open(os.path.join(build, "meson-private", "vkao.pc"), encoding="utf-8") as file:
        text = file.read()
    assert re.search(r"^Cflags:.*-DVKAO_STATIC\b", text, re.M), text
    with open(os.path.join(build, "lib", "vkaoConfig.cmake"), encoding="utf-8") as file:
        assert '"VKAO_STATIC"' in file.read()
    assert "-DVKAO_STATIC" not in pkg_config("--cflags")
    consumer = subproject("static-consumer")
    execute([MESON, "setup", "build", "-Ddefault_library=static"], cwd=consumer)
    with open(os.path.join(consumer, "build", "build.ninja"), encoding="utf-8") as file:
        text = file.read()
    assert re.search(r"build smoke\.p/\S*smoke\.c\.o:.*?ARGS = [^\n]*-DVKAO_STATIC", text, re.S)


def subproject(name):
    consumer = folder(name)
    shutil.copy(os.path.join(HERE, "subproject", "meson.build"), consumer)
    shutil.copy(os.path.join(HERE, "smoke.c"), consumer)
    os.mkdir(os.path.join(consumer, "subprojects"))
    os.symlink(SOURCE, os.path.join(consumer, "subprojects", "vkao"))
    return consumer


def meson_subproject_builds_the_library_alone():
    consumer = subproject("subproject-consumer")
    execute([MESON, "setup", "build"], cwd=consumer)
    with open(os.path.join(consumer, "build", "build.ninja"), encoding="utf-8") as file:
        outputs = re.findall(r"^build (\S+):", file.read(), re.M)
    of_tools = [output for output in outputs if "vkao/tools/" in output or "vkao/tests/" in output]
    assert not of_tools, of_tools
    execute([MESON, "compile", "-C", "build"], cwd=consumer)
    execute([os.path.join(consumer, "build", "smoke")])


def cmake_consumer(name, *options):
    need("cmake")
    build = folder(name)
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    execute(["cmake", "-S", os.path.join(HERE, "cmake"), "-B", build, *generator,
             "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_COMPILE_WARNING_AS_ERROR=ON", *options])
    execute(["cmake", "--build", build])
    for program in ("smoke", "smoke_cpp"):
        execute([os.path.join(build, program)])
    return build


def cmake_finds_the_package():
    build = cmake_consumer("cmake-find", f"-DCMAKE_PREFIX_PATH={PREFIX}")
    assert loads_libvkao(os.path.join(build, "smoke"))


def cmake_takes_the_library_beside_the_headers():
    """In a build folder that has seen another package before."""
    need("cmake")
    build = folder("cmake-again")
    moved = os.path.join(build, "moved")
    shutil.copytree(PREFIX, moved, symlinks=True)
    for prefix in (PREFIX, moved):
        package = glob.glob(os.path.join(prefix, "**/cmake/vkao"), recursive=True)[0]
        execute(["cmake", "-S", os.path.join(HERE, "cmake"), "-B", os.path.join(build, "build"),
                 "-DCMAKE_BUILD_TYPE=Release", f"-Dvkao_DIR={package}"])
    with open(os.path.join(build, "build", "CMakeCache.txt"), encoding="utf-8") as file:
        library = re.search(r"^vkao_LIBRARY:\w+=(.*)$", file.read(), re.M).group(1)
    assert library.startswith(moved + os.sep), library


def cmake_finds_the_package_behind_a_link():
    """Of a system where /lib is a link to /usr/lib, whichever way find_package takes."""
    need("cmake")
    root = folder("cmake-usr-merged")
    shutil.copytree(PREFIX, os.path.join(root, "usr"), symlinks=True)
    package = glob.glob(os.path.join(root, "usr", "lib*", "**", "cmake", "vkao"),
                        recursive=True)[0]
    library = os.path.relpath(package, os.path.join(root, "usr"))
    top = library.split(os.sep)[0]
    os.symlink(os.path.join("usr", top), os.path.join(root, top))
    build = cmake_consumer("cmake-behind-a-link", f"-Dvkao_DIR={os.path.join(root, library)}")
    with open(os.path.join(build, "CMakeCache.txt"), encoding="utf-8") as file:
        found = re.search(r"^vkao_LIBRARY:\w+=(.*)$", file.read(), re.M).group(1)
    assert found.startswith(os.path.join(os.path.realpath(root), "usr") + os.sep), found


def folders_that_lie_apart_are_found():
    """Library and headers outside the prefix, all of them with spaces in their names."""
    need("pkg-config", "cmake")
    root = folder("lies apart")
    library = os.path.join(root, "the library")
    install(os.path.join(root, "the prefix"), library, os.path.join(root, "the headers"))
    flags = execute(["pkg-config", "--cflags", "--libs", "vkao"],
                    env={"PKG_CONFIG_PATH": os.path.join(library, "pkgconfig")}).stdout
    output = os.path.join(root, "smoke")
    execute(["cc", os.path.join(HERE, "smoke.c"), *shlex.split(flags), "-o", output])
    execute([output], env={"LD_LIBRARY_PATH": library})
    cmake_consumer("cmake apart", f"-Dvkao_DIR={os.path.join(library, 'cmake', 'vkao')}")


def cmake_builds_what_meson_builds():
    """add_subdirectory: the same sources, and the same SPIR-V to the byte."""
    build = cmake_consumer("cmake-subdirectory", f"-DVKAO_SOURCE={SOURCE}")
    ours = os.path.join(WORK, "library", "lib")
    theirs = os.path.join(build, "vkao", "shaders")
    names = {os.path.basename(path) for path in glob.glob(os.path.join(ours, "vkao_*.h"))}
    made = {os.path.basename(path) for path in glob.glob(os.path.join(theirs, "vkao_*.h"))}
    assert names == made, f"meson alone: {names - made}, CMake alone: {made - names}"
    for name in sorted(names):
        with open(os.path.join(ours, name), encoding="utf-8") as a, \
                open(os.path.join(theirs, name), encoding="utf-8") as b:
            assert a.read() == b.read(), f"{name} is another"

    def functions(archive):
        return {line.split()[-1] for line in execute(["nm", "-g", "--defined-only", archive])
                .stdout.splitlines() if " T " in line}
    need("nm")
    assert functions(installed("**/libvkao.a")) == \
        functions(os.path.join(build, "vkao", "libvkao.a"))


def a_program_loads_the_library():
    output = os.path.join(folder("loaded"), "loaded")
    need("cc")
    execute(["cc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-D_DEFAULT_SOURCE",
             os.path.join(HERE, "loaded.c"), *pkg_config("--cflags"), "-ldl", "-o", output])
    with open(installed("include/vkao.h"), encoding="utf-8") as file:
        text = re.sub(r"^\s*#(?:.*\\\n)*.*$", "", without_comments(file.read()), flags=re.M)
    names = sorted(set(re.findall(r"\bVKAO_API\b[^;{]*?\b(vkao_\w+)\s*\(", text)))
    names += [f"{name}_init" for name in re.findall(r"^VKAO_DEFAULT\((vkao_\w+)\)", text, re.M)]
    assert len(names) >= 24, names
    execute([output, shared_library(), *names])


def python_takes_defaults_and_tables():
    names = execute([sys.executable, os.path.join(HERE, "bindings.py"), shared_library()]).stdout
    assert "radius" in names, names


def rust_makes_an_effect_on_a_device_of_ash():
    need("cargo")
    source, target = os.path.join(HERE, "rust"), os.path.join(WORK, "rust")
    library = os.path.dirname(shared_library())
    fetched = subprocess.run(["cargo", "fetch", "--locked"], cwd=source, capture_output=True,
                             text=True)
    if fetched.returncode:
        raise Skip("cargo gets no crates: " + (fetched.stderr.strip().splitlines() or ["?"])[-1])
    execute(["cargo", "build", "--locked", "--offline", "--quiet"], cwd=source,
            env={"CARGO_TARGET_DIR": target,
                 "RUSTFLAGS": f"-L native={library} -C link-arg=-Wl,-rpath,{library}"})
    done = execute([os.path.join(target, "debug", "smoke")], ok=(0, 77))
    if done.returncode == 77:
        raise Skip(f"no Vulkan device: {done.stderr.strip()}")


# --- The example, on a device ---

# The second is how other versions of the layers spell it.
VALIDATION = {
    "VK_INSTANCE_LAYERS": "VK_LAYER_KHRONOS_validation",
    "VK_LAYER_ENABLES": "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT:"
                        "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT",
    "VK_KHRONOS_VALIDATION_VALIDATE_SYNC": "1",
    "VK_KHRONOS_VALIDATION_SYNCVAL_SUBMIT_TIME_VALIDATION": "1",
}


def build_example(name, static, change=None):
    """As its first comment says. change: (what stands there once, what to write instead)"""
    build = folder(name)
    installed_at = os.path.dirname(installed("**/example.c"))
    for path in glob.glob(os.path.join(installed_at, "*")):
        shutil.copy(path, build)
    source = os.path.join(build, "example.c")
    if change:
        with open(source, encoding="utf-8") as file:
            text = file.read()
        count = text.count(change[0])
        assert count == 1, f"example.c has {count} of {change[0]!r}"
        with open(source, "w", encoding="utf-8") as file:
            file.write(text.replace(*change))
    for stage in ("vert", "frag"):
        execute(["glslangValidator", "--quiet", "-V", "--target-env", "vulkan1.1",
                 "--variable-name", f"box_{stage}", "-o", f"box_{stage}.h", f"box.{stage}"],
                cwd=build)
    output = os.path.join(build, "example")
    compile_with_pkg_config(["cc", "-std=c11", "-Wno-missing-field-initializers"], source, output,
                            static, "-lvulkan", "-lm")
    return output


def run_example(program):
    done = subprocess.run([program], capture_output=True, text=True,
                          env={**os.environ, **runtime(VALIDATION)})
    reason = re.search(r"^vk(CreateInstance|EnumeratePhysicalDevices)\S*: (-\d+)", done.stderr,
                       re.M)
    if reason:
        raise Skip(f"no Vulkan device or no validation layers: {reason.group()}")
    return done


def example_shades_the_box_in_silence(name, static):
    def case():
        done = run_example(build_example(name, static))
        said = re.fullmatch(r"mean (\S+), minimum (\S+)\n", done.stdout)
        assert done.returncode == 0 and said and not done.stderr, done.stdout + done.stderr
        mean, least = map(float, said.groups())
        # Most of the picture is open floor and background; the foot of the box is not.
        assert 0.95 < mean < 0.995 and least < 0.5, done.stdout
    return name, case


def write_npy(path, type_, value):
    header = f"{{'descr': '{type_}', 'fortran_order': False, 'shape': (36, 64), }}"
    header = header.ljust(117) + "\n"
    with open(path, "wb") as file:
        file.write(b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header.encode())
        file.write(value * 36 * 64)


def engine_is_timed(name, compiler):
    """What a stranger writes, on the numbers of vkao-bench's --dump: it says what --vs reads."""
    def case():
        build = folder(name)
        output = os.path.join(build, "timed")
        compile_with_pkg_config(compiler, os.path.join(HERE, "timed.c"), output, False, "-lvulkan")
        write_npy(os.path.join(build, "wall_z32.npy"), "<f4", struct.pack("<f", 2))
        write_npy(os.path.join(build, "wall_n8.npy"), "<u4", struct.pack("bbbb", 0, 0, -127, 0))
        done = subprocess.run([output, os.path.join(build, "wall")], capture_output=True,
                              text=True, env={**os.environ, **runtime(VALIDATION)})
        if re.search(r"vkCreateInstance|no device", done.stderr):
            raise Skip(done.stderr.strip())
        assert done.returncode == 0 and re.fullmatch(r"readme med \d+\.\d+ ms\n", done.stdout) and \
            not done.stderr, done.stdout + done.stderr
    return name, case


def layers_miss(name, hazard, *change):
    """The same program less one of its waits: were the layers asleep, silence would say nothing."""
    def case():
        done = run_example(build_example(name, False, change))
        assert f"SYNC-HAZARD-{hazard}" in done.stdout + done.stderr, \
            f"no {hazard}:\n{done.stdout}{done.stderr}"
    return name, case


def library_is_installed():
    install()
    shared_library()
    installed("**/libvkao.a")


NOTHING = "VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT"

if __name__ == "__main__":
    os.makedirs(WORK, exist_ok=True)
    run([
        ("library_is_installed", library_is_installed),
        links_with_pkg_config("c11_links_the_shared_library", ["cc", "-std=c11"], False),
        links_with_pkg_config("c11_links_the_static_library", ["cc", "-std=c11"], True),
        links_with_pkg_config("cpp17_links_the_shared_library", ["c++", "-xc++", "-std=c++17"],
                              False),
        links_with_pkg_config("cpp20_links_the_static_library", ["c++", "-xc++", "-std=c++20"],
                              True),
        *((case.__name__, case) for case in (
            static_consumers_get_their_define, meson_subproject_builds_the_library_alone,
            the_package_wants_no_loader, cmake_takes_the_library_beside_the_headers,
            cmake_finds_the_package, cmake_finds_the_package_behind_a_link,
            folders_that_lie_apart_are_found, cmake_builds_what_meson_builds,
            a_program_loads_the_library, python_takes_defaults_and_tables,
            rust_makes_an_effect_on_a_device_of_ash)),
        engine_is_timed("c11_engine_is_timed", ["cc", "-std=c11"]),
        engine_is_timed("cpp17_engine_is_timed", ["c++", "-xc++", "-std=c++17"]),
        example_shades_the_box_in_silence("example_with_the_shared_library", False),
        example_shades_the_box_in_silence("example_with_the_static_library", True),
        layers_miss("drawing_over_what_vkao_reads_is_noticed", "WRITE-AFTER-READ",
                    "{VK_SUBPASS_EXTERNAL, 0, compute,", f"{{VK_SUBPASS_EXTERNAL, 0, {NOTHING},"),
        layers_miss("reading_what_is_being_drawn_is_noticed", "READ-AFTER-WRITE",
                    "drawing, compute, written, VK_ACCESS_SHADER_READ_BIT,",
                    "drawing, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, 0, 0,"),
        layers_miss("copying_what_vkao_writes_is_noticed", "READ-AFTER-WRITE",
                    "vkCmdPipelineBarrier(cmd, compute, transfer,",
                    "vkCmdPipelineBarrier(cmd, transfer, transfer,"),
        layers_miss("writing_what_a_copy_reads_is_noticed", "WRITE-AFTER-READ",
                    "vkCmdPipelineBarrier(cmd, transfer, compute | transfer,",
                    f"vkCmdPipelineBarrier(cmd, {NOTHING}, compute | transfer,"),
    ])
