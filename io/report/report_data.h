// SPDX-License-Identifier: MIT
// What the page of a report is told. Not installed.
#pragma once

#include <string>

#include "batten/fitting/fit_report.h"
#include "batten/io/report_json.h"
#include "batten/io/report_types.h"

namespace batten::internal {

// The name of the geometry's file without folders; without a file the kind of geometry. UTF-8.
std::string ReportTitle(const FitReport& report, const ReportContext& context);

inline constexpr const char* kViewSchema = "batten-view-1";

// That schema, a JSON object. Arrays of numbers are base64 of
// little-endian binary, {"f32": …}, {"u32": …}, {"u8": …}; NaN in them says that there is none.
//   schema, title, date (absent when the context has none), kind ("surface" or "curve"), unit,
//   center, size, tolerance (or null), limit, signed, report (ToReportJson),
//   surfaces [{name, positions, normals, uv, triangles, deviation, gaussian, mean, trims, edges,
//     knot_lines, net {size, points}}],
//   curves [{name, closed, planar, points, parameters, curvature, normals, knots, net}],
//   plan {u, v}, histogram {low, high, counts, below, above, mean, deviation},
//   cloud {points, deviation, outlier, foot, parameter, shown, total}; foot and parameter only
//     where there are curves
// as ReportScene describes them.
std::string ToReportData(const FitReport& report,
                         const ReportContext& context,
                         const ReportScene& scene);

}  // namespace batten::internal
