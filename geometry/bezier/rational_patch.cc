// SPDX-License-Identifier: MIT
#include "geometry/bezier/rational_patch.h"

#include <algorithm>
#include <queue>

#include "geometry/bezier/bernstein.h"
#include "geometry/nurbs/rational_derivatives.h"

namespace batten::internal {
namespace {

constexpr int kMostHalvings = 20000;
constexpr double kTight = 1.01;

// C(m,i) C(n,k−i) / C(m+n,k), the weights of f_i g_{k−i} in the product of f and g.
Eigen::MatrixXd ProductWeights(int m, int n) {
  Eigen::MatrixXd weights(m + 1, n + 1);
  for (int i = 0; i <= m; ++i) {
    for (int j = 0; j <= n; ++j) {
      weights(i, j) = Binomial(m, i) * Binomial(n, j) / Binomial(m + n, i + j);
    }
  }
  return weights;
}

RationalPatch Raised(const RationalPatch& patch, int p, int q) {
  const int r = p - patch.p, s = q - patch.q;
  if (r == 0 && s == 0) return patch;
  const Eigen::RowVectorXd one = Eigen::RowVectorXd::Ones((r + 1) * (s + 1));
  return {p, q, PatchProduct(patch.columns, patch.p, patch.q, one, r, s)};
}

bool Polynomial(const RationalPatch& patch) {
  return (patch.columns.bottomRows<1>().array() == 1).all();
}

// Distances of control points from the origin.
Eigen::RowVectorXd Lengths(const Eigen::MatrixXd& columns) {
  const Eigen::Index d = columns.rows() - 1;
  return columns.topRows(d).colwise().norm().array() / columns.row(d).array();
}

double FarthestCorner(const RationalPatch& patch) {
  double farthest = 0;
  for (const int i : {0, patch.p}) {
    for (const int j : {0, patch.q}) {
      farthest = std::max(farthest, Lengths(patch.columns.col(i * (patch.q + 1) + j))[0]);
    }
  }
  return farthest;
}

// Across the direction in which the control points bend more: halving leaves a quarter of that.
Direction ToHalve(const RationalPatch& patch) {
  const Eigen::Index d = patch.columns.rows() - 1;
  const Eigen::MatrixXd points =
      patch.columns.topRows(d).array().rowwise() / patch.columns.row(d).array();
  double along_u = 0, along_v = 0;
  const int stride = patch.q + 1;
  for (int i = 0; i <= patch.p; ++i) {
    for (int j = 0; j <= patch.q; ++j) {
      const int k = i * stride + j;
      const auto bend = [&](int step) {
        return (points.col(k) - 2 * points.col(k - step) + points.col(k - 2 * step)).norm();
      };
      if (i > 1) along_u = std::max(along_u, bend(stride) * patch.p * (patch.p - 1));
      if (j > 1) along_v = std::max(along_v, bend(1) * patch.q * (patch.q - 1));
    }
  }
  if (along_u == along_v) return patch.p >= patch.q ? Direction::kU : Direction::kV;
  return along_u > along_v ? Direction::kU : Direction::kV;
}

struct Bounded {
  double bound;
  RationalPatch patch;
  bool operator<(const Bounded& other) const { return bound < other.bound; }
};

}  // namespace

std::pair<RationalPatch, RationalPatch> Halved(const RationalPatch& patch, Direction direction) {
  RationalPatch first = patch, second = patch;
  const int p = patch.p, q = patch.q, stride = q + 1;
  if (direction == Direction::kU) {
    for (int i = 0; i <= p; ++i) {
      first.columns.middleCols(i * stride, stride) = second.columns.leftCols(stride);
      for (int k = 0; k < p - i; ++k) {
        second.columns.middleCols(k * stride, stride) =
            (second.columns.middleCols(k * stride, stride) +
             second.columns.middleCols((k + 1) * stride, stride)) /
            2;
      }
    }
  } else {
    for (int i = 0; i <= p; ++i) {
      for (int j = 0; j <= q; ++j) {
        first.columns.col(i * stride + j) = second.columns.col(i * stride);
        for (int k = i * stride; k < i * stride + q - j; ++k) {
          second.columns.col(k) = (second.columns.col(k) + second.columns.col(k + 1)) / 2;
        }
      }
    }
  }
  return {std::move(first), std::move(second)};
}

Eigen::MatrixXd PatchProduct(
    const Eigen::MatrixXd& f, int m, int n, const Eigen::RowVectorXd& g, int r, int s) {
  const Eigen::MatrixXd along_u = ProductWeights(m, r), along_v = ProductWeights(n, s);
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(f.rows(), (m + r + 1) * (n + s + 1));
  for (int i = 0; i <= m; ++i) {
    for (int k = 0; k <= r; ++k) {
      for (int j = 0; j <= n; ++j) {
        for (int l = 0; l <= s; ++l) {
          const double c = along_u(i, k) * along_v(j, l) * g[k * (s + 1) + l];
          h.col((i + k) * (n + s + 1) + j + l) += c * f.col(i * (n + 1) + j);
        }
      }
    }
  }
  return h;
}

RationalPatch Difference(const RationalPatch& a, const RationalPatch& b) {
  const Eigen::Index d = a.columns.rows() - 1;
  if (Polynomial(a) && Polynomial(b)) {
    RationalPatch result = Raised(a, std::max(a.p, b.p), std::max(a.q, b.q));
    result.columns.topRows(d) -= Raised(b, result.p, result.q).columns.topRows(d);
    result.columns.row(d).setOnes();
    return result;
  }
  RationalPatch result{
      a.p + b.p, a.q + b.q, PatchProduct(a.columns, a.p, a.q, b.columns.row(d), b.p, b.q)};
  result.columns.topRows(d) -=
      PatchProduct(b.columns.topRows(d), b.p, b.q, a.columns.row(d), a.p, a.q);
  return result;
}

double FarthestBound(std::vector<RationalPatch> patches, double negligible, double enough) {
  double reached = 0;
  std::priority_queue<Bounded> queue;
  const auto push = [&](RationalPatch patch) {
    reached = std::max(reached, FarthestCorner(patch));
    const double bound = Lengths(patch.columns).maxCoeff();
    queue.push({bound, std::move(patch)});
  };
  for (RationalPatch& patch : patches) push(std::move(patch));
  for (int halvings = 0; halvings < kMostHalvings; ++halvings) {
    const double bound = queue.top().bound;
    if (bound <= kTight * reached || bound <= negligible || reached > enough) return bound;
    auto [first, second] = Halved(queue.top().patch, ToHalve(queue.top().patch));
    queue.pop();
    push(std::move(first));
    push(std::move(second));
  }
  return queue.top().bound;
}

}  // namespace batten::internal
