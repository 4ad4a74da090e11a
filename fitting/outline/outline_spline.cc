// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_spline.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/clamp.h"
#include "batten/geometry/knot_vectors.h"
#include "fitting/outline/outline_corners.h"

namespace batten::internal {
namespace {

constexpr double kShortestSpan = 4;
constexpr double kTogether = 3;         // samples nearer than this count as dependent
constexpr double kMostOffSpline = 0.6;  // the mean misfit over …
constexpr double kWindow = 12;          // … a window this long
constexpr int kMostRises = 3;
constexpr int kMostSplits = 30;

// Points at parameters along a piece, and what the spline through them must keep.
struct PieceData {
  std::vector<double> at;
  Eigen::Matrix2Xd points;
  double length = 0;
  bool closed = false;
  Eigen::Vector2d start, end;  // of an open one
};

struct PieceFit {
  SplineBasis basis;
  Eigen::Matrix2Xd points;  // the distinct control points
  double score = 0;
  double off = 0, worst = 0;  // the greatest mean misfit over a window, and its middle
};

int Column(const SplineBasis& basis, int i) {
  return basis.periodic() ? i % (basis.size() - kOutlineDegree) : i;
}

// Least squares; weak regularization holds control points without data near their neighbours.
Eigen::Matrix2Xd Solved(const PieceData& data, const SplineBasis& basis) {
  const int n = data.closed ? basis.size() - kOutlineDegree : basis.size();
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(n, 2);
  for (size_t k = 0; k < data.at.size(); ++k) {
    double values[kOutlineDegree + 1];
    const int span = basis.Span(data.at[k]);
    basis.Values(span, data.at[k], values);
    for (int r = 0; r <= kOutlineDegree; ++r) {
      const int i = Column(basis, span - kOutlineDegree + r);
      right.row(i) += values[r] * data.points.col(static_cast<Eigen::Index>(k)).transpose();
      for (int s = 0; s <= kOutlineDegree; ++s)
        entries.emplace_back(i, Column(basis, span - kOutlineDegree + s), values[r] * values[s]);
    }
  }
  constexpr double kHeld = 1e-4;
  for (int i = 0; i < n; ++i) {
    if (!data.closed && (i == 0 || i == n - 1)) continue;
    const int before = (i + n - 1) % n, after = (i + 1) % n;
    const int places[3] = {before, i, after};
    const double weights[3] = {-1, 2, -1};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        entries.emplace_back(places[a], places[b], kHeld * weights[a] * weights[b]);
  }
  Eigen::SparseMatrix<double> normal(n, n);
  normal.setFromTriplets(entries.begin(), entries.end());
  using Solver = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
  if (data.closed) return Solver(normal).solve(right).transpose();
  Eigen::MatrixX2d solved(n, 2);
  solved.row(0) = data.start.transpose();
  solved.row(n - 1) = data.end.transpose();
  right -= normal.col(0) * solved.row(0) + normal.col(n - 1) * solved.row(n - 1);
  if (n > 2) {
    const Eigen::SparseMatrix<double> inner = normal.block(1, 1, n - 2, n - 2);
    solved.middleRows(1, n - 2) = Solver(inner).solve(right.middleRows(1, n - 2).eval());
  }
  return solved.transpose();
}

// Schwarz' criterion of the distances across the spline, and the window of largest mean misfit.
void Judge(const PieceData& data, double noise, PieceFit& fit) {
  const auto m = static_cast<double>(data.at.size());
  double sum = 0;
  std::vector<double> off(data.at.size());
  for (size_t k = 0; k < data.at.size(); ++k) {
    double values[2 * (kOutlineDegree + 1)];
    const int span = fit.basis.Span(data.at[k]);
    fit.basis.Derivatives(span, data.at[k], 1, values);
    Eigen::Vector2d place = Eigen::Vector2d::Zero(), way = place;
    for (int r = 0; r <= kOutlineDegree; ++r) {
      const auto point = fit.points.col(Column(fit.basis, span - kOutlineDegree + r));
      place += values[r] * point;
      way += values[kOutlineDegree + 1 + r] * point;
    }
    const Eigen::Vector2d from = data.points.col(static_cast<Eigen::Index>(k)) - place;
    off[k] = way.norm() > 0 ? (way.x() * from.y() - way.y() * from.x()) / way.norm() : from.norm();
    sum += off[k] * off[k];
  }
  const double independent = std::max(4.0, data.length / kTogether);
  fit.score =
      independent * std::log(sum / m + kLeastBorderNoise * kLeastBorderNoise + noise * noise) +
      static_cast<double>(fit.points.cols()) * std::log(independent);
  const auto window = static_cast<size_t>(std::max(1.0, m * kWindow / data.length));
  double running = 0;
  for (size_t k = 0; k < off.size(); ++k) {
    running += off[k];
    if (k >= window) running -= off[k - window];
    const double mean = std::abs(running) / static_cast<double>(window);
    if (k + 1 < window || mean <= fit.off) continue;
    fit.off = mean;
    fit.worst = data.at[k - window / 2];
  }
}

PieceFit Fitted(const PieceData& data, const std::vector<double>& breaks, double noise) {
  PieceFit fit{data.closed ? PeriodicKnots(kOutlineDegree, breaks)
                           : SplineBasis::Clamped(kOutlineDegree, breaks),
               {}};
  fit.points = Solved(data, fit.basis);
  Judge(data, noise, fit);
  return fit;
}

std::vector<double> EvenBreaks(double length, int spans) {
  std::vector<double> breaks;
  for (int i = 0; i <= spans; ++i) breaks.push_back(length * i / spans);
  return breaks;
}

// Uniform spans, as many as Schwarz' criterion selects for the whole border, and more where the
// misfit of a window is large.
PieceFit Chosen(const PieceData& data, double noise) {
  const int least = data.closed ? 4 : 1;
  const int most = std::max(least, static_cast<int>(data.length / kShortestSpan));
  std::vector<double> breaks = EvenBreaks(data.length, least);
  PieceFit best = Fitted(data, breaks, noise);
  int rises = 0;
  for (int spans = least + 1; spans <= most && rises < kMostRises;
       spans = std::max(spans + 1, static_cast<int>(1.2 * spans))) {
    PieceFit next = Fitted(data, EvenBreaks(data.length, spans), noise);
    const bool better = next.score < best.score;
    rises = better ? 0 : rises + 1;
    if (!better) continue;
    best = std::move(next);
    breaks = EvenBreaks(data.length, spans);
  }
  for (int split = 0; split < kMostSplits && best.off > std::max(kMostOffSpline, noise); ++split) {
    const auto next = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, best.worst);
    const double middle = (*next + *(next - 1)) / 2;
    if (*next - *(next - 1) < 2 * kShortestSpan) break;
    breaks.insert(next, middle);
    best = Fitted(data, breaks, noise);
  }
  return best;
}

// Parameters are lengths along the smoothed places.
PieceData OpenData(const Eigen::Vector2d& start,
                   const std::vector<OutlineSample>& samples,
                   const Eigen::Vector2d& end) {
  PieceData data;
  data.start = start;
  data.end = end;
  data.points.resize(2, static_cast<Eigen::Index>(samples.size()));
  Eigen::Vector2d last = start;
  for (size_t k = 0; k < samples.size(); ++k) {
    data.length += (samples[k].place - last).norm();
    last = samples[k].place;
    data.at.push_back(data.length);
    data.points.col(static_cast<Eigen::Index>(k)) = samples[k].measured;
  }
  data.length += (end - last).norm();
  return data;
}

PieceData ClosedData(const OutlineLoop& loop) {
  PieceData data = OpenData(loop.front().place, loop, loop.front().place);
  data.closed = true;
  return data;
}

// Between a corner and the samples a side is straight: that is how corners are found.
std::vector<OutlineSample> WithStraightEnds(const Eigen::Vector2d& start,
                                            const std::vector<OutlineSample>& samples,
                                            const Eigen::Vector2d& end) {
  std::vector<OutlineSample> result;
  const auto fill = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const double length = (to - from).norm();
    for (double away = kBorderStep; away < length - kBorderStep / 2; away += kBorderStep) {
      const Eigen::Vector2d place = from + away / length * (to - from);
      result.push_back({place, place, false, false, false, place, {}});
    }
  };
  fill(start, samples.front().place);
  result.insert(result.end(), samples.begin(), samples.end());
  fill(samples.back().place, end);
  return result;
}

constexpr size_t kFewestSplineSpans = 3;  // samples; with fewer a straight line is used

// An open cubic spline between two places.
struct OutlinePiece {
  std::vector<double> breaks;  // from 0 on
  Eigen::Matrix2Xd points;
};

OutlinePiece StraightPiece(const Eigen::Vector2d& start, const Eigen::Vector2d& end) {
  OutlinePiece piece{{0, std::max((end - start).norm(), 1e-6)},
                     Eigen::Matrix2Xd(2, kOutlineDegree + 1)};
  for (int i = 0; i <= kOutlineDegree; ++i)
    piece.points.col(i) =
        i == kOutlineDegree ? end : Eigen::Vector2d(start + i * (end - start) / kOutlineDegree);
  return piece;
}

OutlineSpline Closed(const OutlineLoop& loop, double noise) {
  PieceFit fit = Chosen(ClosedData(loop), noise);
  OutlineSpline spline{fit.basis, {}, std::move(fit.points), {}, {}, {}, {}};
  for (int i = 0; i < spline.basis.size(); ++i) spline.unknown.push_back(Column(spline.basis, i));
  spline.fixed.assign(static_cast<size_t>(spline.points.cols()), {false, false});
  return spline;
}

// Fitted to the samples of a piece.
OutlinePiece SmoothedPiece(const Eigen::Vector2d& start,
                           const std::vector<OutlineSample>& samples,
                           const Eigen::Vector2d& end,
                           double noise) {
  if (samples.size() < kFewestSplineSpans) return StraightPiece(start, end);
  const PieceFit fit = Chosen(OpenData(start, WithStraightEnds(start, samples, end), end), noise);
  OutlinePiece piece{{}, fit.points};
  for (int i = kOutlineDegree; i <= fit.basis.size(); ++i)
    piece.breaks.push_back(fit.basis.knots()[i]);
  return piece;
}

}  // namespace

OutlineSpline SmoothedOutline(const OutlineLoop& loop, double noise) {
  const auto first = static_cast<size_t>(
      std::find_if(loop.begin(), loop.end(), [](const auto& s) { return s.corner; }) -
      loop.begin());
  const size_t n = loop.size();
  if (first == n) return Closed(loop, noise);
  std::vector<double> knots(kOutlineDegree + 1, 0.0), corners;
  std::vector<char> straight, pinned;
  std::vector<Eigen::Vector2d> points{loop[first].place};
  for (size_t k = 0; k < n;) {
    const OutlineSample& start = loop[(first + k) % n];
    std::vector<OutlineSample> samples;
    size_t end = k + 1;
    for (; end < n && !loop[(first + end) % n].corner; ++end)
      samples.push_back(loop[(first + end) % n]);
    const Eigen::Vector2d& goal = loop[(first + end) % n].place;
    const OutlinePiece piece = start.along_cut || start.pinned
                                   ? StraightPiece(start.place, goal)
                                   : SmoothedPiece(start.place, samples, goal, noise);
    const double begin = knots.back();
    corners.push_back(begin);
    straight.push_back(start.along_cut);
    pinned.push_back(start.pinned);
    for (size_t i = 1; i + 1 < piece.breaks.size(); ++i) knots.push_back(begin + piece.breaks[i]);
    knots.insert(knots.end(), kOutlineDegree, begin + piece.breaks.back());
    for (Eigen::Index i = 1; i < piece.points.cols(); ++i) points.push_back(piece.points.col(i));
    k = end;
  }
  knots.push_back(knots.back());
  OutlineSpline spline{SplineBasis(kOutlineDegree, knots), {}, {}, {}, corners, straight, pinned};
  const auto count = static_cast<int>(points.size()) - 1;
  spline.points.resize(2, count);
  for (int i = 0; i < count; ++i) spline.points.col(i) = points[i];
  for (int i = 0; i <= count; ++i) spline.unknown.push_back(i % count);
  spline.fixed.assign(static_cast<size_t>(count), {false, false});
  return spline;
}

Eigen::Vector2d OutlineSpline::At(double t) const {
  double values[kOutlineDegree + 1];
  const int span = basis.Span(t);
  basis.Values(span, t, values);
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  for (int r = 0; r <= kOutlineDegree; ++r)
    place += values[r] * points.col(unknown[span - kOutlineDegree + r]);
  return place;
}

bool OutlineSpline::IsStraight(double t) const {
  const auto next = std::upper_bound(corners.begin(), corners.end(), t);
  if (next == corners.begin()) return false;
  const auto piece = next - corners.begin() - 1;
  return straight[piece] != 0 || pinned[piece] != 0;
}

NurbsCurve<2> OutlineSpline::Curve(double scale) const {
  std::vector<double> knots = basis.knots();
  for (double& knot : knots) knot *= scale;
  Eigen::Matrix2Xd control(2, basis.size());
  for (int i = 0; i < basis.size(); ++i) control.col(i) = scale * points.col(unknown[i]);
  if (!basis.periodic()) return {SplineBasis(kOutlineDegree, knots), control};
  const NurbsCurve<2> clamped =
      Clamped(NurbsCurve<2>(SplineBasis::Periodic(kOutlineDegree, knots), control));
  control = clamped.control_points();
  control.rightCols(1) = control.leftCols(1);  // to the last bit
  return {clamped.basis(), control};
}

}  // namespace batten::internal
