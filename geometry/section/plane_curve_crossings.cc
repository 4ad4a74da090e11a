// SPDX-License-Identifier: MIT
#include "geometry/section/plane_curve_crossings.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "geometry/bezier/bernstein.h"
#include "geometry/bezier/spline_pieces.h"

namespace batten::internal {
namespace {

constexpr std::size_t kMostPairs = 400'000;  // more are only looked at along a common stretch

// A Bézier piece over [u0, u1] of its curve.
struct Piece {
  double u0, u1;
  Eigen::Matrix3Xd points;  // (w·x, w·y, w)
  Eigen::AlignedBox2d box;
  double straightness;  // how far control points are from the chord, of its length
  Eigen::Vector2d chord;
};

Piece MakePiece(double u0, double u1, Eigen::Matrix3Xd points) {
  Piece piece{u0, u1, std::move(points), {}, 0, {}};
  const Eigen::Matrix2Xd places = piece.points.colwise().hnormalized();
  for (const auto& x : places.colwise()) piece.box.extend(Eigen::Vector2d(x));
  piece.chord = places.rightCols<1>() - places.leftCols<1>();
  const double length = piece.chord.norm();
  double off = 0;
  for (const auto& x : places.colwise()) {
    const Eigen::Vector2d d = x - places.col(0);
    const double across = std::abs(piece.chord[0] * d[1] - piece.chord[1] * d[0]) / length;
    const double along = d.dot(piece.chord) / length;
    off = std::max({off, across, -along, along - length});
  }
  piece.straightness = length > 0 ? off / length : 1;
  return piece;
}

std::vector<Piece> PlanePieces(const NurbsCurve<2>& curve) {
  std::vector<Piece> pieces;
  for (const CurvePiece& one : PiecesOf(curve)) {
    Eigen::Matrix3Xd points(3, one.points.cols());
    points.row(2) = one.points.row(3);
    points.topRows<2>() = one.points.topRows<2>() + one.origin.head<2>() * one.points.row(3);
    pieces.push_back(MakePiece(one.u0, one.u1, std::move(points)));
  }
  return pieces;
}

std::pair<Piece, Piece> Halves(const Piece& piece) {
  auto [low, high] = SplitBernstein(piece.points, 0.5);
  const double middle = piece.u0 / 2 + piece.u1 / 2;
  return {MakePiece(piece.u0, middle, std::move(low)),
          MakePiece(middle, piece.u1, std::move(high))};
}

class CrossingFinder {
 public:
  CrossingFinder(const NurbsCurve<2>& a, const NurbsCurve<2>& b, double tolerance)
      : a_(a), b_(b), tolerance_(tolerance) {}

  std::vector<CurveCrossing> Find() {
    std::vector<std::pair<Piece, Piece>> pairs;
    const std::vector<Piece> pieces_b = PlanePieces(b_);
    for (const Piece& x : PlanePieces(a_)) {
      for (const Piece& y : pieces_b) {
        if (Apart(x, y)) continue;
        pairs.emplace_back(x, y);
        while (!pairs.empty()) {
          auto [p, q] = std::move(pairs.back());
          pairs.pop_back();
          if (++seen_ > kMostPairs) {
            throw std::invalid_argument("CurveCrossings: the curves run along each other");
          }
          Compare(p, q, pairs);
        }
      }
    }
    return std::move(found_);
  }

 private:
  bool Apart(const Piece& x, const Piece& y) const {
    return (x.box.min() - y.box.max()).maxCoeff() > tolerance_ ||
           (y.box.min() - x.box.max()).maxCoeff() > tolerance_;
  }

  void Compare(const Piece& x, const Piece& y, std::vector<std::pair<Piece, Piece>>& pairs) {
    if (Apart(x, y)) return;
    const double size_x = x.box.diagonal().norm(), size_y = y.box.diagonal().norm();
    constexpr double kStraight = 0.02, kLeastSine = 0.2;
    const double lengths = x.chord.norm() * y.chord.norm();
    const double sine = std::abs(x.chord[0] * y.chord[1] - x.chord[1] * y.chord[0]) / lengths;
    if (x.straightness < kStraight && y.straightness < kStraight && sine > kLeastSine) {
      Solve(x, y);
    } else if (std::max(size_x, size_y) <= tolerance_) {
      Add(x.u0 / 2 + x.u1 / 2, y.u0 / 2 + y.u1 / 2);
    } else if (size_x >= size_y) {
      const auto [low, high] = Halves(x);
      pairs.emplace_back(low, y);
      pairs.emplace_back(high, y);
    } else {
      const auto [low, high] = Halves(y);
      pairs.emplace_back(x, low);
      pairs.emplace_back(x, high);
    }
  }

  // Newton's method for a(s) = b(t), kept in the pieces; at their ends the nearest counts.
  void Solve(const Piece& x, const Piece& y) {
    double s = (x.u0 + x.u1) / 2, t = (y.u0 + y.u1) / 2;
    constexpr int kSteps = 20;
    for (int k = 0; k < kSteps; ++k) {
      const CurveJet<2> a = a_.JetAt(s), b = b_.JetAt(t);
      Eigen::Matrix2d jacobian;
      jacobian << a.first, -b.first;
      const Eigen::Vector2d step = jacobian.partialPivLu().solve(a.point - b.point);
      if (!step.allFinite()) return;
      const double next_s = std::clamp(s - step[0], x.u0, x.u1);
      const double next_t = std::clamp(t - step[1], y.u0, y.u1);
      if (next_s == s && next_t == t) break;
      s = next_s;
      t = next_t;
    }
    Add(s, t);
  }

  void Add(double s, double t) {
    const Eigen::Vector2d at = a_.At(s);
    if ((at - b_.At(t)).norm() > 2 * tolerance_) return;
    constexpr double kOne = 100;
    for (const CurveCrossing& one : found_) {
      if ((one.at - at).norm() <= kOne * tolerance_) return;
    }
    found_.push_back({s, t, at});
  }

  const NurbsCurve<2>&a_, &b_;
  double tolerance_;
  std::size_t seen_ = 0;
  std::vector<CurveCrossing> found_;
};

}  // namespace

std::vector<CurveCrossing> CurveCrossings(const NurbsCurve<2>& a,
                                          const NurbsCurve<2>& b,
                                          double tolerance) {
  return CrossingFinder(a, b, tolerance).Find();
}

}  // namespace batten::internal
