// SPDX-License-Identifier: MIT
#include "fitting/solid/solid_fitter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/refused_data.h"
#include "fitting/core/input_summary.h"
#include "fitting/core/rounding.h"
#include "fitting/neighbours/normals.h"
#include "fitting/solid/solid_measurement.h"
#include "fitting/solid/surface_refinement.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr int kNormalNeighbours = 12;
// Beyond this share of the size a layout belongs to something else.
constexpr double kApart = 0.1;
// Normals a sample apart that turn by more are a fold: sound faces stay below 60°.
constexpr double kFold = 1.5;  // radians

QuadMeshSummary CheckedLayout(const QuadMesh& layout) {
  try {
    return CheckQuadMesh(layout);
  } catch (const std::invalid_argument& refusal) {
    throw RefusedData(std::string("the layout can't be used: ") + refusal.what());
  }
}

std::string Degrees(double radians) {
  return NumberText(std::round(radians * (180 / std::numbers::pi) * 100) / 100) + "°";
}

// Normals of the cloud, or planes through neighbours where it has none.
void TakeNormals(const PointCloud& cloud, const NeighbourIndex& index, SurfaceData& data) {
  if (cloud.normals().cols() == cloud.size() && !cloud.normals().isZero()) {
    data.normals = cloud.normals();
    for (Eigen::Index k = 0; k < data.normals.cols(); ++k) data.normals.col(k).stableNormalize();
    data.oriented = true;
    return;
  }
  data.normals = EstimateNormals(index, data.points, data.points, kNormalNeighbours);
}

// Refuses what no reader of the solid would notice.
void RefuseUnsound(const SolidModel& solid, const SolidAudit& audit, bool open) {
  if (audit.open_edges > 0 && !open) {
    throw RefusedData(std::to_string(audit.open_edges) + " edges do not belong to two faces");
  }
  if (!(open || audit.volume > 0)) throw RefusedData("the faces do not enclose a volume");
  if (audit.turn > kFold) {
    throw RefusedData("a face folds over (normals turn by " + Degrees(audit.turn) +
                      " from one sample to the next): the layout is too coarse or uneven there");
  }
  constexpr double kSmooth = 1e-3;  // radians; construction leaves rounding
  if (audit.edge_angle > kSmooth) {
    throw RefusedData("faces meet at an angle of " + Degrees(audit.edge_angle) + " at an edge");
  }
  const double size =
      (solid.vertices.rowwise().maxCoeff() - solid.vertices.rowwise().minCoeff()).norm();
  if (audit.gap > kRelativelyEqual * size)
    throw RefusedData("faces gape by " + NumberText(audit.gap));
}

SolidPoints Prepared(const PointCloud& cloud,
                     Eigen::Index least,
                     const SolidFitOptions& options,
                     ThreadPool& pool) {
  MergedCloud merged = MergeDuplicates(cloud);
  SolidPoints points;
  SurfaceData& data = points.data;
  data.points = merged.cloud.points();
  const auto count = data.points.cols();
  data.weights =
      merged.cloud.weights().size() > 0 ? merged.cloud.weights() : Eigen::VectorXd::Ones(count);
  // Every control point asks for a point, so that none is left to the fairness alone.
  if (count < least) {
    throw RefusedData("there are " + std::to_string(count) + " different points for " +
                      std::to_string(least) +
                      " vertices of the layout: a coarser layout is needed");
  }
  const NeighbourIndex index(data.points, pool);
  const CloudStatistics statistics =
      MeasureCloud(data.points,
                   index,
                   {.seed = options.seed, .find_outliers = !options.keep_outliers},
                   pool,
                   options.progress);
  TakeNormals(merged.cloud, index, data);
  data.noise = statistics.noise;
  data.left_out = EveryTenth(count);
  points.set_aside = PointMask::Constant(count, false);
  if (statistics.outliers.size() == count) points.set_aside = statistics.outliers;
  data.weights = points.set_aside.select(0, data.weights.array());
  points.place = std::move(merged.place);
  points.input = SummariseInput(cloud, merged.duplicates, statistics.spacing, statistics.noise);
  return points;
}

// Refuses a layout of another body, or in other coordinates; turns normals that point inwards.
void CheckNear(const FootGround& ground, SolidPoints& points, ThreadPool& pool) {
  SurfaceData& data = points.data;
  const std::vector<LimitFoot> feet =
      FeetOn(ground, data.points, Eigen::Matrix3Xd(3, 0), false, {}, pool);
  std::vector<double> distances;
  double outwards = 0;
  for (std::size_t k = 0; k < feet.size(); ++k) {
    distances.push_back((feet[k].point - data.points.col(Eigen::Index(k))).norm());
    outwards += feet[k].normal.dot(data.normals.col(Eigen::Index(k)));
  }
  if (data.oriented && outwards < 0) data.normals *= -1;
  const auto middle = distances.begin() + std::ptrdiff_t(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double size = (points.input.box_max - points.input.box_min).maxCoeff();
  if (!(*middle <= kApart * size)) {
    throw RefusedData("the layout lies apart from the points: half of them are farther than " +
                      NumberText(*middle) +
                      " from it; it has to be in the same coordinates, and fine enough for the "
                      "shape");
  }
}

// The solid of a shape's surface, and what it is like.
void MakeSolid(SolidShape& shape) {
  const QuadTopology& mesh = shape.stencils.mesh();
  shape.left_out = CapBlocks(shape.caps, PlacesInBlocks(mesh, shape.blocks), shape.blocks.size());
  shape.solid = SplineSolid(mesh, shape.surface.control_points, shape.blocks, shape.refinements);
  shape.audit =
      AuditSolid(shape.left_out.empty() ? shape.solid : shape.solid.Without(shape.left_out));
}

// The control mesh of a shape.
QuadMesh MeshOf(const SolidShape& shape, const Eigen::Vector3d& shift) {
  const QuadTopology& topology = shape.stencils.mesh();
  QuadMesh mesh;
  mesh.vertices = shape.surface.control_points.colwise() + shift;
  mesh.faces = topology.corners();
  std::vector<int> ends;
  for (int h = 0; h < topology.half_edges(); ++h) {
    if (!topology.IsCrease(h) || topology.Twin(h) < h) continue;
    ends.insert(ends.end(), {topology.Origin(h), topology.Origin(QuadTopology::Next(h))});
  }
  mesh.creases = Eigen::Map<const Eigen::Matrix2Xi>(ends.data(), 2, Eigen::Index(ends.size() / 2));
  for (int v = 0; v < topology.vertices(); ++v) {
    if (topology.corner_marks()[std::size_t(v)]) mesh.corners.push_back(v);
  }
  mesh.caps = shape.caps;
  return mesh;
}

void JudgeEnd(const PointCloud& cloud, const SolidFitOptions& options, SolidFit& fit) {
  FitReport& report = fit.report;
  const PointMask used = !fit.outliers;
  const bool kept = report.error.out_of_tolerance == 0;
  const bool noise = report.error.rms <= 1.2 * report.input.noise;
  // Noise may be wider than dense points are apart.
  const bool far = !noise && report.error.p95 > report.input.spacing;
  constexpr const char* kFar =
      "one point in twenty is farther from the solid than points are from one another: the "
      "layout is too coarse, or of another shape";
  if (options.tolerance && kept) {
    report.end = {EndCode::kToleranceReached, "every point is within the tolerance"};
  } else if (noise) {
    report.end = {EndCode::kNoiseReached, "the residuals are the noise of the points"};
  } else if (far) {
    Eigen::Index farthest = 0;
    used.select(fit.residuals.array().abs(), 0).maxCoeff(&farthest);
    report.end = {EndCode::kStructuredResiduals, kFar, cloud.World(farthest)};
  } else {
    report.end = {EndCode::kCrossValidated,
                  "softer surfaces over this layout do not meet points left out better; a finer "
                  "layout may"};
  }
  report.termination = TerminationOf(report.end.code);
  if (far) report.warnings.push_back(kFar);
}

}  // namespace

SolidFitter::SolidFitter(const PointCloud& cloud,
                         const QuadMesh& layout,
                         const SolidFitOptions& options)
    : cloud_(cloud), options_(options), pool_(options.threads) {
  Check(options);
  fit_.layout = CheckedLayout(layout);
  points_ = Prepared(cloud, layout.vertices.cols(), options, pool_);
  shape_ = CoarseShape(layout);
  RefuseUnsound(shape_->solid, shape_->audit, !shape_->caps.empty());
  Finish();
}

SurfaceFitSettings SolidFitter::Settings(const SolidShape& shape) const {
  return {options_.smoothing, options_.max_iterations, options_.progress, stretch_, shape.no_feet};
}

SolidShape SolidFitter::CoarseShape(const QuadMesh& layout) {
  clock_.Enter(&StageSeconds::parameterize);
  const QuadTopology mesh(layout);
  SolidShape shape{LimitStencils(mesh),
                   {},
                   options_.merge_faces ? MotorcycleBlocks(mesh) : SingleBlocks(mesh),
                   layout.caps};
  shape.free = mesh.vertices();
  const Eigen::Matrix3Xd vertices = layout.vertices.colwise() - cloud_.origin();
  shape.no_feet = PatchesOf(layout.caps, shape.stencils.patches());
  CheckNear({LimitSurface(shape.stencils, vertices), shape.stencils.patches(), shape.no_feet},
            points_,
            pool_);
  const bool creased = layout.creases.cols() > 0;
  // Beside creases faces that fold are kept more even, until they do not.
  constexpr double kMore = 5, kMost = 5;
  stretch_ = creased ? kStretchBesideCreases : kStretch;
  for (;; stretch_ *= kMore) {
    clock_.Enter(&StageSeconds::optimize);
    shape.surface = FitLimitSurface(
        shape.stencils, ControlPointsThrough(mesh, vertices), points_.data, Settings(shape), pool_);
    clock_.Enter(&StageSeconds::trim);
    MakeSolid(shape);
    if (!creased || shape.audit.turn <= kFold || stretch_ * kMore > kMost) return shape;
  }
}

bool SolidFitter::Refine() {
  constexpr int kTries = 6;
  const CoarseSurface coarse{shape_->stencils, shape_->surface, points_.data, shape_->caps};
  std::vector<char> barred;
  for (int round = 0; round < kTries; ++round) {
    clock_.Enter(&StageSeconds::optimize);
    auto finer = RefineSurface(coarse, barred, options_.tolerance, Settings(*shape_), pool_);
    if (!finer) return false;
    SolidShape shape{std::move(finer->stencils),
                     std::move(finer->fit),
                     SubdividedBlocks(shape_->blocks),
                     std::move(finer->caps),
                     shape_->refinements - 1,
                     shape_->free + finer->free};
    shape.no_feet = PatchesOf(shape.caps, shape.stencils.patches());
    std::vector<RoundSummary> rounds = shape_->surface.rounds;
    rounds.insert(rounds.end(), shape.surface.rounds.begin(), shape.surface.rounds.end());
    shape.surface.rounds = std::move(rounds);
    clock_.Enter(&StageSeconds::trim);
    MakeSolid(shape);
    if (shape.audit.turn > kFold) {
      // What folds stays as it is.
      if (!BarAbout(coarse, shape.audit.turn_at, pool_, barred)) return false;
      continue;
    }
    RefuseUnsound(shape.solid, shape.audit, !shape.caps.empty());
    shape_ = std::move(shape);
    return true;
  }
  return false;
}

SolidFit SolidFitter::Refined() && {
  clock_ = StageClock(&StageSeconds::optimize);
  const StageSeconds before = fit_.report.seconds;
  bool finer = false, cancelled = false;
  try {
    while (!options_.smoothing && shape_->refinements > 0 && Refine()) finer = true;
  } catch (const Cancelled&) {
    cancelled = true;
  } catch (const RefusedData&) {
    // What is there stays.
  }
  if (finer) Finish();
  if (cancelled) fit_.report.termination = Termination::kCancelled;
  fit_.report.seconds = before;
  fit_.report.seconds += clock_.Seconds();
  return std::move(fit_);
}

void SolidFitter::Finish() {
  const SolidShape& shape = *shape_;
  const bool open = !shape.caps.empty();
  clock_.Enter(&StageSeconds::project);
  const LimitSurface fitted(shape.stencils, shape.surface.control_points);
  const NearestSurfaces found = MeasureSolid(shape.solid,
                                             PlacesInBlocks(shape.stencils.mesh(), shape.blocks),
                                             shape.refinements,
                                             {fitted, shape.stencils.patches(), shape.no_feet},
                                             shape.left_out,
                                             points_.data.points,
                                             pool_);
  fit_.residuals = found.distances(points_.place);
  fit_.parameters = found.parameters(Eigen::all, points_.place);
  fit_.outliers = points_.set_aside(points_.place);
  fit_.faces.clear();
  for (const Eigen::Index merged : points_.place)
    fit_.faces.push_back(found.surface[std::size_t(merged)]);

  const Eigen::Vector3d shift = cloud_.origin() - options_.shift;
  fit_.solid = open ? shape.solid.Without(shape.left_out) : shape.solid;
  if (!shift.isZero()) fit_.solid = fit_.solid.Translated(shift);
  fit_.audit = shape.audit;
  fit_.audit.edge_angle_at += shift;
  fit_.audit.turn_at += shift;
  fit_.held_out = shape.surface.held_out;
  fit_.control_mesh = MeshOf(shape, shift);
  FitReport& report = fit_.report;
  report = {};
  report.input = points_.input;
  report.input.outliers = fit_.outliers.count();
  report.input.used = cloud_.size() - report.input.outliers;
  report.error = Summarise(fit_.residuals, options_.tolerance, !fit_.outliers);
  report.error_all = Summarise(fit_.residuals, options_.tolerance);
  report.geometry.kind = open ? "shell" : "solid";
  report.geometry.degree = {3, 3};
  report.geometry.control_points = {static_cast<int>(shape.free)};
  report.geometry.closed = {!open, !open};
  const SolidAudit& audit = fit_.audit;
  report.geometry.creases = {
      audit.sharp_edges, audit.sharp_length, audit.least_sharp, audit.greatest_sharp};
  report.iterations = shape.surface.rounds;
  report.threads = pool_.threads();
  JudgeEnd(cloud_, options_, fit_);
  report.seconds = clock_.Seconds();
}

}  // namespace batten::internal
