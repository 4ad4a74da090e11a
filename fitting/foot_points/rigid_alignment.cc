// SPDX-License-Identifier: MIT
#include "batten/fitting/rigid_alignment.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/geometry/foot_point.h"
#include "fitting/core/rounding.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kMostSteps = 100;
// Of the largest eigenvalue: freedoms below are not seen. Points of a plane or cylinder see the
// others only through errors of form, the squares of 1e-4 of the size or less.
constexpr double kSeen = 1e-6;
constexpr double kOnSurface = 1e-10;  // of the points' size: the way to a foot is rounding

// What is nearest to each point, in coordinates about the middle of the points.
struct NearestPlaces {
  Eigen::VectorXd distances;  // along the normals
  Eigen::Matrix3Xd normals;
  std::vector<int> owners;

  NearestPlaces(const std::vector<SurfaceFootPoints>& searches,
                const Eigen::Matrix3Xd& points,
                double unit,
                ThreadPool& pool)
      : distances(Eigen::VectorXd::Constant(points.cols(), HUGE_VAL)),
        normals(3, points.cols()),
        owners(static_cast<size_t>(points.cols()), 0) {
    for (size_t s = 0; s < searches.size(); ++s) {
      const std::vector<SurfaceFoot> feet = searches[s].Nearest(points, pool);
      for (Eigen::Index k = 0; k < points.cols(); ++k) {
        const SurfaceFoot& foot = feet[static_cast<size_t>(k)];
        if (foot.distance >= std::abs(distances[k])) continue;
        const Eigen::Vector3d off = points.col(k) - foot.point;
        const auto normal = searches[s].surface().NormalAt(foot.u, foot.v);
        const Eigen::Vector3d n = normal.value_or(off.normalized());
        distances[k] = n.dot(off) < 0 ? -foot.distance : foot.distance;
        // Beyond an edge the distance changes along the way to the foot.
        normals.col(k) =
            foot.distance > kOnSurface * unit && std::abs(n.dot(off)) < 0.99 * foot.distance
                ? Eigen::Vector3d(off / distances[k])
                : n;
        owners[static_cast<size_t>(k)] = static_cast<int>(s);
      }
    }
  }
};

// The normal equations of distances for a turn (times `unit`) and a shift.
struct Form {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  double squares = 0;
  Eigen::Index points = 0;

  Form(const NearestPlaces& near, const Eigen::Matrix3Xd& points, double unit, int owner) {
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      if (owner >= 0 && near.owners[static_cast<size_t>(k)] != owner) continue;
      Vector6 row;
      row << points.col(k).cross(near.normals.col(k)) / unit, near.normals.col(k);
      matrix += row * row.transpose();
      right -= near.distances[k] * row;
      squares += near.distances[k] * near.distances[k];
      ++this->points;
    }
  }
};

// Steps of datums one after the other: each moves what it sees of the freedoms that are left.
struct Step {
  Vector6 step = Vector6::Zero();
  Matrix6 covariance = Matrix6::Zero();
  int determined = 0;

  explicit Step(const std::vector<Form>& forms) {
    Eigen::MatrixXd left = Matrix6::Identity();
    for (const Form& form : forms) {
      if (left.cols() == 0) break;
      const Eigen::MatrixXd seen = left.transpose() * form.matrix * left;
      const Eigen::VectorXd pull = left.transpose() * (form.right - form.matrix * step);
      const internal::SymmetricEigen eigen = internal::EigenOf(seen);
      const double least = kSeen * std::max(form.matrix.trace() / 6, eigen.values.maxCoeff());
      std::vector<Eigen::Index> open;
      for (Eigen::Index k = 0; k < seen.cols(); ++k) {
        const Eigen::VectorXd v = eigen.vectors.col(k);
        const double eigenvalue = eigen.values[k];
        if (!(eigenvalue > least)) {
          open.push_back(k);
          continue;
        }
        const Vector6 way = left * v;
        step += v.dot(pull) / eigenvalue * way;
        covariance += way * way.transpose() / eigenvalue;
        ++determined;
      }
      left = (left * eigen.vectors(Eigen::all, open)).eval();
    }
  }
};

std::vector<Form> FormsOf(const NearestPlaces& near,
                          const Eigen::Matrix3Xd& points,
                          double unit,
                          const std::vector<int>& datums) {
  if (datums.empty()) return {Form(near, points, unit, -1)};
  std::vector<Form> forms;
  for (const int datum : datums) {
    forms.emplace_back(near, points, unit, datum);
    if (forms.back().points == 0)
      throw std::invalid_argument("AlignRigidly: datums: no point is nearest to surface " +
                                  std::to_string(datum) + ": bring the points nearer first");
  }
  return forms;
}

double RmsOf(const std::vector<Form>& forms) {
  double squares = 0, points = 0;
  for (const Form& form : forms) {
    squares += form.squares;
    points += static_cast<double>(form.points);
  }
  return std::sqrt(squares / std::max(1.0, points));
}

}  // namespace

PointCloud RigidAlignment::Moved(const PointCloud& cloud) const {
  // R (o + p) + t = o + R p + (R o + t − o).
  const Eigen::Vector3d move = rotation * cloud.origin() + translation - cloud.origin();
  PointCloud moved((rotation * cloud.points()).colwise() + move, cloud.origin(), cloud.dimension());
  if (cloud.normals().cols() > 0) moved.set_normals(rotation * cloud.normals());
  moved.set_weights(cloud.weights());
  moved.set_colours(cloud.colours());
  moved.set_parameters(cloud.parameters());
  return moved;
}

Eigen::Matrix3d RigidAlignment::CovarianceAt(const Eigen::Vector3d& place) const {
  const Eigen::Vector3d arm = place - middle;
  Eigen::Matrix<double, 3, 6> rows;
  rows << 0, arm[2], -arm[1], 1, 0, 0, -arm[2], 0, arm[0], 0, 1, 0, arm[1], -arm[0], 0, 0, 0, 1;
  return rows * covariance * rows.transpose();
}

Eigen::VectorXd DistanceDeviations(const PointCloud& moved,
                                   double noise,
                                   const std::optional<RigidAlignment>& alignment) {
  Eigen::VectorXd deviations = Eigen::VectorXd::Constant(moved.size(), noise);
  for (Eigen::Index k = 0; alignment && k < moved.size(); ++k) {
    const Eigen::Vector3d most = EigenOf3(alignment->CovarianceAt(moved.World(k))).values;
    deviations[k] = noise * std::sqrt(1 + std::max(0.0, most[2]));
  }
  return deviations;
}

RigidAlignment AlignRigidly(const std::vector<NurbsSurface>& surfaces,
                            const PointCloud& cloud,
                            const std::vector<int>& datums,
                            ThreadPool& pool) {
  if (surfaces.empty()) throw std::invalid_argument("AlignRigidly: surfaces: there are none");
  for (const int datum : datums) {
    if (datum < 0 || datum >= static_cast<int>(surfaces.size()))
      throw std::invalid_argument("AlignRigidly: datums: there is no surface " +
                                  std::to_string(datum));
  }
  RigidAlignment found;
  if (cloud.size() == 0) throw std::invalid_argument("AlignRigidly: cloud: it has no points");
  const Eigen::Vector3d middle = cloud.points().rowwise().mean();
  std::vector<SurfaceFootPoints> searches;
  for (const NurbsSurface& surface : surfaces)
    searches.emplace_back(surface.Translated(-cloud.origin() - middle));
  const Eigen::Matrix3Xd start = cloud.points().colwise() - middle;
  const double unit = std::max(start.colwise().norm().maxCoeff(), 1e-300);
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double rms = HUGE_VAL;
  for (int k = 0; k < kMostSteps; ++k) {
    const Eigen::Matrix3Xd points = (rotation * start).colwise() + shift;
    const NearestPlaces near(searches, points, unit, pool);
    const std::vector<Form> forms = FormsOf(near, points, unit, datums);
    const double now = RmsOf(forms);
    if (k == 0) found.rms_before = now;
    const Step step(forms);
    // Datums after the first need not come nearer together with it: they end when nothing moves.
    if (datums.empty() && !(now < rms)) break;
    rms = found.rms_after = now;
    found.rotation = rotation;
    found.translation = shift;
    found.iterations = k;
    found.determined = step.determined;
    Vector6 scale;
    scale << Eigen::Vector3d::Constant(1 / unit), Eigen::Vector3d::Ones();
    found.covariance = scale.asDiagonal() * step.covariance * scale.asDiagonal();
    if (step.step.cwiseAbs().maxCoeff() <= internal::kRelativeRounding * unit) break;
    const Eigen::Vector3d turn = step.step.head<3>() / unit;
    const Eigen::Matrix3d by =
        turn.norm() > 0 ? Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix()
                        : Eigen::Matrix3d::Identity();
    rotation = by * rotation;
    shift = by * shift + step.step.tail<3>();
  }
  // About the origin of the world, from about the middle.
  const Eigen::Vector3d about = cloud.origin() + middle;
  found.middle = about + found.translation;
  found.translation += about - found.rotation * about;
  return found;
}

}  // namespace batten
