#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the seeds of the fuzzers into seeds/<target>/: small files, valid and nearly valid.

The seeds of `step` come from `batten convert` of the json seeds of their names, those of `brep` from those, and from OpenCASCADE's primitives. Crashes that were found stand beside them as found-<what>; this script leaves those alone.
"""
import json
import pathlib
import struct

HERE = pathlib.Path(__file__).parent / "seeds"
POINTS = [(0, 0, 0), (1, 0, 0.5), (0, 1, -0.25), (1, 1, 1e-3), (2.5, -1, 3)]
NAN = float("nan")


def save(target, name, content):
    folder = HERE / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)


def rows(points, separator=" "):
    return "".join(separator.join(f"{x:g}" for x in p) + "\n" for p in points)


# ---- PLY ----
def ply(form, count, properties, body, before="", after=""):
    head = f"ply\nformat {form} 1.0\ncomment a seed\n{before}element vertex {count}\n"
    head += "".join(f"property {p}\n" for p in properties) + after + "end_header\n"
    return head.encode() + (body.encode() if isinstance(body, str) else body)


def plies():
    xyz = [f"float {c}" for c in "xyz"]
    n = len(POINTS)
    save("ply", "ascii", ply("ascii", n, xyz, rows(POINTS)))
    save("ply", "ascii_nan", ply("ascii", 3, xyz, "1 2 3\nnan nan nan\ninf 0 -inf\n"))
    save("ply", "ascii_huge_number", ply("ascii", 1, xyz, "1e308 1 1e-308\n"))
    save("ply", "crlf", ply("ascii", n, xyz, rows(POINTS)).replace(b"\n", b"\r\n"))
    rich = [f"double {c}" for c in "xyz"] + [f"float n{c}" for c in "xyz"]
    rich += ["uchar red", "uchar green", "uchar blue", "double w", "float u", "float v"]
    body = "".join(f"{x} {y} {z} 0 0 1 255 128 0 0.5 {x} {y}\n" for x, y, z in POINTS)
    save("ply", "ascii_rich", ply("ascii", n, rich, body))
    for form, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        f3 = b"".join(struct.pack(order + "3f", *p) for p in POINTS)
        save("ply", form, ply(form, n, xyz, f3))
        save("ply", form + "_short", ply(form, n, xyz, f3[:-3]))
        save("ply", form + "_promises", ply(form, 4 * 10**9, xyz, f3))
        save("ply", form + "_nan", ply(form, 2, xyz, struct.pack(order + "6f", 1, 2, 3, NAN, 0, 0)))
        r = b"".join(struct.pack(order + "3d3f3Bdff", *p, 0, 0, 1, 9, 8, 7, 0.5, 1, 2) for p in POINTS)
        save("ply", form + "_rich", ply(form, n, rich, r))
        kinds = ["char a", "uchar b", "short c", "ushort d", "int e", "uint f", "int64 g",
                 "uint64 h", "float x", "double y", "float32 z"]
        mixed = struct.pack(order + "bBhHiIqQfdf", -1, 1, -2, 2, -3, 3, -4, 4, 1, 2, 3)
        save("ply", form + "_kinds", ply(form, 2, kinds, mixed * 2))
        lists = "element face 2\nproperty list uchar int vertex_indices\nproperty uchar flag\n"
        faces = struct.pack(order + "B3iBB2iB", 3, 0, 1, 2, 1, 2, 4, 5, 0)
        save("ply", form + "_faces_before", ply(form, n, xyz, faces + f3, before=lists))
        many = "element face 1\nproperty list int double far\n"
        save("ply", form + "_list_promises",
             ply(form, n, xyz, struct.pack(order + "i", 2**31 - 1) + f3, before=many))
        minus = struct.pack(order + "i", -1)
        save("ply", form + "_list_negative", ply(form, n, xyz, minus + f3, before=many))
    faces = "element face 1\nproperty list uchar int vertex_indices\n"
    save("ply", "ascii_faces_after", ply("ascii", n, xyz, rows(POINTS) + "3 0 1 2\n", after=faces))
    save("ply", "ascii_faces_before", ply("ascii", n, xyz, "3 0 1 2\n" + rows(POINTS), before=faces))
    save("ply", "promises", ply("ascii", 10**8, xyz, rows(POINTS)))
    save("ply", "promises_more", ply("ascii", 2**63 - 1, xyz, rows(POINTS)))
    save("ply", "promises_elements", ply("ascii", 3, xyz, rows(POINTS), before="element e 1099511627776\n"))
    save("ply", "no_vertex", b"ply\nformat ascii 1.0\nelement face 0\nproperty int a\nend_header\n")
    save("ply", "no_x", ply("ascii", 1, ["float y", "float z"], "1 2\n"))
    save("ply", "no_end", b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n")
    save("ply", "list_in_vertex", ply("ascii", 1, xyz + ["list uchar int more"], "1 2 3 0\n"))


# ---- PCD ----
def pcd(fields, sizes, types, counts, points, data, body, width=None, height=1):
    width = points if width is None else width
    head = f"# .PCD v0.7\nVERSION 0.7\nFIELDS {fields}\nSIZE {sizes}\nTYPE {types}\nCOUNT {counts}\n"
    head += f"WIDTH {width}\nHEIGHT {height}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
    return head.encode() + (body.encode() if isinstance(body, str) else body)


def lzf_literal(data):
    return b"".join(bytes([len(data[k:k + 32]) - 1]) + data[k:k + 32] for k in range(0, len(data), 32))


def pcds():
    xyz, n = ("x y z", "4 4 4", "F F F", "1 1 1"), len(POINTS)
    floats = b"".join(struct.pack("<3f", *p) for p in POINTS)
    columns = b"".join(struct.pack(f"<{n}f", *(p[d] for p in POINTS)) for d in range(3))
    save("pcd", "ascii", pcd(*xyz, n, "ascii", rows(POINTS)))
    save("pcd", "ascii_nan", pcd(*xyz, 2, "ascii", "nan nan nan\n1 2 3\n"))
    save("pcd", "ascii_huge_number", pcd(*xyz, 1, "ascii", "1e308 1 1\n"))
    save("pcd", "ascii_colours", pcd("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 2, "ascii",
                                     "1 2 3 4.2108e+06\n4 5 6 -1e30\n"))
    save("pcd", "organised", pcd(*xyz, 4, "ascii", rows(POINTS[:4]), width=2, height=2))
    save("pcd", "old", b"COLUMNS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n")
    save("pcd", "binary", pcd(*xyz, n, "binary", floats))
    save("pcd", "binary_short", pcd(*xyz, n, "binary", floats[:-1]))
    kinds = ("x _ y z normal_x normal_y normal_z rgba a b c", "8 1 8 4 4 4 4 4 2 1 8",
             "F U F F F F F U I U I", "1 3 1 1 1 1 1 1 2 1 1")
    one = struct.pack("<d3xdf3fI2hBq", 1, 2, 3, 0, 0, 1, 0xff8000, -1, 2, 3, -4)
    save("pcd", "binary_kinds", pcd(*kinds, 2, "binary", one * 2))
    packed = lzf_literal(columns)
    compressed = struct.pack("<II", len(packed), len(columns)) + packed
    save("pcd", "compressed", pcd(*xyz, n, "binary_compressed", compressed))
    save("pcd", "compressed_short", pcd(*xyz, n, "binary_compressed", compressed[:-5]))
    save("pcd", "compressed_damaged", pcd(*xyz, n, "binary_compressed", compressed[:8] + b"\xff" * 60))
    zeros = bytes([0, 0, 0xe0, 255, 0]) * 5
    save("pcd", "compressed_runs", pcd(*xyz, 110, "binary_compressed",
                                       struct.pack("<II", len(zeros), 1320) + zeros))
    save("pcd", "compressed_false_size", pcd(*xyz, n, "binary_compressed",
                                             struct.pack("<II", len(packed), 2**32 - 1) + packed))
    save("pcd", "compressed_promises", pcd(*xyz, 357913941, "binary_compressed",
                                           struct.pack("<II", 2**32 - 1, 4294967292) + packed))
    save("pcd", "promises", pcd(*xyz, 10**9, "ascii", rows(POINTS)))
    save("pcd", "promises_binary", pcd(*xyz, 2**40, "binary", floats))
    save("pcd", "width_times_height", pcd(*xyz, 1, "ascii", "1 2 3\n", width=2**33, height=2**33))
    save("pcd", "promises_elements", pcd("x y z", "4 4 4", "F F F", "1 1 65533", 1, "ascii", "1 2 3\n"))
    save("pcd", "no_data", b"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\n")


# ---- text ----
def texts():
    save("text", "blanks", rows(POINTS))
    save("text", "commas", rows(POINTS, ","))
    save("text", "semicolons", rows(POINTS, " ; "))
    save("text", "tabs_crlf", rows(POINTS, "\t").replace("\n", "\r\n"))
    save("text", "plane", "0 0\n1 0\n1 1\n")
    save("text", "names", "x,y,z,label\n" + "".join(f"{x},{y},{z},1\n" for x, y, z in POINTS))
    save("text", "quoted_names", '"y","x","z","u","v"\n1,2,3,4,5\n6,7,8,9,10\n')
    save("text", "normals", "# x y z nx ny nz w\n1 2 3 0 0 1 0.5\n4 5 6 0 1 0 2 // last\n")
    save("text", "comment_prose", "// points of a scan; metres\n# x y z label(1=ground)\n1 2 3 1\n")
    save("text", "count", "3\n1 2 3\n4 5 6\n7 8 9\n")
    save("text", "count_false", "4294967295\n1 2 3\n")
    save("text", "holes", "1,2,3\n4,,6\n,,\n7,8,nan\ninf,0,0\n")
    save("text", "plus_and_quotes", "+1 '2' \"3\"\n+1e5 -0 .5\n1e-400 2. 3\n")
    save("text", "huge", "1e308 1 1\n")
    save("text", "beyond", "1e999 -1e999 1e-999\n")
    save("text", "bom", b"\xef\xbb\xbfx y z\n1 2 3\n")
    save("text", "utf16", "1 2 3\n".encode("utf-16"))
    save("text", "ragged", "1 2 3\n1 2\n")
    save("text", "words", "1 2 three\n")
    save("text", "weights_zero", "x y z w\n1 2 3 0\n")
    save("text", "far", rows([(5.4e9 + x, 4.3e5 + y, z) for x, y, z in POINTS]).replace("+", ""))
    save("text", "one_column", "1\n2\n3\n")
    save("text", "binary", bytes(range(256)))
    sides = "0 0\n.5 .1\n1 0\n\n0 0\n.5 -.1\n1 0\n"
    save("text", "selig", "NACA 2412 11.7%\n" + sides)
    save("text", "lednicer", "A PROFILE\n  3. 3.\n\n" + sides)
    save("text", "lednicer_short", "3 4\n\n" + sides)
    save("text", "upper_lower", "AN AIRFOIL FILE\n0\tSym Flag (0 - No, 1 - Yes)\n3\tUpper\n3\tLower\n" + sides)
    save("text", "keys", "name: wing 7\norigin: 12 30\nN = 6\n" + sides)
    save("text", "decimal_commas", "Nr;X;Y;Z\nP1;1,5;2,0;-3\nP2;4;5,5;6,25\n")
    save("text", "decimal_later", "1 2 3\n4,5 5 6\n7,5 8,5 9\n")
    save("text", "degrees", "Latitude,LON,height\n47.1,8.5,400\n47.2,8.6,410\n")
    save("text", "date_line", "lon lat\n179.9 -17\n-179.9 -17\n")
    save("text", "no_degrees", "lon,lat\n500,91\n")


# ---- LAS ----
def las(minor, form, count, body, stride=None, size=None, at=None, long_count=0, scale=0.01, mark=b"LASF"):
    sizes, records = (227, 227, 227, 235, 375), (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)
    size = sizes[minor] if size is None else size
    head = bytearray(sizes[minor])
    head[0:4], head[24], head[25] = mark, 1, minor
    struct.pack_into("<HII", head, 94, size, size if at is None else at, 0)
    head[104] = form
    struct.pack_into("<HI", head, 105, records[form & 15] if stride is None else stride, count)
    struct.pack_into("<6d", head, 131, scale, scale, scale, 100, 200, 300)
    if minor == 4:
        struct.pack_into("<Q", head, 247, long_count)
    return bytes(head) + body


def lases():
    records = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)
    for form, length in enumerate(records):
        body = b"".join(struct.pack("<3iH", int(100 * x), int(100 * y), int(100 * z), 7)
                        + bytes([9, 2]) + bytes(range(length - 16)) for x, y, z in POINTS[:3])
        minor = 4 if form > 5 else 3 if form > 3 else 2
        save("las", f"format_{form}", las(minor, form, 0 if form > 5 else 3, body, long_count=3))
    plain = b"".join(struct.pack("<3i8x", k, k * k, -k) for k in range(4))
    save("las", "version_0", las(0, 0, 4, plain))
    save("las", "long_records", las(2, 0, 2, plain, stride=40))
    save("las", "records_after", las(2, 0, 4, b"VLR skipped " + plain, at=239))
    save("las", "short", las(2, 0, 4, plain[:-1]))
    save("las", "short_header", las(2, 0, 4, plain)[:200])
    save("las", "promises", las(2, 0, 2**32 - 1, plain))
    save("las", "promises_2_40", las(4, 6, 0, plain, long_count=2**40))
    save("las", "promises_2_63", las(4, 6, 0, plain, long_count=2**63))
    save("las", "points_far_away", las(2, 0, 4, plain, at=2**32 - 1))
    save("las", "points_in_header", las(2, 0, 4, plain, at=100))
    save("las", "stride_zero", las(2, 0, 4, plain, stride=0))
    save("las", "compressed", las(2, 0x80, 4, plain, stride=20))
    save("las", "scale_nan", las(2, 0, 4, plain, scale=NAN))
    save("las", "scale_huge", las(2, 0, 4, plain, scale=1e308))
    save("las", "scale_zero", las(2, 0, 4, plain, scale=0))


# ---- OBJ, STL, OFF ----
def meshes():
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS)
    save("obj", "vertices", "# a mesh\nmtllib a.mtl\no one\n" + corners + "f 1 2 3\nf 1//1 2//2 -1//-1\n")
    save("obj", "colours", "".join(f"v {x} {y} {z} 1 0.5 0\n" for x, y, z in POINTS))
    save("obj", "normals", corners + "vn 0 0 1\n" * len(POINTS) + "vt 0 0\n")
    save("obj", "some_normals", corners + "vn 0 0 1\n")
    save("obj", "weights", "v 1 2 3 1.0\nv 4 5 6 0.5\n")
    save("obj", "huge_nan", "v 1e308 0 0\nv nan inf -inf\nv 1e999 1 1\n")
    save("obj", "nan", "v nan 0 0\nv 1 2 3\n")
    save("obj", "continued", "v 1 2 \\\n3\nf 1 2 \\\n3\n")
    save("obj", "crlf_tabs", corners.replace(" ", "\t").replace("\n", "\r\n"))
    save("obj", "cut", "v 1 2")

    def facet(a, b, c):
        return struct.pack("<12fH", 0, 0, 1, *a, *b, *c, 0)

    two = facet(*POINTS[:3]) + facet(*POINTS[1:4])
    save("stl", "binary", b"a seed".ljust(80) + struct.pack("<I", 2) + two)
    save("stl", "binary_solid", b"solid but binary".ljust(80) + struct.pack("<I", 2) + two)
    save("stl", "binary_short", b"".ljust(80) + struct.pack("<I", 2) + two[:-3])
    save("stl", "promises", b"".ljust(80) + struct.pack("<I", 2**32 - 1) + two)
    save("stl", "no_facet", b"".ljust(80) + struct.pack("<I", 0))
    save("stl", "binary_nan", b"".ljust(80) + struct.pack("<I", 1) + facet((NAN, 0, 0), (-0.0, 0, 0), (0, 1, 0)))
    loop = "".join(f"      vertex {x:e} {y:e} {z:e}\n" for x, y, z in POINTS[:3])
    text = "  facet normal 0 0 1\n    outer loop\n" + loop + "    endloop\n  endfacet\n"
    save("stl", "ascii", "solid a\n" + text * 2 + "endsolid a\n")
    save("stl", "ascii_two", ("solid\n" + text + "endsolid\n") * 2)
    save("stl", "ascii_capitals", ("solid a\n" + text + "endsolid a\n").upper())
    save("stl", "ascii_no_end", "solid a\n" + text)
    save("stl", "ascii_four_corners", "solid a\n" + text.replace(loop, loop + "vertex 1 1 1\n") + "endsolid\n")
    save("stl", "ascii_huge_nan", "solid a\n" + text.replace("0.000000e+00", "nan", 2) + "endsolid\n")

    n = len(POINTS)
    save("off", "plain", f"OFF\n{n} 1 0\n" + rows(POINTS) + "3 0 1 2\n")
    save("off", "one_line", f"OFF {n} 0 0 # counts\n\n" + rows(POINTS))
    save("off", "no_word", f"{n} 0 0\n" + rows(POINTS))
    save("off", "comments", f"# first\nOFF\n# second\n{n} 0 0\n" + rows(POINTS))
    save("off", "normals", "NOFF\n2 0 0\n1 2 3 0 0 1\n4 5 6 0 1 0\n")
    save("off", "colours", "COFF\n2 0 0\n1 2 3 255 0 0 255\n4 5 6 0.5 1 0 1\n")
    save("off", "all", "STCNOFF\n1 0 0\n1 2 3 0 0 1 255 0 0 255 0.5 0.5\n")
    save("off", "bare_colours", "OFF\n2 0 0\n1 2 3 255 0 0\n4 5 6 0 255 0\n")
    save("off", "promises", "OFF\n4294967295 0 0\n" + rows(POINTS))
    save("off", "promises_2_40", "OFF\n1099511627776 0 0\n" + rows(POINTS))
    save("off", "none", "OFF\n0 0 0\n")
    save("off", "binary", b"OFF BINARY\n\x00\x00\x00\x01")
    save("off", "four", "4OFF\n1 0 0\n1 2 3 4\n")
    save("off", "nan", "OFF\n2 0 0\nnan 0 0\n1 2 1e308\n")
    save("off", "cut", "OFF\n3 0 0\n1 2 3\n1 2")


# ---- geometry JSON ----
def spline(degree, knots, points, weights=None, **more):
    control = {"points": points}
    if weights:
        control["weights"] = weights
    return {"type": "spline", "dimension": len(points[0]), "degree": degree, "knotvector": knots,
            "control_points": control, **more}


def shape(kind, data, **more):
    return json.dumps({"shape": {"type": kind, "count": len(data), "data": data, **more}})


SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]


def patch(**more):
    points = [[i, j, i * j] for i in range(3) for j in range(2)]
    return {"type": "spline", "rational": False, "dimension": 3, "degree_u": 2, "degree_v": 1,
            "knotvector_u": [0, 0, 0, 1, 1, 1], "knotvector_v": [0, 0, 1, 1], "size_u": 3, "size_v": 2,
            "control_points": {"points": points, "weights": [1, 1, 0.5, 0.5, 1, 1]}, **more}


def jsons():
    line = spline(1, [0, 0, 1, 1], [[0, 0, 0], [1, 2, 3]])
    arc = spline(2, [0, 0, 0, 1, 1, 1], [[1, 0], [1, 1], [0, 1]], [1, 0.5**0.5, 1])
    loop = spline(1, [0, 0, 1, 2, 3, 4, 4], [[0.25 + x / 2, 0.25 + y / 2] for x, y in SQUARE], reversed=0)
    quarter = [[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]]
    save("json", "line", shape("curve", [line]))
    save("json", "arc", shape("curve", [arc]))
    save("json", "several", shape("curve", [line, arc]))
    save("json", "patch", shape("surface", [patch()]))
    save("json", "mixed", shape("mixed", [line, patch(), arc]))
    save("json", "trimmed", shape("surface", [patch(trims={"count": 1, "data": [loop]})]))
    outer = spline(1, [0, 0, 1, 2, 3, 4, 4], SQUARE)
    save("json", "hole", shape("surface", [patch(trims={"count": 2, "data": [outer, loop]})]))
    free = {"type": "freeform", "points": quarter + quarter[:1]}
    save("json", "freeform", shape("surface", [patch(trims={"data": [free]})]))
    sides = [spline(1, [0, 0, 1, 1], [quarter[k], quarter[(k + 1) % 4]]) for k in (0, 1, 2, 3)]
    box = {"type": "container", "count": 4, "data": sides}
    save("json", "container", shape("surface", [patch(trims={"count": 1, "data": [box]})]))
    ring = [[1, 0], [0, 1], [-1, 0], [0, -1]]
    save("json", "periodic", shape("curve", [spline(2, list(range(-2, 7)), ring + ring[:2], periodic=[True])]))
    save("json", "single", json.dumps({"shape": {"type": "curve", "count": 1, "data": line}}))
    save("json", "huge", shape("curve", [spline(1, [0, 0, 1, 1], [[1e308, 0], [-1e308, 1]])]))
    save("json", "tiny", shape("curve", [spline(1, [0, 0, 5e-324, 5e-324], [[0, 0], [1e-300, 1]], [5e-324, 1])]))
    save("json", "far_apart", shape("curve", [spline(1, [-1e150, -1e150, 1e150, 1e150], [[0, 0], [1, 1]])]))
    small = patch(trims={"count": 1, "data": [spline(1, [0, 0, 1, 2, 3, 4, 4], [
        [1e-200 * (0.25 + x / 2), 1e-200 * (0.25 + y / 2)] for x, y in SQUARE])]})
    small.update(knotvector_u=[0, 0, 0, 1e-200, 1e-200, 1e-200], knotvector_v=[0, 0, 1e-200, 1e-200])
    save("json", "tiny_domain", shape("surface", [small]))
    save("json", "tiny_weights", shape("curve", [spline(2, [0, 0, 0, 1, 1, 1], [[0, 0], [1, 1], [2, 0]],
                                                        [5e-324, 1e-323, 5e-324])]))
    save("json", "count_false", shape("curve", [line]).replace('"count": 1', '"count": 4294967295'))
    save("json", "size_false", shape("surface", [patch()]).replace('"size_u": 3', '"size_u": 1000000000'))
    save("json", "degree_false", shape("curve", [spline(25, [0, 0, 1, 1], [[0, 0], [1, 1]])]))
    save("json", "nan", shape("curve", [line]).replace("3]", "NaN]"))
    save("json", "deep", '{"shape": ' + "[" * 80 + "]" * 80 + "}")
    save("json", "deep_unknown", '{"other": ' + "[" * 80 + "]" * 80 + "}")
    save("json", "escapes", '{"sh\\u0061pe": {"type": "\\ud83d\\ude00", "data": []}}')
    save("json", "cut", shape("curve", [line])[:-9])
    save("json", "twice", '{"shape": {}, "shape": {}}')


# ---- IGES ----
def iges():
    line = "110,0,0,00000000;0.,0.,0.,1.,2.,3.\n"
    curve = "126,0,0,00000000;2,2,0,0,0,0,0.,0.,0.,1.,1.,1.,1.,.5,1.,0.,0.,0.,1.,1.,0.,2.,0.,1.D0,0.,1.,0.,0.,1.\n"
    net = ",".join(f"{x}.,{y}.,{x * y}." for y in range(2) for x in range(2))
    surface = "128,0,0,{};1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.," + net + ",0.,1.,0.,1.\n"
    free = surface.format("00000000")
    save("iges_entities", "line", line)
    save("iges_entities", "curve", curve)
    save("iges_entities", "part_of_curve", curve.replace("0.,1.,0.,0.,1.\n", ".25,.75,0.,0.,1.\n"))
    save("iges_entities", "surface", free)
    save("iges_entities", "matrix", "124,0,0,00010000;0.,-1.,0.,5.,1.,0.,0.,6.,0.,0.,1.,7.\n"
         + line.replace(",0,0,", ",0,1,", 1))
    part = "110,0,0,00010500;{}\n"
    corners = [(.2, .2), (.8, .2), (.8, .8), (.2, .8)]
    sides = [f"{a},{b},0.,{c},{d},0." for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1])]
    trimmed = surface.format("00010000") + "".join(part.format(s) for s in sides)
    trimmed += "102,0,0,00010500;4,3,5,7,9\n142,0,0,00010000;1,1,11,0,1\n144,0,0,00000000;1,1,0,13\n"
    save("iges_entities", "trimmed", trimmed)
    save("iges_entities", "hole", trimmed.replace("1,1,0,13", "1,0,1,0,13"))
    save("iges_entities", "itself", "102,0,0,00000000;1,1\n")
    save("iges_entities", "matrix_of_itself", "124,0,1,00010000;1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0.\n"
         + line.replace(",0,0,", ",0,1,", 1))
    save("iges_entities", "counts", curve.replace(";2,2,", ";4294967295,2,"))
    save("iges_entities", "many_holes", trimmed.replace("1,1,0,13", "1,1,4294967295,13"))
    save("iges_entities", "other_type", "108,0,0,00000000;0.,0.,1.,0.\n")
    save("iges_entities", "texts", "126,0,0,00000000;5HA,B;C,2,0,0,0,0\n" + line)
    for name in ("line", "curve", "trimmed"):
        save("iges", name, lay_out((HERE / "iges_entities" / name).read_text()))
    whole = lay_out(line)
    save("iges", "no_end", whole[:whole.rindex("\n", 0, -1) + 1])
    save("iges", "crlf", whole.replace("\n", "\r\n"))
    save("iges", "compressed", whole.replace("S      1", "C      1"))
    save("iges", "false_lines", whole.replace("       1       0" + " " * 16, "999999991" + " " * 15, 1))


def lay_out(entities):
    """The file with these entities, in the columns of the format."""
    directory, parameters = [], []
    for text in entities.splitlines():
        head, values = text.split(";", 1)
        kind, form, transform, status = head.split(",")
        values = f"{kind},{values};"
        pieces = [values[k:k + 64] for k in range(0, len(values), 64)]
        directory.append(f"{kind:>8}{len(parameters) + 1:>8}{'':32}{transform:>8}{'':8}{status:>8}")
        directory.append(f"{kind:>8}{'':16}{len(pieces):>8}{form:>8}{'':32}")
        parameters += pieces
    head = "1H,,1H;,1Hf,1Hf,1Hb,1Hb,32,38,6,308,15,1Hf,1.,2,2HMM,1,1.,;"
    sections = (("S", ["a seed"]), ("G", [head]), ("D", directory), ("P", parameters), ("T", ["S1"]))
    return "".join(f"{line:<72}{letter}{k + 1:>7}\n" for letter, lines in sections for k, line in enumerate(lines))


# ---- Faces ----
def polygons():
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
    named = "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
    save("polygons", "obj", "o" + vertices + named)
    save("polygons", "obj_relative", "o" + vertices + "f -4/1/1 -3//2 -2/3 -1 # all\nf 1 2 9\n")
    listed = "".join(f"3 {a} {b} {c}\n" for a, b, c in faces)
    save("polygons", "off", "fOFF\n4 4 0\n" + rows(corners) + listed)
    save("polygons", "off_promises", "fCOFF 1099511627776 4 0\n" + rows(corners) + "99999999 0 1 2\n")
    facets = "".join("facet normal 0 0 1\nouter loop\n"
                     + "".join("vertex {} {} {}\n".format(*corners[k]) for k in face)
                     + "endloop\nendfacet\n" for face in faces)
    save("polygons", "stl", "ssolid s\n" + facets + "endsolid s\n")
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for k in face for x in corners[k]), 0) for face in faces)
    save("polygons", "stl_binary", b"s" + bytes(80) + struct.pack("<I", len(faces)) + records)
    save("polygons", "stl_promises", b"s" + bytes(80) + struct.pack("<I", 2**32 - 1) + records)
    xyz = [f"float {c}" for c in "xyz"]
    after = "element face 4\nproperty uchar flag\nproperty list uchar int vertex_indices\n"
    flagged = rows(corners) + "".join(f"7 {face}\n" for face in listed.splitlines())
    save("polygons", "ply", b"p" + ply("ascii", 4, xyz, flagged, after=after))
    for form, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        body = b"".join(struct.pack(order + "3f", *p) for p in corners)
        body += b"".join(struct.pack(order + "BB3i", 7, 3, *face) for face in faces)
        save("polygons", "ply_" + form, b"p" + ply(form, 4, xyz, body, after=after))
        save("polygons", "ply_" + form + "_short", b"p" + ply(form, 4, xyz, body[:-2], after=after))
    words = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "buffers": [{"byteLength": 60}],
             "nodes": [{"children": [1], "scale": [2, 2, 2]}, {"mesh": 0, "rotation": [0, 0, 1, 0], "translation": [1, 0, 0]}],
             "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
             "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
             "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                           {"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"}]}
    body = b"".join(struct.pack("<3f", *p) for p in corners) + bytes(k for face in faces for k in face)

    def glb(document):
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<2I", len(text), 0x4E4F534A) + text + struct.pack("<2I", len(body), 0x004E4942) + body
        return b"gglTF" + struct.pack("<2I", 2, 12 + len(chunks)) + chunks

    save("polygons", "glb", glb(words))
    strips = {"attributes": {"POSITION": 0}, "mode": 5}
    fans = {"attributes": {"POSITION": 0}, "mode": 6, "indices": 1}
    save("polygons", "glb_strips", glb({**words, "meshes": [{"primitives": [strips, fans]}]}))
    save("polygons", "glb_promises", glb({**words, "accessors": [{**words["accessors"][0], "count": 2**63}, words["accessors"][1]]}))
    save("polygons", "glb_ring", glb({**words, "nodes": [{"children": [1]}, {"children": [0], "mesh": 0}]}))
    save("polygons", "ply_promises", b"p" + ply("ascii", 2**63 - 1, xyz, rows(corners), after=after))


# ---- STEP ----
STEP_HEAD = ("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('s','2024-01-01',(''),(''),'','','');\n"
             "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n")
STEP_END = "ENDSEC;\nEND-ISO-10303-21;\n"


def steps():
    def both(name, data, head=STEP_HEAD, end=STEP_END):
        save("step_syntax", name, head + data + end)

    both("point", "#1=CARTESIAN_POINT('a ''b''',(0.,1.5E-3,-2.));\n")
    both("complex", "#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n#2=A(#1,$,*,\"0AF\",.T.,B(1),((),(1,2)));\n")
    both("comments", "/* a */ #10 = A ( ) ; /* b\n*/\n")
    both("undefined", "#1=A(#2);\n")
    both("twice", "#1=A();\n#1=B();\n")
    both("itself", "#1=A(#2);\n#2=B((#1));\n")
    both("deep", "#1=A(" + "(" * 80 + ")" * 80 + ");\n")
    both("large", "#1=A(4294967295,1E308,1E309);\n#4294967295=B();\n")
    both("open_string", "#1=A('no end);\n")
    both("no_end", "#1=A();\n", end="ENDSEC;\n")
    both("sections", "#1=A();\nENDSEC;\nDATA('second',('X'));\n#2=B(#1);\n")
    both("bom", "#1=A();\n", head="\ufeff" + STEP_HEAD)


if __name__ == "__main__":
    plies()
    pcds()
    texts()
    lases()
    meshes()
    jsons()
    iges()
    polygons()
    steps()
