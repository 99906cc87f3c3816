#!/usr/bin/env python3
"""Makes the pictures of docs/studio.md: one by its script of actions, the others by sessions at the window.

    studio.py ECORCHE
"""
import os
import shutil
import subprocess
import sys
import tempfile

from make import HERE, convert


def main():
    program = os.path.abspath(sys.argv[1])
    script = os.path.join(HERE, "..", "studio", "plate.txt")
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "studio", "--script", os.path.abspath(script)], cwd=folder, check=True)
        convert(os.path.join(folder, "studio.png"), os.path.join(HERE, "studio.jpg"), 760)
        shutil.copy(os.path.join(HERE, "..", "studio", "tail.obj"), folder)
        subprocess.run([program, "studio", "--script", os.path.abspath(os.path.join(HERE, "..", "studio", "skeleton.txt"))], cwd=folder, check=True)
        convert(os.path.join(folder, "studio-skeleton.png"), os.path.join(HERE, "studio-skeleton.jpg"), 520)
        subprocess.run([program, "studio", "--script", os.path.abspath(os.path.join(HERE, "..", "studio", "compare.txt"))], cwd=folder, check=True)
        for name in ("compare", "plate"):
            convert(os.path.join(folder, f"studio-{name}.png"), os.path.join(HERE, f"studio-{name}.jpg"), 900)
        session = os.path.join(folder, "session.txt")
        with open(os.path.join(HERE, "..", "studio", "insertion.txt")) as given, open(session, "w") as out:
            # with the card in view, in the midst of the work
            out.write(given.read().split("key Ctrl + Z")[0].replace("-30,10", "-10,6") + "wait\nclick tab:Muscle\nframes 5\npicture window.png\n")
        at_window(program, session, folder)
        convert(os.path.join(folder, "window.png"), os.path.join(HERE, "studio-window.jpg"), 1200)
        at_window(program, os.path.abspath(os.path.join(HERE, "..", "studio", "tools.txt")), folder)
        shutil.copy(os.path.join(HERE, "..", "..", "data", "motions", "walk.bvh"), folder)
        for name in ("new-muscle", "curves", "side-by-side"):
            at_window(program, os.path.abspath(os.path.join(HERE, "..", "studio", name + ".txt")), folder)
        for name in ("shape", "limits", "cut", "draw", "curves"):
            convert(os.path.join(folder, name + ".png"), os.path.join(HERE, f"studio-{name}.jpg"), 900)


def at_window(program, session, folder):
    subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24", program, "studio", "--input", session, "--size", "1280x720"], cwd=folder, check=True)


if __name__ == "__main__":
    main()
