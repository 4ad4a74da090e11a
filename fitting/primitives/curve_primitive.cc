// SPDX-License-Identifier: MIT
#include "fitting/primitives/curve_primitive.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/geometry/make_curve.h"
#include "fitting/core/shared_constants.h"
#include "fitting/primitives/angle_extent.h"
#include "fitting/primitives/curve_accuracy.h"
#include "fitting/primitives/shape_extent.h"
#include "geometry/numeric/constants.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten::internal {
namespace {

[[noreturn]] void RefuseCurve(const std::string& reason) { throw std::invalid_argument(reason); }

template <typename Shape>
constexpr PrimitiveKind KindOf() {
  return std::is_same_v<Shape, FittedLine> ? PrimitiveKind::kLine : PrimitiveKind::kCircle;
}

}  // namespace

CurvePrimitive::CurvePrimitive(PrimitiveInput& input, PrimitiveKind kind)
    : input_(input), kind_(kind), loss_(input.options.loss.value_or(Loss::kNone)) {
  const bool circle = kind == PrimitiveKind::kCircle;
  input.Require(Name(circle ? PrimitiveKind::kCircle : PrimitiveKind::kLine),
                circle ? FittedCircle::kSample : FittedLine::kSample);
  data_ = input.LocalData();
  line_ = Solved<FittedLine>();
  if (kind != PrimitiveKind::kLine) SolveCircle();
  Choose();
}

// Robust fits start from sample consensus.
template <typename Shape>
Shape CurvePrimitive::StartOf(std::optional<double> scale) const {
  if (robust()) {
    const std::optional<Shape> agreed = Consensus<Shape>(data_, scale, input_.options.seed);
    if (agreed) return *agreed;
  }
  return Shape::Start(data_, input_.pool);
}

template <typename Shape>
SmoothedShape<Shape> CurvePrimitive::Solved() {
  Report(input_.options.progress, "solve", 0);
  Stopwatch watch;
  std::optional<double> scale = input_.options.loss_scale;
  if (scale) *scale /= input_.unit;
  const Shape start = StartOf<Shape>(scale);
  SmoothedShape<Shape> solved{start, 1, {}};
  if (robust()) {
    solved = Settled(data_, start, loss_, scale, input_.rounding, input_.pool);
  } else {
    solved.shape = start.Minimised(data_, {}, kMostIterations, input_.pool);
    solved.used.resize(static_cast<size_t>(data_.points.cols()));
    std::iota(solved.used.begin(), solved.used.end(), Eigen::Index{0});
  }
  const Eigen::VectorXd distances = ShapeDistances(solved.shape, data_, input_.pool);
  if (!robust()) {
    const double squares = distances.cwiseAbs2().dot(data_.weights);
    solved.scale =
        std::max(input_.rounding, std::sqrt(squares / std::max(1.0, FreedomsLeftOf<Shape>())));
  }
  RoundSummary round;
  round.stage = Name(KindOf<Shape>());
  round.control_points_u = std::is_same_v<Shape, FittedLine> ? 2 : 9;
  round.rms =
      input_.unit * std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size()));
  round.max = input_.unit * distances.maxCoeff();
  round.score = input_.unit * solved.scale;
  round.seconds = watch.Lap();
  input_.report.iterations.push_back(round);
  return solved;
}

// The degrees of freedom of a line or circle.
template <typename Shape>
int CurvePrimitive::Freedoms() const {
  if constexpr (std::is_same_v<Shape, FittedLine>) return data_.plane ? 2 : 4;
  return data_.plane ? 3 : 6;
}

double CurvePrimitive::Components() const {
  return static_cast<double>(data_.points.cols() * (data_.plane ? 1 : 2));
}

template <typename Shape>
double CurvePrimitive::FreedomsLeftOf() const {
  return Components() - Freedoms<Shape>();
}

// Fits the circle; with kAuto there need not be one.
void CurvePrimitive::SolveCircle() {
  std::optional<SmoothedShape<FittedCircle>> solved;
  const FittedLine line = FittedLine::Start(data_, input_.pool);
  if (data_.points.cols() >= FittedCircle::kSample &&
      ShapeDistances(line, data_, input_.pool).maxCoeff() > input_.rounding) {
    solved = Solved<FittedCircle>();
    solved->shape = solved->shape.Outward();
  }
  // An arc of length one is an eighth of its curvature high.
  if (solved && solved->shape.curvature > 8 * input_.rounding) {
    circle_ = std::move(solved);
  } else if (kind_ == PrimitiveKind::kCircle) {
    RefuseCurve("the points are collinear: the radius of their circle is infinite");
  }
}

// Σ w d², or in robust fits the sum of twice Tukey's loss.
double CurvePrimitive::CostOf(const auto& shape, double scale) const {
  const Loss loss = robust() ? Loss::kTukey : Loss::kNone;
  const Eigen::VectorXd distances = ShapeDistances(shape, data_, input_.pool);
  double sum = 0;
  for (Eigen::Index k = 0; k < distances.size(); ++k) {
    sum += data_.weights[k] * LossValue(loss, distances[k], scale);
  }
  return 2 * sum;
}

// Chooses the line or the circle and records why.
void CurvePrimitive::Choose() {
  if (kind_ == PrimitiveKind::kLine) {
    why_ = "asked for";
  } else if (!circle_) {
    why_ = data_.points.cols() < FittedCircle::kSample ? "two points determine no more"
                                                       : "the points are on one line, to rounding";
  } else {
    // Twice the log-likelihood ratio of circle against line, for normal noise of unknown variance.
    const double scale = circle_->scale, variance = scale * scale;
    const double fall = std::max(0.0, CostOf(line_->shape, scale) - CostOf(circle_->shape, scale));
    const double left = std::max(1.0, FreedomsLeftOf<FittedCircle>());
    const double evidence = left * std::log1p(fall / (left * variance));
    const int more = Freedoms<FittedCircle>() - Freedoms<FittedLine>();
    const double threshold = 2 * more * std::log(Components()) * (1 + 2 / left);
    const bool bent = evidence > threshold;
    if (kind_ == PrimitiveKind::kCircle) {
      why_ = "asked for";
      if (bent) return;
      input_.report.warnings.push_back(
          "a line fits the points as well as their noise lets one tell: the radius means little");
      return;
    }
    char numbers[80];
    std::snprintf(numbers, sizeof numbers, "%.4g; chance is given %.4g", evidence, threshold);
    why_ = std::string(bent ? "the points bend more than their noise"
                            : "the points bend no more than their noise may") +
           " (evidence against a line " + numbers + ")";
    if (!bent) circle_.reset();
  }
}

const std::vector<Eigen::Index>& CurvePrimitive::Used() const {
  return circle_ ? circle_->used : line_->used;
}

// The places of the points along the shape, in their order; isolated ones do not count in robust
// fits.
std::vector<double> CurvePrimitive::Places() const {
  std::vector<double> places;
  for (const Eigen::Index k : Used()) {
    const Eigen::Vector3d p = data_.points.col(k);
    places.push_back(circle_ ? circle_->shape.AngleOf(p)
                             : (p - line_->shape.point).dot(line_->shape.direction));
  }
  return robust() ? Supported(places, circle_ ? kTurn : HUGE_VAL) : places;
}

template <int Dim>
NurbsCurve<Dim> CurvePrimitive::LocalSegment() {
  FittedLine& line = line_->shape;
  const Eigen::Vector3d along = data_.points.rightCols<1>() - data_.points.col(0);
  if (along.dot(line.direction) < 0) line.direction = -line.direction;
  const std::vector<double> places = Places();
  const auto [low, high] = std::minmax_element(places.begin(), places.end());
  if (!(*high > *low)) {
    RefuseCurve("the points have one foot on their line: they do not say how long it is");
  }
  input_.report.input.spacing =
      input_.unit * (*high - *low) / static_cast<double>(places.size() - 1);
  const auto at = [&](double place) {
    return (line.point + place * line.direction).template head<Dim>().eval();
  };
  return MakeLine<Dim>(at(*low), at(*high));
}

template <int Dim>
NurbsCurve<Dim> CurvePrimitive::LocalArc() {
  FittedCircle& circle = circle_->shape;
  if (Clockwise()) circle.tangent = -circle.tangent;
  const std::vector<double> places = Places();
  const AngleRange extent = ArcCovered(places);
  if (!(extent.sweep > 0)) {
    RefuseCurve("the points have one foot on their circle: they do not say how long its arc is");
  }
  sweep_ = extent.sweep;
  input_.report.geometry.closed = {extent.full()};
  const double steps = static_cast<double>(places.size() - (extent.full() ? 0 : 1));
  input_.report.input.spacing = input_.unit * extent.sweep / circle.curvature / steps;
  // From the circle's point and not from its centre: flat arcs are exact to rounding of their own
  // size.
  return MakeFlatArc<Dim>(circle.point.template head<Dim>().eval(),
                          circle.outward.template head<Dim>().eval(),
                          circle.tangent.template head<Dim>().eval(),
                          circle.curvature,
                          extent);
}

// Whether the circle's axis must be reversed: in the plane it points up; in space the points, in
// their order, go round it counter-clockwise on balance.
bool CurvePrimitive::Clockwise() const {
  const FittedCircle& circle = circle_->shape;
  if (data_.plane) return circle.Axis().z() < 0;
  double turned = 0, last = circle.AngleOf(data_.points.col(0));
  for (Eigen::Index k = 1; k < data_.points.cols(); ++k) {
    const double angle = circle.AngleOf(data_.points.col(k));
    turned += std::sin(angle - last);
    last = angle;
  }
  return turned < 0;
}

double CurvePrimitive::Sigma() const {
  double squares = 0;
  for (const Eigen::Index k : Used()) {
    const Eigen::Vector3d p = data_.points.col(k);
    const double d = circle_ ? circle_->shape.Distance(p) : line_->shape.Distance(p);
    squares += data_.weights[k] * d * d;
  }
  return std::max(input_.rounding, std::sqrt(squares / FreedomsLeft()));
}

double CurvePrimitive::FreedomsLeft() const {
  const double components = static_cast<double>(Used().size()) * (data_.plane ? 1 : 2);
  return std::max(1.0, components - (circle_ ? Freedoms<FittedCircle>() : Freedoms<FittedLine>()));
}

double CurvePrimitive::Surprise() const {
  const double sigma = Sigma();
  const auto count = static_cast<double>(Used().size());
  const std::vector<double> places = Places();
  double length = 0;
  if (circle_) {
    length = ArcCovered(places).sweep / circle_->shape.curvature;
  } else {
    const auto [low, high] = std::minmax_element(places.begin(), places.end());
    length = *high - *low;
  }
  const double spread = std::log(2 * std::numbers::pi * std::numbers::e * sigma * sigma);
  const int freedoms = circle_ ? Freedoms<FittedCircle>() : Freedoms<FittedLine>();
  return count * (2 * spread + 2 * std::log(std::max(length, sigma))) +
         freedoms * std::log(2 * count) +
         input_.Anywhere(data_.points.cols() - static_cast<Eigen::Index>(count));
}

// Errors are measured on the curve that is returned, so that rounding of large coordinates is
// included.
template <int Dim>
PrimitiveFit CurvePrimitive::Measure() {
  if (Used().size() < 2)
    RefuseCurve("the loss leaves fewer than two points: its scale is too small");
  input_.report.geometry.closed = {false};
  const double scale = circle_ ? circle_->scale : line_->scale;
  const NurbsCurve<Dim> curve = circle_ ? LocalArc<Dim>() : LocalSegment<Dim>();
  const Eigen::Matrix<double, Dim, 1> place = (input_.middle + input_.move).template head<Dim>();
  NurbsCurve<Dim> written(
      curve.basis(), (input_.unit * curve.control_points()).colwise() + place, curve.weights());
  const NurbsCurve<Dim> measured = Translated(written, -input_.move.template head<Dim>());
  const PointDistances found = DistancesTo<Dim>(measured, input_.points(), input_.pool);
  PrimitiveSummary summary = Summary(scale);
  const std::vector<Eigen::Index>& place_of = input_.merged.place;
  PrimitiveFit fit{{},
                   std::move(written),
                   found.parameters(Eigen::all, place_of),
                   found.distances(place_of),
                   Forgotten(),
                   {}};
  if (circle_) {
    fit.shape = CircleShape{*summary.center, *summary.axis, *summary.radius};
  } else {
    fit.shape = LineShape{*summary.point, *summary.direction};
  }
  input_.report.geometry.degree = {measured.basis().degree()};
  input_.report.geometry.control_points = {measured.basis().size()};
  input_.report.geometry.rational = measured.rational();
  FinishReport(input_, std::move(summary), "curve", fit);
  return fit;
}

// The points that do not count.
PointMask CurvePrimitive::Forgotten() const {
  PointMask merged = PointMask::Constant(data_.points.cols(), true);
  for (const Eigen::Index k : Used()) merged[k] = false;
  return merged(input_.merged.place);
}

PrimitiveSummary CurvePrimitive::Summary(double scale) const {
  PrimitiveSummary summary;
  summary.kind = Name(circle_ ? PrimitiveKind::kCircle : PrimitiveKind::kLine);
  summary.scale = input_.unit * scale;
  summary.why = why_;
  const Eigen::Vector3d place = input_.middle + input_.move;
  const ShapeLoss loss{loss_, scale};
  if (circle_) {
    const FittedCircle& circle = circle_->shape;
    summary.center = place + input_.unit * circle.Center();
    summary.axis = circle.Axis().normalized();
    summary.radius = input_.unit / circle.curvature;
    summary.sweep = sweep_;
    summary.accuracy = AccuracyOf(circle, data_, circle_->used, loss, input_.rounding, input_.unit);
  } else {
    const FittedLine& line = line_->shape;
    summary.point = place + input_.unit * line.point;
    summary.direction = line.direction;
    summary.accuracy = AccuracyOf(line, data_, line_->used, loss, input_.rounding, input_.unit);
  }
  return summary;
}

PrimitiveFit CurvePrimitive::Fit() {
  input_.clock.Enter(&StageSeconds::project);
  return input_.plane() ? Measure<2>() : Measure<3>();
}

}  // namespace batten::internal
