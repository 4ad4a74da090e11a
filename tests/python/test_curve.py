# SPDX-License-Identifier: MIT
"""Curves: evaluation against scipy and differences, operations that keep the shape, values."""
import copy
import pickle

import numpy as np
import pytest
from scipy.interpolate import BSpline, splev, splprep

import batten
from conftest import HALF_DIGITS, ITERATED, ROUNDING, random_curve, same_points


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 9])
@pytest.mark.parametrize("dimension", [2, 3])
def test_points_are_scipys(rng, degree, dimension):
    c = random_curve(rng, degree, degree + 6, dimension, rational=False)
    t = np.append(rng.random(60), [0, 1])
    expected = BSpline(np.array(c.knots), np.array(c.control_points), c.degree)
    assert np.abs(c(t) - expected(t)).max() < 100 * ROUNDING
    assert np.abs(c.derivatives(t, 1)[1] - expected(t, 1)).max() < 1e4 * ROUNDING * np.abs(expected(t, 1)).max()


def test_rational_derivatives_are_differences(rng):
    c, t, h = random_curve(rng, 4, 9), rng.uniform(0.1, 0.9, 40), 1e-6
    t = t[np.abs(c.knots[:, None] - t).min(axis=0) > 2 * h]
    d = c.derivatives(t, 2)
    scale = np.abs(d[2]).max()
    assert np.abs(d[1] - (c(t + h) - c(t - h)) / (2 * h)).max() < 1e3 * HALF_DIGITS * scale
    assert np.abs(d[2] - (c.derivatives(t + h)[1] - c.derivatives(t - h)[1]) / (2 * h)).max() < 1e3 * HALF_DIGITS * scale


@pytest.mark.parametrize("shape", [(), (0,), (5,), (2, 3)])
def test_parameters_of_any_shape(rng, shape):
    c, u = random_curve(rng), rng.random(shape)
    assert c(u).shape == shape + (3,) and c.derivatives(u, 2).shape == (3,) + shape + (3,)
    assert c.curvature(u).shape == shape + (2,) and c.tangent(u).shape == shape + (3,)


def test_curvature_of_a_helix_like_arc():
    c = batten.make.circle(4.0)
    assert np.allclose(c.curvature(np.linspace(0, 1, 17))[:, 0], 0.25, atol=ITERATED)
    assert c.curvature_range == pytest.approx((0.25, 0.25))
    assert c.length == pytest.approx(8 * np.pi, rel=ROUNDING * 10)


def test_lengths_and_parameters_are_inverse(rng):
    c = random_curve(rng)
    at = np.linspace(0, c.length, 11)
    u = c.parameter_at_length(at)
    assert [c.length_between(0, float(x)) for x in u] == pytest.approx(list(at), abs=ITERATED)


def test_closest_is_the_nearest_of_all(rng):
    for dimension in (2, 3):
        c = random_curve(rng, dimension=dimension)
        q = rng.normal(size=(40, dimension))
        found = c.closest(q)
        dense = c(np.linspace(0, 1, 4001))
        brute = np.sqrt(((q[:, None] - dense[None]) ** 2).sum(-1)).min(1)
        assert (found.distances <= brute + ITERATED).all() and np.abs(found.distances - brute).max() < 1e-2
        assert found.certified.all() and found.parameters.shape == (40,)


KEEPING = {
    "insert_knot": lambda c: c.insert_knot(0.37, 2),
    "refine": lambda c: c.refine([0.11, 0.5, 0.5]),
    "elevate": lambda c: c.elevate(3),
    "up and down": lambda c: c.elevate().reduce(tolerance=1e-9).shape,
    "in and out": lambda c: c.insert_knot(0.37).remove_knot(0.37, tolerance=1e-9).shape,
    "reverse twice": lambda c: c.reverse().reverse(),
    "unclamp": lambda c: c.unclamp(),
    "split and join": lambda c: c.split(0.6)[0].join(c.split(0.6)[1], tolerance=1e-9),
    "other domain": lambda c: c.reparameterize(-3, 9).reparameterize(0, 1),
    "scaled": lambda c: c.scale(3, center=(1, 1, 0)).scale(1 / 3, center=(1, 1, 0)),
}


@pytest.mark.parametrize("change", KEEPING)
@pytest.mark.parametrize("dimension", [2, 3])
def test_the_shape_stays(rng, change, dimension):
    c = random_curve(rng, dimension=dimension)
    assert same_points(c, KEEPING[change](c), 1e4 * ROUNDING)


def test_pieces_and_segments(rng):
    c = random_curve(rng)
    assert len(c.decompose()) == 5 and all(len(p.control_points) == 4 for p in c.decompose())
    s = c.segment(0.2, 0.7)
    assert s.domain == (0.2, 0.7) and np.allclose(s(0.5), c(0.5), atol=100 * ROUNDING)


def test_moved_points_and_weights(rng):
    c = random_curve(rng, dimension=2)
    assert np.allclose(c.move_point(0.4, [5, 6])(0.4), [5, 6], atol=100 * ROUNDING)
    assert c.set_weight(2, 7.0).weights[2] == 7
    assert np.allclose(c.extend(1.0)(0.5), c(0.5), atol=1e4 * ROUNDING)
    assert c.extend(1.0).length == pytest.approx(c.length + 1, rel=1e-8)


def test_several_points_are_met_at_once(rng):
    c = random_curve(rng)
    to = [[1, 2, 3], [0, 1, 0], [4, 5, 6]]
    moved = c.move_points([0.2, 0.2, 0.8], to, order=[0, 1, 0], keep=[0.5], fixed=[0])
    assert np.allclose(moved([0.2, 0.8, 0.5]), [to[0], to[2], c(0.5)], atol=1e4 * ROUNDING)
    assert np.allclose(moved.derivatives(0.2, 1)[1], to[1], atol=1e6 * ROUNDING)
    assert (moved.control_points[0] == c.control_points[0]).all()
    with pytest.raises(ValueError, match="can't be met"):
        c.move_points([0.5, 0.5], [[0, 0, 0], [1, 0, 0]])


def test_pulls_warps_flattening_and_bends(rng):
    arch = batten.Curve(3, [0, 0, 0, 0, 1, 1, 1, 1], [[0, 0], [0, 2], [2, 2], [2, 0]])
    assert np.allclose(arch.pull(0.5, (1, 2), 0.25)(0.5), [1, 1.75], atol=100 * ROUNDING)
    assert np.linalg.norm(arch.pull(0.5, 1, 0.25)(0.5) - arch(0.5)) == pytest.approx(0.25, abs=100 * ROUNDING)
    c = random_curve(rng)
    warped = c.warp((0.2, 0.6), [0, 0, 2], shape="tent")
    assert np.allclose(warped(0.4), c(0.4) + [0, 0, 2], atol=1e4 * ROUNDING)
    assert np.allclose(warped([0.1, 0.7]), c([0.1, 0.7]), atol=1e4 * ROUNDING)
    flat = c.flatten((0.2, 0.6), [0, 1, 1], 1.0, along=[0, 0, 1])
    assert np.allclose(flat(np.linspace(0.2, 0.6, 9)) @ [0, 1, 1], 1, atol=1e4 * ROUNDING)
    line = batten.make.line([5, 0, 0], [5, 6, 0]).elevate(2)
    bent, error = line.bend([5, 0, 0], [0, 0, 0], 6, tolerance=1e-6)
    assert error <= 1e-6 and np.allclose(np.linalg.norm(bent(np.linspace(0, 1, 99)), axis=1), 5, atol=2e-6)


def test_moebius_and_composition(rng):
    c, t = random_curve(rng, 2, 5), np.linspace(0, 1, 9)
    assert np.allclose(c.moebius(1, 0, -0.5, 1.5)(t), c(t / (1.5 - 0.5 * t)), atol=1e4 * ROUNDING)
    f = (2, [0, 0, 0, 1, 1, 1], [0, 0.7, 1])
    assert np.allclose(c.compose(f)(t), c(1.4 * t * (1 - t) + t * t), atol=1e4 * ROUNDING)


def test_periodic_forms():
    c = batten.interpolate_curve([[1, 0], [0, 1], [-1, 0], [0, -1]], closed=True).curve
    assert c.periodic and c.closed and not c.clamped and c.seam_continuity() >= 2
    flat = c.clamp()
    assert not flat.periodic and flat.clamped and flat.closed and same_points(c, flat)
    again = flat.make_periodic(1e-9)
    assert again.periodic and same_points(c, again, 1e-9)
    assert np.allclose(c(0.3), c(1.3), atol=ITERATED)
    assert pickle.loads(pickle.dumps(c)) == c


def test_classification():
    assert batten.make.circle(2).classify()[0] == "circle"
    name, numbers = batten.make.ellipse((3, 2)).classify()
    assert name == "ellipse" and numbers["major_radius"] == pytest.approx(3)
    assert batten.make.line([0, 0, 0], [1, 2, 3]).analyze()["shape"][0] == "line"


def test_joins():
    a, b = batten.make.arc(1.0).split(0.5)
    assert a.join_quality(b)["G"] == 2
    with pytest.raises(ValueError, match="other"):
        a.join_quality(batten.make.sphere(1))


@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize("dimension", [2, 3])
def test_values(rng, rational, dimension):
    c = random_curve(rng, dimension=dimension, rational=rational)
    twin = batten.Curve(c.degree, c.knots, c.control_points, c.weights)
    assert c == twin and hash(c) == hash(twin)
    for other in (pickle.loads(pickle.dumps(c)), copy.copy(c), copy.deepcopy(c)):
        assert other == c and hash(other) == hash(c)
    assert c != c.reverse() and "\n" not in repr(c)
    with pytest.raises(ValueError):
        c.knots[0] = -1
    with pytest.raises(AttributeError):
        c.degree = 2


def test_to_and_from_scipy(rng):
    c = random_curve(rng, rational=False)
    t = rng.random(20)
    assert np.allclose(c.to_scipy()(t), c(t), atol=100 * ROUNDING) and batten.Curve.from_scipy(c.to_scipy()) == c
    with pytest.raises(ValueError, match="rational"):
        random_curve(rng).to_scipy()
    x = np.linspace(0, 6, 50)
    tck, u = splprep([np.cos(x), np.sin(x), x], s=0)
    c = batten.Curve.from_scipy((tck, u))
    assert np.allclose(c(u), np.array(splev(u, tck)).T, atol=100 * ROUNDING) and batten.Curve.from_scipy(tck) == c


@pytest.mark.parametrize(
    "arguments, words",
    [
        ((0, [0, 1], [[0, 0]]), "degree|knots"),
        ((30, [0.0] * 31 + [1.0] * 31, np.zeros((31, 2))), "degree|knots"),
        ((2, [0, 0, 0, 1, 1], [[0, 0], [1, 1], [2, 2]]), "control_points|control point|knots"),
        ((1, [0, 0, 1, 0.5], [[0, 0], [1, 1]]), "knots"),
        ((1, [0, 0, np.nan, 1], [[0, 0], [1, 1]]), "knots"),
        ((1, [0, 0, 1, 1], [[0, 0], [np.inf, 1]]), "finite|control"),
        ((1, [0, 0, 1, 1], [[0, 0], [1, 1]], [1, -1]), "weight"),
        ((1, [0, 0, 1, 1], [[0, 0], [1, 1]], [1, 1, 1]), "weight"),
        ((1, [0, 0, 1, 1], [[0, 0, 0, 0], [1, 1, 1, 1]]), "control_points"),
        ((1, [0, 0, 1, 1], [0, 1]), "control_points"),
        ((1, "knots", [[0, 0], [1, 1]]), "knots"),
        (("one", [0, 0, 1, 1], [[0, 0], [1, 1]]), "degree"),
        ((1, [0, 0, 1, 1], np.zeros((0, 2))), "control"),
    ],
)
def test_wrong_numbers_are_refused(arguments, words):
    with pytest.raises(ValueError, match=words):
        batten.Curve(*arguments)
