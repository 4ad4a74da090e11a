// SPDX-License-Identifier: MIT
// Maps of a shape's uncertainty as files.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "batten/fitting/uncertainty.h"
#include "batten/io/atomic_file.h"
#include "batten/io/geometry_types.h"

namespace batten {

// By the extension, any case:
//  · .csv: a header line u[,v],x,y,z,sigma,bias,support,area and a row for each place inside the
//    trims;
//  · .ply of surfaces: a mesh of these places with doubles sigma, bias, support, and colours by
//    sigma, blue for the least and red for the greatest; grey where the points do not support it;
//  · .glb: the mesh with its colours, in metres (`metres` of them in a unit of the coordinates).
// The file appears on Commit(). Throws UsageError for another extension, or a mesh of a curve;
// WriteError where it can't be written.
std::unique_ptr<AtomicFile> WriteUncertainty(const std::string& path,
                                             const UncertaintyMap& map,
                                             const Geometry& geometry,
                                             double metres = 1e-3);

// Throws UsageError for what WriteUncertainty refuses by its name.
void CheckUncertaintyName(const std::string& path, bool curve);

// Standard deviations at places of a domain (2 × k), for ReportSurface::sigma: NaN where the points
// do not support the shape.
Eigen::VectorXd SigmaAt(const Uncertainty& of, const Eigen::Matrix2Xd& parameters);

}  // namespace batten
