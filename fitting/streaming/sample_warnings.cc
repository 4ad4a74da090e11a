// SPDX-License-Identifier: MIT
#include "fitting/streaming/sample_warnings.h"

#include <algorithm>
#include <cmath>

#include "batten/fitting/cloud_parts.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

// By how much the share of the points beyond the limit is more than the sample's by chance.
constexpr double kStandardErrors = 5;
constexpr double kLeastPart = 0.01;  // of the points: less is clutter
constexpr std::size_t kPartsTold = 3;

std::string BetweenText(const Eigen::AlignedBox3d& box) {
  const auto corner = [](const Eigen::Vector3d& at) {
    return "(" + RoundedText(at[0]) + ", " + RoundedText(at[1]) + ", " + RoundedText(at[2]) + ")";
  };
  return "between " + corner(box.min()) + " and " + corner(box.max());
}

}  // namespace

void WarnOfWhatTheSampleMisses(const AllDistances& all,
                               double count,
                               const PointMask& outliers_of_sample,
                               FitReport& report) {
  const double beyond = static_cast<double>(report.input.outliers) / count;
  const auto size = static_cast<double>(outliers_of_sample.size());
  const double of_sample = static_cast<double>(outliers_of_sample.count()) / size;
  if (beyond <= of_sample + kStandardErrors * std::sqrt(of_sample / size)) return;
  report.warnings.push_back(std::to_string(report.input.outliers) + " points, " + Percent(beyond) +
                            ", are farther than " + RoundedText(all.limit) +
                            " from the surface, where the sample has " + Percent(of_sample) +
                            ": it may miss a part; they are " + BetweenText(all.beyond) +
                            "; a larger sample may have it");
}

void WarnOfParts(const PointCloud& sample, ThreadPool& pool, FitReport& report) {
  const CloudParts found = FindCloudParts(sample, pool);
  const auto count = static_cast<std::size_t>(
      std::count_if(found.parts.begin(), found.parts.end(), [](const CloudPart& part) {
        return part.share >= kLeastPart;
      }));
  if (count < 2) return;
  std::string parts;
  for (std::size_t k = 0; k < std::min(count, kPartsTold); ++k)
    parts +=
        (k > 0 ? ", " : "") + Percent(found.parts[k].share) + " " + BetweenText(found.parts[k].box);
  report.warnings.push_back(
      "the points fall into " + std::to_string(count) + " parts that do not touch: " + parts +
      (count > kPartsTold ? ", …" : "") + "; one surface runs through the gaps");
}

}  // namespace batten::internal
