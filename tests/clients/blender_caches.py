"""python blender_caches.py FOLDER   Puts vertex caches on meshes in Blender as docs/caches.md says, every setting at its default, and compares all
vertices of three frames in the world with the OBJ sequences of the same motion, which another part of the program writes.

FOLDER holds, of one motion: whole/%04d.obj (skin), layers/%04d.obj (skin, muscles and bones in one file), walk.glb with glb.pc2 and glb.mdd (--cache-for glb),
plain.pc2 and plain.mdd (skin), parts-LAYER.pc2 and parts-LAYER.obj for the three layers."""
import os
import sys

import bpy
import numpy as np

from blender_world import in_world

TOLERANCE = 1e-4  # m
FRAMES = (0, 7, 19)


def obj_vertices(path):
    with open(path) as f:
        return np.array([line.split()[1:4] for line in f if line.startswith("v ")], dtype=np.float64)


def to_blender(points):
    """A point of ours in Blender's world, which has z up and the face towards -y."""
    return np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1)


def add_cache(thing, path, **settings):
    modifier = thing.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format = os.path.splitext(path)[1][1:].upper()
    modifier.filepath = path
    for name, value in settings.items():
        setattr(modifier, name, value)
    return modifier


def compare(what, thing, expected, frames=FRAMES, at=lambda frame: frame):
    """expected(frame): world points in Blender's axes."""
    worst = 0
    for frame in frames:
        bpy.context.scene.frame_set(int(at(frame)), subframe=at(frame) % 1)
        got, wanted = in_world(thing), expected(frame)
        assert got.shape == wanted.shape, f"{what}: {got.shape[0]} vertices, {wanted.shape[0]} expected"
        worst = max(worst, float(np.linalg.norm(got - wanted, axis=1).max()))
    assert worst < TOLERANCE, f"{what}: {1e3 * worst:.3f} mm off"
    moved = np.linalg.norm(expected(frames[0]) - expected(frames[-1]), axis=1).max()
    assert moved > 0.05, f"{what}: the frames do not differ"
    print(f"{what}: {got.shape[0]} vertices, at most {1e3 * worst:.5f} mm off in frames {', '.join(map(str, frames))}")


def import_obj(path):
    bpy.ops.wm.obj_import(filepath=path)
    things = [o for o in bpy.context.selected_objects if o.type == "MESH"]
    assert len(things) == 1, f"{path}: {len(things)} objects"
    return things[0]


def main(folder):
    def whole(frame):
        return to_blender(obj_vertices(f"{folder}/whole/{frame + 1:04d}.obj"))

    def fresh():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.context.scene.render.fps = 60

    # The skin of our .glb, which moves by joints: the modifier comes last and takes over.
    for kind in ("pc2", "mdd"):
        fresh()
        bpy.ops.import_scene.gltf(filepath=f"{folder}/walk.glb")
        # Blender leaves an empty of the node's name beside a skinned mesh whose weights are animated.
        skin = bpy.data.objects["skin.001"]
        copies = np.empty(len(skin.data.vertices), dtype=np.float32)
        skin.data.attributes["_SKIN_VERTEX"].data.foreach_get("value", copies)
        own = copies.astype(int)
        joints = in_world(skin)
        add_cache(skin, f"{folder}/glb.{kind}")
        compare(f"glb.{kind} on the skin of walk.glb", skin, lambda frame: whole(frame)[own])
        bpy.context.scene.frame_set(0)
        assert np.linalg.norm(in_world(skin) - joints, axis=1).max() > 1e-6, "the cache does nothing that the joints do not"

    # Meshes of ours, any layer.
    fresh()
    skin = import_obj(f"{folder}/whole/0001.obj")
    for kind in ("pc2", "mdd"):
        modifier = add_cache(skin, f"{folder}/plain.{kind}")
        compare(f"plain.{kind} on an OBJ of the skin", skin, whole)
        skin.modifiers.remove(modifier)
    # A scene of another rate, as Blender begins with: the cache's own seconds.
    bpy.context.scene.render.fps = 24
    add_cache(skin, f"{folder}/plain.mdd", time_mode="TIME")
    compare("plain.mdd by its seconds at 24 frames a second", skin, whole, frames=(0, 5, 20), at=lambda frame: frame * 24 / 60)
    first = 0
    for layer in ("skin", "muscles", "bones"):
        fresh()
        mesh = import_obj(f"{folder}/parts-{layer}.obj")
        count = len(mesh.data.vertices)
        add_cache(mesh, f"{folder}/parts-{layer}.pc2")

        def part(frame, begin=first, end=first + count):
            return to_blender(obj_vertices(f"{folder}/layers/{frame + 1:04d}.obj")[begin:end])

        compare(f"parts-{layer}.pc2 on parts-{layer}.obj", mesh, part)
        assert mesh.data.materials and all(m is not None for m in mesh.data.materials), f"{layer}: no materials"
        if layer == "skin":
            assert mesh.data.uv_layers, "the skin has no place on a texture"
        if layer == "muscles":
            names = {m.name.split(".")[0] for m in mesh.data.materials}
            assert names == {"muscle", "tendon"}, names
        first += count
    total = len(obj_vertices(f"{folder}/layers/0001.obj"))
    assert total == first, f"{total} vertices in an OBJ of all layers, {first} in the layers"


main(os.path.abspath(sys.argv[-1]))
