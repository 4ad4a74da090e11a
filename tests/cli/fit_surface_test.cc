// SPDX-License-Identifier: MIT
// Laws of `batten fit surface` and `batten compare`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_clouds.h"

namespace batten::internal::fit_surface_test {

using ::testing::HasSubstr;

constexpr double kSameNumbers = 1e-9;  // relative: the same sums in another order

class FitSurfaceCommandTest : public ::testing::Test {
 protected:
  // Fits and returns the report; the geometry is in `out`.
  Json Fit(std::vector<std::string> arguments, const std::string& out, int code = 0) {
    arguments.insert(arguments.begin(), {"fit", "surface"});
    arguments.insert(arguments.end(), {"-o", folder_.File(out), "--json"});
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    return Json::parse(run.out);
  }

  static void ExpectSameErrors(const Json& a, const Json& b) {
    for (const char* key : {"rms",
                            "mean",
                            "max",
                            "p50",
                            "p95",
                            "p99",
                            "signed_p5",
                            "signed_p95",
                            "within_tolerance"}) {
      EXPECT_NEAR(a[key].get<double>(), b[key].get<double>(), kSameNumbers * a["max"].get<double>())
          << key;
    }
  }

  TemporaryFolder folder_;
  std::string cloud_ = folder_.With("cloud.xyz", ToText(WavySheet(3000)));
};

TEST_F(FitSurfaceCommandTest, ReportHasEveryFieldOfTheContract) {
  const Json report = Fit({cloud_, "--tolerance", "0.05"}, "out.json");
  EXPECT_EQ(report["schema"], "batten-report-2");
  for (const char* key : {"command",
                          "input",
                          "geometry",
                          "error",
                          "error_all",
                          "optimize",
                          "termination",
                          "tolerance_reached",
                          "iterations",
                          "seconds",
                          "peak_memory_bytes",
                          "threads",
                          "warnings",
                          "version"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  for (const char* key : {"files",
                          "points",
                          "used",
                          "non_finite",
                          "duplicates",
                          "outliers",
                          "spacing",
                          "noise",
                          "bounding_box",
                          "origin",
                          "unit"}) {
    EXPECT_TRUE(report["input"].contains(key)) << key;
  }
  for (const char* key :
       {"kind", "base", "degree", "control_points", "rational", "closed", "trims", "file"}) {
    EXPECT_TRUE(report["geometry"].contains(key)) << key;
  }
  for (const char* key : {"ran", "why", "iterations", "rms_before", "rms_after"}) {
    EXPECT_TRUE(report["optimize"].contains(key)) << key;
  }
  for (const char* key : {"read",
                          "prepare",
                          "parameterize",
                          "solve",
                          "project",
                          "refine",
                          "optimize",
                          "trim",
                          "write",
                          "total"}) {
    EXPECT_TRUE(report["seconds"].contains(key)) << key;
  }
  EXPECT_EQ(report["error"]["kind"], "orthogonal");
  EXPECT_EQ(report["error"]["tolerance"], 0.05);
  EXPECT_EQ(report["tolerance_reached"], true);
  EXPECT_EQ(report["termination"], "tolerance_reached");
  EXPECT_EQ(report["input"]["points"], 3000);
  EXPECT_GT(report["iterations"].size(), 0u);
}

TEST_F(FitSurfaceCommandTest, CompareMeasuresOnTheWrittenFileWhatTheFitReported) {
  for (const char* out : {"out.json", "out.step"}) {
    const Json fitted = Fit({cloud_, "--tolerance", "0.01"}, out, 3);
    const ProgramRun run =
        Batten({"compare", folder_.File(out), cloud_, "--tolerance", "0.01", "--json"});
    EXPECT_EQ(run.code, 3);
    const Json compared = Json::parse(run.out);
    ExpectSameErrors(fitted["error_all"], compared["error"]);
    EXPECT_EQ(fitted["geometry"]["control_points"], compared["geometry"]["control_points"]);
    EXPECT_EQ(fitted["input"]["bounding_box"], compared["input"]["bounding_box"]);
  }
}

TEST_F(FitSurfaceCommandTest, OutliersCountInErrorAllButNotInError) {
  std::vector<Row> rows = WavySheet(3000);
  for (int k = 0; k < 30; ++k) rows[100 * k][2] += 3 + 0.1 * k;
  const Json report = Fit({folder_.With("out.xyz", ToText(rows))}, "out.json");
  EXPECT_GE(report["input"]["outliers"], 30);
  EXPECT_LE(report["input"]["outliers"], 60);
  EXPECT_LT(report["error"]["rms"], 0.01);
  EXPECT_GT(report["error_all"]["max"], 2.5);
  const Json compared = Json::parse(
      Batten({"compare", folder_.File("out.json"), folder_.File("out.xyz"), "--json"}).out);
  ExpectSameErrors(report["error_all"], compared["error"]);
}

TEST_F(FitSurfaceCommandTest, ToleranceBelowTheNoiseIsExitCode3AndTheResultIsWritten) {
  const std::string out = folder_.File("out.step");
  const ProgramRun run = Batten({"fit", "surface", cloud_, "-o", out, "--tolerance", "1e-4"});
  EXPECT_EQ(run.code, 3) << run.err;
  EXPECT_THAT(run.out, HasSubstr("out of tolerance 0.0001"));
  EXPECT_EQ(Batten({"info", out, "--quiet"}).code, 0);
}

TEST_F(FitSurfaceCommandTest, ACloudFarFromZeroFitsAsWellAsAtTheOrigin) {
  std::vector<Row> far = WavySheet(3000);
  for (Row& row : far) {
    row[0] += 500000;
    row[1] += 5400000;
    row[2] += 300;
  }
  const std::string path = folder_.With("far.xyz", ToText(far));
  const Json at_zero = Fit({cloud_}, "zero.json"), kept = Fit({path, "--unit", "m"}, "far.json");
  const Json local = Fit({path, "--origin", "local", "--unit", "m"}, "local.json");
  constexpr double kRelative = 1e-6, kRounding = 1e-8;  // 5400000 has an ulp of 1e-9
  for (const Json& report : {kept, local}) {
    EXPECT_EQ(report["geometry"]["control_points"], at_zero["geometry"]["control_points"]);
    const double rms = at_zero["error"]["rms"];
    EXPECT_NEAR(report["error"]["rms"].get<double>(), rms, kRelative * rms);
  }
  EXPECT_THAT(kept["warnings"].dump(), HasSubstr("--origin local"));
  EXPECT_THAT(local["warnings"].dump(), ::testing::Not(HasSubstr("--origin local")));

  // The shift that the report names is all that lies between the two files.
  const Json shift = local["input"]["shift"];
  EXPECT_GT(shift[1], 5399000);
  const Json kept_points = Entry(folder_.Text("far.json"))["control_points"]["points"];
  Json moved = Entry(folder_.Text("local.json"))["control_points"]["points"];
  for (Json& point : moved) {
    for (std::size_t d = 0; d < 3; ++d) point[d] = point[d].get<double>() + shift[d].get<double>();
  }
  EXPECT_LT(Difference(kept_points, moved), kRounding);
}

TEST_F(FitSurfaceCommandTest, AGivenOriginIsSubtracted) {
  const Json report = Fit({cloud_, "--origin", "1,2,3"}, "moved.json");
  Fit({cloud_}, "out.json");
  EXPECT_EQ(report["input"]["shift"], Json({1.0, 2.0, 3.0}));
  const Json points = Entry(folder_.Text("out.json"))["control_points"]["points"];
  const Json moved = Entry(folder_.Text("moved.json"))["control_points"]["points"];
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(
        points[0][d].get<double>() - moved[0][d].get<double>(), static_cast<double>(d + 1), 1e-12);
  }
}

TEST_F(FitSurfaceCommandTest, PermutedColumnsGiveTheSameFit) {
  std::vector<Row> rows = WavySheet(3000);
  for (Row& row : rows) row = {7, row[2], row[0], row[1]};
  Fit({cloud_}, "plain.json");
  Fit({folder_.With("p.xyz", ToText(rows)), "--columns", "x=3,y=4,z=2"}, "numbered.json");
  Fit({folder_.With("n.xyz", ToText(rows, "id h east north\n")), "--columns", "x=east,y=north,z=h"},
      "named.json");
  EXPECT_EQ(folder_.Text("numbered.json"), folder_.Text("plain.json"));
  EXPECT_EQ(folder_.Text("named.json"), folder_.Text("plain.json"));
}

TEST_F(FitSurfaceCommandTest, WhereAndBoxKeepTheRowsTheyName) {
  std::vector<Row> labelled = WavySheet(3000), boxed;
  for (const Row& row : labelled) {
    if (row[0] <= 5 && row[1] <= 4) boxed.push_back(row);
  }
  for (Row& row : labelled) row.push_back(1);
  std::mt19937_64 engine(3);
  for (int k = 0; k < 500; ++k) {
    labelled.insert(labelled.begin() + static_cast<std::ptrdiff_t>(engine() % labelled.size()),
                    Row{5, 3, 0.01 * k, 2});
  }
  Fit({cloud_}, "plain.json");
  const std::string path = folder_.With("labelled.xyz", ToText(labelled, "x y z label\n"));
  for (const char* filter : {"label=1", "4=1"}) {
    const Json report = Fit({path, "--where", filter}, "where.json");
    EXPECT_EQ(report["input"]["points"], 3000);
    EXPECT_EQ(folder_.Text("where.json"), folder_.Text("plain.json"));
  }
  Fit({folder_.With("boxed.xyz", ToText(boxed))}, "boxed.json");
  Fit({cloud_, "--box", "0,0,-9,5,4,9"}, "box.json");
  EXPECT_EQ(folder_.Text("box.json"), folder_.Text("boxed.json"));
}

TEST_F(FitSurfaceCommandTest, SeveralFilesAreOneCloud) {
  const std::vector<Row> rows = WavySheet(3000);
  const std::string a = folder_.With("a.xyz", ToText({rows.begin(), rows.begin() + 1000}));
  const std::string b = folder_.With("b.csv", ToText({rows.begin() + 1000, rows.end()}));
  Fit({cloud_}, "one.json");
  const Json report = Fit({a, b}, "two.json");
  EXPECT_EQ(report["input"]["files"], Json({a, b}));
  EXPECT_EQ(folder_.Text("two.json"), folder_.Text("one.json"));
}

TEST_F(FitSurfaceCommandTest, SameThreadsSameBytesAndOtherThreadsSameNumbers) {
  for (const char* format : {"json", "step"}) {
    const std::string a = std::string("a.") + format, b = std::string("b.") + format;
    Fit({cloud_, "--threads", "2"}, a);
    Fit({cloud_, "--threads", "2"}, b);
    EXPECT_EQ(folder_.Text(a), folder_.Text(b)) << format;
  }
  Fit({cloud_, "--threads", "1"}, "one.json");
  EXPECT_LT(Difference(Entry(folder_.Text("one.json")), Entry(folder_.Text("a.json"))), 1e-9);
}

TEST_F(FitSurfaceCommandTest, NonFiniteAndDuplicatePointsAreCounted) {
  std::vector<Row> rows = WavySheet(1000);
  rows.push_back(rows[0]);
  rows.push_back(rows[1]);
  const std::string path = folder_.With("dirty.xyz", ToText(rows) + "nan 1 2\n1 inf 3\n1 2 -nan\n");
  const Json input = Fit({path}, "out.json")["input"];
  EXPECT_EQ(input["points"], 1005);
  EXPECT_EQ(input["non_finite"], 3);
  EXPECT_EQ(input["duplicates"], 2);
}

TEST_F(FitSurfaceCommandTest, FixedControlPointsAndDegreesAreKept) {
  const Json report = Fit({cloud_, "--degree", "4,2", "--control-points", "9,7"}, "out.json");
  EXPECT_EQ(report["geometry"]["degree"], Json({4, 2}));
  EXPECT_EQ(report["geometry"]["control_points"], Json({9, 7}));
}

TEST_F(FitSurfaceCommandTest, ResidualsHoldTheDistancesTheReportSumsUp) {
  const std::string csv = folder_.File("r.csv"), ply = folder_.File("r.ply");
  const Json report = Fit({cloud_, "--residuals", csv}, "out.json");
  Fit({cloud_, "--residuals", ply}, "out.json");
  std::istringstream rows(folder_.Text("r.csv"));
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "x,y,z,distance,u,v,outlier");
  double squares = 0;
  int count = 0;
  for (; std::getline(rows, row); ++count) {
    std::size_t at = 0;
    for (int k = 0; k < 3; ++k) at = row.find(',', at) + 1;
    squares += std::pow(std::stod(row.substr(at)), 2);
  }
  EXPECT_EQ(count, 3000);
  const double rms = report["error_all"]["rms"];
  EXPECT_NEAR(std::sqrt(squares / count), rms, kSameNumbers * rms);
  EXPECT_EQ(Json::parse(Batten({"info", ply, "--json"}).out)["points"], 3000);
}

TEST_F(FitSurfaceCommandTest, ReportFilesSayWhatStandardOutputSays) {
  const std::string a = folder_.File("a.json"), b = folder_.File("b.json");
  Json printed = Fit({cloud_, "--report", a, "--report", b}, "out.json");
  Json written = Json::parse(folder_.Text("a.json"));
  EXPECT_EQ(written["error"], printed["error"]);
  EXPECT_EQ(written["geometry"], printed["geometry"]);
  EXPECT_TRUE(std::filesystem::exists(b));
}

TEST_F(FitSurfaceCommandTest, StandardInputAndOutputStandForFiles) {
  Fit({cloud_}, "file.json");
  const ProgramRun run =
      Batten({"fit", "surface", "-", "-o", "-", "--format", "text", "--output-format", "json"},
             {ToText(WavySheet(3000)), {}});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, folder_.Text("file.json"));
  EXPECT_EQ(Batten({"compare", "-", cloud_, "--format", "json", "--quiet"}, {run.out, {}}).code, 0);
  EXPECT_EQ(Batten({"compare", folder_.File("file.json"), "-", "--format", "text"},
                   {"1 2 0.5\n2 3 0\n", {}})
                .code,
            0);
}

TEST_F(FitSurfaceCommandTest, DevicesAreWrittenAndLinksAreFollowed) {
  EXPECT_EQ(
      Batten({"fit", "surface", cloud_, "-o", "/dev/stdout", "--output-format", "json", "--quiet"})
          .code,
      0);
  folder_.With("real.json", "old");
  std::filesystem::create_symlink("real.json", folder_.File("link.json"));
  Fit({cloud_}, "link.json");
  EXPECT_TRUE(std::filesystem::is_symlink(folder_.File("link.json")));
  EXPECT_THAT(folder_.Text("real.json"), HasSubstr("\"surface\""));
}

}  // namespace batten::internal::fit_surface_test
