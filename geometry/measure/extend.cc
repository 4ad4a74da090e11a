// SPDX-License-Identifier: MIT
#include "batten/geometry/extend.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/clamp.h"
#include "batten/geometry/closure.h"
#include "geometry/editing/control_rows.h"
#include "geometry/numeric/gauss_rule.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kLeastWeight = 0.01;  // of the least at the end
constexpr double kMeanError = 1e-7;    // of the mean length, by halving the parts of Gauss' rule
constexpr int kMostCuts = 64;
constexpr int kEdgeNodes = 12;
constexpr double kShortest = 1e-9;  // of the parameter at the end

// Homogeneous control points (w·(P − origin), w), one a column.
using Points = Eigen::Matrix4Xd;

// The row of coefficients that takes the p + 1 control points of a span to the blossom of its
// polynomial at p arguments. De Boor's triangle on the unit vectors. [Ramshaw 1989]
Eigen::RowVectorXd BlossomRow(const SplineBasis& basis, int span, std::span<const double> x) {
  const int p = basis.degree();
  const std::vector<double>& U = basis.knots();
  Eigen::MatrixXd d = Eigen::MatrixXd::Identity(p + 1, p + 1);
  for (int r = 1; r <= p; ++r) {
    for (int k = p; k >= r; --k) {
      const int i = span - p + k;
      const double a = (x[r - 1] - U[i]) / (U[i + p - r + 1] - U[i]);
      d.row(k) = (1 - a) * d.row(k - 1) + a * d.row(k);
    }
  }
  return d.row(p);
}

// How rows with a clamped upper end b go on to b + h.
class Strip {
 public:
  Strip(const SplineBasis& basis, bool natural)
      : basis_(basis), p_(basis.degree()), end_(basis.upper()), span_(basis.Span(end_)) {
    natural_ = natural || p_ <= 2;
    Eigen::MatrixXd derivatives(p_ + 1, 3);
    basis_.Derivatives(span_, end_, 2, derivatives.data());
    taylor_ = derivatives.transpose();
    taylor_.row(2) /= 2;
  }

  const SplineBasis& basis() const { return basis_; }
  double end() const { return end_; }
  double last_span() const { return end_ - basis_.knots()[span_]; }
  double ParameterSpeed() const { return p_ / last_span(); }

  // Knots of the shape with its strip.
  SplineBasis Longer(double h) const {
    std::vector<double> knots(basis_.knots().begin(), basis_.knots().end() - (p_ + 1));
    if (!natural_) knots.insert(knots.end(), p_ - 2, end_);
    knots.insert(knots.end(), p_ + 1, end_ + h);
    return SplineBasis(p_, std::move(knots));
  }

  // The last `rows()` control points over those knots, from the last p + 1 of the old ones.
  Eigen::MatrixXd NewPoints(double h) const {
    const SplineBasis longer = Longer(h);
    const std::vector<double>& T = longer.knots();
    const int n = static_cast<int>(T.size()) - p_ - 1;
    Eigen::MatrixXd result(p_, p_ + 1);
    for (int k = 0; k < p_; ++k) {
      const std::span<const double> arguments(T.data() + n - p_ + k + 1, p_);
      result.row(k) = natural_ ? BlossomRow(basis_, span_, arguments) : TaylorBlossom(arguments);
    }
    return result;
  }

  // The Bézier points of the strip, from the last p + 1 control points.
  Eigen::MatrixXd BezierPoints(double h) const {
    Eigen::MatrixXd result(p_ + 1, p_ + 1);
    std::vector<double> arguments(p_, end_);
    for (int k = 0; k <= p_; ++k) {
      if (k > 0) arguments[p_ - k] = end_ + h;
      result.row(k) = natural_ ? BlossomRow(basis_, span_, arguments) : TaylorBlossom(arguments);
    }
    return result;
  }

 private:
  // The blossom of the parabola with the end's point, first and second derivative:
  // f0 + f1·e1/p + f2·e2/C(p,2), e the elementary symmetric functions of the arguments less b.
  Eigen::RowVectorXd TaylorBlossom(std::span<const double> arguments) const {
    double e1 = 0, e2 = 0;
    for (const double x : arguments) {
      e2 += e1 * (x - end_);
      e1 += x - end_;
    }
    return taylor_.row(0) + e1 / p_ * taylor_.row(1) + e2 * 2 / (p_ * (p_ - 1.0)) * taylor_.row(2);
  }

  SplineBasis basis_;
  int p_;
  double end_;
  int span_;
  bool natural_;
  Eigen::MatrixXd taylor_;
};

// The last p + 1 control points of a row about its last one.
Points EndOf(const ControlRows& rows, Eigen::Index row) {
  const int n = rows.basis.size(), p = rows.basis.degree();
  const Eigen::Vector3d origin = rows.At(row, n - 1).place;
  Points points(4, p + 1);
  for (int k = 0; k <= p; ++k) {
    const ControlRows::Point point = rows.At(row, n - p - 1 + k);
    points.col(k) << point.weight * (point.place - origin), point.weight;
  }
  return points;
}

// The control points at the end of the iso-lines whose strips are measured, each with its share.
struct EndLine {
  double share;
  Points points;
};

// Gauss' rule in every span along the edge cut into `cuts` equal parts.
std::vector<EndLine> LinesOf(const ControlRows& rows, const SplineBasis* along, int cuts) {
  if (!along) return {{1, EndOf(rows, 0)}};
  const GaussRule rule = GaussLegendre(kEdgeNodes);
  const int q = along->degree(), p = rows.basis.degree(), n = rows.basis.size();
  const double length = along->upper() - along->lower();
  std::vector<EndLine> lines;
  Eigen::VectorXd N(q + 1);
  for (const int span : along->Spans()) {
    const double width = (along->knots()[span + 1] - along->knots()[span]) / cuts;
    for (int k = 0; k < cuts * kEdgeNodes; ++k) {
      const int cut = k / kEdgeNodes, node = k % kEdgeNodes;
      along->Values(span, along->knots()[span] + (cut + rule.nodes[node]) * width, N.data());
      const Eigen::Vector3d origin = rows.At(span, n - 1).place;
      EndLine line{rule.weights[node] * width / length, Points::Zero(4, p + 1)};
      for (int r = 0; r <= q; ++r) {
        for (int i = 0; i <= p; ++i) {
          const ControlRows::Point point = rows.At(span - q + r, n - p - 1 + i);
          const double w = N[r] * point.weight;
          line.points.col(i) += Eigen::Vector4d(w * (point.place[0] - origin[0]),
                                                w * (point.place[1] - origin[1]),
                                                w * (point.place[2] - origin[2]),
                                                w);
        }
      }
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

double LengthOf(const EndLine& line, const Eigen::MatrixXd& bezier, bool rational) {
  const Points points = line.points * bezier.transpose();
  const auto p = static_cast<int>(points.cols()) - 1;
  const Eigen::RowVectorXd w = points.row(3);
  const Eigen::Matrix3Xd places =
      rational ? Eigen::Matrix3Xd(points.topRows<3>().array().rowwise() / w.array())
               : Eigen::Matrix3Xd(points.topRows<3>());
  const double ends[] = {0, 1};
  return ArcLength(NurbsCurve<3>(SplineBasis::Clamped(p, ends),
                                 places,
                                 rational ? Eigen::VectorXd(w.transpose()) : Eigen::VectorXd()));
}

// The extension of rows, and the search for how far the parameter goes.
class Extender {
 public:
  Extender(ControlRows rows, const SplineBasis* along, Continuation continuation)
      : rows_(std::move(rows)),
        strip_(rows_.basis, rows_.rational() || continuation == Continuation::kNatural),
        along_(along),
        lines_(LinesOf(rows_, along, 1)) {}

  ControlRows Extended(double length) {
    double h = ParameterFor(length);
    for (int cuts = 2; along_ && cuts <= kMostCuts; cuts *= 2) {
      lines_ = LinesOf(rows_, along_, cuts);
      if (std::abs(MeanLength(h) - length) <= kMeanError * length) break;
      h = ParameterFor(length);
    }
    if (h < kShortest * std::abs(strip_.end())) {
      Reject("Extended",
             "length = " + NumberText(length) + " is too short beside the parameter " +
                 NumberText(strip_.end()) + " at the end");
    }
    return By(h);
  }

 private:
  bool WeightsHold(double h) const {
    if (!rows_.rational()) return true;
    const Eigen::MatrixXd map = strip_.NewPoints(h);
    const auto last = rows_.weights.rightCols(map.cols());
    const Eigen::MatrixXd fresh = last * map.transpose();
    return (fresh.rowwise().minCoeff().array() >= kLeastWeight * last.rowwise().minCoeff().array())
        .all();
  }

  double MeanLength(double h) const {
    const Eigen::MatrixXd bezier = strip_.BezierPoints(h);
    double sum = 0;
    for (const EndLine& line : lines_) sum += line.share * LengthOf(line, bezier, rows_.rational());
    return sum;
  }

  // The greatest h in [good, bad] whose weights hold.
  double LastGood(double good, double bad) const {
    constexpr int kHalvings = 50;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = (good + bad) / 2;
      (WeightsHold(middle) ? good : bad) = middle;
    }
    return good;
  }

  double FirstGuess(double length) const {
    double speed = 0;
    for (const EndLine& line : lines_) {
      const Eigen::Index p = line.points.cols() - 1;
      const double w = line.points(3, p);
      const Eigen::Vector4d step = line.points.col(p) - line.points.col(p - 1);
      const Eigen::Vector3d place = line.points.col(p).head<3>() / w;
      speed += line.share * strip_.ParameterSpeed() * (step.head<3>() - place * step[3]).norm() / w;
    }
    const double guess = length / speed;
    return std::isfinite(guess) ? guess : strip_.last_span();
  }

  // Bracketed by doubling, then regula falsi with the Illinois rule.
  double ParameterFor(double length) const {
    constexpr int kDoublings = 60, kSteps = 100;
    constexpr double kExact = 1e-11;
    double low = 0, low_miss = -length, high = FirstGuess(length), high_miss = 0;
    for (int k = 0;; ++k, low = high, low_miss = high_miss, high *= 2) {
      if (!WeightsHold(high)) {
        const double last = LastGood(low, high), most = MeanLength(last);
        if (most < length) {
          Reject("Extended",
                 "length = " + NumberText(length) + " makes weights vanish; the greatest is " +
                     NumberText(most));
        }
        high = last;
      }
      high_miss = MeanLength(high) - length;
      if (high_miss >= 0) break;
      if (k == kDoublings || !std::isfinite(high))
        Reject("Extended", "the shape comes to rest at the end");
    }
    for (int k = 0, side = 0; k < kSteps && high_miss > kExact * length; ++k) {
      double h = (low * high_miss - high * low_miss) / (high_miss - low_miss);
      if (!(h > low && h < high)) h = (low + high) / 2;
      const double miss = MeanLength(h) - length;
      if (std::abs(miss) <= kExact * length || h == low || h == high) return h;
      if (miss < 0) {
        low = h;
        low_miss = miss;
        if (std::exchange(side, -1) == -1) high_miss /= 2;
      } else {
        high = h;
        high_miss = miss;
        if (std::exchange(side, 1) == 1) low_miss /= 2;
      }
    }
    return high;
  }

  ControlRows By(double h) const {
    ControlRows longer = EmptyRows(rows_, strip_.Longer(h));
    const Eigen::MatrixXd map = strip_.NewPoints(h);
    const Eigen::Index kept = longer.basis.size() - map.rows(), n = rows_.basis.size();
    for (Eigen::Index row = 0; row < rows_.rows(); ++row) {
      for (Eigen::Index i = 0; i < kept; ++i) longer.Set(row, i, rows_.At(row, i));
      const Eigen::Vector3d origin = rows_.At(row, n - 1).place;
      const Points fresh = EndOf(rows_, row) * map.transpose();
      for (Eigen::Index k = 0; k < map.rows(); ++k) {
        const double w = rows_.rational() ? fresh(3, k) : 1;
        longer.Set(row, kept + k, {origin + fresh.col(k).head<3>() / w, w});
      }
    }
    return longer;
  }

  ControlRows rows_;
  Strip strip_;
  const SplineBasis* along_;
  std::vector<EndLine> lines_;
};

// The rows run the other way over negated knots: exact, and its own inverse.
ControlRows Mirrored(ControlRows rows) {
  std::vector<double> knots(rows.basis.knots().rbegin(), rows.basis.knots().rend());
  for (double& knot : knots) knot = -knot;
  rows.basis = SplineBasis(rows.basis.degree(), std::move(knots));
  for (Eigen::MatrixXd& x : rows.coordinates) x = x.rowwise().reverse().eval();
  if (rows.rational()) rows.weights = rows.weights.rowwise().reverse().eval();
  return rows;
}

ControlRows ExtendedRows(ControlRows rows,
                         const SplineBasis* along,
                         bool upper,
                         double length,
                         Continuation continuation) {
  if (!upper) rows = Mirrored(std::move(rows));
  ControlRows longer = Extender(std::move(rows), along, continuation).Extended(length);
  return upper ? longer : Mirrored(std::move(longer));
}

void CheckLength(double length) {
  if (!(length > 0) || !std::isfinite(length)) {
    Reject("Extended", "length = " + NumberText(length) + " is not positive and finite");
  }
}

bool Collapsed(const NurbsSurface& surface, const SurfaceEdge& edge) {
  const CollapsedEdgeSet set = CollapsedEdges(surface);
  if (edge.direction == Direction::kU) return edge.upper ? set.u_upper : set.u_lower;
  return edge.upper ? set.v_upper : set.v_lower;
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> Extended(const NurbsCurve<Dim>& curve,
                         bool upper,
                         double length,
                         Continuation continuation) {
  CheckLength(length);
  if (curve.basis().periodic() || Closed(curve))
    Reject("Extended", "the curve is closed: it has no end");
  return CurveOf<Dim>(ExtendedRows(RowsOf(Clamped(curve)), nullptr, upper, length, continuation));
}

NurbsSurface Extended(const NurbsSurface& surface,
                      const SurfaceEdge& edge,
                      double length,
                      Continuation continuation) {
  CheckLength(length);
  const SplineBasis& across =
      edge.direction == Direction::kU ? surface.basis_u() : surface.basis_v();
  const std::string name = edge.direction == Direction::kU ? "u" : "v";
  if (across.periodic() || Closed(surface, edge.direction)) {
    Reject("Extended", "the surface is closed in " + name + ": it has no edge there");
  }
  if (Collapsed(surface, edge)) {
    Reject("Extended",
           "the edge at the " + std::string(edge.upper ? "upper" : "lower") + " end of " + name +
               " is a single point: there is no strip beyond it");
  }
  const SplineBasis along = OtherBasis(surface, edge.direction);
  const NurbsSurface longer =
      SurfaceOf(ExtendedRows(RowsOf(Clamped(surface, edge.direction), edge.direction),
                             &along,
                             edge.upper,
                             length,
                             continuation),
                edge.direction,
                along);
  return longer.WithTrims(surface.trims());
}

template NurbsCurve<2> Extended(const NurbsCurve<2>&, bool, double, Continuation);
template NurbsCurve<3> Extended(const NurbsCurve<3>&, bool, double, Continuation);

}  // namespace batten
