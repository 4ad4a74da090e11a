// SPDX-License-Identifier: MIT
// What the command line refuses, and what help says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "test_clouds.h"

namespace batten::internal::usage_test {

using ::testing::AnyOf;
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
  ExpectBadFlags({"--bogus"}, {"unknown flag '--bogus' for 'batten fit surface'; --help lists"});
  ExpectBadFlags({"-q"}, {"'-q'", "'--quiet'"});
  ExpectBadFlags({"--loss", "hubber"}, {"--loss", "hubber", "'huber'"});
  ExpectBadFlags({"--unit", "inchs"}, {"--unit", "inchs", "'inch'"});
}

TEST_F(UsageTest, NamesThatBeginAsTypedAreSuggestedFirstAndNoneThatIsFarOff) {
  ExpectBadFlags({"--tol", "1"}, {"did you mean '--tolerance'?"});
  ExpectBadFlags({"--control", "9,9"}, {"did you mean '--control-points'?"});
  ExpectBadFlags({"-tol", "1"}, {"did you mean '--tolerance'?"});
  ExpectBadFlags({"--los"}, {"did you mean '--loss' or '--loss-scale'?"});
  ExpectBadFlags({"--base", "rev"}, {"did you mean 'revolution'?"});
  ExpectBadFlags({"--z"}, {"--help lists"});
  ExpectBadFlags({"--tolerating"}, {"--help lists"});  // three edits from --tolerance
  ExpectUsageError({"comp"}, {"did you mean 'compare' or 'completion'?"});
  ExpectUsageError({"x"}, {"unknown command 'batten x'; known are "});
  ExpectBadFlags({"--unit", "x"}, {"'x' is not one of mm"});
  EXPECT_THAT(Batten({"info", cloud_, "--unit", "x"}).err, ::testing::Not(HasSubstr("mean")));
}

TEST_F(UsageTest, WhatTheContractPromisesForLaterIsSaidToBeNotInThisVersion) {
  ExpectUsageError({"fit", "scan", cloud_, "-o", "x.json"}, {"scan", "not in this version"});
  ExpectBadFlags({"--stream"}, {"--stream", "not in this version"});
}

TEST_F(UsageTest, TwoFormatsOfOneOutputAreRefusedAndAnInputIsNoOutput) {
  const std::string patch = folder_.With("patch.json", kRationalPatch);
  ExpectUsageError(
      {"sample", patch, "-o", "-", "--count", "9", "--format", "ply", "--output-format", "csv"},
      {"ply", "csv", "both of the points"});
  ExpectUsageError({"tessellate", patch, "-o", "-", "--format", "obj", "--output-format", "glb"},
                   {"obj", "glb", "both of the mesh"});
  ExpectUsageError({"sample", patch, "-o", patch, "--count", "9", "--output-format", "csv"},
                   {"would be lost"});
  ExpectUsageError({"tessellate", patch, "-o", patch, "--output-format", "ply"}, {"would be lost"});
  EXPECT_EQ(folder_.Text("patch.json"), kRationalPatch);
  const ProgramRun points = Batten(
      {"sample", patch, "-o", "-", "--count", "9", "--format", "json", "--output-format", "csv"});
  EXPECT_EQ(points.code, 0) << points.err;
  EXPECT_THAT(points.out, HasSubstr("x,y,z\n"));
  const ProgramRun mesh =
      Batten({"tessellate", patch, "-o", "-", "--format", "json", "--output-format", "ply"});
  EXPECT_EQ(mesh.code, 0) << mesh.err;
  EXPECT_EQ(mesh.out.substr(0, 4), "ply\n");
}

TEST_F(UsageTest, ThinningIsOfScatteredPoints) {
  ExpectBadFlags({"--thin", "0"}, {"--thin", "'0'"});
  ExpectBadFlags({"--thin", "1", "--grid", "10,10"}, {"--grid", "--thin"});
}

TEST_F(UsageTest, AFlagOfAnotherCommandIsSaidToBeThere) {
  ExpectBadFlags({"--interpolate"}, {"'--interpolate'", "'batten fit curve' has it"});
  ExpectBadFlags({"--start-tangent", "1,0"}, {"'batten fit curve', 'batten make loft' have it"});
  ExpectUsageError(
      {"compare", "a.json", "b.xyz", "--kind", "plane"},
      {"'--kind' for 'batten compare'", "'batten fit primitive', 'batten fit solid' have it"});
  ExpectUsageError({"sample", "a.json", "--tolerance", "1"},
                   {"'batten fit surface', 'batten fit curve'", "have it"});
}

// Flags that may come again take one value each: what follows it is an argument of its own.
TEST_F(UsageTest, FlagsBeforeTheFileLeaveTheFileAlone) {
  const std::string out = folder_.File("out.json");
  for (const std::vector<std::string>& flags : std::vector<std::vector<std::string>>{
           {"--report", folder_.File("report.json")}, {"--where", "3=0"}}) {
    const ProgramRun run = Batten(
        {"fit", "surface", flags[0], flags[1], cloud_, "-o", out, "--control-points", "4,4"});
    // So few control points miss a point by more than a hundredth of the size.
    EXPECT_EQ(run.code, flags[0] == "--report" ? 4 : 1) << run.err;
    EXPECT_THAT(run.err, ::testing::Not(HasSubstr("required")));
  }
  EXPECT_THAT(folder_.Text("report.json"), StartsWith("{"));
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
  ExpectBadFlags({"--tolerance"}, {"--tolerance needs a value"});
  ExpectUsageError({"fit", "surface", cloud_, "-o", ""}, {"the name of a file is empty"});
  ExpectUsageError({"fit", "surface", "", "-o", folder_.File("out.json")},
                   {"the name of a file is empty"});
  ExpectUsageError({"fit", "surface", cloud_, "-o", "/dev/full"}, {"--output-format"});
  ExpectUsageError({"fit", "surface", cloud_}, {"--output is required"});
  ExpectUsageError({"compare", "a.json"}, {"CLOUD is required"});
}

TEST_F(UsageTest, AFlagGivenTwiceIsRefused) {
  ExpectBadFlags({"--tolerance", "1", "--tolerance", "2"}, {"--tolerance is given more than once"});
  ExpectBadFlags({"--degree", "3", "--degree", "4"}, {"--degree is given more than once"});
}

TEST_F(UsageTest, TwoDashesAreNoFlag) {
  ExpectUsageError({"fit", "surface", "--", cloud_}, {"--output is required"});
}

TEST_F(UsageTest, FormatsThatAreNotReadSayWhatToDo) {
  for (const char* extension : {"laz", "e57", "unheard"}) {
    const std::string name = std::string("scan.") + extension;
    ExpectUsageError({"fit", "surface", name, "-o", folder_.File("out.step")}, {name, extension});
  }
  for (const char* extension : {"3dm", "g2"}) {
    ExpectUsageError({"convert", std::string("part.") + extension, folder_.File("out.step")},
                     {extension});
  }
  ExpectUsageError({"info", "-"}, {"--format"});
}

TEST_F(UsageTest, ImpossibleOperationsAreRefused) {
  const std::string patch = folder_.With("patch.json", kRationalPatch);
  ExpectUsageError({"convert", patch, folder_.File("x.pcd")}, {"batten sample"});
  ExpectUsageError({"convert", cloud_, folder_.File("x.step")}, {"batten fit"});
  ExpectUsageError({"compare", cloud_, cloud_}, {cloud_});
  ExpectUsageError({"sample", patch, "-o", folder_.File("x.step"), "--count", "5"}, {"x.step"});
  ExpectUsageError({"evaluate", patch, "--at", "0.5"}, {"two parameters"});
  ExpectUsageError({"evaluate", patch, "--at", "5,0"}, {"u = 5", "[0, 2]"});
  ExpectUsageError({"evaluate", patch}, {"--at"});
  ExpectBadFlags({"--report", folder_.File("out.json")}, {"two outputs"});
  ExpectUsageError({"fit", "surface", cloud_, "-o", "-", "--format", "json", "--json"},
                   {"standard output"});
  ExpectBadFlags({"--columns", "x=9,y=1,z=2"}, {"'9'"});
}

// The lines of a text.
std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Every command there is, as completion knows them; the program itself first.
std::vector<std::vector<std::string>> AllCommands() {
  std::vector<std::vector<std::string>> commands = {{}};
  for (size_t k = 0; k < commands.size(); ++k) {
    std::vector<std::string> question = commands[k];
    question.insert(question.begin(), "__complete");
    question.emplace_back();
    const bool has_commands =
        Batten(std::vector<std::string>(question.begin() + 1, question.end() - 1))
            .err.find("usage") != std::string::npos;
    if (!has_commands) continue;
    std::vector<std::string> names = LinesOf(Batten(question).out);
    names.erase(names.begin());
    for (const std::string& name : names) {
      commands.push_back(commands[k]);
      commands.back().push_back(name);
    }
  }
  return commands;
}

// The words of an example as a shell takes them: up to the remark beside it or what it is piped to.
std::vector<std::string> WordsOfExample(std::string line) {
  const size_t pipe = line.find("| batten ");
  line.erase(0, pipe == std::string::npos ? line.find("batten ") : pipe + 2);
  const size_t remark = line.find("   ");
  std::istringstream stream(line.substr(0, remark));
  std::vector<std::string> words;
  std::string word;
  for (stream >> word; stream >> word && word != ">";) {
    word.erase(word.find_last_not_of(')') + 1);  // of <(batten ...)
    words.push_back(word);
  }
  return words;
}

TEST_F(UsageTest, EveryExampleOfHelpIsACommandLineTheProgramTakes) {
  int examples = 0;
  for (const std::vector<std::string>& command : AllCommands()) {
    std::vector<std::string> help = command;
    help.emplace_back("--help");
    std::string text = Batten(help).out;
    for (size_t at; (at = text.find("\\\n")) != std::string::npos;) {  // goes on below
      text.erase(at, text.find_first_not_of(' ', at + 2) - at);
    }
    for (const std::string& line : LinesOf(text)) {
      if (line.rfind("  ", 0) != 0 || line.find("batten ") == std::string::npos) continue;
      std::vector<std::string> words = WordsOfExample(line);
      if (words.empty() || words[0] == "COMMAND") continue;
      // Files it names are not there, and those it would write are not to be: a line that is in
      // order ends at that, or at --help.
      SCOPED_TRACE(line);
      ++examples;
      EXPECT_EQ(line.find(';'), std::string::npos) << "a shell ends the command there";
      const std::filesystem::path here = std::filesystem::current_path();
      std::filesystem::current_path(folder_.path());
      const ProgramRun run = Batten(words);
      std::filesystem::current_path(here);
      EXPECT_NE(run.code, 2) << run.err;
    }
  }
  EXPECT_GT(examples, 60);
}

TEST_F(UsageTest, HelpShowsExamplesAndDefaultsOfEveryCommand) {
  for (const std::vector<std::string>& command : AllCommands()) {
    std::vector<std::string> arguments = command;
    arguments.push_back("--help");
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.err, "");
    std::string typed = "batten";
    for (const std::string& word : command) typed += " " + word;
    EXPECT_THAT(run.out, HasSubstr("Usage: " + typed + " "));
    EXPECT_THAT(run.out, AnyOf(HasSubstr("\n  " + typed), HasSubstr("<(" + typed)));  // an example
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

TEST_F(UsageTest, HelpOfFitsHasHeadingsAndFitsAHundredColumns) {
  for (const char* const kind : {"surface", "curve", "primitive", "parts", "solid"}) {
    const std::vector<std::string> lines = LinesOf(Batten({"fit", kind, "--help"}).out);
    for (const std::string& line : lines) EXPECT_LE(line.size(), 100u) << line;
    for (const char* const heading : {"What is written:", "Which points count:", "The run:"})
      EXPECT_THAT(lines, ::testing::Contains(heading)) << kind;
    // Under no heading stands help alone.
    const auto rest = std::find(lines.begin(), lines.end(), "Options:");
    ASSERT_NE(rest, lines.end());
    EXPECT_THAT(*(rest + 1), HasSubstr("--help"));
    EXPECT_EQ(*(rest + 2), "");
  }
}

TEST_F(UsageTest, TheVersionIsPrintedQuickly) {
  const ProgramRun run = Batten({"--version"});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, StartsWith("batten "));
  EXPECT_LT(run.seconds, 0.5);  // 0.15 on a machine of its own
}

}  // namespace batten::internal::usage_test
