// SPDX-License-Identifier: MIT
// Laws of the page of a report: it holds everything, and nothing in it can break out of its place.
#include "batten/io/report_html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "io/base/base64.h"
#include "io/report/report_data.h"

namespace batten::internal::report_html_test {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

// An independent reader of base64, digit by digit.
std::string FromBase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) throw std::runtime_error("no digit of base64");
    bits = bits << 6 | static_cast<unsigned>(digit);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes += static_cast<char>(bits >> count & 255u);
    }
  }
  return bytes;
}

template <class Number>
std::vector<Number> Numbers(const Json& array, const char* type) {
  const std::string bytes = FromBase64(array.at(type).get<std::string>());
  EXPECT_EQ(bytes.size() % sizeof(Number), 0u);
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

ReportScene Example() {
  ReportScene scene;
  scene.center << 500000.25, 5400000.125, 300;
  scene.size = 2;
  scene.limit = 0.5;
  scene.signed_values = true;
  ReportSurface& surface = scene.surfaces.emplace_back();
  surface.name = "hull \"A\" </script><script>alert(1)</script>";
  surface.mesh.vertices = Eigen::Matrix3Xd::Random(3, 4);
  surface.mesh.normals = Eigen::Matrix3Xd::Random(3, 4);
  surface.mesh.parameters = Eigen::Matrix2Xd::Random(2, 4);
  surface.mesh.triangles.resize(3, 2);
  surface.mesh.triangles << 0, 0, 1, 2, 2, 3;
  surface.deviation = Eigen::Vector4d(0.1, -0.2, std::nan(""), 0);
  surface.gaussian = surface.mean = Eigen::Vector4d::Ones();
  surface.trims = {Eigen::Matrix3Xd::Random(3, 5)};
  surface.net_u = 2;
  surface.net_v = 3;
  surface.net = Eigen::Matrix3Xd::Random(3, 6);
  scene.cloud.points = Eigen::Matrix3Xd::Random(3, 3);
  scene.cloud.deviation = Eigen::Vector3d(1, -2, 1e300);
  scene.cloud.outlier.resize(3);
  scene.cloud.outlier << false, true, false;
  scene.cloud.total = 3;
  scene.histogram = {-1, 1, {1, 0, 2}, 4, 5};
  return scene;
}

ReportContext Context() {
  ReportContext context;
  context.command = "batten fit surface 'a b.ply' -o part.step";
  context.file = "folder/part.step";
  context.version = "0.1.0";
  return context;
}

// What stands between the tags of the page's data, or of those beside them.
std::string DataOf(const std::string& html, const std::string& name = "data") {
  const std::string open = "id=\"batten-" + name + "\">";
  const std::size_t begin = html.find(open) + open.size();
  return html.substr(begin, html.find("</script", begin) - begin);
}

TEST(ReportHtmlTest, ArraysReadBackAsTheyWereInSinglePrecision) {
  const ReportScene scene = Example();
  const Json data = Json::parse(DataOf(ToReportHtml({}, Context(), scene)));
  EXPECT_EQ(data["schema"], "batten-view-1");
  EXPECT_EQ(data["center"], Json({500000.25, 5400000.125, 300.0}));
  const Json& surface = data["surfaces"][0];
  const auto positions = Numbers<float>(surface["positions"], "f32");
  ASSERT_EQ(positions.size(), 12u);
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_EQ(positions[k], static_cast<float>(scene.surfaces[0].mesh.vertices.data()[k]));
  }
  EXPECT_EQ(Numbers<std::uint32_t>(surface["triangles"], "u32"),
            (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  const auto deviation = Numbers<float>(surface["deviation"], "f32");
  EXPECT_EQ(deviation[1], -0.2f);
  EXPECT_TRUE(std::isnan(deviation[2]));
  EXPECT_EQ(Numbers<float>(surface["net"]["points"], "f32").size(), 18u);
  EXPECT_EQ(surface["net"]["size"], Json({2, 3}));
  EXPECT_EQ(Numbers<float>(surface["trims"][0], "f32").size(), 15u);
  EXPECT_EQ(surface["edges"], Json::array());
  EXPECT_EQ(Numbers<std::uint8_t>(data["cloud"]["outlier"], "u8"),
            (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_EQ(Numbers<float>(data["cloud"]["deviation"], "f32")[2],
            std::numeric_limits<float>::max());  // no infinity
  EXPECT_EQ(data["histogram"]["counts"], Json({1, 0, 2}));
  EXPECT_EQ(data["report"]["schema"], "batten-report-2");
  EXPECT_EQ(data["report"]["command"], Context().command);
  EXPECT_TRUE(data["tolerance"].is_null());
}

TEST(ReportHtmlTest, Base64OfEveryLengthReadsBack) {
  std::mt19937 engine(1);
  for (std::size_t length = 0; length < 200; ++length) {
    std::string bytes;
    for (std::size_t k = 0; k < length; ++k) bytes += static_cast<char>(engine());
    std::string text;
    AppendBase64(text, bytes);
    EXPECT_EQ(text.size(), (length + 2) / 3 * 4);
    EXPECT_EQ(FromBase64(text), bytes);
  }
  std::string json;  // longer than a block
  const Eigen::VectorXd numbers = Eigen::VectorXd::LinSpaced(10001, -1, 1);
  AppendFloats(json, numbers);
  const auto back = Numbers<float>(Json::parse(json), "f32");
  ASSERT_EQ(back.size(), 10001u);
  for (std::size_t k = 0; k < back.size(); ++k) {
    ASSERT_EQ(back[k], static_cast<float>(numbers[static_cast<Eigen::Index>(k)]));
  }
}

TEST(ReportHtmlTest, NamesAndWarningsCannotEndTheScriptNorFillPlaces) {
  FitReport report;
  const std::string nasty =
      "</script><script>alert('x')</script> <!-- <script> & \"quotes\" @@STYLE@@ \xff \xe2\x80\xa8";
  report.warnings = {nasty};
  report.input.files = {nasty};
  ReportContext context = Context();
  context.file = "<b>\"part\" & 'co'.step";
  context.command = nasty;
  const std::string html = ToReportHtml(report, context, Example());
  const std::string plain = ToReportHtml({}, Context(), Example());
  const auto count = [](const std::string& text, const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
      ++found;
    }
    return found;
  };
  for (const char* tag : {"<script", "</script", "<!--", "<style", "alert('x')</"}) {
    EXPECT_EQ(count(html, tag), count(plain, tag)) << tag;
  }
  EXPECT_THAT(html, HasSubstr("&lt;b&gt;&quot;part&quot; &amp; &#39;co&#39;.step"));
  EXPECT_THAT(html, Not(HasSubstr("<b>")));
  const Json data = Json::parse(DataOf(html));
  EXPECT_EQ(data["title"], "<b>\"part\" & 'co'.step");
  const std::string shown = data["report"]["warnings"][0];
  EXPECT_EQ(shown.substr(0, 30), nasty.substr(0, 30));
  EXPECT_THAT(shown, HasSubstr("@@STYLE@@ \xef\xbf\xbd"));
}

TEST(ReportHtmlTest, ThePageIsWholeSmallAndNeedsNoNetwork) {
  const std::string html = ToReportHtml({}, Context(), Example());
  EXPECT_LT(html.size(), 3000000u);
  EXPECT_THAT(html, HasSubstr("<!DOCTYPE html>"));
  EXPECT_THAT(html, Not(HasSubstr("@@")));
  for (const char* loads : {"src=\"http",
                            "href=\"http",
                            "src='http",
                            "url(http",
                            "url(\"http",
                            "@import",
                            "fetch(\"http",
                            "src=\"//"}) {
    EXPECT_THAT(html, Not(HasSubstr(loads)));
  }
}

TEST(ReportHtmlTest, WhatStandsBesideIsTheFirstOfTheOtherPageAsItWas) {
  FitReport report;
  report.warnings = {"</script><script>alert('x')</script> @@STYLE@@"};
  ReportContext context = Context();
  context.file = "first.step";
  const std::string first = ToReportHtml(report, context, Example());
  EXPECT_EQ(DataOf(first, "beside"), "null");
  context.file = "second.step";
  const std::string second = ToReportHtml({}, context, Example(), first);
  EXPECT_EQ(DataOf(second, "beside"), DataOf(first));
  EXPECT_EQ(Json::parse(DataOf(second))["title"], "second.step");
  context.file = "third.step";
  const std::string third = ToReportHtml({}, context, Example(), second);
  EXPECT_EQ(Json::parse(DataOf(third, "beside"))["title"], "second.step");
  EXPECT_LT(third.size(), 3000000u);
}

TEST(ReportHtmlTest, PagesThatCannotStandBesideAreRefused) {
  const auto refusal = [](const std::string& page, const std::string& unit) -> std::string {
    try {
      CheckBeside(page, unit);
    } catch (const std::invalid_argument& refused) {
      ReportContext context = Context();
      context.unit = unit;
      if (!page.empty() && !unit.empty()) {
        EXPECT_THROW(ToReportHtml({}, context, Example(), page), std::invalid_argument);
      }
      return refused.what();
    }
    return {};
  };
  const std::string page = ToReportHtml({}, Context(), Example());
  EXPECT_EQ(refusal(page, "mm"), "");
  EXPECT_EQ(refusal(page, ""), "");
  EXPECT_THAT(refusal(page, "inch"), HasSubstr("its lengths are in mm, these in inch"));
  EXPECT_THAT(refusal("", "mm"), HasSubstr("it is no page that batten wrote"));
  EXPECT_THAT(refusal("<html></html>", "mm"), HasSubstr("it is no page that batten wrote"));
  const std::size_t data = page.find("id=\"batten-data\">") + 17;
  for (const std::size_t end : {data, data + 1, data + 300}) {
    EXPECT_THAT(refusal(page.substr(0, end), "mm"), HasSubstr("damaged"));
  }
  for (const char* json :
       {"null", "[]", "{}", "{\"schema\":\"batten-view-2\"}", "{\"schema\":1}"}) {
    EXPECT_THAT(refusal(page.substr(0, data) + json + "</script>", "mm"), HasSubstr("damaged"));
  }
  const std::string no_unit = page.substr(0, data) + "{\"schema\":\"batten-view-1\"}</script>";
  EXPECT_THAT(refusal(no_unit, "mm"), HasSubstr("no unit"));
}

TEST(ReportHtmlTest, SameSceneGivesTheSameBytesAndTheDateIsTheCallers) {
  ReportContext context = Context();
  const ReportScene scene = Example();
  EXPECT_TRUE(ToReportHtml({}, context, scene) == ToReportHtml({}, context, scene));
  EXPECT_FALSE(Json::parse(ToReportData({}, context, Example())).contains("date"));
  context.date = "2026-11-22";
  EXPECT_EQ(Json::parse(ToReportData({}, context, Example()))["date"], "2026-11-22");
  EXPECT_EQ(ToReportJson({}, context), ToReportJson({}, Context()));
}

}  // namespace batten::internal::report_html_test
