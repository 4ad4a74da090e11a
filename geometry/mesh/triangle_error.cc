// SPDX-License-Identifier: MIT
#include "geometry/mesh/triangle_error.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace batten::internal {
namespace {

constexpr int Next(int e) { return e == 2 ? 0 : e + 1; }
constexpr int Last(int e) { return e == 0 ? 2 : e - 1; }

Eigen::Vector3d SecondDerivative(const SurfaceJet& jet, const Eigen::Vector2d& along) {
  return along[0] * along[0] * jet.duu + 2 * along[0] * along[1] * jet.duv +
         along[1] * along[1] * jet.dvv;
}

// The unit vector, or zero where the length is rounding against `size`.
Eigen::Vector3d Unit(const Eigen::Vector3d& vector, double size) {
  constexpr double kNothing = 1e-12;
  const double length = vector.norm();
  return length > kNothing * size ? Eigen::Vector3d(vector / length) : Eigen::Vector3d::Zero();
}

}  // namespace

TriangleError ErrorOf(const SurfaceTriangle& triangle,
                      const SurfaceEvaluator& surface,
                      double tolerance) {
  const auto& p = triangle.parameters;
  const auto& q = triangle.points;
  std::array<double, 3> lengths, bends{};
  for (int e = 0; e < 3; ++e) lengths[e] = (q[Last(e)] - q[Next(e)]).norm();
  const double longest = *std::max_element(lengths.begin(), lengths.end());
  const Eigen::Vector3d cross = (q[1] - q[0]).cross(q[2] - q[0]);
  const Eigen::Vector3d plane = Unit(cross, longest * longest);
  const bool flat = !plane.isZero();
  // A sliver is where it should be, whichever side it shows.
  constexpr double kSliver = 0.01;  // height over the tolerance
  const bool sliver = cross.norm() <= kSliver * tolerance * longest;
  double distance = 0;
  bool turned = false;

  constexpr double kNear = 2.0 / 3, kFar = 1.0 / 6, kMiddle = 1.0 / 3;
  constexpr double kShares[4][3] = {
      {kMiddle, kMiddle, kMiddle}, {kNear, kFar, kFar}, {kFar, kNear, kFar}, {kFar, kFar, kNear}};
  for (const auto& share : kShares) {
    const Eigen::Vector2d at = share[0] * p[0] + share[1] * p[1] + share[2] * p[2];
    const SurfaceJet jet = surface.JetAt(at[0], at[1]);
    const Eigen::Vector3d normal = Unit(jet.du.cross(jet.dv), jet.du.norm() * jet.dv.norm());
    if (flat && !normal.isZero() && normal.dot(plane) < 0.5) turned = true;
    const Eigen::Vector3d across = flat ? plane : normal;
    const Eigen::Vector3d off =
        jet.point - q[0] - share[1] * (q[1] - q[0]) - share[2] * (q[2] - q[0]);
    distance = std::max(distance, std::abs(across.dot(off)));
    double sum = 0;
    for (int e = 0; e < 3; ++e) {
      const Eigen::Vector3d second = SecondDerivative(jet, p[Last(e)] - p[Next(e)]);
      const double bend = std::abs(normal.dot(second)) / 8;
      sum += bend;
      bends[e] = std::max(bends[e], bend);
      if (!triangle.lines[e] || lengths[e] == 0) continue;
      const Eigen::Vector3d line = (q[Last(e)] - q[Next(e)]) / lengths[e];
      bends[e] = std::max(bends[e], (second - line.dot(second) * line).norm() / 8);
    }
    distance = std::max(distance, sum * 8 / 18);  // at the middle: the mean of the edges' e²/6
  }
  // Folds are looked for near the corners too.
  for (int e = 0; e < 3 && flat && !turned && longest > tolerance; ++e) {
    constexpr double kOff = 1.0 / 32;
    const Eigen::Vector2d at = p[e] + kOff * (p[Next(e)] + p[Last(e)] - 2 * p[e]);
    const SurfaceJet jet = surface.JetAt(at[0], at[1]);
    const Eigen::Vector3d normal = Unit(jet.du.cross(jet.dv), jet.du.norm() * jet.dv.norm());
    if (!normal.isZero() && normal.dot(plane) < 0.5) turned = true;
  }
  for (int e = 0; e < 3; ++e) {
    const Eigen::Vector2d along = p[Last(e)] - p[Next(e)];
    const Eigen::Vector3d line = Unit(q[Last(e)] - q[Next(e)], 0);
    for (const double share : {0.5, 0.25, 0.75}) {
      const Eigen::Vector2d at = p[Next(e)] + share * along;
      const Eigen::Vector3d off = surface.At(at[0], at[1]) - q[Next(e)];
      distance = std::max(distance, std::abs(plane.dot(off)));
      if (!triangle.lines[e]) break;
      const double aside = (off - line.dot(off) * line).norm();
      bends[e] = std::max(bends[e], aside);
    }
    distance = std::max(distance, bends[e]);
  }
  turned = turned && longest > tolerance && !sliver;
  if (turned) distance = std::max(distance, longest);

  TriangleError error{distance, {0, 1, 2}};
  // Of edges that bend alike the fixed one: what is across then need not be halved any more.
  constexpr double kPreferred = 1.25;
  for (int e = 0; e < 3; ++e) bends[e] *= triangle.lines[e] ? kPreferred : 1;
  // Where no edge bends much the longest is the one to halve.
  const double greatest = *std::max_element(bends.begin(), bends.end());
  const auto& measure = turned || greatest < distance / 4 ? lengths : bends;
  std::stable_sort(error.worst.begin(), error.worst.end(), [&](int a, int b) {
    return measure[a] > measure[b];
  });
  return error;
}

std::array<int, 3> EdgesAt(const SurfaceTriangle& triangle,
                           const SurfaceEvaluator& surface,
                           const Eigen::Vector2d& place,
                           double tolerance) {
  const auto& p = triangle.parameters;
  const SurfaceJet jet = surface.JetAt(place[0], place[1]);
  const Eigen::Vector3d normal = Unit(jet.du.cross(jet.dv), jet.du.norm() * jet.dv.norm());
  std::array<double, 3> lengths, bends;
  for (int e = 0; e < 3; ++e) {
    lengths[e] = (triangle.points[Last(e)] - triangle.points[Next(e)]).norm();
    bends[e] = std::abs(normal.dot(SecondDerivative(jet, p[Last(e)] - p[Next(e)]))) / 8;
  }
  const auto& measure =
      *std::max_element(bends.begin(), bends.end()) < tolerance / 4 ? lengths : bends;
  std::array<int, 3> edges{0, 1, 2};
  std::stable_sort(
      edges.begin(), edges.end(), [&](int a, int b) { return measure[a] > measure[b]; });
  return edges;
}

}  // namespace batten::internal
