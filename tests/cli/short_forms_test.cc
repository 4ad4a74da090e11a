// SPDX-License-Identifier: MIT
// Command lines whose command is left out do what they stand for, and say so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "test_clouds.h"

namespace batten::internal::short_forms_test {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class ShortFormsTest : public ::testing::Test {
 protected:
  ShortFormsTest() { folder_.With("scan.xyz", ToText(WavySheet(300))); }

  // Of the program in the folder.
  ProgramRun Here(const std::vector<std::string>& words) const {
    const std::filesystem::path back = std::filesystem::current_path();
    std::filesystem::current_path(folder_.path());
    ProgramRun run = Batten(words);
    std::filesystem::current_path(back);
    return run;
  }
  bool Has(const std::string& name) const { return std::filesystem::exists(folder_.File(name)); }
  void Forget(const std::vector<std::string>& names) const {
    for (const std::string& name : names) std::filesystem::remove(folder_.File(name));
  }

  TemporaryFolder folder_;
};

constexpr const char* kInFull =
    "fit surface scan.xyz -o scan.step --report scan.report.html --report scan.report.json";

TEST_F(ShortFormsTest, ACloudIsFittedWithNamesOfItsOwnAndTheCommandIsTold) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"scan.xyz"}, {"fit", "scan.xyz"}}) {
    const ProgramRun run = Here(words);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, StartsWith("scan.step: surface of degree 3,3"));
    EXPECT_THAT(run.err, AllOf(HasSubstr("command in full"), HasSubstr(kInFull)));
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_TRUE(Has("scan.step") && Has("scan.report.html"));
    // The report's command is one to repeat.
    EXPECT_THAT(folder_.Text("scan.report.json"), HasSubstr(kInFull));
    Forget({"scan.step", "scan.report.html", "scan.report.json"});
  }
}

TEST_F(ShortFormsTest, ATextOfNumbersIsACloudUnderAnyName) {
  folder_.With("scan.pwn", ToText(WavySheet(300)));
  const ProgramRun run = Here({"scan.pwn", "--control-points", "5,5"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(Has("scan.step"));
}

TEST_F(ShortFormsTest, FlagsAreThoseOfFitSurface) {
  const ProgramRun named = Here({"scan.xyz", "--control-points", "5,5", "-o", "part.json"});
  EXPECT_EQ(named.code, 0) << named.err;
  EXPECT_TRUE(Has("part.json"));
  EXPECT_EQ(folder_.Entries(), 2);  // no report that nobody asked for
  const ProgramRun reported = Here({"scan.xyz", "--report=r.json", "--quiet"});
  EXPECT_EQ(reported.code, 0) << reported.err;
  EXPECT_EQ(reported.out + reported.err, "");
  EXPECT_TRUE(Has("scan.step") && Has("r.json"));
  EXPECT_FALSE(Has("scan.report.html"));
  const ProgramRun unknown = Here({"scan.xyz", "--tolerence", "1"});
  EXPECT_EQ(unknown.code, 2);
  Forget({"scan.step"});
  const ProgramRun json = Here({"scan.xyz", "--json"});
  EXPECT_EQ(Json::parse(json.out)["geometry"]["file"], "scan.step");
}

TEST_F(ShortFormsTest, NothingIsWrittenOverUnasked) {
  for (const char* const name : {"scan.step", "scan.report.html", "scan.report.json"}) {
    folder_.With(name, "mine");
    const ProgramRun run = Here({"scan.xyz"});
    EXPECT_EQ(run.code, 2);
    EXPECT_EQ(run.error_lines(), 1);
    EXPECT_THAT(run.err, AllOf(HasSubstr(std::string(name) + " is there"), HasSubstr(kInFull)));
    EXPECT_EQ(folder_.Text(name), "mine");
    Forget({name});
  }
  folder_.With("scan.step", "mine");
  EXPECT_EQ(Here({"scan.xyz", "-o", "scan.step"}).code, 0);
  EXPECT_NE(folder_.Text("scan.step"), "mine");
}

TEST_F(ShortFormsTest, GeometryIsDescribed) {
  folder_.With("patch.json", kRationalPatch);
  const ProgramRun run = Here({"patch.json"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, Here({"info", "patch.json"}).out);
  EXPECT_THAT(run.err, HasSubstr("info patch.json"));
  const ProgramRun fit = Here({"fit", "patch.json"});
  EXPECT_EQ(fit.code, 2);
  EXPECT_THAT(fit.err, HasSubstr("patch.json holds geometry"));
  EXPECT_EQ(folder_.Entries(), 2);
}

TEST_F(ShortFormsTest, CommandsAreNoFilesAndFilesNoCommands) {
  folder_.With("fit", ToText(WavySheet(100)));
  folder_.With("surface", ToText(WavySheet(100)));
  folder_.With("-dash.xyz", ToText(WavySheet(100)));
  EXPECT_THAT(Here({"fit"}).err, HasSubstr("usage: batten fit"));
  EXPECT_THAT(Here({"fit", "surface"}).err, HasSubstr("required"));
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"./fit"}, {"./fit", "--format", "xyz"}}) {
    EXPECT_EQ(Here(words).code, 0);
    EXPECT_TRUE(Has("fit.step"));
    Forget({"fit.step", "fit.report.html", "fit.report.json"});
  }
  EXPECT_EQ(Here({"fit", "fit", "--format=text"}).code, 0);
  EXPECT_TRUE(Has("fit.step"));
  EXPECT_EQ(Here({"-dash.xyz"}).code, 2);
  EXPECT_EQ(Here({"./-dash.xyz"}).code, 0);
  EXPECT_TRUE(Has("-dash.step") && Has("-dash.report.html"));
}

TEST_F(ShortFormsTest, WhatCannotBeReadIsRefusedInOneLine) {
  std::filesystem::create_directory(folder_.File("folder"));
  std::filesystem::create_directory(folder_.File("folder.ply"));
  folder_.With("bad.ply", "this is no ply");
  const std::ptrdiff_t before = folder_.Entries();
  for (const auto& [name, code] : std::vector<std::pair<std::string, int>>{{"missing.ply", 1},
                                                                           {"bad.ply", 1},
                                                                           {"folder.ply", 1},
                                                                           {"missing.step", 1},
                                                                           {"folder", 2},
                                                                           {"scan.e57", 2},
                                                                           {"scan.odd", 2},
                                                                           {"missing", 2},
                                                                           {"", 2}}) {
    const ProgramRun run = Here({name});
    EXPECT_EQ(run.code, code) << name << ' ' << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(name));
    EXPECT_EQ(folder_.Entries(), before) << name;
  }
  EXPECT_THAT(Here({"scan.e57"}).err, HasSubstr("export"));
}

TEST_F(ShortFormsTest, HelpOfACommandIsThatOfItsFlag) {
  EXPECT_EQ(Here({"help"}).out, Here({"--help"}).out);
  EXPECT_EQ(Here({"help", "fit"}).out, Here({"fit", "--help"}).out);
  EXPECT_EQ(Here({"help", "fit", "surface"}).out, Here({"fit", "surface", "--help"}).out);
  EXPECT_EQ(Here({"scan.xyz", "--help"}).out, Here({"fit", "surface", "--help"}).out);
  const ProgramRun unknown = Here({"help", "comapre"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("'compare'"));
  EXPECT_THAT(Here({"help", "fit"}).err, Not(HasSubstr("in full")));
}

std::vector<Row> OutlineRows() {
  std::vector<Row> rows;
  for (int k = 0; k < 120; ++k) {
    const double t = 2 * std::numbers::pi * k / 120;
    rows.push_back({4 * std::cos(t), 3 * std::sin(t)});
  }
  return rows;
}

TEST_F(ShortFormsTest, AFileIsTakenForWhatItHoldsInOneLine) {
  folder_.With("outline.xy", ToText(OutlineRows()));
  const ProgramRun run = Here({"outline.xy", "--optimize", "none"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, StartsWith("outline.step: curve"));
  EXPECT_EQ(run.error_lines(), 1) << run.err;
  EXPECT_THAT(run.err,
              AllOf(HasSubstr("outline.xy: 120 points of the plane along a line"),
                    HasSubstr("'batten fit curve'"),
                    HasSubstr("--as primitive"),
                    HasSubstr("fit curve outline.xy")));
  const ProgramRun sheet = Here({"scan.xyz", "--control-points", "5,5"});
  EXPECT_THAT(sheet.err,
              AllOf(HasSubstr("scan.xyz: 300 points over a surface"),
                    HasSubstr("--as curve|primitive|parts|solid")));
}

TEST_F(ShortFormsTest, SeparateCurvesAreAllFitted) {
  std::vector<Row> rows = OutlineRows();
  for (const Row& row : OutlineRows()) rows.push_back({row[0] + 20, row[1]});
  folder_.With("two.xy", ToText(rows));
  const ProgramRun run = Here({"two.xy", "--optimize", "none"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("2 curves"));
  EXPECT_THAT(run.err, AllOf(HasSubstr("2 lines"), HasSubstr("--component K")));
  const ProgramRun one = Here({"two.xy", "--component", "2", "-o", "one.json"});
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_EQ(Json::parse(folder_.Text("one.json"))["shape"]["count"], 1);
}

TEST_F(ShortFormsTest, AsForcesAnotherKind) {
  folder_.With("outline.xy", ToText(OutlineRows()));
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"outline.xy", "--as", "primitive", "--accept-doubt"},
           {"outline.xy", "--accept-doubt", "--as=primitive"},
           {"--as", "primitive", "outline.xy", "--accept-doubt"},
           {"fit", "outline.xy", "--as", "primitive", "--accept-doubt"}}) {
    const ProgramRun run = Here(words);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("circle"));
    EXPECT_THAT(run.err, HasSubstr("fit primitive outline.xy"));
    EXPECT_THAT(folder_.Text("outline.report.json"), Not(HasSubstr("--as")));
    Forget({"outline.step", "outline.report.html", "outline.report.json"});
  }
  EXPECT_EQ(Here({"scan.xyz", "--as", "info"}).out, Here({"info", "scan.xyz"}).out);
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"scan.xyz", "--as", "cruve"}, {"scan.xyz", "--as"}}) {
    const ProgramRun run = Here(words);
    EXPECT_EQ(run.code, 2);
    EXPECT_THAT(run.err, HasSubstr("curve, surface, primitive, parts, solid, info"));
  }
  folder_.With("patch.json", kRationalPatch);
  EXPECT_EQ(Here({"patch.json", "--as", "surface"}).code, 2);
  EXPECT_EQ(Here({"patch.json", "--as", "info"}).out, Here({"info", "patch.json"}).out);
  // Of a command that is named it is a flag of its own.
  EXPECT_THAT(Here({"fit", "surface", "scan.xyz", "-o", "x.step", "--as", "curve"}).err,
              HasSubstr("unknown flag '--as'"));
}

TEST_F(ShortFormsTest, NamesOfFitsAndShapesAreFirstWordsToo) {
  folder_.With("outline.xy", ToText(OutlineRows()));
  folder_.With("patch.json", kRationalPatch);
  for (const auto& [words, taken] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"curve", "outline.xy"}, "fit curve outline.xy -o outline.step"},
           {{"surface", "scan.xyz", "--control-points", "5,5"}, "fit surface scan.xyz"},
           {{"primitive", "scan.xyz", "--accept-doubt"}, "fit primitive scan.xyz"},
           {{"circle", "outline.xy", "--accept-doubt"},
            "fit primitive outline.xy --kind circle --accept-doubt"},
           {{"fit", "plane", "scan.xyz", "--accept-doubt"},
            "fit primitive scan.xyz --kind plane --accept-doubt"},
           {{"mesh", "patch.json", "-o", "patch.stl"}, "tessellate patch.json -o patch.stl"},
           {{"view", "patch.json"}, "info patch.json"},
           {{"open", "scan.xyz"}, "info scan.xyz"}}) {
    const ProgramRun run = Here(words);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, AllOf(HasSubstr("is taken for"), HasSubstr(taken)));
    EXPECT_THAT(run.err, StartsWith("batten: '"));
    for (const char* const name : {"outline", "scan"})
      Forget({name + std::string(".step"),
              name + std::string(".report.html"),
              name + std::string(".report.json")});
  }
  const ProgramRun alone = Here({"circle", "-o", "c.json", "--radius", "3"});
  EXPECT_EQ(alone.code, 2);
  EXPECT_THAT(alone.err, AllOf(HasSubstr("fit primitive FILE"), HasSubstr("make circle")));
  EXPECT_THAT(Here({"surfce", "scan.xyz"}).err, HasSubstr("'surface'"));
  EXPECT_THAT(Here({"curve"}).err, HasSubstr("required"));
}

TEST_F(ShortFormsTest, AFileOfSuchANameIsOneWhereNothingFollows) {
  folder_.With("surface", ToText(WavySheet(300)));
  folder_.With("plane", ToText(WavySheet(300)));
  for (const char* const name : {"surface", "plane"}) {
    const ProgramRun run = Here({name, "--control-points", "5,5"});
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr(std::string(name) + ": 300 points over a surface"));
  }
  EXPECT_THAT(Here({"plane", "scan.xyz", "--accept-doubt"}).err,
              HasSubstr("fit primitive scan.xyz --kind plane"));
}

TEST_F(ShortFormsTest, FoldersFlagsAndStandardInputAreToldApart) {
  std::filesystem::create_directory(folder_.File("folder"));
  EXPECT_THAT(Here({"folder"}).err, HasSubstr("is a folder"));
  folder_.With("-dash.xyz", ToText(WavySheet(100)));
  EXPECT_THAT(Here({"-dash.xyz"}).err, HasSubstr("./-dash.xyz"));
  EXPECT_EQ(Here({"-"}).code, 2);
  const ProgramRun unnamed = Here({"-", "--format", "xyz"});
  EXPECT_EQ(unnamed.code, 2);
  EXPECT_THAT(unnamed.err, HasSubstr("-o OUT"));
  const ProgramRun piped =
      Batten({"-", "--format", "xyz", "-o", folder_.File("piped.json"), "--control-points", "5,5"},
             {.standard_input = folder_.Text("scan.xyz")});
  EXPECT_EQ(piped.code, 0) << piped.err;
  EXPECT_THAT(piped.err, HasSubstr("standard input"));
}

TEST_F(ShortFormsTest, RefusalsNameTheCommandThatTakesTheFile) {
  const auto refused = [&](const std::vector<std::string>& words) {
    const ProgramRun run = Here(words);
    EXPECT_EQ(run.code, 1) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    return run.err;
  };
  // A bumpy ball, all round.
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal(0, 1);
  std::vector<Row> ball;
  for (int k = 0; k < 3000; ++k) {
    Eigen::Vector3d p(normal(random), normal(random), normal(random));
    p.normalize();
    p *= 5 * (1 + 0.3 * std::sin(3 * p[0]) * std::cos(4 * p[1] + p[2]));
    ball.push_back({p[0], p[1], p[2]});
  }
  folder_.With("ball.xyz", ToText(ball));
  EXPECT_THAT(refused({"fit", "surface", "ball.xyz", "-o", "x.step"}),
              HasSubstr("'batten fit solid ball.xyz'"));
  folder_.With("open.off",
               "OFF\n5 4 0\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n2 2 1\n"
               "3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n");
  EXPECT_THAT(refused({"fit", "solid", "open.off", "-o", "x.step"}),
              HasSubstr("'batten fit surface open.off'"));
  std::vector<Row> grid;
  for (int k = 0; k < 1200; ++k)
    grid.push_back({0.25 * (k % 40), 0.27 * (k / 40), std::sin(0.1 * (k % 40))});
  folder_.With("grid.xyz", ToText(grid));
  EXPECT_THAT(refused({"fit", "curve", "grid.xyz", "-o", "x.step", "--order", "unordered"}),
              HasSubstr("'batten fit surface grid.xyz'"));
  folder_.With("outline.xy", ToText(OutlineRows()));
  EXPECT_THAT(refused({"fit", "primitive", "outline.xy", "-o", "x.step", "--kind", "plane"}),
              AllOf(HasSubstr("--kind auto"), HasSubstr("'batten fit curve outline.xy'")));
}

TEST_F(ShortFormsTest, UnknownEndingsListWhatTheCommandWrites) {
  folder_.With("outline.xy", ToText(OutlineRows()));
  folder_.With("patch.json", kRationalPatch);
  for (const auto& [words, written] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"fit", "surface", "scan.xyz", "-o"},
            ".json, .step, .iges or .brep, triangles as .stl"},
           {{"fit", "curve", "outline.xy", "-o"}, ".json, .step, .iges or .brep"},
           {{"fit", "solid", "scan.xyz", "-o"}, ".step, or as triangles into .stl"},
           {{"convert", "scan.xyz"}, ".ply, .pcd, .xyz or .csv"},
           {{"convert", "patch.json"}, ".json, .step, .iges or .brep, triangles as .stl"},
           {{"tessellate", "patch.json", "-o"}, ".stl .obj .ply .glb"},
           {{"sample", "patch.json", "--count", "9", "-o"}, ".ply .pcd .xyz .csv"},
           {{"section", "patch.json", "--plane", "0,0,1,1", "-o"}, ".json, .step, .iges"}}) {
    for (const char* const name : {"x.dwg", "x.3dm", "x"}) {
      std::vector<std::string> all = words;
      all.emplace_back(name);
      const ProgramRun run = Here(all);
      EXPECT_EQ(run.code, 2);
      EXPECT_THAT(run.err, AllOf(HasSubstr(name), HasSubstr(written), Not(HasSubstr("las"))));
    }
  }
  EXPECT_THAT(Here({"fit", "curve", "outline.xy", "-o", "x.dwg"}).err, Not(HasSubstr("triangles")));
}

TEST_F(ShortFormsTest, CompareTakesItsFilesInEitherOrder) {
  EXPECT_EQ(Here({"fit", "surface", "scan.xyz", "-o", "fit.json", "--control-points", "6,6"}).code,
            0);
  const ProgramRun usual = Here({"compare", "fit.json", "scan.xyz"}),
                   other = Here({"compare", "scan.xyz", "fit.json"});
  EXPECT_EQ(other.code, usual.code);
  EXPECT_EQ(other.out, usual.out);
  EXPECT_EQ(other.error_lines(), usual.error_lines() + 1);
  EXPECT_THAT(other.err, HasSubstr("fit.json is the geometry"));
  EXPECT_EQ(Here({"compare", "scan.xyz", "fit.json", "--quiet"}).err, "");
  EXPECT_EQ(Here({"compare", "scan.xyz", "scan.xyz"}).code, 2);
}

TEST_F(ShortFormsTest, APrimitiveIsTheNearestUnlessOneIsNamed) {
  folder_.With("outline.xy", ToText(OutlineRows()));
  const ProgramRun run = Here({"fit", "primitive", "outline.xy", "-o", "a.json", "--accept-doubt"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(
      run.out,
      Here({"fit", "primitive", "outline.xy", "-o", "a.json", "--accept-doubt", "--kind", "auto"})
          .out);
}

TEST_F(ShortFormsTest, CompletionKnowsThem) {
  EXPECT_EQ(Here({"__complete", "sca"}).out, "files\nscan.xyz\n");
  EXPECT_EQ(Here({"__complete", "fit", "sca"}).out, "files\nscan.xyz\n");
  EXPECT_EQ(Here({"__complete", "scan.xyz", "--toler"}).out, "words\n--tolerance\n");
  EXPECT_EQ(Here({"__complete", "help", "fit", "sur"}).out, "words\nsurface\n");
  EXPECT_EQ(Here({"__complete", "help", "comp"}).out, "words\ncompare\ncompletion\n");
  EXPECT_EQ(Here({"__complete", "scan.e57", "-"}).code, 0);
}

}  // namespace batten::internal::short_forms_test
