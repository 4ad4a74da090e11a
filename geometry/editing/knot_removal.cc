// SPDX-License-Identifier: MIT
#include "geometry/editing/knot_removal.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/editing/knot_refinement.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// Over the old knots U a control point P_i, a ≤ i ≤ b, is made of two over the knots without u:
// P_i = α_i·Q_i + (1 − α_i)·Q_{i−1}, α_i = (u − U_i)/(U_{i+p+1} − U_i); the other points are the
// same in both. Q_a … Q_{b−1} are unknown: one equation too many. λ is what is orthogonal to the
// matrix; its signs alternate and it falls off from its peak to both sides, since α_i decreases.
struct RemovalEquations {
  int a, b, peak;
  std::vector<double> alpha, beta;  // α_i and 1 − α_i, from i = a on
  std::vector<double> lambda;       // |λ_i| with λ_peak = 1

  int count() const { return b - a + 1; }
};

RemovalEquations EquationsOf(const SplineBasis& basis, int r, int multiplicity) {
  const std::vector<double>& U = basis.knots();
  const int p = basis.degree();
  RemovalEquations eq{r - p, r - multiplicity, 0, {}, {}, {}};
  for (int i = eq.a; i <= eq.b; ++i) {
    const double length = U[i + p + 1] - U[i];
    eq.alpha.push_back((U[r] - U[i]) / length);
    eq.beta.push_back((U[i + p + 1] - U[r]) / length);
  }
  const int last = eq.count() - 1;
  while (eq.peak < last && eq.alpha[eq.peak] > eq.beta[eq.peak + 1]) ++eq.peak;
  eq.lambda.assign(eq.count(), 1);
  for (int i = eq.peak; i < last; ++i)
    eq.lambda[i + 1] = eq.lambda[i] * eq.alpha[i] / eq.beta[i + 1];
  for (int i = eq.peak; i > 0; --i) eq.lambda[i - 1] = eq.lambda[i] * eq.beta[i] / eq.alpha[i - 1];
  return eq;
}

using Homogeneous = Eigen::Vector4d;  // weight times place about some origin, weight

Homogeneous About(const Eigen::Vector3d& origin, const ControlRows::Point& point) {
  Homogeneous h;
  h << point.weight * (point.place - origin), point.weight;
  return h;
}

ControlRows::Point FromAbout(const Eigen::Vector3d& origin, const Homogeneous& h, bool rational) {
  if (!rational) return {origin + h.head<3>(), 1};
  return {origin + h.head<3>() / h[3], h[3]};
}

// Q[0] = Q_{a−1} and Q[count] = Q_b are given; solves equations up to the peak from below and from
// above it downwards. Returns what is left over at the peak.
Homogeneous Solve(const RemovalEquations& eq,
                  const std::vector<Homogeneous>& P,
                  std::vector<Homogeneous>& Q) {
  for (int i = 0; i < eq.peak; ++i) Q[i + 1] = (P[i] - eq.beta[i] * Q[i]) / eq.alpha[i];
  for (int i = eq.count() - 1; i > eq.peak; --i) {
    Q[i] = (P[i] - eq.alpha[i] * Q[i + 1]) / eq.beta[i];
  }
  const int c = eq.peak;
  return P[c] - eq.alpha[c] * Q[c + 1] - eq.beta[c] * Q[c];
}

// How far a point of the shape moves, relative bound: see BezierDeviation.
double Move(const Eigen::Vector3d& shift, double weight, double new_weight, double radius) {
  return shift.norm() + std::abs(1 - weight / new_weight) * radius;
}

// The diagonal of the box of all control points.
double Diagonal(const ControlRows& rows) {
  Eigen::Vector3d sides = Eigen::Vector3d::Zero();
  for (int d = 0; d < rows.dimension(); ++d) {
    sides[d] = rows.coordinates[d].maxCoeff() - rows.coordinates[d].minCoeff();
  }
  return sides.norm();
}

// The unknown control points of one row, and the row's part of `move`; none where a weight is not
// positive. The misfit is spread in proportion to the weights with the signs of λ, which takes the
// least largest movement of the old control points.
bool SolveRow(const RemovalEquations& eq,
              std::vector<ControlRows::Point> old,  // P_{a−1} … P_{b+1}
              bool rational,
              double radius,
              std::vector<ControlRows::Point>& unknown,
              double& move) {
  const int count = eq.count();
  const Eigen::Vector3d origin = old[eq.peak + 1].place;
  std::vector<Homogeneous> P(count), Q(count + 1);
  for (int i = 0; i < count; ++i) P[i] = About(origin, old[i + 1]);
  Q.front() = About(origin, old.front());
  Q.back() = About(origin, old.back());
  const Homogeneous misfit = Solve(eq, P, Q);
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += old[i + 1].weight * eq.lambda[i];
  for (int i = 0; i < count; ++i) {
    const double sign = (i - eq.peak) % 2 == 0 ? 1 : -1;
    const Homogeneous change = sign * old[i + 1].weight / sum * misfit;
    P[i] -= change;
    if (!(P[i][3] > 0)) return false;
    // Relative to the point itself, what its weight changes does not count as shift.
    const Eigen::Vector3d shift = change.head<3>() - change[3] * (old[i + 1].place - origin);
    move = std::max(move, Move(shift / P[i][3], old[i + 1].weight, P[i][3], radius));
  }
  Solve(eq, P, Q);
  unknown.clear();
  for (int i = 1; i < count; ++i) {
    if (rational && !(Q[i][3] > 0)) return false;
    unknown.push_back(FromAbout(origin, Q[i], rational));
  }
  return true;
}

std::optional<OneKnotLess> WithoutInnerKnot(const ControlRows& rows, double u) {
  const std::vector<double>& U = rows.basis.knots();
  const auto after = std::upper_bound(U.begin(), U.end(), u);
  const int r = static_cast<int>(after - U.begin()) - 1;
  const RemovalEquations eq = EquationsOf(rows.basis, r, rows.basis.Multiplicity(u));
  std::vector<double> knots = U;
  knots.erase(knots.begin() + r);
  OneKnotLess less{EmptyRows(rows, SplineBasis(rows.basis.degree(), std::move(knots))), 0};
  const double radius = rows.rational() ? Diagonal(rows) : 0;
  std::vector<ControlRows::Point> old, unknown;
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    old.clear();
    for (int i = eq.a - 1; i <= eq.b + 1; ++i) old.push_back(rows.At(row, i));
    if (!SolveRow(eq, old, rows.rational(), radius, unknown, less.move)) return std::nullopt;
    for (int i = 0; i < less.rows.basis.size(); ++i) {
      const bool solved = i >= eq.a && i < eq.b;
      less.rows.Set(row, i, solved ? unknown[i - eq.a] : rows.At(row, i < eq.a ? i : i + 1));
    }
  }
  return less;
}

// The endless sequence of periodic knots without u and its copies. Its elements are numbered such
// that those before the last u in the domain, at r, keep their numbers.
struct ThinnedRing {
  int m;       // different functions left
  int r;       // see above
  int anchor;  // number of the element at which the domain begins
  SplineBasis basis;
};

ThinnedRing Thinned(const SplineBasis& basis, double u) {
  const int p = basis.degree(), m = basis.size() - p - 1;
  const std::vector<double>& U = basis.knots();
  const auto [low, high] = std::equal_range(U.begin(), U.end(), u);
  const int r = static_cast<int>(high - U.begin()) - 1, first = static_cast<int>(low - U.begin());
  // The seam keeps as many copies behind the beginning as before, if so many are left.
  const int anchor = u == basis.lower() ? std::max(p - 1, first) : p;
  const int reach = 2 * (p + 2) + 2 * (m + p + 2);  // old elements either side that may be needed
  const std::vector<double> endless =
      EndlessKnots(basis, -reach, static_cast<int>(U.size()) + reach);
  std::vector<double> knots;
  for (int i = anchor - p; i <= anchor + m + p; ++i) {
    const int shifted = i - (r - m);  // elements r − m … r − 1 are old ones r − m … r − 1
    const int turns = shifted >= 0 ? shifted / m : -((m - 1 - shifted) / m);
    knots.push_back(endless[reach + i - turns * m + turns * (m + 1)]);
  }
  return {m, r, anchor, SplineBasis::Periodic(p, std::move(knots))};
}

Eigen::Index Modulo(Eigen::Index i, Eigen::Index m) { return (i % m + m) % m; }

std::optional<OneKnotLess> WithoutKnotOfRing(const ControlRows& rows, double u) {
  const ThinnedRing ring = Thinned(rows.basis, u);
  const RemovalEquations eq = EquationsOf(rows.basis, ring.r, rows.basis.Multiplicity(u));
  OneKnotLess less{EmptyRows(rows, ring.basis), 0};
  const double radius = rows.rational() ? Diagonal(rows) : 0;
  const int p = rows.basis.degree(), old_m = ring.m + 1;
  std::vector<ControlRows::Point> old, unknown;
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    old.clear();
    for (int i = eq.a - 1; i <= eq.b + 1; ++i) old.push_back(rows.At(row, Modulo(i, old_m)));
    if (!SolveRow(eq, old, rows.rational(), radius, unknown, less.move)) return std::nullopt;
    for (int j = 0; j < less.rows.basis.size(); ++j) {
      // Once round from the known point in front of the unknown ones.
      const int i = eq.a - 1 + static_cast<int>(Modulo(ring.anchor - p + j - (eq.a - 1), ring.m));
      const bool solved = i >= eq.a && i < eq.b;
      less.rows.Set(
          row, j, solved ? unknown[i - eq.a] : rows.At(row, Modulo(i < eq.a ? i : i + 1, old_m)));
    }
  }
  return less;
}

// The matrix that inserts u into rows over the thin ring, by inserting it into the unit vectors:
// `to` × `from` different control points. The order of the result is that of `rows`.
Eigen::MatrixXd InsertionMatrix(const ThinnedRing& ring, const SplineBasis& old, double u) {
  const int p = old.degree(), from = ring.m, to = ring.m + 1;
  ControlRows units{ring.basis, {Eigen::MatrixXd::Zero(from, ring.basis.size())}, {}, 1};
  for (int i = 0; i < ring.basis.size(); ++i) units.coordinates[0](i % from, i) = 1;
  const double seam = u == old.upper() ? old.lower() : u;
  const ControlRows inserted = Refined(units, {&seam, 1});
  const auto behind = [p](const SplineBasis& basis) {
    const std::vector<double>& U = basis.knots();
    return std::upper_bound(U.begin(), U.end(), basis.lower()) - U.begin() - p;
  };
  const Eigen::Index shift = behind(old) - behind(inserted.basis);
  Eigen::MatrixXd matrix(to, from);
  for (int j = 0; j < to; ++j) {
    matrix.row(Modulo(j + shift, to)) = inserted.coordinates[0].col(j).transpose();
  }
  return matrix;
}

// A ring of so few knots that an insertion concerns a point more than once: least squares.
std::optional<OneKnotLess> WithoutKnotOfSmallRing(const ControlRows& rows, double u) {
  const ThinnedRing ring = Thinned(rows.basis, u);
  const Eigen::MatrixXd matrix = InsertionMatrix(ring, rows.basis, u);
  OneKnotLess less{EmptyRows(rows, ring.basis), 0};
  const double radius = rows.rational() ? Diagonal(rows) : 0;
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    const Eigen::Vector3d origin = rows.At(row, 0).place;
    Eigen::MatrixXd P(ring.m + 1, 4);
    for (int i = 0; i <= ring.m; ++i) P.row(i) = About(origin, rows.At(row, i)).transpose();
    const Eigen::MatrixXd Q = LeastSquares(matrix, P), changed = matrix * Q;
    for (int i = 0; i <= ring.m; ++i) {
      const ControlRows::Point old = rows.At(row, i);
      const double weight = rows.rational() ? changed(i, 3) : 1;
      if (!(weight > 0)) return std::nullopt;
      const Eigen::Vector3d shift =
          changed.row(i).head<3>().transpose() / weight - (old.place - origin);
      less.move = std::max(less.move, Move(shift, old.weight, weight, radius));
    }
    if (rows.rational() && !(Q.col(3).minCoeff() > 0)) return std::nullopt;
    for (int j = 0; j < ring.basis.size(); ++j) {
      less.rows.Set(row, j, FromAbout(origin, Q.row(j % ring.m).transpose(), rows.rational()));
    }
  }
  return less;
}

// Boxes of the points of each row within columns first … last, one column of the result per row:
// lower corner above upper corner.
Eigen::Matrix<double, 6, Eigen::Dynamic> RowBoxes(const ControlRows& rows,
                                                  Eigen::Index first,
                                                  Eigen::Index count) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> boxes =
      Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, rows.rows());
  for (int d = 0; d < rows.dimension(); ++d) {
    const auto piece = rows.coordinates[d].middleCols(first, count);
    boxes.row(d) = piece.rowwise().minCoeff().transpose();
    boxes.row(3 + d) = piece.rowwise().maxCoeff().transpose();
  }
  return boxes;
}

double FarthestCorner(const Eigen::Vector3d& lower,
                      const Eigen::Vector3d& upper,
                      const Eigen::Vector3d& from) {
  return (upper - from).cwiseMax(from - lower).norm();
}

}  // namespace

std::optional<OneKnotLess> WithoutKnot(const ControlRows& rows, double u) {
  if (!rows.basis.periodic()) return WithoutInnerKnot(rows, u);
  const int p = rows.basis.degree(), m = rows.basis.size() - p;
  return m > p ? WithoutKnotOfRing(rows, u) : WithoutKnotOfSmallRing(rows, u);
}

double BezierDeviation(const ControlRows& from, const ControlRows& to, int across) {
  const int p = from.basis.degree();
  const Eigen::Index m = from.rows();
  double largest = 0;
  for (Eigen::Index first = 0; first + p < from.basis.size(); first += p) {
    Eigen::Matrix<double, 6, Eigen::Dynamic> boxes;
    if (from.rational()) boxes = RowBoxes(from, first, p + 1);
    for (Eigen::Index row = 0; row < m; ++row) {
      Eigen::Vector3d lower, upper;
      if (from.rational()) {
        const Eigen::Index begin = std::max<Eigen::Index>(0, row - across);
        const Eigen::Index count = std::min(m, row + across + 1) - begin;
        lower = boxes.middleCols(begin, count).topRows<3>().rowwise().minCoeff();
        upper = boxes.middleCols(begin, count).bottomRows<3>().rowwise().maxCoeff();
      }
      for (Eigen::Index i = first; i <= first + p; ++i) {
        const ControlRows::Point a = from.At(row, i), b = to.At(row, i);
        const double radius = from.rational() ? FarthestCorner(lower, upper, a.place) : 0;
        largest = std::max(largest, Move(b.place - a.place, a.weight, b.weight, radius));
      }
    }
  }
  return largest;
}

}  // namespace batten::internal
