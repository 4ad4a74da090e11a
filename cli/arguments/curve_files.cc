// SPDX-License-Identifier: MIT
#include "cli/arguments/curve_files.h"

#include <variant>

#include "batten/io/read_error.h"
#include "cli/arguments/make_values.h"

namespace batten::internal {

std::vector<NurbsCurve<3>> CurvesOf(const std::vector<std::string>& paths,
                                    const std::string& format,
                                    SharedUnit& unit,
                                    const Lifting& lifting) {
  std::vector<NurbsCurve<3>> curves;
  for (const std::string& path : paths) {
    for (const Geometry& one : unit.Read(path, format)) {
      if (std::holds_alternative<NurbsSurface>(one)) {
        throw UsageError(path + ": holds a surface; only curves can be taken");
      }
      const auto* flat = std::get_if<NurbsCurve<2>>(&one);
      curves.push_back(flat != nullptr ? Lifted(*flat, lifting.x, lifting.y)
                                       : std::get<NurbsCurve<3>>(one));
    }
  }
  return curves;
}

NurbsCurve<3> OnlyCurve(const std::string& path,
                        const std::string& format,
                        SharedUnit& unit,
                        const char* what,
                        const Lifting& lifting) {
  const std::vector<NurbsCurve<3>> curves = CurvesOf({path}, format, unit, lifting);
  if (curves.size() != 1) {
    throw UsageError(path + ": holds " + std::to_string(curves.size()) + " curves; one is the " +
                     what);
  }
  return curves.front();
}

double SizeOf(const std::vector<NurbsCurve<3>>& curves) {
  Eigen::Vector3d low = curves.front().control_points().col(0), high = low;
  for (const NurbsCurve<3>& curve : curves) {
    low = low.cwiseMin(curve.control_points().rowwise().minCoeff());
    high = high.cwiseMax(curve.control_points().rowwise().maxCoeff());
  }
  return (high - low).norm();
}

}  // namespace batten::internal
