// SPDX-License-Identifier: MIT
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "batten/geometry/classify_shape.h"
#include "geometry/bezier/steady_sections.h"
#include "geometry/numeric/conic_fit.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/shapes/local_points.h"

namespace batten {
using namespace internal;
namespace {

// SectionSamples of every section, `factor`·degree + `more` in each.
template <int Dim>
Eigen::Matrix3Xd SectionSamples(const NurbsCurve<Dim>& curve, int factor, int more) {
  const std::vector<Section> sections = SteadySections(curve.basis(), curve.weights().transpose());
  const int count = factor * curve.basis().degree() + more;
  Eigen::Matrix3Xd samples = Eigen::Matrix3Xd::Zero(3, std::ssize(sections) * count);
  Eigen::Index column = 0;
  for (const Section& section : sections) {
    for (const double u : WithEnds(section, count)) {
      samples.col(column++).template head<Dim>() = curve.At(u);
    }
  }
  return samples;
}

// Where the samples are spread: the longest direction first.
struct Spread {
  Eigen::Vector3d middle;
  Eigen::Matrix3d axes;  // columns

  explicit Spread(const Eigen::Matrix3Xd& samples) : middle(samples.rowwise().mean()) {
    const Eigen::MatrixXd centred = (samples.colwise() - middle).transpose();
    axes = SingularValuesOf(centred).v;
    if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
    // Seen from the tip of the last axis the curve turns left.
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 1; k < samples.cols(); ++k) {
      const Eigen::Vector3d step = samples.col(k) - samples.col(k - 1);
      turn += (samples.col(k) - samples.col(0)).cross(step);
    }
    if (turn.dot(axes.col(2)) < 0) axes.rightCols<2>() = -axes.rightCols<2>().eval();
  }
  Eigen::Matrix3Xd Local(const Eigen::Matrix3Xd& points) const {
    return axes.transpose() * (points.colwise() - middle);
  }
  Eigen::Vector3d Point(const Eigen::Vector2d& in_plane) const {
    return middle + axes.leftCols<2>() * in_plane;
  }
  Eigen::Vector3d Direction(const Eigen::Vector2d& in_plane) const {
    return (axes.leftCols<2>() * in_plane).normalized();
  }
};

// A conic in the plane of the spread, checked against points in the spread's frame.
bool LiesOn(const PlaneConic& conic, const Eigen::Matrix3Xd& local, double tolerance) {
  for (Eigen::Index k = 0; k < local.cols(); ++k) {
    const double off = conic.DistanceBound(local.col(k).head<2>());
    if (!(std::hypot(off, local(2, k)) <= tolerance)) return false;
  }
  return true;
}

CurveShape ToCircle(const PlaneConic& conic, const Spread& spread, const LocalFrame& frame) {
  const auto circle = CircleOf(conic);
  if (!circle) return FreeForm{};
  return CircleShape{
      frame.Point(spread.Point(circle->center)), spread.axes.col(2), frame.Length(circle->radius)};
}

// With x = across·e + along·f, F = n² across² + l_e across + l_f along + g, n the length of the
// vector whose square the quadratic part is.
CurveShape ToParabola(const PlaneConic& conic, const Spread& spread, const LocalFrame& frame) {
  const Eigen::Matrix2d M = conic.Quadratic();
  const double squared = M.trace();
  const int larger = std::abs(M(0, 0)) > std::abs(M(1, 1)) ? 0 : 1;
  const Eigen::Vector2d e = M.col(larger).normalized(), f(-e[1], e[0]);
  const double across = conic.Linear().dot(e), along = conic.Linear().dot(f);
  if (!(std::abs(squared) > 0) || !(std::abs(along) > 0)) return FreeForm{};
  const double at_e = -across / (2 * squared);
  const double at_f = (across * across / (4 * squared) - conic.Constant()) / along;
  const double sign = squared / along < 0 ? 1 : -1;
  return ParabolaShape{frame.Point(spread.Point(conic.Back(at_e * e + at_f * f))),
                       spread.Direction(conic.axes * f * sign),
                       spread.axes.col(2),
                       frame.Length(std::abs(along / (4 * squared)))};
}

// About its centre F = λ_0 x² + λ_1 y² + F_0.
CurveShape ToCentralConic(const PlaneConic& conic,
                          const Spread& spread,
                          const LocalFrame& frame,
                          const Eigen::Matrix3Xd& samples,
                          double tolerance) {
  const Eigen::Matrix2d M = conic.Quadratic();
  const Eigen::Vector2d center = M.inverse() * conic.Linear() / -2;
  const double value = conic.Constant() + conic.Linear().dot(center) / 2;
  if (!center.allFinite() || !std::isfinite(value)) return FreeForm{};
  const double angle = std::atan2(2 * M(0, 1), M(0, 0) - M(1, 1)) / 2;
  const Eigen::Matrix2d axes = Eigen::Rotation2Dd(angle).toRotationMatrix();
  Eigen::Vector2d lambda;
  const int strong = M.trace() >= 0 ? 0 : 1;
  lambda[strong] = axes.col(strong).dot(M * axes.col(strong));
  lambda[1 - strong] = M.determinant() / lambda[strong];
  const Eigen::Vector2d squares = -value * lambda.cwiseInverse();  // of the radii, signed
  const int first = squares[0] >= squares[1] ? 0 : 1;
  if (!squares.allFinite() || !(squares[first] > 0) || squares[1 - first] == 0) return FreeForm{};
  const Eigen::Vector3d middle = spread.Point(conic.Back(center));
  Eigen::Vector3d a = spread.Direction(conic.axes * axes.col(first));
  Eigen::Vector3d b = spread.Direction(conic.axes * axes.col(1 - first));
  const Eigen::Vector2d radii = squares.cwiseAbs().cwiseSqrt();
  const double first_radius = frame.Length(radii[first]), second = frame.Length(radii[1 - first]);
  if (squares[1 - first] > 0) {
    return EllipseShape{frame.Point(middle), a, b, first_radius, second};
  }
  // Nowhere farther from its asymptotes than this, at the vertex.
  if (!(radii.prod() / radii.norm() > tolerance)) return FreeForm{};
  if ((samples.col(0) - middle).dot(a) < 0) {
    a = -a;
    b = -b;
  }
  return HyperbolaShape{frame.Point(middle), a, b, first_radius, second};
}

CurveShape Classify(const Eigen::Matrix3Xd& samples,
                    const Eigen::Matrix3Xd& denser,
                    const LocalFrame& frame,
                    double relative) {
  const double size = (samples.rowwise().maxCoeff() - samples.rowwise().minCoeff()).norm();
  const double tolerance = frame.Tolerance(relative, size);
  if (!(size > tolerance)) return FreeForm{};
  const Spread spread(samples);
  const Eigen::Matrix3Xd local = spread.Local(denser);
  if (local.bottomRows<2>().colwise().norm().maxCoeff() <= tolerance) {
    Eigen::Vector3d direction = spread.axes.col(0);
    const auto along = local.row(0).array();
    // Where it leads: to the farthest place from its start.
    Eigen::Index farthest;
    (along - along[0]).abs().maxCoeff(&farthest);
    if (along[farthest] < along[0]) direction = -direction;
    return LineShape{frame.Point(samples.col(0)), direction};
  }
  if (local.row(2).cwiseAbs().maxCoeff() > tolerance) return FreeForm{};
  const Eigen::Matrix2Xd fitted = spread.Local(samples).topRows<2>();
  PlaneConic conic = FitCircle(fitted);
  if (LiesOn(conic, local, tolerance)) return ToCircle(conic, spread, frame);
  conic = FitParabola(fitted);
  if (LiesOn(conic, local, tolerance)) return ToParabola(conic, spread, frame);
  conic = FitConic(fitted);
  if (!LiesOn(conic, local, tolerance)) return FreeForm{};
  return ToCentralConic(conic, spread, frame, samples, tolerance);
}

}  // namespace

template <int Dim>
CurveShape ClassifyShape(const NurbsCurve<Dim>& curve, const ClassifyOptions& options) {
  if (!(options.tolerance > 0)) {
    throw std::invalid_argument("ClassifyShape: tolerance = " + std::to_string(options.tolerance) +
                                " is not positive");
  }
  const LocalFrame frame(curve.control_points());
  if (frame.collapsed()) return FreeForm{};
  const NurbsCurve<Dim> local(
      curve.basis(), frame.ToLocal(curve.control_points()), curve.weights());
  // F times the squared weight function is of degree 2p on every span; twice as many samples check.
  return Classify(
      SectionSamples(local, 2, 4), SectionSamples(local, 4, 7), frame, options.tolerance);
}

template CurveShape ClassifyShape(const NurbsCurve<2>&, const ClassifyOptions&);
template CurveShape ClassifyShape(const NurbsCurve<3>&, const ClassifyOptions&);

}  // namespace batten
