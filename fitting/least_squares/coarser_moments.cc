// SPDX-License-Identifier: MIT
#include "fitting/least_squares/coarser_moments.h"

#include <algorithm>
#include <vector>

#include "geometry/evaluation/evaluation_table.h"

namespace batten::internal {
namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstForms = Eigen::Map<const Rows>;
using Forms = Eigen::Map<Rows>;

// A part [a, b] of a span [A, B]: with t, o the places in the span and t', o' those in the part,
// t = α o' + (1 − β) t' and o = (1 − α) o' + β t'.
struct Part {
  int span;
  Rows squares, values;  // t^k o^(m−k) = Σ_l row k, column l · t'^l o'^(m−l), m = 2p and p
};

Rows FormsOfPart(int degree, double alpha, double beta) {
  Rows forms = Rows::Zero(degree + 1, degree + 1);
  std::vector<double> polynomial(static_cast<std::size_t>(degree) + 1);
  for (int k = 0; k <= degree; ++k) {
    std::fill(polynomial.begin(), polynomial.end(), 0.0);
    polynomial[0] = 1;
    for (int factor = 0; factor < degree; ++factor) {
      const double of_o = factor < k ? alpha : 1 - alpha, of_t = factor < k ? 1 - beta : beta;
      for (int l = factor + 1; l > 0; --l)
        polynomial[l] = polynomial[l] * of_o + polynomial[l - 1] * of_t;
      polynomial[0] *= of_o;
    }
    for (int l = 0; l <= degree; ++l) forms(k, l) = polynomial[l];
  }
  return forms;
}

std::vector<Part> PartsOf(const SplineBasis& fine, const SplineBasis& coarse) {
  const std::vector<int> spans = coarse.Spans();
  std::vector<Part> parts;
  std::size_t at = 0;
  for (const int span : fine.Spans()) {
    const double a = fine.knots()[span], b = fine.knots()[span + 1];
    while (coarse.knots()[spans[at] + 1] <= a) ++at;
    const double low = coarse.knots()[spans[at]], high = coarse.knots()[spans[at] + 1];
    const double alpha = (a - low) / (high - low), beta = (high - b) / (high - low);
    parts.push_back({static_cast<int>(at),
                     FormsOfPart(2 * fine.degree(), alpha, beta),
                     FormsOfPart(fine.degree(), alpha, beta)});
  }
  return parts;
}

// The functions of each span as forms: entry (j, r) of t^j o^(p−j) in function r.
std::vector<Rows> FunctionForms(const SplineBasis& basis) {
  const AxisStorage axis(basis, 0);
  const AxisTable& table = axis.table();
  const int p = basis.degree();
  std::vector<Rows> forms(static_cast<std::size_t>(table.span_count), Rows(p + 1, p + 1));
  for (int span = 0; span < table.span_count; ++span) {
    const double* from = table.basis + std::ptrdiff_t{span} * table.span_stride;
    for (int j = 0; j <= p; ++j) {
      for (int r = 0; r <= p; ++r) forms[span](j, r) = from[j * table.row_stride + r];
    }
  }
  return forms;
}

// Σ of the products of a form with itself, times the moments of its squares.
double SquareOf(const Rows& form, const ConstForms& moments) {
  const auto p = static_cast<int>(form.rows()) - 1, q = static_cast<int>(form.cols()) - 1;
  double sum = 0;
  for (int i = 0; i <= p; ++i) {
    for (int k = 0; k <= p; ++k) {
      for (int j = 0; j <= q; ++j) {
        for (int l = 0; l <= q; ++l) sum += form(i, j) * form(k, l) * moments(i + k, j + l);
      }
    }
  }
  return sum;
}

// Σ w of a cell: t + o = 1, so that the moments by binomials give one.
double WeightOf(const ConstForms& moments) {
  double sum = 0, outer = 1;
  const auto p = static_cast<int>(moments.rows()) - 1, q = static_cast<int>(moments.cols()) - 1;
  for (int k = 0; k <= p; outer = outer * (p - k) / (k + 1), ++k) {
    double inner = 1;
    for (int l = 0; l <= q; inner = inner * (q - l) / (l + 1), ++l)
      sum += outer * inner * moments(k, l);
  }
  return sum;
}

}  // namespace

CellMoments CoarserMoments(const CellMoments& fine,
                           const SplineBasis& fine_outer,
                           const SplineBasis& fine_inner,
                           const SplineBasis& outer,
                           const SplineBasis& inner,
                           ThreadPool& pool) {
  const MomentSizes& sizes = fine.sizes();
  const int p = sizes.p, q = sizes.q;
  const std::vector<Part> outer_parts = PartsOf(fine_outer, outer),
                          inner_parts = PartsOf(fine_inner, inner);
  CellMoments coarse(
      sizes, static_cast<int>(outer.Spans().size()), static_cast<int>(inner.Spans().size()));
  std::vector<int> begins(static_cast<std::size_t>(coarse.outer_spans()) + 1, fine.outer_spans());
  for (int k = fine.outer_spans() - 1; k >= 0; --k) begins[outer_parts[k].span] = k;
  pool.For(coarse.outer_spans(), 1, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (int o = begins[first]; o < begins[last]; ++o) {
      const Part& in_outer = outer_parts[o];
      for (int i = 0; i < fine.inner_spans(); ++i) {
        const Part& in_inner = inner_parts[i];
        const double* from = fine.at(o, i);
        double* to = coarse.at(in_outer.span, in_inner.span);
        Forms(to, 2 * p + 1, 2 * q + 1).noalias() += in_outer.squares *
                                                     ConstForms(from, 2 * p + 1, 2 * q + 1) *
                                                     in_inner.squares.transpose();
        for (int d = 0; d < sizes.dimension; ++d) {
          const int at = sizes.squares() + d * (p + 1) * (q + 1);
          Forms(to + at, p + 1, q + 1).noalias() +=
              in_outer.values * ConstForms(from + at, p + 1, q + 1) * in_inner.values.transpose();
        }
        to[sizes.all() - 1] += from[sizes.all() - 1];
      }
    }
  });
  return coarse;
}

CellErrors ErrorsOfCells(const CellMoments& moments,
                         const SplineBasis& outer,
                         const SplineBasis& inner,
                         const Eigen::MatrixXd& net,
                         ThreadPool& pool) {
  const MomentSizes& sizes = moments.sizes();
  const int p = sizes.p, q = sizes.q;
  const std::vector<Rows> outer_forms = FunctionForms(outer), inner_forms = FunctionForms(inner);
  const std::vector<int> outer_spans = outer.Spans(), inner_spans = inner.Spans();
  CellErrors errors{Eigen::ArrayXXd::Zero(moments.outer_spans(), moments.inner_spans()),
                    Eigen::ArrayXXd::Zero(moments.outer_spans(), moments.inner_spans())};
  pool.For(moments.outer_spans(), 1, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (std::ptrdiff_t o = first; o < last; ++o) {
      for (int i = 0; i < moments.inner_spans(); ++i) {
        const double* cell = moments.at(static_cast<int>(o), i);
        const ConstForms squares(cell, 2 * p + 1, 2 * q + 1);
        errors.weights(o, i) = WeightOf(squares);
        double sum = cell[sizes.all() - 1];
        for (int d = 0; d < sizes.dimension; ++d) {
          const double* column =
              net.col(d).data() + std::ptrdiff_t{outer_spans[o] - p} * inner.size();
          const Eigen::Map<const Rows, 0, Eigen::OuterStride<>> part(
              column + inner_spans[i] - q, p + 1, q + 1, Eigen::OuterStride<>(inner.size()));
          const Rows form = outer_forms[o] * part * inner_forms[i].transpose();
          const ConstForms values(cell + sizes.squares() + d * (p + 1) * (q + 1), p + 1, q + 1);
          sum += SquareOf(form, squares) - 2 * form.cwiseProduct(values).sum();
        }
        errors.squares(o, i) = std::max(0.0, sum);
      }
    }
  });
  return errors;
}

}  // namespace batten::internal
