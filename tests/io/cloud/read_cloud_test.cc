// SPDX-License-Identifier: MIT
#include "batten/io/read_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include "batten/io/read_error.h"
#include "batten/io/write_cloud.h"
#include "cases.h"
#include "cloud_bytes.h"
#include "las_bytes.h"
#include "sanitized.h"

namespace batten::internal::read_cloud_test {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr unsigned kSeed = 7;

// The bytes of a few points in every format there is.
// A binary STL file whose facets share no corner.
std::string FacetsWithoutNeighbours(std::mt19937_64& random, std::uint32_t facets) {
  std::uniform_real_distribution<float> unit(-1, 1);
  std::string bytes = std::string(80, 'x') + LittleEndian(facets);
  for (std::uint32_t facet = 0; facet < facets; ++facet) {
    for (int number = 0; number < 12; ++number) bytes += LittleEndian(unit(random));
    bytes += "00";
  }
  return bytes;
}

struct Sample {
  std::string name, bytes;
};
std::string AfterEveryLine(const std::string& word, const std::string& text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at) + 1;
    result += word + text.substr(at, end - at);
    at = end;
  }
  return result;
}

// An ASCII STL file whose corners first appear in the order of the lines; neighbouring facets share
// one.
std::string FacetsOf(const std::string& text) {
  std::vector<std::string_view> rows;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at) + 1;
    rows.push_back(std::string_view(text).substr(at, end - at));
    at = end;
  }
  std::string result = "solid\n";
  for (std::size_t k = 0; k < rows.size(); k += 2) {
    result += "facet normal 0 0 1\nouter loop\n";
    for (std::size_t corner = k; corner < k + 3; ++corner) {
      result += "vertex ";
      result += rows[std::min(corner, rows.size() - 1)];
    }
    result += "endloop\nendfacet\n";
  }
  return result + "endsolid\n";
}

std::vector<Sample> SamplesOf(const Eigen::Matrix3Xd& points) {
  std::string little, big, text, columns;
  char row[100];
  for (const auto& p : points.colwise()) {
    for (int d = 0; d < 3; ++d) {
      little += LittleEndian(p[d]);
      big += BigEndian(p[d]);
    }
    std::snprintf(row, sizeof row, "%.17g %.17g %.17g\n", p[0], p[1], p[2]);
    text += row;
  }
  for (int d = 0; d < 3; ++d) {
    for (const double value : points.row(d)) columns += LittleEndian(value);
  }
  const long m = points.cols();
  return {
      {"a.xyz", text},
      {"ascii.ply", PlyHeader("ascii", m, kPlyDoubles) + text},
      {"little.ply", PlyHeader("binary_little_endian", m, kPlyDoubles) + little},
      {"big.ply", PlyHeader("binary_big_endian", m, kPlyDoubles) + big},
      {"ascii.pcd", PcdHeader(kPcdDoubles, m, "ascii") + text},
      {"binary.pcd", PcdHeader(kPcdDoubles, m, "binary") + little},
      {"compressed.pcd", PcdHeader(kPcdDoubles, m, "binary_compressed") + CompressedBody(columns)},
      {"a.obj", AfterEveryLine("v ", text)},
      {"a.off", "OFF\n" + std::to_string(m) + " 0 0\n" + text},
      {"a.stl", FacetsOf(text)}};
}

TEST(ReadCloudTest, GivesTheSamePointsFromEveryFormat) {
  std::mt19937_64 random(kSeed);
  const Eigen::Matrix3Xd points = RandomPoints(random, 70'000, 40, {500000, 5400000, 300});
  for (const Sample& sample : SamplesOf(points)) {
    const CloudFile file = ReadBytes(sample.name, sample.bytes);
    EXPECT_EQ(World(file.cloud), points) << sample.name;
    EXPECT_EQ(file.points_in_file, points.cols());
    EXPECT_NE(file.cloud.origin(), Eigen::Vector3d::Zero());
  }
}

TEST(ReadCloudTest, CountsWhatItDrops) {
  CloudReadOptions options;
  options.where = {{"4", 1}};
  options.box = Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(10, 10, 10));
  const CloudFile file =
      ReadBytes("a.xyz",
                "0 10 5 1\n1 1 1 2\nnan 1 1 1\nnan 1 1 2\n11 1 1 1\n1 1 -0.001 1\n10 10 10 1\n",
                options);
  EXPECT_EQ(file.cloud.size(), 2);
  EXPECT_EQ(file.non_finite, 1);
  EXPECT_EQ(file.filtered, 4);
  EXPECT_EQ(file.points_in_file, 7);
}

TEST(ReadCloudTest, SaysWhyNothingIsLeft) {
  CloudReadOptions options;
  options.where = {{"4", 1}};
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3 0\nnan 2 3 1\n1 2 3 0\n", options),
              HasSubstr("no usable point (3 rows, 1 not finite, 2 filtered out)"));
  EXPECT_THAT(FailureOf("a.xyz", ""), HasSubstr("is empty"));
  EXPECT_THAT(FailureOf("a.csv", "x,y,z\n"), HasSubstr("no usable point"));
  EXPECT_THAT(FailureOf("a.xyz", "# nothing\n"), HasSubstr("no usable point"));
}

TEST(ReadCloudTest, JoinsFilesAndKeepsWhatAllOfThemHave) {
  const TemporaryFolder folder;
  const std::string a = folder.With("a.csv", "x,y,z,nx,ny,nz,w\n1000001,2,3,0,0,1,2\n");
  const std::string b = folder.With("b.csv", "w,z,y,x\n4,6,5,1000004\n5,9,8,nan\n");
  const CloudFile file = ReadCloud({a, b});
  EXPECT_EQ(World(file.cloud), (Eigen::Matrix3Xd(3, 2) << 1000001, 1000004, 2, 5, 3, 6).finished());
  EXPECT_EQ(file.cloud.weights(), Eigen::Vector2d(2, 4));
  EXPECT_EQ(file.cloud.normals().cols(), 0);
  EXPECT_EQ(file.points_in_file, 3);
  EXPECT_EQ(file.non_finite, 1);
  EXPECT_EQ(file.fields.front(), "x");
}

TEST(ReadCloudTest, RefusesWhatIsNoReadableFile) {
  const TemporaryFolder folder;
  const auto failure = [](const std::string& path) {
    try {
      CloudReadOptions options;
      options.format = "xyz";
      ReadCloud({path}, options);
    } catch (const ReadError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(failure(folder.File("missing.xyz")),
              AllOf(HasSubstr("missing.xyz"), HasSubstr("No such file")));
  EXPECT_THAT(failure(folder.path().string()), HasSubstr("directory"));
  EXPECT_THROW(ReadCloud({folder.File("a.step")}), UsageError);
  EXPECT_THROW(ReadCloud({folder.File("a.e57")}), UsageError);
  EXPECT_THROW(ReadCloud({"-"}), UsageError);
  EXPECT_THROW(ReadCloud({}), std::invalid_argument);
  if (::geteuid() != 0) {
    const std::string path = folder.With("locked.xyz", "1 2 3\n");
    ::chmod(path.c_str(), 0);
    EXPECT_THAT(failure(path), HasSubstr("Permission denied"));
  }
}

// A pipe has no size to hold a header against: memory must follow the data.
TEST(ReadCloudTest, ReadsPipesAndRefusesTheirPromises) {
  const TemporaryFolder folder;
  std::mt19937_64 random(kSeed);
  const Eigen::Matrix3Xd points = RandomPoints(random, 70'000, 1);
  const auto through_pipe = [&](const std::string& name, const std::string& bytes) {
    const std::string path = folder.File("pipe-" + name);
    if (::mkfifo(path.c_str(), 0600) != 0) throw std::runtime_error("no pipe can be made");
    std::thread writer([&] { folder.With("pipe-" + name, bytes); });
    struct Joiner {
      std::thread& thread;
      ~Joiner() { thread.join(); }
    } joiner{writer};
    return ReadCloud({path});
  };
  for (const Sample& sample : SamplesOf(points)) {
    EXPECT_EQ(World(through_pipe(sample.name, sample.bytes).cloud), points) << sample.name;
  }
  EXPECT_THROW(
      through_pipe("b.ply", PlyHeader("binary_little_endian", 1'000'000'000, kPlyDoubles) + "abc"),
      ReadError);
  EXPECT_THROW(through_pipe("b.pcd", PcdHeader(kPcdDoubles, 1'000'000'000, "binary") + "abc"),
               ReadError);
  EXPECT_THROW(
      through_pipe("c.pcd",
                   PcdHeader(kPcdDoubles, 100'000'000, "binary_compressed") +
                       LittleEndian(2'300'000'000u) + LittleEndian(2'400'000'000u) + "abc"),
      ReadError);
}

TEST(ReadCloudTest, ReportsProgressAndPassesOnWhatItThrows) {
  std::mt19937_64 random(kSeed);
  const auto samples = SamplesOf(RandomPoints(random, 500'000, 1));
  struct Cancelled {};
  for (const Sample& sample : samples) {
    if (sample.name == "compressed.pcd") continue;
    CloudReadOptions options;
    double last = 0;
    int calls = 0;
    options.progress = [&](double fraction) {
      EXPECT_LE(last, fraction);
      EXPECT_LE(fraction, 1);
      last = fraction;
      ++calls;
    };
    ReadBytes(sample.name, sample.bytes, options);
    EXPECT_GE(calls, 2) << sample.name;
    options.progress = [](double) { throw Cancelled{}; };
    EXPECT_THROW(ReadBytes(sample.name, sample.bytes, options), Cancelled) << sample.name;
  }
}

void WriteLargeFiles(const TemporaryFolder& folder, Eigen::Index count) {
  std::mt19937_64 random(kSeed);
  const PointCloud cloud = PointCloud::FromWorld(RandomPoints(random, count, 1));
  for (const char* name : {"a.xyz", "a.ply", "a.pcd"}) WriteCloud(cloud, folder.File(name));
  const std::string text = folder.Text("a.xyz");
  folder.With("a.obj", AfterEveryLine("v ", text));
  folder.With("a.off", "OFF\n" + std::to_string(count) + " 0 0\n" + text);
  folder.With("a.stl", FacetsOf(text));
  folder.With("a.las", LasBytes(RandomLasPoints(random, static_cast<std::size_t>(count))));
  folder.With("b.stl", FacetsWithoutNeighbours(random, static_cast<std::uint32_t>(count / 3 + 1)));
}

// The library's promise: at most 2.2 times the points, whatever the format.
TEST(ReadCloudTest, NeedsLittleMoreMemoryThanThePoints) {
  if (!kMemoryIsTheProgramsOwn) GTEST_SKIP();
  constexpr Eigen::Index kPoints = 1'000'000;
  const TemporaryFolder folder;
  // A peak never falls, and what was freed is used again: writing and each reading get a process
  // of their own.
  EXPECT_EXIT(
      {
        WriteLargeFiles(folder, kPoints);
        std::_Exit(0);
      },
      ::testing::ExitedWithCode(0),
      "");
  for (const char* name :
       {"a.xyz", "a.ply", "a.pcd", "a.obj", "a.off", "a.stl", "a.las", "b.stl"}) {
    EXPECT_EXIT(
        {
          const double before = PeakMemory();
          const CloudFile file = ReadCloud({folder.File(name)});
          const auto points = static_cast<double>(file.points_in_file);
          const double used = (PeakMemory() - before) / (24 * points);
          std::fprintf(stderr, "%.2f times the points", used);
          std::_Exit(points >= kPoints && used >= 0.9 && used <= 2.2 ? 0 : 1);
        },
        ::testing::ExitedWithCode(0),
        "")
        << name;
  }
}

// Damaged files give points or a reason; never a crash or memory that the file does not justify.
TEST(ReadCloudTest, SurvivesRandomDamage) {
  const int rounds = Cases(800);
  std::mt19937_64 random(kSeed);
  SCOPED_TRACE(kSeed);
  const TemporaryFolder folder;
  const double before = PeakMemory();
  std::vector<Sample> samples = SamplesOf(RandomPoints(random, 5, 1000));
  samples.push_back({"a.las", LasBytes(RandomLasPoints(random, 5))});
  samples.push_back({"b.stl", FacetsWithoutNeighbours(random, 3)});
  for (const Sample& sample : samples) {
    for (int round = 0; round < rounds; ++round) {
      std::string bytes = sample.bytes;
      for (auto damage = random() % 4; damage < 4; ++damage) {
        // Half of the hits on the first bytes, where headers are.
        const std::size_t range =
            random() % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 200);
        bytes[random() % range] =
            static_cast<char>(random() % 3 ? random() & 0xff : '0' + random() % 10);
      }
      if (random() % 8 == 0) bytes.resize(random() % bytes.size());
      try {
        const CloudFile file = ReadCloud({folder.With(sample.name, bytes)});
        EXPECT_TRUE(file.cloud.points().allFinite());
        EXPECT_EQ(file.points_in_file, file.cloud.size() + file.non_finite + file.filtered);
      } catch (const ReadError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
  }
  if (kMemoryIsTheProgramsOwn) {
    EXPECT_LT(PeakMemory() - before, 100e6);
  }
}

// A file without a known extension is text where its first rows are numbers, and nothing else.
TEST(InputFormatTest, RowsOfNumbersAreTextUnderAnyName) {
  const std::string rows = "0.5 1 2\n1 0 3e-2\n-1 1 nan\n2 2 2\n";
  const TemporaryFolder folder;
  const auto points = [&](const std::string& name, const std::string& text) {
    return ReadCloud({folder.With(name, text)}).cloud.size();
  };
  EXPECT_EQ(points("scan.pwn", rows), 3);
  EXPECT_EQ(points("scan", rows), 3);
  EXPECT_EQ(points("scan.2024", rows), 3);
  EXPECT_EQ(points("scan.text", "# by a scanner\n\n" + rows), 3);
  EXPECT_EQ(points("scan.neu", "x,y,z\n0,1,2\n1,1,1\n"), 2);
  EXPECT_EQ(points("scan.cloud", "2\r\n0;1;2\r\n1;2;3"), 2);
  std::string many;
  for (int k = 0; k < 3000; ++k) many += "1.25 2.5 " + std::to_string(k) + "\n";
  EXPECT_EQ(points("scan.big", many), 3000);
  // What is looked at, 16384 bytes, ends within a row.
  const std::string prose = "#" + std::string(16384 - 12, '-') + "\n";
  EXPECT_EQ(points("scan.prose", prose + "1 2 3\n4.25 5 6\n7 8 9\n"), 3);
}

TEST(InputFormatTest, OtherFilesNeedAWord) {
  const TemporaryFolder folder;
  const auto format = [&](const std::string& name, const std::string& text) {
    return InputFormat(folder.With(name, text));
  };
  EXPECT_THROW(format("notes.md", "# Points\nof two scans\n1 2 3\n"), UsageError);
  EXPECT_THROW(format("empty.foo", ""), UsageError);
  EXPECT_THROW(format("prose.foo", "1 2 words\n3 4 5\n"), UsageError);
  EXPECT_THROW(format("scan.laz", std::string("LASF\0\0 1 2 3\n", 13)), UsageError);
  // Of GoTools: numbers, too.
  EXPECT_THROW(format("part.g2", "200 1 0 0\n3 0\n2 2\n0 0 1 1\n"), UsageError);
  EXPECT_THROW(InputFormat("no such file"), UsageError);
  EXPECT_EQ(InputFormat("missing.ply"), FileFormat::kPly);
  EXPECT_EQ(InputFormat(folder.With("rows.foo", "1 2 3\n"), "xyz"), FileFormat::kXyz);
}

}  // namespace batten::internal::read_cloud_test
