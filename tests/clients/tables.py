"""python tables.py FOLDER   Tables of a motion against one another, by code that shares nothing with the program's.

FOLDER holds of one motion lengths.csv, velocities.sto, bellies.csv, tendons.csv, activations.csv, angles.csv and arms-COORDINATE.csv. Lengths are bellies and tendons;
velocities are the rates of lengths; and what a muscle's length does follows from its moment arms and the angles (the principle of virtual work), for
muscles that cross nothing but the joints whose arms are there."""
import csv
import glob
import os
import sys

import numpy as np


def read(path):
    """Columns by name, without units."""
    if path.endswith(".csv"):
        with open(path, newline="") as f:
            rows = list(csv.reader(f))
        labels, values = [name.split(" [")[0] for name in rows[0]], rows[1:]
    else:
        with open(path) as f:
            lines = f.read().splitlines()
        head = lines.index("endheader")
        stated = dict(line.split("=") for line in lines[:head] if "=" in line)
        labels, values = lines[head + 1].split("\t"), [line.split("\t") for line in lines[head + 2 :]]
        assert int(stated["nRows"]) == len(values) and int(stated["nColumns"]) == len(labels) and stated["units"] == "m/s", stated
    table = np.array(values, dtype=float)
    assert len(set(labels)) == len(labels) and np.isfinite(table).all()
    return {name: table[:, i] for i, name in enumerate(labels)}


def main(folder):
    lengths, rates = read(f"{folder}/lengths.csv"), read(f"{folder}/velocities.sto")
    bellies, tendons, angles = (read(f"{folder}/{name}.csv") for name in ("bellies", "tendons", "angles"))
    activations = read(f"{folder}/activations.csv")
    time = lengths["time"]
    for name, length in lengths.items():
        if name == "time":
            continue
        assert np.abs(bellies[name] + tendons[name] - length).max() < 3e-7, name
        assert 0.01 < length.min() and length.max() < 1.2 and tendons[name].min() > -1e-6, name
        assert np.abs(np.gradient(length, time)[1:-1] - rates[name][1:-1]).max() < 1e-4, name
    assert all(0 <= a.min() and a.max() <= 1 for name, a in activations.items() if name != "time")
    arms = {os.path.basename(p)[5:-4]: read(p) for p in glob.glob(f"{folder}/arms-*.csv")}
    assert arms, "no moment arms"
    checked, worst = 0, (0.0, "")
    for coordinate, table in arms.items():
        # Muscles of this joint alone: no other table of arms names them, and they are known to cross it only.
        for name in table:
            alone = coordinate.startswith("knee") and coordinate.endswith("flexion") and name.split(".")[0][:-2] in (
                "vastus_lateralis", "vastus_medialis", "vastus_intermedius", "biceps_femoris_short", "popliteus")
            if not alone or name[-2:] != coordinate.split("_")[1].join(("_", "")) and f"_{coordinate.split('_')[1]}" not in name:
                continue
            # From frame to frame by the mean of both frames' arms, which holds where an angle starts or stops, too.
            by_arms = np.zeros(len(time) - 1)
            for turn in (coordinate, coordinate.replace("flexion", "rotation")):
                if name in arms.get(turn, {}):
                    by_arms -= (arms[turn][name][1:] + arms[turn][name][:-1]) / 2 * np.diff(np.radians(angles[turn]))
            changes = np.diff(lengths[name])
            off = np.abs(by_arms - changes).max() / np.abs(changes).max()
            checked += 1
            worst = max(worst, (off, name))
            assert off < 0.02, f"{name} about {coordinate}: {100 * off:.1f} % of its greatest change off"
    assert checked >= 4, f"{checked} muscles checked"
    print(f"{folder}: {len(lengths) - 1} strips over {len(time)} frames; {checked} muscles go by their moment arms to {100 * worst[0]:.1f} % ({worst[1]})")


main(sys.argv[1])
