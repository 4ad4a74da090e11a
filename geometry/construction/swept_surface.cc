// SPDX-License-Identifier: MIT
#include "batten/geometry/swept_surface.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "batten/geometry/closure.h"
#include "geometry/construction/cubic_approximation.h"
#include "geometry/construction/curve_closure.h"
#include "geometry/construction/one_sided_curve.h"
#include "geometry/construction/rotation_minimising_frame.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kRows = 12;  // the trajectory less its start, then the columns of the turn

using Motion = Eigen::Matrix<double, kRows, 1>;

Motion MotionOf(const Eigen::Vector3d& place, const Eigen::Matrix3d& turn) {
  Motion motion;
  motion << place, turn.reshaped();
  return motion;
}

// Where a point of the profile, less the start of the trajectory, is carried.
Eigen::Vector3d Carried(const Motion& motion, const Eigen::Vector3d& point) {
  return motion.head<3>() + motion.tail<9>().reshaped(3, 3) * point;
}

// What the profile is to the sweep: its control points less the start of the trajectory.
struct CarriedProfile {
  Eigen::Matrix3Xd control_points;
  Eigen::Matrix3Xd on_curve;
  double radius;  // of the control points from the start
};

CarriedProfile ProfileFrom(const NurbsCurve<3>& profile, const Eigen::Vector3d& start) {
  constexpr int kPerSpan = 16;
  CarriedProfile carried{profile.control_points().colwise() - start, {}, 0};
  carried.radius = carried.control_points.colwise().norm().maxCoeff();
  const int places = kPerSpan * static_cast<int>(profile.basis().Spans().size());
  const double lower = profile.basis().lower(), upper = profile.basis().upper();
  carried.on_curve.resize(3, places + 1);
  for (int k = 0; k <= places; ++k) {
    carried.on_curve.col(k) = profile.At(lower + (upper - lower) * k / places) - start;
  }
  return carried;
}

// Beyond the centre of curvature the profile would be carried backwards.
void RefuseFolds(const RotationMinimisingFrame& frame,
                 const std::vector<double>& places,
                 const CarriedProfile& profile) {
  constexpr double kSlack = 1e-9;
  for (const double at : places) {
    const auto place = frame.At(at, Side::kBelow);
    const double bend = place.bend.norm();
    if (!(bend * profile.radius > 1)) continue;
    const double reach =
        (place.bend.transpose() * (place.turn * profile.on_curve)).maxCoeff() / bend;
    RequireThat(reach * bend <= 1 + kSlack,
                "Sweep",
                "the profile reaches " + RoundedText(reach) +
                    " to the inside of the bend at the trajectory's parameter " + RoundedText(at) +
                    ", whose radius is " + RoundedText(1 / bend) +
                    ": the surface would fold back over itself; bring the profile nearer to the "
                    "trajectory, or make the bend wider");
  }
}

// A profile in a plane that holds the trajectory's tangent is moved within that plane: what turns
// back along the tangent is swept over again.
void RefuseFlat(const NurbsCurve<3>& profile, const Eigen::Vector3d& tangent) {
  constexpr double kFlat = 1e-9;
  RequireThat(!LieAlong(profile.control_points(), tangent),
              "Sweep",
              "the profile lies on a line along the trajectory's start: the surface would have no "
              "area; turn the profile across the trajectory");
  const Eigen::Matrix3Xd legs =
      profile.control_points().rightCols(profile.control_points().cols() - 1) -
      profile.control_points().leftCols(profile.control_points().cols() - 1);
  Eigen::Matrix3Xd across(3, legs.cols());
  for (Eigen::Index k = 0; k < legs.cols(); ++k) across.col(k) = tangent.cross(legs.col(k));
  Eigen::Index most = 0;
  const double size = across.colwise().norm().maxCoeff(&most);
  const Eigen::Vector3d normal = across.col(most) / size;
  const Eigen::RowVectorXd heights = normal.transpose() * across;
  const double off = (across - normal * heights).colwise().norm().maxCoeff();
  if (off > kFlat * size) return;
  constexpr int kPerSpan = 16;
  const SplineBasis& basis = profile.basis();
  const int places = kPerSpan * static_cast<int>(basis.Spans().size());
  double least = 0, greatest = 0;
  for (int k = 0; k <= places; ++k) {
    const double u = basis.lower() + (basis.upper() - basis.lower()) * k / places;
    const double turn = normal.dot(tangent.cross(profile.JetAt(u).first.stableNormalized()));
    least = std::min(least, turn);
    greatest = std::max(greatest, turn);
  }
  RequireThat(least >= -kFlat || greatest <= kFlat,
              "Sweep",
              "the profile's plane holds the trajectory's tangent, and it turns back there: the "
              "surface would lie on itself; turn the profile across the trajectory");
}

// The turn that makes a closed trajectory close the surface.
double ClosingTurn(const NurbsCurve<3>& trajectory,
                   const RotationMinimisingFrame& frame,
                   double twist) {
  if (!Closed(trajectory)) return 0;
  constexpr double kSlack = 1e-9;
  const double turns = twist / (2 * std::numbers::pi);
  RequireThat(std::abs(turns - std::round(turns)) <= kSlack,
              "Sweep",
              "the trajectory is closed, and a twist of " + RoundedText(360 * turns) +
                  " degrees does not close the surface: only whole turns do, multiples of 360");
  return -frame.Holonomy();
}

NurbsSurface SurfaceOf(const NurbsCurve<3>& profile,
                       const CarriedProfile& carried,
                       const Eigen::Vector3d& start,
                       const CubicApproximation& motion,
                       bool closed) {
  const Eigen::Index m = profile.control_points().cols(), n = motion.coefficients.cols();
  Eigen::Matrix3Xd points(3, m * n);
  Eigen::VectorXd weights(m * n);
  for (Eigen::Index i = 0; i < m; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      points.col(i * n + j) =
          start + Carried(motion.coefficients.col(j), carried.control_points.col(i));
      weights[i * n + j] = profile.weights()[i];
    }
    points.col(i * n) = profile.control_points().col(i);  // bit by bit
    if (closed) points.col(i * n + n - 1) = points.col(i * n);
  }
  return NurbsSurface(profile.basis(), motion.basis, std::move(points), std::move(weights));
}

}  // namespace

SweptSurface Sweep(const NurbsCurve<3>& profile,
                   const NurbsCurve<3>& trajectory,
                   const SweepOptions& options) {
  RequirePositive("Sweep", "tolerance", options.tolerance);
  RequireThat(std::isfinite(options.twist), "Sweep", "twist is not finite");
  RequireThat(!IsPoint(trajectory), "Sweep", "the trajectory is a point");
  RequireThat(!IsPoint(profile), "Sweep", "the profile is a point");
  const Eigen::Vector3d start = trajectory.At(trajectory.basis().lower());
  RefuseFlat(profile, trajectory.JetAt(trajectory.basis().lower()).first.stableNormalized());
  const CarriedProfile carried = ProfileFrom(profile, start);
  // What of the tolerance the frame may take, as an angle at the far end of the profile.
  const double radius = std::max(carried.radius, BoxDiagonal(profile.control_points()));
  const double accuracy = std::clamp(options.tolerance / (50 * radius), 1e-12, 1e-6);
  RefuseKinks(trajectory, std::max(accuracy, 1e-9), "Sweep");
  RotationMinimisingFrame frame(trajectory, accuracy, "Sweep");
  const double closing = ClosingTurn(trajectory, frame, options.twist);
  frame.TwistBy(options.twist + closing);
  RefuseFolds(frame, frame.Places(), carried);
  const CubicApproximation motion = ApproximateByCubic(
      [&](double v, Side side) {
        const auto place = frame.At(v, side);
        return ValueAndSlope{MotionOf(place.jet.point - start, place.turn),
                             MotionOf(place.jet.first, place.turn_slope)};
      },
      BreaksOf(trajectory),
      [&](const Eigen::VectorXd& difference) {
        double worst = 0;
        for (const auto& point : carried.control_points.colwise()) {
          worst = std::max(worst, Carried(difference, point).norm());
        }
        return worst;
      },
      options.tolerance,
      "Sweep");
  return {SurfaceOf(profile, carried, start, motion, Closed(trajectory)), motion.error, closing};
}

}  // namespace batten
