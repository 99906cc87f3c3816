"""python compare_opensim.py ECORCHE CHARACTER.glb MOTION FOLDER   Moments and moment arms of our model beside those OpenSim finds on its export.

Run by hand, with the Python of `make clients` (build/clients/physics/bin/python), on a character of `ecorche fit`. Nothing outside holds the body, and nothing is smoothed, so
that both have the same motion: accelerations are differences of the frames before and after. Prints, of hips, knees and ankles, r, the root mean square difference and
that of our moment (N m) over the inner frames; and of the strips that pull at knee and ankle in five frames, r and the difference of the moment arms (mm).
Ends 1 where a moment or an arm has r < 0.8."""
import math
import os
import subprocess
import sys

import numpy as np
import opensim

MOMENTS = ["hip_%s_flexion", "hip_%s_abduction", "knee_%s_flexion", "ankle_%s_flexion"]
ARMS = ["hip_r_flexion", "knee_r_flexion", "ankle_r_flexion"]


def ours(ecorche, character, motion, folder):
    names = {what: os.path.join(folder, what + ".sto") for what in ["angles", "forces"] + ARMS}
    tables = ["--table", "angles=" + names["angles"]] + [x for arm in ARMS for x in ("--table", "moment-arms:%s=%s" % (arm, names[arm]))]
    subprocess.run([ecorche, "animate", character, motion, *tables, "-q"], check=True)
    subprocess.run([ecorche, "dynamics", character, motion, "--no-ground", "--cutoff", "0", "-o", names["forces"], "-q"], check=True)
    model = os.path.join(folder, "model.osim")
    subprocess.run([ecorche, "export", character, "-o", model, "-q"], check=True)
    return model, {what: opensim.TimeSeriesTable(name) for what, name in names.items()}


def column(table, name):
    labels = list(table.getColumnLabels())
    return table.getDependentColumnAtIndex(labels.index(name)).to_numpy()


def compare(a, b):
    both = np.std(a) * np.std(b)
    return np.corrcoef(a, b)[0, 1] if both > 0 else 1.0, float(np.sqrt(np.mean((a - b) ** 2)))


def main(ecorche, character, motion, folder):
    opensim.Logger.setLevelString("Error")
    path, tables = ours(ecorche, character, motion, folder)
    model = opensim.Model(path)
    state = model.initSystem()
    angles = tables["angles"]
    times, labels = np.array(angles.getIndependentColumn()), list(angles.getColumnLabels())
    values = np.array([column(angles, label) * (1 if label.endswith(("_tx", "_ty", "_tz")) else math.pi / 180) for label in labels]).T
    step = times[1] - times[0]
    coordinates = model.getCoordinateSet()
    # Which speed of the state is whose: each is set to its own number.
    for i in range(coordinates.getSize()):
        coordinates.get(i).setSpeedValue(state, i + 1)
    order = [coordinates.get(round(state.getU().get(k)) - 1).getName() for k in range(state.getNU())]
    solver = opensim.InverseDynamicsSolver(model)
    frames = range(2, len(times) - 2)

    def put(frame):
        for i, label in enumerate(labels):
            coordinate = coordinates.get(label)
            coordinate.setValue(state, values[frame, i], False)
            coordinate.setSpeedValue(state, (values[frame + 1, i] - values[frame - 1, i]) / (2 * step))

    for i in range(model.getForceSet().getSize()):
        model.getForceSet().get(i).setAppliesForce(state, False)
    found = []
    for frame in frames:
        put(frame)
        model.realizeVelocity(state)
        bends = (values[frame + 1] - 2 * values[frame] + values[frame - 1]) / step**2
        udot = opensim.Vector(state.getNU(), 0.0)
        for k, name in enumerate(order):
            if name in labels:
                udot.set(k, bends[labels.index(name)])
        found.append(solver.solve(state, udot).to_numpy())
    found, bad = np.array(found), []
    for pattern in MOMENTS:
        for side in "lr":
            name = pattern % side
            own, there = column(tables["forces"], name + "_moment")[2:-2], found[:, order.index(name)]
            r, off = compare(own, there)
            print("%-20s r %.4f, off %.2f of %.2f N m" % (name, r, off, np.sqrt(np.mean(own**2))))
            bad += [name] if r < 0.8 else []
    muscles = model.getMuscles()
    names = {muscles.get(i).getName() for i in range(muscles.getSize())}
    for arm in ARMS:
        strips = [label for label in tables[arm].getColumnLabels() if label in names]
        own, there = [], []
        for frame in np.linspace(2, len(times) - 3, 5).astype(int):
            put(frame)
            model.realizePosition(state)
            for strip in strips:
                own.append(column(tables[arm], strip)[frame])
                there.append(muscles.get(strip).computeMomentArm(state, coordinates.get(arm)))
        r, off = compare(np.array(own), np.array(there))
        middle = float(np.median(np.abs(np.array(own) - there)))
        print("arms %-15s r %.4f, off %.1f mm (median %.1f) over %d strips" % (arm, r, 1e3 * off, 1e3 * middle, len(strips)))
        bad += ["arms of " + arm] if r < 0.8 else []
    if bad:
        print("differs:", ", ".join(bad))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:5]))
