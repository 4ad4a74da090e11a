// SPDX-License-Identifier: MIT
#include "geometry/subdivision/spline_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "batten/geometry/iso_curve.h"
#include "batten/geometry/split.h"
#include "geometry/numeric/polygon.h"
#include "geometry/numeric/reject.h"
#include "geometry/subdivision/catmull_clark.h"
#include "geometry/subdivision/limit_surface.h"
#include "geometry/subdivision/smooth_corner.h"

namespace batten::internal {
namespace {

constexpr int kOwned = 4;  // coefficients of a smooth corner in each direction

// The mesh refined so often that corner blocks of neighbouring vertices keep apart, and the
// coefficients of its fans that are not plain.
class RefinedNet {
 public:
  RefinedNet(const QuadTopology& mesh, const Eigen::Matrix3Xd& control_points, int refinements)
      : fine_(mesh), points_(control_points), cells_(1 << refinements) {
    for (int k = 0; k < refinements; ++k) {
      SubdividedMesh finer = Subdivided(fine_);
      points_ = Combined(finer.stencils, points_);
      fine_ = std::move(finer.topology);
    }
    for (int h = 0; h < fine_.half_edges(); ++h) {
      if (fine_.IsCrease(h)) Straighten(h);
    }
  }

  const QuadTopology& topology() const { return fine_; }

  int cells() const { return cells_; }  // along a face of the mesh
  // The cell at the lower left of a block whose u runs along half-edge h of the mesh.
  int CellOf(int h) const { return cells_ * cells_ * h; }

  // The 4 × 4 points about a cell, those beyond creases too.
  Eigen::Matrix<double, 3, 16> PointsAbout(int cell) const {
    const PlainNet net = PlainNetOf(fine_, cell);
    Eigen::Matrix<double, 3, 16> points;
    for (int k = 0; k < 16; ++k) {
      if (net.vertices[k] >= 0) points.col(k) = points_.col(net.vertices[k]);
    }
    net.beyond.Fill([&](int k) { return points.col(k); });
    return points;
  }

  // Coefficient (i, j) of the corner in the sector to the left of an outgoing half-edge whose fan
  // is not plain.
  Eigen::Vector3d Corner(int outgoing, int i, int j) {
    const QuadFan fan = fine_.FanOf(outgoing);
    FanCoefficients& corner = corners_[fan.first];
    if (corner.coefficients.cols() == 0) {
      const CornerKind kind = KindOf(fan);
      corner.places = {fan.sectors, 3, fan.open};
      const Eigen::Matrix3Xd net = NetOf(fan);
      // Masks of even sectors are few, and used again.
      corner.coefficients = kind.cosines.empty()
                                ? Eigen::Matrix3Xd(net * SmoothCorner::Of(kind).mask().transpose())
                                : Eigen::Matrix3Xd(net * SmoothCorner(kind).mask().transpose());
    }
    int sector = 0;
    for (int h = fan.first; h != outgoing; h = fine_.Turned(h)) ++sector;
    return corner.coefficients.col(corner.places.At(sector, i, j));
  }

 private:
  Eigen::Matrix3Xd NetOf(const QuadFan& fan) const {
    const std::vector<int> places =
        RingVertices(fine_, fan.first, RingPlaces{fan.sectors, 3, fan.open});
    Eigen::Matrix3Xd net(3, Eigen::Index(places.size()));
    for (std::size_t k = 0; k < places.size(); ++k)
      net.col(Eigen::Index(k)) = points_.col(places[k]);
    return net;
  }

  // As SmoothCorner needs it: one of few, so that its masks are, but where three faces or more make
  // a corner. There every edge keeps to the net.
  CornerKind KindOf(const QuadFan& fan) const {
    constexpr double kHalf = std::numbers::pi, kWhole = 2 * std::numbers::pi;
    CornerKind kind{{fan.sectors, fan.open, fan.corner}, kWhole};
    const QuadTopology& mesh = fine_;
    if (!fan.open || mesh.Creases(mesh.Origin(fan.first)) == 1) return kind;
    kind.angle = kHalf;
    if (!fan.corner) return kind;
    const Eigen::Vector3d centre = points_.col(mesh.Origin(fan.first));
    std::vector<double> sectors;
    double angle = 0, first = 0, last = 0;  // lengths of creases
    int h = fan.first;
    for (int k = 0; k < fan.sectors; ++k, h = mesh.Turned(h)) {
      const Eigen::Vector3d one = points_.col(mesh.Origin(QuadTopology::Next(h))) - centre;
      const Eigen::Vector3d two = points_.col(mesh.Origin(QuadTopology::Previous(h))) - centre;
      sectors.push_back(AngleBetween(one, two));
      angle += sectors.back();
      if (k == 0) first = one.norm();
      last = two.norm();
    }
    constexpr double kStep = std::numbers::pi / 12;  // edges then fit the net within a tenth
    const double rounded = std::clamp(std::round(angle / kStep), 1.0, 22.0) * kStep;
    if (std::abs(rounded - kHalf) < kStraight) return kind;
    kind.angle = rounded;
    if (fan.sectors == 3 && rounded > kHalf) kind.cosines = CosinesOf(sectors, first, last);
    return kind;
  }

  // Of the two inner edges of three sectors. Those have the lengths with which the sums of the
  // edges beside them run along them.
  static std::vector<double> CosinesOf(std::vector<double> sectors, double first, double last) {
    constexpr double kLeast = std::numbers::pi / 4, kMost = 2 * std::numbers::pi / 3;
    for (double& sector : sectors) sector = std::clamp(sector, kLeast, kMost);
    const double middle = std::sin(sectors[1]);
    const double second = last * std::sin(sectors[2]) / middle;
    const double third = first * std::sin(sectors[0]) / middle;
    return {(third * std::cos(sectors[1]) + first * std::cos(sectors[0])) / (2 * second),
            (last * std::cos(sectors[2]) + second * std::cos(sectors[1])) / (2 * third)};
  }

  // Where a fan of two or more faces has a corner that is nearly straight, the two creases get one
  // tangent line: none in the middle would have a tangent plane else, or a poor one.
  void Straighten(int h) {
    const QuadTopology& mesh = fine_;
    const QuadFan fan = mesh.FanOf(h);
    if (!fan.corner || fan.sectors < 2 || fan.first != h || KindOf(fan).angle != std::numbers::pi)
      return;
    int last = h;
    for (int k = 0; k < fan.sectors; ++k) last = mesh.Turned(last);
    const int centre = mesh.Origin(h);
    const int one = mesh.Origin(QuadTopology::Next(h)), two = mesh.Origin(QuadTopology::Next(last));
    const Eigen::Vector3d half = (points_.col(one) - points_.col(two)) / 2;
    points_.col(one) = points_.col(centre) + half;
    points_.col(two) = points_.col(centre) - half;
  }

  // Corners nearer to 180° are taken for straight, radians.
  static constexpr double kStraight = 0.3;

  struct FanCoefficients {
    RingPlaces places{};
    Eigen::Matrix3Xd coefficients;
  };
  QuadTopology fine_;
  Eigen::Matrix3Xd points_;
  int cells_;
  std::unordered_map<int, FanCoefficients> corners_;  // by the fan's first half-edge
};

// Knots over `cells` cells of one direction of a block; more at ends where fans are not plain.
std::vector<double> KnotsOf(int cells, bool low, bool high) {
  std::vector<double> knots(4, 0.0);
  if (low) knots.insert(knots.end(), {kDoubleKnot, kDoubleKnot, kSingleKnot});
  for (int k = 1; k < cells; ++k) knots.push_back(k);
  if (high) {
    knots.insert(knots.end(), {cells - kSingleKnot, cells - kDoubleKnot, cells - kDoubleKnot});
  }
  knots.insert(knots.end(), 4, cells);
  return knots;
}

// The cell from whose polynomial coefficient i comes: at an end of the block where all of the
// function lives on the last cell, else one that is not the last.
int CellOfFunction(const std::vector<double>& knots, int i, int cells) {
  if (knots[i + 4] <= 1) return 0;
  if (knots[i] >= cells - 1) return cells - 1;
  return std::clamp(static_cast<int>(std::floor(knots[i + 2])), 1, cells - 2);
}

class BlockFace {
 public:
  BlockFace(RefinedNet& net, const QuadBlock& block)
      : net_(net),
        mesh_(net.topology()),
        cells_u_(net.cells() * block.across),
        cells_v_(net.cells() * block.along) {
    CollectCells(net.CellOf(block.first));
    const int u = cells_u_ - 1, v = cells_v_ - 1;
    corner_ = {Cell(0, 0),
               QuadTopology::Next(Cell(u, 0)),
               QuadTopology::Across(Cell(u, v)),
               QuadTopology::Previous(Cell(0, v))};
    std::array<bool, 4> odd;
    for (int k = 0; k < 4; ++k) odd[k] = Odd(k);
    knots_u_ = KnotsOf(cells_u_, odd[0] || odd[3], odd[1] || odd[2]);
    knots_v_ = KnotsOf(cells_v_, odd[0] || odd[1], odd[2] || odd[3]);
  }

  NurbsSurface Surface() {
    const int size_u = static_cast<int>(knots_u_.size()) - 4;
    const int size_v = static_cast<int>(knots_v_.size()) - 4;
    Eigen::Matrix3Xd points(3, Eigen::Index{size_u} * size_v);
    for (int i = 0; i < size_u; ++i) {
      for (int j = 0; j < size_v; ++j) {
        points.col(Eigen::Index{i} * size_v + j) = Coefficient(i, j, size_u, size_v);
      }
    }
    return NurbsSurface(SplineBasis(3, knots_u_), SplineBasis(3, knots_v_), std::move(points));
  }

 private:
  void CollectCells(int column) {
    cells_.resize(std::size_t(cells_u_) * cells_v_);
    for (int a = 0; a < cells_u_; ++a) {
      int cell = column;
      for (int b = 0; b < cells_v_; ++b) {
        cells_[std::size_t(a) * cells_v_ + b] = cell;
        if (b + 1 < cells_v_) cell = mesh_.Up(cell);
      }
      if (a + 1 < cells_u_) column = mesh_.Right(column);
    }
  }

  int Cell(int a, int b) const { return cells_[std::size_t(a) * cells_v_ + b]; }
  bool Odd(int corner) const { return !mesh_.FanOf(corner_[corner]).plain(); }

  Eigen::Vector3d Coefficient(int i, int j, int size_u, int size_v) {
    const int from_u = size_u - 1 - i, from_v = size_v - 1 - j;
    const bool low_u = i < kOwned, high_u = from_u < kOwned;
    const bool low_v = j < kOwned, high_v = from_v < kOwned;
    if (low_u && low_v && Odd(0)) return net_.Corner(corner_[0], i, j);
    if (high_u && low_v && Odd(1)) return net_.Corner(corner_[1], j, from_u);
    if (high_u && high_v && Odd(2)) return net_.Corner(corner_[2], from_u, from_v);
    if (low_u && high_v && Odd(3)) return net_.Corner(corner_[3], from_v, i);
    const int a = CellOfFunction(knots_u_, i, cells_u_), b = CellOfFunction(knots_v_, j, cells_v_);
    const auto in_u =
        UniformCubicBlossom(knots_u_[i + 1] - a, knots_u_[i + 2] - a, knots_u_[i + 3] - a);
    const auto in_v =
        UniformCubicBlossom(knots_v_[j + 1] - b, knots_v_[j + 2] - b, knots_v_[j + 3] - b);
    const Eigen::Matrix<double, 3, 16> points = net_.PointsAbout(Cell(a, b));
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (int p = 0; p < 4; ++p) {
      for (int q = 0; q < 4; ++q) point += in_u[p] * in_v[q] * points.col(4 * p + q);
    }
    return point;
  }

  RefinedNet& net_;
  const QuadTopology& mesh_;
  int cells_u_, cells_v_;
  std::vector<int> cells_;
  std::array<int, 4> corner_;  // half-edges that leave the corners counter-clockwise
  std::vector<double> knots_u_, knots_v_;
};

// Where the sides of blocks run: for every half-edge of the mesh on one, which and how far along.
struct SidePlace {
  int block = -1, side = 0, place = 0;  // counter-clockwise from the side's first corner
};

class SolidMaker {
 public:
  SolidMaker(const QuadTopology& mesh, const std::vector<QuadBlock>& blocks, int refinements)
      : mesh_(mesh),
        blocks_(blocks),
        refinements_(refinements),
        places_(mesh.half_edges()),
        sides_(blocks.size()) {
    for (int b = 0; b < static_cast<int>(blocks.size()); ++b) TakeSides(b);
  }

  SolidModel Make(const Eigen::Matrix3Xd& control_points) {
    RefinedNet net(mesh_, control_points, refinements_);
    for (const QuadBlock& block : blocks_) {
      solid_.faces.push_back({BlockFace(net, block).Surface(), {}});
    }
    vertex_.assign(mesh_.vertices(), -1);
    for (int b = 0; b < static_cast<int>(blocks_.size()); ++b) TakeCorners(b);
    for (int b = 0; b < static_cast<int>(blocks_.size()); ++b) MakeLoop(b);
    solid_.vertices.resize(3, Eigen::Index(corners_.size()));
    for (std::size_t k = 0; k < corners_.size(); ++k)
      solid_.vertices.col(Eigen::Index(k)) = corners_[k];
    return std::move(solid_);
  }

 private:
  void TakeSides(int b) {
    const QuadBlock& block = blocks_[b];
    int h = block.first;
    for (int side = 0; side < 4; ++side) {
      const int length = side % 2 == 0 ? block.across : block.along;
      for (int k = 0; k < length; ++k) {
        if (places_[h].block >= 0) Reject("SplineSolid", "blocks overlap");
        places_[h] = {b, side, k};
        sides_[b][side].push_back(h);
        if (k + 1 < length) h = mesh_.Right(h);
      }
      h = QuadTopology::Next(h);
    }
  }

  // Parameters of a block at so many faces along one of its sides.
  Eigen::Vector2d ParametersAt(int b, int side, int place) const {
    const int cells = 1 << refinements_;
    const double u = cells * blocks_[b].across, v = cells * blocks_[b].along;
    const double t = cells * place;
    switch (side) {
      case 0:
        return {t, 0};
      case 1:
        return {u, t};
      case 2:
        return {u - t, v};
      default:
        return {0, v - t};
    }
  }

  void TakeCorners(int b) {
    const NurbsSurface& surface = solid_.faces[b].surface;
    const int u = surface.size_u() - 1, v = surface.size_v() - 1;
    const std::array<std::pair<int, int>, 4> at = {{{0, 0}, {u, 0}, {u, v}, {0, v}}};
    for (int side = 0; side < 4; ++side) {
      int& vertex = vertex_[mesh_.Origin(sides_[b][side].front())];
      if (vertex >= 0) continue;
      vertex = static_cast<int>(corners_.size());
      corners_.push_back(surface.control_point(at[side].first, at[side].second));
    }
  }

  // Whether a neighbour ends between two half-edges that follow one another on a side.
  bool Parted(int before, int after) const {
    const SidePlace& one = places_[mesh_.Twin(before)];
    const SidePlace& two = places_[mesh_.Twin(after)];
    return one.block != two.block || one.side != two.side || one.place != two.place + 1;
  }

  void MakeLoop(int b) {
    for (int side = 0; side < 4; ++side) {
      const std::vector<int>& line = sides_[b][side];
      const int length = static_cast<int>(line.size());
      for (int begin = 0, end; begin < length; begin = end) {
        for (end = begin + 1; end < length && !Parted(line[end - 1], line[end]);) ++end;
        solid_.faces[b].loop.push_back(CoedgeOf(b, side, begin, end));
      }
    }
  }

  SolidCoedge CoedgeOf(int b, int side, int begin, int end) {
    const std::vector<int>& line = sides_[b][side];
    const int first = line[begin], last = line[end - 1];
    const Eigen::Vector2d low = ParametersAt(b, side, begin), high = ParametersAt(b, side, end);
    const auto known = edge_.find(mesh_.Twin(last));
    if (known != edge_.end()) {
      // The loop runs against the other's: against the curve where that runs with it.
      return known->second.with_curve ? SolidCoedge{known->second.edge, true, high, low}
                                      : SolidCoedge{known->second.edge, false, low, high};
    }
    const bool with_curve = side < 2;
    const auto curves = BoundaryCurves(solid_.faces[b].surface);
    const int direction = side % 2 == 0 ? 0 : 1;
    const NurbsCurve<3>& whole = curves[side == 0 ? 2 : side == 1 ? 1 : side == 2 ? 3 : 0];
    const double from = std::min(low[direction], high[direction]);
    const double to = std::max(low[direction], high[direction]);
    const int origin = vertex_[mesh_.Origin(first)];
    const int target = vertex_[mesh_.Origin(QuadTopology::Next(last))];
    const int edge = static_cast<int>(solid_.edges.size());
    solid_.edges.push_back({Segment(whole, from, to),
                            with_curve ? origin : target,
                            with_curve ? target : origin,
                            mesh_.IsCrease(first)});
    edge_[first] = {edge, with_curve};
    return with_curve ? SolidCoedge{edge, false, low, high} : SolidCoedge{edge, true, high, low};
  }

  struct KnownEdge {
    int edge;
    bool with_curve;  // the loop that made it runs with the curve
  };
  const QuadTopology& mesh_;
  const std::vector<QuadBlock>& blocks_;
  int refinements_;
  std::vector<SidePlace> places_;
  std::vector<std::array<std::vector<int>, 4>> sides_;
  std::vector<int> vertex_;  // of the solid, for those of the mesh
  std::vector<Eigen::Vector3d> corners_;
  std::unordered_map<int, KnownEdge> edge_;  // by the first half-edge of the loop that made it
  SolidModel solid_;
};

}  // namespace

SolidModel SplineSolid(const QuadTopology& mesh,
                       const Eigen::Matrix3Xd& control_points,
                       const std::vector<QuadBlock>& blocks,
                       int refinements) {
  if (control_points.cols() != mesh.vertices()) {
    Reject("SplineSolid", "control_points: one for every vertex is needed");
  }
  constexpr int kLeastCells = 4;  // two corners of two cells each
  for (const QuadBlock& block : blocks) {
    if (std::min(block.across, block.along) << refinements < kLeastCells) {
      Reject("SplineSolid", "refinements: a block has fewer than four cells along a side");
    }
  }
  return SolidMaker(mesh, blocks, refinements).Make(control_points);
}

}  // namespace batten::internal
