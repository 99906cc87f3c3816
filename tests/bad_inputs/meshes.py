"""Bad skins and meshes: rows 1 to 16, 19, 21, 23 to 43."""
import copy
import json
import math
import os
import random
import shutil
import struct
import subprocess
import zlib

from files import CUBE, glb, grid, mesh_scene, noise, obj, ply, read_glb, skin_of, stl

REGISTER = ("body", "register", "-o", "{out}/c.glb")
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def fit(t, row, name, data, codes, says=(), method="paper", instead=("body", "measure"), **options):
    """A skin to be fitted, by the method that takes the least time; where that is refused, the message names the file.

    What is taken need not be fitted to show that it is read: unless --thorough, the verb `instead` reads it, in a tenth of the time."""
    path = t.bench.file(name, data)
    command = ["fit", path, "-o", "{out}/c.glb", "--method", method]
    if instead and not t.thorough and 0 in (codes if isinstance(codes, tuple) else (codes,)):
        command = [*instead, path]
    t.bench.case(row, name, command, codes, says, names=path.name, **options)


def scan(t, row, name, data, codes, says=(), more=(), **options):
    """A scan to be registered; where it is refused, the message names the file."""
    path = t.bench.file(name, data)
    t.bench.case(row, name, ["body", "register", path, "-o", "{out}/c.glb", *more], codes, says, names=path.name, **options)


def row_1(t):
    """An empty file of every kind."""
    for ending in ("obj", "ply", "glb"):
        fit(t, 1, f"empty.{ending}", b"", 3, "empty file")
    t.animate(1, "empty.glb", motion=t.good_motion, character=t.bench.file("empty-character.glb", b""), codes=3, says="empty file")
    t.animate(1, "empty.bvh", motion=t.bench.file("empty.bvh", b""), codes=3, says="empty file")
    for option, name in (("--weights", "empty-weights.csv"), ("--map", "empty.map"), ("--activation", "empty.sto"), ("--activation", "empty.mot"), ("--activation", "empty.csv")):
        t.animate(1, name, more=[option, t.bench.file(name, b"")], codes=3, says=[name, "empty file"])
    t.bench.case(1, "empty poses", ["posebook", t.small, "--poses", t.bench.file("empty-poses.csv", b""), "-o", "{out}/p", "--no-pictures"], 3, ["empty-poses.csv", "empty file"])
    t.bench.case(1, "empty table of people", ["body", "population", t.bench.file("nobody.csv", b""), "-o", "{out}/p"], 3, ["nobody.csv", "empty file"])
    for name in ("empty.osim", "empty.xml"):
        t.bench.case(1, name, ["template", "import", t.bench.file(name, b""), "-o", "{out}/c.glb"], 3, [name, "empty file"])
    t.bench.case(1, "empty muscle", ["template", "resample", t.bench.file("empty-muscle.obj", b"")], 3, ["empty-muscle.obj", "empty file"])
    for ending in ("ply", "off", "stl", "pcd"):
        scan(t, 1, f"empty-scan.{ending}", b"", 3, "empty file")
    t.bench.case(1, "empty landmarks", ["body", "register", t.body, "--landmarks", t.bench.file("empty-marks.json", b""), "-o", "{out}/c.glb"], 3, ["empty-marks.json", "empty file"])
    t.bench.case(1, "empty body", ["body", "measure", t.bench.file("empty-body.glb", b"")], 3, ["empty-body.glb", "empty file"])
    for name in ("blank.csv", "blank.map"):
        option = "--map" if name.endswith("map") else "--weights"
        t.animate(1, name, more=[option, t.bench.file(name, "\n \n\n# nothing\n")], codes=3, says=name)


def row_2(t):
    """Noise with the right ending; right bytes with a wrong one."""
    for ending in ("obj", "ply", "glb"):
        fit(t, 2, f"noise.{ending}", noise(5000), 3)
        fit(t, 2, f"text.{ending}", "It was the best of times, it was the worst of times\n" * 9, 3)
    for ending in ("ply", "off", "stl", "pcd"):
        scan(t, 2, f"noise-scan.{ending}", noise(5000), 3)
    t.bench.case(2, "noise as landmarks", ["body", "register", t.body, "--landmarks", t.bench.file("noise-marks.json", noise(500)), "-o", "{out}/c.glb"], 3, "noise-marks.json")
    scan(t, 2, "plane-scan.obj", obj(*grid(40)), 4)
    scan(t, 2, "cube-scan.obj", obj(*CUBE), 4)
    t.animate(2, "noise.bvh", motion=t.bench.file("noise.bvh", noise(5000)), codes=3, says="noise.bvh")
    t.animate(2, "noise as a character", motion=t.good_motion, character=t.bench.file("noise-character.glb", noise(5000)), codes=3, says="noise-character.glb")
    t.animate(2, "a motion as a character", motion=t.good_motion, character=t.bench.file("motion.glb", t.walk.text()), codes=3, says="motion.glb")
    for option, name in (("--weights", "noise-weights.csv"), ("--map", "noise.map"), ("--activation", "noise.sto"), ("--activation", "noise.csv")):
        t.animate(2, name, more=[option, t.bench.file(name, noise(3000))], codes=3, says=name)
    t.bench.case(2, "noise as a sling", ["lift", t.small, "--sling", t.bench.file("noise-sling.obj", noise(3000)), "--table", "{out}/l.csv"], 3, "noise-sling.obj")
    t.bench.case(2, "a cube as a sling", ["lift", t.small, "--sling", t.bench.file("cube-sling.obj", obj(*CUBE)), "--table", "{out}/l.csv"], (0, 4, 8), "")
    for name in ("noise.osim", "noise.xml"):
        t.bench.case(2, name, ["template", "import", t.bench.file(name, noise(3000)), "-o", "{out}/c.glb"], 3, name)
    t.bench.case(2, "noise as people", ["body", "population", t.bench.file("noise-people.csv", noise(3000)), "-o", "{out}/p"], (2, 3), "noise-people.csv")
    fit(t, 2, "really_a_glb.obj", t.body.read_bytes(), (0, 8))
    fit(t, 2, "really_an_obj.ply", obj(*t.skin), (0, 8), "read as obj")


def row_3(t):
    """Folders, pipes, devices, what is missing or forbidden: said with the system's own words, and never waited for."""
    folder = t.bench.file("a_folder")
    folder.mkdir(exist_ok=True)
    pipe = t.bench.file("pipe")
    if not pipe.exists():
        os.mkfifo(pipe)
    secret = t.bench.file("secret", b"x")
    secret.chmod(0)
    missing = t.bench.file("missing")
    loop = t.bench.file("loop")
    if not loop.is_symlink():
        loop.symlink_to("loop")
    places = [(folder, "is a directory"), (pipe, "pipe"), ("/dev/zero", "device"), (missing, "no such file or directory"), (loop, "too many levels of symbolic links")]
    users = [(secret, "permission denied")]
    for place, words in places + users:
        user = None if words != "permission denied" or os.getuid() != 0 else t.nobody
        if words == "permission denied" and os.getuid() == 0 and t.nobody is None:
            t.bench.skip(3, "forbidden files", "nobody else to be")
            continue
        rest = {"user": user, "seconds": 20}
        name = os.path.basename(str(place))
        t.bench.case(3, f"skin: {name}", ["fit", place, "-o", t.out(user)], 3, [name, words], writes=False, **rest)
        t.bench.case(3, f"body: {name}", ["body", "measure", place], 3, [name, words], **rest)
        t.bench.case(3, f"character: {name}", ["animate", place, t.good_motion, "-o", t.out(user)], 3, [name, words], **rest)
        t.bench.case(3, f"motion: {name}", ["animate", t.small, place, "-o", t.out(user)], 3, [name, words], **rest)
        for option in ("--weights", "--map", "--activation"):
            t.bench.case(3, f"{option} {name}", ["animate", t.small, t.good_motion, "-o", t.out(user, "m.pc2"), option, place], 3, [name, words], **rest)
        t.bench.case(3, f"--poses {name}", ["posebook", t.small, "--poses", place, "-o", t.out(user, "p"), "--no-pictures"], 3, [name, words], **rest)
        t.bench.case(3, f"check --poses {name}", ["check", t.small, "--poses", place], 3, [name, words], **rest)
        t.bench.case(3, f"people: {name}", ["body", "population", place, "-o", t.out(user, "p")], 3, [name, words], **rest)
        t.bench.case(3, f"sling: {name}", ["lift", t.small, "--sling", place, "--table", t.out(user, "l.csv")], 3, [name, words], **rest)
        t.bench.case(3, f"model: {name}", ["template", "import", place, "-o", t.out(user)], 3, [name, words], **rest)
        t.bench.case(3, f"mesh: {name}", ["template", "resample", place], 3, [name, words], **rest)
        t.bench.case(3, f"template: {name}", ["fit", t.body, "--template", place, "-o", t.out(user)], 3, [name, words], **rest)


def row_4(t):
    """Links: in a ring (row 3), and out of the folder that a file lies in."""
    home, away = t.bench.file("linked/home"), t.bench.file("linked/away")
    home.mkdir(parents=True, exist_ok=True)
    away.mkdir(parents=True, exist_ok=True)
    (away / "secret.stl").write_bytes(stl([((0, 0, 0), (1, 0, 0), (0, 1, 0))]))
    (away / "part.xml").write_text("<mujoco/>")
    for name in ("secret.stl", "part.xml"):
        if not (home / name).is_symlink():
            (home / name).symlink_to(away / name)
    (home / "include.xml").write_text('<mujoco><include file="part.xml"/></mujoco>')
    t.bench.case(4, "include by a link", ["template", "import", home / "include.xml", "-o", "{out}/c.glb"], 3, ["part.xml", "folder"])
    (home / "model.osim").write_text(t.osim(mesh="secret.stl"))
    t.bench.case(4, "mesh by a link", ["template", "import", home / "model.osim", "-o", "{out}/c.glb"], 3, ["secret.stl", "folder"])
    crowd = home / "crowd.gltf"
    text = t.crowd_text()
    crowd.write_text(text.replace("ada.bin", "ada_link.bin"))
    for name in ("crowd.shared", "bob.bin"):
        (home / name).write_bytes((t.crowd.parent / name).read_bytes())
    (away / "ada.bin").write_bytes((t.crowd.parent / "ada.bin").read_bytes())
    if not (home / "ada_link.bin").is_symlink():
        (home / "ada_link.bin").symlink_to(away / "ada.bin")
    t.bench.case(4, "a crowd's buffer by a link", ["animate", crowd, t.good_motion, "-o", "{out}/c.glb"], 3, ["crowd.gltf", "link"])


def row_5(t):
    """Names with blanks, quotes, line ends, umlauts, of 255 bytes, with a dash in front."""
    skin = obj(*t.skin)
    for name in ("with blank.obj", "quo'te\".obj", "line\nend.obj", "ümläut 人.obj", "x" * 251 + ".obj"):
        path = t.bench.file("names/" + name, skin)
        t.bench.case(5, repr(name[:20]), ["body", "measure", path], (0, 8))
    path = t.bench.file("names/-dash.obj", skin)
    t.bench.case(5, "a dash in front", ["fit", "-o", "{out}/c.glb", "--method", "paper", "--", path.name], (0, 8), folder=path.parent)


def row_6(t):
    """Names inside files: not UTF-8, twice, empty. (Of motions: row 48.)"""
    path = os.fsencode(t.bench.file("names")) + b"/caf\xe9.obj"
    t.bench.file("names/x", b"")
    with open(path, "wb") as file:
        file.write(obj(*t.skin).encode())
    t.bench.case(6, "a file's name that is not UTF-8", ["body", "measure", os.fsdecode(path)], (0, 8))
    document, binary = t.small_parts()
    bad = glb(json.dumps(document).encode().replace(b'"knee_l"', b'"kn\xffe_l"'), binary)
    t.animate(6, "a joint's name that is not UTF-8", character=t.bench.file("utf8.glb", bad), codes=3, says="utf8.glb")
    for what, name in (("two nodes of one name", "knee_r"), ("a node without name", "")):
        one = t.changed_small(lambda d: next(n for n in d["nodes"] if n["name"] == "knee_l").update(name=name))
        t.animate(6, what, character=t.bench.file(f"{what.replace(' ', '_')}.glb", one), codes=(3, 4), says=".glb: ")
    weights = t.bench.file("latin1.csv", b"vertex,joint,weight\n0,kn\xe4_l,1\n")
    t.animate(6, "a name in a table that is not UTF-8", more=["--weights", weights], codes=3, says="latin1.csv:2")


def row_7(t):
    """Corners of OBJ faces: 0, beyond, counted back too far, 2^31, of mixed kinds."""
    for name, line, says in (("zero", "f 0 1 2", "a face corner is 0"), ("beyond", "f 1 2 99", "vertex 99"), ("back", "f -1 -2 -9", "counts back"), ("large", "f 1 2 2147483648", ""),
                             ("larger", "f 1 2 99999999999999999999", ""), ("fraction", "f 1 2 3.5", ""), ("word", "f 1 2 x", ""), ("slashes", "f 1/1/1/1 2 3", "")):
        fit(t, 7, f"corner_{name}.obj", SQUARE + line + "\n", 3, [":5", says])
    fit(t, 7, "corner_mixed.obj", SQUARE + "vt 0 0\nvn 0 0 1\nf 1/1 2//1 3/1/1\n", 4)


def row_8(t):
    """Polygons of very many corners, concave, with corners twice."""
    for count in (9999, 10001, 1000000):
        ring = "".join(f"v {math.cos(i):.6f} {math.sin(i * 1.7):.6f} 0\n" for i in range(count))
        fit(t, 8, f"polygon_{count}.obj", ring + "f " + " ".join(str(i + 1) for i in range(count)) + "\n", 4 if count < 10000 else 5, "corners" if count > 10000 else (), seconds=20)
    t.bench.case(8, "a muscle of one concave polygon", ["template", "resample", t.bench.file("concave.obj", "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 2 3 4 5 5\n")], 4)
    fit(t, 8, "many_polygons.obj", "".join(f"v {math.cos(i * .01):.6f} {math.sin(i * .017):.6f} 0\n" for i in range(5000)) + ("f " + " ".join(map(str, range(1, 5001))) + "\n") * (200 if t.thorough else 20), (4, 5), seconds=60)


def row_9(t):
    """Materials that lead elsewhere: never opened."""
    lines = "".join(f"mtllib {place}\n" for place in ("../../../../etc/passwd", "/etc/passwd", "file:///etc/passwd", "\\\\\\\\host\\\\share\\\\x.mtl"))
    path = t.bench.file("materials.obj", lines + SQUARE + "f 1 2 3 4\n")
    fit(t, 9, "materials.obj", path.read_bytes(), 4)
    if not shutil.which("strace"):
        t.bench.skip(9, "what is opened", "strace is not installed")
        return
    log = t.bench.file("materials.strace")
    subprocess.run(["strace", "-f", "-e", "trace=open,openat,openat2", "-o", log, t.bench.program, "fit", path, "-o", t.bench.file("never.glb")], capture_output=True, timeout=300)
    opened = log.read_text()
    t.bench.count += 1
    if "etc/passwd" in opened or "x.mtl" in opened:
        t.bench._fail(9, "what is opened", "a material file was opened", [path])


def row_10(t):
    """Decimal commas in a file; a locale with decimal commas around the program."""
    fit(t, 10, "commas.obj", (SQUARE + "f 1 2 3\n").replace("v 1 0", "v 1,5 0"), 3, ":2")
    t.animate(10, "commas.csv", more=["--weights", t.bench.file("commas.csv", "vertex,joint,weight\n0,knee_l,0,5\n")], codes=3, says="commas.csv:2")
    locale = t.german_locale()
    if locale is None:
        t.bench.skip(10, "a German locale", "localedef cannot make one here")
        return
    plain = t.bench.run(["animate", t.small, t.good_motion, "-o", t.bench.file("plain.glb")])
    t.bench.case(10, "a German locale", ["animate", t.small, t.good_motion, "-o", "{out}/plain.glb"], 0, environment=locale,
                 after=lambda out, done: "" if (out / "plain.glb").read_bytes() == t.bench.file("plain.glb").read_bytes() and plain.code == 0 else "other bytes come out")


def row_11(t):
    """PLY headers that lie; either byte order; any line ends."""
    vertices, faces = t.skin
    good = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}", "property float x", "property float y", "property float z", f"element face {len(faces)}",
            "property list uchar int vertex_indices", "end_header"]

    def header(old, new):
        return [line.replace(old, new) for line in good]

    for name, head, says in (("count", header("vertex 13380", "vertex 4000000000"), "promises"), ("count_faces", header("face 2", "face 9999992"), "promises"),
                             ("type", header("float x", "quaternion x"), "property type"), ("list", header("uchar int", "float int"), "whole type"),
                             ("minus", header("vertex 13380", "vertex -1"), ""), ("no_end", good[:-1], "header")):
        fit(t, 11, f"header_{name}.ply", ply(vertices, faces, header=head), 3, says, megabytes=500)
    fit(t, 11, "list_255.ply", ply(vertices, []), (0, 8), (), instead=REGISTER, seconds=120)
    short = ply(vertices[:4], [(0, 1, 2)])
    fit(t, 11, "list_long.ply", short[:-13] + b"\xff" + short[-12:], 3, "does not fit")
    fit(t, 11, "big_endian.ply", ply(vertices, faces, ">"), (0, 8), ())
    fit(t, 11, "crlf.ply", ply(vertices, faces, line="\r\n"), (0, 8), ())
    fit(t, 11, "cr.ply", ply(vertices, faces, line="\r"), (0, 8), ())


def row_12(t):
    """STL (meshes of models): binary that begins with "solid", counts that lie."""
    triangles = [((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)), ((0, 0, 0), (0, 0.1, 0), (0, 0, 0.1))]
    folder = t.bench.file("stl")
    folder.mkdir(exist_ok=True)
    for name, data, codes in (("solid", stl(triangles), (0, 4, 8)), ("count", stl(triangles, count=4000000000), 3), ("short", stl(triangles)[:-20], 3), ("nan", stl([((math.nan, 0, 0), (1, 0, 0), (0, 1, 0))], b"x"), 3),
                              ("noise", noise(500), 3)):
        (folder / f"{name}.stl").write_bytes(data)
        (folder / f"{name}.osim").write_text(t.osim(mesh=f"{name}.stl"))
        t.bench.case(12, f"{name}.stl", ["template", "import", folder / f"{name}.osim", "-o", "{out}/c.glb"], codes, f"{name}.stl" if codes == 3 else (), writes=False, may_leave=codes != 3)


def row_13(t):
    """GLB containers: lengths beyond the file, chunks of the wrong kind, JSON alone, cut anywhere."""
    document, binary = mesh_scene(*CUBE)
    whole = glb(document, binary)
    for name, data in (("length", glb(document, binary, length=1 << 30)), ("length_short", glb(document, binary, length=60)), ("json_length", glb(document, binary, json_length=1 << 31)),
                       ("chunk_kind", glb(document, binary, first=b"BIN\0")), ("version", glb(document, binary, version=1)), ("json_only", glb(document)), ("json_cut", glb(b'{"asset":{', binary)),
                       ("no_padding", whole[:-1]), ("binary_length", whole.replace(struct.pack("<I", len(binary) + -len(binary) % 4) + b"BIN", struct.pack("<I", 1 << 31) + b"BIN"))):
        fit(t, 13, f"container_{name}.glb", data, 3)
    small = t.small.read_bytes()
    for share in (0.0001, 0.01, 0.3, 0.9, 0.9999):
        t.animate(13, f"a character cut at {share}", character=t.bench.file(f"cut_{share}.glb", small[:int(share * len(small))]), codes=3, says=f"cut_{share}.glb")
    for name in ("length", "version"):
        t.animate(13, f"a character's {name}", character=t.bench.file(f"own_{name}.glb", {"length": small[:8] + struct.pack("<I", 1 << 31) + small[12:], "version": small[:4] + b"\x07" + small[5:]}[name]),
                  codes=3, says=f"own_{name}.glb")


def broken_accessors():
    """What can be wrong with accessors and views: name, change of the document (its first accessor holds positions), pieces of the message."""
    def put(list_name, index, **members):
        return lambda d: d[list_name][index].update(members)

    return [("count_2_62", put("accessors", 0, count=2**62), ()), ("count_2_64", put("accessors", 0, count=2**64), ()), ("count_minus", put("accessors", 0, count=-1), "count"),
            ("count_half", put("accessors", 0, count=1.5), "count"), ("count_word", put("accessors", 0, count="9"), "count"), ("stride", put("bufferViews", 0, byteStride=4), "stride"),
            ("offset", put("accessors", 0, byteOffset=2**40), ()), ("offset_wraps", put("bufferViews", 0, byteOffset=2**64 - 8), ()), ("length", put("bufferViews", 0, byteLength=2**33), ()),
            ("view_gone", put("accessors", 0, bufferView=999999999), "bufferViews[999999999]"), ("view_minus", put("accessors", 0, bufferView=-7), ()), ("buffer_gone", put("bufferViews", 0, buffer=7), ()),
            ("component", put("accessors", 0, componentType=7), "componenttype"), ("shape", put("accessors", 0, type="VEC17"), ()), ("sparse", put("accessors", 0, sparse={"count": 2**40}), "sparse"),
            ("buffer_short", put("buffers", 0, byteLength=8), ()), ("buffer_empty", put("buffers", 0, byteLength=0), ())]


def row_14(t):
    """Accessors: counts of 2^62, none, views beyond their buffer, what is named but not there."""
    document, binary = mesh_scene(*CUBE)
    for name, change, says in broken_accessors():
        bad = copy.deepcopy(document)
        change(bad)
        fit(t, 14, f"accessor_{name}.glb", glb(bad, binary), (3, 5), says, megabytes=400)
    small, small_binary = t.small_parts()
    skin = small["meshes"][next(n for n in small["nodes"] if n["name"] == "skin")["mesh"]]["primitives"][0]["attributes"]["POSITION"]
    for name, change, _ in broken_accessors():
        bad = copy.deepcopy(small)
        bad["accessors"][0], bad["accessors"][skin] = bad["accessors"][skin], bad["accessors"][0]
        view = bad["accessors"][0]["bufferView"]
        bad["bufferViews"][0], bad["bufferViews"][view] = bad["bufferViews"][view], bad["bufferViews"][0]
        for accessor in bad["accessors"]:
            accessor["bufferView"] = {0: view, view: 0}.get(accessor["bufferView"], accessor["bufferView"])
        for mesh in bad["meshes"]:
            for primitive in mesh["primitives"]:
                primitive["indices"] = {0: skin, skin: 0}.get(primitive["indices"], primitive["indices"])
                primitive["attributes"] = {k: {0: skin, skin: 0}.get(v, v) for k, v in primitive["attributes"].items()}
        for one in bad["skins"]:
            one["inverseBindMatrices"] = {0: skin, skin: 0}.get(one["inverseBindMatrices"], one["inverseBindMatrices"])
        change(bad)
        t.animate(14, f"a character's {name}", character=t.bench.file(f"own_{name}.glb", glb(bad, small_binary)), codes=(3, 5), says=f"own_{name}.glb", megabytes=700)
    fit(t, 14, "accessor_none.glb", glb({**document, "accessors": []}, binary), 3, "accessors[0]")
    fit(t, 14, "count_zero.glb", glb({**document, "accessors": [document["accessors"][0], {**document["accessors"][1], "count": 0}]}, binary), 4)


def row_15(t):
    """A buffer as data: URI that is shorter than the 4 GB it claims; meshes and parts named again and again."""
    document, binary = mesh_scene(*CUBE)
    document["buffers"] = [{"byteLength": 2**32 - 4, "uri": "data:application/octet-stream;base64,AAAA"}]
    fit(t, 15, "data_uri.glb", glb(document, binary), 3, megabytes=200)
    t.animate(15, "a character's data: URI", character=t.bench.file("own_data_uri.glb", t.changed_small(lambda d: d.update(buffers=document["buffers"]))), codes=3, says="own_data_uri.glb", megabytes=300)
    vertices, faces = grid(120)
    base, binary = mesh_scene(vertices, faces)
    many = {**base, "nodes": [{"mesh": 0} for _ in range(30000)], "scenes": [{"nodes": list(range(30000))}]}
    fit(t, 15, "mesh_30000_times.glb", glb(many, binary), 5, "again and again", megabytes=900)
    again = {**base, "meshes": [{"primitives": base["meshes"][0]["primitives"] * 60000}]}
    fit(t, 15, "primitive_60000_times.glb", glb(again, binary), 5, "again and again", megabytes=900)

    def bones(d):
        bone = next(n for n in d["nodes"] if n["name"].startswith("bone/"))
        d["nodes"] += [{**bone, "name": f"bone/more_{i}"} for i in range(30000)]

    t.animate(15, "a bone 30000 times", character=t.bench.file("bone_30000_times.glb", t.changed_small(bones)), codes=5, says="bone_30000_times.glb", megabytes=900)


def row_16(t):
    """Buffers and pictures outside the file: by path, by URL, by escaped dots."""
    document, binary = mesh_scene(*CUBE)
    for name, uri in (("path", "../../../../etc/passwd"), ("absolute", "/etc/passwd"), ("url", "http://127.0.0.1:9/x"), ("file", "file:///etc/passwd"), ("escaped", "..%2f..%2fetc%2fpasswd"), ("plain", "x.bin")):
        fit(t, 16, f"buffer_{name}.glb", glb({**document, "buffers": [{"byteLength": 64, "uri": uri}]}, binary), 3, "outside")
        t.animate(16, f"a character's buffer by {name}", character=t.bench.file(f"own_buffer_{name}.glb", t.changed_small(lambda d: d["buffers"][0].update(uri=uri))), codes=3, says="outside")
        t.animate(16, f"a character's picture by {name}", character=t.bench.file(f"own_picture_{name}.glb", t.changed_small(lambda d: d.update(images=[{"uri": uri}]))), codes=0)
    for k, name in enumerate(("../ada.bin", "/etc/passwd", "..", ".", "", "http://127.0.0.1/ada.bin", "..%2fada.bin", "none.bin")):
        crowd = t.crowd.parent / f"uri_{k}.gltf"
        crowd.write_text(t.crowd_text().replace('"ada.bin"', f'"{name}"'))
        t.bench.case(16, f"a crowd's buffer '{name}'", ["animate", crowd, t.good_motion, "-o", "{out}/c.glb"], 3, name if name in ("none.bin", "..%2fada.bin") else crowd.name)


def row_17(t):
    """Trees that are none: a node its own child, two parents, chains of a million; JSON within JSON."""
    document, binary = mesh_scene(*CUBE)
    for name, nodes in (("self", [{"mesh": 0, "children": [0]}]), ("ring", [{"mesh": 0, "children": [1]}, {"children": [2]}, {"children": [0]}]),
                        ("two_parents", [{"children": [2]}, {"children": [2]}, {"mesh": 0}]), ("gone", [{"mesh": 0, "children": [77]}]), ("minus", [{"mesh": 0, "children": [-1]}])):
        fit(t, 17, f"tree_{name}.glb", glb({**document, "nodes": nodes}, binary), 3)
    long = {**document, "nodes": [{"children": [i + 1]} for i in range(300000)] + [{"mesh": 0}]}
    fit(t, 17, "tree_long.glb", glb(long, binary), 4, megabytes=600)
    for depth in (100, 15000, 400000):
        for opening, closing in ((b"[", b"]"), (b'{"a":', b"}")):
            deep = opening * depth + b"1" + closing * depth
            text = json.dumps({**document, "extras": "DEEP"}).encode().replace(b'"DEEP"', deep)
            name = f"deep_{depth}_{'list' if opening == b'[' else 'object'}.glb"
            fit(t, 17, name, glb(text, binary), 5, "nested")
            own, own_binary = t.small_parts()
            own["scenes"][0]["extras"]["deep"] = "DEEP"
            bad = t.bench.file("own_" + name, glb(json.dumps(own).encode().replace(b'"DEEP"', deep), own_binary))
            t.animate(17, "own_" + name, character=bad, codes=5, says="nested")
            t.bench.case(17, f"a body {name}", ["fit", bad, "-o", "{out}/c.glb"], 5, "nested")
    for name, change in (("child_of_itself", lambda d: d["nodes"][3].update(children=[3])), ("two_parents", lambda d: d["nodes"][9].update(children=d["nodes"][0]["children"]))):
        t.animate(17, f"a character's {name}", character=t.bench.file(f"own_{name}.glb", t.changed_small(change)), codes=3, says=f"own_{name}.glb")
    deep = "[" * 20000 + "]" * 20000
    crowd = t.bench.file("crowd_deep.gltf", t.crowd_text().replace('{"asset"', '{"extras":' + deep + ',"asset"', 1))
    t.bench.case(17, "a crowd's JSON within JSON", ["animate", crowd, t.good_motion, "-o", "{out}/c.glb"], 5, "nested")


def row_18(t):
    """Weights of skins from elsewhere are not read; whatever they hold does not matter."""
    document, binary = read_glb(t.body)
    weird = struct.pack("<4f", math.nan, -1, 0, 5)
    document["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": 16})
    document["accessors"].append({"bufferView": len(document["bufferViews"]) - 1, "componentType": 5126, "count": 1, "type": "VEC4"})
    document["buffers"][0]["byteLength"] = len(binary) + 16
    document["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = len(document["accessors"]) - 1
    document["scenes"][0].pop("extras", None)
    fit(t, 18, "weights_nan.glb", glb(document, binary + weird), (0, 8), ())


def row_19(t):
    """Inverse bind matrices: singular, not finite, too few, missing."""
    document, binary = t.small_parts()
    accessor = document["accessors"][document["skins"][0]["inverseBindMatrices"]]
    begin = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
    for name, values in (("singular", [0] * 16), ("nan", [math.nan] * 16), ("inf", [math.inf] * 16)):
        bad = binary[:begin] + struct.pack("<16f", *values) + binary[begin + 64:]
        t.animate(19, f"an inverse bind matrix that is {name}", character=t.bench.file(f"bind_{name}.glb", glb(document, bad)), codes=3, says=f"bind_{name}.glb")
    t.animate(19, "too few", character=t.bench.file("bind_few.glb", t.changed_small(lambda d: d["accessors"][d["skins"][0]["inverseBindMatrices"]].update(count=3))), codes=3, says="inverse bind")
    t.animate(19, "none: identity, as glTF has it", character=t.bench.file("bind_none.glb", t.changed_small(lambda d: d["skins"][0].pop("inverseBindMatrices"))), codes=0)
    for what, offset, value in (("singular", 0, bytes(64)), ("nan", 0, struct.pack("<f", math.nan)), ("sheared", 4, struct.pack("<f", 0.5)), ("scaled", 0, struct.pack("<f", 3.0))):
        folder = t.bench.file(f"crowd_bind_{what}")
        folder.mkdir(exist_ok=True)
        for name in ("crowd.gltf", "crowd.shared", "bob.bin", "ada.bin"):
            data = (t.crowd.parent / name).read_bytes()
            (folder / name).write_bytes(data[:offset] + value + data[offset + len(value):] if name == "ada.bin" else data)
        t.bench.case(19, f"a crowd's matrix that is {what}", ["animate", folder / "crowd.gltf", t.good_motion, "-o", "{out}/c.glb"], 3, "crowd.gltf")


def row_21(t):
    """Pictures: giant, cut, of no kind. None is decoded."""
    size = 20000
    head = b"\x89PNG\r\n\x1a\n"
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    giant = head + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(bytes(1 << 20))) + chunk(b"IEND", b"")
    for name, picture in (("giant", giant), ("cut", giant[:40]), ("noise", noise(400))):
        def add(d, picture=picture):
            d["bufferViews"].append({"buffer": 0, "byteOffset": d["buffers"][0]["byteLength"], "byteLength": len(picture)})
            d["images"] = [{"bufferView": len(d["bufferViews"]) - 1, "mimeType": "image/png"}]
            d["buffers"][0]["byteLength"] += len(picture)

        document, binary = t.small_parts()
        add(document)
        t.animate(21, f"a character's picture: {name}", character=t.bench.file(f"picture_{name}.glb", glb(document, binary[:document["buffers"][0]["byteLength"] - len(picture)] + picture)), codes=0, megabytes=700)
        document, binary = read_glb(t.body)
        add(document)
        document["scenes"][0].pop("extras", None)
        fit(t, 21, f"skin_picture_{name}.glb", glb(document, binary[:document["buffers"][0]["byteLength"] - len(picture)] + picture), (0, 8), (), megabytes=900)
    t.animate(21, "pictures that are not there", character=t.bench.file("picture_gone.glb", t.changed_small(lambda d: d.update(images=[{"bufferView": 10**9}], textures=[{"source": 88}]))), codes=0)


def row_23(t):
    """Units: found out from the height, or asked for."""
    for name, scale in (("cm", 100), ("mm", 1000), ("dm", 10)):
        fit(t, 23, f"in_{name}.obj", obj([[c * scale for c in v] for v in t.skin[0]], t.skin[1]), (0, 8), "read as")
    fit(t, 23, "in_inches.obj", obj([[c * 39.37 for c in v] for v in t.skin[0]], t.skin[1]), (0, 4, 8), ())
    fit(t, 23, "giant.obj", obj([[c * 3e5 for c in v] for v in t.skin[0]], t.skin[1]), 4, "no human height")
    fit(t, 23, "speck.obj", obj([[c * 1e-6 for c in v] for v in t.skin[0]], t.skin[1]), 4, "no human height")
    path = t.bench.file("in_feet.obj", obj([[c * 3.2808 for c in v] for v in t.skin[0]], t.skin[1]))
    t.bench.case(23, "feet, said", ["fit", path, "--unit", "ft", "-o", "{out}/c.glb", "--method", "paper"], (0, 8))
    t.bench.case(23, "feet, said wrong", ["fit", path, "--unit", "km", "-o", "{out}/c.glb"], 2)


def row_24(t):
    """Axes: z up, turned round, mirrored."""
    for name, turn in (("z_up", lambda x, y, z: (x, -z, y)), ("backwards", lambda x, y, z: (-x, y, -z)), ("mirrored", lambda x, y, z: (x, y, -z)), ("x_up", lambda x, y, z: (y, -x, z))):
        fit(t, 24, f"{name}.obj", obj([turn(*v) for v in t.skin[0]], t.skin[1]), (0, 8), "mirrored" if name == "mirrored" else "turned")


def row_25(t):
    """Poses: lying down is an axis; arms elsewhere than in the base mesh's pose are refused by name."""
    fit(t, 25, "lying.obj", obj([(x, -z, y) for x, y, z in t.skin[0]], t.skin[1]), (0, 8), "turned")
    fit(t, 25, "arms_up.obj", obj([(x, y + 1.5 * max(0, abs(x) - 0.2), z) for x, y, z in t.skin[0]], t.skin[1]), 4, "arm is turned")
    fit(t, 25, "seated.obj", obj([(x, y, z) if y > 0.5 else (x, 0.5 + 0.1 * y, z + (0.5 - y)) for x, y, z in t.skin[0]], t.skin[1]), 4)


def row_26(t):
    """Flipped triangles: the base mesh's own take their place."""
    fit(t, 26, "flipped.obj", obj(t.skin[0], [f[::-1] for f in t.skin[1]]), (0, 8), ())
    fit(t, 26, "half_flipped.obj", obj(t.skin[0], [f[::-1] if i % 2 else f for i, f in enumerate(t.skin[1])]), (0, 8), ())


def row_27(t):
    """Edges of three faces and faces twice: neither changes the vertices, which are what is taken."""
    vertices, faces = t.skin
    fit(t, 27, "three_faces.obj", obj(vertices, [*faces, (faces[0][0], faces[0][1], 5000), faces[7], faces[7][::-1]]), (0, 8), ())


def row_28(t):
    """Holes: small ones do not matter to a skin in the base mesh's order, missing halves are refused."""
    vertices, faces = t.skin
    fit(t, 28, "small_holes.obj", obj(vertices, faces[:1000] + faces[1030:]), (0, 4, 8), ())
    if t.thorough:
        fit(t, 28, "half.obj", obj(vertices, faces[: len(faces) // 2]), (4, 8), (), seconds=120)


def row_29(t):
    """Skin through skin: arms against the trunk, a belly folded in."""
    fit(t, 29, "arms_in_trunk.obj", obj([(0.8 * x if abs(x) > 0.25 else x, y, z) for x, y, z in t.skin[0]], t.skin[1]), (0, 4, 8), ())
    fit(t, 29, "dented.obj", obj([(x, y, z - 0.25 * math.exp(-((y - 1.05) / 0.06) ** 2 - (x / 0.1) ** 2)) for x, y, z in t.skin[0]], t.skin[1]), (0, 4, 8), ())


def row_30(t):
    """Vertices on their neighbours, triangles of no area, needles."""
    rng = random.Random(30)
    vertices, faces = t.skin
    for count in (10, 1000) if t.thorough else ():
        moved = list(vertices)
        for f in rng.sample(faces, count):
            moved[f[0]] = moved[f[1]]
        fit(t, 30, f"on_neighbours_{count}.obj", obj(moved, faces), (0, 4, 8), (), "ecorche", seconds=60)
    moved = list(vertices)
    for f in rng.sample(faces, 300):
        a, b = moved[f[1]], moved[f[2]]
        moved[f[0]] = tuple(p + 1e-7 * (q - p) for p, q in zip(a, b))
    if t.thorough:
        fit(t, 30, "needles.obj", obj(moved, faces), (0, 4, 8), (), "ecorche", seconds=60)
    moved = list(vertices)
    for f in rng.sample(faces, 40):
        for corner in f[1:]:
            moved[corner] = moved[f[0]]
    fit(t, 30, "points.obj", obj(moved, faces), (0, 4, 8), (), "ecorche", instead=None, seconds=60)


def row_31(t):
    """Vertices and faces after the skin: left out, and said."""
    extra = [(x, y, z) for y in (0, -0.01) for x in (-3, 3) for z in (-3, 3)]
    n = len(t.skin[0])
    fit(t, 31, "with_floor.obj", obj([*t.skin[0], *extra], [*t.skin[1], (n, n + 1, n + 2), (n + 1, n + 3, n + 2)]), (0, 8), "left out")


def row_32(t):
    """Other shells beside the skin, a node each: eyes and clothes are passed over."""
    document, binary = t.scene_of([t.skin, CUBE, CUBE], ["body", "eye", "shirt"])
    fit(t, 32, "with_eyes.glb", glb(document, binary), (0, 8), ())


def part_of(skin, keep):
    """The faces whose corners `keep` all takes, with the vertices that they use."""
    faces = [f for f in skin[1] if all(keep(*skin[0][c]) for c in f)]
    used = sorted({c for f in faces for c in f})
    place = {old: new for new, old in enumerate(used)}
    return [skin[0][c] for c in used], [tuple(place[c] for c in f) for f in faces]


def row_33(t):
    """Clothes with nobody in them."""
    fit(t, 33, "overall.obj", obj(*part_of(t.skin, lambda x, y, z: 0.25 < y < 1.34 and abs(x) < 0.45)), 4, ["overall.obj", "head"], seconds=120)


def row_34(t):
    """An arm, a shank, both legs, the head missing: refused by name."""
    for name, keep, says in (("arm", lambda x, y, z: x < 0.2 or y < 0.84, "left forearm"), ("shank", lambda x, y, z: x < 0.01 or y > 0.45, "left shank"),
                             ("legs", lambda x, y, z: y > 0.75, "foot"), ("head", lambda x, y, z: y < 1.41, "head")):
        if t.thorough or name == "arm":  # each is registered, for 15 s
            fit(t, 34, f"no_{name}.obj", obj(*part_of(t.skin, keep)), 4, [f"no_{name}.obj", says], seconds=120)


def row_35(t):
    """Bodies at the ends of what people are: a fit, or an honest 8."""
    for name, wishes in (("child", ["--age", "6", "--height", "1.15", "--mass", "21"]), ("giant", ["--height", "2.1", "--mass", "130"]), ("old", ["--age", "88", "--height", "1.45", "--mass", "45"])):
        path = t.bench.file(f"{name}.glb")
        if t.bench.run(["body", "new", "--sex", "male", *wishes, "-o", path]).code == 0:
            t.bench.case(35, name, ["fit", path, "-o", "{out}/c.glb", "--method", "paper"], (0, 8))


def row_36(t):
    """Two people in one file."""
    vertices, faces = t.skin
    n = len(vertices)
    beside = [(x + 2, y, z) for x, y, z in vertices]
    fit(t, 36, "two_in_one.obj", obj([*vertices, *beside], [*faces, *[tuple(c + n for c in f) for f in faces]]), 4, "two skins")
    document, binary = t.scene_of([t.skin, (beside, faces)], ["anna", "bella"])
    fit(t, 36, "a_node_each.glb", glb(document, binary), 4, ["two", "bella"])
    document, binary = t.scene_of([t.skin], ["anna"])
    document["nodes"].append({"mesh": 0, "name": "again", "translation": [2, 0, 0]})
    document["scenes"][0]["nodes"].append(1)
    fit(t, 36, "a_mesh_twice.glb", glb(document, binary), 4, "two")


def row_37(t):
    """A cube, a ball, a triangle, one vertex, a plane."""
    ball = [(math.sin(a / 9) * math.cos(b / 3), math.cos(a / 9), math.sin(a / 9) * math.sin(b / 3)) for a in range(28) for b in range(19)]
    for name, mesh in (("cube", CUBE), ("ball", (ball, [(i, i + 1, i + 19) for i in range(len(ball) - 20)])), ("triangle", ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])), ("vertex", ([(0, 0, 0)], [])), ("plane", grid(30)),
                       ("nearly", (t.skin[0][:-1], [f for f in t.skin[1] if max(f) < len(t.skin[0]) - 1]))):
        # A body that lacks a vertex is registered; what is none takes as long to be sure of.
        codes, says = ((0, 8), ()) if name == "nearly" else (4, name)
        # In one kind of file each: registration takes 10 s.
        kinds = {"obj": obj, "ply": ply, "glb": lambda *m: glb(*mesh_scene(*m))}
        for ending in {"ball": ["ply"], "plane": ["obj"], "nearly": ["glb"]}.get(name, kinds if mesh[1] else ["obj", "ply"]):
            if t.thorough or name != "plane":  # row 2 registers one
                fit(t, 37, f"{name}.{ending}", kinds[ending](*mesh), codes, says, instead=REGISTER, seconds=120)
    t.bench.case(37, "a muscle that is a plane", ["template", "resample", t.bench.file("plane_muscle.obj", obj(*grid(30)))], (0, 4))


def row_38(t):
    """All vertices in one place; far away; sizes of 1e30."""
    vertices, faces = t.skin
    fit(t, 38, "one_place.obj", obj([(1, 2, 3)] * len(vertices), faces), 4)
    fit(t, 38, "size_1e30.obj", obj([[1e30 * c for c in v] for v in vertices], faces), 4)
    fit(t, 38, "size_1e300.obj", obj([[1e300 * c for c in v] for v in vertices], faces), (3, 4))
    far = "".join(f"v {x + 1e8:.9f} {y - 3e7:.9f} {z + 5e7:.9f}\n" for x, y, z in vertices) + obj([], faces)
    fit(t, 38, "far.obj", far, (0, 4, 8), ())
    flat = [(x, y, 0) for x, y, z in vertices]
    fit(t, 38, "flat.obj", obj(flat, faces), 4)
    line = [(0, y, 0) for x, y, z in vertices]
    fit(t, 38, "line.obj", obj(line, faces), 4)


def row_39(t):
    """Vertices that are not finite, denormal, or as large as numbers get."""
    good = obj(*t.skin).split("\n")
    for name, value in (("nan", "nan"), ("inf", "-inf"), ("infinity", "infinity"), ("overflow", "1e999"), ("hex", "0x1p3")):
        fit(t, 39, f"value_{name}.obj", "\n".join([*good[:77], f"v {value} 0 0", *good[78:]]), 3, ":78")
    for value in ("3.4e38", "1.7e308"):
        fit(t, 39, f"value_{value}.obj", "\n".join([*good[:77], f"v {value} 0 0", *good[78:]]), (3, 4))
    fit(t, 39, "denormal.obj", "\n".join([*good[:77], "v 1e-320 " + " ".join(good[77].split()[2:]), *good[78:]]), (0, 4, 8), ())
    document, binary = mesh_scene(*t.skin)
    fit(t, 39, "value_nan.glb", glb(document, struct.pack("<f", math.nan) + binary[4:]), 3, "not finite")
    fit(t, 39, "value_nan.ply", ply([(math.nan, 0, 0), *t.skin[0][1:]], t.skin[1]), 3, "vertex 0")
    document, binary = t.small_parts()
    begin = document["bufferViews"][document["accessors"][document["meshes"][next(n for n in document["nodes"] if n["name"] == "skin")["mesh"]]["primitives"][0]["attributes"]["POSITION"]]["bufferView"]]["byteOffset"]
    for name, value, codes in (("nan", math.nan, 3), ("1e30", 1e30, 3), ("50_m", 50.0, 3)):
        t.animate(39, f"a character's vertex of {name}", character=t.bench.file(f"own_vertex_{name}.glb", glb(document, binary[:begin] + struct.pack("<f", value) + binary[begin + 4:])), codes=codes, says=f"own_vertex_{name}.glb")


def row_40(t):
    """A mesh of a million triangles that is no body: refused, as a sixteenth of it is in a sixteenth of the time."""
    vertices, faces = grid(700 if t.thorough else 175)
    fit(t, 40, "large.ply", ply(vertices, faces), 4, seconds=120, megabytes=1500)


def row_41(t):
    """A figure of twelve vertices."""
    fit(t, 41, "low.obj", obj(CUBE[0] + [(2, 2, 2), (3, 3, 3), (2, 3, 2), (4, 4, 4)], CUBE[1]), 4, "points are left")


def row_42(t):
    """Points without faces: a cloud, which is registered."""
    fit(t, 42, "points_only.ply", ply(t.skin[0][::3], []), (0, 8), (), instead=REGISTER, seconds=120)


def row_43(t):
    """Another order of vertices; vertices split at seams: strangers' skins of our own shape, which are registered."""
    rng = random.Random(43)
    order = list(range(len(t.skin[0])))
    rng.shuffle(order)
    place = {old: new for new, old in enumerate(order)}
    fit(t, 43, "shuffled.obj", obj([t.skin[0][i] for i in order], [tuple(place[c] for c in f) for f in t.skin[1]]), (0, 8), "registered" if t.thorough else (), instead=REGISTER, seconds=120)
    soup = [v for f in t.skin[1] for v in (t.skin[0][c] for c in f)]
    if t.thorough:
        fit(t, 43, "split.obj", obj(soup, [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(len(t.skin[1]))]), (0, 8), "registered", seconds=120)
