// SPDX-License-Identifier: MIT
#include "fitting/regions/free_pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/regions/region_shape.h"
#include "fitting/regions/settle_regions.h"

namespace batten::internal {
namespace {

// The places where two regions are neighbours.
struct Border {
  RegionPair regions;
  std::vector<Eigen::Vector3d> places;
  bool smooth = true;  // a sharp one is not arbitrary
  bool arbitrary = false;
};

// Regions, and left-over pieces as further ones without a shape.
struct Pieces {
  RegionLabels labels;
  int shapes = 0;

  std::size_t SizeOf(int k) const { return labels.regions[std::size_t(k)].points.size(); }
};

Pieces WithLeftovers(const RegionPoints& data, const RegionLabels& labels) {
  Pieces pieces{labels, static_cast<int>(labels.regions.size())};
  for (std::vector<int>& left : SmoothLeftovers(data, labels.label, kFewestPoints))
    Append({{}, std::move(left)}, pieces.labels);
  return pieces;
}

std::vector<Border> BordersOf(const RegionPoints& data, const Pieces& pieces) {
  // A piece and a face as much larger tell nothing of one another; left-over points are no face.
  constexpr double kComparable = 8;
  std::vector<Border> borders;
  for (auto& [pair, found] : LinksOf(data, pieces.labels.label)) {
    if (pair.first >= pieces.shapes) continue;
    const auto a = double(pieces.SizeOf(pair.first)), b = double(pieces.SizeOf(pair.second));
    const bool faces = pair.second < pieces.shapes;
    if ((faces ? std::max(a, b) : a) > kComparable * std::min(a, b)) continue;
    const bool smooth = !faces || JoinSmoothly(data, pieces.labels, pair.first, pair.second);
    borders.push_back({pair, std::move(found), smooth});
  }
  return borders;
}

// Half as many of both as the smaller one has, nearest to the middle of the border.
std::vector<int> Across(const RegionPoints& data, const Pieces& pieces, const Border& border) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : border.places) mean += place / double(border.places.size());
  const Eigen::Vector3d middle = *std::min_element(
      border.places.begin(), border.places.end(), [&](const auto& a, const auto& b) {
        return (a - mean).squaredNorm() < (b - mean).squaredNorm();
      });
  const auto [a, b] = border.regions;
  const auto half = std::ptrdiff_t(std::min(pieces.SizeOf(a), pieces.SizeOf(b)) / 2);
  std::vector<int> both;
  for (const int k : {a, b}) {
    std::vector<int> points = pieces.labels.regions[std::size_t(k)].points;
    std::nth_element(points.begin(), points.begin() + half, points.end(), [&](int p, int q) {
      return (data.points.col(p) - middle).squaredNorm() <
             (data.points.col(q) - middle).squaredNorm();
    });
    both.insert(both.end(), points.begin(), points.begin() + half);
  }
  std::sort(both.begin(), both.end());
  return both;
}

// Whether regions are left that lose their points.
bool DissolveOnce(const RegionPoints& data, double sigma, RegionLabels& labels, ThreadPool& pool) {
  const Pieces pieces = WithLeftovers(data, labels);
  std::vector<Border> borders = BordersOf(data, pieces);
  pool.For(std::ssize(borders), 1, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    ThreadPool alone(1);
    for (auto k = begin; k < end; ++k) {
      Border& border = borders[std::size_t(k)];
      if (!border.smooth) continue;
      // At the noise that both show: what misses shape by some hides as much in a third.
      double noise = sigma;
      for (const int side : {border.regions.first, border.regions.second}) {
        if (side >= pieces.shapes) continue;
        const Region& region = labels.regions[std::size_t(side)];
        noise = std::max(noise, TestShape(data, region.points, region.shape, sigma).rms);
      }
      border.arbitrary =
          SimplestShape(data, Across(data, pieces, border), noise, alone).has_value();
    }
  });
  std::vector<double> sure(labels.regions.size()), arbitrary(labels.regions.size());
  for (const Border& border : borders) {
    for (const int k : {border.regions.first, border.regions.second}) {
      if (k < pieces.shapes)
        (border.arbitrary ? arbitrary : sure)[std::size_t(k)] += double(border.places.size());
    }
  }
  // A piece alone is a face: it takes another, or as many left-over points, to make a free surface.
  std::vector<char> partnered(labels.regions.size());
  const auto piece = [&](int k) {
    return k >= pieces.shapes || arbitrary[std::size_t(k)] > sure[std::size_t(k)];
  };
  for (const Border& border : borders) {
    const auto [a, b] = border.regions;
    if (!border.arbitrary || !piece(a) || !piece(b)) continue;
    partnered[std::size_t(a)] = true;
    if (b < pieces.shapes) partnered[std::size_t(b)] = true;
  }
  bool dissolved = false;
  RegionLabels left{{}, std::vector<int>(labels.label.size(), kNoRegion)};
  for (std::size_t k = 0; k < labels.regions.size(); ++k) {
    if (arbitrary[k] > sure[k] && partnered[k]) {
      dissolved = true;
      continue;
    }
    Append(std::move(labels.regions[k]), left);
  }
  labels = std::move(left);
  return dissolved;
}

}  // namespace

void DissolvePieces(const RegionPoints& data,
                    double sigma,
                    RegionLabels& labels,
                    ThreadPool& pool) {
  constexpr int kMostRounds = 4;  // what is next to a free surface shows once that is found
  for (int round = 0; round < kMostRounds && DissolveOnce(data, sigma, labels, pool); ++round) {
  }
}

std::vector<std::vector<int>> SmoothLeftovers(const RegionPoints& data,
                                              const std::vector<int>& label,
                                              int fewest) {
  std::vector<Component> pieces = ConnectedSets(
      data,
      [&](int k) { return label[std::size_t(k)] == kNoRegion && data.turn[k] < kSameSheet; },
      [&](int a, int b) {
        return !(data.normals.col(a).cross(data.normals.col(b)).norm() > kSameSheet);
      });
  std::erase_if(pieces, [&](const Component& piece) { return std::ssize(piece) < fewest; });
  for (Component& piece : pieces) std::sort(piece.begin(), piece.end());
  return pieces;
}

}  // namespace batten::internal
