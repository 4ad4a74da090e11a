// SPDX-License-Identifier: MIT
#include "fitting/corners/kink_window.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace batten::internal {
namespace {

using Eigen::Index;
using Eigen::RowVector3d;

// Vectors over a window's means, without allocation.
using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostMeans, 1>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMostMeans, 3>;

// Squared standard deviations of the noise by which the kink must leave less than …
constexpr double kOverCubic = 8, kPerChance = 2;  // and so much more for each e-fold of places
constexpr double kOverQuartic = 3;                // with half of that
constexpr double kSurelyTurns = 25;
constexpr double kOverSextic = 6, kUnderRound = 4.5;
constexpr double kUnderCubic = 6, kUnderQuartic = 8;  // in windows too narrow to tell
constexpr double kPoorest = 1.45;   // of the noise's variance: beyond, the shape is another
constexpr double kKinkReach = 0.5;  // of the half window: where the kink is searched for
constexpr int kTried = 33;

// By how much a turn over a quarter of the window and over a sixth must leave more than the kink.
struct Sharpness {
  double over_half, over_third;
};
constexpr Sharpness kBent{40, 20};  // sides that bend imitate a kink
constexpr Sharpness kLines{12, 8};  // between straight lines less is free
constexpr double kStraight = 9;     // that parabolas may leave less than lines

struct Residuals {
  double squares, noise;
};

// Weighted least squares in t ∈ [−1, 1] by functions made orthonormal one by one.
class Fits {
 public:
  explicit Fits(const KinkWindow& window, int degree = 2) {
    const auto m = static_cast<Index>(window.u.size());
    low_ = window.u.front();
    half_ = 0.5 * (window.u.back() - low_);
    t_.resize(m);
    root_.resize(m);
    rest_.resize(m, 3);
    Values power = Values::Ones(m);
    for (Index k = 0; k < m; ++k) {
      const auto i = static_cast<size_t>(k);
      t_[k] = (window.u[i] - low_) / half_ - 1;
      root_[k] = std::sqrt(window.n[i]);
      rest_.row(k) = root_[k] * window.p[i].transpose();
    }
    data_ = rest_;
    for (functions_ = 0; functions_ <= degree;) {
      Values column = Orthogonal(power);
      column /= column.norm();
      basis_[functions_++] = column;
      rest_ -= column * (column.transpose() * rest_);
      power = power.cwiseProduct(t_);
    }
    squares_ = rest_.squaredNorm();
  }

  Index size() const { return t_.size(); }
  double half() const { return half_; }
  double Place(double u) const { return (u - low_) / half_ - 1; }
  double Parameter(double t) const { return low_ + half_ * (t + 1); }

  // Of the function's values, what is left besides the parabolas.
  Values Orthogonal(const Values& values) const {
    Values column = root_.cwiseProduct(values);
    for (int i = 0; i < functions_; ++i) column -= basis_[i] * basis_[i].dot(column);
    return column;
  }

  double Squares() const { return squares_; }

  // Sum of squared residuals of a parabola and this function. What is left of the data is
  // orthogonal to the parabolas already.
  double SquaresWith(const Values& values) const {
    const Values column = root_.cwiseProduct(values);
    double norm = column.squaredNorm();
    for (int i = 0; i < functions_; ++i) {
      const double part = basis_[i].dot(column);
      norm -= part * part;
    }
    if (!(norm > 1e-12 * static_cast<double>(size()))) return Squares();
    return Squares() - (column.transpose() * rest_).squaredNorm() / norm;
  }

  // Sums of squared residuals of polynomials of degrees 3 … 6.
  std::array<double, 4> SquaresOfPolynomials() const {
    std::array<double, 4> squares;
    std::array<Values, 4> basis;
    size_t functions = 0;
    double rest = Squares();
    Values power = t_.cwiseProduct(t_);
    for (size_t i = 0; i < squares.size(); ++i) {
      power = power.cwiseProduct(t_);
      Values column = Orthogonal(power);
      for (size_t j = 0; j < functions; ++j) column -= basis[j] * basis[j].dot(column);
      const double norm = column.norm();
      if (norm > 1e-9) {
        basis[functions] = column / norm;
        rest -= (basis[functions++].transpose() * rest_).squaredNorm();
      }
      squares[i] = rest;
    }
    return squares;
  }

  // A straight turn from 0 to slope 1 at s, over `width`.
  Values Turn(double s, double width) const {
    Values values(size());
    for (Index k = 0; k < size(); ++k) {
      const double x = t_[k] - s, from = x + width / 2;
      values[k] = from <= 0 ? 0 : x >= width / 2 ? x : from * from / (2 * width);
    }
    return values;
  }

  // What a parabola and this function leave: mean square, and the noise that neighbours show.
  Residuals ResidualsOf(const Values& values, double noise) const {
    Values column = Orthogonal(values);
    column /= column.norm();
    const Rows left = rest_ - column * (column.transpose() * rest_);
    const Index steps = size() - 1;
    const double differences = (left.bottomRows(steps) - left.topRows(steps)).squaredNorm();
    const double plane = 2;  // dimensions in which noise shows
    return {left.squaredNorm() / (plane * static_cast<double>(size() - 4) - 1),
            std::max(noise, std::sqrt(0.5 * differences / (plane * static_cast<double>(steps))))};
  }

  // Coefficients of 1, t, t² and the turn, one a row.
  Eigen::Matrix<double, 4, 3> Coefficients(const Values& turn) const {
    Eigen::Matrix<double, Eigen::Dynamic, 4, 0, kMostMeans, 4> columns(size(), 4);
    columns << root_, root_.cwiseProduct(t_), root_.cwiseProduct(t_.cwiseAbs2()),
        root_.cwiseProduct(turn);
    return columns.householderQr().solve(data_);
  }

 private:
  double low_ = 0, half_ = 0;
  Values t_, root_;
  Rows rest_, data_;
  std::array<Values, 3> basis_;
  int functions_ = 0;
  double squares_ = 0;  // of the rest
};

struct Best {
  double s = 0, squares = std::numeric_limits<double>::infinity();
  bool inside = false;  // not at an end of the range searched
};

// Sought around `middle`, in a range that leaves half of the shorter side outside.
Best BestTurn(const Fits& fits, double middle, double width) {
  const double reach = kKinkReach * (1 - std::abs(middle));
  Best best;
  int at = 0;
  std::array<double, kTried> squares;
  for (int i = 0; i < kTried; ++i) {
    const double s = middle + reach * (2.0 * i / (kTried - 1) - 1);
    squares[i] = fits.SquaresWith(fits.Turn(s, width));
    if (squares[i] < best.squares) {
      best = {s, squares[i], i > 0 && i + 1 < kTried};
      at = i;
    }
  }
  if (!best.inside) return best;
  const double step = 2 * reach / (kTried - 1);
  const double left = squares[at - 1], right = squares[at + 1],
               bend = left - 2 * best.squares + right;
  if (bend > 0) {
    const double s = best.s + 0.5 * step * (left - right) / bend;
    const double value = fits.SquaresWith(fits.Turn(s, width));
    if (value < best.squares) best = {s, value, true};
  }
  return best;
}

// Whether turns that take a part of the window leave more than the kink, which leaves `over`.
bool IsSharp(
    const Fits& fits, double middle, double over, const Sharpness& least, double variance) {
  return BestTurn(fits, middle, 0.5).squares - over >= least.over_half * variance &&
         BestTurn(fits, middle, 0.35).squares - over >= least.over_third * variance &&
         BestTurn(fits, middle, 1).squares - over >= least.over_half * variance;
}

double RoundedSquares(const Fits& fits, double middle) {
  double least = std::numeric_limits<double>::infinity();
  for (const double width : {0.12, 0.25, 0.35})
    least = std::min(least, BestTurn(fits, middle, width).squares);
  return least;
}

}  // namespace

PointClass KinkOf(
    const KinkWindow& window, double at, double noise, double least_angle, double chances) {
  const Fits fits(window);
  const double middle = fits.Place(at);
  const Best sharp = BestTurn(fits, middle, 0);
  PointClass verdict;
  verdict.kink.parameter = fits.Parameter(sharp.s);
  if (!sharp.inside) return verdict;
  const Eigen::Matrix<double, 4, 3> c = fits.Coefficients(fits.Turn(sharp.s, 0));
  const RowVector3d before = c.row(1) + 2 * sharp.s * c.row(2), after = before + c.row(3);
  const double angle = std::atan2(before.cross(after).norm(), before.dot(after));
  if (!(angle >= least_angle)) return verdict;

  const Residuals left = fits.ResidualsOf(fits.Turn(sharp.s, 0), noise);
  const std::array<double, 4> smooth = fits.SquaresOfPolynomials();
  verdict.turns = smooth[0] - sharp.squares > kSurelyTurns * noise * noise;
  if (left.squares > kPoorest * left.noise * left.noise) return verdict;
  const double variance = left.noise * left.noise;
  const double over = sharp.squares;
  if (smooth[0] - over < (kOverCubic + kPerChance * chances) * variance) return verdict;
  if (smooth[1] - over < (kOverQuartic + 0.5 * kPerChance * chances) * variance) return verdict;
  if (smooth[3] - over < kOverSextic * variance) return verdict;
  if (RoundedSquares(fits, middle) - over < -kUnderRound * variance) return verdict;
  if (!IsSharp(fits, middle, over, kBent, variance)) {
    const Fits lines(window, 1);
    const double straight = BestTurn(lines, middle, 0).squares;
    if (straight - over > kStraight * variance) return verdict;
    if (!IsSharp(lines, middle, straight, kLines, variance)) return verdict;
  }
  const RowVector3d place = c.row(0) + sharp.s * c.row(1) + sharp.s * sharp.s * c.row(2);
  verdict.corner = true;
  verdict.kink = {fits.Parameter(sharp.s), angle, fits.half(), over, place.transpose()};
  return verdict;
}

bool IsSmoother(const KinkWindow& window, double at, double noise) {
  const Fits fits(window);
  const double sharp = fits.SquaresWith(fits.Turn(fits.Place(at), 0));
  const std::array<double, 4> smooth = fits.SquaresOfPolynomials();
  const double scatter = fits.ResidualsOf(fits.Turn(fits.Place(at), 0), noise).noise,
               variance = scatter * scatter;
  return sharp - smooth[0] > kUnderCubic * variance || sharp - smooth[1] > kUnderQuartic * variance;
}

}  // namespace batten::internal
