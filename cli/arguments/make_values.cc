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

void AddFrame(CLI::App& command, MakeArguments& a, const char* center, const char* axis) {
  AddFlag(command, "--center", a.center, "X,Y,Z", center);
  AddFlag(command, "--axis", a.axis, "X,Y,Z", axis);
  AddFlag(
      command,
      "--x-axis",
      a.x_axis,
      "X,Y,Z",
      "Where angle 0 is, made perpendicular to the axis [the coordinate axis farthest from it]");
}

Eigen::Vector3d Triple(const char* flag, const std::string& text) {
  const std::vector<double> numbers = ParseNumbers(flag, text);
  if (numbers.size() != 3) {
    throw UsageError(std::string(flag) + ": '" + text + "' is not three numbers x,y,z");
  }
  return {numbers[0], numbers[1], numbers[2]};
}

std::pair<double, double> Pair(const char* flag, const std::string& text) {
  const std::vector<double> numbers = ParseNumbers(flag, text);
  if (numbers.size() != 2) {
    throw UsageError(std::string(flag) + ": '" + text + "' is not two numbers");
  }
  return {numbers[0], numbers[1]};
}

double Length(const char* flag, const std::string& text) {
  return ParseNumber(flag, text, Sign::kPositive);
}

double Radians(double degrees) { return degrees / 360 * (2 * std::numbers::pi); }

AngleRange Angles(const char* start_flag,
                  const std::string& start,
                  const char* sweep_flag,
                  const std::string& sweep) {
  const double degrees = ParseNumber(sweep_flag, sweep, Sign::kPositive);
  if (degrees > 360) {
    throw UsageError(std::string(sweep_flag) + ": " + sweep + " is more than 360 degrees");
  }
  return {Radians(ParseNumber(start_flag, start)), Radians(degrees)};
}

AngleRange AnglesOf(const MakeArguments& a) {
  return Angles("--start-angle", a.start_angle, "--sweep", a.sweep);
}

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

Frame FrameOf(const MakeArguments& a) { return ParseFrame(a.center, a.axis, a.x_axis); }

Eigen::Matrix3Xd PointsOf(const char* flag, const std::string& text, int count) {
  const std::vector<double> numbers = ParseNumbers(flag, text);
  const auto given = static_cast<int>(numbers.size());
  if (given != 3 * count && given != 2 * count) {
    throw UsageError(std::string(flag) + ": '" + text + "' holds " + std::to_string(given) +
                     " numbers; " + std::to_string(count) + " points take " +
                     std::to_string(3 * count) + ", or " + std::to_string(2 * count) +
                     " in the plane z = 0");
  }
  const int dimension = given / count;
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, count);
  points.topRows(dimension) = Eigen::Map<const Eigen::MatrixXd>(numbers.data(), dimension, count);
  return points;
}

NurbsCurve<3> Lifted(const NurbsCurve<2>& flat,
                     const Eigen::Vector3d& x,
                     const Eigen::Vector3d& y) {
  Eigen::Matrix3Xd points = x * flat.control_points().row(0) + y * flat.control_points().row(1);
  return NurbsCurve<3>(flat.basis(), std::move(points), flat.weights());
}

}  // namespace batten::internal
