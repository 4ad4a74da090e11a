// SPDX-License-Identifier: MIT
#include "geometry/joining/hole_system.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "geometry/numeric/gauss_rule.h"

namespace batten::internal {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplet = Eigen::Triplet<double>;

// ∫ N_i^(k) N_j^(k) over the basis, k = 0, 1, 2.
std::array<Eigen::MatrixXd, 3> GramMatrices(const SplineBasis& basis) {
  const int p = basis.degree();
  const GaussRule rule = GaussLegendre(p + 1);
  std::array<Eigen::MatrixXd, 3> grams;
  for (Eigen::MatrixXd& gram : grams) gram = Eigen::MatrixXd::Zero(basis.size(), basis.size());
  Eigen::MatrixXd values(p + 1, 3);
  for (const int span : basis.Spans()) {
    const double from = basis.knots()[span], width = basis.knots()[span + 1] - from;
    for (Eigen::Index q = 0; q < rule.nodes.size(); ++q) {
      basis.Derivatives(span, from + width * rule.nodes[q], 2, values.data());
      for (int k = 0; k < 3; ++k) {
        grams[k].block(span - p, span - p, p + 1, p + 1) +=
            rule.weights[q] * width * values.col(k) * values.col(k).transpose();
      }
    }
  }
  return grams;
}

// A sum of coefficients times control points: the unknown ones, and what the given ones make.
struct Combination {
  std::vector<std::pair<int, double>> terms;
  Eigen::Vector3d given = Eigen::Vector3d::Zero();

  void Add(const HoleNet& net, int index, double factor) {
    if (factor == 0) return;
    if (index < 0) {
      given += factor * net.Given(index);
    } else {
      terms.emplace_back(index, factor);
    }
  }
};

// Rows of C x = d, x the coordinates of the unknowns one after the other: 3·index + coordinate.
class Conditions {
 public:
  void AddVector(const Combination& sum, double weight) {
    for (int c = 0; c < 3; ++c) {
      for (const auto& [index, factor] : sum.terms) Put(3 * index + c, weight * factor);
      right_.push_back(-weight * sum.given[c]);
    }
  }
  void AddAlong(const Combination& sum, const Eigen::Vector3d& normal, double weight) {
    for (const auto& [index, factor] : sum.terms) {
      for (int c = 0; c < 3; ++c) Put(3 * index + c, weight * factor * normal[c]);
    }
    right_.push_back(-weight * sum.given.dot(normal));
  }
  Sparse Matrix(int columns) const {
    Sparse matrix(std::ssize(right_), columns);
    matrix.setFromTriplets(triplets_.begin(), triplets_.end());
    return matrix;
  }
  Eigen::VectorXd Right() const {
    return Eigen::Map<const Eigen::VectorXd>(right_.data(), std::ssize(right_));
  }

 private:
  void Put(int column, double value) {
    triplets_.emplace_back(static_cast<int>(right_.size()), column, value);
  }
  std::vector<Triplet> triplets_;
  std::vector<double> right_;
};

// Derivatives of a patch on its edges as combinations of its control points.
class EdgeDerivatives {
 public:
  explicit EdgeDerivatives(const HoleNet& net) : net_(net) {
    const SplineBasis& basis = net.basis();
    const int p = basis.degree();
    Eigen::MatrixXd values(p + 1, 2);
    basis.Derivatives(basis.Span(0), 0, 1, values.data());
    lower_ = values.col(1);
    basis.Derivatives(basis.Span(1), 1, 1, values.data());
    upper_ = values.col(1);
  }

  // ∂/∂u at (end, t), or ∂/∂v at (t, end).
  void AddAcross(
      int patch, bool across_u, bool upper, double t, double factor, Combination& sum) const {
    const SplineBasis& basis = net_.basis();
    const int p = basis.degree(), span = basis.Span(t);
    Eigen::VectorXd along(p + 1);
    basis.Values(span, t, along.data());
    const Eigen::VectorXd& slope = upper ? upper_ : lower_;
    const int first = upper ? basis.size() - p - 1 : 0;
    for (int a = 0; a <= p; ++a) {
      for (int b = 0; b <= p; ++b) {
        const int across = first + a, at = span - p + b;
        sum.Add(net_,
                across_u ? net_.Index(patch, across, at) : net_.Index(patch, at, across),
                factor * slope[a] * along[b]);
      }
    }
  }

  // ∂/∂u at (t, 0): along the edge from the centre.
  void AddAlong(int patch, double t, double factor, Combination& sum) const {
    const SplineBasis& basis = net_.basis();
    const int p = basis.degree(), span = basis.Span(t);
    Eigen::MatrixXd values(p + 1, 2);
    basis.Derivatives(span, t, 1, values.data());
    for (int b = 0; b <= p; ++b) {
      sum.Add(net_, net_.Index(patch, span - p + b, 0), factor * values(b, 1));
    }
  }

 private:
  const HoleNet& net_;
  Eigen::VectorXd lower_, upper_;
};

// Normals along a side that agree with the plane of the two sides at its corners, in which every
// filling lies there: a neighbour that disagrees is approached from the corner over a quarter of
// the side.
class SideNormals {
 public:
  SideNormals(const std::vector<HoleSide>& sides, int k) : side_(sides[k]) {
    const size_t n = sides.size();
    const HoleSide &before = sides[(k + n - 1) % n], &after = sides[(k + 1) % n];
    at_start_ = Correction(before.TangentAt(1), side_.TangentAt(0), 0);
    at_end_ = Correction(side_.TangentAt(1), after.TangentAt(0), 1);
  }
  std::optional<Eigen::Vector3d> At(double s) const {
    const auto plane = side_.PlaneAt(s);
    if (!plane) return std::nullopt;
    return (plane->normal + Fade(s) * at_start_ + Fade(1 - s) * at_end_).normalized();
  }

 private:
  Eigen::Vector3d Correction(const Eigen::Vector3d& in,
                             const Eigen::Vector3d& out,
                             double s) const {
    constexpr double kStraight = 1e-3;  // sine of a corner's angle: below, its plane is not known
    const Eigen::Vector3d normal = in.cross(out);
    const auto plane = side_.PlaneAt(s);
    if (!plane || !(normal.norm() > kStraight)) return Eigen::Vector3d::Zero();
    const double sign = normal.dot(plane->normal) < 0 ? -1 : 1;
    return sign * normal.normalized() - plane->normal;
  }
  static double Fade(double s) {
    constexpr double kZone = 0.25;
    const double x = s / kZone;
    return x < 1 ? (1 - x) * (1 - x) * (1 + 2 * x) : 0;
  }

  const HoleSide& side_;
  Eigen::Vector3d at_start_, at_end_;
};

void AddConditions(const HoleNet& net, const std::vector<HoleSide>& sides, Conditions& conditions) {
  const EdgeDerivatives derivatives(net);
  const SplineBasis& basis = net.basis();
  const int n = net.sides();
  const GaussRule rule = GaussLegendre(basis.degree() + 3);
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    const SideNormals normals(sides, k);
    for (const int span : basis.Spans()) {
      const double from = basis.knots()[span], width = basis.knots()[span + 1] - from;
      for (Eigen::Index q = 0; q < rule.nodes.size(); ++q) {
        const double t = from + width * rule.nodes[q];
        const double weight = std::sqrt(rule.weights[q] * width);
        Combination inner;
        derivatives.AddAcross(k, false, false, t, 1, inner);
        derivatives.AddAcross(next, true, false, t, 1, inner);
        const double lambda = 2 * std::cos(2 * std::numbers::pi / n) * (1 - t) * (1 - t);
        derivatives.AddAlong(k, t, -lambda, inner);
        conditions.AddVector(inner, weight);
        // The halves of side k: t runs from its middle to its ends.
        if (const auto normal = normals.At((1 - t) / 2)) {
          Combination outer;
          derivatives.AddAcross(k, true, true, t, 1, outer);
          conditions.AddAlong(outer, *normal, weight);
        }
        if (const auto normal = normals.At((1 + t) / 2)) {
          Combination outer;
          derivatives.AddAcross(next, false, true, t, 1, outer);
          conditions.AddAlong(outer, *normal, weight);
        }
      }
    }
  }
}

// The thin plate's energy of all patches: a matrix over unknowns, and the pull of given points.
void AddEnergy(const HoleNet& net, std::vector<Triplet>& matrix, Eigen::Matrix3Xd& right) {
  const auto [mass, slope, bending] = GramMatrices(net.basis());
  const int size = net.size(), p = net.basis().degree();
  for (int patch = 0; patch < net.sides(); ++patch) {
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) {
        const int row = net.Index(patch, i, j);
        if (row < 0) continue;
        for (int k = std::max(0, i - p); k <= std::min(size - 1, i + p); ++k) {
          for (int l = std::max(0, j - p); l <= std::min(size - 1, j + p); ++l) {
            const double value = bending(i, k) * mass(j, l) + 2 * slope(i, k) * slope(j, l) +
                                 mass(i, k) * bending(j, l);
            const int column = net.Index(patch, k, l);
            if (column < 0) {
              right.col(row) -= value * net.Given(column);
            } else {
              for (int c = 0; c < 3; ++c) matrix.emplace_back(3 * row + c, 3 * column + c, value);
            }
          }
        }
      }
    }
  }
}

}  // namespace

Eigen::Matrix3Xd SolvedHole(const HoleNet& net, const std::vector<HoleSide>& sides) {
  // Of the conditions against the energy: high enough that few multiplier steps settle, low enough
  // that the factorization keeps its digits; 1e4 and 1e8 give the same angles.
  constexpr double kPenalty = 1e6;
  constexpr int kSteps = 12;
  const int unknowns = 3 * net.unknowns();
  std::vector<Triplet> energy;
  Eigen::Matrix3Xd pull = Eigen::Matrix3Xd::Zero(3, net.unknowns());
  AddEnergy(net, energy, pull);
  Sparse E(unknowns, unknowns);
  E.setFromTriplets(energy.begin(), energy.end());
  Conditions conditions;
  AddConditions(net, sides, conditions);
  const Sparse C = conditions.Matrix(unknowns);
  const Eigen::VectorXd d = conditions.Right();
  const Eigen::SimplicialLDLT<Sparse> factor(E + kPenalty * Sparse(C.transpose() * C));
  Eigen::VectorXd x, multipliers = Eigen::VectorXd::Zero(d.size());
  for (int k = 0; k < kSteps; ++k) {
    x = factor.solve(pull.reshaped() + C.transpose() * (kPenalty * d - multipliers));
    multipliers += kPenalty * (C * x - d);
  }
  return x.reshaped(3, net.unknowns());
}

}  // namespace batten::internal
