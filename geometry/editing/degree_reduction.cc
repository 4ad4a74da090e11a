// SPDX-License-Identifier: MIT
#include "batten/geometry/degree_reduction.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/editing/control_rows.h"
#include "geometry/editing/deviation_bound.h"
#include "geometry/editing/knot_groups.h"
#include "geometry/numeric/number_text.h"
#include "geometry/editing/polar_form.h"

namespace batten {
using namespace internal;
namespace {

using Sparse = Eigen::SparseMatrix<double>;

void CheckReduction(int degree, int by, double tolerance) {
  if (by < 0 || by >= degree) {
    throw std::invalid_argument("Reduced: by = " + std::to_string(by) +
                                " is not in [0, degree − 1 = " + std::to_string(degree - 1) + "]");
  }
  if (!(tolerance >= 0)) {
    throw std::invalid_argument("Reduced: tolerance = " + NumberText(tolerance) + " is negative");
  }
}

// One row for each mean.
Sparse MatrixOf(const std::vector<ControlMean>& means, int columns) {
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t i = 0; i < means.size(); ++i) {
    for (Eigen::Index r = 0; r < means[i].coefficients.size(); ++r) {
      const int column = means[i].first + static_cast<int>(r);
      if (means[i].coefficients[r] == 0 || column < 0 || column >= columns) continue;
      entries.emplace_back(static_cast<int>(i), column, means[i].coefficients[r]);
    }
  }
  Sparse matrix(static_cast<Eigen::Index>(means.size()), columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Of a periodic spline only the control points of one round: columns that repeat others are added
// to them, rows that repeat others left out.
Sparse OneRound(const SplineBasis& reduced, const SplineBasis& elevated, const Sparse& matrix) {
  if (!reduced.periodic()) return matrix;
  const int n = reduced.size(), columns = n - reduced.degree();
  const int rows = elevated.size() - elevated.degree();
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < n; ++j) {
    for (Sparse::InnerIterator entry(matrix, j); entry; ++entry) {
      if (entry.row() < rows) entries.emplace_back(entry.row(), j % columns, entry.value());
    }
  }
  Sparse round(rows, columns);
  round.setFromTriplets(entries.begin(), entries.end());
  return round;
}

// A reduced basis, and what elevation back to the old degree does to control points over it.
struct Elevation {
  SplineBasis reduced, elevated;
  Sparse matrix;
};

Elevation ElevationBack(const SplineBasis& basis, int by) {
  const int low = basis.degree() - by;
  KnotGroups groups = LoweredMultiplicities(GroupKnots(basis), basis.degree(), by);
  const SplineBasis reduced = BasisOfGroups(groups, low);
  SplineBasis elevated = reduced;
  Sparse matrix(reduced.size(), reduced.size());
  matrix.setIdentity();
  for (int q = low + 1; q <= basis.degree(); ++q) {
    groups = RaisedMultiplicities(std::move(groups));
    SplineBasis next = BasisOfGroups(groups, q);
    matrix = MatrixOf(ElevationMeans(elevated, next), elevated.size()) * matrix;
    elevated = std::move(next);
  }
  Sparse round = OneRound(reduced, elevated, matrix);
  return {reduced, std::move(elevated), std::move(round)};
}

// min ‖E X − B‖ over the columns of X between the first and the last fixed ones. The normal
// equations, solved again for what rounding left over: E is a product of elevations, whose
// condition is a hundred at most, so that its square leaves digits enough. [Björck 1996, §6.6.5]
class LeastSquares {
 public:
  LeastSquares(const Sparse& matrix, bool keep_first, bool keep_last)
      : matrix_(matrix), first_(keep_first ? 1 : 0), last_(keep_last ? 1 : 0) {
    const Eigen::Index free = matrix.cols() - first_ - last_;
    if (free <= 0) return;
    free_ = matrix.middleCols(first_, free);
    factor_.compute(Sparse(free_.transpose() * free_));
  }

  bool Solvable() const { return free_.cols() == 0 || factor_.info() == Eigen::Success; }

  // B has a row for each row of the matrix; the first and last rows of X are given.
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& B, Eigen::MatrixXd X) const {
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds && free_.cols() > 0; ++round) {
      const Eigen::MatrixXd rest = B - matrix_ * X;
      X.middleRows(first_, free_.cols()) += factor_.solve(free_.transpose() * rest);
    }
    return X;
  }

 private:
  Sparse matrix_, free_;
  Eigen::Index first_, last_;
  Eigen::SimplicialLLT<Sparse> factor_;
};

// Whether the first (last) control point is a point of the shape, the end of the domain.
bool BeginsAtControlPoint(const SplineBasis& basis) {
  return !basis.periodic() && basis.knots()[1] == basis.lower();
}
bool EndsAtControlPoint(const SplineBasis& basis) {
  return !basis.periodic() && basis.knots()[basis.knots().size() - 2] == basis.upper();
}

// The rows over the reduced basis whose elevated ones are nearest to `target`, one row of control
// points after the other; none where a weight is not positive.
class Reducer {
 public:
  Reducer(const Elevation& elevation, const ControlRows& target)
      : elevation_(elevation),
        target_(target),
        result_(EmptyRows(target, elevation.reduced)),
        keep_first_(BeginsAtControlPoint(elevation.reduced)),
        keep_last_(EndsAtControlPoint(elevation.reduced)) {}

  std::optional<ControlRows> Run() {
    if (!target_.rational()) {
      const LeastSquares solver(elevation_.matrix, keep_first_, keep_last_);
      if (!solver.Solvable()) return {};
      for (Eigen::Index row = 0; row < target_.rows(); ++row) ReduceRow(row, solver, {});
      return result_;
    }
    for (Eigen::Index row = 0; row < target_.rows(); ++row) {
      const Eigen::VectorXd scale = target_.weights.row(row).head(Count()).cwiseInverse();
      const LeastSquares solver(scale.asDiagonal() * elevation_.matrix, keep_first_, keep_last_);
      if (!solver.Solvable() || !ReduceRow(row, solver, scale)) return {};
    }
    return result_;
  }

 private:
  Eigen::Index Count() const { return elevation_.matrix.rows(); }

  bool ReduceRow(Eigen::Index row, const LeastSquares& solver, const Eigen::VectorXd& scale) {
    const int d = target_.dimension();
    const bool rational = target_.rational();
    const Eigen::Vector3d origin = target_.At(row, 0).place;
    Eigen::MatrixXd B(Count(), d + 1);  // (w (P − origin), w) in rows
    for (Eigen::Index i = 0; i < Count(); ++i) {
      const ControlRows::Point point = target_.At(row, i);
      B.row(i) << point.weight * (point.place - origin).head(d).transpose(), point.weight;
    }
    Eigen::MatrixXd X = Eigen::MatrixXd::Zero(elevation_.matrix.cols(), d + 1);
    if (keep_first_) X.row(0) = B.row(0);
    if (keep_last_) X.row(X.rows() - 1) = B.row(B.rows() - 1);
    if (rational) B = scale.asDiagonal() * B;
    X = solver.Solve(B, std::move(X));
    if (rational && !(X.col(d).minCoeff() > 0)) return false;
    for (Eigen::Index i = 0; i < X.rows(); ++i) {
      ControlRows::Point point{origin, rational ? X(i, d) : 1};
      point.place.head(d) += X.row(i).head(d).transpose() / point.weight;
      result_.Set(row, i, point);
    }
    // Ends that are kept are kept bit by bit.
    if (keep_first_) result_.Set(row, 0, target_.At(row, 0));
    if (keep_last_) result_.Set(row, X.rows() - 1, target_.At(row, Count() - 1));
    return true;
  }

  const Elevation& elevation_;
  const ControlRows& target_;
  ControlRows result_;
  bool keep_first_, keep_last_;
};

std::optional<ControlRows> ReducedRows(ControlRows rows, int by) {
  rows.basis = BasisOfGroups(GroupKnots(rows.basis), rows.basis.degree());
  const Elevation elevation = ElevationBack(rows.basis, by);
  const ControlRows target =
      Combined(RefinementMeans(rows.basis, elevation.elevated), rows, elevation.elevated);
  return Reducer(elevation, target).Run();
}

// The first of the candidates reduced by `by`, by − 1, … that keeps the tolerance.
template <typename Shape, typename Back>
DegreeReduction<Shape> Best(
    const Shape& shape, const ControlRows& rows, int by, double tolerance, const Back& back) {
  CheckReduction(rows.basis.degree(), by, tolerance);
  for (; by > 0; --by) {
    const std::optional<ControlRows> reduced = ReducedRows(rows, by);
    if (!reduced) continue;
    Shape candidate = back(*reduced);
    const double error = DeviationBound(candidate, shape, tolerance);
    if (error <= tolerance) return {std::move(candidate), by, error};
  }
  return {shape, 0, 0};
}

}  // namespace

template <int Dim>
DegreeReduction<NurbsCurve<Dim>> Reduced(const NurbsCurve<Dim>& curve, int by, double tolerance) {
  return Best(curve, RowsOf(curve), by, tolerance, CurveOf<Dim>);
}

template DegreeReduction<NurbsCurve<2>> Reduced(const NurbsCurve<2>&, int, double);
template DegreeReduction<NurbsCurve<3>> Reduced(const NurbsCurve<3>&, int, double);

DegreeReduction<NurbsSurface> Reduced(const NurbsSurface& surface,
                                      Direction direction,
                                      int by,
                                      double tolerance) {
  return Best(surface, RowsOf(surface, direction), by, tolerance, [&](const ControlRows& rows) {
    return SurfaceOf(rows, direction, OtherBasis(surface, direction)).WithTrims(surface.trims());
  });
}

}  // namespace batten
