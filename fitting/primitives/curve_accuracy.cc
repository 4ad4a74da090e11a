// SPDX-License-Identifier: MIT
#include "fitting/primitives/curve_accuracy.h"

#include <algorithm>
#include <cmath>

#include "fitting/core/distributions.h"
#include "fitting/core/shared_constants.h"
#include "fitting/primitives/steady_across.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// AccuracySums over the points used. Distances of plane clouds have one component, of others two.
struct AccuracySums {
  Eigen::MatrixXd matrix;  // Σ w J Jᵀ
  double squares = 0;      // Σ w ψ²
  double slopes = 0;       // Σ ψ' over the components
  double components = 0;

  AccuracySums(Eigen::Index freedoms, const std::vector<Eigen::Index>& used, bool plane)
      : matrix(Eigen::MatrixXd::Zero(freedoms, freedoms)),
        components(static_cast<double>(used.size()) * (plane ? 1 : 2)) {}

  // Slopes at a point at distance d: ψ as a vector has the slope ψ' along the distance and ψ/d
  // across.
  void AddLoss(const ShapeLoss& loss, double d, double weight, bool plane) {
    const auto pull = [&](double x) { return x * LossWeight(loss.loss, x, loss.scale); };
    const double step = 1e-4 * loss.scale;
    const bool square = loss.loss == Loss::kNone;
    squares += weight * pull(d) * pull(d);
    slopes += square ? 1 : (pull(d + step) - pull(d - step)) / (2 * step);
    if (!plane) slopes += LossWeight(loss.loss, d, loss.scale);
  }

  // Infinite in all where the points do not determine a freedom, or leave no freedom to estimate
  // noise.
  Eigen::MatrixXd Covariance(double rounding) const {
    const Eigen::Index n = matrix.rows();
    const double left = std::max(1.0, components - static_cast<double>(n));
    const double slope = std::max(slopes / components, 1e-3);
    const double variance = std::max(rounding * rounding, squares / left / (slope * slope));
    const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt();
    if (!(scale.minCoeff() > 0) || components <= static_cast<double>(n)) {
      return Eigen::MatrixXd::Constant(n, n, kInfinity);
    }
    const Eigen::VectorXd by = scale.cwiseInverse();
    const SymmetricFactor solver(by.asDiagonal() * matrix * by.asDiagonal());
    if (!(solver.Pivots().minCoeff() > 0)) return Eigen::MatrixXd::Constant(n, n, kInfinity);
    return variance *
           (by.asDiagonal() * solver.Solve(Eigen::MatrixXd::Identity(n, n)) * by.asDiagonal());
  }
};

// Variances of numbers that depend on undetermined freedoms are infinite too, not computed from
// them.
Eigen::MatrixXd Carried(const Eigen::MatrixXd& by, const Eigen::MatrixXd& covariance) {
  if (covariance.allFinite()) return by * covariance * by.transpose();
  return Eigen::MatrixXd::Constant(by.rows(), by.rows(), kInfinity);
}

// Deviations scaled so that three of them cover as much as for normal errors, however few the
// points.
Eigen::VectorXd DeviationsOf(const Eigen::MatrixXd& covariance, double freedoms_left) {
  return FewFactor(freedoms_left) * covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

// Converts the lengths among the numbers to the data's units.
void Scale(PrimitiveAccuracy& accuracy, const std::vector<bool>& length, double unit) {
  for (size_t i = 0; i < length.size(); ++i) {
    if (!length[i]) continue;
    const auto at = static_cast<Eigen::Index>(i);
    accuracy.standard_deviations[at] *= unit;
    accuracy.covariance.row(at) *= unit;
    accuracy.covariance.col(at) *= unit;
  }
}

}  // namespace

PrimitiveAccuracy AccuracyOf(const FittedLine& line,
                             const ShapeData& data,
                             const std::vector<Eigen::Index>& used,
                             const ShapeLoss& loss,
                             double rounding,
                             double unit) {
  PrimitiveAccuracy accuracy;
  const Eigen::Vector3d& along = line.direction;
  accuracy.frame_x = data.plane ? Eigen::Vector3d(-along.y(), along.x(), 0) : SteadyAcross(along);
  accuracy.frame_y = along.cross(accuracy.frame_x);
  // Turns and shifts; across the other direction they are the same.
  AccuracySums sums(2, used, data.plane);
  for (const Eigen::Index k : used) {
    const double place = (data.points.col(k) - line.point).dot(along), w = data.weights[k];
    const Eigen::Vector2d change(place, 1);
    sums.matrix += w * change * change.transpose();
    sums.AddLoss(loss, line.Distance(data.points.col(k)), w, data.plane);
  }
  const Eigen::MatrixXd one = sums.Covariance(rounding);
  if (data.plane) {
    accuracy.names = {"direction_x", "point_x"};
    accuracy.covariance = one;
  } else {
    accuracy.names = {"direction_x", "direction_y", "point_x", "point_y"};
    accuracy.covariance = Eigen::MatrixXd::Zero(4, 4);
    for (const int i : {0, 1}) {
      for (const int j : {0, 1}) {
        accuracy.covariance(2 * i, 2 * j) = accuracy.covariance(2 * i + 1, 2 * j + 1) = one(i, j);
      }
    }
  }
  accuracy.standard_deviations =
      DeviationsOf(accuracy.covariance, sums.components - (data.plane ? 2 : 4));
  Scale(accuracy,
        data.plane ? std::vector{false, true} : std::vector{false, false, true, true},
        unit);
  return accuracy;
}

PrimitiveAccuracy AccuracyOf(const FittedCircle& circle,
                             const ShapeData& data,
                             const std::vector<Eigen::Index>& used,
                             const ShapeLoss& loss,
                             double rounding,
                             double unit) {
  PrimitiveAccuracy accuracy;
  const double kappa = circle.curvature, radius = 1 / kappa;
  const Eigen::Vector3d axis = circle.Axis().normalized();
  accuracy.frame_x = circle.outward;
  accuracy.frame_y = axis.cross(circle.outward);
  // Freedoms: a shift outward, a turn about the axis, the curvature; out of the plane a shift, and
  // turns about `outward` and `tangent`, all at the circle's point.
  const int freedoms = data.plane ? 3 : 6;
  AccuracySums sums(freedoms, used, data.plane);
  for (const Eigen::Index k : used) {
    const double angle = circle.AngleOf(data.points.col(k)), w = data.weights[k];
    const double sine = std::sin(angle), flat = 2 * std::pow(std::sin(angle / 2), 2);
    Eigen::VectorXd change = Eigen::VectorXd::Zero(freedoms);
    change.head<3>() << flat - 1, radius * sine, radius * radius * flat;
    sums.matrix += w * change * change.transpose();
    if (!data.plane) {
      Eigen::VectorXd off = Eigen::VectorXd::Zero(freedoms);
      off.tail<3>() << 1, radius * sine, radius * flat;
      sums.matrix += w * off * off.transpose();
    }
    sums.AddLoss(loss, circle.Distance(data.points.col(k)), w, data.plane);
  }
  const Eigen::MatrixXd covariance = sums.Covariance(rounding);
  // The axis' turns towards `outward` and `tangent`; the centre outward, along the tangent and the
  // axis; the radius.
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(6, freedoms);
  by(2, 0) = 1;
  by(2, 2) = radius * radius;
  by(3, 1) = -radius;
  by(5, 2) = -radius * radius;
  if (!data.plane) {
    by(0, 5) = 1;
    by(1, 4) = -1;
    by(4, 3) = 1;
    by(4, 5) = radius;
  }
  Eigen::MatrixXd turned = Eigen::MatrixXd::Identity(6, 6);
  turned.block<3, 3>(2, 2) << circle.outward, axis.cross(circle.outward), axis;
  const Eigen::MatrixXd all = Carried(turned * by, covariance);
  // The part of the curvature's error that linearization leaves out.
  double stretch = 1;
  const double bend = std::sqrt(std::max(0.0, covariance(2, 2)));
  if (!(kThreeSigmas * bend < kappa)) {
    stretch = kInfinity;
  } else {
    stretch = 1 / (1 - kThreeSigmas * bend / kappa);
  }
  Eigen::VectorXd deviations = DeviationsOf(all, sums.components - freedoms);
  for (int i = 2; i < 6; ++i) {
    const Eigen::Vector3d coordinate = i < 5 ? Eigen::Vector3d::Unit(i - 2).eval() : circle.outward;
    const double share = std::abs(coordinate.dot(circle.outward)) * radius * radius * bend;
    deviations[i] = std::hypot(deviations[i],
                               std::isfinite(stretch) ? share * std::sqrt(stretch * stretch - 1)
                               : share > 0            ? kInfinity
                                                      : 0);
  }
  std::vector<Eigen::Index> kept = {0, 1, 2, 3, 4, 5};
  accuracy.names = {"axis_x", "axis_y", "center_x", "center_y", "center_z", "radius"};
  std::vector<bool> length = {false, false, true, true, true, true};
  if (data.plane) {
    kept = {2, 3, 5};
    accuracy.names = {"center_x", "center_y", "radius"};
    length = {true, true, true};
  }
  accuracy.covariance = all(kept, kept);
  accuracy.standard_deviations = deviations(kept);
  Scale(accuracy, length, unit);
  return accuracy;
}

}  // namespace batten::internal
