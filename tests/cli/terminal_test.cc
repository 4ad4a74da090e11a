// SPDX-License-Identifier: MIT
// What is drawn on a terminal, in which colours, and what is left of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include "run_on_terminal.h"
#include "test_clouds.h"

namespace batten::internal::terminal_test {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double kPatience = 60;  // seconds, on a machine that has much to do

class TerminalTest : public ::testing::Test {
 protected:
  // A fit that waits for its points.
  std::vector<std::string> Waiting(std::vector<std::string> flags = {}) const {
    flags.insert(
        flags.begin(),
        {"fit", "surface", "-", "--format", "text", "-o", out_, "--control-points", "6,6"});
    return flags;
  }

  // A comparison that is over at once.
  std::vector<std::string> Comparison(const char* tolerance) const {
    return {"compare", patch_, cloud_, "--tolerance", tolerance};
  }

  static bool BarSeen(const std::string& seen) { return seen.find("\rread") != std::string::npos; }

  TemporaryFolder folder_;
  std::string out_ = folder_.File("out.json");
  std::string patch_ = folder_.With("patch.json", kRationalPatch);
  std::string cloud_ = folder_.With("cloud.xyz", "0 0 0\n1 1 0\n0.5 0.5 0.25\n1 0.5 0.75\n");
  std::string points_ = ToText(WavySheet(300));
};

TEST_F(TerminalTest, AfterASecondABarIsDrawnAndWipedAtTheEnd) {
  TerminalRun run(Waiting());
  EXPECT_FALSE(run.ReadUntil(BarSeen, 0.7));
  EXPECT_EQ(run.seen(), "");
  ASSERT_TRUE(run.ReadUntil(BarSeen, kPatience));
  // Nothing is read, and it moves.
  ASSERT_TRUE(run.ReadUntil(
      [](const std::string& seen) { return seen.find("0:02") != std::string::npos; }, kPatience));
  run.Feed(points_);
  run.CloseInput();
  EXPECT_EQ(run.Wait(), 0);
  // Only the result, and what is to be said of it, stays.
  std::istringstream screen(run.Screen());
  for (std::string line; std::getline(screen, line);)
    EXPECT_THAT(line, AnyOf(StartsWith(out_ + ": surface of degree 3,3"), StartsWith("batten: ")));
  EXPECT_THAT(run.Screen(), HasSubstr("surface of degree"));
}

TEST_F(TerminalTest, CtrlCWipesTheBarAndLeavesNothing) {
  const std::ptrdiff_t before = folder_.Entries();
  TerminalRun run(Waiting());
  ASSERT_TRUE(run.ReadUntil(BarSeen, kPatience));
  const auto start = std::chrono::steady_clock::now();
  run.Type("\x03");
  EXPECT_EQ(run.Wait(), 130);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_LT(took.count(), 1.0);
  EXPECT_THAT(run.Screen(), HasSubstr("interrupted; nothing was written\n"));
  EXPECT_THAT(run.Screen(), Not(HasSubstr("read")));
  EXPECT_EQ(folder_.Entries(), before);
}

TEST_F(TerminalTest, NothingIsDrawnInFilesQuietlyOrWhereNoLineCanBeTakenBack) {
  TerminalSetting to_file, dumb;
  to_file.errors_file = folder_.File("errors.txt");
  dumb.environment = {{"TERM", "dumb"}};
  const std::vector<std::pair<std::vector<std::string>, TerminalSetting>> cases = {
      {Waiting(), to_file}, {Waiting({"--quiet"}), {}}, {Waiting(), dumb}};
  std::vector<std::unique_ptr<TerminalRun>> runs;  // all at once
  for (const auto& [arguments, setting] : cases)
    runs.push_back(std::make_unique<TerminalRun>(arguments, setting));
  double patience = 1.6;
  for (const auto& run : runs) {
    EXPECT_FALSE(run->ReadUntil(BarSeen, patience));
    EXPECT_EQ(run->seen(), "");
    run->Feed(points_);
    run->CloseInput();
    EXPECT_EQ(run->Wait(), 0);
    patience = 0.1;
  }
  EXPECT_THAT(folder_.Text("errors.txt"), Not(AnyOf(HasSubstr("\r"), HasSubstr("\033"))));
}

TEST_F(TerminalTest, TheBarStaysWithinNarrowTerminals) {
  std::vector<std::pair<int, std::unique_ptr<TerminalRun>>> runs;  // all at once
  for (const int columns : {8, 20, 200}) {
    TerminalSetting setting;
    setting.columns = columns;
    const std::vector<std::string> command = {
        "fit", "surface", "-", "--format", "text", "-o", out_};
    runs.emplace_back(columns, std::make_unique<TerminalRun>(command, setting));
  }
  for (const auto& [columns, run] : runs) {
    ASSERT_TRUE(run->ReadUntil(BarSeen, kPatience));
    run->Type("\x03");
    EXPECT_EQ(run->Wait(), 130);
    std::istringstream pieces(run->seen());
    for (std::string piece; std::getline(pieces, piece, '\r');) {
      if (piece.find("batten") == std::string::npos && piece.find('^') == std::string::npos) {
        EXPECT_LT(static_cast<int>(piece.size()), columns) << piece;
      }
    }
  }
}

TEST_F(TerminalTest, ErrorsWarningsAndVerdictsHaveTheirColours) {
  TerminalRun error({"info", folder_.File("none.json")});
  EXPECT_EQ(error.Wait(), 1);
  EXPECT_THAT(error.seen(), StartsWith("\033[1;31mbatten:\033[0m " + folder_.File("none.json")));

  TerminalRun usage({"fit", "surfcae"});
  EXPECT_EQ(usage.Wait(), 2);
  EXPECT_THAT(usage.seen(), StartsWith("\033[1;31mbatten:\033[0m unknown"));

  TerminalRun good(Comparison("10"));
  EXPECT_EQ(good.Wait(), 0);
  EXPECT_THAT(good.seen(), HasSubstr("; \033[32m0 out of tolerance 10\033[0m"));

  TerminalRun bad(Comparison("1e-9"));
  EXPECT_EQ(bad.Wait(), 3);
  EXPECT_THAT(bad.seen(), HasSubstr("; \033[33m"));
  EXPECT_THAT(bad.seen(), HasSubstr(" out of tolerance 1e-09\033[0m"));

  const std::string gap = folder_.With("gap.xyz", "0 0 0\nnan 1 0\n0.5 0.5 0.25\n");
  TerminalRun warning({"project", patch_, gap});
  EXPECT_EQ(warning.Wait(), 0);
  EXPECT_THAT(warning.seen(), StartsWith("batten: \033[33mwarning:\033[0m 1 of 3 points"));
}

TEST_F(TerminalTest, NoColorAndDumbTerminalsHaveNone) {
  for (const auto& [name, value, coloured] :
       std::vector<std::tuple<std::string, std::string, bool>>{{"NO_COLOR", "1", false},
                                                               {"NO_COLOR", "0", false},
                                                               {"NO_COLOR", "", true},
                                                               {"TERM", "dumb", false},
                                                               {"TERM", "vt100", true}}) {
    SCOPED_TRACE(name + "=" + value);
    TerminalSetting setting;
    setting.environment = {{name, value}};
    for (const std::vector<std::string>& arguments :
         {Comparison("1e-9"), std::vector<std::string>{"info", "none.json"}}) {
      TerminalRun run(arguments, setting);
      run.Wait();
      EXPECT_EQ(run.seen().find('\033') != std::string::npos, coloured) << run.seen();
    }
  }
}

TEST_F(TerminalTest, StreamsAreJudgedSeparately) {
  TerminalSetting output, errors;
  output.output_file = folder_.File("output.txt");
  errors.errors_file = folder_.File("errors.txt");
  TerminalRun verdict(Comparison("10"), output);
  EXPECT_EQ(verdict.Wait(), 0);
  EXPECT_THAT(folder_.Text("output.txt"), Not(HasSubstr("\033")));
  TerminalRun error_on_terminal({"info", "none.json"}, output);
  EXPECT_EQ(error_on_terminal.Wait(), 1);
  EXPECT_THAT(error_on_terminal.seen(), HasSubstr("\033[1;31m"));
  TerminalRun verdict_on_terminal(Comparison("10"), errors);
  EXPECT_EQ(verdict_on_terminal.Wait(), 0);
  EXPECT_THAT(verdict_on_terminal.seen(), HasSubstr("\033[32m"));
  TerminalRun error({"info", "none.json"}, errors);
  EXPECT_EQ(error.Wait(), 1);
  EXPECT_THAT(folder_.Text("errors.txt"), StartsWith("batten: none.json"));
}

TEST_F(TerminalTest, JsonHasNoColours) {
  std::vector<std::string> arguments = Comparison("1e-9");
  arguments.emplace_back("--json");
  TerminalRun run(arguments);
  EXPECT_EQ(run.Wait(), 3);
  EXPECT_THAT(run.seen(), StartsWith("{"));
  EXPECT_THAT(run.seen(), Not(HasSubstr("\033")));
}

}  // namespace batten::internal::terminal_test
