// SPDX-License-Identifier: MIT
#include "fitting/constraints/refined_edge_basis.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "batten/geometry/clamp.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/reparameterize.h"
#include "fitting/constraints/edge_products.h"
#include "fitting/core/rounding.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/least_squares/nested_bases.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

constexpr double kFieldTurn = 1e-7;   // of the field, the part of it across the curve
constexpr int kKnotHalvings = 7;      // of a span, at most
constexpr int kMostFunctions = 1500;  // then no further refinement
constexpr double kLeastAngle = 1e-6;  // between field and curve

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using KnotCounts = std::map<double, int>;

// Knots inside the domain with their multiplicities.
KnotCounts InnerKnots(const SplineBasis& basis) {
  KnotCounts counts;
  for (const double knot : basis.knots()) {
    if (knot > basis.lower() && knot < basis.upper()) ++counts[knot];
  }
  return counts;
}

// The value among the counts that is next to x, if it is near.
double Nearest(const KnotCounts& counts, double x, double near) {
  const auto above = counts.lower_bound(x);
  if (above != counts.end() && above->first - x <= near) return above->first;
  if (above != counts.begin() && x - std::prev(above)->first <= near)
    return std::prev(above)->first;
  return x;
}

// The knots moved onto near ones of `counts`, or onto the ends of the domain.
SplineBasis Snapped(const SplineBasis& basis, const KnotCounts& counts, double near) {
  std::vector<double> knots = basis.knots();
  for (double& knot : knots) {
    if (knot - basis.lower() <= near) {
      knot = basis.lower();
    } else if (basis.upper() - knot <= near) {
      knot = basis.upper();
    } else {
      knot = Nearest(counts, knot, near);
    }
  }
  return SplineBasis(basis.degree(), std::move(knots));
}

NurbsCurve<3> OverDomain(const NurbsCurve<3>& curve,
                         const SplineBasis& along,
                         const std::string& name) {
  const double length = along.upper() - along.lower();
  if (curve.rational())
    Reject("SurfaceConstraints", name + " has weights; it must be a polynomial spline");
  if (std::abs(curve.basis().lower() - along.lower()) > kRelativelyEqual * length ||
      std::abs(curve.basis().upper() - along.upper()) > kRelativelyEqual * length)
    Reject("SurfaceConstraints",
           name + " is over [" + NumberText(curve.basis().lower()) + ", " +
               NumberText(curve.basis().upper()) + "], the surface's basis along it over [" +
               NumberText(along.lower()) + ", " + NumberText(along.upper()) + "]");
  const NurbsCurve<3> open = Clamped(curve);
  return open.basis().lower() == along.lower() && open.basis().upper() == along.upper()
             ? open
             : Reparameterized(open, along.lower(), along.upper());
}

void Demand(KnotCounts& counts, const KnotCounts& more, double near, int raise) {
  for (const auto& [knot, count] : more) {
    if (count + raise <= 0) continue;
    int& have = counts[Nearest(counts, knot, near)];
    have = std::max(have, count + raise);
  }
}

std::vector<double> Missing(const KnotCounts& wanted, const SplineBasis& basis) {
  const KnotCounts have = InnerKnots(basis);
  std::vector<double> missing;
  for (const auto& [knot, count] : wanted) {
    const auto found = have.find(knot);
    const int there = found == have.end() ? 0 : found->second;
    missing.insert(missing.end(), static_cast<size_t>(std::max(0, count - there)), knot);
  }
  return missing;
}

// How far the products of the coarse functions with the field, and with the curve's direction, are
// from the splines over the basis: spans where it is too much.
std::vector<double> PoorMiddles(const SplineBasis& coarse,
                                const SplineBasis& fine,
                                const ReadyEdge& edge,
                                double most) {
  const int p = coarse.degree();
  const double speed = SpeedOf(edge.curve);
  const auto products = EdgeProducts(coarse, fine, edge, speed);
  std::vector<double> middles;
  std::array<double, kMaxDegree + 1> F, N;
  for (const int span : fine.Spans()) {
    const double a = fine.knots()[span], b = fine.knots()[span + 1];
    const int over = coarse.Span((a + b) / 2);
    double worst = 0;
    for (int k = 0; k <= p; ++k) {
      const double u = a + (b - a) * (k + 0.5) / (p + 1);
      fine.Values(span, u, F.data());
      coarse.Values(over, u, N.data());
      Eigen::Matrix<double, 6, Eigen::Dynamic> errors(6, p + 1);
      errors.topRows<3>() = edge.across->At(u) * Eigen::Map<Eigen::RowVectorXd>(N.data(), p + 1);
      errors.bottomRows<3>() = edge.curve.Derivatives(u, 1).col(1) / speed *
                               Eigen::Map<Eigen::RowVectorXd>(N.data(), p + 1);
      for (int s = 0; s <= p; ++s) {
        for (size_t d = 0; d < 6; ++d) {
          for (Sparse::InnerIterator it(products[d], span - p + s); it; ++it) {
            const Eigen::Index r = it.col() - over + p;
            if (r >= 0 && r <= p)
              errors(static_cast<Eigen::Index>(d), r) -= F[static_cast<size_t>(s)] * it.value();
          }
        }
      }
      worst = std::max({worst,
                        errors.topRows<3>().colwise().norm().maxCoeff(),
                        errors.bottomRows<3>().colwise().norm().maxCoeff()});
    }
    if (worst > most) middles.push_back((a + b) / 2);
  }
  return middles;
}

// The least part of the field across the curve; throws where there is hardly any.
double LeastAcross(const ReadyEdge& edge, const SplineBasis& fine) {
  double least = std::numeric_limits<double>::infinity();
  for (const int span : fine.Spans()) {
    for (int k = 0; k <= 4; ++k) {
      const double a = fine.knots()[span], b = fine.knots()[span + 1], u = a + (b - a) * k / 4;
      const Eigen::Vector3d field = edge.across->At(u), along = edge.curve.Derivatives(u, 1).col(1);
      const double across = field.cross(along.normalized()).norm();
      if (!(across > kLeastAngle * field.norm()) || !(along.norm() > 0))
        Reject("SurfaceConstraints",
               "the directions across " + edge.name + " and the curve itself are parallel at " +
                   NumberText(u) + ": no tangent plane");
      least = std::min(least, across);
    }
  }
  return least;
}

}  // namespace

double SpeedOf(const NurbsCurve<3>& curve) {
  return BoxDiagonal(curve.control_points()) / (curve.basis().upper() - curve.basis().lower());
}

std::string NameOf(const SurfaceEdge& edge) {
  return std::string("the edge ") + (edge.direction == Direction::kU ? "u" : "v") + " = " +
         (edge.upper ? "upper" : "lower");
}

ReadyEdge ReadyFor(const FixedEdge& edge, const SplineBasis& along, const Eigen::Vector3d& centre) {
  const std::string name = NameOf(edge.edge);
  const int p = along.degree();
  if (edge.curve.basis().degree() > p)
    Reject("SurfaceConstraints",
           name + " has degree " + std::to_string(edge.curve.basis().degree()) +
               ", the surface's basis along it " + std::to_string(p));
  const double near = kRelativeRounding * (along.upper() - along.lower());
  const NurbsCurve<3> open =
      Elevated(OverDomain(edge.curve, along, name), p - edge.curve.basis().degree());
  const NurbsCurve<3> curve(Snapped(open.basis(), InnerKnots(along), near),
                            open.control_points().colwise() - centre);
  ReadyEdge ready{edge.edge, curve, curve, std::nullopt, name};
  if (!edge.across) return ready;
  const NurbsCurve<3> field = OverDomain(*edge.across, along, "the direction across " + name);
  const double size = field.control_points().colwise().norm().maxCoeff();
  if (!(size > 0)) Reject("SurfaceConstraints", "the direction across " + name + " vanishes");
  ready.across = NurbsCurve<3>(field.basis(), field.control_points() / size);
  return ready;
}

RefinedEdgeBasis RefinedEdgeBasisFor(const SplineBasis& coarse, std::vector<ReadyEdge>& edges) {
  const int p = coarse.degree();
  const double near = kRelativeRounding * (coarse.upper() - coarse.lower());
  KnotCounts wanted = InnerKnots(coarse);
  for (ReadyEdge& edge : edges) {
    edge.curve =
        NurbsCurve<3>(Snapped(edge.curve.basis(), wanted, near), edge.curve.control_points());
    const KnotCounts own = InnerKnots(edge.curve.basis());
    Demand(wanted, own, near, edge.across ? 1 : 0);
    if (!edge.across) continue;
    Demand(wanted, InnerKnots(edge.across->basis()), near, p - edge.across->basis().degree());
    for (const auto& [knot, count] : wanted) {
      if (count > p)
        Reject("SurfaceConstraints",
               edge.name + " has a corner at " + NumberText(knot) +
                   ": no tangent planes can be met along it");
    }
  }
  const SplineBasis least = WithInnerKnots(coarse, Missing(wanted, coarse));
  SplineBasis fine = least;
  for (const ReadyEdge& edge : edges) {
    if (!edge.across) continue;
    const double most = kFieldTurn * LeastAcross(edge, fine);
    for (int halving = 0; halving < kKnotHalvings && fine.size() < kMostFunctions; ++halving) {
      const std::vector<double> middles = PoorMiddles(coarse, fine, edge, most);
      if (middles.empty()) break;
      fine = WithInnerKnots(fine, middles);
    }
  }
  for (ReadyEdge& edge : edges) {
    edge.plain = edge.curve;
    edge.curve = RefineKnots(edge.plain, MissingKnots(edge.plain.basis(), fine));
  }
  return {coarse, least, fine, KnotInsertion(coarse, fine)};
}

}  // namespace batten::internal
