// SPDX-License-Identifier: MIT
#include "fitting/wings/wing_edge.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "fitting/wings/density_end.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr double kWindowInSpacings = 5;  // h, of the search for the end
constexpr double kWedgeTo = 0.12;        // of the chord: the wedge at the edge ends here
constexpr Eigen::Index kFewestInWedge = 60;
constexpr int kEdgeSamples = 41;

}  // namespace

bool MoveEdge(const WingPlaces& at, double spacing, double noise, WingFrame& frame) {
  std::vector<Eigen::Index> near;
  const double window = std::max(kWindowInSpacings * spacing, kEndWindowInNoises * noise);
  for (Eigen::Index k = 0; k < std::ssize(at.places); ++k)
    if (at.At(k).v >= 0 && at.At(k).v <= 1 && (1 - at.At(k).along) * frame.chord < 3 * window)
      near.push_back(k);
  const auto count = std::ssize(near);
  EndingPoints ending{Eigen::MatrixXd(count, 4), Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const WingPlace& place = at.At(near[static_cast<size_t>(i)]);
    const double t = 2 * place.v - 1;
    ending.along.row(i) << 1, t, t * t, t * t * t;
    ending.reach[i] = (place.along - 1) * frame.ChordAt(place.v);
    ending.place[i] = place.v;
  }
  const std::optional<Eigen::VectorXd> end = EndOfPoints(ending, noise, window);
  if (!end) return false;
  // Heights over the chord: a line along the edge, and slopes of both sides before it.
  std::vector<Eigen::Index> wedge;
  for (Eigen::Index i = 0; i < count; ++i)
    if (ending.reach[i] > ending.along.row(i).dot(*end) - window) wedge.push_back(i);
  if (std::ssize(wedge) < kFewestInWedge) return false;
  Eigen::MatrixXd rows(std::ssize(wedge), 6);
  Eigen::VectorXd heights(std::ssize(wedge));
  for (Eigen::Index r = 0; r < rows.rows(); ++r) {
    const Eigen::Index i = wedge[static_cast<size_t>(r)], k = near[static_cast<size_t>(i)];
    const double before = ending.along.row(i).dot(*end) - ending.reach[i];
    rows.row(r) << ending.along.row(i), before, before * at.SideOf(k);
    heights[r] = at.At(k).above * frame.ChordAt(at.At(k).v);
  }
  const Eigen::VectorXd lines = LeastSquares(rows, heights);
  Eigen::VectorXd v(kEdgeSamples);
  Eigen::Matrix3Xd moved(3, kEdgeSamples);
  for (int s = 0; s < kEdgeSamples; ++s) {
    v[s] = s / (kEdgeSamples - 1.0);
    const double t = 2 * v[s] - 1;
    const Eigen::Vector4d powers(1, t, t * t, t * t * t);
    const Eigen::Matrix3d axes = frame.AxesAt(v[s]);
    moved.col(s) = frame.edge.At(v[s]) + axes.col(0) * powers.dot(*end) +
                   axes.col(1) * powers.dot(lines.head<4>());
  }
  frame.edge = WingLine(v, moved);
  return true;
}

EdgeWedge WedgeAtEdge(const WingPlaces& at, const WingFrame& frame, double noise) {
  std::vector<Eigen::Index> wedge;
  for (Eigen::Index k = 0; k < std::ssize(at.places); ++k) {
    const WingPlace& place = at.At(k);
    const double before = 1 - place.along;
    if (at.SideOf(k) == 0 || place.v < 0 || place.v > 1 || before > kWedgeTo) continue;
    if (std::abs(place.above) * frame.chord * 2 > kClearThickness * noise) wedge.push_back(k);
  }
  if (std::ssize(wedge) < kFewestInWedge) return {HUGE_VAL, 0};
  Eigen::MatrixX4d rows(std::ssize(wedge), 4);
  Eigen::VectorXd heights(std::ssize(wedge));
  double middle = 0;
  for (Eigen::Index r = 0; r < rows.rows(); ++r) {
    const Eigen::Index k = wedge[static_cast<size_t>(r)];
    const double before = 1 - at.At(k).along;
    const int side = at.SideOf(k);
    rows.row(r) << side, side * before, 1, before;
    heights[r] = at.At(k).above;
    middle += before / static_cast<double>(rows.rows());
  }
  const Eigen::Vector4d line = LeastSquares(rows, heights);
  return {line[0] / (line[0] + line[1] * middle), line[1]};
}

}  // namespace batten::internal
