// SPDX-License-Identifier: MIT
// What fuzzing found, one test a finding. Their files are seeds besides (seeds/*/found-*).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/io/iges_reader.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "fuzz_targets.h"
#include "memory_file.h"

namespace batten {
namespace {

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

}  // namespace
}  // namespace batten
