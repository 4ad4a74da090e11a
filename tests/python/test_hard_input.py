# SPDX-License-Identifier: MIT
"""Whatever it is called with, the module answers or raises what a caller can catch; nothing crashes."""
import inspect
import itertools
import random

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
        except CALLER:
            pass


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
        except CALLER:
            pass


def test_keywords_survive():
    points = np.random.default_rng(1).random((40, 3))
    for function in (batten.fit_surface, batten.fit_curve, batten.fit_primitive):
        names = [n for n, p in inspect.signature(function).parameters.items() if p.kind == p.KEYWORD_ONLY]
        for name, value in itertools.product(names, ODD):
            try:
                function(points, **{"optimize": "none", **({name: value})} if "optimize" in names else {name: value})
            except CALLER:
                pass


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_parameters_that_are_no_numbers(value):
    s, c = batten.make.sphere(1), batten.make.circle(1)
    if np.isnan(value):
        for call in (lambda: s(value, 0.5), lambda: s([0.1, value], 0.5), lambda: c(value), lambda: s.derivatives(value, 0, 2), lambda: s.normal(value, 0)):
            with pytest.raises(ValueError):
                call()
    else:
        assert np.isfinite(s(value, 0.5)).all() and np.isfinite(c(value)).all()


def test_points_that_are_no_numbers():
    for shape in (batten.make.sphere(1), batten.make.circle(1)):
        with pytest.raises(ValueError, match="points"):
            shape.closest([[0, 0, np.nan]])


def test_extremes_of_size():
    for size in (1e-150, 1e-30, 1e30, 1e100):
        try:
            fit = batten.fit_surface(np.random.default_rng(1).random((60, 3)) * size)
            assert np.isfinite(fit.residuals).all()
        except ValueError:
            pass
    assert batten.make.sphere(1e-200)(0.5, 0.5).shape == (3,)
    assert np.isfinite(batten.make.sphere(1e150)(0.5, 0.5)).all()


def test_core_objects_are_not_made_by_hand():
    for kind in (batten._core.Body, batten._core.Points, batten._core.Fit):
        with pytest.raises(TypeError):
            kind()


@pytest.mark.parametrize("threads", [-1, 1025, 10**6])
def test_threads_without_number(threads):
    with pytest.raises(ValueError, match="threads"):
        batten.fit_surface(np.random.default_rng(1).random((500, 3)), threads=threads)


def test_very_many_threads_are_fewer():
    torus = batten.make.torus(3, 1)
    points = np.random.default_rng(1).normal(size=(2000, 3))
    assert np.array_equal(torus.closest(points, threads=10**6).distances, torus.closest(points, threads=1).distances)
