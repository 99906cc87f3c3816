#!/usr/bin/env python3
"""Every verb with every option of its --help, on a character as a user makes one: what an option promises is looked for in the output. Fails on an option that no
run here has used.   Usage: options.py ECORCHE SOURCE_FOLDER"""
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import zlib

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from inputs import bend_knees, cross_legs, landmark, one_side, sheet_of_cloth, short_motion, skin_of, spindle, write_obj, write_part, write_scan  # noqa: E402
from runner import Runner  # noqa: E402

VIEW = ["xvfb-run", "-a"]


def pc2_frames(data):
    """Vertex positions of a PC2 file, frame by frame."""
    _, _, points, _, _, frames = struct.unpack_from("<12siiffi", data)
    values = struct.unpack_from(f"<{3 * points * frames}f", data, 32)
    return [values[3 * points * f:3 * points * (f + 1)] for f in range(frames)]


def difference(a, b):
    """Largest distance of a coordinate between two caches, m."""
    return max(max(abs(x - y) for x, y in zip(f, g)) for f, g in zip(pc2_frames(a), pc2_frames(b)))


def measures(t, body):
    return json.loads(t.run(0, "body", "measure", body, "--json").stdout)


def bodies(t):
    t.run((0, 8), "body", "new", "--sex", "female", "--age", 30, "--height", "168cm", "--mass", "60kg", "-o", "anna.glb", "--report", "anna.json")
    anna = measures(t, "anna.glb")
    t.check(abs(anna["stature"] - 1.68) < 0.002 and abs(anna["weight"] - 60) < 0.3, f"anna: {anna['stature']} m, {anna['weight']} kg")
    t.run((0, 8), "body", "new", "--sex", "male", "--height", "5ft10", "--mass", "165lb", "-o", "ben.glb")
    ben = measures(t, "ben.glb")
    t.check(abs(ben["stature"] - 1.778) < 0.002 and abs(ben["weight"] - 74.8) < 0.4, f"ben: {ben['stature']} m, {ben['weight']} kg")
    t.run((0, 8), "body", "new", "--sex", "male", "--height", "1.778m", "--mass", 74.84, "--muscle", 0.9, "-o", "strong.glb")
    t.check(measures(t, "strong.glb")["upper_arm_girth_relaxed"] > ben["upper_arm_girth_relaxed"] + 0.005, "--muscle does not show in the upper arm")
    t.run((0, 8), "body", "new", "--sex", "female", "--age", 75, "--height", "168cm", "--mass", "60kg", "-o", "old.glb")
    t.check(t.bytes("old.glb") != t.bytes("anna.glb"), "--age changes nothing")
    t.run(0, "body", "new", "--sex", "female", "--measure", "stature=168cm", "--measure", "waist_girth=29in", "-o", "waist.glb")
    t.check(abs(measures(t, "waist.glb")["waist_girth"] - 29 * 0.0254) < 0.001, "--measure is not met")
    t.run(0, "body", "new", "--sex", "female", "--measure", "height=5ft6", "--measure", "bust=92cm", "-o", "bust.glb")
    t.check(abs(measures(t, "bust.glb")["chest_girth"] - 0.92) < 0.001 and abs(measures(t, "bust.glb")["stature"] - 1.6764) < 0.001, "other names of measures")
    t.says(t.run(2, "body", "new", "--sex", "female", "--measure", "bust=92cm", "--measure", "chest_girth=90cm", "-o", "no.glb"), "chest_girth")
    t.run(0, "body", "new", "--sex", "male", "--size", "xxl", "-o", "xxl.glb")
    t.check(1.12 < measures(t, "xxl.glb")["chest_girth"] < 1.32, "--size XXL has another chest")
    conflict = ["--sex", "female", "--measure", "stature=160cm", "--measure", "crotch_height=100cm"]
    t.says(t.run(4, "body", "new", *conflict, "-o", "no.glb"), "contradicts")
    t.absent("no.glb")
    t.run(8, "body", "new", *conflict, "--best-effort", "-o", "effort.glb")
    t.there("effort.glb")
    t.run(0, "body", "new", "--sex", "male", "--measure", "stature=201cm", "--measure", "waist_girth=66cm", "--measure", "weight=70kg", "--allow-unusual", "-o", "unusual.glb")
    t.there("unusual.glb")
    t.run(0, "body", "new", "--sex", "female", "--measure", "stature=165cm", "-o", "probable.glb")
    t.run(0, "body", "new", "--sex", "female", "--by", "examples", "--measure", "stature=165cm", "-o", "examples.glb", "--report", "examples.json")
    achieved = t.json("examples.json")["achieved"]["stature"]
    t.check(abs(achieved - 1.65) < 0.05 and abs(measures(t, "examples.glb")["stature"] - achieved) < 0.001, f"--by examples: stature {achieved} m")
    t.check(t.bytes("examples.glb") != t.bytes("probable.glb"), "--by examples changes nothing")


def units(t):
    """Lengths take units everywhere; a number that could be meant otherwise is refused."""
    for text in ("1.68", "168cm", "1680mm", "5ft6.142", "66.142in", "5'6.142\""):
        t.run((0, 8), "body", "new", "--sex", "female", "--age", 30, "--height", text, "--mass", "60kg", "-o", "same.glb")
        t.check(abs(measures(t, "same.glb")["stature"] - 1.68) < 0.002, f"--height {text}")
    for text, hint in (("178", "178cm"), ("70", "70in"), ("5.9", "5.9ft"), ("nan", "not a length"), ("17m", "possible"), ("tall", "not a length"), ("1,78m", "point")):
        t.says(t.run(2, "body", "new", "--sex", "male", "--height", text, "-o", "no.glb"), hint)
    for text in ("waist_girth=80", "waist_girth=nan", "waist_girth=-3cm", "waist_girth=much"):
        t.says(t.run(2, "body", "modify", "anna.glb", "--measure", text, "-o", "no.glb"), "waist_girth")
    for option in ("--mass", "--muscle", "--age"):
        t.says(t.run(2, "body", "new", "--sex", "male", option, "nan", "-o", "no.glb"), option)
    for option in ("--fat", "--exaggerate", "--hip-waist"):
        t.says(t.run(2, "body", "modify", "anna.glb", option, "nan", "-o", "no.glb"), option)
    t.absent("no.glb")
    people = t.write("bare.csv", "name,sex,stature,weight\nada,female,168,60\nbob,male,178cm,74\n")
    t.says(t.run(8, "body", "population", people, "--skins", "-o", "bare"), "168cm")
    t.there("bare/bob.glb")
    t.absent("bare/ada.glb")


def body_verbs(t):
    listed = t.run(0, "body", "measure", "--list").stdout
    t.check(listed.count("\n") > 50 and "waist_girth" in listed, "--list names the measures")
    inches = t.run(0, "body", "measure", "anna.glb", "--unit", "in").stdout
    t.check(re.search(r"^stature +66\.1 in", inches, re.M), "--unit in")
    csv = t.run(0, "body", "measure", "anna.glb", "--csv", "--unit", "mm").stdout
    t.check(re.search(r"^stature,16(79|80)\.\d*,mm", csv, re.M), "--csv")
    t.run(0, "body", "measure", "anna.glb", "--html", "anna.html")
    t.check(b"data:image/png" in t.bytes("anna.html"), "--html has a picture")
    t.run(0, "body", "modify", "anna.glb", "--fat", 34, "-o", "fatter.glb", "--report", "modify.json")
    t.check(abs(t.json("modify.json")["after"]["fat_percent"] - 34) < 0.5, "--fat is not met")
    t.run((0, 8), "body", "modify", "anna.glb", "--hip-waist", 1.35, "-o", "curvy.glb", "--report", "modify.json")
    t.check(abs(t.json("modify.json")["after"]["hip_waist_ratio"] - 1.35) < 0.01, "--hip-waist is not met")
    t.run((0, 8), "body", "modify", "anna.glb", "--measure", "waist_girth=80cm", "-o", "wide.glb")
    t.check(abs(measures(t, "wide.glb")["waist_girth"] - 0.8) < 0.002, "--measure is not met")
    t.run((0, 8), "body", "modify", "anna.glb", "--muscle", 0.8, "-o", "trained.glb")
    t.check(measures(t, "trained.glb")["upper_arm_girth_relaxed"] > measures(t, "anna.glb")["upper_arm_girth_relaxed"], "--muscle")
    t.run((0, 8), "body", "modify", "anna.glb", "--age", 70, "-o", "aged.glb")
    t.run((0, 8), "body", "modify", "wide.glb", "--exaggerate", 1.5, "-o", "overdrawn.glb")
    t.run((0, 8), "body", "modify", "anna.glb", "--sex", "female", "--fat", 34, "-o", "again.glb")
    t.check(t.bytes("aged.glb") != t.bytes("anna.glb") and t.bytes("overdrawn.glb") != t.bytes("wide.glb"), "--age, --exaggerate")
    described = t.run(0, "body", "statistics", "anna.glb").stdout
    t.check("standard deviations from the mean body" in described, "body statistics of a body")
    t.run(0, "body", "statistics", "anna.glb", "--with", "anna.glb", "--age", 75, "--height", "165cm", "--mass", 65, "-o", "anna-old.glb")
    t.there("anna-old.glb")
    items = t.run(0, "body", "statistics", "--sex", "male", "--item", "height=175cm", "--item", "waist_width=30cm", "-o", "items.glb").stdout
    t.check(re.search(r"^height +175.0 +17[45]", items, re.M), "--item is not met")
    t.run(2, "body", "statistics", "--sex", "male", "--item", "girth=90cm", "-o", "no.glb")
    size = t.run(0, "body", "size", "xxl.glb", "--sex", "male").stdout
    t.check(size.startswith("size XXL"), f"body size: {size[:20]}")
    t.write("people.csv", "name,sex,stature,waist_girth\nada,female,168cm,74cm\nbob,,178cm,90cm\n")
    t.run((0, 8), "body", "population", "people.csv", "--sex", "male", "--skins", "-o", "people", "--crowd", "crowd.glb", "--progress", "lines")
    t.there("people/ada.bin")
    t.there("crowd.glb")
    t.check(re.search(r"^bob,male", t.bytes("people/population.csv").decode(), re.M), "--sex of a row without one")
    t.run((0, 8), "body", "population", "--count", 2, "--seed", 5, "--skins", "-o", "drawn")
    t.there("drawn/person-0002.glb")
    t.write("tall.csv", "name,sex,stature,waist_girth,weight\ntom,male,201cm,66cm,70kg\n")
    t.run(4, "body", "population", "tall.csv", "--skins", "-o", "tall")
    t.run((0, 8), "body", "population", "tall.csv", "--skins", "--allow-unusual", "-o", "tall")
    t.there("tall/tom.glb")


def scans(t):
    """Registration: the person comes back from a scan of another topology, unit and axes; hints and outputs."""
    write_scan(t, "anna.glb", "scan.ply", 1000)
    t.run((0, 8), "body", "register", "scan.ply", "-o", "found.glb", "--posed", "posed.ply", "--page", "scan.html", "--report", "scan.json")
    found = t.json("scan.json")
    t.check(abs(found["body"]["stature"] - 1.68) < 0.02, f"stature {found['body']['stature']} m of 1.68")
    t.check(found["register"]["scan_to_body"]["median"] < 0.003, f"scan to body {found['register']['scan_to_body']}")
    t.check(abs(found["register"]["unit_m"] - 0.001) < 1e-5 and found["register"]["up"] == "+Z" and found["register"]["front"] == "-Y", "unit and axes are found")
    t.check(abs(measures(t, "found.glb")["waist_girth"] - measures(t, "anna.glb")["waist_girth"]) < 0.03, "waist of the registered body")
    t.check(t.bytes("scan.html").count(b"data:image/png") >= 5, "--page has pictures")
    t.check(t.bytes("posed.ply").startswith(b"ply"), "--posed")
    elbow = found["register"]["joints"]["forearm_l"]["position"]
    t.check(0.7 * 1000 < elbow[2] < 1.5 * 1000, f"joints are in the file's coordinates: {elbow}")
    write_scan(t, "anna.glb", "scan.obj", 1 / 0.0254)
    t.write("marks.json", json.dumps({"landmarks": {"acromion_l": landmark(t, "anna.glb", "acromion", 1 / 0.0254)}}))
    t.run((0, 8), "body", "register", "scan.obj", "--unit", "in", "--stature", "168cm", "--pose", "A", "--landmarks", "marks.json", "-o", "hinted.glb", "--report", "hinted.json")
    t.check(abs(t.json("hinted.json")["body"]["stature"] - 1.68) < 0.002, "--stature is met")
    t.says(t.run(2, "body", "register", "scan.ply", "--pose", "sitting", "-o", "no.glb"), "A, T")
    t.write("wrong.json", '{"acromyon_l": [0, 0, 0]}')
    t.says(t.run(4, "body", "register", "scan.ply", "--landmarks", "wrong.json", "-o", "no.glb"), "acromion_l")
    t.write("wrong.json", '{"acromion_l": [0, 0]}')
    t.says(t.run(3, "body", "register", "scan.ply", "--landmarks", "wrong.json", "-o", "no.glb"), "three finite numbers")
    t.write("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    t.run(4, "body", "register", "cube.obj", "-o", "no.glb")
    t.absent("no.glb")


def strangers(t):
    """A mesh that is not ours is fitted as it came; motions of .glb files are chosen by name."""
    t.run((0, 8), "fit", "scan.obj", "--unit", "in", "--stature", "168cm", "--pose", "A", "--landmarks", "marks.json", "--skin", "own", "--method", "paper", "-o", "own.glb", "--report", "own.json")
    own = t.json("own.json")
    t.check(own["own_skin"]["distance_p95"] < 0.02 and own["fit"]["bone_vertices_outside"] == 0, f"a stranger's fit: {own['own_skin']}, {own['fit']['bone_vertices_outside']} bone vertices outside")
    t.says(t.run(2, "fit", "anna.glb", "--skin", "own", "-o", "no.glb"), "base mesh")
    t.says(t.run(2, "fit", "anna.glb", "--pose", "A", "-o", "no.glb"), "--pose")
    short_motion(t.data("motions", "walk.bvh"), t.path("second.bvh"), 13)
    t.run((0, 8), "animate", "own.glb", "second.bvh", "-o", "own-walk.glb")
    t.run((0, 8), "animate", "own.glb", "own-walk.glb", "--take", "motion", "-o", "own-again.pc2")
    t.says(t.run(4, "animate", "own.glb", "own-walk.glb", "--take", "nothing", "-o", "no.pc2"), "there are")
    t.says(t.run(2, "animate", "own.glb", t.data("motions", "walk.bvh"), "--take", "1", "-o", "no.pc2"), "--take")
    t.run((0, 8), "render", "own.glb", "own-walk.glb", "--take", "motion", "--at", 0.1, "--size", "160x240", "-o", "own.png")
    t.run((0, 8), "bake", "own.glb", "own-walk.glb", "--take", "motion", "--rig", "ecorche", "--morphs", 2, "--helpers", 2, "--samples", 6, "-o", "own-engine.glb")
    t.says(t.run(4, "bake", "own.glb", "own-walk.glb", "--rig", "own", "-o", "no.glb"), "has no rig")
    t.absent("no.glb")
    t.absent("no.pc2")


def fits(t):
    t.run((0, 8), "fit", "anna.glb", "-o", "anna-anatomy.glb", "--report", "fit.json")
    t.check(t.json("fit.json")["fit"]["bone_vertices"] > 1e5, "a fit reports its bones")
    write_part(t, "anna-anatomy.glb", "some.glb")
    t.run((0, 8), "fit", "anna.glb", "--skin", "fine", "--method", "ellipses", "-o", "fine.glb", "--report", "fine.json")
    t.check(skin_of(t.bytes("fine.glb"))[2] >= 120404, "--skin fine")
    write_part(t, "fine.glb", "fine-some.glb")
    t.run((0, 8), "fit", "anna.glb", "--method", "paper", "--alpha", 0.6, "-o", "paper.glb")
    t.run((0, 8), "fit", "anna.glb", "--method", "paper", "-o", "paper-04.glb")
    t.check(t.bytes("paper.glb") != t.bytes("paper-04.glb"), "--alpha")
    t.says(t.run(2, "fit", "anna.glb", "--alpha", 0.6, "-o", "no.glb"), "--method paper")
    t.run((0, 8), "fit", "anna.glb", "--interior", "lattice", "--tissue", "tissue.vtk", "--method", "paper", "-o", "lattice.glb", "--report", "lattice.json")
    t.check(t.json("lattice.json")["fit"]["tissue"]["tetrahedra"] > 1000 and b"UNSTRUCTURED_GRID" in t.bytes("tissue.vtk"), "--interior, --tissue")
    obj = write_obj(t, "anna.obj", 100 / 2.54)
    t.run((0, 8), "fit", obj, "--unit", "in", "--sex", "female", "--method", "paper", "-o", "from-obj.glb", "--report", "obj.json")
    t.check(abs(t.json("obj.json")["fit"]["stature"] - 1.68) < 0.002, "--unit in")
    # A bare skin comes without a mass.
    write_part(t, "from-obj.glb", "from-obj-some.glb")
    t.run(0, "render", "from-obj-some.glb", "--pose", "standing", "--definition", 0.5, "--size", "64x64", "-o", "from-obj.png")
    inches = json.loads(t.run(0, "body", "measure", obj, "--skin-unit", "in", "--json").stdout)
    t.check(abs(inches["stature"] - 1.68) < 0.002 and abs(inches["waist_girth"] - measures(t, "anna.glb")["waist_girth"]) < 0.002, "body measure of a bare skin")
    t.run(0, "body", "size", obj, "--skin-unit", "in", "--sex", "female")
    t.run(0, "body", "statistics", obj, "--skin-unit", "in", "--sex", "female")
    t.run((0, 8), "body", "modify", obj, "--skin-unit", "in", "--sex", "female", "--fat", 30, "-o", "obj-fatter.glb")
    t.check(abs(measures(t, "fine.glb")["waist_girth"] - measures(t, "anna.glb")["waist_girth"]) < 0.004, "body measure of a character with the fine skin")
    t.run((0, 8), "fit", obj, "--unit", "in", "--sex", "male", "--method", "paper", "-o", "as-male.glb")
    t.check(t.bytes("as-male.glb") != t.bytes("from-obj.glb"), "--sex decides the layer of fat")
    t.run(0, "weights", "anna-anatomy.glb", "-o", "weights.csv", "--joint", "knee_l,hip_l", "--picture", "weights.png")
    rows = t.bytes("weights.csv").decode().splitlines()
    t.check(rows[0] == "vertex,joint,weight" and len(rows) > 13380, "weights of every vertex")
    t.check(t.bytes("weights.png")[:4] == b"\x89PNG", "--picture")
    # The skin between the knees hangs on the pelvis alone: it stays where the pelvis has it.
    knees = sorted({row.split(",")[0] for row in rows[1:] if row.split(",")[1] == "knee_l" and float(row.split(",")[2]) > 0.5}, key=int)
    t.write("painted.csv", "vertex,joint,weight\n" + "".join(f"{v},pelvis,1\n" for v in knees[:40]))
    t.run(0, "weights", "anna-anatomy.glb", "-o", "painted-weights.csv", "--weights", "painted.csv")
    t.check(f"{knees[0]},pelvis,1" in t.bytes("painted-weights.csv").decode(), "--weights of weights")
    t.run((0, 8), "fit", "anna.glb", "--weights", "painted.csv", "--method", "paper", "-o", "painted.glb")
    t.check(t.bytes("painted.glb") != t.bytes("paper-04.glb"), "--weights of fit")
    t.run(0, "export", "anna-anatomy.glb", "-o", "anna.osim", "-o", "anna.xml")
    t.there("anna_meshes/femur_l.obj")
    t.run(0, "export", "anna-anatomy.glb", "-o", "bare.osim", "--no-meshes")
    t.run(0, "export", "anna-anatomy.glb", "-o", "table.osim", "--no-meshes", "--masses", "table")
    t.check(t.bytes("table.osim") != t.bytes("bare.osim"), "export --masses changes nothing")
    t.absent("bare_meshes")
    t.run(0, "export", "anna-anatomy.glb", "-o", "ground.osim", "-o", "ground.xml", "--no-meshes", "--ground")
    t.check(b"ContactHalfSpace" in t.bytes("ground.osim") and b'type="plane"' in t.bytes("ground.xml") and b"ContactHalfSpace" not in t.bytes("bare.osim"), "--ground")
    t.run((0, 8), "fit", "anna.glb", "-o", "light.glb", "--detail", "medium", "--method", "paper")
    t.check(len(t.bytes("light.glb")) < len(t.bytes("anna-anatomy.glb")) / 3, "--detail medium")
    t.run((0, 8), "fit", "anna.glb", "-o", "low.glb", "--detail", "low", "--method", "paper")
    t.check(len(t.bytes("low.glb")) < len(t.bytes("light.glb")) / 1.6, "--detail low")
    t.says(t.run(4, "animate", "light.glb", t.data("motions", "walk.bvh"), "-o", "no.glb"), "light")


def animations(t):
    short_motion(t.data("motions", "walk.bvh"), t.path("walk.bvh"), 8)
    short_motion(t.data("motions", "long_jump.bvh"), t.path("jump.bvh"), 16)
    animate = lambda *words, codes=(0, 8): t.run(codes, "animate", "some.glb", *words)  # noqa: E731
    done = animate("walk.bvh", "-o", "walk.glb", "-o", "walk.pc2", "-o", "walk.mdd", "-o", "objs/%03d.obj", "--report", "walk.json", "-v")
    t.says(done, "walk.bvh: 8 frames at")
    t.says(done, "timings_ms.frames")
    t.check(len(pc2_frames(t.bytes("walk.pc2"))) == 8, "8 frames")
    t.there("objs/008.obj")
    t.there("walk.mdd")
    animate("walk.bvh", "-o", "layers.pc2", "--layers", "skin,muscles,bones")
    t.check(len(pc2_frames(t.bytes("layers-muscles.pc2"))) == 8 and t.bytes("layers-skin.pc2") == t.bytes("walk.pc2"), "--layers")
    vertices = sum(line.startswith("v ") for line in t.bytes("layers-muscles.obj").decode().splitlines())
    t.check(vertices == struct.unpack("<i", t.bytes("layers-muscles.pc2")[16:20])[0], "the muscles' mesh and cache have the same vertices")
    animate("walk.bvh", "-o", "blender.pc2", "-o", "blender.glb", "--cache-for", "glb")
    t.check(struct.unpack("<i", t.bytes("blender.pc2")[16:20])[0] > 13380, "--cache-for glb")
    for name, detail in (("whole-walk.glb", "full"), ("light-walk.glb", "low")):
        animate("walk.bvh", "-o", name, "--detail", detail)
    t.check(len(t.bytes("light-walk.glb")) < 0.8 * len(t.bytes("whole-walk.glb")), "--detail of animate")
    animate("walk.bvh", "-o", "walk.mot", "-o", "walk.trc", "--table", "lengths=lengths.csv", "--table", "moment-arms:knee_l_flexion=arms.sto", "--table", "velocities=velocities.csv",
            "--table", "bellies=bellies.csv", "--table", "tendons=tendons.csv", "--table", "activations=activations.csv")
    for name in ("lengths.csv", "velocities.csv", "bellies.csv", "tendons.csv", "activations.csv"):
        rows = [line for line in t.bytes(name).decode().splitlines() if line and not line.startswith("#")]
        t.check(len(rows) == 9 and rows[0].startswith("time"), f"{name}: a row a frame, {len(rows)}")
    t.check(b"endheader" in t.bytes("walk.mot") and b"endheader" in t.bytes("arms.sto") and b"PathFileType" in t.bytes("walk.trc"), "headers of .mot, .sto and .trc")
    t.says(t.run(2, "animate", "some.glb", "walk.bvh", "--table", "lenghts=x.csv"), "lengths")
    t.says(t.run(2, "animate", "some.glb", "walk.bvh", "-o", "no.glb", "--layers", "skin"), ".pc2")
    animate("walk.bvh", "-o", "lbs.pc2", "--skin", "lbs")
    t.check(difference(t.bytes("lbs.pc2"), t.bytes("walk.pc2")) > 1e-3, "--skin lbs")
    t.write("tense.csv", "time,muscle,value\n0,biceps_brachii_*,1\n0,gastrocnemius_*,1\n")
    animate("walk.bvh", "-o", "tense.pc2", "--activation", "tense.csv", "--report", "tense.json")
    t.check(t.json("tense.json")["activation"]["muscles"] > 0 and difference(t.bytes("tense.pc2"), t.bytes("walk.pc2")) > 1e-4, "--activation")
    t.says(t.run(2, "animate", "some.glb", "walk.bvh", "-o", "no.mot", "--activation", "tense.csv"), "no.glb")
    animate("walk.bvh", "-o", "tense.glb", "--activation", "tense.csv")
    t.check(t.bytes("tense.glb") != t.bytes("walk.glb"), "--activation of a .glb")
    t.run((0, 8), "animate", "tense.glb", "walk.bvh", "-o", "again.mot")  # still a character
    animate("jump.bvh", "-o", "jump.pc2")
    animate("jump.bvh", "-o", "loose.pc2", "--dynamics")
    t.check(difference(t.bytes("jump.pc2"), t.bytes("loose.pc2")) > 1e-5, "--dynamics")
    animate("walk.bvh", "-o", "plain.pc2", "--definition", 0)
    t.check(t.bytes("plain.pc2") == t.bytes("walk.pc2"), "--definition 0")
    t.says(t.run(4, "animate", "some.glb", "walk.bvh", "-o", "no.pc2", "--definition", 1), "--skin fine")
    for definition in (0, 1):
        t.run((0, 8), "animate", "fine-some.glb", "walk.bvh", "-o", f"defined{definition}.pc2", "--definition", definition)
    t.check(difference(t.bytes("defined1.pc2"), t.bytes("defined0.pc2")) > 1e-4, "--definition")
    t.says(t.run(2, "animate", "some.glb", "walk.bvh", "-o", "no.pc2", "--skin", "lbs", "--definition", 1), "--skin")
    animate("walk.bvh", "-o", "painted.pc2", "--weights", "painted.csv")
    t.check(difference(t.bytes("painted.pc2"), t.bytes("walk.pc2")) > 1e-3, "--weights")
    joints = re.findall(r"^\s*(?:ROOT|JOINT) (\S+)", open(t.path("walk.bvh"), encoding="utf-8").read(), re.M)
    t.write("map.txt", "".join(f"{name} =\n" for name in joints if "Hand" in name or "hand" in name or "Wrist" in name))
    animate("walk.bvh", "-o", "mapped.pc2", "--map", "map.txt")
    t.check(difference(t.bytes("mapped.pc2"), t.bytes("walk.pc2")) > 1e-3, "--map leaves the hands as they are")
    animate("walk.bvh", "-o", "up.pc2", "--up", "y")
    t.check(t.bytes("up.pc2") == t.bytes("walk.pc2"), "--up y of a file whose figure stands along y")
    t.says(animate("walk.bvh", "-o", "no.pc2", "--up", "z", codes=4), "stands along y")
    animate("walk.bvh", "-o", "slow.glb", "--motion-fps", 12, "--report", "slow.json")
    t.check(abs(t.json("slow.json")["motion"]["fps"] - 12) < 1e-6, "--motion-fps")
    text = open(t.path("walk.bvh"), encoding="utf-8").read()
    bent = bend_knees(text)
    t.write("bent.bvh", bent)
    animate("bent.bvh", "-o", "keep.pc2", "--limits", "keep", "--report", "keep.json")
    animate("bent.bvh", "-o", "clamp.pc2", "--limits", "clamp", "--report", "clamp.json")
    t.check(t.json("keep.json")["motion"]["joints_beyond_limits"] > t.json("clamp.json")["motion"]["joints_beyond_limits"], "--limits")
    t.write("crossed.bvh", cross_legs(text))
    animate("crossed.bvh", "-o", "apart.pc2", "--limits", "clamp", "--report", "apart.json")
    animate("crossed.bvh", "-o", "through.pc2", "--limits", "clamp", "--no-apart", "--report", "through.json")
    t.check("parted" in t.json("apart.json")["motion"] and "parted" not in t.json("through.json")["motion"], "--no-apart")
    animate("walk.bvh", "-o", "free.pc2", "--no-plant", "--report", "free.json")
    t.check(t.json("free.json")["motion"]["contacts"] == 0, "--no-plant")
    animate("walk.bvh", "-o", "planted.pc2", "--plant", "--report", "planted.json")
    t.check(t.json("planted.json")["motion"]["contacts"] > 0, "--plant")
    t.run((0, 8), "animate", "crowd.glb", "walk.bvh", "-o", "walking.glb", "--stagger", 0.5)
    t.check(b"walk" in t.bytes("walking.glb"), "a crowd that walks")
    done = t.run((0, 8), "bake", "some.glb", "walk.bvh", "jump.bvh", "-o", "baked.glb", "--morphs", 4, "--helpers", 6, "--samples", 10, "--weights", "painted.csv",
                 "--map", "map.txt", "--up", "y", "--motion-fps", 30, "--limits", "keep", "--no-apart", "--no-plant", "--report", "bake.json", "--progress", "lines")
    bake = t.json("bake.json")["bake"]
    t.check(bake["morphs"] <= 4 and bake["helpers"] <= 6 and bake["frames"] == 24, "--morphs, --helpers")
    t.run((0, 8), "bake", "some.glb", "walk.bvh", "-o", "planted.glb", "--morphs", 2, "--helpers", 0, "--samples", 8, "--plant", "--definition", 0)
    t.run((0, 8), "bake", "some.glb", "walk.bvh", "-o", "mapped.glb", "--morphs", 2, "--helpers", 0, "--samples", 4, "--maps", 256, "--definition", 1, "--report", "maps.json")
    normal_maps(t)

    motions_of_other_formats(t)
    markers(t)


def markers(t):
    """Markers on our own walk come back as that walk; a table of one's own names them; plates are compared."""
    t.run((0, 8), "animate", "some.glb", "walk.bvh", "-o", "walk.trc")
    t.run((0, 8), "retarget", "walk.trc", "some.glb", "-o", "from-markers.bvh", "--report", "from-markers.json")
    found = t.json("from-markers.json")
    t.check(found["markers"]["rms"] < 0.012 and abs(found["markers"]["size"]["thigh"] - 1) < 0.08 and found["motion"]["frames"] == 8, f"markers of our own walk: {found['markers']['rms']}")
    with open(t.path("markers.csv"), "w", encoding="utf-8") as file:
        file.write("marker,place,joint,out_front,spread_mm\nthelion_l,,thorax,1,60\nbuttock_l,,pelvis,-1,80\nforearm_r,forearm_r,,,\n")
    own = ("--markers", "markers.csv")
    t.run((0, 8), "animate", "some.glb", "walk.trc", "-o", "from-markers.mot", *own, "--report", "own-markers.json")
    t.check(t.json("own-markers.json")["markers"]["known"] == found["markers"]["known"] + 2, "--markers")
    t.run((0, 8), "retarget", "walk.trc", "some.glb", "-o", "from-markers.glb", *own)
    t.run((0, 8), "bake", "some.glb", "walk.trc", "-o", "marked.glb", "--morphs", 2, "--helpers", 0, "--samples", 4, *own)
    t.run((0, 8), "render", "some.glb", "walk.trc", "--at", 0.02, "--size", "96x80", "-o", "marked.png", *own)
    with open(t.path("plates.mot"), "w", encoding="utf-8") as file:
        axes = [f"{side}_ground_force_{what}{axis}" for side in "RL" for what in "vp" for axis in "xyz"]
        file.write("plates\nnRows=3\nnColumns=13\nendheader\ntime\t" + "\t".join(axes) + "\n")
        for k in range(3):
            file.write(f"{10 + k / 10}\t" + "\t".join(["0", "300", "0", "0", "0", "0"] * 2) + "\n")
    t.says(t.run((0, 8), "dynamics", "anna-anatomy.glb", "walk.trc", "-o", "plates.sto", "--html", "plates.html", "--plates", "plates.mot", "--plates-start", 10, *own, "--report", "plates.json"),
           "beside the plates")
    t.check(t.json("plates.json")["dynamics"]["plates"]["measured_mean"] > 0.5, "--plates")
    t.says(t.run(4, "dynamics", "anna-anatomy.glb", "walk.trc", "-o", "no.sto", "--plates", "plates.mot"), "it lasts from 10")
    t.says(t.run(4, "dynamics", "anna-anatomy.glb", "walk.trc", "-o", "no.sto", "--plates", "legs.mot"), "no force of a plate")
    t.says(t.run(2, "retarget", "walk.bvh", "some.glb", "-o", "no.bvh", *own), "--markers")


def normal_maps(t):
    """The normal map of a bake as glTF has it: an image of the material, unit normals that face outwards, more than one of them."""
    data = t.bytes("mapped.glb")
    length = struct.unpack_from("<I", data, 12)[0]
    doc = json.loads(data[20:20 + length])
    skin = next(mesh for mesh in doc["meshes"] if mesh["name"] == "skin")["primitives"][0]
    texture = doc["textures"][doc["materials"][skin["material"]]["normalTexture"]["index"]]
    image = doc["images"][texture["source"]]
    view = doc["bufferViews"][image["bufferView"]]
    png = data[28 + length + view.get("byteOffset", 0):][:view["byteLength"]]
    t.check(image["mimeType"] == "image/png" and png == t.bytes("mapped-normal.png"), "the normal map inside the bake is the one beside it")
    t.check(doc["accessors"][skin["attributes"]["TEXCOORD_0"]]["count"] == doc["accessors"][skin["attributes"]["POSITION"]]["count"], "places on the texture")
    width, rows = png_rows(png)
    off = max(abs(sum((row[3 * x + k] / 127.5 - 1) ** 2 for k in range(3)) - 1) for row in rows for x in range(width))
    t.check(width == 256 and off < 0.05, "the map's normals have length 1")
    t.check(all(row[3 * x + 2] > 128 for row in rows for x in range(width)) and any(row[3 * x] != 128 for row in rows for x in range(width)), "they face outwards and are not all alike")
    t.check(0 < t.json("maps.json")["bake"]["maps"]["displacement_range"] < 0.02 and png_rows(t.bytes("mapped-displacement.png"))[0] == 256, "the displacement map")


def png_rows(png):
    """Width and rows of an 8-bit RGB PNG."""
    at, packed, width = 8, b"", 0
    while at < len(png):
        length, kind = struct.unpack_from(">I4s", png, at)
        if kind == b"IHDR":
            width = struct.unpack_from(">I", png, at + 8)[0]
        if kind == b"IDAT":
            packed += png[at + 8:at + 8 + length]
        at += 12 + length
    plain, rows, before = zlib.decompress(packed), [], bytearray(3 * width)
    for start in range(0, len(plain), 3 * width + 1):
        row = bytearray(plain[start + 1:start + 1 + 3 * width])
        for i in range(len(row)):
            left, up, corner = row[i - 3] if i >= 3 else 0, before[i], before[i - 3] if i >= 3 else 0
            guess = left + up - corner
            nearest = min((left, up, corner), key=lambda value: abs(guess - value))
            row[i] = (row[i] + (0, left, up, (left + up) // 2, nearest)[plain[start]]) & 255
        rows.append(row)
        before = row
    return width, rows


def filters(t):
    """Each filter does what it says, and says what it does not take."""
    def run(codes, *words, motion="person_01.amc"):
        more = [part for word in words for part in ("--filter", word)]
        return t.run(codes, "retarget", motion, "some.glb", "-o", "filtered.bvh", "--report", "filtered.json", *more)
    frames = lambda: t.json("filtered.json")["motion"]["frames"]  # noqa: E731
    run((0, 8), "speed=0.5", "smooth=50ms", "lock=80%", "mirror", "turn=90")
    t.check(frames() == 15, "half the speed")
    run((0, 8), "blend=walk.bvh,at=20ms,over=10ms", "fps=60")
    run((0, 8), "blend=walk.bvh,share=0.5", "length=1s", "slope=-5")
    t.write("way.csv", "x,z\n0,0\n1,1\n1,2\n")
    run((0, 8), "path=way.csv")
    t.write("way-short.csv", "x,z\n0,0\n")
    for word, codes, says in (("lock=2", 2, "from 0 to 1"), ("smooth=fast", 2, "a width"), ("speed=0", 2, "out of range"), ("lenght=3s", 2, "did you mean length"), ("loop=place", 2, "takes no"), ("loop,travel=in", 2, "keep and out"),
                              ("mirror=x", 2, "takes no"), ("turn", 2, "needs a value"), ("slope=60deg", 2, "from -30 to 30"), ("blend=walk.bvh", 2, "at=1.5s"), ("blend=walk.bvh,at=9s", 4, "begin earlier"),
                              ("blend=none.bvh,at=0s", 3, "none.bvh"), ("path=none.csv", 3, "none.csv"), ("path=way-short.csv", 3, "two or more"), ("loop", 4, "a longer part"), ("length=1e5s", 5, "limit")):
        t.says(run(codes, word), says)


def motions_of_other_formats(t):
    corpus = os.path.join(t.source, "tests", "corpus", "motion")
    for name in ("person.asf", "person_01.amc", "character_person.txt", "person_walk.txt", "legs.mot"):
        shutil.copy(os.path.join(corpus, name), t.path(name))
    frames = lambda name: t.json(name)["motion"]["frames"]  # noqa: E731
    t.run((0, 8), "animate", "some.glb", "person_01.amc", "-o", "amc.mot", "--report", "amc.json")
    t.run((0, 8), "animate", "some.glb", "person_01.amc", "-o", "part.mot", "--filter", "slope=4", "--from", "2f", "--to", "5f", "--report", "part.json")
    t.check(frames("amc.json") == 8 and frames("part.json") == 4, "--from, --to")
    t.run((0, 8), "animate", "some.glb", "person_walk.txt", "--skeleton", "character_person.txt", "-o", "deepmimic.mot", "--report", "deepmimic.json")
    t.check(frames("deepmimic.json") == 8, "--skeleton")
    t.says(t.run((0, 8), "animate", "some.glb", "legs.mot", "-o", "legs-too.mot"), "arm_flex")
    t.says(t.run(3, "animate", "some.glb", "person_01.amc", "--skeleton", "character_person.txt", "-o", "no.mot"), "character_person.txt")
    t.run((0, 8), "retarget", "walk.bvh", "some.glb", "-o", "alone.bvh", "-o", "alone.glb", "--report", "alone.json")
    for name in ("alone.bvh", "alone.glb"):
        t.run((0, 8), "retarget", name, "some.glb", "-o", "again.bvh", "--report", "again.json")
        t.check(frames("again.json") == 8 and t.json("again.json")["motion"]["own_rig"], f"{name} is a motion of the same body")
    t.run((0, 8), "retarget", "walk.bvh", "some.glb", "-o", "some.bvh", "--from", "10ms", "--to", "4f", "--map", "map.txt", "--up", "y", "--motion-fps", 30, "--limits", "keep", "--no-apart",
          "--no-plant", "--report", "some.json")
    t.check(frames("some.json") == 3, "--from, --to of retarget")
    t.run((0, 8), "retarget", "person_01.amc", "some.glb", "-o", "planted.bvh", "--skeleton", "person.asf", "--plant")
    t.run((0, 8), "retarget", "alone.glb", "some.glb", "-o", "taken.bvh", "--take", "1")
    t.run((0, 8), "retarget", "walk.bvh", "some.glb", "-o", "alone.fbx")
    t.run((0, 8), "retarget", "alone.fbx", "some.glb", "-o", "from-fbx.bvh", "--report", "from-fbx.json")
    t.check(frames("from-fbx.json") == 8 and t.json("from-fbx.json")["motion"]["same_rest"], "alone.fbx is a motion of the same skeleton")
    filters(t)
    t.run((0, 8), "bake", "some.glb", "person_01.amc", "-o", "part.glb", "--morphs", 2, "--helpers", 0, "--samples", 4, "--skeleton", "person.asf", "--from", "1f", "--to", "4f", "--filter", "mirror")
    t.run((0, 8), "render", "some.glb", "person_01.amc", "--skeleton", "person.asf", "--filter", "turn=10", "--at", 0.02, "--size", "96x80", "-o", "amc.png")


def forces(t):
    """Segments weigh what the body weighs; the ground carries a walk, and nothing does without it."""
    told = t.run(0, "inertia", "anna-anatomy.glb", "-o", "inertia.csv", "-o", "inertia.json", "--report", "inertia-report.json")
    t.says(told, "thigh_l")
    segments = t.json("inertia.json")["segments"]
    t.check(len(segments) == 17 and abs(sum(s["mass"] for s in segments) - 60) < 0.01, f"inertia: {len(segments)} segments, {sum(s['mass'] for s in segments)} kg")
    t.check(len(t.bytes("inertia.csv").splitlines()) == 18, "inertia.csv has other rows")
    walk = t.data("motions", "walk.bvh")
    t.run(0, "dynamics", "anna-anatomy.glb", walk, "-o", "forces.csv", "-o", "forces.sto", "--html", "forces.html", "--report", "forces.json")
    found = t.json("forces.json")["dynamics"]
    t.check(found["cutoff"] == 6 and abs(found["mean_vertical"] - 1) < 0.05 and found["residual_force_rms"] < 0.08 and found["residual_moment_rms"] < 0.02, f"dynamics of a walk: {found}")
    t.check(b"knee_l_flexion_moment" in t.bytes("forces.sto") and b"<svg" in t.bytes("forces.html"), "dynamics writes no moments or curves")
    t.run(0, "dynamics", "anna-anatomy.glb", walk, "-o", "free.csv", "--no-ground", "--cutoff", "10", "--report", "free.json")
    found = t.json("free.json")["dynamics"]
    t.check(found["cutoff"] == 10 and found["peak_vertical"] == 0 and found["residual_force_rms"] > 0.9, f"dynamics without a ground: {found}")
    t.run(0, "dynamics", "anna-anatomy.glb", "bent.bvh", "-o", "bent.mot", "--map", "map.txt", "--up", "y", "--motion-fps", 30, "--limits", "keep", "--no-apart", "--no-plant")
    t.run(0, "dynamics", "anna-anatomy.glb", "walk.bvh", "-o", "planted.mot", "--plant")
    t.run(0, "dynamics", "anna-anatomy.glb", "person_01.amc", "-o", "amc.mot", "--skeleton", "person.asf", "--filter", "smooth=20ms")
    t.run(0, "dynamics", "anna-anatomy.glb", "walk.glb", "--take", "motion", "-o", "take.mot")
    t.run(0, "dynamics", "anna-anatomy.glb", "walk.bvh", "--activations", "work.sto", "--muscles", "soleus,vastus_*", "--html", "work.html", "--report", "work.json")
    found = t.json("work.json")["activation"]
    t.check(found["samples"] > 2 and found["joints"]["knee_l"]["moment"] > 0, f"--activations: {found}")
    t.check(b"soleus_l" in t.bytes("work.sto") and b"vastus_*" in t.bytes("work.html"), "--activations writes no muscle, or --muscles draws none")
    t.says(t.run(2, "dynamics", "anna-anatomy.glb", "walk.bvh", "-o", "no.sto", "--muscles", "solaeus"), "soleus")
    # An imported anatomy need not have all muscles that are drawn when none is named.
    bones = t.run(0, "list", "bones", "anna-anatomy.glb", "--names").stdout.split()
    write_part(t, "anna-anatomy.glb", "few-muscles.glb", ("soleus_l", "soleus_r"), bones)
    t.run(0, "dynamics", "few-muscles.glb", "walk.bvh", "--activations", "few.sto", "--html", "few.html")
    t.check(b"soleus" in t.bytes("few.html") and b"psoas" not in t.bytes("few.html"), "the muscles that there are")
    t.says(t.run(2, "dynamics", "anna-anatomy.glb", walk), "nothing to write")
    t.run(2, "dynamics", "anna-anatomy.glb", walk, "-o", "forces.xyz")
    t.run(2, "inertia", "anna-anatomy.glb", "-o", "inertia.txt")


def pictures(t):
    def render(*words, codes=0):
        return t.run(codes, "render", "some.glb", *words)
    render("walk.bvh", "-o", "film.mp4", "--size", "160x90", "--fps", 4, "--layers", "muscles,bones", "--camera", "left", "--colour-map", "--report", "film.json")
    t.there("film.mp4")
    t.check(t.json("film.json")["film"]["frames"] >= 1, "--fps")
    png = lambda name: t.bytes(name)  # noqa: E731
    base = ["--size", "96x80", "--fps", 1]
    render("walk.bvh", "-o", "a/%02d.png", *base)
    t.check(struct.unpack(">II", png("a/01.png")[16:24]) == (96, 80), "--size")
    for name, words in (("skin", ["--layers", "skin"]), ("beside", ["--beside"]), ("colours", ["--colour-map"]), ("lengths", ["--colour", "length"]),
                        ("efforts", ["--activation", "auto", "--colour", "activation"]), ("top", ["--camera", "top"]),
                        ("dissolved", ["--dissolve", "0,0.01", "--layers", "skin,muscles"]), ("lbs", ["--skin", "lbs", "--layers", "skin"])):
        render("walk.bvh", "-o", f"{name}/%02d.png", *base, *words)
        t.check(png(f"{name}/01.png") != png("a/01.png"), f"render {' '.join(words)} changes nothing")
    t.check(png("colours/01.png") == png("lengths/01.png"), "--colour-map is not --colour length")
    t.says(render("walk.bvh", "-o", "no/%02d.png", *base, "--colour", "activation", codes=2), "--activation auto")
    large = ["--size", "640x360", "--fps", 1, "--layers", "muscles"]
    render("walk.bvh", "-o", "legend/%02d.png", *large)
    render("walk.bvh", "-o", "bare/%02d.png", *large, "--no-legend")
    t.check(png("legend/01.png") != png("bare/01.png"), "--no-legend")
    render("walk.bvh", "-o", "all/%02d.png", *base, "--weights", "painted.csv", "--map", "map.txt", "--up", "y", "--motion-fps", 30, "--limits", "keep", "--no-apart", "--no-plant")
    render("jump.bvh", "-o", "loose/%02d.png", *base, "--plant", "--dynamics", "--activation", "auto")
    t.there("loose/01.png")
    still = lambda name, *words: render("-o", f"{name}.png", "--size", "160x120", *words)  # noqa: E731
    still("rest")
    for name, words in (("squat", ["--pose", "squat"]), ("torn", ["--pose", "squat", "--muscles", "lines", "--layers", "muscles"]), ("mapped", ["--pose", "squat", "--layers", "muscles"]), ("white", ["--background", "white"]), ("knee", ["--look-at", "knee_l"]), ("hidden", ["--hide", "thigh", "--layers", "muscles"]),
                        ("only", ["--only", "femur_*", "--layers", "bones"]), ("slice", ["--section", "hip_l-knee_l:50%"])):
        still(name, *words)
        t.check(png(f"{name}.png") != png("rest.png"), f"render {' '.join(words)} changes nothing")
    t.check(png("mapped.png") != png("torn.png"), "render --muscles lines changes nothing")
    still("near", "--look-at", "knee_l", "--zoom", 3)
    still("nearer", "--look-at", "knee_l", "--distance", 0.3)
    t.check(len({png(f"{name}.png") for name in ("knee", "near", "nearer")}) == 3, "--zoom, --distance")
    light = {}
    for side, camera in (("before", "0,5"), ("behind", "180,5")):
        still(side, "--background", "white", "--layers", "skin", f"--camera={camera}")
        width, rows = png_rows(png(f"{side}.png"))
        dark = [sum(row[3 * x:3 * x + 3]) for row in rows for x in range(width) if row[3 * x + 2] < 180]
        light[side] = sum(dark) / max(1, len(dark))
    t.check(light["behind"] > 0.85 * light["before"], f"a still from behind lies in the dark: {light}")
    still("own", "--pose", "bent", "--poses", t.write("own.csv", "name,label,view,angles\nbent,bent,front,elbow 90\n"))
    still("shares", "--pose", "arm_bent", "--poses", t.write("shares.csv", "pose,joint,flexion,abduction,rotation\narm_bent,elbow,0.6,0,0\n"))
    render("walk.bvh", "-o", "moment.png", "--at", 0.1, "--size", "160x120")
    render("walk.bvh", "-o", "part/%02d.png", "--from", 0.05, "--to", 0.1, "--fps", 60, "--size", "96x80")
    t.check(os.listdir(t.path("part")) and "01.png" in os.listdir(t.path("part")), "--from, --to")
    render("walk.bvh", "-o", "frames/%02d.png", "--frames", "2-6x2", "--size", "96x80")
    t.check(sorted(os.listdir(t.path("frames"))) == ["02.png", "04.png", "06.png"], f"--frames 2-6x2: {os.listdir(t.path('frames'))}")
    done = t.run((0, 8), "posebook", "some.glb", "ben-anatomy.glb", "-o", "poses", "--poses", t.write("poses.csv", "name,label,view,angles\nbent,bent,front,elbow 90\n"),
                 "--methods", "ecorche,lbs", "--cell", "100x120")
    t.there("poses/ecorche.png")
    t.check(not os.path.exists(t.path("poses/dqs.png")) and "lbs" in done.stdout, "--methods")
    t.run((0, 8), "posebook", "some.glb", "-o", "figures", "--poses", "poses.csv", "--methods", "ecorche", "--no-pictures")
    t.there("figures/figures.csv")
    t.absent("figures/ecorche.png")


def lifts(t):
    t.run((0, 8), "lie", "anna-anatomy.glb", "-o", "lies.png", "--size", "320x180", "--report", "lies.json")
    lies = t.json("lies.json")["lie"]
    t.check(abs(lies["weight"] - 60 * 9.81) < 4 and abs(lies["contact_force"] - lies["weight"]) < 0.01 * lies["weight"], f"lie: {lies['contact_force']} N of {lies['weight']}")
    t.run((0, 8), "lie", "anna-anatomy.glb", "-o", "hard.png", "--foam", 400, "--foam-thickness", 0.05, "--tissue", 80, "--scale", 30, "--size", "320x180", "--report", "hard.json")
    t.check(t.json("hard.json")["lie"]["peak_kpa"] > 1.2 * lies["peak_kpa"], "--foam, --foam-thickness, --tissue of lie")
    t.check(t.bytes("hard.png") != t.bytes("lies.png"), "--scale of lie")
    t.run((0, 8), "sit", "anna-anatomy.glb", "-o", "sits.png", "--size", "320x180", "--report", "sits.json")
    sits = t.json("sits.json")["sit"]
    t.check(abs(sits["contact_force"] - sits["weight"]) < 0.01 * sits["weight"] and sits["peak_to_ischium_mm"] < 70, f"sit: {sits['contact_force']} N of {sits['weight']}, peak {sits['peak_to_ischium_mm']} mm from the ischium")
    t.check(0.7 < sits["seat"]["lift"] / sits["weight"] < 0.98 and sits["back"]["force"] > 0.03 * sits["weight"] and sits["floor"]["lift"] > 0, "seat, back, floor of sit")
    t.run((0, 8), "sit", "anna-anatomy.glb", "-o", "stool.mp4", "--no-back", "--foam", 10000, "--foam-thickness", 0.02, "--tissue", 80, "--step", 0.02, "--fps", 2, "--scale", 30, "--size", "160x90", "--report", "stool.json")
    stool = t.json("stool.json")["sit"]
    t.check("back" not in stool and stool["seat"]["peak_kpa"] > 1.1 * sits["seat"]["peak_kpa"], "--no-back, --foam, --foam-thickness, --tissue of sit")
    t.there("stool.mp4")
    t.run((0, 8), "sit", "anna-anatomy.glb", "-o", "leans.png", "--recline", 25, "--no-floor", "--size", "320x180", "--report", "leans.json")
    leans = t.json("leans.json")["sit"]
    t.check("floor" not in leans and leans["back"]["force"] > 1.3 * sits["back"]["force"], "--recline, --no-floor of sit")
    coarse = ("--spacing", 0.1, "--size", "320x180")
    t.run((0, 8), "lift", "anna-anatomy.glb", "-o", "lift.mp4", "--fps", 5, "--table", "lift.csv", "--report", "lift.json", *coarse)
    lift = t.json("lift.json")["lift"]
    t.check(abs(lift["contact_force"] - lift["weight"]) < 0.01 * lift["weight"] and lift["mattress_force"] == 0, f"lift: {lift['contact_force']} N of {lift['weight']}")
    t.check(abs(lift["strap_force"] - lift["weight"] - lift["sheet_weight"]) < 0.01 * lift["weight"], f"straps: {lift['strap_force']} N")
    t.check(lift["limit_excess_deg"] < 0.5, f"limits of joints: {lift['limit_excess_deg']}")
    t.there("lift.mp4")
    rows = t.bytes("lift.csv").decode().splitlines()
    t.check(rows[0].startswith("time,") and abs(len(rows) - 1 - 5 * lift["seconds"]) < 3, f"--table, --fps: {len(rows)} lines")
    t.run((0, 8), "lift", "anna-anatomy.glb", "--table", "six.csv", "--straps", 6, "--step", 0.02, "--tissue", 80, "--report", "six.json", "--spacing", 0.1)
    six = t.json("six.json")["lift"]
    t.check(six["nodes"] == lift["nodes"] and six["peak_kpa"] != lift["peak_kpa"], "--straps, --step, --tissue of lift")
    t.write("cloth.obj", sheet_of_cloth(10, 14, 1.1, 1.35))
    t.run((0, 8), "lift", "anna-anatomy.glb", "-o", "still.png", "--sling", "cloth.obj", "--scale", 20, "--size", "320x180", "--report", "own.json")
    t.there("still.png")
    t.check(t.json("own.json")["lift"]["nodes"] == 11 * 15, "--sling")


def falls(t):
    t.run(0, "fall", "anna-anatomy.glb", "-o", "falls.bvh", "-o", "falls.fbx", "--push", "0.3,0,1", "--height", 0.3, "--from", "t_pose", "--seconds", 8, "--fps", 30, "--report", "falls.json")
    falls = t.json("falls.json")["fall"]
    t.check(t.bytes("falls.bvh").count(b"\n") > 121 and 0.2 < falls["touch"] < 0.3, f"--seconds, --fps, --height of fall: {falls['touch']}")
    t.check(abs(falls["end_force"] - falls["weight"]) < 0.02 * falls["weight"] and falls["end_speed"] < 0.02, f"fall: {falls['end_force']} N of {falls['weight']}, {falls['end_speed']} m/s")
    t.check(falls["deepest"] < 0.02 and falls["overlap"] < 0.02 and falls["limit_excess_deg"] < 5, f"fall: {falls}")
    t.run(0, "fall", "anna-anatomy.glb", "-o", "stiff.glb", "-o", "stiff.png", "--tone", 1, "--seconds", 0.3, "--size", "96x64", "--camera", "left", "--report", "stiff.json")
    t.run(0, "fall", "anna-anatomy.glb", "-o", "going/%02d.png", "--from", "walk.bvh", "--at", 0.1, "--seconds", 0.2, "--fps", 10, "--size", "96x64")
    t.check(len(os.listdir(t.path("going"))) == 4, f"--from a motion, --at: {os.listdir(t.path('going'))}")
    t.says(t.run(2, "fall", "anna-anatomy.glb", "-o", "no.bvh", "--from", "t_pos"), "t_pose")
    t.says(t.run(2, "fall", "anna-anatomy.glb", "-o", "no.bvh", "--at", 1), "--from")
    t.says(t.run(2, "fall", "anna-anatomy.glb", "-o", "no.bvh", "--from", "walk.bvh", "--at", 9), "ends after")
    t.says(t.run(2, "fall", "anna-anatomy.glb", "-o", "no.bvh", "--size", "wide"), "1280x720")
    t.run((0, 8), "animate", "anna-anatomy.glb", "walk.bvh", "-o", "limp.mot", "--passive", "shoulder_l", "--passive", "c7", "--report", "limp.json")
    limp = t.json("limp.json")["limp"]
    t.check(limp["joints"] == 12 and limp["limit_excess_deg"] < 5, f"--passive: {limp}")
    t.says(t.run(2, "animate", "anna-anatomy.glb", "walk.bvh", "-o", "no.mot", "--passive", "pelvis"), "name a joint of a limb")


def checks(t):
    t.write("limits.csv", "pose,joint,flexion,abduction,rotation\nsitting,hip,0.75,0.2,0\n")
    done = t.run((0, 8), "check", "anna-anatomy.glb", "-o", "check", "--poses", "limits.csv", "--no-sweeps", "--no-pictures")
    t.there("check/check.html")
    t.there("check/check.csv")
    t.check(b"<img" not in t.bytes("check/check.html") and t.json("check/check.json")["exit_code"] == done.returncode, "--no-pictures, check.json")
    t.run((0, 8), "check", "some.glb", "-o", "angles", "--poses", t.write("angles.csv", "name,label,view,angles\nbent,bent,front,elbow 90\n"), "--no-sweeps", "--no-pictures")
    t.check("bent" in t.json("angles/check.json")["check"]["pose"], "check --poses with angles")
    t.run((0, 8), "check", "anna-anatomy.glb", "-o", "lines", "--poses", "limits.csv", "--no-sweeps", "--no-pictures", "--muscles", "lines")
    by_lines, by_map = (t.json(f"{folder}/check.json")["check"]["pose"]["sitting"] for folder in ("lines", "check"))
    t.check(by_map["daylight"] < 0.6 * by_lines["daylight"] and by_map["creased_share"] < 0.3 * by_lines["creased_share"], f"--muscles lines: {by_lines}, {by_map}")
    t.says(t.run(2, "check", "bodies", "--muscles", "lines"), "--muscles")
    done = t.run((0, 8), "check", "bodies", "--body", "thin_male", "-o", "bodies")
    t.check("thin_male" in done.stdout and "heavy_male" not in done.stdout, "--body")
    t.says(t.run(2, "check", "bodies", "--body", "thin_mal"), "did you mean thin_male")
    t.says(t.run(2, "check", "anna-anatomy.glb", "--body", "thin_male"), "check bodies")


def templates(t):
    info = t.json(t.write("info.json", t.run(0, "template", "info", "--json").stdout))
    t.check(info["bones"] == 178 and info["muscles"] == 508, "template info")
    t.run((0, 8), "template", "check", "--json")
    t.run(0, "template", "import", "anna.osim", "-o", "imported.glb", "--stress", 60, "--our-bones", "--report", "import.json")
    t.run(0, "template", "import", "anna.osim", "-o", "imported-30.glb", "--stress", 30, "--folder", ".", "--report", "import-30.json")
    ratio = t.json("import-30.json")["muscle_volume"] / t.json("import.json")["muscle_volume"]
    t.check(abs(ratio - 2) < 0.1, f"--stress: half the stress makes twice the volume, not {ratio:.2f}")
    t.check(t.json("import-30.json")["import"]["meshes"] > 0 and t.json("import.json")["import"]["meshes"] == 0, "--our-bones")
    t.run(0, "template", "import", t.write("left.osim", one_side(t.bytes("anna.osim").decode())), "-o", "mirrored.glb", "--mirror", "--our-bones", "--report", "mirror.json")
    t.run(0, "template", "import", "left.osim", "-o", "left.glb", "--our-bones", "--report", "left.json")
    t.check(t.json("mirror.json")["muscles"] > t.json("left.json")["muscles"], "--mirror")
    t.run(0, "template", "info", "imported.glb")
    t.run((0, 8), "template", "check", "imported.glb")
    t.run((0, 8), "fit", "anna.glb", "--template", "imported.glb", "--method", "paper", "-o", "anna-imported.glb")
    t.run(0, "template", "sweep", "--step", 40, "-o", "coarse.csv")
    t.run(0, "template", "sweep", "--step", 20, "-o", "sweep.csv")
    t.check(1.5 < len(t.bytes("sweep.csv")) / len(t.bytes("coarse.csv")) < 3, "--step")
    t.write("spindle.obj", spindle())
    done = t.run(0, "template", "resample", "spindle.obj", "--origin", "0,0,0", "--insertion", "0,20,0", "--unit", "cm", "--control-points", 2, "--slices", 9, "--rays", 24,
                 "-o", "loft.ply", "--json")
    found = json.loads(done.stdout)
    t.check(found["slices"] == 9 and abs(found["action_line_length"] - 0.2) < 0.01 and abs(found["volume_error"]) < 0.1, f"resample: {found}")
    t.check(t.bytes("loft.ply")[:3] == b"ply", "-o of resample")


def studio(t):
    names = [action["name"] for action in json.loads(t.run(0, "studio", "--list-actions", "--json").stdout)]
    listed = t.run(0, "studio", "--list-actions").stdout
    t.check(len(names) > 40 and all(f"\n  {name} " in listed for name in names), f"--list-actions: {names}")
    shutil.copytree(os.path.join(t.source, "docs", "studio"), t.path("studio"))
    plate = t.write("studio/plate.txt", t.bytes("studio/plate.txt").decode().replace("900x700", "320x240") + "save arm-project\nset_layer 0.9\nwrite_character arm.glb\n")
    done = t.run((0, 8), "studio", "anna.glb", "--script", plate, "-o", "arm-again.glb", "--report", "studio.json")
    t.check("my_biceps_l: " in done.stdout and "moment arm" in done.stdout, f"report: {done.stdout}")
    found = t.json("studio.json")["muscles"]["my_biceps_l"]
    t.check(found["length"] < found["rest_length"] - 0.01 and 0.01 < found["moment_arm"] < 0.07, f"a bent biceps: {found}")
    t.there("studio.png")
    t.check(t.bytes("arm.glb") == t.bytes("arm-again.glb"), "write_character and -o")
    t.check(b"my_biceps_r" in t.bytes("arm.glb") and b"biceps_brachii_long_l" not in t.bytes("arm.glb"), "the character has the muscle in place of the old one")
    more = t.write("more.txt", "undo 2\n")
    t.run(0, "studio", "--project", "arm-project", "--script", more, "--report", "more.json")
    t.check(t.json("more.json")["recovered"] == 1, "what was not saved is done again")
    t.run(0, "studio", "arm-project", "--discard", "--script", t.write("last.txt", "pose rest\nsave\n"), "--report", "more.json")
    t.check(t.bytes("arm-project/journal.txt") == b"" and b"my_biceps" in t.bytes("arm-project/project.txt"), "--discard and save")
    t.says(t.run(3, "studio", "--script", t.write("wrong.txt", "pick soleus\nmove_pont point=1 by=0,0,1\n")), "wrong.txt:2: 'move_pont' is no action; did you mean move_point")
    curves = t.write("curves.txt", f"play_motion {t.data('motions', 'walk.bvh')}\npick rectus_femoris\nturn_joint hip flexion=20\ncurves curves.csv joint=knee\nshow_moment 0.5s\nreport joint=knee\n")
    t.run(0, "studio", "--script", curves, "--report", "curves.json")
    rows = [[float(value) for value in line.split(",")] for line in t.bytes("curves.csv").decode().splitlines()[1:]]
    one, now = t.json("curves.json")["muscles"]["rectus_femoris_l"], min(rows, key=lambda row: abs(row[0] - 0.5))
    t.check(abs(now[1] - 1e3 * one["length"]) < 0.01 and abs(now[3] - 1e3 * one["moment_arm"]) < 0.01, f"the curves' row is what is reported at that moment: {now}, {one}")
    t.check(all(abs((b[1] - a[1]) / (b[0] - a[0]) - at[2]) < 2 for a, at, b in zip(rows, rows[1:], rows[2:])) and rows[-1][0] > 1, "speeds are those of the lengths")
    t.says(t.run(3, "studio", "--script", t.write("no-motion.txt", "pick soleus\ncurves none.csv\n")), "play_motion FILE takes one")
    t.says(t.run(2, "studio", "--script", more, "--frames", 2), "--frames belong to the window")
    studio_outputs(t)
    unsaved_sessions(t)
    studio_window(t)


def studio_outputs(t):
    """Templates, models, plates, films and comparisons by script."""
    script = t.write("outputs.txt", "set_muscle soleus volume=520ml\nwrite_template own-template.glb\nwrite_model own.xml meshes=no ground=yes\ncheck_bones\n")
    done = t.run(0, "studio", "--script", script, "--report", "outputs.json")
    t.check("palpable points" in done.stdout and t.json("outputs.json")["studio"]["points_off"] >= 0, f"check_bones: {done.stdout}")
    t.check(b"soleus_l" in t.bytes("own.xml") and b"<mesh " not in t.bytes("own.xml"), "write_model")
    t.run((0, 8), "fit", "anna.glb", "--template", "own-template.glb", "-o", "by-template.glb", "--report", "by-template.json")
    t.run((0, 8), "studio", "anna.glb", "--script", t.write("same.txt", "set_muscle soleus volume=520ml\n"), "-o", "by-studio.glb", "--report", "by-studio.json")
    one, other = (t.json(f"by-{name}.json")["fit"]["muscle_volume"] for name in ("template", "studio"))
    t.check(abs(one / other - 1) < 0.01, f"a template fits as its document does: {one}, {other}")
    t.says(t.run(4, "studio", "--script", t.write("moved.txt", "move_joint elbow by=0,2,0\nwrite_template moved.glb\n")), "a template does not carry")
    pictures = ["turn_joint elbow flexion=90", "render ours.png size=240x160", "compare linear_blend", "render halves.png size=240x160", "compare linear_blend how=wiped share=0.25", "render wiped.png size=240x160",
                "compare none", "render plain.png size=300x400 camera=front layers=muscles,bones", "render plate.png size=300x400 camera=front layers=muscles,bones labels=function:elbow_flexion",
                "film around/%02d.png size=90x60 fps=4 \"shots=around 1s; front@elbow_l 0.5s\""]
    t.run(0, "studio", "anna.glb", "--script", t.write("pictures.txt", "\n".join(pictures) + "\n"))
    wiped, ours = png_rows(t.bytes("wiped.png"))[1], png_rows(t.bytes("ours.png"))[1]
    t.check([row[:3 * 52] for row in wiped[24:]] == [row[:3 * 52] for row in ours[24:]] and wiped != ours and t.bytes("halves.png") != t.bytes("wiped.png"), "left of the line is the picture without a comparison")
    plain, plate = png_rows(t.bytes("plain.png"))[1], png_rows(t.bytes("plate.png"))[1]
    t.check(sum(a != b for a, b in zip(plain, plate)) > 20, "labels are written")
    t.check(sorted(os.listdir(t.path("around"))) == ["01.png", "02.png", "03.png", "04.png", "05.png", "06.png"] and len({t.bytes(f"around/{name}") for name in os.listdir(t.path("around"))}) == 5, "a turn of four pictures and a close shot of two that stand")
    t.says(t.run(3, "studio", "--script", t.write("no-shot.txt", "film a.mp4 \"shots=front 0-1\"\n")), "there is no motion")


def left_session(t, name):
    folder = f"state/ecorche/studio/{name}"
    os.makedirs(t.path(folder))
    t.write(f"{folder}/journal.txt", "move_point soleus point=2 by=0,0,1\nset_layer 0.9\n")
    os.utime(t.path(f"{folder}/journal.txt"), (0, ord(name[-1])))
    return t.path(folder)


def unsaved_sessions(t):
    """What a session without a project has left is told of, and taken up or removed."""
    state = {"XDG_STATE_HOME": t.path("state")}
    first, second = left_session(t, "20260101-000000-aaaaaa"), left_session(t, "20260101-000000-bbbbbb")
    save = t.write("save-left.txt", "save left-project\n")
    t.says(t.run(0, "studio", "--script", t.write("nothing.txt", ""), env=state), "2 actions): --recover 20260101-000000-aaaaaa goes on")
    t.says(t.run(2, "studio", "anna.glb", "--recover", "last", "--script", save, env=state), "leave START and --project away")
    t.says(t.run(3, "studio", "--recover", "20250101", "--script", save, env=state), "there are 20260101-000000-bbbbbb, 20260101-000000-aaaaaa")
    t.run(0, "studio", "--recover", "20260101-000000-aaaaaa", "--script", save, "--report", "left.json", env=state)
    t.check(t.json("left.json")["recovered"] == 2 and b"set_layer" in t.bytes("left-project/project.txt"), "--recover")
    t.check(not os.path.exists(first) and os.path.exists(second), "what is saved is left no more")
    t.run(0, "studio", "--forget", "all", env=state)
    t.check(not os.path.exists(second), "--forget")


def studio_window(t):
    """What is done by hand is a script: both give the same project."""
    if not shutil.which("xvfb-run"):
        print("skipped: xvfb-run is not installed")
        t.used.setdefault("studio", set()).update(["--input", "--screenshot", "--frames", "--size"])
        return
    t.run(0, "studio", "--input", "studio/insertion.txt", "--size", "1280x720", "--report", "window.json", under=VIEW)
    left = left_session(t, "20260101-000000-cccccc")
    go_on = t.write("go-on.txt", "frames 3\nclick go on with it\nframes 3\nclick save\nclick folder\ntype gone-on\nkey Enter\nframes 3\n")
    t.run(0, "studio", "--input", go_on, under=VIEW, env={"XDG_STATE_HOME": t.path("state")})
    t.check(b"soleus" in t.bytes("gone-on/project.txt") and not os.path.exists(left), "a session that was left is gone on with in the window")
    t.check(b"project /" in t.bytes("state/ecorche/studio/recent.txt"), "a project that was saved is among the recent ones")
    again = t.write("again.txt", "frames 3\nclick project:gone-on\nframes 3\nclick find\ntype soleus\nframes 3\nclick list:soleus\nwait\ndrag point:1:6 20,-20\nwait\nkey Ctrl + S\nframes 3\n")
    before = t.bytes("gone-on/muscles/soleus.txt")
    t.run(0, "studio", "--input", again, "--size", "1280x720", under=VIEW, env={"XDG_STATE_HOME": t.path("state")})
    t.check(t.bytes("gone-on/muscles/soleus.txt") != before and t.bytes("gone-on/journal.txt") == b"", "a recent project is gone on with in the window, and saved")
    t.run(0, "studio", "--project", "by-script", "--script", "studio-0001.txt", "--script", t.write("keep.txt", "save\n"))
    lines = t.bytes("studio-0001.txt").decode().splitlines()
    t.check(len(lines) == 2 and lines[0] == "pick muscle=soleus" and lines[1].startswith("move_point muscle=soleus point=6 by="), f"one line a drag, none for what was taken back: {lines}")
    t.check(t.bytes("by-hand/muscles/soleus.txt") == t.bytes("by-script/muscles/soleus.txt"), "the same muscle by hand and by script")
    t.check(t.bytes("by-hand/project.txt") == t.bytes("by-script/project.txt"), "the same project by hand and by script")
    t.check(len(t.bytes("by-hand.png")) > 50000, "a picture of the window")
    found = t.json("window.json")["window"]
    t.check(found["editing"]["frames"] > 5 and found["undoing"]["frames"] == 1, f"frames of the window: {found}")
    t.run(0, "studio", "by-hand", t.path("walk.bvh"), "--frames", 2, "--screenshot", "walks.png", "--discard", under=VIEW)
    if "ECORCHE_THOROUGH" not in os.environ:
        return
    compare = t.write("compare.txt", "wait\nclick find\ntype soleus\nframes 3\nclick list:soleus\nwait\nkey 9\nkey 9\nclick section:View\nclick tab:Script\nframes 2\npicture before.png\ndrag point:1:6 40,-40\nwait\npicture after.png\nkey C\nwait\npicture again.png\nkey C\nwait\npicture after-again.png\n")
    t.run(0, "studio", "--input", compare, "--size", "1280x720", under=VIEW)
    figure = {name: [bytes(row[3 * 330:3 * 840]) for row in png_rows(t.bytes(f"{name}.png"))[1][150:700]] for name in ("before", "after", "again", "after-again")}
    differ = lambda a, b: sum(x != y for x, y in zip(figure[a], figure[b]))  # noqa: E731
    t.check(differ("before", "after") > 20 and differ("before", "again") == 0 and differ("after", "after-again") == 0, "as it was saved, and as it is")
    t.run(0, "studio", "--input", "studio/new-muscle.txt", "--size", "1280x720", under=VIEW)
    lines = t.bytes("studio-0002.txt").decode().splitlines()
    t.check(len(lines) == 3 and lines[0].startswith("new_muscle name=own_muscle_1 from=humerus@") and " to=radius@" in lines[0] and lines[1] == "pick muscle=own_muscle_1" and re.search(r"point=2 to=(ulna|radius)@", lines[2]), f"a muscle drawn by clicks: {lines}")
    t.run(0, "studio", "--project", "drawn-project", "--script", "studio-0002.txt")
    t.run(0, "studio", "drawn-project", "--script", t.write("keep-drawn.txt", "save\n"), "--report", "drawn.json")
    t.check(t.json("drawn.json")["recovered"] == 3, "a project that was never saved opens by its folder")
    t.says(t.run(3, "studio", "--input", t.write("no-such.txt", "click nothing\n"), under=VIEW), "no-such.txt:1: 'nothing': nothing of that name is shown")


def lists(t):
    counts = {"muscles": 508, "joints": 90, "bones": 178, "measures": 60, "landmarks": 40, "sizes": 10, "poses": 60, "motions": 2}
    for what, least in counts.items():
        names = t.run(0, "list", what, "--names").stdout.split()
        t.check(len(names) >= least, f"list {what}: {len(names)}")
        t.check(len(json.loads(t.run(0, "list", what, "--json").stdout)) == len(names), f"list {what} --json")
    t.check("biceps_brachii" in t.run(0, "list", "muscles", "anna-anatomy.glb").stdout, "list of a character")
    t.says(t.run(2, "list", "muscels"), "muscles")
    man = t.run(0, "man").stdout
    for verb in t.verbs:
        t.check(f'"ecorche {verb}"' in man.replace("\\-", "-"), f"man has no {verb}")
    bash = t.run(0, "completion", "bash").stdout
    t.write("complete.sh", bash + '\nCOMP_WORDS=(ecorche "$@"); COMP_CWORD=$#; _ecorche; printf "%s\\n" "${COMPREPLY[@]}"\n')
    for words, wanted in ((["an"], "animate"), (["body", "ne"], "new"), (["fit", "--interi"], "--interior"), (["fit", "x.glb", "--method", "pa"], "paper"),
                          (["body", "new", "--measure", "waist_gi"], "waist_girth"), (["list", "musc"], "muscles"), (["help", "po"], "posebook")):
        env = {**os.environ, "PATH": os.path.dirname(t.program) + ":" + os.environ["PATH"]}
        found = subprocess.run(["bash", t.path("complete.sh"), *words], capture_output=True, text=True, env=env).stdout.split()
        t.check(wanted in found, f"completion of {' '.join(words)}: {found[:5]}")
    zsh = t.run(0, "completion", "zsh").stdout
    t.check(zsh.startswith("#compdef ecorche"), "completion zsh")
    if shutil.which("zsh"):
        t.write("_ecorche", zsh)
        done = subprocess.run(["zsh", "-n", t.path("_ecorche")], capture_output=True, text=True)
        t.check(done.returncode == 0, f"zsh does not read its completion: {done.stderr}")


def words(t):
    """What is mistyped is answered with what it may have been."""
    for line, hint in ((["ft", "anna.glb"], "fit"), (["body", "nwe"], "new"), (["fit", "anna.glb", "--metod", "paper", "-o", "x.glb"], "--method"), (["--verion"], "--version"),
                       (["-v"], "name the verb"), (["help", "fitt"], "fit"), (["body"], "measure"), ([], "animate"), (["animate", "--bogus", "--wors"], "--bogus"),
                       (["fit", "anna.glb", "-o", "x.glb", "--method", "papr"], "paper"), (["body", "new", "--sex", "male", "--measure", "waist_grith=80cm", "-o", "x.glb"], "waist_girth"),
                       (["body", "new", "--sex", "male", "--size", "LX", "-o", "x.glb"], "XL")):
        t.says(t.run(2, *line), hint)
    for line in (["help", "fit"], ["help", "body", "new"], ["help"], ["--version"], ["-V"]):
        t.run(0, *line)
    t.check("--method" in t.run(0, "help", "fit").stdout, "help fit")
    # It is said before the character is compiled, which would find the broken weights.
    t.write("broken-weights.csv", "vertex,joint,weight\n1,pelvis,heavy\n")
    for line, hint in ((["render", "-o", "x.png", "--look-at", "kne_l"], "knee_l"), (["render", "-o", "x.png", "--pose", "sqat"], "squat"), (["render", "-o", "x.png", "--section", "hip_l-kne_l:50%"], "knee_l"),
                       (["render", "-o", "x.png", "--only", "femr_l"], "femur_l"), (["render", "-o", "x.png", "--camera", "lft"], "left"), (["animate", "walk.bvh", "-o", "x.pc2", "--passive", "sholder_l"], "shoulder_l"),
                       (["animate", "walk.bvh", "--table", "moment-arms:kne_l_flexion=x.csv"], "knee_l_flexion"), (["weights", "--joint", "kne_l", "--picture", "x.png"], "knee_l")):
        t.says(t.run(2, line[0], "anna-anatomy.glb", *line[1:], "--weights", "broken-weights.csv"), hint)
    t.says(t.run(3, "bake", "anna-anatomy.glb", "walk.bhv", "-o", "x.glb", "--weights", "broken-weights.csv"), "walk.bhv")
    wrong = t.write("wrong.csv", "time,muscle,value\n0,biceps_brachii_long_l,strong\n")
    for line in (["animate", "walk.bvh", "-o", "x.pc2"], ["render", "walk.bvh", "-o", "x.mp4"]):
        t.says(t.run(3, line[0], "anna-anatomy.glb", *line[1:], "--activation", wrong, "--weights", "broken-weights.csv"), "wrong.csv:2")
    t.says(t.run(2, "animate", "anna-anatomy.glb", "walk.bvh", "-o", "x.pc2", "--skin", "rubber", "--weights", "broken-weights.csv"), "deltamush")
    t.says(t.run(4, "animate", "anna.glb", t.data("motions", "walk.bvh"), "-o", "x.glb"), "ecorche fit")
    t.says(t.run(3, "animate", "anna-anatomy.glb", "walk.bhv", "-o", "x.glb"), "walk.bvh")
    t.absent("x.glb")


def window(t):
    if not shutil.which("xvfb-run"):
        print("skipped: xvfb-run is not installed")
        t.used.setdefault("view", set()).update(name for group in t.options_of("view") for name in group)
        return
    view = lambda *words, codes=0: t.run(codes, "view", *words, under=VIEW)  # noqa: E731
    view("some.glb", "person_01.amc", "--skeleton", "person.asf", "--filter", "mirror", "--from", "2f", "--to", "6f", "--frames", 2, "--screenshot", "amc-view.png")
    view("some.glb", "walk.trc", "--markers", "markers.csv", "--frames", 2, "--screenshot", "marked-view.png")
    view("own.glb", "own-walk.glb", "--take", "1", "--frames", 2, "--screenshot", "own-view.png")
    view("some.glb", "walk.bvh", "--frames", 3, "--screenshot", "a.png", "--pick", "0.5,0.5")
    t.check(t.bytes("a.png")[:4] == b"\x89PNG", "--screenshot")
    view("--sliders", "--sex", "female", "--measure", "stature=170cm", "--frames", 2, "-o", "edited.glb", codes=(0, 8))
    t.check(abs(measures(t, "edited.glb")["stature"] - 1.70) < 0.002, "--sliders --measure")
    view("some.glb", "jump.bvh", "--frames", 2, "--dynamics", "--definition", 0, "--map", "map.txt", "--up", "y", "--motion-fps", 30, "--limits", "keep", "--no-apart",
         "--no-plant")
    view("some.glb", "walk.bvh", "--frames", 2, "--plant")
    for name, words in (("back", ["--camera", "back"]), ("bones", ["--only", "femur_*,tibia_*"]), ("bare", ["--hide", "thigh"])):
        view("some.glb", "--frames", 2, "--screenshot", f"{name}.png", *words)
    t.check(len({t.bytes(f"{name}.png") for name in ("back", "bones", "bare")}) == 3, "--camera, --only, --hide")
    view("anna-anatomy.glb", "--sliders", "--template", "imported.glb", "--frames", 2)


def benches(t):
    out = t.run((0, 8), "bench", "--rounds", 3, "--muscles").stdout
    t.check("mu" in out, "bench --muscles")
    out = t.run(0, "bench", "--rounds", 3, "--motion", t.data("motions", "walk.bvh"), "--report", "pace.json").stdout
    t.check("frames/s of a core" in out and t.json("pace.json")["bench"]["retarget"]["frames_per_second"] > 0, "bench --motion")
    if not shutil.which("xvfb-run") or "ECORCHE_THOROUGH" not in os.environ:
        t.used.setdefault("bench", set()).add("--studio")
        return
    out = t.run(0, "bench", "--studio", "--report", "studio-bench.json", under=VIEW).stdout
    t.check("dragged till drawn" in out and t.json("studio-bench.json")["bench"]["studio_undo"]["ms"] > 0, "bench --studio")
    t.check(0 < t.json("studio-bench.json")["bench"]["studio_history"]["megabytes"] < 200, "the memory of 1,000 edits")


def demo(t):
    done = t.run((0, 8), "demo", "-o", "jump", "--size", "320x180", "--fps", 3, "--activation", "none", "--progress", "lines", timeout=1500)
    for name in ("long-jump.mp4", "athlete.glb", "long-jump.pc2", "report.html"):
        t.there("jump/" + name, 10000)
    t.check(t.json("jump/report.json")["exit_code"] == done.returncode, "report.json says how the run ended")


def common_options(t):
    t.run((0, 8), "fit", "anna.glb", "-o", "one.glb", "--threads", 1, "-q", "--report", "one.json")
    t.check(t.bytes("one.glb") == t.bytes("anna-anatomy.glb") and t.json("one.json")["threads"] == 1, "--threads")
    t.check(t.run((0, 8), "fit", "anna.glb", "-o", "one.glb", "--method", "paper", "-q").stderr == "", "-q")
    t.says(t.run((0, 8), "fit", "anna.glb", "-o", "one.glb", "--method", "paper", "-v"), "timings_ms.fit_bones")
    t.run((0, 8), "body", "population", "--count", 1, "--seed", 6, "--skins", "-o", "other")
    t.check(t.bytes("other/person-0001.glb") != t.bytes("drawn/person-0001.glb"), "--seed")
    t.run(2, "fit", "anna.glb", "-o", "no.glb", "--threads", -1)
    t.run(2, "fit", "anna.glb", "-o", "no.glb", "--seed", -1)
    t.says(t.run((0, 8), "animate", "some.glb", t.data("motions", "walk.bvh"), "-o", "lines.pc2", "--progress", "lines"), "frames: ")


def main(program, source):
    t = Runner(program, source)
    parts = [bodies, units, body_verbs, scans, strangers, fits, animations, forces, pictures, lifts, falls, checks, templates, studio, lists, words, window, common_options, benches, demo]
    chosen = sys.argv[3:]
    for part in parts:
        if chosen and part.__name__ not in chosen:
            continue
        if part is pictures:
            t.run((0, 8), "fit", "ben.glb", "--method", "ellipses", "-o", "ben-anatomy.glb")
        try:
            part(t)
        except Exception as error:  # noqa: BLE001  one part must not hide the others
            t.check(False, f"{part.__name__}: {type(error).__name__}: {error}")
        print(part.__name__, flush=True)
    if not chosen:
        t.check(not t.unused(), "no run has used: " + "; ".join(t.unused()))
    t.finish()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
