// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "batten/geometry/power_form.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/forms/power_basis.h"
#include "geometry/forms/power_checks.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten {
using namespace internal;
namespace {

// Columns i·(q + 1) + j of a cell changed in both directions.
Eigen::Matrix4Xd Changed(const Eigen::Matrix4Xd& cell,
                         const Eigen::MatrixXd& change_u,
                         const Eigen::MatrixXd& change_v) {
  const Eigen::Index p = change_u.rows() - 1, q = change_v.rows() - 1;
  Eigen::Matrix4Xd half(4, cell.cols()), whole(4, cell.cols());
  for (Eigen::Index i = 0; i <= p; ++i) {
    half.middleCols(i * (q + 1), q + 1) = cell.middleCols(i * (q + 1), q + 1) * change_v;
  }
  whole.setZero();
  for (Eigen::Index i = 0; i <= p; ++i) {
    for (Eigen::Index k = 0; k <= p; ++k) {
      whole.middleCols(k * (q + 1), q + 1) += change_u(i, k) * half.middleCols(i * (q + 1), q + 1);
    }
  }
  return whole;
}

double LossOf(const PowerSurface& power, const NurbsSurface& surface) {
  double error = 0;
  for (size_t k = 0; k + 1 < power.breaks_u.size(); ++k) {
    for (size_t l = 0; l + 1 < power.breaks_v.size(); ++l) {
      for (const double t : PlacesIn(power.degree_u)) {
        const double u = power.breaks_u[k] + t * (power.breaks_u[k + 1] - power.breaks_u[k]);
        for (const double s : PlacesIn(power.degree_v)) {
          const double v = power.breaks_v[l] + s * (power.breaks_v[l + 1] - power.breaks_v[l]);
          error = std::max(error, (power.At(u, v) - surface.At(u, v)).norm());
        }
      }
    }
  }
  return error;
}

void CheckSizes(const PowerSurface& power) {
  CheckPowers(power.degree_u, power.breaks_u, "breaks_u");
  CheckPowers(power.degree_v, power.breaks_v, "breaks_v");
  const Eigen::Index wanted = (std::ssize(power.breaks_u) - 1) * (std::ssize(power.breaks_v) - 1) *
                              (power.degree_u + 1) * (power.degree_v + 1);
  RequireThat(power.coefficients.cols() == wanted,
              "FromPower",
              std::to_string(power.coefficients.cols()) +
                  " coefficients, but cells times powers are " + std::to_string(wanted));
  RequireThat(power.coefficients.allFinite(), "FromPower", "a coefficient is not finite");
}

}  // namespace

Eigen::Vector3d PowerSurface::At(double u, double v) const {
  const auto [k, t] = PlaceIn(breaks_u, u);
  const auto [l, s] = PlaceIn(breaks_v, v);
  const Eigen::Index cells_v = std::ssize(breaks_v) - 1, q = degree_v;
  const Eigen::Index first = (k * cells_v + l) * (degree_u + 1) * (q + 1);
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (int i = degree_u; i >= 0; --i) {
    Eigen::Vector4d row = coefficients.col(first + i * (q + 1) + q);
    for (Eigen::Index j = q - 1; j >= 0; --j) {
      row = row * s + coefficients.col(first + i * (q + 1) + j);
    }
    sum = sum * t + row;
  }
  return sum.head<3>() / sum[3];
}

PowerSurface ToPower(const NurbsSurface& surface, double tolerance) {
  RefuseTrims(surface.trimmed(), "ToPower", "powers have no loops");
  PowerSurface power;
  power.degree_u = surface.basis_u().degree();
  power.degree_v = surface.basis_v().degree();
  power.breaks_u = BreaksIn(surface.basis_u());
  power.breaks_v = BreaksIn(surface.basis_v());
  power.rational = surface.rational();
  const SurfacePieces pieces(surface);
  const Eigen::Index count = Eigen::Index{power.degree_u + 1} * (power.degree_v + 1);
  power.coefficients.resize(4, count * pieces.count_u() * pieces.count_v());
  const Eigen::MatrixXd change_u = PowersOfBernstein(power.degree_u);
  const Eigen::MatrixXd change_v = PowersOfBernstein(power.degree_v);
  for (int k = 0; k < pieces.count_u(); ++k) {
    for (int l = 0; l < pieces.count_v(); ++l) {
      const SurfacePiece piece = pieces.Piece(k, l);
      Eigen::Matrix4Xd cell = Changed(piece.points, change_u, change_v);
      if (!power.rational) cell.row(3) = Eigen::RowVectorXd::Unit(count, 0);
      cell.topRows<3>() += piece.origin * cell.row(3);
      power.coefficients.middleCols((Eigen::Index{k} * pieces.count_v() + l) * count, count) = cell;
    }
  }
  RefusePowerLoss(surface.control_points(),
                  LossOf(power, surface),
                  tolerance,
                  std::max(power.degree_u, power.degree_v));
  return power;
}

NurbsSurface FromPower(const PowerSurface& power) {
  CheckSizes(power);
  const Eigen::Index p = power.degree_u, q = power.degree_v;
  const Eigen::Index cells_u = std::ssize(power.breaks_u) - 1,
                     cells_v = std::ssize(power.breaks_v) - 1;
  const Eigen::Index size_u = cells_u * p + 1, size_v = cells_v * q + 1;
  const Eigen::MatrixXd change_u = BernsteinOfPowers(power.degree_u);
  const Eigen::MatrixXd change_v = BernsteinOfPowers(power.degree_v);
  Eigen::Matrix4Xd net(4, size_u * size_v);
  std::vector<bool> set(size_u * size_v, false);
  for (Eigen::Index k = 0; k < cells_u; ++k) {
    for (Eigen::Index l = 0; l < cells_v; ++l) {
      const Eigen::Index count = (p + 1) * (q + 1);
      const Eigen::Matrix4Xd cell = Changed(
          power.coefficients.middleCols((k * cells_v + l) * count, count), change_u, change_v);
      const Eigen::Index corner = k * p * size_v + l * q;
      RequireThat(cell(3, 0) > 0, "FromPower", "a weight is not positive");
      const double scale = set[corner] ? net(3, corner) / cell(3, 0) : 1;
      for (Eigen::Index i = 0; i <= p; ++i) {
        for (Eigen::Index j = 0; j <= q; ++j) {
          const Eigen::Index at = (k * p + i) * size_v + l * q + j;
          Eigen::VectorXd point = scale * cell.col(i * (q + 1) + j);
          if (set[at]) CloseGap(net.col(at), point, scale * cell, power.breaks_u[k]);
          net.col(at) = point;
          set[at] = true;
        }
      }
    }
  }
  Eigen::VectorXd weights;
  Eigen::Matrix3Xd points = net.topRows<3>();
  if (power.rational) {
    weights = net.row(3).transpose();
    for (Eigen::Index k = 0; k < points.cols(); ++k) points.col(k) /= weights[k];
  }
  return NurbsSurface(BezierFormBasis(power.degree_u, power.breaks_u),
                      BezierFormBasis(power.degree_v, power.breaks_v),
                      std::move(points),
                      std::move(weights));
}

}  // namespace batten
