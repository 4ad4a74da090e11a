// SPDX-License-Identifier: MIT
// Laws of solids of plane faces.
#include "batten/fitting/faceted_solid.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "batten/fitting/closed_surface.h"

namespace batten::internal::faceted_solid_test {
namespace {

// A prism over a plane ring of corners with a ring inside (none: no hole), each corner cut into
// triangles by `cuts` more vertices along every edge.
struct Prism {
  Eigen::Matrix3Xd vertices;
  std::vector<std::vector<int>> faces;
};

Prism RingPrism(
    int outer, double hole, int sides, const Eigen::Matrix3d& turn, double scale, bool in_single) {
  Prism prism;
  std::vector<Eigen::Vector3d> at;
  const auto add = [&](double r, int k, double z) {
    const double angle = 2 * std::numbers::pi * k / outer;
    Eigen::Vector3d p =
        scale * (turn * Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z));
    if (in_single) p = p.cast<float>().cast<double>();
    at.push_back(p);
  };
  // Rings: outer and inner, at `sides` + 1 heights.
  for (int level = 0; level <= sides; ++level) {
    for (int k = 0; k < outer; ++k) add(1, k, double(level) / sides);
    for (int k = 0; k < outer; ++k) add(hole, k, double(level) / sides);
  }
  const auto number = [&](int level, int ring, int k) {
    return 2 * outer * level + outer * ring + k % outer;
  };
  const auto quad = [&](int a, int b, int c, int d) {
    prism.faces.push_back({a, b, c});
    prism.faces.push_back({a, c, d});
  };
  for (int k = 0; k < outer; ++k) {
    for (int level = 0; level < sides; ++level) {
      quad(number(level, 0, k),
           number(level, 0, k + 1),
           number(level + 1, 0, k + 1),
           number(level + 1, 0, k));
      quad(number(level, 1, k + 1),
           number(level, 1, k),
           number(level + 1, 1, k),
           number(level + 1, 1, k + 1));
    }
    quad(number(0, 0, k + 1), number(0, 0, k), number(0, 1, k), number(0, 1, k + 1));
    quad(
        number(sides, 0, k), number(sides, 0, k + 1), number(sides, 1, k + 1), number(sides, 1, k));
  }
  prism.vertices.resize(3, std::ssize(at));
  for (std::size_t k = 0; k < at.size(); ++k) prism.vertices.col(Eigen::Index(k)) = at[k];
  return prism;
}

// Every edge is run along once each way, ends where it says, and faces obey Euler and Poincaré.
void ExpectClosed(const TrimmedSolid& solid, int genus) {
  std::vector<int> uses(solid.edges.size(), 0), ways(solid.edges.size(), 0);
  int rings = 0;
  for (const TrimmedSolidFace& face : solid.faces) {
    ASSERT_FALSE(face.loops.empty());
    rings += static_cast<int>(face.loops.size()) - 1;
    for (const auto& loop : face.loops) {
      ASSERT_GE(loop.size(), 3u);
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const auto end = [&](const TrimmedSolidCoedge& c) {
          return c.reversed ? solid.edges[std::size_t(c.edge)].start
                            : solid.edges[std::size_t(c.edge)].end;
        };
        const auto start = [&](const TrimmedSolidCoedge& c) {
          return c.reversed ? solid.edges[std::size_t(c.edge)].end
                            : solid.edges[std::size_t(c.edge)].start;
        };
        EXPECT_EQ(end(loop[k]), start(loop[(k + 1) % loop.size()]));
        ++uses[std::size_t(loop[k].edge)];
        ways[std::size_t(loop[k].edge)] += loop[k].reversed ? -1 : 1;
      }
    }
  }
  for (std::size_t e = 0; e < uses.size(); ++e) {
    EXPECT_EQ(uses[e], 2);
    EXPECT_EQ(ways[e], 0);
  }
  const int v = static_cast<int>(solid.vertices.cols()), e = static_cast<int>(solid.edges.size()),
            f = static_cast<int>(solid.faces.size());
  EXPECT_EQ(v - e + f - rings, 2 - 2 * genus);
}

// By the divergence theorem over the loops, with no word of the mesh.
double VolumeByLoops(const TrimmedSolid& solid) {
  double volume = 0;
  for (const TrimmedSolidFace& face : solid.faces) {
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    for (const auto& loop : face.loops) {
      for (const TrimmedSolidCoedge& c : loop) {
        const TrimmedSolidEdge& edge = solid.edges[std::size_t(c.edge)];
        const Eigen::Vector3d a = solid.vertices.col(c.reversed ? edge.end : edge.start),
                              b = solid.vertices.col(c.reversed ? edge.start : edge.end);
        area += a.cross(b) / 2;
      }
    }
    const PlaneShape& plane = std::get<PlaneShape>(face.carrier);
    volume += plane.point.dot(plane.normal) * area.dot(plane.normal) / 3;
  }
  return volume;
}

TEST(FacetedSolidTest, HasThePlanesOfTheMeshItsHandlesAndItsVolume) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (const int corners : {3, 4, 7, 40}) {
    for (const int levels : {1, 3}) {
      for (const bool in_single : {false, true}) {
        SCOPED_TRACE(testing::Message()
                     << corners << " corners, " << levels << " levels, in single " << in_single);
        Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
        const double scale = std::pow(10, normal(random));
        const Prism prism =
            RingPrism(corners, 0.4, levels, turn.normalized().toRotationMatrix(), scale, in_single);
        const ClosedSurface closed = CloseSurface(prism.vertices, prism.faces);
        ASSERT_EQ(closed.filled, 0);
        const FacetedMesh made = FacetedSolid(closed.surface, SinglePrecisionOf(prism.vertices));
        EXPECT_EQ(made.solid.faces.size(), std::size_t(2 * corners + 2));
        EXPECT_EQ(made.solid.edges.size(), std::size_t(6 * corners));
        EXPECT_EQ(made.solid.vertices.cols(), 4 * corners);
        ExpectClosed(made.solid, 1);
        const double volume = VolumeOf(closed.surface).volume;
        const double polygon = corners * std::sin(2 * std::numbers::pi / corners) / 2;
        EXPECT_NEAR(volume, std::pow(scale, 3) * polygon * (1 - 0.16), 1e-5 * volume);
        EXPECT_NEAR(VolumeByLoops(made.solid), volume, 1e-5 * volume);
      }
    }
  }
}

TEST(FacetedSolidTest, TrianglesThatAreNotOfOnePlaneStayFacesOfTheirOwn) {
  // An octahedron whose corners are moved, so that no two triangles are of one plane.
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> push(0.8, 1.2);
  Eigen::Matrix3Xd corners = Eigen::Matrix3Xd::Zero(3, 6);
  for (int k = 0; k < 6; ++k) corners(k / 2, k) = (k % 2 ? -1 : 1) * push(random);
  std::vector<std::vector<int>> faces;
  for (int x : {0, 1}) {
    for (int y : {2, 3}) {
      for (int z : {4, 5}) {
        const bool turned = (x + y + z) % 2 != 0;
        faces.push_back(turned ? std::vector<int>{x, z, y} : std::vector<int>{x, y, z});
      }
    }
  }
  const ClosedSurface closed = CloseSurface(corners, faces);
  const FacetedMesh made = FacetedSolid(closed.surface, SinglePrecisionOf(corners));
  EXPECT_EQ(made.solid.faces.size(), 8u);
  ExpectClosed(made.solid, 0);
  EXPECT_NEAR(VolumeByLoops(made.solid), VolumeOf(closed.surface).volume, 1e-12);
}

// As files hold them whose triangles were rounded one by one.
TEST(CloseSurfaceTest, VerticesThatDifferInTheLastDigitsAreOne) {
  std::mt19937_64 random(7);
  for (const double off : {1e-7, 1e-6, 1e-5}) {
    SCOPED_TRACE(off);
    std::uniform_real_distribution<double> shift(-off, off);
    const Prism prism = RingPrism(12, 0.4, 2, Eigen::Matrix3d::Identity(), 1, false);
    Eigen::Matrix3Xd corners(3, 3 * std::ssize(prism.faces));
    std::vector<std::vector<int>> faces;
    for (const std::vector<int>& face : prism.faces) {
      std::vector<int>& own = faces.emplace_back();
      for (const int v : face) {
        const Eigen::Index k = 3 * (std::ssize(faces) - 1) + std::ssize(own);
        corners.col(k) =
            prism.vertices.col(v) + Eigen::Vector3d(shift(random), shift(random), shift(random));
        own.push_back(int(k));
      }
    }
    const ClosedSurface closed = CloseSurface(corners, faces);
    EXPECT_EQ(closed.filled, 0);
    EXPECT_EQ(closed.genus, 1);
    EXPECT_EQ(closed.surface.vertices.cols(), prism.vertices.cols());
    EXPECT_EQ(closed.joined, corners.cols() - prism.vertices.cols());
    EXPECT_NEAR(VolumeOf(closed.surface).volume,
                VolumeOf(CloseSurface(prism.vertices, prism.faces).surface).volume,
                20 * off);
  }
}

}  // namespace
}  // namespace batten::internal::faceted_solid_test
