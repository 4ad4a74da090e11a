// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_parts.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/refused_data.h"
#include "part_clouds.h"
#include "refusal.h"
#include "sector_part.h"
#include "tolerances.h"

namespace batten::internal {
namespace fit_parts_test {

constexpr int kPoints = 20000;

PartsFit Fitted(const PartCloud& cloud, PartFitOptions options = {}) {
  options.threads = 2;
  return FitParts(PointCloud::FromWorld(cloud.points), options);
}

// The truth of each face found: that of most of its points.
std::vector<int> TruthOf(const PartsFit& fit, const PartCloud& cloud) {
  std::vector<std::map<int, int>> votes(fit.faces.size());
  for (std::size_t k = 0; k < cloud.face.size(); ++k) {
    if (fit.labels[k] >= 0) ++votes[std::size_t(fit.labels[k])][cloud.face[k]];
  }
  std::vector<int> truth;
  for (const auto& vote : votes) {
    truth.push_back(std::max_element(vote.begin(), vote.end(), [](const auto& a, const auto& b) {
                      return a.second < b.second;
                    })->first);
  }
  return truth;
}

double DistanceFrom(const SurfaceShape& shape, const Eigen::Vector3d& p) {
  if (const auto* plane = std::get_if<PlaneShape>(&shape))
    return std::abs(plane->normal.dot(p - plane->point));
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return std::abs((p - sphere->center).norm() - sphere->radius);
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return std::abs((p - cylinder->point).cross(cylinder->axis).norm() - cylinder->radius);
  const auto& cone = std::get<ConeShape>(shape);
  const Eigen::Vector3d from = p - cone.apex;
  return std::abs(from.cross(cone.axis).norm() * std::cos(cone.half_angle) -
                  from.dot(cone.axis) * std::sin(cone.half_angle));
}

// Differences of the fitted numbers from the true ones, in standard deviations.
class Deviations {
 public:
  void Add(const PrimitiveSummary& found, const SurfaceShape& truth) {
    if (const auto* plane = std::get_if<PlaneShape>(&truth)) {
      Length("offset", (*found.point - plane->point).dot(plane->normal), found);
      Direction("normal", *found.normal, plane->normal, found);
    } else if (const auto* cylinder = std::get_if<CylinderShape>(&truth)) {
      Length("radius", *found.radius - cylinder->radius, found);
      Direction("axis", *found.axis, cylinder->axis, found);
    } else if (const auto* sphere = std::get_if<SphereShape>(&truth)) {
      Length("radius", *found.radius - sphere->radius, found);
      for (int i = 0; i < 3; ++i) {
        Length(std::string("center_") + "xyz"[i], (*found.center - sphere->center)[i], found);
      }
    } else if (const auto* cone = std::get_if<ConeShape>(&truth)) {
      Length("half_angle", *found.half_angle - cone->half_angle, found);
      Direction("axis", *found.axis, cone->axis, found);
    }
  }

  const std::vector<double>& all() const { return all_; }

 private:
  void Length(const std::string& name, double off, const PrimitiveSummary& found) {
    all_.push_back(std::abs(off) / found.accuracy->Deviation(name));
  }
  void Direction(const std::string& name,
                 const Eigen::Vector3d& direction,
                 const Eigen::Vector3d& truth,
                 const PrimitiveSummary& found) {
    all_.push_back(std::abs(truth.dot(found.accuracy->frame_x)) /
                   found.accuracy->Deviation(name + "_x"));
    all_.push_back(std::abs(truth.dot(found.accuracy->frame_y)) /
                   found.accuracy->Deviation(name + "_y"));
    EXPECT_GT(std::abs(direction.dot(truth)), 0.99);
  }

  std::vector<double> all_;
};

class MachinedPartTest : public testing::TestWithParam<int> {
 protected:
  // Points on the face they were put on, or that are within noise of the shape of the face they are
  // on now and no farther from points put on that than a few of these from one another.
  double RightlyLabelled(const PartsFit& fit,
                         const PartCloud& cloud,
                         const std::vector<int>& truth,
                         double sigma) const {
    constexpr double kNoise = 3, kBeside = 3;
    const double beside = kBeside * fit.report.input.spacing;
    double right = 0;
    for (std::size_t k = 0; k < cloud.face.size(); ++k) {
      if (fit.labels[k] < 0) continue;
      const int found = truth[std::size_t(fit.labels[k])];
      const Eigen::Vector3d p = cloud.points.col(Eigen::Index(k));
      const auto near = [&](std::size_t other) {
        return cloud.face[other] == found &&
               (cloud.points.col(Eigen::Index(other)) - p).norm() <= beside;
      };
      bool is_right = found == cloud.face[k];
      if (!is_right && DistanceFrom(part.faces[std::size_t(found)].shape, p) <= kNoise * sigma) {
        for (std::size_t other = 0; other < cloud.face.size() && !is_right; ++other)
          is_right = near(other);
      }
      right += is_right;
    }
    return right;
  }

  const TruthPart part = MachinedParts()[std::size_t(GetParam())];
};

TEST_P(MachinedPartTest, HasItsFacesOfTheirKindsAndNoOthersAtEveryNoise) {
  for (const double sigma : {0.0, 1e-4, 1e-3}) {
    SCOPED_TRACE(part.name + " at noise " + std::to_string(sigma));
    const PartCloud cloud = SampledPart(part, kPoints, sigma, 7);
    const PartsFit fit = Fitted(cloud);
    ASSERT_EQ(fit.faces.size(), part.faces.size());
    const std::vector<int> truth = TruthOf(fit, cloud);
    std::vector<int> found = truth;
    std::sort(found.begin(), found.end());
    EXPECT_EQ(std::unique(found.begin(), found.end()), found.end());
    for (std::size_t k = 0; k < truth.size(); ++k) {
      EXPECT_EQ(fit.summary.faces[k].kind, NameOf(part.faces[std::size_t(truth[k])].shape));
    }
    // All points but a few at corners are of the face they were put on, or of one beside it that
    // they are on as well as far as noise tells: at smooth borders those are many.
    constexpr double kMost = 0.99;
    EXPECT_GT(RightlyLabelled(fit, cloud, truth, sigma), kMost * kPoints);
    EXPECT_NEAR(fit.report.error.rms, sigma, 0.02 * sigma + 1e-9);
  }
}

TEST_P(MachinedPartTest, IsTheSameOnAnyNumberOfThreads) {
  const PartCloud cloud = SampledPart(part, kPoints / 4, 1e-4, 3);
  PartFitOptions options;
  options.threads = 1;
  const PointCloud points = PointCloud::FromWorld(cloud.points);
  const PartsFit one = FitParts(points, options);
  options.threads = 2;
  const PartsFit two = FitParts(points, options);
  EXPECT_EQ(one.labels, two.labels);
  EXPECT_LT((one.residuals - two.residuals).cwiseAbs().maxCoeff(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(All, MachinedPartTest, testing::Range(0, 7));

TEST(LongFitPartsTest, NumbersAreWithinTwoStandardDeviationsNineteenTimesInTwenty) {
  Deviations deviations;
  unsigned seed = 20;
  for (const TruthPart& part : MachinedParts()) {
    for (const double sigma : {1e-4, 1e-3}) {
      const PartCloud cloud = SampledPart(part, kPoints, sigma, ++seed);
      const PartsFit fit = Fitted(cloud);
      const std::vector<int> truth = TruthOf(fit, cloud);
      for (std::size_t k = 0; k < truth.size(); ++k) {
        ASSERT_EQ(fit.summary.faces[k].kind, NameOf(part.faces[std::size_t(truth[k])].shape));
        deviations.Add(*fit.summary.faces[k].primitive, part.faces[std::size_t(truth[k])].shape);
      }
    }
  }
  const auto& all = deviations.all();
  const auto within = std::count_if(all.begin(), all.end(), [](double d) { return d <= 2; });
  ASSERT_GT(all.size(), 300u);
  RecordProperty("numbers", static_cast<int>(all.size()));
  RecordProperty("within", static_cast<int>(within));
  constexpr double kNineteenInTwenty = 0.95;  // of normal errors 95.4 % are
  EXPECT_GE(static_cast<double>(within), kNineteenInTwenty * static_cast<double>(all.size()));
}

TEST(FitPartsTest, SizeAndPlaceDoNotMatter) {
  const TruthPart part = ShaftPart();
  const PartCloud cloud = SampledPart(part, kPoints / 2, 1e-4, 5);
  for (const auto& [scale, shift] : {std::pair(1e-6, 0.0), std::pair(1000.0, 5e6)}) {
    SCOPED_TRACE(scale);
    PartCloud moved = cloud;
    moved.points = (scale * cloud.points).colwise() + Eigen::Vector3d(shift, -shift, 0);
    const PartsFit fit = Fitted(moved);
    ASSERT_EQ(fit.faces.size(), part.faces.size());
    const std::vector<int> truth = TruthOf(fit, moved);
    for (std::size_t k = 0; k < truth.size(); ++k) {
      EXPECT_EQ(fit.summary.faces[k].kind, NameOf(part.faces[std::size_t(truth[k])].shape));
    }
  }
}

TEST(FitPartsTest, DuplicatesAndStrayPointsChangeNoFace) {
  const TruthPart part = LBlockPart();
  PartCloud cloud = SampledPart(part, kPoints / 2, 1e-4, 5);
  const Eigen::Index count = cloud.points.cols();
  cloud.points.conservativeResize(Eigen::NoChange, count + 1200);
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> even(-0.2, 1.2);
  for (Eigen::Index k = 0; k < 1000; ++k) cloud.points.col(count + k) = cloud.points.col(7 * k);
  for (Eigen::Index k = 1000; k < 1200; ++k) {
    cloud.points.col(count + k) << even(engine), even(engine), even(engine);
  }
  const PartsFit fit = Fitted(cloud);
  EXPECT_EQ(fit.faces.size(), part.faces.size());
  EXPECT_EQ(fit.report.input.duplicates, 1000);
  EXPECT_GT(fit.report.input.outliers, 150);
  for (Eigen::Index k = 0; k < 1000; ++k) {
    EXPECT_EQ(fit.labels[std::size_t(count + k)], fit.labels[std::size_t(7 * k)]);
  }
}

TEST(FitPartsTest, RelationsHoldExactlyOnceTheyAreKept) {
  const PartCloud cloud = SampledPart(FlangePart(), kPoints, 1e-3, 7);
  PartFitOptions options;
  options.regularise = true;
  const PartsFit fit = Fitted(cloud, options);
  ASSERT_FALSE(fit.summary.relations.empty());
  constexpr double kExact = 1e-12;
  const auto numbers = [&](int face) { return *fit.summary.faces[std::size_t(face)].primitive; };
  const auto along = [](const PrimitiveSummary& p) { return p.normal ? *p.normal : *p.axis; };
  std::map<std::string, int> kinds;
  for (const RelationSummary& relation : fit.summary.relations) {
    ++kinds[relation.kind];
    EXPECT_TRUE(relation.kept);
    EXPECT_LE(relation.deviation, relation.allowed);
    const PrimitiveSummary first = numbers(relation.faces[0]);
    for (const int face : relation.faces) {
      const PrimitiveSummary other = numbers(face);
      if (relation.kind == "parallel") {
        EXPECT_LT(along(first).cross(along(other)).norm(), kExact);
      }
      if (relation.kind == "equal radius") {
        EXPECT_NEAR(*first.radius, *other.radius, kExact);
      }
      if (relation.kind == "coaxial") {
        EXPECT_LT((*other.point - *first.point).cross(*first.axis).norm(), kExact);
      }
    }
  }
  // Ten parallel directions, the bore in the rim's axis, six equal holes.
  EXPECT_EQ(kinds["parallel"], 1);
  EXPECT_EQ(kinds["coaxial"], 1);
  EXPECT_EQ(kinds["equal radius"], 1);
  // Points are no farther off than noise and what a relation may cost.
  EXPECT_NEAR(fit.report.error.rms, 1e-3, 2e-5);
}

// Among 55 relations of this cloud are some that are not true, and no shapes have all of them.
TEST(FitPartsTest, RelationsThatCannotHoldTogetherMoveNoFaceFromItsPoints) {
  PartFitOptions options;
  options.regularise = true;
  const PartsFit fit = Fitted(SampledPart(FilletedBoxPart(), kPoints, 1e-3, 32), options);
  EXPECT_FALSE(fit.summary.relations.empty());
  EXPECT_NEAR(fit.report.error.rms, 1e-3, 2e-5);
}

TEST(FitPartsTest, WhatIsNotTrueIsNoRelation) {
  // A box of which one side leans by 1°, eight times what noise can hide.
  TruthPart part = BoxPart();
  part.faces[1] = FlatFace({0, 0, 0.4}, {1, 0, 0.0175}, {0, 0.7, 0});
  const PartCloud cloud = SampledPart(part, kPoints, 1e-4, 7);
  const PartsFit fit = Fitted(cloud);
  const std::vector<int> truth = TruthOf(fit, cloud);
  for (const RelationSummary& relation : fit.summary.relations) {
    if (relation.kind != "parallel") continue;
    const bool leans = std::any_of(relation.faces.begin(), relation.faces.end(), [&](int face) {
      return truth[std::size_t(face)] == 1;
    });
    EXPECT_FALSE(leans);
  }
}

void IsASolidWithItsEdgesAndVertices(const TruthPart& part, double sigma) {
  PartFitOptions options;
  options.regularise = options.solid = true;
  SCOPED_TRACE(part.name + " at noise " + std::to_string(sigma));
  const PartsFit fit = Fitted(SampledPart(part, kPoints, sigma, 7), options);
  ASSERT_TRUE(fit.solid) << fit.no_solid;
  EXPECT_EQ(std::ssize(fit.solid->edges), part.edges);
  // Every closed edge has a vertex of its own.
  if (part.vertices > 0) {
    EXPECT_EQ(fit.solid->vertices.cols(), part.vertices);
  }
  std::vector<int> forward(fit.solid->edges.size()), backward(fit.solid->edges.size());
  for (const TrimmedSolidFace& face : fit.solid->faces) {
    for (const auto& loop : face.loops) {
      for (const TrimmedSolidCoedge& coedge : loop)
        ++(coedge.reversed ? backward : forward)[std::size_t(coedge.edge)];
    }
  }
  EXPECT_EQ(forward, std::vector<int>(forward.size(), 1));
  EXPECT_EQ(backward, std::vector<int>(backward.size(), 1));
  for (const TrimmedSolidEdge& edge : fit.solid->edges) EXPECT_TRUE(edge.exact);
}

TEST(FitPartsTest, ABracketIsASolidWithItsEdgesAndVertices) {
  IsASolidWithItsEdgesAndVertices(BracketPart(), 1e-3);
}

TEST(LongFitPartsTest, PartsAreSolidsWithTheirEdgesAndVertices) {
  for (const TruthPart& part : MachinedParts()) {
    for (const double sigma : {0.0, 1e-4, 1e-3}) IsASolidWithItsEdgesAndVertices(part, sigma);
  }
}

// Points of facets, as of an exact body's mesh: planes have no noise, round faces have that of
// their facets, which is the same way everywhere.
void IsASolidOfItsFacesInFacets(const TruthPart& part, double width) {
  SCOPED_TRACE(part.name + " in facets of " + std::to_string(width));
  PartFitOptions options;
  options.regularise = options.solid = true;
  const PartsFit fit = Fitted(SampledPart(Tessellated(part, width), kPoints, 0, 7), options);
  EXPECT_EQ(fit.faces.size(), part.faces.size());
  ASSERT_TRUE(fit.solid) << fit.no_solid;
  EXPECT_EQ(std::ssize(fit.solid->edges), part.edges);
}

TEST(FitPartsTest, TessellatedPartsAreSolidsOfTheShapesTheyStandFor) {
  for (const double width : {0.003, 0.01}) IsASolidOfItsFacesInFacets(BracketPart(), width);
}

TEST(LongFitPartsTest, AllTessellatedPartsAreSolidsOfTheShapesTheyStandFor) {
  for (const TruthPart& part : MachinedParts()) IsASolidOfItsFacesInFacets(part, 0.003);
}

// Exact bodies have faces that are one to a CAD system and apart by its rounding.
TEST(FitPartsTest, FacesApartByWhatCadTakesForNothingAreOne) {
  TruthPart part = BoxPart();
  part.faces[1] = FlatFace({0, 0, 0.4}, {0.5, 0, 0}, {0, 0.7, 0});
  part.faces.push_back(FlatFace({0.5, 0, 0.4 + 3e-10}, {0.5, 0, 0}, {0, 0.7, 0}));
  PartFitOptions options;
  options.regularise = options.solid = true;
  for (const unsigned seed : {3u, 4u}) {
    const PartsFit fit = Fitted(SampledPart(part, kPoints, 0, seed), options);
    EXPECT_EQ(fit.faces.size(), 6u);
    ASSERT_TRUE(fit.solid) << fit.no_solid;
    EXPECT_EQ(fit.solid->edges.size(), 12u);
  }
}

// A box with a pocket in its top that is as deep as points are apart two and a half times: its
// walls have two rows of points, whose neighbours are mostly of other faces.
TEST(FitPartsTest, NarrowFacesBesideLargerOnesAreFoundAndClose) {
  constexpr double kDeep = 0.03, kTop = 0.4;
  const Eigen::Vector3d low(0.25, 0.2, kTop - kDeep), x(0.5, 0, 0), y(0, 0.3, 0), z(0, 0, kDeep);
  TruthPart part = BoxPart();
  part.faces[1] = FlatFace({0, 0, kTop}, {1, 0, 0}, {0, 0.7, 0}, [&](const Eigen::Vector3d& p) {
    return p[0] < low[0] || p[0] > low[0] + x[0] || p[1] < low[1] || p[1] > low[1] + y[1];
  });
  part.faces.push_back(FlatFace(low, x, y));
  part.faces.push_back(FlatFace(low, z, x));
  part.faces.push_back(FlatFace(low + y, x, z));
  part.faces.push_back(FlatFace(low, y, z));
  part.faces.push_back(FlatFace(low + x, z, y));
  PartFitOptions options;
  options.regularise = options.solid = true;
  // At 1e-3 noise takes a tenth of the walls' height from either side: parts of them are not told.
  for (const double sigma : {0.0, 1e-4}) {
    for (const unsigned seed : {3u, 4u, 5u}) {
      SCOPED_TRACE("noise " + std::to_string(sigma) + ", seed " + std::to_string(seed));
      const PartsFit fit = Fitted(SampledPart(part, kPoints, sigma, seed), options);
      ASSERT_EQ(fit.faces.size(), 11u);
      ASSERT_TRUE(fit.solid) << fit.no_solid;
      EXPECT_EQ(fit.solid->edges.size(), 24u);
      EXPECT_EQ(fit.solid->vertices.cols(), 16);
      EXPECT_EQ(fit.genus, 0);
    }
  }
}

// Ten planes, eight cylinders, five tori, a cone and a sphere. Where the edge below the step fades
// out, three faces have one tangent plane; a wall is thinner than two spacings.
TEST(FitPartsTest, ASectorWhoseEdgesFadeOutIsASolidOfItsTwentyFiveFaces) {
  const TruthPart part = SectorPart::Part();
  ASSERT_EQ(part.faces.size(), 25u);
  PartFitOptions options;
  options.regularise = options.solid = true;
  const PartCloud cloud = SampledPart(part, 3 * kPoints, 0, 7);
  const PartsFit fit = Fitted(cloud, options);
  ASSERT_EQ(fit.faces.size(), part.faces.size());
  const std::vector<int> truth = TruthOf(fit, cloud);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_EQ(fit.summary.faces[k].kind, NameOf(part.faces[std::size_t(truth[k])].shape));
  }
  ASSERT_TRUE(fit.solid) << fit.no_solid;
  EXPECT_EQ(std::ssize(fit.solid->edges), part.edges);
  EXPECT_EQ(fit.solid->vertices.cols(), part.vertices);
  EXPECT_EQ(fit.genus, 0);
  EXPECT_LT(fit.report.error.max, kIterated * SectorPart::kEnd);
}

// At other places contacts are lost while relations are settled.
TEST(FitPartsTest, ContactsThatAreLostAreSaidAndNotThrown) {
  PartFitOptions options;
  options.regularise = options.solid = true;
  const PartsFit fit = Fitted(SampledPart(SectorPart::Part(), 2 * kPoints, 0, 7), options);
  EXPECT_TRUE(fit.solid || fit.no_solid.find("meet smoothly") != std::string::npos) << fit.no_solid;
}

TEST(FitPartsTest, TheSolidOfSmoothlyJoinedFacesIsRefusedWithTheirPlace) {
  PartFitOptions options;
  options.solid = true;
  const PartsFit fit = Fitted(SampledPart(BracketPart(), kPoints, 1e-4, 7), options);
  EXPECT_FALSE(fit.solid);
  EXPECT_NE(fit.no_solid.find("meet smoothly"), std::string::npos) << fit.no_solid;
}

TEST(FitPartsTest, RefusesWhatHasNoFaces) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> even(0, 1);
  Eigen::Matrix3Xd points(3, 3000);
  for (double& value : points.reshaped()) value = even(engine);
  EXPECT_THROW(FitParts(PointCloud(points)), RefusedData);
  EXPECT_THROW(FitParts(PointCloud(points.leftCols(20))), RefusedData);
  EXPECT_THROW(FitParts(PointCloud(points, Eigen::Vector3d::Zero(), 2)), std::invalid_argument);
  PartFitOptions options;
  options.tolerance = -1;
  EXPECT_THROW(FitParts(PointCloud(points), options), std::invalid_argument);
}

// A block whose top is a wave.
void TheFreeTopIsAFaceOfItsOwn(double sigma) {
  SCOPED_TRACE(sigma);
  TruthPart part = BoxPart();
  TruthFace top = FlatFace({0, 0, 0.4}, {1, 0, 0}, {0, 0.7, 0});
  const auto flat = top.place;
  top.shape = FreeForm();
  top.place = [flat](double u, double v) -> Eigen::Vector3d {
    return flat(u, v) + Eigen::Vector3d(0, 0, 0.05 * std::sin(7 * u) * std::cos(5 * v));
  };
  part.faces[1] = top;
  const PartCloud cloud = SampledPart(part, kPoints, sigma, 7);
  const PartsFit fit = Fitted(cloud);
  const std::vector<int> truth = TruthOf(fit, cloud);
  double free_points = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    if (fit.summary.faces[k].kind == "free") {
      EXPECT_EQ(truth[k], 1);
      free_points += static_cast<double>(fit.summary.faces[k].points);
    }
  }
  // Most of it: a ring along its rim has neighbours over the edge.
  constexpr double kMost = 0.8;
  const auto all = std::count(cloud.face.begin(), cloud.face.end(), 1);
  EXPECT_GT(free_points, kMost * static_cast<double>(all));
}

TEST(FitPartsTest, AFreeSurfaceIsAFaceOfItsOwn) { TheFreeTopIsAFaceOfItsOwn(1e-4); }

TEST(LongFitPartsTest, AFreeSurfaceIsAFaceOfItsOwn) { TheFreeTopIsAFaceOfItsOwn(1e-3); }

// A cylinder is as near to a bevel and as much of the top, but the top has sharp edges, which no
// free surface has.
TEST(FitPartsTest, ABevelThatARoundFaceWouldExplainAsWellLeavesTheTopPlane) {
  TruthPart part = BoxPart();
  constexpr double kSlope = 0.3, kWide = 0.2;
  part.faces[1] = FlatFace({0, 0, 0.4}, {1 - kWide, 0, 0}, {0, 0.7, 0});
  part.faces.push_back(FlatFace({1 - kWide, 0, 0.4}, {kWide, 0, -kSlope * kWide}, {0, 0.7, 0}));
  PartFitOptions options;
  options.tolerance = 0.02;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const PartCloud cloud = SampledPart(part, kPoints, 3e-3, seed);
    const PartsFit fit = Fitted(cloud, options);
    const std::vector<int> truth = TruthOf(fit, cloud);
    const auto top = std::find(truth.begin(), truth.end(), 1);
    ASSERT_NE(top, truth.end());
    EXPECT_EQ(fit.summary.faces[std::size_t(top - truth.begin())].kind, "plane");
  }
}

// More than regions grow over: they have their faces, and all of their points.
TEST(FitPartsTest, ManyPointsHaveTheFacesOfFew) {
  const TruthPart part = FlangePart();
  constexpr double kRight = 0.99;
  for (const double sigma : {0.0, 1e-3}) {
    SCOPED_TRACE(sigma);
    const PartCloud cloud = SampledPart(part, 90000, sigma, 3);
    const PartsFit fit = Fitted(cloud);
    const std::vector<int> truth = TruthOf(fit, cloud);
    EXPECT_EQ(std::set<int>(truth.begin(), truth.end()).size(), part.faces.size());
    EXPECT_EQ(truth.size(), part.faces.size());
    double right = 0;
    for (std::size_t k = 0; k < cloud.face.size(); ++k)
      right += fit.labels[k] >= 0 && truth[std::size_t(fit.labels[k])] == cloud.face[k];
    EXPECT_GE(right, kRight * static_cast<double>(cloud.face.size()));
  }
}

// Free faces beside exact ones, or alone, and strays: each is as far as the nearest face, trimmed,
// as written.
TEST(FitPartsTest, PointsOfNoFaceAreMeasuredFromTheNearest) {
  for (const bool alone : {true, false}) {
    SCOPED_TRACE(alone ? "a free face" : "a free face and a plane");
    std::mt19937_64 engine(5);
    std::uniform_real_distribution<double> even(0, 1);
    Eigen::Matrix3Xd points(3, alone ? 2060 : 4060);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double x = 10 * even(engine), y = 8 * even(engine);
      if (k < 60) {
        points.col(k) << x, y, 4 + 8 * even(engine);
      } else if (k < 2060) {
        points.col(k) << x, y, std::sin(0.8 * x) * std::cos(0.7 * y);
      } else {
        points.col(k) << x, y, 14;
      }
    }
    PartFitOptions options;
    options.shift = Eigen::Vector3d(100, 200, 300);
    const PartsFit fit = FitParts(PointCloud::FromWorld(points.colwise() + options.shift), options);
    ASSERT_FALSE(fit.faces.empty());
    ThreadPool pool(2);
    std::vector<Eigen::VectorXd> off;
    for (const PartFace& face : fit.faces)
      off.push_back(DistancesTo(face.surface, points, pool).distances.cwiseAbs());
    int of_none = 0, free = 0;
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      if (fit.labels[std::size_t(k)] >= 0) continue;
      ++of_none;
      double nearest = off[0][k];
      for (const Eigen::VectorXd& one : off) nearest = std::min(nearest, one[k]);
      const std::size_t owner = std::size_t(fit.owners[std::size_t(k)]);
      free += !fit.faces[owner].patch;
      EXPECT_NEAR(std::abs(fit.residuals[k]), nearest, kIterated * 10) << k;
      EXPECT_NEAR(off[owner][k], nearest, kIterated * 10) << k;
    }
    EXPECT_GT(of_none, 30);
    EXPECT_GT(free, 5);
  }
}

}  // namespace fit_parts_test
}  // namespace batten::internal
