// SPDX-License-Identifier: MIT
// The report of a fit or a comparison as a page that any browser shows, without a network.
#pragma once

#include <string>

#include "batten/fitting/fit_report.h"
#include "batten/io/report_json.h"
#include "batten/io/report_types.h"

namespace batten {

// One HTML file with everything in it: figures, viewer, and the scene as single-precision numbers
// relative to its centre (1e-7 of its size). Names, titles and warnings may hold anything; what is
// not UTF-8 becomes the replacement character. About 3 MB and 90 bytes a vertex, 23 a point.
std::string ToReportHtml(const FitReport& report,
                         const ReportContext& context,
                         const ReportScene& scene);

}  // namespace batten
