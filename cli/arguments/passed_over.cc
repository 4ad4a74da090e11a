// SPDX-License-Identifier: MIT
#include "cli/arguments/passed_over.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <memory>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "batten/fitting/fit_streamed.h"
#include "batten/fitting/fit_tiles.h"
#include "batten/io/cloud_source.h"
#include "batten/io/read_error.h"
#include "cli/arguments/point_sharing.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"
#include "cli/terminal/this_run.h"

namespace batten::internal {
namespace {

constexpr int kMostTiles = 10000;  // along a side

// The files' points, or this process's share of them.
class SharedFiles {
 public:
  SharedFiles(FitFiles& files, const std::vector<std::string>& clouds)
      : files_(files.Source()), own_(files_, OwnFiles(clouds) == clouds) {
    if (Sharing()) joined_ = Sharing()->joined(own_);
  }

  CloudFileSource& files() { return files_; }
  PointSource& source() { return joined_ ? *joined_ : own_; }

 private:
  CloudFileSource files_;
  OwnPieces own_;
  std::unique_ptr<PointSource> joined_;
};

// Goes on in `files` with the sample, and moves the surface where its origin is known now.
void Take(FitFiles& files, SharedFiles& shared, const Eigen::Vector3d& shift, StreamedFit& fit) {
  files.TakeSample(shared.files(), fit.report.input.points, fit.sample);
  for (const std::string& warning : shared.files().warnings())
    fit.report.warnings.push_back(warning);
  const Eigen::Vector3d more = shift - files.shift();
  if (!more.isZero(0)) fit.surface = fit.surface.Translated(more);
}

// For each point of the sample the face that its foot is on.
std::vector<int> OwnersAmong(const std::vector<NurbsSurface>& faces, const Eigen::Matrix2Xd& feet) {
  std::vector<int> owners(static_cast<std::size_t>(feet.cols()), 0);
  for (Eigen::Index k = 0; k < feet.cols(); ++k) {
    const double u = feet(0, k), v = feet(1, k);
    const auto found = std::find_if(faces.begin(), faces.end(), [&](const NurbsSurface& face) {
      return u >= face.basis_u().lower() && u <= face.basis_u().upper() &&
             v >= face.basis_v().lower() && v <= face.basis_v().upper();
    });
    if (found != faces.end())
      owners[static_cast<std::size_t>(k)] = static_cast<int>(found - faces.begin());
  }
  return owners;
}

// Finished passes, where they are kept.
class Checkpoint {
 public:
  Checkpoint(const PassArguments& arguments, SharedFiles& shared, bool quiet) : quiet_(quiet) {
    if (arguments.checkpoint.empty()) return;
    JobWords job = arguments.job;
    job["processes"] = std::to_string(Sharing() ? Sharing()->size : 1);
    folder_.emplace(
        arguments.checkpoint, std::move(job), shared.files(), Sharing() ? Sharing()->rank : 0);
  }

  PassStore* store() { return folder_ ? &*folder_ : nullptr; }

  void NoteResumed() const {
    if (folder_ && folder_->resumed() > 0 && !quiet_ && Writes())
      PrintNote(fmt::format("went on after {} finished passes", folder_->resumed()));
  }
  void Remove() {
    if (folder_) folder_->Remove();
  }

 private:
  bool quiet_;
  std::optional<CheckpointFolder> folder_;
};

int RunTiled(FitFiles& files,
             SharedFiles& shared,
             PassStore* store,
             const SurfaceFitOptions& options,
             const PassArguments& arguments) {
  TileOptions tiles = ToTileOptions(arguments.tiles);
  tiles.store = store;
  TiledFit fit = files.Explained([&] { return FitTiles(shared.source(), options, tiles); });
  StreamedFit& whole = fit.whole;
  if (!Writes()) return files.ExitCode(whole.report);
  Take(files, shared, options.shift, whole);
  if (arguments.tile_faces == "one")
    return files.Write(
        {whole.surface}, whole.residuals, whole.parameters, whole.outliers, whole.report);
  std::vector<NurbsSurface> faces = TileFaces(fit);
  const auto empty = std::count_if(whole.report.tiles.begin(),
                                   whole.report.tiles.end(),
                                   [](const TileSummary& tile) { return tile.points == 0; });
  if (empty > 0)
    whole.report.warnings.push_back(fmt::format(
        "{} of {} tiles hold no points and have no face", empty, whole.report.tiles.size()));
  std::vector<int> owners = OwnersAmong(faces, whole.parameters);
  std::vector<Geometry> geometry(std::make_move_iterator(faces.begin()),
                                 std::make_move_iterator(faces.end()));
  if (geometry.size() == 1) owners.clear();
  return files.Write(
      geometry, whole.residuals, whole.parameters, whole.outliers, whole.report, std::move(owners));
}

int RunStreamed(FitFiles& files,
                SharedFiles& shared,
                PassStore* store,
                const SurfaceFitOptions& options,
                std::int64_t memory) {
  StreamOptions stream;
  stream.memory = memory;
  stream.store = store;
  StreamedFit streamed =
      files.Explained([&] { return FitStreamed(shared.source(), options, stream); });
  if (!Writes()) return files.ExitCode(streamed.report);
  Take(files, shared, options.shift, streamed);
  return files.Write({streamed.surface},
                     streamed.residuals,
                     streamed.parameters,
                     streamed.outliers,
                     streamed.report);
}

// Flags from which the result does not follow.
const std::set<std::string> kNoneOfTheJob = {"--output",
                                             "--output-format",
                                             "--step-schema",
                                             "--report",
                                             "--beside",
                                             "--certify",
                                             "--certificate",
                                             "--tile-faces",
                                             "--checkpoint",
                                             "--threads",
                                             "--quiet",
                                             "--json"};

}  // namespace

JobWords JobOf(const CLI::App& command) {
  JobWords job = {{"version", Version()}};
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_single_name();
    if (option->count() == 0 || kNoneOfTheJob.contains("--" + name)) continue;
    job[option->get_positional() ? name : "--" + name] =
        fmt::format("{}", fmt::join(option->results(), " "));
  }
  return job;
}

void AddPassArguments(CLI::App& command, PassArguments& a) {
  command
      .add_option_function<std::string>(
          "--memory",
          [&a](const std::string& text) {
            constexpr std::int64_t kLeast = std::int64_t{1} << 25;
            a.memory = ParseBytes("--memory", text, kLeast);
          },
          "Never more than about this: clouds that take more are passed over several times, a "
          "piece in memory at a time (LAS, PLY, PCD, text). 500MB, 2GB [all points in memory]")
      ->type_name("SIZE");
  Suggest(*command
               .add_option("--tiles",
                           a.tiles,
                           "One surface of very many control points, up to 1000000 unless "
                           "--max-control-points says less, in N x M\ntiles, each as fine as its "
                           "points ask for and its neighbours in line; the points are passed over")
               ->type_name("NxM"),
          {"auto"});
  Allow(*command
             .add_option("--tile-faces",
                         a.tile_faces,
                         "Of --tiles, what is written: each (a face for each tile; they join as "
                         "parts of one surface do), one")
             ->capture_default_str()
             ->type_name("FACES"),
        {"each", "one"});
  command
      .add_option(
          "--checkpoint",
          a.checkpoint,
          "With --memory and --tiles: keep finished passes in this folder; the same command "
          "goes on after the\nlast of them, and removes them when it is done")
      ->type_name("DIR");
}

void CheckPassArguments(const PassArguments& a, const FitArguments& fit) {
  if (a.tiles.empty() && a.tile_faces != PassArguments().tile_faces)
    throw UsageError("--tile-faces " + a.tile_faces + ": needs --tiles");
  if (!a.checkpoint.empty() && !a.any())
    throw UsageError("--checkpoint " + a.checkpoint +
                     ": keeps finished passes over the points, which --memory and --tiles make");
  if (a.tiles.empty()) return;
  ToTileOptions(a.tiles);
  if (a.memory)
    throw UsageError(
        "--tiles: takes memory by control points, some 3 kB each, whatever --memory says; "
        "--max-control-points limits them");
  if (fit.loss != "auto" && fit.loss != "none")
    throw UsageError("--loss " + fit.loss +
                     ": --tiles sets outliers aside and weighs the rest alike");
}

TileOptions ToTileOptions(const std::string& text) {
  if (text == "auto") return {};
  TileOptions tiles;
  const char* const end = text.data() + text.size();
  const auto u = std::from_chars(text.data(), end, tiles.count_u);
  const bool two = u.ec == std::errc() && u.ptr != end && (*u.ptr == 'x' || *u.ptr == ',');
  const auto v = std::from_chars(two ? u.ptr + 1 : end, end, tiles.count_v);
  const bool good = two && v.ec == std::errc() && v.ptr == end && tiles.count_u >= 1 &&
                    tiles.count_v >= 1 && std::max(tiles.count_u, tiles.count_v) <= kMostTiles;
  if (!good)
    throw UsageError(fmt::format(
        "--tiles: '{}' is not auto, nor two numbers of tiles NxM from 1 to {}", text, kMostTiles));
  return tiles;
}

int RunPassedOver(FitFiles& files,
                  const FitArguments& fit,
                  SurfaceFitOptions options,
                  const PassArguments& arguments) {
  SharedFiles shared(files, fit.clouds);
  // A local origin is known when the points are.
  if (const auto shift = ToShift(fit.origin)) options.shift = *shift;
  Checkpoint checkpoint(arguments, shared, fit.flags.quiet);
  const int code = arguments.tiles.empty()
                       ? RunStreamed(files, shared, checkpoint.store(), options, *arguments.memory)
                       : RunTiled(files, shared, checkpoint.store(), options, arguments);
  checkpoint.NoteResumed();
  checkpoint.Remove();
  return code;
}

}  // namespace batten::internal
