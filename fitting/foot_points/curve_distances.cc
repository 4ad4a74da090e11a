// SPDX-License-Identifier: MIT
#include "fitting/foot_points/curve_distances.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "fitting/foot_points/curve_pieces.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr size_t kTogether = 16;  // pieces in a box

// Bounds of the curve and its derivatives over one span.
template <int Dim>
struct Piece {
  using Point = Eigen::Matrix<double, Dim, 1>;
  std::vector<Point> first;  // their hull holds C'
  double bend = 0;           // |C''| is no larger
  Point begin, end;          // the curve is no farther from their chord
  double swell = 0;          // than this
  bool joins_next = false;   // with a tangent in common
};

template <int Dim>
void Extend(Eigen::AlignedBox<double, Dim>& box, const Piece<Dim>& piece) {
  box.extend((piece.begin.cwiseMin(piece.end).array() - piece.swell).matrix());
  box.extend((piece.begin.cwiseMax(piece.end).array() + piece.swell).matrix());
}

// Coefficients of the derivative of spline coefficients of this degree over knots; those that some
// span needs only.
template <typename Points>
Points Differences(const std::vector<double>& knots, int degree, int level, const Points& from) {
  Points result = Points::Zero(from.rows(), from.cols() - 1);
  for (Eigen::Index j = 0; j < result.cols(); ++j) {
    const auto at = static_cast<size_t>(j + 1 + level);
    const double wide = knots[at + static_cast<size_t>(degree)] - knots[at];
    if (wide > 0) result.col(j) = degree / wide * (from.col(j + 1) - from.col(j));
  }
  return result;
}

template <int Dim>
std::vector<Piece<Dim>> PiecesOf(const NurbsCurve<Dim>& curve) {
  const SplineBasis& basis = curve.basis();
  const int p = basis.degree();
  const auto first = Differences(basis.knots(), p, 0, curve.control_points());
  auto second = first;
  if (p > 1) second = Differences(basis.knots(), p - 1, 1, first);
  const std::vector<int> spans = basis.Spans();
  std::vector<Piece<Dim>> pieces(spans.size());
  for (size_t i = 0; i < spans.size(); ++i) {
    Piece<Dim>& piece = pieces[i];
    const int span = spans[i];
    const double low = basis.knots()[static_cast<size_t>(span)],
                 high = basis.knots()[static_cast<size_t>(span) + 1];
    for (int j = span - p; j < span; ++j) piece.first.push_back(first.col(j));
    for (int j = span - p; p > 1 && j < span - 1; ++j)
      piece.bend = std::max(piece.bend, second.col(j).norm());
    piece.begin = curve.At(low);
    piece.end = i + 1 == spans.size() && basis.periodic() ? pieces.front().begin : curve.At(high);
    piece.swell = piece.bend * (high - low) * (high - low) / 8;
    const bool last = i + 1 == spans.size();
    piece.joins_next = last ? basis.periodic() && basis.Multiplicity(basis.lower()) < p
                            : basis.Multiplicity(high) < p;
  }
  return pieces;
}

// The pieces of a curve and, for each, the distance up to which a local foot point on it is
// provably the nearest.
template <int Dim>
class Certainty {
 public:
  Certainty(const NurbsCurve<Dim>& curve)
      : pieces_(PiecesOf(curve)), periodic_(curve.basis().periodic()) {
    for (size_t i = 0; i < pieces_.size(); ++i) sure_.push_back(Convex(i));
    LimitByOthers();
  }

  bool Holds(int piece, double distance, const Eigen::Matrix<double, Dim, 1>& q) const {
    const auto i = static_cast<size_t>(piece);
    if (!(distance < sure_[i])) return false;
    if (const auto k = Before(i); Touches(k, i) && !IsFarther(pieces_[k], distance, q))
      return false;
    const auto k = Behind(i);
    return !Touches(i, k) || IsFarther(pieces_[k], distance, q);
  }

 private:
  // Behind the last one where there is none.
  size_t Before(size_t i) const { return i > 0 ? i - 1 : pieces_.size() - (periodic_ ? 1 : 0); }
  size_t Behind(size_t i) const { return i + 1 == pieces_.size() && periodic_ ? 0 : i + 1; }
  bool IsPiece(size_t i) const { return i < pieces_.size(); }
  bool Joined(size_t i, size_t next) const {
    return IsPiece(i) && IsPiece(next) && pieces_[i].joins_next;
  }
  // At a corner.
  bool Touches(size_t i, size_t next) const {
    return IsPiece(i) && IsPiece(next) && !pieces_[i].joins_next;
  }

  static bool IsFarther(const Piece<Dim>& piece,
                        double distance,
                        const Eigen::Matrix<double, Dim, 1>& q) {
    const Eigen::Matrix<double, Dim, 1> chord = piece.end - piece.begin, from = q - piece.begin;
    const double square = chord.squaredNorm();
    const double t = square > 0 ? std::clamp(from.dot(chord) / square, 0.0, 1.0) : 0;
    return (from - t * chord).norm() - piece.swell >= distance;
  }

  // Condition (1), over the piece and those that go on from it.
  double Convex(size_t i) const {
    std::vector<size_t> around{i};
    if (Joined(Before(i), i)) around.push_back(Before(i));
    if (Joined(i, Behind(i))) around.push_back(Behind(i));
    const Eigen::Matrix<double, Dim, 1> along =
        (pieces_[i].end - pieces_[i].begin).stableNormalized();
    double least = kInfinity, most = 0, bend = 0;
    for (const size_t k : around) {
      for (const auto& first : pieces_[k].first) {
        least = std::min(least, first.dot(along));
        most = std::max(most, first.norm());
      }
      bend = std::max(bend, pieces_[k].bend);
    }
    if (!(least > 0)) return 0;
    // Bounds are computed with rounding.
    return bend > 0 ? (1 - kRelativelyEqual) * least * least / (bend * (1 + 2 * most / least))
                    : kInfinity;
  }

  // Condition (2).
  void LimitByOthers() {
    std::vector<Eigen::AlignedBox<double, Dim>> boxes(pieces_.size()), together;
    for (size_t i = 0; i < pieces_.size(); ++i) {
      Extend(boxes[i], pieces_[i]);
      if (i % kTogether == 0) together.emplace_back();
      Extend(together.back(), pieces_[i]);
    }
    for (size_t i = 0; i < pieces_.size(); ++i) {
      for (size_t b = 0; b < together.size(); ++b) {
        if (boxes[i].exteriorDistance(together[b]) >= 2 * sure_[i]) continue;
        const size_t end = std::min((b + 1) * kTogether, pieces_.size());
        for (size_t k = b * kTogether; k < end; ++k) {
          if (k == i || k == Before(i) || k == Behind(i)) continue;
          sure_[i] =
              std::min(sure_[i], (1 - kRelativelyEqual) / 2 * boxes[i].exteriorDistance(boxes[k]));
        }
      }
    }
  }

  std::vector<Piece<Dim>> pieces_;
  bool periodic_;
  std::vector<double> sure_;
};

// Accepts the points of one block whose foot point is provably the nearest, and marks them in
// `sure`.
template <int Dim>
void TakeSure(const CurvePieceTable& table,
              const Certainty<Dim>& certainty,
              const Eigen::Matrix3Xd& points,
              const Eigen::VectorXd& starts,
              std::ptrdiff_t begin,
              std::ptrdiff_t end,
              PointDistances& result,
              std::vector<char>& sure) {
  const std::ptrdiff_t count = end - begin;
  const Eigen::Matrix<double, Dim, Eigen::Dynamic> q =
      points.middleCols(begin, count).template topRows<Dim>();
  const Eigen::ArrayXd given = starts.segment(begin, count);
  const Eigen::ArrayXd from = given.isNaN().select(table.breaks[0], given);
  double u[kPointsPerTask], squares[kPointsPerTask];
  int piece[kPointsPerTask];
  LocalCurveFootPoints(table, q.data(), from.data(), count, {u, squares, piece});
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    if (piece[k] < 0 || std::isnan(given[k])) continue;
    const double distance = std::sqrt(squares[k]);
    if (!certainty.Holds(piece[k], distance, q.col(k))) continue;
    result.distances[begin + k] = distance;
    result.parameters(0, begin + k) = u[k];
    sure[static_cast<size_t>(begin + k)] = 1;
  }
}

}  // namespace

template <int Dim>
PointDistances DistancesNear(const NurbsCurve<Dim>& curve,
                             const Eigen::Matrix3Xd& points,
                             const Eigen::VectorXd& starts,
                             ThreadPool& pool) {
  if (!CurvePieces<Dim>::Covers(curve)) return DistancesTo<Dim>(curve, points, pool);
  const CurvePieces<Dim> pieces(curve);
  const CurvePieceTable table = pieces.table();
  const Certainty<Dim> certainty(curve);
  PointDistances result{Eigen::VectorXd(points.cols()), Eigen::MatrixXd(1, points.cols())};
  std::vector<char> sure(static_cast<size_t>(points.cols()), 0);
  pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    TakeSure<Dim>(table, certainty, points, starts, begin, end, result, sure);
  });
  std::vector<Eigen::Index> others;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (sure[static_cast<size_t>(k)] == 0) others.push_back(k);
  }
  if (others.empty()) return result;
  const PointDistances searched = DistancesTo<Dim>(curve, points(Eigen::all, others), pool);
  result.distances(others) = searched.distances;
  result.parameters(Eigen::all, others) = searched.parameters;
  return result;
}

template PointDistances DistancesNear<2>(const NurbsCurve<2>&,
                                         const Eigen::Matrix3Xd&,
                                         const Eigen::VectorXd&,
                                         ThreadPool&);
template PointDistances DistancesNear<3>(const NurbsCurve<3>&,
                                         const Eigen::Matrix3Xd&,
                                         const Eigen::VectorXd&,
                                         ThreadPool&);

}  // namespace batten::internal
