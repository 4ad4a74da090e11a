// SPDX-License-Identifier: MIT
// Units, names and schemas of geometry files through the commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>

#include <string>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/io/geometry_file.h"
#include "test_clouds.h"

namespace batten::internal::exchange_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class ExchangeTest : public ::testing::Test {
 protected:
  ExchangeTest() {
    WriteGeometry({folder_.File("part.step"), {sphere_, sheet_}, {"ball", "floor"}}, {.unit = "m"});
  }

  static void Run(const std::vector<std::string>& arguments) {
    const ProgramRun run = Batten(arguments);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
  }
  static Json RunJson(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out);
  }
  GeometryContents Contents(const std::string& name) {
    return ReadGeometryContents(folder_.File(name));
  }

  TemporaryFolder folder_;
  NurbsSurface sphere_ = MakeSphere(Frame(), 2);
  NurbsSurface sheet_ = MakeBilinear({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {4, 3, 1});
};

TEST_F(ExchangeTest, ConvertKeepsTheUnitAndTheNames) {
  for (const char* name : {"a.step", "a.iges", "a.json"}) {
    Run({"convert", folder_.File("part.step"), folder_.File(name)});
    const GeometryContents contents = Contents(name);
    EXPECT_EQ(contents.unit, "m") << name;
    EXPECT_THAT(contents.names, ElementsAre("ball", "floor")) << name;
    const auto& sheet = std::get<NurbsSurface>(contents.geometry[1]);
    EXPECT_TRUE(sheet.control_points().isApprox(sheet_.control_points(), 1e-14)) << name;
  }
}

TEST_F(ExchangeTest, ConvertTurnsLengthsIntoTheUnitAskedFor) {
  for (const char* name : {"a.step", "a.iges", "a.json"}) {
    Run({"convert", folder_.File("part.step"), folder_.File(name), "--unit", "mm"});
    const GeometryContents contents = Contents(name);
    EXPECT_EQ(contents.unit, std::string(name) == "a.json" ? "" : "mm") << name;
    const auto& sheet = std::get<NurbsSurface>(contents.geometry[1]);
    EXPECT_TRUE(sheet.control_points().isApprox(1000 * sheet_.control_points(), 1e-14)) << name;
  }
}

TEST_F(ExchangeTest, InfoSaysUnitNamesAndHowManyThereAre) {
  const Json info = RunJson({"info", folder_.File("part.step")});
  EXPECT_EQ(info["unit"], "m");
  EXPECT_EQ(info["surfaces"], 2);
  EXPECT_EQ(info["curves"], 0);
  EXPECT_EQ(info["results"][0]["name"], "ball");
  EXPECT_EQ(info["results"][0]["shape"], "sphere");
  EXPECT_EQ(info["results"][1]["name"], "floor");
  const ProgramRun text = Batten({"info", folder_.File("part.step")});
  EXPECT_THAT(text.out, AllOf(HasSubstr(" m, from "), HasSubstr("floor")));
}

TEST_F(ExchangeTest, EditedPiecesKeepTheirNameAndTheUnit) {
  Run({"edit", folder_.File("part.step"), "-o", folder_.File("half.step"), "split:dir=v,at=0.5"});
  EXPECT_THAT(Contents("half-1.step").names, ElementsAre("ball"));
  EXPECT_THAT(Contents("half-4.step").names, ElementsAre("floor"));
  EXPECT_EQ(Contents("half-4.step").unit, "m");
  Run({"section",
       folder_.File("part.step"),
       "--plane",
       "0,0,1,-0.5",
       "-o",
       folder_.File("cut.iges")});
  EXPECT_THAT(Contents("cut.iges").names, ElementsAre("ball", "floor"));
  EXPECT_EQ(Contents("cut.iges").unit, "m");
}

TEST_F(ExchangeTest, ComparisonsAreInTheUnitOfTheGeometryOrTheOneAskedFor) {
  // A point 10 mm off the sphere of 2 m, far from the sheet.
  const std::string points =
      folder_.With("points.xyz", "0 0 -2.01\n0 2 0\n0 0 2\n-2 0 0\n0 -2 0\n");
  const std::string in_mm =
      folder_.With("mm.xyz", "0 0 -2010\n0 2000 0\n0 0 2000\n-2000 0 0\n0 -2000 0\n");
  const Json metres = RunJson({"compare", folder_.File("part.step"), points});
  EXPECT_EQ(metres["input"]["unit"], "m");
  EXPECT_NEAR(metres["error"]["max"].get<double>(), 0.01, 1e-12);
  const Json mm = RunJson({"compare", folder_.File("part.step"), in_mm, "--unit", "mm"});
  EXPECT_EQ(mm["input"]["unit"], "mm");
  EXPECT_NEAR(mm["error"]["max"].get<double>(), 10, 1e-9);
}

TEST_F(ExchangeTest, TheStepSchemaIsTheOneAskedFor) {
  Run({"convert", folder_.File("part.step"), folder_.File("214.step")});
  Run({"convert", folder_.File("part.step"), folder_.File("242.step"), "--step-schema", "ap242"});
  Run({"make",
       "line",
       "--from",
       "0,0,0",
       "--to",
       "1,2,3",
       "-o",
       folder_.File("line.step"),
       "--step-schema",
       "ap242"});
  EXPECT_THAT(folder_.Text("214.step"), HasSubstr("FILE_SCHEMA(('AUTOMOTIVE_DESIGN"));
  for (const char* name : {"242.step", "line.step"}) {
    EXPECT_THAT(folder_.Text(name), HasSubstr("AP242_MANAGED_MODEL_BASED_3D_ENGINEERING"));
    EXPECT_THAT(folder_.Text(name), Not(HasSubstr("AUTOMOTIVE_DESIGN")));
  }
  EXPECT_TRUE(Contents("242.step").geometry == Contents("214.step").geometry);
  const ProgramRun wrong = Batten(
      {"convert", folder_.File("part.step"), folder_.File("x.step"), "--step-schema", "ap24"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--step-schema: 'ap24' is not one of ap214 ap242"));
}

TEST_F(ExchangeTest, OddFilesAreReadAndSaidToBeOdd) {
  WriteGeometry(
      {folder_.File("a.igs"),
       {NurbsCurve<3>(SplineBasis(1, {0, 0, 1, 1}), Eigen::Matrix<double, 3, 2>::Identity())}});
  std::string text = folder_.Text("a.igs");
  const std::string unit = ",2,G0000001\n2HMM,";
  ASSERT_NE(text.find(unit), text.npos);
  text.replace(text.find(unit), unit.size(), ", ,G0000001\n    ,");
  const std::string odd = folder_.With("odd.igs", text);
  const ProgramRun run = Batten({"convert", odd, folder_.File("out.step")});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.err, AllOf(HasSubstr("no unit of length"), HasSubstr("holds only lines")));
  EXPECT_EQ(Contents("out.step").unit, "inch");
  EXPECT_EQ(RunJson({"info", odd})["remarks"].size(), 2u);
  for (const char* name : {"a.3dm", "a.g2", "a.brep"}) {
    const ProgramRun refused = Batten({"info", folder_.With(name, "x")});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.err, HasSubstr("export it as .step"));
  }
}

}  // namespace batten::internal::exchange_test
