// SPDX-License-Identifier: MIT
// Faces that are not quite a closed surface become one.
#include "batten/fitting/closed_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "batten/fitting/faceted_solid.h"
#include "batten/fitting/refused_data.h"
#include "fitting/solid/triangle_topology.h"

namespace batten::internal::closed_surface_test {

using ::testing::HasSubstr;

constexpr unsigned kSeed = 20261129;

struct Faces {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::vector<int>> faces;

  // The box between two corners, with vertices of its own.
  void AddBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const int first = static_cast<int>(vertices.size());
    for (int k = 0; k < 8; ++k) {
      vertices.emplace_back(
          k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]);
    }
    const std::vector<std::vector<int>> sides = {
        {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (std::vector<int> side : sides) {
      for (int& v : side) v += first;
      faces.push_back(side);
    }
  }
  Eigen::Matrix3Xd columns() const {
    Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(vertices.size()));
    for (size_t k = 0; k < vertices.size(); ++k)
      all.col(static_cast<Eigen::Index>(k)) = vertices[k];
    return all;
  }
  ClosedSurface Closed() const { return CloseSurface(columns(), faces); }
};

// A staircase whose two blocks meet along an edge only, and over it a bridge that joins them: one
// body, and no manifold at that edge.
Faces Bridge() {
  Faces bridge;
  bridge.AddBox({0, 0, 0}, {1, 1, 1});
  bridge.AddBox({1, 1, 0}, {2, 2, 1});
  return bridge;
}

TEST(CloseSurfaceTest, BodiesThatTouchAlongAnEdgeAreParted) {
  std::mt19937 random(kSeed);
  for (int round = 0; round < 8; ++round) {
    SCOPED_TRACE(round);
    Faces two = Bridge();
    std::shuffle(two.faces.begin(), two.faces.end(), random);
    const Eigen::Matrix3d turn = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
    for (Eigen::Vector3d& v : two.vertices) v = turn * v;
    // Of one place, whatever the rotation rounds to.
    two.vertices[8] = two.vertices[3];
    two.vertices[12] = two.vertices[7];
    const ClosedSurface closed = two.Closed();
    EXPECT_EQ(closed.components, 2);
    EXPECT_EQ(closed.filled, 0);
    EXPECT_NEAR(VolumeOf(closed.surface).volume, 2, 1e-12);
    EXPECT_NO_THROW(TriangleTopology(closed.surface));
  }
}

// Two brackets whose boxes overlap and that leave one another alone, a bar beside them, and the
// same with the bar through one of them, or in it.
TEST(CloseSurfaceTest, BodiesMayBeBesideButNotInOneAnother) {
  const auto bracket = [](Faces& into, double x, double y, double turn) {
    // An L of two cells, (0,0)-(3,1) and (0,1)-(1,3), as one concave prism.
    const std::vector<Eigen::Vector2d> corners = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
    const int first = static_cast<int>(into.vertices.size()), n = 6;
    for (const double z : {0.0, 1.0})
      for (const Eigen::Vector2d& p : corners)
        into.vertices.emplace_back(x + turn * p[0], y + turn * p[1], z);
    std::vector<int> bottom, top;
    for (int k = 0; k < n; ++k) {
      into.faces.push_back(
          {first + k, first + (k + 1) % n, first + (k + 1) % n + n, first + k + n});
      bottom.insert(bottom.begin(), first + k);
      top.push_back(first + k + n);
    }
    into.faces.push_back(bottom);
    into.faces.push_back(top);
  };
  Faces beside;
  bracket(beside, 0, 0, 1);
  bracket(beside, 4, 4, -1);  // its box is (1,1)-(4,4)
  const ClosedSurface closed = beside.Closed();
  EXPECT_EQ(closed.components, 2);
  EXPECT_NEAR(VolumeOf(closed.surface).volume, 10, 1e-12);
  const auto refusal = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) -> std::string {
    Faces with = beside;
    with.AddBox(low, high);
    try {
      with.Closed();
    } catch (const RefusedData& refused) {
      return refused.what();
    }
    return "";
  };
  EXPECT_EQ(refusal({1.2, 1.2, 0}, {1.4, 1.4, 1}), "");
  EXPECT_THAT(refusal({0.2, 0.2, 0.2}, {0.4, 0.4, 0.4}), HasSubstr("one lies in another"));
  EXPECT_THAT(refusal({0.2, 0.2, -1}, {0.4, 0.4, 2}), HasSubstr("two run through one another"));
  EXPECT_THAT(refusal({-1, 0.2, 0.2}, {5, 0.4, 0.4}), HasSubstr("two run through one another"));
}

// Two prongs of a fork that touch along an edge at their tips, on one base.
TEST(CloseSurfaceTest, ABodyThatTouchesItselfAlongAnEdgeIsOneWithTheEdgeTwice) {
  // Cells of a grid of unit cubes: a ring of 3 x 3 less its centre and a corner's neighbour … the
  // cells (0,1) and (1,0) touch along the edge at (1,1) and hang together round it.
  const std::vector<std::pair<int, int>> cells = {
      {0, 1}, {0, 2}, {1, 2}, {2, 2}, {2, 1}, {2, 0}, {1, 0}};
  const auto solid = [&](int x, int y) {
    return std::find(cells.begin(), cells.end(), std::pair(x, y)) != cells.end();
  };
  Faces fork;
  const auto at = [&](int x, int y, int z) {
    fork.vertices.emplace_back(x, y, z);
    return static_cast<int>(fork.vertices.size()) - 1;
  };
  for (const auto& [x, y] : cells) {
    fork.faces.push_back({at(x, y, 0), at(x, y + 1, 0), at(x + 1, y + 1, 0), at(x + 1, y, 0)});
    fork.faces.push_back({at(x, y, 1), at(x + 1, y, 1), at(x + 1, y + 1, 1), at(x, y + 1, 1)});
    if (!solid(x - 1, y))
      fork.faces.push_back({at(x, y, 0), at(x, y, 1), at(x, y + 1, 1), at(x, y + 1, 0)});
    if (!solid(x + 1, y)) {
      fork.faces.push_back(
          {at(x + 1, y, 0), at(x + 1, y + 1, 0), at(x + 1, y + 1, 1), at(x + 1, y, 1)});
    }
    if (!solid(x, y - 1))
      fork.faces.push_back({at(x, y, 0), at(x + 1, y, 0), at(x + 1, y, 1), at(x, y, 1)});
    if (!solid(x, y + 1)) {
      fork.faces.push_back(
          {at(x, y + 1, 0), at(x, y + 1, 1), at(x + 1, y + 1, 1), at(x + 1, y + 1, 0)});
    }
  }
  std::mt19937 random(kSeed);
  for (int round = 0; round < 6; ++round) {
    SCOPED_TRACE(round);
    std::shuffle(fork.faces.begin(), fork.faces.end(), random);
    const ClosedSurface closed = fork.Closed();
    EXPECT_EQ(closed.filled, 0);
    EXPECT_EQ(closed.turned, 0);
    EXPECT_EQ(closed.components, 1);
    EXPECT_EQ(closed.genus, 0);  // open between the prongs: they touch, and do not hang together
    EXPECT_NEAR(VolumeOf(closed.surface).volume, 7, 1e-12);
    EXPECT_NO_THROW(TriangleTopology(closed.surface));
  }
}

TEST(CloseSurfaceTest, FacesAreTurnedOutwardsAndThoseThereTwiceDropped) {
  std::mt19937 random(kSeed);
  for (int round = 0; round < 10; ++round) {
    SCOPED_TRACE(round);
    Faces box;
    box.AddBox({0, 0, 0}, {1, 2, 3});
    box.AddBox({5, 0, 0}, {6, 1, 1});
    for (std::vector<int>& face : box.faces) {
      if (random() % 3 == 0) std::reverse(face.begin(), face.end());
    }
    box.faces.push_back(box.faces[2]);
    std::shuffle(box.faces.begin(), box.faces.end(), random);
    const ClosedSurface closed = box.Closed();
    EXPECT_EQ(closed.components, 2);
    EXPECT_EQ(closed.filled, 0);
    EXPECT_NEAR(VolumeOf(closed.surface).volume, 7, 1e-12);
    EXPECT_NO_THROW(TriangleTopology(closed.surface));
  }
}

// A prism over a star, its caps one face each, begun at any corner.
TEST(CloseSurfaceTest, ConcaveFacesAreCutInside) {
  const int corners = 14;
  double area = 0;
  std::vector<Eigen::Vector2d> star;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * EIGEN_PI * k / corners, radius = k % 2 ? 1 : 3;
    star.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  for (int k = 0; k < corners; ++k) {
    const Eigen::Vector2d &a = star[size_t(k)], &b = star[size_t((k + 1) % corners)];
    area += (a[0] * b[1] - a[1] * b[0]) / 2;
  }
  for (int first = 0; first < corners; ++first) {
    SCOPED_TRACE(first);
    Faces prism;
    for (const double z : {0.0, 2.0})
      for (const Eigen::Vector2d& p : star) prism.vertices.emplace_back(p[0], p[1], z);
    std::vector<int> bottom, top;
    for (int k = 0; k < corners; ++k) {
      const int a = (first + k) % corners, b = (a + 1) % corners;
      prism.faces.push_back({a, b, b + corners, a + corners});
      bottom.insert(bottom.begin(), a);
      top.push_back(a + corners);
    }
    prism.faces.push_back(bottom);
    prism.faces.push_back(top);
    const ClosedSurface closed = prism.Closed();
    EXPECT_EQ(closed.turned, 0);
    EXPECT_NEAR(VolumeOf(closed.surface).volume, 2 * area, 1e-12 * area);
    double surface = 0;
    for (Eigen::Index t = 0; t < closed.surface.triangles.cols(); ++t) {
      const auto corner = [&](int k) {
        return Eigen::Vector3d(closed.surface.vertices.col(closed.surface.triangles(k, t)));
      };
      surface += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
    }
    double sides = 0;
    for (int k = 0; k < corners; ++k)
      sides += 2 * (star[size_t((k + 1) % corners)] - star[size_t(k)]).norm();
    EXPECT_NEAR(surface, 2 * area + sides, 1e-12 * surface);
  }
}

TEST(CloseSurfaceTest, ThreeFacesAtAnEdgeAreNoBodiesThatTouch) {
  Faces box;
  box.AddBox({0, 0, 0}, {1, 1, 1});
  box.vertices.emplace_back(2, 0, 0.5);
  box.faces.push_back({1, 5, 8});
  try {
    box.Closed();
    ADD_FAILURE() << "a fin stands off the box";
  } catch (const RefusedData& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("more than two faces meet at 1 edge"));
  }
}

// The caps of holes are of the body around them, whichever it is.
TEST(CloseSurfaceTest, HolesAreClosedWithinTheirBody) {
  Faces boxes;
  boxes.AddBox({0, 0, 0}, {4, 4, 4});
  boxes.AddBox({9, 0, 0}, {10, 1, 1});
  std::reverse(boxes.faces[7].begin(), boxes.faces[7].end());
  boxes.faces.erase(boxes.faces.begin() + 8);
  const ClosedSurface closed = boxes.Closed();
  EXPECT_EQ(closed.filled, 1);
  EXPECT_NEAR(closed.filled_share, 1.0 / (96 + 6), 1e-12);
  EXPECT_NEAR(VolumeOf(closed.surface).volume, 65, 1e-12);
  EXPECT_NO_THROW(TriangleTopology(closed.surface));
}

}  // namespace batten::internal::closed_surface_test
