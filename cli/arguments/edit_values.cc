// SPDX-License-Identifier: MIT
#include "cli/arguments/edit_values.h"

#include <fmt/format.h>

namespace batten::internal {

void RequireCount(const EditOperation& operation, const std::string& key, size_t count) {
  if (operation.Numbers(key).size() == count) return;
  operation.Refuse(fmt::format("{} takes {} on a {}, not {}",
                               key,
                               count == 1 ? "one number" : "two numbers",
                               count == 1 ? "curve" : "surface",
                               operation.Numbers(key).size()));
}

template <int Dim>
Eigen::Matrix<double, Dim, Eigen::Dynamic> PointsOf(const EditOperation& operation,
                                                    const std::string& key,
                                                    size_t count) {
  const std::vector<double>& numbers = operation.Numbers(key);
  const auto wanted = static_cast<Eigen::Index>(count);
  if (Dim == 2 && numbers.size() == 3 * count) {
    const auto points = Eigen::Map<const Eigen::Matrix3Xd>(numbers.data(), 3, wanted);
    if (points.row(2).isZero(0)) return points.template topRows<Dim>();
  }
  if (numbers.size() != Dim * count) {
    operation.Refuse(count == 1
                         ? (Dim == 2 ? "a plane curve needs two numbers x,y, or a third that is 0"
                                     : "a shape in space needs three numbers x,y,z")
                         : fmt::format("{} holds {} numbers; {} are needed, {} for each of {}",
                                       key,
                                       numbers.size(),
                                       Dim * count,
                                       Dim,
                                       count));
  }
  return Eigen::Map<const Eigen::Matrix<double, Dim, Eigen::Dynamic>>(numbers.data(), Dim, wanted);
}

template Eigen::Matrix2Xd PointsOf<2>(const EditOperation&, const std::string&, size_t);
template Eigen::Matrix3Xd PointsOf<3>(const EditOperation&, const std::string&, size_t);

}  // namespace batten::internal
