// SPDX-License-Identifier: MIT
// Cubic curves along the chains of a section. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/section/section_trace.h"

namespace batten::internal {

// The two curves of one chain, as SectionCurve (plane_section.h) describes them.
struct FittedChain {
  NurbsCurve<2> parameters;
  NurbsCurve<3> points;
  bool closed;
};

struct FittedChains {
  std::vector<FittedChain> curves;
  std::vector<Eigen::Vector2d> touches;  // a place on each chain that only touches the plane
};

// The curves of a trace, error-controlled as Section promises. |normal| = 1.
class SectionFitter {
 public:
  SectionFitter(const NurbsSurface& surface,
                const Eigen::Vector3d& normal,
                double offset,
                double tolerance);
  FittedChains Fit(const SectionTrace& trace);

 private:
  // What is known at one place, seen from one pair of spans.
  struct Contact {
    Eigen::Vector2d at;
    Eigen::Vector3d point;  // brought into the plane
    double height, height_u, height_v;
    double sine;  // of the angle between surface and plane
    bool regular;
    Eigen::Vector3d tangent;   // of length one
    Eigen::Vector2d velocity;  // (u, v) for each unit of length
  };
  // A place of a chain, seen from before and from behind.
  struct Station {
    Contact before, after;
  };
  // One cubic in space and in the domain over [0, length].
  struct Arc {
    double length;
    Eigen::Matrix<double, 3, 4> points;
    Eigen::Matrix<double, 2, 4> places;
  };

  Contact ContactOf(const Eigen::Vector2d& at, const SurfaceJet& jet) const;
  Contact ContactIn(const SectionLink& link, const Eigen::Vector2d& at);
  Contact ContactAt(const Eigen::Vector2d& at) const;
  Contact MiddleOf(const SectionLink& link, const Contact& a, const Contact& b);
  std::optional<Contact> Settled(const SectionLink& link, Eigen::Vector2d at);
  Contact Bracketed(const SectionLink& link, const Contact& a, const Contact& b);
  static Arc ArcBetween(const Contact& a, const Contact& b);
  bool Near(const Arc& arc, const SectionLink* link, int places);
  void Refine(const SectionLink& link,
              const Contact& a,
              const Contact& b,
              int depth,
              std::vector<Station>& stations);
  std::vector<Station> StationsOf(const SectionTrace& trace, const std::vector<SectionLink>& chain);
  std::vector<Station> Thinned(const std::vector<Station>& stations);
  bool Replaces(const std::vector<Station>& stations, std::size_t i, std::size_t j);
  static bool Corner(const Station& station);

  const NurbsSurface& surface_;
  Eigen::Vector3d normal_;
  double offset_, tolerance_, size_;
  SurfacePieces pieces_;
  std::map<std::pair<int, int>, SurfacePiece> used_;
};

}  // namespace batten::internal
