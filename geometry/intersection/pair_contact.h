// SPDX-License-Identifier: MIT
// Places where two smooth parts of surfaces meet, by Newton's method. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/geometry/parameter_box.h"
#include "geometry/intersection/patch_tree.h"

namespace batten::internal {

// One place of both surfaces.
struct MeetPoint {
  Eigen::Vector4d at;        // (u, v) on the first and on the second surface
  Eigen::Vector3d point;     // halfway between the two
  Eigen::Vector3d tangent;   // of the branch, of length one
  Eigen::Vector4d velocity;  // of `at` for each unit of length
  double sine;               // of the angle between the surfaces
  bool regular;              // there are a tangent and a velocity

  MeetPoint Reversed() const {
    MeetPoint other = *this;
    other.tangent = -tangent;
    other.velocity = -velocity;
    return other;
  }
};

// How a place is to be found besides A = B: transversal, or with parallel normals too.
enum class MeetKind { kCrossing, kTouching };

class PairContact {
 public:
  PairContact(const PatchTree& a,
              const ParameterBox& box_a,
              const PatchTree& b,
              const ParameterBox& box_b,
              MeetKind kind,
              double tolerance);

  // The place with A = B to rounding, or 1e-3 of the tolerance, in the plane through a point; with
  // a parameter held; or the nearest in parameters. None where Newton's steps do not end, or end
  // farther than 2 % of the boxes outside them.
  std::optional<Eigen::Vector4d> InPlane(const Eigen::Vector4d& start,
                                         const Eigen::Vector3d& normal,
                                         const Eigen::Vector3d& through) const;
  std::optional<Eigen::Vector4d> Holding(const Eigen::Vector4d& start, int parameter) const;
  std::optional<Eigen::Vector4d> Nearest(const Eigen::Vector4d& start) const;

  // The same with parallel normals, whatever the kind.
  std::optional<Eigen::Vector4d> NearestTouch(const Eigen::Vector4d& start) const;

  // Places on the borders, to a hundredth of the tolerance, are brought onto them.
  Eigen::Vector4d OntoBorders(Eigen::Vector4d at) const;
  // A place beside one on a border, to a tenth of the tolerance both, along which the branch runs
  // on, is kept on that border.
  Eigen::Vector4d AlongBorders(const MeetPoint& here, Eigen::Vector4d at) const;
  // Whether a place is in both boxes.
  bool Inside(const Eigen::Vector4d& at) const;

  MeetPoint PointAt(const Eigen::Vector4d& at) const;
  Eigen::Vector3d First(const Eigen::Vector4d& at) const;
  Eigen::Vector3d Second(const Eigen::Vector4d& at) const;

  const Eigen::Vector4d& lower() const { return lower_; }
  const Eigen::Vector4d& upper() const { return upper_; }
  MeetKind kind() const { return kind_; }
  double tolerance() const { return tolerance_; }

  // Whether the places with A = B and parallel normals about this one are a whole neighbourhood.
  bool Coincident(const Eigen::Vector4d& at) const;

 private:
  // The last row of the system: what is held.
  struct Hold {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(), through = Eigen::Vector3d::Zero();
    int parameter = -1;
  };
  static constexpr int kMostRows = 6;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, 0, kMostRows, 4>;
  struct System {
    Rows matrix;  // columns scaled by the widths of the boxes
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostRows, 1> values;
  };
  Eigen::Vector4d SpeedsAt(const Eigen::Vector4d& at) const;
  System SystemAt(const Eigen::Vector4d& at, const Hold* hold) const;
  std::optional<Eigen::Vector4d> Solve(Eigen::Vector4d at, const Hold* hold) const;
  Rows TouchRows(const SurfaceJet& a, const SurfaceJet& b, Eigen::Vector2d& values) const;

  const PatchTree &a_, &b_;
  ParameterBox box_a_, box_b_;
  MeetKind kind_;
  double tolerance_, size_;
  Eigen::Vector4d lower_, upper_, widths_;
};

}  // namespace batten::internal
