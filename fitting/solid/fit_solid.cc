// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/distances.h"
#include "batten/fitting/refused_data.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/stage_clock.h"
#include "fitting/neighbours/normals.h"
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
    CheckNear(stencils);
    const std::vector<QuadBlock> blocks =
        options_.merge_faces ? MotorcycleBlocks(mesh) : SingleBlocks(mesh);
    const bool creased = layout_.creases.cols() > 0;
    LimitSurfaceFit surface;
    SolidModel solid;
    // Beside creases faces that fold are kept more even, until they do not.
    constexpr double kMore = 5, kMost = 5;
    double stretch = creased ? kStretchBesideCreases : kStretch;
    for (;; stretch *= kMore) {
      clock_.Enter(&StageSeconds::optimize);
      surface =
          FitLimitSurface(stencils,
                          ControlPointsThrough(mesh, layout_.vertices),
                          data_,
                          {options_.smoothing, options_.max_iterations, options_.progress, stretch},
                          pool_);
      clock_.Enter(&StageSeconds::trim);
      solid = SplineSolid(mesh, surface.control_points, blocks);
      left_out_ = LeftOut(mesh, blocks);
      if (left_out_.empty()) {
        fit_.audit = AuditSolid(solid);
      } else {
        fit_.audit = AuditSolid(solid.Without(left_out_));
      }
      if (!creased || fit_.audit.turn <= kFold || stretch * kMore > kMost) break;
    }
    Judge(solid);
    clock_.Enter(&StageSeconds::project);
    Measure(solid, mesh, blocks, stencils, surface);
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
    const std::vector<LimitFoot> feet =
        FeetOn(surface, stencils.patches(), data_.points, Eigen::Matrix3Xd(3, 0), false, {}, pool_);
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

  // The blocks of caps; empty where there are none.
  std::vector<char> LeftOut(const QuadTopology& mesh, const std::vector<QuadBlock>& blocks) const {
    if (layout_.caps.empty()) return {};
    std::vector<char> left_out(blocks.size(), 0);
    const std::vector<BlockPlace> places = PlacesInBlocks(mesh, blocks);
    for (const int face : layout_.caps) left_out[std::size_t(places[std::size_t(face)].block)] = 1;
    return left_out;
  }

  // What no reader of the solid would notice.
  void Judge(const SolidModel& solid) const {
    const SolidAudit& audit = fit_.audit;
    const bool open = !left_out_.empty();
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

  void Measure(const SolidModel& solid,
               const QuadTopology& mesh,
               const std::vector<QuadBlock>& blocks,
               const LimitStencils& stencils,
               const LimitSurfaceFit& surface) {
    // Feet anew, without regard to normals: what is reported is the distance from the solid.
    const std::vector<LimitFoot> feet = FeetOn(LimitSurface(stencils, surface.control_points),
                                               stencils.patches(),
                                               data_.points,
                                               Eigen::Matrix3Xd(3, 0),
                                               false,
                                               {},
                                               pool_);
    const std::vector<BlockPlace> places = PlacesInBlocks(mesh, blocks);
    Eigen::VectorXd distances(data_.points.cols());
    Eigen::Matrix2Xd parameters(2, distances.size());
    pool_.For(distances.size(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t k = begin; k < end; ++k) {
        const LimitPlace& place = feet[std::size_t(k)].place;
        const BlockPlace& face = places[std::size_t(place.patch >> 2)];
        Eigen::Vector2d at = ParametersInBlock(face, place);
        distances[k] =
            DistanceFrom(solid.faces[std::size_t(face.block)].surface, data_.points.col(k), at);
        parameters.col(k) = at;
      }
    });
    std::vector<int> face_of(feet.size());
    for (std::size_t k = 0; k < feet.size(); ++k)
      face_of[k] = places[std::size_t(feet[k].place.patch >> 2)].block;
    if (!left_out_.empty()) MeasureBeyond(solid, distances, parameters, face_of);
    fit_.residuals.resize(cloud_.size());
    fit_.outliers.resize(cloud_.size());
    fit_.parameters.resize(2, cloud_.size());
    fit_.faces.resize(std::size_t(cloud_.size()));
    for (Eigen::Index k = 0; k < cloud_.size(); ++k) {
      const Eigen::Index merged = place_[std::size_t(k)];
      fit_.residuals[k] = distances[merged];
      fit_.outliers[k] = set_aside_[merged];
      fit_.parameters.col(k) = parameters.col(merged);
      fit_.faces[std::size_t(k)] = face_of[std::size_t(merged)];
    }
  }

  // Points whose feet are on caps have them on the nearest face that stays; faces are numbered
  // without caps.
  void MeasureBeyond(const SolidModel& solid,
                     Eigen::VectorXd& distances,
                     Eigen::Matrix2Xd& parameters,
                     std::vector<int>& face_of) {
    std::vector<Eigen::Index> beyond;
    for (std::size_t k = 0; k < face_of.size(); ++k) {
      if (left_out_[std::size_t(face_of[k])]) beyond.push_back(Eigen::Index(k));
    }
    distances(beyond).setConstant(std::numeric_limits<double>::infinity());
    int number = 0;
    std::vector<int> numbers;
    for (std::size_t f = 0; f < solid.faces.size(); ++f) {
      numbers.push_back(number);
      if (left_out_[f]) continue;
      ++number;
      const NurbsSurface& face = solid.faces[f].surface;
      const Eigen::AlignedBox3d box(face.control_points().rowwise().minCoeff(),
                                    face.control_points().rowwise().maxCoeff());
      std::vector<Eigen::Index> near;
      std::copy_if(beyond.begin(), beyond.end(), std::back_inserter(near), [&](Eigen::Index k) {
        return box.exteriorDistance(data_.points.col(k)) < std::abs(distances[k]);
      });
      if (near.empty()) continue;
      const PointDistances found = DistancesTo(face, data_.points(Eigen::all, near), pool_);
      for (std::size_t i = 0; i < near.size(); ++i) {
        if (!(std::abs(found.distances[Eigen::Index(i)]) < std::abs(distances[near[i]]))) continue;
        distances[near[i]] = found.distances[Eigen::Index(i)];
        parameters.col(near[i]) = found.parameters.col(Eigen::Index(i));
        face_of[std::size_t(near[i])] = static_cast<int>(f);
      }
    }
    for (int& face : face_of) face = numbers[std::size_t(face)];
  }

  // Signed along the normal, from the foot that Newton's method finds from parameters near it. Near
  // extraordinary vertices faces run through space a little differently than the limit surface.
  static double DistanceFrom(const NurbsSurface& surface,
                             const Eigen::Vector3d& q,
                             Eigen::Vector2d& at) {
    const Eigen::Vector2d low(surface.basis_u().lower(), surface.basis_v().lower());
    const Eigen::Vector2d high(surface.basis_u().upper(), surface.basis_v().upper());
    SurfaceJet jet = surface.JetAt(at[0], at[1]);
    for (int step = 0; step < 5; ++step) {
      const Eigen::Vector3d d = q - jet.point;
      Eigen::Matrix2d metric;
      metric << jet.du.squaredNorm(), jet.du.dot(jet.dv), jet.du.dot(jet.dv), jet.dv.squaredNorm();
      const Eigen::Vector2d move = metric.inverse() * Eigen::Vector2d(jet.du.dot(d), jet.dv.dot(d));
      if (!move.allFinite()) break;
      const Eigen::Vector2d next = (at + move).cwiseMax(low).cwiseMin(high);
      const SurfaceJet there = surface.JetAt(next[0], next[1]);
      if (!((there.point - q).norm() < d.norm())) break;
      at = next;
      jet = there;
    }
    const Eigen::Vector3d d = q - jet.point;
    return std::copysign(d.norm(), d.dot(jet.du.cross(jet.dv)));
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
  std::vector<char> left_out_;  // by block: of caps
  SolidFit fit_;
};

}  // namespace

SolidFit FitSolid(const PointCloud& cloud, const QuadMesh& layout, const SolidFitOptions& options) {
  return SolidFitter(cloud, layout, options).Fit();
}

}  // namespace batten
