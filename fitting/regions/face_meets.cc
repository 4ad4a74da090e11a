// SPDX-License-Identifier: MIT
#include "fitting/regions/face_meets.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {

std::optional<Eigen::Vector3d> PlaceOn(const std::vector<const FittedSurface*>& shapes,
                                       Eigen::Vector3d from,
                                       double reach,
                                       double least) {
  constexpr int kSteps = 30;
  const Eigen::Vector3d start = from;
  const auto count = std::ssize(shapes);
  Eigen::MatrixXd normals(count, 3);
  Eigen::VectorXd off(count);
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kSteps; ++step) {
    for (Eigen::Index k = 0; k < count; ++k) {
      const FittedSurface touching = shapes[std::size_t(k)]->TouchingNear(from);
      normals.row(k) = touching.normal.transpose();
      off[k] = shapes[std::size_t(k)]->Distance(from);
    }
    // The sine of an angle, and of three the volume, over which a step is divided.
    const bool many = count > 3;
    const Eigen::MatrixXd angles =
        many ? normals.transpose() * normals : Eigen::MatrixXd(normals * normals.transpose());
    if (!(std::sqrt(std::max(0.0, angles.determinant())) > least)) return std::nullopt;
    const double far = off.norm();
    if (far <= kSettled || (far < 1e-11 && !(far < before / 2))) return from;
    before = far;
    if (many) {
      from -= Eigen::Vector3d(SymmetricSolution(angles, normals.transpose() * off));
    } else {
      from -= normals.transpose() * SymmetricSolution(angles, off);
    }
    if (!((from - start).norm() <= reach)) return std::nullopt;
  }
  return before < 1e-9 ? std::optional(from) : std::nullopt;
}

std::vector<const FittedSurface*> FaceMeets::Cutting(const FacePair& faces) const {
  const auto contact = contacts_.find(faces);
  return {&Shape(faces.first),
          contact == contacts_.end() ? &Shape(faces.second) : &contact->second};
}

double FaceMeets::ReachOf(const FacePair& faces, const Eigen::Vector3d& near) const {
  constexpr double kAside = 0.01, kLargest = 0.2;  // of the size
  const FittedSurface here = Shape(faces.first).TouchingNear(near);
  const auto contact = contacts_.find(faces);
  const auto parted = [&](const Eigen::Vector3d& place, const Eigen::Vector3d& way) {
    const FittedSurface aside = Shape(faces.first).TouchingNear(place + kAside * way);
    return std::abs(Shape(faces.second).Distance(aside.point)) / (kAside * kAside);
  };
  double most = 0;  // the faces part by this times the distance squared
  if (contact != contacts_.end()) {
    const FittedSurface across = contact->second.TouchingNear(near);
    most = parted(across.point, across.normal);
  } else {
    most = std::max(parted(near, here.along), parted(near, here.Across()));
  }
  return kBorderReach * spacing() + std::min(kLargest, std::sqrt(same_ / most));
}

double FaceMeets::BesideOf(const FacePair& faces, const Eigen::Vector3d& place) const {
  constexpr double kBeside = 1.5;  // spacings
  return contacts_.contains(faces) ? ReachOf(faces, place) : kBeside * spacing();
}

double FaceMeets::BlurOf(const std::vector<int>& faces, const Eigen::Vector3d& place) const {
  double blur = spacing();
  for (const int a : faces) {
    for (const int b : faces) {
      if (a < b && contacts_.contains({a, b})) blur = std::max(blur, ReachOf({a, b}, place));
    }
  }
  return blur;
}

std::optional<Eigen::Vector3d> FaceMeets::PlaceIn(const FacePair& faces,
                                                  const Eigen::Vector3d& near) const {
  const bool touch = contacts_.contains(faces);
  return PlaceOn(Cutting(faces), near, touch ? ReachOf(faces, near) : kBorderReach * spacing());
}

std::optional<Eigen::Vector3d> FaceMeets::Corner(const std::vector<int>& faces,
                                                 const Eigen::Vector3d& near,
                                                 double at_most) const {
  std::vector<const FittedSurface*> shapes;
  double reach = std::max(kBorderReach * spacing(), at_most);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    shapes.push_back(&Shape(faces[i]));
    for (std::size_t j = 0; j < i; ++j) {
      const FacePair pair = std::minmax(faces[i], faces[j]);
      const auto contact = contacts_.find(pair);
      if (contact == contacts_.end()) continue;
      shapes.push_back(&contact->second);
      reach = std::max(reach, ReachOf(pair, near));
    }
  }
  return PlaceOn(shapes, near, reach);
}

bool FaceMeets::BothAt(const FacePair& faces, const Eigen::Vector3d& place) const {
  // Of a fillet of four spacings' radius, the narrowest that is found, a place two spacings off.
  constexpr double kBends = 0.5;  // spacings
  const double near = kBends * spacing() + same_;
  return std::abs(Shape(faces.first).Distance(place)) <= near &&
         std::abs(Shape(faces.second).Distance(place)) <= near;
}

Eigen::Vector3d FaceMeets::Across(const FacePair& faces, const Eigen::Vector3d& place) const {
  const auto shapes = Cutting(faces);
  return shapes[0]->TouchingNear(place).normal.cross(shapes[1]->TouchingNear(place).normal);
}

double FaceMeets::SineAt(const FacePair& faces, const Eigen::Vector3d& place) const {
  return Across(faces, place).norm();
}

Eigen::Vector3d FaceMeets::TangentAt(const FacePair& faces, const Eigen::Vector3d& place) const {
  return Across(faces, place).stableNormalized();
}

std::string FaceMeets::At(const Eigen::Vector3d& place) const {
  const Eigen::Vector3d p = data_.unit * place + data_.middle;
  return "(" + RoundedText(p[0]) + ", " + RoundedText(p[1]) + ", " + RoundedText(p[2]) + ")";
}

}  // namespace batten::internal
