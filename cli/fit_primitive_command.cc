// SPDX-License-Identifier: MIT
// batten fit primitive: points in, an exact line or circle and its report out.
#include <memory>
#include <utility>

#include "batten/cli/fit_arguments.h"
#include "batten/cli/parse_values.h"
#include "batten/cli/terminal.h"
#include "batten/fitting/fit_primitive.h"
#include "batten/io/read_error.h"

namespace batten {
namespace {

struct Arguments : FitArguments {
  std::string kind;
};

PrimitiveKind ToKind(const std::string& word) {
  CheckChoice(
      "--kind", word, {"auto", "line", "circle"}, {"plane", "cylinder", "sphere", "cone", "torus"});
  if (word == "line") return PrimitiveKind::kLine;
  if (word == "circle") return PrimitiveKind::kCircle;
  return PrimitiveKind::kAuto;
}

PrimitiveFitOptions ToOptions(const Arguments& a) {
  PrimitiveFitOptions options;
  options.kind = ToKind(a.kind);
  options.tolerance = a.tolerance;
  options.loss = ToLoss(a.loss);
  options.loss_scale = ToLossScale(a.loss_scale);
  return WithWork(std::move(options), a);
}

int Run(const Arguments& a) {
  PrimitiveFitOptions options = ToOptions(a);
  FitFiles files(a);
  const PointCloud& cloud = files.Read(false);
  options.shift = files.shift();
  PrimitiveFit fit = files.Explained([&] { return FitPrimitive(cloud, options); });
  const Geometry geometry =
      std::visit([](const auto& curve) { return Geometry(curve); }, fit.curve);
  return files.Write(
      {geometry}, fit.residuals, fit.parameters.transpose(), fit.outliers, fit.report);
}

}  // namespace

void AddFitPrimitiveCommand(CLI::App& fit, Action& action) {
  auto a = std::make_shared<Arguments>();
  CLI::App& command =
      *fit.add_subcommand("primitive", "Fit an exact line, arc or circle to points");
  AddEveryFitsArguments(
      command,
      *a,
      "CLOUD",
      "auto none huber cauchy tukey truncated; auto is none, any other sets outliers aside");
  command
      .add_option(
          "--kind", a->kind, "auto line circle; auto is the simplest that the points do not reject")
      ->required()
      ->type_name("KIND");
  command.footer(
      "Examples:\n"
      "  batten fit primitive hole.xyz -o hole.step --kind circle\n"
      "  batten fit primitive edge.csv -o edge.json --kind auto --report edge-report.json\n"
      "  batten fit primitive pipe-section.xyz -o section.step --kind circle --loss tukey "
      "--tolerance 0.05\n"
      "Two columns are points of the plane. Distances are orthogonal; a circle in space is found "
      "with its plane.\n"
      "A full circle where the points go all round, else the arc that they cover.\n"
      "Centre, radius, axis or direction are in the report, under geometry.\n"
      "Exit code 3 says the best shape is written but the tolerance is not reached.");
  command.callback([a, &action] { action = [a] { return Run(*a); }; });
}

}  // namespace batten
