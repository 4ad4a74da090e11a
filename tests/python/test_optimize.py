# SPDX-License-Identifier: MIT
"""Terms written in Python, in a fit and in the joint optimization alone."""
import gc
import weakref

import numpy as np
import pytest

import batten
from conftest import helix, random_curve, sheet


class Pin(batten.ResidualTerm):
    """A control point at a place."""

    residuals = 3

    def __init__(self, point, place, weight=1000.0):
        self.control_points = [point]
        self.place, self.weight, self.calls = np.asarray(place), weight, 0

    def evaluate(self, values):
        self.calls += 1
        assert values.shape == (3,)
        return self.weight * (values - self.place), self.weight * np.eye(3)


def test_a_term_of_ones_own_moves_a_corner():
    pins = []

    def terms(start):
        assert isinstance(start, batten.Surface)
        pins.append(Pin(0, start.control_points[0, 0] + [0, 0, 0.2]))
        return pins[-1:]

    free = batten.fit_surface(sheet(900, 1e-3), trim="none")
    fit = batten.fit_surface(sheet(900, 1e-3), trim="none", terms=terms)
    assert len(pins) == 1 and pins[0].calls > 1 and fit.report["optimize"]["ran"]
    assert np.allclose(fit.surface.control_points[0, 0], pins[0].place, atol=1e-3)
    assert np.linalg.norm(free.surface.control_points[0, 0] - pins[0].place) > 0.1


def test_a_term_in_a_curve_fit():
    seen = []

    def terms(start):
        seen.append(start)
        return [Pin(0, np.array(start.control_points[0]) + [0, 0, 0.1])]

    fit = batten.fit_curve(helix(300, 1e-3), terms=terms)
    assert isinstance(seen[0], batten.Curve) and np.allclose(fit.curve.control_points[0], seen[0].control_points[0] + [0, 0, 0.1], atol=5e-3)


class Broken(Pin):
    def __init__(self, how):
        super().__init__(0, [0, 0, 0])
        self.how = how

    def evaluate(self, values):
        if self.how == "raises":
            raise KeyError("broken")
        if self.how == "wrong size":
            return np.zeros(2), np.zeros((2, 3))
        if self.how == "wrong jacobian":
            return np.zeros(3), np.zeros(4)
        if self.how == "words":
            return "abc", "def"
        if self.how == "one":
            return np.zeros(3)
        return None


@pytest.mark.parametrize(
    "how, error",
    [("raises", KeyError), ("wrong size", ValueError), ("wrong jacobian", ValueError), ("words", ValueError), ("one", (ValueError, RuntimeError))],
)
def test_what_a_term_raises_comes_out(how, error):
    with pytest.raises(error):
        batten.fit_surface(sheet(300), trim="none", terms=lambda start: [Broken(how)])


def test_a_term_that_cannot_be_evaluated_changes_nothing():
    fit = batten.fit_surface(sheet(300), trim="none", terms=lambda start: [Broken("nothing")])
    assert fit.rms < 1e-2


@pytest.mark.parametrize("terms", [lambda start: [3], lambda start: 3, lambda start: [Pin(10**6, [0, 0, 0])], lambda start: 1 / 0])
def test_wrong_terms(terms):
    with pytest.raises((ValueError, ZeroDivisionError)):
        batten.fit_surface(sheet(300), trim="none", terms=terms)


def test_terms_are_let_go():
    pin = Pin(0, [0, 0, 0])
    watch = weakref.ref(pin)
    batten.fit_surface(sheet(300), trim="none", terms=lambda start, pins=[pin]: pins)
    del pin
    gc.collect()
    assert watch() is None


def test_optimization_is_never_worse(rng):
    c = random_curve(rng, rational=False)
    t = np.sort(rng.random(300))
    points = c(t)
    start = batten.Curve(3, c.knots, c.control_points + 0.05 * rng.normal(size=c.control_points.shape))
    done = batten.optimize(start, points, t)
    assert done.ran and done.rms_after <= done.rms_before and done.rms_after < 1e-6 and done.iterations > 0
    assert done.shape.closest(points).distances.max() < 1e-5 and done.parameters.shape == (300,)


def test_free_weights_find_a_circle():
    arc = batten.make.arc(1.0, sweep=1.5)
    t = np.linspace(0, 1, 100)
    start = batten.Curve(2, arc.knots, arc.control_points)
    done = batten.optimize(start, arc(t), t, free=["parameters", "weights"], fairness=0)
    assert done.shape.rational and done.rms_after < 1e-3 * done.rms_before


def test_pinned_and_fixed_points(rng):
    s = batten.make.plane((2, 2)).elevate("u", 2).elevate("v", 2)
    u, v = rng.random((2, 400))
    points = s(u, v) + 0.01 * rng.normal(size=(400, 3))
    pin = Pin(5, [0.2, 0.1, 0.3])
    done = batten.optimize(s, points, np.column_stack([u, v]), terms=[pin], fixed_control_points=[0], stop_at_noise=False)
    assert np.allclose(done.shape.control_points.reshape(-1, 3)[5], pin.place, atol=1e-2)
    assert np.array_equal(done.shape.control_points[0, 0], s.control_points[0, 0])


@pytest.mark.parametrize(
    "keywords, name",
    [
        ({"free": "all"}, "free"),
        ({"max_iterations": 0}, "max_iterations"),
        ({"loss": "best"}, "loss"),
        ({"loss_scale": -1}, "loss_scale"),
        ({"fairness": -1}, "fairness|smoothing"),
        ({"terms": [1]}, "terms"),
        ({"weights": [1, 2]}, "weights|sizes"),
        ({"fixed_control_points": [99]}, "fixed_control_points"),
        ({"progress": 1}, "progress"),
    ],
)
def test_wrong_keywords_are_named(rng, keywords, name):
    c, t = random_curve(rng, rational=False), np.linspace(0, 1, 40)
    with pytest.raises(ValueError, match=name):
        batten.optimize(c, c(t) + 0.1 * rng.normal(size=(40, 3)), t, **keywords)
