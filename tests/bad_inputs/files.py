"""Makes the files that the bad ones are made of: meshes, glTF, motions, tables, models. Standard library only."""
import copy
import json
import math
import random
import struct

RANDOM = random.Random(7)


def noise(count):
    return bytes(RANDOM.randrange(256) for _ in range(count))


# --- glTF ---------------------------------------------------------------------------------------------------------------------------------

def read_glb(path):
    data = path.read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    rest = data[20 + size:]
    return json.loads(data[20:20 + size]), rest[8:8 + struct.unpack("<I", rest[:4])[0]] if rest else b""


def glb(document, binary=b"", version=2, length=None, first=b"JSON", json_length=None):
    text = document if isinstance(document, bytes) else json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    out = struct.pack("<I", len(text) if json_length is None else json_length) + first + text
    if binary:
        binary += b"\0" * (-len(binary) % 4)
        out += struct.pack("<I", len(binary)) + b"BIN\0" + binary
    return struct.pack("<4sII", b"glTF", version, 12 + len(out) if length is None else length) + out


def smaller(document, binary, muscles, bones, fascia):
    """The same character with some of its muscles, bones and sheets of fascia: files of it are made and read in no time."""
    document, out = copy.deepcopy(document), bytearray()
    names = [node["name"] for node in document["nodes"]]
    kept_parts = {"bone": bones, "muscle": muscles, "fascia": fascia}
    keep = [name.partition("/")[0] not in kept_parts or name.partition("/")[2] in kept_parts[name.partition("/")[0]] for name in names]
    places = {old: new for new, old in enumerate(i for i, kept in enumerate(keep) if kept)}
    meshes, accessors, views, taken = [], [], [], {}

    def take(index):
        if index in taken:  # primitives of a mesh share their vertices
            return taken[index]
        taken[index] = len(accessors)
        accessor = dict(document["accessors"][index])
        view = dict(document["bufferViews"][accessor["bufferView"]])
        begin = view.get("byteOffset", 0)
        out.extend(b"\0" * (-len(out) % 4))
        view["byteOffset"] = len(out)
        out.extend(binary[begin:begin + view["byteLength"]])
        views.append(view)
        accessors.append({**accessor, "bufferView": len(views) - 1})
        return taken[index]

    nodes = [node for node, kept in zip(document["nodes"], keep) if kept]
    for node in nodes:
        if "children" in node:
            node["children"] = [places[c] for c in node["children"] if c in places]
            if not node["children"]:
                del node["children"]
        if "mesh" in node:
            mesh = document["meshes"][node["mesh"]]
            for primitive in mesh["primitives"]:
                primitive["indices"] = take(primitive["indices"])
                primitive["attributes"] = {name: take(index) for name, index in primitive["attributes"].items()}
            meshes.append(mesh)
            node["mesh"] = len(meshes) - 1
    for skin in document["skins"]:
        skin["joints"] = [places[j] for j in skin["joints"]]
        skin["inverseBindMatrices"] = take(skin["inverseBindMatrices"])
        if "skeleton" in skin:
            skin["skeleton"] = places[skin["skeleton"]]
    for scene in document["scenes"]:
        scene["nodes"] = [places[n] for n in scene["nodes"] if n in places]
    document.update(nodes=nodes, meshes=meshes, accessors=accessors, bufferViews=views, buffers=[{"byteLength": len(out)}])
    return document, bytes(out)


def node_named(document, name):
    return next(node for node in document["nodes"] if node["name"] == name)


def changed(document, change):
    document = copy.deepcopy(document)
    change(document)
    return document


def mesh_scene(vertices, faces, **more):
    """A glTF scene of one mesh: document and binary chunk."""
    binary = b"".join(struct.pack("<3f", *v) for v in vertices) + b"".join(struct.pack("<3I", *f) for f in faces)
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "figure"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 12 * len(vertices)}, {"buffer": 0, "byteOffset": 12 * len(vertices), "byteLength": 12 * len(faces)}],
        "buffers": [{"byteLength": len(binary)}], **more}
    return document, binary


def skin_of(document, binary):
    """Vertices and triangles of the mesh node `skin`."""
    primitive = document["meshes"][node_named(document, "skin")["mesh"]]["primitives"][0]

    def values(index, kind, columns):
        accessor = document["accessors"][index]
        begin = document["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0)
        flat = struct.unpack_from(f"<{accessor['count'] * columns}{kind}", binary, begin)
        return [flat[i:i + columns] for i in range(0, len(flat), columns)]

    corners = [c[0] for c in values(primitive["indices"], "I", 1)]
    return values(primitive["attributes"]["POSITION"], "f", 3), [tuple(corners[i:i + 3]) for i in range(0, len(corners), 3)]


# --- meshes -------------------------------------------------------------------------------------------------------------------------------

def obj(vertices, faces):
    return "".join(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in vertices) + "".join("f " + " ".join(str(c + 1) for c in f) + "\n" for f in faces)


def ply(vertices, faces, order="<", header=None, line="\n"):
    kind = "binary_big_endian" if order == ">" else "binary_little_endian"
    head = header or ["ply", f"format {kind} 1.0", f"element vertex {len(vertices)}", "property float x", "property float y", "property float z",
                      f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    return (line.join(head) + line).encode() + b"".join(struct.pack(order + "3f", *v) for v in vertices) + b"".join(struct.pack(order + "B3i", 3, *f) for f in faces)


def stl(triangles, begin=b"solid trick", count=None):
    return begin.ljust(80, b" ") + struct.pack("<I", len(triangles) if count is None else count) + b"".join(
        struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *p) for p in t) + b"\0\0" for t in triangles)


def grid(n):
    vertices = [(x / n, y / n, math.sin(x / 9) * math.sin(y / 7) / 9) for y in range(n + 1) for x in range(n + 1)]
    faces = [f for y in range(n) for x in range(n) for a in [y * (n + 1) + x] for f in ((a, a + 1, a + n + 2), (a, a + n + 2, a + n + 1))]
    return vertices, faces


CUBE = ([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)],
        [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])


# --- motions ------------------------------------------------------------------------------------------------------------------------------

class Motion:
    """A BVH file in parts: lines of the hierarchy, frames of numbers."""

    def __init__(self, text):
        head, tail = text.split("MOTION", 1)
        self.hierarchy = head.rstrip("\n").split("\n")
        lines = tail.strip("\n").split("\n")
        self.time = lines[1].split(":")[1].strip()
        self.frames = [line.split() for line in lines[2:] if line.strip()]
        self.count = None  # what `Frames:` says; None: the truth

    def but(self, **changes):
        out = copy.deepcopy(self)
        for name, value in changes.items():
            setattr(out, name, value)
        return out

    def first(self, frames):
        return self.but(frames=self.frames[:frames])

    def channel(self, joint, name):
        """The column of a joint's channel."""
        at, inside = 0, None
        for line in self.hierarchy:
            words = line.split()
            if words and words[0] in ("ROOT", "JOINT"):
                inside = " ".join(words[1:])
            if words and words[0] == "CHANNELS":
                if inside == joint:
                    return at + words[2:].index(name)
                at += int(words[1])
        raise KeyError(joint)

    def with_value(self, frame, column, value):
        out = copy.deepcopy(self)
        out.frames[frame][column] = str(value)
        return out

    def text(self):
        count = len(self.frames) if self.count is None else self.count
        return "\n".join(self.hierarchy) + f"\nMOTION\nFrames: {count}\nFrame Time: {self.time}\n" + "".join(" ".join(f) + "\n" for f in self.frames)


def chain(depth, channels="CHANNELS 3 Zrotation Xrotation Yrotation"):
    """Joints within each other."""
    return ("HIERARCHY\nROOT j\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n" + "".join(f"JOINT j{i}\n{{\nOFFSET 0 1 0\n{channels}\n" for i in range(depth))
            + "}\n" * (depth + 1) + "MOTION\nFrames: 1\nFrame Time: 0.04\n" + "0 " * (3 * depth + 3) + "\n")
