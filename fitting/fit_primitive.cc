// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_primitive.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "batten/fitting/circle_fit.h"
#include "batten/fitting/distances.h"
#include "batten/fitting/line_fit.h"
#include "batten/fitting/sample_consensus.h"
#include "batten/fitting/shape_data.h"
#include "batten/fitting/shape_extent.h"
#include "batten/fitting/stopwatch.h"
#include "batten/fitting/unit_of.h"

namespace batten {
namespace {

constexpr double kExact = 1e-12;  // of the size: what rounding leaves of exact points
constexpr double kSmallest = 1e-100, kLargest = 1e100;

[[noreturn]] void Refuse(const std::string& reason) { throw std::invalid_argument(reason); }

// One fit, stage by stage; members are what the stages hand on.
class PrimitiveFitter {
 public:
  PrimitiveFitter(const PointCloud& cloud, const PrimitiveFitOptions& options)
      : cloud_(cloud),
        options_(options),
        loss_(options.loss.value_or(Loss::kNone)),
        pool_(options.threads) {
    report_.threads = pool_.threads();
  }

  PrimitiveFit Run() {
    Prepare();
    line_ = Solved<FittedLine>();
    if (options_.kind != PrimitiveKind::kLine) SolveCircle();
    Choose();
    report_.seconds.solve = watch_.Lap();
    return data_.plane ? Measure<2>() : Measure<3>();
  }

 private:
  // Points without their duplicates, about their mean and of about unit size.
  void Prepare() {
    Report(options_.progress, "prepare", 0);
    InputSummary& input = report_.input;
    input.points = cloud_.size();
    if (cloud_.size() == 0) Refuse("there are no points");
    merged_ = MergeDuplicates(cloud_);
    const Eigen::Matrix3Xd& points = merged_.cloud.points();
    input.duplicates = merged_.duplicates;
    input.origin = cloud_.origin();
    input.box_min = cloud_.origin() + points.rowwise().minCoeff();
    input.box_max = cloud_.origin() + points.rowwise().maxCoeff();
    const bool circle = options_.kind == PrimitiveKind::kCircle;
    const Eigen::Index fewest = circle ? FittedCircle::kSample : FittedLine::kSample;
    if (points.cols() < fewest) {
      Refuse(std::string("a ") + Name(circle ? PrimitiveKind::kCircle : PrimitiveKind::kLine) +
             " needs at least " + std::to_string(fewest) + " different points; there " +
             (points.cols() == 1 ? "is " : "are ") + std::to_string(points.cols()));
    }
    const double size = (input.box_max - input.box_min).maxCoeff();
    if (!(size > kSmallest && size < kLargest)) {
      Refuse("the points' extent is not between 1e-100 and 1e100");
    }
    unit_ = UnitOf(points);
    middle_ = (points.rowwise().minCoeff() + points.rowwise().maxCoeff()) / 2;
    data_.points = (points.colwise() - middle_) / unit_;
    data_.plane = cloud_.dimension() == 2;
    const Eigen::VectorXd& weights = merged_.cloud.weights();
    data_.weights = weights.size() > 0 ? (weights / weights.mean()).eval()
                                       : Eigen::VectorXd::Ones(points.cols()).eval();
    const double far = (input.box_min.cwiseAbs().cwiseMax(input.box_max.cwiseAbs())).maxCoeff();
    rounding_ = std::max(kExact, 4 * std::numeric_limits<double>::epsilon() * far / size);
    report_.seconds.prepare = watch_.Lap();
  }

  bool robust() const { return loss_ != Loss::kNone; }

  // Where outliers are feared, what most points agree on.
  template <typename Shape>
  Shape StartOf(std::optional<double> scale) const {
    if (robust()) {
      const std::optional<Shape> agreed = Consensus<Shape>(data_, scale, options_.seed);
      if (agreed) return *agreed;
    }
    return Shape::Start(data_, pool_);
  }

  template <typename Shape>
  SettledShape<Shape> Solved() {
    Report(options_.progress, "solve", 0);
    Stopwatch watch;
    std::optional<double> scale = options_.loss_scale;
    if (scale) *scale /= unit_;
    const Shape start = StartOf<Shape>(scale);
    SettledShape<Shape> solved{start, 1, {}};
    if (robust()) {
      solved = Settled(data_, start, loss_, scale, rounding_, pool_);
    } else {
      constexpr int kSteps = 500;
      solved.shape = start.Minimised(data_, {}, kSteps, pool_);
      solved.used.resize(static_cast<size_t>(data_.points.cols()));
      std::iota(solved.used.begin(), solved.used.end(), Eigen::Index{0});
    }
    const Eigen::VectorXd distances = ShapeDistances(solved.shape, data_, pool_);
    if (!robust()) {
      const double squares = distances.cwiseAbs2().dot(data_.weights);
      solved.scale = std::max(rounding_, std::sqrt(squares / std::max(1.0, FreedomsLeft<Shape>())));
    }
    RoundSummary round;
    round.stage = Name(KindOf<Shape>());
    round.control_points_u = std::is_same_v<Shape, FittedLine> ? 2 : 9;
    round.rms = unit_ * std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size()));
    round.max = unit_ * distances.maxCoeff();
    round.score = unit_ * solved.scale;
    round.seconds = watch.Lap();
    report_.iterations.push_back(round);
    return solved;
  }

  template <typename Shape>
  static constexpr PrimitiveKind KindOf() {
    return std::is_same_v<Shape, FittedLine> ? PrimitiveKind::kLine : PrimitiveKind::kCircle;
  }

  // Numbers that are free in a line or circle.
  template <typename Shape>
  int Freedoms() const {
    if constexpr (std::is_same_v<Shape, FittedLine>) return data_.plane ? 2 : 4;
    return data_.plane ? 3 : 6;
  }

  double Components() const {
    return static_cast<double>(data_.points.cols() * (data_.plane ? 1 : 2));
  }

  template <typename Shape>
  double FreedomsLeft() const {
    return Components() - Freedoms<Shape>();
  }

  // With kAuto there need not be a circle.
  void SolveCircle() {
    std::optional<SettledShape<FittedCircle>> solved;
    const FittedLine line = FittedLine::Start(data_, pool_);
    if (data_.points.cols() >= FittedCircle::kSample &&
        ShapeDistances(line, data_, pool_).maxCoeff() > rounding_) {
      solved = Solved<FittedCircle>();
      solved->shape = solved->shape.Outward();
    }
    constexpr double kSagitta = 8;  // curvature over the height of an arc of length one
    if (solved && solved->shape.curvature > kSagitta * rounding_) {
      circle_ = std::move(solved);
    } else if (options_.kind == PrimitiveKind::kCircle) {
      Refuse("the points are collinear: the radius of their circle is infinite");
    }
  }

  // Σ w d², or where outliers are feared the sum of twice Tukey's loss.
  double CostOf(const auto& shape, double scale) const {
    const Loss loss = robust() ? Loss::kTukey : Loss::kNone;
    const Eigen::VectorXd distances = ShapeDistances(shape, data_, pool_);
    double sum = 0;
    for (Eigen::Index k = 0; k < distances.size(); ++k) {
      sum += data_.weights[k] * LossValue(loss, distances[k], scale);
    }
    return 2 * sum;
  }

  // Line or circle, and why.
  void Choose() {
    if (options_.kind == PrimitiveKind::kLine) {
      why_ = "asked for";
    } else if (!circle_) {
      why_ = data_.points.cols() < FittedCircle::kSample
                 ? "two points determine no more"
                 : "the points are on one line, to rounding";
    } else {
      const double evidence = Evidence(), threshold = Threshold();
      const bool bent = evidence > threshold;
      if (options_.kind == PrimitiveKind::kCircle) {
        why_ = "asked for";
        if (bent) return;
        report_.warnings.push_back(
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

  // How much likelier the circle makes the points than the line does: twice a logarithm, of normal
  // noise of unknown variance.
  double Evidence() const {
    const double scale = circle_->scale, variance = scale * scale;
    const double fall = std::max(0.0, CostOf(line_->shape, scale) - CostOf(circle_->shape, scale));
    const double left = std::max(1.0, FreedomsLeft<FittedCircle>());
    return left * std::log1p(fall / (left * variance));
  }

  double Threshold() const {
    const int more = Freedoms<FittedCircle>() - Freedoms<FittedLine>();
    const double left = std::max(1.0, FreedomsLeft<FittedCircle>());
    return 2 * more * std::log(Components()) * (1 + 2 / left);
  }

  // Where along a shape its points lie, in their order.
  template <typename Place>
  std::vector<double> PlacesOf(const std::vector<Eigen::Index>& used, Place place) const {
    std::vector<double> places;
    for (const Eigen::Index k : used) places.push_back(place(data_.points.col(k)));
    if (places.size() < 2) Refuse("the loss leaves fewer than two points: its scale is too small");
    return places;
  }

  template <int Dim>
  NurbsCurve<Dim> LocalSegment() {
    FittedLine& line = line_->shape;
    const Eigen::Vector3d along = data_.points.rightCols<1>() - data_.points.col(0);
    if (along.dot(line.direction) < 0) line.direction = -line.direction;
    std::vector<double> places = PlacesOf(line_->used, [&](const Eigen::Vector3d& p) {
      return (p - line.point).dot(line.direction);
    });
    if (robust()) places = Supported(places);
    const Extent extent = ExtentOnLine(places);
    if (!(extent.length > 0)) {
      Refuse("the points have one foot on their line: they do not say how long it is");
    }
    report_.input.spacing = unit_ * extent.length / static_cast<double>(places.size() - 1);
    return SegmentOf<Dim>(line, extent);
  }

  template <int Dim>
  NurbsCurve<Dim> LocalArc() {
    FittedCircle& circle = circle_->shape;
    if (Clockwise()) circle.tangent = -circle.tangent;
    std::vector<double> places =
        PlacesOf(circle_->used, [&](const Eigen::Vector3d& p) { return circle.AngleOf(p); });
    if (robust()) places = SupportedAngles(places);
    const Extent extent = ExtentOnCircle(places);
    if (!(extent.length > 0)) {
      Refuse("the points have one foot on their circle: they do not say how long its arc is");
    }
    sweep_ = extent.length;
    report_.geometry.closed = {extent.full};
    const double steps = static_cast<double>(places.size() - (extent.full ? 0 : 1));
    report_.input.spacing = unit_ * extent.length / circle.curvature / steps;
    return ArcOf<Dim>(circle, extent);
  }

  // In the plane, axes point up; in space the points go round them from each to the next, by and
  // large.
  bool Clockwise() const {
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

  // What is reported is measured on the curve as it is handed out, rounding of far coordinates
  // included.
  template <int Dim>
  PrimitiveFit Measure() {
    report_.geometry.closed = {false};
    const double scale = circle_ ? circle_->scale : line_->scale;
    const NurbsCurve<Dim> curve = circle_ ? LocalArc<Dim>() : LocalSegment<Dim>();
    const Eigen::Vector3d move = cloud_.origin() - options_.shift;
    const Eigen::Matrix<double, Dim, 1> place = (middle_ + move).template head<Dim>();
    NurbsCurve<Dim> written(
        curve.basis(), (unit_ * curve.control_points()).colwise() + place, curve.weights());
    const NurbsCurve<Dim> measured(
        written.basis(),
        written.control_points().colwise() - move.template head<Dim>().eval(),
        written.weights());
    const PointDistances found = DistancesTo<Dim>(measured, merged_.cloud.points(), pool_);
    PrimitiveFit fit{ShapeAt(middle_ + move),
                     std::move(written),
                     found.parameters.row(0)(merged_.place).transpose(),
                     found.distances(merged_.place),
                     Forgotten(),
                     {}};
    Summarise(fit, scale);
    report_.geometry.degree = {measured.basis().degree()};
    report_.geometry.control_points = {measured.basis().size()};
    report_.geometry.rational = measured.rational();
    report_.seconds.project = watch_.Lap();
    report_.seconds.total = total_.Lap();
    fit.report = std::move(report_);
    return fit;
  }

  // The points that do not count.
  PointMask Forgotten() const {
    PointMask merged = PointMask::Constant(data_.points.cols(), true);
    for (const Eigen::Index k : circle_ ? circle_->used : line_->used) merged[k] = false;
    return merged(merged_.place);
  }

  std::variant<LineShape, CircleShape> ShapeAt(const Eigen::Vector3d& place) const {
    if (!circle_) return LineShape{place + unit_ * line_->shape.point, line_->shape.direction};
    const FittedCircle& circle = circle_->shape;
    return CircleShape{
        place + unit_ * circle.Center(), circle.Axis().normalized(), unit_ / circle.curvature};
  }

  void Summarise(const PrimitiveFit& fit, double scale) {
    report_.error = batten::Summarise(fit.residuals, options_.tolerance, !fit.outliers);
    report_.error_all = batten::Summarise(fit.residuals, options_.tolerance);
    report_.input.used = report_.error.points;
    report_.input.outliers = fit.outliers.count();
    report_.input.noise = unit_ * scale;
    report_.termination = report_.tolerance_reached().value_or(false)
                              ? Termination::kToleranceReached
                          : options_.tolerance ? Termination::kStalled
                                               : Termination::kNoiseReached;
    PrimitiveSummary primitive;
    primitive.kind = Name(circle_ ? PrimitiveKind::kCircle : PrimitiveKind::kLine);
    primitive.scale = unit_ * scale;
    primitive.why = why_;
    if (const auto* circle = std::get_if<CircleShape>(&fit.shape)) {
      primitive.center = circle->center;
      primitive.axis = circle->normal;
      primitive.radius = circle->radius;
      primitive.sweep = sweep_;
    } else {
      const LineShape& line = std::get<LineShape>(fit.shape);
      primitive.point = line.point;
      primitive.direction = line.direction;
    }
    report_.geometry.kind = "curve";
    report_.geometry.base = primitive.kind;
    report_.geometry.primitive = std::move(primitive);
  }

  const PointCloud& cloud_;
  const PrimitiveFitOptions& options_;
  Loss loss_;
  mutable ThreadPool pool_;
  Stopwatch watch_, total_;
  FitReport report_;
  MergedCloud merged_;
  ShapeData data_;  // (points − middle_) / unit_
  double unit_ = 1;
  Eigen::Vector3d middle_;  // in the cloud's local coordinates
  double rounding_ = kExact;
  std::optional<SettledShape<FittedLine>> line_;
  std::optional<SettledShape<FittedCircle>> circle_;
  std::string why_;
  double sweep_ = 0;
};

[[noreturn]] void Reject(const std::string& rule) {
  throw std::invalid_argument("PrimitiveFitOptions: " + rule);
}

}  // namespace

const char* Name(PrimitiveKind kind) {
  switch (kind) {
    case PrimitiveKind::kAuto:
      return "auto";
    case PrimitiveKind::kLine:
      return "line";
    case PrimitiveKind::kCircle:
      return "circle";
  }
  return "";
}

void Check(const PrimitiveFitOptions& options) {
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    Reject("tolerance must be positive");
  }
  if (options.loss_scale && !(*options.loss_scale > 0 && std::isfinite(*options.loss_scale))) {
    Reject("loss_scale must be positive");
  }
  if (!options.shift.allFinite()) Reject("shift must be finite");
}

PrimitiveFit FitPrimitive(const PointCloud& cloud, const PrimitiveFitOptions& options) {
  Check(options);
  return PrimitiveFitter(cloud, options).Run();
}

}  // namespace batten
