// SPDX-License-Identifier: MIT
#include "batten/geometry/cubic_features.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/bezier/bernstein.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten {
using namespace internal;
namespace {

using Plane4 = Eigen::Matrix<double, 3, 4>;  // columns (w x, w y, w) of a plane piece

double Value(const Eigen::Vector4d& b, double t) {
  const double s = 1 - t;
  return b[0] * s * s * s + 3 * b[1] * s * s * t + 3 * b[2] * s * t * t + b[3] * t * t * t;
}

// The real roots of h0 s² + h1 s t + h2 t² in t, s = 1 − t, increasing; none where it has none.
std::optional<std::array<double, 2>> RootsOfQuadratic(const Eigen::Vector3d& h) {
  const double discriminant = h[1] * h[1] - 4 * h[0] * h[2];
  if (!(discriminant > 0)) return std::nullopt;
  const double sum = -(h[1] + std::copysign(std::sqrt(discriminant), h[1])) / 2;
  // t : s = sum : h2 and h0 : sum.
  std::array<double, 2> roots{sum / (sum + h[2]), h[0] / (h[0] + sum)};
  std::sort(roots.begin(), roots.end());
  return roots;
}

// Where a cubic in Bernstein form changes sign inside (0, 1): between its extremes by halving.
std::vector<double> SignChanges(const Eigen::Vector4d& b) {
  const Eigen::Vector3d slope(b[1] - b[0], 2 * (b[2] - b[1]), b[3] - b[2]);
  std::vector<double> ends{0};
  if (const auto extremes = RootsOfQuadratic(slope)) {
    for (const double t : *extremes) {
      if (t > 0 && t < 1) ends.push_back(t);
    }
  }
  ends.push_back(1);
  constexpr double kZero = 1e-13;
  const double zero = kZero * b.cwiseAbs().maxCoeff();
  std::vector<double> roots;
  for (size_t k = 0; k + 1 < ends.size(); ++k) {
    double low = ends[k], high = ends[k + 1];
    const double at_low = Value(b, low), at_high = Value(b, high);
    if (!(std::min(at_low, at_high) < -zero && std::max(at_low, at_high) > zero)) continue;
    while (true) {
      const double middle = low + (high - low) / 2;
      if (middle <= low || middle >= high) break;
      ((Value(b, middle) < 0) == (at_low < 0) ? low : high) = middle;
    }
    roots.push_back(low);
  }
  return roots;
}

double Det(const Plane4& b, int i, int j, int k) { return b.col(i).dot(b.col(j).cross(b.col(k))); }

// det(C, C′, C″) up to a factor, which every polar form of C gives: Bernstein coefficients.
Eigen::Vector4d InflectionForm(const Plane4& b) {
  return {Det(b, 0, 1, 2), Det(b, 0, 1, 3) / 3, Det(b, 0, 2, 3) / 3, Det(b, 1, 2, 3)};
}

Eigen::Vector3d Hessian(const Eigen::Vector4d& f) {
  return {f[0] * f[2] - f[1] * f[1], f[0] * f[3] - f[1] * f[2], f[1] * f[3] - f[2] * f[2]};
}

// |C′| of the plane piece.
double SpeedAt(const Plane4& b, double t) {
  const Eigen::VectorXd p = DeCasteljau(b, t), d = DeCasteljau(BernsteinDerivative(b), t);
  return (d.head<2>() - d[2] / p[2] * p.head<2>()).norm() / p[2];
}

// Everything in the piece's own parameter t.
void AddPlaneFeatures(const Plane4& b, double size, double tolerance, CubicFeatures& features) {
  const Eigen::Vector4d f = InflectionForm(b);
  const Eigen::Vector3d hessian = Hessian(f);
  constexpr double kCube = 1e-10;  // the form of a conic is a cube, whose Hessian vanishes
  if (hessian.cwiseAbs().maxCoeff() <= kCube * f.cwiseAbs2().maxCoeff()) {
    features.kind = CubicKind::kConic;
    return;
  }
  // Of a double root t : s = −h1 : 2 h2 = 2 h0 : −h1 the better conditioned quotient.
  const double at = std::abs(hessian[2]) > std::abs(hessian[0])
                        ? -hessian[1] / (2 * hessian[2] - hessian[1])
                        : 2 * hessian[0] / (2 * hessian[0] - hessian[1]);
  if (at >= 0 && at <= 1 && SpeedAt(b, at) <= tolerance * size) {
    features.kind = CubicKind::kCusp;
    features.cusp = at;
    for (const double t : SignChanges(f)) {
      constexpr double kBeside = 1e-4;
      if (std::abs(t - at) > kBeside) features.inflections.push_back(t);
    }
    return;
  }
  features.inflections = SignChanges(f);
  if (!features.inflections.empty()) features.kind = CubicKind::kInflected;
  const auto crossing = RootsOfQuadratic(hessian);
  if (!crossing || (*crossing)[0] < 0 || (*crossing)[1] > 1) return;
  features.loop = crossing;
  features.kind = CubicKind::kLoop;
}

// (p × q + q × r + r × p) of Euclidean points p, q, r, times their weights.
Eigen::Vector3d PlaneNormal(const Eigen::Matrix4d& b, int i, int j, int k) {
  const auto cross = [&](int l, int m) { return b.col(l).head<3>().cross(b.col(m).head<3>()); };
  return b(3, i) * cross(j, k) + b(3, j) * cross(k, i) + b(3, k) * cross(i, j);
}

// The torsion −det(b)/3 · w² / |N|², N the normal of the osculating plane: a cubic as the
// inflection form is, and the determinant of all control points a constant. Extremes are those of
// |N|²/w²: of samples, each local one sharpened by golden section.
std::array<double, 2> TorsionOf(const Eigen::Matrix4d& b) {
  Eigen::Matrix4d normal_and_weight;
  normal_and_weight.topRows<3>() << PlaneNormal(b, 0, 1, 2), PlaneNormal(b, 0, 1, 3) / 3,
      PlaneNormal(b, 0, 2, 3) / 3, PlaneNormal(b, 1, 2, 3);
  normal_and_weight.row(3) = b.row(3);
  const auto square = [&](double t) {
    const double s = 1 - t;
    const Eigen::Vector4d at =
        normal_and_weight * Eigen::Vector4d(s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t);
    return at.head<3>().squaredNorm() / (at[3] * at[3]);
  };
  constexpr int kSamples = 512, kSteps = 50;
  const double golden = (std::sqrt(5.0) - 1) / 2;
  std::array<double, 2> range{};
  for (const double sign : {1.0, -1.0}) {
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= kSamples; ++k) {
      double low = std::max(0, k - 1) / double{kSamples};
      double high = std::min(kSamples, k + 1) / double{kSamples};
      const double here = sign * square(k / double{kSamples});
      best = std::min(best, here);
      if (here > std::min(sign * square(low), sign * square(high))) continue;
      for (int step = 0; step < kSteps; ++step) {
        const double x = high - golden * (high - low), y = low + golden * (high - low);
        const double at_x = sign * square(x), at_y = sign * square(y);
        best = std::min({best, at_x, at_y});
        (at_x < at_y ? high : low) = at_x < at_y ? y : x;
      }
    }
    range[sign > 0 ? 0 : 1] = -b.determinant() / 3 / (sign * best);
  }
  std::sort(range.begin(), range.end());
  return range;
}

}  // namespace

std::string NameOf(CubicKind kind) {
  constexpr const char* names[] = {"line", "conic", "arch", "inflected", "cusp", "loop", "space"};
  return names[static_cast<int>(kind)];
}

template <int Dim>
std::vector<CubicFeatures> FeaturesOfCubic(const NurbsCurve<Dim>& curve, double tolerance) {
  RequireThat(curve.basis().degree() == 3,
              "FeaturesOfCubic",
              "the degree is " + std::to_string(curve.basis().degree()) + ", not 3");
  RequireThat(tolerance > 0, "FeaturesOfCubic", "tolerance is not positive");
  std::vector<CubicFeatures> result;
  for (const CurvePiece& piece : PiecesOf(curve)) {
    CubicFeatures features{piece.u0, piece.u1};
    Eigen::Matrix<double, 3, 4> points;
    for (int i = 0; i < 4; ++i) points.col(i) = piece.points.col(i).head<3>() / piece.points(3, i);
    const Eigen::Vector3d middle = points.rowwise().mean();
    const Eigen::Matrix<double, 3, 4> centred = points.colwise() - middle;
    const SingularValues spread = SingularValuesOf(centred.transpose());
    const double size = centred.colwise().norm().maxCoeff();
    const Eigen::Vector3d extent = spread.values;
    if (!(extent[1] > tolerance * size)) {
      features.kind = CubicKind::kLine;
    } else if (extent[2] > tolerance * size) {
      features.kind = CubicKind::kSpace;
      features.torsion = TorsionOf(piece.points);
    } else {
      Plane4 plane;
      plane.topRows<2>() = spread.v.leftCols(2).transpose() * centred / size;
      for (int i = 0; i < 4; ++i) plane.col(i).head<2>() *= piece.points(3, i);
      plane.row(2) = piece.points.row(3);
      AddPlaneFeatures(plane, 1, tolerance, features);
      const auto to_curve = [&](double& t) { t = piece.u0 + t * (piece.u1 - piece.u0); };
      for (double& t : features.inflections) to_curve(t);
      if (features.cusp) to_curve(*features.cusp);
      if (features.loop) std::for_each(features.loop->begin(), features.loop->end(), to_curve);
    }
    result.push_back(std::move(features));
  }
  return result;
}

template std::vector<CubicFeatures> FeaturesOfCubic(const NurbsCurve<2>&, double);
template std::vector<CubicFeatures> FeaturesOfCubic(const NurbsCurve<3>&, double);

}  // namespace batten
