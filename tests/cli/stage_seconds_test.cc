// SPDX-License-Identifier: MIT
// Every second of a report belongs to a stage.
#include <gtest/gtest.h>

#include "test_clouds.h"

namespace batten::internal::stage_seconds_test {

TEST(StageSecondsTest, AddUpToTheTotal) {
  const TemporaryFolder folder;
  const std::string sheet = folder.With("sheet.xyz", ToText(WavySheet(2000)));
  std::vector<Row> circles;
  for (int k = 0; k < 400; ++k) {
    const double angle = 2 * std::numbers::pi * k / 200, x = k < 200 ? 0 : 5;
    circles.push_back({x + std::cos(angle), 1.5 * std::sin(angle)});
  }
  const std::string curves = folder.With("curves.xy", ToText(circles));
  const std::string surface = folder.File("a.json");
  const std::vector<std::vector<std::string>> commands = {
      {"fit", "surface", sheet, "-o", surface},
      {"fit", "surface", sheet, "-o", surface, "--tolerance", "0.05"},
      {"fit", "surface", sheet, "-o", surface, "--thin", "0.4"},
      {"fit", "surface", sheet, "-o", surface, "--symmetric", "y"},
      {"fit", "surface", sheet, "-o", surface, "--optimize", "params,knots"},
      {"fit", "curve", curves, "-o", folder.File("b.json"), "--order", "auto", "--component", "1"},
      {"fit",
       "curve",
       curves,
       "-o",
       folder.File("b.json"),
       "--order",
       "auto",
       "--component",
       "all"},
      {"fit", "primitive", sheet, "-o", folder.File("c.json"), "--kind", "plane"},
      {"compare", surface, sheet}};
  for (std::vector<std::string> command : commands) {
    std::string words;
    for (const std::string& word : command) words += word + ' ';
    SCOPED_TRACE(words);
    command.push_back("--json");
    if (command[0] == "fit")
      command.push_back("--accept-doubt");  // a plane is not the sheet's shape
    const ProgramRun run = Batten(command);
    ASSERT_EQ(run.code, 0) << run.err;
    const Json seconds = Json::parse(run.out)["seconds"];
    const double total = seconds["total"].get<double>();
    double sum = 0;
    for (const auto& [stage, value] : seconds.items()) {
      EXPECT_GE(value.get<double>(), 0) << stage;
      if (stage != "total") sum += value.get<double>();
    }
    EXPECT_NEAR(sum, total, 1e-9 * total);
    EXPECT_LE(total, run.seconds);
    if (!words.starts_with("fit surface")) continue;
    for (const char* stage :
         {"read", "prepare", "parameterize", "solve", "trim", "project", "write"}) {
      EXPECT_GT(seconds[stage].get<double>(), 0) << stage;
    }
  }
}

}  // namespace batten::internal::stage_seconds_test
