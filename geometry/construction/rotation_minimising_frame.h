// SPDX-License-Identifier: MIT
// How a body turns that is carried along a curve without turning about its tangent.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/nurbs_curve.h"
#include "geometry/construction/one_sided_curve.h"

namespace batten::internal {

// The rotation M(v) that takes the frame at the beginning of the curve to the one at v, M = 1 at
// the beginning; with it a turn about the tangent, even by length. [Wang, Jüttler, Zheng & Liu
// 2008: double reflection, of fourth order]
class RotationMinimisingFrame {
 public:
  // The turn at any parameter is right to `accuracy` radians: steps are halved until that and the
  // finer one agree. `curve` has a continuous tangent and stands still nowhere; throws
  // std::invalid_argument in the name of `function` where that does not hold, saying where.
  RotationMinimisingFrame(const NurbsCurve<3>& curve, double accuracy, const char* function);

  // The turn about the tangent, right-handed, by which the frame comes back along a closed curve,
  // in [−π, π].
  double Holonomy() const;

  // From now on turned by `turn` about the tangent along the whole curve, evenly by its length.
  void TwistBy(double turn) { twist_ = turn; }

  struct Place {
    CurveJet<3> jet;
    Eigen::Matrix3d turn, turn_slope;  // M and dM/dv
    Eigen::Vector3d bend;              // curvature vector
  };
  Place At(double v, Side side) const;

  // Where the frame was stepped to, in increasing order.
  std::vector<double> Places() const;

 private:
  struct Node {
    double at;
    Eigen::Vector3d point, tangent, normal;
  };

  CurveJet<3> MovingJet(double at, Side side) const;  // throws where it stands still
  Node Stepped(const Node& from, double to, Side side) const;
  std::vector<Node> Walk(int steps) const;  // so many in every span

  OneSidedCurve pieces_;
  ArcLengthMap length_;
  std::vector<double> breaks_;
  std::vector<Node> nodes_;
  double twist_ = 0;
  const char* function_;
};

// Throws std::invalid_argument in the name of `function` where the tangent of the curve turns at a
// knot, or at the seam of a closed one, by more than `angle` radians, saying where and by how much.
void RefuseKinks(const NurbsCurve<3>& curve, double angle, const char* function);

}  // namespace batten::internal
