// SPDX-License-Identifier: MIT
// What became of the jobs of a batch: a table that a later run goes on from, and a page.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/arguments/batch_jobs.h"

namespace batten::internal {

struct BatchResult {
  int exit_code = 0;
  std::string seconds, points, control_points, rms, max, tolerance_reached;  // as written
  std::string message;      // of a job that failed or warned
  std::string fingerprint;  // of the job
};

// What the program said of a job: its report as JSON, and what went to standard error.
BatchResult ToBatchResult(const BatchJob& job,
                          int exit_code,
                          double seconds,
                          const std::string& report,
                          const std::string& errors);

// The results of an earlier run by their fingerprints; none where the file is not there. Throws
// ReadError where it is no such table.
std::map<std::string, BatchResult> ReadBatchResults(const std::string& path);

// Results by the jobs' places; jobs without one are left out.
using BatchResults = std::map<size_t, BatchResult>;

std::string ToCsv(const std::vector<BatchJob>& jobs, const BatchResults& results);
nlohmann::ordered_json ToJson(const std::vector<BatchJob>& jobs, const BatchResults& results);

// A page with a row for each job and links to geometry and reports, relative to the folder of
// `page`.
std::string ToIndexPage(const std::vector<BatchJob>& jobs,
                        const BatchResults& results,
                        const std::string& title,
                        const std::string& page);

}  // namespace batten::internal
