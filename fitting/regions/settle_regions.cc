// SPDX-License-Identifier: MIT
#include "fitting/regions/settle_regions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "fitting/regions/region_shape.h"

namespace batten::internal {
namespace {

constexpr double kPrice = 0.3;  // of a neighbour of another region, in the units of (d/σ)²/2
constexpr double kTurned = 2;   // price of a normal at right angles to the shape's
constexpr int kMostSweeps = 30, kMostRounds = 4;

// The region that a point pays least for belonging to.
int BestLabel(const RegionPoints& data, const RegionLabels& labels, double sigma, int point) {
  const auto around = data.Around(point);
  int best = kNoRegion;
  double least = kFarPoint * kFarPoint / 2;
  std::vector<int> choices{labels.label[std::size_t(point)]};
  for (const int other : around) choices.push_back(labels.label[std::size_t(other)]);
  std::sort(choices.begin(), choices.end());
  choices.erase(std::unique(choices.begin(), choices.end()), choices.end());
  for (const int choice : choices) {
    if (choice == kNoRegion) continue;
    const FittedSurface& shape = labels.regions[std::size_t(choice)].shape;
    const double off = shape.Distance(data.points.col(point)) / sigma;
    double price = off * off / 2;
    if (!(price < kFarPoint * kFarPoint / 2)) continue;
    const double turned = NormalOff(data, point, shape);
    price += kTurned * turned * turned;
    for (const int other : around) {
      const int there = labels.label[std::size_t(other)];
      if (there != choice && there != kNoRegion) price += kPrice;
    }
    if (best == kNoRegion || price < least) {
      least = price;
      best = choice;
    }
  }
  return best;
}

void Compete(const RegionPoints& data, double sigma, RegionLabels& labels) {
  const auto count = static_cast<int>(data.size());
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    int changes = 0;
    for (int k = 0; k < count; ++k) {
      const int best = BestLabel(data, labels, sigma, k);
      if (best == labels.label[std::size_t(k)]) continue;
      labels.label[std::size_t(k)] = best;
      ++changes;
    }
    if (changes == 0) return;
  }
}

bool Near(const RegionPoints& data, const Component& a, const Component& b) {
  const double far = kFarNeighbour * data.spacing;
  return std::any_of(a.begin(), a.end(), [&](int p) {
    return std::any_of(b.begin(), b.end(), [&](int q) {
      return (data.points.col(p) - data.points.col(q)).squaredNorm() <= far * far;
    });
  });
}

// Narrow components of one label that are near one another are one: the nearest neighbours of a
// point may all be of the faces beside it.
void JoinNarrow(const RegionPoints& data,
                const std::vector<int>& label,
                std::vector<Component>& components) {
  std::vector<std::size_t> narrow;
  for (std::size_t k = 0; k < components.size(); ++k) {
    if (IsNarrow(data, label, components[k])) narrow.push_back(k);
  }
  for (std::size_t i = 0; i < narrow.size(); ++i) {
    Component& one = components[narrow[i]];
    const auto next =
        std::find_if(narrow.begin() + std::ptrdiff_t(i) + 1, narrow.end(), [&](std::size_t k) {
          return label[std::size_t(components[k].front())] == label[std::size_t(one.front())] &&
                 Near(data, one, components[k]);
        });
    if (next == narrow.end()) continue;
    Component& other = components[*next];
    other.insert(other.end(), one.begin(), one.end());
    one.clear();
  }
  std::erase_if(components, [](const Component& one) { return one.empty(); });
}

// Regions as connected sets of points of one label; small ones have no region any more.
void Connect(const RegionPoints& data, RegionLabels& labels) {
  std::vector<Component> components = ComponentsOf(data, labels.label);
  JoinNarrow(data, labels.label, components);
  std::erase_if(components, [](const auto& one) { return std::ssize(one) < kFewestPoints; });
  for (Component& one : components) std::sort(one.begin(), one.end());
  std::sort(components.begin(), components.end());
  RegionLabels parts{{}, std::vector<int>(labels.label.size(), kNoRegion)};
  for (Component& one : components) {
    const int before = labels.label[std::size_t(one.front())];
    Append({labels.regions[std::size_t(before)].shape, std::move(one)}, parts);
  }
  labels = std::move(parts);
}

// Shapes from core points; of the kind they have, or a simpler or richer one where those ask for
// it.
void Refit(const RegionPoints& data, double sigma, RegionLabels& labels, ThreadPool& pool) {
  std::vector<FittedSurface> shapes(labels.regions.size());
  pool.For(std::ssize(shapes), 1, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    ThreadPool alone(1);
    for (auto k = begin; k < end; ++k) {
      const Region& region = labels.regions[std::size_t(k)];
      const std::vector<int> core = CorePoints(data, labels, static_cast<int>(k), sigma);
      const auto simplest = SimplestShape(data, core, sigma, alone);
      if (simplest) {
        shapes[std::size_t(k)] = *simplest;
        continue;
      }
      const auto again = ShapeThrough(data, core, region.shape.kind, sigma, &region.shape);
      shapes[std::size_t(k)] = again.value_or(region.shape);
    }
  });
  for (std::size_t k = 0; k < shapes.size(); ++k) labels.regions[k].shape = shapes[k];
}

// Joins the first pair that one shape explains; whether there was one.
bool JoinOne(const RegionPoints& data,
             double sigma,
             RegionLabels& labels,
             std::map<std::pair<int, int>, bool>& tried,
             ThreadPool& pool) {
  for (const auto& [pair, links] : LinksOf(data, labels.label)) {
    const auto [a, b] = pair;
    const Region &one = labels.regions[std::size_t(a)], &other = labels.regions[std::size_t(b)];
    if (one.points.empty() || other.points.empty() || tried[pair]) continue;
    tried[pair] = true;
    if (!JoinSmoothly(data, labels, a, b)) continue;
    std::vector<int> both;
    std::merge(one.points.begin(),
               one.points.end(),
               other.points.begin(),
               other.points.end(),
               std::back_inserter(both));
    const auto shape = SimplestShape(data, both, sigma, pool);
    if (!shape) continue;
    // Each side by itself: a large one would hide what a small one rejects.
    if (!TestShape(data, one.points, *shape, sigma).passed ||
        !TestShape(data, other.points, *shape, sigma).passed) {
      continue;
    }
    for (const int point : other.points) labels.label[std::size_t(point)] = a;
    labels.regions[std::size_t(a)] = {*shape, std::move(both)};
    labels.regions[std::size_t(b)].points.clear();
    for (auto& [key, done] : tried) {
      if (key.first == a || key.second == a) done = false;
    }
    return true;
  }
  return false;
}

void JoinNeighbours(const RegionPoints& data,
                    double sigma,
                    RegionLabels& labels,
                    ThreadPool& pool) {
  std::map<std::pair<int, int>, bool> tried;
  while (JoinOne(data, sigma, labels, tried, pool)) {
  }
}

}  // namespace

std::vector<Component> ComponentsOf(const RegionPoints& data, const std::vector<int>& label) {
  return ConnectedSets(
      data,
      [&](int k) { return label[std::size_t(k)] != kNoRegion; },
      [&](int a, int b) { return label[std::size_t(a)] == label[std::size_t(b)]; });
}

bool IsNarrow(const RegionPoints& data,
              const std::vector<int>& label,
              const std::vector<int>& points) {
  const auto inside = std::count_if(points.begin(), points.end(), [&](int point) {
    const auto around = data.Around(point);
    return std::all_of(around.begin(), around.end(), [&](int other) {
      return label[std::size_t(other)] == label[std::size_t(point)];
    });
  });
  return 2 * inside < std::ssize(points);
}

bool JoinSmoothly(const RegionPoints& data, const RegionLabels& labels, int a, int b) {
  constexpr double kSmooth = 0.4;  // mean sine
  const FittedSurface &one = labels.regions[std::size_t(a)].shape,
                      &other = labels.regions[std::size_t(b)].shape;
  double sum = 0, count = 0;
  for (const int point : labels.regions[std::size_t(a)].points) {
    for (const int next : data.Around(point)) {
      if (labels.label[std::size_t(next)] != b) continue;
      // At one place: a step between points turns the normal of a narrow fillet.
      const Eigen::Vector3d middle = (data.points.col(point) + data.points.col(next)) / 2;
      const Eigen::Vector3d here = one.TouchingNear(middle).normal;
      sum += here.cross(other.TouchingNear(middle).normal).norm();
      ++count;
    }
  }
  return count > 0 && sum <= kSmooth * count;
}

std::map<RegionPair, std::vector<Eigen::Vector3d>> LinksOf(const RegionPoints& data,
                                                           const std::vector<int>& label) {
  std::map<RegionPair, std::vector<Eigen::Vector3d>> links;
  for (int k = 0; k < static_cast<int>(data.size()); ++k) {
    const int here = label[std::size_t(k)];
    for (const int other : data.Around(k)) {
      const int there = label[std::size_t(other)];
      if (here == kNoRegion || there == kNoRegion || here >= there) continue;
      links[{here, there}].push_back((data.points.col(k) + data.points.col(other)) / 2);
    }
  }
  return links;
}

std::vector<int> CorePoints(const RegionPoints& data,
                            const RegionLabels& labels,
                            int region,
                            double sigma) {
  constexpr int kRings = 4;  // of neighbours: as far as shapes of regions can be confused
  constexpr std::size_t kLeast = 16;
  const Region& own = labels.regions[std::size_t(region)];
  // Which other regions are near each member.
  std::map<int, std::set<int>> near;  // by point
  for (const int point : own.points) {
    for (const int other : data.Around(point)) {
      const int there = labels.label[std::size_t(other)];
      if (there == kNoRegion || there == region) continue;
      near[point].insert(there);
    }
  }
  for (int ring = 1; ring < kRings; ++ring) {
    const auto before = near;
    for (const auto& [point, others] : before) {
      for (const int next : data.Around(point)) {
        if (labels.label[std::size_t(next)] != region) continue;
        near[next].insert(others.begin(), others.end());
      }
    }
  }
  std::vector<int> core;
  for (const int point : own.points) {
    const auto found = near.find(point);
    bool certain = true;
    if (found != near.end()) {
      const Eigen::Vector3d foot = own.shape.TouchingNear(data.points.col(point)).point;
      for (const int other : found->second) {
        const double off = labels.regions[std::size_t(other)].shape.Distance(foot);
        certain = certain && std::abs(off) > kApart * sigma;
      }
    }
    if (certain) core.push_back(point);
  }
  return core.size() >= kLeast ? core : own.points;
}

void SettleRegions(const RegionPoints& data, double sigma, RegionLabels& labels, ThreadPool& pool) {
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<int> before = labels.label;
    // Later rounds move borders only; what can be joined shows once shapes have been fitted again.
    if (round < 2) JoinNeighbours(data, sigma, labels, pool);
    Compete(data, sigma, labels);
    Connect(data, labels);
    Refit(data, sigma, labels, pool);
    if (labels.label == before) break;
  }
}

}  // namespace batten::internal
