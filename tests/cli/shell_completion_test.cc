// SPDX-License-Identifier: MIT
// Completion in zsh and fish: the scripts are run by the shells themselves; skipped where there is
// none. What the program offers is tested with bash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "test_clouds.h"

namespace batten::internal::shell_completion_test {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::UnorderedElementsAre;

using Words = std::vector<std::string>;

std::string InQuotes(const std::string& word) {
  std::string quoted = "'";
  for (const char letter : word) quoted += letter == '\'' ? "'\\''" : std::string(1, letter);
  return quoted + "'";
}

class ShellCompletionTest : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (std::system(("command -v " + GetParam() + " > /dev/null").c_str()) != 0) {
      GTEST_SKIP() << GetParam() << " is not installed";
    }
    folder_.With("scan.ply", "");
    folder_.With("my part.step", "");
    folder_.With("notes.pdf", "");
    std::filesystem::create_directory(folder_.File("parts"));
  }

  // What the shell offers for the last of the words, which follow the program's name.
  Words Offered(const Words& words) const {
    folder_.With("reply.out", "");
    const std::string script = "cd " + InQuotes(folder_.path().string()) + "\n" +
                               (GetParam() == "zsh" ? ZshScript(words) : FishScript(words));
    const std::string file = folder_.With("ask.out", script);
    const std::string shell = GetParam() == "zsh" ? "zsh -f " : "HOME=$PWD fish --no-config ";
    EXPECT_EQ(std::system((shell + InQuotes(file)).c_str()), 0) << script;
    Words lines;
    std::istringstream stream(folder_.Text("reply.out"));
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  }

  TemporaryFolder folder_;

 private:
  // As zsh calls the function, with a compadd that says what it is given after its flags.
  static std::string ZshScript(const Words& words) {
    std::string script = "compdef() { true }\nsource <(" + std::string(InQuotes(BATTEN_PROGRAM)) +
                         " completion zsh)\ncompadd() {\n  while [[ $1 != -- ]]; do shift; done\n"
                         "  shift\n  print -rl -- \"$@\" > reply.out\n}\nwords=(" +
                         InQuotes(BATTEN_PROGRAM);
    for (const std::string& word : words) script += ' ' + InQuotes(word);
    return script + ")\nCURRENT=$#words\nPREFIX=$words[-1]\n_batten\ntrue\n";
  }

  static std::string FishScript(const Words& words) {
    std::string line = "batten";
    for (const std::string& word : words) line += ' ' + word;
    return "set PATH " + InQuotes(std::filesystem::path(BATTEN_PROGRAM).parent_path().string()) +
           " $PATH\nbatten completion fish | source\ncomplete -C " + InQuotes(line) +
           " > reply.out\n";
  }
};

TEST_P(ShellCompletionTest, OffersCommandsFlagsAndWords) {
  EXPECT_THAT(Offered({"co"}), UnorderedElementsAre("compare", "completion", "convert"));
  EXPECT_THAT(Offered({"fit", ""}),
              UnorderedElementsAre("curve", "parts", "primitive", "solid", "surface"));
  EXPECT_THAT(Offered({"fit", "surface", "a.ply", "--to"}), ElementsAre("--tolerance"));
  EXPECT_THAT(Offered({"fit", "surface", "a.ply", "--loss", "h"}), ElementsAre("huber"));
  EXPECT_THAT(Offered({"fit", "surface", "a.ply", "--loss=h"}), ElementsAre("--loss=huber"));
  EXPECT_THAT(Offered({"edit", "a.json", "split:"}), IsSupersetOf({"split:at=", "split:dir="}));
  EXPECT_THAT(Offered({"fit", "surface", "a.ply", "--tolerance", "x"}), IsEmpty());
}

TEST_P(ShellCompletionTest, OffersFilesTheCommandReads) {
  const bool zsh = GetParam() == "zsh";  // which puts the slash after a folder by itself
  const std::string folder = zsh ? "parts" : "parts/";
  EXPECT_THAT(Offered({"fit", "surface", ""}), UnorderedElementsAre("scan.ply", folder));
  EXPECT_THAT(Offered({"analyze", ""}),
              UnorderedElementsAre(zsh ? "my\\ part.step" : "my part.step", folder));
}

INSTANTIATE_TEST_SUITE_P(Shells, ShellCompletionTest, ::testing::Values("zsh", "fish"));

}  // namespace batten::internal::shell_completion_test
