// SPDX-License-Identifier: MIT
#include "fitting/interpolation/tangent_pieces.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;

constexpr double kShortest = 0.01;  // sides of a triangle, of the chord
constexpr double kLongest = 2;      // 150° of a circle

template <int Dim>
ChainPiece<Dim> Arc(const Vector<Dim>& a,
                    const Vector<Dim>& corner,
                    const Vector<Dim>& b,
                    double w) {
  ChainPiece<Dim> piece;
  piece.points.resize(Dim, 3);
  piece.points << a, corner, b;
  piece.weights = Eigen::Vector3d(1, w, 1);
  return piece;
}

// The weight of the arc whose shoulder is the middle of those where the bisectors at either end
// meet the line from the chord's middle to the corner.
template <int Dim>
double ShoulderWeight(const Vector<Dim>& a, const Vector<Dim>& corner, const Vector<Dim>& b) {
  const double half = (b - a).norm() / 2, before = (corner - a).norm(),
               behind = (b - corner).norm();
  const double part = (half / (half + before) + half / (half + behind)) / 2;
  return part / (1 - part);
}

// The point where the tangents at both ends meet, ahead of the first and behind the second: the
// corner of a conic arc's control triangle. None where they do not lie in a plane, meet on the
// wrong side, or so that the arc would turn by more than 150° or shrink to a corner. Straight on:
// the middle.
template <int Dim>
std::optional<Vector<Dim>> TangentCorner(const DirectedPoint<Dim>& start,
                                         const DirectedPoint<Dim>& end) {
  const Vector<Dim> chord = end.place - start.place;
  const double length = chord.norm();
  const Vector<Dim> e = chord / length;
  const double along = start.direction.dot(e), behind = end.direction.dot(e);
  const Vector<Dim> across = start.direction - along * e, beyond = end.direction - behind * e;
  const double a = across.norm(), b = beyond.norm();
  if (a <= kRelativelyEqual && b <= kRelativelyEqual && along > 0 && behind > 0) {
    return Vector<Dim>(start.place + chord / 2);
  }
  // Both sides rise equally high above the chord, in one plane with it.
  if (!(a > 0 && b > 0) || (across / a + beyond / b).norm() * std::min(a, b) > kRelativelyEqual) {
    return std::nullopt;
  }
  const double turn = along * b + behind * a;  // sine of the whole turn, less than 180° above 0
  if (!(turn > 0)) return std::nullopt;
  const double first = b / turn, second = a / turn;  // sides, of the chord
  if (std::min(first, second) < kShortest || std::max(first, second) > kLongest) {
    return std::nullopt;
  }
  return Vector<Dim>(start.place + first * length * start.direction);
}

}  // namespace

template <int Dim>
std::vector<ChainPiece<Dim>> ConicPieces(const DirectedPoint<Dim>& start,
                                         const DirectedPoint<Dim>& end,
                                         bool rational) {
  const auto weight = [&](const Vector<Dim>& a, const Vector<Dim>& corner, const Vector<Dim>& b) {
    return rational ? ShoulderWeight<Dim>(a, corner, b) : 1;
  };
  const Vector<Dim> chord = end.place - start.place;
  const double length = chord.norm();
  if (const auto corner = TangentCorner(start, end)) {
    const bool straight = (*corner - start.place - chord / 2).norm() <= kRelativelyEqual * length;
    const double w = straight ? 1 : weight(start.place, *corner, end.place);
    return {Arc<Dim>(start.place, *corner, end.place, w)};
  }
  // Sides of half a circle's arc where both angles agree.
  const double at_start = start.direction.dot(chord) / length,
               at_end = end.direction.dot(chord) / length;
  constexpr double kLeast = 0.1;  // against long tails where the curve turns round
  const double before = length / 2 / std::max(kLeast, 1 + (at_start + 2 * at_end) / 3);
  const double behind = length / 2 / std::max(kLeast, 1 + (2 * at_start + at_end) / 3);
  const Vector<Dim> first = start.place + before * start.direction,
                    second = end.place - behind * end.direction,
                    joint = first + before / (before + behind) * (second - first);
  return {Arc<Dim>(start.place, first, joint, weight(start.place, first, joint)),
          Arc<Dim>(joint, second, end.place, weight(joint, second, end.place))};
}

// α of 36|D|² − 12 α D·(T₀+T₁) + α²|T₀+T₁|² = 16 α²: speed α at the ends and in the middle.
template <int Dim>
ChainPiece<Dim> CubicPiece(const DirectedPoint<Dim>& start, const DirectedPoint<Dim>& end) {
  const Vector<Dim> chord = end.place - start.place;
  const double length = chord.norm();
  const Vector<Dim> sum = start.direction + end.direction;
  const double a = 16 - sum.squaredNorm(), b = 6 * sum.dot(chord) / length;
  const double alpha = length * 36 / (b + std::sqrt(b * b + 36 * a));
  ChainPiece<Dim> piece;
  piece.points.resize(Dim, 4);
  piece.points << start.place, start.place + alpha / 3 * start.direction,
      end.place - alpha / 3 * end.direction, end.place;
  piece.weights = Eigen::Vector4d::Ones();
  return piece;
}

template std::vector<ChainPiece<2>> ConicPieces(const DirectedPoint<2>&,
                                                const DirectedPoint<2>&,
                                                bool);
template std::vector<ChainPiece<3>> ConicPieces(const DirectedPoint<3>&,
                                                const DirectedPoint<3>&,
                                                bool);
template ChainPiece<2> CubicPiece(const DirectedPoint<2>&, const DirectedPoint<2>&);
template ChainPiece<3> CubicPiece(const DirectedPoint<3>&, const DirectedPoint<3>&);

}  // namespace batten::internal
