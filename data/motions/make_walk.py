#!/usr/bin/env python3
"""Writes walk.bvh: six strides of level walking at 1.35 m/s, beginning and ending at the same point of the stride.

The joint angles and the path of the centre of mass come from gait_cycles.csv. Feet stand where the angles put them in mid-stance and
turn there about heel, ball and toe tip; the hips follow the centre of mass, the planted legs by inverse kinematics.
"""

import math
import pathlib
import sys

import figure
import planting
from figure import Curve, sub

FPS, SUB = 60, 2
SPEED, STRIDE_TIME, STRIDES, STANCE = 1.35, 1.08, 6, 0.61
FADE = 0.25
HERE = pathlib.Path(__file__).resolve().parent


class Support:
    eased = False

    def __init__(self, side, td, to, place):
        self.side, self.td, self.to = side, td, to
        self.place = lambda t: place


class Walk:
    soft_knees = False  # heels strike with knees all but straight

    def __init__(self):
        rows = [r for r in figure.read_table(HERE / "gait_cycles.csv") if r["gait"] == "walk_1.35"]
        columns = [c for c in rows[0] if c not in ("gait", "percent")]
        percent = [float(r["percent"]) + shift for shift in (-100, 0, 100) for r in rows[:-1]]
        self.cycle = {c: Curve(percent, [float(r[c]) for _ in range(3) for r in rows[:-1]]) for c in columns}
        self.names = [c for c in columns if not c.startswith("com")]
        stride = SPEED * STRIDE_TIME
        self.supports = []
        for side, offset in (("Right", 0.0), ("Left", 0.5)):
            x, z = self.mid_stance(side, offset * STRIDE_TIME)
            for n in range(-2, STRIDES + 2):
                td = (n + offset) * STRIDE_TIME
                self.supports.append(Support(side, td, td + STANCE * STRIDE_TIME, (x, z + n * stride)))

    def mid_stance(self, side, touchdown):
        """Where the flat ball stands (x, z) by the angles, a fifth of a stride after touchdown."""
        t = touchdown + 0.2 * STRIDE_TIME
        R, wanted = figure.rotations(self.angles_at(t)), self.center_at(t)
        root = sub(wanted, figure.center_of_mass(figure.kinematics((0, 0, 0), R)))
        ball = figure.kinematics(root, R)[side + "ToeBase"][1]
        return ball[0], ball[2]

    def phase(self, t):
        return 100 * math.fmod(t / STRIDE_TIME + 10, 1)

    def angles_at(self, t):
        return {c: self.cycle[c](self.phase(t)) for c in self.names}

    def center_at(self, t):
        p = self.phase(t)
        return (self.cycle["com_z"](p), self.cycle["com_y"](p), SPEED * t + self.cycle["com_dx"](p))


def main():
    count = round(STRIDES * STRIDE_TIME * FPS) + 1
    frames, short = planting.solve(Walk(), [k / (FPS * SUB) for k in range(SUB * (count - 1) + 1)], FADE)
    figure.write_bvh(HERE / "walk.bvh", FPS, frames[::SUB])
    print(f"walk.bvh: {count} frames; a planted leg is too short by {1000 * short:.1f} mm at worst", file=sys.stderr)


if __name__ == "__main__":
    main()
