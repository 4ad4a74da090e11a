# SPDX-License-Identifier: MIT
"""Pictures with matplotlib, imported when they are asked for."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._curve import Curve
from ._geometry import wrap_all
from ._surface import Surface

if TYPE_CHECKING:
    from ._results import Fit

MOST_POINTS = 20000
SAMPLES = 400  # of a curve
LINES = 40  # of a surface, in a direction


def _axes(ax: Any, flat: bool) -> Any:
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    figure = plt.figure()
    return figure.add_subplot() if flat else figure.add_subplot(projection="3d")


def _inner(knots: Any, domain: Any) -> Any:
    distinct = np.unique(knots)
    return distinct[(distinct > domain[0]) & (distinct < domain[1])]


def _draw_surface(ax: Any, surface: Surface, knots: bool) -> None:
    (u0, u1), (v0, v1) = surface.domain
    u, v = np.linspace(u0, u1, LINES), np.linspace(v0, v1, LINES)
    if surface.trimmed:
        mesh = surface.tessellate()
        ax.plot_trisurf(*mesh.vertices.T, triangles=mesh.faces, color="lightsteelblue", alpha=0.5, linewidth=0)
    else:
        x, y, z = np.moveaxis(surface(u[:, None], v[None, :]), -1, 0)
        ax.plot_surface(x, y, z, color="lightsteelblue", alpha=0.5, linewidth=0)
    if not knots:
        return
    for direction, values, along in (("u", surface.knots_u, v), ("v", surface.knots_v, u)):
        for at in _inner(values, surface.domain["uv".index(direction)]):
            a, b = (np.full_like(along, at), along) if direction == "u" else (along, np.full_like(along, at))
            line = surface(a, b)
            line = np.where(surface.contains(a, b)[:, None], line, np.nan)
            ax.plot(*line.T, color="slategray", linewidth=0.4)


def _draw_curve(ax: Any, curve: Curve, knots: bool) -> None:
    line = curve(np.linspace(*curve.domain, SAMPLES))
    ax.plot(*line.T, color="steelblue")
    if knots:
        ax.plot(*curve(_inner(curve.knots, curve.domain)).T, "o", markersize=3, color="slategray")


def plot_fit(fit: "Fit", ax: Any, colours: bool, knots: bool, points: bool) -> Any:
    shapes = wrap_all(fit._fit.bodies)
    flat = all(shape.dimension == 2 for shape in shapes) and fit.points.dimension == 2
    ax = _axes(ax, flat)
    for shape in shapes:
        if isinstance(shape, Surface):
            _draw_surface(ax, shape, knots)
        elif isinstance(shape, Curve):
            _draw_curve(ax, shape, knots)
    if points:
        step = -(-len(fit.points) // MOST_POINTS)
        places = (fit.points.points - np.asarray(fit.shift)[: fit.points.dimension])[::step]
        used, limit = ~fit.outliers[::step], fit._fit.limit
        kept = places[used]
        if colours:
            shade = {} if flat else {"depthshade": False}
            distances = fit.residuals[::step][used]
            drawn = ax.scatter(*kept.T, c=distances, s=2, cmap="coolwarm", vmin=-limit, vmax=limit, **shade)
            ax.figure.colorbar(drawn, ax=ax, label=f"distance [{fit._fit.unit}]", shrink=0.7)
        else:
            ax.scatter(*kept.T, s=2, color="black")
        if not used.all():
            ax.scatter(*places[~used].T, s=6, marker="x", color="black", label="outliers")
            ax.legend()
    ax.set_xlabel("x")
    ax.set_ylabel("y")
    if flat:
        ax.set_aspect("equal", adjustable="datalim")
    else:
        ax.set_zlabel("z")
        low, high = fit.points.points.min(axis=0), fit.points.points.max(axis=0)
        span = np.maximum(high - low, 1e-3 * (high - low).max() or 1)
        if len(span) == 3:
            ax.set_box_aspect(span)
    return ax


def plot_residuals(fit: "Fit", ax: Any, bins: int) -> Any:
    ax = _axes(ax, True)
    ax.hist(fit.residuals[~fit.outliers], bins=bins, color="steelblue")
    tolerance = fit.report["error"]["tolerance"]
    if tolerance is not None:
        for at in (-tolerance, tolerance):
            ax.axvline(at, color="firebrick", linestyle="--")
    ax.set_xlabel(f"distance [{fit._fit.unit}]")
    ax.set_ylabel("points")
    ax.set_title(f"rms {fit.rms:.3g}")
    return ax
