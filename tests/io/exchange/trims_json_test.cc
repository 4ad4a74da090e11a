// SPDX-License-Identifier: MIT
// Trimmed surfaces in JSON.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Core>

#include <string>
#include <vector>

#include "batten/geometry/reverse.h"
#include "batten/io/geometry_json.h"
#include "batten/io/read_error.h"
#include "random_geometry.h"
#include "random_splines.h"
#include "random_trims.h"

namespace batten::internal::trims_json_test {

using ::testing::HasSubstr;

constexpr unsigned kSeed = 814;

NurbsSurface Read(const std::string& text) {
  return std::get<NurbsSurface>(ParseGeometryJson(text, "x.json").at(0));
}

std::string Refusal(const std::string& text) {
  try {
    ParseGeometryJson(text, "x.json");
  } catch (const ReadError& error) {
    return error.what();
  }
  return "(read)";
}

// The square [0,2] x [0,1] with these trims.
std::string Square(const std::string& trims) {
  return R"({"shape": {"type": "surface", "count": 1, "data": [{"type": "spline", "rational": true,
    "dimension": 3, "degree_u": 1, "degree_v": 1, "knotvector_u": [0, 0, 2, 2],
    "knotvector_v": [0, 0, 1, 1], "size_u": 2, "size_v": 2, "control_points": {"points":
    [[0, 0, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]]}, "trims": )" +
         trims + "}]}}";
}

std::string Line(const std::string& from, const std::string& to) {
  return R"({"type": "spline", "rational": false, "dimension": 2, "degree": 1, "knotvector":
    [0, 0, 1, 1], "control_points": {"points": [)" +
         from + ", " + to + R"(]}, "delta": 0.01, "reversed": 1})";
}

std::string One(const std::string& loop) { return R"({"count": 1, "data": [)" + loop + "]}"; }

std::string Polygon(const std::string& points) {
  return R"({"type": "freeform", "dimension": 2, "name": "", "points": [)" + points + "]}";
}

TEST(TrimsJsonTest, ReadsBackLoopsBitByBit) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  RandomTrims trims(kSeed);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const NurbsSurface surface = trims.Trimmed(
        random.Surface(random.Integer(1, 5), random.Integer(1, 5), i % 2, i % 3 == 0), i % 5);
    const std::string text = ToGeometryJson({surface});
    EXPECT_TRUE(Read(text) == surface);
    EXPECT_EQ(ToGeometryJson({Read(text)}), text);
  }
}

TEST(TrimsJsonTest, ReadsBackRegionsBitByBit) {
  RandomGeometry random(kSeed);
  RandomTrims trims(kSeed);
  for (int i = 0; i < 20; ++i) {
    const NurbsSurface surface = trims.OfThreeRegions(random.Surface(3, 2, i % 2, i % 3 == 0));
    const std::string text = ToGeometryJson({surface});
    EXPECT_TRUE(Read(text) == surface);
    EXPECT_EQ(ToGeometryJson({Read(text)}), text);
  }
}

TEST(TrimsJsonTest, ReadsBackLoopsOfPeriodicSurfacesBitByBit) {
  SCOPED_TRACE(kSeed);
  RandomSplines random(kSeed);
  RandomTrims trims(kSeed);
  for (int i = 0; i < 20; ++i) {
    const NurbsSurface surface =
        trims.Trimmed(random.Surface(3, 2, i % 2, {.periodic = true}, {.periodic = i % 4 > 1}), 4);
    EXPECT_TRUE(Read(ToGeometryJson({surface})) == surface);
  }
}

// A loop over a periodic basis closes by itself.
TEST(TrimsJsonTest, ReadsBackPeriodicLoops) {
  const NurbsSurface square = Read(Square(R"({"count": 0, "data": []})"));
  EXPECT_FALSE(square.trimmed());
  Eigen::Matrix2Xd points(2, 6);
  points << 0.5, 1.5, 1.5, 0.5, 0.5, 1.5, 0.2, 0.2, 0.8, 0.8, 0.2, 0.2;
  const SplineBasis round = SplineBasis::Periodic(2, {-2, -1, 0, 1, 2, 3, 4, 5, 6});
  const NurbsSurface trimmed = square.WithTrims({NurbsCurve<2>(round, points)});
  EXPECT_TRUE(Read(ToGeometryJson({trimmed})) == trimmed);
}

// A hole that cuts the domain's corner off has all its corners on the boundary, which holds it all
// the same.
TEST(TrimsJsonTest, HolesMayTouchTheBoundaryOfTheDomain) {
  const NurbsSurface square = Read(Square(R"({"count": 0, "data": []})"));
  const double u0 = square.basis_u().lower(), u1 = square.basis_u().upper();
  const double v0 = square.basis_v().lower(), v1 = square.basis_v().upper();
  Eigen::Matrix2Xd outer(2, 5), corner(2, 4), strip(2, 5);
  outer << u0, u1, u1, u0, u0, v0, v0, v1, v1, v0;
  corner << u0, u0, u1, u0, v0, v1, v1, v0;
  const double middle = (v0 + v1) / 2;
  strip << u0, u0, u1, u1, u0, middle, v1, v1, middle, middle;
  const NurbsCurve<2> boundary(SplineBasis::Uniform(1, 5, 0, 4), outer);
  for (const Eigen::Matrix2Xd& hole : {corner, strip}) {
    const auto n = static_cast<int>(hole.cols());
    const NurbsSurface trimmed =
        square.WithTrims({boundary, NurbsCurve<2>(SplineBasis::Uniform(1, n, 0, n - 1), hole)});
    const NurbsSurface read = Read(ToGeometryJson({trimmed}));
    EXPECT_EQ(read.trims().size(), 2u);
    EXPECT_TRUE(read == trimmed);
  }
}

// What the importer of NURBS-Python asks of a loop: its type, and what it asks of a curve.
TEST(TrimsJsonTest, WritesWhatNurbsPythonReads) {
  RandomGeometry random(kSeed);
  const std::string text =
      ToGeometryJson({RandomTrims(kSeed).Trimmed(random.Surface(3, 3, true, false), 2)});
  const size_t begin = text.find("\"trims\": {\"count\": 2, \"data\": [");
  ASSERT_NE(begin, std::string::npos);
  for (const char* name :
       {"\"type\": \"spline\"", "\"degree\": ", "\"knotvector\": ", "\"control_points\": "}) {
    EXPECT_THAT(text.substr(begin), HasSubstr(name));
  }
  // Its tessellator cuts the inside of a loop away, or, of a reversed one, the outside
  // (geomdl/_tessellate.py): the outer loop comes first and is reversed, the hole is not.
  const size_t outer = text.find("\"reversed\": 1"), hole = text.find("\"reversed\": 0");
  ASSERT_NE(outer, std::string::npos);
  ASSERT_NE(hole, std::string::npos);
  EXPECT_LT(outer, hole);
  EXPECT_EQ(text.find("\"reversed\"", hole + 1), std::string::npos);
}

TEST(TrimsJsonTest, ChainsContainersIntoOneLoopWhicheverWayTheirCurvesRun) {
  const std::string a = "[0.5, 0.25]", b = "[1.5, 0.25]", c = "[1, 0.75]";
  const auto container = [](const std::string& pieces) {
    return Square(One(R"({"type": "container", "count": 3, "data": [)" + pieces + "]}"));
  };
  Eigen::Matrix2Xd corners(2, 4);
  corners << 0.5, 1.5, 1, 0.5, 0.25, 0.25, 0.75, 0.25;
  for (const std::string& pieces : {Line(a, b) + "," + Line(b, c) + "," + Line(c, a),
                                    Line(a, b) + "," + Line(c, b) + "," + Line(c, a),
                                    Line(b, a) + "," + Line(b, c) + "," + Line(a, c)}) {
    const NurbsSurface surface = Read(container(pieces));
    ASSERT_EQ(surface.trims().size(), 1u);
    EXPECT_EQ(surface.trims()[0].basis().knots(), (std::vector<double>{0, 0, 1, 2, 3, 3}));
    EXPECT_EQ(surface.trims()[0].control_points(), corners);
  }
  const NurbsSurface mixed = Read(Square(One(R"({"type": "container", "data": [)" + Line(a, b) +
                                             "," + Polygon(b + "," + c + "," + a) + "]}")));
  EXPECT_EQ(mixed.trims()[0].control_points(), corners);
}

TEST(TrimsJsonTest, ReadsPolygons) {
  const NurbsSurface surface =
      Read(Square(One(Polygon("[0.5, 0.25], [1.5, 0.25], [1, 0.75], [0.5, 0.25]"))));
  ASSERT_EQ(surface.trims().size(), 1u);
  EXPECT_EQ(surface.trims()[0].control_points().col(2), Eigen::Vector2d(1, 0.75));
}

TEST(TrimsJsonTest, TurnsLoopsOuterFirstAndCounterClockwise) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  RandomTrims trims(kSeed);
  for (int i = 0; i < 20; ++i) {
    const NurbsSurface surface = trims.Trimmed(random.Surface(3, 2, true, false), 3);
    const auto& loops = surface.trims();
    const NurbsSurface turned = Read(
        ToGeometryJson({surface.WithTrims({Reversed(loops[1]), loops[0], Reversed(loops[2])})}));
    ASSERT_EQ(turned.trims().size(), 3u);
    EXPECT_TRUE(turned.trims()[0] == loops[0]);
    for (int k : {1, 2}) {
      const auto& loop = turned.trims()[static_cast<size_t>(k)];
      EXPECT_EQ(loop.control_points(), loops[static_cast<size_t>(k)].control_points());
    }
    const NurbsSurface first =
        Read(ToGeometryJson({surface.WithTrims({Reversed(loops[0]), loops[1]})}));
    EXPECT_EQ(first.trims()[0].control_points(), loops[0].control_points());
  }
}

// NURBS-Python cuts holes without a loop round all.
TEST(TrimsJsonTest, LoopsBesideOneAnotherAreHolesInTheWholeDomain) {
  const std::string left = Polygon("[0.2, 0.2], [0.8, 0.2], [0.5, 0.8], [0.2, 0.2]");
  const std::string right = Polygon("[1.2, 0.2], [1.8, 0.2], [1.5, 0.8], [1.2, 0.2]");
  const NurbsSurface surface =
      Read(Square(R"({"count": 2, "data": [)" + left + "," + right + "]}"));
  ASSERT_EQ(surface.trims().size(), 3u);
  Eigen::Matrix2Xd boundary(2, 5);
  boundary << 0, 2, 2, 0, 0, 0, 0, 1, 1, 0;
  EXPECT_EQ(surface.trims()[0].control_points(), boundary);
  EXPECT_EQ(surface.trims()[2].control_points().col(2), Eigen::Vector2d(1.8, 0.2));
  EXPECT_THAT(Refusal(Square(R"({"count": 2, "data": [)" + left + "," +
                             Polygon("[1.2, 0.2], [2.8, 0.2], [1.5, 0.8], [1.2, 0.2]") + "]}")),
              HasSubstr("trims.data[1]: reaches from u = 1.2 to 2.8"));
}

TEST(TrimsJsonTest, MovesEndsTogetherThatNearlyMeet) {
  const NurbsSurface surface =
      Read(Square(One(Polygon("[0.5, 0.25], [1.5, 0.25], [1, 0.75], [0.5000015, 0.2500005]"))));
  const auto& points = surface.trims()[0].control_points();
  EXPECT_EQ(points.col(0), points.col(3));
  EXPECT_EQ(points.col(0), Eigen::Vector2d(0.5, 0.25));
}

TEST(TrimsJsonTest, NamesTheFieldThatIsWrong) {
  const std::string triangle = Polygon("[0.5, 0.25], [1.5, 0.25], [1, 0.75], [0.5, 0.25]");
  const std::string place = "x.json: shape.data[0].trims";
  const struct {
    std::string trims, message;
  } cases[] = {
      {One(Polygon("[0.5, 0.25], [1.5, 0.25], [1, 0.75], [0.50001, 0.25]")),
       place + ".data[0]: does not close: its ends are "},
      {One(Polygon("[0.5, 0.25], [1.5, 0.25], [1, 0.75]")),
       place + ".data[0]: does not close: its ends are 0.5, 0.5 apart, more than 1e-06 of the dom"},
      {One(Polygon("[0.5, 0.25], [2.5, 0.25], [1, 0.75], [0.5, 0.25]")),
       place + ".data[0]: reaches from u = 0.5 to 2.5, outside the domain [0, 2]"},
      {One(Polygon("[0.5, -0.25], [1.5, 0.25], [1, 0.75], [0.5, -0.25]")),
       place + ".data[0]: reaches from v = -0.25 to 0.75, outside the domain [0, 1]"},
      {One(Polygon("[0.5, 1e151], [1.5, 0.25], [1, 0.75], [0.5, 1e151]")),
       place + ".data[0].points: point 0 has the coordinate 1e+151, above 1e150"},
      {One(Polygon("[0.5, 0.5], [1.5, 0.5], [0.5, 0.5]")), place + ".data[0]: encloses no area"},
      {One(Polygon("[0.5, 0.5]")), place + ".data[0].points: a curve needs two points"},
      {One(Polygon("")), place + ".data[0].points: "},
      {One(Polygon("[0.5, 0.5, 0], [1, 1, 1]")), place + ".data[0].points: points of 3 numbers"},
      {R"({"count": 2, "data": [)" + triangle + "]}", place + ".count: is not the number of entr"},
      {R"({"count": 1})", place + ".count: 1 is not an integer from 0 to 0"},
      {R"({"count": 1, "data": [{}]})", place + ".data[0].control_points: is missing"},
      {R"({"data": [{"type": "nurbs"}]})", place + ".data[0].type: \"nurbs\" is not a curve"},
      {R"({"data": 7})", place + ".data: a number instead of a list"},
      {R"({"data": ["round"]})", place + ".data[0]: a text instead of an object"},
      {"[]", place + ": a list of numbers instead of an object"},
      {One(R"({"type": "container", "count": 0, "data": []})"), place + ".data[0]: "},
      {One(R"({"type": "container", "data": [{"type": "container", "data": []}]})"),
       place + ".data[0].data[0].type: \"container\" is not a curve"},
      {One(R"({"type": "container", "count": 2, "data": [)" + Line("[0,0]", "[1,0]") + "," +
           Line("[1,0.5]", "[0.5,0.5]") + "]}"),
       place + ".data[0]: the end of curve 0 and the start of curve 1 are "},
      {One(Line("[0, 0]", "[1, 1]")), place + ".data[0]: does not close: its ends are 1, 1 apart"},
      {One(Line("[0, 0, 0]", "[1, 1, 1]")), place + ".data[0].control_points.points: points of 3"},
  };
  for (const auto& [trims, message] : cases) {
    EXPECT_THAT(Refusal(Square(trims)), HasSubstr(message)) << trims;
  }
}

}  // namespace batten::internal::trims_json_test
