// SPDX-License-Identifier: MIT
#include "batten/fitting/joint_cells.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "batten/fitting/fairness.h"
#include "batten/geometry/foot_point.h"

namespace batten {
namespace {

constexpr int kNormalGrid =
    4;  // the surface's side is watched at 4 × 4 places a cell, its corners included

double WatchedAt(int k) { return static_cast<double>(k) / (kNormalGrid - 1); }

// Directions along which a residual at a foot point can't be undone by moving the foot.
int FixedDirections(const SurfaceJet& jet, bool held_u, bool held_v, Eigen::Vector3d* directions) {
  const auto normal = UnitNormal(jet);
  if (!normal || (held_u && held_v)) {
    for (int d = 0; d < 3; ++d) directions[d] = Eigen::Vector3d::Unit(d);
    return 3;
  }
  directions[0] = *normal;
  if (!held_u && !held_v) return 1;
  directions[1] = normal->cross(held_u ? jet.dv : jet.du).normalized();
  return 2;
}

// Lᵀ of a semidefinite matrix, by its eigenvalues.
Eigen::MatrixXd SquareRoot(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return solver.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
         solver.eigenvectors().transpose();
}

// The thin-plate (or membrane) form of one cell, in the functions that live on it.
Eigen::MatrixXd CellFairness(const SplineBasis& bu, int span_u, const SplineBasis& bv, int span_v) {
  const int p = bu.degree(), q = bv.degree();
  struct Term {
    int order_u, order_v;
    double factor;
  };
  const std::vector<Term> terms = std::min(p, q) >= 2
                                      ? std::vector<Term>{{2, 0, 1.0}, {1, 1, 2.0}, {0, 2, 1.0}}
                                      : std::vector<Term>{{1, 0, 1.0}, {0, 1, 1.0}};
  const int nodes_u = p + 1, nodes_v = q + 1;
  const Quadrature gu(nodes_u), gv(nodes_v);
  const double a = bu.knots()[span_u], b = bu.knots()[span_u + 1];
  const double c = bv.knots()[span_v], d = bv.knots()[span_v + 1];
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero((p + 1) * (q + 1), (p + 1) * (q + 1));
  std::vector<double> Nu(3 * (p + 1)), Nv(3 * (q + 1));
  Eigen::VectorXd row((p + 1) * (q + 1));
  for (int i = 0; i < nodes_u; ++i) {
    bu.Derivatives(span_u, (a + b) / 2 + (b - a) / 2 * gu.nodes[i], 2, Nu.data());
    for (int j = 0; j < nodes_v; ++j) {
      bv.Derivatives(span_v, (c + d) / 2 + (d - c) / 2 * gv.nodes[j], 2, Nv.data());
      const double weight = gu.weights[i] * gv.weights[j] * (b - a) * (d - c) / 4;
      for (const Term& term : terms) {
        for (int r = 0; r <= p; ++r) {
          for (int s = 0; s <= q; ++s) {
            row[r * (q + 1) + s] = Nu[term.order_u * (p + 1) + r] * Nv[term.order_v * (q + 1) + s];
          }
        }
        form.selfadjointView<Eigen::Lower>().rankUpdate(row, weight * term.factor);
      }
    }
  }
  return form.selfadjointView<Eigen::Lower>();
}

}  // namespace

JointCells::JointCells(const NurbsSurface& start,
                       const Eigen::Matrix3Xd& points,
                       const Eigen::VectorXd& weights,
                       const Eigen::Matrix2Xd& parameters,
                       const JointOptions& options,
                       ThreadPool& pool)
    : basis_u_(start.basis_u()),
      basis_v_(start.basis_v()),
      net_weights_(start.weights()),
      net_(start.control_points()),
      accepted_net_(net_),
      points_(points),
      weights_(weights),
      options_(options),
      pool_(pool),
      functions_((basis_u_.degree() + 1) * (basis_v_.degree() + 1)),
      jets_(static_cast<size_t>(points.cols())),
      feet_(parameters),
      accepted_feet_(parameters) {
  double trace = 0;
  std::vector<double> R(static_cast<size_t>(functions_));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    Rational(
        basis_u_.Span(feet_(0, k)), basis_v_.Span(feet_(1, k)), feet_(0, k), feet_(1, k), R.data());
    for (const double value : R) trace += PointWeight(k) * value * value;
  }
  const double fairness_trace = FairnessForm(basis_u_, basis_v_).Trace();
  MakeCells(start, options.fairness * trace / fairness_trace);
}

void JointCells::MakeCells(const NurbsSurface& start, double fairness_weight) {
  for (const int i : basis_u_.Spans()) {
    for (const int j : basis_v_.Spans()) {
      Cell cell{i,
                j,
                SquareRoot(fairness_weight * CellFairness(basis_u_, i, basis_v_, j)),
                Eigen::MatrixXd::Zero(functions_, functions_),
                0,
                0,
                Eigen::Matrix3Xd::Zero(3, kNormalGrid * kNormalGrid)};
      const auto& U = basis_u_.knots();
      const auto& V = basis_v_.knots();
      for (int g = 0; g < kNormalGrid * kNormalGrid; ++g) {
        const double s = WatchedAt(g / kNormalGrid), t = WatchedAt(g % kNormalGrid);
        const auto normal =
            start.NormalAt(U[i] + s * (U[i + 1] - U[i]), V[j] + t * (V[j + 1] - V[j]));
        if (normal) cell.normals.col(g) = *normal;
      }
      cells_.push_back(std::move(cell));
    }
  }
}

// The rational basis functions of a cell at a parameter. [Piegl & Tiller 1997, eq. 4.12]
void JointCells::Rational(int span_u, int span_v, double u, double v, double* R) const {
  const int p = basis_u_.degree(), q = basis_v_.degree();
  double Nu[kMaxDegree + 1], Nv[kMaxDegree + 1];
  basis_u_.Values(span_u, u, Nu);
  basis_v_.Values(span_v, v, Nv);
  double sum = 0;
  for (int r = 0; r <= p; ++r) {
    const Eigen::Index row = Eigen::Index{span_u - p + r} * basis_v_.size() + span_v - q;
    for (int s = 0; s <= q; ++s) sum += R[r * (q + 1) + s] = Nu[r] * Nv[s] * net_weights_[row + s];
  }
  for (int k = 0; k < functions_; ++k) R[k] /= sum;
}

std::vector<int> JointCells::ControlPointsOf(int cell) const {
  std::vector<int> indices;
  const int p = basis_u_.degree(), q = basis_v_.degree();
  for (int r = 0; r <= p; ++r) {
    for (int s = 0; s <= q; ++s) {
      indices.push_back((cells_[cell].span_u - p + r) * basis_v_.size() + cells_[cell].span_v - q +
                        s);
    }
  }
  return indices;
}

Eigen::Matrix3Xd JointCells::Corner(const Cell& cell, const Eigen::Matrix3Xd& net) const {
  const int p = basis_u_.degree(), q = basis_v_.degree();
  Eigen::Matrix3Xd corner(3, functions_);
  for (int r = 0; r <= p; ++r) {
    corner.middleCols(r * (q + 1), q + 1) = net.middleCols(
        Eigen::Index{cell.span_u - p + r} * basis_v_.size() + cell.span_v - q, q + 1);
  }
  return corner;
}

NurbsSurface JointCells::Surface() const {
  return NurbsSurface(basis_u_, basis_v_, net_, net_weights_);
}

bool JointCells::Project() {
  if (!net_.allFinite()) return false;
  const NurbsSurface surface = Surface();
  for (const Cell& cell : cells_) {
    const auto& U = basis_u_.knots();
    const auto& V = basis_v_.knots();
    for (int g = 0; g < kNormalGrid * kNormalGrid; ++g) {
      const double s = WatchedAt(g / kNormalGrid), t = WatchedAt(g % kNormalGrid);
      const auto normal =
          surface.NormalAt(U[cell.span_u] + s * (U[cell.span_u + 1] - U[cell.span_u]),
                           V[cell.span_v] + t * (V[cell.span_v + 1] - V[cell.span_v]));
      if (cell.normals.col(g).isZero(0)) continue;
      if (!normal || !(normal->dot(cell.normals.col(g)) > 0)) return false;
    }
  }
  pool_.For(points_.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const SurfaceFoot foot =
          LocalFootPoint(surface, points_.col(k), accepted_feet_(0, k), accepted_feet_(1, k));
      feet_.col(k) << foot.u, foot.v;
      jets_[k] = surface.JetAt(foot.u, foot.v);
    }
  });
  const CellOrder sorted(basis_u_, basis_v_, feet_.row(0), feet_.row(1));
  order_ = sorted.points();
  for (Cell& cell : cells_) cell.begin = cell.end = 0;
  size_t at = 0;
  for (const CellOrder::Cell& filled : sorted.cells()) {
    while (cells_[at].span_u != filled.outer_span || cells_[at].span_v != filled.inner_span) ++at;
    cells_[at].begin = filled.begin;
    cells_[at].end = filled.end;
  }
  return true;
}

void JointCells::Accept() {
  accepted_net_ = net_;
  accepted_feet_ = feet_;
  pool_.For(cells(), 4, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    std::vector<double> R(static_cast<size_t>(functions_));
    for (std::ptrdiff_t c = first; c < last; ++c) {
      Cell& cell = cells_[c];
      Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(functions_, functions_);
      for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
        const Eigen::Index k = order_[i];
        Rational(cell.span_u, cell.span_v, feet_(0, k), feet_(1, k), R.data());
        const double distance = (jets_[k].point - points_.col(k)).norm();
        const double weight =
            PointWeight(k) * LossWeight(options_.loss, distance, options_.loss_scale);
        const Eigen::Map<const Eigen::VectorXd> row(R.data(), functions_);
        gram.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
      }
      // Gᶜ = L·Lᵀ; the pivoted factorisation takes semidefinite matrices.
      const Eigen::LDLT<Eigen::MatrixXd> factor(gram.selfadjointView<Eigen::Lower>());
      cell.proximal = factor.vectorD().cwiseMax(0).cwiseSqrt().asDiagonal() *
                      Eigen::MatrixXd(factor.matrixU()) * factor.transpositionsP();
    }
  });
}

void JointCells::Evaluate(int index, double* residual, double* jacobian) const {
  const Cell& cell = cells_[index];
  const int f = functions_, columns = 3 * f;
  Eigen::Map<Eigen::VectorXd> out(residual, rows());
  out.setZero();
  const Eigen::Matrix3Xd corner = Corner(cell, net_);
  const Eigen::MatrixXd fair = cell.fairness * corner.transpose();  // f × 3

  if (jacobian == nullptr) {
    double cost = fair.squaredNorm();
    for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
      const Eigen::Index k = order_[i];
      const double distance = (jets_[k].point - points_.col(k)).norm();
      cost += 2 * PointWeight(k) * LossValue(options_.loss, distance, options_.loss_scale);
    }
    out[0] = std::sqrt(cost);
    out[1] = std::sqrt(damping) *
             (cell.proximal * (corner - Corner(cell, accepted_net_)).transpose()).norm();
    return;
  }

  // Rows [J r] of the points and of the fairness; their triangular factor says the same in 3f+1
  // rows.
  const Eigen::Index points = cell.end - cell.begin;
  Eigen::MatrixXd stack = Eigen::MatrixXd::Zero(3 * points + 3 * f, columns + 1);
  Eigen::Index row = 0;
  double bounded = 0;  // what a loss takes off the plain squares of its reweighted rows
  std::vector<double> R(static_cast<size_t>(f));
  const double u0 = basis_u_.lower(), u1 = basis_u_.upper(), v0 = basis_v_.lower(),
               v1 = basis_v_.upper();
  for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
    const Eigen::Index k = order_[i];
    const Eigen::Vector3d difference = jets_[k].point - points_.col(k);
    const double distance = difference.norm();
    const double weight = PointWeight(k) * LossWeight(options_.loss, distance, options_.loss_scale);
    bounded += 2 * PointWeight(k) * LossValue(options_.loss, distance, options_.loss_scale);
    const double root = std::sqrt(weight);
    Eigen::Vector3d directions[3];
    const int count = FixedDirections(jets_[k],
                                      feet_(0, k) <= u0 || feet_(0, k) >= u1,
                                      feet_(1, k) <= v0 || feet_(1, k) >= v1,
                                      directions);
    Rational(cell.span_u, cell.span_v, feet_(0, k), feet_(1, k), R.data());
    for (int d = 0; d < count; ++d, ++row) {
      for (int j = 0; j < f; ++j)
        stack.row(row).segment<3>(3 * j) = root * R[j] * directions[d].transpose();
      stack(row, columns) = root * directions[d].dot(difference);
      bounded -= stack(row, columns) * stack(row, columns);
    }
  }
  for (int j = 0; j < f; ++j) {
    for (int d = 0; d < 3; ++d, ++row) {
      for (int c = 0; c < f; ++c) stack(row, 3 * c + d) = cell.fairness(j, c);
      stack(row, columns) = fair(j, d);
    }
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor> J(jacobian, rows(), columns);
  J.setZero();
  if (row > columns + 1) {
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(stack.topRows(row));
    const Eigen::MatrixXd triangle =
        qr.matrixQR().topRows(columns + 1).triangularView<Eigen::Upper>();
    J.topRows(columns + 1) = triangle.leftCols(columns);
    out.head(columns + 1) = triangle.col(columns);
  } else {
    J.topRows(row) = stack.topRows(row).leftCols(columns);
    out.head(row) = stack.col(columns).head(row);
  }
  // Where a loss bounds points, Σρ exceeds the rows' squares by what no step can change to first
  // order.
  out[columns + 1] = std::sqrt(std::max(0.0, bounded));
  const double root = std::sqrt(damping);
  for (int j = 0; j < f; ++j) {
    for (int d = 0; d < 3; ++d) {
      for (int c = 0; c < f; ++c)
        J(columns + 2 + 3 * j + d, 3 * c + d) = root * cell.proximal(j, c);
    }
  }
}

double JointCells::SquaredDistances() const {
  double sum = 0;
  for (Eigen::Index k = 0; k < points_.cols(); ++k)
    sum += (jets_[k].point - points_.col(k)).squaredNorm();
  return sum;
}

}  // namespace batten
