// SPDX-License-Identifier: MIT
#include "cli/arguments/cad_solid.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "batten/fitting/fit_parts.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/refused_data.h"
#include "batten/io/read_error.h"
#include "batten/io/solid_writer.h"
#include "cli/arguments/part_words.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

constexpr double kMostlyExact =
    0.6;  // of the points: below, exact faces are not what it is made of

// Some of the points, from which auto sees what a body is made of.
PointCloud Glance(const PointCloud& cloud) {
  constexpr Eigen::Index kEnough = 8000;
  if (cloud.size() <= kEnough) return cloud;
  return cloud.Picked(SampleIndices(cloud.size(), kEnough, 1));
}

double ExactShare(const PartsFit& fit) {
  return static_cast<double>(fit.report.input.used) / static_cast<double>(fit.report.input.points);
}

std::string TooFewWords(double share) {
  return fmt::format("{:.0f} % of the points are on planes, cylinders, cones, spheres and tori",
                     100 * share);
}

// Why the part is no solid of exact faces; empty where it is one.
std::string WhyNot(const PartsFit& fit, SolidKind kind, const SolidDemands& demands) {
  const double share = ExactShare(fit);
  if (share < kMostlyExact) return TooFewWords(share);
  if (!fit.solid) return fit.no_solid;
  if (demands.genus && fit.genus != *demands.genus) return GenusWords(fit.genus, *demands.genus);
  // The bodies of a mesh are known, those of points may be one.
  const bool several = kind == SolidKind::kAuto && fit.bodies > 1 && !demands.volume;
  return several ? fmt::format("the faces are {} bodies", fit.bodies) : "";
}

// What a solid misses of a mesh, whose every place is one of the body; empty: nothing.
std::string MissedOf(FitReport report) {
  report.input.mesh = InputMesh{.sampled = report.input.points};
  for (const Doubt& doubt : report.Doubts()) {
    if (doubt.code == "points_missed") return doubt.words;
  }
  return "";
}

int Written(const FitArguments& a, FitFiles& files, PartsFit& fit) {
  std::vector<Geometry> faces;
  for (PartFace& face : fit.faces) faces.emplace_back(face.surface);
  PointMask outliers(std::ssize(fit.labels));
  for (Eigen::Index k = 0; k < outliers.size(); ++k) outliers[k] = fit.labels[std::size_t(k)] < 0;
  SolidCensus census;
  files.KeepSolid(*fit.solid, census);
  files.KeepPart(fit.summary);
  const int code =
      files.Write(faces, fit.residuals, fit.parameters, outliers, fit.report, fit.owners);
  if (!a.flags.quiet) {
    if (fit.invented > 0.01) {
      PrintWarning(fmt::format("{:.0f} % of the area have no points near", 100 * fit.invented));
    }
    PrintNote(a.out + ": " + CensusWords(census, "faces"));
    if (!a.flags.json) fmt::print("{}", PartTable(fit.summary));
  }
  return code;
}

// Under these options; a reason and no code where it ends before a solid that meets the demands.
CadOutcome TryCadSolid(const FitArguments& a,
                       SolidKind kind,
                       const SolidDemands& demands,
                       FitFiles& files,
                       const PointCloud& cloud,
                       const PartFitOptions& options) {
  try {
    if (kind == SolidKind::kAuto) {
      PartFitOptions quick = options;
      quick.regularise = quick.solid = false;
      const double share = ExactShare(FitParts(Glance(cloud), quick));
      if (share < kMostlyExact) return {std::nullopt, TooFewWords(share)};
    }
    PartsFit fit = FitParts(cloud, options);
    std::string reason = WhyNot(fit, kind, demands);
    if (reason.empty() && demands.volume) {
      const auto doubt = VolumeDoubt(CensusOf(*fit.solid).volume, *demands.volume);
      if (doubt) reason = doubt->words;
      if (reason.empty()) reason = MissedOf(fit.report);
    }
    if (!reason.empty()) return {std::nullopt, reason};
    const int code = Written(a, files, fit);
    if (kind == SolidKind::kAuto && !a.flags.quiet) {
      PrintNote("--kind auto: cad, for all faces are exact and their edges close");
    }
    return {code, ""};
  } catch (const RefusedData& refusal) {
    return {std::nullopt, refusal.what()};
  } catch (const WriteError& refusal) {
    return {std::nullopt, refusal.what()};
  }
}

}  // namespace

std::string CensusWords(const SolidCensus& census, const char* faces) {
  return fmt::format("{} of {} {}, {} edges; volume {:.6g}, area {:.6g}",
                     census.solids == 1 ? "a watertight solid"
                                        : fmt::format("{} watertight solids", census.solids),
                     census.faces,
                     faces,
                     census.edges,
                     census.volume,
                     census.area);
}

std::string GenusWords(int genus, int asked) {
  return fmt::format("its genus is {}, not {} (--genus)", genus, asked);
}

SolidKind ToSolidKind(const std::string& word) {
  return word == "cad"       ? SolidKind::kCad
         : word == "organic" ? SolidKind::kOrganic
         : word == "faceted" ? SolidKind::kFaceted
                             : SolidKind::kAuto;
}

CadOutcome RunCadSolid(const FitArguments& a,
                       SolidKind kind,
                       const SolidDemands& demands,
                       FitFiles& files,
                       const PointCloud& cloud) {
  if (kind == SolidKind::kOrganic || kind == SolidKind::kFaceted) return {};
  PartFitOptions options;
  options.tolerance = a.tolerance;
  options.regularise = true;
  options.free_form = false;
  options.solid = true;
  options.most_invented = demands.most_invented;
  options.shift = files.shift();
  options = WithWork(std::move(options), a);
  CadOutcome outcome = TryCadSolid(a, kind, demands, files, cloud, options);
  if (!outcome.code && demands.least_noise > 0) {
    // Facets that are exact by themselves stand for round faces where their chords count as noise.
    options.least_noise = demands.least_noise;
    const CadOutcome rounded = TryCadSolid(a, kind, demands, files, cloud, options);
    if (rounded.code) return rounded;
  }
  if (!outcome.code && kind == SolidKind::kCad) {
    files.Refuse("makes no solid of exact faces: " + outcome.reason +
                 " (--kind organic makes one of smooth faces, fit parts writes the exact ones)");
  }
  return outcome;
}

}  // namespace batten::internal
