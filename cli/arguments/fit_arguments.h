// SPDX-License-Identifier: MIT
// What the fits have in common on the command line.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/free_variables.h"
#include "batten/fitting/part_options.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/refused_data.h"
#include "batten/fitting/robust_loss.h"
#include "batten/fitting/uncertainty.h"
#include "batten/geometry/solid_model.h"
#include "batten/io/cloud_source.h"
#include "batten/io/geometry_types.h"
#include "batten/io/read_cloud.h"
#include "batten/io/solid_writer.h"
#include "cli/arguments/cleaning.h"
#include "cli/arguments/cloud_arguments.h"
#include "cli/arguments/fit_output.h"
#include "cli/terminal/cli11_forward.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/interrupt.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {

struct FitArguments {
  std::vector<std::string> clouds;
  bool curves = false;          // all that is fitted: they have no mesh
  bool vertices_alone = false;  // of a mesh count
  bool may_keep_all = false;    // --clean none
  std::string out, out_format, step_schema = GeometryWriteOptions().step_schema;
  CloudArguments cloud;
  OutputArguments output;
  CommonFlags flags;
  WorkFlags work;
  std::optional<double> tolerance, time_limit, sew;
  bool accept_doubt = false;
  bool uncertainty = false;     // of curves and surfaces
  std::string uncertainty_map;  // a file; empty: none
  std::string control_points = "chosen", max_control_points, smoothing = "auto", loss = "auto",
              loss_scale = "auto", clean = "auto", optimize = "auto", origin = "keep",
              parameterization, points = "faces";
};

// The options of a fit with control points, with the words that differ.
struct FitWords {
  const char* points;                               // name of the positional argument
  const char* control_points;                       // of its value
  const char* smoothing;                            // the default, in numbers
  const char* loss;                                 // help
  const char* parameterization;                     // help
  std::vector<std::string> parameterizations = {};  // the choices
};
void AddFitArguments(CLI::App& command, FitArguments& arguments, const FitWords& words);

// Those among them that every fit has; --loss and --loss-scale where there are words for them.
void AddEveryFitsArguments(CLI::App& command,
                           FitArguments& arguments,
                           const char* points,
                           const char* loss);

// --uncertainty, --uncertainty-map, --certify and --certificate.
void AddUncertaintyArguments(CLI::App& command, FitArguments& arguments);

// Puts the flags of a fit, when all are added, under headings.
void GroupFitFlags(CLI::App& command);

[[noreturn]] void NotYet(const std::string& what);  // "… is not in this version"

// Values of the shared flags. Each throws UsageError naming flag, value and rule. A loss is one of
// the words that the flag allows.
std::optional<Loss> ToLoss(const std::string& word);  // none for auto
std::optional<double> ToSmoothing(const std::string& text);
std::optional<double> ToLossScale(const std::string& text);
// auto (none), none (nothing free), or any of params, weights and knots in any order.
std::optional<FreeVariables> ToFreeVariables(const std::string& words);
// What is subtracted from the coordinates written; none says the cloud's own origin.
std::optional<Eigen::Vector3d> ToShift(const std::string& origin);

// A fit's options with the flags for seed, threads and progress. What breaks a rule of theirs is a
// usage error.
//
// The limit of time begins here.
template <class Options>
Options WithWork(Options options, const FitArguments& a) {
  options.seed = a.work.seed;
  options.threads = a.work.threads;
  options.progress = MakeProgress(a.flags.quiet);
  if (a.time_limit) BeginTimeLimit(*a.time_limit);
  try {
    Check(options);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  return options;
}

// The flags that carry out a remedy, as the end of a sentence; empty for Remedy::kNone.
std::string FlagsThatHelp(Remedy remedy);

// A fit from its files' point of view: checks the outputs before any work is done, reads, and
// writes geometry, residuals and reports.
class FitFiles {
 public:
  // `beside`: files that are read too, and so not to be written; `also`: files that are written
  // too.
  explicit FitFiles(const FitArguments& arguments,
                    const std::vector<std::string>& beside = {},
                    const std::vector<std::string>& also = {});

  // The cloud, with columns u and v where `parameters` asks for them and of a mesh what `faces`
  // says, unless vertices alone count. Throws ReadError where it can't
  // be used.
  const PointCloud& Read(bool parameters, CloudFaces faces = CloudFaces::kKept);

  // The faces among what was read; null where there are none, or vertices alone count.
  const FaceSurface* faces() const { return file_.mesh ? &file_.mesh->faces : nullptr; }
  // Whether points on them are among the points.
  bool sampled() const { return file_.mesh && file_.mesh->sampled > 0; }

  // The files as a source that is passed over, not read.
  CloudFileSource Source();

  // Goes on with the points that stand for those of a source.
  void TakeSample(const CloudFileSource& source, Eigen::Index points, const PointCloud& sample);

  // Whether only some points of the files are taken (--box, --where and their like).
  bool picked() const { return file_.filtered > 0 || cleaned_ > 0; }

  // What the program ends with for a fit of this report.
  static int ExitCode(const FitReport& report);

  // Of what was read: places of rows that are not finite.
  const std::vector<Eigen::Index>& missing() const { return file_.missing; }

  // Runs `fit`; the library's reason why points can't be fitted gets the name of their file and the
  // flags that help.
  template <class Function>
  auto Explained(const Function& fit) const {
    try {
      return fit();
    } catch (const RefusedData& refusal) {
      Refuse(refusal.what() + FlagsThatHelp(refusal.remedy()));
    } catch (const std::invalid_argument& error) {
      Refuse(error.what());
    }
  }
  // The same; where time is up before there is any result, `quick` makes one.
  template <class Function, class Quick>
  auto ExplainedInTime(const Function& fit, const Quick& quick) const {
    return Explained([&] {
      try {
        return fit();
      } catch (const Cancelled&) {
        if (!TimeIsUp()) throw;
        auto made = quick();
        NoteTimeLimit(made.report);
        return made;
      }
    });
  }

  // Whether time was up, and not the user's patience; the limit ends then, and a report is told.
  bool TimeIsUp() const;
  void NoteTimeLimit(FitReport& report) const;

  // Goes on with these points in place of those that were read; so many are on triangles.
  void TakePoints(const PointCloud& points, Eigen::Index sampled = 0);

  // Goes on with these points of the cloud alone.
  void Keep(const std::vector<Eigen::Index>& points);

  [[noreturn]] void Refuse(const std::string& reason) const;

  Eigen::Vector3d shift() const;

  // What is written is this solid, whose faces are the geometries; it outlives Write.
  void KeepSolid(const SolidModel& solid) { solid_ = &solid; }
  // The same of exact faces; `census` gets what the solid has when it is written.
  void KeepSolid(const TrimmedSolid& solid, SolidCensus& census) {
    trimmed_ = &solid;
    census_ = &census;
  }

  // What has been done since Read is of the stage before the fit.
  void NotePrepared() { prepared_seconds_ = Seconds() - read_seconds_; }

  // The faces of which the reports tell; they outlive Write.
  void KeepPart(const PartSummary& part) { part_ = &part; }

  // Computes the uncertainty of a fit to what was read, where it is asked for, for Write.
  template <class Fit>
  void NoteUncertainty(Fit& fit);

  // What the report of Write says of the form.
  void NoteForm(FormDeviation form) { checks_.form = std::move(form); }

  // Writes everything and returns the exit code. Of several geometries `owners` names that of each
  // point's foot.
  int Write(const std::vector<Geometry>& geometry,
            const Eigen::VectorXd& residuals,
            const Eigen::MatrixXd& parameters,
            const Eigen::Array<bool, Eigen::Dynamic, 1>& outliers,
            FitReport& report,
            std::vector<int> owners = {}) const;

 private:
  double Seconds() const;  // since construction
  void Clean(const StatisticalRemoval& how);
  void RefuseFarOrigin() const;  // from which coordinates keep too few digits

  // The geometry or, where OUT is one, its mesh, of which it returns the words; what is proved of
  // the mesh goes to `certified`, where there is one.
  std::string WriteShapes(const std::vector<Geometry>& geometry,
                          std::optional<CertificateSummary>& certified) const;
  [[noreturn]] void RefuseMesh() const;

  const FitArguments& a_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::optional<Eigen::Vector3d> shift_;
  std::string out_format_;
  bool word_is_geometry_;
  CloudFile file_;
  double read_seconds_ = 0, prepared_seconds_ = 0;
  Cleaning cleaning_;
  Eigen::Index cleaned_ = 0;
  const SolidModel* solid_ = nullptr;
  ReportChecks checks_;
  std::optional<Uncertainty> uncertainty_;
  std::optional<UncertaintyMap> map_;
  Eigen::VectorXd deviations_;  // of the shape at the points' feet
  const TrimmedSolid* trimmed_ = nullptr;
  SolidCensus* census_ = nullptr;
  const PartSummary* part_ = nullptr;
};

}  // namespace batten::internal
