// SPDX-License-Identifier: MIT
#include "fitting/foot_points/joint_foot_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "batten/geometry/curve_evaluator.h"
#include "batten/geometry/direction.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"

namespace batten::internal {
namespace {

constexpr int kPlaces = 4;  // places of orientation in a cell, each direction

NurbsSurface ToSurface(const TensorShape& shape) {
  return NurbsSurface(shape.basis_u, *shape.basis_v, shape.net, shape.weights);
}

template <int Dim>
NurbsCurve<Dim> ToCurve(const TensorShape& shape) {
  return NurbsCurve<Dim>(shape.basis_u, shape.net, shape.weights);
}

// Whether a foot point cannot move in both directions: at an end, or at a knot where the shape may
// have a kink.
bool Held(const SplineBasis& basis, double u) {
  if (!basis.periodic() && (u <= basis.lower() || u >= basis.upper())) return true;
  const std::vector<double>& knots = basis.knots();
  const int span = basis.Span(u);
  return knots[span] == u && knots[span - basis.degree() + 1] == u;
}

void Resize(FootPointSet& feet, Eigen::Index dimension, Eigen::Index count) {
  feet.parameters.resize(2, count);
  feet.difference.resize(dimension, count);
  feet.first.resize(dimension, count);
  feet.second.resize(dimension, count);
  feet.directions.resize(static_cast<size_t>(count));
}

template <int Dim>
void ProjectOn(const TensorShape& shape,
               const Eigen::MatrixXd& points,
               bool orthogonal,
               const Eigen::Matrix2Xd& starts,
               ThreadPool& pool,
               FootPointSet& feet) {
  const NurbsCurve<Dim> curve = ToCurve<Dim>(shape);
  const CurveEvaluator<Dim> evaluator(curve);
  const std::optional<CurveFootPoints<Dim>> finder =
      orthogonal ? std::make_optional<CurveFootPoints<Dim>>(curve) : std::nullopt;
  pool.For(points.cols(), kSlowPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      double u = starts(0, k);
      if (orthogonal) {
        Eigen::Vector3d q = Eigen::Vector3d::Zero();
        q.head<Dim>() = points.col(k);
        u = finder->Near(q, u).u;
      }
      const CurveJet<Dim> jet = evaluator.JetAt(u);
      feet.parameters.col(k) << u, 0;
      feet.difference.col(k) = jet.point - points.col(k);
      feet.directions[k] = 0;
      const double speed = jet.first.norm();
      if (!orthogonal || Held(shape.basis_u, u) || !(speed > 0)) continue;
      const Eigen::Matrix<double, Dim, 1> t = jet.first / speed;
      feet.directions[k] = Dim - 1;
      if constexpr (Dim == 2) {
        feet.first.col(k) << -t[1], t[0];
      } else {
        const Eigen::Vector3d first = t.unitOrthogonal();
        feet.first.col(k) = first;
        feet.second.col(k) = t.cross(first);
      }
    }
  });
}

// The parameter of the place nearest to a point along the surface's line of the other one, by
// Newton's steps from a start nearby, halved where they do not come nearer.
double NearestAlong(const SurfaceEvaluator& surface,
                    const Eigen::Vector3d& point,
                    Eigen::Vector2d at,
                    Direction direction) {
  const bool in_u = direction == Direction::kU;
  double& free = at[in_u ? 0 : 1];
  const SplineBasis& basis = in_u ? surface.surface().basis_u() : surface.surface().basis_v();
  double nearest = std::numeric_limits<double>::infinity(), best = free, step = 0;
  for (int k = 0; k < kMostIterations; ++k) {
    const SurfaceJet jet = surface.JetAt(at[0], at[1]);
    const Eigen::Vector3d off = point - jet.point;
    if (off.squaredNorm() < nearest) {
      nearest = off.squaredNorm();
      best = free;
      const Eigen::Vector3d &first = in_u ? jet.du : jet.dv, &second = in_u ? jet.duu : jet.dvv;
      const double newton = first.squaredNorm() - off.dot(second);
      step = off.dot(first) / (newton > 0 ? newton : first.squaredNorm());
      if (!std::isfinite(step)) break;
    } else {
      step /= 2;
    }
    if (std::abs(step) <= kRelativeRounding * (basis.upper() - basis.lower())) break;
    const double next = basis.Clamp(best + step);
    if (next == free || next == best) break;
    free = next;
  }
  return best;
}

std::vector<double> Places(const SplineBasis& basis) {
  std::vector<double> places;
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int g = 0; g < kPlaces; ++g) places.push_back(a + (b - a) * (g + 0.5) / kPlaces);
  }
  return places;
}

template <int Dim>
Eigen::MatrixXd Tangents(const TensorShape& shape) {
  const NurbsCurve<Dim> curve = ToCurve<Dim>(shape);
  const std::vector<double> places = Places(shape.basis_u);
  Eigen::MatrixXd tangents = Eigen::MatrixXd::Zero(Dim, std::ssize(places));
  for (size_t k = 0; k < places.size(); ++k) {
    const Eigen::Matrix<double, Dim, 1> first = curve.JetAt(places[k]).first;
    const double speed = first.norm();
    if (speed > 0) tangents.col(static_cast<Eigen::Index>(k)) = first / speed;
  }
  return tangents;
}

// The index of the place in one direction whose part of the span holds a parameter.
class PlaceFinder {
 public:
  explicit PlaceFinder(const SplineBasis& basis)
      : basis_(basis), rank_(static_cast<size_t>(basis.size()), 0) {
    const std::vector<int> spans = basis.Spans();
    for (size_t k = 0; k < spans.size(); ++k) rank_[static_cast<size_t>(spans[k])] = k;
    places_ = spans.size() * kPlaces;
  }
  size_t places() const { return places_; }
  struct Place {
    size_t index;
    double middle;  // its parameter
  };
  Place At(double u) const {
    const int span = basis_.Span(u);
    const double a = basis_.knots()[span], b = basis_.knots()[span + 1];
    const int part = std::clamp(static_cast<int>(kPlaces * ((u - a) / (b - a))), 0, kPlaces - 1);
    return {rank_[static_cast<size_t>(span)] * kPlaces + static_cast<size_t>(part),
            a + (b - a) * (part + 0.5) / kPlaces};
  }

 private:
  const SplineBasis& basis_;
  std::vector<size_t> rank_;
  size_t places_;
};

}  // namespace

void TensorShape::Rational(int span_u, int span_v, double u, double v, double* R) const {
  const int p = basis_u.degree(), q = degree_v();
  double Nu[kMaxDegree + 1], Nv[kMaxDegree + 1];
  basis_u.Values(span_u, u, Nu);
  Nv[0] = 1;
  if (basis_v) basis_v->Values(span_v, v, Nv);
  double sum = 0;
  for (int r = 0, k = 0; r <= p; ++r) {
    const Eigen::Index row = ControlPoint(span_u, span_v, r * (q + 1));
    for (int s = 0; s <= q; ++s, ++k) sum += R[k] = Nu[r] * Nv[s] * weights[row + s];
  }
  for (int k = 0; k < functions(); ++k) R[k] /= sum;
}

void FootProjector::Project(const TensorShape& shape,
                            const Eigen::Matrix2Xd& starts,
                            FootPointSet& feet) const {
  Resize(feet, points_.rows(), points_.cols());
  if (shape.basis_v) {
    ProjectOnSurface(shape, starts, feet);
  } else if (shape.dimension() == 2) {
    ProjectOn<2>(shape, points_, orthogonal_, starts, pool_, feet);
  } else {
    ProjectOn<3>(shape, points_, orthogonal_, starts, pool_, feet);
  }
}

void FootProjector::ProjectOnSurface(const TensorShape& shape,
                                     const Eigen::Matrix2Xd& starts,
                                     FootPointSet& feet) const {
  const NurbsSurface surface = ToSurface(shape);
  const SurfaceEvaluator evaluator(surface);
  const std::optional<SurfaceFootPoints> finder =
      orthogonal_ ? std::make_optional<SurfaceFootPoints>(surface) : std::nullopt;
  pool_.For(points_.cols(), kSlowPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      double u = starts(0, k), v = starts(1, k);
      const int given = held_.empty() ? 0 : held_[static_cast<size_t>(k)];
      if (orthogonal_) {
        if (given == 0) {
          const SurfaceFoot foot = finder->Near(points_.col(k), u, v);
          u = foot.u;
          v = foot.v;
        } else if (given != 3) {
          double& free = given == 1 ? v : u;
          free = NearestAlong(
              evaluator, points_.col(k), {u, v}, given == 1 ? Direction::kV : Direction::kU);
        }
      }
      const SurfaceJet jet = evaluator.JetAt(u, v);
      feet.parameters.col(k) << u, v;
      feet.difference.col(k) = jet.point - points_.col(k);
      feet.directions[k] = 0;
      if (!orthogonal_) continue;
      const bool held_u = (given & 1) != 0 || Held(shape.basis_u, u);
      const bool held_v = (given & 2) != 0 || Held(*shape.basis_v, v);
      const auto normal = UnitNormal(jet);
      if (!normal || (held_u && held_v)) continue;
      feet.first.col(k) = *normal;
      feet.directions[k] = 1;
      if (held_u || held_v) {
        feet.second.col(k) = normal->cross(held_u ? jet.dv : jet.du).normalized();
        feet.directions[k] = 2;
      }
    }
  });
}

bool Facing::Keeps(const Facing& before) const {
  if (directions.cols() != before.directions.cols() || columns != before.columns) return false;
  const auto opposed = [](const Eigen::MatrixXd& n, Eigen::Index a, Eigen::Index b) {
    return n.col(a).dot(n.col(b)) < 0;
  };
  const auto watches = [&](Eigen::Index g) { return before.watched[static_cast<size_t>(g)]; };
  for (Eigen::Index g = 0; g < directions.cols(); ++g) {
    if (!watches(g)) continue;
    bool folded = false;
    for (const Eigen::Index next : {g + columns, g + 1}) {
      const bool across = next != g + 1 || columns == 1;
      const Eigen::Index place = across ? g / columns : g % columns;
      if (place % kPlaces == kPlaces - 1 || !watches(next)) continue;
      const bool was = opposed(before.directions, g, next);
      folded = folded || was;
      if (!was && opposed(directions, g, next)) return false;
      if (columns == 1) break;
    }
    if (!folded && directions.col(g).dot(before.directions.col(g)) < 0) return false;
  }
  return true;
}

void Facing::Watch(const TensorShape& shape, const Eigen::Matrix2Xd& feet) {
  watched.assign(static_cast<size_t>(directions.cols()), false);
  if (feet.cols() == 0) return;
  const PlaceFinder in_u(shape.basis_u);
  const std::optional<PlaceFinder> in_v =
      shape.basis_v ? std::make_optional<PlaceFinder>(*shape.basis_v) : std::nullopt;
  const Eigen::Vector2d low = feet.rowwise().minCoeff(), high = feet.rowwise().maxCoeff();
  for (Eigen::Index k = 0; k < feet.cols(); ++k) {
    const PlaceFinder::Place u = in_u.At(feet(0, k));
    if (u.middle < low[0] || u.middle > high[0]) continue;
    if (!in_v) {
      watched[u.index] = true;
      continue;
    }
    const PlaceFinder::Place v = in_v->At(feet(1, k));
    if (v.middle < low[1] || v.middle > high[1]) continue;
    watched[u.index * in_v->places() + v.index] = true;
  }
}

Facing FacingOf(const TensorShape& shape, ThreadPool& pool) {
  Facing facing;
  if (!shape.basis_v) {
    facing.directions = shape.dimension() == 2 ? Tangents<2>(shape) : Tangents<3>(shape);
    return facing;
  }
  const std::vector<double> vs = Places(*shape.basis_v);
  SurfaceGrid grid;
  SurfaceEvaluator(ToSurface(shape)).Grid(Places(shape.basis_u), vs, grid, pool);
  facing.directions = std::move(grid.normals);
  facing.columns = std::ssize(vs);
  return facing;
}

}  // namespace batten::internal
