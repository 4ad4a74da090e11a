// SPDX-License-Identifier: MIT
// Units, names and schemas of geometry files through the commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>

#include <numbers>
#include <string>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/io/geometry_file.h"
#include "test_clouds.h"
#include "tolerances.h"

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

TEST_F(ExchangeTest, FilesTakenTogetherAreInOneUnit) {
  const auto run = [&](const std::vector<std::string>& words) {
    const ProgramRun run = Batten(words);
    EXPECT_EQ(run.code, 0) << run.err;
    return run;
  };
  const auto analysis = [&](const std::vector<std::string>& files) {
    std::vector<std::string> words{"analyze"};
    for (const std::string& file : files) words.push_back(folder_.File(file));
    words.emplace_back("--json");
    return Json::parse(run(words).out);
  };
  const std::string inch = folder_.File("inch.step"), mm = folder_.File("mm.json");
  run({"make", "line", "--from", "0,0,0", "--to", "1,0,0", "--unit", "inch", "-o", inch});
  run({"make", "line", "--from", "25.4,0,0", "--to", "25.4,50.8,0", "-o", mm});

  // What is made is in the unit of the first file, or the one asked for.
  run({"make", "extrude", inch, "--by", "0,0,2", "-o", folder_.File("wall.step")});
  EXPECT_NEAR(analysis({"wall.step"})["area"].get<double>(), 2, kRounding);
  EXPECT_THAT(run({"info", folder_.File("wall.step")}).out, HasSubstr("inch"));
  run({"make", "extrude", inch, "--by", "0,0,2", "--unit", "mm", "-o", folder_.File("low.json")});
  EXPECT_NEAR(analysis({"low.json"})["area"].get<double>(), 50.8, 50.8 * kRounding);
  run({"make", "ruled", mm, inch, "-o", folder_.File("ruled.json")});
  EXPECT_NEAR(analysis({"ruled.json"})["bounding_box"][1][0].get<double>(), 25.4, kRounding);
  run({"make", "ruled", inch, mm, "-o", folder_.File("ruled.step")});
  EXPECT_NEAR(analysis({"ruled.step"})["bounding_box"][1][0].get<double>(), 1, kRounding);
  EXPECT_NEAR(analysis({"ruled.step"})["bounding_box"][1][1].get<double>(), 2, kRounding);

  // Ends that meet do so whichever file comes first.
  EXPECT_LE(analysis({"inch.step", "mm.json"})["join"]["position_gap"].get<double>(), kRounding);
  EXPECT_LE(analysis({"mm.json", "inch.step"})["join"]["position_gap"].get<double>(),
            50 * kRounding);
  run({"edit", inch, "-o", folder_.File("chain.step"), "unify:with=" + mm});
  EXPECT_NEAR(analysis({"chain.step"})["length"].get<double>(), 3, kRounding);
  run({"edit", mm, "-o", folder_.File("chain.json"), "unify:with=" + inch});
  EXPECT_NEAR(analysis({"chain.json"})["length"].get<double>(), 76.2, 76.2 * kRounding);
  EXPECT_THAT(run({"intersect", inch, mm}).out, HasSubstr("at 1, "));
  EXPECT_THAT(run({"intersect", mm, inch}).out, HasSubstr("at 25.4, "));
}

TEST_F(ExchangeTest, CurvesThatTrimAreInTheUnitOfTheSurface) {
  const std::string plate = folder_.File("plate.step"), hole = folder_.File("hole.json"),
                    trimmed = folder_.File("trimmed.step");
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"make", "plane", "--size", "4,4", "--unit", "inch", "-o", plate},
           {"make", "circle", "--radius", "25.4", "-o", hole},
           {"edit", plate, "-o", trimmed, "trim:curve=" + hole + ",keep=inside"}}) {
    const ProgramRun run = Batten(words);
    ASSERT_EQ(run.code, 0) << run.err;
  }
  const double area = Json::parse(Batten({"analyze", trimmed, "--json"}).out)["area"];
  EXPECT_NEAR(area, std::numbers::pi, 1e-5);  // the trim is within 1e-8 of the size
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
  for (const char* name : {"a.3dm", "a.g2"}) {
    const ProgramRun refused = Batten({"info", folder_.With(name, "x")});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.err, HasSubstr("export it as .step"));
  }
}

class SewTest : public ExchangeTest {
 protected:
  // The sides of a unit cube but the one at x = 1, which is `gap` beside.
  SewTest() {
    const auto side = [&](Eigen::Vector3d at, Eigen::Vector3d u, Eigen::Vector3d v) {
      sides_.emplace_back(MakeBilinear(at, at + u, at + v, at + u + v));
    };
    const Eigen::Vector3d o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    for (const Eigen::Vector3d& at : {o, z}) side(at, x, y);
    for (const Eigen::Vector3d& at : {o, y}) side(at, x, z);
    side(o, y, z);
    side(x + kGap * x, y, z);
    WriteGeometry({folder_.File("cube.json"), sides_});
  }

  static constexpr double kGap = 0.01;
  std::vector<Geometry> sides_;
};

TEST_F(SewTest, SaysWhatCameOfIt) {
  const std::string cube = folder_.File("cube.json"), step = folder_.File("cube.step");
  ProgramRun run = Batten({"convert", cube, step, "--sew", "0.001", "--json"});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.err,
              AllOf(HasSubstr("warning"),
                    HasSubstr("8 free edges: not watertight"),
                    HasSubstr("the nearest two are 0.01 apart")));
  Json sewing = Json::parse(run.out)["files"][0]["sewing"];
  EXPECT_EQ(sewing["watertight"], false);
  EXPECT_EQ(sewing["free_edges"], 8);
  EXPECT_EQ(sewing["loose"], 1);
  EXPECT_NEAR(sewing["nearest_gap"].get<double>(), kGap, 1e-9);
  run = Batten({"analyze", step});
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("5 surfaces, 8 shared edges, not watertight: 4 free edges"),
                    HasSubstr("free edge"),
                    HasSubstr("from (1, ")));

  run = Batten({"convert", cube, step, "--sew", "0.02", "--json"});
  EXPECT_THAT(run.err, AllOf(HasSubstr("watertight"), Not(HasSubstr("warning"))));
  sewing = Json::parse(run.out)["files"][0]["sewing"];
  EXPECT_EQ(sewing["watertight"], true);
  EXPECT_EQ(sewing["solids"], 1);
  EXPECT_NEAR(sewing["largest_gap"].get<double>(), kGap, 1e-6);
  run = Batten({"analyze", step});
  EXPECT_THAT(run.out, HasSubstr("6 surfaces, 12 shared edges, watertight"));
  EXPECT_EQ(RunJson({"info", step})["bodies"][0]["kind"], "solid");
}

TEST_F(SewTest, SolidsAreFlattenedOnlyWhereTheFormatHoldsNone) {
  const std::string step = folder_.File("cube.step");
  ASSERT_EQ(Batten({"convert", folder_.File("cube.json"), step, "--sew", "0.02"}).code, 0);
  for (const char* name : {"again.step", "again.brep"}) {
    const ProgramRun run = Batten({"convert", step, folder_.File(name)});
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, AllOf(HasSubstr("sewn into a solid"), Not(HasSubstr("flattened"))));
    EXPECT_EQ(Contents(name).bodies.size(), 1u) << name;
  }
  const ProgramRun moved =
      Batten({"edit", step, "-o", folder_.File("moved.step"), "scale:100", "translate:1,2,3"});
  EXPECT_THAT(moved.err, HasSubstr("sewn into a solid"));
  EXPECT_TRUE(Contents("moved.step").bodies.at(0).watertight());
  const ProgramRun lines =
      Batten({"edit", step, "-o", folder_.File("lines.step"), "iso:dir=u,at=0.5"});
  EXPECT_EQ(lines.code, 0) << lines.err;
  EXPECT_THAT(lines.err, HasSubstr("a solid is flattened"));
  EXPECT_THAT(Batten({"convert", step, folder_.File("again.stl")}).err,
              Not(HasSubstr("flattened")));
  for (const char* name : {"again.json", "again.iges"}) {
    EXPECT_THAT(Batten({"convert", step, folder_.File(name)}).err,
                HasSubstr("a solid is flattened"));
  }
  const ProgramRun apart = Batten({"convert", step, folder_.File("apart.step"), "--sew", "0"});
  EXPECT_THAT(apart.err, HasSubstr("flattened"));
  EXPECT_TRUE(Contents("apart.step").bodies.empty());
}

TEST_F(SewTest, IsRefusedWhereThereIsNothingToSew) {
  const std::string cube = folder_.File("cube.json");
  for (const char* name : {"x.json", "x.iges", "x.stl"}) {
    const ProgramRun run = Batten({"convert", cube, folder_.File(name), "--sew", "0.1"});
    EXPECT_EQ(run.code, 2) << name;
  }
  EXPECT_EQ(Batten({"convert", cube, folder_.File("x.step"), "--sew", "-1"}).code, 2);
}

TEST_F(ExchangeTest, BrepIsReadAndWritten) {
  const ProgramRun written = Batten({"convert", folder_.File("part.step"), folder_.File("a.brep")});
  EXPECT_EQ(written.code, 0) << written.err;
  EXPECT_EQ(RunJson({"info", folder_.File("a.brep")})["surfaces"], 2);
  const ProgramRun back = Batten({"convert", folder_.File("a.brep"), folder_.File("b.step")});
  EXPECT_THAT(back.err, HasSubstr("does not say its unit; say --unit"));
  EXPECT_EQ(Contents("b.step").unit, "mm");
  const std::string text = folder_.Text("a.brep");
  const ProgramRun cut =
      Batten({"info", folder_.With("cut.brep", text.substr(0, text.size() / 2))});
  EXPECT_EQ(cut.code, 1);
  EXPECT_THAT(cut.err, AllOf(HasSubstr("cut.brep: line "), HasSubstr("the file ends where")));
}

// The second surface of the file becomes an entity that nobody knows.
TEST_F(ExchangeTest, WhatCantBeReadIsNamedAndCostsTheExitCode) {
  Run({"convert", folder_.File("part.step"), folder_.File("a.igs")});
  std::string text = folder_.Text("a.igs");
  for (const char* type : {"     128 ", "     128 ", "\n128,"}) {
    const size_t at = text.rfind(type);
    ASSERT_NE(at, text.npos);
    text.replace(text.find("128", at), 3, "129");
  }
  const std::string half = folder_.With("half.igs", text);
  for (const char* out : {"b.step", "b.brep", "b.json"}) {
    SCOPED_TRACE(out);
    const std::string path = folder_.File(out);
    const ProgramRun run = Batten({"convert", half, path});
    EXPECT_EQ(run.code, 4) << run.err;
    EXPECT_THAT(
        run.err,
        AllOf(HasSubstr("1 of its 2 faces and curves can't be read"), HasSubstr("(type 129): ")));
    EXPECT_EQ(Batten({"convert", half, path, "--accept-doubt"}).code, 0);
    EXPECT_EQ(RunJson({"info", path})["surfaces"], 1);
    const ProgramRun strict = Batten({"convert", half, path, "--strict"});
    EXPECT_EQ(strict.code, 1);
    EXPECT_THAT(strict.err, HasSubstr("half.igs: entity "));
  }
  const ProgramRun info = Batten({"info", half, "--json", "--quiet"});
  EXPECT_EQ(info.code, 4);
  EXPECT_EQ(Json::parse(info.out)["unread"].size(), 1u);
  EXPECT_EQ(Batten({"tessellate", half, "-o", folder_.File("b.stl")}).code, 4);
}

}  // namespace batten::internal::exchange_test
