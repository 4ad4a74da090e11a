// SPDX-License-Identifier: MIT
#include "fitting/constraints/symmetric_net.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

SplineBasis SymmetricBasis(const SplineBasis& basis) {
  const std::vector<double>& old = basis.knots();
  const double sum = basis.lower() + basis.upper();
  std::vector<double> knots = old;
  for (size_t i = 0; i < old.size(); ++i) {
    const double mirrored = sum - old[old.size() - 1 - i];
    if (!(std::abs(mirrored - old[i]) <= kRelativelyEqual * (basis.upper() - basis.lower())))
      throw std::invalid_argument("SymmetricNet: the knots are not symmetric");
    // The lower half decides, so that equal knots stay equal.
    if (2 * i >= old.size()) knots[i] = sum - old[old.size() - 1 - i];
  }
  std::sort(knots.begin(), knots.end());
  return basis.periodic() ? SplineBasis::Periodic(basis.degree(), std::move(knots))
                          : SplineBasis(basis.degree(), std::move(knots));
}

// Column of control point i of the direction, j of the other.
Eigen::Index ColumnOf(const NurbsSurface& surface, Direction direction, int i, int j) {
  return direction == Direction::kU ? Eigen::Index{i} * surface.size_v() + j
                                    : Eigen::Index{j} * surface.size_v() + i;
}

}  // namespace

NurbsSurface SymmetricNet(const NurbsSurface& surface,
                          Direction direction,
                          const MirrorPlane& plane) {
  const bool u = direction == Direction::kU;
  const SplineBasis& basis = u ? surface.basis_u() : surface.basis_v();
  const int size = basis.size(), other = u ? surface.size_v() : surface.size_u();
  Eigen::Matrix3Xd points = surface.control_points();
  Eigen::VectorXd weights = surface.weights();
  for (int j = 0; j < other; ++j) {
    for (int i = 0; 2 * i < size; ++i) {
      const Eigen::Index a = ColumnOf(surface, direction, i, j),
                         b = ColumnOf(surface, direction, size - 1 - i, j);
      const Eigen::Vector3d first = points.col(a), last = points.col(b);
      points.col(a) = first + (plane.Mirrored(last) - first) / 2;
      points.col(b) = a == b ? points.col(a) : plane.Mirrored(points.col(a));
      weights[a] = weights[b] = (weights[a] + weights[b]) / 2;
    }
    for (int i = 0; basis.periodic() && i < basis.degree(); ++i) {
      const Eigen::Index from = ColumnOf(surface, direction, i, j),
                         to = ColumnOf(surface, direction, size - basis.degree() + i, j);
      points.col(to) = points.col(from);
      weights[to] = weights[from];
    }
  }
  return NurbsSurface(u ? SymmetricBasis(surface.basis_u()) : surface.basis_u(),
                      u ? surface.basis_v() : SymmetricBasis(surface.basis_v()),
                      std::move(points),
                      std::move(weights))
      .WithTrims(surface.trims());
}

}  // namespace batten::internal
