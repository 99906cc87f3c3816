"""python blender_crowd.py CROWD SKINS_FOLDER   Loads a crowd (.glb, or .gltf with its people beside it) in Blender and checks it against the
same people's own files of a `body population --skins`, SKINS_FOLDER/NAME.glb: every mesh is there, each skin's vertices are where their own
file has them, at the person's place, people are as tall as their figures say and do not reach into each other, and a bent elbow moves its
own arm and nobody else. Of a crowd that moves, one of people who keep to the ground: the animation moves everybody, on the ground."""
import json
import math
import struct
import sys

import bpy
import numpy as np


def document(path):
    with open(path, "rb") as f:
        if path.endswith(".gltf"):
            return json.load(f), None
        f.seek(12)
        length, _ = struct.unpack("<II", f.read(8))
        text = json.loads(f.read(length))
        f.seek(8, 1)
        return text, f.read()


def own_skin(path):
    text, binary = document(path)
    node = next(n for n in text["nodes"] if n["name"] == "skin")
    accessor = text["accessors"][text["meshes"][node["mesh"]]["primitives"][0]["attributes"]["POSITION"]]
    start = text["bufferViews"][accessor["bufferView"]].get("byteOffset", 0)
    return np.frombuffer(binary, np.float32, 3 * accessor["count"], start).reshape(-1, 3)


def posed(mesh, at_rest=False):
    """World places of a mesh's vertices, axes as in glTF, as the armature moves them or as they are without it."""
    evaluated = mesh.data if at_rest else mesh.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    flat = np.empty(3 * len(evaluated.vertices), np.float32)
    evaluated.vertices.foreach_get("co", flat)
    matrix = np.array(mesh.matrix_world)
    places = flat.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    return places[:, [0, 2, 1]] * [1, 1, -1]


def bend(people, rest):
    elbow = bpy.data.objects[people[0] + "/middle"].pose.bones["elbow_l"]
    elbow.rotation_mode = "QUATERNION"
    elbow.rotation_quaternion = (math.cos(0.5), math.sin(0.5), 0, 0)
    bpy.context.view_layer.update()
    moved = {name: np.linalg.norm(posed(bpy.data.objects[name + "/skin"]) - rest[name], axis=1) for name in people}
    share = float((moved[people[0]] > 0.01).mean())
    assert 0.01 < share < 0.3, f"an elbow moves {share:.3f} of the skin"
    assert all(moved[name].max() < 1e-6 for name in people[1:]), "an elbow moves somebody else"
    return ""


def play(people, rest, seconds):
    scene, off = bpy.context.scene, 0.0
    for share in (0.25, 0.5, 0.75):
        scene.frame_set(round(share * seconds * scene.render.fps / scene.render.fps_base))
        for name in people:
            now = posed(bpy.data.objects[name + "/skin"])
            off = max(off, abs(float(now[:, 1].min())))
            assert np.linalg.norm(now - rest[name], axis=1).min() > 0.1, f"{name} does not move along"
    assert off < 0.02, f"{1e3 * off:.1f} mm off the ground"
    return f", at most {1e3 * off:.1f} mm off the ground in motion"


def main(path, folder):
    text, _ = document(path)
    animated = "animations" in text
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    meshes = [n["name"] for n in text["nodes"] if "mesh" in n]
    missing = [name for name in meshes if name not in bpy.data.objects]
    assert not missing, f"not in Blender: {missing}"
    people = [name[:-5] for name in meshes if name.endswith("/skin")]
    assert len(people) == text["scenes"][0]["extras"]["crowd"]["people"] > 0, f"{len(people)} people"
    most, boxes, rest = 0.0, {}, {}
    for name in people:
        place = next(n for n in text["nodes"] if n["name"] == name)["translation"]
        rest[name] = posed(bpy.data.objects[name + "/skin"], at_rest=animated)
        own = own_skin(f"{folder}/{name}.glb") + np.array(place)
        assert rest[name].shape == own.shape, f"{name}: {len(rest[name])} vertices, {len(own)} in their own file"
        most = max(most, float(np.linalg.norm(rest[name] - own, axis=1).max()))
        unposed = float(np.linalg.norm(posed(bpy.data.objects[name + "/skin"], True) - own, axis=1).max())
        assert unposed < 1e-4, f"{name}: without the armature a vertex is {1e3 * unposed} mm from where their own file has it"
        boxes[name] = rest[name].min(0), rest[name].max(0)
        tall, said = boxes[name][1][1] - boxes[name][0][1], bpy.data.objects[name]["stature_m"]
        assert abs(tall - said) < 1e-4, f"{name}: {tall:.5f} m tall, {said} by the figures"
    assert most < 5e-5, f"a vertex is {1e3 * most} mm from where its own file has it"
    for one in people:
        for other in people:
            apart = (boxes[one][0] > boxes[other][1]) | (boxes[other][0] > boxes[one][1])
            assert one == other or apart.any(), f"{one} and {other} reach into each other"
    if animated:
        seconds = max(text["accessors"][s["input"]]["max"][0] for s in text["animations"][0]["samplers"])
    more = play(people, rest, seconds) if animated else bend(people, rest)
    print(f"{path}: Blender {bpy.app.version_string} shows {len(people)} people in {len(meshes)} meshes, at most {1e3 * most:.3f} mm from their own files{more}")


main(*sys.argv[-2:])
