// SPDX-License-Identifier: MIT
// batten make: every kind is the shape that its flags say, and what can't be made is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batten/geometry/classify_shape.h"
#include "batten/geometry/closure.h"
#include "batten/io/geometry_file.h"
#include "run_program.h"
#include "tolerances.h"

namespace batten::internal::make_test {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

class MakeTest : public ::testing::Test {
 protected:
  std::string File(const std::string& name) const { return folder_.File(name); }

  ProgramRun Make(std::vector<std::string> words, const std::string& out) const {
    words.insert(words.begin(), "make");
    words.insert(words.end(), {"-o", out});
    return Batten(words);
  }

  // What the words make, through a JSON file.
  template <typename Shape>
  Shape Made(const std::vector<std::string>& words) const {
    const ProgramRun run = Make(words, File("made.json"));
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    return std::get<Shape>(ReadGeometry(File("made.json")).at(0));
  }

  void ExpectRefused(const std::vector<std::string>& words,
                     const std::vector<std::string>& said) const {
    const std::ptrdiff_t before = folder_.Entries();
    const ProgramRun run = Make(words, File("never.json"));
    EXPECT_EQ(run.code, 2) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(run.out, "");
    for (const std::string& part : said) EXPECT_THAT(run.err, HasSubstr(part));
    EXPECT_EQ(folder_.Entries(), before);
  }

  TemporaryFolder folder_;
};

void ExpectNear(const Eigen::Vector3d& got, const Eigen::Vector3d& expected) {
  EXPECT_LE((got - expected).norm(), kRounding * 100) << got.transpose();
}

TEST_F(MakeTest, Curves) {
  const auto circle = Made<NurbsCurve<3>>(
      {"circle", "--radius", "4", "--center", "10,0,0", "--axis", "-1,0,0", "--x-axis", "0,1,0"});
  EXPECT_NEAR(std::get<CircleShape>(ClassifyShape(circle)).radius, 4, kIterated);
  ExpectNear(circle.At(0), {10, 4, 0});
  ExpectNear(circle.At(0.25), {10, 0, -4});
  EXPECT_TRUE(circle.At(0) == circle.At(1));

  const auto arc =
      Made<NurbsCurve<3>>({"arc", "--radius", "2", "--start-angle", "-45", "--sweep", "180"});
  ExpectNear(arc.At(0), {std::sqrt(2), -std::sqrt(2), 0});
  ExpectNear(arc.At(1), {-std::sqrt(2), std::sqrt(2), 0});
  ExpectNear(Made<NurbsCurve<3>>({"arc", "--radius", "2"}).At(1), {0, 2, 0});

  const auto ellipse = Made<NurbsCurve<3>>({"ellipse", "--radii", "1,2"});
  const auto shape = std::get<EllipseShape>(ClassifyShape(ellipse));
  EXPECT_NEAR(shape.major_radius, 2, kIterated);
  EXPECT_NEAR(shape.minor_radius, 1, kIterated);

  const auto line = Made<NurbsCurve<3>>({"line", "--from", "0,0,1", "--to", "1,2,3"});
  ExpectNear(line.At(0.5), {0.5, 1, 2});
}

// What it was told is what it has.
TEST_F(MakeTest, SegmentsOfEndsAndDerivatives) {
  const std::vector<std::string> flags = {
      "hermite", "--ends=1,2,3,-4,1,0", "--derivatives=5,0,1,-5,5,0"};
  const auto cubic = Made<NurbsCurve<3>>(flags);
  EXPECT_EQ(cubic.basis().degree(), 3);
  std::vector<std::string> more = flags;
  more.emplace_back("--second-derivatives=0,-6,2,8,0,1");
  const auto quintic = Made<NurbsCurve<3>>(more);
  EXPECT_EQ(quintic.basis().degree(), 5);
  for (const auto& curve : {cubic, quintic}) {
    ExpectNear(curve.At(0), {1, 2, 3});
    ExpectNear(curve.At(1), {-4, 1, 0});
    ExpectNear(curve.JetAt(0).first, {5, 0, 1});
    ExpectNear(curve.JetAt(1).first, {-5, 5, 0});
  }
  ExpectNear(quintic.JetAt(0).second, {0, -6, 2});
  ExpectNear(quintic.JetAt(1).second, {8, 0, 1});
  const std::vector<std::string> point = {
      "hermite", "--ends=1,1,1,1,1,1", "--derivatives=0,0,0,0,0,0"};
  ExpectRefused(point, {"no curve"});
  ExpectRefused({point[0], point[1], point[2], "--second-derivatives=0,0,0,0,0,0"}, {"no curve"});
}

TEST_F(MakeTest, FlatSurfaces) {
  const auto plane = Made<NurbsSurface>(
      {"plane", "--size", "4,2", "--center", "1,1,1", "--axis", "0,-1,0", "--x-axis", "1,0,0"});
  ExpectNear(plane.At(0, 0), {-1, 1, 0});
  ExpectNear(plane.At(1, 1), {3, 1, 2});
  ExpectNear(plane.NormalAt(0.5, 0.5).value(), {0, -1, 0});
  const auto bilinear = Made<NurbsSurface>({"bilinear",
                                            "--corner-00=0,0,0",
                                            "--corner-10=4,0,1",
                                            "--corner-01=0,3,1",
                                            "--corner-11=4,3,0"});
  ExpectNear(bilinear.At(0.5, 0.5), {2, 1.5, 0.5});
  ExpectNear(bilinear.At(1, 0), {4, 0, 1});
}

TEST_F(MakeTest, RoundSurfaces) {
  const auto cylinder = Made<NurbsSurface>({"cylinder", "--radius", "3", "--height", "20"});
  EXPECT_NEAR(std::get<CylinderShape>(ClassifyShape(cylinder)).radius, 3, kIterated);
  EXPECT_TRUE(Closed(cylinder, Direction::kU));
  ExpectNear(cylinder.At(0, 1), {3, 0, 20});
  ExpectNear(cylinder.NormalAt(0, 0.5).value(), {1, 0, 0});

  const auto frustum = Made<NurbsSurface>(
      {"cone", "--radius", "5", "--height", "8", "--half-angle", "20", "--sweep", "270"});
  const auto cone = std::get<ConeShape>(ClassifyShape(frustum));
  EXPECT_NEAR(cone.half_angle, std::acos(-1) / 9, kIterated);
  EXPECT_FALSE(Closed(frustum, Direction::kU));
  const auto tip = Made<NurbsSurface>({"cone", "--radius", "5", "--height", "8"});
  EXPECT_EQ(CollapsedEdges(tip), (CollapsedEdgeSet{.v_upper = true}));
  const auto sharp =
      Made<NurbsSurface>({"cone", "--radius", "5", "--height", "5", "--half-angle", "45"});
  EXPECT_EQ(CollapsedEdges(sharp, 0), (CollapsedEdgeSet{.v_upper = true}));
  const auto wide =
      Made<NurbsSurface>({"cone", "--radius", "0", "--height", "1", "--half-angle", "-45"});
  ExpectNear(wide.At(0, 1), {1, 0, 1});

  const auto dome = Made<NurbsSurface>({"sphere", "--radius", "10", "--latitudes", "0,90"});
  EXPECT_EQ(CollapsedEdges(dome, 0), (CollapsedEdgeSet{.v_upper = true}));
  ExpectNear(dome.At(0.3, 1), {0, 0, 10});
  const auto ball = Made<NurbsSurface>({"sphere", "--radius", "10", "--center", "1,2,3"});
  ExpectNear(std::get<SphereShape>(ClassifyShape(ball)).center, {1, 2, 3});

  const auto elbow =
      Made<NurbsSurface>({"torus", "--major-radius", "20", "--minor-radius", "4", "--sweep", "90"});
  EXPECT_NEAR(std::get<TorusShape>(ClassifyShape(elbow)).minor_radius, 4, kIterated * 20);
  EXPECT_TRUE(Closed(elbow, Direction::kV));
  ExpectNear(elbow.At(0, 0.25), {20, 0, 4});
}

TEST_F(MakeTest, CurvesAreRevolved) {
  ASSERT_EQ(Make({"line", "--from", "2,0,0", "--to", "1,0,3"}, File("line.json")).code, 0);
  const auto surface = Made<NurbsSurface>({"revolve", File("line.json"), "--sweep", "180"});
  ExpectNear(surface.At(1, 0), {-2, 0, 0});
  ExpectNear(surface.At(0.5, 1), {0, 1, 3});
  ASSERT_EQ(Make({"line", "--from", "0,0,1", "--to", "0,0,3"}, File("axis.json")).code, 0);
  ExpectRefused({"revolve", File("axis.json")}, {"Revolve: the curve lies on the axis"});
  ASSERT_EQ(Make({"plane", "--size", "1,1"}, File("plane.json")).code, 0);
  ExpectRefused({"revolve", File("plane.json")}, {"only curves can be taken"});
  EXPECT_EQ(Make({"revolve", File("none.json")}, File("x.json")).code, 1);
}

TEST_F(MakeTest, StepHoldsTheAnalyticShape) {
  const struct {
    std::vector<std::string> words;
    const char* entity;
  } cases[] = {{{"cylinder", "--radius", "3", "--height", "20"}, "CYLINDRICAL_SURFACE"},
               {{"cone", "--radius", "5", "--height", "8"}, "CONICAL_SURFACE"},
               {{"sphere", "--radius", "1"}, "SPHERICAL_SURFACE"},
               {{"torus", "--major-radius", "3", "--minor-radius", "1"}, "TOROIDAL_SURFACE"},
               {{"plane", "--size", "3,1"}, "PLANE("},
               {{"circle", "--radius", "3"}, "CIRCLE("},
               {{"line", "--from", "0,0,0", "--to", "1,0,0"}, "LINE("}};
  for (const auto& [words, entity] : cases) {
    ASSERT_EQ(Make(words, File("a.step")).code, 0);
    EXPECT_THAT(folder_.Text("a.step"), HasSubstr(entity));
    EXPECT_THAT(folder_.Text("a.step"), Not(HasSubstr("B_SPLINE")));
    // Through JSON too: a file carries all that says what the shape is.
    ASSERT_EQ(Make(words, File("a.json")).code, 0);
    ASSERT_EQ(Batten({"convert", File("a.json"), File("b.step")}).code, 0);
    EXPECT_THAT(folder_.Text("b.step"), HasSubstr(entity));
  }
}

TEST_F(MakeTest, BadValuesAreNamedWithTheirRule) {
  ExpectRefused({"cylinder", "--radius", "-3", "--height", "1"}, {"--radius", "-3", "positive"});
  ExpectRefused({"cylinder", "--radius", "nan", "--height", "1"}, {"--radius", "nan"});
  ExpectRefused({"cylinder", "--radius", "3"}, {"--height is required"});
  ExpectRefused({"cylinder", "--radus", "3"}, {"--radus", "did you mean '--radius'?"});
  ExpectRefused({"cone", "--radius=3", "--height=10", "--half-angle=45"}, {"past the tip", "3"});
  ExpectRefused({"cone", "--radius=3", "--height=1", "--half-angle=90"}, {"--half-angle", "90"});
  ExpectRefused({"cone", "--radius=3", "--height=1", "--half-angle=9", "--top-radius=1"},
                {"--half-angle", "--top-radius"});
  ExpectRefused({"cone", "--radius=0", "--height=1"}, {"--radius", "above 0"});
  ExpectRefused({"sphere", "--radius", "1", "--sweep", "400"}, {"--sweep", "400", "360"});
  ExpectRefused({"sphere", "--radius", "1", "--latitudes", "-91,0"}, {"--latitudes", "-91,0"});
  ExpectRefused({"sphere", "--radius", "1", "--latitudes", "9,9"}, {"--latitudes", "9,9"});
  ExpectRefused({"torus", "--major-radius=3", "--minor-radius=0"}, {"--minor-radius", "positive"});
  ExpectRefused({"circle", "--radius", "1", "--center", "1,2"}, {"--center", "three numbers"});
  ExpectRefused({"circle", "--radius", "1", "--axis", "0,0,0"}, {"--axis", "no direction"});
  ExpectRefused({"circle", "--radius", "1", "--x-axis", "0,0,2"}, {"--x-axis", "0,0,2"});
  ExpectRefused({"ellipse", "--radii", "1,-2"}, {"--radii", "both positive"});
  ExpectRefused({"plane", "--size", "1"}, {"--size", "two numbers"});
  ExpectRefused({"line", "--from", "1,1,1", "--to", "1,1,1"}, {"the ends are one point"});
  ExpectRefused({"cylinder", "--radius", "1e300", "--height", "1"}, {"1e100"});
  ExpectRefused({"circle", "--radius", "1", "--center", "1e200,0,0"}, {"1e100"});
  ExpectRefused({"cilinder"}, {"'batten make cilinder'", "'cylinder'"});
  EXPECT_EQ(Batten({"make"}).code, 2);
  EXPECT_EQ(Make({"sphere", "--radius", "1"}, File("x.xyz")).code, 2);
}

TEST_F(MakeTest, TellsWhatItWrote) {
  const std::string out = File("a.json");
  const std::vector<std::string> sphere = {"make", "sphere", "--radius", "1", "-o", out};
  EXPECT_EQ(Batten(sphere).out, out + ": surface of degree 2,2, 9 x 5 control points\n");
  std::vector<std::string> words = sphere;
  words.push_back("--json");
  const Json files = Json::parse(Batten(words).out);
  EXPECT_EQ(files["files"].size(), 1u);
  EXPECT_EQ(files["files"][0]["path"], out);
  EXPECT_EQ(files["files"][0]["kind"], "surface");
  words.back() = "--quiet";
  const ProgramRun quiet = Batten(words);
  EXPECT_EQ(quiet.out + quiet.err, "");
  const ProgramRun piped =
      Batten({"make", "sphere", "--radius", "1", "-o", "-", "--output-format", "json"});
  EXPECT_EQ(Json::parse(piped.out)["shape"]["count"], 1);
}

TEST_F(MakeTest, HelpShowsDefaultsAndExamples) {
  const std::string help = Batten({"make", "--help"}).out;
  for (const char* kind : {"circle",
                           "arc",
                           "ellipse",
                           "line",
                           "hermite",
                           "plane",
                           "bilinear",
                           "cylinder",
                           "cone",
                           "sphere",
                           "torus",
                           "revolve",
                           "extrude",
                           "ruled",
                           "loft",
                           "sweep",
                           "swing",
                           "gordon",
                           "coons",
                           "patch"}) {
    EXPECT_THAT(help, HasSubstr(std::string("batten make ") + kind));
  }
  const std::string sphere = Batten({"make", "sphere", "--help"}).out;
  EXPECT_THAT(sphere, HasSubstr("Example"));
  EXPECT_THAT(sphere, HasSubstr("LOW,HIGH=-90,90"));
  EXPECT_THAT(sphere, HasSubstr("DEGREES=360"));
}

}  // namespace batten::internal::make_test
