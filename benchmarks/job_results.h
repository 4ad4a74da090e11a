// SPDX-License-Identifier: MIT
// What `compare` and the programs it runs agree on: clouds as raw doubles in files, and results as
// one line of name=value.
#pragma once

#include <time.h>

#include <Eigen/Core>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/fitting/statistics.h"

namespace batten::internal {

// Seconds on the wall and of the processor, of all threads, since it was made.
class JobClock {
 public:
  double Wall() const { return Read(CLOCK_MONOTONIC) - wall_; }
  double Cpu() const { return Read(CLOCK_PROCESS_CPUTIME_ID) - cpu_; }

 private:
  static double Read(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }

  double wall_ = Read(CLOCK_MONOTONIC), cpu_ = Read(CLOCK_PROCESS_CPUTIME_ID);
};

// Runs of one job: at most five, no more once a second of processor time has gone; as the
// comparator programs do.
class JobRuns {
 public:
  bool MayRun() const { return wall_.empty() || (wall_.size() < kMost && spent_ < 1); }

  void Add(double wall, double cpu) {
    wall_.push_back(wall);
    cpu_.push_back(cpu);
    spent_ += cpu;
  }

  void PrintSeconds() const { std::printf("wall=%.6g cpu=%.6g", Median(wall_), Median(cpu_)); }

 private:
  static constexpr size_t kMost = 5;

  std::vector<double> wall_, cpu_;
  double spent_ = 0;
};

// Calls `job` as often as that; returns what the last call did.
template <typename Job>
auto RunJob(JobRuns& runs, const Job& job) {
  for (;;) {
    const JobClock clock;
    auto result = job();
    runs.Add(clock.Wall(), clock.Cpu());
    if (!runs.MayRun()) return result;
  }
}

inline void WriteDoubles(std::ostream& out, const double* numbers, Eigen::Index count) {
  out.write(reinterpret_cast<const char*>(numbers),
            static_cast<std::streamsize>(count) * static_cast<std::streamsize>(sizeof(double)));
}

// Columns one after another, in the machine's byte order.
template <typename Derived>
void WriteColumns(const std::string& path, const Eigen::PlainObjectBase<Derived>& columns) {
  std::ofstream out(path, std::ios::binary);
  WriteDoubles(out, columns.data(), columns.size());
  if (!out.flush()) throw std::runtime_error("can't write " + path);
}

inline Eigen::Matrix3Xd ReadPoints(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamsize bytes = in ? static_cast<std::streamsize>(in.tellg()) : 0;
  Eigen::Matrix3Xd points(3, bytes / static_cast<std::streamsize>(3 * sizeof(double)));
  in.seekg(0);
  if (points.size() == 0 || !in.read(reinterpret_cast<char*>(points.data()), bytes)) {
    throw std::runtime_error("can't read points from " + path);
  }
  return points;
}

}  // namespace batten::internal
