// SPDX-License-Identifier: MIT
// Laws of `batten fit surface` on bent sheets: bases, what the report says of them, refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "test_clouds.h"
#include "wings.h"

namespace batten::internal::fit_sheet_test {

using ::testing::HasSubstr;

constexpr double kSameNumbers = 1e-9;  // relative: the same sums in another order

// Uniform and normal numbers that are the same everywhere.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : engine_(seed) {}
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double Normal() {
    const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
    return radius * std::cos(2 * std::numbers::pi * Uniform());
  }

 private:
  std::mt19937_64 engine_;
};

constexpr double kNoise = 0.002;

// Part of a cylinder of radius 1 and height 1.5, with normal noise of deviation 0.002 in every
// coordinate.
std::vector<Row> Arc(double degrees, int points, std::uint64_t seed = 1) {
  Chance chance(seed);
  std::vector<Row> rows;
  for (int k = 0; k < points; ++k) {
    const double angle = degrees * std::numbers::pi / 180 * chance.Uniform();
    Row row{std::cos(angle), std::sin(angle), 1.5 * chance.Uniform()};
    for (double& x : row) x += kNoise * chance.Normal();
    rows.push_back(row);
  }
  return rows;
}

class FitSheetCommandTest : public ::testing::Test {
 protected:
  ProgramRun Run(std::vector<std::string> arguments, const std::string& out) {
    arguments.insert(arguments.begin(), {"fit", "surface"});
    arguments.insert(arguments.end(), {"-o", folder_.File(out), "--json"});
    return Batten(arguments);
  }

  // Fits and returns the report; the geometry is in `out`.
  Json Fit(const std::vector<std::string>& arguments, const std::string& out, int code = 0) {
    const ProgramRun run = Run(arguments, out);
    EXPECT_EQ(run.code, code) << run.err;
    return Json::parse(run.out);
  }

  // Exit 1 with a reason of one line, nothing written: the reason.
  std::string Refusal(const std::vector<std::string>& arguments) {
    const ProgramRun run = Run(arguments, "none.json");
    EXPECT_EQ(run.code, 1) << run.out;
    EXPECT_EQ(run.error_lines(), 1);
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder_.File("none.json")));
    return run.err;
  }

  TemporaryFolder folder_;
  std::string arc_ = folder_.With("arc.xyz", ToText(Arc(240, 3000)));
};

TEST_F(FitSheetCommandTest, FindsTheBaseItselfAndSaysWhichWhyAndHowMuchLengthsChange) {
  const Json bent = Fit({arc_}, "arc.json")["geometry"];
  EXPECT_EQ(bent["base"], "sheet");
  EXPECT_THAT(bent["base_why"].get<std::string>(), HasSubstr("over each other"));
  EXPECT_GE(bent["distortion"], 0);
  EXPECT_LE(bent["distortion"], 0.02);  // a cylinder's part can be laid out flat
  const std::string wavy = folder_.With("wavy.xyz", ToText(WavySheet(3000)));
  const Json flat = Fit({wavy}, "wavy.json")["geometry"];
  EXPECT_EQ(flat["base"], "plane");
  EXPECT_THAT(flat["base_why"].get<std::string>(), HasSubstr("height field"));
  EXPECT_GT(flat["distortion"], bent["distortion"]);  // over a plane, slopes are longer
}

TEST_F(FitSheetCommandTest, TheResidualsOfABentSheetAreTheNoise) {
  const Json report = Fit({arc_}, "arc.json");
  EXPECT_NEAR(report["error"]["rms"].get<double>(), kNoise, 0.1 * kNoise);
  EXPECT_NEAR(report["input"]["noise"].get<double>(), kNoise, 0.1 * kNoise);
  EXPECT_EQ(report["termination"], "noise_reached");
  EXPECT_EQ(report["input"]["outliers"], 0);
}

TEST_F(FitSheetCommandTest, TakesTheBaseAskedFor) {
  Fit({arc_}, "auto.json");
  const Json report = Fit({arc_, "--base", "sheet"}, "sheet.json");
  EXPECT_EQ(report["geometry"]["base"], "sheet");
  EXPECT_EQ(report["geometry"]["base_why"].get<std::string>().find("asked for"), 0u);
  EXPECT_EQ(folder_.Text("sheet.json"), folder_.Text("auto.json"));

  const std::string wavy = folder_.With("wavy.xyz", ToText(WavySheet(3000)));
  const Json plane = Fit({wavy, "--base", "plane"}, "plane.json");
  const Json laid = Fit({wavy, "--base", "sheet"}, "laid.json");
  EXPECT_EQ(plane["geometry"]["base"], "plane");
  EXPECT_EQ(laid["geometry"]["base"], "sheet");
  EXPECT_NEAR(laid["error"]["rms"].get<double>(), plane["error"]["rms"].get<double>(), 5e-4);
}

TEST_F(FitSheetCommandTest, LaysAWingRoundItsNoseWhenAskedToOrOnItsOwn) {
  const WingCloud cloud = PointsOverWing(MapOf({}), 15000, 5e-4, 21);
  std::vector<Row> rows;
  for (const auto& p : cloud.points.colwise()) rows.push_back({p[0], p[1], p[2]});
  const std::string wing = folder_.With("wing.xyz", ToText(rows));
  for (const std::string base : {"auto", "wing"}) {
    const Json report = Fit({wing, "--base", base}, base + ".json");
    EXPECT_THAT(report["geometry"]["base_why"].get<std::string>(), HasSubstr("round the nose"));
    EXPECT_LT(report["error"]["rms"].get<double>(), 1.1 * 5e-4) << base;
  }
  EXPECT_NE(Refusal({arc_, "--base", "wing"}), "");
}

TEST_F(FitSheetCommandTest, APlaneAskedForUnderABentSheetIsRefusedAndTheWayOutNamed) {
  EXPECT_THAT(Refusal({arc_, "--base", "plane"}), HasSubstr("--base sheet"));
}

TEST_F(FitSheetCommandTest, ABaseOfNoKnownNameIsAUsageError) {
  const ProgramRun run = Run({arc_, "--base", "shet"}, "none.json");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("sheet"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("none.json")));
}

TEST_F(FitSheetCommandTest, OneSidedAndSeveralSheetsAndNoneAreRefusedWithWhatToDo) {
  Chance chance(3);
  std::vector<Row> band, ball, parts = Arc(200, 3000), twins = Arc(200, 6000);
  for (int k = 0; k < 6000; ++k) {
    const double angle = 2 * std::numbers::pi * chance.Uniform();
    const double across = 0.6 * (chance.Uniform() - 0.5);
    const double radius = 1 + across * std::cos(angle / 2);
    band.push_back(
        {radius * std::cos(angle), radius * std::sin(angle), across * std::sin(angle / 2)});
    Row row{chance.Normal(), chance.Normal(), chance.Normal()};
    const double length = std::hypot(row[0], row[1], row[2]);
    for (double& x : row) x /= length;
    ball.push_back(row);
  }
  for (std::size_t k = 0; k < parts.size(); k += 3) parts[k][0] += 40;
  const double apart = 2 * std::sqrt(200 * std::numbers::pi / 180 * 1.5 / 3000);
  for (std::size_t k = 0; k < twins.size(); k += 2) {
    for (int d = 0; d < 2; ++d) twins[k][d] *= 1 + apart;
  }
  const struct {
    const char* name;
    std::vector<Row> rows;
    const char* word;
    const char* advice;
  } cases[] = {{"band.xyz", band, "one-sided", "fit a part of the cloud"},
               {"parts.xyz", parts, "apart", "fit one part of the cloud at a time"},
               {"twins.xyz", twins, "two sheets", "fit one of them (--part, --box, --where)"}};
  for (const auto& [name, rows, word, advice] : cases) {
    SCOPED_TRACE(name);
    const std::string reason = Refusal({folder_.With(name, ToText(rows))});
    EXPECT_THAT(reason, HasSubstr(word));
    EXPECT_THAT(reason, HasSubstr(advice));
    EXPECT_THAT(reason, HasSubstr(name));
  }
  // A ball closes, but is no sheet.
  const std::string reason = Refusal({folder_.With("ball.xyz", ToText(ball)), "--base", "sheet"});
  EXPECT_THAT(reason, HasSubstr("closed"));
  EXPECT_THAT(reason, HasSubstr("fit a part of the cloud"));
}

// What a refusal recommends works.
TEST_F(FitSheetCommandTest, ABoxAroundAPartOfAClosedShapeFits) {
  const std::string pipe = folder_.With("pipe.xyz", ToText(Arc(360, 6000)));
  const Json report = Fit({pipe, "--box", "-0.5,-2,-2,2,2,4"}, "part.json");
  EXPECT_EQ(report["geometry"]["base"], "sheet");
  EXPECT_NEAR(report["error"]["rms"].get<double>(), kNoise, 0.1 * kNoise);
}

TEST_F(FitSheetCommandTest, ResidualsNameTheOutliersAndHoldTheDistancesTheReportSumsUp) {
  std::vector<Row> rows = Arc(240, 4000);
  for (std::size_t k = 0; k < rows.size(); k += 100) {
    for (int d = 0; d < 2; ++d) rows[k][d] *= 1.2;  // 100 sigma off
  }
  const std::string csv = folder_.File("r.csv");
  const Json report =
      Fit({folder_.With("dirty.xyz", ToText(rows)), "--residuals", csv}, "out.json");
  std::istringstream lines(folder_.Text("r.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x,y,z,distance,u,v,outlier");
  int count = 0, flagged = 0, missed = 0;
  double squares = 0;
  for (; std::getline(lines, line); ++count) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    double x, y, z, distance, u, v;
    int outlier;
    ASSERT_TRUE(numbers >> x >> y >> z >> distance >> u >> v >> outlier) << line;
    ASSERT_TRUE(outlier == 0 || outlier == 1) << line;
    flagged += outlier;
    if (count % 100 == 0 && outlier == 0) ++missed;
    if (outlier == 0) squares += distance * distance;
  }
  EXPECT_EQ(count, 4000);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(report["input"]["outliers"], flagged);
  EXPECT_EQ(report["input"]["used"], count - flagged);
  EXPECT_LE(flagged, 40 + 40);  // 1 % of the good ones
  const double rms = report["error"]["rms"];
  EXPECT_NEAR(std::sqrt(squares / (count - flagged)), rms, kSameNumbers * rms);
  EXPECT_GT(report["error_all"]["max"], 0.1);
}

TEST_F(FitSheetCommandTest, CompareMeasuresOnTheWrittenFileWhatTheFitReported) {
  for (const char* out : {"out.json", "out.step"}) {
    SCOPED_TRACE(out);
    const Json fitted = Fit({arc_, "--tolerance", "0.01"}, out);
    EXPECT_EQ(fitted["tolerance_reached"], true);
    const ProgramRun run =
        Batten({"compare", folder_.File(out), arc_, "--tolerance", "0.01", "--json"});
    EXPECT_EQ(run.code, 0);
    const Json compared = Json::parse(run.out);
    for (const char* key : {"rms", "mean", "max", "p95", "within_tolerance"}) {
      const double value = fitted["error_all"][key];
      EXPECT_NEAR(compared["error"][key].get<double>(), value, kSameNumbers * value) << key;
    }
    EXPECT_EQ(fitted["geometry"]["control_points"], compared["geometry"]["control_points"]);
  }
}

TEST_F(FitSheetCommandTest, AToleranceBelowTheNoiseIsExitCode3AndTheResultIsWritten) {
  const Json report = Fit({arc_, "--tolerance", "2e-4"}, "out.step", 3);
  EXPECT_EQ(report["tolerance_reached"], false);
  EXPECT_EQ(Batten({"info", folder_.File("out.step"), "--quiet"}).code, 0);
}

TEST_F(FitSheetCommandTest, SameThreadsSameBytesAndOtherThreadsSameNumbers) {
  for (const char* format : {"json", "step"}) {
    const std::string a = std::string("a.") + format, b = std::string("b.") + format;
    Fit({arc_, "--threads", "2"}, a);
    Fit({arc_, "--threads", "2"}, b);
    EXPECT_EQ(folder_.Text(a), folder_.Text(b)) << format;
  }
  Fit({arc_, "--threads", "1"}, "one.json");
  EXPECT_LT(Difference(Entry(folder_.Text("one.json")), Entry(folder_.Text("a.json"))), 1e-9);
}

TEST_F(FitSheetCommandTest, ACloudFarFromZeroFitsAsWellAsAtTheOrigin) {
  std::vector<Row> far = Arc(240, 3000);
  for (Row& row : far) {
    row[0] += 500000;
    row[1] += 5400000;
  }
  const Json near = Fit({arc_}, "near.json");
  const Json moved = Fit({folder_.With("far.xyz", ToText(far)), "--unit", "m"}, "far.json");
  EXPECT_EQ(moved["geometry"]["base"], near["geometry"]["base"]);
  // Coordinates of 5.4e6 are known to 1e-9.
  const double rms = near["error"]["rms"];
  EXPECT_NEAR(moved["error"]["rms"].get<double>(), rms, 1e-3 * rms);
}

}  // namespace batten::internal::fit_sheet_test
