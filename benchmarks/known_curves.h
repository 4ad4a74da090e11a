// SPDX-License-Identifier: MIT
// Curves given by formulas, clouds along them, and how near a fitted curve comes to its formula.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace batten::internal {

// A place of a formula with its derivatives.
struct FormulaJet {
  Eigen::Vector3d point, first, second;
};

enum class FormulaEnds {
  kOpen,    // what lies beyond an end has no foot
  kClosed,  // periodic
  kCorner,  // another piece begins there
};

struct FormulaPiece {
  std::function<FormulaJet(double)> at;
  double lower, upper;
  FormulaEnds ends;
};

struct KnownCurve {
  std::string name;
  int dimension;
  std::vector<FormulaPiece> pieces;  // in order; parameters run from one into the next
};

// radius(a)·(cos a, sin a) and a height; each function gives value, first and second derivative.
inline FormulaJet Polar(double a, const Eigen::Vector3d& radius, const Eigen::Vector3d& height) {
  const Eigen::Vector3d out(std::cos(a), std::sin(a), 0), on(-std::sin(a), std::cos(a), 0);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  return {radius[0] * out + height[0] * up,
          radius[1] * out + radius[0] * on + height[1] * up,
          (radius[2] - radius[0]) * out + 2 * radius[1] * on + height[2] * up};
}

// (1 + 0.3 cos 10πt)·(cos 6πt, sin 6πt), height 2t, by the angle a = 6πt.
inline KnownCurve WavyHelix() {
  const auto at = [](double a) {
    constexpr double kWave = 5.0 / 3, kRise = 1 / (3 * std::numbers::pi);
    const double c = 0.3 * std::cos(kWave * a), s = 0.3 * std::sin(kWave * a);
    return Polar(a, {1 + c, -kWave * s, -kWave * kWave * c}, {kRise * a, kRise, 0});
  };
  return {"helix", 3, {{at, 0, 6 * std::numbers::pi, FormulaEnds::kOpen}}};
}

inline KnownCurve ClosedFlower() {
  const auto at = [](double a) {
    return Polar(a,
                 {1 + 0.25 * std::cos(5 * a) + 0.1 * std::sin(2 * a),
                  -1.25 * std::sin(5 * a) + 0.2 * std::cos(2 * a),
                  -6.25 * std::cos(5 * a) - 0.4 * std::sin(2 * a)},
                 Eigen::Vector3d::Zero());
  };
  return {"flower", 2, {{at, 0, 2 * std::numbers::pi, FormulaEnds::kClosed}}};
}

inline FormulaPiece Segment(const Eigen::Vector3d& from,
                            const Eigen::Vector3d& along,
                            FormulaEnds ends) {
  return {[from, along](double t) {
            return FormulaJet{from + t * along, along, Eigen::Vector3d::Zero()};
          },
          0,
          1,
          ends};
}

inline KnownCurve UnitSquare() {
  const Eigen::Vector3d corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  KnownCurve square{"square", 2, {}};
  for (int k = 0; k < 4; ++k) {
    square.pieces.push_back(
        Segment(corners[k], corners[(k + 1) % 4] - corners[k], FormulaEnds::kCorner));
  }
  return square;
}

inline KnownCurve StraightLine() {
  return {"line", 3, {Segment({1, -2, 0.5}, {2, 1, -0.7}, FormulaEnds::kOpen)}};
}

// Radius 2, all the way round or a part.
inline KnownCurve CircleArc(double degrees) {
  const auto at = [](double a) { return Polar(a, {2, 0, 0}, Eigen::Vector3d::Zero()); };
  const bool full = degrees == 360;
  return {full ? "circle" : "arc",
          2,
          {{at,
            0,
            degrees * std::numbers::pi / 180,
            full ? FormulaEnds::kClosed : FormulaEnds::kOpen}}};
}

inline KnownCurve EllipseArc() {
  const auto at = [](double a) {
    const Eigen::Vector3d point(2 * std::cos(a), std::sin(a), 0);
    return FormulaJet{point, {-2 * std::sin(a), std::cos(a), 0}, -point};
  };
  return {"ellipse arc", 2, {{at, 0.2, 2.2, FormulaEnds::kOpen}}};
}

inline KnownCurve HyperbolaArc() {
  const auto at = [](double a) {
    const Eigen::Vector3d point(std::cosh(a), 0.5 * std::sinh(a), 0);
    return FormulaJet{point, {std::sinh(a), 0.5 * std::cosh(a), 0}, point};
  };
  return {"hyperbola arc", 2, {{at, -1, 1.5, FormulaEnds::kOpen}}};
}

// The place at a share of the parameters, 0 … 1.
inline Eigen::Vector3d PlaceAt(const KnownCurve& curve, double share) {
  double all = 0;
  for (const FormulaPiece& piece : curve.pieces) all += piece.upper - piece.lower;
  double left = share * all;
  for (const FormulaPiece& piece : curve.pieces) {
    const double length = piece.upper - piece.lower;
    if (left <= length) return piece.at(piece.lower + left).point;
    left -= length;
  }
  return curve.pieces.back().at(curve.pieces.back().upper).point;
}

struct CurveCloudKind {
  Eigen::Index count;
  double sigma;
  double outliers =
      0;  // this share of the points lies anywhere in the box, a tenth wider all round
  bool ordered = true;  // evenly along the curve, both ends included; else at random
};

inline Eigen::Matrix3Xd CloudAlong(const KnownCurve& curve,
                                   const CurveCloudKind& kind,
                                   std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 1);
  const bool open = curve.pieces.front().ends == FormulaEnds::kOpen;
  const auto steps = static_cast<double>(kind.count - (open ? 1 : 0));
  Eigen::Matrix3Xd points(3, kind.count);
  for (Eigen::Index k = 0; k < kind.count; ++k) {
    const double share = kind.ordered ? static_cast<double>(k) / steps : uniform(engine);
    points.col(k) = PlaceAt(curve, share);
  }
  const Eigen::Vector3d low = points.rowwise().minCoeff();
  const Eigen::Vector3d size = points.rowwise().maxCoeff() - low;
  for (auto point : points.colwise()) {
    const bool astray = kind.outliers > 0 && uniform(engine) < kind.outliers;
    for (int d = 0; d < curve.dimension; ++d) {
      if (astray) {
        point[d] = low[d] + (1.2 * uniform(engine) - 0.1) * size[d];
      } else {
        point[d] += kind.sigma * normal(engine);
      }
    }
  }
  return points;
}

// The distance of a point from the curve by Newton's iteration from the nearest of many places;
// NaN where the foot is beyond an open end.
class FormulaDistance {
 public:
  explicit FormulaDistance(const KnownCurve& curve) : curve_(curve) {
    for (const FormulaPiece& piece : curve.pieces) {
      Eigen::Matrix3Xd places(3, kPlaces + 1);
      for (int k = 0; k <= kPlaces; ++k) places.col(k) = piece.at(At(piece, k)).point;
      places_.push_back(std::move(places));
    }
  }

  double operator()(const Eigen::Vector3d& q) const {
    double least = std::numeric_limits<double>::infinity();
    bool beyond = false;
    for (size_t i = 0; i < places_.size(); ++i) {
      const FormulaPiece& piece = curve_.pieces[i];
      int nearest = 0;
      (places_[i].colwise() - q).colwise().squaredNorm().minCoeff(&nearest);
      double t = Foot(piece, At(piece, nearest), q);
      const bool outside = t < piece.lower || t > piece.upper;
      if (piece.ends == FormulaEnds::kCorner) t = std::clamp(t, piece.lower, piece.upper);
      const double distance = (piece.at(t).point - q).norm();
      if (distance >= least) continue;
      least = distance;
      beyond = outside && piece.ends == FormulaEnds::kOpen;
    }
    return beyond ? std::numeric_limits<double>::quiet_NaN() : least;
  }

 private:
  static constexpr int kPlaces = 3000, kSteps = 30;

  static double At(const FormulaPiece& piece, int k) {
    return piece.lower + (piece.upper - piece.lower) * k / kPlaces;
  }

  // Newton's step where the square of the distance is convex, else Gauss' and Newton's; none
  // uphill.
  static double Foot(const FormulaPiece& piece, double t, const Eigen::Vector3d& q) {
    FormulaJet jet = piece.at(t);
    for (int step = 0; step < kSteps; ++step) {
      const Eigen::Vector3d offset = jet.point - q;
      const double slope = offset.dot(jet.first), square = jet.first.squaredNorm();
      const double bend = square + offset.dot(jet.second);
      const double next = t - slope / (bend > 0.1 * square ? bend : square);
      FormulaJet there = piece.at(next);
      if (!((there.point - q).norm() < offset.norm())) break;
      t = next;
      jet = std::move(there);
    }
    return t;
  }

  KnownCurve curve_;
  std::vector<Eigen::Matrix3Xd> places_;
};

// From the formula: root of the mean square along the fitted curve, the largest, and back: the
// largest distance of a place of the formula from the fitted curve.
struct TruthError {
  double rms = 0, max = 0, back = 0;
};

// The fitted curve as a polyline of many points.
inline TruthError ErrorAgainst(const KnownCurve& curve, const Eigen::Matrix3Xd& line) {
  const FormulaDistance distance(curve);
  TruthError error;
  double squares = 0, length = 0;
  for (Eigen::Index k = 0; k < line.cols(); ++k) {
    const double d = distance(line.col(k));
    if (std::isnan(d)) continue;
    double weight = 0;
    if (k > 0) weight += (line.col(k) - line.col(k - 1)).norm();
    if (k + 1 < line.cols()) weight += (line.col(k + 1) - line.col(k)).norm();
    squares += weight * d * d;
    length += weight;
    error.max = std::max(error.max, d);
  }
  error.rms = length > 0 ? std::sqrt(squares / length) : 0;

  constexpr int kPlaces = 1000;
  const Eigen::Index chords = line.cols() - 1;
  const Eigen::Matrix3Xd along = line.rightCols(chords) - line.leftCols(chords);
  const Eigen::RowVectorXd squared =
      along.colwise().squaredNorm().cwiseMax(std::numeric_limits<double>::min());
  for (int k = 0; k <= kPlaces; ++k) {
    const Eigen::Vector3d q = PlaceAt(curve, static_cast<double>(k) / kPlaces);
    const Eigen::Matrix3Xd offset = (-line.leftCols(chords)).colwise() + q;
    const Eigen::RowVectorXd share =
        (offset.cwiseProduct(along).colwise().sum().array() / squared.array()).max(0.0).min(1.0);
    const double nearest = (offset - along * share.asDiagonal()).colwise().squaredNorm().minCoeff();
    error.back = std::max(error.back, std::sqrt(nearest));
  }
  return error;
}

}  // namespace batten::internal
