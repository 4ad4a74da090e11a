// SPDX-License-Identifier: MIT
// The control points of compatible sections, row by row across them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Sections over one basis; column k holds the control points of section k one below the other.
struct SectionRows {
  SplineBasis basis;
  Eigen::MatrixXd points;   // 3n × sections
  Eigen::MatrixXd weights;  // n × sections

  Eigen::Index count() const { return points.cols(); }
  Eigen::Index rows() const { return weights.rows(); }
};

// Weights scaled to mean one (of their logarithms) in every section.
SectionRows SectionRowsOf(const std::vector<NurbsCurve<3>>& compatible);

// Whether every row has one weight, to rounding.
bool SameWeights(const SectionRows& sections);

// Distances of control points from one section to the next, a row for each row of the net; with
// `closed` also from the last to the first.
Eigen::MatrixXd ChordLengths(const SectionRows& sections, bool closed);

// Places of the sections in [0, 1] (the last, where closed, is the first again): the mean over the
// rows of the shares of their chord lengths. Throws std::invalid_argument in the name of `function`
// where two sections that follow one another are the same. [Piegl & Tiller 1997, eq. 10.8]
std::vector<double> ChordParameters(const SectionRows& sections, bool closed, const char* function);

// The net over the basis of the sections and `across`, of points (3n × m) and weights (n × m).
NurbsSurface SurfaceOfRows(const SplineBasis& along,
                           const SplineBasis& across,
                           const Eigen::MatrixXd& points,
                           const Eigen::MatrixXd& weights);

}  // namespace batten::internal
