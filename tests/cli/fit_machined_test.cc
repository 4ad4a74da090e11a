// SPDX-License-Identifier: MIT
// Laws of `batten fit parts` and of `batten fit solid --kind`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "part_clouds.h"
#include "test_clouds.h"

namespace batten::internal::fit_machined_command_test {

using ::testing::HasSubstr;
using ::testing::Not;

std::string TextOf(const TruthPart& part, int count, double sigma) {
  std::ostringstream text;
  text.precision(17);
  text << SampledPart(part, count, sigma, 7).points.transpose() << "\n";
  return text.str();
}

TEST(FitPartsCommandTest, WritesFacesLabelsTableAndReport) {
  const TemporaryFolder folder;
  const std::string cloud = folder.With("shaft.xyz", TextOf(ShaftPart(), 12000, 1e-4));
  const ProgramRun run = Batten({"fit",
                                 "parts",
                                 cloud,
                                 "-o",
                                 folder.File("faces.step"),
                                 "--labels",
                                 folder.File("labels.csv"),
                                 "--report",
                                 folder.File("report.json"),
                                 "--report",
                                 folder.File("report.html"),
                                 "--regularise"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("8 faces: rms"));
  EXPECT_THAT(run.out, HasSubstr("cone"));
  EXPECT_THAT(run.out, HasSubstr("are coaxial"));
  const Json report = Json::parse(folder.Text("report.json"));
  ASSERT_EQ(report["faces"].size(), 8u);
  Eigen::Index points = 0;
  for (const Json& face : report["faces"]) {
    points += face["points"].get<int>();
    EXPECT_EQ(face["kind"], face["primitive"]["kind"]);
    EXPECT_FALSE(face["touching"].empty());
  }
  EXPECT_EQ(points, report["input"]["used"]);
  EXPECT_FALSE(report["relations"].empty());
  EXPECT_THAT(folder.Text("faces.step"), HasSubstr("CONICAL_SURFACE"));
  EXPECT_THAT(folder.Text("report.html"), HasSubstr("relations"));
  std::istringstream rows(folder.Text("labels.csv"));
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "x,y,z,red,green,blue,label");
  int labelled = 0;
  while (std::getline(rows, row)) {
    const int label = std::stoi(row.substr(row.rfind(',') + 1));
    EXPECT_LT(label, 8);
    labelled += label >= 0;
  }
  EXPECT_EQ(labelled, points);
}

TEST(FitPartsCommandTest, JsonAloneIsOnStandardOutput) {
  const TemporaryFolder folder;
  const std::string cloud = folder.With("box.xyz", TextOf(BoxPart(), 6000, 1e-4));
  const ProgramRun run = Batten({"fit", "parts", cloud, "-o", folder.File("a.json"), "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(Json::parse(run.out)["faces"].size(), 6u);
  EXPECT_EQ(Json::parse(folder.Text("a.json"))["shape"]["count"], 6);
}

TEST(FitPartsCommandTest, ExitCodesAreThoseOfEveryFit) {
  const TemporaryFolder folder;
  const std::string cloud = folder.With("box.xyz", TextOf(BoxPart(), 6000, 1e-3));
  const std::string few = folder.With("few.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
  const auto code = [&](std::vector<std::string> more, const std::string& points) {
    std::vector<std::string> words{"fit", "parts", points, "-o", folder.File("a.step")};
    words.insert(words.end(), more.begin(), more.end());
    return Batten(words).code;
  };
  EXPECT_EQ(code({"--tolerance", "0.006"}, cloud), 0);
  EXPECT_EQ(code({"--tolerance", "0.002"}, cloud), 3);
  EXPECT_EQ(code({}, few), 1);
  EXPECT_EQ(code({"--labels", folder.File("labels.txt")}, cloud), 2);
  EXPECT_EQ(code({"--labels", cloud}, cloud), 2);
  EXPECT_EQ(code({"--tolerance", "-1"}, cloud), 2);
}

TEST(FitSolidKindTest, CadKeepsEdgesSharp) {
  const TemporaryFolder folder;
  const TruthPart part = FlangePart();
  const std::string cloud = folder.With("flange.xyz", TextOf(part, 16000, 1e-4));
  for (const char* kind : {"cad", "auto"}) {
    const ProgramRun run =
        Batten({"fit", "solid", cloud, "-o", folder.File("a.step"), "--kind", kind});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("a watertight solid of 10 faces"));
    const std::string step = folder.Text("a.step");
    EXPECT_THAT(step, HasSubstr("MANIFOLD_SOLID_BREP"));
    EXPECT_THAT(step, HasSubstr("CYLINDRICAL_SURFACE"));
    EXPECT_THAT(step, Not(HasSubstr("B_SPLINE_SURFACE")));
    const auto at = run.err.find("volume ");
    ASSERT_NE(at, std::string::npos);
    EXPECT_NEAR(std::stod(run.err.substr(at + 7)), part.volume, 1e-3 * part.volume);
  }
}

TEST(FitSolidKindTest, AnotherGenusThanAskedForIsRefused) {
  const TemporaryFolder folder;
  const std::string tube = folder.With("tube.xyz", TextOf(TubePart(), 12000, 1e-4));
  const auto fit = [&](const char* kind, const char* genus) {
    return Batten({"fit",
                   "solid",
                   tube,
                   "-o",
                   folder.File("a.step"),
                   "--kind",
                   kind,
                   "--faces",
                   "200",
                   "--genus",
                   genus});
  };
  ProgramRun run =
      Batten({"fit", "solid", tube, "-o", folder.File("b.step"), "--kind", "cad", "--genus", "1"});
  EXPECT_EQ(run.code, 0) << run.err;
  run =
      Batten({"fit", "solid", tube, "-o", folder.File("c.step"), "--kind", "cad", "--genus", "0"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("its genus is 1, not 0 (--genus)"));
  EXPECT_FALSE(std::filesystem::exists(folder.File("c.step")));
  run = fit("organic", "0");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("its genus is 1, not 0 (--genus)"));
  EXPECT_FALSE(std::filesystem::exists(folder.File("a.step")));
  EXPECT_EQ(fit("organic", "1").code, 0);
  run = fit("organic", "1.5");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("--genus"));
}

TEST(FitSolidKindTest, SaysWhyThereIsNoCadSolid) {
  const TemporaryFolder folder;
  TruthPart open = BoxPart();
  open.faces.pop_back();
  const std::string cloud = folder.With("open.xyz", TextOf(open, 12000, 1e-4));
  const ProgramRun run =
      Batten({"fit", "solid", cloud, "-o", folder.File("a.step"), "--kind", "cad"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("makes no solid of exact faces: the border of face"));
  EXPECT_FALSE(std::filesystem::exists(folder.File("a.step")));
  EXPECT_EQ(
      Batten(
          {"fit", "solid", cloud, "-o", folder.File("a.step"), "--kind", "cad", "--faces", "100"})
          .code,
      2);
}

}  // namespace batten::internal::fit_machined_command_test
