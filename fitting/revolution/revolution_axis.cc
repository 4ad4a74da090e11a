// SPDX-License-Identifier: MIT
#include "fitting/revolution/revolution_axis.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "batten/fitting/statistics.h"

namespace batten::internal {
namespace {

constexpr double kTowardsCentre = 1e-4;  // pull to the centre, against effects of noisy normals
constexpr int kRounds = 5;
constexpr double kAxisCauchy = 3;

// Stationary rotations: c in columns, that of the least value first, with c̄ for each.
struct Rotations {
  Eigen::Matrix3d directions, moments;
};

Rotations SolveRotations(const Eigen::Matrix3Xd& moments,
                         const Eigen::Matrix3Xd& normals,
                         const Eigen::VectorXd& weights) {
  const Eigen::Matrix3Xd weighted = normals * weights.asDiagonal();
  Eigen::Matrix3d nn = weighted * normals.transpose();
  const Eigen::Matrix3d nm = weighted * moments.transpose();
  const Eigen::Matrix3d mm = moments * weights.asDiagonal() * moments.transpose();
  nn.diagonal().array() += kTowardsCentre * weights.sum();
  const Eigen::Matrix3d out = nn.ldlt().solve(nm);
  const Eigen::Matrix3d left = mm - nm.transpose() * out;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver((left + left.transpose()) / 2);
  return {solver.eigenvectors(), -out * solver.eigenvectors()};
}

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
  const Eigen::Index n = places.cols();
  const double unit = size > 0 ? 1 / size : 1;
  Eigen::Matrix3Xd moments(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d p = unit * (places.col(i) - centre);
    moments.col(i) = p.cross(Eigen::Vector3d(normals.col(i)));
  }
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(n);
  Rotations rotations = SolveRotations(moments, normals, weights);
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::VectorXd off = moments.transpose() * rotations.directions.col(0) +
                                normals.transpose() * rotations.moments.col(0);
    const Eigen::VectorXd sizes = off.cwiseAbs();
    const double scale = kMadToSigma * Median({sizes.begin(), sizes.end()}) + 1e-12;
    weights = (1 + (off / (kAxisCauchy * scale)).array().square()).inverse();
    rotations = SolveRotations(moments, normals, weights);
  }
  std::vector<AxisFrame> frames;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d c = rotations.directions.col(k), moment = rotations.moments.col(k);
    frames.push_back(FrameAbout(centre + size * c.cross(moment), c));
  }
  return frames;
}

std::vector<AxisFrame> AxesOfInertia(const Eigen::Matrix3Xd& places,
                                     const Eigen::Vector3d& centre) {
  const Eigen::Matrix3Xd centred = places.colwise() - centre;
  const Eigen::Matrix3d scatter = centred * centred.transpose();
  const double size = scatter.cwiseAbs().maxCoeff();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter / (size > 0 ? size : 1));
  std::vector<AxisFrame> frames;
  for (int k = 2; k >= 0; --k) frames.push_back(FrameAbout(centre, solver.eigenvectors().col(k)));
  return frames;
}

}  // namespace batten::internal
