// SPDX-License-Identifier: MIT
#include "fitting/revolution/revolution_axis.h"

#include <Eigen/Geometry>

#include "fitting/primitives/normal_axes.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr double kTowardsCentre = 1e-4;  // of Σ |c̄|²: less, and noisy normals shift the axis

}  // namespace

AxisFrame AxisFrame::Moved(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) const {
  AxisFrame moved = *this;
  const double angle = turn.norm();
  if (angle > 0) {
    moved.axes = axes * Eigen::AngleAxisd(-angle, turn / angle).toRotationMatrix();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < i; ++j) {
        moved.axes.col(i) -= moved.axes.col(j) * moved.axes.col(j).dot(moved.axes.col(i));
      }
      moved.axes.col(i).normalize();
    }
  }
  moved.origin = origin - moved.axes * shift;
  return moved;
}

AxisFrame FrameAbout(const Eigen::Vector3d& point, const Eigen::Vector3d& direction) {
  Eigen::Vector3d axis = direction.normalized();
  Eigen::Index largest, smallest;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0) axis = -axis;
  axis.cwiseAbs().minCoeff(&smallest);
  AxisFrame frame;
  frame.origin = point;
  frame.axes.col(2) = axis;
  const Eigen::Vector3d across = Eigen::Vector3d::Unit(smallest) - axis[smallest] * axis;
  frame.axes.col(0) = across.normalized();
  frame.axes.col(1) = axis.cross(Eigen::Vector3d(frame.axes.col(0)));
  return frame;
}

std::vector<AxisFrame> AxesOfRotation(const Eigen::Matrix3Xd& places,
                                      const Eigen::Matrix3Xd& normals,
                                      const Eigen::Vector3d& centre,
                                      double size) {
  const double unit = size > 0 ? 1 / size : 1;
  std::vector<AxisFrame> frames;
  for (const Axis& axis :
       LinesMeetingNormals({unit * (places.colwise() - centre), normals}, kTowardsCentre)) {
    frames.push_back(FrameAbout(centre + size * axis.point, axis.direction));
  }
  return frames;
}

std::vector<AxisFrame> AxesOfInertia(const Eigen::Matrix3Xd& places,
                                     const Eigen::Vector3d& centre) {
  const Eigen::Matrix3Xd centred = places.colwise() - centre;
  const Eigen::Matrix3d scatter = centred * centred.transpose();
  const double size = scatter.cwiseAbs().maxCoeff();
  const SymmetricEigen3 solver = EigenOf3(scatter / (size > 0 ? size : 1));
  std::vector<AxisFrame> frames;
  for (int k = 2; k >= 0; --k) frames.push_back(FrameAbout(centre, solver.vectors.col(k)));
  return frames;
}

}  // namespace batten::internal
