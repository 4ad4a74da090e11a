// SPDX-License-Identifier: MIT
#include "batten/geometry/transform.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "geometry/numeric/number_text.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

// Control points after the map, and the factors that their weights take: all ones if it is affine.
struct Image {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd factors;
};

// Divides by the last coordinate; the homogeneous point (w·P, w) goes to (w·f·P', w·f).
Image MapPoints(const Eigen::Matrix4d& matrix, const Eigen::Matrix3Xd& points) {
  if (!matrix.allFinite()) Reject("Transformed", "the matrix is not finite");
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  const Eigen::Vector3d shift = matrix.topRightCorner<3, 1>();
  const Eigen::Vector3d row = matrix.bottomLeftCorner<1, 3>().transpose();
  const double corner = matrix(3, 3);
  const bool affine = row.isZero(0);
  Image image{Eigen::Matrix3Xd(3, points.cols()), Eigen::VectorXd::Ones(points.cols())};
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d P = points.col(i);
    const double f = row.dot(P) + corner;
    if (!(f > 4 * kEpsilon * (row.cwiseAbs().dot(P.cwiseAbs()) + std::abs(corner)))) {
      Reject(
          "Transformed",
          "control point " + std::to_string(i) +
              " lies on or behind the plane that the matrix sends to infinity (its weight would be "
              "multiplied by " +
              NumberText(f) + ")");
    }
    image.points.col(i) = (linear * P + shift) / f;
    if (!affine) image.factors[i] = f;
    if (!image.points.col(i).allFinite() || !std::isfinite(f)) {
      Reject("Transformed", "the image of control point " + std::to_string(i) + " is not finite");
    }
  }
  return image;
}

// Rounding of matrices made by products of turns and shifts is not held against them.
void CheckKeepsThePlane(const Eigen::Matrix4d& matrix) {
  if (!matrix.allFinite()) Reject("Transformed", "the matrix is not finite");
  constexpr double kAllowed = 64 * kEpsilon;
  const double turn = matrix.topLeftCorner<3, 2>().cwiseAbs().maxCoeff();
  const double shift = matrix.topRightCorner<3, 1>().cwiseAbs().maxCoeff();
  if (std::max(std::abs(matrix(2, 0)), std::abs(matrix(2, 1))) <= kAllowed * turn &&
      std::abs(matrix(2, 3)) <= kAllowed * shift) {
    return;
  }
  Reject("Transformed",
         "the matrix moves a plane curve out of its plane z = 0 (its third row is " +
             NumberText(matrix(2, 0)) + ", " + NumberText(matrix(2, 1)) + ", " +
             NumberText(matrix(2, 2)) + ", " + NumberText(matrix(2, 3)) + ")");
}

}  // namespace

NurbsSurface Transformed(const NurbsSurface& surface, const Eigen::Matrix4d& matrix) {
  Image image = MapPoints(matrix, surface.control_points());
  return NurbsSurface(surface.basis_u(),
                      surface.basis_v(),
                      std::move(image.points),
                      surface.weights().cwiseProduct(image.factors))
      .WithTrims(surface.trims());
}

template <int Dim>
NurbsCurve<Dim> Transformed(const NurbsCurve<Dim>& curve, const Eigen::Matrix4d& matrix) {
  if constexpr (Dim == 2) CheckKeepsThePlane(matrix);
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, curve.basis().size());
  points.topRows<Dim>() = curve.control_points();
  const Image image = MapPoints(matrix, points);
  return NurbsCurve<Dim>(
      curve.basis(), image.points.topRows<Dim>(), curve.weights().cwiseProduct(image.factors));
}

template NurbsCurve<2> Transformed(const NurbsCurve<2>&, const Eigen::Matrix4d&);
template NurbsCurve<3> Transformed(const NurbsCurve<3>&, const Eigen::Matrix4d&);

Eigen::Matrix4d Translation(const Eigen::Vector3d& shift) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topRightCorner<3, 1>() = shift;
  return matrix;
}

// The formula of Rodrigues, cos α·I + (1 − cos α)·aaᵀ + sin α·[a]×. About a coordinate axis the
// entries that should be 0 or 1 are.
Eigen::Matrix4d Rotation(const Eigen::Vector3d& axis, double angle) {
  const double length = axis.stableNorm();
  if (!std::isfinite(length) || !(length > 0)) {
    throw std::invalid_argument("Rotation: the axis is zero or not finite");
  }
  if (!std::isfinite(angle)) throw std::invalid_argument("Rotation: the angle is not finite");
  const Eigen::Vector3d a = axis / length;
  const double c = std::cos(angle), s = std::sin(angle);
  const double half = std::sin(angle / 2), d = 2 * half * half;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double square = a[i] * a[i];
    matrix(i, i) = square + c * (1 - square);
    matrix(i, j) = d * a[i] * a[j] - s * a[k];
    matrix(j, i) = d * a[i] * a[j] + s * a[k];
  }
  return matrix;
}

Eigen::Matrix4d Scaling(const Eigen::Vector3d& factors) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.diagonal().head<3>() = factors;
  return matrix;
}

Eigen::Matrix4d Scaling(double factor) {
  return batten::Scaling(Eigen::Vector3d::Constant(factor));
}

}  // namespace batten
