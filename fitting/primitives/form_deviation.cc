// SPDX-License-Identifier: MIT
#include "batten/fitting/form_deviation.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "fitting/core/mask_indices.h"
#include "fitting/primitives/linear_chebyshev.h"
#include "geometry/numeric/enum_name.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kMostSteps = 30;
constexpr double kSettled = 1e-10;  // of the width: a step that gains less ends

// A shape by a point, a direction (normal or axis) and a radius; what it has not is not looked at.
struct FormShape {
  enum class Kind { kPlane, kCircle, kSphere, kCylinder } kind;
  Eigen::Vector3d point, direction;
  double radius = 0;

  int freedoms() const {
    switch (kind) {
      case Kind::kPlane:
        return 3;
      case Kind::kCircle:
        return 3;
      case Kind::kSphere:
        return 4;
      case Kind::kCylinder:
        return 5;
    }
    return 0;
  }

  // The residual of a point and its derivatives by turns of the direction about its two normals,
  // shifts and the radius, in units of `unit`.
  double Residual(const Eigen::Vector3d& p,
                  const Eigen::Vector3d& x,
                  const Eigen::Vector3d& y,
                  double unit,
                  Eigen::MatrixXd::RowXpr row) const {
    const Eigen::Vector3d off = p - point;
    const double along = off.dot(direction);
    if (kind == Kind::kPlane) {
      row << -off.dot(x) / unit, -off.dot(y) / unit, -1;
      return along;
    }
    const bool round = kind != Kind::kSphere;
    const Eigen::Vector3d away = round ? Eigen::Vector3d(off - along * direction) : off;
    const double distance = away.norm();
    const Eigen::Vector3d e = distance > 0 ? Eigen::Vector3d(away / distance) : x;
    switch (kind) {
      case Kind::kCircle:
        row << -e.dot(x), -e.dot(y), -1;
        break;
      case Kind::kSphere:
        row << -e.dot(x), -e.dot(y), -e.dot(direction), -1;
        break;
      default:
        row << -e.dot(x), -e.dot(y), -along / unit * e.dot(x), -along / unit * e.dot(y), -1;
    }
    return distance - radius;
  }

  FormShape Moved(const Eigen::VectorXd& by,
                  const Eigen::Vector3d& x,
                  const Eigen::Vector3d& y,
                  double unit) const {
    FormShape moved = *this;
    switch (kind) {
      case Kind::kPlane:
        moved.direction = (direction - (by[0] * x + by[1] * y) / unit).normalized();
        moved.point += by[2] * direction;
        break;
      case Kind::kCircle:
        moved.point += by[0] * x + by[1] * y;
        moved.radius += by[2];
        break;
      case Kind::kSphere:
        moved.point += by[0] * x + by[1] * y + by[2] * direction;
        moved.radius += by[3];
        break;
      case Kind::kCylinder:
        moved.point += by[0] * x + by[1] * y;
        moved.direction = (direction + (by[2] * x + by[3] * y) / unit).normalized();
        moved.radius += by[4];
        break;
    }
    return moved;
  }
};

// The points' residuals, whose range is the width of the zone about the shape.
struct Residuals {
  Eigen::VectorXd values;
  Eigen::MatrixXd jacobian;
  double width = 0;

  Residuals(const FormShape& shape, const Eigen::Matrix3Xd& points, double unit)
      : values(points.cols()), jacobian(points.cols(), shape.freedoms()) {
    const Eigen::Vector3d x = shape.direction.unitOrthogonal(), y = shape.direction.cross(x);
    for (Eigen::Index k = 0; k < points.cols(); ++k)
      values[k] = shape.Residual(points.col(k), x, y, unit, jacobian.row(k));
    width = values.maxCoeff() - values.minCoeff();
  }
};

std::optional<FormShape> ShapeOf(const PrimitiveFit& fit) {
  using Kind = FormShape::Kind;
  if (const auto* plane = std::get_if<PlaneShape>(&fit.shape))
    return FormShape{Kind::kPlane, plane->point, plane->normal, 0};
  if (const auto* circle = std::get_if<CircleShape>(&fit.shape))
    return FormShape{Kind::kCircle, circle->center, circle->normal, circle->radius};
  if (const auto* sphere = std::get_if<SphereShape>(&fit.shape))
    return FormShape{Kind::kSphere, sphere->center, Eigen::Vector3d::UnitZ(), sphere->radius};
  if (const auto* cylinder = std::get_if<CylinderShape>(&fit.shape))
    return FormShape{Kind::kCylinder, cylinder->point, cylinder->axis, cylinder->radius};
  return std::nullopt;
}

const char* NameOf(FormShape::Kind kind) {
  static constexpr std::array kNames{"flatness", "roundness", "sphericity", "cylindricity"};
  return NameIn<FormShape::Kind::kCylinder>(kNames, kind);
}

// Chebyshev steps, each as far as it makes the zone narrower.
double MinimumZone(FormShape shape, const Eigen::Matrix3Xd& points, double unit) {
  Residuals now(shape, points, unit);
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::Vector3d x = shape.direction.unitOrthogonal(), y = shape.direction.cross(x);
    const Eigen::VectorXd by = SolveChebyshev(now.jacobian, now.values).x;
    bool gained = false;
    double share = 1;
    for (int halving = 0; halving < 30 && !gained; ++halving, share /= 2) {
      const FormShape trial = shape.Moved(share * by, x, y, unit);
      Residuals then(trial, points, unit);
      if (!(then.width < now.width * (1 - kSettled))) continue;
      shape = trial;
      now = std::move(then);
      gained = true;
    }
    if (!gained) break;
  }
  return now.width;
}

}  // namespace

bool HasForm(const PrimitiveFit& fit) { return ShapeOf(fit).has_value(); }

FormDeviation FormDeviationOf(const PrimitiveFit& fit,
                              const PointCloud& cloud,
                              const Eigen::Vector3d& shift) {
  std::optional<FormShape> shape = ShapeOf(fit);
  if (!shape)
    throw std::invalid_argument(
        "FormDeviationOf: fit: only a plane, circle, sphere or cylinder "
        "has a deviation of form");
  if (fit.outliers.size() != cloud.size())
    throw std::invalid_argument("FormDeviationOf: cloud: is not the one that was fitted");
  const std::vector<Eigen::Index> used = internal::IndicesOf(!fit.outliers);
  FormDeviation form;
  form.name = NameOf(shape->kind);
  form.points = std::ssize(used);
  if (form.points <= shape->freedoms()) return form;
  // About the middle of the points, where turns and shifts are told apart best.
  const Eigen::Matrix3Xd local = cloud.points()(Eigen::all, used);
  const Eigen::Vector3d middle = local.rowwise().mean();
  const Eigen::Matrix3Xd points = local.colwise() - middle;
  shape->point -= middle + cloud.origin() - shift;
  if (shape->kind == FormShape::Kind::kPlane || shape->kind == FormShape::Kind::kCylinder)
    shape->point -=
        (shape->kind == FormShape::Kind::kPlane)
            ? Eigen::Vector3d(shape->point - shape->direction.dot(shape->point) * shape->direction)
            : Eigen::Vector3d(shape->direction.dot(shape->point) * shape->direction);
  const double unit = points.colwise().norm().maxCoeff();
  form.least_squares = Residuals(*shape, points, unit).width;
  form.minimum_zone = MinimumZone(*shape, points, unit);
  form.deviation = std::sqrt(2.0) * fit.report.input.noise;
  return form;
}

}  // namespace batten
