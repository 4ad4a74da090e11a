// SPDX-License-Identifier: MIT
#include "geometry/shapes/axis_crossings.h"

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "batten/geometry/closure.h"
#include "batten/geometry/split.h"
#include "geometry/numeric/construction_checks.h"

namespace batten::internal {
namespace {

constexpr double kFlat = 1e-9;  // of the size

// Distances from the axis, those of the other side negative, in the plane of the profile.
std::optional<Eigen::Vector3d> SideOf(const Eigen::Matrix3Xd& from_axis, const Frame& axis) {
  Eigen::Index farthest = 0;
  const double size = from_axis.colwise().norm().maxCoeff(&farthest);
  const Eigen::Vector3d outward = from_axis.col(farthest).normalized();
  const double off = (axis.axis().cross(outward).transpose() * from_axis).cwiseAbs().maxCoeff();
  if (!(off <= kFlat * size)) return {};
  return outward;
}

// The signs a function takes from one end to the other, and where it changes them.
class SignSequence {
 public:
  // Bézier coefficients over [a, b].
  void Append(const Eigen::VectorXd& b, double from, double to, int halvings) {
    if (b.minCoeff() >= 0 || b.maxCoeff() <= 0) {
      if (!b.isZero(0)) Take(b.maxCoeff() > 0 ? 1 : -1, from);
      return;
    }
    if (halvings == 0) return;
    Eigen::VectorXd rest = b, left(b.size()), right(b.size());
    const Eigen::Index last = b.size() - 1;
    for (Eigen::Index k = 0; k <= last; ++k) {
      left[k] = rest[0];
      right[last - k] = rest[last - k];
      for (Eigen::Index j = 0; j < last - k; ++j) rest[j] = (rest[j] + rest[j + 1]) / 2;
    }
    Append(left, from, (from + to) / 2, halvings - 1);
    Append(right, (from + to) / 2, to, halvings - 1);
  }

  int first() const { return first_; }
  int last() const { return last_; }
  const std::vector<double>& changes() const { return changes_; }

 private:
  void Take(int sign, double at) {
    if (last_ != 0 && sign != last_) changes_.push_back(at);
    if (first_ == 0) first_ = sign;
    last_ = sign;
  }

  int first_ = 0, last_ = 0;
  std::vector<double> changes_;
};

Eigen::Matrix3Xd FromAxis(const NurbsCurve<3>& curve, const Frame& axis) {
  const Eigen::Matrix3Xd from = curve.control_points().colwise() - axis.origin();
  return from - axis.axis() * (axis.axis().transpose() * from);
}

}  // namespace

std::vector<double> AxisCrossings(const NurbsCurve<3>& profile, const Frame& axis) {
  constexpr int kHalvings = 40;
  const Eigen::Matrix3Xd all = FromAxis(profile, axis);
  const std::optional<Eigen::Vector3d> outward = SideOf(all, axis);
  if (!outward) return {};
  const double on_axis = kFlat * all.colwise().norm().maxCoeff();
  SignSequence signs;
  for (const NurbsCurve<3>& piece : Decompose(profile)) {
    Eigen::VectorXd distances = FromAxis(piece, axis).transpose() * *outward;
    distances = (distances.array().abs() <= on_axis).select(0, distances);
    const Eigen::VectorXd coefficients = distances.cwiseProduct(piece.weights());
    signs.Append(coefficients, piece.basis().lower(), piece.basis().upper(), kHalvings);
  }
  std::vector<double> crossings = signs.changes();
  if (Closed(profile) && signs.first() != signs.last())
    crossings.push_back(profile.basis().upper());
  return crossings;
}

void RefuseCrossings(const NurbsCurve<3>& profile, const Frame& axis, const char* function) {
  const std::vector<double> crossings = AxisCrossings(profile, axis);
  if (crossings.size() < 2) return;
  const auto place = [&](double at) {
    const Eigen::Vector3d p = profile.At(at);
    return RoundedText(at) + " (" + RoundedText(p.x()) + ", " + RoundedText(p.y()) + ", " +
           RoundedText(p.z()) + ")";
  };
  RequireThat(false,
              function,
              "the profile crosses its axis " + std::to_string(crossings.size()) +
                  " times, first at its parameters " + place(crossings[0]) + " and " +
                  place(crossings[1]) +
                  ": turned by more than 180 degrees the surface would go through itself; take "
                  "what lies on one side");
}

}  // namespace batten::internal
