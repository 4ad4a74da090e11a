// SPDX-License-Identifier: MIT
#include "geometry/bezier/limit_series.h"

#include <algorithm>

#include "geometry/nurbs/rational_derivatives.h"

namespace batten::internal {
namespace {

template <typename Combine>
Series Combined(const Series& a, const Series& b, Combine combine) {
  Series result(std::min(a.size(), b.size()));
  for (size_t k = 0; k < result.size(); ++k) result[k] = combine(a[k], b[k]);
  return result;
}

Rounded Quotient(const Rounded& a, const Rounded& b) {
  const double value = a.value / b.value;
  return {value, (a.error + std::abs(value) * b.error) / std::abs(b.value) + RoundingOf(value)};
}

// The homogeneous points, the weight taken as exact: an error in it moves the point towards the
// origin of the piece only.
std::vector<Rounded> RoundedPoints(const Eigen::Matrix4Xd& points, const Eigen::VectorXd& errors) {
  std::vector<Rounded> result;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    for (int d = 0; d < 3; ++d) result.push_back({points(d, k), errors[k]});
    result.push_back({points(3, k), 0});
  }
  return result;
}

// Differences of order `order` of count values a stride apart, in place.
void Difference(Rounded* values, int count, int order, int stride) {
  for (int k = 0; k < order; ++k) {
    for (int i = 0; i + k + 1 < count; ++i) {
      values[i * stride] = values[(i + 1) * stride] - values[i * stride];
    }
  }
}

}  // namespace

Series operator+(const Series& a, const Series& b) {
  return Combined(a, b, [](const Rounded& x, const Rounded& y) { return x + y; });
}

Series operator-(const Series& a, const Series& b) {
  return Combined(a, b, [](const Rounded& x, const Rounded& y) { return x - y; });
}

Series operator*(const Series& a, const Series& b) {
  Series result(std::min(a.size(), b.size()));
  for (size_t k = 0; k < result.size(); ++k) {
    for (size_t i = 0; i <= k; ++i) result[k] = result[k] + a[i] * b[k - i];
  }
  return result;
}

std::optional<int> LeadingOrder(const Series& a) {
  for (size_t k = 0; k < a.size(); ++k) {
    if (a[k].significant()) return static_cast<int>(k);
  }
  return std::nullopt;
}

VectorSeries Cross(const VectorSeries& a, const VectorSeries& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Series Dot(const VectorSeries& a, const VectorSeries& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

VectorSeries Derivative(const VectorSeries& a) {
  VectorSeries result;
  for (int k = 1; k < a.size(); ++k) {
    result.x.push_back(k * a.x[k]);
    result.y.push_back(k * a.y[k]);
    result.z.push_back(k * a.z[k]);
  }
  return result;
}

std::optional<int> LeadingOrder(const VectorSeries& a) {
  for (int k = 0; k < a.size(); ++k) {
    if (a.x[k].significant() || a.y[k].significant() || a.z[k].significant()) return k;
  }
  return std::nullopt;
}

VectorSeries Shifted(const VectorSeries& a, int order) {
  return {{a.x.begin() + order, a.x.end()},
          {a.y.begin() + order, a.y.end()},
          {a.z.begin() + order, a.z.end()}};
}

// Binomial times the Bézier form of degree p − k over k-th differences; then the quotient by the
// weight, which in Taylor coefficients has no binomials.
VectorSeries TaylorSeries(const CurvePiece& piece, double t, int order, bool backward) {
  const int p = piece.degree();
  std::vector<Rounded> points = RoundedPoints(piece.points, piece.errors);
  std::vector<Series> A(4, Series(order + 1));
  for (int k = 0; k <= std::min(p, order); ++k) {
    double B[kMaxDegree + 1];
    BernsteinBasis(p - k, t, B);
    const double factor = (backward && k % 2 == 1 ? -1 : 1) * Binomial(p, k);
    for (int d = 0; d < 4; ++d) {
      for (int i = 0; i <= p - k; ++i) A[d][k] = A[d][k] + factor * B[i] * points[4 * i + d];
      Difference(points.data() + d, p + 1 - k, 1, 4);
    }
  }
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k <= order; ++k) {
      for (int i = 1; i <= k; ++i) A[d][k] = A[d][k] - A[3][i] * A[d][k - i];
      A[d][k] = Quotient(A[d][k], A[3][0]);
    }
  }
  return {A[0], A[1], A[2]};
}

SurfaceSeries::SurfaceSeries(const SurfacePiece& piece, double s, double t, int order)
    : order_(order), table_((order + 1) * (order + 1) * 4) {
  const int p = piece.p, q = piece.q;
  const auto at = [&](int k, int l, int d) -> Rounded& {
    return table_[(k * (order_ + 1) + l) * 4 + d];
  };
  const std::vector<Rounded> points = RoundedPoints(piece.points, piece.errors);
  std::vector<Rounded> rows((p + 1) * 4);
  for (int l = 0; l <= std::min(q, order); ++l) {
    double Bt[kMaxDegree + 1];
    BernsteinBasis(q - l, t, Bt);
    for (int i = 0; i <= p; ++i) {
      for (int d = 0; d < 4; ++d) {
        std::vector<Rounded> row;
        for (int j = 0; j <= q; ++j) row.push_back(points[4 * piece.Column(i, j) + d]);
        Difference(row.data(), q + 1, l, 1);
        Rounded sum;
        for (int j = 0; j <= q - l; ++j) sum = sum + Binomial(q, l) * Bt[j] * row[j];
        rows[4 * i + d] = sum;
      }
    }
    for (int k = 0; k + l <= order && k <= p; ++k) {
      double Bs[kMaxDegree + 1];
      BernsteinBasis(p - k, s, Bs);
      for (int d = 0; d < 4; ++d) {
        Rounded sum;
        for (int i = 0; i <= p - k; ++i) sum = sum + Binomial(p, k) * Bs[i] * rows[4 * i + d];
        at(k, l, d) = sum;
        Difference(rows.data() + d, p + 1 - k, 1, 4);
      }
    }
  }
  for (int k = 0; k <= order; ++k) {
    for (int l = 0; k + l <= order; ++l) {
      for (int d = 0; d < 3; ++d) {
        Rounded sum = at(k, l, d);
        for (int i = 0; i <= k; ++i) {
          for (int j = (i == 0 ? 1 : 0); j <= l; ++j) {
            sum = sum - at(i, j, 3) * at(k - i, l - j, d);
          }
        }
        at(k, l, d) = Quotient(sum, at(0, 0, 3));
      }
    }
  }
}

VectorSeries SurfaceSeries::AlongRay(int i, int j, double a, double b) const {
  std::array<Series, 3> result;
  for (int d = 0; d < 3; ++d) {
    for (int m = 0; m + i + j <= order_; ++m) {
      Rounded sum;
      for (int k = 0; k <= m; ++k) {
        const int l = m - k;
        double factor = std::pow(a, k) * std::pow(b, l);
        for (int r = 1; r <= i; ++r) factor *= k + r;
        for (int r = 1; r <= j; ++r) factor *= l + r;
        if (factor != 0) sum = sum + factor * At(k + i, l + j, d);
      }
      result[d].push_back(sum);
    }
  }
  return {result[0], result[1], result[2]};
}

}  // namespace batten::internal
