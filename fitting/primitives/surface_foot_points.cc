// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "fitting/core/rounding.h"
#include "fitting/primitives/surface_patch.h"
#include "fitting/primitives/surface_places.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

double PartOf(double value, const Interval& range) {
  return std::clamp((value - range.lower) / (range.upper - range.lower), 0.0, 1.0);
}

// The parameter at which a NURBS arc of rational quadratic pieces of 90° at most has the direction
// (x, y): on a piece of twice the angle h, at t with tan(φ/2) = (2t − 1) tan(h/2), φ from its
// middle. Beyond, the nearer end.
class ArcParameter {
 public:
  explicit ArcParameter(const AngleRange& angles) {
    pieces_ =
        std::max(1, static_cast<int>(std::ceil(angles.sweep / (kTurn / 4) - kRelativeRounding)));
    const double step = angles.sweep / pieces_;
    widest_ = std::tan(step / 4);
    for (int i = 0; i < pieces_; ++i) {
      const double middle = angles.start + (i + 0.5) * step;
      middles_[static_cast<size_t>(i)] = {std::cos(middle), std::sin(middle)};
    }
  }

  double operator()(double x, double y) const {
    int piece = 0;
    double along = -2;
    for (int i = 0; i < pieces_; ++i) {
      const Direction& middle = middles_[static_cast<size_t>(i)];
      const double dot = x * middle.cosine + y * middle.sine;
      if (i == 0 || dot > along) {
        along = dot;
        piece = i;
      }
    }
    const Direction& middle = middles_[static_cast<size_t>(piece)];
    const double across = y * middle.cosine - x * middle.sine;
    const double sum = std::sqrt(x * x + y * y) + along;
    const double half = sum > 0 ? across / sum : std::copysign(1 / widest_, across);
    const double t = 0.5 + 0.5 * half / widest_;
    return (piece + std::clamp(t, 0.0, 1.0)) / pieces_;
  }

  // The direction at a parameter.
  Eigen::Vector2d At(double parameter) const {
    const int piece = std::min(static_cast<int>(parameter * pieces_), pieces_ - 1);
    const double half = (2 * (parameter * pieces_ - piece) - 1) * widest_;  // tan(φ/2)
    const double cosine = (1 - half * half) / (1 + half * half),
                 sine = 2 * half / (1 + half * half);
    const Direction& middle = middles_[static_cast<size_t>(piece)];
    return {middle.cosine * cosine - middle.sine * sine,
            middle.sine * cosine + middle.cosine * sine};
  }

 private:
  struct Direction {
    double cosine = 1, sine = 0;
  };

  std::array<Direction, 4> middles_;
  int pieces_;
  double widest_;
};

// The parameters of all points' foot points.
struct FootPointsOf {
  const Eigen::Matrix3Xd& points;
  ThreadPool& pool;

  // Of places (x, y, z) in the frame, z along the axis.
  template <typename Foot>
  Eigen::Matrix2Xd InFrame(const Frame& frame, const Foot& foot) const {
    return PlacesOf(points, pool, [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
      const Eigen::Vector3d from = p - frame.origin();
      return foot(
          Eigen::Vector3d(from.dot(frame.x()), from.dot(frame.y()), from.dot(frame.axis())));
    });
  }

  Eigen::Matrix2Xd operator()(const ExactPlane& s) const {
    return InFrame(s.frame, [&](const Eigen::Vector3d& at) {
      return Eigen::Vector2d(PartOf(at[0], s.x), PartOf(at[1], s.y));
    });
  }
  Eigen::Matrix2Xd operator()(const ExactCylinder& s) const {
    const ArcParameter round(s.angles);
    return InFrame(s.frame, [&](const Eigen::Vector3d& at) {
      return Eigen::Vector2d(round(at[0], at[1]), PartOf(at[2], s.height));
    });
  }
  Eigen::Matrix2Xd operator()(const ExactCone& s) const {
    const ArcParameter round(s.angles);
    const Eigen::Vector2d lower(s.radius_lower, s.height.lower);
    const Eigen::Vector2d along = Eigen::Vector2d(s.radius_upper, s.height.upper) - lower;
    return InFrame(s.frame, [&](const Eigen::Vector3d& at) {
      const Eigen::Vector2d place(at.head<2>().norm(), at[2]);
      return Eigen::Vector2d(
          round(at[0], at[1]),
          std::clamp((place - lower).dot(along) / along.squaredNorm(), 0.0, 1.0));
    });
  }
  Eigen::Matrix2Xd operator()(const ExactSphere& s) const {
    const ArcParameter round(s.longitude);
    const ArcParameter up({s.latitude.lower, s.latitude.upper - s.latitude.lower});
    return InFrame(s.frame, [&](const Eigen::Vector3d& at) {
      return Eigen::Vector2d(round(at[0], at[1]), up(at.head<2>().norm(), at[2]));
    });
  }
  Eigen::Matrix2Xd operator()(const ExactTorus& s) const {
    const ArcParameter round(s.round), tube(s.tube);
    const auto off = [&](const Eigen::Vector3d& at, const Eigen::Vector2d& foot) {
      const Eigen::Vector2d about = round.At(foot[0]), on_tube = s.minor * tube.At(foot[1]);
      const double out = s.major + on_tube[0];
      return (at - Eigen::Vector3d(out * about[0], out * about[1], on_tube[1])).squaredNorm();
    };
    // Beyond an end of the round, in the plane of its end.
    const auto on_side = [&](const Eigen::Vector3d& at, const Eigen::Vector2d& side) {
      const double u = round(side[0], side[1]);
      return Eigen::Vector2d(u, tube(at.head<2>().dot(round.At(u)) - s.major, at[2]));
    };
    return InFrame(s.frame, [&](const Eigen::Vector3d& at) {
      const Eigen::Vector2d here = on_side(at, at.head<2>());
      if (!(s.minor > s.major)) return here;
      // A spindle's tube goes on across the axis.
      const Eigen::Vector2d across = on_side(at, -at.head<2>());
      return off(at, across) < off(at, here) ? across : here;
    });
  }
};

}  // namespace

Eigen::Matrix2Xd FootPointsOn(const ExactSurface& patch,
                              const Eigen::Matrix3Xd& points,
                              ThreadPool& pool) {
  return std::visit(FootPointsOf{points, pool}, patch);
}

}  // namespace batten::internal
