// SPDX-License-Identifier: MIT
// From the parameters of analytic surfaces to those of their NURBS form. Not installed.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The map of [first, last] onto the domain of a basis: linear, or for an angle along a chain of
// equal rational arcs of degree 2, whose parameter is the tangent of half the angle from the
// middle of each. [Piegl & Tiller 1997, §7.3]
class ParameterMap {
 public:
  ParameterMap(double first, double last, const SplineBasis& basis, bool angle);

  bool linear() const { return !angle_; }
  double At(double parameter) const;
  double Slope(double parameter) const;

 private:
  // The arc an angle lies on and its angle there from the arc's middle.
  int ArcOf(double parameter, double& from_middle) const;

  double first_, last_;
  std::vector<double> breaks_;  // of the basis
  bool angle_;
};

// Whether a curve that is made of another has to be at the same place at the same parameter, not
// only to run the same way.
enum class CurveSpeed { kAny, kKept };

// A place of a curve and its derivative there.
struct CurveNode {
  double parameter;
  Eigen::Vector2d point, slope;
};

// The C^1 cubic, within `tolerance` in each coordinate, of a curve without corners given by its
// nodes.
NurbsCurve<2> CubicOf(const std::function<CurveNode(double)>& curve,
                      double lower,
                      double upper,
                      const Eigen::Array2d& tolerance);

// The curve with u and v mapped: exact where both maps are linear or the curve runs along a
// parameter line, at the same speed if that is to be kept, else a C^1 cubic within `tolerance` of
// each domain.
NurbsCurve<2> Mapped(const NurbsCurve<2>& curve,
                     const ParameterMap& u,
                     const ParameterMap& v,
                     const Eigen::Array2d& sides,
                     double tolerance,
                     CurveSpeed speed = CurveSpeed::kAny);

}  // namespace batten::internal
