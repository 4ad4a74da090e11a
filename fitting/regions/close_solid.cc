// SPDX-License-Identifier: MIT
#include "fitting/regions/close_solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "batten/fitting/interpolate_curve.h"
#include "batten/geometry/make_curve.h"
#include "fitting/regions/border_repair.h"
#include "fitting/regions/solid_genus.h"
#include "fitting/regions/solid_samples.h"

namespace batten::internal {
namespace {

constexpr double kExactEdge = 1e-9;  // of the size: points so near to a line or circle are on it

// Positive where the shape's normal looks away from its axis or centre, or is the plane's.
double NaturalSide(const FittedSurface& shape) {
  switch (shape.kind) {
    case SurfaceKind::kPlane:
      return 1;
    case SurfaceKind::kSphere:
    case SurfaceKind::kTorus:
      return shape.curvature;
    case SurfaceKind::kCylinder:
      return shape.axis_curvature;
    case SurfaceKind::kCone:
      break;
  }
  return shape.axis_curvature * std::cos(shape.slope);
}

bool OnSegment(const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d from = points.col(0), way = points.rightCols<1>() - from;
  const double length = way.norm();
  return std::all_of(points.colwise().begin(), points.colwise().end(), [&](const auto& p) {
    return (p - from).cross(way).norm() <= kExactEdge * length;
  });
}

// The arc through all points, counter-clockwise from the first to the last or all round.
std::optional<ExactArc> ArcThrough(const Eigen::Matrix3Xd& points, bool closed) {
  const Eigen::Index count = points.cols();
  if (count < 4) return std::nullopt;
  const Eigen::Vector3d a = points.col(0), b = points.col(count / 3) - a,
                        c = points.col(2 * count / 3) - a;
  const Eigen::Vector3d axis = b.cross(c);
  if (!(axis.norm() > 1e-6 * b.norm() * c.norm())) return std::nullopt;
  const Eigen::Vector3d center =
      a + (b.squaredNorm() * c.cross(axis) + c.squaredNorm() * axis.cross(b)) /
              (2 * axis.squaredNorm());
  const Eigen::Vector3d normal = axis.normalized();
  const double radius = (a - center).norm();
  for (const auto& p : points.colwise()) {
    const Eigen::Vector3d from = p - center;
    const double height = from.dot(normal);
    if (std::hypot(height, (from - height * normal).norm() - radius) > kExactEdge) {
      return std::nullopt;
    }
  }
  const Frame frame(center, normal, a - center);
  double sweep = 2 * std::numbers::pi;
  if (!closed) {
    const Eigen::Vector3d last = points.rightCols<1>() - center;
    sweep = std::atan2(last.dot(frame.y()), last.dot(frame.x()));
    if (sweep <= 0) sweep += 2 * std::numbers::pi;
  }
  return ExactArc{frame, radius, {0, sweep}};
}

class SolidCloser {
 public:
  SolidCloser(const RegionPoints& data,
              const RegionLabels& labels,
              const std::map<FacePair, FittedSurface>& contacts,
              double sigma,
              double most_invented,
              const Eigen::Vector3d& move)
      : data_(data),
        labels_(labels),
        contacts_(contacts),
        most_invented_(most_invented),
        move_(data.middle + move) {
    constexpr double kSameVertex = 4;  // standard deviations of the points, as shapes are nearer
    same_ = std::max(1e-8, kSameVertex * sigma);
  }

  ClosedSolid Close() && {
    const FaceMeets meets(data_, labels_, contacts_, same_);
    borders_ = FindBorders(meets);
    if (borders_.refused.empty()) RepairBorders(meets, borders_);
    refused_ = borders_.refused;
    if (refused_.empty()) CheckWhole();
    if (refused_.empty()) OrientEdges();
    if (refused_.empty()) OrientFaces();
    if (refused_.empty()) MakeEdges();
    if (refused_.empty()) MakeFaces();
    ClosedSolid closed;
    if (refused_.empty()) CheckPoints(closed);
    if (refused_.empty()) closed.solid = std::move(solid_);
    closed.refused = std::move(refused_);
    return closed;
  }

 private:
  const FittedSurface& Shape(int face) const { return labels_.regions[std::size_t(face)].shape; }
  int FaceCount() const { return static_cast<int>(labels_.regions.size()); }

  // A face without edges is a whole sphere or torus.
  void CheckWhole() {
    std::vector<bool> bounded(labels_.regions.size());
    for (const BorderEdge& edge : borders_.edges) {
      bounded[std::size_t(edge.faces.first)] = bounded[std::size_t(edge.faces.second)] = true;
    }
    for (int k = 0; k < FaceCount(); ++k) {
      const SurfaceKind kind = Shape(k).kind;
      if (bounded[std::size_t(k)] || kind == SurfaceKind::kSphere || kind == SurfaceKind::kTorus)
        continue;
      refused_ = "face " + std::to_string(k) + " has no border with another";
      return;
    }
  }

  // +1 where the face's points are on the left of the edge, the shape's normal upwards.
  double SideOf(const BorderEdge& edge, int face) const {
    constexpr double kNear = 4, kOff = 0.3;  // spacings
    const Eigen::Index count = edge.points.cols();
    double sum = 0;
    for (const Eigen::Index at : {count / 4, count / 2, 3 * count / 4}) {
      const Eigen::Index next = std::min(at + 1, count - 1),
                         before = std::max<Eigen::Index>(next - 1, 0);
      const Eigen::Vector3d here = (edge.points.col(before) + edge.points.col(next)) / 2;
      const Eigen::Vector3d way = edge.points.col(next) - edge.points.col(before);
      const Eigen::Vector3d left =
          Shape(face).TouchingNear(here).normal.cross(way).stableNormalized();
      for (const int point : labels_.regions[std::size_t(face)].points) {
        const Eigen::Vector3d off = data_.points.col(point) - here;
        if (off.squaredNorm() > std::pow(kNear * data_.spacing, 2)) continue;
        const double side = off.dot(left);
        if (std::abs(side) > kOff * data_.spacing) sum += side > 0 ? 1 : -1;
      }
    }
    return sum > 0 ? 1 : sum < 0 ? -1 : 0;
  }

  void OrientEdges() {
    for (const BorderEdge& edge : borders_.edges) {
      // One that ends where it began has a way round.
      const bool point = edge.start >= 0 && edge.start == edge.end && OnSegment(edge.points);
      if (point) {
        refused_ = "the border of faces " + std::to_string(edge.faces.first) + " and " +
                   std::to_string(edge.faces.second) + " comes back to where it began";
        return;
      }
      sides_.push_back({SideOf(edge, edge.faces.first), SideOf(edge, edge.faces.second)});
    }
    while (TellSideByNext()) {
    }
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      if (sides_[k].first != 0 && sides_[k].second != 0) continue;
      const FacePair& faces = borders_.edges[k].faces;
      refused_ = "the border of faces " + std::to_string(faces.first) + " and " +
                 std::to_string(faces.second) + " is too short for its points";
      return;
    }
  }

  // Of an edge without points beside it the side follows from the face's other edge at a vertex:
  // where one arrives the other leaves. Whether there is one more.
  bool TellSideByNext() {
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      const BorderEdge& edge = borders_.edges[k];
      for (const int face : {edge.faces.first, edge.faces.second}) {
        double& side = face == edge.faces.first ? sides_[k].first : sides_[k].second;
        for (const int vertex : {edge.start, edge.end}) {
          if (side != 0 || vertex < 0) continue;
          const auto arrives = ArrivesAt(vertex, face, k);
          if (!arrives) continue;
          side = (*arrives == (edge.start == vertex)) ? 1 : -1;
          return true;
        }
      }
    }
    return false;
  }

  // Whether the loop of a face comes to a vertex along its only edge there beside one; none where
  // that is not known.
  std::optional<bool> ArrivesAt(int vertex, int face, std::size_t beside) const {
    std::optional<bool> arrives;
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      const BorderEdge& edge = borders_.edges[k];
      const bool of_face = edge.faces.first == face || edge.faces.second == face;
      if (k == beside || !of_face || (edge.start != vertex && edge.end != vertex)) continue;
      const double side = face == edge.faces.first ? sides_[k].first : sides_[k].second;
      if (arrives || side == 0 || edge.start == edge.end) return std::nullopt;
      arrives = (edge.end == vertex) == (side > 0);
    }
    return arrives;
  }

  // Outwards along the normal (+1) or against it, so that loops run along an edge in opposite
  // directions.
  void OrientFaces() {
    outward_.assign(labels_.regions.size(), 0);
    for (int seed = 0; seed < FaceCount(); ++seed) {
      if (outward_[std::size_t(seed)] != 0) continue;
      std::vector<int> shell{seed};
      outward_[std::size_t(seed)] = 1;
      for (std::size_t k = 0; k < shell.size(); ++k) {
        for (std::size_t e = 0; e < borders_.edges.size(); ++e) {
          const FacePair& faces = borders_.edges[e].faces;
          if (faces.first != shell[k] && faces.second != shell[k]) continue;
          const bool first = faces.first == shell[k];
          const int other = first ? faces.second : faces.first;
          const double own = first ? sides_[e].first : sides_[e].second;
          const double its = first ? sides_[e].second : sides_[e].first;
          const double wanted = -outward_[std::size_t(shell[k])] * own * its;
          double& there = outward_[std::size_t(other)];
          if (there == 0) {
            there = wanted;
            shell.push_back(other);
          } else if (there != wanted) {
            refused_ = "sides of faces " + std::to_string(shell[k]) + " and " +
                       std::to_string(other) + " contradict each other";
            return;
          }
        }
      }
      TurnOutwards(shell);
    }
  }

  // At the point of the shell farthest from its middle the outside looks away from there.
  void TurnOutwards(const std::vector<int>& shell) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double count = 0;
    for (const int face : shell) {
      for (const int point : labels_.regions[std::size_t(face)].points) {
        middle += data_.points.col(point);
        ++count;
      }
    }
    middle /= count;
    double farthest = -1, side = 1;
    for (const int face : shell) {
      for (const int point : labels_.regions[std::size_t(face)].points) {
        const Eigen::Vector3d from = data_.points.col(point) - middle;
        if (!(from.squaredNorm() > farthest)) continue;
        farthest = from.squaredNorm();
        side = Shape(face).TouchingNear(data_.points.col(point)).normal.dot(from) *
               outward_[std::size_t(face)];
      }
    }
    if (side >= 0) return;
    for (const int face : shell) outward_[std::size_t(face)] *= -1;
  }

  void MakeEdges() {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<int> place_of(borders_.vertices.size(), -1);
    const auto vertex = [&](int k) {
      int& place = place_of[std::size_t(k)];
      if (place < 0) {
        place = static_cast<int>(vertices.size());
        vertices.push_back(InResult(borders_.vertices[std::size_t(k)].place));
      }
      return place;
    };
    for (const BorderEdge& edge : borders_.edges) {
      const bool closed = edge.start < 0;
      int start = 0, end = 0;
      if (closed) {
        start = end = static_cast<int>(vertices.size());
        vertices.push_back(InResult(edge.points.col(0)));
      } else {
        start = vertex(edge.start);
        end = vertex(edge.end);
      }
      solid_.edges.push_back(CurveOf(edge, closed));
      solid_.edges.back().start = start;
      solid_.edges.back().end = end;
    }
    solid_.vertices.resize(3, std::ssize(vertices));
    for (std::size_t k = 0; k < vertices.size(); ++k)
      solid_.vertices.col(Eigen::Index(k)) = vertices[k];
  }

  Eigen::Vector3d InResult(const Eigen::Vector3d& place) const {
    return data_.unit * place + move_;
  }

  TrimmedSolidEdge CurveOf(const BorderEdge& edge, bool closed) const {
    if (!closed && OnSegment(edge.points)) {
      const ExactLine line{InResult(edge.points.col(0)), InResult(edge.points.rightCols<1>())};
      return {MakeLine<3>(line.start, line.end), line};
    }
    if (auto arc = ArcThrough(edge.points, closed)) {
      arc->frame = Frame(InResult(arc->frame.origin()), arc->frame.axis(), arc->frame.x());
      arc->radius *= data_.unit;
      return {MakeArc(arc->frame, arc->radius, arc->angles), *arc};
    }
    Eigen::Matrix3Xd points = edge.points;
    if (closed) {
      points.conservativeResize(Eigen::NoChange, points.cols() + 1);
      points.rightCols<1>() = points.col(0);
    }
    points = (data_.unit * points).colwise() + move_;
    return {InterpolateCurve<3>(points).curve, std::nullopt};
  }

  void MakeFaces() {
    for (int k = 0; k < FaceCount() && refused_.empty(); ++k) {
      const double outward = outward_[std::size_t(k)];
      TrimmedSolidFace face{MovedCarrier(k), outward * NaturalSide(Shape(k)) < 0, {}};
      std::vector<TrimmedSolidCoedge> open;
      for (std::size_t e = 0; e < borders_.edges.size(); ++e) {
        const FacePair& faces = borders_.edges[e].faces;
        if (faces.first != k && faces.second != k) continue;
        const double side = faces.first == k ? sides_[e].first : sides_[e].second;
        const TrimmedSolidCoedge coedge{static_cast<int>(e), side * outward < 0};
        if (borders_.edges[e].start < 0) {
          face.loops.push_back({coedge});
        } else {
          open.push_back(coedge);
        }
      }
      Chain(k, std::move(open), face);
      solid_.faces.push_back(std::move(face));
    }
  }

  SurfaceShape MovedCarrier(int face) const { return Shape(face).Shape(data_.unit, move_); }

  int Start(const TrimmedSolidCoedge& coedge) const {
    const TrimmedSolidEdge& edge = solid_.edges[std::size_t(coedge.edge)];
    return coedge.reversed ? edge.end : edge.start;
  }
  int End(const TrimmedSolidCoedge& coedge) const {
    const TrimmedSolidEdge& edge = solid_.edges[std::size_t(coedge.edge)];
    return coedge.reversed ? edge.start : edge.end;
  }

  void Chain(int number, std::vector<TrimmedSolidCoedge> open, TrimmedSolidFace& face) {
    while (!open.empty()) {
      std::vector<TrimmedSolidCoedge> loop{open.back()};
      open.pop_back();
      while (End(loop.back()) != Start(loop.front())) {
        const auto next = std::find_if(open.begin(), open.end(), [&](const auto& one) {
          return Start(one) == End(loop.back());
        });
        if (next == open.end()) {
          refused_ = "the border of face " + std::to_string(number) + " does not close";
          return;
        }
        loop.push_back(*next);
        open.erase(next);
      }
      face.loops.push_back(std::move(loop));
    }
  }

  // A shape goes on where its points end, and so may a solid; faces that cross one another have
  // points on both sides of where they meet.
  void CheckPoints(ClosedSolid& closed) {
    constexpr double kStep = 2;           // spacings
    constexpr double kMostBeside = 0.05;  // of the points: some at edges are of the wrong face
    const std::vector<SolidSample> samples =
        SampledSolid(solid_, kStep * data_.unit * data_.spacing);
    if (samples.empty()) {
      refused_ = "its faces have no inside";
      return;
    }
    std::vector<int> of_faces;
    for (const Region& region : labels_.regions)
      of_faces.insert(of_faces.end(), region.points.begin(), region.points.end());
    const SolidCover cover =
        CoverOf(samples, (data_.unit * data_.points(Eigen::all, of_faces)).colwise() + move_);
    const auto percent = [](double share) { return std::to_string(std::lround(100 * share)); };
    closed.invented = cover.invented;
    const std::vector<int> shells = ShellsOf(solid_);
    closed.shells = 1 + *std::max_element(shells.begin(), shells.end());
    closed.genus = GenusOf(solid_);
    if (cover.invented > most_invented_) {
      refused_ = "the points do not go all round a body: " + percent(cover.invented) +
                 " % of its area have none near";
    } else if (cover.beside > kMostBeside) {
      refused_ = "faces cross one another: " + percent(cover.beside) +
                 " % of their points are beyond where they meet";
    } else if (closed.shells > 1 && ShellsInOneAnother(samples, shells)) {
      refused_ = "the faces are " + std::to_string(closed.shells) +
                 " bodies, of which two lie in one another";
    }
  }

  const RegionPoints& data_;
  const RegionLabels& labels_;
  const std::map<FacePair, FittedSurface>& contacts_;
  const double most_invented_;
  const Eigen::Vector3d move_;
  double same_ = 0;
  FaceBorders borders_;
  std::vector<std::pair<double, double>> sides_;  // of every edge's two faces
  std::vector<double> outward_;                   // of every face
  TrimmedSolid solid_;
  std::string refused_;
};

}  // namespace

ClosedSolid CloseSolid(const RegionPoints& data,
                       const RegionLabels& labels,
                       const std::map<FacePair, FittedSurface>& contacts,
                       double sigma,
                       double most_invented,
                       const Eigen::Vector3d& move) {
  return SolidCloser(data, labels, contacts, sigma, most_invented, move).Close();
}

}  // namespace batten::internal
