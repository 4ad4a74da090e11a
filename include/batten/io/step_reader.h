// SPDX-License-Identifier: MIT
// Curves and surfaces from a STEP file.
#pragma once

#include <string>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten {

// Every face and every edge outside faces, as NURBS in the file's own unit
// (the first it declares; parts in others are turned into it). What the file holds as
// non-periodic B-splines comes as it stands; lines, circles, planes, cylinders, cones, spheres and
// tori as batten makes them; other shapes are converted, periodic ones clamped. Faces that are not
// the whole of a B-spline surface or a rectangle of another's parameters are trimmed, a loop for
// every wire. Names are those of faces and curves, else of what they are part of, the product at
// last. The path "-" is standard input. Throws ReadError for what is not STEP,
// is truncated or damaged, or holds no geometry; a face whose boundary is not closed or can't be
// brought to the parameters of a NURBS surface is among the unread.
GeometryContents ReadStepContents(const std::string& path);

// All of them: ReadError where one can't be read.
std::vector<Geometry> ReadStep(const std::string& path);

}  // namespace batten
