# SPDX-License-Identifier: MIT
"""The joint optimization, with terms of one's own."""
from __future__ import annotations

from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Union

from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, finite
from ._geometry import Geometry, _body_of, wrap
from ._progress import callback


class ResidualTerm:
    """A least-squares term ½ |r|² beside the distances of the points. Derive from it, say what it looks at, and give
    residuals and their derivatives.

    A residual of the data's unit counts as much as the distance of one point of weight 1.

    Attributes
    ----------
    residuals : int
        How many there are.
    control_points : sequence of int
        Indices, v fastest: point (i, j) of n × m is i m + j. No index twice.
    weights : sequence of int
        Indices of weights.
    needs_knots : bool
        Whether all knots of u and v are wanted, too.
    """

    residuals: int = 0
    control_points: Sequence[int] = ()
    weights: Sequence[int] = ()
    needs_knots: bool = False

    def evaluate(self, values: Floats) -> Optional[Tuple[ArrayLike, ArrayLike]]:
        """Residuals and Jacobian; called from several threads, one at a time.

        Parameters
        ----------
        values : ndarray of shape (k,)
            The coordinates of the control points one after the other, then weights, then knots.

        Returns
        -------
        residual : array_like of shape (residuals,)
        jacobian : array_like of shape (residuals, k)
            Its derivatives. None in place of both where the term can't be evaluated: the step is refused.
        """
        raise NotImplementedError(f"{type(self).__name__} has no evaluate")


class Optimized(NamedTuple):
    """What the joint optimization gives.

    Attributes
    ----------
    shape : Curve or Surface
        Never worse than the one given.
    parameters : ndarray of shape (N, 2), curves (N,)
        Foot points where they were free.
    ran : bool
        Whether anything was tried.
    note : str
        Why nothing was tried, or what ended it.
    iterations : int
        Of all stages.
    rms_before, rms_after : float
        Of the distances that were minimised, in the data's units.
    """

    shape: Any
    parameters: Floats
    ran: bool
    note: str
    iterations: int
    rms_before: float
    rms_after: float


def checked_terms(terms: Any) -> List[ResidualTerm]:
    try:
        given = list(terms)
    except TypeError:
        raise ValueError("terms: a list of ResidualTerm is needed") from None
    for term in given:
        if not isinstance(term, ResidualTerm):
            raise ValueError(f"terms: {type(term).__name__} is no ResidualTerm")
    return given


def optimize(
    shape: Geometry,
    points: ArrayLike,
    parameters: ArrayLike,
    *,
    weights: Optional[ArrayLike] = None,
    free: Union[str, Iterable[str]] = "parameters",
    terms: Iterable[ResidualTerm] = (),
    knots_u: bool = True,
    knots_v: bool = True,
    max_iterations: int = 40,
    noise: float = 0,
    stop_at_noise: bool = True,
    least_gain: float = 1e-5,
    loss: Optional[str] = None,
    loss_scale: float = 1,
    fairness: float = 1e-6,
    fixed_control_points: Sequence[int] = (),
    seconds: float = 0,
    seed: int = 1,
    threads: int = 0,
    progress: Any = None,
) -> Optimized:
    """Minimises the sum of squared distances of points from a shape over control points and whatever else is free.

    Parameters
    ----------
    shape : Curve or Surface
        Where it starts.
    points : array_like of shape (N, 3), plane curves (N, 2)
        In the data's units.
    parameters : array_like of shape (N, 2), curves (N,)
        Of the points, in the domain.
    weights : array_like of shape (N,), optional
        Of the points, not negative.
    free : str or iterable of {'parameters', 'weights', 'knots'}
        Besides the control points. With free parameters distances are orthogonal.
    terms : iterable of ResidualTerm
        Terms of your own.
    knots_u, knots_v : bool
        Directions that free knots move in.
    max_iterations : int
        Of each stage.
    noise : float
        Standard deviation of the data where it is known, in the data's units.
    stop_at_noise : bool
        Do not go on when the residuals are at the noise.
    least_gain : float
        A stage ends when a step gains less than this share.
    loss : {'none', 'huber', 'cauchy', 'tukey', 'truncated'}, optional
        On each point's distance.
    loss_scale : float
        Standard deviation of good points, in the data's units.
    fairness : float
        Thin plate relative to the data.
    fixed_control_points : sequence of int
        Indices, v fastest.
    seconds : float
        Stop after so long; 0: never.
    seed : int
        Of random starts for knots.
    threads : int
        0: all cores.
    progress : callable or bool, optional
        ``progress(stage, fraction)``, or True for a bar.

    Returns
    -------
    Optimized
        shape, parameters, and how it went.

    Raises
    ------
    ValueError
        Naming the keyword.
    """
    surface = _body_of("shape", shape).is_surface
    options: Dict[str, Any] = {
        "free": free,
        "knots_u": knots_u,
        "knots_v": knots_v,
        "max_iterations": max_iterations,
        "noise": noise,
        "stop_at_noise": stop_at_noise,
        "least_gain": least_gain,
        "loss": loss,
        "loss_scale": loss_scale,
        "fairness": fairness,
        "fixed_control_points": list(fixed_control_points),
        "seconds": seconds,
        "seed": seed,
        "threads": threads,
    }
    with callback(progress) as tell:
        body, places, report = _core.optimize(
            shape._body,
            finite("points", points, None, shape.dimension),
            finite("parameters", parameters, *((None, 2) if surface else (None,))),
            None if weights is None else finite("weights", weights, None),
            options,
            checked_terms(terms),
            tell,
        )
    report.pop("cancelled")
    return Optimized(wrap(body), places, **report)
