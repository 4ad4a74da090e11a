// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "geometry/subdivision/spline_faces.h"

namespace batten::internal {
namespace {

// Edges that no block crosses.
class Walls {
 public:
  explicit Walls(const QuadTopology& mesh) : mesh_(mesh), wall_(mesh.edges(), false) {
    std::vector<char> passed(mesh.vertices(), 0);  // where lines end
    std::vector<int> heads = Origins();
    for (const int h : heads) passed[mesh.Origin(h)] = 1;
    for (int h = 0; h < mesh.half_edges(); ++h) {
      if (!mesh.IsCrease(h)) continue;
      wall_[mesh.Edge(h)] = true;
      passed[mesh.Origin(h)] = 1;
    }
    Trace(std::move(heads), std::move(passed));
  }

  bool At(int half_edge) const { return wall_[mesh_.Edge(half_edge)]; }

 private:
  // The half-edges along which lines begin: those of fans that are not plain and, where a smooth
  // part has none, nor a corner, which a grid of faces with four sides has, those of one vertex.
  std::vector<int> Origins() const {
    const std::vector<int> parts = mesh_.SmoothParts();
    const int count = *std::max_element(parts.begin(), parts.end()) + 1;
    std::vector<int> first(count, -1);
    std::vector<bool> has(count, false);
    std::vector<int> heads;
    for (int v = 0; v < mesh_.vertices(); ++v) {
      int h = mesh_.Outgoing(v);
      for (int k = 0; k < mesh_.Valence(v); ++k, h = mesh_.Turned(h)) {
        const int part = parts[h >> 2];
        const QuadFan fan = mesh_.FanOf(h);
        if (first[part] < 0) first[part] = h;
        if (!fan.plain()) heads.push_back(h);
        if (!fan.plain() || fan.corner) has[part] = true;
      }
    }
    for (int part = 0; part < count; ++part) {
      if (has[part]) continue;
      const QuadFan fan = mesh_.FanOf(first[part]);
      int h = fan.first;
      for (int k = 0; k < fan.sectors; ++k, h = mesh_.Turned(h)) heads.push_back(h);
    }
    return heads;
  }

  void Trace(std::vector<int> heads, std::vector<char> passed) {
    while (!heads.empty()) {
      std::vector<int> next;
      for (const int h : heads) {
        if (At(h)) continue;
        wall_[mesh_.Edge(h)] = true;
        const int reached = mesh_.Origin(QuadTopology::Next(h));
        if (passed[reached]) continue;
        passed[reached] = 1;
        next.push_back(mesh_.Right(h));
      }
      heads = std::move(next);
    }
  }

  const QuadTopology& mesh_;
  std::vector<bool> wall_;
};

// The half-edges of a block's lower left corner cells, column by column.
std::vector<int> CellsOf(const QuadTopology& mesh, const QuadBlock& block) {
  std::vector<int> cells;
  int column = block.first;
  for (int a = 0; a < block.across; ++a) {
    int cell = column;
    for (int b = 0; b < block.along; ++b) {
      cells.push_back(cell);
      if (b + 1 < block.along) cell = mesh.Up(cell);
    }
    if (a + 1 < block.across) column = mesh.Right(column);
  }
  return cells;
}

// Whether the block is beside itself, in which case its face would close on itself.
bool MeetsItself(const QuadTopology& mesh,
                 const QuadBlock& block,
                 std::vector<int>& owner,
                 int name) {
  const std::vector<int> cells = CellsOf(mesh, block);
  for (const int cell : cells) owner[cell >> 2] = name;
  const auto at = [&](int a, int b) { return cells[std::size_t(a) * block.along + b]; };
  const auto own = [&](int side) { return owner[mesh.Twin(side) >> 2] == name; };
  for (int a = 0; a < block.across; ++a) {
    if (own(at(a, 0)) || own(QuadTopology::Across(at(a, block.along - 1)))) return true;
  }
  for (int b = 0; b < block.along; ++b) {
    if (own(QuadTopology::Previous(at(0, b))) || own(QuadTopology::Next(at(block.across - 1, b)))) {
      return true;
    }
  }
  return false;
}

std::array<QuadBlock, 2> Halves(const QuadTopology& mesh, const QuadBlock& block) {
  QuadBlock low = block, high = block;
  const bool wide = block.across >= block.along;
  int& low_size = wide ? low.across : low.along;
  int& high_size = wide ? high.across : high.along;
  low_size /= 2;
  high_size -= low_size;
  for (int k = 0; k < low_size; ++k) {
    high.first = wide ? mesh.Right(high.first) : mesh.Up(high.first);
  }
  return {low, high};
}

}  // namespace

std::vector<QuadBlock> MotorcycleBlocks(const QuadTopology& mesh) {
  const Walls walls(mesh);
  std::vector<QuadBlock> found;
  std::vector<bool> covered(mesh.faces(), false);
  for (int face = 0; face < mesh.faces(); ++face) {
    if (covered[face]) continue;
    QuadBlock block{4 * face, 1, 1};
    // To the lower left corner. The first side of a block that goes round is a wall as well.
    while (!walls.At(QuadTopology::Previous(block.first))) block.first = mesh.Left(block.first);
    while (!walls.At(block.first)) block.first = mesh.Down(block.first);
    int last = block.first;
    for (; !walls.At(QuadTopology::Next(last)); ++block.across) last = mesh.Right(last);
    last = block.first;
    for (; !walls.At(QuadTopology::Across(last)); ++block.along) last = mesh.Up(last);
    for (const int cell : CellsOf(mesh, block)) covered[cell >> 2] = true;
    found.push_back(block);
  }
  std::vector<QuadBlock> blocks;
  std::vector<int> owner(mesh.faces(), -1);
  int name = 0;
  while (!found.empty()) {
    const QuadBlock block = found.back();
    found.pop_back();
    if (block.across * block.along > 1 && MeetsItself(mesh, block, owner, name++)) {
      for (const QuadBlock& half : Halves(mesh, block)) found.push_back(half);
    } else {
      blocks.push_back(block);
    }
  }
  return blocks;
}

std::vector<BlockPlace> PlacesInBlocks(const QuadTopology& mesh,
                                       const std::vector<QuadBlock>& blocks) {
  std::vector<BlockPlace> places(mesh.faces());
  for (int b = 0; b < static_cast<int>(blocks.size()); ++b) {
    const std::vector<int> cells = CellsOf(mesh, blocks[b]);
    for (int k = 0; k < static_cast<int>(cells.size()); ++k) {
      places[cells[k] >> 2] = {b, k / blocks[b].along, k % blocks[b].along, cells[k]};
    }
  }
  return places;
}

std::vector<QuadBlock> SubdividedBlocks(std::vector<QuadBlock> blocks) {
  for (QuadBlock& block : blocks) block = {4 * block.first, 2 * block.across, 2 * block.along};
  return blocks;
}

Eigen::Vector2d ParametersInBlock(const BlockPlace& face,
                                  const LimitPlace& place,
                                  int refinements) {
  const double u = place.u / 2, v = place.v / 2;
  Eigen::Vector2d in_cell;
  switch ((place.patch - face.half_edge) & 3) {
    case 0:
      in_cell << u, v;
      break;
    case 1:
      in_cell << 1 - v, u;
      break;
    case 2:
      in_cell << 1 - u, 1 - v;
      break;
    default:
      in_cell << v, 1 - u;
  }
  return (1 << refinements) * (Eigen::Vector2d(face.column, face.row) + in_cell);
}

std::vector<QuadBlock> SingleBlocks(const QuadTopology& mesh) {
  std::vector<QuadBlock> blocks;
  for (int face = 0; face < mesh.faces(); ++face) blocks.push_back({4 * face, 1, 1});
  return blocks;
}

}  // namespace batten::internal
