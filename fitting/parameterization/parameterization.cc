// SPDX-License-Identifier: MIT
#include "fitting/parameterization/parameterization.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/parameterization/height_field.h"
#include "geometry/evaluation/evaluation_kernels.h"

namespace batten::internal {
namespace {

// Unit normal from the first derivatives of a jet; its limit if these hardly span a plane.
std::optional<Eigen::Vector3d> NormalOf(const SurfaceEvaluator& surface,
                                        const double* jet,
                                        const double* uv) {
  constexpr double kTrusted = 0x1p-40;  // the square of a sine, and of lengths against the extent
  const Eigen::Map<const Eigen::Vector3d> du(jet + 3), dv(jet + 6);
  const SurfaceTable& table = surface.table();
  const double in_u = table.u.upper - table.u.lower, in_v = table.v.upper - table.v.lower;
  const double uu = du.squaredNorm(), vv = dv.squaredNorm();
  const double least = std::min(uu * in_u * in_u, vv * in_v * in_v);
  const Eigen::Vector3d normal = du.cross(dv);
  const double squares = normal.squaredNorm();
  const bool good = squares > kTrusted * uu * vv && least > kTrusted * table.extent * table.extent;
  if (good) return normal / std::sqrt(squares);
  return surface.NormalAt(uv[0], uv[1]);
}

}  // namespace

NurbsSurface Parameterization::Surface(const SplineBasis& basis_u,
                                       const SplineBasis& basis_v,
                                       const Eigen::MatrixXd& coefficients) const {
  return plane ? HeightSurface(*plane, basis_u, basis_v, coefficients)
               : NurbsSurface(
                     basis_u, basis_v, WithPolesClosed(coefficients, basis_u, basis_v, poles));
}

void Parameterization::MoveRectangle(const Eigen::Vector2d& shift, const Eigen::Vector2d& sides) {
  parameters.colwise() -= shift;
  length_u = sides[0];
  length_v = sides[1];
  if (!plane) return;
  plane->origin += plane->axes.leftCols<2>() * shift;
  plane->length_u = length_u;
  plane->length_v = length_v;
}

FittingProblem Parameterization::ProblemOf(const PointCloud& points,
                                           const PointMask& mask,
                                           int degree_u,
                                           int degree_v,
                                           double smoothing) const {
  auto data = std::make_shared<FittingData>();
  const Eigen::Index count = mask.count();
  data->parameters.resize(2, count);
  data->values.resize(plane ? 1 : 3, count);
  const bool weighted = points.weights().size() > 0;
  if (weighted) data->weights.resize(count);
  Eigen::Index next = 0;
  for (Eigen::Index k = 0; k < points.size(); ++k) {
    if (!mask[k]) continue;
    data->parameters.col(next) = parameters.col(k);
    if (plane) {
      data->values(0, next) = plane->axes.col(2).dot(points.points().col(k) - plane->origin);
    } else {
      data->values.col(next) = points.points().col(k);
    }
    if (weighted) data->weights[next] = points.weights()[k];
    ++next;
  }
  if (weighted) data->weights /= data->weights.mean();
  const auto basis = [](int degree, double length, bool periodic) {
    return periodic ? PeriodicUniformKnots(degree, degree + 1, 0, length)
                    : SplineBasis::Uniform(degree, degree + 1, 0, length);
  };
  return FittingProblem(basis(degree_u, length_u, periodic_u),
                        basis(degree_v, length_v, periodic_v),
                        std::move(data),
                        smoothing)
      .WithPoles(poles);
}

Eigen::VectorXd Parameterization::Residuals(const FittingProblem& problem,
                                            const Eigen::MatrixXd& coefficients,
                                            ThreadPool& pool) const {
  const Eigen::MatrixXd off = problem.data().values - EvaluateAt(problem, coefficients, pool);
  if (exact) return off.colwise().norm().transpose();
  const SurfaceEvaluator surface(Surface(problem.basis_u(), problem.basis_v(), coefficients));
  Eigen::VectorXd residuals(problem.size());
  pool.For(problem.size(), 4096, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    constexpr std::ptrdiff_t kTogether = 256;
    double jets[18 * kTogether];
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const std::ptrdiff_t place = (k - begin) % kTogether;
      const double* uv = problem.data().parameters.data() + 2 * k;
      if (place == 0) {
        const auto count = static_cast<std::size_t>(std::min(kTogether, end - k));
        EvaluateJets(surface.table(), uv, count, jets);
      }
      const auto normal = NormalOf(surface, jets + 18 * place, uv);
      if (plane) {
        residuals[k] = off(0, k) * (normal ? normal->dot(plane->axes.col(2)) : 1.0);
      } else {
        residuals[k] = normal ? normal->dot(off.col(k)) : off.col(k).norm();
      }
    }
  });
  return residuals;
}

std::vector<SurfaceJet> SomeJets(const NurbsSurface& surface, const Eigen::Matrix2Xd& parameters) {
  constexpr Eigen::Index kPlaces = 4000;  // enough for a mean
  const Eigen::Index step = std::max<Eigen::Index>(1, parameters.cols() / kPlaces);
  const Eigen::Matrix2Xd places = parameters(Eigen::all, Eigen::seq(0, Eigen::last, step));
  std::vector<SurfaceJet> jets;
  SurfaceEvaluator(surface).Jets(places, jets);
  return jets;
}

double DistortionAt(const NurbsSurface& surface, const Eigen::Matrix2Xd& parameters) {
  const std::vector<SurfaceJet> jets = SomeJets(surface, parameters);
  double squares = 0;
  for (const SurfaceJet& jet : jets) {
    // Eigenvalues of the first fundamental form are the squares of the principal stretches.
    const double E = jet.du.squaredNorm(), F = jet.du.dot(jet.dv), G = jet.dv.squaredNorm();
    const double mean = (E + G) / 2, spread = std::hypot((E - G) / 2, F);
    const double longest = std::sqrt(mean + spread);
    const double shortest = std::sqrt(std::max(0.0, mean - spread));
    squares += (std::pow(longest - 1, 2) + std::pow(shortest - 1, 2)) / 2;
  }
  return jets.empty() ? 0 : std::sqrt(squares / static_cast<double>(jets.size()));
}

}  // namespace batten::internal
