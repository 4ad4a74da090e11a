// SPDX-License-Identifier: MIT
// Laws of --report R.html and --residuals, of every command that has them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <sstream>

#include "cli/terminal/shell_words.h"
#include "test_clouds.h"

namespace batten::internal::report_page_test {

using ::testing::HasSubstr;

class ReportPageTest : public ::testing::Test {
 protected:
  // Runs a command that writes the page and gives what the page is told.
  Json Page(std::vector<std::string> arguments, int code = 0) {
    const std::string page = folder_.File("page.html");
    arguments.insert(arguments.end(), {"--report", page});
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    const std::string html = folder_.Text("page.html"), open = "id=\"batten-data\">";
    const std::size_t begin = html.find(open) + open.size();
    return Json::parse(html.substr(begin, html.find("</script", begin) - begin));
  }

  static std::int64_t Counted(const Json& data) {
    const auto counts = data["histogram"]["counts"].get<std::vector<std::int64_t>>();
    return std::accumulate(counts.begin(), counts.end(), std::int64_t{0}) +
           data["histogram"]["below"].get<std::int64_t>() +
           data["histogram"]["above"].get<std::int64_t>();
  }

  TemporaryFolder folder_;
  std::string cloud_ = folder_.With("cloud.xyz", ToText(WavySheet(3000)));
};

TEST_F(ReportPageTest, ASurfaceFitGivesAPageThatHoldsItsReport) {
  const std::string json = folder_.File("r.json");
  const Json data =
      Page({"fit", "surface", cloud_, "-o", folder_.File("out.step"), "--report", json});
  EXPECT_EQ(data["title"], "out.step");
  EXPECT_EQ(data["kind"], "surface");
  Json report = Json::parse(folder_.Text("r.json"));
  EXPECT_EQ(data["report"]["error"], report["error"]);
  EXPECT_EQ(data["report"]["geometry"], report["geometry"]);
  EXPECT_EQ(data["report"]["iterations"].size(), report["iterations"].size());
  EXPECT_EQ(Counted(data), report["input"]["used"]);
  EXPECT_EQ(data["cloud"]["total"], 3000);
  EXPECT_EQ(data["surfaces"].size(), 1u);
  EXPECT_FALSE(report.contains("date"));
}

TEST_F(ReportPageTest, AnEarlierPageStandsBesideTheNewOne) {
  const std::string first = folder_.File("first.html"), both = folder_.File("both.html");
  const std::string out = folder_.File("a.json");
  EXPECT_EQ(Batten({"fit", "surface", cloud_, "-o", out, "--report", first, "--quiet"}).code, 0);
  const std::vector<std::string> compare = {
      "compare", out, cloud_, "--report", both, "--beside", first, "--quiet"};
  const ProgramRun run = Batten(compare);
  EXPECT_EQ(run.code, 0) << run.err;
  const auto data = [](const std::string& html, const std::string& open) {
    const std::size_t begin = html.find(open) + open.size();
    return html.substr(begin, html.find("</script", begin) - begin);
  };
  EXPECT_EQ(data(folder_.Text("both.html"), "id=\"batten-beside\">"),
            data(folder_.Text("first.html"), "id=\"batten-data\">"));
}

TEST_F(ReportPageTest, WhatCannotStandBesideIsToldBeforeTheWork) {
  const std::string page = folder_.File("page.html"), out = folder_.File("a.json");
  const auto refusal = [&](std::vector<std::string> flags, int code) {
    std::vector<std::string> words = {"fit", "surface", cloud_, "-o", out};
    words.insert(words.end(), flags.begin(), flags.end());
    const ProgramRun run = Batten(words);
    EXPECT_EQ(run.code, code);
    EXPECT_FALSE(std::filesystem::exists(out));
    return run.err;
  };
  EXPECT_THAT(refusal({"--beside", cloud_}, 2), HasSubstr("it needs --report R.html"));
  EXPECT_THAT(refusal({"--report", page, "--beside", cloud_}, 1), HasSubstr("no page that batten"));
  EXPECT_THAT(refusal({"--report", page, "--beside", folder_.File("none.html")}, 1),
              HasSubstr("none.html"));
  EXPECT_EQ(Batten({"fit", "surface", cloud_, "-o", folder_.File("b.json"), "--report", page}).code,
            0);
  EXPECT_THAT(refusal({"--report", page, "--beside", page}, 2), HasSubstr("would be lost"));
  EXPECT_THAT(refusal({"--report", folder_.File("c.html"), "--beside", page, "--unit", "m"}, 1),
              HasSubstr("its lengths are in mm, these in m: give both the same --unit"));
}

TEST_F(ReportPageTest, CurvesPrimitivesGridsAndComparisonsHavePages) {
  std::vector<Row> rows, grid;
  for (int ring = 0; ring < 2; ++ring) {
    for (int k = 0; k < 120; ++k) {
      const double angle = 2 * std::numbers::pi * k / 120;
      rows.push_back({(3 - ring) * std::cos(angle), (3 - ring) * std::sin(angle) + 10 * ring});
    }
  }
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 9; ++j) {
      grid.push_back({0.5 * i, 0.5 * j, std::sin(0.4 * i) * std::cos(0.3 * j)});
    }
  }
  const std::string rings = folder_.With("rings.xy", ToText(rows)),
                    lattice = folder_.With("grid.xyz", ToText(grid)),
                    out = folder_.File("rings.json");
  const Json curves = Page({"fit", "curve", rings, "-o", out, "--component", "all"});
  EXPECT_EQ(curves["kind"], "curve");
  EXPECT_EQ(curves["curves"].size(), 2u);
  EXPECT_TRUE(curves["signed"]);
  EXPECT_EQ(curves["cloud"]["shown"], 240);
  const Json plane =
      Page({"fit", "primitive", cloud_, "-o", folder_.File("p.step"), "--kind", "plane"}, 4);
  EXPECT_EQ(plane["surfaces"].size(), 1u);
  const Json sheet =
      Page({"fit", "surface", lattice, "-o", folder_.File("g.json"), "--grid", "12,9"});
  EXPECT_EQ(sheet["cloud"]["total"], 108);
  const Json again = Page({"compare", out, rings, "--tolerance", "1e-9"}, 3);
  EXPECT_EQ(again["curves"].size(), 2u);
  EXPECT_EQ(again["tolerance"], 1e-9);
  EXPECT_EQ(again["report"]["iterations"], Json::array());
  EXPECT_EQ(Counted(again), 240);
}

TEST_F(ReportPageTest, SameInputGivesTheSameBytesButForTimings) {
  ::setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  const std::vector<std::string> command = {
      "fit", "surface", cloud_, "-o", folder_.File("out.step"), "--threads", "2"};
  Json first = Page(command), second = Page(command);
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_EQ(first["date"], "2023-11-14 22:13 UTC");
  for (Json* data : {&first, &second}) {
    Json& report = (*data)["report"];
    report.erase("seconds");
    report.erase("peak_memory_bytes");
    for (Json& round : report["iterations"]) round.erase("seconds");
  }
  EXPECT_TRUE(first == second);
}

TEST_F(ReportPageTest, TheCommandCanBeRepeatedWhateverTheNames) {
  const std::string odd = folder_.With("a 'b' \"c\" <script> \xc3\xa4.xyz", ToText(WavySheet(500)));
  const std::string out = folder_.File("out.json");
  const Json data = Page({"fit", "surface", odd, "-o", out});
  const std::string first = folder_.Text("out.json");
  std::filesystem::remove(out);
  const std::string command = data["report"]["command"];
  ASSERT_EQ(std::system((command + " > /dev/null").c_str()), 0) << command;
  EXPECT_EQ(folder_.Text("out.json"), first);
}

TEST_F(ReportPageTest, WordsAreQuotedAsAShellReadsThem) {
  EXPECT_EQ(ShellWord("--at=0.5,1"), "--at=0.5,1");
  EXPECT_EQ(ShellWord(""), "''");
  EXPECT_EQ(ShellWord("a b"), "'a b'");
  EXPECT_EQ(ShellWord("it's"), "'it'\\''s'");
  EXPECT_EQ(ShellWord("$HOME;*"), "'$HOME;*'");
  EXPECT_EQ(ShellWord("Größe"), "'Größe'");
  EXPECT_EQ(ShellWord("a\nb'\xff"), "$'a\\012b\\'\\377'");
}

TEST_F(ReportPageTest, AReportIsHtmlOrJsonAndTakesOneFile) {
  const ProgramRun run = Batten({"fit", "surface", cloud_, "-o", "x.json", "--report", "r.pdf"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr(".html or .json"));
  // The file after it is the cloud.
  const Json data = [&] {
    const std::string page = folder_.File("page.html");
    EXPECT_EQ(
        Batten({"fit", "surface", "--report", page, cloud_, "-o", folder_.File("o.json")}).code, 0);
    return Page({"compare", folder_.File("o.json"), cloud_});
  }();
  EXPECT_EQ(data["cloud"]["total"], 3000);
}

TEST_F(ReportPageTest, ResidualsArePointsColouredByTheirDistance) {
  const std::string out = folder_.File("out.json"), ply = folder_.File("r.ply");
  const ProgramRun run =
      Batten({"fit", "surface", cloud_, "-o", out, "--residuals", ply, "--tolerance", "0.05"});
  ASSERT_LE(run.code, 3) << run.err;
  const std::string file = folder_.Text("r.ply"), end = "end_header\n";
  const std::size_t body = file.find(end) + end.size();
  EXPECT_THAT(file.substr(0, body),
              HasSubstr("property uchar red\nproperty uchar green\n"
                        "property uchar blue\nproperty uchar outlier\n"));
  constexpr std::size_t kRow = 6 * sizeof(double) + 4;
  ASSERT_EQ(file.size() - body, 3000 * kRow);
  int above = 0, below = 0;
  for (std::size_t k = 0; k < 3000; ++k) {
    double numbers[6];
    std::memcpy(numbers, file.data() + body + k * kRow, sizeof numbers);
    std::uint8_t colour[4];
    std::memcpy(colour, file.data() + body + k * kRow + sizeof numbers, sizeof colour);
    if (numbers[3] > 0.005) {
      EXPECT_GT(colour[0], colour[2]) << numbers[3];  // red above
      ++above;
    } else if (numbers[3] < -0.005) {
      EXPECT_LT(colour[0], colour[2]) << numbers[3];  // blue below
      ++below;
    }
    EXPECT_LE(colour[3], 1);
  }
  EXPECT_GT(above, 300);
  EXPECT_GT(below, 300);
  const Json info = Json::parse(Batten({"info", ply, "--json"}).out);
  EXPECT_EQ(info["points"], 3000);
}

// Two sheets three apart in one file, and the points of both.
TEST_F(ReportPageTest, PointsOfSeveralGeometriesAreCountedForTheNearest) {
  const std::string low = folder_.File("low.json"), high = folder_.File("high.json");
  ASSERT_EQ(Batten({"fit", "surface", cloud_, "-o", low}).code, 0);
  ASSERT_EQ(Batten({"edit", low, "-o", high, "translate:0,0,3"}).code, 0);
  Json both = Json::parse(folder_.Text("low.json"));
  both["shape"]["count"] = 2;
  both["shape"]["data"].push_back(Json::parse(folder_.Text("high.json"))["shape"]["data"][0]);
  both["shape"]["data"][0]["name"] = "lower";
  const std::string two = folder_.With("two.json", both.dump());
  std::vector<Row> rows = WavySheet(500, 2);
  for (Row& row : rows) row[2] += 3;
  const std::string moved = folder_.With("moved.xyz", ToText(rows));
  const std::string table = folder_.File("r.csv"), ply = folder_.File("r.ply");
  const std::string report = folder_.File("r.json");
  ASSERT_EQ(Batten({"compare", two, cloud_, moved, "--report", report, "--residuals", table}).code,
            0);
  const Json parts = Json::parse(folder_.Text("r.json"))["parts"];
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0]["name"], "lower");
  EXPECT_EQ(parts[1]["index"], 1);
  EXPECT_EQ(parts[0]["geometry"], "surface");
  EXPECT_EQ(parts[0]["kind"], "orthogonal");
  EXPECT_EQ(parts[0]["points"], 3000);
  EXPECT_EQ(parts[1]["points"], 500);
  EXPECT_LT(parts[1]["rms"].get<double>(), 0.01);
  std::istringstream lines(folder_.Text("r.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x,y,z,distance,u,v,outlier,index");
  std::vector<int> counted(2, 0);
  while (std::getline(lines, line)) ++counted.at(line.back() - '0');
  EXPECT_EQ(counted[0], parts[0]["points"]);
  EXPECT_EQ(counted[1], parts[1]["points"]);
  ASSERT_EQ(Batten({"compare", two, cloud_, "--residuals", ply}).code, 0);
  EXPECT_THAT(folder_.Text("r.ply"), HasSubstr("property int index\n"));
  EXPECT_EQ(Json::parse(Batten({"info", ply, "--json"}).out)["points"], 3000);
  // Of one geometry there is nothing to tell apart.
  ASSERT_EQ(Batten({"compare", low, cloud_, "--report", report, "--residuals", table}).code, 0);
  EXPECT_FALSE(Json::parse(folder_.Text("r.json")).contains("parts"));
  EXPECT_THAT(folder_.Text("r.csv"), ::testing::StartsWith("x,y,z,distance,u,v,outlier\n"));
}

// What is read is never written over by a report of it, whatever its name looks like.
TEST_F(ReportPageTest, FilesThatAreReadAreNotWrittenOver) {
  const std::string part = folder_.File("part.json"), table = folder_.With("table.csv", "0 0 0\n");
  ASSERT_EQ(Batten({"fit", "surface", cloud_, "-o", part}).code, 0);
  const std::string before = folder_.Text("part.json"), points = folder_.Text("cloud.xyz");
  std::filesystem::create_symlink(part, folder_.File("link.json"));
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"compare", part, cloud_, "--report", part},
           {"compare", part, cloud_, "--report", folder_.File("./part.json")},
           {"compare", folder_.File("link.json"), cloud_, "--report", part},
           {"compare", part, table, "--residuals", table},
           {"fit", "surface", cloud_, table, "-o", folder_.File("o.json"), "--residuals", table}}) {
    const ProgramRun run = Batten(command);
    EXPECT_EQ(run.code, 2) << command.back();
    EXPECT_THAT(run.err, HasSubstr("would be lost")) << command.back();
  }
  const std::string met = folder_.With("met.csv", "x,y,z\n1,1,0.5\n");
  EXPECT_EQ(Batten({"fit",
                    "surface",
                    cloud_,
                    "-o",
                    folder_.File("o.json"),
                    "--meet",
                    met,
                    "--residuals",
                    met})
                .code,
            2);
  EXPECT_EQ(folder_.Text("part.json"), before);
  EXPECT_EQ(folder_.Text("cloud.xyz"), points);
  EXPECT_EQ(folder_.Text("table.csv"), "0 0 0\n");
}

}  // namespace batten::internal::report_page_test
