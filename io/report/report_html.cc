// SPDX-License-Identifier: MIT
#include "batten/io/report_html.h"

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "io/base/markup_text.h"
#include "io/report/report_assets.h"
#include "io/report/report_data.h"

namespace batten {
using namespace internal;
namespace {

// JSON that may stand in a script: without < no tag and no comment begins in it.
std::string InScript(std::string_view json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

[[noreturn]] void RefuseBeside(const std::string& reason) {
  throw std::invalid_argument("beside: " + reason);
}

// The JSON between the tags of a page.
std::string_view DataOfPage(std::string_view page) {
  constexpr std::string_view kOpen = "id=\"batten-data\">", kClose = "</script";
  const std::size_t open = page.find(kOpen);
  if (open == std::string_view::npos) RefuseBeside("it is no page that batten wrote with --report");
  const std::string_view rest = page.substr(open + kOpen.size());
  return rest.substr(0, rest.find(kClose));
}

// What of another page stands on this one.
std::string_view DataBeside(std::string_view page, const std::string& unit) {
  if (page.empty()) return "null";
  const std::string_view data = DataOfPage(page);
  const auto json = nlohmann::json::parse(data, nullptr, false);
  if (!json.is_object() || json.value("schema", nlohmann::json()) != kViewSchema)
    RefuseBeside("its data are damaged, or of another version of batten: write it again");
  const nlohmann::json own = json.value("unit", nlohmann::json());
  if (!unit.empty() && own != unit)
    RefuseBeside("its lengths are in " + (own.is_string() ? own.get<std::string>() : "no unit") +
                 ", these in " + unit + ": give both the same --unit");
  return data;
}

}  // namespace

void CheckBeside(std::string_view page, const std::string& unit) {
  DataOfPage(page);  // an empty page is none
  DataBeside(page, unit);
}

std::string ToReportHtml(const FitReport& report,
                         const ReportContext& context,
                         const ReportScene& scene,
                         std::string_view beside) {
  const std::string other = InScript(DataBeside(beside, context.unit));
  const std::string data = InScript(ToReportData(report, context, scene));
  const std::string title = InMarkup(ReportTitle(report, context));
  const std::string_view page = ReportTemplate();
  std::string html;
  html.reserve(page.size() + data.size() + other.size() + ReportStyle().size() +
               ThreeLibrary().size() + ReportViewer().size());
  constexpr std::string_view kMark = "@@";
  // In one pass, so that what is filled in is never taken for a place to fill.
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t begin = page.find(kMark, at);
    html += page.substr(at, begin - at);
    if (begin == std::string_view::npos) break;
    const std::size_t end = page.find(kMark, begin + kMark.size());
    if (end == std::string_view::npos) throw std::logic_error("ToReportHtml: a mark has no end");
    const std::string_view name = page.substr(begin + kMark.size(), end - begin - kMark.size());
    if (name == "TITLE") {
      html += title;
    } else if (name == "STYLE") {
      html += ReportStyle();
    } else if (name == "THREE") {
      html += ThreeLibrary();
    } else if (name == "VIEWER") {
      html += ReportViewer();
    } else if (name == "DATA") {
      html += data;
    } else if (name == "BESIDE") {
      html += other;
    } else {
      throw std::logic_error("ToReportHtml: nothing is known of " + std::string(name));
    }
    at = end + kMark.size();
  }
  return html;
}

}  // namespace batten
