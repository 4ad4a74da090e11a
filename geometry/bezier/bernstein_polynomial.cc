// SPDX-License-Identifier: MIT
#include "geometry/bezier/bernstein_polynomial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/numeric/run_time_dispatch.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {
namespace {

constexpr int kMost = 2 * kMaxDegree + 1;  // coefficients in one variable

constexpr int kLanes = 8;
static_assert(kLanes + 2 <= kReadPast);
typedef double Lanes __attribute__((vector_size(64), aligned(8)));

BATTEN_INLINE double SumOf(const Lanes& a) {
  return ((a[0] + a[1]) + (a[2] + a[3])) + ((a[4] + a[5]) + (a[6] + a[7]));
}

BATTEN_INLINE Lanes Load(const double* from) { return *reinterpret_cast<const Lanes*>(from); }

// The Bernstein polynomials C(n,k) x^k (1−x)^{n−k} at x with first and second derivatives, which
// are differences of those of one and two degrees less. Zero past n up to whole lanes.
struct Basis {
  static constexpr int kRoom = kMost + kLanes;
  double b0[kRoom], b1[kRoom], b2[kRoom];

  BATTEN_INLINE Basis(
      int n, double x, const double* choose0, const double* choose1, const double* choose2) {
    double up[kMost], down[kMost];  // x^k and (1−x)^k
    up[0] = down[0] = 1;
    for (int k = 1; k <= n; ++k) {
      up[k] = up[k - 1] * x;
      down[k] = down[k - 1] * (1 - x);
    }
    const int end = n / kLanes * kLanes + kLanes;
    for (int k = 0; k < end; ++k) b0[k] = b1[k] = b2[k] = 0;
    for (int k = 0; k <= n; ++k) b0[k] = choose0[k] * up[k] * down[n - k];
    for (int k = 0; k < n; ++k) {
      const double lower = n * choose1[k] * up[k] * down[n - 1 - k];
      b1[k] -= lower;
      b1[k + 1] += lower;
    }
    for (int k = 0; k + 1 < n; ++k) {
      const double lower = n * (n - 1) * choose2[k] * up[k] * down[n - 2 - k];
      b2[k] += lower;
      b2[k + 1] -= 2 * lower;
      b2[k + 2] += lower;
    }
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

namespace {

// Rows of binomial coefficients of a degree and the two below it.
struct Choices {
  const double *of, *below, *two_below;

  explicit Choices(int n)
      : of(Binomials(n).data()),
        below(Binomials(std::max(0, n - 1)).data()),
        two_below(Binomials(std::max(0, n - 2)).data()) {}
};

// Rows are summed with the basis of x first; the columns of the sums are then met by that of y.
BATTEN_CLONES
PolynomialJet Evaluate(const double* f,
                       int m,
                       int n,
                       double x,
                       double y,
                       const Choices& choose_x,
                       const Choices& choose_y) {
  const Basis in_x(m, x, choose_x.of, choose_x.below, choose_x.two_below);
  const Basis in_y(n, y, choose_y.of, choose_y.below, choose_y.two_below);
  PolynomialJet jet{};
  for (int l = 0; l <= n; l += kLanes) {
    Lanes s0{}, s1{}, s2{};
    for (int k = 0; k <= m; ++k) {
      const Lanes row = Load(f + k * (n + 1) + l);
      s0 += in_x.b0[k] * row;
      s1 += in_x.b1[k] * row;
      s2 += in_x.b2[k] * row;
    }
    const Lanes v0 = Load(in_y.b0 + l), v1 = Load(in_y.b1 + l), v2 = Load(in_y.b2 + l);
    jet.value += SumOf(s0 * v0);
    jet.gx += SumOf(s1 * v0);
    jet.hxx += SumOf(s2 * v0);
    jet.gy += SumOf(s0 * v1);
    jet.hxy += SumOf(s1 * v1);
    jet.hyy += SumOf(s0 * v2);
  }
  return jet;
}

}  // namespace

PolynomialJet EvaluateBernstein(const double* f, int m, int n, double x, double y) {
  return Evaluate(f, m, n, x, y, Choices(m), Choices(n));
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
  Lanes low, high;
};

BATTEN_INLINE LaneRange Empty() {
  const Lanes far = Lanes{} + std::numeric_limits<double>::infinity();
  return {far, -far};
}

BATTEN_INLINE void Extend(LaneRange& range, const Lanes& x, const Lanes& put_aside) {
  const Lanes above = x + put_aside, below = x - put_aside;
  range.low = above < range.low ? above : range.low;
  range.high = below > range.high ? below : range.high;
}

BATTEN_INLINE void Reduce(const LaneRange& range, double* low, double* high) {
  double lows[kLanes], highs[kLanes];
  for (int k = 0; k < kLanes; ++k) {
    lows[k] = range.low[k];
    highs[k] = range.high[k];
  }
  for (int half = kLanes / 2; half > 0; half /= 2) {
    for (int k = 0; k < half; ++k) {
      lows[k] = lows[k + half] < lows[k] ? lows[k + half] : lows[k];
      highs[k] = highs[k + half] > highs[k] ? highs[k + half] : highs[k];
    }
  }
  *low = lows[0];
  *high = highs[0];
}

// Zero in the first `count` lanes, infinite in the others.
BATTEN_INLINE Lanes PutAside(int count) {
  constexpr double kOut = std::numeric_limits<double>::infinity();
  static constexpr double kSteps[2 * kLanes] = {
      0, 0, 0, 0, 0, 0, 0, 0, kOut, kOut, kOut, kOut, kOut, kOut, kOut, kOut};
  return Load(kSteps + kLanes - (count < 0 ? 0 : count > kLanes ? kLanes : count));
}

// One pass over the rows, of which each gives its differences along y and those to the next two
// rows. Lanes past the end of a row are read and put aside.
BATTEN_CLONES
void DifferenceRanges(const double* f, int m, int n, Ranges* ranges) {
  LaneRange x = Empty(), y = Empty(), xx = Empty(), yy = Empty(), xy = Empty();
  const int w = n + 1;
  for (int l = 0; l <= n; l += kLanes) {
    const Lanes in0 = PutAside(n + 1 - l), in1 = PutAside(n - l), in2 = PutAside(n - 1 - l);
    Lanes a = Load(f + l), a1 = Load(f + l + 1) - a, before{};
    for (int r = 0; r <= m; ++r) {
      const double* row = f + r * w + l;
      Extend(y, a1, in1);
      Extend(yy, Load(row + 2) - Load(row + 1) - a1, in2);
      if (r == m) break;
      const Lanes b = Load(row + w), b1 = Load(row + w + 1) - b, step = b - a;
      Extend(x, step, in0);
      Extend(xy, b1 - a1, in1);
      if (r > 0) Extend(xx, step - before, in0);
      before = step;
      a = b;
      a1 = b1;
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

PolynomialBounds BoundsOf(const double* f, int m, int n) {
  Ranges r;
  DifferenceRanges(f, m, n, &r);
  Settle(r.low_x, r.high_x);
  Settle(r.low_y, r.high_y);
  Settle(r.low_xx, r.high_xx);
  Settle(r.low_yy, r.high_yy);
  const double least_xx = r.low_xx, most_xx = r.high_xx, least_yy = r.low_yy, most_yy = r.high_yy,
               most_xy = std::max(0.0, r.most_xy);
  const double xx = double(m) * (m - 1), yy = double(n) * (n - 1), xy = double(m) * n;
  PolynomialBounds bounds;
  bounds.rises_x = r.low_x >= 0;
  bounds.falls_x = r.high_x <= 0;
  bounds.rises_y = r.low_y >= 0;
  bounds.falls_y = r.high_y <= 0;
  // The Hessian's entries lie within the range of their coefficients; with the least diagonal and
  // the greatest off-diagonal its lowest eigenvalue can only fall.
  const double a = xx * least_xx, b = xy * most_xy, c = yy * least_yy;
  if (m == 0 || n == 0) {
    bounds.lowest = m == 0 ? c : a;
  } else {
    const double mean = a / 2 + c / 2, half = a / 2 - c / 2;
    bounds.lowest = mean - std::sqrt(half * half + b * b);
    // Rounding of the root must not make a singular Hessian look safe.
    if (!(a > 0 && c > 0 && a * c > b * b)) bounds.lowest = std::min(bounds.lowest, 0.0);
  }
  bounds.bend_x = xx * std::max(std::abs(least_xx), std::abs(most_xx));
  bounds.bend_y = yy * std::max(std::abs(least_yy), std::abs(most_yy));
  return bounds;
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

}  // namespace batten::internal
