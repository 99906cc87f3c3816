"""python blender_looks.py FILE.glb [PICTURE.png]   Loads a character in Blender and checks what it looks like: materials by tissue, colours of the vertices in
them, places on a texture, eyes. With a picture it renders muscles, bones and eyes from the front, the left and the back beside each other."""
import math
import sys

import bpy
import mathutils
import numpy as np

TISSUES = {"skin", "bone", "cartilage", "muscle", "tendon", "eye_white", "iris", "pupil"}


def base_color(material):
    """The base colour of a material, and whether vertices' colours go into it."""
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    links = shader.inputs["Base Color"].links
    if not links:
        return np.array(shader.inputs["Base Color"].default_value[:3]), False
    mix = links[0].from_node
    factors = [i for i in mix.inputs if i.type == "RGBA" and not i.links]
    by_vertex = any(i.links and i.links[0].from_node.type == "VERTEX_COLOR" for i in mix.inputs)
    return np.array(factors[0].default_value[:3]), by_vertex


def check(light):
    materials = {m.name: m for m in bpy.data.materials if m.users}
    assert set(materials) == TISSUES, f"materials: {sorted(materials)}"
    for name in ("muscle", "tendon"):
        color, by_vertex = base_color(materials[name])
        assert by_vertex, f"{name}: the vertices' colours are not in its colour"
        red, green = color[:2]
        assert red > 3 * green if name == "muscle" else green > 0.6 * red, f"{name}: {color}"
    skin = bpy.data.objects["skin"]
    places = np.empty(2 * len(skin.data.loops), dtype=np.float32)
    skin.data.uv_layers[0].uv.foreach_get("vector", places)
    places = places.reshape(-1, 2)
    assert places.min() > 0 and places.max() < 1 and len(np.unique(places, axis=0)) == len(skin.data.vertices)
    eyes = [bpy.data.objects["eyes"]] if light else [bpy.data.objects["eye/left"], bpy.data.objects["eye/right"]]
    for eye in eyes:
        assert {m.name for m in eye.data.materials} == {"eye_white", "iris", "pupil"}
    muscles = [o for o in bpy.data.objects if o.type == "MESH" and o.name.startswith("muscle")]
    faded = 0
    for muscle in muscles:
        colors = np.empty(4 * len(muscle.data.loops), dtype=np.float32)
        muscle.data.color_attributes[0].data.foreach_get("color", colors)
        faded += len(np.unique(colors.reshape(-1, 4).round(2), axis=0)) > 3
    assert faded > 0.6 * len(muscles), f"{faded} of {len(muscles)} muscles fade from belly to tendon"
    return len(muscles)


def triangles():
    return sum(len(o.data.loop_triangles) or (o.data.calc_loop_triangles() or len(o.data.loop_triangles)) for o in bpy.data.objects if o.type == "MESH")


def render(path, hidden):
    scene = bpy.context.scene
    for name in hidden:
        bpy.data.objects[name].hide_render = True
    things = [o for o in bpy.data.objects if o.type == "MESH" and not o.hide_render]
    corners = np.array([o.matrix_world @ mathutils.Vector(c) for o in things for c in o.bound_box])
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, height = (low + high) / 2, high[2] - low[2]
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 1.04 * height
    scene.collection.objects.link(camera)
    scene.camera = camera
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle = 3.0, 0.3
    scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.8, 0.85, 0.9, 1)
    scene.world.node_tree.nodes["Background"].inputs[1].default_value = 0.6
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 24
    scene.cycles.use_denoising = True
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = 640, 1280
    sides = []
    for number, (turn, _) in enumerate(((0, "front"), (90, "left"), (180, "back"))):
        a = math.radians(turn)
        toward = mathutils.Vector((math.sin(a), -math.cos(a), 0))
        camera.location = mathutils.Vector(middle) + 5 * toward
        camera.rotation_euler = toward.to_track_quat("Z", "Y").to_euler()
        sun.rotation_euler = (toward + mathutils.Vector((0.5 * toward.y, -0.5 * toward.x, 0.7))).to_track_quat("Z", "Y").to_euler()
        scene.render.filepath = f"{path[:-4]}-{number}.png"
        bpy.ops.render.render(write_still=True)
        picture = bpy.data.images.load(scene.render.filepath)
        sides.append(np.array(picture.pixels[:]).reshape(1280, 640, 4))
    sheet = np.concatenate(sides, axis=1)
    out = bpy.data.images.new("sheet", 3 * 640, 1280)
    out.pixels = sheet.ravel()
    out.filepath_raw, out.file_format = path, "PNG"
    out.save()


def main(path, picture):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    light = "muscles" in bpy.data.objects
    count = check(light)
    total = triangles()
    if light:
        assert total <= 60000, f"{total} triangles"
    print(f"{path}: Blender {bpy.app.version_string} shows {count} muscle meshes, {total} triangles, all tissues")
    if picture:
        render(picture, ["skin"])


arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else sys.argv[1:]
main(arguments[0], arguments[1] if len(arguments) > 1 else None)
