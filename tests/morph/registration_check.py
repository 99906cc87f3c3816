#!/usr/bin/env python3
"""The figures of registration on scanned people once more, by nothing but what `ecorche body register` writes: --posed and --report.

    registration_check.py ECORCHE SCANS WORK [--people 0,1] [--poses 0,3]

SCANS: tr_reg_0NN.off and tr_reg_0NN.vts (five people in ten poses; registration_figures.cpp). WORK: a folder outside every repository. Needs NumPy and SciPy; ends with 77
where they or the scans are not there.
"""
import argparse
import json
import os
import subprocess
import sys

try:
    import numpy as np
    from scipy.spatial import cKDTree
except ImportError:
    print("skipped: NumPy and SciPy are not installed")
    sys.exit(77)

KNOWN_UNIT = {0: 1.7753, 10: 1.65, 25: 1.6919, 30: 1.78, 40: 1.65}  # metres in a unit of that scan; a person's other scans by their volume
CANDIDATES = 24


def read_off(path):
    with open(path, encoding="ascii") as file:
        words = file.read().split()
    vertices, faces = int(words[1]), int(words[2])
    V = np.array(words[4:4 + 3 * vertices], float).reshape(-1, 3)
    F = np.array(words[4 + 3 * vertices:4 + 3 * vertices + 4 * faces], int).reshape(-1, 4)[:, 1:]
    return V, F


def read_ply(path):
    """Binary little-endian, double x y z and triangles: as the program writes it."""
    with open(path, "rb") as file:
        data = file.read()
    head, body = data.split(b"end_header\n", 1)
    words = head.decode().split()
    vertices, faces = (int(words[words.index(name) + 1]) for name in ("vertex", "face"))
    V = np.frombuffer(body, "<f8", 3 * vertices).reshape(-1, 3)
    F = np.frombuffer(body, np.dtype([("n", "u1"), ("i", "<i4", 3)]), faces, 24 * vertices)["i"]
    return V, F


def volume(V, F):
    return np.einsum("ij,ij->i", np.cross(V[F[:, 0]], V[F[:, 1]]), V[F[:, 2]]).sum() / 6


def closest(P, V, F):
    """Distance, triangle and barycentric coordinates of the nearest point on a mesh, among the triangles whose centres are nearest."""
    A, B, C = V[F[:, 0]], V[F[:, 1]], V[F[:, 2]]
    tree = cKDTree((A + B + C) / 3)
    _, near = tree.query(P, k=CANDIDATES)
    best, face, where = np.full(len(P), np.inf), np.zeros(len(P), int), np.zeros((len(P), 3))
    for k in range(CANDIDATES):
        f = near[:, k]
        bary = nearest_in(P, A[f], B[f], C[f])
        d = np.linalg.norm(P - (bary[:, :1] * A[f] + bary[:, 1:2] * B[f] + bary[:, 2:] * C[f]), axis=1)
        closer = d < best
        best[closer], face[closer], where[closer] = d[closer], f[closer], bary[closer]
    return best, face, where


def nearest_in(P, A, B, C):
    """Barycentric coordinates: the plane's point where it lies inside, else the nearest of three edges."""
    def dot(u, v):
        return np.einsum("ij,ij->i", u, v)

    def edge(p, q):
        t = np.clip(dot(P - p, q - p) / np.maximum(dot(q - p, q - p), 1e-30), 0, 1)
        return t, dot(P - p - t[:, None] * (q - p), P - p - t[:, None] * (q - p))
    u, v, w = B - A, C - A, P - A
    det = np.maximum(dot(u, u) * dot(v, v) - dot(u, v) ** 2, 1e-30)
    s = (dot(v, v) * dot(w, u) - dot(u, v) * dot(w, v)) / det
    t = (dot(u, u) * dot(w, v) - dot(u, v) * dot(w, u)) / det
    out = np.stack([1 - s - t, s, t], 1)
    outside = (out < 0).any(1)
    edges = [edge(A, B), edge(B, C), edge(C, A)]
    which = np.argmin(np.stack([e[1] for e in edges]), 0)
    for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 0))):
        at = outside & (which == k)
        out[at] = 0
        out[at, i] = 1 - edges[k][0][at]
        out[at, j] = edges[k][0][at]
    return out


def register(options, number, unit):
    """The posed skin in metres on the scan, and the report."""
    V, F = read_off(os.path.join(options.scans, f"tr_reg_{number:03}.off"))
    scan, posed, report = (os.path.join(options.work, f"{number:03}{ending}") for ending in (".off", "-posed.ply", ".json"))
    if not os.path.exists(report):  # which is written last
        with open(scan, "w", encoding="ascii") as out:
            out.write(f"OFF\n{len(V)} {len(F)} 0\n" + "".join("%.7f %.7f %.7f\n" % tuple(unit * v) for v in V) + "".join("3 %d %d %d\n" % tuple(f) for f in F))
        done = subprocess.run([options.ecorche, "body", "register", scan, "--unit", "m", "-o", scan[:-4] + ".glb", "--posed", posed, "--report", report], capture_output=True, text=True)
        if done.returncode not in (0, 8):
            return unit * V, None, None, done.stderr.strip()
    with open(report, encoding="utf-8") as file:
        return unit * V, read_ply(posed), json.load(file), ""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("ecorche")
    parser.add_argument("scans")
    parser.add_argument("work")
    parser.add_argument("--people", default="0,1,2,3,4")
    parser.add_argument("--poses", default="0,1,2,3,4,5,6,7,8,9")
    options = parser.parse_args()
    if not os.path.exists(os.path.join(options.scans, "tr_reg_000.off")):
        print(f"skipped: no scans in {options.scans}")
        return 77
    os.makedirs(options.work, exist_ok=True)
    found, distances = [], []
    for person in map(int, options.people.split(",")):
        known = next(n for n in KNOWN_UNIT if n // 10 == person)
        litres = KNOWN_UNIT[known] ** 3 * volume(*read_off(os.path.join(options.scans, f"tr_reg_{known:03}.off")))
        for pose in map(int, options.poses.split(",")):
            number = 10 * person + pose
            unit = (litres / volume(*read_off(os.path.join(options.scans, f"tr_reg_{number:03}.off")))) ** (1 / 3)
            V, skin, report, why = register(options, number, unit)
            if skin is None:
                print(f"{number:03} refused: {why}")
                continue
            samples = np.loadtxt(os.path.join(options.scans, f"tr_reg_{number:03}.vts"), dtype=int) - 1
            d, _, _ = closest(V, *skin)
            distances.append(d)
            _, face, bary = closest(V[samples], *skin)
            said = report["register"]["scan_to_body"]
            print(f"{number:03} median {1e3 * np.median(d):6.2f} p95 {1e3 * np.quantile(d, 0.95):6.2f} mm; the report says {1e3 * said['median']:.2f}, {1e3 * said['p95']:.2f}", flush=True)
            found.append((person, V[samples], skin, face, bary))
    within, between = [], []
    for a in found:
        for b in found:
            if a is not b:
                corners = b[2][0][b[2][1][a[3]]]
                mapped = np.einsum("ij,ijk->ik", a[4], corners)
                (within if a[0] == b[0] else between).append(np.linalg.norm(mapped - b[1], axis=1).mean())
    d = np.concatenate(distances)
    print(f"scan to surface: median {1e3 * np.median(d):.2f}, p95 {1e3 * np.quantile(d, 0.95):.2f} mm")
    for name, values in (("one person's poses", within), ("people", between)):
        if values:
            print(f"correspondence between {name}: mean {1e3 * np.mean(values):.1f}, worst pair {1e3 * np.max(values):.1f} mm")
    return 0


if __name__ == "__main__":
    sys.exit(main())
