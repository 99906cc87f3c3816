"""Bad characters: rows 60, 61 and 63, and what belongs to them: joints, sections, bones and figures that no body has."""
import json
import math
import random
import struct

from files import glb


def character(t, row, name, change, codes=3, says=(), **options):
    path = t.bench.file(f"character_{name}.glb", t.changed_small(change))
    t.animate(row, name.replace("_", " "), character=path, codes=codes, says=says, names=path.name, **options)


def muscle(d, name="biceps_femoris_long_l"):
    return next(n for n in d["nodes"] if n["name"] == "muscle/" + name)["extras"]


def joint(d, name="knee_l"):
    return next(n for n in d["nodes"] if n["name"] == name)["extras"]


def row_60(t):
    """Anatomy that is none: paths of one point, joints, bones and wraps that are not there, ends in one place, sections of nothing."""
    def strip(change):
        return lambda d: change(muscle(d)["strips"][0])

    def set_all(s, key, column, value):
        for entry in s[key]:
            entry[column] = value

    cases = [("one_point", strip(lambda s: s.update(path=s["path"][:1])), "two"), ("no_path", strip(lambda s: s.update(path=[])), ()),
             ("many_points", strip(lambda s: s.update(path=[[p[0], p[1] + i * 1e-3, *p[2:]] for i in range(500) for p in s["path"][:1]])), "limit"),
             ("joint_gone", strip(lambda s: set_all(s, "path", 3, 9999)), "joint 9999"), ("joint_minus", strip(lambda s: set_all(s, "path", 3, -1)), "joint -1"),
             ("joint_half", strip(lambda s: set_all(s, "path", 3, 1.5)), "whole"), ("ends_in_one_place", strip(lambda s: s.update(path=[s["path"][0]] * 2)), "no length"),
             ("line_turns_back", strip(lambda s: s.update(path=[s["path"][0], s["path"][-1], s["path"][0]])), ()),
             ("one_slice", strip(lambda s: s.update(slices=s["slices"][:1])), "slices"), ("slices_65537", strip(lambda s: s.update(slices=[[i / 65536, *s["slices"][0][1:]] for i in range(65537)])), "limit"),
             ("slices_fall", strip(lambda s: s["slices"].reverse()), "slice parameter"), ("radius_minus", strip(lambda s: set_all(s, "slices", 4, -0.01)), "radius"),
             ("radius_1e300", strip(lambda s: set_all(s, "slices", 4, 1e300)), "radius"), ("radius_5_m", strip(lambda s: set_all(s, "slices", 4, 5)), "radius"),
             ("outline_1e30", strip(lambda s: set_all(s, "slices", 9, 1e30)), "outline"), ("outline_1e300", strip(lambda s: set_all(s, "slices", 9, 1e300)), ()),
             ("offset_1e300", strip(lambda s: set_all(s, "slices", 2, 1e300)), "offset"), ("roll_1e300", strip(lambda s: set_all(s, "slices", 1, 1e300)), "roll"),
             ("slice_short", strip(lambda s: s["slices"][0].pop()), "slices"), ("place_1e300", strip(lambda s: set_all(s, "path", 1, 1e300)), "path point"),
             ("place_far", strip(lambda s: set_all(s, "path", 1, 40)), "path point"), ("share_1e9", strip(lambda s: set_all(s, "path", 5, 1e9)), "share"),
             ("length_zero", strip(lambda s: s.update(rest_length=0)), "rest_length"), ("length_minus", strip(lambda s: s.update(rest_length=-1)), "rest_length"),
             ("length_huge", strip(lambda s: s.update(rest_length=1e200)), "rest_length"), ("reference_zero", strip(lambda s: s.update(reference=[0, 0, 0])), "reference"),
             ("belly_beyond", strip(lambda s: s.update(belly=[0.2, 77])), "belly"), ("belly_backwards", strip(lambda s: s.update(belly=[0.9, 0.1])), "belly"),
             ("intersections_fall", strip(lambda s: s.update(intersections=[0.6, 0.3])), "intersections"), ("intersection_word", strip(lambda s: s.update(intersections=["x"])), "intersections"),
             ("intersections_number", strip(lambda s: s.update(intersections=0.5)), "list"), ("raphe_2", strip(lambda s: s.update(raphe=2)), "raphe"),
             ("strip_is_text", lambda d: muscle(d).update(strips=["x"]), "strip 1"), ("no_strips", lambda d: muscle(d).update(strips=[]), "no strip"), ("strips_null", lambda d: muscle(d).update(strips=None), "list"),
             ("volume_minus", lambda d: muscle(d).update(volume=-1), "volume"), ("volume_word", lambda d: muscle(d).update(volume="much"), "volume"), ("force_1e300", lambda d: muscle(d).update(max_force=1e300), "max_force"), ("tense_9", lambda d: muscle(d).update(tense_thickness=9), "tense_thickness"),
             ("pennation_9", lambda d: muscle(d).update(pennation=9), "pennation"), ("side_up", lambda d: muscle(d).update(side="up"), "side"), ("no_label", lambda d: muscle(d).pop("label"), "label"),
             ("extras_gone", lambda d: next(n for n in d["nodes"] if n["name"].startswith("muscle/")).pop("extras"), "extras")]
    def sheet(**members):
        return lambda d: next(n for n in d["nodes"] if n["name"].startswith("fascia/"))["extras"].update(members)

    cases += [("fascia_rows", sheet(rows=2), "grid"), ("fascia_rows_minus", sheet(rows=-3), "rows"), ("fascia_columns_1e6", sheet(columns=10**6), "limit"),
              ("fascia_rows_half", sheet(rows=2.5), "whole"), ("fascia_on_nothing", sheet(bones=["nobody"]), "nobody"), ("fascia_bones_word", sheet(bones="femur_l"), "bones"),
              ("fascia_belly_gone", lambda d: d["meshes"][next(n for n in d["nodes"] if n["name"].startswith("fascia/"))["mesh"]]["primitives"][0]["attributes"].pop("_BELLY"), "_BELLY")]
    for name, change, says in cases:
        character(t, 60, name, change, (3, 5), says)

    def wrap(**members):
        def change(d):
            for node in d["nodes"]:
                for one in node.get("extras", {}).get("strips", []):
                    one["wraps"] = [{"joint": 0, "kind": "sphere", "radii": [0.01] * 3, "rotation": [0, 0, 0, 1], "translation": [0, 1, 0], **members}]
        return change

    for name, members, says in (("kind", {"kind": "torus"}, "kind"), ("joint", {"joint": 400}, "wrap"), ("radius_zero", {"radii": [0, 0, 0]}, "wrap"), ("radius_minus", {"radii": [-1, 1, 1]}, "wrap"),
                                ("radius_1e300", {"radii": [1e300] * 3}, "wrap"), ("rotation_zero", {"rotation": [0, 0, 0, 0]}, "rotation"), ("rotation_1e300", {"rotation": [1e300, 0, 0, 1]}, "rotation"),
                                ("far", {"translation": [0, 1e9, 0]}, "wrap")):
        character(t, 60, f"wrap_{name}", wrap(**members), 3, says)
    for name, members, says in (("axes_zero", {"axes": [0] * 9}, "axes"), ("axes_1e300", {"axes": [1e300] * 9}, "axes"), ("axes_left_handed", {"axes": [1, 0, 0, 0, 1, 0, 0, 0, -1]}, "axes"),
                                ("axes_short", {"axes": [1, 0, 0]}, "axes"), ("limits_9", {"min": [-9] * 3, "max": [9] * 3}, "min"), ("limits_fall", {"min": [1] * 3, "max": [0] * 3}, "min"),
                                ("limits_1e300", {"max": [1e300] * 3}, "max"), ("zero_1e9", {"zero": [1e9, 0, 0]}, "zero"), ("zero_1e300", {"zero": [1e300] * 3}, "zero"),
                                ("offset_1e300", {"offset": [1e300] * 3}, "knee_l"), ("offset_far", {"offset": [0, -30, 0]}, "knee_l"), ("offset_word", {"offset": ["a", "b", "c"]}, "offset")):
        character(t, 60, f"joint_{name}", lambda d, members=members: joint(d).update(members), 3, ["knee_l", says])
    for name in ("knee_l", "head", "thorax", "wrist_r", "toe_ip1_l"):
        character(t, 60, f"without_{name}", lambda d, name=name: next(n for n in d["nodes"] if n["name"] == name).update(name="somebody_elses"), 4, [name, "ecorche fit"])
    character(t, 60, "skin_of_no_joints", lambda d: d["skins"][0].update(joints=[]), 3, "joints")
    character(t, 60, "skin_names_no_node", lambda d: d["skins"][0]["joints"].__setitem__(3, 10**6), 3, "node")
    character(t, 60, "joint_twice", lambda d: d["skins"][0]["joints"].__setitem__(3, d["skins"][0]["joints"][4]), 3, "twice")
    character(t, 60, "joints_reversed", lambda d: d["skins"][0]["joints"].reverse(), 3, "precede")
    character(t, 60, "bone_of_no_joint", lambda d: next(n for n in d["nodes"] if n["name"].startswith("bone/"))["extras"].update(joint=500), 3, "joint 500")
    character(t, 60, "bone_without_mesh", lambda d: next(n for n in d["nodes"] if n["name"].startswith("bone/")).pop("mesh"), 3, "mesh")
    character(t, 60, "no_skin", lambda d: next(n for n in d["nodes"] if n["name"] == "skin").update(name="hide"), 3, "'skin'")
    character(t, 60, "landmark_far", lambda d: d["scenes"][0]["extras"]["ecorche"]["body"].update(landmarks={"here": [1e300, 0, 0]}), 3, "landmark")
    character(t, 60, "mass_of_tons", lambda d: d["scenes"][0]["extras"]["ecorche"]["body"].update(mass=12339), 3, "mass")
    character(t, 60, "age_minus", lambda d: d["scenes"][0]["extras"]["ecorche"]["body"].update(age=-3), 3, "age")
    character(t, 60, "sex_of_a_cat", lambda d: d["scenes"][0]["extras"]["ecorche"]["body"].update(sex="cat"), 3, "sex")
    many = [f"muscle/copy_{i}" for i in range(5000)]
    character(t, 60, "muscles_5000", lambda d: d["nodes"].extend([{"name": name, "extras": muscle(d)} for name in many]), 5, "limit")
    t.animate(60, "a body in place of a character", character=t.body, codes=4, says=["anna.glb", "ecorche fit"])
    t.animate(60, "another program's file", character=t.bench.file("foreign.glb", glb({"asset": {"version": "2.0"}, "scenes": [{}]})), codes=3, says="foreign.glb")
    for verb in (["export", "{file}", "-o", "{out}/a.osim"], ["check", "{file}", "--no-sweeps"], ["weights", "{file}", "-o", "{out}/w.csv"], ["inertia", "{file}", "-o", "{out}/i.csv"],
                 ["dynamics", "{file}", t.good_motion, "-o", "{out}/d.csv"], ["bake", "{file}", t.good_motion, "-o", "{out}/b.glb"],
                 ["posebook", "{file}", "-o", "{out}/p", "--no-pictures"], ["render", "{file}", t.good_motion, "-o", "{out}/%04d.png"], ["fit", t.body, "--template", "{file}", "-o", "{out}/c.glb"]):
        for name, codes in (("axes_zero", 3), ("without_knee_l", 4)):
            path = t.bench.file(f"character_{'joint_' if name == 'axes_zero' else ''}{name}.glb")
            t.bench.case(60, f"{verb[0]} of {path.name}", [path if a == "{file}" else a for a in verb], codes, path.name)


def row_61(t):
    """A character that changed by chance in one place: refused, or moved to where bodies are. Never flung away in silence."""
    rng = random.Random(t.seed)
    data = t.small.read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    for k in range(t.mutants):
        bad = bytearray(data)
        kind = rng.randrange(4)
        if kind == 0:  # a digit of the JSON
            places = [i for i in range(20, 20 + size) if chr(bad[i]).isdigit()]
            bad[rng.choice(places)] = ord(rng.choice("0123456789"))
        elif kind == 1:  # any byte of the JSON
            bad[20 + rng.randrange(size)] = rng.randrange(256)
        elif kind == 2:  # a bit of the numbers
            bad[28 + size + rng.randrange(len(bad) - 28 - size)] ^= 1 << rng.randrange(8)
        else:  # a float of the numbers
            at = 28 + size + 4 * rng.randrange((len(bad) - 28 - size) // 4)
            bad[at:at + 4] = struct.pack("<f", rng.choice([0, -1, 9, 1e9, 3e38, math.nan, math.inf, 1e-40]))
        path = t.bench.file(f"mutant_{k}.glb", bytes(bad))
        t.bench.case(61, f"mutant {k} of kind {kind}", ["animate", path, t.good_motion, "-o", "{out}/m.pc2"], (0, 3, 4, 5), after=lambda out, done: t.near_body(out / "m.pc2") if done.code == 0 else "")


def row_63(t):
    """Files of newer and older versions."""
    def schema(value):
        return lambda d: d["scenes"][0]["extras"]["ecorche"].update(schema=value)

    for name, value, codes, says in (("newer", 99, 4, "newer version"), ("much_newer", 10**8, 4, "newer version"), ("older", 0, 3, "schema"), ("minus", -1, 3, "schema"), ("word", "one", 3, "schema"), ("half", 1.5, 3, "schema")):
        character(t, 63, f"schema_{name}", schema(value), codes, says)
        t.bench.case(63, f"a body of schema {value}", ["fit", t.bench.file(f"character_schema_{name}.glb"), "-o", "{out}/c.glb"], codes, says)
    text = t.crowd_text()
    for value, codes, says in ((99, 4, "newer version"), (1, 3, "older")):
        path = t.crowd.parent / f"schema_{value}.gltf"
        path.write_text(text.replace('"crowd":{"schema":2', f'"crowd":{{"schema":{value}'))
        t.bench.case(63, f"a crowd of schema {value}", ["animate", path, t.good_motion, "-o", "{out}/c.glb"], codes, [path.name, says])


def crowds(t):
    """Crowds whose parts do not belong together (rows 14, 15 and 60 of them)."""
    text = t.crowd_text()
    document = json.loads(text)

    def put(name, change, codes=3, says=()):
        bad = json.loads(text)
        change(bad)
        path = t.crowd.parent / f"bad_{name}.gltf"
        path.write_text(json.dumps(bad, separators=(",", ":")))
        t.bench.case(14, f"a crowd: {name}", ["animate", path, t.good_motion, "-o", "{out}/c.glb"], codes, says, names=path.name)

    last = len(document["bufferViews"]) - 1
    put("view_gone", lambda d: d["accessors"][0].update(bufferView=10**9), says="bufferview")
    put("view_gone_unused", lambda d: d["accessors"].append({"bufferView": 10**9, "componentType": 5126, "count": 1, "type": "SCALAR"}), says="bufferview")
    put("view_beyond", lambda d: d["bufferViews"][last].update(byteLength=2**40), says="beyond")
    put("view_wraps", lambda d: d["bufferViews"][last].update(byteOffset=2**64 - 4), says="beyond")
    put("buffer_empty", lambda d: d["buffers"][0].update(byteLength=0), says="empty")
    put("buffer_long", lambda d: d["buffers"][0].update(byteLength=2**40), says="shorter")
    put("buffer_gone", lambda d: d["bufferViews"][0].update(buffer=9), says="buffer")
    put("count_2_62", lambda d: [a.update(count=2**62) for a in d["accessors"]], says=())
    put("joint_gone", lambda d: d["skins"][0]["joints"].__setitem__(5, 10**7), says="joint")
    put("joints_none", lambda d: d["skins"][0].update(joints=[]), says="joints")
    put("child_of_two", lambda d: d["nodes"].append({"children": [0, 1, 2]}), says="children")
    put("nobody", lambda d: d.update(nodes=[], scenes=[{**d["scenes"][0], "nodes": []}]), says="nobody")
    put("joint_renamed", lambda d: next(n for n in d["nodes"] if n.get("name", "").endswith("knee_l")).update(name="x"), (3, 4))
    for address, says in ((f"{t.crowd}#eve", "nobody is named"), (f"{t.crowd}#", "nobody is named")):
        t.bench.case(60, "somebody who is not there", ["fit", address, "-o", "{out}/c.glb"], 3, says)
