// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/refused_data.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/stage_clock.h"
#include "fitting/neighbours/normals.h"
#include "fitting/solid/solid_measurement.h"
#include "fitting/solid/surface_fit.h"
#include "geometry/numeric/number_text.h"
#include "geometry/subdivision/spline_faces.h"

namespace batten {
using namespace internal;

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
  constexpr double kDegree = 57.29577951308232;
  return NumberText(std::round(radians * kDegree * 100) / 100) + "°";
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
  constexpr double kGap = 1e-9;  // of the size; construction leaves rounding
  const double size =
      (solid.vertices.rowwise().maxCoeff() - solid.vertices.rowwise().minCoeff()).norm();
  if (audit.gap > kGap * size) throw RefusedData("faces gape by " + NumberText(audit.gap));
}

class SolidFitter {
 public:
  SolidFitter(const PointCloud& cloud, const QuadMesh& layout, const SolidFitOptions& options)
      : cloud_(cloud), options_(options), pool_(options.threads) {
    Check(options);
    fit_.layout = CheckedLayout(layout);
    layout_ = layout;
    layout_.vertices.colwise() -= cloud.origin();
  }

  SolidFit Fit() && {
    Prepare();
    clock_.Enter(&StageSeconds::parameterize);
    const QuadTopology mesh(layout_);
    const LimitStencils stencils(mesh);
    no_feet_ = PatchesOf(layout_.caps, stencils.patches());
    CheckNear(stencils);
    const std::vector<QuadBlock> blocks =
        options_.merge_faces ? MotorcycleBlocks(mesh) : SingleBlocks(mesh);
    const bool creased = layout_.creases.cols() > 0;
    const std::vector<BlockPlace> places = PlacesInBlocks(mesh, blocks);
    left_out_ = CapBlocks(layout_.caps, places, blocks.size());
    LimitSurfaceFit surface;
    SolidModel solid;
    // Beside creases faces that fold are kept more even, until they do not.
    constexpr double kMore = 5, kMost = 5;
    double stretch = creased ? kStretchBesideCreases : kStretch;
    for (;; stretch *= kMore) {
      clock_.Enter(&StageSeconds::optimize);
      surface = FitLimitSurface(
          stencils,
          ControlPointsThrough(mesh, layout_.vertices),
          data_,
          {options_.smoothing, options_.max_iterations, options_.progress, stretch, no_feet_},
          pool_);
      clock_.Enter(&StageSeconds::trim);
      solid = SplineSolid(mesh, surface.control_points, blocks);
      fit_.audit = AuditSolid(left_out_.empty() ? solid : solid.Without(left_out_));
      if (!creased || fit_.audit.turn <= kFold || stretch * kMore > kMost) break;
    }
    RefuseUnsound(solid, fit_.audit, !left_out_.empty());
    clock_.Enter(&StageSeconds::project);
    Measure(solid, places, stencils, surface);
    Finish(left_out_.empty() ? std::move(solid) : solid.Without(left_out_), surface);
    return std::move(fit_);
  }

 private:
  void Prepare() {
    const MergedCloud merged = MergeDuplicates(cloud_);
    place_ = merged.place;
    data_.points = merged.cloud.points();
    const auto count = data_.points.cols();
    data_.weights =
        merged.cloud.weights().size() > 0 ? merged.cloud.weights() : Eigen::VectorXd::Ones(count);
    // Every control point asks for a point, so that none is left to the fairness alone.
    if (count < layout_.vertices.cols()) {
      throw RefusedData("there are " + std::to_string(count) + " different points for " +
                        std::to_string(layout_.vertices.cols()) +
                        " vertices of the layout: a coarser layout is needed");
    }
    const NeighbourIndex index(data_.points, pool_);
    const CloudStatistics statistics =
        MeasureCloud(data_.points,
                     index,
                     {.seed = options_.seed, .find_outliers = !options_.keep_outliers},
                     pool_,
                     options_.progress);
    TakeNormals(merged.cloud, index, data_);
    data_.noise = statistics.noise;
    set_aside_ = PointMask::Constant(count, false);
    if (statistics.outliers.size() == count) set_aside_ = statistics.outliers;
    for (Eigen::Index k = 0; k < count; ++k) {
      if (set_aside_[k]) data_.weights[k] = 0;
    }
    InputSummary& input = fit_.report.input;
    input.points = cloud_.size();
    input.duplicates = merged.duplicates;
    input.spacing = statistics.spacing;
    input.noise = statistics.noise;
    input.origin = cloud_.origin();
    input.box_min = data_.points.rowwise().minCoeff() + cloud_.origin();
    input.box_max = data_.points.rowwise().maxCoeff() + cloud_.origin();
  }

  // Refuses a layout of another body, or in other coordinates; turns normals that point inwards.
  void CheckNear(const LimitStencils& stencils) {
    const LimitSurface surface(stencils, layout_.vertices);
    const std::vector<LimitFoot> feet = FeetOn({surface, stencils.patches(), no_feet_},
                                               data_.points,
                                               Eigen::Matrix3Xd(3, 0),
                                               false,
                                               {},
                                               pool_);
    std::vector<double> distances;
    double outwards = 0;
    for (std::size_t k = 0; k < feet.size(); ++k) {
      distances.push_back((feet[k].point - data_.points.col(Eigen::Index(k))).norm());
      outwards += feet[k].normal.dot(data_.normals.col(Eigen::Index(k)));
    }
    if (data_.oriented && outwards < 0) data_.normals *= -1;
    const auto middle = distances.begin() + std::ptrdiff_t(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    const double size = (fit_.report.input.box_max - fit_.report.input.box_min).maxCoeff();
    if (!(*middle <= kApart * size)) {
      throw RefusedData("the layout lies apart from the points: half of them are farther than " +
                        NumberText(*middle) +
                        " from it; it has to be in the same coordinates, and fine enough for the "
                        "shape");
    }
  }

  void Measure(const SolidModel& solid,
               const std::vector<BlockPlace>& places,
               const LimitStencils& stencils,
               const LimitSurfaceFit& surface) {
    const LimitSurface fitted(stencils, surface.control_points);
    const NearestSurfaces found = MeasureSolid(
        solid, places, {fitted, stencils.patches(), no_feet_}, left_out_, data_.points, pool_);
    fit_.residuals = found.distances(place_);
    fit_.parameters = found.parameters(Eigen::all, place_);
    fit_.outliers = set_aside_(place_);
    for (const Eigen::Index merged : place_)
      fit_.faces.push_back(found.surface[std::size_t(merged)]);
  }

  void Finish(const SolidModel& solid, const LimitSurfaceFit& surface) {
    const Eigen::Vector3d shift = cloud_.origin() - options_.shift;
    fit_.solid = shift.isZero() ? solid : solid.Translated(shift);
    fit_.audit.edge_angle_at += shift;
    fit_.held_out = surface.held_out;
    fit_.control_mesh = layout_;
    fit_.control_mesh.vertices = surface.control_points.colwise() + shift;
    FitReport& report = fit_.report;
    report.input.outliers = fit_.outliers.count();
    report.input.used = cloud_.size() - report.input.outliers;
    const PointMask used = !fit_.outliers;
    report.error = Summarise(fit_.residuals, options_.tolerance, used);
    report.error_all = Summarise(fit_.residuals, options_.tolerance);
    report.geometry.kind = left_out_.empty() ? "solid" : "shell";
    report.geometry.degree = {3, 3};
    report.geometry.control_points = {static_cast<int>(surface.control_points.cols())};
    report.geometry.closed = {left_out_.empty(), left_out_.empty()};
    const SolidAudit& audit = fit_.audit;
    report.geometry.creases = {
        audit.sharp_edges, audit.sharp_length, audit.least_sharp, audit.greatest_sharp};
    report.iterations = surface.rounds;
    report.threads = pool_.threads();
    const bool kept = report.error.out_of_tolerance == 0;
    const bool noise = report.error.rms <= 1.2 * report.input.noise;
    // Noise may be wider than dense points are apart.
    const bool far = !noise && report.error.p95 > report.input.spacing;
    constexpr const char* kFar =
        "one point in twenty is farther from the solid than points are from one another: the "
        "layout is too coarse, or of another shape";
    if (options_.tolerance && kept) {
      report.end = {EndCode::kToleranceReached, "every point is within the tolerance"};
    } else if (noise) {
      report.end = {EndCode::kNoiseReached, "the residuals are the noise of the points"};
    } else if (far) {
      Eigen::Index farthest = 0;
      used.select(fit_.residuals.array().abs(), 0).maxCoeff(&farthest);
      report.end = {EndCode::kStructuredResiduals, kFar, cloud_.World(farthest)};
    } else {
      report.end = {EndCode::kCrossValidated,
                    "softer surfaces over this layout do not meet points left out better; a finer "
                    "layout may"};
    }
    report.termination = TerminationOf(report.end.code);
    if (far) report.warnings.push_back(kFar);
    report.seconds = clock_.Seconds();
  }

  const PointCloud& cloud_;
  const SolidFitOptions& options_;
  ThreadPool pool_;
  StageClock clock_;
  QuadMesh layout_;  // relative to the cloud's origin
  SurfaceData data_;
  std::vector<Eigen::Index> place_;
  PointMask set_aside_;
  std::vector<char> no_feet_, left_out_;  // by patch, by block: of caps
  SolidFit fit_;
};

}  // namespace

SolidFit FitSolid(const PointCloud& cloud, const QuadMesh& layout, const SolidFitOptions& options) {
  return SolidFitter(cloud, layout, options).Fit();
}

}  // namespace batten
