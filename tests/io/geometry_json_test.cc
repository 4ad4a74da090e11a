// SPDX-License-Identifier: MIT
#include "batten/io/geometry_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "random_geometry.h"
#include "temporary_folder.h"

namespace batten {
namespace {

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
  EXPECT_THROW(ToGeometryJson({}), std::invalid_argument);
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

TEST(GeometryJsonTest, ReadsUnclampedKnotsThatAreSaidToBePeriodic) {
  const std::string unclamped = Replaced(kCurve, "[0, 0, 0, 1, 1, 1]", "[-2, -1, 0, 1, 2, 3]");
  const std::string periodic = Replaced(unclamped, "\"degree\"", R"("periodic": [true], "degree")");
  EXPECT_TRUE(ParseGeometryJson(periodic, "x") == ParseGeometryJson(unclamped, "x"));
  EXPECT_THAT(Refusal(Replaced(kCurve, "\"degree\"", R"("periodic": true, "degree")")),
              HasSubstr("shape.data[0].periodic: periodic shapes with clamped knots are not in"));
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
       "shape.data[0].trims: trimmed surfaces are not in this version"},
      {"\"dimension\": 3",
       R"("trims": {"data": [{"type": "spline"}]}, "dimension": 3)",
       "shape.data[0].trims: trimmed surfaces are not in this version"},
      {"\"dimension\": 3",
       R"("periodic": [true, false], "dimension": 3)",
       "shape.data[0].periodic[0]: periodic shapes"},
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
  EXPECT_THROW(WriteGeometry(geometry, folder.File("a.brep")), UsageError);
  EXPECT_THROW(WriteGeometry(geometry, folder.File("a"), {.format = "xml"}), UsageError);
  try {
    WriteGeometry(geometry, folder.File("a.igs"));
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("IGES is not in this version"));
  }
  EXPECT_EQ(folder.Entries(), 2);
}

TEST(GeometryFileTest, RefusesFilesThatCanNotBeRead) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.File("folder.json"));
  EXPECT_THROW(ReadGeometry(folder.File("missing.json")), ReadError);
  EXPECT_THROW(ReadGeometry(folder.File("folder.json")), ReadError);
  EXPECT_THROW(ReadGeometry(folder.With("empty.json", "")), ReadError);
  EXPECT_THROW(ReadGeometry(folder.With("empty.step", "")), ReadError);
}

}  // namespace
}  // namespace batten
