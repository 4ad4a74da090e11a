// SPDX-License-Identifier: MIT
// What the page of a report shows, as plain numbers: meshes, curves, points and a histogram.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/tessellate.h"

namespace batten {

// Everything below is relative to ReportScene::center.
struct ReportSurface {
  std::string name;
  TriangleMesh mesh;
  Eigen::VectorXd deviation;       // at the vertices (DeviationMap); NaN where no point is near
  Eigen::VectorXd gap;             // distance from the nearest point; empty where there are none
  Eigen::VectorXd sigma;           // standard deviations; NaN where unsupported; empty: not known
  Eigen::VectorXd gaussian, mean;  // curvature there; NaN where it has no finite limit
  // Polylines on the surface: trim loops, closed; the edges of the domain of an untrimmed one that
  // are neither seam nor point; lines of interior knots, inside the trims.
  std::vector<Eigen::Matrix3Xd> trims, edges, knot_lines;
  int net_u = 0, net_v = 0;
  Eigen::Matrix3Xd net;  // control points, v runs fastest
};

struct ReportCurve {
  std::string name;
  bool closed = false;
  bool planar = false;         // lies in a plane, along the scene's plan axes; curvature has a sign
  Eigen::Matrix3Xd points;     // samples, at a jump of direction or curvature two
  Eigen::VectorXd parameters;  // of these
  Eigen::VectorXd curvature;   // positive to the left where planar; NaN where it is not finite
  Eigen::Matrix3Xd normals;    // unit vectors away from the centre of curvature
  Eigen::Matrix3Xd net, knots;  // control points; the places of distinct interior knots
};

struct ReportCloud {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd deviation;   // of each, signed as the scene says
  PointMask outlier;           // set aside
  Eigen::Matrix3Xd feet;       // on the geometry; none where there are only surfaces
  Eigen::VectorXd parameters;  // of these on their curves, NaN on surfaces; likewise
  Eigen::Index total = 0;      // points there are; those above are what is shown of them
};

// Of the deviations of all points that count.
struct ReportHistogram {
  double low = 0, high = 0;  // the ends of the bins, all equally wide; low < high unless empty
  std::vector<Eigen::Index> counts;
  Eigen::Index below = 0, above = 0;
  double mean = 0, deviation = 0;  // the standard one, of all of them, those beyond the bins too
};

struct ReportScene {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // in the coordinates of the points
  double size = 0;                                   // diagonal of the box, > 0
  std::optional<double> tolerance = std::nullopt;
  double limit = 0;            // half width of the colour range, > 0 (DeviationLimit)
  bool signed_values = false;  // whether deviations have a sign
  std::vector<ReportSurface> surfaces;
  std::vector<ReportCurve> curves;
  // Axes in which curves are drawn flat, at right angles to each other: x and y for plane curves.
  Eigen::Vector3d plan_u = Eigen::Vector3d::UnitX(), plan_v = Eigen::Vector3d::UnitY();
  ReportCloud cloud;
  ReportHistogram histogram;
};

}  // namespace batten
