// SPDX-License-Identifier: MIT
#include "cli/arguments/make_values.h"

#include <numbers>
#include <stdexcept>
#include <utility>

#include "batten/io/read_error.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/parse_values.h"

namespace batten::internal {

CLI::Option* AddFlag(
    CLI::App& command, const char* flag, std::string& value, const char* type, const char* help) {
  CLI::Option* option = command.add_option(flag, value, help)->type_name(type);
  if (!value.empty()) option->capture_default_str();
  return option;
}

void Require(
    CLI::App& command, const char* flag, std::string& value, const char* type, const char* help) {
  AddFlag(command, flag, value, type, help)->required();
}

Eigen::Vector3d Triple(const char* flag, const std::string& text) {
  const std::vector<double> numbers = ParseNumbers(flag, text);
  if (numbers.size() != 3) {
    throw UsageError(std::string(flag) + ": '" + text + "' is not three numbers x,y,z");
  }
  return {numbers[0], numbers[1], numbers[2]};
}

double Radians(double degrees) { return degrees / 360 * (2 * std::numbers::pi); }

Frame ParseFrame(const std::string& center, const std::string& axis, const std::string& x_axis) {
  const Eigen::Vector3d origin = Triple("--center", center), direction = Triple("--axis", axis);
  if (direction.isZero(0)) throw UsageError("--axis: '" + axis + "' has no direction");
  if (x_axis.empty()) return Frame(origin, direction);
  const Eigen::Vector3d x = Triple("--x-axis", x_axis);
  try {
    return Frame(origin, direction, x);
  } catch (const std::invalid_argument&) {
    throw UsageError("--x-axis: '" + x_axis + "' does not point away from the axis " + axis);
  }
}

NurbsCurve<3> Lifted(const NurbsCurve<2>& flat,
                     const Eigen::Vector3d& x,
                     const Eigen::Vector3d& y) {
  Eigen::Matrix3Xd points = x * flat.control_points().row(0) + y * flat.control_points().row(1);
  return NurbsCurve<3>(flat.basis(), std::move(points), flat.weights());
}

}  // namespace batten::internal
