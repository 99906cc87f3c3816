#!/usr/bin/env python3
"""Writes long_jump.bvh: standing start, a run-up of 16 steps, take-off from the left foot, hang, landing in the pit, standing out.

The joint angles come from gait_cycles.csv (run-up) and long_jump_keys.csv (from the fourth-last support on), which say where their
values are from. What is decided here is where the feet stand, how fast the body goes and how high its centre of mass travels:
  * feet: the step lengths below; while a foot is planted it turns about heel, ball or toe tip, which do not move;
  * flights, those of the run-up too: the centre of mass falls with 9.81 m/s^2, horizontally it keeps its speed;
  * supports: cubic between touchdown and toe-off, so that speeds agree.
The hips are put where the centre of mass asks for it, the planted legs follow by inverse kinematics, and what that changes fades out
over the swing. Foul line at z = 0 (z forwards), ground at y = 0, time 0 at the touchdown of the take-off foot.
"""

import math
import pathlib
import sys

import figure
import planting
from figure import GRAVITY, Curve, hermite, smooth

FPS, SUB = 60, 4  # output rate; solved at FPS * SUB
HERE = pathlib.Path(__file__).resolve().parent

# Run-up: foot, length of the step that follows (m), its duration (s), contact (s), ball ahead of the centre of mass at touchdown (m),
# trunk lean (deg), place between jog and run, run and sprint. A relaxed acceleration to 9.4 m/s: the first supports are long pushes
# under a leaning trunk, contact shortens and flight lengthens with speed (own estimate within the ranges of 12 to 20 step run-ups).
# The last five supports are those of the keys.
RUN_UP = [("L", 0.95, 0.400, 0.300, 0.25, 20, 0.00, 0.00), ("R", 1.20, 0.370, 0.260, 0.30, 18, 0.00, 0.00),
          ("L", 1.42, 0.345, 0.215, 0.34, 16, 0.32, 0.00), ("R", 1.60, 0.320, 0.192, 0.37, 14, 0.68, 0.00),
          ("L", 1.75, 0.297, 0.170, 0.39, 12, 1.00, 0.00), ("R", 1.88, 0.281, 0.153, 0.39, 11, 1.00, 0.22),
          ("L", 1.96, 0.268, 0.141, 0.39, 10, 1.00, 0.41), ("R", 2.03, 0.260, 0.130, 0.385, 9, 1.00, 0.56),
          ("L", 2.09, 0.253, 0.123, 0.38, 9, 1.00, 0.70), ("R", 2.14, 0.249, 0.119, 0.38, 8, 1.00, 0.81),
          ("L", 2.18, 0.245, 0.115, 0.375, 7, 1.00, 0.91), ("R", 2.21, 0.242, 0.113, 0.375, 7, 1.00, 0.98)]

# Supports of the keys: foot, touchdown, toe-off (s), ball's place (z forwards from the foul line, x left), m.
SUPPORTS = [("L", -0.937, -0.829, -9.246, 0.075), ("R", -0.701, -0.593, -7.035, -0.075), ("L", -0.463, -0.355, -4.777, 0.075),
            ("R", -0.215, -0.090, -2.366, -0.075), ("L", 0.000, 0.120, -0.160, 0.055)]
TAKE_OFF, HEELS_DOWN = 0.120, 0.894
# Landing: the heels plough 0.34 m through the sand in 0.15 s; the right foot steps out, the left one closes up to it.
LANDING_BALL, PLOUGH, PLOUGH_TIME, STANCE = 7.775, 0.34, 0.15, 0.130
STEP_OUT, CLOSE_UP, STAND_AT, END = (1.400, 1.660), (1.800, 2.100), 8.419, 2.64
FADE = 0.16         # s over which a planted leg's correction fades out of its swing
START = 1.25        # s of standing and pushing off before the first touchdown of the run-up
PUSH = 0.50         # s from standing still to the first touchdown

# A hand that passes the hips keeps so far (m) from their middle, to the side and, before or behind, beyond; a degree of abduction and one
# of outward rotation together move it by HAND_OUT.
HIPS_HALF, HIPS_DEEP, HAND_OUT = 0.235, 0.28, 0.0137

GAITS = {"jog": "jog_3.5", "run": "run_6.0", "sprint": "sprint_9.2"}
STANCE_SHARE = {"jog": 0.3625, "run": 0.2675, "sprint": 0.2260}  # of the stride, as in the tables


def load():
    keys = figure.read_table(HERE / "long_jump_keys.csv")
    names = [c for c in keys[0] if c not in ("t", "event")]
    times = [float(r["t"]) for r in keys]
    jump = {c: Curve(times, [float(r[c]) for r in keys]) for c in names}
    rows = figure.read_table(HERE / "gait_cycles.csv")
    gaits = {}
    for gait, label in GAITS.items():
        mine = [r for r in rows if r["gait"] == label]
        # The cycle is laid three times end to end, so that the curves are smooth over its ends.
        percent = [float(r["percent"]) + shift for shift in (-100, 0, 100) for r in mine[:-1]]
        gaits[gait] = {c: Curve(percent, [float(r[c]) for _ in range(3) for r in mine[:-1]]) for c in names if not c.startswith("com")}
    return jump, gaits, [c for c in names if not c.startswith("com")]


class Support:
    """One foot on the ground from td to to; `place(t)` is where its flat ball stands (x, z). Feet are eased down, but not into the sand."""

    def __init__(self, side, td, to, place, eased=True):
        self.side, self.td, self.to, self.place, self.eased = side, td, to, place if callable(place) else (lambda t, p=place: p), eased


class Jump:
    soft_knees = True

    def __init__(self):
        self.jump, self.gaits, self.names = load()
        self.plan_run_up()
        self.plan_supports()
        self.plan_center()

    # Touchdowns of the run-up, counted back from the first support of the keys.
    def plan_run_up(self):
        first = SUPPORTS[0]
        self.touchdowns = [first[1] - sum(step[2] for step in RUN_UP[k:]) for k in range(len(RUN_UP))] + [first[1]]
        self.places = [first[3] - sum(step[1] for step in RUN_UP[k:]) for k in range(len(RUN_UP))] + [first[3]]
        self.start = self.touchdowns[0] - START

    def plan_supports(self):
        out = []
        t0, z0 = self.touchdowns[0], self.places[0]
        self.rear = (z0 - 0.80, z0 - 0.54)  # where the feet stand at the start: left behind, right before
        out.append(Support("Left", self.start - 1, t0 - 0.46, (0.085, self.rear[0])))
        out.append(Support("Right", self.start - 1, t0 - 0.05, (-0.085, self.rear[1])))
        for k, step in enumerate(RUN_UP):
            half = 0.06 + 0.015 * k / len(RUN_UP)
            out.append(Support("Left" if step[0] == "L" else "Right", self.touchdowns[k], self.touchdowns[k] + step[3],
                               (half if step[0] == "L" else -half, self.places[k])))
        for foot, td, to, z, x in SUPPORTS:
            out.append(Support("Left" if foot == "L" else "Right", td, to, (x, z)))
        plough = lambda t: LANDING_BALL - PLOUGH * (1 - min(max((t - HEELS_DOWN) / PLOUGH_TIME, 0), 1)) ** 2
        closing = lambda t: STANCE + 0.015 * (1 - min(max((t - HEELS_DOWN) / PLOUGH_TIME, 0), 1))
        out.append(Support("Right", HEELS_DOWN, STEP_OUT[0], lambda t: (-closing(t), plough(t)), eased=False))
        out.append(Support("Left", HEELS_DOWN, CLOSE_UP[0], lambda t: (closing(t), plough(t)), eased=False))
        out.append(Support("Right", STEP_OUT[1], END + 1, (-0.120, STAND_AT)))
        out.append(Support("Left", CLOSE_UP[1], END + 1, (0.120, STAND_AT)))
        self.supports = out

    # Height of the body's centre at each touchdown and toe-off from equal heights at both ends of a flight, forward speed from the
    # steps; pieces (t0, t1, kind, values).
    def plan_center(self):
        key_y, key_z = self.jump["com_y"], self.jump["com_x"]
        n = len(RUN_UP)
        z_td = [self.places[k] - RUN_UP[k][4] for k in range(n)] + [key_z(self.touchdowns[n])]
        y_td = [1.040 + (key_y(self.touchdowns[n]) - 1.040) * k / n for k in range(n)] + [key_y(self.touchdowns[n])]
        mean = [(z_td[k + 1] - z_td[k]) / RUN_UP[k][2] for k in range(n)] + [9.43]
        flights = []  # per step: speed and upward speed at toe-off
        for k in range(n):
            flight = RUN_UP[k][2] - RUN_UP[k][3]
            rise = (y_td[k + 1] - y_td[k]) * 0.5
            flights.append((0.5 * (mean[k] + mean[k + 1]), rise / flight + 0.5 * GRAVITY * flight, y_td[k + 1] - rise, flight))
        self.center = []
        # From standing: no speed, then a steady push.
        speed0 = 0.75 * mean[0]
        self.push = (z_td[0], speed0, y_td[0])
        before = (speed0, -0.10)
        for k in range(n):
            vz, vy, y_to, flight = flights[k]
            td, to = self.touchdowns[k], self.touchdowns[k] + RUN_UP[k][3]
            self.center.append((td, to, "support", (z_td[k], before[0], z_td[k + 1] - vz * flight, vz), (y_td[k], before[1], y_to, vy)))
            self.center.append((to, self.touchdowns[k + 1], "flight", (z_td[k + 1] - vz * flight, vz), (y_to, vy)))
            before = (vz, vy - GRAVITY * flight)
        # The keys: flights between the supports, the jump, the rest as tabled.
        ends = [(a[2], b[1]) for a, b in zip(SUPPORTS, SUPPORTS[1:])]
        self.key_flights = []
        for to, td in ends:
            y0, y1, z0, z1 = key_y(to), key_y(td), key_z(to), key_z(td)
            self.key_flights.append((to, td, z0, (z1 - z0) / (td - to), y0, (y1 - y0) / (td - to) + 0.5 * GRAVITY * (td - to)))
        self.key_flights.append((TAKE_OFF, HEELS_DOWN, 0.2854, 8.40, 1.2054, 3.20))
        # Supports of the keys join the flights with their speeds.
        self.key_supports = []
        vz_in, vy_in = before
        for (foot, td, to, _, _), flight in zip(SUPPORTS, self.key_flights):
            z_in = key_z(td) if td == SUPPORTS[0][1] else self.key_flights[len(self.key_supports) - 1]
            if td != SUPPORTS[0][1]:
                p = self.key_flights[len(self.key_supports) - 1]
                span = td - p[0]
                z_in, y_in, vz_in, vy_in = p[2] + p[3] * span, p[4] + p[5] * span - 0.5 * GRAVITY * span ** 2, p[3], p[5] - GRAVITY * span
            else:
                y_in = key_y(td)
            self.key_supports.append((td, to, (z_in, vz_in, flight[2], flight[3]), (y_in, vy_in, flight[4], flight[5])))

    def center_at(self, t):
        """Wanted centre of mass, (0, y, z)."""
        if t < self.touchdowns[0]:
            z1, v1, y1 = self.push
            span = PUSH
            tau = max(0.0, t - (self.touchdowns[0] - span))
            z = z1 - 0.5 * v1 * span + 0.5 * v1 * tau * tau / span
            u = smooth(tau / span)
            return (0.0, STAND_Y + (y1 - STAND_Y) * u, z)
        for piece in self.center:
            if t < piece[1] or (piece is self.center[-1] and t < SUPPORTS[0][1]):
                t0, t1, kind, z, y = piece
                if kind == "flight":
                    tau = t - t0
                    return (0.0, y[0] + y[1] * tau - 0.5 * GRAVITY * tau * tau, z[0] + z[1] * tau)
                u = (t - t0) / (t1 - t0)
                return (0.0, hermite(u, t1 - t0, *y), hermite(u, t1 - t0, *z))
        for to, td, z0, vz, y0, vy in self.key_flights:
            if to <= t < td:
                tau = t - to
                return (0.0, y0 + vy * tau - 0.5 * GRAVITY * tau * tau, z0 + vz * tau)
        for td, to, z, y in self.key_supports:
            if td <= t < to:
                u = (t - td) / (to - td)
                return (0.0, hermite(u, to - td, *y), hermite(u, to - td, *z))
        return (0.0, self.jump["com_y"](t), self.jump["com_x"](t))

    def angles_at(self, t):
        """Anatomical angles by the tables, hands led past the hips."""
        a = self.tabled_angles(t)
        for _ in range(3):
            world = figure.kinematics((0.0, 0.0, 0.0), figure.rotations(a))
            hips, origin = figure.transpose(world["Hips"][0]), world["Hips"][1]
            for side, suffix, s in (("Left", "_l", 1), ("Right", "_r", -1)):
                turn, wrist = world[side + "Hand"]
                most = 0.0
                for point in (wrist, figure.add(wrist, figure.apply(turn, (0, -0.08, 0))), figure.add(wrist, figure.apply(turn, (0, -0.15, 0)))):
                    x, y, z = figure.apply(hips, figure.sub(point, origin))
                    room = (HIPS_HALF - 0.05 * smooth((y - 0.05) / 0.2)) * max(0.0, 1 - (z / HIPS_DEEP) ** 4) * (1 - smooth((y - 0.2) / 0.2))
                    off = room - s * x
                    most = max(most, 0.5 * (off + math.sqrt(off * off + 0.02 ** 2)))
                if most > 1e-3:
                    a["sh_abd" + suffix] += most / HAND_OUT
                    a["sh_rot" + suffix] -= most / HAND_OUT
        return a

    def tabled_angles(self, t):
        first_key = SUPPORTS[0][1]
        if t >= first_key:
            return {c: self.jump[c](max(t, self.jump[c].t[0])) for c in self.names}
        if t < self.touchdowns[0]:
            # Standing, then the second half of the jog's right support, at its own pace.
            t0 = self.touchdowns[0]
            phase = 50 + 100 * max(t - t0, -0.47) / 0.735
            running = {c: self.gaits["jog"][c](phase) for c in self.names}
            self.lean(running, 16)
            share = smooth((t - (t0 - START + 0.1)) / (START - 0.1 - 0.36))
            return {c: (1 - share) * self.jump[c](END) + share * running[c] for c in self.names}
        k = max(i for i in range(len(RUN_UP)) if self.touchdowns[i] <= t)
        step, after = RUN_UP[k], RUN_UP[min(k + 1, len(RUN_UP) - 1)]
        u = (t - self.touchdowns[k]) / step[2]
        base = 0 if step[0] == "R" else 50
        blends = [step[c] + (after[c] - step[c]) * u for c in (6, 7)]
        weights = {"jog": 1 - blends[0], "run": blends[0] * (1 - blends[1]), "sprint": blends[0] * blends[1]}
        out = dict.fromkeys(self.names, 0.0)
        tau = t - self.touchdowns[k]
        for gait, weight in weights.items():
            stance = 100 * STANCE_SHARE[gait]
            phase = stance * tau / step[3] if tau < step[3] else stance + (50 - stance) * (tau - step[3]) / (step[2] - step[3])
            for c in self.names:
                out[c] += weight * self.gaits[gait][c](base + phase)
        own = weights["jog"] * 8 + weights["run"] * 9 + weights["sprint"] * 7
        lean = step[5] + (after[5] - step[5]) * u
        share = 1.0 if k > 0 else 0.4 + 0.6 * smooth(u)  # the push-off has leaned less
        self.lean(out, own + share * (lean - own), own)
        return out

    @staticmethod
    def lean(a, wanted, own=8.0):
        extra = wanted - own
        a["pelvis_tilt"] += 0.3 * extra
        a["lumbar_flex"] += 0.4 * extra
        a["thorax_flex"] += 0.3 * extra
        a["neck_flex"] -= 0.5 * extra  # the eyes stay on the board
        for s in ("_l", "_r"):
            a["hip_flex" + s] += 0.3 * extra


def standing_height():
    zero = dict.fromkeys(load()[2], 0.0)
    return figure.center_of_mass(figure.kinematics(figure.OFFSET["Hips"], figure.rotations(zero)))[1]


STAND_Y = standing_height() - 0.035


def main():
    jump = Jump()
    count = int((END - jump.start) * FPS) + 1
    times = [jump.start + k / (FPS * SUB) for k in range(SUB * (count - 1) + 1)]
    frames, short = planting.solve(jump, times, FADE, passes=4)
    figure.write_bvh(HERE / "long_jump.bvh", FPS, frames[::SUB])
    print(f"long_jump.bvh: {len(frames[::SUB])} frames; a planted leg is too short by {1000 * short:.1f} mm at worst", file=sys.stderr)


if __name__ == "__main__":
    main()
