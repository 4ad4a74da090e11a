// SPDX-License-Identifier: MIT
// What files are taken for, told from how they were made.
#include "cli/commands/file_kind.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "batten/io/read_error.h"
#include "test_clouds.h"

namespace batten::internal::file_kind_test {

using std::numbers::pi;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Random = std::mt19937_64;

double Uniform(Random& random) { return std::uniform_real_distribution<double>(0, 1)(random); }

Eigen::Matrix3Xd Noisy(Eigen::Matrix3Xd points, double sigma, Random& random) {
  std::normal_distribution<double> normal(0, 1);
  for (double& coordinate : points.reshaped()) coordinate += sigma * normal(random);
  return points;
}

Eigen::Matrix3Xd Shuffled(const Eigen::Matrix3Xd& points, Random& random) {
  std::vector<Eigen::Index> order(static_cast<size_t>(points.cols()));
  for (size_t k = 0; k < order.size(); ++k) order[k] = static_cast<Eigen::Index>(k);
  std::shuffle(order.begin(), order.end(), random);
  return points(Eigen::all, order);
}

Eigen::Matrix3Xd Helix(Eigen::Index count) {
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = 12.0 * double(k) / double(count - 1);
    points.col(k) << 10 * std::cos(t), 10 * std::sin(t), t;
  }
  return points;
}

// Rows of a bent sheet, one after the other, or there and back.
Eigen::Matrix3Xd Rows(int rows, int columns, double width, double height, bool back_and_forth) {
  Eigen::Matrix3Xd points(3, rows * columns);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int place = back_and_forth && j % 2 == 1 ? columns - 1 - i : i;
      const double x = width * place / (columns - 1), y = height * j / (rows - 1);
      points.col(j * columns + i) << x, y, std::sin(x / width * 3) + 0.2 * y * x / width;
    }
  }
  return points;
}

Eigen::Matrix3Xd Sphere(Eigen::Index count, Random& random) {
  Eigen::Matrix3Xd points = Noisy(Eigen::Matrix3Xd::Zero(3, count), 1, random);
  points.colwise().normalize();
  return points;
}

Eigen::Matrix3Xd Ring(double x, Eigen::Index count) {
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = 2 * pi * double(k) / double(count);
    points.col(k) << x + std::cos(t), std::sin(t), 0;
  }
  return points;
}

Eigen::Matrix3Xd Beside(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  Eigen::Matrix3Xd both(3, a.cols() + b.cols());
  both << a, b;
  return both;
}

FileUse UseOf(const Eigen::Matrix3Xd& points) { return KindOf(PointCloud(points)).use; }

// The same at other places, in other units and the other way round.
std::vector<Eigen::Matrix3Xd> Alike(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  return {points,
          1e-3 * (turn * points),
          (1e4 * points).colwise() + Eigen::Vector3d(3, -5, 1e5),
          points.rowwise().reverse()};
}

TEST(FileKindTest, PointsInOrderAlongALineInSpaceAreACurve) {
  Random random(1);
  for (const double noise : {0.0, 0.01, 0.1}) {
    for (const Eigen::Index count : {60, 200, 2000}) {
      for (const Eigen::Matrix3Xd& points : Alike(Noisy(Helix(count), noise, random)))
        EXPECT_EQ(UseOf(points), FileUse::kCurve) << noise << ' ' << count;
    }
  }
  EXPECT_EQ(UseOf(Shuffled(Noisy(Helix(2000), 0.02, random), random)), FileUse::kCurve);
}

TEST(FileKindTest, PointsOfASurfaceAreNoneThoughTheirRowsFollowOneAnother) {
  Random random(2);
  for (const bool back : {false, true}) {
    for (const Eigen::Matrix3Xd& grid : {Rows(30, 40, 10, 8, back),
                                         Rows(12, 12, 3, 3, back),
                                         Rows(40, 5, 2, 30, back),      // a strip, across …
                                         Rows(5, 200, 60, 1, back)}) {  // … and along
      const std::vector<Eigen::Matrix3Xd> alike = Alike(grid);
      for (size_t k = 0; k < alike.size(); ++k)
        EXPECT_EQ(UseOf(alike[k]), FileUse::kSurface) << grid.cols() << ' ' << back << ' ' << k;
      EXPECT_EQ(UseOf(Shuffled(Noisy(grid, 0.01, random), random)), FileUse::kSurface);
    }
  }
  EXPECT_EQ(UseOf(Sphere(1500, random)), FileUse::kSurface);
}

TEST(FileKindTest, ManyPointsAreTheSameKindAsFew) {
  EXPECT_EQ(UseOf(Helix(60000)), FileUse::kCurve);
  EXPECT_EQ(UseOf(Rows(200, 300, 10, 8, true)), FileUse::kSurface);
}

TEST(FileKindTest, PointsOfThePlaneAreCurvesAllOfThem) {
  Random random(3);
  const Eigen::Matrix3Xd one = Ring(0, 200), two = Beside(one, Ring(5, 300));
  const FileKind single = KindOf(PointCloud(Shuffled(one, random), Eigen::Vector3d::Zero(), 2));
  EXPECT_EQ(single.use, FileUse::kCurve);
  EXPECT_TRUE(single.flags.empty());
  EXPECT_THAT(single.why, HasSubstr("200 points of the plane along a line"));
  const FileKind both = KindOf(PointCloud(two, Eigen::Vector3d::Zero(), 2));
  EXPECT_THAT(both.flags, ElementsAre("--component", "all"));
  EXPECT_THAT(both.why, HasSubstr("2 lines"));
  EXPECT_THAT(both.pick, HasSubstr("--component K"));
  EXPECT_EQ(KindOf(PointCloud(two)).use, FileUse::kCurve);  // in space, though flat
  Eigen::Matrix3Xd scatter = Eigen::Matrix3Xd::Zero(3, 50);
  for (double& place : scatter.topRows(2).reshaped()) place = Uniform(random);
  EXPECT_EQ(KindOf(PointCloud(scatter, Eigen::Vector3d::Zero(), 2)).use, FileUse::kCurve);
}

TEST(FileKindTest, LinesBesideOneAnotherAreSectionsOfASurface) {
  EXPECT_EQ(UseOf(Rows(10, 400, 10, 10, false)), FileUse::kSurface);
}

TEST(FileKindTest, SeparateSheetsAreCounted) {
  const Eigen::Matrix3Xd sheet = Rows(30, 40, 10, 8, false);
  EXPECT_EQ(KindOf(PointCloud(sheet)).pick, "");
  const FileKind kind =
      KindOf(PointCloud(Beside(sheet, sheet.colwise() + Eigen::Vector3d(0, 0, 20))));
  EXPECT_EQ(kind.use, FileUse::kSurface);
  EXPECT_THAT(kind.why, HasSubstr("2 separate parts"));
  EXPECT_THAT(kind.pick, HasSubstr("--part all"));
}

// A box as OFF: its first faces, each of four corners.
std::string Box(int faces) {
  const std::array<std::string, 6> sides = {
      "4 0 3 2 1\n", "4 4 5 6 7\n", "4 0 1 5 4\n", "4 1 2 6 5\n", "4 2 3 7 6\n", "4 3 0 4 7\n"};
  std::string text = "OFF\n8 " + std::to_string(faces) + " 0\n";
  text += "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
  for (int k = 0; k < faces; ++k) text += sides[size_t(k)];
  return text;
}

TEST(FileKindTest, AMeshIsASolidIfItCloses) {
  const TemporaryFolder folder;
  const FileKind closed = KindOf(folder.With("box.off", Box(6)), {});
  EXPECT_EQ(closed.use, FileUse::kSolid);
  EXPECT_THAT(closed.why, HasSubstr("closed mesh of 6 faces"));
  const FileKind open = KindOf(folder.With("open.off", Box(5)), {});
  EXPECT_EQ(open.use, FileUse::kSurface);
  EXPECT_THAT(open.why, HasSubstr("open mesh"));
}

TEST(FileKindTest, FilesAreReadAsTheirCommandWillReadThem) {
  const TemporaryFolder folder;
  std::vector<Row> rows;
  const Eigen::Matrix3Xd ring = Ring(0, 100);
  for (const auto& point : ring.colwise()) rows.push_back({9, point[0], point[1]});
  const std::string path = folder.With("ring.xyz", ToText(rows));
  CloudArguments plane;
  plane.columns = "x=2,y=3";
  EXPECT_THAT(KindOf(path, plane).why, HasSubstr("of the plane"));
  plane.where = {"2=1"};
  EXPECT_THAT(KindOf(path, plane).why, HasSubstr("1 points"));
}

TEST(FileKindTest, LargeCloudsAreNotReadForThis) {
  const TemporaryFolder folder;
  const std::string junk(10 << 20, 'x');  // which no reader takes
  const FileKind large = KindOf(folder.With("large.xyz", junk), {});
  EXPECT_EQ(large.use, FileUse::kSurface);
  EXPECT_THAT(large.why, HasSubstr("not looked at"));
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  EXPECT_THAT(KindOf(folder.With("large.ply", header + junk), {}).why, HasSubstr("not looked at"));
  EXPECT_EQ(KindOf(folder.With("small.xyz", "no number\n"), {}).why, "");
  EXPECT_EQ(KindOf(folder.File("missing.xyz"), {}).why, "");
}

// Reading a pipe for this would leave nothing for the command, or wait for ever.
TEST(FileKindTest, PipesAreLeftToTheirCommand) {
  const TemporaryFolder folder;
  for (const char* const name : {"a.stl", "a.ply", "a.off", "a.xyz", "a.step", "a"}) {
    const std::string path = folder.File(name);
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    const int end = ::open(path.c_str(), O_RDWR);  // a writer, so that nobody waits for one
    ASSERT_EQ(::write(end, "1 2 3\n", 6), 6);
    CloudArguments arguments;
    if (std::string(name) == "a") arguments.format = "text";
    const FileKind kind = KindOf(path, arguments);
    EXPECT_EQ(kind.use, std::string(name) == "a.step" ? FileUse::kInfo : FileUse::kSurface) << name;
    char left[8];
    EXPECT_EQ(::read(end, left, sizeof left), 6) << name;
    ::close(end);
  }
}

TEST(FileKindTest, NamesThatNoSystemTakesAreThoseOfMissingFiles) {
  for (const char* const extension : {".step", ".xyz", ".stl"})
    EXPECT_EQ(KindOf(std::string(300, 'a') + extension, {}).why, "") << extension;
  const ProgramRun run = Batten({std::string(300, 'a') + ".step"});
  EXPECT_NE(run.code, 0);
  EXPECT_THAT(run.err, ::testing::Not(HasSubstr("filesystem error")));
}

// The kind is told from the points that the command will fit.
TEST(FileKindTest, AProjectionCountsForTheKind) {
  const TemporaryFolder folder;
  // A row of 300 m to the east and the north at 60 degrees of latitude, with heights: in degrees
  // a rod, in metres a sheet.
  std::vector<Row> rows;
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 24; ++j)
      rows.push_back({10 + 2.4e-4 * i, 60 + 1.2e-4 * j, 90 + 10 * std::sin(0.1 * i) + 0.2 * j});
  const std::string path = folder.With("sheet.xyz", ToText(rows));
  CloudArguments local;
  local.projection = "local";
  const FileKind kind = KindOf(path, local);
  EXPECT_EQ(kind.use, FileUse::kSurface);
  const ProgramRun run = Batten({path, "--projection", "nowhere", "-o", folder.File("a.step")});
  EXPECT_EQ(run.code, 2);
  // Not looked at by other words than the command's.
  EXPECT_THAT(run.err, ::testing::Not(HasSubstr("points")));
}

// Points of degrees are held against a geometry only about a place that is fixed.
TEST(FileKindTest, DegreesAreComparedAboutTheMiddleOfTheFit) {
  const TemporaryFolder folder;
  std::vector<Row> rows, half;
  for (int i = 0; i < 24; ++i) {
    for (int j = 0; j < 24; ++j) {
      rows.push_back({10 + 2.4e-4 * i, 60 + 1.2e-4 * j, 90 + 10 * std::sin(0.1 * i) + 0.2 * j});
      if (i < 12) half.push_back(rows.back());
    }
  }
  const std::string all = folder.With("all.csv", ToText(rows, "lon lat z\n")),
                    west = folder.With("west.csv", ToText(half, "lon lat z\n")),
                    out = folder.File("out.json"), report = folder.File("report.json");
  const ProgramRun fit = Batten({"fit", "surface", all, "-o", out, "--report", report});
  ASSERT_EQ(fit.code, 0) << fit.err;
  const std::string words = Json::parse(folder.Text("report.json"))["warnings"].dump();
  const size_t at = words.find("local=");
  ASSERT_NE(at, std::string::npos) << words;
  const std::string middle = words.substr(at, words.find(')', at) - at);
  for (const char* const command : {"compare", "project"}) {
    const ProgramRun refused = Batten({command, out, west});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.err, HasSubstr("--projection local=LON,LAT"));
    EXPECT_THAT(refused.err, HasSubstr("the middle of these points is 10.00132,60.00138"));
    EXPECT_EQ(Batten({command, out, west, "--projection", middle}).code, 0);
  }
  const std::string distances = folder.File("distances.json");
  Batten({"compare", out, west, "--projection", middle, "--report", distances});
  EXPECT_LT(Json::parse(folder.Text("distances.json"))["error"]["rms"].get<double>(), 0.1);
}

TEST(FileKindTest, WordsAreThoseOfTheCommands) {
  for (const char* const word : {"curve", "surface", "primitive", "parts", "solid", "info"})
    EXPECT_STREQ(NameOf(UseNamed(word)), word);
  EXPECT_THROW(UseNamed("curves"), UsageError);
  EXPECT_THROW(UseNamed(""), UsageError);
}

}  // namespace batten::internal::file_kind_test
