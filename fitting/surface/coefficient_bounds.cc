// SPDX-License-Identifier: MIT
#include "fitting/surface/coefficient_bounds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "fitting/least_squares/fitting_bases.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten::internal {
namespace {

constexpr double kOfAll =
    0.2;  // share of the range of all heights by which a coefficient leaves it
constexpr char kAllQuarters = 15;
constexpr std::size_t kLeastData = 4;  // in a support, else it grows

// The knot spans of one direction, the spans each function acts on, and its margin.
struct Axis {
  std::vector<double> breaks;           // ends of the spans, ascending
  std::vector<std::vector<int>> spans;  // of each function, ascending but across a seam
  std::vector<double> reach;            // greatest polar value of a polynomial within ±1
  bool periodic;

  int size() const { return static_cast<int>(breaks.size()) - 1; }
  bool IsUpperHalf(double u) const {
    const auto span = static_cast<size_t>(SpanAt(u));
    return 2 * u > breaks[span] + breaks[span + 1];
  }
  int SpanAt(double u) const {
    const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, u);
    return static_cast<int>(above - breaks.begin()) - 1;
  }
};

// The polar form of the Chebyshev polynomial T_degree over [a, b] at some arguments. By the
// recursion of symmetric functions: the polar form of x^k is e_k over the binomial coefficient.
double ChebyshevPolar(int degree, double a, double b, const std::vector<double>& at) {
  const auto count = at.size();
  std::vector<double> symmetric(count + 1, 0);  // e_0 … e_count of the scaled arguments
  symmetric[0] = 1;
  for (size_t k = 0; k < count; ++k) {
    const double x = (2 * at[k] - a - b) / (b - a);
    for (size_t i = k + 1; i > 0; --i) symmetric[i] += x * symmetric[i - 1];
  }
  std::vector<double> last{1}, next{0, 1};  // coefficients of T_0 and T_1
  if (degree == 0) next = last;
  for (int k = 1; k < degree; ++k) {
    std::vector<double> after(next.size() + 1, 0);
    for (size_t i = 0; i < next.size(); ++i) after[i + 1] += 2 * next[i];
    for (size_t i = 0; i < last.size(); ++i) after[i] -= last[i];
    last = std::move(next);
    next = std::move(after);
  }
  double sum = 0, binomial = 1;
  for (size_t k = 0; k < next.size(); ++k) {
    sum += next[k] * symmetric[k] / binomial;
    binomial *= static_cast<double>(count - k) / static_cast<double>(k + 1);
  }
  return sum;
}

Axis AxisOf(const SplineBasis& basis) {
  Axis axis;
  axis.periodic = basis.periodic();
  const std::vector<double>& knots = basis.knots();
  axis.breaks = BreaksIn(basis);
  const int p = basis.degree();
  const double period = basis.upper() - basis.lower();
  for (int i = 0; i < basis.size(); ++i) {
    const double first = knots[static_cast<size_t>(i)],
                 last = knots[static_cast<size_t>(i + p + 1)];
    std::vector<int> spans;
    for (int shift = axis.periodic ? -1 : 0; shift <= (axis.periodic ? 1 : 0); ++shift) {
      for (int k = 0; k < axis.size(); ++k) {
        const double low = axis.breaks[static_cast<size_t>(k)] + shift * period,
                     high = axis.breaks[static_cast<size_t>(k) + 1] + shift * period;
        if (low < last && high > first) spans.push_back(k);
      }
    }
    axis.spans.push_back(std::move(spans));
    const double a = axis.periodic ? first : std::max(first, basis.lower()),
                 b = axis.periodic ? last : std::min(last, basis.upper());
    const std::vector<double> inside(knots.begin() + i + 1, knots.begin() + i + 1 + p);
    double reach = 1;
    for (int degree = 1; degree <= p; ++degree)
      reach = std::max(reach, std::abs(ChebyshevPolar(degree, a, b, inside)));
    axis.reach.push_back(reach);
  }
  return axis;
}

// Data sorted by cells.
class Cells {
 public:
  Cells(const FittingProblem& problem, const Axis& u, const Axis& v)
      : u_(u),
        v_(v),
        first_(static_cast<size_t>(u.size()) * v.size() + 1, 0),
        filled_(first_.size() - 1, 0) {
    const FittingData& data = problem.data();
    in_space_ = data.values.rows() == 3;
    const auto counts = [&](Eigen::Index k) { return WeightOf(data, k) > 0; };
    std::vector<size_t> cell(static_cast<size_t>(problem.size()));
    for (Eigen::Index k = 0; k < problem.size(); ++k) {
      if (!counts(k)) continue;
      cell[static_cast<size_t>(k)] =
          At(u.SpanAt(data.parameters(0, k)), v.SpanAt(data.parameters(1, k)));
      ++first_[cell[static_cast<size_t>(k)] + 1];
      const int quarter =
          2 * u.IsUpperHalf(data.parameters(0, k)) + v.IsUpperHalf(data.parameters(1, k));
      filled_[cell[static_cast<size_t>(k)]] |= static_cast<char>(1 << quarter);
    }
    const auto across = static_cast<size_t>(v.size());
    below_.assign((static_cast<size_t>(u.size()) + 1) * (across + 1), 0);
    for (size_t c = 0; c + 1 < first_.size(); ++c) {
      if (first_[c + 1] > 0) holding_.push_back(c);
      const size_t at = (c / across + 1) * (across + 1) + c % across + 1;
      below_[at] =
          first_[c + 1] + below_[at - 1] + below_[at - across - 1] - below_[at - across - 2];
    }
    for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    data_.resize(first_.back());
    std::vector<size_t> next(first_.begin(), first_.end() - 1);
    for (Eigen::Index k = 0; k < problem.size(); ++k)
      if (counts(k)) data_[next[cell[static_cast<size_t>(k)]]++] = k;
  }

  struct Support {
    std::vector<size_t> cells;
    size_t data = 0;  // in them
    bool has_gap = false;
  };

  bool HasGap() const {
    return std::any_of(
        filled_.begin(), filled_.end(), [](char one) { return one != kAllQuarters; });
  }

  size_t size() const { return filled_.size(); }
  std::span<const Eigen::Index> In(size_t cell) const {
    return std::span(data_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }

  // The cells with data of function (i, j), or those around it too where it holds too few.
  Support Of(int i, int j) const {
    Run us = RunOf(u_, i), vs = RunOf(v_, j);
    Support support;
    for (int a = 0; a < us.count && !support.has_gap; ++a) {
      for (int b = 0; b < vs.count && !support.has_gap; ++b) {
        const char filled = filled_[At((us.first + a) % u_.size(), (vs.first + b) % v_.size())];
        support.has_gap = in_space_ ? filled == 0 : filled != kAllQuarters;
      }
    }
    while (DataIn(us, vs) < kLeastData && (us.count < u_.size() || vs.count < v_.size())) {
      Grow(u_, us);
      Grow(v_, vs);
    }
    support.data = DataIn(us, vs);
    if (std::ssize(holding_) < std::ptrdiff_t{us.count} * vs.count) {
      for (const size_t cell : holding_) {
        const auto across = static_cast<size_t>(v_.size());
        if (Holds(u_, us, static_cast<int>(cell / across)) &&
            Holds(v_, vs, static_cast<int>(cell % across)))
          support.cells.push_back(cell);
      }
      return support;
    }
    for (int a = 0; a < us.count; ++a)
      for (int b = 0; b < vs.count; ++b)
        support.cells.push_back(At((us.first + a) % u_.size(), (vs.first + b) % v_.size()));
    return support;
  }

 private:
  size_t At(int a, int b) const {
    return static_cast<size_t>(a) * static_cast<size_t>(v_.size()) + static_cast<size_t>(b);
  }

  // Spans that follow one another, on a periodic axis past its end.
  struct Run {
    int first = 0, count = 0;
  };

  static Run RunOf(const Axis& axis, int function) {
    const std::vector<int>& spans = axis.spans[static_cast<size_t>(function)];
    return {spans.front(), std::min(axis.size(), static_cast<int>(std::ssize(spans)))};
  }

  static bool Holds(const Axis& axis, const Run& run, int span) {
    return (span - run.first + axis.size()) % axis.size() < run.count;
  }

  // Adds a span at each end.
  static void Grow(const Axis& axis, Run& run) {
    const int all = axis.size();
    if (axis.periodic) {
      run.first = (run.first + all - 1) % all;
      run.count = std::min(all, run.count + 2);
      return;
    }
    const int end = std::min(all, run.first + run.count + 1);
    run.first = std::max(0, run.first - 1);
    run.count = end - run.first;
  }

  size_t DataIn(const Run& us, const Run& vs) const {
    // A run past the end of its axis is two.
    const auto parts = [](const Run& run, int all) {
      const int end = run.first + run.count;
      return std::array{std::pair(run.first, std::min(end, all)), std::pair(0, end - all)};
    };
    size_t data = 0;
    for (const auto& [a, b] : parts(us, u_.size())) {
      for (const auto& [c, d] : parts(vs, v_.size())) {
        if (b > a && d > c) data += Below(b, d) - Below(a, d) - Below(b, c) + Below(a, c);
      }
    }
    return data;
  }

  // The number of data in cells of lesser indices [Crow 1984].
  size_t Below(int a, int b) const {
    return below_[static_cast<size_t>(a) * (static_cast<size_t>(v_.size()) + 1) +
                  static_cast<size_t>(b)];
  }

  const Axis &u_, &v_;
  std::vector<size_t> first_;  // of each cell's data
  bool in_space_ = false;
  std::vector<char> filled_;        // which quarters of each cell hold data, a bit for each
  std::vector<Eigen::Index> data_;  // by cells
  std::vector<size_t> below_;       // summed-area table of their numbers
  std::vector<size_t> holding_;     // cells that hold data
};

using Height = Eigen::Matrix<double, 1, 1>;

// Of the heights in each cell.
std::vector<Eigen::AlignedBox1d> RangesOf(const Cells& cells, const Eigen::MatrixXd& heights) {
  std::vector<Eigen::AlignedBox1d> ranges(cells.size());
  for (size_t cell = 0; cell < cells.size(); ++cell)
    for (const Eigen::Index one : cells.In(cell)) ranges[cell].extend(Height(heights(0, one)));
  return ranges;
}

// Share of a range by which the coefficients of a spline within it leave it: collocation over equal
// spans has an inverse of norm (π/2)^{p+1}/2, 3 for cubics.
double CoveredMargin(int degree) {
  return std::max(0.0, (std::pow(std::numbers::pi / 2, degree + 1) / 2 - 1) / 2);
}

}  // namespace

bool FillsEveryCell(const FittingProblem& problem) {
  const Axis u = AxisOf(problem.basis_u()), v = AxisOf(problem.basis_v());
  return !Cells(problem, u, v).HasGap();
}

CoefficientBounds BoundsFromData(const FittingProblem& problem,
                                 const Eigen::MatrixXd& smooth,
                                 double slack,
                                 ThreadPool& pool) {
  const SplineBasis &bu = problem.basis_u(), &bv = problem.basis_v();
  const Axis u = AxisOf(bu), v = AxisOf(bv);
  const Cells cells(problem, u, v);
  const bool in_space = smooth.rows() == 3;
  const Eigen::MatrixXd off = problem.data().values - EvaluateAt(problem, smooth, pool);
  std::optional<NurbsSurface> surface;
  if (in_space) surface.emplace(bu, bv, smooth);
  const auto heights = problem.data().values.row(0);
  const double all_low = heights.minCoeff(), all_high = heights.maxCoeff(),
               beyond = kOfAll * (all_high - all_low) + slack;
  const std::vector<Eigen::AlignedBox1d> ranges =
      in_space ? std::vector<Eigen::AlignedBox1d>() : RangesOf(cells, off);
  const double covered = CoveredMargin(std::max(bu.degree(), bv.degree()));
  const Eigen::Index count = problem.net_size();
  CoefficientBounds bounds{Eigen::VectorXd::Constant(count, -HUGE_VAL),
                           Eigen::VectorXd::Constant(count, HUGE_VAL),
                           Eigen::Matrix3Xd::Zero(3, in_space ? count : 0)};
  for (int i = 0; i < bu.size(); ++i) {
    for (int j = 0; j < bv.size(); ++j) {
      const Eigen::Index k = Eigen::Index{i} * bv.size() + j;
      const Cells::Support support = cells.Of(i, j);
      if (support.data < kLeastData) continue;
      if (in_space) {
        const auto normal = surface->NormalAt(bu.Clamp(bu.Greville(i)), bv.Clamp(bv.Greville(j)));
        if (!normal) continue;
        bounds.up.col(k) = *normal;
      }
      Eigen::AlignedBox1d range;
      for (const size_t cell : support.cells) {
        if (!in_space) {
          range.extend(ranges[cell]);
          continue;
        }
        for (const Eigen::Index one : cells.In(cell))
          range.extend(Height(bounds.up.col(k).dot(off.col(one))));
      }
      const double reach = u.reach[static_cast<size_t>(i)] * v.reach[static_cast<size_t>(j)];
      const double margin = support.has_gap ? (reach - 1) / 2 : covered;
      const double more = margin * range.sizes()[0] + slack;
      const double middle = bounds.HeightOf(smooth, k);
      bounds.low[k] = middle + range.min()[0] - more;
      bounds.high[k] = middle + range.max()[0] + more;
      if (in_space || !support.has_gap) continue;
      const double least = all_low - beyond, most = all_high + beyond;
      bounds.low[k] = std::clamp(bounds.low[k], least, most);
      bounds.high[k] = std::clamp(bounds.high[k], least, most);
    }
  }
  return bounds;
}

}  // namespace batten::internal
