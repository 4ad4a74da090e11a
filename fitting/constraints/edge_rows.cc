// SPDX-License-Identifier: MIT
#include "fitting/constraints/edge_rows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "fitting/constraints/edge_products.h"
#include "fitting/constraints/local_projection.h"
#include "fitting/core/rounding.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

bool AlongU(const SurfaceEdge& edge) { return edge.direction == Direction::kV; }

// The coarse coefficient, first or second from an end, of curves over the fine basis: one for every
// column.
Eigen::VectorXd EndCoefficient(const RefinedEdgeBasis& axis,
                               const Sparse& curves,
                               bool upper,
                               int second) {
  const int last = axis.fine.size() - 1;
  const Eigen::VectorXd end = curves.row(upper ? last : 0).transpose();
  if (second == 0) return end;
  const Eigen::VectorXd next = curves.row(upper ? last - 1 : 1).transpose();
  return end + (next - end) * (EndLength(axis.coarse, upper) / EndLength(axis.fine, upper));
}

int FunctionAt(const SplineBasis& basis, bool upper, int second) {
  return upper ? basis.size() - 1 - second : second;
}

Sparse Column(const Eigen::VectorXd& values) { return values.sparseView(); }

// The given curve alone.
EdgeRow GivenRow(const ReadyEdge& edge, int index, const RefinedEdgeBasis& across) {
  EdgeRow row{AlongU(edge.edge), index, FunctionAt(across.coarse, edge.edge.upper, 0), 0, 0, {}};
  for (int d = 0; d < 3; ++d) row.curves[d] = Column(edge.curve.control_points().row(d));
  return row;
}

// The curve and what the field and the curve's direction add to it for each coefficient of a and b.
EdgeRow TangentRow(const ReadyEdge& edge,
                   int index,
                   const RefinedEdgeBasis& along,
                   const RefinedEdgeBasis& across,
                   int first) {
  const int count = along.coarse.size();
  EdgeRow row{AlongU(edge.edge),
              index,
              FunctionAt(across.coarse, edge.edge.upper, 1),
              first,
              2 * count,
              {}};
  const double sign = edge.edge.upper ? -1 : 1;
  const auto products = EdgeProducts(along.coarse, along.fine, edge, SpeedOf(edge.curve));
  for (size_t d = 0; d < 3; ++d) {
    std::vector<Eigen::Triplet<double>> entries;
    const Eigen::Matrix3Xd& curve = edge.curve.control_points();
    for (int i = 0; i < along.fine.size(); ++i) {
      for (const size_t which : {d, d + 3}) {
        for (Sparse::InnerIterator it(products[which], i); it; ++it) {
          const auto m = static_cast<int>(it.col());
          entries.emplace_back(i, which == d ? m : count + m, sign * it.value());
        }
      }
      entries.emplace_back(i, row.count, curve(static_cast<Eigen::Index>(d), i));
    }
    row.curves[d].resize(along.fine.size(), row.count + 1);
    row.curves[d].setFromTriplets(entries.begin(), entries.end());
  }
  return row;
}

// The end of an edge's curve.
Eigen::Vector3d EndOf(const ReadyEdge& edge, bool upper) {
  const Eigen::Matrix3Xd& points = edge.curve.control_points();
  return points.col(upper ? points.cols() - 1 : 0);
}

// Makes the curves meet at their corners.
void CloseCorners(std::vector<ReadyEdge>& edges) {
  double size = 0;
  for (const ReadyEdge& edge : edges) {
    size = std::max(size, BoxDiagonal(edge.curve.control_points()));
  }
  for (ReadyEdge& row : edges) {
    for (ReadyEdge& column : edges) {
      if (!AlongU(row.edge) || AlongU(column.edge)) continue;
      const Eigen::Vector3d a = EndOf(row, column.edge.upper), b = EndOf(column, row.edge.upper);
      const double gap = (a - b).norm();
      const double rounding =
          16 * std::numeric_limits<double>::epsilon() * std::max(a.norm(), b.norm());
      if (gap > std::max(kRelativelyEqual * size, rounding))
        Reject("SurfaceConstraints",
               row.name + " and " + column.name + " do not meet at their corner: they are " +
                   NumberText(gap) + " apart");
      const auto moved = [&](const NurbsCurve<3>& curve, bool upper) {
        Eigen::Matrix3Xd points = curve.control_points();
        points.col(upper ? points.cols() - 1 : 0) = (a + b) / 2;
        return NurbsCurve<3>(curve.basis(), std::move(points));
      };
      for (const auto curve : {&ReadyEdge::curve, &ReadyEdge::plain}) {
        row.*curve = moved(row.*curve, column.edge.upper);
        column.*curve = moved(column.*curve, row.edge.upper);
      }
    }
  }
}

// The coefficients of a row that stand at a corner: three coordinates by unknowns, and what is
// given.
struct CornerPoint {
  Eigen::MatrixXd unknowns;
  Eigen::Vector3d given;
};

CornerPoint PointOf(
    const EdgeRow& row, const RefinedEdgeBasis& along, bool upper, int second, int unknowns) {
  CornerPoint point{Eigen::MatrixXd::Zero(3, unknowns), Eigen::Vector3d::Zero()};
  for (int d = 0; d < 3; ++d) {
    const Eigen::VectorXd all = EndCoefficient(along, row.curves[d], upper, second);
    point.unknowns.row(d).segment(row.first, row.count) = all.head(row.count).transpose();
    point.given[d] = all[row.count];
  }
  return point;
}

// Two directions of the plane of a and b, and its normal.
Eigen::Matrix3d PlaneFrame(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Matrix3d frame;
  frame.col(0) = a.normalized();
  frame.col(2) = a.cross(b).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame.transpose();
}

struct RowsOfEdge {
  const ReadyEdge* edge;
  std::vector<const EdgeRow*> rows;  // the edge itself, then the next
};

// What a row edge and a column edge ask of each other where they meet.
void AddCorner(EdgeRows& all, const RowsOfEdge& row, const RowsOfEdge& column) {
  const bool upper_u = column.edge->edge.upper, upper_v = row.edge->edge.upper;
  for (size_t i = 0; i < column.rows.size(); ++i) {
    for (size_t j = 0; j < row.rows.size(); ++j) {
      if (i == 0 && j == 0) continue;
      const CornerPoint a =
          PointOf(*row.rows[j], all.u, upper_u, static_cast<int>(i), all.unknowns);
      const CornerPoint b =
          PointOf(*column.rows[i], all.v, upper_v, static_cast<int>(j), all.unknowns);
      const ReadyEdge& holder = j == 1 ? *row.edge : *column.edge;
      const double at = AlongU(holder.edge)
                            ? (upper_u ? all.u.coarse.upper() : all.u.coarse.lower())
                            : (upper_v ? all.v.coarse.upper() : all.v.coarse.lower());
      const Eigen::Matrix3d frame =
          PlaneFrame(holder.curve.Derivatives(at, 1).col(1), holder.across->At(at));
      CornerCondition corner;
      corner.unknowns = frame * (a.unknowns - b.unknowns);
      corner.given = frame * (a.given - b.given);
      const std::string names = row.edge->name + " and " + column.edge->name;
      if (i == 1 && j == 1) {
        corner.name = "the twist at the corner of " + names;
      } else {
        corner.name = "the tangent plane at the corner of " + names;
        corner.length =
            (j == 1 ? b.given - EndOf(*column.edge, upper_v) : a.given - EndOf(*row.edge, upper_u))
                .norm();
      }
      all.corners.push_back(std::move(corner));
    }
  }
}

// Takes the corners' coefficients out of a row: the columns of curves carry them.
void RemoveCorners(EdgeRow& row, const EdgeRows& all, const std::vector<RowsOfEdge>& columns) {
  for (const RowsOfEdge& column : columns) {
    const bool upper = column.edge->edge.upper;
    for (size_t i = 0; i < column.rows.size(); ++i) {
      const int function = FunctionAt(all.u.coarse, upper, static_cast<int>(i));
      for (auto& curves : row.curves) {
        const Eigen::VectorXd taken = EndCoefficient(all.u, curves, upper, static_cast<int>(i));
        const Sparse product =
            Sparse(Column(all.u.raised.col(function))) * Sparse(Column(taken)).transpose();
        curves = Sparse(curves - product);
      }
    }
  }
}

std::vector<char> Taken(const RefinedEdgeBasis& axis,
                        const std::vector<ReadyEdge>& edges,
                        bool along_u) {
  std::vector<char> taken(static_cast<size_t>(axis.coarse.size()), 0);
  int wanted = 0;
  for (const ReadyEdge& edge : edges) {
    if (AlongU(edge.edge) != along_u) continue;
    for (int second = 0; second < (edge.across ? 2 : 1); ++second, ++wanted) {
      const int function = FunctionAt(axis.coarse, edge.edge.upper, second);
      if (function >= 0 && function < axis.coarse.size()) taken[static_cast<size_t>(function)] = 1;
    }
  }
  if (wanted > std::count(taken.begin(), taken.end(), 1))
    Reject("SurfaceConstraints",
           "edges and tangent planes ask for " + std::to_string(wanted) + " control points of " +
               std::to_string(axis.coarse.size()) + " in " + (along_u ? "v" : "u"));
  return taken;
}

void CheckEdges(const SplineBasis& basis_u,
                const SplineBasis& basis_v,
                const std::vector<FixedEdge>& edges) {
  for (size_t k = 0; k < edges.size(); ++k) {
    for (size_t other = 0; other < k; ++other) {
      if (edges[k].edge == edges[other].edge)
        Reject("SurfaceConstraints", NameOf(edges[k].edge) + " is given twice");
    }
  }
  for (const SplineBasis* basis : {&basis_u, &basis_v}) {
    if (!edges.empty() && !basis->clamped())
      Reject("SurfaceConstraints", "a basis with fixed edges must be clamped");
  }
}

std::vector<ReadyEdge> ReadyAlong(bool along_u,
                                  const SplineBasis& basis,
                                  const std::vector<FixedEdge>& edges,
                                  const Eigen::Vector3d& centre) {
  std::vector<ReadyEdge> ready;
  for (const FixedEdge& edge : edges) {
    if (AlongU(edge.edge) == along_u) ready.push_back(ReadyFor(edge, basis, centre));
  }
  return ready;
}

}  // namespace

EdgeRows EdgeRowsOf(const SplineBasis& basis_u,
                    const SplineBasis& basis_v,
                    const std::vector<FixedEdge>& edges,
                    const Eigen::Vector3d& centre) {
  CheckEdges(basis_u, basis_v, edges);
  std::vector<ReadyEdge> along_u = ReadyAlong(true, basis_u, edges, centre),
                         along_v = ReadyAlong(false, basis_v, edges, centre);
  RefinedEdgeBasis u = RefinedEdgeBasisFor(basis_u, along_u),
                   v = RefinedEdgeBasisFor(basis_v, along_v);
  EdgeRows all{std::move(u), std::move(v), std::move(along_u), {}, {}, 0, {}, {}};
  std::move(along_v.begin(), along_v.end(), std::back_inserter(all.edges));
  CloseCorners(all.edges);
  all.taken_u = Taken(all.u, all.edges, false);
  all.taken_v = Taken(all.v, all.edges, true);
  std::vector<RowsOfEdge> rows, columns;
  all.rows.reserve(8);  // rows are pointed at
  for (const ReadyEdge& edge : all.edges) {
    const bool is_row = AlongU(edge.edge);
    const auto index = static_cast<int>(&edge - all.edges.data());
    const RefinedEdgeBasis& along = is_row ? all.u : all.v;
    const RefinedEdgeBasis& across = is_row ? all.v : all.u;
    RowsOfEdge own{&edge, {}};
    all.rows.push_back(GivenRow(edge, index, across));
    own.rows.push_back(&all.rows.back());
    if (edge.across) {
      all.rows.push_back(TangentRow(edge, index, along, across, all.unknowns));
      own.rows.push_back(&all.rows.back());
      all.unknowns += all.rows.back().count;
    }
    (is_row ? rows : columns).push_back(own);
  }
  for (const RowsOfEdge& row : rows) {
    for (const RowsOfEdge& column : columns) AddCorner(all, row, column);
  }
  for (EdgeRow& row : all.rows) {
    if (row.along_u) RemoveCorners(row, all, columns);
  }
  return all;
}

}  // namespace batten::internal
