"""Bad scans and strangers' scenes: rows 22 (FBX) and 81 to 85 (OFF, PCD, STL, .gltf, COLLADA), some forty files and more each."""
import base64
import json
import math
import struct

from bench import THOROUGH
from files import CUBE, noise, stl

BAD, CANNOT, LIMIT = 3, 4, 5
ANY = (BAD, CANNOT, LIMIT)  # a damaged file may still be a cube, which is no body


def damaged(good, name, ending, cuts=24, changes=24):
    """Copies cut and changed at places spread over the file; the last ones may still be read, and be no body. A fifth of them, unless --thorough."""
    step = 1 if THOROUGH else 5
    for k in range(0, cuts, step):
        yield f"{name}_cut_{k}.{ending}", good[: len(good) * k // cuts] or b"\n", ANY, ()
    for k in range(0, changes, step):
        at = len(good) * k // changes
        yield f"{name}_changed_{k}.{ending}", good[:at] + bytes([good[at] ^ (0x10 if k % 2 else 0xFF)]) + good[at + 1:], ANY, ()


# --- OFF ----------------------------------------------------------------------------------------------------------------------------------

def off(vertices=CUBE[0], faces=CUBE[1], keyword="OFF", counts=None, more=""):
    counts = counts or f"{len(vertices)} {len(faces)} 0"
    return (f"{keyword}\n{counts}\n" + "".join(f"{x} {y} {z}{more}\n" for x, y, z in vertices) + "".join(f"{len(f)} " + " ".join(map(str, f)) + "\n" for f in faces)).encode()


def off_cases():
    for name, counts, codes, says in (("negative", "-8 12 0", BAD, "count"), ("word", "eight 12 0", BAD, "count"), ("fraction", "8.5 12 0", BAD, "count"), ("none", " ", CANNOT, "needed"), ("more_vertices", "9 12 0", BAD, ()),
                                      ("more_faces", "8 13 0", BAD, "ends before"), ("a_billion", "1000000000 12 0", LIMIT, "limit"), ("beyond_64_bits", "99999999999999999999999 12 0", BAD, "count"), ("millions", "100000000 1 0", BAD, "more than the file can hold"),
                                      ("no_faces", "8 0 0", CANNOT, "needed"), ("nothing", "0 0 0", CANNOT, "needed"), ("faces_of_nothing", "0 12 0", BAD, ())):
        yield f"counts_{name}.off", off(counts=counts), codes, says
    good = off().decode()
    for name, line in (("index_high", "3 0 1 8"), ("index_minus", "3 0 1 -1"), ("index_word", "3 0 1 x"), ("index_fraction", "3 0 1 1.5"), ("index_2_40", "3 0 1 1099511627776"), ("size_minus", "-3 0 1 2"), ("size_word", "three 0 1 2")):
        yield f"{name}.off", good.replace("3 0 1 3", line, 1).encode(), BAD, ()
    yield "size_huge.off", good.replace("3 0 1 3", "2000000 0 1 3", 1).encode(), LIMIT, "corners"
    for name, value in (("nan", "nan"), ("inf", "inf"), ("overflow", "1e999"), ("comma", "0,5"), ("hex", "0x1")):
        yield f"value_{name}.off", good.replace("0 0 0\n", f"{value} 0 0\n", 2).replace(f"{value} 0 0\n", "8 12 0\n", 0).encode(), BAD, ()
    yield "four.off", off(keyword="4OFF"), CANNOT, "dimensions"
    yield "n_dimensions.off", off(keyword="nOFF"), CANNOT, "dimensions"
    yield "binary.off", b"OFF BINARY\n" + struct.pack(">3i", 8, 12, 0) + noise(400), CANNOT, "binary OFF"
    yield "keyword_alone.off", b"OFF", BAD, "ends before"
    yield "comments_alone.off", b"OFF\n# 8 12 0\n#\n", BAD, "ends before"
    yield "colour_words.off", off(keyword="COFF", more=" red green blue"), BAD, "not in numbers"
    yield "many_values.off", off(more=" 1" * 40), BAD, ()
    yield "corners_twice.off", off(faces=[(0, 0, 1), (2, 2, 2)]), CANNOT, "needed"
    yield from damaged(off(), "cube", "off")


# --- PCD ----------------------------------------------------------------------------------------------------------------------------------

def pcd(fields="x y z", size="4 4 4", kind="F F F", count="1 1 1", width="8", height="1", points="8", data="ascii", body=None, more=""):
    if body is None:
        body = "".join(f"{x} {y} {z}\n" for x, y, z in CUBE[0]).encode()
    head = f"# .PCD v0.7\nVERSION 0.7\nFIELDS {fields}\nSIZE {size}\nTYPE {kind}\nCOUNT {count}\nWIDTH {width}\nHEIGHT {height}\nVIEWPOINT 0 0 0 1 0 0 0\n{more}" + (f"POINTS {points}\n" if points else "") + f"DATA {data}\n"
    return head.encode() + body


def pcd_cases():
    raw = b"".join(struct.pack("<3f", *v) for v in CUBE[0])
    planar = struct.pack("<24f", *(v[k] for k in range(3) for v in CUBE[0]))
    packed = b"".join(bytes([min(31, len(planar) - k - 1)]) + planar[k:k + 32] for k in range(0, len(planar), 32))

    def squeezed(data, size=None, whole=96):
        return pcd(data="binary_compressed", body=struct.pack("<II", len(data) if size is None else size, whole) + data)

    for name, data in (("ascii", pcd()), ("binary", pcd(data="binary", body=raw)), ("compressed", squeezed(packed))):
        yield f"points_{name}.pcd", data, CANNOT, "needed"
    for name, changes, codes, says in (
            ("no_z", {"fields": "x y w"}, BAD, "x, y and z"), ("x_twice", {"fields": "x x z"}, BAD, "x, y and z"), ("no_fields", {"fields": ""}, BAD, ()), ("size_3", {"size": "3 4 4"}, BAD, "bytes"), ("size_9", {"size": "9 4 4"}, BAD, "size"),
            ("size_word", {"size": "four 4 4"}, BAD, "size"), ("size_short", {"size": "4 4"}, BAD, "size"), ("type_s", {"kind": "S F F"}, BAD, "type"), ("type_half", {"size": "2 4 4"}, BAD, "bytes"), ("count_2", {"count": "2 1 1"}, BAD, "values a point"),
            ("count_0", {"count": "0 1 1"}, BAD, "values a point"), ("count_minus", {"count": "-1 1 1"}, BAD, "count"), ("count_huge", {"count": "99999999999 1 1"}, BAD, "count"), ("width_minus", {"width": "-8"}, BAD, "width"),
            ("width_huge", {"width": "4000000000", "points": "4000000000"}, LIMIT, "limit"), ("area_huge", {"width": "100000000", "height": "100000000", "points": ""}, LIMIT, "limit"), ("points_other", {"points": "9"}, BAD, "9 points"),
            ("points_word", {"points": "many"}, BAD, "points"), ("points_more", {"width": "9", "points": "9"}, BAD, "ends before"), ("none", {"width": "0", "points": "0"}, CANNOT, "points"), ("data_other", {"data": "base64"}, BAD, "coding"),
            ("statement", {"more": "COLOUR red\n"}, BAD, "unknown statement"), ("binary_short", {"data": "binary", "body": raw[:-1]}, BAD, "promised"), ("binary_empty", {"data": "binary", "body": b""}, BAD, "promised"),
            ("many_fields", {"fields": "x y z " + "f " * 300}, BAD, "256 fields")):
        yield f"{name}.pcd", pcd(**changes), codes, says
    for name, data, says in (("no_sizes", pcd(data="binary_compressed", body=b"\1\2"), "sizes"), ("beyond", squeezed(packed, size=10**6), "promised"), ("whole_other", squeezed(packed, whole=97), "uncompressed"), ("bomb", pcd(width="100000000", points="100000000", data="binary_compressed", body=struct.pack("<II", 3, 1200000000) + b"\xff\xff\xff"), "cannot hold"),
                             ("before_beginning", squeezed(b"\x20\x05" + packed), "before its beginning"), ("run_cut", squeezed(packed[:-3]), "ends within"), ("too_much", squeezed(packed + packed), "more than"), ("too_little", squeezed(packed[:33]), "less than"), ("long_run", squeezed(b"\0\0\xe0\xff\0"), "more than")):
        yield f"lzf_{name}.pcd", data, BAD, says
    for name, line in (("word", "a b c"), ("short", "1 2"), ("empty", "")):
        yield f"ascii_{name}.pcd", pcd(body=(line + "\n").encode() * 8), BAD, ()
    yield "all_nan.pcd", pcd(body=b"nan nan nan\n" * 8), CANNOT, "finite"
    yield "no_data.pcd", pcd().split(b"DATA")[0], BAD, "DATA"
    yield from damaged(squeezed(packed), "cloud", "pcd")


# --- STL ----------------------------------------------------------------------------------------------------------------------------------

def stl_cases():
    triangles = [tuple(CUBE[0][c] for c in f) for f in CUBE[1]]
    good = stl(triangles, b"cube")
    text = "solid cube\n" + "".join("facet normal 0 0 1\nouter loop\n" + "".join("vertex {} {} {}\n".format(*p) for p in t) + "endloop\nendfacet\n" for t in triangles) + "endsolid cube\n"
    for name, count in (("more", 13), ("many", 4000000000), ("none", 0), ("minus", 0xFFFFFFFF)):
        yield f"count_{name}.stl", stl(triangles, b"cube", count), BAD, ()
    for name, value in (("nan", math.nan), ("inf", math.inf), ("minus_inf", -math.inf)):
        yield f"value_{name}.stl", stl([((value, 0, 0), (1, 0, 0), (0, 1, 0)), *triangles], b"cube"), BAD, "not finite"
        yield f"text_{name}.stl", text.replace("vertex 0 0 0", f"vertex {value} 0 0", 1), BAD, "three numbers"
    for name, old, new in (("word", "vertex 0 0 0", "vertex a b c"), ("comma", "vertex 0 0 0", "vertex 0,0 0 0"), ("two_numbers", "vertex 0 0 0\n", "vertex 0 0\n"), ("two_corners", "vertex 0 0 0\n", ""), ("overflow", "vertex 0 0 0", "vertex 1e999 0 0")):
        yield f"text_{name}.stl", text.replace(old, new, 1), BAD, ()
    yield "no_corners.stl", "solid cube\nfacet normal 0 0 1\nendfacet\nendsolid\n", BAD, "corners"
    yield "header_alone.stl", good[:84], BAD, ()
    yield "flat_points.stl", stl([((0, 0, 0), (0, 0, 0), (1, 1, 1))] * 3, b"cube"), CANNOT, "needed"
    yield "float_overflow.stl", text.replace("vertex 0 0 0", "vertex 1e300 0 0", 1), BAD, "not finite"
    yield from damaged(good, "cube", "stl", cuts=30, changes=20)
    yield from damaged(text.encode(), "text", "stl", cuts=10, changes=20)


# --- glTF as text -------------------------------------------------------------------------------------------------------------------------

def gltf(change=lambda d: None, binary=None):
    positions = b"".join(struct.pack("<3f", *v) for v in CUBE[0])
    corners = b"".join(struct.pack("<3H", *f) for f in CUBE[1])
    data = positions + corners if binary is None else binary
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "cube"}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"}, {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
                "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}], "buffers": [{"byteLength": 168, "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}
    change(document)
    return json.dumps(document).encode()


def skinned(change=lambda d: None):
    def bind(d):
        joints = bytes(32)
        weights = struct.pack("<4f", 1, 0, 0, 0) * 8
        raw = base64.b64decode(d["buffers"][0]["uri"].split(",")[1]) + joints + weights
        d["buffers"] = [{"byteLength": len(raw), "uri": "data:;base64," + base64.b64encode(raw).decode()}]
        d["bufferViews"] += [{"buffer": 0, "byteOffset": 168, "byteLength": 32}, {"buffer": 0, "byteOffset": 200, "byteLength": 128}]
        d["accessors"] += [{"bufferView": 2, "componentType": 5121, "count": 8, "type": "VEC4"}, {"bufferView": 3, "componentType": 5126, "count": 8, "type": "VEC4"}]
        d["meshes"][0]["primitives"][0]["attributes"].update(JOINTS_0=2, WEIGHTS_0=3)
        d["nodes"] += [{"name": "joint"}]
        d["nodes"][0]["skin"] = 0
        d["skins"] = [{"joints": [1]}]
        change(d)

    return gltf(bind)


def gltf_cases():
    def uri(text):
        return lambda d: d["buffers"][0].update(uri=text)

    for name, text in (("parent", "../secret.bin"), ("coded_parent", "..%2fsecret.bin"), ("absolute", "/etc/passwd"), ("address", "http://localhost/x.bin"), ("file_address", "file:///etc/passwd"), ("gone", "gone.bin"), ("empty", ""), ("folder", "."), ("itself_folder", "sub/x.bin"), ("zero", "x\0.bin"), ("backslash", "..\\x.bin"),
                       ("not_base64", "data:;base64,####"), ("no_comma", "data:;base64"), ("plain_data", "data:,hello"), ("short_base64", "data:;base64,AAAA"), ("odd_base64", "data:;base64,AAAAA")):
        yield f"uri_{name}.gltf", gltf(uri(text)), BAD, f"uri_{name}.gltf"
    for name, change, codes in (
            ("uri_number", uri(7), BAD), ("no_buffer", lambda d: d.pop("buffers"), BAD), ("no_uri", lambda d: d["buffers"][0].pop("uri"), BAD), ("view_beyond", lambda d: d["bufferViews"][0].update(byteLength=1000), BAD), ("offset_wrap", lambda d: d["bufferViews"][1].update(byteOffset=2**64 - 8), BAD),
            ("count_high", lambda d: d["accessors"][0].update(count=9), BAD), ("count_2_62", lambda d: d["accessors"][0].update(count=2**62), LIMIT), ("component", lambda d: d["accessors"][0].update(componentType=5124), BAD), ("shape", lambda d: d["accessors"][0].update(type="VEC2"), BAD),
            ("shape_number", lambda d: d["accessors"][0].update(type=3), BAD), ("stride", lambda d: d["bufferViews"][0].update(byteStride=4), BAD), ("accessor_gone", lambda d: d["meshes"][0]["primitives"][0].update(indices=9), BAD), ("corner_high", lambda d: d["accessors"][0].update(count=4), BAD),
            ("no_attributes", lambda d: d["meshes"][0]["primitives"][0].pop("attributes"), BAD), ("mesh_gone", lambda d: d["nodes"][0].update(mesh=5), BAD), ("own_child", lambda d: d["nodes"][0].update(children=[0]), BAD), ("child_gone", lambda d: d["nodes"][0].update(children=[7]), BAD),
            ("matrix_short", lambda d: d["nodes"][0].update(matrix=[1] * 15), BAD), ("matrix_words", lambda d: d["nodes"][0].update(matrix=["1"] * 16), BAD), ("rotation_zero", lambda d: d["nodes"][0].update(rotation=[0, 0, 0, 0]), BAD), ("scale_1e200", lambda d: d["nodes"][0].update(scale=[1e308] * 3, translation=[1e308] * 3), (BAD, CANNOT)),
            ("draco", lambda d: d["meshes"][0]["primitives"][0].update(extensions={"KHR_draco_mesh_compression": {}}), BAD), ("meshopt", lambda d: d["bufferViews"][0].update(extensions={"EXT_meshopt_compression": {}}), BAD), ("no_mesh", lambda d: d["nodes"][0].pop("mesh"), CANNOT), ("lines", lambda d: d["meshes"][0]["primitives"][0].update(mode=1), CANNOT),
            ("sparse_high", lambda d: d["accessors"][0].update(sparse={"count": 1, "indices": {"bufferView": 1, "componentType": 5123, "byteOffset": 2}, "values": {"bufferView": 0}, "x": 0}), ANY), ("sparse_many", lambda d: d["accessors"][0].update(sparse={"count": 99}), BAD), ("sparse_list", lambda d: d["accessors"][0].update(sparse=[1]), BAD),
            ("zeros_many", lambda d: d["accessors"][0].update(count=2**26) or d["accessors"][0].pop("bufferView"), LIMIT), ("primitives_object", lambda d: d["meshes"][0].update(primitives={}), BAD), ("uv_short", lambda d: d["meshes"][0]["primitives"][0]["attributes"].update(TEXCOORD_0=1), BAD), ("colour_scalar", lambda d: d["meshes"][0]["primitives"][0]["attributes"].update(COLOR_0=1), BAD)):
        yield f"{name}.gltf", gltf(change), codes, f"{name}.gltf"
    for name, change in (("joint_gone", lambda d: d["skins"][0].update(joints=[9])), ("no_joints", lambda d: d["skins"][0].update(joints=[])), ("joints_word", lambda d: d["skins"][0].update(joints=["a"])), ("skin_gone", lambda d: d["nodes"][0].update(skin=3)), ("binds_gone", lambda d: d["skins"][0].update(inverseBindMatrices=77)),
                         ("binds_shape", lambda d: d["skins"][0].update(inverseBindMatrices=0))):
        yield f"skin_{name}.gltf", skinned(change), BAD, f"skin_{name}.gltf"
    yield "nested.gltf", b'{"a":' * 3000 + b"1" + b"}" * 3000, LIMIT, "nested"
    yield "many_values.gltf", b'{"a":[' + b"1," * 20000000 + b"1]}", LIMIT, "values"
    yield "array.gltf", b"{}", CANNOT, "no mesh"
    yield "unclosed.gltf", gltf()[:-1], BAD, "unclosed.gltf"
    yield from damaged(gltf(), "cube", "gltf")


# --- COLLADA ------------------------------------------------------------------------------------------------------------------------------

def dae(positions=None, corners=None, count=None, extra="", body=None):
    positions = positions or " ".join(str(c) for v in CUBE[0] for c in v)
    corners = corners or " ".join(str(c) for f in CUBE[1] for c in f)
    body = body or (f'<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="{count or 24}">{positions}</float_array><technique_common><accessor source="#a" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>'
                    f'<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>{corners}</p></triangles></mesh></geometry></library_geometries>{extra}'
                    '<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene>')
    return f'<?xml version="1.0"?>\n<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="0.01"/><up_axis>Z_UP</up_axis></asset>{body}</COLLADA>\n'.encode()


def dae_cases():
    good = dae()
    for name, data in (("corner_high", dae(corners="0 1 99 " * 12)), ("corner_minus", dae(corners="0 1 -1 " * 12)), ("corner_words", dae(corners="a b c " * 12)), ("corners_few", dae(corners="0 1 2")), ("count_high", dae(count=2400000000)), ("count_minus", dae(count=-24)), ("value_nan", dae(positions="nan " * 24)), ("value_words", dae(positions="x " * 24)),
                       ("value_overflow", dae(positions="1e999 " * 24)), ("no_scene", good.split(b"<scene>")[0] + b"</COLLADA>"), ("no_geometry", dae(body="<scene/>")), ("nothing", dae(body=" ")), ("source_gone", good.replace(b'source="#p"', b'source="#q"')), ("accessor_gone", good.replace(b'source="#a"', b'source="#b"')), ("geometry_gone", good.replace(b'url="#g"', b'url="#h"')),
                       ("scene_gone", good.replace(b'url="#s"', b'url="#t"')), ("stride_0", good.replace(b'stride="3"', b'stride="0"')), ("stride_high", good.replace(b'stride="3"', b'stride="3000000"')), ("offset_high", good.replace(b'offset="0"', b'offset="400000"')), ("unit_0", good.replace(b"0.01", b"0")), ("unit_nan", good.replace(b"0.01", b"nan")), ("version", good.replace(b"1.4.1", b"9.9")),
                       ("triangles_many", good.replace(b'triangles count="12"', b'triangles count="4000000000"')), ("entities", b'<?xml version="1.0"?><!DOCTYPE c [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>' + dae(positions="&b;")[22:]), ("outside", b'<?xml version="1.0"?><!DOCTYPE c [<!ENTITY a SYSTEM "file:///etc/passwd">]>' + dae(positions="&a;")[22:]),
                       ("nested", dae(extra="<node>" * 20000 + "</node>" * 20000)), ("own_node", good.replace(b"<instance_geometry", b'<instance_node url="#n"/><instance_geometry')), ("not_closed", good[:-12])):
        yield f"{name}.dae", data, ANY, f"{name}.dae"
    yield "no_collada.dae", b"<?xml version='1.0'?>\n<scene/>\n", BAD, "neither OBJ"
    yield "no_collada_long.dae", b"<?xml version='1.0'?>\n<x>" + b"<y/>" * 30000 + b"<COLLADA/></x>", BAD, "neither OBJ"
    yield from damaged(good, "cube", "dae", cuts=16, changes=20)


# --- FBX ----------------------------------------------------------------------------------------------------------------------------------

class Fbx:
    """Writes binary FBX of 32-bit offsets."""

    @staticmethod
    def value(v):
        if isinstance(v, str):
            return b"S" + struct.pack("<I", len(v)) + v.encode("latin-1")
        if isinstance(v, int):
            return b"L" + struct.pack("<q", v)
        if isinstance(v, float):
            return b"D" + struct.pack("<d", v)
        kind, data = v
        if kind == b"I":
            return b"I" + struct.pack("<i", data)
        return kind + struct.pack("<III", len(data), 0, 8 * len(data) if kind == b"d" else 4 * len(data)) + struct.pack(f"<{len(data)}{'d' if kind == b'd' else 'i'}", *data)

    @classmethod
    def node(cls, at, name, values=(), children=()):
        properties = b"".join(cls.value(v) for v in values)
        head = 13 + len(name)
        inner = b""
        for child in children:
            inner += cls.node(at + head + len(properties) + len(inner), *child)
        if children:
            inner += bytes(13)
        return struct.pack("<IIIB", at + head + len(properties) + len(inner), len(values), len(properties), len(name)) + name.encode() + properties + inner

    @classmethod
    def file(cls, nodes, version=7400):
        out = b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", version)
        for node in nodes:
            out += cls.node(len(out), *node)
        return out + bytes(13)


def fbx(vertices=None, corners=None, version=7400, connections=None, settings=None, objects=None):
    vertices = [float(c) for v in CUBE[0] for c in v] if vertices is None else vertices
    corners = [c for f in CUBE[1] for c in (f[0], f[1], ~f[2])] if corners is None else corners
    return Fbx.file([("FBXHeaderExtension", (), [("FBXVersion", ((b"I", version),))]),
                     ("GlobalSettings", (), [("Version", ((b"I", 1000),)), ("Properties70", (), settings or [("P", ("UnitScaleFactor", "double", "Number", "", 1.0))])]),
                     ("Objects", (), objects or [("Geometry", (1, "cube\0\x01Geometry", "Mesh"), [("Vertices", ((b"d", vertices),)), ("PolygonVertexIndex", ((b"i", corners),))]), ("Model", (2, "cube\0\x01Model", "Mesh"), [("Version", ((b"I", 232),))])]),
                     ("Connections", (), connections or [("C", ("OO", 2, 0)), ("C", ("OO", 1, 2))])], version)


def fbx_cases():
    good = fbx()
    yield "before_2011.fbx", fbx(version=6100), CANNOT, "version 6100"
    yield "version_0.fbx", fbx(version=0), BAD, "version"
    yield "before_2011_text.fbx", b"; FBX 6.1.0 project file\n\nFBXHeaderExtension:  {\n\tFBXVersion: 6100\n}\n", CANNOT, "version 6100"
    yield "text_no_version.fbx", b"; FBX 7.3.0 project file\n\nFBXHeaderExtension:  {\n}\n", BAD, "version"
    yield "text_open.fbx", b"; FBX 7.3.0 project file\n\nFBXHeaderExtension:  {\n\tFBXVersion: 7300\n" + b"Objects: {" * 50, ANY, "text_open.fbx"
    for name, data in (("version_9999", fbx(version=9999)), ("corner_high", fbx(corners=[0, 1, ~900])), ("corner_none_ends", fbx(corners=[0, 1, 2, 3])), ("corner_minus_all", fbx(corners=[-1] * 9)), ("corners_empty", fbx(corners=[])), ("vertices_empty", fbx(vertices=[])), ("vertices_two", fbx(vertices=[0.0, 1.0])), ("value_nan", fbx(vertices=[math.nan] * 24)),
                       ("value_inf", fbx(vertices=[math.inf] * 24)), ("value_1e300", fbx(vertices=[1e300] * 24)), ("own_child", fbx(connections=[("C", ("OO", 2, 2)), ("C", ("OO", 1, 2))])), ("circle", fbx(connections=[("C", ("OO", 2, 1)), ("C", ("OO", 1, 2)), ("C", ("OO", 2, 0))])), ("object_gone", fbx(connections=[("C", ("OO", 77, 0)), ("C", ("OO", 1, 99))])),
                       ("connection_short", fbx(connections=[("C", ("OO",))])), ("connection_words", fbx(connections=[("C", (1.5, "a", "b"))])), ("no_objects", fbx(objects=[("Nothing", ())])), ("object_short", fbx(objects=[("Geometry", ()), ("Model", ())])), ("unit_nan", fbx(settings=[("P", ("UnitScaleFactor", "double", "Number", "", math.nan))])),
                       ("unit_short", fbx(settings=[("P", ("UnitScaleFactor",))])), ("array_long", good.replace(struct.pack("<III", 24, 0, 192), struct.pack("<III", 2**31, 0, 192))), ("array_bytes", good.replace(struct.pack("<III", 24, 0, 192), struct.pack("<III", 24, 0, 2**31))), ("array_packed", good.replace(struct.pack("<III", 24, 0, 192), struct.pack("<III", 24, 1, 192))),
                       ("array_coding", good.replace(struct.pack("<III", 24, 0, 192), struct.pack("<III", 24, 7, 192))), ("offset_beyond", good[:27] + struct.pack("<I", 2**31) + good[31:]), ("offset_back", good[:27] + struct.pack("<I", 5) + good[31:]), ("noise", good[:27] + noise(3000)), ("nothing", good[:27]), ("zeros", good[:27] + bytes(500))):
        yield f"{name}.fbx", data, ANY, f"{name}.fbx"
    yield from damaged(good, "cube", "fbx", cuts=16, changes=20)


CASES = {81: off_cases, 82: pcd_cases, 83: stl_cases, 84: gltf_cases, 85: dae_cases, 22: fbx_cases}


def run(t, row):
    folder = t.bench.file(f"scans_{row}")
    folder.mkdir(exist_ok=True)
    for name, data, codes, says in CASES[row]():
        path = folder / name
        path.write_bytes(data if isinstance(data, bytes) else data.encode())
        t.bench.case(row, name, ["fit", path, "-o", "{out}/c.glb", "--method", "paper"], codes, says, names=name)


def row_22(t):
    """FBX: lies about lengths, offsets, versions and connections."""
    run(t, 22)


def row_81(t):
    """OFF: counts, corners and numbers that lie."""
    run(t, 81)


def row_82(t):
    """PCD: headers, packed runs and points that lie."""
    run(t, 82)


def row_83(t):
    """STL by itself, binary and text."""
    run(t, 83)


def row_84(t):
    """.gltf: buffers elsewhere, accessors, skins."""
    run(t, 84)


def row_85(t):
    """COLLADA: references, counts, entities."""
    run(t, 85)
