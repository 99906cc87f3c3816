"""python blender_clip.py FILE.glb SKIN.pc2 MUSCLES.pc2 FPS   Plays an animated character in Blender, compares its skin and muscles with the exact vertex caches of
the same motion, within the error that the file states, and counts the muscles' points that have come out of the skin that Blender shows, beside those that exactly have."""
import json
import struct
import sys
import time

import bpy
import numpy as np

from blender_world import in_world

ROUNDING = 1e-4  # m; weights of 16 bits, keys and places of 32
MORE_OUTSIDE = 0.001  # of the points, than exactly
SAMPLES = 1500


def document(path):
    with open(path, "rb") as file:
        data = file.read()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), data[20 + length + 8:]


def cache(path):
    with open(path, "rb") as file:
        data = file.read()
    points, frames = struct.unpack_from("<i", data, 16)[0], struct.unpack_from("<i", data, 28)[0]
    return np.frombuffer(data, dtype=np.float32, offset=32).reshape(frames, points, 3).astype(np.float64)


def mesh_object(name):
    """Blender leaves an empty of the node's name beside a skinned mesh whose weights are animated."""
    return next(o for o in bpy.data.objects if o.type == "MESH" and o.name.split(".")[0] == name)


def in_file_axes(thing):
    """+Y up."""
    p = in_world(thing)
    return np.stack([p[:, 0], p[:, 2], -p[:, 1]], axis=1)


def triangles(thing):
    thing.data.calc_loop_triangles()
    flat = np.empty(3 * len(thing.data.loop_triangles), dtype=np.int32)
    thing.data.loop_triangles.foreach_get("vertices", flat)
    return flat.reshape(-1, 3)


def inside(points, V, F):
    """By the solid angle of the surface (van Oosterom and Strackee 1983, 10.1109/TBME.1983.325207)."""
    out = np.empty(len(points), dtype=bool)
    for i, p in enumerate(points):
        r = V - p
        lengths = np.linalg.norm(r, axis=1)
        a, b, c = r[F[:, 0]], r[F[:, 1]], r[F[:, 2]]
        la, lb, lc = lengths[F[:, 0]], lengths[F[:, 1]], lengths[F[:, 2]]
        rest = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
        out[i] = np.arctan2((a * np.cross(b, c)).sum(1), rest).sum() > np.pi
    return out


class Muscles:
    """Their vertices, and those of fascia, as Blender has them: those of a tissue after those of another."""

    def __init__(self, gltf, binary):
        self.things, self.rows, first = [], [], 0
        for node in gltf["nodes"]:
            if not node["name"].startswith(("muscle/", "fascia/")):
                continue
            primitives = gltf["meshes"][node["mesh"]]["primitives"]
            used = []
            for primitive in primitives:
                accessor = gltf["accessors"][primitive["indices"]]
                at = gltf["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0)
                used.append(np.unique(np.frombuffer(binary, dtype=np.uint32, count=accessor["count"], offset=at)))
            self.rows.append(first + np.concatenate(used))
            self.things.append(mesh_object(node["name"]))
            first += gltf["accessors"][primitives[0]["attributes"]["POSITION"]]["count"]
        self.count = first

    def places(self):
        out = np.full((self.count, 3), np.nan)
        for thing, rows in zip(self.things, self.rows):
            there = in_file_axes(thing)
            assert len(there) == len(rows), f"{thing.name}: {len(there)} vertices, {len(rows)} expected"
            out[rows] = there
        return out


def main(path, skin_path, muscles_path, fps):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = int(fps)
    began = time.time()
    bpy.ops.import_scene.gltf(filepath=path)
    seconds = time.time() - began
    gltf, binary = document(path)
    stated = gltf["scenes"][0]["extras"]["ecorche"]["shapes"]
    skins, flesh = cache(skin_path), cache(muscles_path)
    skin, muscles = mesh_object("skin"), Muscles(gltf, binary)
    F = triangles(skin)
    picked = np.arange(0, flesh.shape[1], max(1, flesh.shape[1] // SAMPLES))
    frames = sorted({round(share * (len(skins) - 1)) for share in (0, 0.4, 0.8)})
    kept = None
    left = exact = counted = 0
    copies = np.empty(len(skin.data.vertices), dtype=np.float32)
    skin.data.attributes["_SKIN_VERTEX"].data.foreach_get("value", copies)
    own = copies.astype(int)  # our skin's own vertices are the first; copies on the texture's seams follow
    off = {"skin": [], "muscles": []}
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        V, P = in_file_axes(skin), muscles.places()
        off["skin"].append(np.linalg.norm(V[:skins.shape[1]] - skins[frame], axis=1))
        off["muscles"].append(np.linalg.norm(P - flesh[frame], axis=1))
        # Points about the mouth, whose inside is none of the body's, are outside in every frame.
        now = inside(P[picked], V, F)
        if kept is None:
            kept = now
        left += int((kept & ~now).sum())
        exact += int((kept & ~inside(flesh[frame][picked], skins[frame][own], F)).sum())
        counted += int(kept.sum())
    for what, errors in off.items():
        errors = np.concatenate(errors)
        most = np.nanmax(errors)
        print(f"{path}: Blender {bpy.app.version_string}: {what} {1e3 * np.sqrt(np.nanmean(errors ** 2)):.2f} mm RMS and at most {1e3 * most:.2f} mm off in frames "
              f"{', '.join(map(str, frames))}")
        assert most <= stated[what]["max"] + ROUNDING, f"the file states at most {1e3 * stated[what]['max']:.2f} mm"
    print(f"{path}: Blender {bpy.app.version_string}: {100 * left / counted:.3f} % of {counted} muscle points outside the skin (exactly {100 * exact / counted:.3f} %); imported in {seconds:.0f} s")
    assert left <= exact + MORE_OUTSIDE * counted, "muscles come out of the skin"


arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else sys.argv[1:]
main(arguments[0], arguments[1], arguments[2], float(arguments[3]))
