// SPDX-License-Identifier: MIT
#include "batten/io/cloud_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "batten/io/file_format.h"
#include "batten/io/read_error.h"
#include "io/cloud/read_part.h"

namespace batten {
using namespace internal;
namespace {

bool IsPassedOver(FileFormat format) {
  return format == FileFormat::kLas || format == FileFormat::kPly || format == FileFormat::kPcd ||
         IsTextFormat(format);
}

std::uint64_t BitsSummed(const Eigen::Matrix3Xd& points) {
  std::uint64_t sum = 0;
  const double* at = points.data();
  for (Eigen::Index k = 0; k < points.size(); ++k) sum += std::bit_cast<std::uint64_t>(at[k]);
  return sum;
}

// Files whose coordinates are so many times as large, and reach so many times as far, as those of
// the middle one: metres beside millimetres, degrees beside metres; tiles of a survey differ less.
std::vector<std::string> WarningsOfUnits(const std::vector<std::string>& paths,
                                         const std::vector<Eigen::AlignedBox3d>& boxes) {
  constexpr double kAnotherUnit = 50;
  const auto largest = [&](std::size_t k) {
    return std::max(boxes[k].min().cwiseAbs().maxCoeff(), boxes[k].max().cwiseAbs().maxCoeff());
  };
  const auto reach = [&](std::size_t k) { return boxes[k].diagonal().norm(); };
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < paths.size(); ++k)
    if (!boxes[k].isEmpty() && reach(k) > 0) order.push_back(k);
  std::vector<std::string> warnings;
  if (order.size() < 2) return warnings;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return reach(a) < reach(b);
  });
  const std::size_t middle = order[(order.size() - 1) / 2];
  for (const std::size_t k : order) {
    const double by_reach = reach(k) / reach(middle), by_size = largest(k) / largest(middle);
    const bool larger = std::min(by_reach, by_size) > kAnotherUnit;
    const bool smaller = std::max(by_reach, by_size) < 1 / kAnotherUnit;
    if (!larger && !smaller) continue;
    warnings.push_back(fmt::format(
        "coordinates of {} are {:.3g} times those of {} and reach {:.3g} times as far: is one of "
        "them in another unit?",
        paths[k],
        by_size,
        paths[middle],
        by_reach));
  }
  return warnings;
}

}  // namespace

CloudFileSource::CloudFileSource(std::vector<std::string> paths, CloudReadOptions options)
    : paths_(std::move(paths)), options_(std::move(options)) {
  if (paths_.empty()) throw std::invalid_argument("CloudFileSource: paths must not be empty");
  for (const std::string& path : paths_) {
    if (path == "-")
      throw UsageError("-: standard input can be read once only; a file can be passed over again");
  }
  const std::vector<FileFormat> formats = CloudFormats(paths_, options_);
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    if (IsPassedOver(formats[k])) continue;
    throw UsageError(fmt::format(
        "{}: a {} file is read whole; LAS, PLY, PCD and text can be passed over piece by piece",
        paths_[k],
        FormatName(formats[k])));
  }
}

CloudFileSource::Trace CloudFileSource::TraceOf(const std::string& path) const {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0) throw ReadError(path, std::strerror(errno));
  if (!S_ISREG(about.st_mode))
    throw ReadError(path, "is no regular file, which could be passed over again");
  return {about.st_size, about.st_mtim.tv_sec, about.st_mtim.tv_nsec};
}

void CloudFileSource::Require(const std::string& path, const Trace& now, const Trace& then) const {
  if (now == then) return;
  const char* const what = now.bytes != then.bytes     ? "another size"
                           : now.points != then.points ? "other points"
                                                       : "another time of change";
  throw ReadError(path,
                  fmt::format("changed while it was passed over: it has {} ({} bytes, {} before)",
                              what,
                              now.bytes,
                              then.bytes));
}

void CloudFileSource::Pass(const TakePoints& take) {
  const std::vector<FileFormat> formats = CloudFormats(paths_, options_);
  const bool first = passed_.traces.empty();
  std::vector<Trace> traces;
  std::vector<std::string> fields;
  std::vector<Eigen::AlignedBox3d> boxes(first ? paths_.size() : 0);
  Eigen::Index rows = 0, non_finite = 0, filtered = 0;
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    Trace before = TraceOf(paths_[k]), trace = before;
    if (!first) {
      before.points = passed_.traces[k].points;
      Require(paths_[k], before, passed_.traces[k]);
    }
    CloudReadOptions options = options_;
    options.take = [&](const Eigen::Matrix3Xd& points) {
      trace.points += BitsSummed(points);
      if (first && points.cols() > 0) {
        boxes[k].extend(points.rowwise().minCoeff().eval());
        boxes[k].extend(points.rowwise().maxCoeff().eval());
      }
      take(points);
    };
    const FileCloud part = ReadPart(paths_[k], formats[k], options, {});
    const std::uint64_t points = trace.points;
    Trace after = TraceOf(paths_[k]);
    after.points = points;
    Require(paths_[k], after, first ? trace : passed_.traces[k]);
    traces.push_back(after);
    rows += part.rows;
    non_finite += part.non_finite;
    filtered += part.filtered;
    if (k == 0) fields = part.fields;
    if (first) {
      for (const std::string& remark : part.remarks)
        passed_.warnings.push_back(paths_[k] + ": " + remark);
    }
    if (first && part.fields != fields) {
      passed_.warnings.push_back(
          fmt::format("{} has the columns {}, {} {}: only the coordinates are used",
                      paths_[k],
                      fmt::join(part.fields, " "),
                      paths_[0],
                      fmt::join(fields, " ")));
    }
  }
  if (non_finite + filtered == rows) {
    throw ReadError(paths_.front(),
                    fmt::format("{} no usable point ({} rows, {} not finite, {} filtered out)",
                                paths_.size() > 1 ? "this and the other files hold" : "holds",
                                rows,
                                non_finite,
                                filtered));
  }
  if (first) {
    for (std::string& warning : WarningsOfUnits(paths_, boxes))
      passed_.warnings.push_back(std::move(warning));
  }
  passed_ = {std::move(traces), rows, non_finite, filtered, std::move(passed_.warnings)};
}

void CloudFileSource::Resume(Passed passed) {
  if (passed.traces.size() != paths_.size())
    throw std::invalid_argument("Resume: traces: one a file is needed");
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    Trace now = TraceOf(paths_[k]);
    now.points = passed.traces[k].points;
    Require(paths_[k], now, passed.traces[k]);
  }
  passed_ = std::move(passed);
}

}  // namespace batten
