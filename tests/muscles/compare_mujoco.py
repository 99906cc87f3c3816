"""Our muscles' lengths beside those that MuJoCo finds for MyoFullBody, while one joint after the other turns.

Usage: compare_mujoco.py ECORCHE PACKAGES [--step DEGREES] [--out FILE.csv]
ECORCHE: the executable, or a table that its `template sweep` has written. PACKAGES: the folder with the bone package's wheel.

Both models stand on the same bones, in the same pose and with the same joint centres, so that nothing is scaled. A sweep turns one
joint; all others stay at zero, but for the knee's, which the model couples to its flexion (roll, slide, patella). Lengths are compared
over the range that both joints have, less those at zero. A muscle counts at a joint where either model's length changes by 2 mm.
Moment arms are the slopes of the lengths; their signs are compared wherever the model's is at least 3 mm. Pairs of muscle and axis where the
model's own path is not what anatomy says (`mujoco_doubts.csv`, with the reasons) are printed with a question mark and summed up apart.
Ends with 77 when MuJoCo or the package is not there, with 1 when a figure falls short of `REACHED`.
"""

import argparse
import csv
import glob
import os
import re
import statistics
import subprocess
import sys
import tempfile
import zipfile
from collections import defaultdict

SKIPPED = 77
COUNTS = 2.0  # mm: a change of length that is compared
ARM = 3.0  # mm: a moment arm whose sign is compared

# What is asked, and what must not be lost again.
ASKED = {"muscles": 60, "correlation": 0.95, "rms": 10.0, "sign": 95.0}
REACHED = {"muscles": 60, "correlation": 0.95, "rms": 10.0, "sign": 95.0}

try:
    import mujoco
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}; make clients")
    sys.exit(SKIPPED)


def table(name):
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), name)) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def our_sweeps(ecorche, step):
    if ecorche.endswith(".csv"):
        return read_sweeps(ecorche)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "sweeps.csv")
        subprocess.run([ecorche, "template", "sweep", "--step", str(step), "-o", path, "-q"], check=True)
        return read_sweeps(path)


def read_sweeps(path):
    """(joint, axis) -> muscle -> strip -> points (angle in degrees, length in mm)."""
    strips = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    with open(path) as file:
        for row in csv.DictReader(file):
            key = row["joint"], row["axis"]
            strips[key][row["muscle"]][row["strip"]].append((float(row["angle_deg"]), float(row["length_mm"])))
    return strips


class Model:
    def __init__(self, wheel):
        with tempfile.TemporaryDirectory() as folder:
            with zipfile.ZipFile(wheel) as archive:
                archive.extractall(folder)
            (path,) = glob.glob(os.path.join(folder, "*", "model", "body", "myofullbody.xml"))
            self.model = mujoco.MjModel.from_xml_path(path)
        self.data = mujoco.MjData(self.model)
        self.muscles = {self.model.actuator(i).name: i for i in range(self.model.nu)}

    def joint(self, name):
        return self.model.joint(name)

    def stand(self):
        """Zero, and what the equalities' constant terms ask for."""
        self.data.qpos[:] = self.model.qpos0
        self.follow(None)

    def follow(self, driver):
        """Joints that an equality ties to the knee take its angle; of all others only the constant term counts."""
        m = self.model
        for i in range(m.neq):
            if m.eq_type[i] != mujoco.mjtEq.mjEQ_JOINT:
                continue
            tied, to = m.eq_obj1id[i], m.eq_obj2id[i]
            moves = driver is not None and to >= 0 and m.joint(to).name == driver and driver.startswith("knee_angle")
            q = self.data.qpos[m.jnt_qposadr[to]] if moves else 0.0
            if m.joint(tied).name != driver and not m.joint(tied).name.startswith("shoulder1_r2"):
                self.data.qpos[m.jnt_qposadr[tied]] = sum(c * q**k for k, c in enumerate(m.eq_data[i][:5]))

    def lengths(self, row, degrees):
        """Lengths of all muscles in mm, the joint turned by our `degrees`."""
        self.stand()
        name = row["theirs"]
        if row["plane"]:
            plane = np.radians(float(row["plane"]))
            self.data.qpos[self.joint(name.replace("shoulder_elv", "elv_angle")).qposadr] = plane
            self.data.qpos[self.joint(name.replace("shoulder_elv", "shoulder1_r2")).qposadr] = -plane
        self.data.qpos[self.joint(name).qposadr] = float(row["sense"]) * np.radians(degrees)
        self.follow(name)
        mujoco.mj_fwdPosition(self.model, self.data)
        return 1e3 * self.data.actuator_length.copy()

    def range(self, row):
        """What both allow, degrees of ours."""
        low, high = sorted(float(row["sense"]) * np.degrees(self.joint(row["theirs"]).range))
        if row["from"]:
            low, high = float(row["from"]), float(row["to"])
        return low - 1e-9, high + 1e-9


def theirs_of(model, text, lengths):
    """Columns of `lengths`: mean within a group, groups added."""
    return sum(lengths[:, [model.muscles[n] for n in group.split()]].mean(axis=1) for group in text.split("+"))


def ours_of(strips, angles, count):
    """Mean over the muscle's strips less the value at zero; strips that are not listed do not change."""
    total = np.zeros(len(angles))
    for points in strips.values():
        x, y = zip(*points)
        total += np.interp(angles, x, y) - np.interp(0.0, x, y)
    return total / count


def slopes(lengths, angles):
    return -np.gradient(lengths, np.radians(angles))


def strip_counts(folder):
    counts = {}
    for name in sorted(os.listdir(folder)):
        muscle = None
        with open(os.path.join(folder, name)) as file:
            for line in file:
                word = line.split()
                if len(word) == 2 and word[0] == "muscle" and name.endswith(".txt"):
                    muscle = word[1] + "_l"
                    counts[muscle] = 0
                elif word == ["strip"] and muscle:
                    counts[muscle] += 1
    return counts


def compare(sweeps, model, counts):
    pairs = []
    matches = table("mujoco_matches.csv")
    doubts = {(row["ours"], row["joint"], row["axis"]) for row in table("mujoco_doubts.csv")}
    for row in table("mujoco_joints.csv"):
        ours = sweeps[row["ours"], row["axis"]]
        if not ours:
            continue
        low, high = model.range(row)
        some = next(iter(next(iter(ours.values())).values()))
        angles = np.array([a for a, _ in some if low <= a <= high])
        if len(angles) < 3:
            continue
        lengths = np.array([model.lengths(row, a) for a in angles])
        zero = model.lengths(row, 0.0)
        for match in matches:
            mine = ours_of(ours.get(match["ours"], {}), angles, counts[match["ours"]])
            other = theirs_of(model, match["theirs"], lengths) - theirs_of(model, match["theirs"], zero[None, :])
            spans = np.ptp(mine), np.ptp(other)
            if max(spans) < COUNTS:
                continue
            alike = float(np.corrcoef(mine, other)[0, 1]) if min(spans) > 1e-3 else 0.0
            arms = slopes(mine, angles), slopes(other, angles)
            seen = np.abs(arms[1]) >= ARM
            pairs.append(
                {
                    "muscle": match["ours"],
                    "joint": f"{row['ours']} {row['axis']}",
                    "low": angles[0],
                    "high": angles[-1],
                    "change": spans[0],
                    "model": spans[1],
                    "correlation": alike,
                    "rms": float(np.sqrt(np.mean((mine - other) ** 2))),
                    "arm": float(np.mean(arms[0])),
                    "model_arm": float(np.mean(arms[1])),
                    "signs": int(np.sum(seen)),
                    "agree": int(np.sum(seen & (arms[0] * arms[1] > 0))),
                    "doubtful": (match["ours"], row["ours"], row["axis"]) in doubts,
                }
            )
    return pairs


def print_table(pairs):
    head = f"{'muscle':<34} {'joint':<20} {'degrees':>12} {'ours mm':>8} {'model mm':>8} {'corr':>6} {'RMS mm':>7} {'arm mm':>7} {'model':>7} {'sign %':>6}"
    print(head)
    for p in pairs:
        sign = f"{100 * p['agree'] / p['signs']:.0f}" if p["signs"] else "-"
        print(
            f"{p['muscle']:<34} {p['joint']:<20} {p['low']:>5.0f} ..{p['high']:>4.0f} {p['change']:>8.1f} {p['model']:>8.1f} "
            f"{p['correlation']:>6.2f} {p['rms']:>7.1f} {p['arm']:>7.1f} {p['model_arm']:>7.1f} {sign:>6}{' ?' if p['doubtful'] else ''}"
        )


def sign_share(pairs):
    return 100 * sum(p["agree"] for p in pairs) / max(1, sum(p["signs"] for p in pairs))


def summary(pairs):
    rms = [p["rms"] for p in pairs]
    return {
        "muscles": len({p["muscle"] for p in pairs}),
        "pairs": len(pairs),
        "correlation": statistics.median(p["correlation"] for p in pairs),
        "rms": statistics.median(rms),
        "rms_within": 100 * sum(r <= 10 for r in rms) / len(rms),
        "rms_max": max(rms),
        "sign": sign_share(pairs),
        "sign_sound": sign_share([p for p in pairs if not p["doubtful"]]),
    }


def parts(pairs):
    trunk = re.compile(r"^l\d ")
    leg = re.compile(r"^(hip|knee|ankle|subtalar)_")
    shoulder = re.compile(r"^shoulder_")
    yield "all", pairs
    yield "trunk", [p for p in pairs if trunk.match(p["joint"])]
    yield "leg", [p for p in pairs if leg.match(p["joint"])]
    yield "shoulder", [p for p in pairs if shoulder.match(p["joint"])]
    yield "arm and hand", [p for p in pairs if not any(r.match(p["joint"]) for r in (trunk, leg, shoulder))]


def print_summary(pairs):
    print(
        f"\n{'':<14} {'muscles':>8} {'pairs':>6} {'corr median':>12} {'RMS median mm':>14} {'RMS <= 10 mm %':>15} {'RMS max mm':>11} {'sign %':>7} {'without ?':>9}"
    )
    for name, part in parts(pairs):
        s = summary(part)
        print(
            f"{name:<14} {s['muscles']:>8} {s['pairs']:>6} {s['correlation']:>12.3f} {s['rms']:>14.1f} {s['rms_within']:>15.0f} "
            f"{s['rms_max']:>11.1f} {s['sign']:>7.1f} {s['sign_sound']:>9.1f}"
        )
    print(f"{'asked':<14} {ASKED['muscles']:>8} {'':>6} {ASKED['correlation']:>12.3f} {ASKED['rms']:>14.1f} {'':>15} {'':>11} {ASKED['sign']:>7.1f}")


def fallen_short(found):
    """What is worse than it has been."""
    return [k for k, v in REACHED.items() if (found[k] > v if k == "rms" else found[k] < v)]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("ecorche")
    parser.add_argument("packages")
    parser.add_argument("--step", type=float, default=2)
    parser.add_argument("--out", help="also write the table as CSV")
    here = os.path.dirname(os.path.abspath(__file__))
    parser.add_argument("--muscles", default=os.path.join(here, "..", "..", "data", "muscles"), help="our muscle table")
    options = parser.parse_args()
    wheels = glob.glob(os.path.join(options.packages, "musclemimic_models-*.whl"))
    if not wheels:
        print(f"skipped: no musclemimic_models in {options.packages}; make setup")
        return SKIPPED
    pairs = compare(our_sweeps(options.ecorche, options.step), Model(wheels[0]), strip_counts(options.muscles))
    print_table(pairs)
    print_summary(pairs)
    if options.out:
        with open(options.out, "w", newline="") as file:
            writer = csv.DictWriter(file, pairs[0].keys())
            writer.writeheader()
            writer.writerows(pairs)
    short = fallen_short(summary(pairs))
    if short:
        print("FAILED, worse than reached before: " + ", ".join(f"{k} (wanted {REACHED[k]})" for k in short))
    return 1 if short else 0


if __name__ == "__main__":
    sys.exit(main())
