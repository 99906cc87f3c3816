#!/usr/bin/env python3
"""Writes the bad and odd meshes of this folder and expected.tsv: file, outcome, a piece of the message or of a note.

outcome: ok (two triangles, four vertices), input, unfit, limit. Standard library only.
"""
import json
import pathlib
import struct

HERE = pathlib.Path(__file__).parent
ROWS = []


def put(name, data, outcome, needle=""):
    (HERE / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    ROWS.append((name, outcome, needle))


SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

put("empty.obj", "", "input", "empty file")
put("noise.obj", bytes((i * 197 + i * i * 31) % 256 for i in range(600)), "input", "neither OBJ")
put("prose.obj", "It was a bright cold day\nin April, and the clocks\n", "input", "neither OBJ, PLY, STL")
put("truncated_utf16.obj", "v 0 0 0\n".encode("utf-16"), "input", "UTF-16")
put("quad.obj", SQUARE + "f 1 2 3 4\n", "ok")
put("quad_crlf_bom.obj", b"\xef\xbb\xbf" + (SQUARE + "f 1/1 2/2 3/3 4/4\n").replace("\n", "\r\n").encode(), "ok")
put("negative.obj", SQUARE + "f -4 -3 -2 -1\n", "ok")
put("normals.obj", SQUARE + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n", "ok")
put("forward.obj", "f 1 2 3 4\n" + SQUARE, "ok")
put("no_newline.obj", SQUARE + "f 1 2 3 4", "ok")
put("plus_signs.obj", SQUARE.replace(" 1", " +1e0") + "f 1 2 3 4\n", "ok")
put("quad.txt", SQUARE + "f 1 2 3 4\n", "ok", "whatever its ending")
put("material.obj", "mtllib ../../../../etc/passwd\nmtllib file:///etc/passwd\n" + SQUARE + "f 1 2 3 4\n", "ok", "materials are not read")
put("index_zero.obj", SQUARE + "f 0 1 2\n", "input", "index_zero.obj:5: a face corner is 0")
put("index_high.obj", SQUARE + "f 1 2 9\n", "input", "index_high.obj:5: a face corner names vertex 9 of 4")
put("index_back.obj", SQUARE + "f -1 -2 -9\n", "input", "counts back beyond")
put("index_2_31.obj", SQUARE + "f 1 2 2147483648\n", "input", "index_2_31.obj:5")
put("index_2_70.obj", SQUARE + "f 1 2 1180591620717411303424\n", "input", "index_2_70.obj:5")
put("index_word.obj", SQUARE + "f 1 2 x\n", "input", "index_word.obj:5")
put("index_half.obj", SQUARE + "f 1 2 3.5\n", "input", "index_half.obj:5")
put("short_vertex.obj", "v 0 0\n", "input", "short_vertex.obj:1: z is missing")
put("comma.obj", SQUARE.replace("v 1 0", "v 1,5 0") + "f 1 2 3\n", "input", "comma.obj:2: x '1,5' is not a finite number")
put("nan.obj", SQUARE.replace("v 1 0", "v nan 0") + "f 1 2 3\n", "input", "nan.obj:2")
put("inf.obj", SQUARE.replace("v 1 0", "v 1e999 0") + "f 1 2 3\n", "input", "inf.obj:2")
put("points.obj", SQUARE, "unfit", "no faces")
put("edges.obj", SQUARE + "f 1 2\nf 3\nf\n", "unfit", "no faces")
put("repeated.obj", SQUARE + "f 1 1 2\nf 1 2 2 3 3 4 1\n", "ok", "passed over 1 faces")
put("many_corners.obj", SQUARE + "f " + "1 2 3 4 " * 2600 + "\n", "limit", "corners")


def ply(head, body, coding="ascii", vertices=4, faces=1, index="list uchar int vertex_indices", coordinate="float"):
    text = f"ply\nformat {coding} 1.0\ncomment ours\nelement vertex {vertices}\n"
    text += "".join(f"property {coordinate} {axis}\n" for axis in "xyz")
    text += head + f"element face {faces}\nproperty {index}\nend_header\n"
    return text.encode() + (body if isinstance(body, bytes) else body.encode())


CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
TEXT = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"


def binary(order, coordinate="f", index="i"):
    return b"".join(struct.pack(order + "3" + coordinate, *p) for p in CORNERS) + struct.pack(order + "B4" + index, 4, 0, 1, 2, 3)


put("quad.ply", ply("", TEXT), "ok")
put("quad_crlf.ply", ply("", TEXT).replace(b"\n", b"\r\n"), "ok")
put("quad_little.ply", ply("", binary("<"), "binary_little_endian"), "ok")
put("quad_big.ply", ply("", binary(">"), "binary_big_endian"), "ok")
put("quad_double.ply", ply("", binary("<", "d", "H"), "binary_little_endian", coordinate="double", index="list uchar ushort vertex_index"), "ok")
put("quad_colour.ply", ply("property uchar red\n", "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3\n"), "ok")
put("ply_without_ending", ply("", TEXT), "ok", "whatever its ending")
put("count_4e9.ply", ply("", binary("<"), "binary_little_endian", vertices=4000000000), "input", "promises 4000000000")
put("count_minus.ply", ply("", TEXT, vertices=-4), "input", "count_minus.ply:4")
put("count_2_80.ply", ply("", TEXT, vertices=2**80), "input", "count_2_80.ply:4")
put("list_long.ply", ply("", "0 0 0\n1 0 0\n1 1 0\n0 1 0\n255 0 1 2 3\n"), "input", "does not fit")
put("list_minus.ply", ply("", "0 0 0\n1 0 0\n1 1 0\n0 1 0\n-1 0 1 2 3\n", index="list char int vertex_indices"), "input", "does not fit")
put("truncated.ply", ply("", binary("<")[:-3], "binary_little_endian"), "input", "ends before")
put("truncated_ascii.ply", ply("", TEXT[:-4]), "input", "ends before")
put("header_only.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", "input", "header does not end")
put("no_format.ply", b"ply\nelement vertex 1\nproperty float x\nend_header\n0\n", "input", "no format")
put("type.ply", ply("property quaternion q\n", TEXT), "input", "unknown property type")
put("float_count.ply", ply("", TEXT, index="list float int vertex_indices"), "input", "whole type")
put("index_high.ply", ply("", TEXT.replace("2 3", "2 4")), "input", "face 0 names vertex 4 of 4")
put("index_minus.ply", ply("", TEXT.replace("2 3", "2 -1")), "input", "face 0 names vertex -1 of 4")
put("nan_binary.ply", ply("", struct.pack("<f", float("nan")) + binary("<")[4:], "binary_little_endian"), "input", "vertex 0 is not finite")
put("no_z.ply", b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n", "input", "x, y, z")
put("points.ply", ply("", TEXT, faces=0), "unfit", "no faces")
put("bytes_ff_fe.ply", ply("", b"\xff\xfe\x00\x00" + binary("<")[4:], "binary_little_endian"), "ok")


def glb(root, data=b"", length=None, first=0x4E4F534A, version=2):
    text = (root if isinstance(root, str) else json.dumps(root)).encode()
    text += b" " * (-len(text) % 4)
    out = struct.pack("<II", len(text), first) + text
    if data:
        data += b"\0" * (-len(data) % 4)
        out += struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<4sII", b"glTF", version, 12 + len(out) if length is None else length) + out


DATA = b"".join(struct.pack("<3f", *p) for p in CORNERS) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)


def scene(**changes):
    root = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(DATA)}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0, "name": "skin"}],
    }
    for path, value in changes.items():
        spot = root
        *way, last = [int(k) if k.isdigit() else k for k in path.split("__")]
        for key in way:
            spot = spot[key]
        spot[last] = value
    return root


put("quad.glb", glb(scene(), DATA), "ok")
put("quad_nodes.glb", glb(scene(nodes=[{"children": [1], "scale": [2, 2, 2]}, {"mesh": 0, "translation": [1, 2, 3]}]), DATA), "ok")
put("quad_image.glb", glb(scene(images=[{"uri": "../../../etc/passwd"}, {"bufferView": 99}], textures=[{"source": 77}]), DATA), "ok")
put("glb_named.obj", glb(scene(), DATA), "ok", "whatever its ending")
put("header_only.glb", b"glTF\x02\0\0\0", "input", "truncated")
put("length_high.glb", glb(scene(), DATA, length=99999), "input", "promises 99999 bytes")
put("version_1.glb", glb(scene(), DATA, version=1), "input", "version 1")
put("chunk_type.glb", glb(scene(), DATA, first=0x004E4942), "input", "not JSON")
put("chunk_beyond.glb", glb(scene(), DATA)[:12] + struct.pack("<I", 0x7FFFFFFF) + glb(scene(), DATA)[16:], "input", "beyond the file")
put("json_only.glb", glb(scene()), "input", "beyond the binary chunk")
put("json_broken.glb", glb('{"asset": {"version": "2.0"', DATA), "input", "parse error")
put("json_array.glb", glb("[]", DATA), "input", "no object")
put("json_deep.glb", glb("[" * 1000, DATA), "limit", "deeper than 64")
put("no_mesh.glb", glb({"asset": {"version": "2.0"}}), "unfit", "no mesh")
put("count_2_62.glb", glb(scene(accessors__0__count=2**62), DATA), "limit", "accessor 0")
put("count_high.glb", glb(scene(accessors__0__count=5), DATA), "input", "too short")
put("count_zero.glb", glb(scene(accessors__1__count=0), DATA), "unfit", "no faces")
put("count_negative.glb", glb(scene(accessors__0__count=-4), DATA), "input", "count")
put("offset_wrap.glb", glb(scene(bufferViews__0__byteOffset=2**64 - 8), DATA), "input", "beyond the binary chunk")
put("stride_small.glb", glb(scene(bufferViews__0__byteStride=4), DATA), "input", "stride 4")
put("stride_large.glb", glb(scene(bufferViews__0__byteStride=252), DATA), "input", "too short")
put("index_high.glb", glb(scene(), DATA[:-2] + b"\x09\x00"), "input", "names vertex 9 of 4")
put("accessor_gone.glb", glb(scene(meshes__0__primitives__0__indices=7), DATA), "input", "accessors[7]")
put("float_indices.glb", glb(scene(accessors__1__componentType=5126), DATA), "input", "bufferView 1")
put("sparse.glb", glb(scene(accessors__0__sparse={"count": 2**40}), DATA), "input", "sparse")
put("data_uri_4gb.glb", glb(scene(buffers=[{"uri": "data:;base64,AAAA", "byteLength": 2**32}]), DATA), "input", "beyond the binary chunk")
put("uri_traversal.glb", glb(scene(buffers=[{"uri": "..%2f..%2fetc%2fpasswd", "byteLength": 60}]), DATA), "input", "outside the file")
put("uri_http.glb", glb(scene(buffers=[{"uri": "http://localhost/x.bin", "byteLength": 60}]), DATA), "input", "outside the file")
put("node_self.glb", glb(scene(nodes=[{"mesh": 0, "children": [0]}]), DATA), "input", "ancestors")
put("node_cycle.glb", glb(scene(nodes=[{"mesh": 0, "children": [1]}, {"children": [0]}]), DATA), "input", "ancestors")
put("node_two_parents.glb", glb(scene(nodes=[{"children": [2]}, {"children": [2]}, {"mesh": 0}]), DATA), "input", "more than one node")
put("node_gone.glb", glb(scene(nodes=[{"mesh": 0, "children": [9]}]), DATA), "input", "node 9")
put("rotation_zero.glb", glb(scene(nodes=[{"mesh": 0, "rotation": [0, 0, 0, 0]}]), DATA), "input", "zero quaternion")
put("nan.glb", glb(scene(), b"\0\0\xc0\x7f" + DATA[4:]), "input", "not finite")
put("compressed.glb", glb(scene(meshes__0__primitives__0__extensions={"KHR_draco_mesh_compression": {}}), DATA), "input", "compression")

(HERE / "expected.tsv").write_text("".join("\t".join(row) + "\n" for row in sorted(ROWS)))
