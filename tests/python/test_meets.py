# SPDX-License-Identifier: MIT
"""Where shapes meet, and shapes at a distance."""
import math

import numpy as np
import pytest

import batten


def test_spheres_meet_in_a_circle() -> None:
    met = batten.intersect(batten.make.sphere(1.0), batten.make.sphere(1.0, center=(1.2, 0, 0)))
    assert [branch.kind for branch in met.branches] == ["transversal"]
    branch = met.branches[0]
    assert branch.closed and branch.deviation < 4e-6
    assert branch.curve.length == pytest.approx(2 * math.pi * 0.8, rel=1e-5)
    assert not met.points and not met.overlaps


def test_places_of_curves_and_surfaces_agree() -> None:
    line, ball = batten.make.line((-3, 0.1, 0), (3, 0.1, 0)), batten.make.sphere(1.0)
    met = batten.intersect(line, ball)
    assert len(met.points) == 2
    for one in met.points:
        assert np.linalg.norm(one.point) == pytest.approx(1)
        assert np.allclose(line(one.first[0]), one.point, atol=1e-5)
        assert np.allclose(ball(*one.second), one.point, atol=1e-5)
    turned = batten.intersect(ball, line)
    assert np.allclose(turned.points[0].second, met.points[0].first)


def test_an_offset_is_exact_or_within_its_tolerance() -> None:
    circle = batten.offset(batten.make.circle(2.0), 0.5)
    assert circle.exact and circle.geometry[0].length == pytest.approx(3 * math.pi)
    shape = batten.Surface(2, [0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 1], [[[i, j, i * j / 4] for j in range(3)] for i in range(3)])
    aside = batten.offset(shape, 0.1, tolerance=1e-4)
    assert aside.ok and not aside.exact and aside.deviation <= 1e-4
    u, v = np.random.default_rng(1).random((2, 200))
    exact = shape(u, v) + 0.1 * shape.normal(u, v)
    assert np.abs(aside.geometry[0](u, v) - exact).max() <= 1e-4


def test_a_distance_past_the_radius_is_refused_with_it() -> None:
    with pytest.raises(ValueError, match="smallest radius of curvature 2"):
        batten.offset(batten.make.circle(2.0), 2.5)
    with pytest.raises(ValueError, match="Curve or Surface"):
        batten.intersect(1, batten.make.sphere(1.0))  # type: ignore[arg-type]
