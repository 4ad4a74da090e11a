// SPDX-License-Identifier: MIT
// What can't be used ends in one line and the right exit code, at once, with nothing written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <random>

#include "test_clouds.h"

namespace batten::internal::bad_input_test {

using ::testing::HasSubstr;

constexpr double kSeconds = 1;
constexpr std::int64_t kBytes = std::int64_t{100} << 20;

class BadInputTest : public ::testing::Test {
 protected:
  void ExpectRefused(const std::vector<std::string>& arguments,
                     int code,
                     const std::vector<std::string>& said,
                     const std::string& standard_input = "") {
    const std::ptrdiff_t before = folder_.Entries();
    const ProgramRun run = Batten(arguments, {standard_input, {}});
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(run.out, "");
    for (const std::string& words : said) EXPECT_THAT(run.err, HasSubstr(words));
    EXPECT_EQ(folder_.Entries(), before);
    EXPECT_LT(run.seconds, kSeconds);
    EXPECT_LT(run.peak_bytes, kBytes + MemoryAtStart());
  }

  // Every command that reads points refuses them, naming file and reason.
  void ExpectBadCloud(const std::string& name,
                      std::string_view content,
                      const std::string& reason) {
    const std::string path = folder_.With(name, content);
    const std::string good = folder_.With("good.json", kRationalPatch);
    ExpectRefused({"fit",
                   "surface",
                   path,
                   "-o",
                   folder_.File("out.step"),
                   "--report",
                   folder_.File("out.json")},
                  1,
                  {path, reason});
    ExpectRefused({"info", path}, 1, {path, reason});
    ExpectRefused({"convert", path, folder_.File("out.ply")}, 1, {path, reason});
    ExpectRefused({"compare", good, path, "--report", folder_.File("out.json")}, 1, {path, reason});
  }

  // Points that can be read but carry no surface.
  void ExpectNoSurface(const std::string& content, const std::string& reason) {
    const std::string path = folder_.With("points.xyz", content);
    ExpectRefused({"fit", "surface", path, "-o", folder_.File("out.step")}, 1, {path, reason});
  }

  void ExpectBadGeometry(const std::string& name,
                         std::string_view content,
                         const std::string& reason) {
    const std::string path = folder_.With(name, content);
    const std::string cloud = folder_.With("good.xyz", ToText(WavySheet(20)));
    ExpectRefused({"info", path}, 1, {path, reason});
    ExpectRefused({"evaluate", path, "--at", "0,0"}, 1, {path, reason});
    ExpectRefused({"compare", path, cloud}, 1, {path, reason});
    ExpectRefused({"convert", path, folder_.File("out.step")}, 1, {path, reason});
    ExpectRefused(
        {"sample", path, "-o", folder_.File("out.xyz"), "--count", "10"}, 1, {path, reason});
  }

  static std::string Noise() {
    std::mt19937_64 engine(5);
    std::string bytes;
    for (int k = 0; k < 4096; ++k) bytes.push_back(static_cast<char>(engine() >> 56));
    return bytes;
  }

  TemporaryFolder folder_;
};

TEST_F(BadInputTest, AnEmptyFileHoldsNoPoints) {
  ExpectBadCloud("empty.xyz", "", "is empty");
  ExpectBadCloud("empty.ply", "", "is empty");
  ExpectBadCloud("empty.pcd", "", "is empty");
}

TEST_F(BadInputTest, AHeaderAloneHoldsNoPoints) {
  ExpectBadCloud("header.xyz", "x y z\n", "no usable point");
  ExpectBadCloud("header.ply",
                 "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                 "property float z\nend_header\n",
                 "no usable point");
  ExpectBadCloud(
      "header.pcd",
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 0\nHEIGHT 1\n"
      "POINTS 0\nDATA ascii\n",
      "no usable point");
}

TEST_F(BadInputTest, ThreePointsCarryNoSurface) {
  ExpectNoSurface("0 0 0\n1 0 0\n0 1 0\n", "at least 4 different points; there are 3");
}

TEST_F(BadInputTest, CollinearPointsCarryNoSurface) {
  std::vector<Row> rows;
  for (int k = 0; k < 100; ++k) rows.push_back({1.0 * k, 2.0 * k, 3.0 * k});
  ExpectNoSurface(ToText(rows), "on a line");
}

TEST_F(BadInputTest, EqualPointsCarryNoSurface) {
  ExpectNoSurface(ToText(std::vector<Row>(200, Row{1, 2, 3})), "there are 1");
}

TEST_F(BadInputTest, PointsOfThePlaneCarryNoSurface) {
  ExpectNoSurface("0 0\n1 0\n0 1\n1 1\n2 2\n", "two columns");
}

TEST_F(BadInputTest, NothingButNaNIsNoPoint) {
  std::string rows;
  for (int k = 0; k < 100; ++k) rows += "nan nan nan\n";
  ExpectBadCloud("nan.xyz", rows, "100 not finite");
}

TEST_F(BadInputTest, APcdThatPromisesAThousandMillionPointsIsNotBelieved) {
  for (const char* data : {"ascii", "binary", "binary_compressed"}) {
    ExpectBadCloud("big.pcd",
                   std::string("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
                               "WIDTH 1000000000\nHEIGHT 1\nPOINTS 1000000000\nDATA ") +
                       data + "\n1 2 3 4 5 6\n",
                   "1000000000");
  }
}

TEST_F(BadInputTest, APlyThatPromisesAThousandMillionPointsIsNotBelieved) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    ExpectBadCloud(
        "big.ply",
        std::string("ply\nformat ") + format +
            " 1.0\nelement vertex 1000000000\n"
            "property float x\nproperty float y\nproperty float z\nend_header\n1 2 3 4 5 6\n",
        "1000000000");
  }
}

TEST_F(BadInputTest, ATruncatedBinaryPlyIsRefused) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 100\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n";
  ExpectBadCloud("short.ply", header + std::string(600, '\0'), "1200 bytes, but 600 follow");
}

TEST_F(BadInputTest, CoordinatesOfTenToThe308AreRefused) {
  std::vector<Row> rows;
  for (int k = 1; k < 100; ++k) rows.push_back({k * 1e306, k * k * 1e304, 1e308});
  ExpectBadCloud("huge.xyz", ToText(rows), "line 1");
}

TEST_F(BadInputTest, CoordinatesBeyondSinglePrecisionDoNotCrash) {
  for (const double scale : {1e30, 1e100, 1e149}) {
    std::vector<Row> rows = WavySheet(200);
    rows.push_back({scale, scale, scale});
    ExpectBadCloud("large.xyz", ToText(rows), "line 201");
  }
}

// From 1e15 on, doubles are an eighth apart.
TEST_F(BadInputTest, AnOriginFromWhichNoDigitsAreLeftIsRefused) {
  const std::string path = folder_.With("cloud.xyz", ToText(WavySheet(200)));
  for (const char* origin : {"1e15,0,0", "0,-1e300,0"}) {
    ExpectRefused({"fit", "surface", path, "-o", folder_.File("out.json"), "--origin", origin},
                  1,
                  {path, "--origin", origin, "local"});
  }
  // Those that are passed over, not read, as well.
  for (const std::vector<std::string>& passes :
       {std::vector<std::string>{"--memory", "100MB"}, {"--tiles", "1x1"}}) {
    std::vector<std::string> command{
        "fit", "surface", path, "-o", folder_.File("out.json"), "--origin", "1e15,0,0"};
    command.insert(command.end(), passes.begin(), passes.end());
    ExpectRefused(command, 1, {path, "--origin", "1e15,0,0", "local"});
  }
  const ProgramRun near = Batten(
      {"fit", "surface", path, "-o", folder_.File("out.json"), "--origin", "500000,5000000,0"});
  EXPECT_EQ(near.code, 0) << near.err;
}

TEST_F(BadInputTest, APointIsNoBody) {
  for (const size_t count : {1, 500}) {
    const std::string path =
        folder_.With("point.xyz", ToText(std::vector<Row>(count, Row{1, 2, 3})));
    ExpectRefused(
        {"fit", "solid", path, "-o", folder_.File("out.step")}, 1, {path, "at one place"});
  }
}

TEST_F(BadInputTest, BinaryGarbageIsRefusedWhateverItsName) {
  ExpectBadCloud("noise.xyz", Noise(), "line 1");
  ExpectBadCloud("noise.csv", Noise(), "line 1");
  ExpectBadCloud("noise.ply", Noise(), "line 1");
  ExpectBadCloud("noise.pcd", Noise(), "line 1");
  ExpectBadGeometry("noise.json", Noise(), "not JSON");
  ExpectBadGeometry("noise.step", Noise(), "not a STEP file");
}

TEST_F(BadInputTest, ARowThatIsNoNumbersIsNamedByItsLine) {
  ExpectBadCloud("words.xyz", "1 2 3\n1 2 three\n", "line 2: expected a number, found 'three'");
  ExpectBadCloud("ragged.xyz", "1 2 3\n1 2\n", "line 2: expected 3 columns, found 2");
}

TEST_F(BadInputTest, EmptyGeometryIsRefused) {
  ExpectBadGeometry("empty.json", "", "is empty");
  ExpectBadGeometry("empty.step", "", "is empty");
  ExpectBadGeometry("nothing.json", "{}", "shape");
}

TEST_F(BadInputTest, AFolderIsNoFile) {
  const std::string path = folder_.path().string();
  const std::string good = folder_.With("good.json", kRationalPatch);
  ExpectRefused({"fit", "surface", path, "--format", "text", "-o", folder_.File("out.step")},
                1,
                {path, "directory"});
  ExpectRefused({"info", path, "--format", "step"}, 1, {path, "directory"});
  ExpectRefused({"evaluate", good, "--at-file", path}, 1, {path, "directory"});
}

TEST_F(BadInputTest, AMissingFileIsNamed) {
  const std::string good = folder_.With("good.json", kRationalPatch);
  const std::string cloud = folder_.File("missing.xyz"), geometry = folder_.File("missing.json");
  ExpectRefused(
      {"fit", "surface", cloud, "-o", folder_.File("out.step")}, 1, {cloud, "No such file"});
  ExpectRefused({"compare", good, cloud}, 1, {cloud, "No such file"});
  ExpectRefused({"compare", geometry, cloud}, 1, {geometry, "No such file"});
  ExpectRefused({"evaluate", good, "--at-file", cloud}, 1, {cloud, "No such file"});
}

TEST_F(BadInputTest, AnUnwritableOutputIsRefusedBeforeTheWork) {
  const std::string cloud = folder_.With("cloud.xyz", ToText(WavySheet(500)));
  const std::string out = folder_.File("out.json"), lost = folder_.File("nowhere/out.json");
  const std::string folder = folder_.path().string();
  ExpectRefused({"fit", "surface", cloud, "-o", lost}, 1, {lost, "No such file"});
  ExpectRefused({"fit", "surface", cloud, "-o", out, "--report", lost}, 1, {lost});
  ExpectRefused({"fit", "surface", cloud, "-o", out, "--residuals", folder_.File("nowhere/r.csv")},
                1,
                {"nowhere"});
  ExpectRefused(
      {"fit", "surface", cloud, "-o", folder, "--output-format", "json"}, 1, {folder, "directory"});
  ExpectRefused({"fit", "surface", cloud, "-o", "/proc/out.json"}, 1, {"/proc/out.json"});
  if (::geteuid() == 0) return;  // root may write anywhere
  const std::string locked = folder_.With("locked.json", "old");
  std::filesystem::permissions(locked, std::filesystem::perms::owner_read);
  ExpectRefused({"fit", "surface", cloud, "-o", locked}, 1, {locked, "denied"});
}

TEST_F(BadInputTest, AFailureLeavesTheOldTargetUntouched) {
  const std::string bad = folder_.With("bad.xyz", "1 2 3\n1 2 three\n");
  const std::string out = folder_.With("out.json", "old");
  ExpectRefused(
      {"fit", "surface", bad, "-o", out, "--report", folder_.With("report.json", "old too")},
      1,
      {bad});
  EXPECT_EQ(folder_.Text("out.json"), "old");
  EXPECT_EQ(folder_.Text("report.json"), "old too");
}

TEST_F(BadInputTest, BadStandardInputIsNamedAsSuch) {
  ExpectRefused({"fit", "surface", "-", "--format", "text", "-o", folder_.File("out.json")},
                1,
                {"standard input", "is empty"});
  ExpectRefused(
      {"info", "-", "--format", "text"}, 1, {"standard input", "line 2"}, "1 2 3\nnot numbers\n");
}

TEST_F(BadInputTest, AFilterThatLeavesNothingSaysSo) {
  const std::string cloud = folder_.With("cloud.xyz", ToText(WavySheet(50)));
  ExpectRefused({"info", cloud, "--box", "50,50,50,60,60,60"}, 1, {cloud, "50 filtered out"});
  ExpectRefused({"info", cloud, "--where", "3=1e9"}, 1, {cloud, "50 filtered out"});
}

TEST_F(BadInputTest, AParameterFileIsJudgedLineByLine) {
  const std::string patch = folder_.With("patch.json", kRationalPatch);
  const std::string outside = folder_.With("outside.csv", "u,v\n0,0\n9,0\n");
  ExpectRefused({"evaluate", patch, "--at-file", outside}, 1, {outside, "line 3", "u = 9"});
  const std::string single = folder_.With("single.csv", "0.5\n");
  ExpectRefused({"evaluate", patch, "--at-file", single}, 1, {single, "line 1", "two parameters"});
}

// ---- what headers promise, held against the file before memory is taken ----

TEST_F(BadInputTest, APlyOfAHundredBytesIsNotBelievedWhateverItPromises) {
  for (const char* count : {"100000000", "4000000000", "1099511627776", "9223372036854775807"}) {
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      const std::string path = folder_.With(
          "promise.ply",
          std::string("ply\nformat ") + format + " 1.0\nelement vertex " + count +
              "\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2");
      ExpectRefused({"info", path}, 1, {path, count});
    }
  }
}

TEST_F(BadInputTest, AListThatPromisesMoreThanTheFileIsNotBelieved) {
  const std::string path =
      folder_.With("list.ply",
                   std::string("ply\nformat binary_little_endian 1.0\nelement face 1\n"
                               "property list uint double far\nelement vertex 1\nproperty float x\n"
                               "property float y\nproperty float z\nend_header\n") +
                       std::string(4, '\xff') + std::string(12, '\0'));
  ExpectRefused({"info", path}, 1, {path, "the file ends after 0 of 1 of element face"});
}

TEST_F(BadInputTest, ACompressedPcdOfAFalseSizeIsNotBelieved) {
  const auto pcd = [&](const std::string& points, std::uint32_t packed, std::uint32_t size) {
    std::string bytes = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
                        points + "\nHEIGHT 1\nPOINTS " + points + "\nDATA binary_compressed\n";
    for (const std::uint32_t number : {packed, size}) {
      for (int k = 0; k < 4; ++k) bytes.push_back(static_cast<char>(number >> (8 * k)));
    }
    return folder_.With("false.pcd", bytes + "\x1f" + std::string(32, 'a'));
  };
  std::string path = pcd("357913941", 33, 4294967292);
  ExpectRefused({"info", path}, 1, {path, "33 bytes can't decompress to 4294967292"});
  path = pcd("357913941", 4294967295, 4294967292);
  ExpectRefused({"info", path}, 1, {path, "but 33 follow"});
  path = pcd("2", 33, 4294967292);
  ExpectRefused({"info", path}, 1, {path, "4294967292 bytes where 2 points take 24"});
}

TEST_F(BadInputTest, ALasThatPromisesBillionsOfPointsIsNotBelieved) {
  // LAS 1.4 of one point of format 6, 30 bytes.
  const auto las = [&](std::uint64_t points) {
    std::string bytes(375 + 30, '\0');
    const auto put = [&](std::size_t at, const auto& value) {
      std::memcpy(bytes.data() + at, &value, sizeof value);
    };
    bytes.replace(0, 4, "LASF");
    put(24, std::uint8_t{1});
    put(25, std::uint8_t{4});
    put(94, std::uint16_t{375});
    put(96, std::uint32_t{375});
    put(104, std::uint8_t{6});
    put(105, std::uint16_t{30});
    for (const std::size_t at : {131, 139, 147}) put(at, 0.001);
    put(247, points);
    return folder_.With("promise.las", bytes);
  };
  const ProgramRun read = Batten({"info", las(1)});
  EXPECT_EQ(read.code, 0) << read.err;
  for (const int bits : {32, 40}) {
    const std::uint64_t points = std::uint64_t{1} << bits;
    const std::string path = las(points);
    ExpectRefused({"info", path},
                  1,
                  {path, "promises " + std::to_string(points), "the file ends at byte 405"});
  }
  for (const int bits : {41, 59, 63}) {
    const std::uint64_t points = std::uint64_t{1} << bits;
    const std::string path = las(points);
    ExpectRefused({"info", path}, 1, {path, std::to_string(points) + " points are not possible"});
  }
}

TEST_F(BadInputTest, AnStlThatPromisesBillionsOfFacetsIsNotBelieved) {
  const auto stl = [&](std::uint32_t facets) {
    std::string bytes(84 + 50, '\0');
    std::memcpy(bytes.data() + 80, &facets, sizeof facets);
    return folder_.With("promise.stl", bytes);
  };
  const ProgramRun read = Batten({"info", stl(1)});
  EXPECT_EQ(read.code, 0) << read.err;
  for (const std::uint32_t facets : {2u, 2147483648u, 4294967295u}) {
    const std::string path = stl(facets);
    ExpectRefused({"info", path},
                  1,
                  {path, "promises " + std::to_string(facets) + " facets", "but 50 follow"});
  }
}

TEST_F(BadInputTest, ListsNestedAHundredThousandDeepAreRefused) {
  const std::string open(100'000, '['), close(100'000, ']');
  for (const char* name : {"shape", "data", "unknown"}) {
    const std::string path =
        folder_.With("deep.json", std::string("{\"") + name + "\": " + open + close + "}");
    ExpectRefused({"info", path}, 1, {path, "nested deeper than 64 levels"});
  }
  const std::string head =
      "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('CONFIG_CONTROL_DESIGN'));\nENDSEC;\nDATA;\n#1=A";
  const std::string path =
      folder_.With("deep.step",
                   head + std::string(100'000, '(') + std::string(100'000, ')') +
                       ";\nENDSEC;\nEND-ISO-10303-21;\n");
  ExpectRefused({"info", path}, 1, {path, "line 6", "nested deeper than 64 levels"});
}

TEST_F(BadInputTest, CountsOfJsonAreHeldAgainstItsLists) {
  std::string text = kRationalPatch;
  const std::size_t at = text.find("\"size_u\": 4");
  ASSERT_NE(at, text.npos);
  text.replace(at, 11, "\"size_u\": 1000000000");
  const std::string path = folder_.With("counts.json", text);
  ExpectRefused({"info", path}, 1, {path, "size_u 1000000000"});
}

TEST_F(BadInputTest, CountsOfIgesAreHeldAgainstItsNumbers) {
  // One curve whose parameters are `values` on `lines` lines.
  const auto iges = [&](const std::string& values, const std::string& lines) {
    const auto field = [](std::string text) { return std::string(8 - text.size(), ' ') + text; };
    const auto line = [&](std::string text, char section, const std::string& number) {
      text.resize(72, ' ');
      return text + section + field(number).substr(1) + "\n";
    };
    return folder_.With(
        "counts.iges",
        line("counts", 'S', "1") + line("1H,,1H;;", 'G', "1") +
            line(field("126") + field("1") + std::string(48, ' ') + "00000000", 'D', "1") +
            line(field("126") + std::string(16, ' ') + field(lines), 'D', "2") +
            line("126," + values + ";", 'P', "1") + line("S1G1D2P1", 'T', "1"));
  };
  for (const char* count : {"2147483647", "4294967295", "1E300", "-1"}) {
    const std::string path = iges(std::string(count) + ",1,0,0,0,0,0.,0.,1.,1.", "1");
    ExpectRefused({"info", path}, 1, {path, "promises more numbers than it has"});
  }
  const std::string path = iges("1,1", "9999999");
  ExpectRefused({"info", path}, 1, {path, "line 3", "parameters are not in the file"});
}

}  // namespace batten::internal::bad_input_test
