#!/usr/bin/env python3
"""The truth of bellies under the skin: how much the layer over them changes as they flex, with definition and without.

    definition_truth.py ECORCHE

A lean athlete relaxes and tenses with straight and with bent elbows, knees and ankles. The layer over a skin vertex is the mean depth, along its normal, of the muscles'
points within some 8 mm about it, the near ones most. Were skin and muscles to move as they do in life, it would stay: what it changes is the error of the belly's depth, and
its mean times 2 pi that of the girth.
"""
import os
import subprocess
import sys
import tempfile

import numpy as np

from relief_figures import read_faces, read_pc2

GROUPS = {"biceps and brachialis": ("biceps_brachii", "brachialis"), "triceps": ("triceps",), "deltoid": ("deltoid",), "quadriceps": ("vastus", "rectus_femoris"),
          "calf": ("gastrocnemius", "soleus")}
ANGLES = {"elbow_flex_l": 100, "elbow_flex_r": 100, "knee_angle_l": -60, "knee_angle_r": -60, "ankle_angle_l": -25, "ankle_angle_r": -25}
REACH, WIDTH, DEEPEST, STEEP = 0.016, 0.008, 0.03, 0.004  # m


def read_groups(file):
    """The group of each vertex of an OBJ."""
    names, name = [], ""
    with open(file, encoding="utf-8") as text:
        for line in text:
            if line.startswith(("g ", "o ")):
                name = line.split()[1]
            elif line.startswith("v "):
                names.append(name)
    return names


def vertex_normals(x, faces):
    a, b, c = (x[faces[:, k]] for k in range(3))
    n, out = np.cross(b - a, c - a), np.zeros_like(x)
    for k in range(3):
        np.add.at(out, faces[:, k], n)
    return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-12)


def layer(skin, normals, muscles, of_muscle):
    """Depth of the muscles' points under each vertex, and the muscle that is nearest; nan where there is none. By cells of REACH + DEEPEST."""
    size = REACH + DEEPEST
    cells = {}
    for i, key in enumerate(map(tuple, np.floor(muscles / size).astype(int))):
        cells.setdefault(key, []).append(i)
    depth, nearest = np.full(len(skin), np.nan), np.full(len(skin), -1)
    for v, (p, n) in enumerate(zip(skin, normals)):
        at = np.floor(p / size).astype(int)
        near = [i for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1) for i in cells.get((at[0] + a, at[1] + b, at[2] + c), ())]
        if not near:
            continue
        away = p - muscles[near]
        deep = away @ n
        beside = np.sqrt(np.maximum(np.einsum("ij,ij->i", away, away) - deep ** 2, 0))
        good = (beside < REACH) & (deep < DEEPEST) & (deep > -0.01)
        if not good.any():
            continue
        weight = np.exp(-0.5 * (beside[good] / WIDTH) ** 2 - (deep[good] - deep[good].min()) / STEEP)
        depth[v] = weight @ deep[good] / weight.sum()
        nearest[v] = of_muscle[np.array(near)[good][np.argmax(weight)]]
    return depth, nearest


def main():
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:

        def ecorche(*words):
            done = subprocess.run([program, *words, "-q"], cwd=folder, capture_output=True, text=True)
            if done.returncode not in (0, 8):
                raise SystemExit(f"{' '.join(words)}: exit {done.returncode}\n{done.stderr}")

        ecorche("body", "new", "--sex", "male", "--age", "25", "--height", "1.85", "--mass", "78", "--muscle", "0.95", "-o", "body.glb")
        ecorche("fit", "body.glb", "--skin", "fine", "-o", "anatomy.glb")
        # Straight and relaxed, straight and tense, bent and relaxed, bent and tense.
        with open(os.path.join(folder, "bend.mot"), "w", encoding="utf-8") as text:
            text.write("bend\nversion=1\nnRows=4\nnColumns=%d\ninDegrees=yes\nendheader\ntime\t%s\n" % (len(ANGLES) + 1, "\t".join(ANGLES)))
            for k in range(4):
                text.write(f"{k / 10}\t" + "\t".join(str(value if k > 1 else 0) for value in ANGLES.values()) + "\n")
        with open(os.path.join(folder, "tense.csv"), "w", encoding="utf-8") as text:
            text.write("time,muscle,value\n" + "".join(f"{k / 10},*,{k % 2}\n" for k in range(4)))
        for definition in ("0", "1"):
            ecorche("animate", "anatomy.glb", "bend.mot", "-o", f"d{definition}.pc2", "--layers", "skin,muscles", "--definition", definition, "--activation", "tense.csv", "--limits", "keep", "--no-plant")
        names = read_groups(os.path.join(folder, "d0-muscles.obj"))
        faces = read_faces(os.path.join(folder, "d0-skin.obj"))
        for definition in ("0", "1"):
            skin, muscles = (read_pc2(os.path.join(folder, f"d{definition}-{what}.pc2")) for what in ("skin", "muscles"))
            group = np.array([next((k for k, words in enumerate(GROUPS.values()) if any(word in name for word in words)), -1) for name in names])
            wanted = np.isin(group, range(len(GROUPS)))
            near = layer_of_frames(skin, muscles, faces, group, wanted)
            for label, before, after in (("tensed, straight", 0, 1), ("tensed, bent", 2, 3), ("bent and tensed, from straight and relaxed", 0, 3)):
                said = []
                for k, name in enumerate(GROUPS):
                    use = (near[before][1] == k) & np.isfinite(near[after][0]) & (near[before][0] < 0.015)
                    change = 1e3 * (near[after][0][use] - near[before][0][use])
                    said.append(f"{name} {np.mean(np.abs(change)):.2f} (95 % {np.percentile(np.abs(change), 95):.2f}, girth {2 * np.pi * change.mean():+.1f})")
                print(f"definition {definition}, {label}: error of depth, mm: " + "; ".join(said), flush=True)


def layer_of_frames(skin, muscles, faces, group, wanted):
    out = []
    for x, m in zip(skin, muscles):
        low, high = m[wanted].min(0) - 0.03, m[wanted].max(0) + 0.03
        use = np.flatnonzero(np.all((x > low) & (x < high), axis=1))
        depth, nearest = np.full(len(x), np.nan), np.full(len(x), -1)
        depth[use], nearest[use] = layer(x[use], vertex_normals(x, faces)[use], m, group)
        out.append((depth, nearest))
    return out


if __name__ == "__main__":
    main()
