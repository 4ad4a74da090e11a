// SPDX-License-Identifier: MIT
#include "cli/arguments/part_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string>

namespace batten::internal {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

std::string Deviation(double value, const char* unit) {
  return std::isfinite(value) ? fmt::format(" ± {:.2g}{}", value, unit) : std::string(" ± ?");
}

// A number with as many decimals as its deviation, or the size's rounding, leaves meaning.
std::string Rounded(double value, double deviation) {
  const double digit =
      std::isfinite(deviation) && deviation > 0 ? deviation : std::abs(value) * 1e-9;
  const int places =
      digit > 0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(digit))) + 1, 0, 12) : 6;
  const std::string text = fmt::format("{:.{}f}", value, places);
  return text.find_first_not_of("-0.") == std::string::npos ? "0" : text;
}

std::string Vector(const Eigen::Vector3d& v, double deviation) {
  return fmt::format(
      "({}, {}, {})", Rounded(v[0], deviation), Rounded(v[1], deviation), Rounded(v[2], deviation));
}

std::string Direction(const char* name, const PrimitiveSummary& p) {
  const std::optional<Eigen::Vector3d>& along = p.normal ? p.normal : p.axis;
  if (!along) return "";
  const double deviation = p.accuracy ? p.accuracy->Deviation(name) : 0;
  return fmt::format(
      ", {} {}{}", name, Vector(*along, deviation), Deviation(kDegrees * deviation, "°"));
}

std::string Place(const PrimitiveSummary& p) {
  const auto deviation = [&](const char* name) {
    return p.accuracy ? p.accuracy->Deviation(name) : 0.0;
  };
  const auto words = [&](const char* name, const Eigen::Vector3d& at, double off) {
    return fmt::format(", {} {}{}", name, Vector(at, off), Deviation(off, ""));
  };
  if (p.kind == "plane") return words("through", *p.point, deviation("offset"));
  if (p.center) return words("center", *p.center, deviation("center"));
  if (p.apex) return words("apex", *p.apex, deviation("apex"));
  return p.point ? words("through", *p.point, deviation("point")) : "";
}

// "of radius 12.003 ± 0.002, axis (0, 0, 1) ± 0.01°, …"
std::string Numbers(const PrimitiveSummary& p) {
  std::string words = p.Words().substr(p.kind.size());
  words += Direction(p.normal ? "normal" : "axis", p) + Place(p);
  return words.substr(words.find_first_not_of(", "));
}

std::string Indices(const std::vector<int>& faces) {
  return fmt::format("{}", fmt::join(faces, " and "));
}

}  // namespace

std::string PartTable(const PartSummary& part) {
  std::string text =
      fmt::format("{:>4}  {:8}  {:>8}  {:>9}  {}\n", "face", "kind", "points", "rms", "");
  for (std::size_t k = 0; k < part.faces.size(); ++k) {
    const FaceSummary& face = part.faces[k];
    fmt::format_to(std::back_inserter(text),
                   "{:>4}  {:8}  {:>8}  {:>9.3g}  {}\n",
                   k,
                   face.kind,
                   face.points,
                   face.rms,
                   face.primitive ? Numbers(*face.primitive) : "");
  }
  for (const RelationSummary& relation : part.relations) {
    const bool angle = relation.kind == "parallel" || relation.kind == "perpendicular";
    const double unit = angle ? kDegrees : 1;
    const char* const sign = angle ? "°" : "";
    fmt::format_to(std::back_inserter(text),
                   "faces {} are {}{}: off by {:.2g}{}, chance explains {:.2g}{}\n",
                   Indices(relation.faces),
                   relation.kind == "equal radius" ? "of equal radius" : relation.kind,
                   relation.kept ? "" : " as far as the points tell",
                   unit * relation.deviation,
                   sign,
                   unit * relation.allowed,
                   sign);
  }
  return text;
}

}  // namespace batten::internal
