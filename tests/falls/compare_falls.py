"""Courses of our ragdoll beside MuJoCo's, of the model that we export.

Usage: compare_falls.py ECORCHE RAGDOLL_FIGURES [CHARACTER.glb [STEPS A SECOND]]
Flight: the whole body thrown, turning about hips, knees, ankles, shoulders and elbows. Pendulum: a leg that hangs from a pelvis that is held. Drop: the body
without joints, on its back from 0.3 m onto the points that ours meets the ground with. MuJoCo's bodies have the exported masses, inertias and places; their
joints are those that move, without friction. Ends with 77 when MuJoCo is not there.
"""

import csv
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET

try:
    import mujoco
    import numpy as np
except ImportError:
    print("skipped: MuJoCo is not installed: run make clients")
    sys.exit(77)

ASKED = 0.02
C = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])  # our axes to MuJoCo's: z forwards, x left, y up
STEP = 2e-4


def text(values):
    return " ".join("%.17g" % v for v in values)


def read_start(path):
    rows = list(csv.reader(open(path)))
    place, turned = ([float(x) for x in row[1:]] for row in rows[:2])
    return np.array(place[:3]), np.array(turned), [(r[0], np.array([float(x) for x in r[1:4]]), float(r[4])) for r in rows[2:]]


def give_back_tokens(root, segments):
    """The export gives a body without a segment of its own, a vertebra or a toe, some grams of the segment's mass, as simulators want it. Here they weigh nothing."""
    total = taken = 0
    for body in root.iter("body"):
        inertial = body.find("inertial")
        mass = float(inertial.get("mass"))
        total += mass
        own = segments.get(body.get("name"))
        if own is None:
            taken += mass
            inertial.attrib.update(mass="1e-9", fullinertia="1e-12 1e-12 1e-12 0 0 0")
            continue
        center, inertia = C @ own[1:4], C @ own[4:].reshape(3, 3) @ C.T
        assert np.linalg.norm(center - np.array([float(x) for x in inertial.get("pos").split()])) < 1e-6, "the centre of %s differs" % body.get("name")
        assert 0.2 < mass / own[0] <= 1 + 1e-9, "the mass of %s differs" % body.get("name")
        inertial.attrib.update(mass="%.17g" % own[0], fullinertia=text(inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]))
    weight = sum(own[0] for own in segments.values())
    assert abs(total - weight) < 1e-4 * weight, "%.3f kg are exported, ours are %.3f" % (total, weight)
    return total, taken


def build(exported, segments, freedoms, held, points):
    """The exported bodies with these freedoms alone."""
    root = ET.parse(exported).getroot()
    give_back_tokens(root, segments)
    for name in ("tendon", "actuator", "equality", "sensor", "contact", "keyframe", "default", "asset"):
        for part in root.findall(name):
            root.remove(part)
    axes = {}
    for joint, axis, _ in freedoms:
        axes.setdefault(joint, []).append(axis)
    for body in root.iter("body"):
        exported_axes = {}
        for part in list(body):
            if part.tag == "joint":
                exported_axes[part.get("name")] = np.array([float(x) for x in part.get("axis").split()])
            if part.tag in ("joint", "freejoint", "geom", "site"):
                body.remove(part)
        name = body.get("name")
        moving = axes.get(name, [])
        if name == "pelvis" and not held:
            body.insert(0, ET.Element("freejoint", name="pelvis"))
        elif len(moving) == 3:
            body.insert(0, ET.Element("joint", name=name, type="ball"))
        elif moving:
            theirs = exported_axes[name + "_flexion"]
            assert abs(theirs @ (C @ moving[0])) > 0.9999 * np.linalg.norm(theirs), "the exported axis of %s differs" % name
            body.insert(0, ET.Element("joint", name=name, type="hinge", axis=text(C @ moving[0])))
    world = root.find("worldbody")
    for part in world.findall("geom") + world.findall("site"):
        world.remove(part)
    if points is not None:
        # damped far beyond the critical, so that nothing bounces: ours does not
        near = dict(condim="3", friction="0.5 0.005 0.0001", solref="0.001 10", solimp="0.95 0.99 0.001")
        ET.SubElement(world, "geom", type="plane", size="5 5 1", **near)
        pelvis = next(b for b in root.iter("body") if b.get("name") == "pelvis")
        for point in points:
            ET.SubElement(pelvis, "geom", type="sphere", size="0.0005", mass="0", pos=text(C @ point), **near)
    option = root.find("option") if root.find("option") is not None else ET.SubElement(root, "option")
    option.attrib.clear()
    option.attrib.update(timestep=str(STEP), integrator="RK4", gravity="0 0 -9.81", cone="elliptic")
    for flag in option.findall("flag"):
        option.remove(flag)
    ET.SubElement(option, "flag", energy="enable", contact="enable" if points is not None else "disable")
    return mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))


def compare(name, folder, exported, segments, held=False, points=None):
    place, turned, freedoms = read_start(os.path.join(folder, name + "_start.csv"))
    model = build(exported, segments, freedoms, held, points)
    data = mujoco.MjData(model)
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, turned[[3, 0, 1, 2]])
    R = C @ turn.reshape(3, 3) @ C.T
    if not held:
        data.qpos[:3] = C @ place
        mujoco.mju_mat2Quat(data.qpos[3:7], R.flatten())
    speeds = {}
    for joint, axis, velocity in freedoms:
        speeds[joint] = speeds.get(joint, 0) + velocity * (C @ axis)
    for joint, speed in speeds.items():
        if joint == "root":
            data.qvel[:3] = speed
        elif joint == "turn":
            data.qvel[3:6] = R.T @ speed
        else:
            at = model.joint(joint)
            adr = at.dofadr[0]
            if at.type[0] == mujoco.mjtJoint.mjJNT_BALL:
                data.qvel[adr : adr + 3] = speed
            else:
                data.qvel[adr] = speed @ model.jnt_axis[at.id]
    rows = list(csv.DictReader(open(os.path.join(folder, name + "_course.csv"))))
    seen = [k[:-2] for k in rows[0] if k.endswith("_x")]
    ours = np.array([[[float(r[j + "_" + k]) for k in "xyz"] for j in seen] for r in rows])
    theirs, energy, kinetic = [], [], []
    for row in rows:
        while data.time < float(row["time"]) - STEP / 2:
            mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        theirs.append([C.T @ data.body(j).xpos for j in seen])
        energy.append(sum(data.energy))
        kinetic.append(data.energy[1])
    theirs, energy = np.array(theirs), np.array(energy)
    own = np.array([float(r["energy"]) for r in rows])
    way = np.max(np.linalg.norm(theirs - theirs[0], axis=2))
    off = np.max(np.linalg.norm(ours - theirs, axis=2), axis=1)
    size = sum(model.body_mass) * 9.81 * 0.3 if points is not None else max(kinetic)
    # Energies are counted from other heights. Impacts may be a sample, 10 ms, earlier or later: ours lies between MuJoCo's before and after.
    near = [np.roll(energy - energy[0], k)[1:-1] for k in (-1, 0, 1)]
    mine = (own - own[0])[1:-1]
    lost = np.maximum(0, np.maximum(mine - np.max(near, axis=0), np.min(near, axis=0) - mine))
    print("%-9s %5.2f s: places differ by up to %.1f mm of a way of %.2f m (%.2f %%), energies by %.2f J of %.1f (%.2f %%)"
          % (name, float(rows[-1]["time"]), 1e3 * off.max(), way, 100 * off.max() / way, lost.max(), size, 100 * lost.max() / size))
    return off.max() / way, lost.max() / size, sum(model.body_mass)


def main():
    ecorche, figures = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as folder:
        if len(sys.argv) > 3:
            character = sys.argv[3]
        else:
            character = os.path.join(folder, "c.glb")
            body = os.path.join(folder, "b.glb")
            subprocess.run([ecorche, "body", "new", "--sex", "female", "--age", "30", "--height", "1.68", "--mass", "60", "-o", body, "-q"], check=True)
            subprocess.run([ecorche, "fit", body, "-o", character, "-q"], check=True)
        exported = os.path.join(folder, "c.xml")
        subprocess.run([ecorche, "export", character, "-o", exported, "-q"], check=True)
        subprocess.run([figures, character, folder, *sys.argv[4:]], check=True)
        points = [[float(x) for x in line.split(",")] for line in open(os.path.join(folder, "points.csv"))]
        rows = csv.reader(open(os.path.join(folder, "segments.csv")))
        segments = {row[0]: np.array([float(x) for x in row[1:]]) for row in rows}
        of = (folder, exported, segments)
        found = [compare("flight", *of), compare("pendulum", *of, held=True), compare("drop", *of, points=points)]
        worst = max(max(way, energy) for way, energy, _ in found)
        assert worst <= ASKED, "%.2f %% apart; asked for %.0f %%" % (100 * worst, 100 * ASKED)


main()
