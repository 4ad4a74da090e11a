// SPDX-License-Identifier: MIT
#include "geometry/editing/composed_blossom.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace batten::internal {
namespace {

// Level r of de Boor's triangle at the argument x, r = 1 … p: row k of d, k = 0 … p − r + 1,
// becomes row k − 1 and stands for coefficient span − p + r + k − 1. [Ramshaw 1989]
Eigen::MatrixXd Level(const SplinePiece& piece, int r, double x, const Eigen::MatrixXd& d) {
  const int p = piece.degree;
  const double* U = piece.knots->data();
  Eigen::MatrixXd next(d.rows() - 1, d.cols());
  for (int k = 0; k < next.rows(); ++k) {
    const int i = piece.span - p + r + k;
    const double t = (x - U[i]) / (U[i + p - r + 1] - U[i]);
    next.row(k) = (1 - t) * d.row(k) + t * d.row(k + 1);
  }
  return next;
}

// The blossom of one group of arguments.
double GroupValue(const SplinePiece& piece,
                  const Eigen::VectorXd& coefficients,
                  const std::vector<double>& values,
                  const std::vector<int>& group) {
  Eigen::MatrixXd d = coefficients;
  int r = 0;
  for (size_t k = 0; k < group.size(); ++k) {
    for (int times = 0; times < group[k]; ++times) d = Level(piece, ++r, values[k], d);
  }
  return d(0, 0);
}

double Choose(int n, int k) {
  double result = 1;
  for (int j = 1; j <= k; ++j) result = result * (n - k + j) / j;
  return result;
}

// Calls draw(group, probability) for every group of q among the remaining arguments that holds the
// first of them; each such group is as likely as it is in a random dealing.
template <typename Draw>
void ForGroups(const std::vector<int>& remaining, int q, const Draw& draw) {
  const size_t first = static_cast<size_t>(
      std::find_if(remaining.begin(), remaining.end(), [](int c) { return c > 0; }) -
      remaining.begin());
  const int total = std::accumulate(remaining.begin(), remaining.end(), 0);
  std::vector<int> group(remaining.size(), 0);
  const auto choose = [&](const auto& self, size_t k, int left, double ways) -> void {
    if (left == 0) return draw(group, ways / Choose(total - 1, q - 1));
    if (k == remaining.size()) return;
    const int forced = k == first ? 1 : 0;
    for (int c = std::min(left, remaining[k]); c >= forced; --c) {
      group[k] = c;
      self(self, k + 1, left - c, ways * Choose(remaining[k] - forced, c - forced));
    }
    group[k] = 0;
  };
  choose(choose, first, q, 1);
}

}  // namespace

// A state is the multiset of arguments not yet dealt, with the mean of the triangles that led
// there; every level of the triangle is affine, so means can be taken before it.
Eigen::VectorXd ComposedBlossom(const SplinePiece& outer,
                                const SplinePiece& inner,
                                const Eigen::VectorXd& inner_coefficients,
                                const Multiset& arguments) {
  const int p = outer.degree, q = inner.degree;
  std::map<std::vector<int>, Eigen::MatrixXd> states;
  states[arguments.counts] = Eigen::MatrixXd::Identity(p + 1, p + 1);
  for (int r = 1; r <= p; ++r) {
    std::map<std::vector<int>, Eigen::MatrixXd> next;
    for (const auto& [remaining, triangle] : states) {
      ForGroups(remaining, q, [&](const std::vector<int>& group, double probability) {
        std::vector<int> rest = remaining;
        for (size_t k = 0; k < rest.size(); ++k) rest[k] -= group[k];
        const double x = GroupValue(inner, inner_coefficients, arguments.values, group);
        Eigen::MatrixXd& sum = next[rest];
        if (sum.size() == 0) sum = Eigen::MatrixXd::Zero(p + 1 - r, p + 1);
        sum += probability * Level(outer, r, x, triangle);
      });
    }
    states = std::move(next);
  }
  return states.begin()->second.row(0).transpose();
}

}  // namespace batten::internal
