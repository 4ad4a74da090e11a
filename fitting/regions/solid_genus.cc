// SPDX-License-Identifier: MIT
#include "fitting/regions/solid_genus.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/geometry/frame.h"
#include "fitting/regions/solid_samples.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

// Round a torus' axis and round its tube.
Eigen::Vector2d AnglesOn(const TorusShape& torus, const Frame& frame, const Eigen::Vector3d& p) {
  const Eigen::Vector3d from = p - frame.origin();
  const double x = from.dot(frame.x()), y = from.dot(frame.y());
  return {std::atan2(y, x),
          std::atan2(from.dot(frame.axis()), std::hypot(x, y) - torus.major_radius)};
}

// Whether the face is the torus less some discs, so that the handle is in it: no loop goes round,
// and together they have the discs on their right.
bool HasHandle(const TrimmedSolid& solid, const TrimmedSolidFace& face, const TorusShape& torus) {
  const Frame frame(torus.center, torus.axis);
  double area = 0;
  for (const auto& loop : face.loops) {
    std::vector<Eigen::Vector2d> places;
    for (const TrimmedSolidCoedge& coedge : loop) {
      const TrimmedSolidEdge& edge = solid.edges[std::size_t(coedge.edge)];
      const double begin = edge.curve.basis().lower(), end = edge.curve.basis().upper();
      for (int k = 0; k < kPiecesOfEdge; ++k) {
        const double along = double(coedge.reversed ? kPiecesOfEdge - k : k) / kPiecesOfEdge;
        places.push_back(AnglesOn(torus, frame, edge.curve.At(begin + along * (end - begin))));
      }
    }
    Eigen::Vector2d at = places.front(), round = Eigen::Vector2d::Zero();
    for (std::size_t k = 1; k <= places.size(); ++k) {
      Eigen::Vector2d step = places[k % places.size()] - places[k - 1];
      for (double& turn : step) turn -= kTurn * std::round(turn / kTurn);
      area += (at[0] * step[1] - at[1] * step[0]) / 2;
      at += step;
      round += step;
    }
    if (round.cwiseAbs().maxCoeff() > kTurn / 2) return false;
  }
  return face.reversed ? area > 0 : area < 0;
}

// Faces of a plane's topology have two less their loops; tori have handles of their own.
int EulerOf(const TrimmedSolid& solid, const TrimmedSolidFace& face) {
  const auto* torus = std::get_if<TorusShape>(&face.carrier);
  const bool handle = torus != nullptr && (face.loops.empty() || HasHandle(solid, face, *torus));
  return (handle ? 0 : 2) - static_cast<int>(face.loops.size());
}

}  // namespace

int GenusOf(const TrimmedSolid& solid) {
  auto euler = static_cast<int>(solid.vertices.cols() - std::ssize(solid.edges));
  for (const TrimmedSolidFace& face : solid.faces) euler += EulerOf(solid, face);
  const std::vector<int> shells = ShellsOf(solid);
  const int count = shells.empty() ? 0 : 1 + *std::max_element(shells.begin(), shells.end());
  return count - euler / 2;
}

}  // namespace batten::internal
