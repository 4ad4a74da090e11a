// SPDX-License-Identifier: MIT
#include "cli/arguments/make_constructions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "batten/geometry/aligned_curves.h"
#include "batten/geometry/bicubic_patch.h"
#include "batten/geometry/coons_surface.h"
#include "batten/geometry/gordon_surface.h"
#include "batten/geometry/lofted_surface.h"
#include "batten/geometry/ruled_surface.h"
#include "batten/geometry/swept_surface.h"
#include "batten/geometry/swung_surface.h"
#include "batten/io/read_error.h"
#include "cli/arguments/curve_files.h"
#include "cli/arguments/make_values.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/parse_values.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

using Arguments = ConstructionArguments;
using Curves = std::vector<NurbsCurve<3>>;

constexpr double kToleranceOfSize = 1e-5;

void AddCurves(CLI::App& command, Arguments& a, const char* name, const char* help) {
  command.add_option(name, a.curves, help)->required()->expected(1, 1 << 20);
}

void AddFormat(CLI::App& command, Arguments& a) {
  AddFlag(command, "--format", a.format, "FORMAT", "Format of the files where names do not tell");
}

void AddTolerance(CLI::App& command, Arguments& a, const char* help) {
  AddFlag(command, "--tolerance", a.tolerance, "T", help);
}

double ToleranceOf(const Arguments& a, const Curves& curves) {
  if (!a.tolerance.empty()) return ParseNumber("--tolerance", a.tolerance, Sign::kPositive);
  return kToleranceOfSize * SizeOf(curves);
}

void RequireCount(const Curves& curves, std::size_t count, const char* what) {
  if (curves.size() == count) return;
  throw UsageError(fmt::format("the files hold {} curves; {}", curves.size(), what));
}

// "section 3 turned round and begun 0.25 of its length later"
std::string ChangeText(const char* noun, std::size_t k, const CurveAlignment& change) {
  std::string text = fmt::format("{} {}", noun, k + 1);
  if (change.reversed) text += " turned round";
  if (change.reversed && change.start > 0) text += " and";
  if (change.start > 0) text += fmt::format(" begun {:.3g} of its domain later", change.start);
  return text;
}

std::vector<std::string> ChangeNotes(const char* noun, const std::vector<CurveAlignment>& changes) {
  std::vector<std::string> notes;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    if (changes[k].reversed || changes[k].start > 0) {
      notes.push_back(ChangeText(noun, k, changes[k]));
    }
  }
  return notes;
}

// Where curves run or begin unlike those before them and --align was not asked for.
std::vector<std::string> AlignHints(const char* noun, const Curves& curves) {
  constexpr double kBesides = 0.05;  // of the domain: a start so near is not worth a word
  std::string unlike;
  const std::vector<CurveAlignment> changes = Aligned(curves).changes;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const double off = std::abs(std::remainder(changes[k].start, 1.0));
    if (changes[k].reversed || off > kBesides) {
      unlike += fmt::format("{}{} {}", unlike.empty() ? "" : ", ", noun, k + 1);
    }
  }
  if (unlike.empty()) return {};
  return {unlike +
          ": runs the other way than the one before, or begins elsewhere; --align turns it"};
}

std::string ErrorNote(const char* what, double error) {
  return fmt::format("{} to {:.2g}", what, error);
}

void AddExtrude(CLI::App& command, Arguments& a) {
  AddCurves(command, a, "PROFILE", "The curves to move: .json .step .iges");
  AddFormat(command, a);
  Require(command, "--by", a.by, "X,Y,Z", "How far and in which direction");
}
Construction Extruded(const Arguments& a) {
  Construction made;
  for (const NurbsCurve<3>& curve : CurvesOf(a.curves, a.format, *a.unit)) {
    made.shapes.emplace_back(Extrude(curve, Triple("--by", a.by)));
  }
  return made;
}

void AddRuled(CLI::App& command, Arguments& a) {
  AddCurves(command, a, "CURVE", "Two curves, in one file or two");
  AddFormat(command, a);
  command.add_flag("--by-length",
                   a.by_length,
                   "Join points at equal shares of the lengths, not of the parameters");
  command.add_flag(
      "--align", a.align, "Turn the second round, or begin it elsewhere, to run beside the first");
  AddTolerance(
      command, a, "Of --by-length: how far the edge may leave the curve [1e-5 of the size]");
}
Construction RuledBetween(const Arguments& a) {
  Curves curves = CurvesOf(a.curves, a.format, *a.unit);
  RequireCount(curves, 2, "two are joined");
  Construction made;
  RuledOptions options;
  if (!a.by_length && !a.tolerance.empty())
    throw UsageError(
        "--tolerance: only --by-length needs one; without it the curves are met exactly");
  if (a.by_length) options = {RuledBy::kLength, ToleranceOf(a, curves)};
  if (a.align) {
    AlignedCurves aligned = Aligned(std::move(curves));
    curves = std::move(aligned.curves);
    made.notes = ChangeNotes("curve", aligned.changes);
  }
  RuledSurface ruled = Ruled(curves[0], curves[1], options);
  if (!a.align) made.notes = AlignHints("curve", curves);
  made.shapes.emplace_back(std::move(ruled.surface));
  if (ruled.error > 0) made.notes.push_back(ErrorNote("the second curve is met", ruled.error));
  return made;
}

void AddLoft(CLI::App& command, Arguments& a) {
  AddCurves(command, a, "SECTION", "Section curves in their order, one or more in a file");
  AddFormat(command, a);
  AddFlag(command, "--degree", a.degree, "P", "Across the sections, where there are enough");
  command.add_flag("--closed", a.closed, "Goes on from the last section to the first, smoothly");
  command.add_flag("--align",
                   a.align,
                   "Turn sections round, and begin closed ones elsewhere, to run beside the one "
                   "before");
  AddFlag(command,
          "--spine",
          a.spine,
          "FILE",
          "A curve past the sections in their order; they are crossed in its direction");
  AddFlag(command,
          "--start-tangent",
          a.start_tangent,
          "X,Y,Z[,F]",
          "Direction in which the surface leaves the first section; F: how full [1]");
  AddFlag(command,
          "--end-tangent",
          a.end_tangent,
          "X,Y,Z[,F]",
          "Direction in which it arrives at the last");
  AddTolerance(command,
               a,
               "Of sections whose weights differ too wildly to be lofted as they are "
               "[1e-5 of the size]");
}
std::optional<LoftEnd> EndOf(const char* flag, const std::string& text) {
  if (text.empty()) return {};
  const std::vector<double> x = ParseNumbers(flag, text);
  if (x.size() != 3 && x.size() != 4) {
    throw UsageError(fmt::format("{}: '{}' is not x,y,z or x,y,z,fullness", flag, text));
  }
  return LoftEnd{{x[0], x[1], x[2]}, x.size() == 4 ? x[3] : 1};
}
Construction Lofted(const Arguments& a) {
  const Curves sections = CurvesOf(a.curves, a.format, *a.unit);
  LoftOptions options;
  options.degree = static_cast<int>(ParseWhole("--degree", a.degree, 1, kMaxDegree));
  options.closed = a.closed;
  options.align = a.align;
  options.start = EndOf("--start-tangent", a.start_tangent);
  options.end = EndOf("--end-tangent", a.end_tangent);
  if (!a.spine.empty()) options.spine = OnlyCurve(a.spine, a.format, *a.unit, "spine");
  if (!sections.empty()) options.tolerance = ToleranceOf(a, sections);
  LoftedSurface loft = Loft(sections, options);
  Construction made{{std::move(loft.surface)}, ChangeNotes("section", loft.changes)};
  if (!a.align) made.notes = AlignHints("section", sections);
  if (loft.error > 0) {
    made.notes.push_back(
        ErrorNote("weights differ too wildly: cubics stand for the sections,", loft.error));
  }
  return made;
}

void AddSweep(CLI::App& command, Arguments& a) {
  AddCurves(command, a, "PROFILE TRAJECTORY", "The curve that is moved, and the one along which");
  AddFormat(command, a);
  command.add_flag(
      "--translational", a.translational, "Move the profile without turning it: exact");
  AddTolerance(command, a, "Largest distance from the exact sweep [1e-5 of the size]");
  AddFlag(command,
          "--twist",
          a.twist,
          "DEGREES",
          "Turn it about the trajectory on the way; whole turns where that is closed");
}
Construction Swept(const Arguments& a) {
  const Curves curves = CurvesOf(a.curves, a.format, *a.unit);
  RequireCount(curves, 2, "one is moved along the other");
  if (a.translational) {
    if (ParseNumber("--twist", a.twist) != 0)
      throw UsageError("--twist: --translational does not turn");
    if (!a.tolerance.empty()) throw UsageError("--tolerance: --translational is exact");
    return {{SweepTranslational(curves[0], curves[1])}};
  }
  SweptSurface sweep = Sweep(
      curves[0],
      curves[1],
      {.tolerance = ToleranceOf(a, curves), .twist = Radians(ParseNumber("--twist", a.twist))});
  Construction made{{std::move(sweep.surface)}, {ErrorNote("the exact sweep is met", sweep.error)}};
  if (sweep.closing != 0) {
    made.notes.push_back(
        fmt::format("{:.3g} degrees of turn are spread along the closed trajectory",
                    sweep.closing * 180 / std::numbers::pi));
  }
  return made;
}

void AddSwing(CLI::App& command, Arguments& a) {
  AddCurves(command,
            a,
            "PROFILE TRAJECTORY",
            "The profile in the plane of x axis and axis, and the curve across the axis that says "
            "how far out it is");
  AddFormat(command, a);
  AddFlag(command, "--center", a.center, "X,Y,Z", "A point of the axis");
  AddFlag(command, "--axis", a.axis, "X,Y,Z", "What the profile goes round");
  AddFlag(command,
          "--x-axis",
          a.x_axis,
          "X,Y,Z",
          "The profile's plane [the coordinate axis farthest from the axis]");
  AddFlag(command,
          "--scale",
          a.scale,
          "S",
          "Of profile times trajectory: 1 over the trajectory's size keeps the profile's");
}
Construction Swung(const Arguments& a) {
  const Frame frame = ParseFrame(a.center, a.axis, a.x_axis);
  if (a.curves.size() != 2) throw UsageError("a profile and a trajectory are needed, a file each");
  const NurbsCurve<3> profile =
      OnlyCurve(a.curves[0], a.format, *a.unit, "profile", {frame.x(), frame.axis()});
  const NurbsCurve<3> trajectory =
      OnlyCurve(a.curves[1], a.format, *a.unit, "trajectory", {frame.x(), frame.y()});
  return {{Swing(profile, trajectory, frame, ParseNumber("--scale", a.scale))}};
}

void AddGordon(CLI::App& command, Arguments& a) {
  command.add_option("--u", a.along_u, "Files of the curves of one direction")
      ->required()
      ->type_name("FILE,...");
  command.add_option("--v", a.along_v, "Files of the curves across them")
      ->required()
      ->type_name("FILE,...");
  AddFormat(command, a);
  AddTolerance(command,
               a,
               "How far apart curves may be where they meet, and the surface from curves that had "
               "to be traced anew [1e-5 of the size]");
}

// The files of "a.json,b.json", given once or several times.
std::vector<std::string> FilesOf(const char* flag, const std::vector<std::string>& lists) {
  std::vector<std::string> files;
  for (const std::string& list : lists) {
    for (std::size_t begin = 0; begin <= list.size();) {
      const std::size_t end = std::min(list.find(',', begin), list.size());
      if (end == begin)
        throw UsageError(
            fmt::format("{}: '{}' names no file between two commas or at an end", flag, list));
      files.push_back(list.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  return files;
}

Construction OfNetwork(const Arguments& a) {
  const Curves along_u = CurvesOf(FilesOf("--u", a.along_u), a.format, *a.unit),
               along_v = CurvesOf(FilesOf("--v", a.along_v), a.format, *a.unit);
  Curves all = along_u;
  all.insert(all.end(), along_v.begin(), along_v.end());
  if (all.empty()) throw UsageError("the files hold no curves");
  GordonSurface gordon = Gordon(along_u, along_v, {.tolerance = ToleranceOf(a, all)});
  Construction made{{std::move(gordon.surface)},
                    {fmt::format("{} x {} curves; where they meet they are at most {:.2g} apart",
                                 along_u.size(),
                                 along_v.size(),
                                 gordon.gap)}};
  if (gordon.error > 0) {
    made.notes.push_back(
        ErrorNote("curves were traced anew, to meet at common parameters or for their weights,",
                  gordon.error));
  }
  return made;
}

void AddCoons(CLI::App& command, Arguments& a) {
  AddCurves(command, a, "SIDE", "Three or four curves that go round, in any order and direction");
  AddFormat(command, a);
  command.add_flag("--bicubic", a.bicubic, "Blend by cubics, with the sides' tangents at corners");
  AddTolerance(command,
               a,
               "How far apart ends may be at a corner, and the surface from sides that had to be "
               "replaced for their weights [1e-5 of the size]");
}
Construction BetweenSides(const Arguments& a) {
  const Curves sides = CurvesOf(a.curves, a.format, *a.unit);
  if (sides.empty()) throw UsageError("the files hold no curves");
  CoonsSurface coons = Coons(sides, {.tolerance = ToleranceOf(a, sides), .bicubic = a.bicubic});
  Construction made{{std::move(coons.surface)}};
  if (coons.gap > 0) {
    made.notes.push_back(fmt::format("corners were closed over gaps of at most {:.2g}", coons.gap));
  }
  if (coons.error > 0) {
    made.notes.push_back(ErrorNote("cubics stand for sides with weights,", coons.error));
  }
  return made;
}

void AddPatch(CLI::App& command, Arguments& a) {
  Require(command, "--corner-00", a.corner00, "X,Y,Z", "The corner u = 0, v = 0");
  Require(command, "--corner-10", a.corner10, "X,Y,Z", "The corner u = 1, v = 0");
  Require(command, "--corner-01", a.corner01, "X,Y,Z", "The corner u = 0, v = 1");
  Require(command, "--corner-11", a.corner11, "X,Y,Z", "The corner u = 1, v = 1");
  const char* four = "X,Y,Z;X,Y,Z;X,Y,Z;X,Y,Z";
  AddFlag(command,
          "--tangents-u",
          a.tangents_u,
          four,
          "Derivatives along u at corners 00, 10, 01, 11 [from corner to corner]");
  AddFlag(command, "--tangents-v", a.tangents_v, four, "The same along v");
  AddFlag(command, "--twists", a.twists, four, "Mixed derivatives there [zero]");
}
void TakeFour(const char* flag, const std::string& text, std::array<Eigen::Vector3d, 4>& four) {
  if (text.empty()) return;
  const std::vector<double> x = ParseNumbers(flag, text);
  if (x.size() != 12) {
    throw UsageError(fmt::format(
        "{}: '{}' holds {} numbers; four vectors x,y,z are needed", flag, text, x.size()));
  }
  for (int k = 0; k < 4; ++k) four[k] = {x[3 * k], x[3 * k + 1], x[3 * k + 2]};
}
Construction Patch(const Arguments& a) {
  PatchCorners corners;
  corners.points = {Triple("--corner-00", a.corner00),
                    Triple("--corner-10", a.corner10),
                    Triple("--corner-01", a.corner01),
                    Triple("--corner-11", a.corner11)};
  for (int k = 0; k < 4; ++k) {
    corners.tangents_u[k] = corners.points[k | 1] - corners.points[k & ~1];
    corners.tangents_v[k] = corners.points[k | 2] - corners.points[k & ~2];
  }
  TakeFour("--tangents-u", a.tangents_u, corners.tangents_u);
  TakeFour("--tangents-v", a.tangents_v, corners.tangents_v);
  TakeFour("--twists", a.twists, corners.twists);
  return {{BicubicPatch(corners)}};
}

}  // namespace

const std::vector<ConstructionKind>& ConstructionKinds() {
  static const std::vector<ConstructionKind> kinds = {
      {"extrude",
       "The surface of a curve moved along a vector",
       "extrude profile.json -o rail.step --by 0,0,120",
       AddExtrude,
       Extruded},
      {"ruled",
       "The straight lines between two curves",
       "ruled top.json bottom.json -o chute.step",
       AddRuled,
       RuledBetween},
      {"loft",
       "The surface through section curves",
       "loft nose.json rib-1.json rib-2.json tail.json -o hull.step --align",
       AddLoft,
       Lofted},
      {"sweep",
       "The surface of a curve moved along another, turned with it",
       "sweep section.json path.json -o pipe.step --tolerance 0.01",
       AddSweep,
       Swept},
      {"swing",
       "The surface of a profile that goes round an axis along a curve",
       "swing profile.json outline.json -o bottle.step",
       AddSwing,
       Swung},
      {"gordon",
       "The surface through a network of curves in two directions",
       "gordon --u keel.json,chine.json,deck.json --v bow.json,mid.json,stern.json \\\n"
       "    -o hull.step --tolerance 0.1",
       AddGordon,
       OfNetwork},
      {"coons",
       "The surface between three or four boundary curves",
       "coons north.json east.json south.json west.json -o panel.step",
       AddCoons,
       BetweenSides},
      {"patch",
       "The bicubic patch of corners, tangents and twists (Hermite's form; without twists "
       "Ferguson's)",
       "patch -o patch.step --corner-00 0,0,0 --corner-10 4,0,0 --corner-01 0,3,0 \\\n"
       "    --corner-11 4,3,1 --tangents-u 4,0,4,4,0,-4,4,0,4,4,0,-4",
       AddPatch,
       Patch},
  };
  return kinds;
}

}  // namespace batten::internal
