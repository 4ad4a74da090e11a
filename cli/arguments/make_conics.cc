// SPDX-License-Identifier: MIT
#include "cli/arguments/make_conics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "batten/geometry/conic_arc.h"
#include "batten/geometry/make_curve.h"
#include "batten/io/read_error.h"
#include "cli/arguments/make_values.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/parse_values.h"

namespace batten::internal {
namespace {

using Shapes = std::vector<Geometry>;

void AddConic(CLI::App& command, MakeArguments& a) {
  AddFlag(command, "--ends", a.ends, "P,Q", "Its ends, x,y,z,x,y,z, or x,y,x,y");
  AddFlag(command, "--tangents", a.tangents, "T,S", "Directions of its tangents at the ends");
  AddFlag(
      command, "--point", a.point, "X,Y,Z", "With ends and tangents: a point it passes through");
  AddFlag(command,
          "--shoulder",
          a.shoulder,
          "X,Y,Z",
          "With ends: its point whose tangent is parallel to the chord");
  AddFlag(command,
          "--rho",
          a.rho,
          "R",
          "With tangents or shoulder: below 0.5 an ellipse, 0.5 a parabola, above a hyperbola");
  AddFlag(command, "--points", a.points, "P1,...,P5", "Five points in order along it");
  AddFlag(command,
          "--implicit",
          a.implicit,
          "a,b,c,d,e,f",
          "a x^2 + b x y + c y^2 + d x + e y + f = 0 in the plane of --center, --axis, --x-axis");
  AddFlag(command, "--from", a.from, "X,Y", "With implicit: where it begins [a whole ellipse]");
  AddFlag(command, "--to", a.to, "X,Y", "With implicit: where it ends");
  AddFlag(command, "--via", a.via, "X,Y", "With implicit: a point of the arc [the shorter arc]");
  AddFlag(command,
          "--homogeneous",
          a.control,
          "x,y,z,w,...",
          "Three control points times their weights, and the weights; w = 0: at infinity");
  AddFrame(command, a, "With implicit: the origin of the plane", "With implicit: its normal");
}

double RhoOf(const MakeArguments& a) { return a.rho.empty() ? 0.5 : ParseNumber("--rho", a.rho); }

ConicArc<3> BetweenEnds(const MakeArguments& a) {
  const Eigen::Matrix3Xd ends = PointsOf("--ends", a.ends, 2);
  if (!a.shoulder.empty()) {
    if (!a.tangents.empty() || !a.point.empty()) {
      throw UsageError("--shoulder: the tangents and the point follow from it; leave them out");
    }
    const Eigen::Vector3d shoulder = PointsOf("--shoulder", a.shoulder, 1);
    return ConicArcOfShoulder<3>(ends.col(0), shoulder, ends.col(1), RhoOf(a));
  }
  if (a.tangents.empty()) throw UsageError("--ends: needs --tangents or --shoulder too");
  const Eigen::Matrix3Xd tangents = PointsOf("--tangents", a.tangents, 2);
  if (a.point.empty() == a.rho.empty()) {
    throw UsageError(std::string("--tangents: one of --point and --rho is needed") +
                     (a.rho.empty() ? "" : ", not both"));
  }
  if (a.point.empty()) {
    return ConicArcOfRho<3>(ends.col(0), tangents.col(0), ends.col(1), tangents.col(1), RhoOf(a));
  }
  const Eigen::Vector3d point = PointsOf("--point", a.point, 1);
  return ConicArcThrough<3>(ends.col(0), tangents.col(0), ends.col(1), tangents.col(1), point);
}

Eigen::Vector2d PlanePoint(const char* flag, const std::string& text) {
  const auto [x, y] = Pair(flag, text);
  return {x, y};
}

// The whole ellipse or circle.
NurbsCurve<3> Whole(const ImplicitConic& conic, const Frame& frame) {
  const ConicLocus locus = ClassifyConic(conic);
  const auto at = [&](const Eigen::Vector3d& p) { return frame.At(p[0], p[1], 0); };
  if (const auto* circle = std::get_if<CircleShape>(&locus)) {
    return MakeArc(Frame(at(circle->center), frame.axis(), frame.x()), circle->radius);
  }
  if (const auto* ellipse = std::get_if<EllipseShape>(&locus)) {
    const Eigen::Vector3d x = at(ellipse->major_axis) - frame.origin();
    return MakeEllipseArc(
        Frame(at(ellipse->center), frame.axis(), x), ellipse->major_radius, ellipse->minor_radius);
  }
  throw UsageError("--implicit: the conic is " + NameOf(locus) +
                   "; only a whole ellipse needs no --from and --to");
}

NurbsCurve<3> OfEquation(const MakeArguments& a) {
  const std::vector<double> x = ParseNumbers("--implicit", a.implicit);
  if (x.size() != 6) throw UsageError("--implicit: '" + a.implicit + "' is not six numbers");
  const ImplicitConic conic{x[0], x[1], x[2], x[3], x[4], x[5]};
  const Frame frame = FrameOf(a);
  if (a.from.empty() != a.to.empty()) throw UsageError("--from and --to: both or neither");
  if (a.from.empty()) return Whole(conic, frame);
  std::optional<Eigen::Vector2d> via;
  if (!a.via.empty()) via = PlanePoint("--via", a.via);
  const ConicArc<2> flat =
      ArcOf(conic, PlanePoint("--from", a.from), PlanePoint("--to", a.to), via);
  ConicArc<3> arc;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d p = flat.columns.col(i);
    arc.columns.col(i) << p[0] * frame.x() + p[1] * frame.y() + p[2] * frame.origin(), p[2];
  }
  return ToNurbs(arc);
}

ConicArc<3> OfControl(const MakeArguments& a) {
  const std::vector<double> x = ParseNumbers("--homogeneous", a.control);
  if (x.size() != 12) {
    throw UsageError("--homogeneous: '" + a.control + "' is not three times four numbers");
  }
  return {Eigen::Map<const Eigen::Matrix<double, 4, 3>>(x.data())};
}

Shapes Conic(const MakeArguments& a) {
  const auto ways = std::ptrdiff_t{!a.ends.empty()} + !a.points.empty() + !a.implicit.empty() +
                    !a.control.empty();
  if (ways != 1) {
    throw UsageError(
        std::string("one of --ends, --points, --implicit and --homogeneous is needed") +
        (ways > 1 ? ", not " + std::to_string(ways) : ""));
  }
  if (!a.implicit.empty()) return {OfEquation(a)};
  if (!a.control.empty()) return {ToNurbs(OfControl(a))};
  if (!a.ends.empty()) return {ToNurbs(BetweenEnds(a))};
  return {ToNurbs(ConicArcThroughFive<3>(PointsOf("--points", a.points, 5)))};
}

}  // namespace

MakeKind ConicKind() {
  return {"conic",
          "An arc of an ellipse, parabola or hyperbola",
          "conic -o nose.json --ends 0,0,0,4,0,0 \\\n"
          "    --tangents 0,1,0,0,-1,0 --point 2,3,0\n"
          "  batten make conic -o dome.json --points 0,0,1,2,2,2.6,3,2.2,4,0\n"
          "  batten make conic -o branch.json --implicit 1,0,-1,0,0,-1 --from 1.25,-0.75 \\\n"
          "    --to 1.25,0.75",
          AddConic,
          Conic};
}

}  // namespace batten::internal
