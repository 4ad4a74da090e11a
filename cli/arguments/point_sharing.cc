// SPDX-License-Identifier: MIT
#include "cli/arguments/point_sharing.h"

#include <optional>
#include <utility>

namespace batten::internal {
namespace {

std::optional<PointSharing>& Shared() {
  static std::optional<PointSharing> sharing;
  return sharing;
}

}  // namespace

void ShareAmong(PointSharing sharing) { Shared() = std::move(sharing); }

const PointSharing* Sharing() { return Shared() ? &*Shared() : nullptr; }

bool Writes() { return !Shared() || Shared()->rank == 0; }

std::vector<std::string> OwnFiles(const std::vector<std::string>& files) {
  if (!Shared() || static_cast<int>(files.size()) < Shared()->size) return files;
  std::vector<std::string> own;
  for (std::size_t k = static_cast<std::size_t>(Shared()->rank); k < files.size();
       k += static_cast<std::size_t>(Shared()->size))
    own.push_back(files[k]);
  return own;
}

void OwnPieces::Pass(const TakePoints& take) {
  const int size = same_files_ && Shared() ? Shared()->size : 1;
  const int rank = size > 1 ? Shared()->rank : 0;
  int piece = 0;
  all_.Pass([&](const Eigen::Matrix3Xd& points) {
    if (piece++ % size == rank) take(points);
  });
}

}  // namespace batten::internal
