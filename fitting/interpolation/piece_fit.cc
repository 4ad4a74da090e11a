// SPDX-License-Identifier: MIT
#include "fitting/interpolation/piece_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;
template <int Dim>
using Points = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

constexpr Eigen::Index kSample = 64;  // points that determine the piece
constexpr int kRounds = 12;

// A Bézier curve of degree 2 or 3 with its first two derivatives, by its power form about the
// start: sums of w·(P − P₀) over sums of w.
template <int Dim>
class PieceCurve {
 public:
  explicit PieceCurve(const ChainPiece<Dim>& piece) : origin_(piece.points.col(0)) {
    const Eigen::Index p = piece.points.cols() - 1;
    Eigen::Matrix4d bernstein = Eigen::Matrix4d::Zero();  // column i: powers of u in B_i
    if (p == 2) {
      bernstein.topLeftCorner<3, 3>() << 1, 0, 0, -2, 2, 0, 1, -2, 1;
    } else {
      bernstein << 1, 0, 0, 0, -3, 3, 0, 0, 3, -6, 3, 0, -1, 3, -3, 1;
    }
    for (Eigen::Index i = 0; i <= p; ++i) {
      const double w = piece.weights[i];
      numerator_ += w * (piece.points.col(i) - origin_) * bernstein.col(i).transpose();
      denominator_ += w * bernstein.col(i);
    }
    rational_ = !(piece.weights.array() == 1).all();
  }

  struct Jet {
    Vector<Dim> point, first, second;
    double weight;
  };
  Jet At(double u) const {
    const Eigen::Vector4d t(1, u, u * u, u * u * u), d(0, 1, 2 * u, 3 * u * u), e(0, 0, 2, 6 * u);
    Jet jet{numerator_ * t, numerator_ * d, numerator_ * e, 1};
    if (rational_) {
      const double w = denominator_.dot(t), dw = denominator_.dot(d), ddw = denominator_.dot(e);
      jet.point /= w;
      jet.first = (jet.first - dw * jet.point) / w;
      jet.second = (jet.second - 2 * dw * jet.first - ddw * jet.point) / w;
      jet.weight = w;
    }
    jet.point += origin_;
    return jet;
  }

  // The parameter of a local minimum of the distance to q, by Newton's steps from u, kept inside.
  double Foot(const Vector<Dim>& q, double u) const {
    constexpr int kSteps = 8;
    for (int step = 0; step < kSteps; ++step) {
      const Jet jet = At(u);
      const Vector<Dim> miss = jet.point - q;
      const double slope = miss.dot(jet.first), speed = jet.first.squaredNorm();
      const double bend = speed + miss.dot(jet.second);
      const double next = std::clamp(u - slope / (bend > 0.1 * speed ? bend : speed), 0.0, 1.0);
      if (!(std::abs(next - u) > kRelativelyEqual)) break;
      u = next;
    }
    return u;
  }

 private:
  Vector<Dim> origin_;
  Eigen::Matrix<double, Dim, 4> numerator_ = Eigen::Matrix<double, Dim, 4>::Zero();
  Eigen::Vector4d denominator_ = Eigen::Vector4d::Zero();
  bool rational_;
};

// Chord lengths along the run from 0 to 1, of the inner points.
template <int Dim>
Eigen::VectorXd ChordParameters(const DirectedPoint<Dim>& start,
                                const DirectedPoint<Dim>& end,
                                const Points<Dim>& inner) {
  const Eigen::Index count = inner.cols();
  Eigen::VectorXd u(count);
  double sum = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    sum += (inner.col(k) - (k == 0 ? start.place : Vector<Dim>(inner.col(k - 1)))).norm();
    u[k] = sum;
  }
  return u / (sum + (end.place - inner.col(count - 1)).norm());
}

template <int Dim>
struct Sample {
  Points<Dim> points;
  Eigen::VectorXd u;
};

template <int Dim>
Sample<Dim> SampleOf(const Points<Dim>& inner, const Eigen::VectorXd& u) {
  const Eigen::Index count = inner.cols(), few = std::min(count, kSample);
  Sample<Dim> sample{Points<Dim>(Dim, few), Eigen::VectorXd(few)};
  for (Eigen::Index k = 0; k < few; ++k) {
    const Eigen::Index from = (2 * k + 1) * count / (2 * few);
    sample.points.col(k) = inner.col(from);
    sample.u[k] = u[from];
  }
  return sample;
}

// Moves the parameters to foot points; the root of the sum of squared distances.
template <int Dim>
double Project(const PieceCurve<Dim>& curve, Sample<Dim>& sample) {
  double squares = 0;
  for (Eigen::Index k = 0; k < sample.u.size(); ++k) {
    sample.u[k] = curve.Foot(sample.points.col(k), sample.u[k]);
    squares += (curve.At(sample.u[k]).point - sample.points.col(k)).squaredNorm();
  }
  return std::sqrt(squares);
}

// Foot points of the whole run on the nearest of its pieces, from the parameters u along the run;
// none if one is too far.
template <int Dim>
std::optional<FittedRun<Dim>> Judged(std::vector<ChainPiece<Dim>> pieces,
                                     const Points<Dim>& inner,
                                     const Eigen::VectorXd& u,
                                     double tolerance) {
  std::vector<PieceCurve<Dim>> curves(pieces.begin(), pieces.end());
  FittedRun<Dim> result{std::move(pieces), {}, 0};
  result.places.reserve(static_cast<size_t>(inner.cols()));
  for (Eigen::Index k = 0; k < inner.cols(); ++k) {
    typename FittedRun<Dim>::Place place{0, 0};
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < curves.size(); ++i) {
      const double start = static_cast<double>(curves.size()) * u[k] - static_cast<double>(i);
      const double foot = curves[i].Foot(inner.col(k), std::clamp(start, 0.0, 1.0));
      const double distance = (curves[i].At(foot).point - inner.col(k)).norm();
      if (distance < least) {
        least = distance;
        place = {static_cast<Eigen::Index>(i), foot};
      }
    }
    if (!(least <= tolerance)) return std::nullopt;
    result.places.push_back(place);
    result.largest = std::max(result.largest, least);
  }
  return result;
}

// Improves a piece by `improve`(piece, sample) in rounds while the sum of squares falls, and tests
// the best against the tolerance.
template <int Dim, typename Improve>
std::optional<FittedRun<Dim>> Fitted(ChainPiece<Dim> piece,
                                     const Points<Dim>& inner,
                                     const Eigen::VectorXd& u,
                                     double tolerance,
                                     const Improve& improve) {
  constexpr double kWorthwhile = 0.99;
  Sample<Dim> sample = SampleOf<Dim>(inner, u);
  ChainPiece<Dim> best = piece;
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kRounds; ++round) {
    const double miss = Project(PieceCurve<Dim>(piece), sample);
    const bool better = miss < kWorthwhile * least;
    if (miss < least) {
      least = miss;
      best = piece;
    }
    if (!better || !improve(piece, sample)) break;
  }
  return Judged<Dim>({std::move(best)}, inner, u, tolerance);
}

// The lengths α, β of the arms of a cubic, by least squares at the sample's parameters; none where
// one would point backwards or out of proportion.
template <int Dim>
std::optional<ChainPiece<Dim>> CubicAt(const DirectedPoint<Dim>& start,
                                       const DirectedPoint<Dim>& end,
                                       const Sample<Dim>& sample,
                                       double length) {
  Eigen::Matrix2d sums = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (Eigen::Index k = 0; k < sample.u.size(); ++k) {
    const double u = sample.u[k], v = 1 - u;
    const Vector<Dim> first = 3 * u * v * v * start.direction,
                      second = -3 * u * u * v * end.direction,
                      miss = sample.points.col(k) - start.place -
                             (3 * v + u) * u * u * (end.place - start.place);
    sums(0, 0) += first.squaredNorm();
    sums(0, 1) += first.dot(second);
    sums(1, 1) += second.squaredNorm();
    right += Eigen::Vector2d(first.dot(miss), second.dot(miss));
  }
  sums(1, 0) = sums(0, 1);
  const double determinant = sums.determinant();
  if (!(determinant > 1e-10 * sums(0, 0) * sums(1, 1))) return std::nullopt;
  const double alpha = (sums(1, 1) * right[0] - sums(0, 1) * right[1]) / determinant,
               beta = (sums(0, 0) * right[1] - sums(0, 1) * right[0]) / determinant;
  constexpr double kShortest = 0.02, kLongest = 2;  // of the run's length
  if (!(std::min(alpha, beta) > kShortest * length && std::max(alpha, beta) < kLongest * length)) {
    return std::nullopt;
  }
  ChainPiece<Dim> piece;
  piece.points.resize(Dim, 4);
  piece.points << start.place, start.place + alpha * start.direction,
      end.place - beta * end.direction, end.place;
  piece.weights = Eigen::Vector4d::Ones();
  return piece;
}

// A better weight of the conic's corner: one Gauss-Newton step for its logarithm, by the distances
// across the curve.
template <int Dim>
bool ImproveWeight(ChainPiece<Dim>& piece, const Sample<Dim>& sample) {
  const PieceCurve<Dim> curve(piece);
  const double w = piece.weights[1];
  double sum = 0, squares = 0;
  for (Eigen::Index k = 0; k < sample.u.size(); ++k) {
    const double u = sample.u[k];
    const auto jet = curve.At(u);
    const Vector<Dim> along = jet.first.normalized();
    Vector<Dim> change = 2 * u * (1 - u) * w / jet.weight * (piece.points.col(1) - jet.point);
    change -= along * along.dot(change);
    sum += change.dot(sample.points.col(k) - jet.point);
    squares += change.squaredNorm();
  }
  if (!(squares > 0)) return false;
  constexpr double kStep = 1, kLargest = 50;
  piece.weights[1] =
      std::clamp(w * std::exp(std::clamp(sum / squares, -kStep, kStep)), 1 / kLargest, kLargest);
  return piece.weights[1] != w;
}

}  // namespace

template <int Dim>
std::optional<FittedRun<Dim>> FitCubicRun(const DirectedPoint<Dim>& start,
                                          const DirectedPoint<Dim>& end,
                                          const Points<Dim>& inner,
                                          double tolerance) {
  const Eigen::VectorXd u = ChordParameters<Dim>(start, end, inner);
  Sample<Dim> sample = SampleOf<Dim>(inner, u);
  double length =
      (end.place - sample.points.rightCols(1)).norm() + (sample.points.col(0) - start.place).norm();
  for (Eigen::Index k = 1; k < sample.u.size(); ++k) {
    length += (sample.points.col(k) - sample.points.col(k - 1)).norm();
  }
  const auto first = CubicAt<Dim>(start, end, sample, length);
  if (!first) return std::nullopt;
  return Fitted<Dim>(*first, inner, u, tolerance, [&](ChainPiece<Dim>& piece, Sample<Dim>& at) {
    const auto next = CubicAt<Dim>(start, end, at, length);
    if (next) piece = *next;
    return next.has_value();
  });
}

template <int Dim>
std::optional<FittedRun<Dim>> FitConicRun(const DirectedPoint<Dim>& start,
                                          const DirectedPoint<Dim>& end,
                                          const Points<Dim>& inner,
                                          double tolerance) {
  const std::vector<ChainPiece<Dim>> arcs = ConicPieces<Dim>(start, end, true);
  const Eigen::VectorXd u = ChordParameters<Dim>(start, end, inner);
  if (arcs.size() > 1) return Judged<Dim>(arcs, inner, u, tolerance);
  return Fitted<Dim>(arcs[0], inner, u, tolerance, [](ChainPiece<Dim>& piece, Sample<Dim>& at) {
    return ImproveWeight<Dim>(piece, at);
  });
}

template std::optional<FittedRun<2>> FitCubicRun(const DirectedPoint<2>&,
                                                 const DirectedPoint<2>&,
                                                 const Eigen::Matrix2Xd&,
                                                 double);
template std::optional<FittedRun<3>> FitCubicRun(const DirectedPoint<3>&,
                                                 const DirectedPoint<3>&,
                                                 const Eigen::Matrix3Xd&,
                                                 double);
template std::optional<FittedRun<2>> FitConicRun(const DirectedPoint<2>&,
                                                 const DirectedPoint<2>&,
                                                 const Eigen::Matrix2Xd&,
                                                 double);
template std::optional<FittedRun<3>> FitConicRun(const DirectedPoint<3>&,
                                                 const DirectedPoint<3>&,
                                                 const Eigen::Matrix3Xd&,
                                                 double);

}  // namespace batten::internal
