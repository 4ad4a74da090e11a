// SPDX-License-Identifier: MIT
#include "batten/io/checkpoint.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "batten/io/atomic_file.h"
#include "batten/io/read_error.h"
#include "io/base/little_endian.h"
#include "io/base/whole_file.h"

namespace batten {
using namespace internal;
namespace {

using CheckpointJson = nlohmann::ordered_json;

constexpr const char* kSchema = "batten-pass-1";

CheckpointJson ToJson(const std::vector<std::string>& paths,
                      const CloudFileSource::Passed& passed) {
  CheckpointJson files = CheckpointJson::array();
  for (std::size_t k = 0; k < passed.traces.size(); ++k) {
    const CloudFileSource::Trace& trace = passed.traces[k];
    files.push_back({paths[k], trace.bytes, trace.seconds, trace.nanoseconds, trace.points});
  }
  return {{"files", std::move(files)},
          {"rows", passed.rows},
          {"non_finite", passed.non_finite},
          {"filtered", passed.filtered},
          {"warnings", passed.warnings}};
}

CloudFileSource::Passed ToPassed(const CheckpointJson& json) {
  CloudFileSource::Passed passed;
  for (const CheckpointJson& file : json.at("files"))
    passed.traces.push_back({file.at(1), file.at(2), file.at(3), file.at(4)});
  passed.rows = json.at("rows");
  passed.non_finite = json.at("non_finite");
  passed.filtered = json.at("filtered");
  passed.warnings = json.at("warnings").get<std::vector<std::string>>();
  return passed;
}

// The first word in which two jobs differ, as a sentence; empty where there is none.
std::string Difference(const JobWords& then, const JobWords& now) {
  const auto in = [](const JobWords& job, const std::string& name) {
    const auto found = job.find(name);
    return found == job.end() ? std::string("not given") : "'" + found->second + "'";
  };
  JobWords all = then;
  all.insert(now.begin(), now.end());
  for (const auto& [name, value] : all) {
    if (in(then, name) != in(now, name))
      return fmt::format("{} was {} and is {}", name, in(then, name), in(now, name));
  }
  return {};
}

}  // namespace

CheckpointFolder::CheckpointFolder(std::string folder,
                                   JobWords job,
                                   CloudFileSource& source,
                                   int rank)
    : folder_(std::move(folder)), job_(std::move(job)), source_(source), rank_(rank) {
  std::error_code failure;
  std::filesystem::create_directory(folder_, failure);
  if (failure || !std::filesystem::is_directory(folder_))
    throw WriteError(folder_,
                     "can't be made a folder for finished passes: " +
                         (failure ? failure.message() : std::string("is a file")));
  if (::access(folder_.c_str(), W_OK | X_OK) != 0)
    throw WriteError(folder_, "can't be written to, and finished passes are kept there");
}

std::string CheckpointFolder::PathOf(int pass) const {
  const std::string name = fmt::format("pass-{}", pass);
  const std::string of_rank = rank_ == 0 ? "" : fmt::format(".rank-{}", rank_);
  return (std::filesystem::path(folder_) / (name + of_rank)).string();
}

std::optional<std::vector<double>> CheckpointFolder::Kept(int pass) {
  const std::string path = PathOf(pass);
  if (!std::filesystem::exists(path)) return std::nullopt;
  const auto broken = [&] {
    return ReadError(path, "is not a whole pass that this version kept; remove it to begin there");
  };
  const std::string text = ReadWholeFile(path);
  const std::size_t head = text.find('\n');
  if (head == std::string::npos) throw broken();
  std::vector<double> numbers;
  try {
    const CheckpointJson json = CheckpointJson::parse(text.begin(), text.begin() + head);
    const std::uint64_t count = json.at("numbers");
    if (json.at("schema") != kSchema || (text.size() - head - 1) / sizeof(double) != count ||
        (text.size() - head - 1) % sizeof(double) != 0)
      throw broken();
    const std::string difference = Difference(json.at("job").get<JobWords>(), job_);
    if (!difference.empty())
      throw ReadError(path,
                      "was kept by another job: " + difference +
                          "; go on with the flags it had, or begin in another folder");
    for (std::size_t k = 0; k < source_.paths().size(); ++k) {
      const std::string then = json.at("source").at("files").at(k).at(0);
      if (then != source_.paths()[k])
        throw ReadError(
            path, "was kept by a job over " + then + " where this one has " + source_.paths()[k]);
    }
    source_.Resume(ToPassed(json.at("source")));
    numbers.resize(count);
  } catch (const nlohmann::json::exception&) {
    throw broken();
  }
  for (std::size_t k = 0; k < numbers.size(); ++k)
    numbers[k] = LoadLittleEndian<double>(text, head + 1 + k * sizeof(double));
  passes_ = std::max(passes_, pass);
  resumed_ = pass;
  if (rank_ > 0) return std::nullopt;
  return numbers;
}

void CheckpointFolder::Keep(int pass, std::span<const double> numbers) {
  const std::size_t count = rank_ == 0 ? numbers.size() : 0;
  const CheckpointJson json = {{"schema", kSchema},
                               {"numbers", count},
                               {"job", job_},
                               {"source", ToJson(source_.paths(), source_.passed())}};
  AtomicFile file(PathOf(pass));
  file.Write(json.dump(-1, ' ', false, CheckpointJson::error_handler_t::replace) + '\n');
  constexpr std::size_t kAtOnce = std::size_t{1} << 16;
  for (std::size_t at = 0; at < count; at += kAtOnce) {
    std::string bytes;
    AppendAllLittleEndian<double>(bytes, numbers.subspan(at, std::min(kAtOnce, count - at)));
    file.Write(bytes);
  }
  file.CommitAtOnce();
  passes_ = std::max(passes_, pass);
}

void CheckpointFolder::Remove() {
  std::error_code ignored;
  for (int pass = 1; pass <= passes_; ++pass) std::filesystem::remove(PathOf(pass), ignored);
  std::filesystem::remove(folder_, ignored);  // not where anything is in it
}

}  // namespace batten
