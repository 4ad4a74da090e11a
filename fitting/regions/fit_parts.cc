// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "batten/fitting/fit_surface.h"
#include "batten/fitting/refused_data.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/fit_end.h"
#include "fitting/core/stage_clock.h"
#include "fitting/foot_points/nearest_surface.h"
#include "fitting/primitives/surface_patch.h"
#include "fitting/primitives/surface_primitive.h"
#include "fitting/regions/close_solid.h"
#include "fitting/regions/face_relations.h"
#include "fitting/regions/find_regions.h"
#include "fitting/regions/free_pieces.h"
#include "fitting/regions/region_face.h"
#include "fitting/regions/settle_regions.h"
#include "fitting/regions/turned_joins.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;

namespace {

constexpr int kFewestFree = 60;  // points that carry a free surface of some control points

// A face with its points, before faces are put in order.
struct MadeFace {
  PartFace face;
  FaceSummary summary;
  std::vector<int> points;  // of the merged cloud
  Eigen::VectorXd residuals;
  Eigen::Matrix2Xd parameters;
  int shape = -1;  // the number of its fit; of free ones none
};

class PartFitter {
 public:
  PartFitter(const PointCloud& cloud, const PartFitOptions& options)
      : cloud_(cloud),
        options_(options),
        pool_(options.threads),
        move_(cloud.origin() - options.shift) {}

  PartsFit Fit() && {
    Prepare();
    clock_.Enter(&StageSeconds::solve);
    found_ =
        FindRegions(data_, options_.tolerance.value_or(0) / data_.unit, options_.progress, pool_);
    FitShapes();
    clock_.Enter(&StageSeconds::optimize);
    Relate();
    clock_.Enter(&StageSeconds::trim);
    for (std::size_t k = 0; k < shapes_.size(); ++k) {
      made_.push_back(Covered(shapes_[k]));
      made_.back().shape = static_cast<int>(k);
    }
    if (options_.free_form) FitLeftovers();
    if (made_.empty()) {
      throw RefusedData(
          "no face is found: no thirty neighbouring points lie on one plane, sphere, cylinder, "
          "cone or torus to within their noise of " +
          RoundedText(data_.unit * data_.noise) + "; a tolerance may say how far off they may be");
    }
    clock_.Enter(&StageSeconds::project);
    Assemble();
    if (options_.solid) MakeSolid();
    FinishReport();
    return std::move(result_);
  }

 private:
  void Prepare() {
    Report(options_.progress, "prepare", 0);
    merged_ = MergeDuplicates(cloud_);
    if (merged_.cloud.size() < kFewestPoints) {
      throw RefusedData("parts are found from " + std::to_string(kFewestPoints) +
                        " different points on; there are " + std::to_string(merged_.cloud.size()));
    }
    data_ = MakeRegionPoints(merged_.cloud, options_.seed, pool_);
    // Within a tolerance that is given a shape may miss what it misses.
    if (options_.tolerance) data_.most_trend = 1;
    InputSummary& input = result_.report.input;
    input.points = cloud_.size();
    input.duplicates = merged_.duplicates;
    input.origin = cloud_.origin();
    input.spacing = data_.unit * data_.spacing;
    input.box_min = cloud_.origin() + cloud_.points().rowwise().minCoeff();
    input.box_max = cloud_.origin() + cloud_.points().rowwise().maxCoeff();
  }

  void FitShapes() {
    const RegionLabels& labels = found_.labels;
    for (std::size_t k = 0; k < labels.regions.size(); ++k) {
      Report(options_.progress, "faces", double(k) / double(labels.regions.size()));
      const Region& region = labels.regions[k];
      auto face = FittedFace(data_,
                             region.shape,
                             region.points,
                             CorePoints(data_, labels, static_cast<int>(k), found_.sigma),
                             move_,
                             options_.seed,
                             pool_);
      if (face && Determined(*face)) {
        shapes_.push_back(std::move(*face));
        continue;
      }
      for (const int point : region.points) found_.labels.label[std::size_t(point)] = kNoRegion;
    }
  }

  // Whether the points tell radii and angles to a third, directions to 11°: else any other shape
  // would do as well.
  static bool Determined(const RegionFace& face) {
    constexpr double kVague = 1.0 / 3, kVagueAngle = 0.2;
    const PrimitiveSummary& p = face.numbers;
    const auto told = [&](const char* name, const std::optional<double>& value) {
      return !value || p.accuracy->Deviation(name) <= kVague * *value;
    };
    const auto turned = [&](const char* name, const std::optional<Eigen::Vector3d>& value) {
      return !value || p.accuracy->Deviation(name) <= kVagueAngle;
    };
    return turned("normal", p.normal) && turned("axis", p.axis) && told("radius", p.radius) &&
           told("major_radius", p.major_radius) && told("minor_radius", p.minor_radius) &&
           told("half_angle", p.half_angle);
  }

  RegionLabels LabelsOf(const std::vector<int>& faces) const {
    RegionLabels labels;
    labels.label.assign(std::size_t(data_.size()), kNoRegion);
    for (const int number : faces) {
      const RegionFace& face = shapes_[std::size_t(number)];
      for (const int point : face.points)
        labels.label[std::size_t(point)] = static_cast<int>(labels.regions.size());
      labels.regions.push_back({face.shape, face.points});
    }
    return labels;
  }

  void Relate() {
    std::vector<int> all(shapes_.size());
    std::iota(all.begin(), all.end(), 0);
    const std::vector<FaceJoin> joins = SmoothJoins(data_, LabelsOf(all));
    relations_ = FindRelations(data_, shapes_, joins, pool_);
    if (!options_.regularise) return;
    std::vector<FittedSurface> related = ShapesUnder(data_, shapes_, relations_, pool_);
    if (TurnBeside(data_, joins, found_.sigma, related, shapes_, relations_))
      related = ShapesUnder(data_, shapes_, relations_, pool_);
    for (std::size_t k = 0; k < shapes_.size(); ++k)
      TakeShape(data_, related[k], move_, shapes_[k]);
  }

  MadeFace Covered(const RegionFace& face) {
    std::vector<std::string> warnings = face.warnings;
    MadeFace made{CoveredFace(data_, face, move_, warnings, pool_), {}, face.points, {}, {}};
    const Eigen::Matrix3Xd points = data_.points(Eigen::all, face.points);
    const ExactSurface local = internal::Placed(*made.face.patch, 1, -data_.middle - move_);
    made.parameters = FootPointsOn(local, data_.unit * points, pool_);
    made.residuals = data_.unit * SurfaceDistances(face.shape, points, pool_);
    if (!LooksAlike(face.shape, *made.face.patch)) made.residuals *= -1;
    made.summary.kind = face.numbers.kind;
    made.summary.primitive = face.numbers;
    for (std::string& warning : warnings) {
      result_.report.warnings.push_back(made.summary.kind + " of " +
                                        std::to_string(face.points.size()) + " points: " + warning);
    }
    return made;
  }

  void FitLeftovers() {
    for (std::vector<int>& piece : SmoothLeftovers(data_, found_.labels.label, kFewestFree)) {
      const std::vector<Eigen::Index> indices(piece.begin(), piece.end());
      SurfaceFitOptions free;
      free.tolerance = options_.tolerance;
      free.shift = options_.shift;
      free.seed = options_.seed;
      free.threads = options_.threads;
      free.progress = options_.progress;
      try {
        SurfaceFit fit = FitSurface(merged_.cloud.Picked(indices), free);
        if (fit.report.leaves_points()) {
          result_.report.warnings.push_back("a free face of " + std::to_string(piece.size()) +
                                            " points: " + WordsOfLeaving(fit.report));
        }
        made_.push_back({{FreeForm(), std::nullopt, std::move(fit.surface)},
                         {"free"},
                         std::move(piece),
                         std::move(fit.residuals),
                         fit.parameters});
      } catch (const RefusedData& refusal) {
        result_.report.warnings.push_back("a smooth region of " + std::to_string(piece.size()) +
                                          " points has no face: " + refusal.what());
      }
    }
  }

  // Faces by falling number of points, and what every point is on.
  void Assemble() {
    std::stable_sort(made_.begin(), made_.end(), [](const MadeFace& a, const MadeFace& b) {
      return a.points.size() > b.points.size();
    });
    const Eigen::Index count = merged_.cloud.size();
    RegionLabels labels;
    labels.label.assign(std::size_t(count), kNoRegion);
    Eigen::VectorXd residuals(count);
    Eigen::Matrix2Xd parameters = Eigen::Matrix2Xd::Zero(2, count);
    for (std::size_t k = 0; k < made_.size(); ++k) {
      MadeFace& made = made_[k];
      for (std::size_t i = 0; i < made.points.size(); ++i) {
        const int point = made.points[i];
        labels.label[std::size_t(point)] = static_cast<int>(k);
        residuals[point] = made.residuals[Eigen::Index(i)];
        parameters.col(point) = made.parameters.col(Eigen::Index(i));
      }
      made.summary.points = std::ssize(made.points);
      made.summary.rms =
          std::sqrt(made.residuals.squaredNorm() / static_cast<double>(made.points.size()));
      made.summary.max = made.residuals.cwiseAbs().maxCoeff();
      labels.regions.push_back({{}, std::move(made.points)});
      result_.faces.push_back(std::move(made.face));
    }
    const auto touching = TouchingRegions(data_, labels);
    constexpr int kBorder = 3;  // pairs: fewer are points across a corner
    for (std::size_t k = 0; k < made_.size(); ++k) {
      for (const auto& [other, pairs] : touching[k]) {
        if (pairs >= kBorder) made_[k].summary.touching.push_back(other);
      }
      result_.summary.faces.push_back(std::move(made_[k].summary));
    }
    SummariseRelations();
    std::vector<int> owners = labels.label;
    MeasureOthers(labels.label, residuals, parameters, owners);
    Spread(labels.label, residuals, parameters, owners);
  }

  void SummariseRelations() {
    std::vector<int> face_of(shapes_.size(), -1);
    for (std::size_t k = 0; k < made_.size(); ++k) {
      if (made_[k].shape >= 0) face_of[std::size_t(made_[k].shape)] = static_cast<int>(k);
    }
    // One entry for all that have a relation to the same face; of its members the farthest off.
    std::map<std::pair<RelationKind, int>, RelationSummary> groups;
    for (const FaceRelation& relation : relations_) {
      const bool angle =
          relation.kind == RelationKind::kParallel || relation.kind == RelationKind::kPerpendicular;
      const double unit = angle ? 1 : data_.unit;
      RelationSummary& group = groups[{relation.kind, relation.first}];
      const bool pair =
          relation.kind == RelationKind::kPerpendicular || relation.kind == RelationKind::kTangent;
      if (group.faces.empty() || pair) {
        group = {
            Name(relation.kind), {face_of[std::size_t(relation.first)]}, 0, 1, options_.regularise};
      }
      group.faces.push_back(face_of[std::size_t(relation.second)]);
      if (relation.deviation * group.allowed >= group.deviation * relation.allowed) {
        group.deviation = unit * relation.deviation;
        group.allowed = unit * relation.allowed;
      }
      if (pair) result_.summary.relations.push_back(group);
    }
    for (auto& [key, group] : groups) {
      if (key.first != RelationKind::kPerpendicular && key.first != RelationKind::kTangent)
        result_.summary.relations.push_back(std::move(group));
    }
  }

  void MakeSolid() {
    std::vector<int> numbers, place(shapes_.size());
    for (const MadeFace& made : made_) {
      if (made.shape < 0) {
        result_.no_solid = "face " + std::to_string(numbers.size()) + " is free";
        return;
      }
      place[std::size_t(made.shape)] = static_cast<int>(numbers.size());
      numbers.push_back(made.shape);
    }
    std::map<FacePair, FittedSurface> contacts;
    for (const FaceRelation& relation : relations_) {
      if (relation.kind != RelationKind::kTangent || !options_.regularise) continue;
      const auto a = std::size_t(relation.first), b = std::size_t(relation.second);
      contacts[std::minmax(place[a], place[b])] =
          NormalsAlong(relation.contact, shapes_[a].shape, shapes_[b].shape);
    }
    ClosedSolid closed =
        CloseSolid(data_, LabelsOf(numbers), contacts, found_.sigma, options_.most_invented, move_);
    result_.bodies = closed.shells;
    result_.genus = closed.genus;
    result_.invented = closed.invented;
    result_.solid = std::move(closed.solid);
    result_.no_solid = std::move(closed.refused);
  }

  // Points of no face are measured from the nearest.
  void MeasureOthers(const std::vector<int>& label,
                     Eigen::VectorXd& residuals,
                     Eigen::Matrix2Xd& parameters,
                     std::vector<int>& owners) {
    std::vector<int> others;
    for (std::size_t k = 0; k < label.size(); ++k) {
      if (label[k] == kNoRegion) others.push_back(static_cast<int>(k));
    }
    if (others.empty()) return;
    std::vector<NurbsSurface> faces;
    for (const PartFace& face : result_.faces) faces.push_back(face.surface.Translated(-move_));
    const NearestSurfaces nearest =
        NearestOf(faces, merged_.cloud.points()(Eigen::all, others), pool_);
    residuals(others) = nearest.distances;
    parameters(Eigen::all, others) = nearest.parameters;
    for (std::size_t i = 0; i < others.size(); ++i)
      owners[std::size_t(others[i])] = nearest.surface[i];
  }

  // From the merged points to all.
  void Spread(const std::vector<int>& label,
              const Eigen::VectorXd& residuals,
              const Eigen::Matrix2Xd& parameters,
              const std::vector<int>& owners) {
    const auto& place = merged_.place;
    result_.residuals = residuals(place);
    result_.parameters = parameters(Eigen::all, place);
    for (const Eigen::Index at : place) {
      result_.labels.push_back(label[std::size_t(at)]);
      result_.owners.push_back(owners[std::size_t(at)]);
    }
  }

  void FinishReport() {
    FitReport& report = result_.report;
    PointMask used(cloud_.size());
    for (Eigen::Index k = 0; k < used.size(); ++k) used[k] = result_.labels[std::size_t(k)] >= 0;
    report.error = Summarise(result_.residuals, options_.tolerance, used);
    report.error_all = Summarise(result_.residuals, options_.tolerance);
    report.input.used = used.count();
    report.input.outliers = cloud_.size() - report.input.used;
    report.input.noise = data_.unit * found_.sigma;
    report.threads = pool_.threads();
    report.geometry.kind = "face";
    report.geometry.count = static_cast<int>(result_.faces.size());
    for (const PartFace& face : result_.faces) {
      report.geometry.trims += static_cast<int>(face.surface.trims().size());
    }
    JudgeEnd({.noise = report.input.noise, .rounding = data_.unit * data_.rounding}, report);
    report.seconds = clock_.Seconds();
  }

  const PointCloud& cloud_;
  const PartFitOptions& options_;
  ThreadPool pool_;
  const Eigen::Vector3d move_;
  StageClock clock_;
  MergedCloud merged_;
  RegionPoints data_;
  FoundRegions found_;
  std::vector<RegionFace> shapes_;
  std::vector<FaceRelation> relations_;
  std::vector<MadeFace> made_;
  PartsFit result_;
};

}  // namespace

PartsFit FitParts(const PointCloud& cloud, const PartFitOptions& options) {
  Check(options);
  if (cloud.dimension() == 2) throw RefusedData("points of the plane are of no faces");
  return PartFitter(cloud, options).Fit();
}

}  // namespace batten
