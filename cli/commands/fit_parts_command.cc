// SPDX-License-Identifier: MIT
// batten fit parts: the scan of a machined part in, its faces and what they have in common out.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/fit_parts.h"
#include "batten/fitting/refused_data.h"
#include "batten/io/write_labels.h"
#include "cli/arguments/fit_arguments.h"
#include "cli/arguments/part_words.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/help_format.h"

namespace batten::internal {
namespace {

struct FitPartsArguments : FitArguments {
  std::string labels;
  bool regularise = false;
};

int RunFitParts(const FitPartsArguments& a) {
  PartFitOptions options;
  options.tolerance = a.tolerance;
  options.regularise = a.regularise;
  options = WithWork(std::move(options), a);
  FitFiles files(a, {}, a.labels.empty() ? std::vector<std::string>() : std::vector{a.labels});
  if (!a.labels.empty()) CheckLabelsName(a.labels);
  PointCloud cloud = files.Read(false, CloudFaces::kFlat);
  options.shift = files.shift();
  PartsFit fit = files.Explained([&] { return FitParts(cloud, options); });
  std::vector<Geometry> faces;
  for (PartFace& face : fit.faces) faces.emplace_back(std::move(face.surface));
  PointMask outliers(cloud.size());
  for (Eigen::Index k = 0; k < outliers.size(); ++k) outliers[k] = fit.labels[std::size_t(k)] < 0;
  files.KeepPart(fit.summary);
  if (!a.labels.empty()) WriteLabels(cloud, fit.labels, a.labels);
  const int code =
      files.Write(faces, fit.residuals, fit.parameters, outliers, fit.report, fit.owners);
  if (!a.flags.quiet && !a.flags.json && a.out != "-") fmt::print("{}", PartTable(fit.summary));
  return code;
}

}  // namespace

void AddFitPartsCommand(CLI::App& fit, Action& action) {
  auto a = std::make_shared<FitPartsArguments>();
  CLI::App& command = *fit.add_subcommand(
      "parts", "Find the planes, cylinders, cones, spheres, tori and free faces of a scanned part");
  AddEveryFitsArguments(command, *a, "CLOUD", nullptr);
  command.get_option("--tolerance")
      ->description(
          "Distance within which points are of one face, in the data's unit [3.5 times the noise]");
  command
      .add_option(
          "--labels",
          a->labels,
          "Where to write every point with the number of its face and its colour: .ply .csv")
      ->type_name("LABELLED");
  command.add_flag(
      "--regularise",
      a->regularise,
      "Fit the faces together so that what is parallel, perpendicular, coaxial, coplanar, of one "
      "radius or tangent within its standard deviations is so exactly");
  GroupFitFlags(command);
  GroupFlags(command, "What is written", {"--labels"});
  GroupFlags(command, "Which shape", {"--regularise"});
  command.footer(
      "Examples:\n"
      "  batten fit parts scan.ply -o faces.step\n"
      "  batten fit parts scan.ply -o faces.step --labels labelled.ply --report faces-report.html\n"
      "  batten fit parts part.stl -o faces.step --regularise\n"
      "Regions grow from the flattest places, compete for the points at their borders, and are "
      "each\n"
      "of the first of plane, sphere, cylinder, cone and torus that their points do not reject. "
      "Smooth\n"
      "regions of none of these get free surfaces. Each face is trimmed to the outline of its "
      "points.\n"
      "The table lists kind, points, rms and numbers with standard deviations; --json and the "
      "reports\n"
      "have them in full, with the relations between faces and how far each is from holding.\n"
      "Points of no face have the label -1 and count as outliers.\n"
      "Exit code 3 says a point of a face is farther from it than the tolerance.");
  command.callback([a, &action] { action = [a] { return RunFitParts(*a); }; });
}

}  // namespace batten::internal
