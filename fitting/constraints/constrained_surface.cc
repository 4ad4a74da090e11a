// SPDX-License-Identifier: MIT
#include "fitting/constraints/constrained_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "fitting/constraints/edge_energy.h"
#include "fitting/constraints/edge_rows.h"
#include "fitting/constraints/edge_values.h"
#include "fitting/constraints/linear_constraints.h"
#include "fitting/constraints/reduced_edge_basis.h"
#include "fitting/core/rounding.h"
#include "fitting/least_squares/penalised_system.h"
#include "fitting/linear/bordered_system.h"
#include "fitting/linear/independent_rows.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/polygon.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

constexpr double kMissedAngle = 1e-6;
constexpr double kMissedAlong = 1e-4;  // along an edge: what thinning may leave, and some

// The part of a vector across a unit direction.
Eigen::Vector3d Across(const Eigen::Vector3d& vector, const Eigen::Vector3d& direction) {
  return vector - direction.dot(vector) * direction;
}

// The conditions on a surface over given bases, and the equations they become for some data.
struct ConstrainedSystem {
  ConstrainedSystem(const SplineBasis& basis_u,
                    const SplineBasis& basis_v,
                    const SurfaceConstraints& constraints,
                    const Eigen::Vector3d& middle)
      : centre(middle),
        points(constraints.points),
        edges(EdgeRowsOf(basis_u, basis_v, constraints.edges, middle)),
        conditions(ConditionsOf(edges, points, middle)),
        columns(conditions.Columns()),
        rows(conditions.Rows(columns)),
        independent(rows, conditions.scales) {}

  // What points ask of the edges' unknowns.
  struct Data {
    std::array<Eigen::MatrixXd, 3> border;  // solver's rows × t
    Eigen::MatrixXd corner;
    Eigen::VectorXd right;
  };

  bool Taken(int i, int j) const {
    return edges.taken_u[static_cast<size_t>(i)] || edges.taken_v[static_cast<size_t>(j)];
  }

  // The data less the centre and what is given of the surface there.
  Eigen::MatrixXd ValuesLess(const FittingProblem& problem) const {
    const FittingData& data = problem.data();
    Eigen::MatrixXd values = data.values.colwise() - centre;
    for (Eigen::Index k = 0; k < values.cols() && !edges.rows.empty(); ++k) {
      AxisValues u(edges.u, data.parameters(0, k), 0), v(edges.v, data.parameters(1, k), 0);
      VisitEdges(edges, u, v, [&](int unknown, int d, double value) {
        if (unknown < 0) values(d, k) -= value;
      });
    }
    return values;
  }

  Data Gathered(const FittingProblem& problem,
                const PenalisedSystem& system,
                const Eigen::MatrixXd& values) const {
    const int unknowns = edges.unknowns;
    Data gathered;
    gathered.corner = Eigen::MatrixXd::Zero(unknowns, unknowns);
    gathered.right = Eigen::VectorXd::Zero(unknowns);
    gathered.border.fill(Eigen::MatrixXd::Zero(system.unknowns(), unknowns));
    if (unknowns == 0) return gathered;
    const FittingData& data = problem.data();
    std::array<Eigen::VectorXd, 3> acting;
    acting.fill(Eigen::VectorXd::Zero(unknowns));
    std::vector<int> touched;
    std::vector<char> known(static_cast<size_t>(unknowns), 0);
    const int size_v = edges.v.coarse.size();
    for (Eigen::Index k = 0; k < data.parameters.cols(); ++k) {
      const double weight = data.weights.size() > 0 ? data.weights[k] : 1.0;
      if (weight == 0) continue;
      AxisValues u(edges.u, data.parameters(0, k), 0), v(edges.v, data.parameters(1, k), 0);
      VisitEdges(edges, u, v, [&](int unknown, int d, double value) {
        if (unknown < 0) return;
        acting[d][unknown] += value;
        if (!std::exchange(known[static_cast<size_t>(unknown)], 1)) touched.push_back(unknown);
      });
      if (touched.empty()) continue;
      for (int d = 0; d < 3; ++d) {
        for (const int a : touched) {
          const double value = weight * acting[d][a];
          gathered.right[a] += value * values(d, k);
          for (const int b : touched) gathered.corner(a, b) += value * acting[d][b];
          for (int i = u.first(); i <= u.first() + edges.u.coarse.degree(); ++i) {
            for (int j = v.first(); j <= v.first() + edges.v.coarse.degree(); ++j) {
              if (Taken(i, j)) continue;
              gathered.border[d](system.RowOf(Eigen::Index{i} * size_v + j), a) +=
                  value * u.Coarse(i) * v.Coarse(j);
            }
          }
        }
      }
      for (const int a : touched) {
        for (auto& coordinate : acting) coordinate[a] = 0;
        known[static_cast<size_t>(a)] = 0;
      }
      touched.clear();
    }
    return gathered;
  }

  std::vector<Eigen::Index> PinnedRows(const PenalisedSystem& system) const {
    std::vector<Eigen::Index> pinned;
    for (int i = 0; i < edges.u.coarse.size(); ++i) {
      for (int j = 0; j < edges.v.coarse.size(); ++j) {
        if (Taken(i, j))
          pinned.push_back(system.RowOf(Eigen::Index{i} * edges.v.coarse.size() + j));
      }
    }
    return pinned;
  }

  // The equations at one smoothing.
  BorderedSystem Assembled(const Data& data,
                           const PenalisedSystem& system,
                           const EdgeEnergy& energy,
                           double lambda) const {
    const int unknowns = edges.unknowns;
    BorderedSystem bordered;
    bordered.right = system.rhs();
    bordered.border = data.border;
    for (int i = 0; i < edges.u.coarse.size(); ++i) {
      for (int j = 0; j < edges.v.coarse.size(); ++j) {
        if (Taken(i, j)) continue;
        const Eigen::Index c = Eigen::Index{i} * edges.v.coarse.size() + j, row = system.RowOf(c);
        for (int d = 0; d < 3; ++d) {
          bordered.border[d].row(row) += lambda * energy.inner[d].row(c).head(unknowns);
          bordered.right(row, d) -= lambda * energy.inner[d](c, unknowns);
        }
      }
    }
    for (const Eigen::Index row : PinnedRows(system)) bordered.right.row(row).setZero();
    bordered.corner = data.corner + lambda * energy.edges.topLeftCorner(unknowns, unknowns);
    bordered.corner_right = data.right - lambda * energy.edges.col(unknowns).head(unknowns);
    const std::vector<Eigen::Index>& kept = independent.kept();
    bordered.functionals = Eigen::MatrixXd::Zero(system.unknowns(), conditions.functionals.cols());
    for (int f = 0; f < conditions.functionals.cols(); ++f) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(conditions.functionals, f); it; ++it) {
        bordered.functionals(system.RowOf(it.row()), f) += it.value();
      }
    }
    const auto count = static_cast<Eigen::Index>(kept.size());
    bordered.directions.resize(3, count);
    bordered.condition_rows.resize(count, unknowns);
    bordered.condition_right.resize(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Index from = kept[static_cast<size_t>(k)];
      bordered.functional.push_back(conditions.functional[static_cast<size_t>(from)]);
      bordered.directions.col(k) = conditions.directions.col(from);
      bordered.condition_rows.row(k) = conditions.unknowns.row(from);
      bordered.condition_right[k] = conditions.right[from];
    }
    return bordered;
  }

  Eigen::VectorXd LeftSides(const BorderedSolution& solution, const PenalisedSystem& system) const {
    const auto width = static_cast<Eigen::Index>(columns.size());
    Eigen::VectorXd all(3 * width + edges.unknowns);
    for (Eigen::Index c = 0; c < width; ++c) {
      const Eigen::Index row = system.RowOf(columns[static_cast<size_t>(c)]);
      for (int d = 0; d < 3; ++d) all[d * width + c] = solution.inner(row, d);
    }
    all.tail(edges.unknowns) = solution.border;
    return rows * all;
  }

  // Takes away what rounding left of the conditions that are kept, by the smallest step.
  void Meet(BorderedSolution& solution, const PenalisedSystem& system) const {
    const std::vector<Eigen::Index>& kept = independent.kept();
    if (kept.empty()) return;
    const auto width = static_cast<Eigen::Index>(columns.size());
    for (int pass = 0; pass < 2; ++pass) {
      const Eigen::VectorXd missing = conditions.right - LeftSides(solution, system);
      const Eigen::VectorXd step = independent.LeastSolution(missing(kept));
      for (Eigen::Index c = 0; c < width; ++c) {
        const Eigen::Index row = system.RowOf(columns[static_cast<size_t>(c)]);
        for (int d = 0; d < 3; ++d) solution.inner(row, d) += step[d * width + c];
      }
      solution.border += step.tail(edges.unknowns);
    }
  }

  Eigen::Vector3d centre;
  std::vector<FixedPoint> points;
  EdgeRows edges;
  LinearConstraints conditions;
  std::vector<Eigen::Index> columns;  // coarse control points in conditions
  Eigen::MatrixXd rows;               // the conditions by these, and t
  IndependentRows independent;
};

NurbsSurface SurfaceOf(const ConstrainedSystem& constrained,
                       const BorderedSolution& solution,
                       const PenalisedSystem& system) {
  const EdgeRows& edges = constrained.edges;
  const int size_u = edges.u.coarse.size(), size_v = edges.v.coarse.size();
  const ReducedEdgeBasis u = Thinned(edges, true, solution.border),
                         v = Thinned(edges, false, solution.border);
  Eigen::Matrix3Xd net(3, Eigen::Index{u.basis.size()} * v.basis.size());
  for (int d = 0; d < 3; ++d) {
    Eigen::MatrixXd coarse = Eigen::MatrixXd::Zero(size_u, size_v);
    for (int i = 0; i < size_u; ++i) {
      for (int j = 0; j < size_v; ++j) {
        if (!constrained.Taken(i, j))
          coarse(i, j) = solution.inner(system.RowOf(Eigen::Index{i} * size_v + j), d);
      }
    }
    Eigen::MatrixXd fine = (u.raised * coarse) * v.raised.transpose();
    for (const EdgeRow& row : edges.rows) {
      Eigen::VectorXd amounts(row.count + 1);
      amounts << solution.border.segment(row.first, row.count), 1;
      const Eigen::VectorXd curve =
          (row.along_u ? u : v).thinned * Eigen::VectorXd(row.curves[d] * amounts);
      const Eigen::VectorXd profile = (row.along_u ? v : u).raised.col(row.profile);
      if (row.along_u) {
        fine += curve * profile.transpose();
      } else {
        fine += profile * curve.transpose();
      }
    }
    net.row(d) = fine.transpose().reshaped().transpose().array() + constrained.centre[d];
  }
  // Edges by their own control points: rounding of the sums moves none of them.
  const Eigen::Index last_u = u.basis.size() - 1, last_v = v.basis.size() - 1;
  for (const ReadyEdge& edge : edges.edges) {
    const bool along_u = edge.edge.direction == Direction::kV;
    const Eigen::Matrix3Xd ends =
        RefineKnots(edge.plain, MissingKnots(edge.plain.basis(), (along_u ? u : v).basis))
            .control_points()
            .colwise() +
        constrained.centre;
    for (Eigen::Index k = 0; k < ends.cols(); ++k) {
      const Eigen::Index i = along_u ? k : (edge.edge.upper ? last_u : 0);
      const Eigen::Index j = along_u ? (edge.edge.upper ? last_v : 0) : k;
      net.col(i * (last_v + 1) + j) = ends.col(k);
    }
  }
  return NurbsSurface(u.basis, v.basis, std::move(net));
}

// Adds the edges along which the tangent planes asked for are missed.
void AddMissedPlanes(const EdgeRows& edges,
                     const NurbsSurface& surface,
                     std::vector<MissedConstraint>& missed) {
  for (const ReadyEdge& edge : edges.edges) {
    if (!edge.across) continue;
    const bool along_u = edge.edge.direction == Direction::kV;
    const SplineBasis& along = along_u ? edges.u.fine : edges.v.fine;
    const SplineBasis& across = along_u ? edges.v.fine : edges.u.fine;
    const double side = edge.edge.upper ? across.upper() : across.lower();
    MissedConstraint worst{"", 0, true};
    for (const int span : along.Spans()) {
      for (int k = 0; k <= 4; ++k) {
        const double a = along.knots()[span], b = along.knots()[span + 1], s = a + (b - a) * k / 4;
        const SurfaceJet jet = along_u ? surface.JetAt(s, side) : surface.JetAt(side, s);
        const Eigen::Vector3d direction = edge.curve.Derivatives(s, 1).col(1).normalized();
        const double angle = AngleBetween(Across(along_u ? jet.dv : jet.du, direction),
                                          Across(edge.across->At(s), direction));
        if (angle > worst.amount)
          worst = {"the tangent plane along " + edge.name + " at " + NumberText(s), angle, true};
      }
    }
    if (worst.amount > kMissedAlong) missed.push_back(worst);
  }
}

std::vector<MissedConstraint> MissedBy(const ConstrainedSystem& constrained,
                                       const NurbsSurface& surface,
                                       const BorderedSolution& solution,
                                       const PenalisedSystem& system,
                                       double size) {
  using Kind = ConditionBlock::Kind;
  std::vector<MissedConstraint> missed;
  const LinearConstraints& conditions = constrained.conditions;
  const Eigen::VectorXd misses = constrained.LeftSides(solution, system) - conditions.right;
  for (const ConditionBlock& block : conditions.blocks) {
    const Eigen::VectorXd miss = misses.segment(block.first, block.count);
    MissedConstraint result{block.name, miss.norm(), false};
    if (block.kind == Kind::kCornerPlane) {
      result = {block.name, std::atan2(miss.norm(), block.length), true};
    } else if (block.kind == Kind::kNormal) {
      const FixedPoint& point = constrained.points[static_cast<size_t>(block.from)];
      const SurfaceJet jet = surface.JetAt(point.u, point.v);
      const Eigen::Vector3d asked = point.normal->normalized(), normal = jet.du.cross(jet.dv);
      result = {
          block.name, std::min(AngleBetween(normal, asked), AngleBetween(-normal, asked)), true};
    }
    if (result.amount > (result.angle ? kMissedAngle : kRelativelyEqual * size))
      missed.push_back(std::move(result));
  }
  AddMissedPlanes(constrained.edges, surface, missed);
  return missed;
}

}  // namespace

std::string MissedConstraint::Text() const {
  return condition + " contradicts the other constraints: missed by " +
         (angle ? RoundedText(amount * 180 / std::numbers::pi) + " degrees" : RoundedText(amount));
}

ConstrainedSolution SolveConstrained(const FittingProblem& problem,
                                     const SurfaceConstraints& constraints,
                                     ThreadPool& pool) {
  if (problem.is_curve() || problem.data().values.rows() != 3)
    Reject("SolveConstrained", "the data must be points in space over two parameters");
  if (problem.poles().any() || problem.basis_u().periodic() || problem.basis_v().periodic())
    Reject("SolveConstrained", "a surface that closes or has a pole takes no constraints");
  const Eigen::Vector3d centre = problem.size() > 0
                                     ? Eigen::Vector3d(problem.data().values.rowwise().mean())
                                     : Eigen::Vector3d(Eigen::Vector3d::Zero());
  const ConstrainedSystem constrained(problem.basis_u(), problem.basis_v(), constraints, centre);
  const Eigen::Matrix2Xd& parameters = problem.data().parameters;
  const Eigen::MatrixXd values = constrained.ValuesLess(problem);
  const PenalisedSystem system(problem.basis_u(),
                               &problem.basis_v(),
                               parameters.row(0),
                               parameters.row(1),
                               values,
                               problem.data().weights,
                               problem.energy(),
                               pool);
  const ConstrainedSystem::Data data = constrained.Gathered(problem, system, values);
  const EdgeEnergy energy = EnergyOf(constrained.edges, problem.energy());
  const std::vector<Eigen::Index> pinned = constrained.PinnedRows(system);
  double smoothing = problem.smoothing();
  for (int attempt = 0; attempt <= PenalisedSystem::kAttempts; ++attempt) {
    BlockBandedMatrix matrix = system.Matrix(smoothing, PenalisedSystem::JittersOf(attempt));
    matrix.Pin(pinned, matrix.Trace() / matrix.size());
    if (matrix.Factor() && system.Determines(smoothing, matrix.SmallestPivot())) {
      BorderedSolution solution =
          Solve(constrained.Assembled(data, system, energy, system.Lambda(smoothing)), matrix);
      constrained.Meet(solution, system);
      if (solution.inner.allFinite() && solution.border.allFinite()) {
        NurbsSurface surface = SurfaceOf(constrained, solution, system);
        std::vector<MissedConstraint> missed =
            MissedBy(constrained, surface, solution, system, BoxDiagonal(surface.control_points()));
        return {std::move(surface), std::move(missed)};
      }
    }
    smoothing = PenalisedSystem::Raised(smoothing);
  }
  Reject("SolveConstrained",
         "the points do not determine the control points: too few carry weight, or the degree is "
         "too high for them");
}

}  // namespace batten::internal
