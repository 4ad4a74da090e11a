// SPDX-License-Identifier: MIT
// Random trim loops for the tests of files.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

class RandomTrims {
 public:
  using Curve = NurbsCurve<2>;
  // Places in the domain as shares of its sides.
  struct Box {
    double u0, u1, v0, v1;
  };

  explicit RandomTrims(unsigned seed) : generator_(seed) {}

  double Real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int Integer(int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(generator_);
  }

  // The surface with an outer loop and up to three holes, or untrimmed for `count` = 0.
  NurbsSurface Trimmed(const NurbsSurface& surface, int count) {
    std::vector<Curve> loops;
    const Box holes[] = {
        {0.31, 0.48, 0.31, 0.48}, {0.52, 0.69, 0.33, 0.45}, {0.35, 0.65, 0.52, 0.69}};
    for (int i = 0; i < count; ++i) {
      loops.push_back(i == 0 ? Outer(surface) : Any(surface, holes[i - 1], false));
    }
    return surface.WithTrims(std::move(loops));
  }

  // The surface with three regions, one in the hole of another.
  NurbsSurface OfThreeRegions(const NurbsSurface& surface) {
    return surface.WithTrims({Any(surface, {0.05, 0.45, 0.1, 0.5}, true),
                              Any(surface, {0.5, 0.95, 0.4, 0.9}, true),
                              Any(surface, {0.7, 0.74, 0.63, 0.67}, true),
                              Any(surface, {0.62, 0.82, 0.55, 0.75}, false),
                              Any(surface, {0.2, 0.3, 0.25, 0.35}, false)});
  }

  // An outer boundary: around the whole, touching the edges of the domain or not.
  Curve Outer(const NurbsSurface& surface) {
    if (Integer(0, 2) == 0) {
      return Polygon(surface, {{0, 0}, {1, 0}, {1, 0.9}, {0.95, 1}, {0.1, 1}, {0, 0.9}}, true);
    }
    return Any(surface, {0.03, 0.97, 0.03, 0.97}, true);
  }

  Curve Any(const NurbsSurface& surface, const Box& box, bool ccw) {
    switch (Integer(0, 3)) {
      case 0:
        return Circle(surface, box, ccw);
      case 1:
        return Smooth(surface, box, ccw);
      case 2:
        return Cornered(surface, box, ccw);
      default:
        return Polygon(
            surface, {{box.u0, box.v0}, {box.u1, box.v0}, {box.u1, box.v1}, {box.u0, box.v1}}, ccw);
    }
  }

  // An ellipse of four rational arcs.
  Curve Circle(const NurbsSurface& surface, const Box& box, bool ccw) {
    const double x[] = {1, 1, 0, -1, -1, -1, 0, 1, 1}, y[] = {0, 1, 1, 1, 0, -1, -1, -1, 0};
    Eigen::Matrix2Xd points(2, 9);
    Eigen::VectorXd weights(9);
    for (int i = 0; i < 9; ++i) {
      points.col(i) = In(surface, box, x[i], ccw ? y[i] : -y[i]);
      weights[i] = i % 2 ? std::numbers::sqrt2 / 2 : 1;
    }
    points.col(8) = points.col(0);
    return Curve(SplineBasis(2, {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}), points, weights);
  }

  // A smooth closed cubic, clamped where it begins.
  Curve Smooth(const NurbsSurface& surface, const Box& box, bool ccw) {
    const int size = Integer(8, 13);
    Eigen::Matrix2Xd points(2, size);
    const double first = Real(0, 6);
    for (int i = 0; i < size; ++i) {
      // Ends and beginnings on the tangent at the start, so that it is smooth there too.
      const double at = i == 0 || i == size - 1 ? 0 : i - (size - 1) / 2.0;
      const double angle = first + std::numbers::pi +
                           (i == 0 || i == size - 1 ? std::numbers::pi : 0) +
                           (at * 2 * std::numbers::pi / (size - 2)) * (ccw ? 1 : -1);
      const double r =
          i == 0 || i == size - 1 ? 0.9 * std::cos(std::numbers::pi / (size - 2)) : 0.9;
      points.col(i) = In(surface, box, r * std::cos(angle), r * std::sin(angle));
    }
    points.col(size - 1) = points.col(0);
    return Curve(SplineBasis::Uniform(3, size, Real(-1, 1), Real(2, 4)), points);
  }

  // A cubic with corners: knots of multiplicity three.
  Curve Cornered(const NurbsSurface& surface, const Box& box, bool ccw) {
    const int sides = Integer(4, 6);
    std::vector<double> knots(4, 0.0);
    Eigen::Matrix2Xd points(2, 3 * sides + 1);
    const double first = Real(0, 6), turn = 2 * std::numbers::pi / sides * (ccw ? 1 : -1);
    for (int i = 0; i < sides; ++i) {
      for (int j = 0; j < 3; ++j) {
        const double angle = first + turn * (i + j / 3.0), r = j == 0 ? 0.9 : Real(0.7, 0.95);
        points.col(3 * i + j) = In(surface, box, r * std::cos(angle), r * std::sin(angle));
      }
      knots.insert(knots.end(), i + 1 < sides ? 3 : 4, knots.back() + Real(0.5, 2));
    }
    points.col(3 * sides) = points.col(0);
    return Curve(SplineBasis(3, knots), points);
  }

  static Curve Polygon(const NurbsSurface& surface,
                       std::vector<std::pair<double, double>> corners,
                       bool ccw) {
    corners.push_back(corners.front());
    if (!ccw) corners = {corners.rbegin(), corners.rend()};
    Eigen::Matrix2Xd points(2, static_cast<Eigen::Index>(corners.size()));
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const auto [u, v] = corners[static_cast<size_t>(i)];
      points.col(i) = In(surface, {0, 1, 0, 1}, 2 * u - 1, 2 * v - 1);
    }
    const auto size = static_cast<int>(points.cols());
    return Curve(SplineBasis::Uniform(1, size, 0, 1), points);
  }

  // The place in the box at x, y from −1 to 1; the domain's own ends at the ends of the whole.
  static Eigen::Vector2d In(const NurbsSurface& surface, const Box& box, double x, double y) {
    const auto at = [](const SplineBasis& basis, double share) {
      if (share == 0) return basis.lower();
      if (share == 1) return basis.upper();
      return basis.lower() + share * (basis.upper() - basis.lower());
    };
    return {at(surface.basis_u(), box.u0 + (box.u1 - box.u0) * (x + 1) / 2),
            at(surface.basis_v(), box.v0 + (box.v1 - box.v0) * (y + 1) / 2)};
  }

 private:
  std::mt19937 generator_;
};

}  // namespace batten::internal
