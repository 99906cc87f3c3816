#!/usr/bin/env python3
"""Makes the picture of docs/definition.md: a lean man without and with what shows through his skin.

    definition.py ECORCHE
"""
import os
import subprocess
import sys
import tempfile

from make import program_in

HERE = os.path.dirname(os.path.abspath(__file__))
SIZE = (450, 900)
VIEWS = (("standing", "25,5"), ("elbow_135", "320,5"))


def main():
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        path, ecorche = program_in(folder, program)
        ecorche("body", "new", "--sex", "male", "--age", "25", "--height", "1.85", "--mass", "78", "--muscle", "0.95", "-o", path("man.glb"))
        ecorche("fit", path("man.glb"), "--skin", "fine", "-o", path("lean-anatomy.glb"))
        stills = []
        for pose, view in VIEWS:
            for definition in ("0", "1"):
                stills.append(path(f"{pose}-{definition}.png"))
                ecorche("render", path("lean-anatomy.glb"), "-o", stills[-1], "--pose", pose, "--camera", view, "--definition", definition, "--layers", "skin",
                        "--background", "#30343A", "--size", f"{SIZE[0]}x{SIZE[1]}")
        inputs = [word for still in stills for word in ("-i", still)]
        joined = "".join(f"[{k}:v]" for k in range(len(stills))) + f"hstack=inputs={len(stills)}"
        subprocess.run(["ffmpeg", "-y", "-loglevel", "error", *inputs, "-filter_complex", joined, "-frames:v", "1", "-q:v", "4", "-bitexact", os.path.join(HERE, "definition.jpg")], check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
