#!/usr/bin/env python3
"""The installed library, as somebody uses it who has it: run.py SOURCE BUILD

Installs the build into an empty folder, takes the program that README.md shows, builds it there by
find_package(ecorche) with nothing of the source tree in reach, runs it, and holds what it writes
beside what the program `ecorche` writes of the same person and motion.
"""
import array
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "command_line"))
from inputs import short_motion  # noqa: E402

PROJECT = """cmake_minimum_required(VERSION 3.25)
project(user LANGUAGES CXX)
find_package(ecorche 0.2 REQUIRED)
add_executable(user user.cpp)
target_link_libraries(user PRIVATE ecorche::ecorche)
"""


def run(*words, **more):
    ran = subprocess.run([str(w) for w in words], text=True, capture_output=True, **more)
    if ran.returncode not in (0, 8):
        raise SystemExit(f"{' '.join(map(str, words))}\nended {ran.returncode}\n{ran.stdout}{ran.stderr}")
    return ran.stdout


def program_of(readme):
    """The one C++ program in README.md."""
    programs = re.findall(r"^```cpp\n(.*?)^```$", readme.read_text(), re.M | re.S)
    if len(programs) != 1:
        raise SystemExit(f"README.md: {len(programs)} programs, not one")
    return programs[0]


def points_of(cache):
    """All coordinates of a PC2 cache, m."""
    values = array.array("f")
    values.frombytes(cache.read_bytes()[32:])
    return values


def check(what, holds):
    print(("ok     " if holds else "WRONG  ") + what)
    return holds


def main():
    source, build = (pathlib.Path(p).resolve() for p in sys.argv[1:3])
    folder = pathlib.Path(tempfile.mkdtemp(prefix="ecorche-installed-"))
    prefix, user = folder / "prefix", folder / "user"
    user.mkdir()
    try:
        run("cmake", "--install", build, "--prefix", prefix)
        program = program_of(source / "README.md")
        (user / "user.cpp").write_text(program)
        (user / "CMakeLists.txt").write_text(PROJECT)
        run("cmake", "-S", user, "-B", user / "build", f"-DCMAKE_PREFIX_PATH={prefix}",
            "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror")
        run("cmake", "--build", user / "build")
        # The tables are those that are installed; packages lie where the build fetched them.
        clean = {k: v for k, v in os.environ.items() if k != "ECORCHE_DATA"}
        clean["ECORCHE_PACKAGES"] = os.environ.get("ECORCHE_PACKAGES", str(build / "packages"))
        short_motion(source / "data/motions/walk.bvh", user / "walk.bvh", 12)
        run(user / "build/user", cwd=user, env=clean)

        installed = prefix / "bin/ecorche"
        wish = re.search(r"\.age = (\d+), \.height = ([\d.]+), \.mass = (\d+)", program)
        run(installed, "body", "new", "--sex", "female", "--age", wish[1], "--height", wish[2], "--mass",
            wish[3], "-o", "body.glb", cwd=folder, env=clean)
        run(installed, "fit", "body.glb", "-o", "fitted.glb", cwd=folder, env=clean)
        run(installed, "animate", "fitted.glb", user / "walk.bvh", "-o", "walk.pc2", cwd=folder, env=clean)

        # The program's body and character have gone through files, in single precision; now and then
        # a contact then decides otherwise.
        ours, theirs = points_of(user / "anna.pc2"), points_of(folder / "walk.pc2")
        apart = sorted(abs(a - b) for a, b in zip(ours, theirs))
        near = apart[int(0.999 * len(apart))]
        print(f"{len(apart)} coordinates: 99.9 % within {1e3 * near:.4f} mm, all within {1e3 * apart[-1]:.2f} mm")
        headers = [p.relative_to(prefix / "include/ecorche") for p in prefix.rglob("*.h")]
        held = [
            check("the program has at most 25 lines", len(program.splitlines()) <= 25),
            check("its vertex cache is the program's",
                  len(ours) == len(theirs) and near < 1e-4 and apart[-1] < 5e-3),
            check("its character is a glTF file", (user / "anna.glb").read_bytes()[:4] == b"glTF"),
            check("headers name no third party but Eigen", not [
                h for h in headers if re.search(r"#include <(?!Eigen)[\w/]+/", (prefix / "include/ecorche" / h).read_text())]),
            check("nothing points back into the source tree", not [
                p for p in prefix.rglob("*.cmake") if str(source) in p.read_text()]),
            check("manual page and completion are there",
                  (prefix / "share/man/man1/ecorche.1").exists()
                  and (prefix / "share/bash-completion/completions/ecorche").exists()),
        ]
        print(f"{len(headers)} headers")
        raise SystemExit(0 if all(held) else 1)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
