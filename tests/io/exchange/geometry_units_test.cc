// SPDX-License-Identifier: MIT
// Units of geometry files: what they declare, what is turned into what, what is said of odd ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "batten/io/geometry_file.h"
#include "batten/io/length_unit.h"
#include "batten/io/read_error.h"
#include "random_geometry.h"
#include "temporary_folder.h"

namespace batten::internal::geometry_units_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr unsigned kSeed = 5120;
// One rounding for the scale and one for the file's digits, of numbers near the largest.
constexpr double kRelative = 1e-15;

const NurbsSurface& Surface(const GeometryContents& contents) {
  return std::get<NurbsSurface>(contents.geometry.at(0));
}

std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  const size_t at = text.find(what);
  EXPECT_NE(at, text.npos) << what;
  return at == text.npos ? text : text.replace(at, what.size(), by);
}

class GeometryUnitsTest : public testing::Test {
 protected:
  // A file in that unit.
  std::string File(const std::string& extension, const std::string& unit) {
    const std::string path = folder_.File("part-" + unit + extension);
    WriteGeometry({surface_}, path, {.unit = unit});
    return path;
  }

  TemporaryFolder folder_;
  RandomGeometry random_{kSeed};
  NurbsSurface surface_ = random_.Surface(3, 2, true, true);
};

TEST_F(GeometryUnitsTest, AFileKeepsItsNumbersAndSaysItsUnit) {
  for (const std::string extension : {".step", ".igs"}) {
    for (const LengthUnit& unit : LengthUnits()) {
      SCOPED_TRACE(extension + " " + unit.name);
      const GeometryContents contents = ReadGeometryContents(File(extension, unit.name));
      EXPECT_EQ(contents.unit, LengthUnitName(unit.millimetres));
      EXPECT_THAT(contents.remarks, IsEmpty());
      EXPECT_TRUE(Surface(contents).control_points().isApprox(surface_.control_points(), 1e-14));
    }
  }
}

TEST_F(GeometryUnitsTest, AskedForAnotherUnitLengthsAreTurnedIntoIt) {
  const std::pair<const char*, double> units[] = {
      {"mm", 1}, {"m", 1000}, {"inch", 25.4}, {"ft", 304.8}, {"um", 1e-3}, {"km", 1e6}};
  for (const std::string extension : {".step", ".igs"}) {
    for (const auto& [from, from_mm] : units) {
      const std::string path = File(extension, from);
      for (const auto& [to, to_mm] : units) {
        SCOPED_TRACE(extension + " " + from + " to " + to);
        const GeometryContents contents = ReadGeometryContents(path, {.unit = to});
        EXPECT_EQ(contents.unit, to);
        const Eigen::Matrix3Xd expected = surface_.control_points() * (from_mm / to_mm);
        EXPECT_LE((Surface(contents).control_points() - expected).cwiseAbs().maxCoeff(),
                  10 * kRelative * expected.cwiseAbs().maxCoeff());
        EXPECT_TRUE(Surface(contents).weights().isApprox(surface_.weights(), 1e-14));
        EXPECT_EQ(Surface(contents).basis_u(), surface_.basis_u());
      }
    }
  }
}

TEST_F(GeometryUnitsTest, TrimLoopsAreParametersAndStayAsTheyAre) {
  Eigen::Matrix2Xd corners(2, 5);
  const double u0 = surface_.basis_u().lower(), u1 = surface_.basis_u().upper();
  const double v0 = surface_.basis_v().lower(), v1 = surface_.basis_v().upper();
  const double a = 0.75 * u0 + 0.25 * u1, b = 0.25 * u0 + 0.75 * u1;
  const double c = 0.75 * v0 + 0.25 * v1, d = 0.25 * v0 + 0.75 * v1;
  corners << a, b, b, a, a, c, c, d, d, c;
  surface_ = surface_.WithTrims({NurbsCurve<2>(SplineBasis::Uniform(1, 5, 0, 4), corners)});
  const GeometryContents in_mm = ReadGeometryContents(File(".igs", "m"), {.unit = "mm"});
  EXPECT_EQ(Surface(in_mm).trims(), surface_.trims());
}

TEST_F(GeometryUnitsTest, JsonSaysTheUnitWhereItIsNotMillimetres) {
  EXPECT_EQ(ReadGeometryContents(File(".json", "mm")).unit, "");
  const GeometryContents metres = ReadGeometryContents(File(".json", "m"), {.unit = "mm"});
  EXPECT_EQ(metres.unit, "mm");
  EXPECT_TRUE(Surface(metres).control_points() == 1000 * surface_.control_points());
  // What says no unit is in the one asked for.
  const GeometryContents silent = ReadGeometryContents(File(".json", "mm"), {.unit = "ft"});
  EXPECT_EQ(silent.unit, "ft");
  EXPECT_TRUE(Surface(silent).control_points() == surface_.control_points());
}

TEST_F(GeometryUnitsTest, UnknownUnitsAreRefusedBeforeAnythingIsRead) {
  EXPECT_THROW(ReadGeometryContents("/nowhere/a.step", {.unit = "furlong"}), UsageError);
  const std::string bad = folder_.With(
      "a.json", R"({"shape": {"type": "curve", "unit": "furlong", "count": 0, "data": []}})");
  try {
    ReadGeometryContents(bad);
    FAIL();
  } catch (const ReadError& error) {
    EXPECT_THAT(error.what(), HasSubstr("shape.unit: unit \"furlong\" is not one of mm, cm, m"));
  }
}

TEST_F(GeometryUnitsTest, StepWithoutAUnitSaysSo) {
  File(".step", "mm");
  std::string text = folder_.Text("part-mm.step");
  // The context names the three units; without the length the model has none.
  const size_t begin = text.find("GLOBAL_UNIT_ASSIGNED_CONTEXT");
  ASSERT_NE(begin, text.npos);
  const size_t first = text.find('#', begin), comma = text.find(',', first);
  text.erase(first, comma + 1 - first);
  const GeometryContents contents = ReadGeometryContents(folder_.With("none.step", text));
  EXPECT_EQ(contents.unit, "");
  EXPECT_THAT(contents.remarks, ElementsAre("it declares no unit of length"));
  EXPECT_TRUE(Surface(contents).control_points().isApprox(surface_.control_points(), 1e-14));
}

TEST_F(GeometryUnitsTest, IgesWithoutAUnitIsInInchesAndSaysSo) {
  File(".igs", "mm");
  const std::string good = folder_.Text("part-mm.igs");
  // Its header ends a line between the flag and the name.
  const auto read = [&](const std::string& flag, const std::string& name) {
    return ReadGeometryContents(folder_.With(
        "odd.igs",
        Replaced(good, ",2,G0000001\n2HMM,", "," + flag + ",G0000001\n2H" + name + ",")));
  };
  const GeometryContents none = read(" ", "??");
  EXPECT_EQ(none.unit, "inch");
  EXPECT_THAT(none.remarks, ElementsAre(HasSubstr("no unit of length that is known: inches")));
  const GeometryContents torn = read("2", "IN");
  EXPECT_EQ(torn.unit, "mm");
  EXPECT_THAT(torn.remarks,
              ElementsAre("its unit is mm by its flag and inch by its name: the flag counts"));
  const GeometryContents named = read("3", "FT");
  EXPECT_EQ(named.unit, "ft");
  EXPECT_THAT(named.remarks, IsEmpty());
}

// A line in a file of one context in millimetres and one in inches, as merged files have them.
TEST_F(GeometryUnitsTest, PartsOfAStepFileInAnotherUnitAreTurnedIntoTheFirst) {
  const auto line = NurbsCurve<3>(SplineBasis(2, {0, 0, 0, 1, 1, 1}),
                                  Eigen::Matrix3d{{0, 1, 2}, {0, 1, 0}, {0, 0, 1}});
  const std::string path = folder_.File("two.step");
  WriteGeometry({line, line}, path, {.unit = "mm"});
  std::string text = folder_.Text("two.step");
  const size_t second = text.rfind("SI_UNIT(.MILLI.,.METRE.)");
  ASSERT_NE(text.find("SI_UNIT(.MILLI.,.METRE.)"), second);
  text.replace(second, 24, "SI_UNIT(.CENTI.,.METRE.)");
  const GeometryContents contents = ReadGeometryContents(folder_.With("torn.step", text));
  EXPECT_EQ(contents.unit, "mm");
  EXPECT_THAT(contents.remarks,
              ElementsAre("it declares several units (mm, cm): all is turned into mm"));
  const auto& far = std::get<NurbsCurve<3>>(contents.geometry.at(1));
  EXPECT_LE((far.control_points() - 10 * line.control_points()).norm(), 1e-13);
}

// One context that calls both millimetres and metres its unit of length.
TEST_F(GeometryUnitsTest, ASecondUnitOfLengthInOneContextIsSaid) {
  File(".step", "mm");
  std::string text = folder_.Text("part-mm.step");
  const size_t begin = text.find("GLOBAL_UNIT_ASSIGNED_CONTEXT");
  ASSERT_NE(begin, text.npos);
  text.insert(text.find('#', begin), "#9999,");
  text =
      Replaced(text, "DATA;", "DATA;\n#9999 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.) );");
  const GeometryContents contents = ReadGeometryContents(folder_.With("both.step", text));
  ASSERT_EQ(contents.remarks.size(), 1u);
  EXPECT_THAT(contents.remarks[0], HasSubstr("it declares several units ("));
}

}  // namespace batten::internal::geometry_units_test
