// SPDX-License-Identifier: MIT
// Places where the shapes of two faces of a part, or of three, meet.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fitting/regions/grow_regions.h"

namespace batten::internal {

using FacePair = std::pair<int, int>;  // ascending

inline constexpr double kTangent = 0.14;  // sine: faces that meet under less have no sure border

inline constexpr double kBorderReach = 4;  // spacings: of a border from the points beside it

// The place on all of two shapes or more nearest to `from`, by Gauss–Newton steps; none where they
// do not settle on it within `reach`, or the shapes are near to tangent: the sine of their angle,
// of three the volume, is below `least`.
std::optional<Eigen::Vector3d> PlaceOn(const std::vector<const FittedSurface*>& shapes,
                                       Eigen::Vector3d from,
                                       double reach,
                                       double least = kTangent);

// The shapes of a part's faces, and which of them touch along a curve: `contacts` has its normals
// (NormalsAlong). Places on shapes nearer to one another than `same`, which is noise, are one.
// Keeps references.
class FaceMeets {
 public:
  FaceMeets(const RegionPoints& data,
            const RegionLabels& labels,
            const std::map<FacePair, FittedSurface>& contacts,
            double same)
      : data_(data), labels_(labels), contacts_(contacts), same_(same) {}

  const RegionPoints& data() const { return data_; }
  double spacing() const { return data_.spacing; }
  double same() const { return same_; }
  int LabelOf(int point) const { return labels_.label[std::size_t(point)]; }

  // The two shapes that cut one another in the border.
  std::vector<const FittedSurface*> Cutting(const FacePair& faces) const;

  // How far from a border its points may be: where faces touch, as far as noise hides one from the
  // other.
  double ReachOf(const FacePair& faces, const Eigen::Vector3d& near) const;

  // How far from a place of the border the nearest points of its faces are.
  double BesideOf(const FacePair& faces, const Eigen::Vector3d& place) const;

  // How far beyond a vertex points may be of its faces.
  double BlurOf(const std::vector<int>& faces, const Eigen::Vector3d& place) const;

  // On the border, and where three faces or more meet: no farther than a few spacings, or
  // `at_most` where that is more.
  std::optional<Eigen::Vector3d> PlaceIn(const FacePair& faces, const Eigen::Vector3d& near) const;
  std::optional<Eigen::Vector3d> Corner(const std::vector<int>& faces,
                                        const Eigen::Vector3d& near,
                                        double at_most = 0) const;

  // Whether the face's shape passes the place, as far as noise tells.
  bool IsOn(int face, const Eigen::Vector3d& place) const {
    return std::abs(Shape(face).Distance(place)) <= same_;
  }

  // Whether both shapes pass a place between two of their points: those of two sides of a thin wall
  // do not.
  bool BothAt(const FacePair& faces, const Eigen::Vector3d& place) const;

  // The sine of the angle under which the two faces meet.
  double SineAt(const FacePair& faces, const Eigen::Vector3d& place) const;

  // The direction of the border.
  Eigen::Vector3d TangentAt(const FacePair& faces, const Eigen::Vector3d& place) const;

  // In words, in the coordinates of the cloud.
  std::string At(const Eigen::Vector3d& place) const;

 private:
  // The cross product of their normals.
  Eigen::Vector3d Across(const FacePair& faces, const Eigen::Vector3d& place) const;

  const FittedSurface& Shape(int face) const { return labels_.regions[std::size_t(face)].shape; }

  const RegionPoints& data_;
  const RegionLabels& labels_;
  const std::map<FacePair, FittedSurface>& contacts_;
  const double same_;
};

}  // namespace batten::internal
