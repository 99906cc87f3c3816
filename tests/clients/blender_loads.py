"""python blender_loads.py FILE.glb   Loads a character in Blender and checks that every bone and muscle is there by name,
that the skin is deformed by the joints, and that an animation, where the file has one, moves it."""
import json
import struct
import sys

import bpy


def node_names(path):
    with open(path, "rb") as f:
        f.seek(12)
        length, _ = struct.unpack("<II", f.read(8))
        document = json.loads(f.read(length))
    return [n["name"] for n in document["nodes"] if "mesh" in n], "animations" in document


def target_names(path):
    with open(path, "rb") as f:
        f.seek(12)
        length, _ = struct.unpack("<II", f.read(8))
        document = json.loads(f.read(length))
    return [name for mesh in document["meshes"] for name in mesh.get("extras", {}).get("targetNames", [])]


def heights(skin):
    graph = bpy.context.evaluated_depsgraph_get()
    evaluated = skin.evaluated_get(graph)
    return [tuple(skin.matrix_world @ v.co) for v in list(evaluated.to_mesh().vertices)[::997]]


def main(path):
    wanted, animated = node_names(path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    missing = [name for name in wanted if name not in bpy.data.objects]
    assert not missing, f"not in Blender: {missing[:5]} and {max(0, len(missing) - 5)} more"
    # A node that has curves of its own and a mesh that joints move becomes two objects there, of which the mesh comes second.
    skin = next(o for o in bpy.data.objects if o.type == "MESH" and o.name.split(".")[0] == "skin")
    assert any(m.type == "ARMATURE" for m in skin.modifiers), "the skin has no armature"
    if any(n.startswith("corrective_") for n in target_names(path)):
        keys = skin.data.shape_keys
        assert keys and all(name in keys.key_blocks for name in target_names(path)), "the corrective shapes are missing"
        assert keys.animation_data and (keys.animation_data.action or keys.animation_data.nla_tracks), "the corrective shapes have no curves"
    if animated:
        scene = bpy.context.scene
        scene.frame_set(1)
        first = heights(skin)
        scene.frame_set(40)
        moved = max(abs(a - b) for p, q in zip(first, heights(skin)) for a, b in zip(p, q))
        assert moved > 0.01, "the animation does not move the skin"
    bones = sum(name.startswith("bone/") for name in wanted)
    muscles = sum(name.startswith("muscle/") for name in wanted)
    print(f"{path}: Blender {bpy.app.version_string} shows {bones} bones and {muscles} muscles by name")


main(sys.argv[-1])
