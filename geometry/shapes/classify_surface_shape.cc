// SPDX-License-Identifier: MIT
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include "batten/geometry/classify_shape.h"
#include "geometry/bezier/steady_sections.h"
#include "geometry/numeric/conic_fit.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/nurbs/homogeneous.h"
#include "geometry/shapes/local_points.h"
#include "geometry/shapes/revolved_circle.h"

namespace batten {
using namespace internal;
namespace {

// One row for each row of the net: the weights as coefficients along `direction`.
Eigen::MatrixXd WeightRows(const NurbsSurface& surface, Direction direction) {
  const Eigen::Map<const Eigen::MatrixXd> net(
      surface.weights().data(), surface.size_v(), surface.size_u());
  return direction == Direction::kU ? Eigen::MatrixXd(net) : Eigen::MatrixXd(net.transpose());
}

// At most so many, evenly chosen.
std::vector<Section> Thinned(const std::vector<Section>& sections, int most) {
  if (std::ssize(sections) <= most) return sections;
  std::vector<Section> chosen;
  for (int k = 0; k < most; ++k) {
    chosen.push_back(sections[k * (std::ssize(sections) - 1) / (most - 1)]);
  }
  return chosen;
}

// A surface of about unit size, what is fitted, and what checks it.
class Samples {
 public:
  explicit Samples(const NurbsSurface& surface) : surface_(surface) {
    for (const Direction direction : {Direction::kU, Direction::kV}) {
      sections_[Index(direction)] =
          SteadySections(BasisOf(surface, direction), WeightRows(surface, direction));
    }
    TakePoints();
    TakeNormals();
  }

  // To be fitted, and places inside the sections with their normals, where there is one.
  const Eigen::Matrix3Xd& points() const { return points_; }
  const Eigen::Matrix3Xd& places() const { return places_; }
  const Eigen::Matrix3Xd& normals() const { return normals_; }

  // Of the surface, if it were everywhere stretched as where it is most.
  double area() const { return area_; }

  // `holds(u, v)` on a grid of every section that determines an implicit form of this degree in the
  // coordinates: along a section it is a polynomial of degree · p over powers of the weight.
  template <typename Law>
  bool Everywhere(int degree, const Law& holds) const {
    const std::vector<double> in_u = CheckParameters(Direction::kU, degree);
    const std::vector<double> in_v = CheckParameters(Direction::kV, degree);
    for (const double u : in_u) {
      for (const double v : in_v) {
        if (!holds(u, v)) return false;
      }
    }
    return true;
  }

  // All fitted points first: what is not the shape fails there, soon.
  template <typename Distance>
  bool Within(double tolerance, int degree, const Distance& distance) const {
    for (const auto& p : points_.colwise()) {
      if (!(std::abs(distance(Eigen::Vector3d(p))) <= tolerance)) return false;
    }
    return Everywhere(degree, [&](double u, double v) {
      return std::abs(distance(surface_.At(u, v))) <= tolerance;
    });
  }

 private:
  static int Index(Direction direction) { return direction == Direction::kU ? 0 : 1; }

  // Ends included: the tip of a cone tells most about it.
  void TakePoints() {
    const std::vector<double> in_u = FitParameters(Direction::kU, WithEnds);
    const std::vector<double> in_v = FitParameters(Direction::kV, WithEnds);
    points_.resize(3, std::ssize(in_u) * std::ssize(in_v));
    Eigen::Index column = 0;
    for (const double u : in_u) {
      for (const double v : in_v) points_.col(column++) = surface_.At(u, v);
    }
  }

  void TakeNormals() {
    const std::vector<double> in_u = FitParameters(Direction::kU, Inside);
    const std::vector<double> in_v = FitParameters(Direction::kV, Inside);
    places_.resize(3, std::ssize(in_u) * std::ssize(in_v));
    normals_.resize(3, places_.cols());
    Eigen::Index column = 0;
    for (const double u : in_u) {
      for (const double v : in_v) {
        const SurfaceJet jet = surface_.JetAt(u, v);
        const auto normal = UnitNormal(jet);
        area_ = std::max(area_, jet.du.cross(jet.dv).norm());
        if (!normal) continue;
        places_.col(column) = jet.point;
        normals_.col(column++) = *normal;
      }
    }
    places_.conservativeResize(3, column);
    normals_.conservativeResize(3, column);
    for (const SplineBasis* basis : {&surface_.basis_u(), &surface_.basis_v()}) {
      area_ *= basis->upper() - basis->lower();
    }
  }

  template <typename Nodes>
  std::vector<double> FitParameters(Direction direction, const Nodes& nodes) const {
    constexpr int kMostSections = 12, kWanted = 20;
    const std::vector<Section> chosen = Thinned(sections_[Index(direction)], kMostSections);
    const int degree = BasisOf(surface_, direction).degree();
    const int count = std::clamp(kWanted / static_cast<int>(std::ssize(chosen)), 3, 2 * degree + 5);
    std::vector<double> parameters;
    for (const Section& section : chosen) {
      for (const double t : nodes(section, count)) parameters.push_back(t);
    }
    return parameters;
  }

  std::vector<double> CheckParameters(Direction direction, int degree) const {
    const int count = degree * BasisOf(surface_, direction).degree() + 3;
    std::vector<double> parameters;
    for (const Section& section : sections_[Index(direction)]) {
      for (const double t : WithEnds(section, count)) parameters.push_back(t);
    }
    return parameters;
  }

  const NurbsSurface& surface_;
  std::array<std::vector<Section>, 2> sections_;
  Eigen::Matrix3Xd points_, places_, normals_;
  double area_ = 0;
};

// The direction that all columns are nearest to being perpendicular to.
Eigen::Vector3d LeastDirection(const Eigen::Matrix3Xd& columns) {
  return NullVector(columns.transpose());
}

class Classifier {
 public:
  Classifier(const NurbsSurface& local, const LocalFrame& frame, double relative)
      : local_(local), samples_(local), frame_(frame) {
    const Eigen::Matrix3Xd& points = samples_.points();
    if (samples_.places().cols() < kFewest) return;
    size_ = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
    tolerance_ = frame.Tolerance(relative, size_);
  }

  SurfaceShape Shape() const {
    if (!(size_ > tolerance_) || !(samples_.area() > tolerance_ * size_)) return FreeForm{};
    if (const SurfaceShape shape = Plane(); Found(shape)) return shape;
    if (const SurfaceShape shape = Sphere(); Found(shape)) return shape;
    const auto cylinder = FittedCylinder();
    if (cylinder) {
      if (const SurfaceShape shape = Cylinder(*cylinder); Found(shape)) return shape;
    }
    const Axis axis = AxisOfNormals();
    const auto about = About(axis);
    // A small patch hardly tells its axis by its normals: the cylinder's is another start.
    for (const auto& start : {about, cylinder}) {
      if (!start) continue;
      if (const SurfaceShape shape = Cone(*start); Found(shape)) return shape;
    }
    if (about) {
      if (const SurfaceShape shape = TorusOrCone(*about); Found(shape)) return shape;
    }
    if (const SurfaceShape shape = Revolution(axis); Found(shape)) return shape;
    return Extrusion();
  }

 private:
  static constexpr int kFewest = 9;

  // A line in the local frame.
  struct Axis {
    Eigen::Vector3d point, direction;
  };

  static bool Found(const SurfaceShape& shape) { return !std::holds_alternative<FreeForm>(shape); }

  SurfaceShape Plane() const {
    const Eigen::Vector3d middle = samples_.points().rowwise().mean();
    const Eigen::Vector3d normal = LeastDirection(samples_.points().colwise() - middle);
    if (!samples_.Within(
            tolerance_, 1, [&](const Eigen::Vector3d& p) { return normal.dot(p - middle); })) {
      return FreeForm{};
    }
    const bool against = normal.dot(samples_.normals().col(0)) < 0;
    return PlaneShape{frame_.Point(middle), against ? Eigen::Vector3d(-normal) : normal};
  }

  // α|x|² + δ·x + γ = 0 about the middle, each coordinate stretched to one: see PlaneConic.
  SurfaceShape Sphere() const {
    const Eigen::Vector3d middle = samples_.points().rowwise().mean();
    const Eigen::Matrix3Xd centred = samples_.points().colwise() - middle;
    const Eigen::Matrix3d axes = SingularValuesOf(centred.transpose()).v;
    const Eigen::Matrix3Xd turned = axes.transpose() * centred;
    Eigen::Vector3d stretch = turned.rowwise().lpNorm<Eigen::Infinity>();
    for (double& s : stretch) {
      if (!(s > 0)) s = 1;  // all fitted points in one plane, others not
    }
    Eigen::MatrixXd design(centred.cols(), 5);
    design << turned.colwise().squaredNorm().transpose(),
        (stretch.cwiseInverse().asDiagonal() * turned).transpose(),
        Eigen::VectorXd::Ones(centred.cols());
    const Eigen::VectorXd v = NullVector(design);
    const Eigen::Vector3d linear = v.segment<3>(1).cwiseQuotient(stretch);
    const double alpha = v[0], gamma = v[4];
    const double square = linear.squaredNorm() - 4 * alpha * gamma;
    if (!(square > 0)) return FreeForm{};
    // |x − c| − R = 2 F / (|∇F| + sqrt(square)), which holds as α goes to zero.
    const bool lies = samples_.Within(tolerance_, 2, [&](const Eigen::Vector3d& p) {
      const Eigen::Vector3d x = axes.transpose() * (p - middle);
      const double F = alpha * x.squaredNorm() + linear.dot(x) + gamma;
      return 2 * F / ((2 * alpha * x + linear).norm() + std::sqrt(square));
    });
    const Eigen::Vector3d center = axes * linear / (-2 * alpha);
    if (!lies || !center.allFinite()) return FreeForm{};
    return SphereShape{frame_.Point(middle + center),
                       frame_.Length(std::sqrt(square) / std::abs(2 * alpha))};
  }

  // On a shape of the kind every start is near it: others are not worth the steps.
  RevolvedCircle Fitted(RevolvedKind kind, const RevolvedCircle& start) const {
    constexpr double kNear = 1e-2;
    double squares = 0;
    for (const auto& p : samples_.points().colwise()) squares += std::pow(start.Distance(p), 2);
    const double rms = std::sqrt(squares / static_cast<double>(samples_.points().cols()));
    if (!(rms <= std::max(kNear * size_, 10 * tolerance_))) return start;
    return FitRevolved(kind, start, samples_.points());
  }

  bool LiesOn(const RevolvedCircle& shape) const {
    const int degree = shape.curvature == 0 ? 2 : 4;
    return samples_.Within(
        tolerance_, degree, [&](const Eigen::Vector3d& p) { return shape.Distance(p); });
  }

  // The place nearest to the middle of all.
  Eigen::Index Central() const {
    const Eigen::Vector3d middle = samples_.places().rowwise().mean();
    Eigen::Index k;
    (samples_.places().colwise() - middle).colwise().squaredNorm().minCoeff(&k);
    return k;
  }

  // All normals are perpendicular to the axis; seen along it, the samples lie on a circle.
  std::optional<RevolvedCircle> FittedCylinder() const {
    RevolvedCircle start;
    start.axis = LeastDirection(samples_.normals());
    const Eigen::Index k = Central();
    start.point = samples_.places().col(k);
    const Eigen::Vector3d normal = samples_.normals().col(k);
    start.outward = (normal - normal.dot(start.axis) * start.axis).normalized();
    Eigen::Matrix<double, 2, 3> across;
    across << start.outward.transpose(), start.axis.cross(start.outward).transpose();
    const auto circle = CircleOf(FitCircle(across * (samples_.points().colwise() - start.point)));
    if (!circle) return std::nullopt;
    start.outward = (across.transpose() * -circle->center).normalized();
    start.axis_curvature = 1 / circle->center.norm();
    return Fitted(RevolvedKind::kCylinder, start);
  }

  SurfaceShape Cylinder(const RevolvedCircle& shape) const {
    if (!(shape.axis_curvature > 0) || !LiesOn(shape)) return FreeForm{};
    return CylinderShape{frame_.Point(shape.point - shape.outward / shape.axis_curvature),
                         shape.axis,
                         frame_.Length(1 / shape.axis_curvature)};
  }

  // The line that comes nearest to meeting the normals of all samples: n·m + (p × n)·d = 0 with its
  // direction d and moment m. [Pottmann & Randrup 1998]
  Axis AxisOfNormals() const {
    const Eigen::Index count = samples_.places().cols();
    const Eigen::Vector3d middle = samples_.places().rowwise().mean();
    Eigen::MatrixXd design(count, 6);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Vector3d n = samples_.normals().col(k), p = samples_.places().col(k) - middle;
      design.row(k) << p.cross(n).transpose(), n.transpose();
    }
    const Eigen::VectorXd v = NullVector(design);
    const double length = v.head<3>().norm();
    const Eigen::Vector3d d = v.head<3>() / length, m = v.tail<3>() / length;
    return {middle + d.cross(m), d};
  }

  // A cone about the axis that touches the surface at the place farthest from it.
  std::optional<RevolvedCircle> About(const Axis& axis) const {
    if (!axis.direction.allFinite() || !axis.point.allFinite()) return std::nullopt;
    RevolvedCircle start;
    start.axis = axis.direction;
    Eigen::Index far = 0;
    const Eigen::Matrix3Xd from = samples_.places().colwise() - axis.point;
    const Eigen::Matrix3Xd across = from - axis.direction * (axis.direction.transpose() * from);
    const double radius = std::sqrt(across.colwise().squaredNorm().maxCoeff(&far));
    start.point = samples_.places().col(far);
    start.outward = across.col(far) / radius;
    start.axis_curvature = 1 / radius;
    if (!start.outward.allFinite() || !std::isfinite(start.axis_curvature)) return std::nullopt;
    const Eigen::Vector3d normal = samples_.normals().col(far);
    start.slope = std::atan2(normal.dot(start.axis), normal.dot(start.outward));
    return start;
  }

  // ξ of all samples.
  Eigen::Matrix2Xd Meridian(const RevolvedCircle& about) const {
    const Eigen::Matrix3Xd from = samples_.points().colwise() - about.point;
    Eigen::Matrix2Xd profile(2, from.cols());
    const Eigen::Vector3d to_axis = about.outward / about.axis_curvature;
    for (Eigen::Index k = 0; k < from.cols(); ++k) {
      const double height = from.col(k).dot(about.axis);
      profile.col(k) << (from.col(k) - height * about.axis + to_axis).norm() - to_axis.norm(),
          height;
    }
    return profile;
  }

  SurfaceShape Cone(RevolvedCircle start) const {
    start.curvature = 0;
    const RevolvedCircle shape = Fitted(RevolvedKind::kCone, start);
    if (!(shape.axis_curvature > 0) || !LiesOn(shape)) return FreeForm{};
    // From `point` along the profile line, which is perpendicular to ν, down to the axis.
    const double c = std::cos(shape.slope), s = std::sin(shape.slope);
    const double to_apex = c / (s * shape.axis_curvature);
    if (!std::isfinite(to_apex)) return FreeForm{};
    const Eigen::Vector3d apex =
        shape.point - shape.outward / shape.axis_curvature + to_apex * shape.axis;
    return ConeShape{frame_.Point(apex),
                     to_apex > 0 ? Eigen::Vector3d(-shape.axis) : shape.axis,
                     std::atan(std::abs(s / c))};
  }

  // The profile is a circle; of a spindle, one or both of its arcs in the half-plane: then the
  // outer one alone is the start.
  SurfaceShape TorusOrCone(const RevolvedCircle& about) const {
    const Eigen::Matrix2Xd profile = Meridian(about);
    const SurfaceShape torus = Torus(about, profile);
    if (Found(torus)) return torus;
    constexpr double kOuter = 0.15;
    const double radius = 1 / about.axis_curvature;
    Eigen::Matrix2Xd outer(2, profile.cols());
    Eigen::Index count = 0;
    for (const auto& xi : profile.colwise()) {
      if (xi[0] > -kOuter * radius) outer.col(count++) = xi;
    }
    constexpr Eigen::Index kFewestOfACircle = 3;
    if (count < kFewestOfACircle) return FreeForm{};
    return Torus(about, outer.leftCols(count));
  }

  SurfaceShape Torus(RevolvedCircle start, const Eigen::Matrix2Xd& profile) const {
    const auto circle = CircleOf(FitCircle(profile));
    if (!circle) return FreeForm{};
    start.slope = std::atan2(circle->center[1], circle->center[0]);
    start.curvature = 1 / circle->center.norm();
    const RevolvedCircle shape = Fitted(RevolvedKind::kTorus, start);
    if (!(shape.axis_curvature > 0) || shape.curvature == 0 || !LiesOn(shape)) return FreeForm{};
    // So may a cone that is nearly a plane.
    const SurfaceShape cone = Cone(shape);
    if (Found(cone)) return cone;
    const double radius = 1 / shape.curvature;
    const double over = 1 / shape.axis_curvature + radius * std::cos(shape.slope);
    const Eigen::Vector3d center = shape.point - shape.outward / shape.axis_curvature +
                                   radius * std::sin(shape.slope) * shape.axis;
    return TorusShape{frame_.Point(center),
                      shape.axis,
                      frame_.Length(std::abs(over)),
                      frame_.Length(std::abs(radius))};
  }

  // Whether every normal is perpendicular to the motion at its place.
  template <typename Motion>
  bool SlidesAlongItself(const Motion& motion) const {
    const auto stays = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
      return std::abs(n.dot(motion(p))) <= tolerance_;
    };
    for (Eigen::Index k = 0; k < samples_.places().cols(); ++k) {
      if (!stays(samples_.places().col(k), samples_.normals().col(k))) return false;
    }
    return samples_.Everywhere(4, [&](double u, double v) {
      const SurfaceJet jet = local_.JetAt(u, v);
      const auto normal = UnitNormal(jet);
      return !normal || stays(jet.point, *normal);
    });
  }

  SurfaceShape Revolution(const Axis& axis) const {
    if (!axis.direction.allFinite() || !axis.point.allFinite() ||
        !SlidesAlongItself([&](const Eigen::Vector3d& p) {
          return axis.direction.cross(p - axis.point).eval();
        })) {
      return FreeForm{};
    }
    return RevolutionShape{frame_.Point(axis.point), axis.direction};
  }

  SurfaceShape Extrusion() const {
    const Eigen::Vector3d direction = LeastDirection(samples_.normals());
    const Eigen::Vector3d motion = size_ * direction;
    if (!SlidesAlongItself([&](const Eigen::Vector3d&) { return motion; })) return FreeForm{};
    return ExtrusionShape{direction};
  }

  const NurbsSurface& local_;
  const Samples samples_;
  const LocalFrame& frame_;
  double size_ = 0, tolerance_ = 0;
};

}  // namespace

SurfaceShape ClassifyShape(const NurbsSurface& surface, const ClassifyOptions& options) {
  if (!(options.tolerance > 0)) {
    throw std::invalid_argument("ClassifyShape: tolerance = " + std::to_string(options.tolerance) +
                                " is not positive");
  }
  const LocalFrame frame(surface.control_points());
  if (frame.collapsed()) return FreeForm{};
  const NurbsSurface local(surface.basis_u(),
                           surface.basis_v(),
                           frame.ToLocal(surface.control_points()),
                           surface.weights());
  return Classifier(local, frame, options.tolerance).Shape();
}

}  // namespace batten
