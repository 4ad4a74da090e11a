// SPDX-License-Identifier: MIT
#include "fitting/regions/solid_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/frame.h"
#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

constexpr double kMostSamples = 20000;  // of a face; a thousandth of it is some twenty

// The natural normal of a carrier near a place.
struct NaturalNormal {
  Eigen::Vector3d place;

  Eigen::Vector3d operator()(const PlaneShape& s) const { return s.normal; }
  Eigen::Vector3d operator()(const SphereShape& s) const { return (place - s.center).normalized(); }
  Eigen::Vector3d operator()(const CylinderShape& s) const { return Out(s.point, s.axis); }
  Eigen::Vector3d operator()(const ConeShape& s) const {
    return std::cos(s.half_angle) * Out(s.apex, s.axis) - std::sin(s.half_angle) * s.axis;
  }
  Eigen::Vector3d operator()(const TorusShape& s) const {
    return (place - s.center - s.major_radius * Out(s.center, s.axis)).normalized();
  }
  template <typename Other>
  Eigen::Vector3d operator()(const Other&) const {
    return Eigen::Vector3d::Zero();  // of no face
  }

  Eigen::Vector3d Out(const Eigen::Vector3d& foot, const Eigen::Vector3d& axis) const {
    const Eigen::Vector3d from = place - foot;
    return (from - from.dot(axis) * axis).normalized();
  }
};

// The pieces of a face's loops, in their direction, with what is left of them along the face.
struct LoopPiece {
  Eigen::Vector3d from, way, left;
};

std::vector<LoopPiece> PiecesOf(const TrimmedSolid& solid, const TrimmedSolidFace& face) {
  std::vector<LoopPiece> pieces;
  for (const auto& loop : face.loops) {
    for (const TrimmedSolidCoedge& coedge : loop) {
      const TrimmedSolidEdge& edge = solid.edges[std::size_t(coedge.edge)];
      const bool segment = edge.exact && std::holds_alternative<ExactLine>(*edge.exact);
      const int count = segment ? 1 : kPiecesOfEdge;
      const double begin = edge.curve.basis().lower(), end = edge.curve.basis().upper();
      Eigen::Vector3d last = edge.curve.At(coedge.reversed ? end : begin);
      for (int k = 1; k <= count; ++k) {
        const double along = double(coedge.reversed ? count - k : k) / count;
        const Eigen::Vector3d next = edge.curve.At(begin + along * (end - begin));
        const Eigen::Vector3d normal = std::visit(NaturalNormal{(last + next) / 2}, face.carrier);
        pieces.push_back(
            {last, next - last, (face.reversed ? -1 : 1) * normal.cross(next - last).normalized()});
        last = next;
      }
    }
  }
  return pieces;
}

// Of pieces that share the nearest corner the one that is seen most squarely decides.
bool OnTheLeft(const std::vector<LoopPiece>& pieces, const Eigen::Vector3d& place) {
  double least = std::numeric_limits<double>::infinity(), side = 1;
  for (const LoopPiece& piece : pieces) {
    const double length = piece.way.squaredNorm();
    if (!(length > 0)) continue;
    const double along = std::clamp((place - piece.from).dot(piece.way) / length, 0.0, 1.0);
    const Eigen::Vector3d off = place - piece.from - along * piece.way;
    const double far = off.squaredNorm();
    const double left = piece.left.dot(off);
    const bool tie = far <= (1 + kRelativelyEqual) * least && std::abs(left) > std::abs(side);
    if (!(far < (1 - kRelativelyEqual) * least) && !tie) continue;
    least = far;
    side = left;
  }
  return side > 0;
}

// Whatever is not a plane turns a profile about an axis.
struct ProfilePlace {
  double radius, height;            // from and along the axis
  double normal_out, normal_along;  // the carrier's natural normal
  double length;                    // of the profile for which it stands
};

struct TurnedProfile {
  Frame frame;
  std::vector<ProfilePlace> places;
};

int CellsOf(double length, double step) {
  return std::max(1, static_cast<int>(std::ceil(length / step)));
}

// An arc of the profile about (radius, height).
void AddArc(
    double radius, double about, double from, double sweep, double step, TurnedProfile& to) {
  const int count = CellsOf(radius * sweep, step);
  for (int k = 0; k < count; ++k) {
    const double angle = from + sweep * (k + 0.5) / count;
    const double out = std::cos(angle), along = std::sin(angle);
    to.places.push_back({about + radius * out, radius * along, out, along, radius * sweep / count});
  }
}

class FaceSampler {
 public:
  FaceSampler(const TrimmedSolid& solid, int number, double step, std::vector<SolidSample>& samples)
      : face_(solid.faces[std::size_t(number)]),
        number_(number),
        step_(step),
        pieces_(PiecesOf(solid, face_)),
        samples_(samples) {}

  void Sample() {
    if (const auto* plane = std::get_if<PlaneShape>(&face_.carrier)) {
      SamplePlane(*plane);
    } else if (const auto* cylinder = std::get_if<CylinderShape>(&face_.carrier)) {
      SampleStraight({cylinder->point, cylinder->axis}, cylinder->radius, 0);
    } else if (const auto* cone = std::get_if<ConeShape>(&face_.carrier)) {
      SampleStraight({cone->apex, cone->axis}, 0, std::tan(cone->half_angle));
    } else if (const auto* sphere = std::get_if<SphereShape>(&face_.carrier)) {
      TurnedProfile profile{Frame(sphere->center, Eigen::Vector3d::UnitZ()), {}};
      step_ = Coarse(4 * std::numbers::pi * sphere->radius * sphere->radius);
      AddArc(sphere->radius, 0, -std::numbers::pi / 2, std::numbers::pi, step_, profile);
      Turn(profile);
    } else if (const auto* torus = std::get_if<TorusShape>(&face_.carrier)) {
      TurnedProfile profile{Frame(torus->center, torus->axis), {}};
      step_ = Coarse(4 * std::pow(std::numbers::pi, 2) * torus->major_radius * torus->minor_radius);
      AddArc(torus->minor_radius, torus->major_radius, 0, 2 * std::numbers::pi, step_, profile);
      Turn(profile);
    }
  }

 private:
  double Coarse(double area) const { return std::max(step_, std::sqrt(area / kMostSamples)); }

  Interval Range(const Eigen::Vector3d& origin, const Eigen::Vector3d& along) const {
    Interval range{std::numeric_limits<double>::infinity(),
                   -std::numeric_limits<double>::infinity()};
    for (const LoopPiece& piece : pieces_) {
      const double at = (piece.from - origin).dot(along);
      range = {std::min(range.lower, at), std::max(range.upper, at)};
    }
    return range;
  }

  void SamplePlane(const PlaneShape& plane) {
    if (pieces_.empty()) return;
    const Frame frame(plane.point, plane.normal);
    const Interval x = Range(frame.origin(), frame.x()), y = Range(frame.origin(), frame.y());
    const double width = x.upper - x.lower, height = y.upper - y.lower;
    const double step = Coarse(width * height);
    const int columns = CellsOf(width, step), rows = CellsOf(height, step);
    for (int i = 0; i < columns; ++i) {
      for (int j = 0; j < rows; ++j) {
        Add(frame.At(x.lower + width * (i + 0.5) / columns, y.lower + height * (j + 0.5) / rows, 0),
            frame.axis(),
            width * height / columns / rows);
      }
    }
  }

  // Cylinders as far as their edges reach, cones from the tip on.
  void SampleStraight(const Frame& frame, double radius, double slope) {
    if (pieces_.empty()) return;
    Interval range = Range(frame.origin(), frame.axis());
    if (slope > 0) range.lower = 0;
    const double slant = std::hypot(1, slope), high = range.upper - range.lower;
    const double most = radius + slope * std::max(0.0, range.upper);
    step_ = Coarse(2 * std::numbers::pi * most * high * slant);
    TurnedProfile profile{frame, {}};
    const int count = CellsOf(high * slant, step_);
    for (int k = 0; k < count; ++k) {
      const double height = range.lower + high * (k + 0.5) / count;
      profile.places.push_back(
          {radius + slope * height, height, 1 / slant, -slope / slant, high * slant / count});
    }
    Turn(profile);
  }

  void Turn(const TurnedProfile& profile) {
    for (const ProfilePlace& at : profile.places) {
      // The inner part of a torus that cuts its axis is not there.
      if (!(at.radius > 0)) continue;
      const double round = 2 * std::numbers::pi * at.radius;
      const int count = std::max(3, CellsOf(round, step_));
      for (int k = 0; k < count; ++k) {
        const double angle = 2 * std::numbers::pi * (k + 0.5) / count;
        const Eigen::Vector3d out =
            std::cos(angle) * profile.frame.x() + std::sin(angle) * profile.frame.y();
        Add(profile.frame.origin() + at.radius * out + at.height * profile.frame.axis(),
            at.normal_out * out + at.normal_along * profile.frame.axis(),
            at.length * round / count);
      }
    }
  }

  void Add(const Eigen::Vector3d& place, const Eigen::Vector3d& natural, double area) {
    const Eigen::Vector3d outward = face_.reversed ? Eigen::Vector3d(-natural) : natural;
    if (!pieces_.empty() && !OnTheLeft(pieces_, place)) return;
    samples_.push_back({place, outward, area, number_});
  }

  const TrimmedSolidFace& face_;
  const int number_;
  double step_;
  const std::vector<LoopPiece> pieces_;
  std::vector<SolidSample>& samples_;
};

// How often a shell winds round a place: one inside, none outside.
double WindingNumber(const std::vector<const SolidSample*>& shell, const Eigen::Vector3d& about) {
  double sum = 0;
  for (const SolidSample* sample : shell) {
    const Eigen::Vector3d off = sample->place - about;
    const double far = off.norm();
    if (far > 0) sum += sample->area * off.dot(sample->outward) / (far * far * far);
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace

std::vector<SolidSample> SampledSolid(const TrimmedSolid& solid, double step) {
  std::vector<SolidSample> samples;
  for (int k = 0; k < std::ssize(solid.faces); ++k) FaceSampler(solid, k, step, samples).Sample();
  return samples;
}

SolidCover CoverOf(const std::vector<SolidSample>& samples, const Eigen::Matrix3Xd& points) {
  constexpr double kReach = 2;
  const Eigen::Vector3d middle = points.rowwise().mean();
  const Eigen::Matrix3Xd shown = points.colwise() - middle;
  Eigen::Matrix3Xd places(3, std::ssize(samples));
  for (std::size_t k = 0; k < samples.size(); ++k)
    places.col(Eigen::Index(k)) = samples[k].place - middle;
  const NeighbourIndex index(shown), of_solid(places);
  const int neighbours = std::min<int>(7, static_cast<int>(shown.cols()));
  const std::vector<int> around = index.Nearest(shown, neighbours);
  const auto reach = [&](Eigen::Index k) {
    const int sixth = around[std::size_t((k + 1) * neighbours - 1)];
    return kReach * (shown.col(sixth) - shown.col(k)).norm();
  };
  SolidCover cover;
  double whole = 0;
  const std::vector<int> nearest = index.Nearest(places, 1);
  for (Eigen::Index k = 0; k < places.cols(); ++k) {
    const int point = nearest[std::size_t(k)];
    const double area = samples[std::size_t(k)].area;
    whole += area;
    if (!((places.col(k) - shown.col(point)).norm() <= reach(point))) cover.invented += area;
  }
  cover.invented /= whole;
  const std::vector<int> sample = of_solid.Nearest(shown, 1);
  for (Eigen::Index k = 0; k < shown.cols(); ++k) {
    const int at = sample[std::size_t(k)];
    const double cell = std::sqrt(samples[std::size_t(at)].area);
    if (!((shown.col(k) - places.col(at)).norm() <= reach(k) + cell)) ++cover.beside;
  }
  cover.beside /= static_cast<double>(shown.cols());
  return cover;
}

std::vector<int> ShellsOf(const TrimmedSolid& solid) {
  std::vector<int> parent(solid.faces.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int k) {
    while (parent[std::size_t(k)] != k) k = parent[std::size_t(k)];
    return k;
  };
  std::vector<int> first(solid.edges.size(), -1);
  for (int k = 0; k < std::ssize(solid.faces); ++k) {
    for (const auto& loop : solid.faces[std::size_t(k)].loops) {
      for (const TrimmedSolidCoedge& coedge : loop) {
        int& other = first[std::size_t(coedge.edge)];
        if (other >= 0) parent[std::size_t(root(k))] = root(other);
        other = k;
      }
    }
  }
  std::vector<int> shells(parent.size()), number(parent.size(), -1);
  int count = 0;
  for (int k = 0; k < std::ssize(parent); ++k) {
    int& shell = number[std::size_t(root(k))];
    if (shell < 0) shell = count++;
    shells[std::size_t(k)] = shell;
  }
  return shells;
}

bool ShellsInOneAnother(const std::vector<SolidSample>& samples, const std::vector<int>& shells) {
  constexpr std::size_t kProbes = 200;  // of a shell
  const int count = 1 + *std::max_element(shells.begin(), shells.end());
  std::vector<std::vector<const SolidSample*>> of(static_cast<std::size_t>(count));
  for (const SolidSample& sample : samples)
    of[std::size_t(shells[std::size_t(sample.face)])].push_back(&sample);
  for (const auto& one : of) {
    for (const auto& other : of) {
      if (&one == &other) continue;
      for (std::size_t k = 0; k < one.size(); k += 1 + one.size() / kProbes) {
        if (WindingNumber(other, one[k]->place) > 0.5) return true;
      }
    }
  }
  return false;
}

}  // namespace batten::internal
