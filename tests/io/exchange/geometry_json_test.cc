// SPDX-License-Identifier: MIT
#include "batten/io/geometry_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "random_geometry.h"
#include "random_splines.h"
#include "temporary_folder.h"

namespace batten::internal::geometry_json_test {

using ::testing::HasSubstr;

constexpr unsigned kSeed = 20240531;

// A valid surface of 3 × 2 control points in which a test puts one mistake.
const std::string kSurface = R"({"shape": {"type": "surface", "count": 1, "data": [
  {"type": "spline", "rational": false, "dimension": 3, "degree_u": 2, "degree_v": 1,
   "knotvector_u": [0, 0, 0, 1, 1, 1], "knotvector_v": [0.0, 0.0, 1.0, 1.0], "size_u": 3, "size_v": 2,
   "control_points": {"points": [[0, 0, 0], [0, 1, 0], [1, 0, 1], [1, 1, 1], [2, 0, 0], [2, 1, 0]],
                      "weights": [1, 1, 1, 1, 1, 1]}}]}})";

const std::string kCurve = R"({"shape": {"type": "curve", "count": 1, "data": [
  {"type": "spline", "rational": false, "dimension": 2, "degree": 2, "knotvector": [0, 0, 0, 1, 1, 1],
   "control_points": {"points": [[0, 0], [1, 1], [2, 0]]}}]}})";

std::string Replaced(std::string text, const std::string& old, const std::string& with) {
  const size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), with);
}

// What a text that must be refused is refused with.
std::string Refusal(const std::string& text) {
  try {
    ParseGeometryJson(text, "x.json");
  } catch (const ReadError& error) {
    EXPECT_THAT(error.what(), ::testing::StartsWith("x.json: "));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "must be one line";
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown for " << text.substr(0, 400);
  return "";
}

void ExpectRoundTrip(const std::vector<Geometry>& geometry) {
  const std::string text = ToGeometryJson(geometry);
  EXPECT_TRUE(ParseGeometryJson(text, "x.json") == geometry) << text;
  EXPECT_EQ(ToGeometryJson(ParseGeometryJson(text, "x.json")), text);
}

TEST(GeometryJsonTest, ReadsBackCurvesAndSurfacesBitByBit) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  for (int degree = 1; degree <= 7; ++degree) {
    for (const bool clamped : {true, false}) {
      for (const bool rational : {true, false}) {
        ExpectRoundTrip({random.Curve<2>(degree, clamped, rational)});
        ExpectRoundTrip({random.Curve<3>(degree, clamped, rational)});
        ExpectRoundTrip({random.Surface(degree, random.Integer(1, 7), clamped, rational)});
      }
    }
  }
}

TEST(GeometryJsonTest, ReadsBackExtremeNumbersBitByBit) {
  Eigen::Matrix3Xd points(3, 3);
  points << 0.1, -0.0, 1e150, 5e-324, 1e22, 123456789012345678.0, -1e-150, 5400000.1,
      9007199254740993.0;
  const NurbsCurve<3> curve(SplineBasis::Uniform(2, 3, 0, 1e-300), points);
  ExpectRoundTrip({curve});
  const auto back = std::get<NurbsCurve<3>>(ParseGeometryJson(ToGeometryJson({curve}), "x")[0]);
  EXPECT_TRUE(std::signbit(back.control_points()(0, 1)));
}

TEST(GeometryJsonTest, ReadsBackSeveralGeometriesOfDifferentKindsInOrder) {
  RandomGeometry random(kSeed);
  const std::vector<Geometry> mixed = {random.Curve<3>(3, true, true),
                                       random.Surface(2, 3, true, false),
                                       random.Curve<2>(2, true, false),
                                       random.Surface(1, 1, true, true)};
  ExpectRoundTrip(mixed);
  ExpectRoundTrip({mixed[0], mixed[2]});
  ExpectRoundTrip({mixed[1], mixed[3]});
  EXPECT_THAT(ToGeometryJson(mixed), HasSubstr(R"("type": "mixed", "count": 4)"));
  EXPECT_THROW(ToGeometryJson(std::vector<Geometry>{}), std::invalid_argument);
}

TEST(GeometryJsonTest, ReadsWhatTheExchangeFormAllows) {
  const auto surface = ParseGeometryJson(kSurface, "x.json");
  ASSERT_EQ(surface.size(), 1u);
  EXPECT_EQ(std::get<NurbsSurface>(surface[0]).control_point(1, 0), Eigen::Vector3d(1, 0, 1));

  const auto curve = ParseGeometryJson(kCurve, "x.json");
  EXPECT_EQ(std::get<NurbsCurve<2>>(curve[0]).weights(), Eigen::Vector3d::Ones());

  const auto same = [](const std::string& text) { return ParseGeometryJson(text, "x.json"); };
  EXPECT_TRUE(same(Replaced(kSurface, "\"rational\"", R"("delta": [0.05, 0.05], "id": null,
      "sample_size": [20, 20], "extra": {"a": [[], {}, [1, "x"], [[null]]]}, "rational")")) ==
              surface);
  EXPECT_TRUE(same(Replaced(kSurface, "\"rational\"", R"("periodic": [false, false],
      "trims": {"count": 0, "data": []}, "rational")")) == surface);
  std::string object = Replaced(kCurve, "[\n  {\"type\"", "{\"type\"");
  object = Replaced(object, "}}]}}", "}}}}");
  EXPECT_TRUE(same(object) == curve) << object;
  EXPECT_TRUE(same("\xEF\xBB\xBF" + kCurve) == curve);
}

TEST(GeometryJsonTest, ReadsBackPeriodicShapesBitByBit) {
  SCOPED_TRACE(kSeed);
  RandomSplines random(kSeed);
  const BasisKind open, round{.periodic = true};
  for (int degree = 1; degree <= 11; ++degree) {
    for (const bool rational : {true, false}) {
      ExpectRoundTrip({random.Curve<2>(degree, rational, round)});
      ExpectRoundTrip({random.Curve<3>(degree, rational, round)});
      const int other = random.Integer(1, 5);
      for (const BasisKind& kind_u : {open, round}) {
        for (const BasisKind& kind_v : {open, round}) {
          ExpectRoundTrip({random.Surface(degree, other, rational, kind_u, kind_v)});
        }
      }
    }
  }
}

// One period of the square (0,0) (1,0) (1,1) (0,1), rounded to a curve of degree 2.
const std::string kRound = R"({"shape": {"type": "curve", "count": 1, "data": [
  {"type": "spline", "dimension": 2, "degree": 2, "periodic": [true], "knotvector": [-2, -1, 0, 1, 2, 3, 4, 5, 6],
   "control_points": {"points": [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0], [1, 0]],
                      "weights": [1, 2, 1, 2, 1, 2]}}]}})";

TEST(GeometryJsonTest, SaysWhichDirectionsArePeriodicOnlyWhereOneIs) {
  const auto round = ParseGeometryJson(kRound, "x");
  EXPECT_TRUE(std::get<NurbsCurve<2>>(round[0]).basis().periodic());
  EXPECT_THAT(ToGeometryJson(round), HasSubstr(R"("dimension": 2, "periodic": [true],)"));
  const auto open = ParseGeometryJson(Replaced(kRound, "[true]", "[false]"), "x");
  EXPECT_FALSE(std::get<NurbsCurve<2>>(open[0]).basis().periodic());
  EXPECT_EQ(ToGeometryJson(open).find("periodic"), std::string::npos);
  EXPECT_TRUE(ParseGeometryJson(Replaced(kRound, "[true]", "true"), "x") == round);
}

TEST(GeometryJsonTest, PeriodicPointsRepeatedUpToDecimalRoundingAreMadeToRepeat) {
  const auto exact = ParseGeometryJson(kRound, "x");
  EXPECT_TRUE(ParseGeometryJson(Replaced(kRound, "[0, 0], [1, 0]],", "[3e-13, 0], [1, -5e-13]],"),
                                "x") == exact);
  EXPECT_TRUE(ParseGeometryJson(
                  Replaced(kRound, "1, 2]}}", "1.0000000000000002, 1.9999999999999996]}}"), "x") ==
              exact);
}

TEST(GeometryJsonTest, NamesTheFieldThatIsNotPeriodic) {
  const struct {
    std::string old, with, message;
  } cases[] = {
      {"[-2, -1, 0, 1, 2, 3, 4, 5, 6]",
       "[0, 0, 0, 1, 2, 3, 4, 4, 4]",
       "shape.data[0].periodic[0]: is true, but knotvector is clamped"},
      {"4, 5, 6]", "4, 5, 6.5]", "shape.data[0].knotvector: SplineBasis: knots 4 and 8 of a per"},
      {"[0, 0], [1, 0]],",
       "[0, 0], [1, 1e-9]],",
       "shape.data[0].control_points.points: point 5 must be point 1 again"},
      {"1, 2]}}", "1.1, 2]}}", "shape.data[0].control_points.weights: weight 4 must be weight 0"},
      {"[true]", "[true, true]", "shape.data[0].periodic: must be a list of 1 times true or false"},
      {"[true]", "[]", "shape.data[0].periodic: must be a list of 1 times true or false"},
      {"[true]", "[1]", "shape.data[0].periodic: must be a list of 1 times true or false"},
      {"[true]", "[\"yes\"]", "shape.data[0].periodic[0]: a text instead of true or false"},
      {"[true]", "{}", "shape.data[0].periodic: must be a list of 1 times true or false"},
  };
  for (const auto& [old, with, message] : cases) {
    EXPECT_THAT(Refusal(Replaced(kRound, old, with)), HasSubstr(message));
  }
}

TEST(GeometryJsonTest, JudgesEachDirectionOfAPeriodicSurface) {
  RandomSplines random(kSeed);
  const NurbsSurface torus = random.Surface(2, 3, true, {.periodic = true}, {.periodic = true});
  const int n = torus.size_u(), m = torus.size_v();
  const auto with = [&](Eigen::Index k) {
    Eigen::Matrix3Xd points = torus.control_points();
    points(1, k) += 1e-6;
    const NurbsSurface open(SplineBasis(2, torus.basis_u().knots()),
                            SplineBasis(3, torus.basis_v().knots()),
                            points,
                            torus.weights());
    return Replaced(
        ToGeometryJson({open}), "\"degree_u\"", "\"periodic\": [true, true], \"degree_u\"");
  };
  const auto name = [](Eigen::Index to, Eigen::Index from) {
    return "points: point " + std::to_string(to) + " must be point " + std::to_string(from);
  };
  EXPECT_THAT(Refusal(with(m - 1)), HasSubstr(name(m - 1, (m - 1) % (m - 3))));
  EXPECT_THAT(Refusal(with(Eigen::Index{n - 1} * m)),
              HasSubstr(name(Eigen::Index{n - 1} * m, Eigen::Index{(n - 1) % (n - 2)} * m)));
}

// What exchange.export_json of NURBS-Python 5 writes: names in this order, `delta`, weights only
// where the shape is of its rational class, trims only where there are some.
TEST(GeometryJsonTest, ReadsTheFormNurbsPythonWrites) {
  const auto surface = ParseGeometryJson(
      R"({"shape": {"type": "surface", "count": 1, "data": [{"type": "spline", "rational": true,
      "dimension": 3, "degree_u": 1, "degree_v": 2, "knotvector_u": [0.0, 0.0, 1.0, 1.0],
      "knotvector_v": [0.0, 0.0, 0.0, 1.0, 1.0, 1.0], "size_u": 2, "size_v": 3, "control_points":
      {"points": [[0.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 1.0],
      [1.0, 2.0, 0.0]], "weights": [1.0, 0.5, 1.0, 1.0, 0.5, 1.0]}, "delta": [0.05, 0.05],
      "reversed": 0}]}})",
      "x");
  EXPECT_EQ(std::get<NurbsSurface>(surface[0]).control_point(0, 1), Eigen::Vector3d(0, 1, 1));
  EXPECT_EQ(std::get<NurbsSurface>(surface[0]).weights()[1], 0.5);
  const auto curves = ParseGeometryJson(
      R"({"shape": {"type": "curve", "count": 2, "data": [{"type": "spline", "rational": false,
      "dimension": 2, "degree": 1, "knotvector": [0.0, 0.0, 1.0, 1.0], "control_points": {"points":
      [[5.0, 5.0], [10.0, 10.0]]}, "delta": 0.01}, {"type": "spline", "rational": false,
      "dimension": 3, "degree": 1, "knotvector": [0.0, 0.0, 1.0, 1.0], "control_points": {"points":
      [[5.0, 5.0, 1.0], [10.0, 10.0, 1.0]]}, "delta": 0.01, "id": 7, "name": "edge"}]}})",
      "x");
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<NurbsCurve<2>>(curves[0]));
  EXPECT_TRUE(std::holds_alternative<NurbsCurve<3>>(curves[1]));
}

// What its importer asks of an entry: these names, points of plain lists, a weight a point.
TEST(GeometryJsonTest, WritesWhatNurbsPythonReads) {
  RandomSplines random(kSeed);
  const auto entry = [](const Geometry& one) {
    return nlohmann::json::parse(ToGeometryJson({one}))["shape"]["data"][0];
  };
  for (const BasisKind& kind : {BasisKind{}, BasisKind{.periodic = true}}) {
    const auto curve = entry(random.Curve<3>(3, false, kind));
    for (const char* name : {"degree", "knotvector", "control_points", "type", "dimension"}) {
      EXPECT_TRUE(curve.contains(name)) << name;
    }
    const size_t count = curve["control_points"]["points"].size();
    EXPECT_EQ(curve["control_points"]["weights"].size(), count);
    EXPECT_EQ(curve["knotvector"].size(), count + 3 + 1);
    const auto surface = entry(random.Surface(2, 3, true, kind));
    for (const char* name :
         {"degree_u", "degree_v", "knotvector_u", "knotvector_v", "size_u", "size_v", "type"}) {
      EXPECT_TRUE(surface.contains(name)) << name;
    }
    const size_t net = surface["size_u"].get<size_t>() * surface["size_v"].get<size_t>();
    EXPECT_EQ(surface["control_points"]["points"].size(), net);
    EXPECT_EQ(surface["control_points"]["weights"].size(), net);
    EXPECT_FALSE(surface.contains("trims"));
  }
}

TEST(GeometryJsonTest, NamesTheFieldThatIsWrong) {
  const struct {
    std::string old, with, message;
  } cases[] = {
      {"[0, 0, 0, 1, 1, 1]",
       "[0, 0, 0, 1, 1]",
       "shape.data[0].knotvector_u: 5 knots, but size_u 3 + degree_u 2 + 1 = 6 are needed"},
      {"[0, 0, 0, 1, 1, 1]", "[0, 0, 0, 1, 0.5, 1]", "shape.data[0].knotvector_u: SplineBasis: "},
      {"[0, 0, 0, 1, 1, 1]", "[0, 0, 0, 0, 0, 0]", "shape.data[0].knotvector_u: SplineBasis: "},
      {"[0, 0, 0, 1, 1, 1]", "[0, 0, 0, 1, 1, 1e200]", "shape.data[0].knotvector_u: knot 5 is"},
      {"[0, 0, 0, 1, 1, 1]", "7", "shape.data[0].knotvector_u: a number instead of a list of num"},
      {"[0, 0, 0, 1, 1, 1]",
       "[0, 0, 0, 1, 1, null]",
       "shape.data[0].knotvector_u[5]: null among numbers"},
      {"[0, 0, 0, 1, 1, 1]",
       "[0, 0, 0, 1, 1, \"1\"]",
       "shape.data[0].knotvector_u[5]: a text among numbers"},
      {"\"degree_u\": 2", "\"degree_u\": 2.5", "shape.data[0].degree_u: 2.5 is not an integer"},
      {"\"degree_u\": 2", "\"degree_u\": 99", "shape.data[0].degree_u: 99 is not an integer"},
      {"\"degree_u\": 2", "\"degree_u\": \"2\"", "shape.data[0].degree_u: a text instead of"},
      {"\"degree_u\": 2, ", "", "shape.data[0].degree_u: is missing"},
      {"\"size_u\": 3", "\"size_u\": 1000000000", "shape.data[0].knotvector_u: 6 knots"},
      {"\"size_u\": 3", "\"size_u\": 1e300", "shape.data[0].size_u: 1e+300 is not an integer"},
      {"\"size_u\": 3, ", "", "shape.data[0].size_u: is missing"},
      {", [2, 1, 0]]", "]", "shape.data[0].control_points.points: 5 points, but"},
      {"[2, 1, 0]]",
       "[2, 1]]",
       "shape.data[0].control_points.points[5]: 2 numbers, but 3 in the rows before"},
      {"[2, 1, 0]]", "7]", "shape.data[0].control_points.points[5]: a number among lists"},
      {"[2, 1, 0]]",
       "[2, 1e151, 0]]",
       "shape.data[0].control_points.points: point 5 has the coordinate 1e+151"},
      {"[2, 1, 0]]", "[2, null, 0]]", "shape.data[0].control_points.points[5][1]: null among"},
      {"\"dimension\": 3", "\"dimension\": 2", "shape.data[0].dimension: 2 is not an integer"},
      {"[1, 1, 1, 1, 1, 1]}", "[1, 1, 1, 1, 1]}", "control_points.weights: 5 weights, but 6"},
      {"[1, 1, 1, 1, 1, 1]}", "[1, 1, 1, 0, 1, 1]}", "control_points.weights: weight 3 is 0;"},
      {"[1, 1, 1, 1, 1, 1]}", "[1, 1, 1, 1, -1, 1]}", "control_points.weights: weight 4 is -1;"},
      {"\"type\": \"surface\"", "\"type\": \"volume\"", "shape.type: \"volume\" is not known"},
      {"\"type\": \"surface\"", "\"type\": 3", "shape.type: a number instead of a text"},
      {"\"type\": \"spline\"", "\"type\": \"nurbs\"", "shape.data[0].type: \"nurbs\" is not known"},
      {"\"count\": 1", "\"count\": 2", "shape.count: is not the number of entries in data, 1"},
      {"\"shape\"", "\"shapes\"", "shape: is missing"},
      {"\"dimension\": 3", "\"dimension\": 3, \"dimension\": 3", "given twice"},
      {"\"dimension\": 3",
       R"("trims": {"count": 1, "data": [{}]}, "dimension": 3)",
       "shape.data[0].trims.data[0].control_points: is missing"},
      {"\"dimension\": 3",
       R"("trims": {"data": [{"type": "spline"}]}, "dimension": 3)",
       "shape.data[0].trims.data[0].control_points: is missing"},
      {"\"dimension\": 3",
       R"("periodic": [true, false], "dimension": 3)",
       "shape.data[0].periodic[0]: is true, but knotvector_u is clamped"},
  };
  for (const auto& [old, with, message] : cases) {
    EXPECT_THAT(Refusal(Replaced(kSurface, old, with)), HasSubstr(message));
  }
}

TEST(GeometryJsonTest, NamesTheFieldThatIsWrongInCurves) {
  EXPECT_THAT(Refusal(Replaced(kCurve, ", [2, 0]]", "]")),
              HasSubstr("shape.data[0].knotvector: 6 knots, but the number of control points 2"));
  EXPECT_THAT(Refusal(Replaced(kCurve, "\"dimension\": 2", "\"dimension\": 4")),
              HasSubstr("shape.data[0].dimension: 4 is not an integer from 2 to 3"));
  EXPECT_THAT(Refusal(Replaced(kCurve, "\"dimension\": 2", "\"dimension\": 3")),
              HasSubstr("points of 2 numbers, but the dimension is 3"));
  EXPECT_THAT(Refusal(Replaced(kCurve, "\"type\": \"curve\"", "\"type\": \"surface\"")),
              HasSubstr("shape.data[0]."));
}

TEST(GeometryJsonTest, NamesTheLineWhereTheSyntaxBreaks) {
  EXPECT_THAT(Refusal("{\n\"shape\":\n  nonsense}"), HasSubstr("line 3: not JSON at"));
  EXPECT_THAT(Refusal(kSurface.substr(0, 300)), HasSubstr("line 4: the text ends too early"));
  EXPECT_THAT(Refusal(Replaced(kSurface, "[2, 1, 0]", "[2, NaN, 0]")), HasSubstr("line 4: "));
  EXPECT_THAT(Refusal(Replaced(kSurface, "[2, 1, 0]", "[2, 1e999, 0]")),
              HasSubstr("line 4: 1e999 is out of the range of a double"));
  EXPECT_THAT(Refusal(kSurface + "x"), HasSubstr("line 5: "));
}

TEST(GeometryJsonTest, NamesTheFieldThatHoldsNoFiniteNumber) {
  for (const char* word : {"NaN", "Infinity", "-Infinity"}) {
    const std::string said = std::string(word) + " is not a finite number (in ";
    EXPECT_THAT(Refusal(Replaced(kSurface, "[2, 1, 0]", "[2, " + std::string(word) + ", 0]")),
                HasSubstr(said + "shape.data[0].control_points.points[5][1])"));
    EXPECT_THAT(Refusal(Replaced(kSurface, "[0, 0, 0, 1", "[0, 0, " + std::string(word) + ", 1")),
                HasSubstr(said + "shape.data[0].knotvector_u[2])"));
    EXPECT_THAT(Refusal(Replaced(kSurface, "1, 1]}", "1, " + std::string(word) + "]}")),
                HasSubstr(said + "shape.data[0].control_points.weights[5])"));
  }
  EXPECT_THAT(Refusal(Replaced(kSurface, "[2, 1, 0]", "[2, 1e999, 0]")),
              HasSubstr("(in shape.data[0].control_points.points[5][1])"));
}

TEST(GeometryJsonTest, RefusesTextsWithoutGeometry) {
  EXPECT_THAT(Refusal(""), HasSubstr("is empty"));
  EXPECT_THAT(Refusal(" \n"), HasSubstr("is empty"));
  EXPECT_THAT(Refusal("7"), HasSubstr("a number instead of an object"));
  EXPECT_THAT(Refusal("[1, 2]"), HasSubstr("a list of numbers instead of an object"));
  EXPECT_THAT(Refusal("{}"), HasSubstr("shape: is missing"));
  EXPECT_THAT(Refusal(R"({"shape": {"type": "curve", "data": []}})"),
              HasSubstr("shape.data: holds no geometry"));
  EXPECT_THAT(Refusal(std::string("\0\xFF\x80 binary", 10)), HasSubstr("line 1: not JSON"));
}

TEST(GeometryJsonTest, SurvivesNestingBombs) {
  EXPECT_THAT(Refusal(std::string(1'000'000, '[')), HasSubstr("nested deeper than 64 levels"));
  EXPECT_THAT(Refusal("{\"unknown\": " + std::string(1'000'000, '[')), HasSubstr("64 levels"));
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"data\":";
  EXPECT_THAT(Refusal(objects), HasSubstr("64 levels"));
}

TEST(GeometryJsonTest, TakesNoMemoryForHugeListsOfNothing) {
  std::string bomb = R"({"shape": {"type": "curve", "data": [{})";
  for (int i = 0; i < 3'000'000; ++i) bomb += ",{}";
  EXPECT_THAT(Refusal(bomb + "]}}"), HasSubstr("more than 1000000 values"));
}

TEST(GeometryFileTest, ChoosesTheFormatByExtensionOrByName) {
  const TemporaryFolder folder;
  RandomGeometry random(kSeed);
  const std::vector<Geometry> geometry = {random.Surface(3, 2, true, true)};
  WriteGeometry(geometry, folder.File("a.JSON"));
  EXPECT_TRUE(ReadGeometry(folder.File("a.JSON")) == geometry);
  WriteGeometry(geometry, folder.File("a.txt"), {.format = "json"});
  EXPECT_TRUE(ReadGeometry(folder.File("a.txt"), {.format = "json"}) == geometry);
  EXPECT_THROW(ReadGeometry(folder.File("a.txt")), UsageError);
  EXPECT_THROW(ReadGeometry("-"), UsageError);
  EXPECT_THROW(WriteGeometry(geometry, folder.File("a.g2")), UsageError);
  EXPECT_THROW(WriteGeometry(geometry, folder.File("a"), {.format = "xml"}), UsageError);
  try {
    WriteGeometry(geometry, folder.File("a.3dm"));
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("use .json, .step, .iges or .brep"));
  }
  EXPECT_EQ(folder.Entries(), 2);
}

TEST(GeometryFileTest, WritesSeveralFilesAllOrNone) {
  const TemporaryFolder folder;
  RandomGeometry random(kSeed);
  std::vector<GeometryFile> files;
  for (const char* name : {"a-1.json", "a-2.json", "a-3.json"}) {
    files.push_back({folder.File(name), {random.Surface(3, 2, true, true)}});
  }
  WriteGeometryFiles(files);
  EXPECT_EQ(folder.Entries(), 3);
  for (const GeometryFile& file : files) {
    EXPECT_TRUE(ReadGeometry(file.path) == file.geometry);
    EXPECT_EQ(std::filesystem::status(file.path).permissions(),
              std::filesystem::status(folder.With("plain", "")).permissions());
  }

  const TemporaryFolder other;
  const std::string old = other.With("b-1.json", "old");
  std::filesystem::create_directory(other.File("b-3.json"));
  for (int k = 0; k < 3; ++k) files[k].path = other.File("b-" + std::to_string(k + 1) + ".json");
  try {
    WriteGeometryFiles(files);
    FAIL() << "nothing was thrown";
  } catch (const WriteError& error) {
    EXPECT_THAT(error.what(), HasSubstr("b-3.json"));
  }
  EXPECT_EQ(other.Text("b-1.json"), "old");
  EXPECT_EQ(other.Entries(), 2);

  // The second can't become STEP: every edge of it is a point.
  const SplineBasis line = SplineBasis::Uniform(1, 2, 0, 1);
  files = {{other.File("c-1.step"), {random.Surface(2, 2, true, false)}},
           {other.File("c-2.step"), {NurbsSurface(line, line, Eigen::Matrix3Xd::Zero(3, 4))}}};
  try {
    WriteGeometryFiles(files);
    FAIL() << "nothing was thrown";
  } catch (const WriteError& error) {
    EXPECT_THAT(error.what(),
                ::testing::StartsWith(other.File("c-2.step") + ": can't become STEP"));
  }
  files[1].geometry.insert(files[1].geometry.begin(), files[0].geometry.front());
  try {
    WriteGeometryFiles(files);
    FAIL() << "nothing was thrown";
  } catch (const WriteError& error) {
    EXPECT_THAT(error.what(), HasSubstr("number 2 of 2"));
  }
  EXPECT_EQ(other.Entries(), 2);
}

TEST(GeometryFileTest, RefusesFilesThatCanNotBeRead) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.File("folder.json"));
  EXPECT_THROW(ReadGeometry(folder.File("missing.json")), ReadError);
  EXPECT_THROW(ReadGeometry(folder.File("folder.json")), ReadError);
  EXPECT_THROW(ReadGeometry(folder.With("empty.json", "")), ReadError);
  EXPECT_THROW(ReadGeometry(folder.With("empty.step", "")), ReadError);
}

}  // namespace batten::internal::geometry_json_test
