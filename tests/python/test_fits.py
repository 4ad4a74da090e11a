# SPDX-License-Identifier: MIT
"""Fits recover known truth, and say what they did: the same as the program says."""
import gc
import json
import os
import subprocess

import numpy as np
import pytest

import batten
from conftest import ITERATED, ROOT, ROUNDING, heights, helix, random_surface, sheet

PROGRAM = os.environ.get("BATTEN_PROGRAM", "")


def test_surface_recovers_the_truth(sheet_fit):
    xy = np.random.default_rng(9).uniform(0.05, 0.95, (500, 2))
    truth = np.column_stack([xy, heights(*xy.T)])
    error = sheet_fit.surface.closest(truth).distances
    assert np.sqrt((error**2).mean()) < 0.5e-3 and error.max() < 3e-3  # the noise is 1e-3
    assert sheet_fit.ok and 0.8e-3 < sheet_fit.rms < 1.2e-3


def test_exact_surface_is_found(rng):
    s = random_surface(rng, (3, 3), (5, 5), rational=False)
    g = s.greville
    flat = np.stack(np.broadcast_arrays(g[0][:, None], g[1][None, :], 0.1 * rng.random((5, 5))), axis=-1)
    s = batten.Surface(3, s.knots_u, s.knots_v, flat)
    fit = batten.fit_surface(s(rng.random(1500), rng.random(1500)), tolerance=1e-4)
    assert fit.ok and np.abs(fit.residuals).max() <= 1e-4


def test_uncertainty_covers_the_truth(sheet_fit):
    xy = np.random.default_rng(4).uniform(0.1, 0.9, (400, 2))
    truth = np.column_stack([xy, heights(*xy.T)])
    feet = sheet_fit.surface.closest(truth)
    found = sheet_fit.uncertainty(feet.parameters)
    shares = np.mean(feet.distances <= 2 * found.sigma + np.abs(found.bias))
    assert shares > 0.85 and (found.support > 0.5).all()  # 95 % of independent places
    assert sheet_fit.uncertainty().sigma.shape == (len(sheet_fit.residuals),)
    with pytest.raises(ValueError, match="places"):
        sheet_fit.uncertainty([1.0, 2.0, 3.0])
    some = feet.parameters[:5]
    covariance = sheet_fit.covariance(some)
    assert np.allclose(np.sqrt(np.diag(covariance)), sheet_fit.uncertainty(some).sigma, rtol=ITERATED)
    assert np.allclose(covariance, covariance.T) and np.linalg.eigvalsh(covariance).min() > 0
    again = sheet_fit.covariance([some[0], some[0]])
    assert again == pytest.approx(np.full((2, 2), covariance[0, 0]), rel=ITERATED)
    with pytest.raises(ValueError, match="places"):
        sheet_fit.covariance([[np.nan, 0.5]])
    exact = batten.fit_primitive(batten.make.sphere(5.0).sample(300, noise=0.01), "sphere")
    with pytest.raises(ValueError):
        exact.uncertainty()


def test_certificates_bound_the_distances(sheet_fit, tmp_path):
    compared = batten.compare(sheet_fit.surface, sheet_fit.points, tolerance=2e-3)
    for fit in (sheet_fit, compared):
        fit.to_certificate(tmp_path / "proof.json")
        proof = json.loads((tmp_path / "proof.json").read_text())
        rows = np.array(proof["points"], float)
        off = np.abs(fit.residuals)
        assert proof["schema"] == "batten-certificate-1" and rows.shape == (len(off), 9)
        assert (rows[:, 3] <= off).all() and (off <= rows[:, 4]).all()
        verify = os.path.join(os.path.dirname(PROGRAM), "batten-verify")
        if PROGRAM and os.path.exists(verify):
            done = subprocess.run([verify, tmp_path / "proof.json"], capture_output=True, text=True)
            assert done.returncode == 0, done.stdout + done.stderr


def test_results_fit_together(sheet_fit):
    fit, s = sheet_fit, sheet_fit.surface
    points = fit.points.points
    feet = s(*fit.parameters.T)
    assert np.allclose(np.linalg.norm(points - feet, axis=1), np.abs(fit.residuals), atol=ITERATED)
    assert np.allclose(np.abs(fit.residuals), s.closest(points).distances, atol=1e-8)
    side = np.einsum("ij,ij->i", points - feet, s.normal(*fit.parameters.T))
    inside = np.abs(np.abs(side) - np.abs(fit.residuals)) < ITERATED
    assert inside.mean() > 0.9 and (np.sign(side[inside]) == np.sign(fit.residuals[inside])).all()
    used = fit.residuals[~fit.outliers]
    assert np.sqrt((used**2).mean()) == pytest.approx(fit.report["error"]["rms"], rel=ROUNDING * 100)
    assert fit.report["input"]["points"] == len(fit.residuals) == 2000
    assert fit.report["geometry"]["control_points"] == list(s.control_points.shape[:2])


def test_report_is_plain_json(sheet_fit):
    assert json.loads(json.dumps(sheet_fit.report)) == sheet_fit.report
    assert sheet_fit.report["schema"] == "batten-report-2" and sheet_fit.report["version"] == batten.__version__
    assert sheet_fit.report["command"] == "batten.fit_surface"


VOLATILE = {"command", "seconds", "peak_memory_bytes"}


def without_times(report):
    report = {key: value for key, value in report.items() if key not in VOLATILE}
    report["iterations"] = [{k: v for k, v in one.items() if k != "seconds"} for one in report["iterations"]]
    return report


@pytest.mark.skipif(not os.path.exists(PROGRAM), reason="the program is not built (BATTEN_PROGRAM)")
@pytest.mark.parametrize(
    "kind, flags, keywords",
    [
        ("surface", ["--tolerance", "0.3"], {"tolerance": 0.3}),
        ("surface", ["--degree", "2,4", "--trim", "none", "--optimize", "none"], {"degree": (2, 4), "trim": "none", "optimize": "none"}),
        (
            "surface",
            "--keep-outliers --control-points 9,8 --smoothing 1e-2 --loss huber --loss-scale 0.05 --unit cm --thin 12 --seed 7".split(),
            {"keep_outliers": True, "control_points": (9, 8), "smoothing": 1e-2, "loss": "huber", "loss_scale": 0.05}
            | {"unit": "cm", "thin": 12, "seed": 7},
        ),
        ("surface", "--base sheet --max-control-points 60 --closed none".split(), {"base": "sheet", "max_control_points": 60, "closed": "none"}),
        (
            "curve",
            "--degree 4 --max-control-points 12 --parameterization centripetal --distance squared --smoothing 1e-3 --corners none".split()
            + "--loss cauchy --loss-scale 0.01 --optimize knots --unit m".split(),
            {"degree": 4, "max_control_points": 12, "parameterization": "centripetal", "distance": "squared", "smoothing": 1e-3}
            | {"corners": False, "loss": "cauchy", "loss_scale": 0.01, "optimize": "knots", "unit": "m"},
        ),
        ("primitive", ["--kind", "plane"], {"kind": "plane"}),
        ("primitive", "--kind sphere --loss cauchy --loss-scale 0.1 --tolerance 9".split(), {"kind": "sphere", "loss": "cauchy", "loss_scale": 0.1, "tolerance": 9}),
        ("curve", ["--tolerance", "0.01"], {"tolerance": 0.01}),
        ("compare", ["--tolerance", "0.3"], {"tolerance": 0.3}),
    ],
)
def test_report_is_the_programs(tmp_path, kind, flags, keywords):
    cloud = os.path.join(ROOT, "data", "panel.ply")
    if kind == "curve":
        cloud = str(tmp_path / "helix.xyz")
        batten.write_cloud(helix(300, 1e-3), cloud)
    out, report = str(tmp_path / "out.json"), str(tmp_path / "report.json")
    if kind == "compare":
        words = ["compare", os.path.join(ROOT, "data", "panel.json"), cloud]
        fit = batten.compare(words[1], cloud, **keywords)
    else:
        words = ["fit", kind, cloud, "-o", out]
        fit = getattr(batten, "fit_" + kind)(cloud, **keywords)
        fit.to_json(out)
        mine = open(out).read()
    run = subprocess.run([PROGRAM, *words, *flags, "--report", report], capture_output=True, text=True)
    assert run.returncode in (0, 3) or run.returncode == 4 and json.load(open(report))["doubt"], run.stderr
    theirs, ours = without_times(json.load(open(report))), without_times(fit.report)
    if kind == "compare":
        ours["geometry"]["file"] = theirs["geometry"]["file"]
    assert ours == theirs
    assert fit.ok == (run.returncode == 0)
    if kind != "compare":
        assert open(out).read() == mine  # the geometry, byte by byte


def test_arrays_share_memory_and_outlive_the_fit():
    fit = batten.fit_surface(sheet(300), optimize="none")
    for name in ("parameters", "residuals", "outliers"):
        first, second = getattr(fit, name), getattr(fit, name)
        assert first.__array_interface__["data"] == second.__array_interface__["data"]
        assert first.base is not None and not first.flags.writeable
        with pytest.raises(ValueError):
            first[...] = 0
    kept, copied = fit.residuals, np.array(fit.residuals)
    points, same = fit.points.points, np.array(fit.points.points)
    del fit, first, second
    gc.collect()
    assert np.array_equal(kept, copied) and np.array_equal(points, same)


def test_the_same_points_give_the_same_fit():
    points = sheet(400, 1e-3)
    fit = batten.fit_surface(points)
    for other in (np.asfortranarray(points), np.repeat(points, 2, axis=0)[::2], points.tolist(), batten.Cloud(points)):
        assert batten.fit_surface(other).surface == fit.surface
    single = batten.fit_surface(points.astype(np.float32))
    assert single.surface == batten.fit_surface(points.astype(np.float32).astype(np.float64)).surface


def test_the_callers_array_is_left_alone():
    points = sheet(300)
    before = points.copy()
    fit = batten.fit_surface(points)
    assert np.array_equal(points, before)
    points[:] = np.nan
    assert np.isfinite(fit.points.points).all()


OPTIONS = [
    {"degree": 2},
    {"degree": (4, 2)},
    {"control_points": (6, 5)},
    {"max_control_points": 30},
    {"smoothing": 1e-3},
    {"smoothing": "cross-validation"},
    {"smoothing": "noise"},
    {"loss": "none"},
    {"loss": "huber"},
    {"loss": "tukey", "loss_scale": 1e-3},
    {"optimize": "none"},
    {"optimize": "parameters"},
    {"optimize": ["parameters", "weights"]},
    {"base": "plane"},
    {"base": "sheet"},
    {"closed": "none"},
    {"trim": "none"},
    {"symmetric": "x"},
    {"symmetric": [0, 1, 0, -0.5]},
    {"domain": [-0.2, -0.2, 1.2, 1.2]},
    {"thin": 0.05},
    {"keep_outliers": True},
    {"snap": True},
    {"shift": [1, 2, 3]},
    {"shift": "local"},
    {"unit": "inch"},
    {"seed": 7},
    {"threads": 1},
    {"tolerance": np.float32(0.01), "degree": np.int64(3)},
    {"progress": True},
]


@pytest.mark.parametrize("options", OPTIONS, ids=[",".join(map(str, o.items())) for o in OPTIONS])
def test_every_option_is_taken(options):
    points = sheet(250, 1e-3)
    if "symmetric" in options:  # what is its own mirror image
        points[:, 2] = 0.1 * (points[:, 0] ** 2 + (points[:, 1] - 0.5) ** 2)
    fit = batten.fit_surface(points, **options)
    report = fit.report
    if "degree" in options:
        assert fit.surface.degree == tuple(np.broadcast_to(options["degree"], 2))
    if "control_points" in options:
        assert fit.surface.control_points.shape[:2] == options["control_points"]
    if "max_control_points" in options:
        assert np.prod(fit.surface.control_points.shape[:2]) <= 30
    if options.get("trim") == "none":
        assert not fit.surface.trimmed
    if "symmetric" in options:
        whole, at = fit.surface.with_trims([]), np.linspace(0, 1, 9)
        (u0, u1), (v0, v1) = whole.domain
        mirror = ([-1, 1, 1], [0, 0, 0]) if options["symmetric"] == "x" else ([1, -1, 1], [0, 0.5, 0])
        image = whole.scale(mirror[0], center=mirror[1])(u0 + (u1 - u0) * at[:, None], v0 + (v1 - v0) * at)
        assert whole.closest(image.reshape(-1, 3)).distances.max() < ITERATED
    if options.get("base"):
        assert report["geometry"]["base"] == options["base"]
    if options.get("optimize") == "none":
        assert not report["optimize"]["ran"]
    if options.get("shift") == [1, 2, 3]:
        assert report["input"]["shift"] == [1, 2, 3] and fit.surface.bounding_box[0][2] < -2
    if "thin" in options:
        assert report["input"]["thinned_to"] < 250
    if "unit" in options:
        assert report["input"]["unit"] == "inch"
    if "domain" in options:
        low, high = fit.surface.with_trims([]).bounding_box
        assert (high - low)[:2] == pytest.approx([1.4, 1.4], abs=0.1)
    assert fit.rms < 0.1


def test_far_points_warn_and_shift_local():
    points = sheet(250) + [4.5e5, 5.4e6, 0]
    fit = batten.fit_surface(points, unit="m")
    assert any("500 m" in warning for warning in fit.warnings)
    near = batten.fit_surface(points, unit="m", shift="local")
    assert not any("500 m" in warning for warning in near.warnings)
    assert np.abs(near.surface.control_points).max() < 2e5 and near.shift[1] > 5e6


def test_outliers_are_set_aside():
    points = sheet(2000, 1e-3)
    points[:40, 2] += np.linspace(0.3, 0.6, 40)
    fit = batten.fit_surface(points)
    assert fit.outliers[:40].all() and fit.outliers[40:].sum() <= 10
    assert fit.report["input"]["outliers"] == fit.outliers.sum() and fit.rms < 2e-3


def test_normals_choose_the_side():
    points = sheet(300)
    for z in (1, -1):
        s = batten.fit_surface(points, normals=np.tile([0, 0, z], (300, 1))).surface
        (u0, u1), (v0, v1) = s.domain
        assert s.normal((u0 + u1) / 2, (v0 + v1) / 2)[2] * z > 0


def test_given_parameters_are_taken():
    points = sheet(400)
    fit = batten.fit_surface(points, parameters=points[:, :2])
    assert fit.rms < 1e-3 and np.allclose(fit.surface(0.5, 0.5)[:2], 0.5, atol=0.02)


def test_boundaries_and_fixed_points_are_met():
    points = sheet(800)
    edge = batten.interpolate_curve(np.column_stack([np.zeros(30), np.linspace(0, 1, 30), heights(0, np.linspace(0, 1, 30))])).curve
    fit = batten.fit_surface(points, boundary=[edge])
    assert fit.surface.closest(edge(np.linspace(0, 1, 50))).distances.max() < 1e-6
    near = batten.fit_surface(points, boundary=[edge], boundary_tolerance=0.01).surface
    assert near != fit.surface and near.closest(edge(np.linspace(0, 1, 50))).distances.max() < 0.01
    met = batten.fit_surface(points, meet=[[0.5, 0.5, 0.2]])
    assert met.surface.closest([0.5, 0.5, 0.2]).distances < 1e-9


def test_closed_shapes():
    cloud = batten.make.sphere(2.0).sample(1500, noise=1e-3)
    fit = batten.fit_surface(cloud)
    assert fit.report["geometry"]["closed"] == [True, False] and fit.rms < 2e-3
    snapped = batten.fit_surface(cloud, snap=True)
    assert snapped.surface.classify()[0] == "sphere"


def test_curve_recovers_the_truth(curve_fit):
    c = curve_fit.curve
    assert c.closest(helix(1001)).distances.max() < 2e-3 and curve_fit.rms < 2e-3
    assert c.length == pytest.approx(2 * np.pi * np.hypot(1, 0.3), rel=1e-3)
    assert curve_fit.parameters.shape == (400,) and (np.diff(curve_fit.parameters) > 0).mean() > 0.9
    assert np.allclose(np.linalg.norm(c(curve_fit.parameters) - curve_fit.points.points, axis=1), curve_fit.residuals, atol=ITERATED)


CURVE_OPTIONS = [
    {"degree": 2},
    {"control_points": 9},
    {"tolerance": 0.05},
    {"parameterization": "centripetal"},
    {"parameterization": "foley"},
    {"parameters": np.linspace(0, 1, 200)},
    {"order": "given"},
    {"order": "unordered"},
    {"closed": False},
    {"closed": "auto"},
    {"corners": False},
    {"distance": "squared"},
    {"smoothing": "noise"},
    {"loss": "cauchy"},
    {"optimize": "knots"},
    {"weights": np.linspace(1, 2, 200)},
    {"shift": (1, 1, 1)},
    {"component": 1, "order": "unordered"},
]


@pytest.mark.parametrize("options", CURVE_OPTIONS, ids=[",".join(o) for o in CURVE_OPTIONS])
def test_curve_options(options):
    fit = batten.fit_curve(helix(200, 1e-3), **options)
    assert fit.rms < 0.1 and fit.residuals.shape == (200,)
    if "degree" in options:
        assert fit.curve.degree == 2
    if "control_points" in options:
        assert len(fit.curve.control_points) == 9
    if "tolerance" in options:
        assert fit.ok and len(fit.curve.control_points) < len(batten.fit_curve(helix(200, 1e-3)).curve.control_points)


def test_plane_and_closed_curves(rng):
    t = np.linspace(0, 2 * np.pi, 300, endpoint=False)
    ring = np.column_stack([np.cos(t), np.sin(t)])
    rng.shuffle(ring)
    fit = batten.fit_curve(ring, tolerance=1e-3)
    assert fit.curve.dimension == 2 and fit.curve.closed and fit.curve.length == pytest.approx(2 * np.pi, rel=1e-3)
    assert not batten.fit_curve(ring[np.argsort(np.arctan2(*ring.T))], closed=False).curve.periodic


def test_several_curves():
    both = np.vstack([helix(200), helix(100) * 0.3 + [5, 0, 0]])
    fits = batten.fit_curves(both, order="unordered")
    assert len(fits) == 2 and fits[0].curve.length > fits[1].curve.length
    with pytest.raises(batten.FitRefused):
        batten.fit_curve(both, order="unordered")
    assert batten.fit_curve(both, order="unordered", component=2).curve.length < 3
    with pytest.raises(TypeError, match="nosuch"):
        batten.fit_curves(both, nosuch=1)


def test_interpolation_meets_the_points():
    points = helix(30)
    fit = batten.interpolate_curve(points)
    assert np.abs(fit.curve(fit.parameters) - points).max() < ITERATED
    for options in ({"degree": 5}, {"parameterization": "centripetal"}, {"parameters": np.linspace(2, 3, 30)}):
        fit = batten.interpolate_curve(points, **options)
        assert np.abs(fit.curve(fit.parameters) - points).max() < ITERATED
    ends = batten.interpolate_curve(points, start_tangent=[0, 0, 1], end_tangent=[0, 1, 0]).curve
    assert np.allclose(ends.tangent([0.0, 1.0]), [[0, 0, 1], [0, 1, 0]], atol=ITERATED)
    flat = batten.interpolate_curve(points[:, :2], start_tangent=[1, 0], end_tangent=[-1, 0]).curve
    assert np.allclose(flat.tangent([0.0, 1.0]), [[1, 0], [-1, 0]], atol=ITERATED)
    ring = batten.interpolate_curve(points[:-1, :2], closed=True)
    assert ring.curve.periodic and np.abs(ring.curve(ring.parameters) - points[:-1, :2]).max() < ITERATED


def test_splines_have_their_ends():
    x = np.array([0.0, 1, 2, 3.5, 5])
    points = np.column_stack([x, np.sin(x)])
    for ends in ("natural", "not-a-knot"):
        fit = batten.interpolate_curve(points, spline=ends, parameterization="x")
        assert np.allclose(fit.curve(x), points, atol=ITERATED)
    natural = batten.interpolate_curve(points, spline="natural", parameterization="x").curve
    assert np.allclose(natural.derivatives([0.0, 5.0], 2)[2], 0, atol=ITERATED)
    clamped = batten.interpolate_curve(
        points, spline="clamped", parameterization="x", start_tangent=[2, 2], end_tangent=[1, np.cos(5)]
    ).curve
    assert np.allclose(clamped.derivatives([0.0, 5.0], 1)[1], [[1, 1], [1, np.cos(5)]], atol=ITERATED)
    bent = batten.interpolate_curve(points, spline="curvature", start_curvature=0.2, end_curvature=-0.1).curve
    assert np.allclose(bent.curvature([0.0, 5.0 / 5])[:, 0], [0.2, 0.1], atol=1e-8)
    space = batten.interpolate_curve(helix(9), spline="curvature", start_curvature=[0, 0, 0.2], end_curvature=[0, 0, 0]).curve
    assert space.curvature(1.0)[0] == pytest.approx(0, abs=1e-8)
    assert batten.interpolate_curve(points, spline="periodic").curve.periodic
    with pytest.raises(batten.FitRefused, match="clamped spline needs the start tangent"):
        batten.interpolate_curve(points, spline="clamped")


def test_local_methods_meet_points_or_keep_a_tolerance():
    points = helix(300)
    for method in ("local-parabolic", "local-conic", "local-cubic"):
        assert batten.fit_curve(points, method=method).residuals.max() < ITERATED
    for method in ("local-conic", "local-cubic"):
        fit = batten.fit_curve(points, method=method, tolerance=1e-3)
        assert fit.residuals.max() <= 1e-3 and len(fit.curve.control_points) < 150
    with pytest.raises(batten.FitRefused, match="parabolas"):
        batten.fit_curve(points, method="local-parabolic", tolerance=1e-3)
    with pytest.raises(ValueError, match="method"):
        batten.fit_curve(points, method="local-cubic", control_points=9)


def test_places_and_directions_are_met():
    points = helix(400)
    fit = batten.fit_curve(points, through=[points[100]], tangents=[[*points[0], 0, 1, 1]])
    foot = fit.curve.closest(np.array([points[100], points[0]]))
    assert foot.distances.max() < ITERATED
    along = fit.curve.tangent(foot.parameters[1])
    assert np.allclose(np.cross(along, [0, 1, 1]), 0, atol=1e-8)
    with pytest.raises(ValueError, match="tangents"):
        batten.fit_curve(points, tangents=[[0, 0, 0]])


@pytest.mark.parametrize("kind", ["line", "circle", "plane", "sphere", "cylinder", "cone", "torus"])
def test_primitives_are_recognised(kind):
    shapes = {
        "line": batten.make.line([1, 2, 3], [4, 6, 3]),
        "circle": batten.make.circle(3, center=(1, 2, 3), axis=(0, 1, 1)),
        "plane": batten.make.plane((4, 5), axis=(1, 1, 1)),
        "sphere": batten.make.sphere(3, center=(1, 2, 3)),
        "cylinder": batten.make.cylinder(2, 8, axis=(1, 0, 1)),
        "cone": batten.make.cone(3, 4, top_radius=1),
        "torus": batten.make.torus(5, 1),
    }
    cloud = shapes[kind].sample(1200, noise=1e-3)
    fit = batten.fit_primitive(cloud)
    assert fit.kind == kind and 0.5e-3 < fit.rms < 2e-3
    assert batten.fit_primitive(cloud, kind).kind == kind
    form = {"circle": "roundness", "plane": "flatness", "sphere": "sphericity", "cylinder": "cylindricity"}.get(kind)
    assert (fit.form and fit.form["name"]) == form
    if form:
        assert 2e-3 < fit.form["minimum_zone"] <= fit.form["least_squares"] < 2e-2
    radius = {"circle": 3, "sphere": 3, "cylinder": 2}.get(kind)
    if radius:
        assert fit.numbers["radius"] == pytest.approx(radius, abs=5e-3)
        assert 0 < fit.numbers["standard_deviations"]["radius"] < 1e-2
    assert isinstance(fit.geometry, batten.Curve if kind in ("line", "circle") else batten.Surface)
    assert fit.parameters.shape == ((1200,) if kind in ("line", "circle") else (1200, 2))


def grid(n=20, m=30):
    u, v = np.linspace(0, 1, n)[:, None], np.linspace(0, 1, m)[None, :]
    return np.stack(np.broadcast_arrays(u, v, heights(u, v)), axis=-1)


def test_grids_are_interpolated_and_approximated():
    points = grid()
    fit = batten.fit_grid(points)
    assert np.abs(fit.residuals).max() < ITERATED
    assert batten.fit_grid(points.reshape(-1, 3), (20, 30)).surface == fit.surface
    near = batten.fit_grid(points, tolerance=1e-3)
    assert near.ok and near.surface.control_points.size < fit.surface.control_points.size
    least = batten.fit_grid(points, control_points=(6, 7))
    assert least.surface.control_points.shape == (6, 7, 3)
    assert batten.fit_grid(points, method="local").rms < ITERATED
    u, v = np.linspace(0, 2, 20), np.linspace(5, 6, 30)
    given = batten.fit_grid(points, parameters=(u, v)).surface
    assert given.domain == ((0, 2), (5, 6)) and np.allclose(given(u[:, None], v[None]), points, atol=ITERATED)


def test_missing_cells_are_filled():
    points = grid()
    points[3, 4] = points[10, 10:14] = np.nan
    fit = batten.fit_grid(points)
    assert fit.residuals.shape == (600 - 5,) and np.abs(fit.residuals).max() < 1e-6
    assert fit.surface.closest(grid()[10, 12]).distances < 1e-3


def test_parts_get_a_surface_each():
    both = np.vstack([sheet(900), sheet(500) + [5, 0, 0]])
    fits = batten.fit_parts(both, optimize="none")
    assert [len(fit.points) for fit in fits] == [900, 500] and all(fit.rms < 1e-3 for fit in fits)


def test_comparison_with_brute_force(rng):
    s = batten.make.sphere(2.0)
    q = rng.normal(size=(200, 3))
    found = batten.compare(s, q, tolerance=0.5)
    expected = np.linalg.norm(q, axis=1) - 2
    assert np.allclose(found.distances, expected, atol=ITERATED) and found.ok == (np.abs(expected).max() <= 0.5)
    assert found.report["error"]["out_of_tolerance"] == (np.abs(expected) > 0.5).sum()
    both = batten.compare([s, batten.make.plane((20, 20), center=(0, 0, 10))], np.vstack([q, q + [0, 0, 10]]))
    assert (both.owners[:200] == 0).all() and (both.owners[200:][np.abs(q[:, 2]) < 1] == 1).all()
    assert len(both.report["parts"]) == 2 and len(both.geometries) == 2


def test_comparison_checks_a_profile(rng):
    s = batten.make.torus(5.0, 1.5)
    q = s.sample(1500, noise=0.003, seed=3).points + [0.04, -0.02, 0.03]
    loose = batten.compare(s, q, profile=0.05)
    found = batten.compare(s, q, align="best", profile=0.05, certify=True, tolerance=0.05)
    assert loose.report["profile"]["decision"] == "does_not_conform" and found.report["profile"]["decision"] == "conforms"
    assert np.allclose(found.report["alignment"]["translation"], [-0.04, 0.02, -0.03], atol=2e-3)
    certified = found.report["certified"]
    assert certified["proved_within"] == 1500 and certified["max_upper"] >= np.abs(found.distances).max()
    assert "alignment" not in loose.report and "certified" not in loose.report
    narrow = batten.compare(s, q, align="datum", datums=[0], profile=(-0.001, 0.001))
    assert narrow.report["profile"]["decision"] == "does_not_conform"
    for keywords in ({"align": "best", "datums": [0]}, {"align": "datum"}, {"align": "worst"}, {"profile": 0}, {"profile": (1, 0)},
                     {"profile": (1, 2, 3)}, {"align": "datum", "datums": [7]}):
        with pytest.raises(ValueError):
            batten.compare(s, q, **keywords)
    with pytest.raises(ValueError):
        batten.compare(batten.make.circle(1.0), q, align="best")
    ball = batten.fit_primitive(batten.make.sphere(5.0).sample(400, noise=0.01), "sphere")
    assert 0.01 < ball.report["form"]["minimum_zone"] <= ball.report["form"]["least_squares"]


def test_what_a_fit_writes(tmp_path, sheet_fit, curve_fit):
    for fit in (sheet_fit, curve_fit):
        for name in ("a.step", "a.iges", "a.json", "a.html"):
            getattr(fit, "to_" + name[2:])(tmp_path / name)
        fit.to_report(tmp_path / "report.json")
        fit.to_residuals(tmp_path / "residuals.csv")
        fit.to_residuals(tmp_path / "residuals.ply")
        rows = np.genfromtxt(tmp_path / "residuals.csv", delimiter=",", names=True)
        assert np.array_equal(rows["distance"], fit.residuals)
        page = (tmp_path / "a.html").read_text()
        assert page.startswith("<!DOCTYPE html>") and fit.report["end"]["words"][:20] in page
        assert json.loads((tmp_path / "report.json").read_text())["error"] == fit.report["error"]
        assert len(batten.read_geometry(tmp_path / "a.step")) >= 1
    sheet_fit.to_mesh(tmp_path / "a.stl")
    sheet_fit.to_html(tmp_path / "both.html", beside=tmp_path / "a.html")
    data = page[page.index('id="batten-data">') + 17:].partition("</script")[0]
    assert 'id="batten-beside">' + data + "</script" in (tmp_path / "both.html").read_text()
    inches = batten.fit_surface(sheet(300), unit="inch", optimize="none")
    for other in ("a.html", "report.json"):
        with pytest.raises(ValueError, match="^beside: "):
            inches.to_html(tmp_path / "bad.html", beside=tmp_path / other)
    with pytest.raises(FileNotFoundError):
        inches.to_html(tmp_path / "bad.html", beside=tmp_path / "absent.html")
    assert not (tmp_path / "bad.html").exists()
    inches.to_step(tmp_path / "inch.step")
    inches.to_iges(tmp_path / "metre.iges", unit="m")
    assert [batten.read_geometry(tmp_path / name).unit for name in ("inch.step", "metre.iges")] == ["inch", "m"]
    inches.to_mesh(tmp_path / "inch.glb", tolerance=0.1)
    batten.write_mesh(inches.surface.tessellate(0.1), tmp_path / "same.glb", unit="inch")
    assert (tmp_path / "inch.glb").read_bytes() == (tmp_path / "same.glb").read_bytes()
    assert batten.read_geometry(tmp_path / "a.json")[0] == curve_fit.curve
    with pytest.raises(ValueError):
        sheet_fit.to_residuals(tmp_path / "residuals.txt")


def test_notebook_view_and_repr(sheet_fit, curve_fit):
    html = sheet_fit._repr_html_()
    assert html.startswith("<iframe") and "&lt;!DOCTYPE" in html and len(html) < 8e6
    for fit in (sheet_fit, curve_fit):
        assert "\n" not in repr(fit) and "rms" in repr(fit)


def test_pictures(sheet_fit, curve_fit):
    import matplotlib.pyplot as plt

    assert len(sheet_fit.plot().collections) >= 2
    assert len(sheet_fit.plot(colours=False, knots=False).lines) == 0
    curve_fit.plot()
    flat = batten.fit_curve(helix(100)[:, :2] + [[0.001, 0]], closed=True)
    ax = plt.figure().add_subplot()
    assert flat.plot(ax) is ax and len(ax.lines) >= 1
    assert len(batten.fit_surface(sheet(200), tolerance=0.1).plot_residuals().lines) == 2
    batten.compare([batten.make.sphere(1), batten.make.plane((3, 3))], sheet(100)).plot()
    plt.close("all")


REFUSED = {
    "three points": np.eye(3),
    "none": np.zeros((0, 3)),
    "one place": np.ones((50, 3)),
    "a line": np.outer(np.arange(50.0), [1, 2, 3]),
}


@pytest.mark.parametrize("points", REFUSED)
def test_points_that_carry_no_surface(points):
    with pytest.raises(batten.FitRefused) as caught:
        batten.fit_surface(REFUSED[points])
    assert caught.value.reason and "\n" not in caught.value.reason and isinstance(caught.value.numbers, tuple)
    assert isinstance(caught.value, ValueError)


def test_refusals_have_numbers_and_remedies(tmp_path):
    import pickle

    error = batten.FitRefused("needs 4 points, 3 of 1.5e-3 mm are there", "base='sheet'")
    assert error.numbers == (4, 3, 1.5e-3) and error.remedy == "base='sheet'" and "try base='sheet'" in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert (again.reason, again.remedy, again.numbers) == (error.reason, error.remedy, error.numbers)
    ball = batten.make.sphere(2.0).sample(1500, noise=1e-3)
    with pytest.raises(batten.FitRefused) as caught:
        batten.fit_surface(ball, base="plane")
    assert caught.value.remedy == "base='sheet'" and len(caught.value.numbers) == 1
    with pytest.raises(batten.FitRefused) as caught:
        batten.fit_surface(batten.make.cylinder(2, 5, sweep=4).sample(1500), closed="uv")
    assert caught.value.remedy == "closed='auto'"


WRONG = [
    ("tolerance", 0),
    ("tolerance", -1),
    ("tolerance", "small"),
    ("tolerance", np.nan),
    ("tolerance", True),
    ("degree", 0),
    ("degree", 26),
    ("degree", 2.5),
    ("degree", (3,)),
    ("degree", "cubic"),
    ("control_points", 5),
    ("control_points", (2, 2)),
    ("control_points", (5, 6, 7)),
    ("max_control_points", 1),
    ("max_control_points", 10**12),
    ("smoothing", -1),
    ("smoothing", "lots"),
    ("loss", "hubert"),
    ("loss", 3),
    ("loss_scale", 0),
    ("optimize", "everything"),
    ("optimize", 3),
    ("base", "cube"),
    ("closed", "w"),
    ("trim", "yes"),
    ("boundary", [3]),
    ("boundary", 3),
    ("meet", [[1, 2]] * 3 + [[1]]),
    ("symmetric", "w"),
    ("symmetric", [0, 0, 0, 1]),
    ("symmetric", [1, 2]),
    ("domain", [1, 1, 0, 0]),
    ("domain", [1, 1]),
    ("thin", 0),
    ("keep_outliers", "no"),
    ("snap", 2),
    ("shift", [np.nan, 0, 0]),
    ("shift", "there"),
    ("unit", "furlong"),
    ("seed", -1),
    ("seed", 1.5),
    ("threads", "all"),
    ("progress", 3),
    ("terms", 3),
    ("normals", np.zeros((3, 3))),
    ("weights", np.zeros(100)),
    ("parameters", np.zeros((4, 2))),
    ("given_parameters", True),
]


@pytest.mark.parametrize("name, value", WRONG, ids=[f"{n}={str(v)[:20]}" for n, v in WRONG])
def test_wrong_keywords_are_named(name, value):
    with pytest.raises(ValueError, match=name) as caught:
        batten.fit_surface(sheet(100), **{name: value})
    assert not isinstance(caught.value, batten.FitRefused)


@pytest.mark.parametrize(
    "call, name",
    [
        (lambda p: batten.fit_curve(p, closed="perhaps"), "closed"),
        (lambda p: batten.fit_curve(p, component=0), "component"),
        (lambda p: batten.fit_curve(p, parameterization="given"), "parameterization"),
        (lambda p: batten.fit_curve(p, parameterization="chord", parameters=np.zeros(100)), "parameterization"),
        (lambda p: batten.fit_curve(p, control_points=(4, 4)), "control_points"),
        (lambda p: batten.fit_primitive(p, "cube"), "kind"),
        (lambda p: batten.fit_primitive(p, tolerance=-1), "tolerance"),
        (lambda p: batten.fit_grid(p), "points"),
        (lambda p: batten.fit_grid(p, (7, 7)), "shape"),
        (lambda p: batten.fit_grid(p, (10, 10), parameters=3), "parameters"),
        (lambda p: batten.fit_grid(p, "ten"), "shape"),
        (lambda p: batten.fit_surface(p[:, :2]), "points"),
        (lambda p: batten.interpolate_curve(p, degree=0), "degree"),
        (lambda p: batten.interpolate_curve(p, tolerance=0), "tolerance"),
        (lambda p: batten.interpolate_curve(p, start_tangent=[1]), "start_tangent"),
        (lambda p: batten.compare(3, p), "geometry"),
        (lambda p: batten.compare([], p), "geometry"),
        (lambda p: batten.compare(batten.make.sphere(1), np.zeros((0, 3))), "points"),
        (lambda p: batten.compare(batten.make.sphere(1), p, tolerance=-1), "tolerance"),
    ],
)
def test_the_other_functions_name_them_too(call, name):
    with pytest.raises(ValueError, match=name) as caught:
        call(sheet(100))
    assert not isinstance(caught.value, batten.FitRefused)
