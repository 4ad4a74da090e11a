// SPDX-License-Identifier: MIT
// What can be known of a fit to a closed shape: the best that a uniform bicubic net does at the
// true parameters, the error of the surface against the shape, its seams and its poles.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"
#include "closed_shapes.h"

namespace batten::internal {

// How many control points are free: repeats of a periodic direction and rows at poles count once.
inline int FreePointsOf(const NurbsSurface& surface) {
  std::set<std::array<double, 3>> places;
  for (const auto& p : surface.control_points().colwise()) places.insert({p[0], p[1], p[2]});
  return static_cast<int>(places.size());
}

// Whether all control points of the first row (else the last) in v are one.
inline bool HasPole(const NurbsSurface& surface, bool at_start) {
  const int j = at_start ? 0 : surface.size_v() - 1;
  for (int i = 1; i < surface.size_u(); ++i) {
    if (surface.control_point(i, j) != surface.control_point(0, j)) return false;
  }
  return true;
}

struct ClosedOracle {
  double rms = std::numeric_limits<double>::infinity();  // against the truth
  int unknowns = 0;
};

// The best of uniform bicubic nets at the true parameters, periodic and collapsed as the shape is:
// nearly square cells from coarse to fine until the error has risen three times, then each
// direction alone. Dense least squares; errors are those along the normals.
class ClosedOracleSearch {
 public:
  ClosedOracleSearch(const TurnedShape& shape, const TurnedPoints& cloud, const TurnedPoints& truth)
      : shape_(shape), cloud_(cloud), truth_(truth), normals_(3, truth.points.cols()) {
    for (Eigen::Index k = 0; k < normals_.cols(); ++k) {
      normals_.col(k) = shape.NormalAt(truth.parameters(0, k), truth.parameters(1, k));
    }
  }

  ClosedOracle Find() {
    const double across = shape_.Area() / shape_.length;
    const double stretch = std::sqrt(across / shape_.length);
    std::pair<int, int> best{6, 6};
    int rises = 0;
    for (double cells = 5; rises < 3 && cells < 60; cells *= 1.25) {
      const std::pair<int, int> net{std::max(6, Rounded(cells * stretch)),
                                    std::max(5, Rounded(cells / stretch))};
      const bool better = Rms(net) < Rms(best);
      if (better) best = net;
      rises = better || net == best ? 0 : rises + 1;
    }
    for (bool moved = true; moved;) {
      moved = false;
      for (const auto& [du, dv] :
           {std::pair{2, 0}, {-2, 0}, {0, 2}, {0, -2}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const std::pair<int, int> net{std::max(4, best.first + du), std::max(4, best.second + dv)};
        if (Rms(net) >= 0.999 * Rms(best)) continue;
        best = net;
        moved = true;
      }
    }
    return {Rms(best), Net(*this, best).unknowns};
  }

 private:
  struct Net {
    SplineBasis u, v;
    Eigen::MatrixXi unknown;  // the number of the one at (i, j)
    int unknowns = 0;

    Net(const ClosedOracleSearch& search, const std::pair<int, int>& size)
        : u(Basis(search.shape_.turned_all_round(), size.first, search.shape_.angle)),
          v(Basis(search.shape_.profile_closed, size.second, search.shape_.length)),
          unknown(size.first, size.second) {
      const auto collapsed = [&](int j) {
        return (j == 0 && search.shape_.pole_start) ||
               (j == size.second - 1 && search.shape_.pole_end);
      };
      for (int j = 0; j < size.second; ++j) {
        for (int i = 0; i < size.first; ++i) {
          if (i == 0 || !collapsed(j)) ++unknowns;
          unknown(i, j) = unknowns - 1;
        }
      }
    }

    static SplineBasis Basis(bool periodic, int size, double length) {
      if (!periodic) return SplineBasis::Uniform(3, size, 0, length);
      std::vector<double> knots;
      for (int i = -3; i <= size + 3; ++i) knots.push_back(length * i / size);
      return SplineBasis::Periodic(3, knots);
    }

    // The sixteen unknowns that act at a place, and how.
    void RowAt(const Eigen::Vector2d& place, std::array<int, 16>& who, double* values) const {
      std::array<double, 4> a, b;
      const double x = u.Clamp(place[0]), y = v.Clamp(place[1]);
      const int i = u.Span(x) - 3, j = v.Span(y) - 3;
      u.Values(i + 3, x, a.data());
      v.Values(j + 3, y, b.data());
      const auto rows = static_cast<int>(unknown.rows()),
                 columns = static_cast<int>(unknown.cols());
      for (int r = 0; r < 4; ++r) {
        for (int s = 0; s < 4; ++s) {
          who[4 * r + s] = unknown((i + r) % rows, (j + s) % columns);
          values[4 * r + s] = a[r] * b[s];
        }
      }
    }

    // Adds weight · Σ of squared second differences along both directions.
    void AddFairness(double weight, Eigen::MatrixXd& matrix) const {
      const auto add = [&](int a, int b, int c) {
        const std::array<std::pair<int, double>, 3> terms{{{a, 1.0}, {b, -2.0}, {c, 1.0}}};
        for (const auto& [k, x] : terms) {
          for (const auto& [l, y] : terms) matrix(k, l) += weight * x * y;
        }
      };
      const auto rows = static_cast<int>(unknown.rows()),
                 columns = static_cast<int>(unknown.cols());
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
          if (u.periodic() || i + 2 < rows) {
            add(unknown(i, j), unknown((i + 1) % rows, j), unknown((i + 2) % rows, j));
          }
          if (v.periodic() || j + 2 < columns) {
            add(unknown(i, j), unknown(i, (j + 1) % columns), unknown(i, (j + 2) % columns));
          }
        }
      }
    }
  };

  static constexpr Eigen::Index kMostUnknowns = 900;  // the best of every shape here is far below

  static int Rounded(double x) { return static_cast<int>(std::lround(x)); }

  double Rms(const std::pair<int, int>& size) {
    const auto [place, is_new] = rms_.try_emplace(size, std::numeric_limits<double>::infinity());
    const int most = static_cast<int>(std::min(cloud_.points.cols() / 4, kMostUnknowns));
    if (!is_new || size.first * size.second > most) return place->second;
    const Net net(*this, size);
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(net.unknowns, net.unknowns);
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(net.unknowns, 3);
    std::array<int, 16> who;
    std::array<double, 16> values;
    for (Eigen::Index k = 0; k < cloud_.points.cols(); ++k) {
      net.RowAt(cloud_.parameters.col(k), who, values.data());
      for (int a = 0; a < 16; ++a) {
        for (int b = 0; b < 16; ++b) matrix(who[a], who[b]) += values[a] * values[b];
        right.row(who[a]) += values[a] * cloud_.points.col(k).transpose();
      }
    }
    for (const double fairness : {1e-4, 1e-9}) {
      Eigen::MatrixXd calm = matrix;
      net.AddFairness(fairness * matrix.trace() / net.unknowns, calm);
      const Eigen::MatrixX3d solution = calm.ldlt().solve(right);
      double squares = 0;
      for (Eigen::Index k = 0; k < truth_.points.cols(); ++k) {
        net.RowAt(truth_.parameters.col(k), who, values.data());
        Eigen::Vector3d off = -truth_.points.col(k);
        for (int a = 0; a < 16; ++a) off += values[a] * solution.row(who[a]).transpose();
        squares += std::pow(off.dot(normals_.col(k)), 2);
      }
      place->second =
          std::min(place->second, std::sqrt(squares / static_cast<double>(truth_.points.cols())));
    }
    return place->second;
  }

  const TurnedShape& shape_;
  const TurnedPoints& cloud_;
  const TurnedPoints& truth_;
  Eigen::Matrix3Xd normals_;
  std::map<std::pair<int, int>, double> rms_;
};

inline ClosedOracle BestUniform(const TurnedShape& shape,
                                const TurnedPoints& cloud,
                                const TurnedPoints& truth) {
  return ClosedOracleSearch(shape, cloud, truth).Find();
}

struct ShapeError {
  double rms = 0, max = 0;
};

inline ShapeError SummaryOf(const Eigen::VectorXd& distances) {
  return {std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size())),
          distances.cwiseAbs().maxCoeff()};
}

// Of places of the shape from the surface.
inline ShapeError ErrorOfShape(const NurbsSurface& surface, const Eigen::Matrix3Xd& truth) {
  ThreadPool pool(2);
  return SummaryOf(DistancesTo(surface, truth, pool).distances);
}

// Of places all over the surface from the shape, by their areas, except near open borders. For
// surfaces that end where the shape does.
inline ShapeError ErrorOfSurface(const NurbsSurface& surface,
                                 const TurnedShape& shape,
                                 double strip) {
  constexpr int kSide = 100;
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  double squares = 0, area = 0, most = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const SurfaceJet jet = surface.JetAt(u.lower() + (u.upper() - u.lower()) * (i + 0.5) / kSide,
                                           v.lower() + (v.upper() - v.lower()) * (j + 0.5) / kSide);
      const TurnedFoot foot = FootOn(shape, jet.point);
      if (!shape.Inside(foot.u, foot.v, strip)) continue;
      const double weight = jet.du.cross(jet.dv).norm();
      squares += weight * foot.distance * foot.distance;
      area += weight;
      most = std::max(most, foot.distance);
    }
  }
  return {std::sqrt(squares / area), most};
}

// How far the surface jumps from the end of a direction to its beginning: in position and first and
// second derivatives across, relative to the largest of each over the seam, and in unit normals.
struct SeamJump {
  double position = 0, normal = 0;
  double first = 0, second = 0;
};

inline SeamJump JumpAcross(const NurbsSurface& surface, bool in_u) {
  constexpr int kPlaces = 200;
  const SplineBasis& across = in_u ? surface.basis_u() : surface.basis_v();
  const SplineBasis& along = in_u ? surface.basis_v() : surface.basis_u();
  SeamJump jump;
  const Eigen::Vector3d low = surface.control_points().rowwise().minCoeff();
  const double size = (surface.control_points().colwise() - low).colwise().norm().maxCoeff();
  double first = 0, second = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const double w = along.lower() + (along.upper() - along.lower()) * (i + 0.5) / kPlaces;
    // One step of rounding inside the upper end: the end itself is the lower one again.
    const double end = std::nextafter(across.upper(), across.lower());
    const auto jet = [&](double x) { return in_u ? surface.JetAt(x, w) : surface.JetAt(w, x); };
    const SurfaceJet a = jet(across.lower()), b = jet(end);
    jump.position = std::max(jump.position, (a.point - b.point).norm() / size);
    const Eigen::Vector3d a1 = in_u ? a.du : a.dv, b1 = in_u ? b.du : b.dv;
    const Eigen::Vector3d a2 = in_u ? a.duu : a.dvv, b2 = in_u ? b.duu : b.dvv;
    jump.first = std::max(jump.first, (a1 - b1).norm());
    jump.second = std::max(jump.second, (a2 - b2).norm());
    first = std::max(first, a1.norm());
    second = std::max(second, a2.norm());
    const Eigen::Vector3d m = a.du.cross(a.dv).normalized(), n = b.du.cross(b.dv).normalized();
    jump.normal = std::max(jump.normal, (m - n).norm());
  }
  jump.first /= first;
  jump.second /= second;
  return jump;
}

// What the surface is like at the pole at v's start or end.
struct PoleView {
  Eigen::Vector3d point, normal;  // the mean of the limits of unit normals
  double spread = 0;              // the largest angle between a limit and their mean
  double turn = 0;   // by which the directions that leave it turn, ±2π for once round
  double swirl = 0;  // the largest angle by which they run ahead of an even turn
  bool has_normals = true;
};

inline PoleView ViewPole(const NurbsSurface& surface, bool at_start) {
  constexpr int kPlaces = 90;
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  const double end = at_start ? v.lower() : v.upper();
  PoleView view;
  view.point = surface.At(u.lower(), end);
  std::vector<Eigen::Vector3d> normals, leaving;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i <= kPlaces; ++i) {
    const double x = u.lower() + (u.upper() - u.lower()) * i / kPlaces;
    const std::optional<Eigen::Vector3d> normal = surface.NormalAt(x, end);
    if (!normal) {
      view.has_normals = false;
      return view;
    }
    normals.push_back(*normal);
    sum += *normal;
    leaving.push_back(surface.JetAt(x, end).dv);
  }
  view.normal = sum.normalized();
  for (const auto& n : normals) {
    view.spread =
        std::max(view.spread, std::atan2(n.cross(view.normal).norm(), n.dot(view.normal)));
  }
  for (auto& direction : leaving) direction -= direction.dot(view.normal) * view.normal;
  std::vector<double> turned(1, 0.0);
  for (int i = 1; i <= kPlaces; ++i) {
    const double sine = leaving[i - 1].cross(leaving[i]).dot(view.normal);
    turned.push_back(turned.back() + std::atan2(sine, leaving[i - 1].dot(leaving[i])));
  }
  view.turn = turned.back();
  for (int i = 0; i <= kPlaces; ++i) {
    view.swirl = std::max(view.swirl, std::abs(turned[i] - view.turn * i / kPlaces));
  }
  return view;
}

}  // namespace batten::internal
