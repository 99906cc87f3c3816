"""Puts a figure whose angles, planted feet and centre of mass are given as functions of time on its feet.

`plan` has angles_at(t), center_at(t), soft_knees (free legs do not stretch all the way: running), and supports (side, td, to, place(t),
eased: the foot slows down before it touches down).
"""

import bisect
import math

import figure
from figure import add, smooth, sub

SUFFIX = {"Left": "_l", "Right": "_r"}
MAX_DORSIFLEXION = 30.0  # deg, under the body's weight
LEG = ("hip_flex", "hip_abd", "knee_flex", "ankle_dorsi", "ankle_inv", "foot_rot", "toe_ext")
CLEARANCE, CLEARANCE_RATE = 0.015, 0.25  # m a swinging foot keeps from the ground, reached at m/s from its supports
EASE, END_SPEED = 0.10, 0.55  # s before a touchdown in which the foot slows down on its way, to this share of the speed it would have had


def pitch_of(a, suffix):
    """Foot's pitch in the plane of progression by the angles, toes up."""
    return a["hip_flex" + suffix] - a["pelvis_tilt"] - a["knee_flex" + suffix] + a["ankle_dorsi" + suffix]


class Solver:
    def __init__(self, plan, fade):
        self.plan, self.fade = plan, fade
        self.supports = {side: [u for u in plan.supports if u.side == side] for side in SUFFIX}
        # (side, support, "td" or "to") -> what planting changes in the leg's angles there: of the last pass, of this one
        self.known, self.found = {}, {}
        self.short = 0.0  # m that a planted leg is too short by, at worst
        self.paths, self.walked = {}, {}  # side -> (t, foot's turn, ankle, toes), a sample each: of the last pass, of this one

    def support_at(self, side, t):
        for k, support in enumerate(self.supports[side]):
            if support.td <= t < support.to:
                return k
        return None

    def swing(self, a, side, t):
        """A free leg: the corrections of its neighbouring supports fade out and in."""
        supports = self.supports[side]
        before = max((k for k, u in enumerate(supports) if u.to <= t), default=None)
        after = min((k for k, u in enumerate(supports) if u.td > t), default=None)
        gap = (math.inf if after is None else supports[after].td) - (-math.inf if before is None else supports[before].to)
        fade = min(self.fade, 0.5 * gap)
        for k, end in ((before, "to"), (after, "td")):
            change = self.known.get((side, k, end))
            if change is None:
                continue
            distance = t - supports[k].to if end == "to" else supports[k].td - t
            for name in LEG:
                key = name + SUFFIX[side]
                a[key] = a.get(key, 0.0) + (1 - smooth(distance / fade)) * change[name]

    def lift(self, a, R, root, side, t):
        """Raises the ankle of a free leg whose foot would scrape the ground."""
        world = figure.kinematics(root, R)
        low = min(p[1] for p in figure.foot_points(world, side).values())
        near = min(min(abs(t - u.to), abs(t - u.td)) for u in self.supports[side])
        wanted = min(CLEARANCE, CLEARANCE_RATE * near)
        d = wanted - low
        up = 0.5 * (d + math.sqrt(d * d + (0.5 * wanted) ** 2)) if d > -4 * wanted else 0.0
        if up <= 0:
            return
        foot, ankle = world[side + "Foot"]
        hip, knee, local, _, _ = figure.reach_leg((R["Hips"], root), side, add(ankle, (0, up, 0)), foot, a["hip_rot" + SUFFIX[side]], free=self.plan.soft_knees)
        R[side + "UpLeg"], R[side + "Leg"], R[side + "Foot"] = hip, knee, local

    def ease_down(self, a, R, root, side, t):
        """A foot about to touch down goes the way of the last pass, first a little faster, then ever slower."""
        after = [u for u in self.supports[side] if u.td > t]
        if side not in self.paths or not after or after[0].td - t >= EASE or not after[0].eased:
            return
        x = (after[0].td - t) / EASE
        path, when = self.paths[side], after[0].td - EASE * (END_SPEED * x * (1 - x) ** 2 + 2 * x * x - x ** 3)
        k = min(max(bisect.bisect_left(path, (when,)), 1), len(path) - 1)
        (t0, _, ankle0, _), (t1, foot, ankle1, toes) = path[k - 1], path[k]
        share = min(max((when - t0) / (t1 - t0), 0.0), 1.0)
        foot = figure.between(path[k - 1][1], foot, share)
        ankle = tuple((1 - share) * p + share * q for p, q in zip(ankle0, ankle1))
        hip, knee, local, _, _ = figure.reach_leg((R["Hips"], root), side, ankle, foot, a["hip_rot" + SUFFIX[side]], free=self.plan.soft_knees)
        R[side + "UpLeg"], R[side + "Leg"], R[side + "Foot"] = hip, knee, local
        R[side + "ToeBase"] = toes

    def note(self, R, root, side, t):
        foot, ankle = figure.kinematics(root, R)[side + "Foot"]
        steps = self.walked.setdefault(side, [])
        if steps and steps[-1][0] == t:
            steps.pop()
        steps.append((t, foot, ankle, R[side + "ToeBase"]))

    def plant(self, a, R, root, side, place, pitch):
        """Leg rotations that keep the foot where it stands; its heel rises as far as a leg that is too short
        or an ankle that bends no further needs."""
        for _ in range(30):
            foot, ankle, extension = figure.planted_foot(place, pitch)
            hip, knee, local, angles, short = figure.reach_leg((R["Hips"], root), side, ankle, foot, a["hip_rot" + SUFFIX[side]])
            stiff = angles["ankle_dorsi"] - MAX_DORSIFLEXION
            if max(short, 1e-3 * stiff) < 1e-4 or (pitch > 0 and stiff <= 0):
                break
            pitch -= max(0.1, 300 * short, 0.7 * stiff)
        R[side + "UpLeg"], R[side + "Leg"], R[side + "Foot"] = hip, knee, local
        R[side + "ToeBase"] = figure.turn("X", -extension)
        angles["toe_ext"] = extension
        return angles, short

    def pose(self, t):
        wanted = self.plan.center_at(t)
        a = self.plan.angles_at(t)
        planted = {}
        for side in SUFFIX:
            planted[side] = self.support_at(side, t)
            if planted[side] is None:
                self.swing(a, side, t)
        R = figure.rotations(a)
        swings = {side: {part: R[side + part] for part in ("UpLeg", "Leg", "Foot", "ToeBase")} for side in SUFFIX}
        root, legs = (0.0, 0.98, wanted[2]), {}
        for _ in range(40):  # the hips move the centre, the centre the hips
            for side, k in planted.items():
                if k is None:
                    R.update({side + part: r for part, r in swings[side].items()})
                    self.lift(a, R, root, side, t)
                    self.note(R, root, side, t)
                    self.ease_down(a, R, root, side, t)
                else:
                    place = self.supports[side][k].place(t)
                    legs[side] = self.plant(a, R, root, side, place, pitch_of(a, SUFFIX[side]))
                    self.note(R, root, side, t)
            off = sub(wanted, figure.center_of_mass(figure.kinematics(root, R)))
            root = add(root, off)
            if max(map(abs, off)) < 1e-6:
                break
        for side, (angles, short) in legs.items():
            self.short = max(self.short, short)
            change = {name: angles[name] - a.get(name + SUFFIX[side], 0.0) for name in LEG}
            self.found.setdefault((side, planted[side], "td"), change)
            self.found[(side, planted[side], "to")] = change
        return root, R


def solve(plan, times, fade, passes=3):
    """Frames (root, rotations), and by how many metres a planted leg is too short at worst. The first passes find what planting
    changes at the ends of the supports and which way free feet go, the last one has it fade through the swings and eases feet down."""
    solver = Solver(plan, fade)
    frames = []
    for _ in range(passes):
        solver.found, solver.short, solver.walked = {}, 0.0, {}
        frames = [solver.pose(t) for t in times]
        solver.known, solver.paths = solver.found, solver.walked
    return frames, solver.short
