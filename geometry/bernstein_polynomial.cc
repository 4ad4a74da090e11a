// SPDX-License-Identifier: MIT
#include "batten/geometry/bernstein_polynomial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "batten/geometry/run_time_dispatch.h"
#include "batten/geometry/spline_basis.h"

namespace batten {
namespace {

constexpr int kMost = 2 * kMaxDegree + 1;  // coefficients in one variable

constexpr int kLanes = 8;
static_assert(kLanes + 2 <= kReadPast);
typedef double Lanes __attribute__((vector_size(64), aligned(8)));

BATTEN_INLINE Lanes Load(const double* from) { return *reinterpret_cast<const Lanes*>(from); }

// The Bernstein polynomials of degree n at x with first and second derivatives, from the recursion
// B_k^n = (1−x) B_k^{n−1} + x B_{k−1}^{n−1} stopped two and one levels early.
struct Basis {
  double b0[kMost], b1[kMost], b2[kMost];

  BATTEN_INLINE Basis(int n, double x) {
    std::fill_n(b0, n + 1, 0.0);
    b0[0] = 1;
    if (n < 2) std::fill_n(b2, n + 1, 0.0);
    if (n < 1) b1[0] = 0;
    for (int level = 1; level <= n; ++level) {
      if (level == n - 1) Differences(n - 2, double(n) * (n - 1), 2, b2);
      if (level == n) Differences(n - 1, n, 1, b1);
      double last = 0;
      for (int k = 0; k < level; ++k) {
        const double next = b0[k];
        b0[k] = (1 - x) * next + x * last;
        last = next;
      }
      b0[level] = x * last;
    }
  }

 private:
  // The order-th difference of the polynomials of degree `low` now in b0, scaled.
  BATTEN_INLINE void Differences(int low, double scale, int order, double* to) const {
    std::copy_n(b0, low + 1, to);
    for (int pass = 0; pass < order; ++pass) {
      double last = 0;
      for (int k = 0; k <= low + pass; ++k) {
        const double next = to[k];
        to[k] = last - next;
        last = next;
      }
      to[low + pass + 1] = last;
    }
    for (int k = 0; k <= low + order; ++k) to[k] *= scale;
  }
};

}  // namespace

const std::vector<double>& Binomials(int n) {
  static const std::vector<std::vector<double>> rows = [] {
    std::vector<std::vector<double>> made;
    for (int m = 0; m < kMost; ++m) {
      made.emplace_back(m + 1, 1.0);
      for (int k = 1; k < m; ++k) made[m][k] = made[m - 1][k - 1] + made[m - 1][k];
    }
    return made;
  }();
  return rows[n];
}

// Rows are summed with the basis of x first; the columns of the sums are then met by that of y.
BATTEN_CLONES
PlaneJet EvaluateBernstein(const double* f, int m, int n, double x, double y) {
  const Basis in_x(m, x), in_y(n, y);
  PlaneJet jet{};
  for (int l = 0; l <= n; l += kLanes) {
    Lanes s0{}, s1{}, s2{};
    for (int k = 0; k <= m; ++k) {
      const Lanes row = Load(f + k * (n + 1) + l);
      s0 += in_x.b0[k] * row;
      s1 += in_x.b1[k] * row;
      s2 += in_x.b2[k] * row;
    }
    const int count = std::min(kLanes, n + 1 - l);
    for (int lane = 0; lane < count; ++lane) {
      const double v0 = in_y.b0[l + lane], v1 = in_y.b1[l + lane], v2 = in_y.b2[l + lane];
      jet.value += s0[lane] * v0;
      jet.gx += s1[lane] * v0;
      jet.hxx += s2[lane] * v0;
      jet.gy += s0[lane] * v1;
      jet.hxy += s1[lane] * v1;
      jet.hyy += s0[lane] * v2;
    }
  }
  return jet;
}

double LeastCoefficient(const double* f, int count) {
  double least = f[0];
  for (int k = 1; k < count; ++k) least = f[k] < least ? f[k] : least;
  return least;
}

namespace {

// Ranges of first and second differences; a range holds zero unless all differences have one sign.
struct Ranges {
  double low_x, high_x, low_y, high_y, low_xx, high_xx, low_yy, high_yy, most_xy;
};

// Eight ranges kept side by side; `put_aside` is infinite in lanes that do not count.
struct LaneRange {
  double low[kLanes], high[kLanes];
};

BATTEN_INLINE void Clear(LaneRange& range) {
  for (int k = 0; k < kLanes; ++k) {
    range.low[k] = std::numeric_limits<double>::infinity();
    range.high[k] = -std::numeric_limits<double>::infinity();
  }
}

BATTEN_INLINE void Extend(LaneRange& range, const double* x, const double* put_aside) {
  for (int k = 0; k < kLanes; ++k) {
    const double above = x[k] + put_aside[k], below = x[k] - put_aside[k];
    range.low[k] = above < range.low[k] ? above : range.low[k];
    range.high[k] = below > range.high[k] ? below : range.high[k];
  }
}

BATTEN_INLINE void Reduce(const LaneRange& range, double* low, double* high) {
  *low = range.low[0];
  *high = range.high[0];
  for (int k = 1; k < kLanes; ++k) {
    *low = range.low[k] < *low ? range.low[k] : *low;
    *high = range.high[k] > *high ? range.high[k] : *high;
  }
}

BATTEN_INLINE void PutAside(int count, double* lanes) {
  for (int k = 0; k < kLanes; ++k) {
    lanes[k] = k < count ? 0 : std::numeric_limits<double>::infinity();
  }
}

// One pass over the rows, of which each gives its differences along y and those to the next two
// rows. Lanes past the end of a row are read and put aside.
BATTEN_CLONES
void DifferenceRanges(const double* f, int m, int n, Ranges* ranges) {
  LaneRange x, y, xx, yy, xy;
  Clear(x);
  Clear(y);
  Clear(xx);
  Clear(yy);
  Clear(xy);
  const int w = n + 1;
  for (int l = 0; l <= n; l += kLanes) {
    double in0[kLanes], in1[kLanes], in2[kLanes];
    PutAside(n + 1 - l, in0);
    PutAside(n - l, in1);
    PutAside(n - 1 - l, in2);
    double a[kLanes], a1[kLanes], before[kLanes];
    for (int k = 0; k < kLanes; ++k) {
      a[k] = f[l + k];
      a1[k] = f[l + k + 1] - f[l + k];
      before[k] = 0;
    }
    for (int r = 0; r <= m; ++r) {
      const double* row = f + r * w + l;
      double d2[kLanes];
      for (int k = 0; k < kLanes; ++k) d2[k] = row[k + 2] - 2 * row[k + 1] + row[k];
      Extend(y, a1, in1);
      Extend(yy, d2, in2);
      if (r == m) break;
      double b[kLanes], b1[kLanes], step[kLanes], twist[kLanes], bend[kLanes];
      for (int k = 0; k < kLanes; ++k) {
        b[k] = row[w + k];
        b1[k] = row[w + k + 1] - row[w + k];
        step[k] = b[k] - a[k];
        twist[k] = b1[k] - a1[k];
        bend[k] = step[k] - before[k];
      }
      Extend(x, step, in0);
      Extend(xy, twist, in1);
      if (r > 0) Extend(xx, bend, in0);
      for (int k = 0; k < kLanes; ++k) {
        before[k] = step[k];
        a[k] = b[k];
        a1[k] = b1[k];
      }
    }
  }
  double low_xy, high_xy;
  Reduce(x, &ranges->low_x, &ranges->high_x);
  Reduce(y, &ranges->low_y, &ranges->high_y);
  Reduce(xx, &ranges->low_xx, &ranges->high_xx);
  Reduce(yy, &ranges->low_yy, &ranges->high_yy);
  Reduce(xy, &low_xy, &high_xy);
  ranges->most_xy = high_xy > -low_xy ? high_xy : -low_xy;
}

// A range without differences is zero.
void Settle(double& low, double& high) {
  if (low <= high) return;
  low = high = 0;
}

}  // namespace

PlaneShape ShapeOf(const double* f, int m, int n) {
  Ranges r;
  DifferenceRanges(f, m, n, &r);
  Settle(r.low_x, r.high_x);
  Settle(r.low_y, r.high_y);
  Settle(r.low_xx, r.high_xx);
  Settle(r.low_yy, r.high_yy);
  const double least_xx = r.low_xx, most_xx = r.high_xx, least_yy = r.low_yy, most_yy = r.high_yy,
               most_xy = std::max(0.0, r.most_xy);
  const double xx = double(m) * (m - 1), yy = double(n) * (n - 1), xy = double(m) * n;
  PlaneShape shape;
  shape.rises_x = r.low_x >= 0;
  shape.falls_x = r.high_x <= 0;
  shape.rises_y = r.low_y >= 0;
  shape.falls_y = r.high_y <= 0;
  // The Hessian's entries lie within the range of their coefficients; with the least diagonal and
  // the greatest off-diagonal its lowest eigenvalue can only fall.
  const double a = xx * least_xx, b = xy * most_xy, c = yy * least_yy;
  if (m == 0 || n == 0) {
    shape.lowest = m == 0 ? c : a;
  } else {
    const double mean = a / 2 + c / 2, half = a / 2 - c / 2;
    shape.lowest = mean - std::sqrt(half * half + b * b);
    // Rounding of the root must not make a singular Hessian look safe.
    if (!(a > 0 && c > 0 && a * c > b * b)) shape.lowest = std::min(shape.lowest, 0.0);
  }
  shape.bend_x = xx * std::max(std::abs(least_xx), std::abs(most_xx));
  shape.bend_y = yy * std::max(std::abs(least_yy), std::abs(most_yy));
  return shape;
}

namespace {

BATTEN_CLONES
void HalveLine(const double* f, int n, int lanes, double* lower, double* upper) {
  const int all = (n + 1) * lanes;
  if (lower != f) std::copy_n(f, all, lower);
  for (int level = 0;; ++level) {
    std::copy_n(lower + n * lanes, lanes, upper + (n - level) * lanes);
    if (level == n) break;
    for (int k = all - 1; k >= (level + 1) * lanes; --k) {
      lower[k] = 0.5 * (lower[k] + lower[k - lanes]);
    }
  }
}

}  // namespace

void HalveFirst(const double* f, int m, int n, int lanes, double* lower, double* upper) {
  HalveLine(f, m, (n + 1) * lanes, lower, upper);
}

namespace {

// De Casteljau at 1/2 as a matrix for up to eight coefficients: column j, eight numbers, holds what
// coefficient j gives to those of the lower half; the upper half is its mirror image.
struct HalfMatrix {
  double columns[kLanes][kLanes] = {};
  double mirrored[kLanes][kLanes] = {};

  explicit HalfMatrix(int n) {
    for (int l = 0; l <= n; ++l) {
      for (int j = 0; j <= l; ++j) {
        columns[j][l] = std::ldexp(Binomials(l)[j], -l);
        mirrored[n - j][n - l] = columns[j][l];
      }
    }
  }
};

const HalfMatrix& HalfMatrixOf(int n) {
  static const std::vector<HalfMatrix> matrices = [] {
    std::vector<HalfMatrix> made;
    for (int k = 0; k < kLanes; ++k) made.emplace_back(k);
    return made;
  }();
  return matrices[n];
}

BATTEN_CLONES
void HalveRows(
    const double* f, int m, int n, const HalfMatrix* half, double* lower, double* upper) {
  for (int k = 0; k <= m; ++k) {
    const double* row = f + k * (n + 1);
    Lanes low{}, high{};
    for (int j = 0; j <= n; ++j) {
      low += row[j] * Load(half->columns[j]);
      high += row[j] * Load(half->mirrored[j]);
    }
    for (int l = 0; l <= n; ++l) {
      lower[k * (n + 1) + l] = low[l];
      upper[k * (n + 1) + l] = high[l];
    }
  }
}

}  // namespace

void HalveSecond(const double* f, int m, int n, int lanes, double* lower, double* upper) {
  if (lanes == 1 && n < kLanes && f != lower) {
    HalveRows(f, m, n, &HalfMatrixOf(n), lower, upper);
    return;
  }
  const int row = (n + 1) * lanes;
  for (int k = 0; k <= m; ++k) HalveLine(f + k * row, n, lanes, lower + k * row, upper + k * row);
}

void AddProduct(const double* a, const double* b, int m, int n, double factor, double* product) {
  const std::vector<double>&in_x = Binomials(m), &in_y = Binomials(n), &of_x = Binomials(2 * m),
        &of_y = Binomials(2 * n);
  const int wide = 2 * n + 1;
  for (int k = 0; k <= 2 * m; ++k) {
    for (int l = 0; l <= 2 * n; ++l) {
      double sum = 0;
      for (int i = std::max(0, k - m); i <= std::min(k, m); ++i) {
        const double* row_a = a + i * (n + 1);
        const double* row_b = b + (k - i) * (n + 1);
        double inner = 0;
        for (int j = std::max(0, l - n); j <= std::min(l, n); ++j) {
          inner += in_y[j] * in_y[l - j] * row_a[j] * row_b[l - j];
        }
        sum += in_x[i] * in_x[k - i] * inner;
      }
      product[k * wide + l] += factor * sum / (of_x[k] * of_y[l]);
    }
  }
}

}  // namespace batten
