// SPDX-License-Identifier: MIT
// The report of a fit or a comparison as a page that any browser shows, without a network.
#pragma once

#include <string>
#include <string_view>

#include "batten/fitting/fit_report.h"
#include "batten/io/report_json.h"
#include "batten/io/report_types.h"

namespace batten {

// One HTML file with everything in it: figures, viewer, and the scene as single-precision numbers
// relative to its centre (1e-7 of its size). Names, titles and warnings may hold anything; what is
// not UTF-8 becomes the replacement character. About 3 MB and 90 bytes a vertex, 23 a point.
// `beside` is a page that this function wrote before, or empty: what it shows stands beside this
// report on one scale of colours, their figures in two columns with the differences. Of a page with
// two that is the first. Throws std::invalid_argument where it is no such page or in another unit.
std::string ToReportHtml(const FitReport& report,
                         const ReportContext& context,
                         const ReportScene& scene,
                         std::string_view beside = {});

// Refuses a page that can't stand beside a report in this unit, as ToReportHtml does; an empty unit
// may be any.
void CheckBeside(std::string_view page, const std::string& unit);

}  // namespace batten
