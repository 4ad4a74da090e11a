// SPDX-License-Identifier: MIT
#include "fitting/regions/face_relations.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "fitting/primitives/shape_scores.h"
#include "fitting/primitives/surface_minimum.h"
#include "fitting/regions/settle_regions.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/enum_name.h"

namespace batten::internal {
namespace {

// Squares of standard deviations: one normal case in a thousand is farther, of one dimension and of
// two; one in a million, of one to five.
constexpr double kFar[] = {10.83, 13.82}, kFarJoin[] = {23.93, 27.63, 30.66, 33.38, 35.89};

using Freedoms = Eigen::Matrix<double, 7, 1>;

bool HasDirection(const FittedSurface& shape) { return shape.kind != SurfaceKind::kSphere; }
bool HasAxis(const FittedSurface& shape) { return shape.kind >= SurfaceKind::kCylinder; }
bool HasRadius(const FittedSurface& shape) {
  return shape.kind == SurfaceKind::kSphere || shape.kind == SurfaceKind::kCylinder ||
         shape.kind == SurfaceKind::kTorus;
}

// A sphere's centre, or the place of an axis beside the shape's point.
Eigen::Vector3d MiddleOf(const FittedSurface& shape) {
  return shape.kind == SurfaceKind::kSphere ? shape.Center() : shape.OnAxis();
}

// What is zero where two shapes have the relation; of coaxial and coplanar ones that are parallel,
// what there is besides. Directions across `frame`, which does not move.
struct RelationGap {
  RelationKind kind;
  Eigen::Vector3d x, y;  // across the first shape's direction
  SmoothContact contact;

  RelationGap(RelationKind of, const FittedSurface& first, const SmoothContact& at = {})
      : kind(of), contact(at) {
    const Eigen::Vector3d along =
        HasDirection(first) ? first.Direction() : Eigen::Vector3d::UnitZ();
    x = along.unitOrthogonal();
    y = along.cross(x);
  }

  Eigen::VectorXd operator()(const FittedSurface& a, const FittedSurface& b) const {
    switch (kind) {
      case RelationKind::kParallel: {
        const Eigen::Vector3d turn = a.Direction().cross(b.Direction());
        return Eigen::Vector2d(x.dot(turn), y.dot(turn));
      }
      case RelationKind::kPerpendicular:
        return Eigen::VectorXd::Constant(1, a.Direction().dot(b.Direction()));
      case RelationKind::kCoaxial: {
        const Eigen::Vector3d axis = a.Direction(), from = MiddleOf(b) - MiddleOf(a);
        const Eigen::Vector3d off = from - from.dot(axis) * axis;
        return Eigen::Vector2d(x.dot(off), y.dot(off));
      }
      case RelationKind::kCoplanar:
        return Eigen::VectorXd::Constant(1, a.Direction().dot(b.point - a.point));
      case RelationKind::kTangent:
        return ContactGap(contact, a, b).value();
      case RelationKind::kEqualRadius:
        break;
    }
    return Eigen::VectorXd::Constant(1, b.PipeRadius() - a.PipeRadius());
  }
};

// By the freedoms of one of the two shapes, by central differences.
Eigen::MatrixXd DerivativesOf(const RelationGap& gap,
                              const FittedSurface& a,
                              const FittedSurface& b,
                              bool of_first) {
  const FittedSurface& moving = of_first ? a : b;
  const int freedoms = FreedomsOf(moving.kind);
  const auto rows = gap(a, b).size();
  Eigen::MatrixXd result(rows, freedoms);
  for (int k = 0; k < freedoms; ++k) {
    // Curvatures move by a share of themselves, lengths and angles by a millionth.
    const bool bends = k == 3 || k == 6;
    const double curvature =
        k == 6 || moving.kind == SurfaceKind::kSphere ? moving.curvature : moving.axis_curvature;
    const double step = 1e-6 * (bends ? std::max(std::abs(curvature), 1e-6) : 1.0);
    Freedoms by = Freedoms::Zero();
    by[k] = step;
    const FittedSurface up = Moved(moving, by), down = Moved(moving, -by);
    result.col(k) =
        ((of_first ? gap(up, b) : gap(a, up)) - (of_first ? gap(down, b) : gap(a, down))) /
        (2 * step);
  }
  return result;
}

ShapeData CoreOf(const RegionPoints& data, const RegionFace& face) {
  ShapeData core;
  core.points = data.points(Eigen::all, face.core);
  core.weights = Eigen::VectorXd::Ones(core.points.cols());
  return core;
}

double SigmaOf(const RegionPoints& data, const RegionFace& face) {
  return std::max(face.numbers.scale / data.unit, data.rounding);
}

// Finds relations one kind after the other.
class RelationFinder {
 public:
  RelationFinder(const RegionPoints& data, const std::vector<RegionFace>& faces, ThreadPool& pool)
      : faces_(faces) {
    std::vector<std::pair<double, double>> weighted;
    for (const RegionFace& face : faces) {
      covariances_.push_back(
          CovarianceOf(face.shape, CoreOf(data, face), {}, data.rounding, pool).covariance);
      weighted.emplace_back(SigmaOf(data, face), static_cast<double>(face.core.size()));
    }
    const double usual = weighted.empty() ? 0 : WeightedMedian(weighted);
    for (const RegionFace& face : faces) {
      const double sigma = SigmaOf(data, face);
      bias_.push_back(sigma > kNoisier * usual ? sigma : 0);
    }
    order_.resize(faces.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) {
      return DirectionVariance(a) < DirectionVariance(b);
    });
  }

  std::vector<FaceRelation> Find(const std::vector<FaceJoin>& joins) && {
    std::vector<int> leaders;
    const std::vector<int> parallel = Cluster(
        RelationKind::kParallel, &HasDirection, [](int, int) { return true; }, &leaders);
    for (std::size_t i = 0; i < leaders.size(); ++i) {
      for (std::size_t j = i + 1; j < leaders.size(); ++j) {
        Test(RelationKind::kPerpendicular, leaders[i], leaders[j]);
      }
    }
    const auto alike = [&](int a, int b) {
      return parallel[std::size_t(a)] == parallel[std::size_t(b)];
    };
    Cluster(
        RelationKind::kCoplanar,
        [](const FittedSurface& shape) { return shape.kind == SurfaceKind::kPlane; },
        alike,
        nullptr);
    Cluster(RelationKind::kCoaxial, &HasAxis, alike, nullptr);
    std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) {
      return RadiusVariance(a) < RadiusVariance(b);
    });
    Cluster(
        RelationKind::kEqualRadius, &HasRadius, [](int, int) { return true; }, nullptr);
    for (const FaceJoin& join : joins) {
      std::any_of(std::begin(kContactKinds), std::end(kContactKinds), [&](ContactKind kind) {
        const SmoothContact contact{kind, join.near};
        const auto gap = ContactGap(
            contact, faces_[std::size_t(join.first)].shape, faces_[std::size_t(join.second)].shape);
        return gap && Test(RelationKind::kTangent, join.first, join.second, contact);
      });
    }
    return std::move(relations_);
  }

 private:
  double DirectionVariance(int face) const {
    const Eigen::MatrixXd& covariance = covariances_[std::size_t(face)];
    return HasDirection(faces_[std::size_t(face)].shape) ? covariance(1, 1) + covariance(2, 2)
                                                         : covariance(0, 0);
  }

  double RadiusVariance(int face) const {
    const FittedSurface& shape = faces_[std::size_t(face)].shape;
    if (!HasRadius(shape)) return std::numeric_limits<double>::infinity();
    const int at = shape.kind == SurfaceKind::kTorus ? 6 : 3;
    return covariances_[std::size_t(face)](at, at) * std::pow(shape.PipeRadius(), 4);
  }

  // Each face that `takes` goes to the first leader that `may` lead it and has the relation, or
  // becomes one. Returns each face's leader.
  template <typename Takes, typename May>
  std::vector<int> Cluster(RelationKind kind,
                           const Takes& takes,
                           const May& may,
                           std::vector<int>* found) {
    std::vector<int> leaders, leader_of(faces_.size(), -1);
    for (const int face : order_) {
      if (!takes(faces_[std::size_t(face)].shape)) continue;
      for (const int leader : leaders) {
        if (!may(leader, face) || !Test(kind, leader, face)) continue;
        leader_of[std::size_t(face)] = leader;
        break;
      }
      if (leader_of[std::size_t(face)] >= 0) continue;
      leader_of[std::size_t(face)] = face;
      leaders.push_back(face);
    }
    if (found != nullptr) *found = leaders;
    return leader_of;
  }

  // Adds the relation where the covariances do not reject it and tell it.
  bool Test(RelationKind kind, int first, int second, const SmoothContact& contact = {}) {
    const FittedSurface &a = faces_[std::size_t(first)].shape,
                        &b = faces_[std::size_t(second)].shape;
    const RelationGap gap(kind, a, contact);
    const Eigen::VectorXd off = gap(a, b);
    const Eigen::MatrixXd by_a = DerivativesOf(gap, a, b, true),
                          by_b = DerivativesOf(gap, a, b, false);
    const bool joins = kind == RelationKind::kTangent;
    const double far = (joins ? kFarJoin : kFar)[off.size() - 1];
    Eigen::MatrixXd variance;
    const auto rejected = [&](bool biased) {
      const auto covariance = [&](int face) {
        const auto k = std::size_t(face);
        const bool alike = biased && bias_[k] > 0;  // what is off is off the same way everywhere
        return Eigen::MatrixXd(covariances_[k] * (alike ? double(faces_[k].core.size()) : 1.0));
      };
      variance = by_a * covariance(first) * by_a.transpose() +
                 by_b * covariance(second) * by_b.transpose();
      return !variance.allFinite() || !(variance.diagonal().minCoeff() > 0) ||
             !(off.dot(Eigen::VectorXd(SymmetricSolution(variance, off))) <= far);
    };
    const double bias = std::max(bias_[std::size_t(first)], bias_[std::size_t(second)]);
    double moves = 0;
    if (rejected(false)) {
      if (!joins || !(bias > 0) || rejected(true)) return false;
      moves = kFarPoint * bias;
    }
    FaceRelation relation{
        kind, first, second, off.norm(), std::sqrt(far * variance.trace()), contact, moves};
    if (!(relation.allowed <= Telling(kind, a))) return false;
    relations_.push_back(relation);
    return true;
  }

  static double Telling(RelationKind kind, const FittedSurface& shape) {
    constexpr double kAngle = 0.0175, kLength = 0.01, kRadius = 0.1, kJoin = 0.1;
    if (kind == RelationKind::kTangent) return kJoin;
    if (kind == RelationKind::kEqualRadius) return kRadius * shape.PipeRadius();
    return kind == RelationKind::kParallel || kind == RelationKind::kPerpendicular ? kAngle
                                                                                   : kLength;
  }

  const std::vector<RegionFace>& faces_;
  std::vector<Eigen::MatrixXd> covariances_;
  std::vector<double> bias_;  // of faces noisier than others, that may not be noise; else zero
  std::vector<int> order_;    // best known directions first
  std::vector<FaceRelation> relations_;
};

// One Gauss–Newton step for all faces: the steps of all freedoms, from the forms Σ d²/2 of the
// faces and their variances.
std::vector<Freedoms> ConstrainedStep(const std::vector<FittedSurface>& shapes,
                                      const std::vector<FaceRelation>& relations,
                                      const std::vector<SurfaceForm>& forms,
                                      const std::vector<double>& variances) {
  std::vector<Eigen::MatrixXd> inverses;
  std::vector<Eigen::VectorXd> plain;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const int n = FreedomsOf(shapes[k].kind);
    const Eigen::MatrixXd matrix = forms[k].matrix.topLeftCorner(n, n) / variances[k];
    inverses.push_back(LeastNormSolution(
        matrix, Eigen::MatrixXd::Identity(n, n), n * std::numeric_limits<double>::epsilon()));
    plain.push_back(inverses.back() * forms[k].gradient.head(n) / variances[k]);
  }
  struct Block {
    int face;
    Eigen::Index row;
    Eigen::MatrixXd by;
  };
  std::vector<Block> blocks;
  std::vector<double> all;
  for (const FaceRelation& relation : relations) {
    const FittedSurface &a = shapes[std::size_t(relation.first)],
                        &b = shapes[std::size_t(relation.second)];
    const RelationGap gap(relation.kind, a, relation.contact);
    const Eigen::VectorXd off = gap(a, b);
    const auto row = std::ssize(all);
    blocks.push_back({relation.first, row, DerivativesOf(gap, a, b, true)});
    blocks.push_back({relation.second, row, DerivativesOf(gap, a, b, false)});
    all.insert(all.end(), off.begin(), off.end());
  }
  // Multipliers: (J A⁻¹ Jᵀ) λ = c − J A⁻¹ g.
  const auto rows = std::ssize(all);
  Eigen::MatrixXd schur = Eigen::MatrixXd::Zero(rows, rows);
  Eigen::VectorXd right = Eigen::Map<Eigen::VectorXd>(all.data(), rows);
  for (const Block& one : blocks) {
    right.segment(one.row, one.by.rows()) -= one.by * plain[std::size_t(one.face)];
    for (const Block& other : blocks) {
      if (other.face != one.face) continue;
      schur.block(one.row, other.row, one.by.rows(), other.by.rows()) +=
          one.by * inverses[std::size_t(one.face)] * other.by.transpose();
    }
  }
  // Some relations follow from others to within rounding; variances of those that do not may
  // differ by ten powers of ten.
  const Eigen::VectorXd scale =
      schur.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd multipliers =
      scale.cwiseProduct(LeastNormSolution(scale.asDiagonal() * schur * scale.asDiagonal(),
                                           scale.cwiseProduct(right),
                                           kRelativeRounding)
                             .col(0));
  std::vector<Freedoms> steps(shapes.size(), Freedoms::Zero());
  for (std::size_t k = 0; k < shapes.size(); ++k) steps[k].head(plain[k].size()) = -plain[k];
  for (const Block& one : blocks) {
    steps[std::size_t(one.face)].head(one.by.cols()) -= inverses[std::size_t(one.face)] *
                                                        one.by.transpose() *
                                                        multipliers.segment(one.row, one.by.rows());
  }
  return steps;
}

}  // namespace

const char* Name(RelationKind kind) {
  static constexpr std::array kNames{
      "parallel", "perpendicular", "coaxial", "coplanar", "equal radius", "tangent"};
  return NameIn<RelationKind::kTangent>(kNames, kind);
}

std::vector<FaceJoin> SmoothJoins(const RegionPoints& data, const RegionLabels& labels) {
  std::vector<FaceJoin> joins;
  for (const auto& [pair, found] : LinksOf(data, labels.label)) {
    if (std::ssize(found) < kFewLinks || !JoinSmoothly(data, labels, pair.first, pair.second))
      continue;
    joins.push_back({pair.first, pair.second, found[found.size() / 2]});
  }
  return joins;
}

std::vector<FaceRelation> FindRelations(const RegionPoints& data,
                                        const std::vector<RegionFace>& faces,
                                        const std::vector<FaceJoin>& joins,
                                        ThreadPool& pool) {
  return RelationFinder(data, faces, pool).Find(joins);
}

namespace {

// A tangent relation of shapes that have moved to where they can't touch.
std::vector<FaceRelation>::const_iterator LostContact(const std::vector<FaceRelation>& relations,
                                                      const std::vector<FittedSurface>& shapes) {
  return std::find_if(relations.begin(), relations.end(), [&](const FaceRelation& one) {
    return one.kind == RelationKind::kTangent &&
           !ContactGap(
               one.contact, shapes[std::size_t(one.first)], shapes[std::size_t(one.second)]);
  });
}

// Ends early where a contact is lost.
std::vector<FittedSurface> SettledUnder(const RegionPoints& data,
                                        const std::vector<RegionFace>& faces,
                                        const std::vector<FaceRelation>& relations,
                                        ThreadPool& pool) {
  constexpr int kMostSteps = 20;
  std::vector<FittedSurface> shapes;
  std::vector<ShapeData> cores;
  std::vector<double> variances;
  for (const RegionFace& face : faces) {
    shapes.push_back(face.shape);
    cores.push_back(CoreOf(data, face));
    const double sigma = SigmaOf(data, face);
    variances.push_back(sigma * sigma);
  }
  if (relations.empty()) return shapes;
  for (int step = 0; step < kMostSteps; ++step) {
    if (LostContact(relations, shapes) != relations.end()) break;
    std::vector<SurfaceForm> forms;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      const double far = kFarPoint * std::sqrt(variances[k]);
      forms.push_back(
          FormOf(shapes[k], cores[k], {Loss::kTruncated, far / kTruncatedTuning}, pool));
    }
    const std::vector<Freedoms> steps = ConstrainedStep(shapes, relations, forms, variances);
    double largest = 0;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      shapes[k] = Moved(shapes[k], steps[k]);
      largest = std::max(largest, steps[k].head<3>().norm());
    }
    if (largest < kSettled) break;
  }
  return shapes;
}

// Σ d²/σ² over the points of a face's core, each no farther off than what counts.
double CostOf(const RegionPoints& data, const RegionFace& face, const FittedSurface& shape) {
  const double sigma = SigmaOf(data, face);
  double cost = 0;
  for (const int point : face.core) {
    const double off =
        std::min(kFarPoint, std::abs(shape.Distance(data.points.col(point))) / sigma);
    cost += off * off;
  }
  return cost;
}

// The relation that is least likely of those whose faces have left their points; the end where no
// face has: each of its relations may cost as much as chance explains once in a million.
std::vector<FaceRelation>::iterator WorstOf(const RegionPoints& data,
                                            const std::vector<RegionFace>& faces,
                                            const std::vector<FittedSurface>& shapes,
                                            std::vector<FaceRelation>& relations) {
  std::vector<double> allowed(faces.size());
  for (const FaceRelation& relation : relations) {
    for (const int k : {relation.first, relation.second}) {
      const RegionFace& face = faces[std::size_t(k)];
      const double moves = relation.moves / SigmaOf(data, face);
      // Of five dimensions.
      allowed[std::size_t(k)] += kFarJoin[4] + double(face.core.size()) * moves * moves;
    }
  }
  const auto left = [&](int face) {
    const auto k = std::size_t(face);
    return !(CostOf(data, faces[k], shapes[k]) <=
             CostOf(data, faces[k], faces[k].shape) + allowed[k]);
  };
  auto worst = relations.end();
  for (auto one = relations.begin(); one != relations.end(); ++one) {
    if (one->moves > 0 || (!left(one->first) && !left(one->second))) continue;
    if (worst == relations.end() ||
        one->deviation * worst->allowed > worst->deviation * one->allowed)
      worst = one;
  }
  return worst;
}

}  // namespace

std::vector<FittedSurface> ShapesUnder(const RegionPoints& data,
                                       const std::vector<RegionFace>& faces,
                                       std::vector<FaceRelation>& relations,
                                       ThreadPool& pool) {
  for (;;) {
    std::vector<FittedSurface> shapes = SettledUnder(data, faces, relations, pool);
    if (const auto lost = LostContact(relations, shapes); lost != relations.end()) {
      relations.erase(lost);
      continue;
    }
    const auto worst = WorstOf(data, faces, shapes, relations);
    if (worst == relations.end()) return shapes;
    relations.erase(worst);
  }
}

}  // namespace batten::internal
