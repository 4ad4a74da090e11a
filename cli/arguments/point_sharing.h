// SPDX-License-Identifier: MIT
// Points that several processes share, each with the same command line.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "batten/fitting/point_source.h"

namespace batten::internal {

struct PointSharing {
  int rank = 0, size = 1;
  // The source of a process as the share of all.
  std::function<std::unique_ptr<PointSource>(PointSource& own)> joined;
};

// To be called once, before any work, by a program that runs as several processes. Only the one of
// rank 0 writes then.
void ShareAmong(PointSharing sharing);

// None for a single process.
const PointSharing* Sharing();

// Whether this process writes files and results.
bool Writes();

// Files of which each process has some; where they are fewer than processes, all.
std::vector<std::string> OwnFiles(const std::vector<std::string>& files);

// Where processes have the same files, the pieces of points that are this one's: every size-th.
class OwnPieces : public PointSource {
 public:
  OwnPieces(PointSource& all, bool same_files) : all_(all), same_files_(same_files) {}
  void Pass(const TakePoints& take) override;

 private:
  PointSource& all_;
  bool same_files_;
};

}  // namespace batten::internal
