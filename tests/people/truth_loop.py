#!/usr/bin/env python3
"""Compares the skin with scanned people in poses that its fit has not seen; see README.md.

    truth_loop.py --prep PREP --raw RAW --tools TOOLS --ecorche PROGRAM -o FOLDER [--start FOLDER] [--rounds N] [--people 0 1 ...] [--meshshot PROGRAM]

PREP, RAW: what prepare.sh of TOOLS has made. FOLDER: table.txt, errors.csv, worst.csv, and a folder a person. With --meshshot: pictures of scan, linear blend and ours, a person and pose.
"""
import argparse
import csv
import os
import shutil
import subprocess
import sys

import numpy as np

RED, WHITE, BLUE = np.array([0.8, 0.1, 0.1]), np.array([0.9, 0.9, 0.9]), np.array([0.1, 0.2, 0.8])
FULL_COLOUR = 20.0  # mm
WORST = 12  # places a person and pose
APART = 0.08  # m, between two worst places


def read_options():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("--prep", "--raw", "--tools", "--ecorche"):
        ap.add_argument(name, required=True)
    ap.add_argument("-o", "--out", required=True)
    ap.add_argument("--start", help="folder of an earlier run, whose rest skins and poses are taken")
    ap.add_argument("--rounds", type=int, help="rounds of Gauss-Newton on the poses; 3, and 2 with --start")
    ap.add_argument("--unpose", type=int, default=2, help="rounds in which the rest skin is corrected by pose 0")
    ap.add_argument("--people", type=int, nargs="*", default=list(range(5)))
    ap.add_argument("--skin", default="ecorche")
    ap.add_argument("--no-refit", action="store_true", help="leave away the small correction of joints that evaluate.py gives each method alike")
    ap.add_argument("--meshshot", help="draw pictures by this program")
    return ap.parse_args()


def in_work_tree(folder):
    done = subprocess.run(["git", "-C", folder, "rev-parse", "--show-toplevel"], capture_output=True)
    return done.returncode == 0


def unposed(tool, z, model, rounds):
    """Rest skin and pose 0 by which the program meets the scan of pose 0: what it misses there is taken back to the rest skin."""
    from common import fk, lbs
    M = fk(model.parents, z["heads"], z["R"][0], z["root"][0])
    target = lbs(z["rest"], model.W, M)
    blend = np.einsum("vj,jab->vab", np.asarray(model.W), M[:, :, :3])
    U, _, Vt = np.linalg.svd(blend)
    V, x = z["rest"].copy(), np.zeros((1, tool.n))
    for k in range(rounds + 1):
        tool.fit(V)
        x, _ = tool.solve([0], [tool.scan0], x, 2)
        if k < rounds:
            V = V + np.einsum("vba,vb->va", U @ Vt, target - tool.play([(0, x[0])])[0])
    return x


def predict(options, model, person, folder):
    """Predicted vertices of each pose, pose 0 first."""
    from common import write_pc2
    from fit_pose import Tool
    os.makedirs(folder, exist_ok=True)
    z = person.z
    tool = Tool(options, model, person, folder)
    tool.scan0 = person.scans[0][0]
    rounds = options.rounds
    if options.start:
        before = os.path.join(options.start, f"person{person.p}")
        if os.path.abspath(before) != os.path.abspath(folder):
            shutil.copy(os.path.join(before, "rest.obj"), folder)
        tool.run("fit", f"{folder}/rest.obj", "-o", f"{folder}/fit.glb")
        poses = np.load(os.path.join(before, "poses.npy"))
        rounds = 2 if rounds is None else rounds
    else:
        poses = np.tile(unposed(tool, z, model, options.unpose), (10, 1))
        rounds = 3 if rounds is None else rounds
    if rounds:
        poses[1:], _ = tool.solve(list(range(1, 10)), z["truth"], poses[1:], rounds)
    np.save(os.path.join(folder, "poses.npy"), poses)
    X = tool.play([(k, poses[k]) for k in range(10)])
    for name in ("try.bvh", "try.pc2"):
        os.remove(os.path.join(folder, name))
    for k in range(10):
        write_pc2(os.path.join(folder, f"pose{int(z['poses'][k])}.pc2"), X[k][None])
    return list(X.astype(float))


def refitted(model, person, skins):
    """The same small correction of joints for each method, by which neither profits from whose poses they are."""
    from evaluate import refit
    ids = list(range(1, len(skins)))
    return [skins[0], *refit(model, person.z, ids, np.stack([skins[k] for k in ids]), person.weight)]


def signed(person, pose, skin):
    """Signed distance from each scan vertex to the skin, mm: above 0 where the skin is outside of the scan."""
    S, N = person.scans[pose]
    _, _, X, d, _ = person.closest(skin, S, N)
    return 1000 * np.where(np.einsum("pc,pc->p", X - S, N) > 0, d, -d)


def places(person, pose, skin):
    """By how much points of the skin miss their places on the scan, mm, and the regions they are of."""
    from common import interp
    z = person.z
    x = interp(skin, person.m.skin_tris, z["face"], z["bary"])
    ok = z["mat_ok"]
    return 1000 * np.linalg.norm(x - z["truth"][pose - 1], axis=1)[ok], person.region[ok]


def worst_places(person, pose, error):
    out = []
    for i in np.argsort(-np.abs(error)):
        S = person.scans[pose][0]
        if all(np.linalg.norm(S[i] - S[j]) > APART for j in out):
            out.append(int(i))
        if len(out) == WORST:
            return out
    return out


def write_ply(file, V, F, error):
    share = np.clip(np.abs(error) / FULL_COLOUR, 0, 1)[:, None]
    end = np.where((error > 0)[:, None], RED, BLUE)
    colour = (255 * ((1 - share) * WHITE + share * end)).astype(int)
    with open(file, "w") as f:
        f.write(f"ply\nformat ascii 1.0\nelement vertex {len(V)}\n" + "".join(f"property float {c}\n" for c in "xyz")
                + "".join(f"property uchar {c}\n" for c in ("red", "green", "blue"))
                + f"element face {len(F)}\nproperty list uchar int vertex_indices\nend_header\n")
        np.savetxt(f, np.hstack([V, colour]), fmt="%.5f %.5f %.5f %d %d %d")
        np.savetxt(f, np.hstack([np.full((len(F), 1), 3), F]), fmt="%d")


def draw(options, person, pose, skins, errors, folder):
    """A picture of the scan and of each skin: front, left, back. Skins take the colour of the nearest scan vertex."""
    from common import NAMES, read_off
    from scipy.spatial import cKDTree
    S = person.scans[pose][0]
    number = int(person.z["poses"][pose])
    F = read_off(os.path.join(options.raw, "off", NAMES[10 * person.p + number] + ".off"))[1]
    nearest = cKDTree(S)
    shown = {"scan": (S, F, np.zeros(len(S)))}
    for method, skin in skins.items():
        shown[method] = (skin, person.m.skin_tris, errors[method][nearest.query(skin)[1]])
    for name, mesh in shown.items():
        ply, png = (os.path.join(folder, f"pose{number}_{name}.{ending}") for ending in ("ply", "png"))
        write_ply(ply, *mesh)
        subprocess.run([options.meshshot, png, "--view", "front", "--view", "left", "--view", "back", "--size", "600x640", ply],
                       check=True, capture_output=True)
        os.remove(ply)


def judge(person, pose, method, skin, error, regions):
    """Rows of errors.csv and of worst.csv."""
    at = {"person": person.p, "pose": int(person.z["poses"][pose]), "method": method}
    place, of = places(person, pose, skin)
    rows = []
    for region in regions:
        here, there = error[person.sreg[pose] == region], place[of == region]
        if len(here) and len(there):
            rows.append({**at, "region": region, "vertices": len(here), "points": len(there),
                         "surface": np.abs(here).mean(), "sign": here.mean(), "place": there.mean()})
    worst = [{**at, "vertex": i, "region": person.sreg[pose][i], "sign": round(float(error[i]), 1)}
             for i in worst_places(person, pose, error)]
    return rows, worst


def mean(rows, value, regions=None, **wanted):
    """Over rows with these regions and values; each scan vertex (surface, sign) or point of the skin (place) counts once."""
    at = [r for r in rows if (regions is None or r["region"] in regions) and all(r[k] == v for k, v in wanted.items())]
    return np.average([r[value] for r in at], weights=[r["points" if value == "place" else "vertices"] for r in at])


def table(rows, regions):
    methods = list(dict.fromkeys(r["method"] for r in rows))
    lines = [f"{'region':12s}" + "".join(f"{m + ' surface':>18s}{'sign':>8s}{'place':>8s}" for m in methods)]
    for label, names in [(r, [r]) for r in regions] + [("BODY", regions)]:
        line = f"{label:12s}"
        for m in methods:
            surface, sign, place = (mean(rows, value, names, method=m) for value in ("surface", "sign", "place"))
            line += f"{surface:18.2f}{sign:8.2f}{place:8.2f}"
        lines.append(line)
    for label, names in [("BODY", regions), ("shoulder and upper arm", ["shoulder", "upper arm"])]:
        line = f"{label}, surface by pose ({'/'.join(methods)}):"
        for pose in sorted({r["pose"] for r in rows}):
            line += f"  {pose}: " + "/".join(f"{mean(rows, 'surface', names, pose=pose, method=m):.1f}" for m in methods)
        lines.append(line)
    return "\n".join(lines)


def main():
    options = read_options()
    sys.path.insert(0, options.tools)
    from common import BODY_REGIONS, Model
    from evaluate import Person
    os.makedirs(options.out, exist_ok=True)
    if in_work_tree(options.out):
        sys.exit(f"{options.out} lies in a git work tree; what is made from scans must not")
    model = Model(os.path.join(options.prep, "model.npz"))
    rows, worst = [], []
    for p in options.people:
        person = Person(model, options.prep, options.raw, p)
        folder = os.path.join(options.out, f"person{p}")
        skins = {"linear": person.baseline("LBS"), "ours": predict(options, model, person, folder)}
        if not options.no_refit:
            skins = {method: refitted(model, person, per_pose) for method, per_pose in skins.items()}
        for pose in range(1, 10):
            errors = {method: signed(person, pose, per_pose[pose]) for method, per_pose in skins.items()}
            for method, per_pose in skins.items():
                more, farthest = judge(person, pose, method, per_pose[pose], errors[method], BODY_REGIONS)
                rows += more
                worst += farthest
            if options.meshshot:
                draw(options, person, pose, {method: per_pose[pose] for method, per_pose in skins.items()}, errors, folder)
        print(f"person {p}: " + ", ".join(f"{m} {mean(rows, 'surface', person=p, method=m):.2f} mm" for m in skins), flush=True)
    text = table(rows, BODY_REGIONS)
    print(text)
    with open(os.path.join(options.out, "table.txt"), "w") as f:
        f.write(text + "\n")
    for name, values in (("errors.csv", rows), ("worst.csv", worst)):
        with open(os.path.join(options.out, name), "w", newline="") as f:
            out = csv.DictWriter(f, list(values[0]))
            out.writeheader()
            out.writerows(values)


if __name__ == "__main__":
    main()
