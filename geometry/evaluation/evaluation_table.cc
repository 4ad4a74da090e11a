// SPDX-License-Identifier: MIT
#include "geometry/evaluation/evaluation_table.h"
#include "geometry/numeric/constants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace batten::internal {
namespace {

// Row r: the coefficients of one function on the span.
using LocalFunctions = std::array<std::array<long double, kMaxDegree + 1>, kMaxDegree + 1>;
using Values = std::array<long double, kMaxDegree + 1>;

// The functions of one degree on a span as Bernstein forms without binomials, Σ c_j t^j o^(d−j):
// the recursion of Cox and de Boor on coefficients instead of values. A function of degree d − 1
// over [low, high] goes times (high − u)/(high − low) to one of degree d and times (u − low)/(high
// − low) to the next; a factor with the values x, y at the ends of the span maps c_j to x·c_j and
// to y·c_j one place on. All numbers are positive: no digits are lost. The functions of degree
// p − k go to by_order[k], one less than whose size is the largest k. [Piegl & Tiller 1997,
// eq. 2.5]
void FindBernsteinFunctions(const SplineBasis& basis,
                            int span,
                            std::vector<LocalFunctions>& by_order) {
  const double* U = basis.knots().data() + span;
  const auto from = [&](int end, int knot) -> long double {
    return std::abs(static_cast<long double>(U[end]) - U[knot]);
  };
  const int p = basis.degree();
  LocalFunctions f;
  for (int r = 0; r <= p; ++r) std::fill_n(f[r].begin(), p + 1, 0.0L);
  f[0][0] = 1;
  for (int d = 0; d <= p; ++d) {
    for (int r = d; d > 0 && r >= 0; --r) {
      Values sum{};
      if (r < d) {
        const long double width = from(r + 1, 1 - d + r);
        for (int j = 0; j < d; ++j) {
          sum[j] += f[r][j] * (from(0, r + 1) / width);
          sum[j + 1] += f[r][j] * (from(1, r + 1) / width);
        }
      }
      if (r > 0) {
        const long double width = from(r, r - d);
        for (int j = 0; j < d; ++j) {
          sum[j] += f[r - 1][j] * (from(0, r - d) / width);
          sum[j + 1] += f[r - 1][j] * (from(1, r - d) / width);
        }
      }
      std::copy_n(sum.begin(), d + 1, f[r].begin());
    }
    if (p - d < static_cast<int>(by_order.size())) by_order[p - d] = f;
  }
}

// From functions of degree p − k, or coefficients of them, to the k-th derivatives of those of
// degree p: each is a difference of two of one degree less. [A2.3, eq. 2.9]
void Raise(const SplineBasis& basis, int span, int k, Values& f) {
  const double* U = basis.knots().data() + span;
  const int p = basis.degree();
  for (int d = p - k + 1; d <= p; ++d) {
    long double previous = 0;
    for (int r = 0; r < d; ++r) {
      const long double width = static_cast<long double>(U[r + 1]) - U[1 - d + r];
      const long double term = f[r] / width;
      f[r] = d * (previous - term);
      previous = term;
    }
    f[d] = d * previous;
  }
}

// Row d: the values of the functions of degree d = 0 … p in the middle of the span. [A2.2]
LocalFunctions MiddleValues(const SplineBasis& basis, int span) {
  const double* U = basis.knots().data() + span;
  const auto middle_from = [&](int knot) -> long double {
    const long double zero = U[knot];
    return std::abs((U[0] - zero) + (U[1] - zero)) / 2;
  };
  LocalFunctions N;
  N[0][0] = 1;
  for (int d = 1; d <= basis.degree(); ++d) {
    long double saved = 0;
    for (int r = 0; r < d; ++r) {
      const long double term = N[d - 1][r] / (static_cast<long double>(U[r + 1]) - U[1 - d + r]);
      N[d][r] = saved + middle_from(r + 1) * term;
      saved = middle_from(1 - d + r) * term;
    }
    N[d][d] = saved;
  }
  return N;
}

template <typename Points>
auto CentreOf(const Points& points) {
  return (points.rowwise().minCoeff() / 2 + points.rowwise().maxCoeff() / 2).eval();
}

// Control points less the centre as homogeneous columns. Weights are divided by a power of two that
// brings the largest near one; without weights all are one.
template <typename Shape, typename Centre>
void FillHomogeneous(const Shape& shape, const Centre& centre, Eigen::Map<Eigen::Matrix4Xd> net) {
  constexpr int kDim = Centre::RowsAtCompileTime;
  net.setZero();
  net.template topRows<kDim>() = shape.control_points().colwise() - centre;
  if (!shape.rational()) {
    net.row(3).setOnes();
    return;
  }
  net.row(3) = shape.weights() * std::exp2(-std::ilogb(shape.weights().maxCoeff()));
  for (int d = 0; d < kDim; ++d) net.row(d).array() *= net.row(3).array();
}

// Of homogeneous control points, one below the other.
template <typename Block>
double LeastWeight(const Block& block) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index j = 0; j < block.cols(); ++j) {
    for (Eigen::Index i = 3; i < block.rows(); i += 4) least = std::min(least, block(i, j));
  }
  return least;
}

}  // namespace

AxisStorage::AxisStorage(const SplineBasis& basis, int order) {
  const int p = basis.degree();
  const std::vector<int> spans = basis.Spans();
  for (int span : spans) {
    const double start = basis.knots()[span], end = basis.knots()[span + 1];
    spans_.push_back({start, end, 1 / (end - start)});
    first_point_.push_back(span - p);
  }
  spans_.push_back({kInfinity, kInfinity, 0});
  table_.lower = basis.lower();
  table_.upper = basis.upper();
  table_.degree = p;
  table_.order = order;
  table_.span_count = static_cast<int>(spans.size());
  table_.row_stride = (p + 4) / 4 * 4;
  for (int k = 0; k <= std::min(order, p); ++k) {
    table_.span_stride += (p + 1 - k) * table_.row_stride;
  }
  basis_ = AlignedDoubles(static_cast<size_t>(table_.span_stride) * spans.size());
  double* row = basis_.data();
  std::vector<LocalFunctions> functions(std::min(order, p) + 1);
  for (int span : spans) {
    FindBernsteinFunctions(basis, span, functions);
    for (int k = 0; k <= std::min(order, p); ++k) {
      const LocalFunctions& f = functions[k];
      for (int j = 0; j <= p - k; ++j, row += table_.row_stride) {
        Values column;
        for (int r = 0; r <= p - k; ++r) column[r] = f[r][j];
        Raise(basis, span, k, column);
        for (int r = 0; r <= p; ++r) row[r] = static_cast<double>(column[r]);
      }
    }
  }
  FillCells();
  table_.cell_spans = cell_spans_.data();
  table_.spans = spans_.data();
  table_.first_point = first_point_.data();
  table_.basis = basis_.data();
  table_.outside = &basis;
}

// Spans are entered by the cell their start falls into, found by the arithmetic of the search
// itself, which is monotone: a parameter of a later cell lies behind every start of an earlier one.
void AxisStorage::FillCells() {
  constexpr int kCellsASpan = 4;
  table_.cell_count = kCellsASpan * table_.span_count;
  table_.cells_per_unit = table_.cell_count / (table_.upper - table_.lower);
  if (!std::isfinite(table_.cells_per_unit)) {
    table_.cell_count = 1;
    table_.cells_per_unit = 0;
  }
  cell_spans_.assign(table_.cell_count, 0);
  int cell = 0;
  for (int span = 0; span < table_.span_count; ++span) {
    const double place = (spans_[span].start - table_.lower) * table_.cells_per_unit;
    while (cell < table_.cell_count && cell <= place) cell_spans_[cell++] = std::max(0, span - 1);
  }
  while (cell < table_.cell_count) cell_spans_[cell++] = table_.span_count - 1;
}

// By Taylor's formula about the middle, so that coefficients that are small because the span is
// short against its neighbours keep their digits.
Eigen::MatrixXd MonomialBasis(const SplineBasis& basis, int span) {
  const int p = basis.degree();
  const long double half =
      (static_cast<long double>(basis.knots()[span + 1]) - basis.knots()[span]) / 2;
  const LocalFunctions middle = MiddleValues(basis, span);
  Eigen::MatrixXd coefficients(p + 1, p + 1);
  long double factor = 1;  // half^k / k!
  for (int k = 0; k <= p; ++k) {
    Values column = middle[p - k];
    Raise(basis, span, k, column);
    for (int r = 0; r <= p; ++r) coefficients(r, k) = static_cast<double>(factor * column[r]);
    factor *= half / (k + 1);
  }
  return coefficients;
}

SurfaceStorage::SurfaceStorage(const NurbsSurface& surface)
    : u_(surface.basis_u(), 2), v_(surface.basis_v(), 2) {
  table_.u = u_.table();
  table_.v = v_.table();
  table_.rational = surface.rational();
  FillNet(surface);
  FillPatches(surface);
}

void SurfaceStorage::FillNet(const NurbsSurface& surface) {
  const Eigen::Vector3d centre = CentreOf(surface.control_points());
  const Eigen::Index count = surface.control_points().cols();
  net_ = AlignedDoubles(4 * static_cast<size_t>(count));
  FillHomogeneous(surface, centre, Eigen::Map<Eigen::Matrix4Xd>(net_.data(), 4, count));
  table_.extent = (surface.control_points().colwise() - centre).cwiseAbs().maxCoeff();
  table_.v_points = surface.size_v();
  table_.net = net_.data();
  Eigen::Map<Eigen::Vector4d>(table_.centre) << centre, 0;
}

double SurfaceStorage::FillPatch(const Eigen::MatrixXd& rows,
                                 const Eigen::MatrixXd& Mv,
                                 int first,
                                 double least_weight,
                                 double* patch) const {
  const int p = table_.u.degree, q = table_.v.degree;
  Eigen::Vector4d sums = Eigen::Vector4d::Zero();
  for (int r = 0; r <= p; ++r) {
    for (int s = 0; s <= q; ++s) {
      Eigen::Map<Eigen::Vector4d> c(patch + 4 * (s * (p + 1) + r));
      c.setZero();
      for (int k = 0; k <= q; ++k) {
        c += Mv(k, s) * rows.col(r).segment<4>(Eigen::Index{4} * (first + k));
      }
      if (!table_.rational) c[3] = r == 0 && s == 0;
      sums += c.cwiseAbs();
    }
  }
  const double extent = table_.extent > 0 ? table_.extent : 1;
  return (sums.head<3>().maxCoeff() / extent + sums[3]) / least_weight;
}

void SurfaceStorage::FillPatches(const NurbsSurface& surface) {
  constexpr size_t kMostDoubles = size_t{32} << 17;  // 32 MB
  // Errors of points were measured at up to 1e-16 of the extent times the growth (random nets,
  // degrees 1 to 14, weights in [1e-2, 1e2]): 2.6e-14 here, a quarter of what is promised.
  constexpr double kMostGrowth = 256;
  const int p = table_.u.degree, q = table_.v.degree, m = surface.size_v();
  const std::vector<int> spans_u = surface.basis_u().Spans(), spans_v = surface.basis_v().Spans();
  const size_t stride = 4 * static_cast<size_t>((p + 1) * (q + 1));
  if (spans_u.size() * spans_v.size() > kMostDoubles / stride) return;
  AlignedDoubles patches(stride * spans_u.size() * spans_v.size());
  const Eigen::Map<const Eigen::MatrixXd> net(net_.data(), Eigen::Index{4} * m, surface.size_u());
  std::vector<Eigen::MatrixXd> Mv;
  for (int span : spans_v) Mv.push_back(MonomialBasis(surface.basis_v(), span));
  double* patch = patches.data();
  for (int u : spans_u) {
    const auto block = net.middleCols(u - p, p + 1);
    const Eigen::MatrixXd rows = block * MonomialBasis(surface.basis_u(), u);
    for (size_t j = 0; j < spans_v.size(); ++j, patch += stride) {
      const int first = spans_v[j] - q;
      const double least = LeastWeight(block.middleRows(Eigen::Index{4} * first, 4 * (q + 1)));
      if (!(FillPatch(rows, Mv[j], first, least, patch) <= kMostGrowth)) return;
    }
  }
  patches_ = std::move(patches);
  table_.patch_stride = stride;
  table_.patches = patches_.data();
}

template <int Dim>
CurveStorage<Dim>::CurveStorage(const NurbsCurve<Dim>& curve) : axis_(curve.basis(), 3) {
  const AxisTable& axis = axis_.table();
  const Eigen::Matrix<double, Dim, 1> centre = CentreOf(curve.control_points());
  Eigen::Matrix4Xd net(4, curve.control_points().cols());
  FillHomogeneous(curve, centre, Eigen::Map<Eigen::Matrix4Xd>(net.data(), 4, net.cols()));
  const size_t rows = static_cast<size_t>(axis.span_stride / axis.row_stride);
  table_.axis = axis;
  table_.rational = curve.rational();
  table_.dimension = Dim;
  table_.piece_stride = 4 * rows;
  pieces_ = AlignedDoubles(table_.piece_stride * static_cast<size_t>(axis.span_count));
  double* to = pieces_.data();
  const double* row = axis.basis;
  for (int span = 0; span < axis.span_count; ++span) {
    for (size_t j = 0; j < rows; ++j, to += 4, row += axis.row_stride) {
      Eigen::Map<Eigen::Vector4d> h(to);
      h.setZero();
      for (int r = 0; r <= axis.degree; ++r) h += row[r] * net.col(axis.first_point[span] + r);
    }
  }
  table_.pieces = pieces_.data();
  std::copy_n(centre.data(), Dim, table_.centre);
}

template class CurveStorage<2>;
template class CurveStorage<3>;

}  // namespace batten::internal
