// SPDX-License-Identifier: MIT
// Random curves and surfaces for the tests of files.
#pragma once

#include <Eigen/Core>
#include <random>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

class RandomGeometry {
 public:
  explicit RandomGeometry(unsigned seed) : generator_(seed) {}

  int Integer(int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(generator_);
  }
  double Real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }

  // Clamped or not, with repeated interior knots.
  SplineBasis Basis(int degree, bool clamped) {
    std::vector<double> knots(degree + 1, Real(-2, 2));
    if (!clamped) {
      for (int i = degree - 1; i >= 0; --i) knots[i] = knots[i + 1] - Real(0.1, 1);
    }
    for (int spans = Integer(1, 5); spans > 1; --spans) {
      knots.insert(knots.end(), Integer(1, degree), knots.back() + Real(0.1, 1));
    }
    const double end = knots.back() + Real(0.1, 1);
    for (int i = 0; i <= degree; ++i) {
      knots.push_back(clamped || i == 0 ? end : knots.back() + Real(0.1, 1));
    }
    return SplineBasis(degree, std::move(knots));
  }

  Eigen::VectorXd Weights(Eigen::Index count) {
    Eigen::VectorXd weights(count);
    for (double& weight : weights) weight = Real(0.3, 3);
    return weights;
  }

  template <int Dim>
  NurbsCurve<Dim> Curve(int degree, bool clamped, bool rational) {
    SplineBasis basis = Basis(degree, clamped);
    Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, basis.size());
    for (double& x : points.reshaped()) x = Real(-1, 1);
    points.row(0) += Eigen::RowVectorXd::LinSpaced(basis.size(), 0, 3.0 * basis.size());
    Eigen::VectorXd weights = rational ? Weights(basis.size()) : Eigen::VectorXd();
    return NurbsCurve<Dim>(std::move(basis), std::move(points), std::move(weights));
  }

  // A height field over a distorted grid: not folded, so that it is a valid face.
  NurbsSurface Surface(int degree_u, int degree_v, bool clamped, bool rational) {
    SplineBasis u = Basis(degree_u, clamped), v = Basis(degree_v, clamped);
    Eigen::Matrix3Xd points(3, u.size() * v.size());
    for (int i = 0; i < u.size(); ++i) {
      for (int j = 0; j < v.size(); ++j) {
        points.col(i * v.size() + j) << i + Real(-0.3, 0.3), j + Real(-0.3, 0.3), Real(-1, 1);
      }
    }
    Eigen::VectorXd weights = rational ? Weights(points.cols()) : Eigen::VectorXd();
    return NurbsSurface(std::move(u), std::move(v), std::move(points), std::move(weights));
  }

 private:
  std::mt19937 generator_;
};

}  // namespace batten::internal
