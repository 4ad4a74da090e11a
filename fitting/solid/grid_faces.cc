// SPDX-License-Identifier: MIT
#include "fitting/solid/grid_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "batten/fitting/refused_data.h"

namespace batten::internal {
namespace {

constexpr std::array<Complex, 4> kOutwards = {Complex(0, -1), 1, Complex(0, 1), -1};  // of sides

class GridWalker {
 public:
  GridWalker(const TriangleSurface& surface,
             const TriangleTopology& topology,
             const GridMap& map,
             const std::vector<char>& creases)
      : surface_(surface),
        topology_(topology),
        map_(map),
        creases_(creases),
        in_triangle_(std::size_t(topology.triangles())) {
    for (int t = 0; t < topology.triangles(); ++t) FindMiddles(t);
  }

  QuadMesh Faces() {
    FindTwins();
    const auto sides = static_cast<int>(twin_.size());
    std::vector<int> vertex(std::size_t(sides), -1);
    std::vector<Eigen::Vector3d> places;
    for (int first = 0; first < sides; ++first) {
      if (vertex[std::size_t(first)] >= 0 || middles_[std::size_t(first / 4)].gone) continue;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      int valence = 0;
      int h = first;
      do {
        vertex[std::size_t(h)] = static_cast<int>(places.size());
        sum += middles_[std::size_t(h / 4)].place;
        ++valence;
        h = twin_[std::size_t((h & ~3) | ((h + 3) & 3))];
      } while (h != first);
      places.push_back(sum / valence);
    }
    QuadMesh mesh;
    mesh.vertices.resize(3, Eigen::Index(places.size()));
    for (std::size_t k = 0; k < places.size(); ++k) mesh.vertices.col(Eigen::Index(k)) = places[k];
    mesh.faces.resize(4, sides / 4);
    Eigen::Index faces = 0;
    for (int f = 0; f < sides / 4; ++f) {
      if (middles_[std::size_t(f)].gone) continue;
      for (int k = 0; k < 4; ++k) mesh.faces(k, faces) = vertex[std::size_t(4 * f + k)];
      ++faces;
    }
    mesh.faces.conservativeResize(4, faces);
    for (int h = 0; h < sides; ++h) {
      if (middles_[std::size_t(h / 4)].gone || !crossing_[std::size_t(h)]) continue;
      const int other = twin_[std::size_t(h)];
      if (other < h) continue;
      mesh.creases.conservativeResize(2, mesh.creases.cols() + 1);
      mesh.creases.rightCols(1) << vertex[std::size_t(h)],
          vertex[std::size_t((h & ~3) | ((h + 1) & 3))];
    }
    return mesh;
  }

 private:
  struct Middle {
    int triangle;
    Complex at;  // in its chart
    Eigen::Vector3d place;
    bool gone = false;
  };

  const Complex* CornersOf(int t) const { return &map_.corners[std::size_t(3 * t)]; }

  void FindMiddles(int t) {
    const Complex* p = CornersOf(t);
    const double area = AreaOf(p[1] - p[0], p[2] - p[0]);
    if (!(area > 0)) return;
    const auto [left, right] = std::minmax({p[0].real(), p[1].real(), p[2].real()});
    const auto [low, high] = std::minmax({p[0].imag(), p[1].imag(), p[2].imag()});
    for (double u = std::ceil(left - 0.5) + 0.5; u <= right; ++u) {
      for (double v = std::ceil(low - 0.5) + 0.5; v <= high; ++v) {
        const Complex at(u, v);
        const Eigen::Vector3d share = Eigen::Vector3d(AreaOf(p[1] - at, p[2] - at),
                                                      AreaOf(p[2] - at, p[0] - at),
                                                      AreaOf(p[0] - at, p[1] - at)) /
                                      area;
        if (share.minCoeff() < 0) continue;
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        for (int k = 0; k < 3; ++k) {
          place += share[k] * surface_.vertices.col(surface_.triangles(k, t));
        }
        in_triangle_[std::size_t(t)].push_back(static_cast<int>(middles_.size()));
        middles_.push_back({t, at, place, false});
      }
    }
  }

  // The middle at this place of a triangle; −1: none.
  int MiddleAt(int t, Complex at) const {
    for (const int k : in_triangle_[std::size_t(t)]) {
      const Middle& middle = middles_[std::size_t(k)];
      if (!middle.gone && std::abs(middle.at - at) < 0.25) return k;
    }
    return -1;
  }

  // The side of the face reached by a unit step out of a face; −1: none. Along the line of the grid
  // from triangle to triangle, through those that turn over as well.
  int Reached(int side) {
    crossing_[std::size_t(side)] = 0;
    const Middle& from = middles_[std::size_t(side >> 2)];
    Complex direction = kOutwards[std::size_t(side & 3)];
    Complex goal = from.at + direction;
    int t = from.triangle;
    int entered = -1;
    constexpr int kMost = 10000;
    for (int step = 0; step < kMost; ++step) {
      if (const int found = MiddleAt(t, goal); found >= 0) {
        for (int k = 0; k < 4; ++k) {
          if (std::abs(kOutwards[std::size_t(k)] + direction) < 0.5) return 4 * found + k;
        }
      }
      const int left = ExitOf(t, goal, direction, entered);
      if (left < 0) return -1;
      crossing_[std::size_t(side)] ^= creases_[std::size_t(left)];
      goal = map_.Across(left, goal);
      direction = map_.DirectionAcross(left, direction);
      entered = topology_.Twin(left);
      t = entered / 3;
    }
    return -1;
  }

  // The half-edge through which the line leaves a triangle that it entered, or, if none, in which
  // it begins.
  int ExitOf(int t, Complex goal, Complex direction, int entered) const {
    const Complex* p = CornersOf(t);
    const bool over = !(AreaOf(p[1] - p[0], p[2] - p[0]) > 0);
    for (int k = 0; k < 3; ++k) {
      const int h = 3 * t + k;
      if (h == entered) continue;
      const double one = AreaOf(direction, p[k] - goal);
      const double two = AreaOf(direction, p[(k + 1) % 3] - goal);
      if ((one < 0) == (two < 0)) continue;
      // Counter-clockwise triangles have the outer side of an edge that is left on its right.
      if (entered >= 0 || (one < 0) != over) return h;
    }
    return -1;
  }

  // Where triangles turn over, a square may have its middle at several places: those go that lines
  // do not lead back to.
  void FindTwins() {
    const std::size_t sides = 4 * middles_.size();
    twin_.resize(sides);
    crossing_.resize(sides);
    constexpr std::size_t kMost = 20;  // one in so many middles goes
    std::size_t lost = 0;
    for (std::size_t gone = 0; gone <= middles_.size() / kMost; ++gone) {
      for (std::size_t h = 0; h < sides; ++h) {
        twin_[h] = middles_[h / 4].gone ? -1 : Reached(static_cast<int>(h));
      }
      std::vector<int> doubts(middles_.size(), 0);
      lost = 0;
      for (std::size_t h = 0; h < sides; ++h) {
        if (middles_[h / 4].gone) continue;
        const int other = twin_[h];
        if (other >= 0 && other != static_cast<int>(h) &&
            twin_[std::size_t(other)] == static_cast<int>(h)) {
          continue;
        }
        ++lost;
        ++doubts[h / 4];
      }
      if (lost == 0) return;
      const auto worst = std::max_element(doubts.begin(), doubts.end());
      middles_[std::size_t(worst - doubts.begin())].gone = true;
    }
    throw RefusedData(std::to_string(lost) + " sides of faces of " + std::to_string(sides) +
                      " have none beside them");
  }

  const TriangleSurface& surface_;
  const TriangleTopology& topology_;
  const GridMap& map_;
  const std::vector<char>& creases_;
  std::vector<Middle> middles_;
  std::vector<std::vector<int>> in_triangle_;
  std::vector<int> twin_;       // of sides 4f + k, as half-edges of QuadTopology
  std::vector<char> crossing_;  // whether a crease lies between the two
};

}  // namespace

QuadMesh FacesOfGrid(const TriangleSurface& surface,
                     const TriangleTopology& topology,
                     const GridMap& map,
                     const std::vector<char>& creases) {
  return GridWalker(surface, topology, map, creases).Faces();
}

}  // namespace batten::internal
