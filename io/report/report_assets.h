// SPDX-License-Identifier: MIT
// The parts of the page that an HTML report is made of. They are files when batten is built and
// part of the library afterwards (cmake/ReportAssets.cmake), so that a report needs nothing beside
// itself.
#pragma once

#include <string_view>

namespace batten::internal {

// The page, with @@TITLE@@ (HTML text), @@STYLE@@, @@THREE@@, @@VIEWER@@ and @@DATA@@ (JSON in
// which
// "</" is written "<\/") where the rest belongs, each once. [io/report_view/report.html]
std::string_view ReportTemplate();

// The style sheet, for screens and for paper. [io/report_view/report.css]
std::string_view ReportStyle();

// three.js as Debian packages it: WebGL.
std::string_view ThreeLibrary();

// The viewer: io/report_view/*.js, one after another in the order of cmake/ReportAssets.cmake.
std::string_view ReportViewer();

}  // namespace batten::internal
