// SPDX-License-Identifier: MIT
#include "batten/io/cloud_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include <bit>
#include <cerrno>
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
  const bool first = traces_.empty();
  std::vector<Trace> traces;
  std::vector<std::string> fields;
  Eigen::Index rows = 0, non_finite = 0, filtered = 0;
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    Trace before = TraceOf(paths_[k]), trace = before;
    if (!first) {
      before.points = traces_[k].points;
      Require(paths_[k], before, traces_[k]);
    }
    CloudReadOptions options = options_;
    options.take = [&](const Eigen::Matrix3Xd& points) {
      trace.points += BitsSummed(points);
      take(points);
    };
    const FileCloud part = ReadPart(paths_[k], formats[k], options, {});
    const std::uint64_t points = trace.points;
    Trace after = TraceOf(paths_[k]);
    after.points = points;
    Require(paths_[k], after, first ? trace : traces_[k]);
    traces.push_back(after);
    rows += part.rows;
    non_finite += part.non_finite;
    filtered += part.filtered;
    if (k == 0) fields = part.fields;
    if (first && part.fields != fields) {
      warnings_.push_back(fmt::format("{} has the columns {}, {} {}: only the coordinates are used",
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
  traces_ = std::move(traces);
  rows_ = rows;
  non_finite_ = non_finite;
  filtered_ = filtered;
}

}  // namespace batten
