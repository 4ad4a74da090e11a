// SPDX-License-Identifier: MIT
#include "io/exchange/brep_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <utility>

#include "batten/io/read_error.h"

namespace batten::internal::brep_text_test {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// An edge on a spline from (0, 0, 0) to (1, 0, 0), with triangles and polygons nobody needs.
const std::string kEdge = R"(DBRep_DrawableShape

CASCADE Topology V2, (c) Matra-Datavision
Locations 2
1
1 0 0 5
0 1 0 0
0 0 1 0
2  1 2 0
Curve2ds 0
Curves 2
7 1 0  1 2 2 0 0 0 1 1 0 0 1
 0 2 1 2
8 0 0.5 1 0 0 0 1 0 0
Polygon3D 1
2 1
0.1
0 0 0 1 0 0
0 1
PolygonOnTriangulations 0
Surfaces 0
Triangulations 0

TShapes 3
Ve
1e-07
0 0 0
0 0

0101101
*
Ve
1e-07
1 0 0
0 0

0101101
*
Ed
 1e-07 1 1 0
1  1 0 0 1
5  1 0
0

0101000
+3 0 -2 0 *

+1 2 
)";

std::string Replaced(std::string text, const std::string& what, const std::string& with) {
  const size_t at = text.find(what);
  EXPECT_NE(at, text.npos) << what;
  return text.replace(at, what.size(), with);
}

std::string Refusal(const std::string& text) {
  try {
    CheckedBrep(text, "part.brep");
  } catch (const ReadError& error) {
    return error.what();
  }
  return "";
}

TEST(BrepTextTest, LeavesOutWhatIsNoGeometry) {
  const std::string checked = CheckedBrep(kEdge, "part.brep");
  EXPECT_THAT(checked, StartsWith("CASCADE Topology V1, (c) Matra-Datavision\nLocations 2"));
  EXPECT_THAT(checked, HasSubstr("Polygon3D 0"));
  EXPECT_THAT(checked, Not(HasSubstr("\n5 ")));
  EXPECT_EQ(CheckedBrep(checked, "again.brep"), checked);
}

TEST(BrepTextTest, EveryCutIsRefused) {
  const size_t begin = kEdge.find("Locations"), end = kEdge.rfind("+1");
  for (size_t length = 0; length < end; ++length) {
    EXPECT_NE(Refusal(kEdge.substr(0, length)), "") << length;
  }
  EXPECT_THAT(Refusal(kEdge.substr(0, begin)), HasSubstr("the file ends where Locations should"));
}

TEST(BrepTextTest, NamesFileLineAndRule) {
  const std::pair<std::pair<const char*, const char*>, const char*> cases[] = {
      {{" 0 2 1 2", " 1 2 1 2"}, "part.brep: line 13: knots must increase"},
      {{"7 1 0  1 2 2", "7 1 0  1 3 2"}, "line 14: a knot's multiplicity must be"},
      {{" 0 2 1 2", " 0 1 1 2"}, "there are 2 control points where the knots want 1"},
      {{"0 0 0 1 1 0 0 1", "0 0 0 0 1 0 0 1"}, "line 12: a weight must be positive"},
      {{"0 0 0 1 1 0 0 1", "0 0 nan 1 1 0 0 1"}, "'nan' is no number, which a coordinate must be"},
      {{"0 0 0 1 1 0 0 1", "0 0 1e200 1 1 0 0 1"}, "above 1e150"},
      {{"7 1 0  1 2", "7 1 0  26 2"}, "a degree must be a whole number from 1 to 25, not '26'"},
      {{"7 1 0  1 2 2 0 0 0 1 1 0 0 1\n 0 2 1 2", "7 0 1  2 2 2 0 0 0 1 0 0\n 0 2 1 1"},
       "the end knots of a periodic direction must be alike"},
      {{"8 0 0.5 1", "8 0.5 0.5 1"}, "trimmed to nothing"},
      {{"8 0 0.5 1 0 0 0 1 0 0", "8 0 2 6 0 1 0 0 0 1 0 0"}, "trimmed outside its domain"},
      {{"8 0 0.5 1 0 0 0 1 0 0", "8 0 1e9 2 0 0 0 0 0 1 1 0 0 0 1 0 1"}, "a million periods"},
      {{"8 0 0.5 1", "8 0 1 8 0 1 8 0 1 8 0 1 8 0 1 8 0 1 8 0 1 8 0 1 8 0 1 1"}, "more than 8 times"},
      {{"8 0 0.5 1 0 0 0 1 0 0", "2 0 0 0 0 0 1 0 0 2 0 1 0 1"}, "two axes are parallel"},
      {{"8 0 0.5 1 0 0 0 1 0 0", "2 0 0 0 0 0 1 1 0 0 0 1 0 -1"}, "must not be negative"},
      {{"8 0 0.5 1 0 0 0 1 0 0", "3 0 0 0 0 0 1 1 0 0 0 1 0 1 2"}, "the minor radius is above"},
      {{"Surfaces 0", "Surfaces 1\n5 0 0 0 0 0 1 1 0 0 0 1 0 3 0"}, "tube of a torus"},
      {{"Surfaces 0", "Surfaces 1\n3 0 0 0 0 0 1 1 0 0 0 1 0 3 0"}, "the angle of a cone"},
      {{"Surfaces 0", "Surfaces 1\n10 0 1 0 9 4 0 0 0 0 0 1 1 0 0 0 1 0 3"},
       "trimmed outside its domain"},
      {{"2\n1\n1 0 0 5\n0 1 0 0\n0 0 1 0\n2  1 2 0",
        "5\n1\n1 0 0 5\n0 1 0 0\n0 0 1 0\n2 1 16 0 2 2 16 0 2 3 16 0 2 4 2 0"},
       "a product of more than 4096"},
      {{"0 0 0 1 0 0\nPoly", "0 0 0 0 0 0\nPoly"}, "a direction has no length"},
      {{"2  1 2 0", "2  2 2 0"}, "a placement must be a whole number from 0 to 1, not '2'"},
      {{"2  1 2 0", "2  1 2000 0"}, "a power must be"},
      {{"1  1 0 0 1", "1  3 0 0 1"}, "a curve must be a whole number from 1 to 2, not '3'"},
      {{"+3 0 -2 0 *", "+3 0 -1 0 *"}, "'-1' is no shape that stands before"},
      {{"+3 0 -2 0 *", "+3 0 -9 0 *"}, "'-9' is no shape that stands before"},
      {{"0101000", "01010"}, "the seven flags"},
      {{"TShapes 3", "TShapes 2000000"}, ""},
      {{"Curves 2", "Curves 99999999999"}, "a number of entries"},
      {{"Polygon3D 1\n2", "Polygon3D 1\n90000000"}, ""},
      {{"Ed\n", "Xx\n"}, "'Xx' is no kind of shape"},
      {{"Topology V2", "Topology V7"}, "none of 1 to 3"},
      {{"CASCADE Topology", "Topology of CASCADE"}, "does not begin with CASCADE Topology"},
      {{"DBRep_DrawableShape", "Open CASCADE Topology V4"}, "binary"},
  };
  for (const auto& [change, reason] : cases) {
    const std::string refusal = Refusal(Replaced(kEdge, change.first, change.second));
    EXPECT_THAT(refusal, AllOf(HasSubstr("part.brep: "), HasSubstr(reason)));
  }
}

// Shapes of a few bytes that stand in 2^40 places, and one inside another ten thousand times.
TEST(BrepTextTest, RefusesWhatNoReaderCanVisit) {
  const std::string head =
      "CASCADE Topology V1, (c) Matra-Datavision\nLocations 0\nCurve2ds 0\nCurves 0\nPolygon3D 0\n"
      "PolygonOnTriangulations 0\nSurfaces 0\nTriangulations 0\nTShapes ";
  const auto nested = [&](int count, bool twice) {
    std::ostringstream text;
    text << head << count << "\nCo\n\n1100000\n*\n";
    for (int i = 1; i < count; ++i) {
      text << "Co\n\n1100000\n";
      for (int k = 0; k < (twice ? 2 : 1); ++k) text << '+' << count - i + 1 << " 0 ";
      text << "*\n";
    }
    text << "+1 0\n";
    return text.str();
  };
  EXPECT_THAT(Refusal(nested(40, true)), HasSubstr("more places than a reader can visit"));
  EXPECT_THAT(Refusal(nested(10000, false)), HasSubstr("more than 256 deep"));
  EXPECT_EQ(Refusal(nested(100, false)), "");
}

}  // namespace batten::internal::brep_text_test
