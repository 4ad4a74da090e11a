// SPDX-License-Identifier: MIT
#include "batten/io/report_html.h"

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

}  // namespace

std::string ToReportHtml(const FitReport& report,
                         const ReportContext& context,
                         const ReportScene& scene) {
  const std::string data = InScript(ToReportData(report, context, scene));
  const std::string title = InMarkup(ReportTitle(report, context));
  const std::string_view page = ReportTemplate();
  std::string html;
  html.reserve(page.size() + data.size() + ReportStyle().size() + ThreeLibrary().size() +
               ReportViewer().size());
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
    } else {
      throw std::logic_error("ToReportHtml: nothing is known of " + std::string(name));
    }
    at = end + kMark.size();
  }
  return html;
}

}  // namespace batten
