// SPDX-License-Identifier: MIT
// Random bases, curves and surfaces from a seed.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// What a random basis looks like.
struct BasisKind {
  bool clamped = true;
  int most_spans = 5;
  int highest_multiplicity = 25;  // of interior knots; never more than the degree
  bool periodic = false;          // then `clamped` does not count
};

class RandomSplines {
 public:
  explicit RandomSplines(unsigned seed) : generator_(seed) {}

  int Integer(int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(generator_);
  }
  double Real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  bool Coin() { return Integer(0, 1) == 1; }

  // Equally likely in every decade.
  double Logarithmic(double low, double high) {
    return std::exp(Real(std::log(low), std::log(high)));
  }

  Eigen::Vector3d Vector(double half_side) {
    return {Real(-half_side, half_side), Real(-half_side, half_side), Real(-half_side, half_side)};
  }

  // Spans of lengths in [0.05, 1], repeated interior knots; an unclamped basis may start or end in
  // a knot repeated up to degree times.
  SplineBasis Basis(int degree, const BasisKind& kind = {}) {
    const int most = std::min(degree, kind.highest_multiplicity);
    std::vector<double> breaks(1, Real(-2, 2));
    for (int spans = Integer(1, kind.most_spans); spans > 0; --spans) {
      breaks.push_back(breaks.back() + Real(0.05, 1));
    }
    if (kind.periodic) return PeriodicBasis(degree, most, breaks);
    std::vector<double> knots;
    if (kind.clamped) {
      knots.assign(degree + 1, breaks.front());
    } else {
      std::vector<double> outside(1, breaks.front());
      while (static_cast<int>(outside.size()) < degree + 1) {
        outside.push_back(Integer(0, 2) == 0 ? outside.back() : outside.back() - Real(0.05, 1));
      }
      knots.assign(outside.rbegin(), outside.rend());
    }
    for (size_t k = 1; k + 1 < breaks.size(); ++k) {
      knots.insert(knots.end(), Integer(1, most), breaks[k]);
    }
    knots.push_back(breaks.back());
    for (int i = 0; i < degree; ++i) {
      knots.push_back(kind.clamped || Integer(0, 2) == 0 ? knots.back()
                                                         : knots.back() + Real(0.05, 1));
    }
    return SplineBasis(degree, std::move(knots));
  }

  Eigen::VectorXd Weights(Eigen::Index count, double low = 1e-2, double high = 1e2) {
    Eigen::VectorXd weights(count);
    for (double& weight : weights) weight = Logarithmic(low, high);
    return weights;
  }

  // Control points in a cube of side 2 about the origin.
  template <int Dim>
  NurbsCurve<Dim> Curve(int degree, bool rational, const BasisKind& kind = {}) {
    SplineBasis basis = Basis(degree, kind);
    Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, basis.size());
    for (double& x : points.reshaped()) x = Real(-1, 1);
    Eigen::VectorXd weights = rational ? Weights(basis.size()) : Eigen::VectorXd();
    if (basis.periodic()) {
      const int round = basis.size() - degree;
      for (int i = round; i < basis.size(); ++i) {
        points.col(i) = points.col(i - round);
        if (rational) weights[i] = weights[i - round];
      }
    }
    return NurbsCurve<Dim>(std::move(basis), std::move(points), std::move(weights));
  }
  NurbsSurface Surface(int degree_u, int degree_v, bool rational, const BasisKind& kind = {}) {
    return Surface(degree_u, degree_v, rational, kind, kind);
  }
  NurbsSurface Surface(
      int degree_u, int degree_v, bool rational, const BasisKind& kind_u, const BasisKind& kind_v) {
    SplineBasis u = Basis(degree_u, kind_u), v = Basis(degree_v, kind_v);
    Eigen::Matrix3Xd points(3, u.size() * v.size());
    for (double& x : points.reshaped()) x = Real(-1, 1);
    Eigen::VectorXd weights = rational ? Weights(points.cols()) : Eigen::VectorXd();
    // In a periodic direction the net goes round: what lies past its end is its beginning again.
    const int round_u = u.periodic() ? u.size() - degree_u : u.size();
    const int round_v = v.periodic() ? v.size() - degree_v : v.size();
    for (int i = 0; i < u.size(); ++i) {
      for (int j = 0; j < v.size(); ++j) {
        const int to = i * v.size() + j, from = i % round_u * v.size() + j % round_v;
        points.col(to) = points.col(from);
        if (rational) weights[to] = weights[from];
      }
    }
    return NurbsSurface(std::move(u), std::move(v), std::move(points), std::move(weights));
  }

  // A surface that is nearly a sheet over a grid of unit cells, as fits to scans are.
  NurbsSurface Sheet(int degree_u, int degree_v, double height, const BasisKind& kind = {}) {
    SplineBasis u = Basis(degree_u, kind), v = Basis(degree_v, kind);
    Eigen::Matrix3Xd points(3, u.size() * v.size());
    for (int i = 0; i < u.size(); ++i) {
      for (int j = 0; j < v.size(); ++j) {
        points.col(i * v.size() + j) << i + Real(-0.2, 0.2), j + Real(-0.2, 0.2),
            Real(-height, height);
      }
    }
    return NurbsSurface(std::move(u), std::move(v), std::move(points));
  }

  // A parameter of the domain; one time in four an end or a knot.
  double Parameter(const SplineBasis& basis) {
    switch (Integer(0, 11)) {
      case 0:
        return basis.lower();
      case 1:
        return basis.upper();
      case 2:
        return basis.knots()[Integer(basis.degree(), basis.size())];
      default:
        return Real(basis.lower(), basis.upper());
    }
  }

  // A turn, perhaps with a reflection.
  Eigen::Matrix3d Orthogonal() {
    Eigen::Matrix3d axes{{Real(-1, 1), Real(-1, 1), Real(-1, 1)},
                         {Real(-1, 1), Real(-1, 1), Real(-1, 1)},
                         {Real(-1, 1), Real(-1, 1), Real(-1, 1)}};
    axes.col(0).normalize();
    axes.col(1) = axes.col(0).cross(axes.col(1)).normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1)) * (axes(2, 2) < 0 ? -1 : 1);
    return axes;
  }

 private:
  // One period of knots, the inner breaks and the seam repeated 1 … `most` times, continued to both
  // sides from a random place.
  SplineBasis PeriodicBasis(int degree, int most, const std::vector<double>& breaks) {
    std::vector<double> round;
    for (size_t k = 0; k + 1 < breaks.size(); ++k) {
      round.insert(round.end(), Integer(1, most), breaks[k]);
    }
    const double period = breaks.back() - breaks.front();
    const int distinct = static_cast<int>(round.size()), start = Integer(0, distinct - 1);
    std::vector<double> knots;
    for (int i = 0; i < distinct + 2 * degree + 1; ++i) {
      const int k = start + i;
      knots.push_back(round[k % distinct] + period * (k / distinct));
    }
    return SplineBasis::Periodic(degree, std::move(knots));
  }

  std::mt19937 generator_;
};

// The half diagonal of the box of the control points: the size that tolerances are relative to.
template <typename Geometry>
double SizeOf(const Geometry& geometry) {
  const auto& points = geometry.control_points();
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm() / 2;
}

// The largest coordinate of the control points: the size that rounding is relative to.
template <typename Geometry>
double ExtentOf(const Geometry& geometry) {
  return geometry.control_points().cwiseAbs().maxCoeff();
}

}  // namespace batten::internal
