#!/usr/bin/env python3
"""Figures of retargeting over many motions: limbs' directions, speeds, feet, limits, rates of frames.

    retarget_figures.py ECORCHE CHARACTER.glb MOTION.. [--rates] [--to 8s]

Each motion is retargeted as usual and with nothing enforced (--limits keep, no planting, limbs through
each other), which is the source's own movement on this body. Between the two: the mean angle of thighs,
shins, upper arms and forearms, and each joint's top speed about the pelvis. --rates: also at 24, 60 and
240 frames a second, joints' places compared at common times. A row a motion.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

LIMBS = [(a + s, b + s) for s in ("_l", "_r") for a, b in (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist"))]
SEEN = ["head", "thorax"] + [j + s for s in ("_l", "_r") for j in ("knee", "ankle", "elbow", "wrist")]
FREE = ("--limits", "keep", "--no-plant", "--no-apart")


def read_places(file):
    """Joints' places, frames x 3 by name, of a .bvh as `retarget` writes it; frames a second."""
    names, parents, offsets, orders, stack = [], [], [], [], []
    with open(file, encoding="utf-8") as text:
        for line in text:
            words = line.split()
            if words[0] in ("ROOT", "JOINT"):
                parents.append(stack[-1] if stack else -1)
                names.append(words[1])
            elif words[0] == "End":
                names.append(None)
                parents.append(stack[-1])
            elif words[0] == "{":
                stack.append(len(names) - 1)
            elif words[0] == "}":
                stack.pop()
            elif words[0] == "OFFSET":
                offsets.append([float(w) for w in words[1:]])
                orders.append(None)
            elif words[0] == "CHANNELS":
                orders[-1] = words[2:]
            elif words[0] == "Frame":
                fps = 1 / float(words[2])
                break
        rows = np.loadtxt(text, ndmin=2)
    places, turns, at = [], [], 0
    for j, name in enumerate(names):
        shift = np.broadcast_to(np.array(offsets[j]), (len(rows), 3)).copy()
        turn = np.broadcast_to(np.eye(3), (len(rows), 3, 3))
        for channel in orders[j] or []:
            value, axis = rows[:, at], "XYZ".index(channel[0])
            at += 1
            if channel.endswith("position"):
                shift[:, axis] = value
                continue
            c, s = np.cos(np.radians(value)), np.sin(np.radians(value))
            one = np.zeros((len(rows), 3, 3))
            b, d = (axis + 1) % 3, (axis + 2) % 3
            one[:, axis, axis] = 1
            one[:, b, b] = one[:, d, d] = c
            one[:, d, b], one[:, b, d] = s, -s
            turn = turn @ one
        up = parents[j]
        places.append(shift if up < 0 else places[up] + np.einsum("fij,fj->fi", turns[up], shift))
        turns.append(turn if up < 0 else turns[up] @ turn)
    return {n: p for n, p in zip(names, places) if n}, fps


def retarget(program, character, motion, options, folder):
    out, report = os.path.join(folder, "out.bvh"), os.path.join(folder, "report.json")
    run = subprocess.run([program, "retarget", motion, character, "-o", out, "--report", report, "-q", *options], capture_output=True, text=True)
    if run.returncode != 0:
        raise RuntimeError(run.stderr.strip().splitlines()[-1] if run.stderr.strip() else f"exit {run.returncode}")
    with open(report, encoding="utf-8") as text:
        return *read_places(out), json.load(text)


def limbs_apart(ours, source):
    """Mean angle, deg, of all limbs and of the worst one."""
    angles = []
    for a, b in LIMBS:
        u, v = (p[b] - p[a] for p in (ours, source))
        cosine = (u * v).sum(1) / np.linalg.norm(u, axis=1) / np.linalg.norm(v, axis=1)
        angles.append(np.degrees(np.arccos(np.clip(cosine, -1, 1))).mean())
    return np.mean(angles), max(angles)


def speed_ratio(ours, source, fps):
    """Worst ratio of a joint's top speeds about the pelvis, those below 1 m/s left out, and whose."""
    worst = (0.0, "-")
    for joint in SEEN:
        a, b = (np.linalg.norm(np.diff(p[joint] - p["pelvis"], axis=0), axis=1).max(initial=0) * fps for p in (ours, source))
        if a > 1:
            worst = max(worst, (a / max(b, 1e-9), joint))
    return worst


def rates_apart(program, character, motion, options, folder):
    """Mean distance, mm, of joints at common times of 24, 60 and 240 frames a second."""
    shown = {fps: retarget(program, character, motion, (*options, "--filter", f"fps={fps}"), folder)[0] for fps in (24, 60, 240)}
    worst = 0.0
    for coarse, step in ((24, 10), (60, 4)):
        for joint in SEEN + ["pelvis"]:
            a, b = shown[coarse][joint], shown[240][joint][::step]
            n = min(len(a), len(b))
            worst = max(worst, 1e3 * np.linalg.norm(a[:n] - b[:n], axis=1).mean())
    return worst


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("character")
    parser.add_argument("motions", nargs="+")
    parser.add_argument("--rates", action="store_true")
    parser.add_argument("--to", default="")
    args = parser.parse_args()
    print("motion,frames,limbs_mean_deg,limb_worst_deg,speed_ratio,joint,slide_p95_mm,penetration_mm,limits_broken,contacts,rates_mm,frames_per_second")
    with tempfile.TemporaryDirectory() as folder:
        for motion in args.motions:
            name, options = os.path.splitext(os.path.basename(motion))[0], ()
            try:
                try:
                    options = ("--to", args.to) if args.to else ()
                    ours, fps, report = retarget(args.program, args.character, motion, options, folder)
                except RuntimeError:  # it is shorter
                    options = ()
                    ours, fps, report = retarget(args.program, args.character, motion, options, folder)
                source, _, _ = retarget(args.program, args.character, motion, (*options, *FREE), folder)
                rates = rates_apart(args.program, args.character, motion, options, folder) if args.rates else float("nan")
            except RuntimeError as error:
                print(f"{name}: {error}", file=sys.stderr, flush=True)
                continue
            found, frames = report["motion"], len(ours["pelvis"])
            mean, limb = limbs_apart(ours, source)
            ratio, joint = speed_ratio(ours, source, fps)
            pace = frames / (1e-3 * report["timings_ms"]["retarget"])
            print(f"{name},{frames},{mean:.2f},{limb:.2f},{ratio:.2f},{joint},{1e3 * found['foot_slide_p95']:.2f},{1e3 * found['penetration']:.2f},{found['joints_beyond_limits']},{found['contacts']},{rates:.2f},{pace:.0f}", flush=True)


main()
