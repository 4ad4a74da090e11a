// SPDX-License-Identifier: MIT
// What the command line refuses, and what help says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_clouds.h"

namespace batten {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class UsageTest : public ::testing::Test {
 protected:
  void ExpectUsageError(const std::vector<std::string>& arguments,
                        const std::vector<std::string>& said) {
    const std::ptrdiff_t before = folder_.Entries();
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 2) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(run.out, "");
    for (const std::string& words : said) EXPECT_THAT(run.err, HasSubstr(words));
    EXPECT_EQ(folder_.Entries(), before) << run.err;
  }

  // A fit that is in order but for the flags.
  void ExpectBadFlags(std::vector<std::string> flags, const std::vector<std::string>& said) {
    flags.insert(flags.begin(), {"fit", "surface", cloud_, "-o", folder_.File("out.json")});
    ExpectUsageError(flags, said);
  }

  TemporaryFolder folder_;
  std::string cloud_ = folder_.With("cloud.xyz", ToText(WavySheet(300)));
};

TEST_F(UsageTest, NoArgumentsShowTheUsage) {
  ExpectUsageError(
      {}, {"usage", "fit", "compare", "evaluate", "project", "edit", "convert", "info", "sample"});
  ExpectUsageError({"fit"}, {"usage", "surface"});
}

TEST_F(UsageTest, UnknownNamesAreAnsweredWithTheNearest) {
  ExpectUsageError({"comapre"}, {"'batten comapre'", "'compare'"});
  ExpectUsageError({"projekt"}, {"'batten projekt'", "'project'"});
  ExpectUsageError({"fit", "surfcae"}, {"'batten fit surfcae'", "'surface'"});
  ExpectBadFlags({"--tolerence", "1"}, {"--tolerence", "'--tolerance'"});
  ExpectBadFlags({"--bogus"}, {"--bogus", "nearest known is '--"});
  ExpectBadFlags({"-q"}, {"'-q'", "'--quiet'"});
  ExpectBadFlags({"--loss", "hubber"}, {"--loss", "hubber", "'huber'"});
  ExpectBadFlags({"--unit", "inchs"}, {"--unit", "inchs", "'inch'"});
}

TEST_F(UsageTest, WhatTheContractPromisesForLaterIsSaidToBeNotInThisVersion) {
  ExpectUsageError({"fit", "scan", cloud_, "-o", "x.json"}, {"scan", "not in this version"});
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"--thin", "1"},
                                             {"--uncertainty"},
                                             {"--certify"},
                                             {"--stream"},
                                             {"--report", "r.html"}}) {
    ExpectBadFlags(flags, {flags.front(), "not in this version"});
  }
}

TEST_F(UsageTest, NumbersOutOfRangeAreRefusedWithFlagAndValue) {
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"--tolerance", "0"},
                                             {"--tolerance", "-1"},
                                             {"--tolerance", "nan"},
                                             {"--tolerance", "1e400"},
                                             {"--degree", "0"},
                                             {"--degree", "26"},
                                             {"--degree", "3,26"},
                                             {"--degree", "3,3,3"},
                                             {"--degree", "2.5"},
                                             {"--control-points", "3,3"},
                                             {"--control-points", "-4"},
                                             {"--control-points", "100000,100000"},
                                             {"--max-control-points", "15"},
                                             {"--max-control-points", "99999999999"},
                                             {"--smoothing", "-1"},
                                             {"--grid", "5"},
                                             {"--grid", "1,5"},
                                             {"--grid-method", "local"},
                                             {"--domain", "0,0,1"},
                                             {"--domain", "0,0,0,1"},
                                             {"--symmetric", "0,0,0,1"},
                                             {"--symmetric", "1,0,0"},
                                             {"--boundary-tolerance", "-1"},
                                             {"--smoothing", "1e300"},
                                             {"--loss-scale", "0"},
                                             {"--threads", "0"},
                                             {"--threads", "-1"},
                                             {"--threads", "many"},
                                             {"--seed", "-1"},
                                             {"--seed", "18446744073709551616"},
                                             {"--origin", "1,2"},
                                             {"--box", "1,2,3"},
                                             {"--box", "1,1,1,0,0,0"},
                                             {"--where", "z"},
                                             {"--columns", "x"},
                                             {"--base", "cube"},
                                             {"--optimize", "everything"},
                                             {"--unit", "parsec"}}) {
    ExpectBadFlags(flags, {flags[0], flags[1]});
  }
}

TEST_F(UsageTest, EmptyAndMissingValuesAreRefused) {
  for (const char* flag : {"--tolerance",
                           "--degree",
                           "--control-points",
                           "--threads",
                           "--seed",
                           "--loss",
                           "--unit",
                           "--origin",
                           "--smoothing",
                           "--max-control-points"}) {
    ExpectBadFlags({flag, ""}, {flag});
    ExpectBadFlags({flag}, {flag});
  }
  ExpectUsageError({""}, {"unknown command"});
  ExpectUsageError({"fit", "surface", cloud_, "-o", ""}, {"format"});
  ExpectUsageError({"fit", "surface", "", "-o", folder_.File("out.json")}, {"format"});
  ExpectUsageError({"fit", "surface", cloud_}, {"--output is required"});
  ExpectUsageError({"compare", "a.json"}, {"CLOUD is required"});
}

TEST_F(UsageTest, AFlagGivenTwiceIsRefused) {
  ExpectBadFlags({"--tolerance", "1", "--tolerance", "2"}, {"--tolerance"});
  ExpectBadFlags({"--degree", "3", "--degree", "4"}, {"--degree"});
}

TEST_F(UsageTest, FormatsThatAreNotReadSayWhatToDo) {
  for (const char* extension : {"laz", "e57", "unheard"}) {
    const std::string name = std::string("scan.") + extension;
    ExpectUsageError({"fit", "surface", name, "-o", folder_.File("out.step")}, {name, extension});
  }
  for (const char* extension : {"3dm", "g2", "brep"}) {
    ExpectUsageError({"convert", std::string("part.") + extension, folder_.File("out.step")},
                     {extension});
  }
  ExpectUsageError({"info", "-"}, {"--format"});
}

TEST_F(UsageTest, ImpossibleOperationsAreRefused) {
  const std::string patch = folder_.With("patch.json", kRationalPatch);
  ExpectUsageError({"convert", patch, folder_.File("x.pcd")}, {"batten sample"});
  ExpectUsageError({"convert", cloud_, folder_.File("x.step")}, {"batten fit"});
  ExpectUsageError({"compare", cloud_, patch}, {cloud_});
  ExpectUsageError({"sample", patch, "-o", folder_.File("x.step"), "--count", "5"}, {"x.step"});
  ExpectUsageError({"evaluate", patch, "--at", "0.5"}, {"two parameters"});
  ExpectUsageError({"evaluate", patch, "--at", "5,0"}, {"u = 5", "[0, 2]"});
  ExpectUsageError({"evaluate", patch}, {"--at"});
  ExpectBadFlags({"--report", folder_.File("out.json")}, {"two outputs"});
  ExpectUsageError({"fit", "surface", cloud_, "-o", "-", "--format", "json", "--json"},
                   {"standard output"});
  ExpectBadFlags({"--columns", "x=9,y=1,z=2"}, {"'9'"});
}

TEST_F(UsageTest, HelpShowsExamplesAndDefaultsOfEveryCommand) {
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{},
                                             {"fit"},
                                             {"fit", "surface"},
                                             {"compare"},
                                             {"evaluate"},
                                             {"project"},
                                             {"edit"},
                                             {"analyze"},
                                             {"convert"},
                                             {"info"},
                                             {"sample"}}) {
    std::vector<std::string> arguments = command;
    arguments.push_back("--help");
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.err, "");
    std::string typed = "batten";
    for (const std::string& word : command) typed += " " + word;
    EXPECT_THAT(run.out, HasSubstr("Usage: " + typed + " "));
    EXPECT_THAT(run.out, HasSubstr("\n  " + typed));  // an example
  }
  const std::string fit = Batten({"fit", "surface", "--help"}).out;
  for (const char* text : {"P[,Q]=3,3",
                           "K=20000",
                           "L=auto",
                           "LOSS=auto",
                           "ORIGIN=keep",
                           "UNIT=mm",
                           "N=1",
                           "[none]",
                           "[all cores]"}) {
    EXPECT_THAT(fit, HasSubstr(text));
  }
}

TEST_F(UsageTest, TheVersionIsPrintedQuickly) {
  const ProgramRun run = Batten({"--version"});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, StartsWith("batten "));
  EXPECT_LT(run.seconds, 0.5);  // 0.15 on a machine of its own
}

}  // namespace
}  // namespace batten
