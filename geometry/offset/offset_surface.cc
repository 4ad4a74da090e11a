// SPDX-License-Identifier: MIT
#include "batten/geometry/offset_surface.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/clamp.h"
#include "batten/geometry/curvature.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/polygon.h"
#include "geometry/offset/exact_offset.h"
#include "geometry/offset/self_crossings.h"

namespace batten {
using namespace internal;
namespace {

constexpr const char* kOffsetSurface = "OffsetSurface";
constexpr int kCellPlaces = 5;  // a side
constexpr int kMostRows = 400;
constexpr std::size_t kMostMeetings = 100;

std::string PlaceText(double u, double v) {
  return "u, v = " + RoundedText(u) + ", " + RoundedText(v);
}

// Breaks of one direction with the multiplicities that a cubic offset has there.
struct Breaks {
  std::vector<double> places;
  std::vector<int> multiplicities;

  SplineBasis Basis() const {
    std::vector<double> knots(4, places.front());
    for (std::size_t k = 1; k + 1 < places.size(); ++k) {
      knots.insert(knots.end(), multiplicities[k], places[k]);
    }
    knots.insert(knots.end(), 4, places.back());
    return SplineBasis(3, std::move(knots));
  }
};

// The normal is of one smoothness less than the surface.
Breaks BreaksOf(const SplineBasis& basis) {
  Breaks breaks;
  for (const int span : basis.Spans()) {
    const double knot = basis.knots()[span];
    breaks.places.push_back(knot);
    breaks.multiplicities.push_back(
        std::clamp(3 - (basis.degree() - basis.Multiplicity(knot) - 1), 1, 3));
  }
  breaks.places.push_back(basis.upper());
  breaks.multiplicities.push_back(4);
  return breaks;
}

class OffsetMaker {
 public:
  OffsetMaker(const NurbsSurface& surface, double distance, double tolerance)
      : surface_(surface),
        distance_(distance),
        tolerance_(tolerance),
        u_(BreaksOf(surface.basis_u())),
        v_(BreaksOf(surface.basis_v())) {}

  Eigen::Vector3d ExactAt(double u, double v) const {
    const auto normal = surface_.NormalAt(u, v);
    RequireThat(normal.has_value(),
                kOffsetSurface,
                "there is no normal at " + PlaceText(u, v) + ": no side to go to");
    return surface_.At(u, v) + distance_ * *normal;
  }

  // Creases have two offsets: no surface.
  void RequireNoCreases() const {
    for (const bool along_u : {true, false}) {
      const SplineBasis& across = along_u ? surface_.basis_u() : surface_.basis_v();
      const Breaks &breaks = along_u ? u_ : v_, &others = along_u ? v_ : u_;
      for (std::size_t k = 1; k + 1 < breaks.places.size(); ++k) {
        const double knot = breaks.places[k];
        if (across.Multiplicity(knot) < across.degree()) continue;
        const double low = knot - kAside * (knot - breaks.places[k - 1]);
        for (std::size_t j = 0; j + 1 < others.places.size(); ++j) {
          const double other = others.places[j] / 2 + others.places[j + 1] / 2;
          const auto a = along_u ? surface_.NormalAt(low, other) : surface_.NormalAt(other, low);
          const auto b = along_u ? surface_.NormalAt(knot, other) : surface_.NormalAt(other, knot);
          if (!a || !b) continue;
          const double angle = AngleBetween(*a, *b);
          RequireThat(angle <= kCrease,
                      kOffsetSurface,
                      "the surface has a crease of " + RoundedText(angle) + " rad at the knot " +
                          (along_u ? "u = " : "v = ") + RoundedText(knot) +
                          ": its offset is not one surface; split it there");
        }
      }
    }
  }

  void RequireWideBends() const {
    double most = 0;
    Eigen::Vector2d at(0, 0);
    ForCells([&](double u0, double u1, double v0, double v1) {
      for (int i = 0; i < kCellPlaces; ++i) {
        for (int j = 0; j < kCellPlaces; ++j) {
          const Eigen::Vector2d place(u0 + (i + 0.5) / kCellPlaces * (u1 - u0),
                                      v0 + (j + 0.5) / kCellPlaces * (v1 - v0));
          const double bend = BendAt(place);
          if (bend <= most) continue;
          most = bend;
          at = place;
        }
      }
    });
    Climb(at, most);
    RequireThat(most < 1,
                kOffsetSurface,
                "distance = " + NumberText(distance_) +
                    " is beyond the smallest radius of curvature " +
                    RoundedText(std::abs(distance_) / most) + " on that side, at " +
                    PlaceText(at[0], at[1]));
  }

  // The interpolant over the breaks so far, and the deviation of each of its cells. A cubic's falls
  // to a sixteenth where cells are halved; three halvings without a gain show the rounding of
  // coordinates, or normals that jump.
  SurfaceOffset Make() {
    constexpr int kPatience = 3;
    constexpr double kGain = 0.9;
    double least = std::numeric_limits<double>::infinity();
    for (int idle = 0;;) {
      NurbsSurface surface = Interpolant();
      const double deviation = Measure(surface);
      idle = deviation < kGain * least ? 0 : idle + 1;
      least = std::min(least, deviation);
      const bool full = surface.size_u() >= kMostRows || surface.size_v() >= kMostRows;
      if (deviation <= kShare * tolerance_ || full || idle == kPatience || !Refine()) {
        return {std::move(surface), false, deviation, deviation <= tolerance_, {}};
      }
    }
  }

 private:
  static constexpr double kAside = 1e-9;   // of a span
  static constexpr double kCrease = 1e-6;  // radians
  static constexpr double kShare = 0.7;    // of the tolerance: what places between may add

  template <typename Function>
  void ForCells(Function function) const {
    for (std::size_t i = 0; i + 1 < u_.places.size(); ++i) {
      for (std::size_t j = 0; j + 1 < v_.places.size(); ++j) {
        function(u_.places[i], u_.places[i + 1], v_.places[j], v_.places[j + 1]);
      }
    }
  }

  // The distance times the greater curvature on its side.
  double BendAt(const Eigen::Vector2d& at) const {
    const auto curvature = CurvatureOf(surface_.JetAt(at[0], at[1]));
    if (!curvature) return 0;
    return std::max(distance_ * curvature->principal_low, distance_ * curvature->principal_high);
  }

  // A pattern search from the greatest sample.
  void Climb(Eigen::Vector2d& at, double& most) const {
    const SplineBasis &U = surface_.basis_u(), &V = surface_.basis_v();
    Eigen::Vector2d reach((U.upper() - U.lower()) / (kCellPlaces * (u_.places.size() - 1.0)),
                          (V.upper() - V.lower()) / (kCellPlaces * (v_.places.size() - 1.0)));
    constexpr int kSteps = 200;
    int halvings = 0;
    for (int k = 0; k < kSteps && halvings < 30; ++k) {
      bool moved = false;
      for (const auto& [i, sign] :
           {std::pair(0, 1), std::pair(0, -1), std::pair(1, 1), std::pair(1, -1)}) {
        Eigen::Vector2d next = at;
        next[i] += sign * reach[i];
        next[0] = std::clamp(next[0], U.lower(), U.upper());
        next[1] = std::clamp(next[1], V.lower(), V.upper());
        const double bend = BendAt(next);
        if (bend <= most) continue;
        most = bend;
        at = next;
        moved = true;
        break;
      }
      if (moved) continue;
      reach /= 2;
      ++halvings;
    }
  }

  static Eigen::MatrixXd Collocation(const SplineBasis& basis, std::vector<double>& places) {
    const int n = basis.size();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
      const double x = std::clamp(basis.Greville(i), basis.lower(), basis.upper());
      places.push_back(x);
      const int span = basis.Span(x);
      double values[kMaxDegree + 1];
      basis.Values(span, x, values);
      for (int r = 0; r <= 3; ++r) matrix(i, span - 3 + r) = values[r];
    }
    return matrix;
  }

  NurbsSurface Interpolant() const {
    SplineBasis basis_u = u_.Basis(), basis_v = v_.Basis();
    std::vector<double> us, vs;
    const Eigen::PartialPivLU<Eigen::MatrixXd> by_u(Collocation(basis_u, us));
    const Eigen::PartialPivLU<Eigen::MatrixXd> by_v(Collocation(basis_v, vs));
    const int n = basis_u.size(), m = basis_v.size();
    Eigen::Matrix3Xd points(3, n * m);
    std::array<Eigen::MatrixXd, 3> values;
    for (Eigen::MatrixXd& one : values) one.resize(n, m);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < m; ++j) {
        const Eigen::Vector3d x = ExactAt(us[i], vs[j]);
        for (int c = 0; c < 3; ++c) values[c](i, j) = x[c];
      }
    }
    for (int c = 0; c < 3; ++c) {
      const Eigen::MatrixXd net = by_v.solve(by_u.solve(values[c]).transpose()).transpose();
      for (int i = 0; i < n; ++i) points.block(c, i * m, 1, m) = net.row(i);
    }
    return NurbsSurface(std::move(basis_u), std::move(basis_v), std::move(points));
  }

  // Fills the deviations of rows and columns of cells: along u and along v.
  double Measure(const NurbsSurface& surface) {
    bad_u_.assign(u_.places.size() - 1, false);
    bad_v_.assign(v_.places.size() - 1, false);
    double most = 0;
    for (std::size_t i = 0; i + 1 < u_.places.size(); ++i) {
      for (std::size_t j = 0; j + 1 < v_.places.size(); ++j) {
        const double here = DeviationIn(surface, i, j);
        most = std::max(most, here);
        if (here <= kShare * tolerance_) continue;
        const double by_u = Unevenness(i, j, true), by_v = Unevenness(i, j, false);
        constexpr double kClearly = 0.2;
        if (by_u >= kClearly * by_v) bad_u_[i] = true;
        if (by_v >= kClearly * by_u) bad_v_[j] = true;
      }
    }
    return most;
  }

  double DeviationIn(const NurbsSurface& surface, std::size_t i, std::size_t j) const {
    double most = 0;
    for (int a = 0; a < kCellPlaces; ++a) {
      for (int b = 0; b < kCellPlaces; ++b) {
        const double u = Between(u_, i, (a + 0.5) / kCellPlaces);
        const double v = Between(v_, j, (b + 0.5) / kCellPlaces);
        most = std::max(most, (surface.At(u, v) - ExactAt(u, v)).norm());
      }
    }
    return most;
  }

  static double Between(const Breaks& breaks, std::size_t k, double share) {
    return breaks.places[k] + share * (breaks.places[k + 1] - breaks.places[k]);
  }

  // The fourth difference of the exact offset along one direction through a cell's middle.
  double Unevenness(std::size_t i, std::size_t j, bool along_u) const {
    constexpr std::array<double, 5> kFourth{1, -4, 6, -4, 1};
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int k = 0; k < 5; ++k) {
      const double t = 0.02 + 0.24 * k;
      sum += kFourth[k] * ExactAt(along_u ? Between(u_, i, t) : Between(u_, i, 0.5),
                                  along_u ? Between(v_, j, 0.5) : Between(v_, j, t));
    }
    return sum.norm();
  }

  bool Refine() {
    bool any = false;
    for (const bool along_u : {true, false}) {
      Breaks& breaks = along_u ? u_ : v_;
      const std::vector<bool>& bad = along_u ? bad_u_ : bad_v_;
      for (std::size_t k = bad.size(); k-- > 0;) {
        const double middle = breaks.places[k] / 2 + breaks.places[k + 1] / 2;
        if (!bad[k] || middle <= breaks.places[k] || middle >= breaks.places[k + 1]) continue;
        breaks.places.insert(breaks.places.begin() + static_cast<std::ptrdiff_t>(k) + 1, middle);
        breaks.multiplicities.insert(
            breaks.multiplicities.begin() + static_cast<std::ptrdiff_t>(k) + 1, 1);
        any = true;
      }
    }
    return any;
  }

  const NurbsSurface& surface_;
  double distance_, tolerance_;
  Breaks u_, v_;
  std::vector<bool> bad_u_, bad_v_;
};

}  // namespace

SurfaceOffset OffsetSurface(const NurbsSurface& surface,
                            double distance,
                            const OffsetOptions& options) {
  RequireThat(std::isfinite(distance) && distance != 0,
              kOffsetSurface,
              "distance = " + NumberText(distance) + " is not finite and different from zero");
  if (options.tolerance) RequirePositive(kOffsetSurface, "tolerance", *options.tolerance);
  const auto& points = surface.control_points();
  constexpr double kOfTheSize = 1e-6;
  const double tolerance = options.tolerance.value_or(
      kOfTheSize * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm());
  const NurbsSurface clamped =
      Clamped(Clamped(surface.WithTrims({}), Direction::kU), Direction::kV);
  OffsetMaker maker(clamped, distance, tolerance);
  maker.RequireNoCreases();
  maker.RequireWideBends();
  if (auto exact = ExactSurfaceOffset(clamped, distance)) {
    return {exact->WithTrims(surface.trims()), true, 0, true, {}};
  }
  SurfaceOffset offset = maker.Make();
  for (const SelfCrossing& one : SelfCrossings(offset.surface, tolerance, kMostMeetings)) {
    offset.self_meetings.push_back({one.first, one.second, one.point});
  }
  offset.surface = offset.surface.WithTrims(surface.trims());
  return offset;
}

}  // namespace batten
