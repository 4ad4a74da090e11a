// SPDX-License-Identifier: MIT
// batten make: surfaces from curves in files contain them, and what can't be made is refused with
// the measure and the rule.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batten/geometry/classify_shape.h"
#include "batten/geometry/closure.h"
#include "batten/io/geometry_file.h"
#include "run_program.h"
#include "tolerances.h"

namespace batten::internal::make_constructions_test {

using ::testing::HasSubstr;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

class MakeConstructionsTest : public ::testing::Test {
 protected:
  std::string File(const std::string& name) const { return folder_.File(name); }

  ProgramRun Make(Words words, const std::string& out) const {
    words.insert(words.begin(), "make");
    words.insert(words.end(), {"-o", File(out)});
    return Batten(words);
  }

  // A file of one curve made by the words.
  std::string Curve(const std::string& name, const Words& words) const {
    EXPECT_EQ(Make(words, name).code, 0);
    return File(name);
  }
  std::string Circle(const std::string& name, double radius, double z) const {
    return Curve(
        name,
        {"circle", "--radius", std::to_string(radius), "--center", "0,0," + std::to_string(z)});
  }
  std::string Line(const std::string& name, const std::string& from, const std::string& to) const {
    return Curve(name, {"line", "--from=" + from, "--to=" + to});
  }

  NurbsSurface Made(const Words& words, const std::string& said = "") const {
    const ProgramRun run = Make(words, "made.json");
    EXPECT_EQ(run.code, 0) << run.err;
    if (said.empty()) {
      EXPECT_EQ(run.err, "");
    } else {
      EXPECT_THAT(run.err, HasSubstr(said));
    }
    return std::get<NurbsSurface>(ReadGeometry(File("made.json")).at(0));
  }

  void ExpectRefused(const Words& words, const std::string& said) const {
    const ProgramRun run = Make(words, "never.json");
    EXPECT_EQ(run.code, 2) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(said));
    EXPECT_FALSE(std::filesystem::exists(File("never.json")));
  }

  TemporaryFolder folder_;
};

void ExpectNear(const Eigen::Vector3d& got,
                const Eigen::Vector3d& expected,
                double within = 1e-10) {
  EXPECT_LE((got - expected).norm(), within) << got.transpose();
}

TEST_F(MakeConstructionsTest, ExtrudedAndRuled) {
  const std::string circle = Circle("circle.json", 2, 0);
  const NurbsSurface pin = Made({"extrude", circle, "--by", "0,0,5"});
  EXPECT_NEAR(std::get<CylinderShape>(ClassifyShape(pin)).radius, 2, kIterated);
  const NurbsSurface cone = Made({"ruled", circle, Circle("top.json", 1, 3)});
  EXPECT_TRUE(std::holds_alternative<ConeShape>(ClassifyShape(cone)));
  ExpectRefused({"extrude", circle, "--by", "0,0,0"}, "by has the length 0");
  ExpectRefused({"extrude", circle}, "--by is required");
  ExpectRefused({"ruled", circle}, "the files hold 1 curves; two are joined");
  ExpectRefused({"ruled", circle, Line("line.json", "0,0,1", "0,3,1")},
                "curve 1 is closed and curve 2 is open, its ends 3 apart");
  const std::string a = Line("a.json", "0,0,0", "4,0,0"), b = Line("b.json", "4,1,0", "0,1,0");
  ExpectNear(Made({"ruled", a, b}, "curve 2: runs the other way").At(0, 1), {4, 1, 0});
  ExpectNear(Made({"ruled", a, b, "--align"}, "curve 2 turned round").At(0, 1), {0, 1, 0});
  Made(
      {"ruled", a, Curve("arc.json", {"arc", "--radius", "4", "--center", "0,9,0"}), "--by-length"},
      "the second curve is met to");
  ExpectRefused({"ruled",
                 Line("s.json", "0,0,0", "1,0,0"),
                 Line("t.json", "0,1,0", "1,1,0"),
                 "--tolerance",
                 "0.1"},
                "only --by-length needs one");
}

TEST_F(MakeConstructionsTest, Lofted) {
  const Words circles = {Circle("0.json", 1, 0),
                         Circle("1.json", 2, 1),
                         Circle("2.json", 1.5, 3),
                         Circle("3.json", 1, 4)};
  Words words = {"loft"};
  words.insert(words.end(), circles.begin(), circles.end());
  const NurbsSurface hull = Made(words);
  EXPECT_TRUE(Closed(hull, Direction::kU, 0));
  ExpectNear(hull.At(0, 0), {1, 0, 0});
  ExpectNear(hull.At(0.5, 1), {-1, 0, 4});
  words.insert(words.end(), {"--start-tangent", "0,0,1,2", "--degree", "4"});
  EXPECT_LE(Made(words).JetAt(0.1, 0).dv.head<2>().norm(), 1e-9);
  // Several sections in one file.
  EXPECT_EQ(Batten({"convert", circles[0], circles[1], File("both.json")}).code, 2);
  words = {
      "loft",
      circles[0],
      Curve("turned.json", {"circle", "--radius", "1", "--center", "0,0,2", "--x-axis", "0,1,0"})};
  Made(words,
       "section 2: runs the other way than the one before, or begins elsewhere; --align turns it");
  words.push_back("--align");
  ExpectNear(Made(words, "section 2 begun 0.75 of its domain later").At(0, 1), {1, 0, 2}, 1e-6);
  ExpectRefused({"loft", circles[0]}, "1 sections; at least 2");
  ExpectRefused({"loft", circles[0], circles[0]}, "sections 1 and 2 are the same curve");
  ExpectRefused({"loft", circles[0], Line("l.json", "0,0,1", "3,4,1")}, "its ends 5 apart");
  ExpectRefused({"loft", circles[0], circles[1], "--degree", "0"}, "--degree");
  ExpectRefused({"loft", circles[0], circles[1], "--start-tangent", "1,2"},
                "x,y,z or x,y,z,fullness");
  EXPECT_EQ(Make({"loft", circles[0], File("none.json")}, "x.json").code, 1);
  ASSERT_EQ(Make({"plane", "--size", "1,1"}, "plane.json").code, 0);
  ExpectRefused({"loft", circles[0], File("plane.json")},
                "holds a surface; only curves can be taken");
}

TEST_F(MakeConstructionsTest, Swept) {
  const std::string section =
      Curve("s.json", {"circle", "--radius", "1", "--axis", "0,1,0", "--center", "5,0,0"});
  const std::string path = Curve("p.json", {"arc", "--radius", "5", "--sweep", "100"});
  const NurbsSurface pipe =
      Made({"sweep", section, path, "--tolerance", "1e-6"}, "the exact sweep is met to");
  for (int k = 0; k <= 20; ++k) {
    const Eigen::Vector3d p = pipe.At(0.3, k / 20.0);
    EXPECT_NEAR(std::hypot(p.head<2>().norm() - 5, p.z()), 1, 1e-6);
  }
  const NurbsSurface moved = Made({"sweep", section, path, "--translational"});
  EXPECT_TRUE(moved.rational());
  ExpectNear(moved.At(0, 0), pipe.At(0, 0));
  ExpectRefused({"sweep", section, path, "--translational", "--twist", "9"}, "does not turn");
  ExpectRefused({"sweep", section, path, "--tolerance", "0"}, "positive");
  ExpectRefused(
      {"sweep",
       Curve("big.json", {"circle", "--radius", "6", "--axis", "0,1,0", "--center", "5,0,0"}),
       path},
      "whose radius is 5");
  Made({"sweep", section, Curve("ring.json", {"circle", "--radius", "5"}), "--twist", "360"},
       "the exact sweep");
  ExpectRefused({"sweep", section, File("ring.json"), "--twist", "90"}, "only whole turns");
  const std::string ring = Curve("closed.json", {"circle", "--radius", "9"});
  const std::string disc =
      Curve("disc.json", {"circle", "--radius", "1", "--axis", "0,1,0", "--center", "9,0,0"});
  ExpectRefused({"sweep", disc, ring, "--twist", "180"}, "a twist of 180 degrees");
  const std::string wide =
      Curve("wide.json", {"circle", "--radius", "10", "--axis", "0,1,0", "--center", "9,0,0"});
  ExpectRefused({"sweep", wide, ring}, "bring the profile nearer");
}

TEST_F(MakeConstructionsTest, Swung) {
  const std::string profile = Line("p.json", "1,0,0", "2,0,3");
  const std::string oval = Curve("o.json", {"ellipse", "--radii", "1,0.5"});
  ExpectNear(Made({"swing", profile, oval}).At(0.25, 1), {0, 1, 3});
  ExpectRefused({"swing", Line("q.json", "1,0,0", "2,0.25,3"), oval}, "by 0.25");
  ExpectRefused({"swing", profile}, "a profile and a trajectory");
  ExpectRefused({"swing", Line("axis.json", "0,0,0", "0,0,3"), oval}, "profile away from it");
}

TEST_F(MakeConstructionsTest, NetworksSidesAndPatches) {
  const std::string u = Line("u0.json", "0,0,0", "4,0,1") + "," + Line("u1.json", "0,3,0", "4,3,2");
  const std::string v = Line("v0.json", "0,0,0", "0,3,0") + "," + Line("v1.json", "4,0,1", "4,3,2");
  ExpectNear(Made({"gordon", "--u", u, "--v", v}, "2 x 2 curves").At(0.5, 1), {2, 3, 1});
  ExpectRefused(
      {"gordon", "--u", u, "--v", File("v0.json") + "," + Line("w.json", "4,0,1.5", "4,3,2.5")},
      "curve 1 along u and curve 2 along v do not meet");
  const NurbsSurface coons =
      Made({"coons", File("u0.json"), File("v1.json"), File("u1.json"), File("v0.json")});
  ExpectNear(coons.At(0.5, 0.5), {2, 1.5, 0.75});
  Made({"coons", File("u0.json"), File("v1.json"), Line("d.json", "4,3,2", "0,0,0"), "--bicubic"});
  ExpectRefused({"coons", File("u0.json"), File("v1.json"), File("v0.json")}, "do not meet");
  const NurbsSurface patch = Made({"patch",
                                   "--corner-00=0,0,0",
                                   "--corner-10=1,0,0",
                                   "--corner-01=0,1,0",
                                   "--corner-11=1,1,1",
                                   "--twists",
                                   "1,2,3;0,0,0;0,0,0;0,0,0"});
  ExpectNear(patch.JetAt(0, 0).duv, {1, 2, 3});
  ExpectRefused({"patch",
                 "--corner-00=0,0,0",
                 "--corner-10=1,0,0",
                 "--corner-01=0,1,0",
                 "--corner-11=1,1,1",
                 "--twists",
                 "1,2,3"},
                "four vectors");
  ExpectRefused({"gordon", "--u", u, "--v", File("v0.json") + ",," + File("v1.json")},
                "names no file");
  ExpectRefused({"gordon", "--u", u + ",", "--v", v}, "names no file");
}

// What would have no area is no surface.
TEST_F(MakeConstructionsTest, SurfacesWithoutAreaAreRefused) {
  const std::string line = Line("line.json", "0,0,0", "0,0,4");
  ExpectRefused({"extrude", line, "--by", "0,0,-2"}, "the surface would have no area");
  const std::string on = Line("on.json", "0,0,9", "0,0,5");
  for (const char* kind : {"ruled", "loft"}) ExpectRefused({kind, line, on}, "lies on one line");
  ExpectRefused(
      {"coons", line, Line("b.json", "0,0,4", "0,0,9"), on, Line("d.json", "0,0,5", "0,0,0")},
      "lies on one line");
  ExpectRefused(
      {"patch", "--corner-00=0,0,0", "--corner-10=1,1,1", "--corner-01=2,2,2", "--corner-11=3,3,3"},
      "lies on one line");
  ExpectRefused({"sweep", Line("along.json", "0,0,0", "0,0,1"), line}, "no area");
  ExpectRefused({"sweep", File("along.json"), line, "--translational"}, "no area");
  const std::string ring =
      Curve("ring.json", {"circle", "--radius", "1", "--axis", "1,0,0", "--center", "0,1,0"});
  ExpectRefused({"sweep", ring, line}, "the surface would lie on itself");
  // A slanted line in such a plane makes a piece of it.
  Made({"sweep", Line("slant.json", "0,0,0", "0,1,1"), line}, "the exact sweep is met");
}

TEST_F(MakeConstructionsTest, NotesStandInTheJsonToo) {
  const std::string path = Curve("p.json", {"arc", "--radius", "5"});
  const std::string section =
      Curve("s.json", {"circle", "--radius", "1", "--axis", "0,1,0", "--center", "5,0,0"});
  const ProgramRun run = Batten({"make", "sweep", section, path, "-o", File("x.step"), "--json"});
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(Json::parse(run.out)["files"][0]["notes"].size(), 1u);
  EXPECT_EQ(Batten({"make", "sweep", section, path, "-o", File("x.step"), "--quiet"}).err, "");
}

TEST_F(MakeConstructionsTest, OctantsAndUnevenScaling) {
  const NurbsSurface octant =
      Made({"sphere", "--radius", "10", "--latitudes", "0,90", "--sweep", "90"});
  ExpectNear(octant.At(0, 0), {10, 0, 0});
  ExpectNear(octant.At(1, 0), {0, 10, 0});
  ExpectNear(octant.At(0.7, 1), {0, 0, 10});
  const std::string circle = Circle("c.json", 2, 0);
  ASSERT_EQ(Batten({"edit", circle, "-o", File("e.json"), "scale:2,0.5,3"}).code, 0);
  const auto ellipse = std::get<NurbsCurve<3>>(ReadGeometry(File("e.json")).at(0));
  EXPECT_NEAR(std::get<EllipseShape>(ClassifyShape(ellipse)).major_radius, 4, kIterated);
  EXPECT_EQ(Batten({"edit", circle, "-o", File("f.json"), "scale:2,3"}).code, 2);
  EXPECT_EQ(Batten({"edit", circle, "-o", File("f.json"), "scale:2,0,3"}).code, 2);
}

}  // namespace batten::internal::make_constructions_test
