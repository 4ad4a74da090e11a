# SPDX-License-Identifier: MIT
"""Clouds and shapes with known truth. ROUNDING, ITERATED and HALF_DIGITS are those of tests/support/tolerances.h."""
import os

os.environ.setdefault("MPLBACKEND", "Agg")

import numpy as np
import pytest

import batten

ROUNDING = 1e-12  # a closed formula
ITERATED = 1e-9  # the end of an iteration
HALF_DIGITS = 1e-6  # differences in place of derivatives

SANITIZED = "BATTEN_SANITIZED" in os.environ  # then seconds mean nothing

ROOT = os.environ.get("BATTEN_SOURCE_DIR", os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))


@pytest.fixture
def rng(request):
    seed = 20240607
    print(f"seed {seed}")
    return np.random.default_rng(seed)


def heights(x, y):
    """A smooth graph over the unit square."""
    return 0.1 * np.sin(3 * x) * np.cos(2 * y) + 0.05 * x * y


def sheet(count, noise=0.0, seed=1, dtype=np.float64):
    """Points of that graph, in rows that nobody ordered."""
    rng = np.random.default_rng(seed)
    xy = rng.random((count, 2))
    z = heights(*xy.T) + noise * rng.normal(size=count)
    return np.column_stack([xy, z]).astype(dtype)


def helix(count, noise=0.0, seed=1):
    t = np.linspace(0, 2 * np.pi, count)
    points = np.column_stack([np.cos(t), np.sin(t), 0.3 * t])
    return points + noise * np.random.default_rng(seed).normal(size=points.shape)


def random_surface(rng, degree=(3, 2), size=(7, 6), rational=True):
    knots = []
    for p, n in zip(degree, size):
        inner = np.sort(rng.random(n - p - 1))
        knots.append(np.concatenate([np.zeros(p + 1), inner, np.ones(p + 1)]))
    points = rng.normal(size=size + (3,))
    weights = rng.uniform(0.5, 2, size=size) if rational else None
    return batten.Surface(degree, knots[0], knots[1], points, weights)


def random_curve(rng, degree=3, size=8, dimension=3, rational=True):
    inner = np.sort(rng.random(size - degree - 1))
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    weights = rng.uniform(0.5, 2, size=size) if rational else None
    return batten.Curve(degree, knots, rng.normal(size=(size, dimension)), weights)


def same_points(a, b, tolerance=ROUNDING * 100, samples=17):
    """Two surfaces or curves with the same domain at the same parameters."""
    if isinstance(a, batten.Surface):
        (u0, u1), (v0, v1) = a.domain
        assert np.allclose(np.ravel(a.domain), np.ravel(b.domain), rtol=0, atol=ROUNDING * 10)
        at = np.linspace(u0, u1, samples)[:, None], np.linspace(v0, v1, samples)[None, :]
    else:
        assert np.allclose(a.domain, b.domain, rtol=0, atol=ROUNDING * 10)
        at = (np.linspace(*a.domain, samples),)
    size = max(1.0, np.abs(a.control_points).max())
    return np.abs(a(*at) - b(*at)).max() <= tolerance * size


@pytest.fixture(scope="session")
def sheet_fit():
    return batten.fit_surface(sheet(2000, 1e-3))


@pytest.fixture(scope="session")
def curve_fit():
    return batten.fit_curve(helix(400, 1e-3))
