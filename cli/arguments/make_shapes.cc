// SPDX-License-Identifier: MIT
#include "cli/arguments/make_shapes.h"

#include <cmath>

#include "batten/geometry/bezier_curve.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/segment_forms.h"
#include "batten/io/read_error.h"
#include "cli/arguments/curve_files.h"
#include "cli/arguments/make_conics.h"
#include "cli/arguments/make_joins.h"
#include "cli/arguments/make_values.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

using Shapes = std::vector<Geometry>;

void AddAngles(CLI::App& command, MakeArguments& a) {
  AddFlag(command, "--start-angle", a.start_angle, "DEGREES", "Where it begins about the axis");
  AddFlag(command, "--sweep", a.sweep, "DEGREES", "How far it goes, counter-clockwise");
}

void AddCircle(CLI::App& command, MakeArguments& a) {
  AddFrame(command, a, "Its centre", "Normal of its plane");
  Require(command, "--radius", a.radius, "R", "Its radius");
  AddFlag(command, "--start-angle", a.start_angle, "DEGREES", "Where it begins");
  a.circle_form = "9";
  Allow(*AddFlag(command,
                 "--form",
                 a.circle_form,
                 "FORM",
                 "9 or 7 control points of degree 2, or degree5: one piece of degree 5"),
        {"9", "7", "degree5"});
}
Shapes Circle(const MakeArguments& a) {
  const CircleForm form = a.circle_form == "7"         ? CircleForm::kSevenPoints
                          : a.circle_form == "degree5" ? CircleForm::kDegreeFive
                                                       : CircleForm::kNinePoints;
  const double start = Radians(ParseNumber("--start-angle", a.start_angle));
  return {MakeCircle(FrameOf(a), Length("--radius", a.radius), form, start)};
}

void AddArc(CLI::App& command, MakeArguments& a) {
  AddFrame(command, a, "The centre of its circle", "Normal of its plane");
  Require(command, "--radius", a.radius, "R", "Its radius");
  a.sweep = "90";
  AddAngles(command, a);
  AddFlag(command,
          "--segments",
          a.segments,
          "N",
          "Equal pieces of less than 180 degrees [as few as are of 90 degrees at most]");
}
Shapes Arc(const MakeArguments& a) {
  const double radius = Length("--radius", a.radius);
  if (a.segments.empty()) return {MakeArc(FrameOf(a), radius, AnglesOf(a))};
  const auto pieces = static_cast<int>(ParseWhole("--segments", a.segments, 1, 1000));
  return {MakeArc(FrameOf(a), radius, AnglesOf(a), pieces)};
}

void AddEllipse(CLI::App& command, MakeArguments& a) {
  AddFrame(command, a, "Its centre", "Normal of its plane");
  Require(command, "--radii", a.radii, "A,B", "Its radii along the x axis and across");
  AddAngles(command, a);
}
Shapes Ellipse(const MakeArguments& a) {
  const auto [x, y] = Pair("--radii", a.radii);
  if (!(x > 0 && y > 0)) throw UsageError("--radii: '" + a.radii + "' are not both positive");
  return {MakeEllipseArc(FrameOf(a), x, y, AnglesOf(a))};
}

void AddLine(CLI::App& command, MakeArguments& a) {
  Require(command, "--from", a.from, "X,Y,Z", "Where it begins");
  Require(command, "--to", a.to, "X,Y,Z", "Where it ends");
}
Shapes Line(const MakeArguments& a) {
  return {MakeLine<3>(Triple("--from", a.from), Triple("--to", a.to))};
}

void AddHermite(CLI::App& command, MakeArguments& a) {
  Require(command, "--ends", a.ends, "P,Q", "Its ends, x,y,z,x,y,z, or x,y,x,y");
  Require(command,
          "--derivatives",
          a.derivatives,
          "D,E",
          "First derivatives at the ends, by a parameter from 0 to 1");
  AddFlag(command,
          "--second-derivatives",
          a.second_derivatives,
          "D,E",
          "Second ones too: it is of degree 5 then, not 3");
}
Shapes Hermite(const MakeArguments& a) {
  const bool quintic = !a.second_derivatives.empty();
  const Eigen::Matrix3Xd ends = PointsOf("--ends", a.ends, 2),
                         first = PointsOf("--derivatives", a.derivatives, 2),
                         second = quintic
                                      ? PointsOf("--second-derivatives", a.second_derivatives, 2)
                                      : Eigen::Matrix3Xd(Eigen::Matrix3Xd::Zero(3, 2));
  if (ends.col(0) == ends.col(1) && first.isZero(0) && second.isZero(0))
    throw UsageError("--ends: one point, without derivatives: it would be no curve");
  if (quintic) {
    return {ToNurbs(ToBezier(QuinticHermite<3>{
        ends.col(0), first.col(0), second.col(0), ends.col(1), first.col(1), second.col(1)}))};
  }
  return {ToNurbs(ToBezier(CubicHermite<3>{ends.col(0), first.col(0), ends.col(1), first.col(1)}))};
}

void AddPlane(CLI::App& command, MakeArguments& a) {
  AddFrame(command, a, "The middle of the rectangle", "Its normal");
  Require(command, "--size", a.size, "W,H", "Its sides, along the x axis and across");
}
Shapes Plane(const MakeArguments& a) {
  const auto [w, h] = Pair("--size", a.size);
  if (!(w > 0 && h > 0)) throw UsageError("--size: '" + a.size + "' are not both positive");
  return {MakePlane(FrameOf(a), {-w / 2, w / 2}, {-h / 2, h / 2})};
}

void AddBilinear(CLI::App& command, MakeArguments& a) {
  Require(command, "--corner-00", a.corner00, "X,Y,Z", "The corner u = 0, v = 0");
  Require(command, "--corner-10", a.corner10, "X,Y,Z", "The corner u = 1, v = 0");
  Require(command, "--corner-01", a.corner01, "X,Y,Z", "The corner u = 0, v = 1");
  Require(command, "--corner-11", a.corner11, "X,Y,Z", "The corner u = 1, v = 1");
}
Shapes Bilinear(const MakeArguments& a) {
  return {MakeBilinear(Triple("--corner-00", a.corner00),
                       Triple("--corner-10", a.corner10),
                       Triple("--corner-01", a.corner01),
                       Triple("--corner-11", a.corner11))};
}

void AddCylinder(CLI::App& command, MakeArguments& a) {
  AddFrame(command, a, "The middle of its foot", "Its axis, from the foot up");
  Require(command, "--radius", a.radius, "R", "Its radius");
  Require(command, "--height", a.height, "H", "From the foot to the top");
  AddAngles(command, a);
}
Shapes Cylinder(const MakeArguments& a) {
  const double height = Length("--height", a.height);
  return {MakeCylinder(FrameOf(a), Length("--radius", a.radius), {0, height}, AnglesOf(a))};
}

void AddCone(CLI::App& command, MakeArguments& a) {
  AddFrame(command, a, "The middle of its foot", "Its axis, from the foot up");
  AddFlag(command, "--radius", a.radius, "R", "Radius of the foot, 0 for a tip")->required();
  Require(command, "--height", a.height, "H", "From the foot to the top, along the axis");
  AddFlag(command, "--top-radius", a.top_radius, "R", "Radius of the top [0: a tip]");
  AddFlag(command,
          "--half-angle",
          a.half_angle,
          "DEGREES",
          "In place of the top radius: between axis and side, narrowing upwards; below 0 widening");
  AddAngles(command, a);
}
double TopRadius(const MakeArguments& a, double radius, double height) {
  if (a.half_angle.empty()) {
    return a.top_radius.empty() ? 0 : ParseNumber("--top-radius", a.top_radius, Sign::kNotNegative);
  }
  if (!a.top_radius.empty()) throw UsageError("--half-angle: --top-radius says it already");
  const double degrees = ParseNumber("--half-angle", a.half_angle);
  if (!(std::abs(degrees) < 90)) {
    throw UsageError("--half-angle: " + a.half_angle + " is not between -90 and 90 degrees");
  }
  const double slope = std::tan(Radians(degrees)), top = radius - height * slope;
  constexpr double kTip = 1e-12;
  if (std::abs(top) <= kTip * radius) return 0;
  if (top < 0) {
    throw UsageError("--height: " + a.height + " leads past the tip, which is at " +
                     NumberText(radius / slope));
  }
  return top;
}
Shapes Cone(const MakeArguments& a) {
  const double radius = ParseNumber("--radius", a.radius, Sign::kNotNegative);
  const double height = Length("--height", a.height);
  const double top = TopRadius(a, radius, height);
  if (radius == 0 && top == 0) throw UsageError("--radius: a cone needs a foot or a top above 0");
  return {MakeCone(FrameOf(a), radius, top, {0, height}, AnglesOf(a))};
}

void AddSphere(CLI::App& command, MakeArguments& a) {
  AddFrame(command, a, "Its centre", "From the south pole to the north pole");
  Require(command, "--radius", a.radius, "R", "Its radius");
  AddAngles(command, a);
  AddFlag(command, "--latitudes", a.latitudes, "LOW,HIGH", "From where to where, in degrees");
}
Shapes Sphere(const MakeArguments& a) {
  const auto [low, high] = Pair("--latitudes", a.latitudes);
  if (!(low >= -90 && high <= 90 && low < high)) {
    throw UsageError("--latitudes: '" + a.latitudes + "' do not increase within -90 and 90");
  }
  const double radius = Length("--radius", a.radius);
  return {MakeSphere(FrameOf(a), radius, AnglesOf(a), {Radians(low), Radians(high)})};
}

void AddTorus(CLI::App& command, MakeArguments& a) {
  AddFrame(command, a, "Its centre", "Its axis");
  Require(command, "--major-radius", a.major_radius, "R", "From the axis to the tube's middle");
  Require(command, "--minor-radius", a.minor_radius, "R", "Of the tube");
  AddAngles(command, a);
  AddFlag(command,
          "--tube-start",
          a.tube_start,
          "DEGREES",
          "Where the tube begins: 0 outermost, then towards the axis' direction");
  AddFlag(command, "--tube-sweep", a.tube_sweep, "DEGREES", "How far round the tube goes");
}
Shapes Torus(const MakeArguments& a) {
  return {MakeTorus(FrameOf(a),
                    Length("--major-radius", a.major_radius),
                    Length("--minor-radius", a.minor_radius),
                    AnglesOf(a),
                    Angles("--tube-start", a.tube_start, "--tube-sweep", a.tube_sweep))};
}

void AddRevolve(CLI::App& command, MakeArguments& a) {
  command.add_option("CURVE", a.curve, "The curves to turn: .json .step")->required();
  AddFlag(command, "--format", a.format, "FORMAT", "Format of CURVE where its name does not tell");
  AddFlag(command, "--center", a.center, "X,Y,Z", "A point of the axis");
  AddFlag(command, "--axis", a.axis, "X,Y,Z", "What they turn about");
  AddAngles(command, a);
}
Shapes Revolved(const MakeArguments& a) {
  const Frame frame = FrameOf(a);
  const AngleRange angles = AnglesOf(a);
  Shapes shapes;
  for (const NurbsCurve<3>& curve : CurvesOf({a.curve}, a.format, *a.unit)) {
    shapes.emplace_back(Revolve(curve, frame, angles));
  }
  return shapes;
}

}  // namespace

const std::vector<MakeKind>& MakeKinds() {
  static const std::vector<MakeKind> kinds = {
      {"circle",
       "A full circle",
       "circle -o hole.step --radius 4 --center 10,0,0",
       AddCircle,
       Circle},
      {"arc",
       "An arc of a circle",
       "arc -o fillet.json --radius 2 --start-angle 180 --sweep 90",
       AddArc,
       Arc},
      {"ellipse",
       "An ellipse or an arc of one",
       "ellipse -o oval.json --radii 3,2",
       AddEllipse,
       Ellipse},
      {"line", "A segment", "line -o edge.json --from 0,0,0 --to 1,2,3", AddLine, Line},
      {"hermite",
       "The cubic or quintic between ends with derivatives (Hermite's form, Ferguson's)",
       "hermite -o road.json --ends 0,0,0,4,1,0 --derivatives 5,0,0,5,5,0",
       AddHermite,
       Hermite},
      {"plane", "A rectangle", "plane -o table.step --size 100,50", AddPlane, Plane},
      {"bilinear",
       "The surface between four corners",
       "bilinear -o roof.json --corner-00 0,0,0 --corner-10 4,0,1 \\\n"
       "    --corner-01 0,3,1 --corner-11 4,3,0",
       AddBilinear,
       Bilinear},
      {"cylinder",
       "A cylinder or a part of one",
       "cylinder -o pin.step --radius 3 --height 20",
       AddCylinder,
       Cylinder},
      {"cone",
       "A cone, a frustum, or a part of one",
       "cone -o taper.step --radius 5 --height 8 --half-angle 20",
       AddCone,
       Cone},
      {"sphere",
       "A sphere or a part of one",
       "sphere -o dome.step --radius 10 --latitudes 0,90\n"
       "  batten make sphere -o octant.step --radius 10 --latitudes 0,90 --sweep 90",
       AddSphere,
       Sphere},
      {"torus",
       "A torus or a part of one",
       "torus -o elbow.step --major-radius 20 --minor-radius 4 --sweep 90",
       AddTorus,
       Torus},
      {"revolve",
       "The surface of a curve turned about an axis",
       "revolve profile.json -o vase.step --axis 0,0,1",
       AddRevolve,
       Revolved},
      ConicKind(),
      BlendKind(),
      FillKind(),
  };
  return kinds;
}

}  // namespace batten::internal
