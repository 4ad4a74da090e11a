// SPDX-License-Identifier: MIT
#include "fitting/constraints/linear_constraints.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "fitting/constraints/edge_values.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

// The surface or a first derivative at a place, as a function of all unknowns.
struct Functional {
  std::vector<std::pair<Eigen::Index, double>> inner;  // coarse control points
  Eigen::MatrixXd unknowns;                            // 3 × t
  Eigen::Vector3d given;
  double scale;  // of all coarse functions, inner or not
};

Functional FunctionalAt(const EdgeRows& edges, double u, double v, int order_u, int order_v) {
  AxisValues at_u(edges.u, u, order_u), at_v(edges.v, v, order_v);
  Functional result{{}, Eigen::MatrixXd::Zero(3, edges.unknowns), Eigen::Vector3d::Zero(), 0};
  for (int i = at_u.first(); i <= at_u.first() + edges.u.coarse.degree(); ++i) {
    for (int j = at_v.first(); j <= at_v.first() + edges.v.coarse.degree(); ++j) {
      const double value = at_u.Coarse(i) * at_v.Coarse(j);
      result.scale += value * value;
      if (edges.taken_u[static_cast<size_t>(i)] || edges.taken_v[static_cast<size_t>(j)]) continue;
      result.inner.emplace_back(Eigen::Index{i} * edges.v.coarse.size() + j, value);
    }
  }
  result.scale = std::sqrt(result.scale);
  VisitEdges(edges, at_u, at_v, [&](int unknown, int d, double value) {
    (unknown < 0 ? result.given[d] : result.unknowns(d, unknown)) += value;
  });
  return result;
}

void CheckPoint(const FixedPoint& point, const EdgeRows& edges, const std::string& name) {
  const SplineBasis &u = edges.u.coarse, &v = edges.v.coarse;
  if (!(point.u >= u.lower() && point.u <= u.upper() && point.v >= v.lower() &&
        point.v <= v.upper()))
    Reject("SurfaceConstraints",
           name + " lies outside the domain " + IntervalText(u.lower(), u.upper()) + " × " +
               IntervalText(v.lower(), v.upper()));
  if (!point.place && !point.normal)
    Reject("SurfaceConstraints", name + " asks for neither place nor normal");
  if (point.place && !point.place->allFinite())
    Reject("SurfaceConstraints", "the place of " + name + " is not finite");
  if (point.normal && !(point.normal->norm() > 0 && point.normal->allFinite()))
    Reject("SurfaceConstraints", "the normal of " + name + " is zero or not finite");
}

}  // namespace

Eigen::MatrixXd LinearConstraints::Rows(const std::vector<Eigen::Index>& columns) const {
  const auto width = static_cast<Eigen::Index>(columns.size());
  std::map<Eigen::Index, Eigen::Index> place;
  for (Eigen::Index c = 0; c < width; ++c) place[columns[static_cast<size_t>(c)]] = c;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count(), 3 * width + unknowns.cols());
  for (Eigen::Index k = 0; k < count(); ++k) {
    const int f = functional[static_cast<size_t>(k)];
    if (f < 0) continue;  // of unknowns alone; there may be no functional at all
    for (Eigen::SparseMatrix<double>::InnerIterator it(functionals, f); it; ++it) {
      for (int d = 0; d < 3; ++d) {
        rows(k, d * width + place.at(it.row())) += directions(d, k) * it.value();
      }
    }
  }
  rows.rightCols(unknowns.cols()) = unknowns;
  return rows;
}

std::vector<Eigen::Index> LinearConstraints::Columns() const {
  std::vector<char> takes_part(static_cast<size_t>(functionals.rows()), 0);
  for (int f = 0; f < functionals.cols(); ++f) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(functionals, f); it; ++it) {
      takes_part[static_cast<size_t>(it.row())] = 1;
    }
  }
  std::vector<Eigen::Index> columns;
  for (size_t c = 0; c < takes_part.size(); ++c) {
    if (takes_part[c]) columns.push_back(static_cast<Eigen::Index>(c));
  }
  return columns;
}

LinearConstraints ConditionsOf(const EdgeRows& edges,
                               const std::vector<FixedPoint>& points,
                               const Eigen::Vector3d& centre) {
  using Kind = ConditionBlock::Kind;
  Eigen::Index most = 3 * std::ssize(edges.corners);
  for (const FixedPoint& point : points) most += (point.place ? 3 : 0) + (point.normal ? 2 : 0);
  LinearConstraints result;
  result.directions.resize(3, most);
  result.unknowns.resize(most, edges.unknowns);
  result.right.resize(most);
  result.scales.resize(most);
  std::vector<Eigen::Triplet<double>> entries;
  int functionals = 0;
  const auto add_functional = [&](const Functional& functional) {
    for (const auto& [place, value] : functional.inner)
      entries.emplace_back(place, functionals, value);
    return functionals++;
  };
  const auto rows = [&] { return std::ssize(result.functional); };
  const auto add_row = [&](int functional,
                           const Eigen::Vector3d& direction,
                           const Eigen::RowVectorXd& unknowns,
                           double right,
                           double scale) {
    const Eigen::Index k = rows();
    result.functional.push_back(functional);
    result.directions.col(k) = direction;
    result.unknowns.row(k) = unknowns;
    result.right[k] = right;
    result.scales[k] = scale;
  };
  for (const CornerCondition& corner : edges.corners) {
    result.blocks.push_back({corner.length > 0 ? Kind::kCornerPlane : Kind::kTwist,
                             corner.name,
                             rows(),
                             3,
                             corner.length,
                             0});
    for (int d = 0; d < 3; ++d) {
      add_row(-1, Eigen::Vector3d::Zero(), corner.unknowns.row(d), -corner.given[d], 1);
    }
  }
  for (size_t k = 0; k < points.size(); ++k) {
    const FixedPoint& point = points[k];
    const auto index = static_cast<Eigen::Index>(k);
    const std::string name = "point " + std::to_string(k) + " at (" + NumberText(point.u) + ", " +
                             NumberText(point.v) + ")";
    CheckPoint(point, edges, name);
    if (point.place) {
      result.blocks.push_back({Kind::kPlace, "the place of " + name, rows(), 3, 0, index});
      const Functional value = FunctionalAt(edges, point.u, point.v, 0, 0);
      const int f = add_functional(value);
      for (int d = 0; d < 3; ++d) {
        add_row(f,
                Eigen::Vector3d::Unit(d),
                value.unknowns.row(d),
                (*point.place - centre - value.given)[d],
                value.scale);
      }
    }
    if (!point.normal) continue;
    result.blocks.push_back({Kind::kNormal, "the normal of " + name, rows(), 2, 0, index});
    const Eigen::Vector3d normal = point.normal->normalized();
    for (int along_v = 0; along_v < 2; ++along_v) {
      const Functional slope = FunctionalAt(edges, point.u, point.v, 1 - along_v, along_v);
      add_row(add_functional(slope),
              normal,
              normal.transpose() * slope.unknowns,
              -normal.dot(slope.given),
              slope.scale);
    }
  }
  result.functionals.resize(Eigen::Index{edges.u.coarse.size()} * edges.v.coarse.size(),
                            functionals);
  result.functionals.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace batten::internal
