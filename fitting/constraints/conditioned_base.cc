// SPDX-License-Identifier: MIT
#include "fitting/constraints/conditioned_base.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/refused_data.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "fitting/constraints/domain_box.h"
#include "fitting/constraints/neighbour_tangents.h"
#include "fitting/core/rules.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kFewestPlaced = 4;  // samples of a side that the base must reach

// The points of a cloud and, after them, places that conditions speak of. Of equal ones there is
// one.
struct Extended {
  MergedCloud merged;
  Eigen::Index own = 0;  // of the cloud

  Eigen::Index At(Eigen::Index extra) const {
    return merged.place[static_cast<size_t>(own + extra)];
  }
};

Extended Extend(const PointCloud& cloud, const Eigen::Matrix3Xd& extras) {
  Eigen::Matrix3Xd all(3, cloud.size() + extras.cols());
  all << cloud.points(), extras;
  Extended extended{MergeDuplicates(PointCloud(std::move(all), cloud.origin())), cloud.size()};
  if (cloud.weights().size() == 0) {
    extended.merged.cloud.set_weights({});
    return extended;
  }
  Eigen::VectorXd weights =
      Eigen::VectorXd::Constant(extended.merged.cloud.size(), cloud.weights().mean());
  weights.head(cloud.size()) = cloud.weights();
  extended.merged.cloud.set_weights(std::move(weights));
  return extended;
}

CloudStatistics WithPlain(CloudStatistics statistics, Eigen::Index size) {
  const Eigen::Index own = statistics.outliers.size();
  statistics.outliers.conservativeResize(size);
  statistics.outliers.tail(size - own).setConstant(false);
  return statistics;
}

// The conditions of one fit, placed in the base that is found for points and conditions together.
class Conditioner {
 public:
  Conditioner(const PointCloud& cloud,
              const NeighbourIndex& index,
              const CloudStatistics& statistics,
              const SurfaceFitOptions& options,
              ThreadPool& pool)
      : cloud_(cloud), statistics_(statistics), options_(options), pool_(pool) {
    sides_ = BoundaryEdges(options, cloud.origin(), cloud.points(), index, statistics.spacing);
    std::vector<Eigen::Matrix3Xd> parts;
    Eigen::Index count = options.meet ? options.meet->size() : 0;
    for (const BoundaryEdge& side : sides_) {
      samples_.push_back(SampleSide(side, statistics.spacing));
      count += samples_.back().points.cols();
    }
    Eigen::Matrix3Xd extras(3, count);
    Eigen::Index next = 0;
    for (const SideSamples& sample : samples_) {
      extras.middleCols(next, sample.points.cols()) = sample.points;
      next += sample.points.cols();
    }
    for (Eigen::Index k = 0; options.meet && k < options.meet->size(); ++k)
      extras.col(next++) = options.meet->World(k) - cloud.origin();
    extended_ = Extend(cloud, extras);
  }

  ConditionedBase Run() {
    const PointCloud& all = extended_.merged.cloud;
    ConditionedBase result{
        ChooseBase(
            all, NeighbourIndex(all.points()), WithPlain(statistics_, all.size()), options_, pool_),
        {}};
    Parameterization& base = result.choice.base;
    if (base.periodic_u || base.periodic_v || base.poles.any()) {
      throw RefusedData(
          "boundary curves and points to be met need an open surface; these points lie on one that "
          "closes (" +
              base.name + "): take a part of it",
          Remedy::kFitPart);
    }
    PlaceSides(result);
    PlacePoints(result);
    base.plane.reset();  // not heights: edges run in space
    base.parameters.conservativeResize(2, cloud_.size());
    result.choice.reached.conservativeResize(cloud_.size());
    return result;
  }

 private:
  void PlaceSides(ConditionedBase& result) {
    std::vector<PlacedSide> placed;
    Eigen::Index first = 0;
    for (size_t k = 0; k < sides_.size(); ++k) {
      const SideSamples& sample = samples_[k];
      std::vector<Eigen::Index> kept;
      for (Eigen::Index i = 0; i < sample.points.cols(); ++i)
        if (result.choice.reached[extended_.At(first + i)]) kept.push_back(i);
      if (static_cast<Eigen::Index>(kept.size()) < kFewestPlaced) {
        throw std::invalid_argument("boundary " + sides_[k].name +
                                    ": the curve does not lie on the sheet of the points");
      }
      PlacedSide side{sides_[k], sample.parameters(kept), Eigen::Matrix2Xd(2, kept.size())};
      for (size_t i = 0; i < kept.size(); ++i) {
        side.places.col(static_cast<Eigen::Index>(i)) =
            result.choice.base.parameters.col(extended_.At(first + kept[i]));
      }
      placed.push_back(std::move(side));
      first += sample.points.cols();
    }
    extras_of_sides_ = first;
    if (placed.empty()) return;
    // Points of the sides serve to place them; the outline is that of the cloud.
    PointMask own = result.choice.reached;
    own.tail(own.size() - cloud_.size()).setConstant(false);
    PlacedBoundaries laid = ParameterizeByCoons(result.choice.base,
                                                own,
                                                extended_.merged.cloud.points(),
                                                placed,
                                                statistics_.spacing,
                                                statistics_.noise,
                                                pool_);
    result.choice.reached.head(cloud_.size()) = own.head(cloud_.size());
    result.choice.base.why += "; laid between the curves given for its edges";
    result.conditions.sides = std::move(laid.sides);
    auto& warnings = result.choice.warnings;
    warnings.insert(warnings.end(), laid.warnings.begin(), laid.warnings.end());
    if (laid.beyond > 0) {
      warnings.push_back(std::to_string(laid.beyond) +
                         " points lie beyond the given boundary and are not counted");
    }
  }

  void PlacePoints(ConditionedBase& result) const {
    for (Eigen::Index k = 0; options_.meet && k < options_.meet->size(); ++k) {
      const Eigen::Index at = extended_.At(extras_of_sides_ + k);
      if (!result.choice.reached[at]) {
        throw std::invalid_argument("point " + std::to_string(k + 1) +
                                    " of those to be met does not lie on the sheet of the points");
      }
      const Eigen::Vector2d uv = result.choice.base.parameters.col(at);
      FixedPoint point{uv[0], uv[1], options_.meet->World(k) - cloud_.origin()};
      const bool has = options_.meet->normals().cols() > 0 &&
                       !options_.meet->normals().col(k).isZero(0);  // zero: none
      if (has) point.normal = options_.meet->normals().col(k);
      result.conditions.points.push_back(std::move(point));
    }
  }

  const PointCloud& cloud_;
  const CloudStatistics& statistics_;
  const SurfaceFitOptions& options_;
  ThreadPool& pool_;
  std::vector<BoundaryEdge> sides_;
  std::vector<SideSamples> samples_;
  Extended extended_;
  Eigen::Index extras_of_sides_ = 0;
};

}  // namespace

namespace {

// A rectangle round an open sheet is better one that its own sides bound; not where a plane was
// asked for, over which heights are to be fitted.
bool MayEndInOutline(const Parameterization& base, const SurfaceFitOptions& options) {
  return (base.name == "sheet" || (base.plane && options.base == BaseShape::kAuto)) &&
         base.settled_cells_u == 0 && !base.periodic_u && !base.periodic_v;
}

}  // namespace

namespace {

// Both edges u = 0 and u = length_u are the curve.
std::vector<PlacedBoundary> SidesOf(const NurbsCurve<3>& sharp_edge) {
  std::vector<PlacedBoundary> sides;
  for (const bool upper : {false, true})
    sides.push_back({{Direction::kU, upper}, {sharp_edge, std::nullopt, "sharp edge"}});
  return sides;
}

}  // namespace

SurfaceConstraints ConstraintsOf(const SurfaceConditions& conditions) {
  SurfaceConstraints constraints;
  for (const PlacedBoundary& laid : conditions.sides) {
    const BoundaryEdge& side = laid.side;
    FixedEdge edge{laid.edge, side.curve};
    if (side.neighbour) {
      NurbsCurve<3> across = OutwardDerivative(*side.neighbour);
      if (side.reversed) across = Reversed(across);
      // Out of the neighbour is into this surface, but the parameter rises out of an upper edge.
      if (laid.edge.upper) across = NurbsCurve<3>(across.basis(), -across.control_points());
      edge.across = Reparameterized(across, side.curve.basis().lower(), side.curve.basis().upper());
    }
    constraints.edges.push_back(std::move(edge));
  }
  constraints.points = conditions.points;
  return constraints;
}

ConditionedBase ChooseConditionedBase(const PointCloud& points,
                                      const NeighbourIndex& index,
                                      const CloudStatistics& statistics,
                                      const SurfaceFitOptions& options,
                                      ThreadPool& pool) {
  if (!options.boundary.empty() || options.meet)
    return Conditioner(points, index, statistics, options, pool).Run();
  ConditionedBase result{ChooseBase(points, index, statistics, options, pool), {}};
  Parameterization& base = result.choice.base;
  if (base.sharp_edge) {
    result.conditions.sides = SidesOf(*base.sharp_edge);
  } else if (options.domain) {
    TakeDomain(base, result.choice.reached, points.origin(), *options.domain);
  } else if (!options.symmetric && MayEndInOutline(base, options)) {
    const PointMask counted = result.choice.reached && !statistics.outliers;
    if (Acts(Rule::kOutlineBase) &&
        ParameterizeByOutline(base, counted, statistics.spacing, statistics.noise, pool)) {
      base.why += "; its rectangle ends in the outline of the points";
      base.plane.reset();
    }
  }
  return result;
}

}  // namespace batten::internal
