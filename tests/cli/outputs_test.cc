// SPDX-License-Identifier: MIT
// All outputs of a run or none, whatever stands in the way; and what reaches the terminal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "cli/commands/commands.h"
#include "test_clouds.h"

namespace batten::internal::outputs_test {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class OutputsTest : public ::testing::Test {
 protected:
  OutputsTest() { folder_.With("c.xyz", ToText(WavySheet(300))); }

  // The exit code of a line of bash, run in the folder; $B is the program, words go to `said`.
  int Shell(const std::string& line) const {
    ::setenv("B", BATTEN_PROGRAM, 1);
    const std::string all = "cd '" + folder_.path().string() + "' && exec bash -o pipefail -c '{ " +
                            line + "; } > said 2>&1'";
    return WEXITSTATUS(std::system(all.c_str()));
  }
  bool Has(const std::string& name) const { return std::filesystem::exists(folder_.File(name)); }
  std::string said() const { return folder_.Text("said"); }

  TemporaryFolder folder_;
};

TEST_F(OutputsTest, ALimitOnTheSizeOfFilesIsAnErrorThatNamesTheFile) {
  for (const char* const work : {"make torus -o t.step --major-radius 20 --minor-radius 4",
                                 "fit surface c.xyz -o t.iges",
                                 "convert c.xyz t.ply"}) {
    SCOPED_TRACE(work);
    // The words go to a pipe: the limit would hold for their file too.
    EXPECT_EQ(Shell(std::string("(ulimit -f 0; exec \"$B\" ") + work + ") 2>&1 | cat"), 1);
    EXPECT_THAT(said(), HasSubstr("can't be written: File too large"));
    EXPECT_EQ(folder_.Entries(), 2);  // the cloud, and what was said
  }
}

TEST_F(OutputsTest, AFileNameTooLongIsSaidBeforeTheFit) {
  const std::string name = std::string(300, 'a') + ".json";
  EXPECT_EQ(Shell("\"$B\" fit surface c.xyz -o " + name), 1);
  EXPECT_EQ(said(), "batten: " + name + ": can't be written: File name too long\n");
  EXPECT_EQ(folder_.Entries(), 2);
}

TEST_F(OutputsTest, AMissingModuleIsSaidBeforeTheInputIsRead) {
  if (std::filesystem::exists("/usr/local/lib/batten")) GTEST_SKIP() << "a module is installed";
  // Far from its build the program finds no module.
  EXPECT_EQ(
      Shell("mkdir bin; cp \"$B\" bin; BATTEN_MODULES= bin/batten fit surface none.xyz -o a.step"),
      1);
  EXPECT_THAT(said(), HasSubstr("need the module libbatten_opencascade.so"));
  EXPECT_EQ(Shell("BATTEN_MODULES= bin/batten fit surface none.xyz -o a.json"), 1);
  EXPECT_THAT(said(), HasSubstr("none.xyz"));
}

TEST_F(OutputsTest, AModuleThatIsNotBuiltYetIsNamedWithWhatBuildsIt) {
  if (std::filesystem::exists("/usr/local/lib/batten")) GTEST_SKIP() << "a module is installed";
  EXPECT_EQ(Shell("mkdir bin; cp \"$B\" bin; BATTEN_MODULES= bin/batten fit solid c.xyz -o a.stl"),
            1);
  EXPECT_THAT(said(), HasSubstr("libbatten_reconstruction.so"));
  EXPECT_THAT(said(), HasSubstr("./scripts/start"));
  EXPECT_FALSE(Has("a.stl"));
}

// batten_first, which scripts/start fits with before the rest is compiled.
TEST_F(OutputsTest, TheFirstProgramFitsAsTheWholeDoesAndNamesWhatIsStillToBeBuilt) {
  ::setenv("F", BATTEN_FIRST, 1);
  const std::string fit = " fit surface c.xyz -o ";
  ASSERT_EQ(Shell("\"$F\"" + fit + "f.step && \"$F\" convert f.step f.json"), 0) << said();
  ASSERT_EQ(Shell("\"$B\"" + fit + "w.step && \"$B\" convert w.step w.json"), 0) << said();
  EXPECT_EQ(folder_.Text("f.json"), folder_.Text("w.json"));
  EXPECT_EQ(Shell("\"$F\" tessellate f.step -o f.stl && \"$F\" f.step --at 0.5,0.5"), 2);
  EXPECT_THAT(said(),
              HasSubstr("'batten info' is not in this first program; ./scripts/start builds"));
  EXPECT_TRUE(Has("f.stl"));
  // Every command is known to both, and either runs or says what it needs.
  std::string later;
  for (const ProgramCommand& command : AllCommands()) {
    const std::string typed = (command.of_fit ? "fit " : "") + std::string(command.name);
    SCOPED_TRACE(typed);
    if (Shell("\"$F\" " + typed + " --help") == 0) {
      EXPECT_THAT(said(), HasSubstr("Examples:"));
    } else {
      EXPECT_EQ(said(),
                "batten: 'batten " + typed +
                    "' is not in this first program; ./scripts/start builds "
                    "build/release/bin/batten, which has it\n");
      later += command.name + std::string(" ");
    }
  }
  EXPECT_THAT(later, AllOf(HasSubstr("solid"), HasSubstr("compare"), Not(HasSubstr("surface"))));
  EXPECT_EQ(Shell("\"$F\" --help | grep -q \"Not in this first program: ./scripts/start builds\""),
            0);
}

TEST_F(OutputsTest, NothingIsLeftWhereOneOfTheOutputsFails) {
  folder_.With("g.json", kRationalPatch);
  std::filesystem::create_symlink("/dev/full", folder_.File("r.json"));
  EXPECT_EQ(Shell("\"$B\" fit surface c.xyz -o a.json --report r.json"), 1);
  EXPECT_THAT(said(), HasSubstr("r.json: can't be written"));
  EXPECT_EQ(Shell("\"$B\" fit surface c.xyz -o a.json --residuals e.csv --report r.json"), 1);
  EXPECT_EQ(Shell("\"$B\" fit surface c.xyz -o a.json > /dev/full"), 1);
  EXPECT_THAT(said(), HasSubstr("standard output: can't be written"));
  EXPECT_EQ(Shell("\"$B\" compare g.json c.xyz --residuals e.csv --report r.json"), 1);
  EXPECT_FALSE(Has("a.json"));
  EXPECT_FALSE(Has("e.csv"));
  EXPECT_EQ(folder_.Entries(), 4);
}

TEST_F(OutputsTest, WhoeverReadsOnlyTheFirstLineStillGetsTheFiles) {
  EXPECT_EQ(Shell("\"$B\" fit surface c.xyz -o a.json --json | true"), 141);
  EXPECT_TRUE(Has("a.json"));
  EXPECT_EQ(folder_.Entries(), 3);
}

// A shell without job control has what it runs in the background ignore interrupts.
TEST_F(OutputsTest, AnIgnoredInterruptStaysIgnored) {
  const auto interrupted = [&](const std::string& signals) {
    return Shell("mkfifo p; " + signals +
                 " \"$B\" fit surface - --format text -o a.json < p & exec 3> p; sleep 0.5; "
                 "kill -INT $!; sleep 0.2; cat c.xyz >&3; exec 3>&-; wait $!; code=$?; rm p; "
                 "exit $code");
  };
  EXPECT_EQ(interrupted(""), 0) << said();
  EXPECT_TRUE(Has("a.json"));
  std::filesystem::remove(folder_.File("a.json"));
  EXPECT_EQ(interrupted("env --default-signal=INT"), 130) << said();
  EXPECT_FALSE(Has("a.json"));
}

TEST_F(OutputsTest, NamesReachTheTerminalWithoutControlCharacters) {
  const std::string name = "a\nb\x1b[31m\xff\u202e\u00e9.xyz";
  const ProgramRun made = Batten({"sample",
                                  folder_.With("g.json", kRationalPatch),
                                  "-o",
                                  folder_.File(name),
                                  "--count",
                                  "100"});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("a\\nb\\x1b[31m\\xff\\xe2\\x80\\xae\u00e9.xyz: 100 points"));
  const ProgramRun fitted =
      Batten({"fit", "surface", folder_.File(name), "-o", folder_.File(name + ".json")});
  const ProgramRun missing = Batten({"info", folder_.File(name + ".not")});
  EXPECT_EQ(missing.error_lines(), 1);
  for (const std::string& text : {made.out, fitted.out, fitted.err, missing.err}) {
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 2) << text;
    EXPECT_THAT(text, Not(HasSubstr("\x1b")));
  }
}

TEST_F(OutputsTest, SoDoNamesInsideFiles) {
  Json geometry = Json::parse(kRationalPatch);
  geometry["shape"]["data"][0]["name"] = "red \x1b[31m\nnext";
  const std::string path = folder_.With("n.json", geometry.dump());
  for (const char* const command : {"info", "analyze"}) {
    const ProgramRun run = Batten({command, path});
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, Not(HasSubstr("\x1b")));
    EXPECT_THAT(run.out, Not(HasSubstr("\nnext")));
  }
}

}  // namespace batten::internal::outputs_test
