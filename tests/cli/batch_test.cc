// SPDX-License-Identifier: MIT
// Laws of batch: every job as if run alone, nothing done twice, nothing half done.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "cli/arguments/csv_table.h"
#include "test_clouds.h"

namespace batten::internal::batch_test {

using ::testing::HasSubstr;
using ::testing::Not;

class BatchTest : public ::testing::Test {
 protected:
  std::string Table(const std::string& rows) const { return folder_.With("jobs.csv", rows); }
  std::string In(const std::string& name) const { return folder_.File(name); }
  std::vector<CsvRow> Results() const { return ReadCsv(In("jobs.results.csv")); }
  static std::string Cell(const std::vector<CsvRow>& rows, size_t row, const std::string& column) {
    const auto& names = rows.front().cells;
    const auto at = std::find(names.begin(), names.end(), column) - names.begin();
    return rows.at(row).cells.at(static_cast<size_t>(at));
  }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

  TemporaryFolder folder_;
  std::string wavy_ = folder_.With("wavy.xyz", ToText(WavySheet(1500)));
  std::string other_ = folder_.With("other, too.xyz", ToText(WavySheet(1500, 2)));
};

TEST_F(BatchTest, JobsWriteWhatTheProgramWritesAlone) {
  const std::string table = Table("input,output,degree,trim,keep-outliers\n" + wavy_ + "," +
                                  In("a.json") + ",\"4,3\",none,no\r\n\n# a comment\n\"" + other_ +
                                  "\"," + In("b.json") + ",,none,yes\n");
  const ProgramRun run = Batten({"batch", table, "--jobs", "2", "--threads", "2"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  ASSERT_EQ(Batten({"fit",
                    "surface",
                    wavy_,
                    "-o",
                    In("a1.json"),
                    "--degree",
                    "4,3",
                    "--trim",
                    "none",
                    "--threads",
                    "1"})
                .code,
            0);
  ASSERT_EQ(Batten({"fit",
                    "surface",
                    other_,
                    "-o",
                    In("b1.json"),
                    "--trim",
                    "none",
                    "--keep-outliers",
                    "--threads",
                    "1"})
                .code,
            0);
  EXPECT_EQ(folder_.Text("a.json"), folder_.Text("a1.json"));
  EXPECT_EQ(folder_.Text("b.json"), folder_.Text("b1.json"));
  const auto rows = Results();
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(Cell(rows, 1, "exit_code"), "0");
  EXPECT_EQ(Cell(rows, 1, "points"), "1500");
  EXPECT_EQ(Cell(rows, 2, "line"), "5");
  EXPECT_EQ(Cell(rows, 2, "input"), other_);
  const std::string page = folder_.Text("jobs.results.html");
  EXPECT_THAT(page, HasSubstr("<a href=\"a.report.html\">"));
  EXPECT_THAT(page, HasSubstr("<a href=\"other%2C%20too.xyz\">"));
  EXPECT_THAT(folder_.Text("b.report.html"), HasSubstr("<html"));
}

TEST_F(BatchTest, WhatIsDoneAndUnchangedIsNotDoneAgain) {
  const std::string head = "input,output,control-points\n";
  const std::string first = wavy_ + "," + In("a.json") + ",\"8,8\"\n";
  const std::string table =
      Table(head + first + "\"" + other_ + "\"," + In("b.json") + ",\"8,8\"\n");
  ASSERT_EQ(Batten({"batch", table}).code, 0);
  const auto skipped = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"batch", table, "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun run = Batten(words);
    EXPECT_EQ(run.code, 0) << run.err;
    const Json told = Json::parse(run.out);
    EXPECT_EQ(told["jobs"].size(), 2u);
    return told["skipped"].get<int>();
  };
  EXPECT_EQ(skipped({}), 2);
  EXPECT_EQ(skipped({"--again"}), 0);
  folder_.With("wavy.xyz", ToText(WavySheet(1501)));
  EXPECT_EQ(skipped({}), 1);
  Table(head + first + "\"" + other_ + "\"," + In("b.json") + ",\"8,9\"\n");
  EXPECT_EQ(skipped({}), 1);
  std::filesystem::remove(In("a.json"));
  EXPECT_EQ(skipped({}), 1);
  EXPECT_EQ(skipped({}), 2);
}

TEST_F(BatchTest, FailuresStandInTheTableAndAreTriedAgain) {
  const std::string line = folder_.With("line.xyz", "0 0 0\n1 1 1\n2 2 2\n3 3 3\n4 4 4\n");
  const std::string table =
      Table("output,input,tolerance\n" + In("a.json") + "," + line + ",\n" + In("b.json") + "," +
            wavy_ + ",1e-9\n" + In("c.json") + ",\"" + other_ + "\",1\n");
  const ProgramRun run = Batten({"batch", table});
  EXPECT_EQ(run.code, 1);
  const auto rows = Results();
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(Cell(rows, 1, "exit_code"), "1");
  EXPECT_THAT(Cell(rows, 1, "message"), HasSubstr("line.xyz"));
  EXPECT_EQ(Cell(rows, 2, "exit_code"), "3");
  EXPECT_EQ(Cell(rows, 2, "tolerance_reached"), "no");
  EXPECT_EQ(Cell(rows, 3, "exit_code"), "0");
  EXPECT_EQ(Cell(rows, 3, "tolerance_reached"), "yes");
  EXPECT_THAT(folder_.Text("jobs.results.html"), HasSubstr("failed (1)"));
  folder_.With("line.xyz", ToText(WavySheet(400)));
  const ProgramRun again = Batten({"batch", table, "--json"});
  EXPECT_EQ(again.code, 3) << again.err;
  EXPECT_EQ(Json::parse(again.out)["skipped"], 2);
}

TEST_F(BatchTest, LinesThatAreNoCommandLineAreRefusedBeforeAnyJobRuns) {
  const std::string good = wavy_ + "," + In("a.json") + ",";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"input,output,tolerance\n" + good + "\n" + wavy_ + "," + In("b.json") + ",fast\n",
       "jobs.csv: line 3: --tolerance: 'fast'"},
      {"input,output,tolerence\n" + good + "1\n", "did you mean '--tolerance'?"},
      {"input,output,snap\n" + good + "maybe\n", "line 2: snap: 'maybe' is neither yes nor no"},
      {"input,output,command\n" + good + "fit surfaec\n", "command: 'fit surfaec'"},
      {"input,output\n" + wavy_ + ",a.json,3\n", "line 2: has 3 cells, but 2 columns"},
      {"input,output\n" + In("none-*.ply") + ",a.json\n", "line 2: input: there is no file"},
      {"input,output\n" + wavy_ + "," + In("a.json") + "\n\n" + wavy_ + "," + In("a.json") + "\n",
       "jobs.csv: line 4: '" + In("a.json") + "' is written by line 2"},
      {"input,output\n" + wavy_ + "," + In("a.json") + "\n" + wavy_ + "," + wavy_ + "\n",
       "is written by line 3"},
      {"output\na.json\n", "line 1: there is no column named input"},
      {"input,json\n" + wavy_ + ",yes\n", "line 1: column json"},
      {"input,output\n\"" + wavy_ + ",a.json\n", "line 2: quotes that do not end"},
      {"input,output\n", "holds no job"},
      {"# nothing\n", "holds no row"}};
  for (const auto& [rows, reason] : cases) {
    const ProgramRun run = Batten({"batch", Table(rows)});
    EXPECT_EQ(run.code, 1) << rows;
    EXPECT_THAT(run.err, HasSubstr(reason)) << rows;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(In("a.json"))) << rows;
    EXPECT_FALSE(std::filesystem::exists(In("jobs.results.csv"))) << rows;
  }
  EXPECT_EQ(
      Batten({"batch", Table("input,output\n" + wavy_ + ",a.json\n"), "--results", wavy_}).code, 2);
}

TEST_F(BatchTest, CtrlCLeavesNothingHalfWrittenAndTheRestForLater) {
  const std::string large = folder_.With("large.xyz", ToText(WavySheet(200000)));
  const std::string slow = ",params,\"80,80\",\"9,9\"\n";
  const std::string table = Table("input,output,optimize,control-points,degree\n" + wavy_ + "," +
                                  In("a.json") + ",,,\n" + large + "," + In("b.json") + slow);
  constexpr double kFirstIsDone = 3;
  const ProgramRun run =
      Batten({"batch", table}, {.standard_input = "", .interrupt_after = kFirstIsDone});
  if (run.code == 0) GTEST_SKIP() << "the jobs were done before they could be interrupted";
  EXPECT_EQ(run.code, 130);
  EXPECT_LT(run.seconds, kFirstIsDone + 1);
  EXPECT_THAT(run.err, HasSubstr("1 of 2 jobs have results"));
  EXPECT_THAT(Names(),
              ::testing::ElementsAre("a.json",
                                     "a.report.html",
                                     "jobs.csv",
                                     "jobs.results.csv",
                                     "jobs.results.html",
                                     "large.xyz",
                                     "other, too.xyz",
                                     "wavy.xyz"));
  EXPECT_EQ(Results().size(), 2u);
}

TEST_F(BatchTest, PatternsAreOneCloudAndComparisonsNeedNoOutput) {
  folder_.With("part-1.xyz", ToText(WavySheet(700, 3)));
  folder_.With("part-2.xyz", ToText(WavySheet(800, 4)));
  ASSERT_EQ(
      Batten({"batch", Table("input,output\n" + In("part-*.xyz") + "," + In("a.json") + "\n")})
          .code,
      0);
  EXPECT_EQ(Cell(Results(), 1, "points"), "1500");
  const std::string table = folder_.With(
      "checks.csv", "command,input,tolerance\ncompare," + In("a.json") + ";" + wavy_ + ",0.5\n");
  const ProgramRun run = Batten({"batch", table});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(folder_.Text("checks.results.csv"), HasSubstr("compare,"));
}

TEST(CsvTableTest, CellsReadBackAsTheyWereWritten) {
  const TemporaryFolder folder;
  const std::vector<std::string> cells = {
      "a", "", "b,c", "say \"no\"", " blanks ", "two\nlines", "#"};
  const std::string path = folder.With("t.csv", CsvLine(cells) + CsvLine({"x"}));
  const std::vector<CsvRow> rows = ReadCsv(path);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].cells, cells);
  EXPECT_EQ(rows[1].line, 3);
}

}  // namespace batten::internal::batch_test
