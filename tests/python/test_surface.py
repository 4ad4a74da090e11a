# SPDX-License-Identifier: MIT
"""Surfaces: evaluation against scipy and differences, closest points against brute force, operations that keep the
shape, values."""
import copy
import gc
import pickle

import numpy as np
import pytest
from scipy.interpolate import BSpline

import batten
from conftest import HALF_DIGITS, ITERATED, ROUNDING, random_surface, same_points

DEGREES = [(1, 1), (2, 3), (3, 3), (5, 2), (4, 7)]


def design(degree, knots, at):
    """The basis functions by scipy: one row for each parameter."""
    count = len(knots) - degree - 1
    knots = np.array(knots)  # scipy 1.10 takes no read-only arrays
    return np.column_stack([BSpline(knots, np.eye(count)[i], degree)(at) for i in range(count)])


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize("rational", [False, True])
def test_points_are_those_of_scipys_basis(rng, degree, rational):
    s = random_surface(rng, degree, (9, 10), rational)
    u, v = rng.random(50), rng.random(50)
    n, m = design(degree[0], s.knots_u, u), design(degree[1], s.knots_v, v)
    w = np.einsum("ki,kj,ij->k", n, m, s.weights)
    expected = np.einsum("ki,kj,ij,ijd->kd", n, m, s.weights, s.control_points) / w[:, None]
    assert np.abs(s(u, v) - expected).max() < 100 * ROUNDING


@pytest.mark.parametrize("degree", DEGREES)
def test_basis_is_a_partition_of_unity(rng, degree):
    s = random_surface(rng, degree, (9, 10))
    ones = batten.Surface(s.degree, s.knots_u, s.knots_v, np.ones((9, 10, 3)), s.weights)
    assert np.abs(ones(rng.random(100), rng.random(100)) - 1).max() < ROUNDING


@pytest.mark.parametrize("degree", DEGREES)
def test_derivatives_are_differences(rng, degree):
    s = random_surface(rng, degree, (9, 10))
    u, v = rng.uniform(0.1, 0.9, 40), rng.uniform(0.1, 0.9, 40)
    h = 1e-6
    far = (np.abs(s.knots_u[:, None] - u).min(axis=0) > 2 * h) & (np.abs(s.knots_v[:, None] - v).min(axis=0) > 2 * h)
    u, v = u[far], v[far]
    d = s.derivatives(u, v, 2)
    scale = np.abs(d[2, 0]).max() + np.abs(d[0, 2]).max() + np.abs(d[1, 0]).max() + 1
    assert np.abs(d[1, 0] - (s(u + h, v) - s(u - h, v)) / (2 * h)).max() < 1e3 * HALF_DIGITS * scale
    assert np.abs(d[0, 1] - (s(u, v + h) - s(u, v - h)) / (2 * h)).max() < 1e3 * HALF_DIGITS * scale
    mixed = (s.derivatives(u + h, v)[0, 1] - s.derivatives(u - h, v)[0, 1]) / (2 * h)
    assert np.abs(d[1, 1] - mixed).max() < 1e3 * HALF_DIGITS * scale


@pytest.mark.parametrize("order", [0, 1, 2, 3, 4])
def test_derivatives_have_their_shape(rng, order):
    s = random_surface(rng)
    d = s.derivatives(np.linspace(0, 1, 4)[:, None], np.linspace(0, 1, 3)[None, :], order)
    assert d.shape == (order + 1, order + 1, 4, 3, 3)
    k, l = np.indices((order + 1, order + 1))
    assert (np.isnan(d).all(axis=(2, 3, 4)) == (k + l > order)).all()
    assert np.allclose(d[0, 0], s(np.linspace(0, 1, 4)[:, None], np.linspace(0, 1, 3)[None, :]), atol=100 * ROUNDING)


def test_higher_orders_agree_with_lower_ones(rng):
    s, at = random_surface(rng, (3, 4)), (rng.random(30), rng.random(30))
    low, high = s.derivatives(*at, 2), s.derivatives(*at, 4)
    scale = np.nanmax(np.abs(low))
    kept = ~np.isnan(low)
    assert np.abs(low[kept] - high[:3, :3][kept]).max() < 1e3 * ROUNDING * scale


@pytest.mark.parametrize(
    "u, v, shape",
    [
        (0.5, 0.5, ()),
        ([0.1, 0.2], 0.3, (2,)),
        (np.zeros((4, 1)), np.zeros((1, 5)), (4, 5)),
        (np.zeros((2, 3, 4)), np.zeros(4), (2, 3, 4)),
        (np.zeros(0), np.zeros(0), (0,)),
        (np.float32([0.25]), np.int64([0]), (1,)),
        (np.arange(10)[::-2] / 10, 0.5, (5,)),
    ],
)
def test_parameters_broadcast(rng, u, v, shape):
    s = random_surface(rng)
    points = s(u, v)
    assert points.shape == shape + (3,) and points.dtype == np.float64
    a, b = np.broadcast_arrays(u, v)
    for k in np.ndindex(*shape):
        assert np.array_equal(points[k], s(float(a[k]), float(b[k])))


def test_many_parameters_are_as_few(rng):
    s = random_surface(rng)
    u, v = rng.random(30001), rng.random(30001)
    assert np.array_equal(s(u, v), s(u, v, threads=1))
    assert np.array_equal(s(u[:7], v[:7]), s(u, v)[:7])


def test_outside_the_domain_is_its_edge(rng):
    s = random_surface(rng)
    assert np.array_equal(s(-1.0, 0.5), s(0.0, 0.5)) and np.array_equal(s(7.0, 2.0), s(1.0, 1.0))


def test_normals_are_perpendicular_and_of_length_one(rng):
    s = random_surface(rng)
    u, v = rng.random(50), rng.random(50)
    d, n = s.derivatives(u, v), s.normal(u, v)
    assert np.abs(np.linalg.norm(n, axis=1) - 1).max() < 10 * ROUNDING
    assert np.abs(np.einsum("ki,ki->k", d[1, 0], n)).max() < 1e3 * ROUNDING * np.abs(d[1, 0]).max()


def test_curvature_of_a_sphere():
    s = batten.make.sphere(2.0)
    c = s.curvature(np.linspace(0.05, 0.95, 9), 0.3)
    assert np.allclose(c.gaussian, 0.25, atol=ITERATED) and np.allclose(np.abs(c.mean), 0.5, atol=ITERATED)
    assert np.allclose(c.low * c.high, c.gaussian, atol=ITERATED) and (c.low <= c.high).all()


def test_tip_of_a_cone_has_no_curvature():
    assert np.isnan(batten.make.cone(1, 2).curvature(0.2, 1.0).gaussian)


def test_closest_is_the_nearest_of_all(rng):
    s = random_surface(rng, rational=False)
    q = rng.normal(size=(60, 3))
    found = s.closest(q)
    dense = s(np.linspace(0, 1, 201)[:, None], np.linspace(0, 1, 201)[None, :]).reshape(-1, 3)
    brute = np.sqrt(((q[:, None] - dense[None]) ** 2).sum(-1)).min(1)
    assert (found.distances <= brute + ITERATED).all() and (brute - found.distances < 0.05).all()
    assert np.allclose(s(*found.parameters.T), found.points, atol=ITERATED)
    assert np.allclose(np.linalg.norm(q - found.points, axis=1), found.distances, atol=ITERATED)
    assert found.certified.all() and (found.lower_bounds <= found.distances + ITERATED).all()


def test_closest_of_one_point_is_a_row_less(rng):
    s = random_surface(rng)
    one = s.closest([0.0, 0, 0])
    assert one.parameters.shape == (2,) and np.ndim(one.distances) == 0
    assert one.distances == s.closest([[0.0, 0, 0]]).distances[0]


KEEPING = {
    "insert_knot": lambda s: s.insert_knot("u", 0.37),
    "insert_knot twice": lambda s: s.insert_knot("v", 0.61, 2),
    "refine": lambda s: s.refine("v", [0.2, 0.4, 0.4]),
    "elevate": lambda s: s.elevate("u", 2),
    "swap twice": lambda s: s.swap().swap(),
    "reverse twice": lambda s: s.reverse("u").reverse("u"),
    "unclamp and clamp": lambda s: s.unclamp("u").clamp("u"),
    "clamp": lambda s: s.clamp(),
    "segments joined": lambda s: s.segment("u", 0, 0.4).join(s.segment("u", 0.4, 1), "u", tolerance=1e-9),
    "knot in and out": lambda s: s.insert_knot("u", 0.43).remove_knot("u", 0.43, tolerance=1e-9).shape,
    "degree up and down": lambda s: s.elevate("v").reduce("v", tolerance=1e-9).shape,
    "there and back": lambda s: s.translate([1, 2, 3]).translate([-1, -2, -3]),
    "round and round": lambda s: s.rotate([1, 1, 0], 1.0).rotate([1, 1, 0], -1.0),
    "large and small": lambda s: s.scale(4.0).scale(0.25),
    "other domain": lambda s: s.reparameterize("u", 3, 5).reparameterize("u", 0, 1),
}


@pytest.mark.parametrize("change", KEEPING)
def test_the_shape_stays(rng, change):
    s = random_surface(rng)
    assert same_points(s, KEEPING[change](s), 1e4 * ROUNDING)


def test_moves_are_those_of_vectors(rng):
    s, k, c, angle = random_surface(rng), np.array([2, -1, 2]) / 3, np.array([1.0, 2, 3]), 0.7
    at = s(0.3, 0.6)
    d = at - c  # Rodrigues' formula
    turned = c + d * np.cos(angle) + np.cross(k, d) * np.sin(angle) + k * (k @ d) * (1 - np.cos(angle))
    assert np.allclose(s.rotate(5 * k, angle, center=c)(0.3, 0.6), turned, atol=100 * ROUNDING)
    assert np.allclose(s.scale([2, 3, -1], center=c)(0.3, 0.6), c + d * [2, 3, -1], atol=100 * ROUNDING)
    assert np.allclose(s.translate(c)(0.3, 0.6), at + c, atol=100 * ROUNDING)


def test_split_pieces_are_the_shape(rng):
    s = random_surface(rng)
    low, high = s.split("v", 0.3)
    assert low.domain[1] == (0, 0.3) and high.domain[1] == (0.3, 1)
    u = rng.random(20)
    assert np.allclose(low(u, 0.3), high(u, 0.3), atol=0)
    assert np.allclose(low(u, 0.2), s(u, 0.2), atol=100 * ROUNDING)


def test_decompose_gives_bezier_pieces(rng):
    s = random_surface(rng, (3, 2), (7, 6))
    pieces = s.decompose()
    assert len(pieces) == 4 * 4 and all(p.control_points.shape[:2] == (4, 3) for p in pieces)
    assert len(s.decompose("u")) == 4


def test_remove_knot_says_how_far_it_moves(rng):
    s = random_surface(rng, (3, 3), (8, 8), rational=False)
    at = float(s.knots_u[4])
    removal = s.remove_knot("u", at, tolerance=10)
    moved = np.abs(removal.shape(rng.random(400), rng.random(400)) - s(0, 0))  # finite
    assert removal.removed == 1 and removal.error > 0 and np.isfinite(moved).all()
    u, v = rng.random(2000), rng.random(2000)
    assert np.linalg.norm(removal.shape(u, v) - s(u, v), axis=1).max() <= removal.error * (1 + ITERATED)
    nothing = s.remove_knot("u", at, tolerance=0)
    assert nothing.removed == 0 and nothing.shape == s


def test_remove_knots_finds_inserted_ones(rng):
    s = batten.make.bilinear([0, 0, 0], [1, 0, 1], [0, 1, 2], [1, 1, 0]).elevate("u", 2).refine("u", [0.2, 0.5, 0.7])
    removal = s.remove_knots(1e-9)
    assert removal.removed == 3 and len(removal.shape.knots_u) == 8


def test_iso_curves_and_boundary(rng):
    s, t = random_surface(rng), rng.random(15)
    assert np.allclose(s.iso("u", 0.4)(t), s(0.4, t), atol=100 * ROUNDING)
    assert np.allclose(s.iso("v", 0.7)(t), s(t, 0.7), atol=100 * ROUNDING)
    edges = s.boundary()
    assert np.allclose(edges[1](t), s(1.0, t), atol=100 * ROUNDING) and np.allclose(edges[2](t), s(t, 0.0), atol=100 * ROUNDING)


def test_moved_point_is_met_and_weights_pull(rng):
    s = random_surface(rng)
    to = np.array([3.0, -1, 2])
    assert np.allclose(s.move_point(0.3, 0.6, to)(0.3, 0.6), to, atol=100 * ROUNDING)
    i, j = 3, 2
    u, v = s.greville[0][i], s.greville[1][j]
    pulled = s.set_weight(i, j, 50.0)
    assert np.linalg.norm(pulled(u, v) - s.control_points[i, j]) < np.linalg.norm(s(u, v) - s.control_points[i, j])


def test_changes_by_hand(rng):
    s = random_surface(rng)
    to = [[3, -1, 2], [1, 1, 1]]
    moved = s.move_points([[0.2, 0.3], [0.8, 0.7]], to, keep=[[0.5, 0.5]], fixed=[[0, 0]])
    assert np.allclose(moved([0.2, 0.8, 0.5], [0.3, 0.7, 0.5]), [*to, s(0.5, 0.5)], atol=1e4 * ROUNDING)
    i, j = 3, 2
    u, v = s.greville[0][i], s.greville[1][j]
    assert np.linalg.norm(s.pull(u, v, i, j, 0.01)(u, v) - s(u, v)) == pytest.approx(0.01, abs=1e4 * ROUNDING)
    warped = s.warp([0, 0, 1], u=(0.2, 0.6), v=(0.3, 0.9))
    assert np.allclose(warped(0.4, 0.6), s(0.4, 0.6) + [0, 0, 1], atol=1e4 * ROUNDING)
    flat = s.flatten([0, 0, 1], 2.0, u=(0.2, 0.6))
    assert np.allclose(flat(0.4, np.linspace(0, 1, 9))[:, 2], 2, atol=1e4 * ROUNDING)
    plate = batten.make.bilinear([5, 0, 0], [5, 6, 0], [5, 0, 1], [5, 6, 1]).elevate("u", 2)
    bent, error = plate.bend([5, 0, 0], [0, 0, 0], 6, tolerance=1e-5)
    assert error <= 1e-5 and len(bent.knots_v) == 4
    with pytest.raises(ValueError, match="u, v"):
        s.warp([0, 0, 1])


def test_extension_keeps_the_old_part(rng):
    s = random_surface(rng, rational=False)
    longer = s.extend("u", 0.5)
    assert longer.domain[0][1] > 1
    u, v = rng.random(30), rng.random(30)
    assert np.allclose(longer(u, v), s(u, v), atol=1e4 * ROUNDING)


def test_compose_follows_the_function(rng):
    s = random_surface(rng, (2, 2), (5, 5), rational=False)
    f = BSpline([0, 0, 0, 1, 1, 1], [0, 0.2, 1], 2)
    t = rng.random(20)
    assert np.allclose(s.compose("u", f)(t, 0.4), s(f(t), 0.4), atol=1e4 * ROUNDING)


def test_moebius_keeps_the_set(rng):
    s = random_surface(rng)
    m = s.moebius("u", 1.0, 0.0, -0.5, 1.5)
    t = np.linspace(0, 1, 9)
    assert np.allclose(m(t, 0.3), s(t / (1.5 - 0.5 * t), 0.3), atol=1e4 * ROUNDING)


def test_section_lies_in_the_plane_and_on_the_surface():
    s = batten.make.sphere(1.0)
    (circle,) = s.section([0, 0, 1, -0.5], tolerance=1e-8)
    points = circle(np.linspace(*circle.domain, 100))
    assert np.abs(points[:, 2] - 0.5).max() < 1e-7 and np.abs(np.linalg.norm(points, axis=1) - 1).max() < 1e-7
    assert circle.length == pytest.approx(2 * np.pi * np.sqrt(0.75), rel=1e-6)
    assert s.section([0, 0, 1, -5]) == []


def test_cut_parts_add_up():
    s = batten.make.torus(3, 1)
    above, below = s.cut([1, 0, 0.3, -0.4])
    assert sum(part.area for part in above + below) == pytest.approx(s.area, rel=1e-8)


def test_trim_keeps_the_inside():
    s = batten.make.plane((4, 4))
    hole = batten.make.circle(0.25, center=(0.5, 0.5))
    (disc,) = s.trim(hole)
    (rest,) = s.trim(hole, keep="outside")
    assert disc.area == pytest.approx(np.pi, rel=1e-9) and rest.area == pytest.approx(16 - np.pi, rel=1e-9)
    assert disc.contains(0.5, 0.5) and not rest.contains(0.5, 0.5) and len(s.trim(hole, keep="both")) == 2
    assert disc.trimmed and disc.with_trims([]) == s
    with pytest.raises(ValueError):
        s.with_trims([batten.make.circle(5.0, center=(0.5, 0.5))])


def test_projected_curve_lies_under_the_curve():
    s = batten.make.plane((4, 4))
    (flat,) = s.project(batten.make.line([-1, -1, 3], [1, 1, 5]), tolerance=1e-8)
    assert flat.dimension == 2
    assert np.allclose(s(*flat(np.linspace(0, 1, 5)).T)[:, :2], np.linspace(-1, 1, 5)[:, None], atol=1e-7)


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-3])
def test_triangles_keep_the_tolerance(tolerance):
    s = batten.make.sphere(1.0)
    mesh = s.tessellate(tolerance)
    middles = mesh.vertices[mesh.faces].mean(axis=1)
    assert (1 - np.linalg.norm(middles, axis=1)).max() <= tolerance
    assert np.abs(np.linalg.norm(mesh.vertices, axis=1) - 1).max() < ITERATED
    edges = np.sort(np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()  # watertight
    assert mesh.faces.dtype == np.int32 and mesh.parameters.shape == (len(mesh.vertices), 2)
    assert (np.einsum("ij,ij->i", mesh.vertices, mesh.normals) > 0.9).all()


def test_analysis_of_known_shapes():
    s = batten.make.cylinder(2, 5)
    a = s.analyze()
    assert a["closed"] == (True, False) and a["area"] == pytest.approx(20 * np.pi) and a["shape"][0] == "cylinder"
    assert a["shape"][1]["radius"] == pytest.approx(2)
    low, high = s.bounding_box
    assert np.allclose(low, [-2, -2, 0], atol=ITERATED) and np.allclose(high, [2, 2, 5], atol=ITERATED)
    assert s.seam_continuity("u") >= 1 and s.seam_continuity("v") is None
    assert batten.make.sphere(1).collapsed_edges == {"u lower": False, "u upper": False, "v lower": True, "v upper": True}
    assert s.area_between((0, 0.5), (0, 1)) == pytest.approx(10 * np.pi)


def test_joins_are_measured(rng):
    s = random_surface(rng, (3, 3), (8, 8), rational=False)
    low, high = s.split("u", 0.45)
    quality = low.join_quality(high)
    assert quality["G"] == 2 and quality["C"] == 2 and quality["position_gap"] < ITERATED
    apart = low.join_quality(high.translate([0, 0, 1]))
    assert apart["G"] == -1 and apart["position_gap"] > 0.5
    assert [k.at for k in s.continuity("u")] == pytest.approx(list(s.knots_u[4:-4]))


# --- values


def test_equal_values_have_equal_hashes(rng):
    s = random_surface(rng)
    t = batten.Surface(s.degree, s.knots_u, s.knots_v, s.control_points, s.weights)
    assert s == t and hash(s) == hash(t) and s is not t and len({s, t}) == 1
    other = s.set_weight(0, 0, 9.0)
    assert s != other and s != 3 and s != batten.make.line([0, 0, 0], [1, 0, 0]) and len({s, other}) == 2


def test_zero_of_either_sign_is_one_value():
    a = batten.make.bilinear([0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1])
    b = batten.make.bilinear([-0.0, 0, 0], [1, -0.0, 0], [0, 1, 0], [1, 1, 1])
    assert a == b and hash(a) == hash(b)


@pytest.mark.parametrize("rational", [False, True])
def test_pickle_and_copy_keep_every_bit(rng, rational):
    s = random_surface(rng, rational=rational)
    for t in (pickle.loads(pickle.dumps(s)), copy.copy(s), copy.deepcopy(s)):
        assert s == t and hash(s) == hash(t) and np.array_equal(s.control_points, t.control_points)


def test_pickle_keeps_trims_and_periods():
    disc = batten.make.plane((4, 4)).trim(batten.make.circle(0.25, center=(0.5, 0.5)))[0]
    assert pickle.loads(pickle.dumps(disc)) == disc
    x = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    z = np.linspace(0, 1, 30)
    tube = np.stack(np.broadcast_arrays(np.cos(x)[None], np.sin(x)[None], z[:, None]), axis=-1)
    s = batten.fit_grid(tube, closed="v", control_points=(5, 24)).surface
    assert s.periodic == (False, True) and pickle.loads(pickle.dumps(s)) == s


def test_nothing_changes_it(rng):
    s = random_surface(rng)
    for array in (s.control_points, s.weights, s.knots_u, s.knots_v):
        with pytest.raises(ValueError):
            array[...] = 0
    for name in ("degree", "control_points", "_body", "nickname"):
        with pytest.raises(AttributeError):
            setattr(s, name, 1)
    with pytest.raises(AttributeError):
        del s._body
    points = np.array(s.control_points)
    t = batten.Surface(s.degree, s.knots_u, s.knots_v, points, s.weights)
    points[:] = 0
    assert s == t


def test_arrays_share_the_surfaces_memory(rng):
    s = random_surface(rng)
    first, second = s.control_points, s.control_points
    assert first.__array_interface__["data"][0] == second.__array_interface__["data"][0] and first.base is not None
    kept, copy_of_it = s.control_points, np.array(s.control_points)
    del s, first, second
    gc.collect()
    assert np.array_equal(kept, copy_of_it)


def test_repr_is_one_line(rng):
    for shape in (random_surface(rng), batten.make.plane((1, 1)), batten.make.sphere(1)):
        assert "\n" not in repr(shape) and repr(shape).startswith("<Surface: degree")
