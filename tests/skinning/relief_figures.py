#!/usr/bin/env python3
"""Figures of the relief on the skin: size by region, leaps between frames, volume, flipped triangles, of a lean man, an average one and a heavy woman.

    relief_figures.py ECORCHE MOTION.bvh [BODY...]

Each body moves twice, with its relief and without; what lies between the two skins is measured. Bodies: lean, average, heavy; all when left out.
"""
import os
import subprocess
import sys
import tempfile

import numpy as np

BODIES = {
    "lean": (("--sex", "male", "--age", "28", "--height", "1.85", "--mass", "80", "--muscle", "0.8"), ("--fat", "8")),
    "average": (("--sex", "male", "--age", "40", "--height", "1.754", "--mass", "84.8"), ()),
    "heavy": (("--sex", "female", "--age", "45", "--height", "1.64", "--mass", "95"), ()),
}
REGIONS = ("head", "trunk", "shoulder", "upper arm", "forearm", "hand", "thigh", "shank", "foot")


def read_pc2(file):
    with open(file, "rb") as data:
        head = data.read(32)
        vertices, frames = np.frombuffer(head[16:20], "<i4")[0], np.frombuffer(head[28:32], "<i4")[0]
        return np.fromfile(data, "<f4").reshape(frames, vertices, 3).astype(float)


def read_faces(file):
    with open(file, encoding="utf-8") as text:
        return np.array([[int(word.split("/")[0]) - 1 for word in line.split()[1:4]] for line in text if line.startswith("f ")])


def cross(x, faces):
    a, b, c = (x[faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def volume(x, faces):
    return np.einsum("ij,ij->", x[faces[:, 0]], cross(x, faces)) / 6


def regions_of(x):
    """Region of each vertex in the rest pose (A-pose), by height and distance from the mid-plane as shares of the stature."""
    low, high = x[:, 1].min(), x[:, 1].max()
    up, out = (x[:, 1] - low) / (high - low), np.abs(x[:, 0]) / (high - low)
    region = np.full(len(x), 1)
    region[up > 0.86] = 0
    region[(up > 0.74) & (up < 0.86) & (out > 0.09)] = 2
    arm = (out > 0.135) & (up > 0.40)
    region[arm] = 3
    region[arm & (out > 0.21)] = 4
    region[arm & (out > 0.285)] = 5
    leg = (up < 0.46) & ~arm
    region[leg] = 6
    region[leg & (up < 0.27)] = 7
    region[leg & (up < 0.04)] = 8
    return region


def main():
    program, motion = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:

        def ecorche(*words):
            done = subprocess.run([program, *words, "-q"], cwd=folder, capture_output=True, text=True)
            if done.returncode not in (0, 8):
                raise SystemExit(f"{' '.join(words)}: exit {done.returncode}\n{done.stderr}")

        for name in sys.argv[3:] or BODIES:
            shape, change = BODIES[name]
            ecorche("body", "new", *shape, "-o", "body.glb")
            if change:
                ecorche("body", "modify", "body.glb", *change, "-o", "changed.glb")
            ecorche("fit", "changed.glb" if change else "body.glb", "-o", "anatomy.glb")
            ecorche("animate", "anatomy.glb", motion, "-o", "bare.pc2", "--layers", "skin", "--definition", "0")
            ecorche("animate", "anatomy.glb", motion, "-o", "shown.pc2", "--definition", "1")
            bare, shown = read_pc2(os.path.join(folder, "bare-skin.pc2")), read_pc2(os.path.join(folder, "shown.pc2"))
            faces = read_faces(os.path.join(folder, "bare-skin.obj"))
            with open(os.path.join(folder, "bare-skin.obj"), encoding="utf-8") as text:
                rest = np.array([line.split()[1:4] for line in text if line.startswith("v ")], dtype=float)
            region = regions_of(rest)
            relief, flipped, change_of_volume = [], 0, []
            for a, b in zip(bare, shown):
                normal, moved = cross(a, faces), cross(b, faces)
                flipped = max(flipped, np.mean(np.einsum("ij,ij->i", normal, moved) < 0))
                at = np.zeros_like(a)
                for k in range(3):
                    np.add.at(at, faces[:, k], normal)
                at /= np.maximum(np.linalg.norm(at, axis=1, keepdims=True), 1e-12)
                relief.append(np.einsum("ij,ij->i", b - a, at))
                change_of_volume.append(volume(b, faces) / volume(a, faces) - 1)
            relief = 1e3 * np.array(relief)
            leaps = np.abs(np.diff(relief, axis=0))
            print(f"{name}: RMS mm: " + ", ".join(f"{REGIONS[k]} {np.sqrt(np.mean(relief[:, region == k] ** 2)):.2f}" for k in range(len(REGIONS))))
            print(f"  whole body {np.sqrt(np.mean(relief ** 2)):.2f}, 99 % below {np.percentile(np.abs(relief), 99):.2f}, at most {np.abs(relief).max():.2f} mm")
            if len(leaps):
                second = np.abs(np.diff(relief, n=2, axis=0))
                print(f"  from frame to frame: mean {leaps.mean():.3f}, 99.9 % below {np.percentile(leaps, 99.9):.2f}, at most {leaps.max():.2f} mm; second difference 99.9 % {np.percentile(second, 99.9):.2f}")
            print(f"  volume {100 * min(change_of_volume):+.3f} .. {100 * max(change_of_volume):+.3f} %, flipped against the skin without it {100 * flipped:.4f} %", flush=True)


if __name__ == "__main__":
    main()
