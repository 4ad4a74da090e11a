// SPDX-License-Identifier: MIT
// Curves and surfaces as a STEP file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten {

// Writes AP214, or AP242 where that is asked for, through OpenCASCADE: a surface as a B-rep face, a
// curve as an edge (a plane curve at z = 0), each a product of its own, in order. What is built
// exactly as make_curve.h and make_surface.h build it (ExactShapeOf) becomes an analytic line,
// circle, plane, cylinder, cone, sphere or torus, where readers keep that; all else a B-spline with
// its own knots and control points, clamped and closed where it is periodic. A trimmed surface is a
// face with a wire for every loop: edges run from corner to corner, those along a seam bound it on
// both sides. The numbers in the file are the data's, declared to be in `unit`. The same geometry
// gives the same bytes: the time stamp is SOURCE_DATE_EPOCH or 1970. Throws UsageError for an
// unknown unit, WriteError when the file can't be written or no valid B-rep can be built,
// std::invalid_argument without geometry. The path "-" is standard output.
void WriteStep(const std::vector<Geometry>& geometry,
               const std::string& path,
               const std::string& unit = "mm");

// The same with names, of the product and of its face or curve; products without one are
// "batten-1", "batten-2", …. Surfaces are sewn where options.sew says so: those of one body, and
// those of none, each set by itself; what shares edges then is one shell, and a solid where the
// shell is closed, with voids where closed shells of one body lie in another. What sewing came to
// is returned; nothing where nothing was to be sewn. Throws UsageError for an unknown schema as
// well, std::invalid_argument for bodies that name surfaces there are not or share one.
std::optional<SewingReport> WriteStep(const GeometryFile& file,
                                      const GeometryWriteOptions& options);

}  // namespace batten
