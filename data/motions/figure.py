"""The 1.85 m figure that our motions are authored on: joints, masses, kinematics, leg inverse kinematics, BVH output.

Metres, Y up, Z forwards, X to the body's left. Standing upright with hanging arms and palms to the thighs, all rotations are zero.
Standard library only; the same input gives the same bytes.
"""

import bisect
import csv
import math

GRAVITY = 9.81

# name, parent, offset from the parent, end site, channels. Leg lengths and shoulder height as in the reference figure; names as
# MotionBuilder has them.
_XZY = ("Xrotation", "Zrotation", "Yrotation")
THIGH, SHANK, ANKLE_HEIGHT = 0.453, 0.455, 0.072
HEEL, BALL, TIP = (0.0, -ANKLE_HEIGHT, -0.055), (0.0, -ANKLE_HEIGHT, 0.140), (0.0, -ANKLE_HEIGHT, 0.220)


def _joints():
    joints = [
        ("Hips", None, (0, THIGH + SHANK + ANKLE_HEIGHT, 0), None),
        ("Spine", "Hips", (0, 0.095, -0.015), None),
        ("Spine1", "Spine", (0, 0.170, -0.005), None),
        ("Neck", "Spine1", (0, 0.315, -0.010), None),
        ("Head", "Neck", (0, 0.105, 0.025), (0, 0.185, 0)),
    ]
    for side, s in (("Left", 1), ("Right", -1)):
        joints += [
            (side + "Shoulder", "Spine1", (0.022 * s, 0.240, 0.060), None),
            (side + "Arm", side + "Shoulder", (0.163 * s, 0.028, -0.060), None),
            (side + "ForeArm", side + "Arm", (0, -0.344, 0), None),
            (side + "Hand", side + "ForeArm", (0, -0.270, 0), None),
        ]
        for finger, x, y, z, bones in (("Thumb", 0.012, -0.030, 0.030, (0.040, 0.032, 0.028)),
                                       ("Index", 0.0, -0.095, 0.028, (0.044, 0.026, 0.022)),
                                       ("Middle", 0.0, -0.098, 0.006, (0.048, 0.030, 0.024)),
                                       ("Ring", 0.0, -0.092, -0.015, (0.045, 0.028, 0.024)),
                                       ("Pinky", 0.0, -0.083, -0.034, (0.036, 0.021, 0.021))):
            along = (0.0, -0.80, 0.60) if finger == "Thumb" else (0.0, -1.0, 0.0)
            offset, parent = (-x * s, y, z), side + "Hand"
            for k, length in enumerate(bones):
                name = f"{side}Hand{finger}{k + 1}"
                tip = tuple(length * a for a in along)
                joints.append((name, parent, offset, tip if k == 2 else None))
                offset, parent = tip, name
    for side, s in (("Left", 1), ("Right", -1)):
        joints += [
            (side + "UpLeg", "Hips", (0.0875 * s, 0, 0), None),
            (side + "Leg", side + "UpLeg", (0, -THIGH, 0), None),
            (side + "Foot", side + "Leg", (0, -SHANK, 0), None),
            (side + "ToeBase", side + "Foot", BALL, (0, 0, TIP[2] - BALL[2])),
        ]
    return joints


JOINTS = _joints()
PARENT = {name: parent for name, parent, _, _ in JOINTS}
OFFSET = {name: offset for name, _, offset, _ in JOINTS}

# Share of the body's mass and place of its centre in the joint's frame (Winter 2009; trunk in three parts).
MASSES = [("Hips", 0.142, (0, 0.050, -0.010)), ("Spine", 0.139, (0, 0.085, 0.010)), ("Spine1", 0.216, (0, 0.170, 0.012)),
          ("Neck", 0.081, (0, 0.165, 0.022))]
for _side in ("Left", "Right"):
    MASSES += [(_side + "Arm", 0.028, (0, -0.150, 0)), (_side + "ForeArm", 0.016, (0, -0.116, 0)), (_side + "Hand", 0.006, (0, -0.080, 0)),
               (_side + "UpLeg", 0.100, (0, -0.433 * THIGH, 0)), (_side + "Leg", 0.0465, (0, -0.433 * SHANK, 0)),
               (_side + "Foot", 0.0145, (0, -0.040, 0.055))]
_TOTAL = sum(m for _, m, _ in MASSES)


# --- 3-vectors as tuples, rotations as row-major 9-tuples -------------------------------------------------------------------------
def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def mul(A, B):
    return tuple(A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j] for i in range(3) for j in range(3))


def apply(A, v):
    return tuple(A[3 * i] * v[0] + A[3 * i + 1] * v[1] + A[3 * i + 2] * v[2] for i in range(3))


def transpose(A):
    return (A[0], A[3], A[6], A[1], A[4], A[7], A[2], A[5], A[8])


def turn(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {"X": (1, 0, 0, 0, c, -s, 0, s, c), "Y": (c, 0, s, 0, 1, 0, -s, 0, c), "Z": (c, -s, 0, s, c, 0, 0, 0, 1)}[axis]


def turns(*pairs):
    R = (1, 0, 0, 0, 1, 0, 0, 0, 1)
    for axis, degrees in pairs:
        R = mul(R, turn(axis, degrees))
    return R


def between(A, B, share):
    """A rotation between two near ones."""
    M = [(1 - share) * a + share * b for a, b in zip(A, B)]
    unit = lambda v: tuple(c / math.sqrt(sum(d * d for d in v)) for c in v)
    x = unit(M[0:3])
    y = M[3:6]
    along = sum(p * q for p, q in zip(x, y))
    y = unit([q - along * p for p, q in zip(x, y)])
    z = (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0])
    return x + y + z


def xzy_angles(R):
    """Degrees x, z, y with R = Rx Rz Ry."""
    z = math.atan2(-R[1], math.hypot(R[0], R[2]))
    return tuple(math.degrees(a) for a in (math.atan2(R[7], R[4]), z, math.atan2(R[2], R[0])))


def smooth(x):
    x = min(max(x, 0.0), 1.0)
    return x * x * x * (10 - 15 * x + 6 * x * x)


# --- poses ------------------------------------------------------------------------------------------------------------------------
def rotations(a):
    """Anatomical angles (see long_jump_keys.csv) -> local rotation of every joint that turns."""
    R = {
        "Hips": turns(("Y", a["pelvis_rotation"]), ("Z", a["pelvis_obliquity"]), ("X", a["pelvis_tilt"])),
        "Spine": turns(("X", a["lumbar_flex"]), ("Z", a["lumbar_bend"]), ("Y", a["lumbar_rot"])),
        "Spine1": turns(("X", a["thorax_flex"]), ("Z", a["thorax_bend"]), ("Y", a["thorax_rot"])),
        "Neck": turns(("X", a["neck_flex"]), ("Z", a["neck_bend"]), ("Y", a["neck_rot"])),
        "Head": turns(("X", a["head_flex"])),
    }
    for side, suffix, s in (("Left", "_l", -1), ("Right", "_r", 1)):
        g = lambda name: a[name + suffix]
        collar = turns(("Y", s * g("clav_protr")), ("Z", -s * g("clav_elev")))
        arm = turns(("X", -g("sh_flex")), ("Z", -s * g("sh_abd")), ("Y", s * g("sh_rot")))
        R[side + "Shoulder"] = collar
        R[side + "Arm"] = mul(transpose(collar), arm)  # the arm's angles are those to the thorax
        R[side + "ForeArm"] = turns(("X", -g("elbow_flex")), ("Y", s * g("pronation")))
        R[side + "Hand"] = turns(("Z", s * g("wrist_flex")))
        for finger in ("Index", "Middle", "Ring", "Pinky"):
            for k, share in ((1, 1.0), (2, 1.0), (3, 0.6)):
                R[f"{side}Hand{finger}{k}"] = turns(("Z", s * share * g("finger_flex")))
        for k, share in ((1, 0.2), (2, 0.4), (3, 0.5)):
            R[f"{side}HandThumb{k}"] = turns(("X", 0.5 * share * g("finger_flex")), ("Z", s * 0.5 * share * g("finger_flex")))
        R[side + "UpLeg"] = turns(("X", -g("hip_flex")), ("Z", -s * g("hip_abd")), ("Y", s * g("hip_rot")))
        R[side + "Leg"] = turns(("X", g("knee_flex")))
        R[side + "Foot"] = turns(("X", -g("ankle_dorsi")), ("Z", s * a.get("ankle_inv" + suffix, 0.0)), ("Y", s * a.get("foot_rot" + suffix, 0.0)))
        R[side + "ToeBase"] = turns(("X", -g("toe_ext")))
    return R


def kinematics(root, R):
    """World rotation and place of every joint."""
    world = {}
    for name, parent, offset, _ in JOINTS:
        if parent is None:
            world[name] = (R[name], root)
        else:
            P, p = world[parent]
            world[name] = (mul(P, R[name]) if name in R else P, add(p, apply(P, offset)))
    return world


def center_of_mass(world):
    sums = [0.0, 0.0, 0.0]
    for name, mass, place in MASSES:
        P, p = world[name]
        point = add(p, apply(P, place))
        for k in range(3):
            sums[k] += mass * point[k]
    return tuple(s / _TOTAL for s in sums)


def foot_points(world, side):
    P, p = world[side + "Foot"]
    Q, q = world[side + "ToeBase"]
    return {"heel": add(p, apply(P, HEEL)), "ball": q, "tip": add(q, apply(Q, (0, 0, TIP[2] - BALL[2])))}


MAX_TOE_EXTENSION = 30.0  # deg; beyond it the foot rolls over the tip of the toes


def planted_foot(place, pitch):
    """A foot on the ground, its flat ball at `place` (x, z), pitched by `pitch` (deg, toes up): it turns about the heel, then about
    the ball with the toes flat, then about their tip. Returns world rotation and place of the ankle, and the toes' extension."""
    R = turn("X", -pitch)
    if pitch >= 0:
        pivot, point, extension = (place[0], 0.0, place[1] + HEEL[2] - BALL[2]), HEEL, 0.0
    else:
        extension = min(-0.85 * pitch, MAX_TOE_EXTENSION)
        toe = apply(turn("X", -(pitch + extension)), (0, 0, TIP[2] - BALL[2]))
        pivot, point = sub((place[0], 0.0, place[1] + TIP[2] - BALL[2]), toe), BALL
    return R, sub(pivot, apply(R, point)), extension


STRETCH, MOST_STRETCH = 0.97, 0.993  # of its length: how far a free leg goes before it slows down, and comes to at most (14 deg of knee)


def free_reach(distance):
    """How far a free leg reaches towards something `distance` away: its knee runs out slowly instead of stopping dead."""
    length = THIGH + SHANK
    room, beyond = (MOST_STRETCH - STRETCH) * length, distance - STRETCH * length
    return distance if beyond <= 0 else STRETCH * length + room * (1 - math.exp(-beyond / room))


def reach_leg(world_hips, side, ankle, foot_rotation, hip_rot, free=False):
    """Rotations of hip, knee and foot that bring the ankle there, knee forwards, thigh turned inwards by hip_rot; their angles; and
    the distance that the leg is too short by. A free leg is one that does not bear the body."""
    s = 1 if side == "Right" else -1
    P, p = world_hips
    v = apply(transpose(P), sub(ankle, add(p, apply(P, OFFSET[side + "UpLeg"]))))
    distance = math.sqrt(sum(x * x for x in v))
    reach = free_reach(distance) if free else min(distance, 0.9995 * (THIGH + SHANK))
    knee = math.degrees(math.acos((reach * reach - THIGH ** 2 - SHANK ** 2) / (2 * THIGH * SHANK)))
    k = math.radians(knee)
    w = apply(turn("Y", s * hip_rot), (0, -THIGH - SHANK * math.cos(k), -SHANK * math.sin(k)))
    # Rx(-flex) Rz(-s abd) w = v: abduction from x, then flexion in the plane that is left.
    across = math.hypot(w[0], w[1])
    side_angle = math.asin(min(max(v[0] / distance * reach / across, -1), 1)) - math.atan2(w[0], -w[1])
    u = apply(turn("Z", math.degrees(side_angle)), w)
    flex = math.degrees(math.atan2(v[2], -v[1]) - math.atan2(u[2], -u[1]))
    hip = turns(("X", -flex), ("Z", math.degrees(side_angle)), ("Y", s * hip_rot))
    shank = mul(mul(P, hip), turn("X", knee))
    foot = mul(transpose(shank), foot_rotation)
    x, z, y = xzy_angles(foot)
    angles = {"hip_flex": flex, "hip_abd": -s * math.degrees(side_angle), "knee_flex": knee, "ankle_dorsi": -x, "ankle_inv": s * z,
              "foot_rot": s * y}
    return hip, turn("X", knee), foot, angles, distance - reach


# --- tables -----------------------------------------------------------------------------------------------------------------------
def read_table(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


class Curve:
    """Monotone piecewise cubic (Fritsch & Carlson 1980) through points with rising t."""

    def __init__(self, t, y):
        self.t, self.y = t, y
        h = [b - a for a, b in zip(t, t[1:])]
        d = [(b - a) / w for a, b, w in zip(y, y[1:], h)]
        m = [d[0]] + [0.0] * (len(t) - 2) + [d[-1]]
        for k in range(1, len(t) - 1):
            if d[k - 1] * d[k] > 0:
                w1, w2 = 2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]
                m[k] = (w1 + w2) / (w1 / d[k - 1] + w2 / d[k])
        self.m = m

    def __call__(self, x):
        t = self.t
        x = min(max(x, t[0]), t[-1])
        k = min(max(bisect.bisect_right(t, x) - 1, 0), len(t) - 2)
        h = t[k + 1] - t[k]
        u = (x - t[k]) / h
        return ((1 + 2 * u) * (1 - u) ** 2 * self.y[k] + u * (1 - u) ** 2 * h * self.m[k] + u * u * (3 - 2 * u) * self.y[k + 1] +
                u * u * (u - 1) * h * self.m[k + 1])


def hermite(u, span, y0, v0, y1, v1):
    """Cubic from y0 with slope v0 to y1 with slope v1 over `span`, at u in [0, 1]."""
    return ((1 + 2 * u) * (1 - u) ** 2 * y0 + u * (1 - u) ** 2 * span * v0 + u * u * (3 - 2 * u) * y1 + u * u * (u - 1) * span * v1)


# --- output -----------------------------------------------------------------------------------------------------------------------
def write_bvh(path, fps, frames):
    """frames: (root, rotations). Centimetres, degrees."""
    lines = ["HIERARCHY"]
    depth, open_joints = 0, []
    number = lambda x: f"{x:.4f}".rstrip("0").rstrip(".").replace("-0", "0") if abs(x) < 5e-5 else f"{x:.4f}".rstrip("0").rstrip(".")
    cm = lambda v: " ".join(number(100 * x) for x in v)
    for name, parent, offset, end in JOINTS:
        while open_joints and open_joints[-1] != parent:
            open_joints.pop()
            lines.append("  " * len(open_joints) + "}")
        pad = "  " * len(open_joints)
        lines += [f"{pad}{'JOINT' if parent else 'ROOT'} {name}", pad + "{", f"{pad}  OFFSET {cm(offset)}"]
        positions = "" if parent else "Xposition Yposition Zposition "
        lines.append(f"{pad}  CHANNELS {3 if parent else 6} {positions}{' '.join(_XZY)}")
        if end:
            lines += [pad + "  End Site", pad + "  {", f"{pad}    OFFSET {cm(end)}", pad + "  }"]
        open_joints.append(name)
    while open_joints:
        open_joints.pop()
        lines.append("  " * len(open_joints) + "}")
    lines += ["MOTION", f"Frames: {len(frames)}", f"Frame Time: {1 / fps:.7f}"]
    last = {}
    for root, R in frames:
        row = [number(100 * x) for x in root]
        for name, _, _, _ in JOINTS:
            angles = list(xzy_angles(R[name])) if name in R else [0.0, 0.0, 0.0]
            for k in range(3):  # no jumps by full turns
                before = last.get((name, k), angles[k])
                angles[k] += 360 * round((before - angles[k]) / 360)
                last[(name, k)] = angles[k]
            row += [number(x) for x in angles]
        lines.append(" ".join(row))
    with open(path, "w", newline="\n", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
