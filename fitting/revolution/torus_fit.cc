// SPDX-License-Identifier: MIT
#include "fitting/revolution/torus_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "fitting/revolution/cylindrical_chart.h"

namespace batten::internal {

Ring FitTorus(const RevolutionSamples& round, const AxisFrame& start) {
  Ring ring;
  ring.frame = start;
  SamplesAboutAxis seen = CylindricalCoordinates(round, start);
  const Eigen::Index n = seen.size();
  {  // |q|² = 2 q·c + e
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const Eigen::Vector2d middle = seen.places.rowwise().mean();
    for (const auto q : seen.places.colwise()) {
      const Eigen::Vector2d p = (q - middle) / round.size;
      const Eigen::Vector3d row(2 * p[0], 2 * p[1], 1);
      normal += row * row.transpose();
      right += row * p.squaredNorm();
    }
    normal.diagonal().array() += 1e-12 * static_cast<double>(n);
    const Eigen::Vector3d c = normal.ldlt().solve(right);
    ring.tube = round.size * std::sqrt(std::max(0.0, c[2] + c.head<2>().squaredNorm()));
    ring.radius = middle[0] + round.size * c[0];
    ring.frame.origin += ring.frame.axes.col(2) * (middle[1] + round.size * c[1]);
  }
  constexpr int kRounds = 10;
  for (int step = 0; step <= kRounds; ++step) {
    seen = CylindricalCoordinates(round, ring.frame);
    Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Zero();
    Eigen::Matrix<double, 7, 1> right = Eigen::Matrix<double, 7, 1>::Zero(), row;
    double squares = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Vector2d q = seen.places.col(i);
      const Eigen::Vector2d out = q - Eigen::Vector2d(ring.radius, 0);
      const double distance = out.norm();
      if (!(distance > 0)) continue;
      const Eigen::Vector2d normal_i = out / distance;
      const double off = distance - ring.tube;
      const double cosine = std::cos(seen.angles[i]), sine = std::sin(seen.angles[i]);
      const double lever = (q[0] * normal_i[1] - q[1] * normal_i[0]) / round.size;
      row << normal_i[0] * cosine, normal_i[0] * sine, normal_i[1], lever * sine, -lever * cosine,
          -normal_i[0], -1;
      normal += row * row.transpose();
      right -= off * row;
      squares += off * off;
    }
    ring.misfit = std::sqrt(squares / static_cast<double>(n)) / std::max(ring.radius, 1e-300);
    if (step == kRounds) break;
    normal.diagonal().array() += 1e-9 * static_cast<double>(n);
    Eigen::Matrix<double, 7, 1> move = normal.ldlt().solve(right);
    if (!move.allFinite()) break;
    const double longest = std::max({move.head<3>().norm() / round.size,
                                     move.segment<2>(3).norm() / round.size,
                                     move.tail<2>().norm() / round.size});
    constexpr double kLongest = 0.3;
    if (longest > kLongest) move *= kLongest / longest;
    ring.frame =
        ring.frame.Moved(Eigen::Vector3d(move[3], move[4], 0) / round.size, move.head<3>());
    ring.radius += move[5];
    ring.tube += move[6];
  }
  return ring;
}

}  // namespace batten::internal
