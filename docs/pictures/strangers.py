#!/usr/bin/env python3
"""Makes the pictures of docs/scans.md and docs/strangers.md from a scan and a rigged character that lie beside the repository.

    strangers.py ECORCHE TESTDATA     (TESTDATA: ../shared/testdata; ends with 77 where it is not there)
"""
import os
import re
import subprocess
import sys
import tempfile

from make import convert, pictures_of, program_in

HERE = os.path.dirname(os.path.abspath(__file__))
SCAN = "scans/kinect_full_body_GPL3/scan1.ply"
CHARACTER = "rigs/sketchfab_basemeshes/free_rigged_male_basemesh.glb"


def beside(sources, target, height, width):
    """Pictures side by side, cut about the middle to their share of the width."""
    share = width // len(sources)
    cut = "".join(f"[{k}]scale=-2:{height}:flags=area,crop={share}:{height}[p{k}];" for k in range(len(sources)))
    joined = "".join(f"[p{k}]" for k in range(len(sources))) + f"hstack=inputs={len(sources)}"
    inputs = [word for source in sources for word in ("-i", source)]
    subprocess.run(["ffmpeg", "-y", "-loglevel", "error", *inputs, "-filter_complex", cut + joined, "-q:v", "4", "-bitexact", target], check=True)


def main():
    program, data = (os.path.abspath(word) for word in sys.argv[1:3])
    scan, character = os.path.join(data, SCAN), os.path.join(data, CHARACTER)
    if not os.path.exists(scan) or not os.path.exists(character):
        print(f"skipped: no scans and rigs in {data}")
        return 77
    walk = os.path.join(HERE, "..", "..", "data", "motions", "walk.bvh")
    with tempfile.TemporaryDirectory() as folder:
        path, ecorche = program_in(folder, program)
        ecorche("body", "register", scan, "-o", path("person.glb"), "--page", path("scan.html"))
        with open(path("scan.html"), encoding="utf-8") as page:
            sheet = next(png for caption, png in pictures_of(page.read()) if re.match("From the front", caption))
        with open(path("sheet.png"), "wb") as out:
            out.write(sheet)
        convert(path("sheet.png"), os.path.join(HERE, "scan.jpg"), 900)
        ecorche("fit", character, "-o", path("hero.glb"))
        still = ("--background", "white", "--size", "900x1120", "--no-legend")
        takes = (("before.png", ["--layers", "skin"]), ("inside.png", ["--layers", "muscles,bones"]), ("walk.png", [walk, "--at", "1.1", "--camera", "60,10"]))
        for name, words in takes:
            motion = [word for word in words if word.endswith(".bvh")]
            ecorche("render", path("hero.glb"), *motion, "-o", path(name), *[word for word in words if word not in motion], *still)
        beside([path(name) for name, _ in takes], os.path.join(HERE, "stranger.jpg"), 700, 1500)
    return 0


if __name__ == "__main__":
    sys.exit(main())
