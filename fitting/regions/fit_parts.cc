// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "batten/fitting/point_mask.h"
#include "batten/fitting/refused_data.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/fit_end.h"
#include "fitting/core/input_summary.h"
#include "fitting/core/stage_clock.h"
#include "fitting/foot_points/nearest_surface.h"
#include "fitting/regions/close_solid.h"
#include "fitting/regions/face_relations.h"
#include "fitting/regions/find_regions.h"
#include "fitting/regions/free_pieces.h"
#include "fitting/regions/made_face.h"
#include "fitting/regions/region_face.h"
#include "fitting/regions/relation_summary.h"
#include "fitting/regions/settle_regions.h"
#include "fitting/regions/turned_joins.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;

namespace {

constexpr int kFewestFree = 60;  // points that carry a free surface of some control points

MergedCloud DifferentPoints(const PointCloud& cloud) {
  MergedCloud merged = MergeDuplicates(cloud);
  if (merged.cloud.size() < kFewestPoints) {
    throw RefusedData("parts are found from " + std::to_string(kFewestPoints) +
                      " different points on; there are " + std::to_string(merged.cloud.size()));
  }
  return merged;
}

// The fits of regions. Points that do not determine theirs are of no region then.
std::vector<RegionFace> FitShapes(const RegionPoints& data,
                                  const PartFitOptions& options,
                                  const Eigen::Vector3d& move,
                                  FoundRegions& found,
                                  ThreadPool& pool) {
  std::vector<RegionFace> shapes;
  const std::vector<Region>& regions = found.labels.regions;
  for (std::size_t k = 0; k < regions.size(); ++k) {
    Report(options.progress, "faces", double(k) / double(regions.size()));
    auto face = FittedFace(data,
                           regions[k].shape,
                           regions[k].points,
                           CorePoints(data, found.labels, static_cast<int>(k), found.sigma),
                           move,
                           options.seed,
                           pool);
    if (face && Determined(*face)) {
      shapes.push_back(std::move(*face));
      continue;
    }
    for (const int point : regions[k].points) found.labels.label[std::size_t(point)] = kNoRegion;
  }
  return shapes;
}

// Regions of the shapes in the order of `numbers`.
RegionLabels LabelsOf(const RegionPoints& data,
                      const std::vector<RegionFace>& shapes,
                      const std::vector<int>& numbers) {
  RegionLabels labels;
  labels.label.assign(std::size_t(data.size()), kNoRegion);
  for (const int number : numbers) {
    const RegionFace& face = shapes[std::size_t(number)];
    Append({face.shape, face.points}, labels);
  }
  return labels;
}

// Relations of the shapes, and these under them where they are to be kept.
std::vector<FaceRelation> Relate(const RegionPoints& data,
                                 double sigma,
                                 bool regularise,
                                 const Eigen::Vector3d& move,
                                 std::vector<RegionFace>& shapes,
                                 ThreadPool& pool) {
  std::vector<int> all(shapes.size());
  std::iota(all.begin(), all.end(), 0);
  const std::vector<FaceJoin> joins = SmoothJoins(data, LabelsOf(data, shapes, all));
  std::vector<FaceRelation> relations = FindRelations(data, shapes, joins, pool);
  if (!regularise) return relations;
  std::vector<FittedSurface> related = ShapesUnder(data, shapes, relations, pool);
  if (TurnBeside(data, joins, sigma, related, shapes, relations))
    related = ShapesUnder(data, shapes, relations, pool);
  for (std::size_t k = 0; k < shapes.size(); ++k) TakeShape(data, related[k], move, shapes[k]);
  return relations;
}

RefusedData NoFace(double noise) {
  return RefusedData(
      "no face is found: no thirty neighbouring points lie on one plane, sphere, cylinder, "
      "cone or torus to within their noise of " +
      RoundedText(noise) + "; a tolerance may say how far off they may be");
}

// Where the feet of the merged points are.
struct PointFeet {
  std::vector<int> label;   // the face that a point is of
  std::vector<int> owners;  // the face with its foot
  Eigen::VectorXd residuals;
  Eigen::Matrix2Xd parameters;
};

// Points of no face are measured from the nearest.
PointFeet FeetOn(const std::vector<MadeFace>& faces,
                 const PointCloud& cloud,
                 const Eigen::Vector3d& move,
                 ThreadPool& pool) {
  const Eigen::Index count = cloud.size();
  PointFeet feet;
  feet.label.assign(std::size_t(count), kNoRegion);
  feet.residuals.resize(count);
  feet.parameters.resize(2, count);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const MadeFace& face = faces[k];
    for (const int point : face.points) feet.label[std::size_t(point)] = static_cast<int>(k);
    feet.residuals(face.points) = face.residuals;
    feet.parameters(Eigen::all, face.points) = face.parameters;
  }
  feet.owners = feet.label;
  std::vector<int> others;
  for (std::size_t k = 0; k < feet.label.size(); ++k) {
    if (feet.label[k] == kNoRegion) others.push_back(static_cast<int>(k));
  }
  if (others.empty()) return feet;
  std::vector<NurbsSurface> surfaces;
  for (const MadeFace& face : faces) surfaces.push_back(face.face.surface.Translated(-move));
  const NearestSurfaces nearest = NearestOf(surfaces, cloud.points()(Eigen::all, others), pool);
  feet.residuals(others) = nearest.distances;
  feet.parameters(Eigen::all, others) = nearest.parameters;
  for (std::size_t i = 0; i < others.size(); ++i)
    feet.owners[std::size_t(others[i])] = nearest.surface[i];
  return feet;
}

std::vector<FaceSummary> SummariseFaces(const RegionPoints& data,
                                        const std::vector<MadeFace>& faces,
                                        const std::vector<int>& label) {
  constexpr int kBorder = 3;  // pairs: fewer are points across a corner
  std::vector<FaceSummary> summaries;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    FaceSummary summary = faces[k].summary;
    summary.points = std::ssize(faces[k].points);
    summary.rms = std::sqrt(faces[k].residuals.squaredNorm() / double(summary.points));
    summary.max = faces[k].residuals.cwiseAbs().maxCoeff();
    summaries.push_back(std::move(summary));
  }
  for (const auto& [pair, links] : LinksOf(data, label)) {
    if (links.size() < kBorder) continue;
    summaries[std::size_t(pair.first)].touching.push_back(pair.second);
    summaries[std::size_t(pair.second)].touching.push_back(pair.first);
  }
  return summaries;
}

// Of every shape the number of its face.
std::vector<int> FacesOfShapes(const std::vector<MadeFace>& faces, std::size_t shapes) {
  std::vector<int> face_of(shapes, -1);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (faces[k].shape >= 0) face_of[std::size_t(faces[k].shape)] = static_cast<int>(k);
  }
  return face_of;
}

// Where faces touch along a curve; `face_of`: those of the shapes.
std::map<FacePair, FittedSurface> ContactsOf(const std::vector<FaceRelation>& relations,
                                             const std::vector<RegionFace>& shapes,
                                             const std::vector<int>& face_of) {
  std::map<FacePair, FittedSurface> contacts;
  for (const FaceRelation& relation : relations) {
    if (relation.kind != RelationKind::kTangent) continue;
    const auto a = std::size_t(relation.first), b = std::size_t(relation.second);
    contacts[std::minmax(face_of[a], face_of[b])] =
        NormalsAlong(relation.contact, shapes[a].shape, shapes[b].shape);
  }
  return contacts;
}

ClosedSolid SolidOf(const RegionPoints& data,
                    const std::vector<MadeFace>& faces,
                    const std::vector<RegionFace>& shapes,
                    const std::map<FacePair, FittedSurface>& contacts,
                    double sigma,
                    double most_invented,
                    const Eigen::Vector3d& move) {
  std::vector<int> numbers;
  for (const MadeFace& face : faces) {
    if (face.shape < 0)
      return {.solid = {}, .refused = "face " + std::to_string(numbers.size()) + " is free"};
    numbers.push_back(face.shape);
  }
  return CloseSolid(data, LabelsOf(data, shapes, numbers), contacts, sigma, most_invented, move);
}

// What the result says of every point given, from the merged point that stands for it.
void TakeFeet(const PointFeet& feet, const std::vector<Eigen::Index>& place, PartsFit& result) {
  result.residuals = feet.residuals(place);
  result.parameters = feet.parameters(Eigen::all, place);
  for (const Eigen::Index at : place) {
    result.labels.push_back(feet.label[std::size_t(at)]);
    result.owners.push_back(feet.owners[std::size_t(at)]);
  }
}

void TakeSolid(ClosedSolid closed, PartsFit& result) {
  result.bodies = closed.shells;
  result.genus = closed.genus;
  result.invented = closed.invented;
  result.solid = std::move(closed.solid);
  result.no_solid = std::move(closed.refused);
}

void FinishReport(const RegionPoints& data, const PartFitOptions& options, PartsFit& result) {
  FitReport& report = result.report;
  PointMask used(std::ssize(result.labels));
  for (Eigen::Index k = 0; k < used.size(); ++k) used[k] = result.labels[std::size_t(k)] >= 0;
  report.error = Summarise(result.residuals, options.tolerance, used);
  report.error_all = Summarise(result.residuals, options.tolerance);
  report.input.used = used.count();
  report.input.outliers = report.input.points - report.input.used;
  report.geometry.kind = "face";
  report.geometry.count = static_cast<int>(result.faces.size());
  for (const PartFace& face : result.faces)
    report.geometry.trims += static_cast<int>(face.surface.trims().size());
  JudgeEnd({.noise = report.input.noise, .rounding = data.unit * data.rounding}, report);
}

}  // namespace

PartsFit FitParts(const PointCloud& cloud, const PartFitOptions& options) {
  Check(options);
  if (cloud.dimension() == 2) throw RefusedData("points of the plane are of no faces");
  ThreadPool pool(options.threads);
  const Eigen::Vector3d move = cloud.origin() - options.shift;
  PartsFit result;
  StageClock clock;
  Report(options.progress, "prepare", 0);
  const MergedCloud merged = DifferentPoints(cloud);
  RegionPoints data = MakeRegionPoints(merged.cloud, options.seed, pool, options.least_noise);
  // Within a tolerance that is given a shape may miss what it misses.
  if (options.tolerance) data.most_trend = 1;

  clock.Enter(&StageSeconds::solve);
  FoundRegions found =
      FindRegions(data, options.tolerance.value_or(0) / data.unit, options.progress, pool);
  result.report.input =
      SummariseInput(cloud, merged.duplicates, data.unit * data.spacing, data.unit * found.sigma);
  std::vector<RegionFace> shapes = FitShapes(data, options, move, found, pool);

  clock.Enter(&StageSeconds::optimize);
  const std::vector<FaceRelation> relations =
      Relate(data, found.sigma, options.regularise, move, shapes, pool);

  clock.Enter(&StageSeconds::trim);
  std::vector<std::string>& warnings = result.report.warnings;
  std::vector<MadeFace> faces = ShapeFaces(data, shapes, move, warnings, pool);
  if (options.free_form) {
    auto pieces = SmoothLeftovers(data, found.labels.label, kFewestFree);
    std::ranges::move(FreeFaces(merged.cloud, std::move(pieces), options, warnings),
                      std::back_inserter(faces));
  }
  if (faces.empty()) throw NoFace(data.unit * data.noise);
  std::ranges::stable_sort(
      faces, std::greater(), [](const MadeFace& face) { return face.points.size(); });

  clock.Enter(&StageSeconds::project);
  const PointFeet feet = FeetOn(faces, merged.cloud, move, pool);
  TakeFeet(feet, merged.place, result);
  const std::vector<int> face_of = FacesOfShapes(faces, shapes.size());
  result.summary = {SummariseFaces(data, faces, feet.label),
                    SummariseRelations(relations, face_of, data.unit, options.regularise)};
  if (options.solid) {
    std::map<FacePair, FittedSurface> contacts;
    if (options.regularise) contacts = ContactsOf(relations, shapes, face_of);
    TakeSolid(SolidOf(data, faces, shapes, contacts, found.sigma, options.most_invented, move),
              result);
  }
  for (MadeFace& face : faces) result.faces.push_back(std::move(face.face));
  FinishReport(data, options, result);
  result.report.threads = pool.threads();
  result.report.seconds = clock.Seconds();
  return result;
}

}  // namespace batten
