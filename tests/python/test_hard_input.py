# SPDX-License-Identifier: MIT
"""Whatever it is called with, the module answers or raises what a caller can catch; nothing crashes."""
import inspect
import itertools
import random
import re

import numpy as np
import pytest

import batten
from conftest import random_curve, random_surface

ODD = [
    None,
    True,
    0,
    -1,
    3,
    10**30,
    0.5,
    float("nan"),
    float("inf"),
    -1e308,
    1 + 2j,
    "",
    "u",
    "v",
    "auto",
    b"bytes",
    [],
    [[]],
    [1, 2],
    [0, 0, 1],
    [0, 0, 0, 0],
    [0.0, 0, 1, -0.5],
    {"a": 1},
    object(),
    np.zeros(0),
    np.zeros((0, 3)),
    np.zeros((3, 0)),
    np.zeros((5, 3), dtype=np.float32, order="F"),
    np.full((4, 3), np.nan),
    np.zeros((2, 2, 2)),
    np.array(["x"]),
    np.array([None, 1], dtype=object),
    np.ma.masked_array([1.0, 2], mask=[True, False]),
    np.linspace(0, 1, 7)[::-2],
    np.eye(4),
    len,
    batten.make.line([0, 0, 0], [1, 0, 0]),
    batten.make.circle(0.25, center=(0.5, 0.5)),
    batten.make.plane((1, 1)),
    batten.Cloud(np.eye(3)),
]
INTERNAL = re.compile(r"[A-Za-z]\w*::|\b[A-Z][a-z]+[A-Z]\w*: ")  # names of the library
CALLER = (ValueError, TypeError, AttributeError, OSError, RuntimeError, ImportError, IndexError, OverflowError, MemoryError)
WRITERS = {"write", "to_step", "to_iges", "to_json", "to_mesh", "to_html", "to_report", "to_residuals"}


def subjects():
    rng = np.random.default_rng(8)
    return {
        "Surface": random_surface(rng, (2, 2), (4, 4)),
        "Curve": random_curve(rng, 2, 4),
        "Curve2": random_curve(rng, 2, 4, 2),
        "Cloud": batten.Cloud(rng.random((30, 3))),
    }


METHODS = [
    (kind, name)
    for kind, subject in subjects().items()
    for name, method in inspect.getmembers(type(subject), callable)
    if (not name.startswith("_") or name == "__call__") and name not in WRITERS
]


@pytest.mark.parametrize("kind, name", METHODS, ids=["-".join(m) for m in METHODS])
def test_methods_survive(kind, name):
    method = getattr(subjects()[kind], name)
    signature = inspect.signature(method)
    count = len([p for p in signature.parameters.values() if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)])
    chooser = random.Random(name)
    tries = [[one] * count for one in ODD] + [[chooser.choice(ODD) for _ in range(count)] for _ in range(40)]
    for arguments in tries if count else [[]]:
        if name == "tessellate" and isinstance(arguments[0], float) and 0 < arguments[0] < 1e-3:
            continue
        try:
            method(*arguments)
        except CALLER as error:
            assert not INTERNAL.search(str(error)), error


FUNCTIONS = {
    "Surface": (batten.Surface, 5),
    "Curve": (batten.Curve, 4),
    "Cloud": (batten.Cloud, 1),
    "fit_surface": (batten.fit_surface, 1),
    "fit_curve": (batten.fit_curve, 1),
    "fit_primitive": (batten.fit_primitive, 2),
    "fit_grid": (batten.fit_grid, 2),
    "fit_solid": (batten.fit_solid, 1),
    "layout": (lambda layout: batten.fit_solid(np.eye(3), layout=layout), 1),
    "interpolate_curve": (batten.interpolate_curve, 1),
    "compare": (batten.compare, 2),
    "optimize": (batten.optimize, 3),
    "cloud_parts": (batten.cloud_parts, 1),
    "from_geomdl": (batten.from_geomdl, 1),
    "read_cloud": (batten.read_cloud, 1),
    "read_geometry": (batten.read_geometry, 1),
    **{"make." + name: (getattr(batten.make, name), 2) for name in batten.make.__all__},
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_survive(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    function, count = FUNCTIONS[name]
    chooser = random.Random(name)
    for arguments in [[one] * count for one in ODD] + [[chooser.choice(ODD) for _ in range(count)] for _ in range(60)]:
        try:
            function(*arguments)
        except CALLER as error:
            assert not INTERNAL.search(str(error)), error


def test_keywords_survive():
    points = np.random.default_rng(1).random((40, 3))
    for function in (batten.fit_surface, batten.fit_curve, batten.fit_primitive):
        names = [n for n, p in inspect.signature(function).parameters.items() if p.kind == p.KEYWORD_ONLY]
        for name, value in itertools.product(names, ODD):
            try:
                function(points, **{"optimize": "none", **({name: value})} if "optimize" in names else {name: value})
            except CALLER as error:
                assert not INTERNAL.search(str(error)), error


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_parameters_that_are_no_numbers(value):
    s, c = batten.make.sphere(1), batten.make.circle(1)
    if not np.isnan(value):
        assert np.isfinite(s(value, 0.5)).all() and np.isfinite(c(value)).all()
        return
    calls = [lambda u, v, call=call: call(u, v) for call in (s, s.normal, s.curvature, s.contains)]
    calls += [lambda u, v, order=order: s.derivatives(u, v, order) for order in (0, 2, 3)]
    for call in calls:
        for u, v, name in ((value, 0.5, "u"), ([0.1, value], 0.5, "u"), (0.5, value, "v"), (0.5, [0.1, value], "v")):
            with pytest.raises(ValueError, match=f"^{name}: not a number$"):
                call(u, v)
    for call in (c, c.tangent, c.curvature, lambda u: c.derivatives(u, 3)):
        with pytest.raises(ValueError, match="^u: not a number$"):
            call([0.1, value])
    for call, name in (
        (lambda: s.iso("u", value), "at"),
        (lambda: c.split(value), "at"),
        (lambda: s.move_point(0.5, value, [1, 1, 1]), "v"),
        (lambda: c.length_between(0, value), "b"),
        (lambda: batten.make.sphere(value), "radius"),
    ):
        with pytest.raises(ValueError, match=f"^{name}: nan is not a number$"):
            call()


def test_messages_name_arguments():
    c = batten.make.circle(1)
    calls = (
        lambda: c.parameter_at_length(99),
        lambda: batten.Curve(2, [0, 0, 1], np.zeros((3, 3))),
        lambda: batten.Cloud(np.eye(3), normals=np.eye(3)[:2]),
        lambda: batten.Cloud(np.eye(3), weights=-np.ones(3)),
        lambda: batten.Surface(1, [0, 1, 2], [0, 0, 1, 1], np.zeros((2, 2, 3))),
        lambda: c.compose((1, [0, 1], [0, 5])),
    )
    for call in calls:
        with pytest.raises(ValueError) as caught:
            call()
        assert not INTERNAL.search(str(caught.value)), caught.value


def test_points_that_are_no_numbers():
    for shape in (batten.make.sphere(1), batten.make.circle(1)):
        with pytest.raises(ValueError, match="points"):
            shape.closest([[0, 0, np.nan]])


def test_extremes_of_size():
    points = np.random.default_rng(1).random((60, 3))
    plan = points[np.lexsort(points.T)][:, [2, 0, 1]]
    fits = (
        batten.fit_surface,
        batten.fit_curve,
        batten.fit_primitive,
        batten.interpolate_curve,
        lambda p: batten.compare(batten.make.sphere(1), p),
        lambda p: batten.fit_surface(plan, meet=p),
        lambda p: batten.fit_grid(p, (6, 10)),
    )
    for fit, name in zip(fits, ["points"] * 5 + ["meet", "points"]):
        for size in (1e19, 1e30, 1e300, 1.7e308):
            with pytest.raises(ValueError, match=rf"^{name}: row 0: the number .* is beyond ±1e18") as caught:
                fit(plan * size)
            assert not isinstance(caught.value, batten.FitRefused)
    for fit, name in zip(fits[:6], ["points"] * 5 + ["meet"]):  # in a grid it is a missing cell
        with pytest.raises(ValueError, match=f"^{name}: row 7 is not finite"):
            fit(np.where(np.arange(60)[:, None] == 7, -np.inf, plan))
    assert np.isfinite(batten.fit_surface(plan * 1e18, optimize="none").residuals).all()
    for size in (1e-101, 1e-150, 1e-300):
        for fit in (batten.fit_surface, lambda p: batten.fit_curve(p, order="given"), batten.interpolate_curve):
            with pytest.raises(batten.FitRefused, match="^the points differ by less than 1e-100: scale them up"):
                fit(plan * size)
    assert batten.fit_surface(plan * 1e-99, optimize="none").rms > 0
    with pytest.raises(batten.FitRefused, match="on a line"):
        batten.fit_surface(np.outer(np.arange(1.0, 60), [1, 2, 3]) * 1e-90)
    assert batten.make.sphere(1e-200)(0.5, 0.5).shape == (3,)
    assert np.isfinite(batten.make.sphere(1e150)(0.5, 0.5)).all()


def test_core_objects_are_not_made_by_hand():
    for kind in (batten._core.Body, batten._core.Points, batten._core.Fit):
        with pytest.raises(TypeError):
            kind()


@pytest.mark.parametrize("threads", [-1, 1025, 10**6])
def test_threads_without_number(threads):
    points, ball, arc = np.random.default_rng(1).random((500, 3)), batten.make.sphere(1), batten.make.arc(1)
    calls = [lambda: batten.fit_surface(points, threads=threads), lambda: batten.compare(ball, points, threads=threads)]
    calls += [lambda: batten.optimize(arc, arc([0, 0.5, 1]), [0, 0.5, 1], threads=threads)]
    if threads < 0:  # these take as many as there are of use
        calls += [lambda call=call: call(0.5, 0.5, threads=threads) for call in (ball, ball.normal, ball.curvature, ball.contains)]
        calls += [lambda: arc(0.5, threads=threads), lambda: ball.closest(points, threads=threads)]
        calls += [lambda: batten.Cloud(points).statistics(threads=threads), lambda: batten.cloud_parts(points, threads=threads)]
    for call in calls:
        with pytest.raises(ValueError, match="threads"):
            call()


def test_very_many_threads_are_fewer():
    torus = batten.make.torus(3, 1)
    points = np.random.default_rng(1).normal(size=(2000, 3))
    assert np.array_equal(torus.closest(points, threads=10**6).distances, torus.closest(points, threads=1).distances)
