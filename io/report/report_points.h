// SPDX-License-Identifier: MIT
// Points as a report shows them: which of many, and how their deviations are spread. Not installed.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/io/report_types.h"

namespace batten::internal {

// The numbers of at most `most` points, in increasing order, as MakeReportScene describes.
std::vector<Eigen::Index> ShownPoints(const Eigen::VectorXd& deviations,
                                      const PointMask& outliers,
                                      Eigen::Index most);

// One of each of `count` runs of about the same length of 0 … total−1, chosen by a hash of the
// run's number: evenly spread, and in step with no pattern of the order.
std::vector<Eigen::Index> EvenlySpread(Eigen::Index total, Eigen::Index count);

// 60 bins over what all but 0.4 % keep, but no farther than six robust standard deviations from the
// median; zero and the tolerance lie within them unless they are far off. Without a sign they begin
// at 0.
ReportHistogram HistogramOf(const Eigen::VectorXd& deviations,
                            const PointMask& outliers,
                            std::optional<double> tolerance,
                            bool signed_values);

}  // namespace batten::internal
