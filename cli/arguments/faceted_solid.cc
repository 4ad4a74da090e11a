// SPDX-License-Identifier: MIT
#include "cli/arguments/faceted_solid.h"

#include <fmt/format.h>

#include <numeric>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "batten/fitting/faceted_solid.h"
#include "batten/fitting/point_mask.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/spline_basis.h"
#include "cli/arguments/cad_solid.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

// The parameters of a point of the plane.
Eigen::Vector2d PlaceOn(const NurbsSurface& plane, const Eigen::Vector3d& p) {
  const auto along = [&](const Eigen::Vector3d& side, const SplineBasis& basis) {
    const double share = (p - plane.control_points().col(0)).dot(side) / side.squaredNorm();
    return basis.lower() + share * (basis.upper() - basis.lower());
  };
  return {along(plane.control_points().col(2) - plane.control_points().col(0), plane.basis_u()),
          along(plane.control_points().col(1) - plane.control_points().col(0), plane.basis_v())};
}

// A plane face as a surface with its loops as trims.
NurbsSurface SurfaceOf(const TrimmedSolid& solid, const TrimmedSolidFace& face) {
  const PlaneShape& plane = std::get<PlaneShape>(face.carrier);
  const Frame frame(plane.point, plane.normal);
  std::vector<std::vector<Eigen::Vector3d>> loops;
  Eigen::AlignedBox2d box;
  for (const auto& loop : face.loops) {
    std::vector<Eigen::Vector3d>& corners = loops.emplace_back();
    for (const TrimmedSolidCoedge& coedge : loop) {
      const TrimmedSolidEdge& edge = solid.edges[std::size_t(coedge.edge)];
      corners.push_back(solid.vertices.col(coedge.reversed ? edge.end : edge.start));
      const Eigen::Vector3d from = corners.back() - frame.origin();
      box.extend(Eigen::Vector2d(from.dot(frame.x()), from.dot(frame.y())));
    }
    corners.push_back(corners.front());
  }
  const NurbsSurface whole =
      MakePlane(frame, {box.min().x(), box.max().x()}, {box.min().y(), box.max().y()});
  std::vector<NurbsCurve<2>> trims;
  for (const std::vector<Eigen::Vector3d>& corners : loops) {
    Eigen::Matrix2Xd places(2, std::ssize(corners));
    std::vector<double> breaks(corners.size());
    std::iota(breaks.begin(), breaks.end(), 0.0);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      places.col(Eigen::Index(k)) = PlaceOn(whole, corners[k]);
    }
    trims.emplace_back(SplineBasis::Clamped(1, breaks), places);
  }
  return whole.WithTrims(std::move(trims));
}

}  // namespace

int WriteFacetedSolid(const FitArguments& a,
                      FitFiles& files,
                      const ClosedSurface& mesh,
                      const PointCloud& cloud,
                      const std::string& why) {
  TriangleSurface local = mesh.surface;
  local.vertices.colwise() -= files.shift();
  const FacetedMesh made = FacetedSolid(local, SinglePrecisionOf(mesh.surface.vertices));
  const auto count = std::ssize(made.solid.faces);
  if (count > kMostFacets) {
    files.Refuse(fmt::format("has {} plane faces, and a solid of plane faces has at most {}{}{}",
                             count,
                             kMostFacets,
                             why.empty() ? "" : "; no other solid is made: ",
                             why));
  }
  std::vector<Geometry> faces;
  for (const TrimmedSolidFace& face : made.solid.faces) {
    faces.emplace_back(SurfaceOf(made.solid, face));
  }
  // The vertices of the mesh, each at its place on a face that has it.
  const Eigen::Index points = local.vertices.cols();
  std::vector<int> owners(static_cast<std::size_t>(points), 0);
  Eigen::MatrixXd parameters = Eigen::MatrixXd::Zero(2, points);
  Eigen::VectorXd residuals = Eigen::VectorXd::Zero(points);
  for (Eigen::Index t = 0; t < local.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      owners[std::size_t(local.triangles(k, t))] = made.faces[std::size_t(t)];
    }
  }
  for (Eigen::Index k = 0; k < points; ++k) {
    const auto owner = std::size_t(owners[std::size_t(k)]);
    const PlaneShape& plane = std::get<PlaneShape>(made.solid.faces[owner].carrier);
    const Eigen::Vector3d p = local.vertices.col(k);
    residuals[k] = (p - plane.point).dot(plane.normal);
    parameters.col(k) = PlaceOn(std::get<NurbsSurface>(faces[owner]), p);
  }
  files.TakePoints(PointCloud(mesh.surface.vertices.colwise() - cloud.origin(), cloud.origin()));
  FitReport report;
  report.input.points = report.input.used = points;
  report.input.box_min = mesh.surface.vertices.rowwise().minCoeff();
  report.input.box_max = mesh.surface.vertices.rowwise().maxCoeff();
  report.input.origin = files.shift();
  report.geometry.kind = "face";
  report.geometry.count = static_cast<int>(count);
  report.error = report.error_all = Summarise(residuals, a.tolerance);
  report.end = {EndCode::kNoiseReached, "the faces are those of the mesh"};
  if (!why.empty())
    report.doubts.push_back({"faceted", "the mesh as it is, in plane faces: " + why});
  SolidCensus census;
  files.KeepSolid(made.solid, census);
  const int code =
      files.Write(faces, residuals, parameters, PointMask::Constant(points, false), report, owners);
  if (!a.flags.quiet) {
    PrintNote(a.out + ": " + CensusWords(census, "plane faces"));
  }
  return code;
}

}  // namespace batten::internal
