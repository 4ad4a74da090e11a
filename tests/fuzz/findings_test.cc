// SPDX-License-Identifier: MIT
// What fuzzing found, one test a finding. Their files are seeds besides (seeds/*/found-*).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "batten/io/geometry_json.h"
#include "batten/io/iges_reader.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "fuzz_targets.h"
#include "memory_file.h"

namespace batten::internal::findings_test {

using ::testing::HasSubstr;

// Why IGES of these entities is refused.
std::string RefusalOfIges(std::string_view entities) {
  const MemoryFile file(LaidOutIges(entities));
  try {
    ReadIges(file.path());
  } catch (const ReadError& error) {
    return error.what();
  }
  return "(read)";
}

// A directory that says zero lines of parameters behind the last one: one line past the end was
// read.
TEST(FuzzFindingsTest, ParametersOfIgesThatTheFileDoesNotHaveAreNotRead) {
  std::string text = LaidOutIges("110,0,0,00000000;0.,0.,0.,1.,2.,3.\n");
  constexpr size_t kLine = 81, kField = 8;
  const size_t entry = text.find("D      1") - 72;
  ASSERT_EQ(entry % kLine, 0u);
  for (const char* count : {"0", "1", "-1"}) {
    text.replace(entry + kField, kField, "       2");
    text.replace(
        entry + kLine + 3 * kField, kField, std::string(kField - std::strlen(count), ' ') + count);
    const MemoryFile file(text);
    try {
      ReadIges(file.path());
      ADD_FAILURE() << "it was read";
    } catch (const ReadError& error) {
      EXPECT_THAT(error.what(), HasSubstr("the entity's parameters are not in the file"));
    }
  }
}

TEST(FuzzFindingsTest, AMatrixOfIgesMayNotMovePointsBeyondWhatIsReadElsewhere) {
  const std::string line = "110,0,1,00000000;0.,0.,0.,1.,2.,3.\n";
  EXPECT_EQ(RefusalOfIges("124,0,0,00010000;1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,1.E149\n" + line),
            "(read)");
  EXPECT_THAT(RefusalOfIges("124,0,0,00010000;1.,0.,0.,0.,0.,1.,0.,0.,0.,1.E150,1.,0.\n" + line),
              HasSubstr("entity D3 (type 110): has a coordinate above 1e150 in magnitude"));
}

TEST(FuzzFindingsTest, KnotsAndWeightsOfIgesHaveTheLimitsOfJson) {
  const auto curve = [](const std::string& knot, const std::string& weight) {
    return "126,0,0,00000000;1,1,0,0,0,0,0.,0.," + knot + ',' + knot + ',' + weight + ",1.," +
           "0.,0.,0.,1.,0.,0.,0.,1.\n";
  };
  EXPECT_EQ(RefusalOfIges(curve("1.", "1.")), "(read)");
  EXPECT_THAT(RefusalOfIges(curve("1.", "1.E151")), HasSubstr("has a weight above 1e150"));
  EXPECT_THAT(RefusalOfIges(curve("1.E151", "1.")), HasSubstr("has a knot above 1e150"));
  const std::string surface =
      "128,0,0,00000000;1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.E151,1.,1.,0.,0.,0.,1.,0.,0."
      ","
      "0.,1.,0.,1.,1.,0.,0.,1.,0.,1.\n";
  EXPECT_THAT(RefusalOfIges(surface), HasSubstr("has a weight above 1e150"));
}

TEST(FuzzFindingsTest, ACompositeCurveWithoutAPartSpansNoSurface) {
  const std::string curves =
      "102,0,0,00010000;0\n"
      "110,0,0,00010000;0.,0.,0.,1.,0.,0.\n";
  const auto reason = HasSubstr("entity D5 (type 1");
  const auto part = HasSubstr("has a composite curve without a part");
  for (const char* surface : {"118,0,0,00000000;1,3,0,0",
                              "118,0,0,00000000;3,1,0,0",
                              "120,0,0,00000000;1,3,0.,6.",
                              "120,0,0,00000000;3,1,0.,6.",
                              "122,0,0,00000000;1,0.,0.,1."}) {
    EXPECT_THAT(RefusalOfIges(curves + surface), ::testing::AllOf(reason, part)) << surface;
  }
}

// The area of such a domain is 0 in doubles; it is no loop of the file that is wrong.
TEST(FuzzFindingsTest, HolesOfADomainTooSmallToHaveAnAreaAreRefused) {
  const auto refusal = [](const std::string& side) {
    const std::string knots = "[0, 0, " + side + ", " + side + "]";
    try {
      ParseGeometryJson(
          R"({"shape": {"type": "surface", "data": {"degree_u": 1, "degree_v": 1, "knotvector_u": )" +
              knots + R"(, "knotvector_v": )" + knots +
              R"(, "size_u": 2, "size_v": 2, "control_points": {"points": )"
              R"([[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]]}, "trims": {"data": [)"
              R"({"type": "freeform", "points": [[0, 0], [1e-201, 0], [1e-201, 1e-201], [0, 0]]},)"
              R"({"type": "freeform", "points": [[4e-201, 4e-201], [5e-201, 4e-201],)"
              R"( [5e-201, 5e-201], [4e-201, 4e-201]]}]}}}})",
          "a.json");
    } catch (const ReadError& error) {
      return std::string(error.what());
    }
    return std::string("(read)");
  };
  EXPECT_THAT(refusal("1e-200"),
              HasSubstr("shape.data.trims: the domain of the surface encloses no area"));
  EXPECT_THAT(refusal("1"), HasSubstr("shape.data.trims.data[0]: encloses no area"));
}

TEST(FuzzFindingsTest, PointsOutsideTheBoxAreNoHolesOfTheirGrid) {
  const MemoryFile file("0 0 0\n5 5 5\nnan 0 0\n1 0 0\n");
  CloudReadOptions options;
  options.format = "text";
  options.box = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1));
  const CloudFile read = ReadCloud({file.path()}, options);
  EXPECT_EQ(read.filtered, 1);
  EXPECT_EQ(read.non_finite, 1);
  EXPECT_THAT(read.missing, ::testing::ElementsAre(2));
}

}  // namespace batten::internal::findings_test
