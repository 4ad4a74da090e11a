# SPDX-License-Identifier: MIT
"""Every format out and in again, and files that can't be read."""
import json
import os
import struct

import numpy as np
import pytest

import batten
from conftest import ITERATED, ROOT, random_curve, random_surface, same_points


@pytest.mark.parametrize("extension", ["ply", "pcd", "xyz", "csv", "txt"])
@pytest.mark.parametrize("attributes", [False, True])
def test_clouds_come_back_bit_by_bit(tmp_path, rng, extension, attributes):
    points = rng.normal(size=(50, 3)) * 1e3
    more = {"normals": rng.normal(size=(50, 3)), "weights": rng.uniform(1, 2, 50)} if attributes else {}
    path = tmp_path / f"cloud.{extension}"
    batten.write_cloud(points, path, **more)
    cloud = batten.read_cloud(path)
    assert np.array_equal(cloud.points, points) and cloud.info["points_in_file"] == 50
    assert cloud.info["files"] == [str(path)]
    if attributes and extension in ("ply", "pcd", "csv"):
        assert np.array_equal(cloud.normals, more["normals"])
        assert np.array_equal(batten.read_cloud(path, columns={"w": "w"}).weights, more["weights"])


def test_plane_clouds_and_colours(tmp_path, rng):
    batten.write_cloud(rng.random((9, 2)), tmp_path / "plane.xyz")
    assert batten.read_cloud(tmp_path / "plane.xyz").dimension == 2
    colours = rng.integers(0, 256, (9, 3)).astype(np.uint8)
    batten.write_cloud(rng.random((9, 3)), tmp_path / "c.ply", colours=colours)
    assert np.array_equal(batten.read_cloud(tmp_path / "c.ply").colours, colours)


@pytest.mark.parametrize("extension", ["obj", "stl", "off"])
def test_vertices_of_meshes(tmp_path, extension):
    mesh = batten.make.sphere(1).tessellate(0.1)
    path = tmp_path / f"mesh.{extension}"
    if extension == "off":
        rows = [f"OFF\n{len(mesh.vertices)} {len(mesh.faces)} 0"]
        rows += [" ".join(map(repr, map(float, v))) for v in mesh.vertices]
        rows += ["3 " + " ".join(map(str, f)) for f in mesh.faces]
        path.write_text("\n".join(rows) + "\n")
    else:
        batten.write_mesh(mesh, path)
    read = batten.read_cloud(path).points
    assert len(read) == len(mesh.vertices)
    assert np.allclose(np.linalg.norm(read, axis=1), 1, atol=1e-6)


def test_las_and_the_data_of_the_project(tmp_path):
    header = bytearray(227)
    header[:4], header[24:26] = b"LASF", bytes([1, 2])
    struct.pack_into("<HIIBHI", header, 94, 227, 227, 0, 0, 20, 3)
    struct.pack_into("<6d", header, 131, *[0.5] * 3, *[100.0] * 3)
    rows = [struct.pack("<iiiHBBbBH", k, 2 * k, 3 * k, 0, 9, kind, 0, 0, 0) for k, kind in enumerate((2, 6, 2))]
    (tmp_path / "a.las").write_bytes(bytes(header) + b"".join(rows))
    assert np.array_equal(batten.read_cloud(tmp_path / "a.las").points, 100 + np.outer(np.arange(3), [0.5, 1, 1.5]))
    assert np.array_equal(batten.read_cloud(tmp_path / "a.las", las_classes=[6]).points, [[100.5, 101, 101.5]])
    panel = batten.read_cloud(os.path.join(ROOT, "data", "panel.ply"))
    assert len(panel) > 1000 and len(batten.read_cloud(os.path.join(ROOT, "data", "hull.xyz"))) > 1000
    two = batten.read_cloud([os.path.join(ROOT, "data", "panel.ply")] * 2)
    assert len(two) == 2 * len(panel) and panel.info["fields"]


def test_triangles_of_a_mesh_count_in_fits_and_comparisons_of_its_path(tmp_path):
    path = tmp_path / "tile.obj"
    path.write_text("v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nf 1 2 3 4\n")
    assert len(batten.read_cloud(path)) == 4
    sampled = batten.read_cloud(path, faces="sampled")
    assert len(sampled) > 19000 and np.array_equal(sampled.points[:4], batten.read_cloud(path).points)
    assert np.abs(sampled.points.mean(axis=0) - [2, 1.5, 0]).max() < 0.01
    assert len(batten.fit_primitive(path, "plane").residuals) == 4
    fit = batten.fit_surface(path)
    mesh = fit.report["input"]["mesh"]
    assert mesh["triangles"] == 2 and mesh["open_edges"] == 4 and mesh["sampled"] == len(sampled) - 4
    assert len(batten.compare(fit.surface, path).distances) == len(sampled)
    with pytest.raises(ValueError, match="faces"):
        batten.read_cloud(path, faces="all")


def test_columns_rows_and_boxes(tmp_path):
    path = tmp_path / "rows.csv"
    path.write_text("a,b,c,label\n1,2,3,1\n4,5,6,2\n7,8,9,1\nnan,1,1,1\n")
    cloud = batten.read_cloud(path, columns={"x": "b", "y": 1, "z": "c"}, where={"label": 1})
    assert np.array_equal(cloud.points, [[2, 1, 3], [8, 7, 9]])
    assert cloud.info["non_finite"] == 1 and cloud.info["filtered"] == 1
    assert len(batten.read_cloud(path, columns={"x": "a", "y": "b", "z": "c"}, box=[0, 0, 0, 5, 6, 7])) == 2
    with pytest.raises(ValueError, match="nosuch"):
        batten.read_cloud(path, columns={"x": "nosuch"})
    with pytest.raises(ValueError, match="box"):
        batten.read_cloud(path, box=[1, 2])


@pytest.mark.parametrize("extension", ["json", "step", "stp", "iges", "igs", "brep", "brp"])
@pytest.mark.parametrize("rational", [False, True])
def test_geometry_comes_back(tmp_path, rng, extension, rational):
    s, c = random_surface(rng, rational=rational), random_curve(rng, rational=rational)
    path = tmp_path / f"shapes.{extension}"
    batten.write_geometry([s, c], path, names=["face", "edge"], unit="inch")
    shapes = batten.read_geometry(path)
    read_s = next(one for one in shapes if isinstance(one, batten.Surface))
    read_c = next(one for one in shapes if isinstance(one, batten.Curve))
    says = not extension.startswith("br")  # B-rep knows neither names nor units
    assert sorted(shapes.names) == (["edge", "face"] if says else ["", ""])
    assert shapes.unit == ("inch" if says else "") and shapes.remarks == []
    assert same_points(s, read_s, ITERATED) and same_points(c, read_c, ITERATED)
    if extension == "json":
        assert read_s == s and read_c == c


def test_methods_write_the_same(tmp_path, rng):
    s = random_surface(rng)
    s.to_step(tmp_path / "a.step", name="lid", unit="m", schema="ap242")
    s.to_iges(tmp_path / "a.iges", name="lid")
    s.to_json(tmp_path / "a.json", name="lid")
    for name in ("a.step", "a.iges", "a.json"):
        read = batten.read_geometry(tmp_path / name)
        assert read.names == ["lid"] and same_points(read[0], s, ITERATED)
    assert batten.read_geometry(tmp_path / "a.step").unit == "m"
    assert batten.read_geometry(tmp_path / "a.step", unit="mm")[0].control_points.max() == pytest.approx(1000 * s.control_points.max())


def cube(gap=0.0):
    """Six faces about the unit cube, each moved out of it by the gap."""
    middle = np.full(3, 0.5)
    for axis in range(3):
        a, b, c = np.roll(np.eye(3), -axis, axis=0)
        for side in (0, 1):
            corners = [side * a, side * a + b, side * a + c, side * a + b + c]
            out = gap * (2 * side - 1) * a
            yield batten.make.bilinear(*(corner + out - middle for corner in corners))


@pytest.mark.parametrize("extension", ["step", "brep"])
def test_surfaces_are_sewn(tmp_path, extension):
    path = tmp_path / f"cube.{extension}"
    faces = list(cube())
    report = batten.write_geometry(faces, path, sew=1e-6)
    assert report == batten.Sewing(6, 1, 0, 0, 0, 12, 0, report.largest_gap, None, True) and report.largest_gap < 1e-12
    read = batten.read_geometry(path)
    assert len(read) == 6 and any("flattened" in words for words in read.remarks)
    box = batten.write_geometry(faces[:5], path, sew=1e-6)
    assert (box.solids, box.shells, box.shared_edges, box.free_edges, box.watertight) == (0, 1, 8, 4, False)
    apart = batten.write_geometry(list(cube(1e-3)), path, sew=1e-6)
    assert apart.loose == 6 and apart.free_edges == 24 and apart.nearest_gap == pytest.approx(np.sqrt(2) * 1e-3)
    near = batten.write_geometry(list(cube(1e-3)), path, sew=1e-2)
    assert near.watertight and 0 < near.largest_gap <= 2e-3
    assert not any("flattened" in words for words in (batten.write_geometry(faces, path, sew=0), batten.read_geometry(path))[1].remarks)


@pytest.mark.parametrize("sew", [-1, "wide", float("nan"), float("inf"), True])
def test_wrong_sewing_is_named(tmp_path, sew):
    with pytest.raises(ValueError, match="sew"):
        batten.write_geometry(list(cube()), tmp_path / "a.step", sew=sew)
    with pytest.raises(ValueError):
        batten.write_geometry(list(cube()), tmp_path / "a.iges", sew=1e-3)
    assert list(tmp_path.iterdir()) == []


def test_trims_come_back(tmp_path):
    disc = batten.make.plane((4, 4)).trim(batten.make.circle(0.25, center=(0.5, 0.5)))[0]
    for extension in ("json", "step", "iges", "brep"):
        batten.write_geometry(disc, tmp_path / f"disc.{extension}")
        (read,) = batten.read_geometry(tmp_path / f"disc.{extension}")
        assert read.area == pytest.approx(np.pi, rel=1e-6)


@pytest.mark.parametrize("extension", ["stl", "obj", "ply", "glb"])
def test_meshes_are_written(tmp_path, extension):
    s = batten.make.sphere(1)
    s.to_mesh(tmp_path / f"a.{extension}", tolerance=0.05)
    mesh = s.tessellate(0.05)
    batten.write_mesh((mesh.vertices, mesh.faces), tmp_path / f"b.{extension}")
    assert (tmp_path / f"a.{extension}").stat().st_size > 1000 and (tmp_path / f"b.{extension}").stat().st_size > 1000
    if extension != "stl":
        batten.write_mesh(mesh, tmp_path / f"c.{extension}", deviations=mesh.vertices[:, 2])


@pytest.mark.parametrize(
    "mesh, words",
    [
        ((np.zeros((3, 3)), [[0, 1, 3]]), "faces"),
        ((np.zeros((3, 3)), [[0, 1, -1]]), "faces"),
        ((np.zeros((3, 3)), [[0.0, 1, 2]]), "faces"),
        ((np.zeros((3, 3)), [0, 1, 2]), "faces"),
        ((np.zeros((3, 2)), [[0, 1, 2]]), "vertices"),
        ((np.full((3, 3), np.nan), [[0, 1, 2]]), "vertices"),
        (7, "mesh"),
        ((1, 2, 3), "mesh"),
    ],
)
def test_wrong_meshes_name_the_part(tmp_path, mesh, words):
    with pytest.raises(ValueError, match=words):
        batten.write_mesh(mesh, tmp_path / "m.ply")
    assert list(tmp_path.iterdir()) == []


def test_read_errors_say_file_and_line(tmp_path):
    path = tmp_path / "a b: c.xyz"
    path.write_text("1 2 3\n4 5 6\n7 eight 9\n")
    with pytest.raises(batten.ReadError) as caught:
        batten.read_cloud(path)
    assert caught.value.file == str(path) and caught.value.line == 3 and "eight" in str(caught.value)
    assert isinstance(caught.value, OSError)
    with pytest.raises(batten.ReadError) as caught:
        batten.read_cloud(tmp_path / "absent.ply")
    assert caught.value.file == str(tmp_path / "absent.ply") and caught.value.line is None and caught.value.reason
    with pytest.raises(batten.ReadError):
        batten.fit_surface(str(tmp_path / "absent.ply"))
    with pytest.raises(batten.ReadError):
        batten.compare(tmp_path / "absent.step", np.zeros((3, 3)))


@pytest.mark.parametrize("name", ["a.ply", "a.pcd", "a.las", "a.stl", "a.obj", "a.step", "a.iges", "a.brep", "a.json"])
@pytest.mark.parametrize("content", [b"", b"\0" * 1000, b"ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n", os.urandom(500)])
def test_damaged_files_are_read_errors(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    read = batten.read_geometry if name.split(".")[1] in ("step", "iges", "brep", "json") else batten.read_cloud
    with pytest.raises(batten.ReadError) as caught:
        read(path)
    assert caught.value.file == str(path)


def test_unknown_formats_and_unwritable_places(tmp_path, rng):
    s = random_surface(rng)
    with pytest.raises(ValueError):
        batten.write_geometry(s, tmp_path / "x.unknown")
    with pytest.raises(ValueError):
        batten.read_geometry(tmp_path / "x.3dm")
    with pytest.raises(ValueError):
        batten.write_geometry(s, tmp_path / "x.step", unit="furlong")
    with pytest.raises(batten.WriteError) as caught:
        s.to_json(tmp_path / "absent" / "x.json")
    assert caught.value.file.endswith("x.json")
    with pytest.raises(ValueError, match="geometry"):
        batten.write_geometry([], tmp_path / "x.json")
    with pytest.raises(ValueError, match="geometry"):
        batten.write_geometry([3], tmp_path / "x.json")
    with pytest.raises(ValueError, match="names"):
        batten.write_geometry(s, tmp_path / "x.json", names=["a", "b"])
    with pytest.raises(ValueError, match="path"):
        batten.read_geometry(3)
    assert [one.name for one in tmp_path.iterdir()] == []


ENDINGS = {"step": ("step", "STP"), "iges": ("iges", "igs"), "json": ("json", "Json")}


def test_names_do_not_lie(tmp_path, sheet_fit, curve_fit):
    for thing in (sheet_fit, curve_fit, sheet_fit.surface, curve_fit.curve):
        for format, endings in ENDINGS.items():
            write = getattr(thing, "to_" + format)
            for wrong in ("a.foo", "a", format, "a." + format + "x", "a." + ("json" if format == "step" else "step")):
                with pytest.raises(ValueError, match=r"^path: .*\." + format):
                    write(tmp_path / wrong)
            assert list(tmp_path.iterdir()) == []
            for ending in endings:
                write(tmp_path / f"a.{ending}")
                os.remove(tmp_path / f"a.{ending}")
    batten.write_geometry(sheet_fit.surface, tmp_path / "a.foo", format="step")  # who says so has it
    assert (tmp_path / "a.foo").read_bytes().startswith(b"ISO-10303-21")


def test_a_zero_byte_cuts_no_path(tmp_path, sheet_fit):
    s, points, here = sheet_fit.surface, np.eye(3), str(tmp_path)
    batten.write_cloud(points, here + "/a.xyz")
    s.to_json(here + "/a.json")
    calls = [
        lambda: batten.read_cloud(here + "/a.xyz\0b"),
        lambda: batten.read_cloud([here + "/a.xyz", here + "/a.xyz\0"]),
        lambda: batten.read_geometry(here + "/a.json\0.json"),
        lambda: batten.fit_surface(here + "/a.xyz\0.xyz"),
        lambda: batten.compare(s, here + "/a.xyz\0.xyz"),
        lambda: batten.fit_solid(points, layout=here + "/a.obj\0.obj"),
        lambda: batten.write_cloud(points, here + "/b.xyz\0.xyz"),
        lambda: batten.write_geometry(s, here + "/b.json\0.json"),
        lambda: s.to_mesh(here + "/b.stl\0.stl", tolerance=0.1),
    ]
    names = {"step": "step", "iges": "iges", "json": "json", "html": "html", "report": "json", "residuals": "csv"}
    calls += [lambda n=n, e=e: getattr(sheet_fit, "to_" + n)(f"{here}/b.{e}\0.{e}") for n, e in names.items()]
    for call in calls:
        with pytest.raises(ValueError, match=r"^\w+: '.*\\x00.*' holds a zero byte"):
            call()
    assert sorted(one.name for one in tmp_path.iterdir()) == ["a.json", "a.xyz"]


def test_paths_of_any_kind(tmp_path, rng):
    s = random_surface(rng)
    path = tmp_path / "Fläche 曲面.json"
    s.to_json(path)
    assert batten.read_geometry(str(path))[0] == s and batten.read_geometry(path)[0] == s
    odd = os.fsencode(str(tmp_path)) + b"/\xff.json"
    try:
        s.to_json(os.fsdecode(odd))
    except OSError:
        pytest.skip("this file system keeps no such names")
    assert batten.read_geometry(os.fsdecode(odd))[0] == s


def test_json_is_that_of_the_program(tmp_path, rng):
    s = random_surface(rng)
    s.to_json(tmp_path / "s.json")
    assert json.loads((tmp_path / "s.json").read_text())["shape"] == s.to_geomdl()["shape"]
