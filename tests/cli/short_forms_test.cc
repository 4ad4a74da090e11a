// SPDX-License-Identifier: MIT
// Command lines whose command is left out do what they stand for, and say so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

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

TEST_F(ShortFormsTest, CompletionKnowsThem) {
  EXPECT_EQ(Here({"__complete", "sca"}).out, "files\nscan.xyz\n");
  EXPECT_EQ(Here({"__complete", "fit", "sca"}).out, "files\nscan.xyz\n");
  EXPECT_EQ(Here({"__complete", "scan.xyz", "--toler"}).out, "words\n--tolerance\n");
  EXPECT_EQ(Here({"__complete", "help", "fit", "sur"}).out, "words\nsurface\n");
  EXPECT_EQ(Here({"__complete", "help", "comp"}).out, "words\ncompare\ncompletion\n");
  EXPECT_EQ(Here({"__complete", "scan.e57", "-"}).code, 0);
}

}  // namespace batten::internal::short_forms_test
