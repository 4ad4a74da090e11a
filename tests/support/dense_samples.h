// SPDX-License-Identifier: MIT
// Closest points by brute force: a dense sampling and a polish of its lowest places. What it finds
// lies on the surface, so a search that returns something farther has missed a minimum.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// `count` parameters or a few more: equally many in every span, knots included.
inline std::vector<double> DenseParameters(const SplineBasis& basis, int count) {
  const std::vector<int> spans = basis.Spans();
  const int per_span = std::max(4, count / static_cast<int>(spans.size()));
  std::vector<double> parameters;
  for (const int span : spans) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int k = 0; k < per_span; ++k) parameters.push_back(a + (b - a) * k / per_span);
  }
  parameters.push_back(basis.upper());
  return parameters;
}

class DenseSurface {
 public:
  DenseSurface(const NurbsSurface& surface, int count)
      : surface_(surface),
        u_(DenseParameters(surface.basis_u(), count)),
        v_(DenseParameters(surface.basis_v(), count)),
        samples_(u_.size() * v_.size(), 3) {
    Eigen::Index row = 0;
    for (const double u : u_) {
      for (const double v : v_) samples_.row(row++) = surface.At(u, v).transpose();
    }
  }

  // The least distance found: the lowest sample, and the `polished` lowest of the grid's local
  // minima followed downhill within their neighbour cells.
  double Distance(const Eigen::Vector3d& q, int polished) {
    squared_ = (samples_.col(0).array() - q[0]).square() +
               (samples_.col(1).array() - q[1]).square() +
               (samples_.col(2).array() - q[2]).square();
    const int rows = static_cast<int>(u_.size()), columns = static_cast<int>(v_.size());
    lowest_.clear();
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < columns; ++j) {
        const int k = i * columns + j;
        const double d = squared_[k];
        if ((i > 0 && squared_[k - columns] < d) || (j > 0 && squared_[k - 1] < d)) continue;
        if ((i + 1 < rows && squared_[k + columns] < d) ||
            (j + 1 < columns && squared_[k + 1] < d)) {
          continue;
        }
        lowest_.push_back(k);
      }
    }
    const auto keep = lowest_.begin() + std::min<std::ptrdiff_t>(polished, std::ssize(lowest_));
    std::partial_sort(lowest_.begin(), keep, lowest_.end(), [&](int a, int b) {
      return squared_[a] < squared_[b];
    });
    double best = std::sqrt(squared_.minCoeff());
    for (auto k = lowest_.begin(); k != keep; ++k) {
      const int i = *k / columns, j = *k % columns;
      const ParameterBox box{u_[std::max(0, i - 1)],
                             u_[std::min(rows - 1, i + 1)],
                             v_[std::max(0, j - 1)],
                             v_[std::min(columns - 1, j + 1)]};
      best = std::min(best, LocalFootPoint(surface_, q, u_[i], v_[j], box).distance);
    }
    return best;
  }

 private:
  const NurbsSurface& surface_;
  std::vector<double> u_, v_;
  Eigen::MatrixX3d samples_;
  Eigen::ArrayXd squared_;
  std::vector<int> lowest_;
};

// The least distance to a curve: the lowest of dense samples, refined by golden sections between
// the neighbours of each of the grid's local minima that could be it.
template <int Dim>
double DenseDistance(const NurbsCurve<Dim>& curve,
                     const Eigen::Matrix<double, Dim, 1>& q,
                     int count) {
  const std::vector<double> u = DenseParameters(curve.basis(), count);
  const auto distance = [&](double t) { return (curve.At(t) - q).norm(); };
  std::vector<double> d;
  for (const double t : u) d.push_back(distance(t));
  double best = *std::min_element(d.begin(), d.end());
  const double golden = (std::sqrt(5.0) - 1) / 2;
  for (size_t k = 0; k < u.size(); ++k) {
    const size_t before = k > 0 ? k - 1 : 0, after = std::min(u.size() - 1, k + 1);
    if (d[before] < d[k] || d[after] < d[k]) continue;
    double low = u[before], high = u[after];
    for (int step = 0; step < 60; ++step) {
      const double left = high - golden * (high - low), right = low + golden * (high - low);
      const double at_left = distance(left), at_right = distance(right);
      best = std::min({best, at_left, at_right});
      (at_left < at_right ? high : low) = at_left < at_right ? right : left;
    }
  }
  return best;
}

}  // namespace batten::internal
