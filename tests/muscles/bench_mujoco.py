"""Time to pose all our muscles beside the time that MuJoCo takes for MyoFullBody's kinematics and tendon paths.

Usage: bench_mujoco.py ECORCHE PACKAGES [--rounds N] [--turns N]
Ours: kinematics, wrapping, contact and bellies of all muscles over 12 poses of a motion, one after the other (`ecorche bench --muscles`), on one thread, and by the clock on
all cores. The second parting after the skin has moved is no part of it.
MuJoCo's: mj_kinematics, mj_comPos and mj_tendon over 60 poses spread over its joints' ranges, one after the other. The two take turns, and the
least CPU time of each counts.
Ends with 77 when MuJoCo or the package is not there. The ratio is printed, never asserted: times depend on what else runs.
"""

import argparse
import glob
import json
import os
import subprocess
import sys
import tempfile
import time

from compare_mujoco import SKIPPED, Model, mujoco, np

ASKED = 4.0
POSES = 60


def tendon_ms(model, rounds):
    """Least CPU time of one pose, ms."""
    m, d = model.model, model.data
    low, high = m.jnt_range.T
    poses = []
    for k in range(POSES):
        qpos = m.qpos0.copy()
        share = 0.5 + 0.45 * np.sin(0.1 * k + np.arange(m.njnt))
        for j in np.flatnonzero((m.jnt_type >= int(mujoco.mjtJoint.mjJNT_SLIDE)) & (m.jnt_limited != 0)):
            qpos[m.jnt_qposadr[j]] = low[j] + share[j] * (high[j] - low[j])
        poses.append(qpos)
    least = float("inf")
    for _ in range(rounds):
        start = time.process_time()
        for qpos in poses:
            d.qpos[:] = qpos
            mujoco.mj_kinematics(m, d)
            mujoco.mj_comPos(m, d)
            mujoco.mj_tendon(m, d)
        least = min(least, (time.process_time() - start) / POSES)
    return 1e3 * least


def our_ms(ecorche, rounds):
    """Least times of one pose, ms: CPU time of one thread, and by the clock on all cores."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "bench.json")
        subprocess.run([ecorche, "bench", "--muscles", "--rounds", str(rounds), "--report", path, "-q"], check=True, stdout=subprocess.DEVNULL)
        with open(path) as file:
            report = json.load(file)
    row = report["bench"]["muscles_row_13k"]
    return np.array([row["ms"], row["all_cores_ms"]])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("ecorche")
    parser.add_argument("packages")
    parser.add_argument("--rounds", type=int, default=40, help="of 60 poses, in one turn")
    parser.add_argument("--turns", type=int, default=3)
    options = parser.parse_args()
    wheels = glob.glob(os.path.join(options.packages, "musclemimic_models-*.whl"))
    if not wheels:
        print(f"skipped: no musclemimic_models in {options.packages}; make setup")
        return SKIPPED
    model = Model(wheels[0])
    theirs, ours = float("inf"), np.full(2, np.inf)
    for _ in range(options.turns):
        theirs = min(theirs, tendon_ms(model, options.rounds))
        ours = np.minimum(ours, our_ms(options.ecorche, options.rounds))
    theirs = min(theirs, tendon_ms(model, options.rounds))
    print(f"MuJoCo's kinematics and {model.model.ntendon} tendon paths {theirs:.3f} ms")
    for name, ms in zip(("one thread", "all cores"), ours):
        print(f"all our muscles, {name}: {ms:.3f} ms, ratio {ms / theirs:.2f} (asked {ASKED:.0f})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
