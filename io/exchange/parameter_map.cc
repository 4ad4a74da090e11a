// SPDX-License-Identifier: MIT
#include "io/exchange/parameter_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/nurbs/span_breaks.h"

namespace batten::internal {
namespace {

using Node = CurveNode;

constexpr int kDeepestCubic = 12;  // halvings

class MappedCurve {
 public:
  MappedCurve(const NurbsCurve<2>& curve, const ParameterMap& u, const ParameterMap& v)
      : curve_(curve), u_(u), v_(v) {}

  // With the slope of one side or the other where the curve has a corner.
  Node At(double t, bool left) const {
    const SplineBasis& basis = curve_.basis();
    const double step = 1e-9 * (basis.upper() - basis.lower());
    const double beside = left ? std::max(t - step, basis.lower()) : t;
    const Eigen::Vector2d point = curve_.At(t);
    const Eigen::Vector2d slope = curve_.JetAt(beside).first;
    return {t,
            {u_.At(point[0]), v_.At(point[1])},
            {slope[0] * u_.Slope(point[0]), slope[1] * v_.Slope(point[1])}};
  }

 private:
  const NurbsCurve<2>& curve_;
  const ParameterMap& u_;
  const ParameterMap& v_;
};

Eigen::Vector2d Hermite(const Node& a, const Node& b, double share) {
  const double h = b.parameter - a.parameter, s = share, r = 1 - s;
  const Eigen::Vector2d p = a.point + a.slope * (h / 3), q = b.point - b.slope * (h / 3);
  return r * r * r * a.point + 3 * r * r * s * p + 3 * r * s * s * q + s * s * s * b.point;
}

// Appends to `nodes`, which ends with `a`, the nodes up to `b`.
template <class NodeAt>
void Refine(const NodeAt& curve,
            const Node& a,
            const Node& b,
            const Eigen::Array2d& tolerance,
            int depth,
            std::vector<Node>& nodes) {
  const double h = b.parameter - a.parameter;
  bool near = true;
  for (const double share : {0.25, 0.5, 0.75}) {
    const Eigen::Vector2d exact = curve(a.parameter + share * h).point;
    near = near && ((Hermite(a, b, share) - exact).array().abs() <= tolerance).all();
  }
  if (near || depth == 0) {
    nodes.push_back(b);
    return;
  }
  const Node middle = curve(a.parameter + h / 2);
  Refine(curve, a, middle, tolerance, depth - 1, nodes);
  Refine(curve, middle, b, tolerance, depth - 1, nodes);
}

// The cubic through nodes; each break with as many knots as corners need.
NurbsCurve<2> Cubic(const std::vector<std::vector<Node>>& runs) {
  std::vector<double> knots(4, runs.front().front().parameter);
  std::vector<Eigen::Vector2d> points = {runs.front().front().point};
  for (const std::vector<Node>& run : runs) {
    for (size_t i = 1; i < run.size(); ++i) {
      const double third = (run[i].parameter - run[i - 1].parameter) / 3;
      points.push_back(run[i - 1].point + third * run[i - 1].slope);
      points.push_back(run[i].point - third * run[i].slope);
      const bool last = i + 1 == run.size();
      if (last) points.push_back(run[i].point);
      knots.insert(knots.end(), last ? 3 : 2, run[i].parameter);
    }
  }
  knots.push_back(knots.back());
  Eigen::Matrix2Xd columns(2, static_cast<Eigen::Index>(points.size()));
  for (size_t i = 0; i < points.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = points[i];
  return NurbsCurve<2>(SplineBasis(3, std::move(knots)), std::move(columns));
}

// Along a line of constant u or v: only its ends count.
bool OnParameterLine(const NurbsCurve<2>& curve) {
  constexpr double kRounding = 1e-12;
  const auto& points = curve.control_points();
  const Eigen::Vector2d extent = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  return extent.minCoeff() <= kRounding * extent.maxCoeff();
}

// Whether the mapped curve is where a line between its ends is at the same parameters.
bool RunsEvenly(const MappedCurve& mapped, const SplineBasis& basis, const Eigen::Array2d& near) {
  constexpr int kPlaces = 16;
  const double lower = basis.lower(), length = basis.upper() - lower;
  const Eigen::Vector2d start = mapped.At(lower, false).point;
  const Eigen::Vector2d way = mapped.At(basis.upper(), false).point - start;
  for (int k = 1; k < kPlaces; ++k) {
    const double share = static_cast<double>(k) / kPlaces;
    const Eigen::Vector2d off =
        mapped.At(lower + share * length, false).point - start - share * way;
    if (!(off.array().abs() <= near).all()) return false;
  }
  return true;
}

}  // namespace

NurbsCurve<2> CubicOf(const std::function<CurveNode(double)>& curve,
                      double lower,
                      double upper,
                      const Eigen::Array2d& tolerance) {
  std::vector<Node> run{curve(lower)};
  Refine(curve, run.front(), curve(upper), tolerance, kDeepestCubic, run);
  return Cubic({run});
}

ParameterMap::ParameterMap(double first, double last, const SplineBasis& basis, bool angle)
    : first_(first), last_(last), breaks_(BreaksIn(basis)), angle_(angle) {}

int ParameterMap::ArcOf(double parameter, double& from_middle) const {
  const int arcs = static_cast<int>(breaks_.size()) - 1;
  const double sweep = (last_ - first_) / arcs, place = (parameter - first_) / sweep;
  const int arc = std::clamp(static_cast<int>(std::floor(place)), 0, arcs - 1);
  from_middle = (std::clamp(place - arc, 0.0, 1.0) - 0.5) * sweep;
  return arc;
}

double ParameterMap::At(double parameter) const {
  if (!angle_) {
    if (first_ == breaks_.front() && last_ == breaks_.back()) return parameter;
    const double share = (parameter - first_) / (last_ - first_);
    return breaks_.front() + share * (breaks_.back() - breaks_.front());
  }
  double angle = 0;
  const auto arc = static_cast<size_t>(ArcOf(parameter, angle));
  const double half = (last_ - first_) / static_cast<double>(breaks_.size() - 1) / 2;
  const double share = (1 + std::tan(angle / 2) / std::tan(half / 2)) / 2;
  return breaks_[arc] + share * (breaks_[arc + 1] - breaks_[arc]);
}

double ParameterMap::Slope(double parameter) const {
  if (!angle_) return (breaks_.back() - breaks_.front()) / (last_ - first_);
  double angle = 0;
  const auto arc = static_cast<size_t>(ArcOf(parameter, angle));
  const double half = (last_ - first_) / static_cast<double>(breaks_.size() - 1) / 2;
  const double cosine = std::cos(angle / 2);
  return (breaks_[arc + 1] - breaks_[arc]) / (4 * cosine * cosine * std::tan(half / 2));
}

NurbsCurve<2> Mapped(const NurbsCurve<2>& curve,
                     const ParameterMap& u,
                     const ParameterMap& v,
                     const Eigen::Array2d& sides,
                     double tolerance,
                     CurveSpeed speed) {
  const SplineBasis& basis = curve.basis();
  if (u.linear() && v.linear()) {
    Eigen::Matrix2Xd points = curve.control_points();
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      points.col(i) << u.At(points(0, i)), v.At(points(1, i));
    }
    return NurbsCurve<2>(basis, std::move(points), curve.weights());
  }
  const MappedCurve mapped(curve, u, v);
  if (OnParameterLine(curve) &&
      (speed == CurveSpeed::kAny || RunsEvenly(mapped, basis, tolerance * sides))) {
    Eigen::Matrix2Xd ends(2, 2);
    ends << mapped.At(basis.lower(), false).point, mapped.At(basis.upper(), false).point;
    return NurbsCurve<2>(
        SplineBasis(1, {basis.lower(), basis.lower(), basis.upper(), basis.upper()}),
        std::move(ends));
  }
  const auto node_at = [&](double t) { return mapped.At(t, false); };
  std::vector<std::vector<Node>> runs;
  for (const int span : basis.Spans()) {
    const Node a = mapped.At(basis.knots()[span], false);
    const Node b = mapped.At(basis.knots()[span + 1], true);
    std::vector<Node>& run = runs.emplace_back(std::vector<Node>{a});
    Refine(node_at, a, b, tolerance * sides, kDeepestCubic, run);
  }
  return Cubic(runs);
}

}  // namespace batten::internal
