# SPDX-License-Identifier: MIT
"""To and from scipy, geomdl, trimesh, PyVista."""
import sys
import types

import numpy as np
import pytest
import scipy.interpolate
from scipy.interpolate import RectBivariateSpline, SmoothBivariateSpline

import batten
from conftest import ROUNDING, heights, random_curve, random_surface


def test_bivariate_splines_become_surfaces(rng):
    x, y = np.linspace(0, 1, 12), np.linspace(0, 2, 15)
    spline = RectBivariateSpline(x, y, heights(x[:, None], y[None, :]), kx=3, ky=4)
    s = batten.Surface.from_scipy(spline)
    u, v = rng.random(40), 2 * rng.random(40)
    p = s(u, v)
    assert np.allclose(p[:, 0], u, atol=10 * ROUNDING) and np.allclose(p[:, 1], v, atol=10 * ROUNDING)
    assert np.allclose(p[:, 2], spline(u, v, grid=False), atol=100 * ROUNDING) and s.degree == (3, 4)
    q = rng.random((400, 2))
    smooth = SmoothBivariateSpline(*q.T, heights(*q.T), s=1e-4)
    s = batten.Surface.from_scipy(smooth)
    (u0, u1), (v0, v1) = s.domain
    u, v = rng.uniform(u0, u1, 40), rng.uniform(v0, v1, 40)
    assert np.allclose(s(u, v)[:, 2], smooth(u, v, grid=False), atol=100 * ROUNDING)


def test_nd_splines_where_scipy_has_them(rng):
    s = random_surface(rng, rational=False)
    if not hasattr(scipy.interpolate, "NdBSpline"):
        with pytest.raises(ImportError, match="1.12"):
            s.to_scipy()
        nd = types.SimpleNamespace(t=(s.knots_u, s.knots_v), c=s.control_points, k=s.degree)
    else:
        nd = s.to_scipy()
        q = rng.random((20, 2))
        assert np.allclose(nd(q), s(*q.T), atol=100 * ROUNDING)
    assert batten.Surface.from_scipy(nd) == s


@pytest.mark.parametrize("rational", [False, True])
def test_geomdl_dictionaries(rng, rational):
    s, c = random_surface(rng, rational=rational), random_curve(rng, dimension=2, rational=rational)
    assert batten.Surface.from_geomdl(s.to_geomdl()) == s and batten.Curve.from_geomdl(c.to_geomdl()) == c
    entry = s.to_geomdl()["shape"]["data"][0]
    assert entry["size_u"] == 7 and entry["degree_v"] == 2 and batten.Surface.from_geomdl(entry) == s
    entry["control_points"]["points"] = s.control_points.reshape(-1, 3)  # arrays are numbers, too
    assert batten.Surface.from_geomdl(entry) == s
    several = batten.to_geomdl([s, s.swap()])
    assert several["shape"]["count"] == 2 and batten.from_geomdl(several) == [s, s.swap()]
    with pytest.raises(ValueError, match="curve"):
        batten.Surface.from_geomdl(c.to_geomdl())
    with pytest.raises(batten.ReadError, match="dimension"):
        batten.Curve.from_geomdl({"type": "spline", "degree": 3})
    with pytest.raises(ValueError, match="entry"):
        batten.from_geomdl(7)


def test_geomdl_objects(rng):
    s, c = random_surface(rng), random_curve(rng)
    surface = types.SimpleNamespace(
        degree_u=3, degree_v=2, knotvector_u=s.knots_u.tolist(), knotvector_v=s.knots_v.tolist(),
        ctrlpts_size_u=7, ctrlpts_size_v=6, ctrlpts=s.control_points.reshape(-1, 3).tolist(), weights=s.weights.ravel().tolist(),
    )
    curve = types.SimpleNamespace(degree=3, knotvector=c.knots.tolist(), ctrlpts=c.control_points.tolist(), weights=c.weights.tolist())
    assert batten.Surface.from_geomdl(surface) == s and batten.Curve.from_geomdl(curve) == c


def test_trimesh_and_pyvista_get_what_they_take(monkeypatch):
    """With stand-ins that keep what they were called with: neither is a package of Debian 12."""
    calls = {}
    trimesh = types.ModuleType("trimesh")
    trimesh.Trimesh = lambda vertices, faces, **more: calls.update(vertices=vertices, faces=faces, **more) or "trimesh"
    pyvista = types.ModuleType("pyvista")

    class PolyData:
        def __init__(self, points, faces):
            self.points, self.faces, self.point_data = points, faces, {}

    pyvista.PolyData = PolyData
    monkeypatch.setitem(sys.modules, "trimesh", trimesh)
    monkeypatch.setitem(sys.modules, "pyvista", pyvista)
    s = batten.make.sphere(1)
    mesh = s.tessellate(0.1)
    assert s.to_trimesh(0.1) == "trimesh" and np.array_equal(calls["faces"], mesh.faces)
    poly = s.to_pyvista(0.1)
    assert np.array_equal(poly.faces.reshape(-1, 4)[:, 1:], mesh.faces) and (poly.faces[::4] == 3).all()
    assert np.array_equal(poly.point_data["Normals"], mesh.normals)


@pytest.mark.parametrize("wrong", [3, "tck", ([0, 1], [1]), types.SimpleNamespace(t=[0, 0, 1, 1], c=[1.0, 2], k=1)])
def test_what_is_no_spline(wrong):
    with pytest.raises(ValueError, match="spline"):
        batten.Curve.from_scipy(wrong)
    if not isinstance(wrong, types.SimpleNamespace):
        with pytest.raises(ValueError, match="spline"):
            batten.Surface.from_scipy(wrong)
