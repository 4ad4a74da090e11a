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


def test_surfaces_made_of_curves_contain_them():
    u = np.linspace(0, 1, 21)
    circles = [make.circle(1 + 0.3 * k, center=(0, 0, 2 * k)) for k in range(4)]
    loft = make.loft(circles)
    assert np.allclose(loft(u, 0), circles[0](u), atol=10 * ROUNDING)
    assert np.allclose(loft(u, 1), circles[3](u), atol=10 * ROUNDING)
    leaving = make.loft(circles, start_tangent=(0, 0, 1)).derivatives(0.3, 0, 1)
    assert leaving is not None
    turned = [circles[0], make.circle(1.3, center=(0, 0, 2), x=(0, 1, 0))]
    assert np.allclose(make.loft(turned, align=True)(0, 1), [1.3, 0, 2], atol=1e-6)
    assert np.allclose(make.extrude(circles[0], (0, 0, 5))(u, 1), circles[0](u) + [0, 0, 5])
    assert np.allclose(make.ruled(circles[0], circles[1])(u, 0.5), (circles[0](u) + circles[1](u)) / 2)
    path = make.arc(10, axis=(0, -1, 0), x=(-1, 0, 0), sweep=1.5)
    section = make.circle(1, center=path(0), axis=(0, 0, 1))
    pipe = make.sweep(section, path, tolerance=1e-6)
    assert np.allclose(np.linalg.norm(pipe(0.3, u) - path(u), axis=-1), 1, atol=1e-6)
    assert np.allclose(make.sweep(section, path, translational=True)(u, 1), section(u) + path(1) - path(0))
    bottle = make.swing(make.line([1, 0, 0], [2, 0, 3]), make.ellipse((1, 0.5)))
    assert np.allclose(bottle(0.25, u)[:, 1], 0.5 * (1 + u))
    lines = [make.line([0, y, 0], [4, y, y]) for y in (0, 1, 3)], [make.line([x, 0, 0], [x, 3, 3 * x / 4]) for x in (0, 4)]
    assert np.allclose(make.gordon(*lines)(0.5, u)[:, 2], make.gordon(*lines)(0.5, u)[:, 1] / 2)
    sides = [make.arc(1), make.arc(1, axis=(1, 0, 0), x=(0, 1, 0)), make.arc(1, axis=(0, 1, 0), x=(0, 0, 1))]
    for bicubic in (False, True):
        assert np.allclose(np.linalg.norm(make.coons(sides, bicubic=bicubic)(u, 0), axis=-1), 1, atol=1e-4)
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 4.0]])
    assert np.allclose(make.patch(corners)(0.5, 0.5), [0.5, 0.5, 1])


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
        (lambda: make.extrude(make.circle(1), (0, 0)), "by"),
        (lambda: make.loft([make.circle(1), make.line([0, 0, 1], [1, 0, 1])]), "section 1 is closed and section 2 is open"),
        (lambda: make.loft(make.circle(1)), "sections: a list"),
        (lambda: make.loft([make.circle(1), make.sphere(1)]), r"sections\[1\]"),
        (lambda: make.sweep(make.circle(1), make.arc(0.5, axis=(0, 1, 0))), "radius is 0.5"),
        (lambda: make.gordon([], []), "along_u"),
        (lambda: make.coons([make.arc(1), make.arc(2)]), "three or four"),
        (lambda: make.patch(np.zeros((3, 3))), "corners"),
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
