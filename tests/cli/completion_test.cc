// SPDX-License-Identifier: MIT
// Completion in bash: the script is run by bash itself, and what it offers is what the program
// takes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "test_clouds.h"

namespace batten::internal::completion_test {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

using Words = std::vector<std::string>;

Words Lines(const std::string& text) {
  Words lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string InQuotes(const std::string& word) {
  std::string quoted = "'";
  for (const char letter : word) quoted += letter == '\'' ? "'\\''" : std::string(1, letter);
  return quoted + "'";
}

class CompletionTest : public ::testing::Test {
 protected:
  // What bash offers for the last of the words, which follow the program's name and are split as
  // bash splits them.
  Words Offered(const Words& words) const {
    std::string script = "cd " + InQuotes(folder_.path().string()) + "\nsource <(" +
                         InQuotes(BATTEN_PROGRAM) + " completion bash)\nCOMP_WORDS=(" +
                         InQuotes(BATTEN_PROGRAM);
    for (const std::string& word : words) script += ' ' + InQuotes(word);
    script += ")\nCOMP_CWORD=" + std::to_string(words.size()) +
              "\n_batten\n[[ ${#COMPREPLY[@]} = 0 ]] || printf '%s\\n' \"${COMPREPLY[@]}\" > "
              "reply.out\n";
    folder_.With("reply.out", "");
    const std::string file = folder_.With("ask.out", script);
    const std::string command = "bash --norc --noprofile " + InQuotes(file);
    EXPECT_EQ(std::system(command.c_str()), 0) << script;
    return Lines(folder_.Text("reply.out"));
  }

  TemporaryFolder folder_;
};

// Names that begin a line of help, as "  surface   Fit a …".
Words InHelp(const Words& command, const std::regex& form) {
  Words arguments = command;
  arguments.emplace_back("--help");
  Words names;
  for (const std::string& line : Lines(Batten(arguments).out)) {
    std::smatch match;
    if (std::regex_search(line, match, form)) names.push_back(match[1]);
  }
  return names;
}

TEST_F(CompletionTest, CommandsAreThoseOfHelp) {
  const std::regex command("^  ([a-z]+)  +[A-Z]");
  const Words all = Offered({""});
  EXPECT_THAT(all, IsSupersetOf({"fit", "compare", "edit", "make", "completion"}));
  EXPECT_THAT(all, ::testing::UnorderedElementsAreArray(InHelp({}, command)));
  EXPECT_THAT(Offered({"co"}), ElementsAre("compare", "completion", "convert"));
  EXPECT_THAT(Offered({"fit", ""}), ElementsAre("curve", "parts", "primitive", "solid", "surface"));
  EXPECT_THAT(Offered({"make", ""}),
              ::testing::UnorderedElementsAreArray(InHelp({"make"}, command)));
  EXPECT_THAT(Offered({"nonsense"}), IsEmpty());
}

TEST_F(CompletionTest, FlagsAreThoseOfHelpLessThoseGiven) {
  const std::regex flag("^  (?:-., *)?(--[a-z-]+)");
  for (const Words& command : std::vector<Words>{{"fit", "surface"},
                                                 {"fit", "curve"},
                                                 {"fit", "primitive"},
                                                 {"make", "arc"},
                                                 {"compare"},
                                                 {"evaluate"},
                                                 {"sample"},
                                                 {"tessellate"}}) {
    Words words = command;
    words.emplace_back("-");
    EXPECT_THAT(Offered(words), ::testing::UnorderedElementsAreArray(InHelp(command, flag)))
        << command.back();
  }
  EXPECT_THAT(Offered({"fit", "surface", "a.ply", "--to"}), ElementsAre("--tolerance"));
  EXPECT_THAT(Offered({"fit", "surface", "--tolerance", "1", "--to"}), IsEmpty());
  EXPECT_THAT(Offered({"fit", "surface", "--report", "r.json", "--rep"}), ElementsAre("--report"));
  EXPECT_THAT(Offered({"info", "--", "-"}), IsEmpty());
}

TEST_F(CompletionTest, WordsOfFlagsAreThoseTheProgramTakes) {
  EXPECT_THAT(
      Offered({"fit", "surface", "--base", ""}),
      UnorderedElementsAre("auto", "plane", "sheet", "revolution", "sphere", "torus", "wing"));
  EXPECT_THAT(Offered({"fit", "surface", "--loss", "h"}), ElementsAre("huber"));
  EXPECT_THAT(Offered({"fit", "primitive", "--kind", "c"}),
              ElementsAre("circle", "cone", "cylinder"));
  EXPECT_THAT(Offered({"fit", "curve", "a.xyz", "--unit", "in"}), ElementsAre("in", "inch"));
  EXPECT_THAT(Offered({"convert", "--format", "s"}), Contains("step"));
  EXPECT_THAT(Offered({"fit", "surface", "--tolerance", ""}), IsEmpty());
  EXPECT_THAT(Offered({"completion", ""}), ElementsAre("bash", "fish", "zsh"));
  EXPECT_THAT(Offered({"fit", "solid", "--output-format", ""}),
              UnorderedElementsAre("step", "stl", "obj", "ply", "glb"));
  EXPECT_THAT(Offered({"fit", "solid", "--clean", ""}), ElementsAre("auto", "none", "statistical"));
  EXPECT_THAT(Offered({"fit", "solid", "--lo"}), IsEmpty());
  // Every word of a closed list is taken, others are not.
  const std::string cloud = folder_.With("cloud.xyz", ToText(WavySheet(30)));
  for (const char* const flag :
       {"--loss", "--base", "--closed", "--trim", "--normals", "--parameterization", "--unit"}) {
    for (const std::string& word : Offered({"fit", "surface", flag, ""})) {
      const ProgramRun run = Batten({"fit", "surface", cloud, "-o", "out.xxx", flag, word});
      EXPECT_THAT(run.err, ::testing::HasSubstr("out.xxx")) << flag << ' ' << word;
    }
  }
}

TEST_F(CompletionTest, BashSplitsAtEqualSignsAndColons) {
  EXPECT_THAT(Offered({"fit", "surface", "--loss", "=", "hu"}), ElementsAre("huber"));
  EXPECT_THAT(Offered({"fit", "surface", "--loss", "="}), Contains("huber"));
  EXPECT_THAT(Offered({"fit", "surface", "--loss=hu"}), ElementsAre("--loss=huber"));
  EXPECT_THAT(Offered({"edit", "a.json", "insert"}), ElementsAre("insert-knot:"));
  EXPECT_THAT(Offered({"edit", "a.json", "insert-knot", ":"}),
              ElementsAre("at=", "dir=", "times="));
  EXPECT_THAT(Offered({"edit", "a.json", "insert-knot:"}),
              ElementsAre("insert-knot:at=", "insert-knot:dir=", "insert-knot:times="));
  EXPECT_THAT(Offered({"edit", "a.json", "insert-knot", ":", "at", "=", "0.3,ti"}),
              ElementsAre("0.3,times="));
  EXPECT_THAT(Offered({"edit", "a.json", "reverse:", "cut", ":", "plane", "=", "0,keep", "=", "b"}),
              ElementsAre("below", "both"));
}

TEST_F(CompletionTest, FilesAreThoseThatCanBeReadOrWrittenThere) {
  for (const char* const name :
       {"a.json", "a.step", "A.IGS", "a.ply", "a.xyz", "a.3dm", "a.cc", "spaced name.ply"}) {
    folder_.With(name, "");
  }
  std::filesystem::create_directory(folder_.File("sub"));
  folder_.With("sub/b.step", "");
  EXPECT_THAT(Offered({"analyze", ""}), UnorderedElementsAre("A.IGS", "a.json", "a.step", "sub"));
  EXPECT_THAT(Offered({"analyze", "a"}), UnorderedElementsAre("a.json", "a.step"));
  EXPECT_THAT(Offered({"analyze", "sub/"}), ElementsAre("sub/b.step"));
  EXPECT_THAT(Offered({"analyze", folder_.File("sub/")}), ElementsAre(folder_.File("sub/b.step")));
  const Words clouds = Offered({"fit", "surface", "a.xyz", ""});
  EXPECT_THAT(clouds, IsSupersetOf({"a.ply", "a.xyz", "spaced name.ply", "sub"}));
  EXPECT_THAT(clouds, Not(Contains("a.json")));
  EXPECT_THAT(clouds, Not(Contains("a.cc")));
  EXPECT_THAT(Offered({"fit", "surface", "spaced\\ na"}), ElementsAre("spaced name.ply"));
  EXPECT_THAT(Offered({"fit", "surface", "\"spaced na"}), ElementsAre("spaced name.ply"));
  EXPECT_THAT(Offered({"compare", "a.json", "a."}), IsSupersetOf({"a.ply", "a.xyz"}));
  EXPECT_THAT(Offered({"fit", "surface", "a.ply", "-o", "a"}),
              UnorderedElementsAre("a.json", "a.step"));
  EXPECT_THAT(Offered({"info", "a"}), IsSupersetOf({"a.json", "a.step", "a.ply", "a.xyz"}));
  EXPECT_THAT(Offered({"convert", "a"}), IsSupersetOf({"a.json", "a.step", "a.ply", "a.xyz"}));
  EXPECT_THAT(Offered({"convert", "a.ply", "a.xyz", "spa"}), ElementsAre("spaced name.ply"));
  EXPECT_THAT(Offered({"analyze", "nowhere/"}), IsEmpty());
}

// Every command that says in its usage that it takes files is offered some.
TEST_F(CompletionTest, EveryCommandOffersFilesWhereItTakesThem) {
  folder_.With("a.json", "");
  folder_.With("a.ply", "");
  const std::regex takes("(GEOMETRY|CLOUD|POINTS|FILE|CURVE)");
  int takers = 0;
  for (const std::string& command : Offered({""})) {
    const std::string help = Batten({command, "--help"}).out;
    const std::string usage = help.substr(0, help.find('\n', help.find("batten " + command)));
    if (!std::regex_search(usage, takes)) continue;
    ++takers;
    EXPECT_THAT(Offered({command, "a."}), Not(IsEmpty())) << command;
  }
  EXPECT_GE(takers, 8);
}

TEST_F(CompletionTest, NothingTypedMakesItFail) {
  for (const Words& words :
       std::vector<Words>{{"="},
                          {":", "="},
                          {"--"},
                          {"-"},
                          {"--nonsense", ""},
                          {"--nonsense=", "x"},
                          {"edit", "x", "nonsense:"},
                          {"edit", "x", ":"},
                          {"fit", "surface", "'"},
                          {"fit", "surface", "\\"},
                          {"fit", "surface", std::string(10000, 'x')},
                          {"fit", "surface", "--quiet=", ""},
                          {"/proc/self/mem", ""},  // no name of a format, unreadable
                          {"fit", "/proc/self/mem", "--"},
                          {"analyze", "~nobody/"},
                          {"analyze", "\xff\xfe"}}) {
    Words arguments = words;
    arguments.insert(arguments.begin(), "__complete");
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
  }
  EXPECT_EQ(Batten({"__complete"}).code, 0);
}

TEST_F(CompletionTest, TheScriptIsTheOneThatIsInstalled) {
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    std::ifstream file(std::string(BATTEN_SOURCE_DIR) + "/cli/terminal/batten." + shell);
    std::ostringstream text;
    text << file.rdbuf();
    EXPECT_EQ(Batten({"completion", shell}).out, text.str());
  }
  EXPECT_EQ(Batten({"completion", "csh"}).code, 2);
  EXPECT_THAT(Batten({"completion", "bsh"}).err, ::testing::HasSubstr("'bash'"));
}

}  // namespace batten::internal::completion_test
