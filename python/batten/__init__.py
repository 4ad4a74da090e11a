# SPDX-License-Identifier: MIT
"""NURBS from measured points.

>>> fit = batten.fit_surface(points, tolerance=0.05)
>>> fit.surface(0.5, 0.5), fit.ok, fit.report["error"]["rms"]
>>> fit.to_step("part.step")

Points are arrays of shape (N, 3) or anything numpy makes one of, or the path of a file. Lengths are in the data's
units, angles in radians. Curves, surfaces and clouds are values: nothing changes them.
"""
from . import make
from ._cloud import Cloud, Statistics
from ._core import version as __version__
from ._curve import Curve
from ._errors import Cancelled, DoubtWarning, FitRefused, ReadError, ReadWarning, WriteError
from ._files import Sewing, Shapes, read_cloud, read_geometry, write_cloud, write_geometry, write_mesh
from ._fits import (
    cloud_parts,
    compare,
    fit_curve,
    fit_curves,
    fit_grid,
    fit_parts,
    fit_primitive,
    fit_solid,
    fit_surface,
    interpolate_curve,
)
from ._friends import from_geomdl, to_geomdl
from ._geometry import Closest, Geometry, Knot, Removal
from ._meets import Branch, Intersection, Meeting, Offset, Overlap, intersect, offset
from ._optimize import Optimized, ResidualTerm, optimize
from ._results import Comparison, CurveFit, Fit, PrimitiveFit, Solid, SolidFit, SurfaceFit, Uncertainty
from ._surface import Curvature, Mesh, Surface

__all__ = [
    "Branch",
    "Cancelled",
    "Closest",
    "Cloud",
    "Comparison",
    "Curvature",
    "Curve",
    "CurveFit",
    "DoubtWarning",
    "Fit",
    "FitRefused",
    "Geometry",
    "Intersection",
    "Knot",
    "Meeting",
    "Mesh",
    "Offset",
    "Optimized",
    "Overlap",
    "PrimitiveFit",
    "ReadError",
    "ReadWarning",
    "Removal",
    "ResidualTerm",
    "Sewing",
    "Shapes",
    "Solid",
    "SolidFit",
    "Statistics",
    "Surface",
    "SurfaceFit",
    "Uncertainty",
    "WriteError",
    "cloud_parts",
    "compare",
    "fit_curve",
    "fit_curves",
    "fit_grid",
    "fit_parts",
    "fit_primitive",
    "fit_solid",
    "fit_surface",
    "from_geomdl",
    "interpolate_curve",
    "intersect",
    "make",
    "offset",
    "optimize",
    "read_cloud",
    "read_geometry",
    "to_geomdl",
    "write_cloud",
    "write_geometry",
    "write_mesh",
]
