# SPDX-License-Identifier: MIT
"""Exact shapes lie where they should."""
import numpy as np
import pytest

from batten import make
from conftest import ROUNDING

GRID = np.linspace(0, 1, 13)[:, None], np.linspace(0, 1, 11)[None, :]


def turned(p, axis):
    """Distance from an axis through the origin, and height on it."""
    axis = np.asarray(axis) / np.linalg.norm(axis)
    height = p @ axis
    return np.linalg.norm(p - height[..., None] * axis, axis=-1), height


@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 0, 0), (1, 2, -3)])
def test_cylinder_sphere_torus_cone(axis):
    radius, height = turned(make.cylinder(2, 5, axis=axis)(*GRID), axis)
    assert np.allclose(radius, 2, atol=10 * ROUNDING) and np.allclose(height, 5 * GRID[1], atol=10 * ROUNDING)
    assert np.allclose(np.linalg.norm(make.sphere(3, axis=axis)(*GRID), axis=-1), 3, atol=10 * ROUNDING)
    radius, height = turned(make.torus(3, 1, axis=axis)(*GRID), axis)
    assert np.allclose((radius - 3) ** 2 + height**2, 1, atol=100 * ROUNDING)
    radius, height = turned(make.cone(2, 4, axis=axis)(*GRID), axis)
    assert np.allclose(radius, 2 * (1 - height / 4), atol=10 * ROUNDING)


def test_partial_shapes():
    half = make.sphere(1, latitudes=(0, np.pi / 2), sweep=np.pi)
    assert half.area == pytest.approx(np.pi, rel=1e-9) and half(*GRID)[..., 2].min() >= -10 * ROUNDING
    assert make.cone(2, 3, top_radius=1).area == pytest.approx(np.pi * 3 * np.sqrt(10), rel=1e-9)
    assert make.plane((2, 3), center=(1, 1, 1)).area == pytest.approx(6)
    assert make.torus(3, 1, tube_sweep=np.pi).area == pytest.approx(2 * np.pi**2 * 3, rel=1e-8)


def test_curves():
    assert make.arc(2, sweep=np.pi).length == pytest.approx(2 * np.pi)
    flat = make.circle(2, center=(1, 1))
    assert flat.dimension == 2 and np.allclose(np.linalg.norm(flat(GRID[0]) - 1, axis=-1), 2, atol=10 * ROUNDING)
    p = make.ellipse((3, 2))(np.linspace(0, 1, 31))
    assert np.allclose((p[:, 0] / 3) ** 2 + (p[:, 1] / 2) ** 2, 1, atol=10 * ROUNDING)
    assert np.allclose(make.line([0, 0], [2, 4])(0.5), [1, 2])


def test_revolved_profile():
    vase = make.revolve(make.line([1, 0, 0], [2, 0, 3]))
    assert np.allclose(turned(vase(*GRID), (0, 0, 1))[0], 1 + GRID[1], atol=10 * ROUNDING)
    assert np.allclose(make.bilinear([0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 4])(0.5, 0.5), [0.5, 0.5, 1])


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: make.sphere(-1), "radius"),
        (lambda: make.sphere("big"), "radius"),
        (lambda: make.cylinder(1, 2, axis=(0, 0, 0)), "axis"),
        (lambda: make.cylinder(1, 2, axis=(0, 0)), "axis"),
        (lambda: make.circle(1, x=(0, 0, 1)), "x|axis"),
        (lambda: make.plane((1, -1)), "size"),
        (lambda: make.arc(1, sweep=7), "sweep|2π|angle"),
        (lambda: make.line([0, 0, 0], [0, 0, 0]), "differ|point"),
        (lambda: make.line([0, 0, 0], [1, 1]), "start, end"),
        (lambda: make.torus(1, np.nan), "minor|radius|radii"),
        (lambda: make.revolve(make.sphere(1)), "profile"),
        (lambda: make.revolve("profile.json"), "profile"),
        (lambda: make.ellipse(3), "radii"),
    ],
)
def test_refusals_name_the_argument(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_conics_pass_where_they_should():
    t = np.linspace(0, 1, 50)
    circle = make.conic(ends=[(1, 0, 0), (-1, 0, 0)], tangents=[(0, 1, 0), (0, -1, 0)], point=(0, 1, 0))
    assert np.allclose(np.linalg.norm(circle(t), axis=-1), 1, atol=10 * ROUNDING)
    parabola = make.conic(ends=[(0, 0, 0), (2, 0, 0)], tangents=[(1, 1, 0), (1, -1, 0)], rho=0.5)
    assert parabola.classify()[0] == "parabola"
    points = [(2 * np.cos(a), np.sin(a), 5) for a in (0.1, 0.5, 1.2, 1.9, 2.6)]
    x, y, _ = make.conic(points)(t).T
    assert np.allclose((x / 2) ** 2 + y**2, 1, atol=1e-9)
    with pytest.raises(ValueError, match="lie on one line"):
        make.conic([(0, 0, 0), (1, 1, 0), (2, 2, 0), (3, 1, 0), (4, 5, 0)])
    with pytest.raises(ValueError, match="points or ends"):
        make.conic()


def test_blends_fills_and_chains():
    low, high = make.plane((2, 2)), make.plane((2, 2), center=(5, 0, 1))
    blend = make.blend(low, high, continuity=2, from_edge="u1", to_edge="u0")
    assert np.allclose(blend(0.0, GRID[1].ravel()), low(1.0, GRID[1].ravel()), atol=10 * ROUNDING)
    with pytest.raises(ValueError, match="from_edge"):
        make.blend(low, high, from_edge="u2")
    corners = [(0, 0, 0), (3, 0, 0.5), (1, 2, 0)]
    sides = [make.line(corners[k], corners[(k + 1) % 3]) for k in range(3)]
    patches, quality = make.fill(sides)
    assert len(patches) == 3 and quality["reached"] and quality["outer_angle"] == 0
    outline = make.chain([sides[0], sides[2], sides[1]])
    assert outline.degree == 3 and outline.length == pytest.approx(sum(one.length for one in sides), rel=1e-9)
    with pytest.raises(ValueError, match="from an end of the chain"):
        make.chain([sides[0], make.line((9, 9, 9), (10, 9, 9))])
