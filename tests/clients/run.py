#!/usr/bin/env python3
"""Makes a character and its motion in every format that is for other programs, and has these programs look at them.

    run.py ECORCHE SOURCE_FOLDER CLIENTS_FOLDER     (CLIENTS_FOLDER: where `make clients` puts them; ends 77 where nothing is there)
"""
import os
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "command_line"))
from inputs import short_motion  # noqa: E402
from runner import Runner  # noqa: E402

FRAMES = 21
FPS = 60
CLIPS = ("landing",)
KNEES = [f"knee_{side}_{turn}" for side in "lr" for turn in ("flexion", "rotation")]


def last_frames(source, target, first, step):
    """The frames of a BVH file from the one numbered `first` on, every `step`th."""
    with open(source, encoding="utf-8") as file:
        lines = file.read().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("Frame Time:")) + 1
    kept = lines[start + first::step]
    lines = [f"Frames: {len(kept)}" if line.startswith("Frames:") else line for line in lines[:start]] + kept
    with open(target, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def caches(t, clip):
    return [t.path(f"{clip}-{layer}.pc2") for layer in ("skin", "muscles")]


def make(t):
    t.run((0, 8), "body", "new", "--sex", "female", "--height", "168cm", "-o", "anna.glb")
    t.run((0, 8), "fit", "anna.glb", "-o", "anna-anatomy.glb", "--method", "ellipses")
    t.run((0, 8), "fit", "anna.glb", "-o", "light.glb", "--method", "ellipses", "--detail", "low")
    short_motion(t.data("motions", "walk.bvh"), t.path("walk.bvh"), FRAMES)

    def animate(*words):
        t.run((0, 8), "animate", "anna-anatomy.glb", "walk.bvh", *words)

    animate("-o", "walk.glb", "-o", "glb.pc2", "-o", "glb.mdd", "--cache-for", "glb")
    last_frames(t.data("motions", "long_jump.bvh"), t.path("landing.bvh"), 420, 4)
    for clip in CLIPS:  # in the file and exactly, with bulges
        t.run((0, 8), "animate", "anna-anatomy.glb", f"{clip}.bvh", "--activation", "auto", "-o", f"{clip}.glb", "-o", f"{clip}.pc2", "--layers", "skin,muscles")
    animate("-o", "plain.pc2", "-o", "plain.mdd", "-o", "whole/%04d.obj")
    animate("-o", "parts.pc2", "--layers", "skin,muscles,bones")
    animate("-o", "layers/%04d.obj", "--layers", "skin,muscles,bones")
    tables = {"angles": "angles.csv", "lengths": "lengths.csv", "velocities": "velocities.sto", "bellies": "bellies.csv", "tendons": "tendons.csv", "activations": "activations.csv",
              **{f"moment-arms:{knee}": f"arms-{knee}.csv" for knee in KNEES}}
    animate("--activation", "auto", *[word for what, file in tables.items() for word in ("--table", f"{what}={file}")])


def show(t, what, *words):
    done = subprocess.run([str(word) for word in words], cwd=t.folder, capture_output=True, text=True, timeout=1200, errors="replace")
    lines = [line for line in done.stdout.splitlines() if t.folder in line or "off in frames" in line or ".glb:" in line or "strips over" in line]
    print("\n".join(lines), flush=True)
    t.check(done.returncode == 0, f"{what}: exit {done.returncode}\n{done.stdout[-600:]}\n{done.stderr[-1500:]}")


def main():
    program, source, clients = sys.argv[1:4]
    blender, modules = os.path.join(clients, "python/bin/python"), os.path.join(clients, "node_modules")
    has_blender, has_browser = os.path.exists(os.path.join(clients, "python/ready")), os.path.isdir(os.path.join(modules, "three")) and shutil.which("chromium")
    if not has_blender and not has_browser:
        print("skipped: neither Blender nor three.js is here; `make clients` fetches them")
        return 77
    t = Runner(program, source)
    make(t)
    if has_blender:
        show(t, "vertex caches in Blender", blender, os.path.join(HERE, "blender_caches.py"), t.folder)
        for clip in CLIPS:
            show(t, f"{clip} in Blender", blender, os.path.join(HERE, "blender_clip.py"), t.path(f"{clip}.glb"), *caches(t, clip), FPS)
        show(t, "the looks of light.glb in Blender", blender, os.path.join(HERE, "blender_looks.py"), t.path("light.glb"))
        show(t, "tables", blender, os.path.join(HERE, "tables.py"), t.folder)
    else:
        print("skipped: Blender is not here")
    if has_browser:
        for file in ("anna-anatomy.glb", "light.glb"):
            show(t, f"the validator on {file}", "node", os.path.join(HERE, "validate.cjs"), modules, t.path(file))
        show(t, "the looks of anna-anatomy.glb in three.js", "node", os.path.join(HERE, "three_looks.mjs"), modules, t.path("anna-anatomy.glb"))
        for clip in CLIPS:
            show(t, f"the validator on {clip}.glb", "node", os.path.join(HERE, "validate.cjs"), modules, t.path(f"{clip}.glb"))
            show(t, f"{clip} in three.js", "node", os.path.join(HERE, "three_clip.mjs"), modules, t.path(f"{clip}.glb"), *caches(t, clip), FPS)
    else:
        print("skipped: three.js or Chromium is not here")
    t.finish()


if __name__ == "__main__":
    sys.exit(main())
