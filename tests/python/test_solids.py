# SPDX-License-Identifier: MIT
"""Solids recover known bodies, are written through the program's gate, and refuse what is no body."""
import gc
import json
import os
import resource
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import batten
from conftest import ITERATED, ROUNDING, SANITIZED
from test_threads import longest_silence

PROGRAM = os.environ.get("BATTEN_PROGRAM", "")
VOLUME, AREA = 4 * np.pi / 3, 4 * np.pi


def sphere(count, noise=0.0, seed=1, least_z=-2.0):
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(count, 3))
    points = way / np.linalg.norm(way, axis=1)[:, None] * (1 + noise * rng.normal(size=count))[:, None]
    return points[points[:, 2] > least_z]


def cube_sphere(cells):
    """The cube with so many faces along an edge, its vertices on the unit sphere."""
    places, faces = {}, []

    def vertex(p):
        return places.setdefault(tuple(p), len(places))

    for axis in range(3):
        a, b = (axis + 1) % 3, (axis + 2) % 3
        for side in (-cells, cells):
            for i in range(-cells, cells, 2):
                for j in range(-cells, cells, 2):
                    corners = []
                    for di, dj in ((0, 0), (2, 0), (2, 2), (0, 2)):
                        p = [0, 0, 0]
                        p[axis], p[a], p[b] = side, i + di, j + dj
                        corners.append(vertex(p))
                    faces.append(corners if side > 0 else corners[::-1])
    vertices = np.array(list(places), dtype=float)
    return vertices / np.linalg.norm(vertices, axis=1)[:, None], np.array(faces)


def enclosed(surfaces, chord=1e-4):
    """Volume by the divergence theorem over triangles that look outwards."""
    volume = 0.0
    for surface in surfaces:
        mesh = surface.tessellate(chord)
        corners = mesh.vertices[mesh.faces]
        volume += np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    return volume


NOISE, COUNT = 0.01, 4000
# The mean radius is known to noise / sqrt(points), the volume to three times that: 5 of these.
WITHIN = 5 * 3 * VOLUME * NOISE / np.sqrt(COUNT)


@pytest.fixture(scope="module")
def ball():
    return batten.fit_solid(sphere(COUNT, NOISE), layout=cube_sphere(4), threads=1)


def test_a_noisy_ball_is_found(ball, tmp_path):
    assert ball.ok and abs(ball.solid.volume - VOLUME) < WITHIN and ball.solid.area == pytest.approx(AREA, rel=0.01)
    assert 0.9 * NOISE < ball.rms < 1.1 * NOISE
    path = tmp_path / "ball.step"
    ball.to_step(path, unit="cm")
    assert b"MANIFOLD_SOLID_BREP" in path.read_bytes()
    shapes = batten.read_geometry(path)
    assert shapes.unit == "cm" and len(shapes) == len(ball.faces)
    # Chords of 1e-4 take at most that from the radius, AREA times it from the volume.
    assert abs(enclosed(shapes) - ball.solid.volume) < AREA * 1e-4
    assert abs(enclosed(shapes) - VOLUME) < WITHIN + AREA * 1e-4


def test_what_the_program_says(ball):
    s = ball.summary
    assert (s["faces"], s["edges"], s["vertices"], s["genus"], s["bodies"], s["extraordinary"]) == (6, 12, 8, 0, 1, 8)
    assert s["watertight"] and s["gap"] < ROUNDING and s["angle"] < ITERATED
    assert s["rms"] == ball.rms and s["max"] == np.abs(ball.residuals[~ball.outliers]).max() and s["warnings"] == ball.warnings
    assert ball.report["geometry"]["kind"] == "solid" and ball.report["command"] == "batten.fit_solid"
    assert "6 faces, 12 edges, 8 vertices, genus 0" in repr(ball) and "\n" not in repr(ball)


def test_results_fit_together(ball):
    points = ball.points.points
    solid = ball.solid
    for number, face in enumerate(solid.faces):
        mine = ball.owners == number
        feet = face(*ball.parameters[mine].T)
        assert np.allclose(np.linalg.norm(points[mine] - feet, axis=1), np.abs(ball.residuals[mine]), atol=ROUNDING)
        outside = np.linalg.norm(points[mine], axis=1) > np.linalg.norm(feet, axis=1)
        assert ((ball.residuals[mine] > 0) == outside).all()
        assert (np.einsum("ij,ij->i", face.normal(*ball.parameters[mine].T), feet) > 0).all()
    ends = np.array([edge(edge.domain[k]) for edge in solid.edges for k in (0, 1)])
    nearest = np.linalg.norm(ends[:, None] - solid.vertices[None], axis=2).min(axis=1)
    assert nearest.max() < ROUNDING and len(solid.edges) == 12
    vertices, faces = ball.control_mesh
    assert np.array_equal(faces, cube_sphere(4)[1]) and len(vertices) == len(cube_sphere(4)[0])


def test_arrays_live_as_long_as_they_are_held():
    def arrays():
        fit = batten.fit_solid(sphere(600), layout=cube_sphere(2))
        return fit.residuals, fit.owners, fit.solid.vertices, fit.control_mesh

    held = arrays()
    copies = [np.array(held[0]), np.array(held[1]), np.array(held[2]), np.array(held[3][0])]
    gc.collect()
    arrays()
    for array, copy in zip([*held[:3], held[3][0]], copies):
        assert np.array_equal(array, copy) and not array.flags.writeable


def test_fits_give_their_memory_back():
    def peak():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

    points, layout = sphere(3000, NOISE), cube_sphere(2)
    for _ in range(3):
        batten.fit_solid(points, layout=layout, smoothing=1e-3, max_iterations=3)
    before = peak()
    for _ in range(12):
        batten.fit_solid(points, layout=layout, smoothing=1e-3, max_iterations=3)
    assert peak() - before < 8 or SANITIZED  # MiB; one result holds 0.2


def test_every_keyword(tmp_path):
    points, layout = sphere(1500, NOISE), cube_sphere(2)
    fit = batten.fit_solid(
        points + [1000, 2000, 3000],
        layout=(layout[0] + [1000, 2000, 3000], layout[1]),
        tolerance=0.02,
        smoothing=1e-3,
        max_iterations=20,
        keep_outliers=True,
        merge_faces=False,
        normals=points / np.linalg.norm(points, axis=1)[:, None],
        weights=np.ones(len(points)),
        shift=(1000, 2000, 3000),
        unit="m",
        seed=2,
        threads=2,
    )
    assert len(fit.faces) == len(layout[1]) and not fit.outliers.any() and fit.shift == (1000, 2000, 3000)
    assert fit.ok == (np.abs(fit.residuals).max() <= 0.02)
    assert abs(enclosed(fit.faces, 1e-3) - fit.solid.volume) < AREA * 1e-3  # about the origin, or it would not be
    fit.to_step(tmp_path / "a.step", schema="ap242")
    assert batten.read_geometry(tmp_path / "a.step").unit == "m"


def test_outliers_do_not_count():
    points = sphere(4000, 0.005)
    points[::20] *= 1.3
    fit = batten.fit_solid(points, layout=cube_sphere(4))
    assert fit.outliers[::20].mean() > 0.9 and abs(fit.solid.volume - VOLUME) < 0.01 * VOLUME


def test_points_alone_and_meshes(tmp_path):
    fit = batten.fit_solid(sphere(2000, 0.003), faces=100)
    assert fit.solid.genus == 0 and abs(fit.solid.volume - VOLUME) < 0.01 * VOLUME
    assert batten.fit_solid(batten.Cloud(sphere(2000, 0.003)), faces=100).solid.volume == fit.solid.volume
    vertices, faces = cube_sphere(12)
    mesh = batten.fit_solid((vertices, faces))
    triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    lists = faces.tolist()[:-1] + [faces[-1, [0, 1, 2]].tolist(), faces[-1, [0, 2, 3]].tolist()]
    for given in ((vertices, triangles), (vertices.tolist(), lists)):
        assert abs(batten.fit_solid(given).solid.volume - mesh.solid.volume) < 0.01 * VOLUME
    batten.write_mesh((vertices, triangles), tmp_path / "ball.ply")
    batten.write_mesh((vertices, triangles), tmp_path / "ball.obj")
    read = batten.fit_solid(tmp_path / "ball.obj")
    assert read.solid.volume == pytest.approx(batten.fit_solid((vertices, triangles)).solid.volume, rel=1e-6)
    one_hole = batten.fit_solid((vertices, faces[1:]))
    assert any("1 hole is closed" in words for words in one_hole.warnings)


@pytest.mark.skipif(not PROGRAM, reason="the program is not built")
def test_it_is_that_of_the_program(tmp_path):
    batten.write_cloud(sphere(1500, NOISE), tmp_path / "ball.xyz")
    vertices, faces = cube_sphere(2)
    lines = ["v " + " ".join(map(repr, map(float, v))) for v in vertices] + ["f " + " ".join(str(k + 1) for k in f) for f in faces]
    (tmp_path / "q.obj").write_text("\n".join(lines) + "\n")
    for words, keywords in ((["--quads", "q.obj"], {"layout": tmp_path / "q.obj"}), (["--faces", "80"], {"faces": 80})):
        run = [PROGRAM, "fit", "solid", "ball.xyz", "-o", "program.step", "--report", "report.json", "--threads", "1", *words]
        said = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True)
        assert said.returncode == 0, said.stderr
        fit = batten.fit_solid(tmp_path / "ball.xyz", threads=1, **keywords)
        fit.to_step(tmp_path / "python.step")
        ours, theirs = ((tmp_path / name).read_text().split("DATA;")[1] for name in ("python.step", "program.step"))
        assert ours.replace("python", "program") == theirs
        report = json.loads((tmp_path / "report.json").read_text())
        ours = fit.report
        assert ours["geometry"].pop("file") and report["geometry"].pop("file") == "program.step"
        for name in ("error", "error_all", "geometry", "end"):
            assert ours.get(name) == report.get(name)
        s = fit.summary
        assert f"{s['faces']} faces, {s['edges']} edges and {s['vertices']} vertices, genus {s['genus']}" in said.stderr


VERTICES, QUADS = cube_sphere(2)


@pytest.mark.parametrize(
    "points, keywords, words",
    [
        (sphere(3000, 0.003, least_z=0.2), {}, "do not go all round"),
        (sphere(1000, 0.003), {"genus": 1}, "its genus is 0, not 1"),
        (np.column_stack([np.random.default_rng(1).random((2000, 2)), np.zeros(2000)]), {}, ""),
        (cube_sphere(4)[0], {"layout": (VERTICES, QUADS[:-1])}, "the mesh is open"),
        ((cube_sphere(4)[0], cube_sphere(4)[1][:50]), {}, "the surface is open"),
        (sphere(1500), {"layout": (VERTICES, QUADS[:, ::-1])}, "clockwise"),
        (sphere(1500), {"layout": (VERTICES + [3, 0, 0], QUADS)}, "apart from the points"),
        (sphere(20), {"layout": (VERTICES, QUADS)}, "a coarser layout is needed"),
    ],
    ids=["bowl", "genus", "sheet", "open-layout", "open-mesh", "turned", "apart", "few"],
)
def test_what_is_no_body_is_refused(points, keywords, words):
    with pytest.raises(batten.FitRefused) as caught:
        batten.fit_solid(points, **keywords)
    assert words in caught.value.reason


def test_more_may_be_invented_where_it_is_said():
    bowl = sphere(3000, NOISE, least_z=-0.6)
    with pytest.raises(batten.FitRefused):
        batten.fit_solid(bowl, most_invented=0.05)
    closed = batten.fit_solid(bowl, most_invented=0.5, faces=100, genus=0)
    assert closed.summary["watertight"] and any("no points" in words for words in closed.warnings)


@pytest.mark.parametrize(
    "keywords, words",
    [
        ({"layout": 7}, "layout"),
        ({"layout": (VERTICES, QUADS[:, :3])}, "layout"),
        ({"layout": (VERTICES, QUADS + 1)}, "layout"),
        ({"layout": (VERTICES, -QUADS)}, "layout"),
        ({"layout": (VERTICES, QUADS.astype(float))}, "layout"),
        ({"layout": (VERTICES, [])}, "layout"),
        ({"layout": (VERTICES * np.nan, QUADS)}, "layout"),
        ({"layout": (VERTICES[:, :2], QUADS)}, "layout"),
        ({"layout": "layout.txt"}, "layout"),
        ({"layout": (VERTICES, QUADS), "faces": 50}, "faces"),
        ({"faces": 5}, "faces"),
        ({"faces": 20001}, "faces"),
        ({"faces": 7.5}, "faces"),
        ({"genus": -1}, "genus"),
        ({"genus": 0.5}, "genus"),
        ({"most_invented": 1.5}, "most_invented"),
        ({"most_invented": "all"}, "most_invented"),
        ({"tolerance": -1}, "tolerance"),
        ({"tolerance": "small"}, "tolerance"),
        ({"smoothing": -1}, "smoothing"),
        ({"smoothing": "noise"}, "smoothing"),
        ({"smoothing": 1e13}, "smoothing"),
        ({"max_iterations": 0}, "max_iterations"),
        ({"keep_outliers": "yes"}, "keep_outliers"),
        ({"merge_faces": 3}, "merge_faces"),
        ({"normals": np.zeros((2, 3))}, "normals"),
        ({"weights": [1.0]}, "weights"),
        ({"shift": "far"}, "shift"),
        ({"unit": "furlong"}, "unit"),
        ({"progress": 7}, "progress"),
    ],
)
def test_wrong_keywords_are_named(keywords, words):
    with pytest.raises(ValueError, match=rf"\b{words}\b") as caught:
        batten.fit_solid(sphere(100), **keywords)
    assert not isinstance(caught.value, batten.FitRefused)


def test_wrong_points_and_files(tmp_path):
    with pytest.raises(ValueError, match="x, y and z"):
        batten.fit_solid(np.random.default_rng(1).random((50, 2)), layout=(VERTICES, QUADS))
    with pytest.raises(ValueError, match="normals"):
        batten.fit_solid((VERTICES, QUADS), normals=VERTICES)
    with pytest.raises(batten.ReadError):
        batten.fit_solid(sphere(100), layout=tmp_path / "absent.obj")
    with pytest.raises(batten.ReadError):
        batten.fit_solid(tmp_path / "absent.ply")
    batten.write_mesh((VERTICES, np.concatenate([QUADS[:, :3], QUADS[:, [0, 2, 3]]])), tmp_path / "triangles.obj")
    with pytest.raises(batten.ReadError):
        batten.fit_solid(sphere(100), layout=tmp_path / "triangles.obj")


def test_the_gate_leaves_no_file(ball, tmp_path):
    with pytest.raises(ValueError):
        ball.to_step(tmp_path / "a.step", unit="furlong")
    with pytest.raises(ValueError):
        ball.to_step(tmp_path / "a.step", schema="ap999")
    with pytest.raises(ValueError, match=r"^path: .*\.step"):
        ball.to_step(tmp_path / "a.foo")
    with pytest.raises(ValueError, match="zero byte"):
        ball.to_step(str(tmp_path / "a\0.step"))
    with pytest.raises(batten.WriteError):
        ball.to_step(tmp_path / "absent" / "a.step")
    assert list(tmp_path.iterdir()) == []


def test_what_every_fit_gives(ball, tmp_path):
    ball.to_html(tmp_path / "a.html")
    ball.to_report(tmp_path / "a.report")
    ball.to_residuals(tmp_path / "a.csv")
    ball.to_json(tmp_path / "a.json")
    assert ball._repr_html_().startswith("<iframe") and len(batten.read_geometry(tmp_path / "a.json")) == 6
    assert ball.plot() is not None
    report = batten.write_geometry(ball.faces, tmp_path / "sewn.step", sew=1e-6)
    assert report.watertight and report.solids == 1 and report.shared_edges == 12


def test_the_lock_is_released():
    silence, took = longest_silence(lambda: batten.fit_solid(sphere(6000, NOISE), layout=cube_sphere(4), threads=1))
    assert took > 0.05 and silence < 0.5 * took


@pytest.mark.parametrize("given", ["layout=layout", "faces=800"])
def test_ctrl_c_raises_within_three_tenths(given):
    program = textwrap.dedent(
        f"""
        import os, sys, signal, threading, time
        sys.path.insert(0, {os.path.dirname(os.path.abspath(__file__))!r})
        from test_solids import batten, cube_sphere, sphere
        points, layout = sphere(60000, 0.01), cube_sphere(16)
        sent = []
        def interrupt():
            time.sleep(0.3)
            sent.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=interrupt).start()
        try:
            batten.fit_solid(points, {given})
            print("finished")
        except KeyboardInterrupt:
            print("interrupted", time.perf_counter() - sent[0])
        """
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=100)
    assert run.returncode == 0, run.stderr
    word, seconds = run.stdout.split()
    assert word == "interrupted" and (float(seconds) < 0.3 or SANITIZED)


def test_progress_tells_and_stops():
    for keywords, stages in (({"layout": cube_sphere(2)}, {"prepare", "fit"}), ({"faces": 80}, {"layout", "prepare", "fit"})):
        told = []
        batten.fit_solid(sphere(2000, NOISE), progress=lambda stage, fraction: told.append((stage, fraction)), **keywords)
        fractions = [fraction for _, fraction in told]
        assert fractions == sorted(fractions) and fractions[0] == 0 and fractions[-1] == 1
        assert {stage for stage, _ in told} <= stages
    with pytest.raises(batten.Cancelled):
        batten.fit_solid(sphere(20000, NOISE), layout=cube_sphere(8), progress=lambda stage, fraction: False)

    def tell(stage, fraction):
        raise KeyError("enough")

    with pytest.raises(KeyError):
        batten.fit_solid(sphere(500), layout=cube_sphere(2), progress=tell)


def test_an_open_scan_is_a_shell_that_ends_where_its_points_do(tmp_path):
    points = sphere(3000, least_z=-0.3)
    with pytest.raises(batten.FitRefused) as refused:
        batten.fit_solid(points)
    assert refused.value.remedy == "open=True"
    shell = batten.fit_solid(points, open=True, faces=200)
    s = shell.summary
    assert not s["watertight"] and s["volume"] is None and shell.solid.volume is None and "open" in repr(shell)
    # The sphere above -0.3, to about a spacing.
    assert abs(s["area"] - 2 * np.pi * 1.3) < 0.08 * 2 * np.pi and s["max"] < 0.02
    path = tmp_path / "shell.step"
    shell.to_step(path)
    assert b"SHELL_BASED_SURFACE_MODEL" in path.read_bytes() and b"MANIFOLD_SOLID_BREP" not in path.read_bytes()
    with pytest.raises(ValueError, match="open: not beside"):
        batten.fit_solid(points, open=True, genus=0)
