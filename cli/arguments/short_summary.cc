// SPDX-License-Identifier: MIT
#include "cli/arguments/short_summary.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "cli/arguments/file_entry.h"
#include "cli/arguments/geometry_summary.h"
#include "cli/terminal/streams.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDigits = 4, kDigitsOfEstimates = 3, kDigitsOfMeasures = 6;
constexpr size_t kFew = 8;

std::string Line(const std::string& key, const std::string& value) {
  return fmt::format("{:<12} {}\n", key, Printable(value));
}

// Without exponent where the number is of a usual size.
std::string Number(double x, int digits = kDigits) {
  const double magnitude = std::abs(x);
  if (!(magnitude >= 1e-4 && magnitude < 1e9)) return fmt::format("{:.{}g}", x, digits);
  const int decimals = digits - 1 - static_cast<int>(std::floor(std::log10(magnitude)));
  if (decimals <= 0) return fmt::format("{:.0f}", x);
  std::string text = fmt::format("{:.{}f}", x, decimals);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

Eigen::AlignedBox3d BoxOf(const Json& info) {
  const auto corner = [](const Json& numbers) {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (size_t k = 0; k < numbers.size(); ++k) x[static_cast<int>(k)] = numbers[k].get<double>();
    return x;
  };
  const Json& box = info["bounding_box"];
  return {corner(box[0]), corner(box[1])};
}

// "800 x 500 x 69.2 mm, from 0.2, 0.2, 0.0": places to a ten thousandth of the size.
std::string Extent(const Eigen::AlignedBox3d& box, const Json& info) {
  const Eigen::Vector3d size = box.sizes(), from = box.min();
  const std::string unit = info.contains("unit") ? " " + info["unit"].get<std::string>() : "";
  const double step = std::pow(10, std::floor(std::log10(std::max(size.maxCoeff(), 1e-300))) - 3);
  const auto place = [&](double x) {
    const double rounded = std::round(x / step) * step + 0.0;  // no -0
    return Number(std::isfinite(rounded) ? rounded : x, 12);
  };
  return fmt::format("{} x {} x {}{}, from {}, {}, {}",
                     Number(size[0]),
                     Number(size[1]),
                     Number(size[2]),
                     unit,
                     place(from[0]),
                     place(from[1]),
                     place(from[2]));
}

// "3, of 4000, 1200, 60 points; 12 stray", the first few.
std::string PartsText(const Json& info) {
  const Json& parts = info["parts"];
  std::string text = std::to_string(parts.size());
  for (size_t k = 0; k < std::min(kFew, parts.size()); ++k)
    text += (k == 0 ? ", of " : ", ") + std::to_string(parts[k]["points"].get<std::int64_t>());
  text += parts.size() > kFew ? ", … points" : parts.empty() ? "" : " points";
  const auto stray = info["stray"].get<std::int64_t>();
  return stray > 0 ? text + fmt::format("; {} stray", stray) : text;
}

// "340 faces, closed, volume 22328.9"
std::string MeshText(const Json& mesh) {
  std::string text = mesh.contains("faces")
                         ? std::to_string(mesh["faces"].get<std::int64_t>()) + " faces, "
                         : std::string();
  if (mesh.contains("reason")) return text + mesh["reason"].get<std::string>();
  text += mesh["closed"].get<bool>()
              ? "closed"
              : "with " + std::to_string(mesh["holes"].get<std::int64_t>()) + " holes";
  const auto bodies = mesh["bodies"].get<std::int64_t>();
  if (bodies > 1) text += ", " + std::to_string(bodies) + " bodies";
  return text + ", volume " + Number(mesh["volume"], kDigitsOfMeasures);
}

std::string OfCloud(const Json& info) {
  std::string columns;
  for (const Json& field : info["fields"])
    columns += (columns.empty() ? "" : " ") + field.get<std::string>();
  std::string text =
      Line("kind", fmt::format("cloud of {} points", info["points"].get<std::int64_t>())) +
      Line("size", Extent(BoxOf(info), info)) +
      Line("spacing", Number(info["spacing"], kDigitsOfEstimates)) +
      Line("noise", Number(info["noise"], kDigitsOfEstimates));
  for (const char* const count : {"outliers", "duplicates", "non_finite"}) {
    const auto number = info[count].get<std::int64_t>();
    if (number > 0 || count == std::string("outliers")) text += Line(count, std::to_string(number));
  }
  if (info.contains("mesh")) text += Line("mesh", MeshText(info["mesh"]));
  return text + Line("parts", PartsText(info)) + Line("columns", columns);
}

// "circle, radius 3"
std::string ShapeText(const Json& one) {
  const auto name = one["shape"].get<std::string>();
  std::string text = name == "free" ? "free-form" : name;
  if (!one.contains("shape_parameters")) return text;
  for (const auto& [key, value] : one["shape_parameters"].items()) {
    if (!value.is_number()) continue;
    std::string words = key;
    std::replace(words.begin(), words.end(), '_', ' ');
    text += ", " + words + " " + Number(value, kDigitsOfMeasures);
  }
  return text;
}

// "[0, 1] line", the first few of several.
std::string PiecesText(const Json& one) {
  if (!one.contains("pieces") || one["pieces"].size() < 2) return "";
  const Json& pieces = one["pieces"];
  std::string text = Line("pieces", std::to_string(pieces.size()));
  for (size_t k = 0; k < std::min(kFew, pieces.size()); ++k) {
    const Json& domain = pieces[k]["domain"];
    text += Line(fmt::format("  {}", k),
                 ShapeText(pieces[k]) + ", on " + Number(domain[0]) + " to " + Number(domain[1]));
  }
  if (pieces.size() > kFew) text += fmt::format("  … {} more\n", pieces.size() - kFew);
  return text;
}

// Where plane cubics are inflected, come to rest or cross themselves.
std::string CubicsText(const Json& one) {
  if (!one.contains("cubics")) return "";
  std::string inflections, cusps, loops;
  for (const Json& piece : one["cubics"]) {
    const auto add = [](std::string& list, const std::string& text) {
      list += (list.empty() ? "at " : ", ") + text;
    };
    if (piece.contains("inflections")) {
      for (const Json& u : piece["inflections"]) add(inflections, Number(u, kDigitsOfMeasures));
    }
    if (piece.contains("cusp")) add(cusps, Number(piece["cusp"], kDigitsOfMeasures));
    if (piece.contains("loop")) {
      add(loops,
          Number(piece["loop"][0], kDigitsOfMeasures) + " = " +
              Number(piece["loop"][1], kDigitsOfMeasures));
    }
  }
  std::string text;
  if (!inflections.empty()) text += Line("inflections", inflections);
  if (!cusps.empty()) text += Line("cusps", cusps);
  if (!loops.empty()) text += Line("crosses", loops);
  return text;
}

std::string KindText(const Json& one) {
  std::string text = ShapeWords(one);
  if (one["rational"].get<bool>()) text += ", rational";
  const Json& closed = one["closed"];
  if (closed.size() == 1 && closed[0].get<bool>()) text += ", closed";
  if (closed.size() == 2) {
    const bool u = closed[0].get<bool>(), v = closed[1].get<bool>();
    if (u || v) text += std::string(", closed in ") + (u && v ? "u and v" : u ? "u" : "v");
  }
  return text;
}

std::string OfOne(const Json& one) {
  std::string text = one.contains("name") ? Line("name", one["name"]) : "";
  text += Line("kind", KindText(one)) + Line("shape", ShapeText(one)) +
          Line("size", Extent(BoxOf(one), one));
  for (const char* const measure : {"length", "area"})
    if (one.contains(measure)) text += Line(measure, Number(one[measure], kDigitsOfMeasures));
  if (one.contains("trims") && one["trims"] > 0) text += Line("trims", one["trims"].dump());
  const Json& curvature = one["curvature"];
  if (curvature.is_object()) {
    const auto bound = [](const Json& x) {
      return x.is_null() ? "unbounded" : Number(x, kDigitsOfEstimates);
    };
    text += Line("curvature", bound(curvature["min"]) + " to " + bound(curvature["max"]));
  }
  return text + PiecesText(one) + CubicsText(one);
}

std::string OfSeveral(const Json& info) {
  const Json& results = info["results"];
  Eigen::AlignedBox3d box;
  std::map<std::string, int> shapes;
  std::string lines;
  for (size_t k = 0; k < results.size(); ++k) {
    const Json& one = results[k];
    box.extend(BoxOf(one));
    ++shapes[one["shape"].get<std::string>()];
    if (k >= kFew) continue;
    const std::string name =
        one.contains("name") ? "\"" + one["name"].get<std::string>() + "\", " : "";
    lines += Line(fmt::format("  {}", k), name + KindText(one) + ", " + ShapeText(one));
  }
  if (results.size() > kFew) lines += fmt::format("  … {} more\n", results.size() - kFew);
  std::string counts;
  for (const auto& [shape, count] : shapes)
    counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, shape);
  return Line("kind",
              fmt::format("{} surfaces, {} curves",
                          info["surfaces"].get<std::int64_t>(),
                          info["curves"].get<std::int64_t>())) +
         Line("shapes", counts) + Line("size", Extent(box, info)) + lines;
}

// "(1, 2, 3)"
std::string PlaceText(const Json& place) {
  std::string text;
  for (const Json& x : place) text += (text.empty() ? "(" : ", ") + Number(x, kDigitsOfMeasures);
  return text + ")";
}

// A solid or shell, and its free edges, the first few.
std::string OfBody(const Json& body) {
  const Json& free = body["free_edges"];
  const size_t surfaces = body["surfaces"].size();
  std::string text = body.contains("name") ? "\"" + body["name"].get<std::string>() + "\", " : "";
  text += fmt::format("{} surface{}, {} shared edges, ",
                      surfaces,
                      surfaces == 1 ? "" : "s",
                      body["shared_edges"].get<size_t>());
  text += free.empty()       ? "watertight"
          : free.size() == 1 ? "not watertight: a free edge"
                             : fmt::format("not watertight: {} free edges", free.size());
  std::string lines = Line(body["kind"].get<std::string>().c_str(), text);
  for (size_t k = 0; k < free.size() && k < kFew; ++k) {
    lines += Line("  free edge",
                  fmt::format("of surface {}, from {} to {}",
                              free[k]["surface"].get<size_t>(),
                              PlaceText(free[k]["from"]),
                              PlaceText(free[k]["to"])));
  }
  if (free.size() > kFew) lines += fmt::format("  … {} more\n", free.size() - kFew);
  return lines;
}

}  // namespace

std::string ShortSummary(const Json& info) {
  std::string text = info.contains("results")  ? OfSeveral(info)
                     : info["kind"] == "cloud" ? OfCloud(info)
                                               : OfOne(info);
  if (info.contains("bodies")) {
    for (const Json& body : info["bodies"]) text += OfBody(body);
  }
  if (info.contains("remarks")) {
    for (const Json& remark : info["remarks"]) text += Line("remark", remark);
  }
  return text;
}

void PrintForPeople(const Json& info, bool all) {
  fmt::print("{}", ShortSummary(info));
  if (!all) return;
  fmt::print("\n");
  PrintAligned(info);
}

}  // namespace batten::internal
