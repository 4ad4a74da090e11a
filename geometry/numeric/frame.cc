// SPDX-License-Identifier: MIT
#include "batten/geometry/frame.h"

#include <Eigen/Geometry>
#include <stdexcept>
#include <string>

#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

std::string VectorText(const Eigen::Vector3d& v) {
  return "(" + NumberText(v[0]) + ", " + NumberText(v[1]) + ", " + NumberText(v[2]) + ")";
}

Eigen::Vector3d Unit(const Eigen::Vector3d& v, const char* name) {
  if (!v.allFinite() || v.isZero(0)) {
    throw std::invalid_argument(std::string("Frame: ") + name + " = " + VectorText(v) +
                                " is not a finite direction");
  }
  return (v / v.cwiseAbs().maxCoeff()).normalized();
}

// The part of a unit vector across a unit axis.
Eigen::Vector3d Across(const Eigen::Vector3d& v, const Eigen::Vector3d& axis) {
  return v - v.dot(axis) * axis;
}

Eigen::Vector3d CoordinateAxisFarFrom(const Eigen::Vector3d& axis) {
  Eigen::Index farthest = 0;
  for (Eigen::Index k = 1; k < 3; ++k) {
    if (std::abs(axis[k]) < std::abs(axis[farthest])) farthest = k;
  }
  return Eigen::Vector3d::Unit(farthest);
}

}  // namespace

Frame::Frame(const Eigen::Vector3d& origin, const Eigen::Vector3d& axis)
    : Frame(origin, axis, CoordinateAxisFarFrom(Unit(axis, "axis"))) {}

Frame::Frame(const Eigen::Vector3d& origin, const Eigen::Vector3d& axis, const Eigen::Vector3d& x)
    : origin_(origin), axis_(Unit(axis, "axis")) {
  constexpr double kParallel = 1e-9;
  if (!origin.allFinite()) {
    throw std::invalid_argument("Frame: origin = " + VectorText(origin) + " is not finite");
  }
  const Eigen::Vector3d across = Across(Unit(x, "x"), axis_);
  if (!(across.norm() > kParallel)) {
    throw std::invalid_argument("Frame: x = " + VectorText(x) + " is along the axis");
  }
  // Twice: what the first difference leaves along the axis is rounding over its length.
  x_ = Across(across.normalized(), axis_).normalized();
  y_ = axis_.cross(x_);
}

}  // namespace batten
