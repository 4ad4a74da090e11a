// SPDX-License-Identifier: MIT
// Random problems of the joint optimisation: a shape, and points near it with parameters.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "fitting/foot_points/joint_foot_points.h"
#include "random_splines.h"

namespace batten::internal {

struct JointCase {
  FittingProblem problem;
  Eigen::MatrixXd net;      // dimension × n
  Eigen::VectorXd weights;  // n
};

struct JointKind {
  bool curve = false;
  int dimension = 3;
  bool rational = false, periodic = false, data_weights = false;
  double noise = 0.03;  // of every coordinate; the shape's size is a few
  int count = 300;
  int least_degree = 1, most_degree = 4;

  std::string Name() const {
    return std::string(curve ? "curve" : "surface") + ", dimension " + std::to_string(dimension) +
           (rational ? ", rational" : "") + (periodic ? ", periodic" : "") +
           (data_weights ? ", weighted data" : "");
  }
};

// Every kind of shape there is.
inline std::vector<JointKind> JointKinds() {
  std::vector<JointKind> kinds;
  for (const bool rational : {false, true}) {
    for (const bool periodic : {false, true}) {
      for (const int shape : {0, 1, 2}) {
        kinds.push_back({.curve = shape > 0,
                         .dimension = shape == 2 ? 2 : 3,
                         .rational = rational,
                         .periodic = periodic,
                         .data_weights = (shape + rational + periodic) % 2 == 0});
      }
    }
  }
  return kinds;
}

// Clamped or not, gaps of 0.5 to 1, now and then a double knot where the degree leaves it smooth.
inline SplineBasis JointBasis(RandomSplines& random, int degree, bool periodic) {
  std::vector<double> knots;
  if (periodic) {
    const int distinct = degree + 3;
    std::vector<double> gaps;
    for (int i = 0; i < distinct; ++i) gaps.push_back(random.Real(0.5, 1));
    knots.push_back(random.Real(-1, 1));
    for (int i = 0; i < distinct + 2 * degree; ++i)
      knots.push_back(knots.back() + gaps[i % distinct]);
    // The sums differ by rounding from one period to the next, which the basis allows.
    return SplineBasis::Periodic(degree, std::move(knots));
  }
  const bool clamped = random.Coin();
  double t = random.Real(-1, 1);
  for (int i = 0; i <= degree; ++i) {
    knots.push_back(t);
    if (!clamped) t += random.Real(0.5, 1);
  }
  if (!clamped) t = knots.back();
  for (int interior = random.Integer(1, 3); interior > 0; --interior) {
    t += random.Real(0.5, 1);
    knots.insert(knots.end(), degree > 2 && random.Integer(0, 3) == 0 ? 2 : 1, t);
  }
  t += random.Real(0.5, 1);
  for (int i = 0; i <= degree; ++i) {
    knots.push_back(t);
    if (!clamped) t += random.Real(0.5, 1);
  }
  return SplineBasis(degree, std::move(knots));
}

inline Eigen::Vector3d PointOf(const TensorShape& shape, double u, double v) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  if (shape.basis_v) {
    return NurbsSurface(shape.basis_u, *shape.basis_v, shape.net, shape.weights).At(u, v);
  }
  if (shape.dimension() == 2) {
    point.head<2>() = NurbsCurve<2>(shape.basis_u, shape.net, shape.weights).At(u);
    return point;
  }
  return NurbsCurve<3>(shape.basis_u, shape.net, shape.weights).At(u);
}

inline TensorShape ShapeOf(const FittingProblem& problem,
                           const Eigen::MatrixXd& net,
                           const Eigen::VectorXd& weights) {
  return {problem.basis_u(),
          problem.is_curve() ? std::nullopt : std::make_optional(problem.basis_v()),
          net,
          weights};
}

// A graph over its parameters; periodic in u: a ring, or a tube round the z axis, of radius 1.
inline TensorShape RandomShape(RandomSplines& random, const JointKind& kind) {
  const auto degree = [&] { return random.Integer(kind.least_degree, kind.most_degree); };
  TensorShape shape{JointBasis(random, degree(), kind.periodic), std::nullopt, {}, {}};
  if (!kind.curve) shape.basis_v = JointBasis(random, degree(), false);
  const SplineBasis& u = shape.basis_u;
  shape.net.resize(kind.dimension, Eigen::Index{u.size()} * shape.size_v());
  shape.weights.setOnes(shape.net.cols());
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < shape.size_v(); ++j) {
      const Eigen::Index k = Eigen::Index{i} * shape.size_v() + j;
      if (kind.periodic && i >= u.size() - u.degree()) {
        const int first = i - (u.size() - u.degree());
        shape.net.col(k) = shape.net.col(Eigen::Index{first} * shape.size_v() + j);
        shape.weights[k] = shape.weights[Eigen::Index{first} * shape.size_v() + j];
        continue;
      }
      const double s = u.Greville(i), t = shape.basis_v ? shape.basis_v->Greville(j) : 0;
      Eigen::Vector3d point(s, random.Real(-0.2, 0.2), random.Real(-0.2, 0.2));
      if (shape.basis_v) point[1] = t + random.Real(-0.03, 0.03);
      if (kind.periodic) {
        const double angle = 2 * std::numbers::pi * (s - u.lower()) / (u.upper() - u.lower());
        const double radius = random.Real(1.4, 1.7);
        point << radius * std::cos(angle), radius * std::sin(angle), t + random.Real(-0.1, 0.1);
      }
      shape.net.col(k) = point.head(kind.dimension);
      if (kind.rational) shape.weights[k] = std::exp(random.Real(-0.4, 0.4));
    }
  }
  return shape;
}

// Points of the shape with noise, at parameters over the whole domain.
inline JointCase RandomJointCase(RandomSplines& random, const JointKind& kind) {
  TensorShape shape = RandomShape(random, kind);
  auto data = std::make_shared<FittingData>();
  data->parameters.setZero(2, kind.count);
  data->values.resize(kind.dimension, kind.count);
  for (int k = 0; k < kind.count; ++k) {
    data->parameters(0, k) = random.Real(shape.basis_u.lower(), shape.basis_u.upper());
    if (shape.basis_v)
      data->parameters(1, k) = random.Real(shape.basis_v->lower(), shape.basis_v->upper());
    const Eigen::Vector3d point = PointOf(shape, data->parameters(0, k), data->parameters(1, k)) +
                                  random.Vector(std::sqrt(3.0) * kind.noise);
    data->values.col(k) = point.head(kind.dimension);
  }
  if (kind.data_weights) {
    data->weights.resize(kind.count);
    for (double& w : data->weights) w = random.Integer(0, 9) == 0 ? 0 : random.Real(0.5, 2);
  }
  FittingProblem problem = shape.basis_v
                               ? FittingProblem(shape.basis_u, *shape.basis_v, std::move(data), 0)
                               : FittingProblem(shape.basis_u, std::move(data), 0);
  return {std::move(problem), std::move(shape.net), std::move(shape.weights)};
}

}  // namespace batten::internal
