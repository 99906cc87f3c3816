"""What the tests of the command line give to the program: parts of characters, motions, scans, models."""
import json
import os
import pathlib
import re
import struct
import sys

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bad_inputs"))
import files  # noqa: E402

# What is kept of a character where an option is tried that does not ask for all of it.
MUSCLES = [f"{name}_{side}" for side in "lr" for name in ("biceps_brachii_long", "biceps_brachii_short", "biceps_femoris_long", "deltoid_middle", "gastrocnemius_lateral", "gastrocnemius_medial", "gluteus_maximus_superior",
                                                          "rectus_abdominis", "rectus_femoris", "soleus", "vastus_lateralis")]
BONES = ["sacrum", "skull", *(f"{name}_{side}" for side in "lr" for name in ("calcaneus", "femur", "fibula", "hip_bone", "humerus", "radius", "scapula", "tibia", "ulna"))]


def write_part(t, source, name, muscles=MUSCLES, bones=BONES):
    """A character with some of its muscles and bones: a run on it takes a third of the time."""
    parts = files.smaller(*files.read_glb(pathlib.Path(t.path(source))), muscles, bones, ("linea_alba",))
    pathlib.Path(t.path(name)).write_bytes(files.glb(*parts))


def short_motion(source, target, frames):
    """The first frames of a BVH file."""
    with open(source, encoding="utf-8") as file:
        lines = file.read().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("Frame Time:")) + 1
    lines = [f"Frames: {frames}" if line.startswith("Frames:") else line for line in lines[:start + frames]]
    with open(target, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def skin_of(data):
    """Positions of the node `skin` of a .glb, as its file has them."""
    length = struct.unpack_from("<I", data, 12)[0]
    doc = json.loads(data[20:20 + length])
    mesh = next(n["mesh"] for n in doc["nodes"] if n.get("name") == "skin")
    primitive = doc["meshes"][mesh]["primitives"][0]

    def read(index, letter, size):
        accessor = doc["accessors"][index]
        view = doc["bufferViews"][accessor["bufferView"]]
        start = 28 + length + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return struct.unpack_from(f"<{accessor['count'] * size}{letter}", data, start), accessor["count"]
    points, count = read(primitive["attributes"]["POSITION"], "f", 3)
    kind = {5123: "H", 5125: "I"}[doc["accessors"][primitive["indices"]]["componentType"]]
    triangles, _ = read(primitive["indices"], kind, 1)
    return points, triangles, count


def write_obj(t, name, scale):
    points, triangles, count = skin_of(t.bytes("anna.glb"))
    lines = [f"v {scale * points[3 * i]:.6f} {scale * points[3 * i + 1]:.6f} {scale * points[3 * i + 2]:.6f}" for i in range(count)]
    lines += [f"f {triangles[i] + 1} {triangles[i + 1] + 1} {triangles[i + 2] + 1}" for i in range(0, len(triangles), 3)]
    return t.write(name, "\n".join(lines) + "\n")


def write_scan(t, source, name, scale):
    """A body's skin as a scanner would have it: vertices in another order, Z up, OBJ or ASCII PLY."""
    points, triangles, count = skin_of(t.bytes(source))
    order = sorted(range(count), key=lambda i: (i * 7919) % count)
    place = {old: new for new, old in enumerate(order)}
    rows = [f"{scale * points[3 * i]:.6f} {-scale * points[3 * i + 2]:.6f} {scale * points[3 * i + 1]:.6f}" for i in order]
    faces = [[place[i] for i in triangles[k:k + 3]] for k in range(0, len(triangles), 3)]
    if name.endswith(".obj"):
        return t.write(name, "".join(f"v {row}\n" for row in rows) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))
    head = f"ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\nproperty float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    return t.write(name, head + "".join(row + "\n" for row in rows) + "".join(f"3 {a} {b} {c}\n" for a, b, c in faces))


def landmark(t, body, name, scale):
    """A landmark of data/body/landmarks.csv where write_scan() puts it."""
    with open(t.data("body", "landmarks.csv"), encoding="utf-8") as file:
        vertex = next(int(line.split(",")[1]) for line in file if line.startswith(name + ","))
    points, _, _ = skin_of(t.bytes(body))
    x, y, z = points[3 * vertex:3 * vertex + 3]
    return [scale * x, -scale * z, scale * y]


def channel_column(text, joint, channel):
    """Column of a joint's channel in the rows of a BVH file; None: it has none."""
    column, found = 0, None
    for name, count, channels in re.findall(r"(?:ROOT|JOINT) (\S+).*?CHANNELS (\d+) ([^\n]*)", text, re.S):
        if name == joint and channel in channels.split():
            found = column + channels.split().index(channel)
        column += int(count)
    return found


def change_column(text, joint, by, channel="Xrotation"):
    column = channel_column(text, joint, channel)
    assert column is not None, joint
    head, rows = text.split("Frame Time:", 1)
    time, rows = rows.split("\n", 1)
    out = []
    for row in rows.strip().splitlines():
        values = row.split()
        values[column] = str(float(values[column]) + by)
        out.append(" ".join(values))
    return head + "Frame Time:" + time + "\n" + "\n".join(out) + "\n"


def leg_joints(text):
    names = re.findall(r"(?:ROOT|JOINT) (\S+)", text)
    return [n for n in names if re.search(r"shin|knee|(?<!up)leg$|lowerleg|calf", n, re.I) and not re.search(r"up", n, re.I)]


def bend_knees(text):
    for joint in leg_joints(text):
        text = change_column(text, joint, -80)
    return text


def cross_legs(text):
    """Thighs turned towards each other."""
    for name in re.findall(r"(?:ROOT|JOINT) (\S+)", text):
        if re.search(r"up.?leg|thigh", name, re.I):
            text = change_column(text, name, -25 if name.lower().startswith("l") or "left" in name.lower() else 25, "Zrotation")
    return text


def sheet_of_cloth(columns, rows, width, length):
    """A rectangle as an OBJ file, laid out in x and z."""
    points = [f"v {width * (c / columns - 0.5):.4f} 0 {length * (r / rows - 0.5):.4f}" for r in range(rows + 1) for c in range(columns + 1)]
    at = lambda r, c: 1 + r * (columns + 1) + c  # noqa: E731
    faces = [f"f {at(r, c)} {at(r + 1, c)} {at(r + 1, c + 1)} {at(r, c + 1)}" for r in range(rows) for c in range(columns)]
    return "\n".join(points + faces) + "\n"


def one_side(model):
    """An OpenSim model without the right side's muscles."""
    return re.sub(r"<(Thelen2003Muscle|Millard2012EquilibriumMuscle) name=\"[^\"]*_r[^\"]*\">.*?</\1>", "", model, flags=re.S)


def spindle():
    """A closed spindle along y, 20 units long."""
    from math import cos, pi, sin
    rings, around = 20, 24
    points, faces = ["v 0 0 0"], []
    for i in range(1, rings):
        y = 20 * i / rings
        r = 2.5 * sin(pi * i / rings)
        points += [f"v {r * cos(2 * pi * k / around):.6f} {y:.6f} {r * sin(2 * pi * k / around):.6f}" for k in range(around)]
    points.append("v 0 20 0")
    at = lambda i, k: 2 + (i - 1) * around + k % around  # noqa: E731
    for k in range(around):
        faces.append(f"f 1 {at(1, k)} {at(1, k + 1)}")
        faces.append(f"f {len(points)} {at(rings - 1, k + 1)} {at(rings - 1, k)}")
        for i in range(1, rings - 1):
            faces += [f"f {at(i, k)} {at(i + 1, k)} {at(i + 1, k + 1)}", f"f {at(i, k)} {at(i + 1, k + 1)} {at(i, k + 1)}"]
    return "\n".join(points + faces) + "\n"
