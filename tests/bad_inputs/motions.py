"""Bad motions: rows 47 to 57."""
import pathlib
import random

from files import chain, glb
from meshes import fit


def move(t, row, name, data, codes, says=(), **options):
    path = t.bench.file(f"{name}.bvh", data)
    t.animate(row, name.replace("_", " "), motion=path, codes=codes, says=says, names=path.name, **options)


def row_47(t):
    """Cut short: in the hierarchy, before and inside the motion, within the last line."""
    text = t.walk.first(4).text()
    motion = text.index("MOTION")
    for name, end, codes in (("cut_hierarchy", motion // 2, 3), ("cut_before_motion", motion, 3), ("cut_header", motion + 12, 3)):
        move(t, 47, name, text[:end], codes)
    move(t, 47, "cut_last_line", text[:-40], 0, "left out")
    move(t, 47, "cut_last_number", text[:-2], 0, ())
    for k, share in enumerate((0.1, 0.5, 0.9)):
        move(t, 47, f"cut_{k}", text[:int(share * motion)], 3)


def row_48(t):
    """Channels and joints that do not belong together."""
    w = t.walk.first(3)
    for name, old, new, says in (("count", "CHANNELS 3", "CHANNELS 4", ""), ("many", "CHANNELS 6", "CHANNELS 7", "0 to 6"), ("unknown", "Xrotation", "Wrotation", "unknown channel"), ("twice", "Xrotation Zrotation", "Xrotation Xrotation", "twice"),
                                 ("word", "CHANNELS 3", "CHANNELS three", "not a finite number"), ("minus", "CHANNELS 3", "CHANNELS -3", ""), ("offset", "OFFSET 0 98 0", "OFFSET 0 98", "")):
        text = w.text()
        move(t, 48, f"channels_{name}", text.replace(old, new, 1), 3, [".bvh:", says])
    move(t, 48, "no_channels", "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}\nMOTION\nFrames: 1\nFrame Time: 0.04\n0\n", 3, ":9")
    move(t, 48, "two_roots", w.text().replace("MOTION", "ROOT other\n{\nOFFSET 0 0 0\nEnd Site\n{\nOFFSET 0 0 0\n}\n}\nMOTION"), (0, 4), "roots")
    names = [line.split()[1] for line in w.hierarchy if line.split()[:1] == ["JOINT"]]
    move(t, 48, "name_twice", w.text().replace("JOINT " + names[-1] + "\n", "JOINT " + names[0] + "\n"), (0, 4), "repeats a name")
    move(t, 48, "name_empty", w.text().replace("JOINT " + names[-1] + "\n", "JOINT\n"), (0, 4), "has no name")
    move(t, 48, "name_latin1", w.text().replace("JOINT " + names[-1] + "\n", "JOINT F\xfc\xdf\n").encode("latin-1"), (0, 4), "not UTF-8")
    move(t, 48, "name_long", w.text().replace("JOINT " + names[-1], "JOINT " + "x" * 5000), 3, "5000 bytes")


def row_49(t):
    """`Frames:` that is not the truth."""
    w = t.walk.first(3)
    for count, codes, says in ((0, 0, "holds 3"), (-1, 3, "whole number"), (2, 0, "holds 3"), (2000000000, 0, "holds 3"), (10**30, 0, "holds 3"), ("many", 3, ""), (2.5, 3, "")):
        move(t, 49, f"frames_{count}", w.but(count=count).text(), codes, says, megabytes=700)
    move(t, 49, "no_frames", w.but(frames=[]).text(), 0, "no frames")
    lines = w.text().rstrip("\n").split("\n")
    move(t, 49, "line_long", "\n".join([*lines[:-2], lines[-2] + " 1 2 3", lines[-1]]), 3, "channels")
    move(t, 49, "line_short", "\n".join([*lines[:-2], lines[-2].rsplit(" ", 5)[0], lines[-1]]), 3, "channels")


def row_50(t):
    """`Frame Time:` of nothing."""
    for value in ("0", "-0.01", "nan", "inf", "1e-9", "1e9", "soon", ""):
        move(t, 50, f"time_{value or 'empty'}", t.walk.first(3).but(time=value).text(), 3, "frame time")


def row_51(t):
    """Samples that are no numbers, turns of 1e20 degrees and of 720, frozen frames, leaps to far away."""
    w = t.walk.first(6)
    knee, root = w.channel(w.hierarchy[1].split()[1], "Yrotation"), 0
    for value in ("nan", "-inf", "1e999", "1e20", "0x10", "1,5", "--1"):
        move(t, 51, f"sample_{value}", w.with_value(2, knee, value).text(), 3, "frame 2")
    wraps = w.but(frames=[[str(float(v) + (720 if i % 2 and c > 5 else 0)) for c, v in enumerate(f)] for i, f in enumerate(w.frames)])
    move(t, 51, "turns_of_720", wraps.text(), 0, after=lambda out, done: t.near_body(out / "m.pc2", 3.0))
    move(t, 51, "frozen", w.but(frames=[w.frames[0]] * 6).text(), 0)
    for value, codes in (("1e8", 4), ("-9e8", 4)):
        move(t, 51, f"leap_{value}", w.with_value(3, root, value).text(), codes, "frame")
    move(t, 51, "spike", w.with_value(3, root, "4000").text(), (0, 4), "frame")
    rng = random.Random(t.seed + 51)
    text = t.walk.first(3).text()
    for k in range(max(6, t.mutants // 3)):
        at = rng.randrange(len(text))
        bad = text[:at] + rng.choice("0123456789-.eE {}\nx") + text[at + 1:]
        move(t, 51, f"mutant_{k}", bad, (0, 3, 4, 5), after=lambda out, done: t.near_body(out / "m.pc2", 2e4) if done.code == 0 else "")


def row_52(t):
    """Joints of other names, without arms or feet; maps that do not fit."""
    w = t.walk.first(3)
    text = w.text()
    names = [line.split()[1] for line in w.hierarchy if line.split()[:1] in (["JOINT"], ["ROOT"])]
    strange = text
    for k, name in enumerate(names):
        strange = strange.replace(f" {name}\n", f" q{k}x\n")
    move(t, 52, "names_of_nothing", strange, (0, 4), ())
    move(t, 52, "one_joint", chain(0), 4, "one_joint.bvh")
    move(t, 52, "a_snake", chain(30), 4, "a_snake.bvh")
    lines = [f"q{k}x = {name}" for k, name in enumerate(["pelvis", "thorax", "no_such_joint"])]
    strange_file = t.bench.file("names_of_nothing.bvh")
    for name, content, codes, says in (("unknown_joint", "\n".join(lines), (3, 4), "no_such_joint"), ("file_joint_gone", "nobody = pelvis\n", (0, 3, 4), "nobody"), ("no_equals", "q0x pelvis\n", 3, "no_equals.map:1"),
                                       ("twice", "q0x = pelvis\nq0x = head\n", 3, "twice.map:2"), ("empty_name", " = pelvis\n", 3, "empty_name.map:1"), ("remarks_alone", "# nothing\n\n", 3, "remarks_alone.map"),
                                       ("crlf_bom", "\ufeffq0x = pelvis\r\n", (0, 4), ()), ("carriage", "q0x = pelvis\rq0x = head\r", 3, "carriage.map:2")):
        t.animate(52, f"a map: {name}", motion=strange_file, more=["--map", t.bench.file(f"{name}.map", content)], codes=codes, says=says)


def row_53(t):
    """Figures of ten times the size, of a tenth, under the ground."""
    for name, scale, lift in (("tenfold", 10, 0), ("tenth", 0.1, 0), ("underground", 1, -300)):
        hierarchy = [" ".join(["OFFSET", *[str(scale * float(v)) for v in line.split()[1:]]]) if line.split()[:1] == ["OFFSET"] else line for line in t.walk.hierarchy]
        frames = [[str(scale * float(v) + (lift if i == 1 else 0)) if i < 3 else v for i, v in enumerate(f)] for f in t.walk.frames[:6]]
        move(t, 53, name, t.walk.but(hierarchy=hierarchy, frames=frames).text(), 0, after=lambda out, done: t.near_body(out / "m.pc2", 5.0))


def row_54(t):
    """Knees turned backwards, which are legs turned about: brought back only if asked, and said either way, with the frame."""
    w = t.walk.first(6)
    knee = w.channel("LeftLeg", "Xrotation")
    bad = w
    for f in range(6):
        bad = bad.with_value(f, knee, -70)
    for limits, says in (("keep", ["hip_l", "beyond"]), ("clamp", ["hip_l", "brought back"]), ("auto", "hip_l")):
        move(t, 54, f"knee_backwards_{limits}", bad.text(), 0, says, more=["--limits", limits])


def row_55(t):
    """Skeletons of 200,000 joints within each other, of 70,000 beside each other."""
    move(t, 55, "deep", chain(200000), 3, "deeper than 256", megabytes=700)
    wide = "HIERARCHY\nROOT j\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n" + "".join(f"JOINT j{i}\n{{\nOFFSET 0 1 0\n}}\n" for i in range(70000)) + "}\nMOTION\nFrames: 1\nFrame Time: 0.04\n0 0 0\n"
    move(t, 55, "wide", wide, 3, "65535", megabytes=700)
    move(t, 55, "a_chain_of_200", chain(200), (3, 4))


def row_56(t):
    """Scales and turns of nodes: in a skin from elsewhere they count, a turn of nothing is refused."""
    for name, node, codes in (("mirrored", {"scale": [-1, 1, 1]}, (0, 8)), ("uneven", {"scale": [1, 1.02, 1]}, (0, 4, 8)), ("flat", {"scale": [1, 1, 0]}, 4), ("turn_zero", {"rotation": [0, 0, 0, 0]}, 3), ("turn_long", {"rotation": [0, 0, 0, 7]}, (0, 8)),
                              ("matrix_short", {"matrix": [1, 2, 3]}, 3), ("matrix_nan_word", {"matrix": ["a"] * 16}, 3), ("far", {"translation": [1e308, 0, 0]}, (3, 4)), ("scale_1e300", {"scale": [1e300] * 3}, (3, 4))):
        document, binary = t.scene_of([t.skin], ["anna"])
        document["nodes"][0].update(node)
        fit(t, 56, f"node_{name}.glb", glb(document, binary), codes)


def row_57(t):
    """Animations inside a character's file are not read; they cannot do harm."""
    def add(d):
        d["animations"] = [{"channels": [{"sampler": 9, "target": {"node": 10**6, "path": "rotation"}}], "samplers": [{"input": 10**6, "output": -4}]}]

    t.animate(57, "an animation of nothing", character=t.bench.file("animation.glb", t.changed_small(add)), codes=0)


def row_86(t):
    """Motions of other formats: bad files of the corpus, skeletons that are not there or another's, motions whose endings lie."""
    corpus = pathlib.Path(__file__).parent.parent / "corpus" / "motion"
    for line in (corpus / "expected.txt").read_text().splitlines():
        name, _, outcome = line.partition(" | ")
        if line.startswith("#") or not outcome.startswith("error ") or name.endswith(".asf") or name.startswith("character_"):
            continue
        skeleton = [] if name.endswith(".mot") else ["--skeleton", corpus / ("arm.asf" if name.endswith(".amc") else "character_arm.txt")]
        t.animate(86, name, motion=corpus / name, codes=(2, 3, 4), more=skeleton, names=name)
    markers = corpus.parent / "markers"
    for line in (markers / "expected.txt").read_text().splitlines():
        name, _, outcome = line.partition(" | ")
        if not line.startswith("#"):  # takes of three markers are read, and tell no pose
            t.animate(86, name, motion=markers / name, codes=(2, 3, 4), names=name)
    t.animate(86, "a skeleton for markers", motion=markers / "take.trc", more=["--skeleton", corpus / "person.asf"], codes=2, says="--skeleton")
    for name, table, says in (("no_place.csv", "marker,place\nLASI,elbow_lefty\n", "no place 'elbow_lefty'"), ("twice.csv", "marker,place\nLASI,asis_l\nlasi,psis_l\n", "twice"),
                              ("nowhere.csv", "marker,place,joint\nLASI,,\n", "neither a place nor a joint"), ("columns.csv", "name\nLASI\n", "marker")):
        t.animate(86, name, motion=markers / "take.trc", more=["--markers", t.bench.file(name, table)], codes=3, says=says)
    person = (corpus / "person_01.amc").read_text()
    alone = t.bench.file("person_01.amc", person)
    t.animate(86, "no skeleton beside", motion=alone, codes=3, says="--skeleton")
    t.animate(86, "a skeleton that is gone", motion=alone, more=["--skeleton", "gone.asf"], codes=3, says="gone.asf")
    t.animate(86, "another's skeleton", motion=alone, more=["--skeleton", corpus / "arm.asf"], codes=3, says="no bone 'spine'")
    t.animate(86, "a motion for a skeleton", motion=alone, more=["--skeleton", alone], codes=3, says="person_01.amc")
    t.animate(86, "a skeleton for a motion", motion=corpus / "person.asf", codes=4, says="person.asf")
    t.animate(86, "a skeleton for a BVH", more=["--skeleton", corpus / "person.asf"], codes=2, says="--skeleton")
    t.animate(86, "an arm alone", motion=corpus / "plain.amc", more=["--skeleton", corpus / "arm.asf"], codes=4, says="plain.amc")
    for name, text in (("says_fbx.fbx", person), ("says_mot.mot", person), ("says_txt.txt", "{\"Frames\": 7}")):
        t.animate(86, name, motion=t.bench.file(name, text), codes=3, says="says_")
    for words, codes in ((["--from", "0f"], 2), (["--from", "soon"], 2), (["--to", "-1"], 2), (["--from", "99s"], 2), (["--from", "5f", "--to", "4f"], 2), (["--from", "nan"], 2), (["--from", "1e999"], 2)):
        t.animate(86, "a part: " + " ".join(words), more=words, codes=codes, says="--")
