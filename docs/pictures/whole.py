#!/usr/bin/env python3
"""Makes the picture of docs/check.md: hard poses by action lines, above, and by the map of the body's inside, below.

    whole.py ECORCHE
"""
import os
import subprocess
import sys
import tempfile

from make import program_in

HERE = os.path.dirname(os.path.abspath(__file__))
SIZE = (380, 400)
VIEWS = (("squat", "left"), ("squat", "back"), ("crunch", "front"), ("hip_120", "left"))


def main():
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        path, ecorche = program_in(folder, program)
        ecorche("body", "new", "--sex", "male", "-o", path("man.glb"))
        ecorche("fit", path("man.glb"), "-o", path("man-anatomy.glb"))
        stills = []
        for muscles in ("lines", "map"):
            for pose, view in VIEWS:
                stills.append(path(f"{muscles}-{pose}-{view}.png"))
                ecorche("render", path("man-anatomy.glb"), "-o", stills[-1], "--pose", pose, "--camera", view, "--muscles", muscles, "--layers", "muscles,bones",
                        "--background", "white", "--no-legend", "--size", f"{SIZE[0]}x{SIZE[1]}")
        inputs = [word for still in stills for word in ("-i", still)]
        places = "|".join(f"{SIZE[0] * (k % len(VIEWS))}_{SIZE[1] * (k // len(VIEWS))}" for k in range(len(stills)))
        joined = "".join(f"[{k}:v]" for k in range(len(stills))) + f"xstack=inputs={len(stills)}:layout={places}"
        subprocess.run(["ffmpeg", "-y", "-loglevel", "error", *inputs, "-filter_complex", joined, "-frames:v", "1", "-q:v", "4", "-bitexact", os.path.join(HERE, "whole.jpg")], check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
