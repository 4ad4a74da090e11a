// SPDX-License-Identifier: MIT
#include "batten/io/certificate.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/regularity.h"
#include "batten/geometry/trim_region.h"
#include "batten/io/geometry_json.h"
#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kWiden = 1e-9, kWidenOnBorder = 1e-5;  // of the geometry's size
constexpr double kRounding = 64 * 0x1p-52;              // of the coordinates
constexpr double kNextToBorder = 1e-7;                  // of the domain: settled by the loop itself
constexpr std::ptrdiff_t kBlock = 64;

// What coordinates allow: the size of a shape, and the rounding of its and the points' coordinates.
struct Slack {
  double size = 0, rounding = 0;
};

Slack SlackOf(const Eigen::MatrixXd& control_points,
              const PointCloud& cloud,
              const Eigen::Vector3d& shift) {
  const Eigen::Matrix3Xd net = PointsInSpace(control_points);
  const Eigen::Vector3d low = net.rowwise().minCoeff(), high = net.rowwise().maxCoeff();
  double far = net.cwiseAbs().maxCoeff();
  far = std::max(far, cloud.origin().cwiseAbs().maxCoeff() + shift.cwiseAbs().maxCoeff());
  if (cloud.size() > 0) far = std::max(far, cloud.points().cwiseAbs().maxCoeff());
  return {(high - low).norm(), kRounding * far};
}

// The nearest place of the loops to a place of the domain, if that is next to it.
class Border {
 public:
  explicit Border(const NurbsSurface& surface)
      : reach_(kNextToBorder * std::max(surface.basis_u().upper() - surface.basis_u().lower(),
                                        surface.basis_v().upper() - surface.basis_v().lower())) {
    for (const NurbsCurve<2>& loop : surface.trims()) loops_.emplace_back(loop);
  }

  void Settle(PointBounds& bounds) const {
    const Eigen::Vector3d place(bounds.u, bounds.v, 0);
    double nearest = reach_;
    for (size_t k = 0; k < loops_.size(); ++k) {
      const CurveFoot foot = loops_[k].Nearest(place);
      if (foot.distance > nearest) continue;
      nearest = foot.distance;
      bounds.loop = static_cast<int>(k);
      bounds.u = foot.u;
      bounds.v = 0;
    }
  }

 private:
  double reach_;
  std::vector<CurveFootPoints<2>> loops_;
};

// Widens the bounds of a foot.
void Widen(const Slack& slack, double distance, double lower, PointBounds& bounds) {
  const double upper = kWiden * slack.size + slack.rounding + kWiden * distance;
  bounds.upper = distance + upper;
  const double down = bounds.loop >= 0 ? kWidenOnBorder * slack.size + upper : upper;
  bounds.lower = std::max(0.0, std::min(lower, distance) - down);
}

std::vector<PointBounds> BoundsTo(const NurbsSurface& given,
                                  const PointCloud& cloud,
                                  const Eigen::Vector3d& shift,
                                  ThreadPool& pool) {
  const NurbsSurface local = given.Translated(shift - cloud.origin());
  const SurfaceFootPoints search(local);
  const Border border(local);
  const Slack slack = SlackOf(given.control_points(), cloud, shift);
  std::vector<PointBounds> bounds(static_cast<size_t>(cloud.size()));
  pool.For(cloud.size(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const SurfaceFoot foot = search.Nearest(cloud.points().col(k));
      PointBounds& own = bounds[static_cast<size_t>(k)];
      own.u = foot.u;
      own.v = foot.v;
      border.Settle(own);
      Widen(slack, foot.distance, foot.lower_bound, own);
    }
  });
  return bounds;
}

template <int Dim>
std::vector<PointBounds> BoundsTo(const NurbsCurve<Dim>& given,
                                  const PointCloud& cloud,
                                  const Eigen::Vector3d& shift,
                                  ThreadPool& pool) {
  const Eigen::Matrix<double, Dim, 1> move = (shift - cloud.origin()).template head<Dim>();
  const NurbsCurve<Dim> local = Translated(given, move);
  const std::vector<CurveFoot> feet = CurveFootPoints<Dim>(local).Nearest(cloud.points(), pool);
  const Slack slack = SlackOf(given.control_points(), cloud, shift);
  std::vector<PointBounds> bounds;
  for (const CurveFoot& foot : feet) {
    bounds.push_back({.u = foot.u});
    Widen(slack, foot.distance, foot.lower_bound, bounds.back());
  }
  return bounds;
}

// The sentences on what is open.
void Summarise(const std::vector<double>& gaps, Certificate& certificate) {
  CertificateSummary& summary = certificate.summary;
  Eigen::Index apart = 0;
  double widest = 0;
  for (size_t k = 0; k < certificate.points.size(); ++k) {
    const PointBounds& point = certificate.points[k];
    summary.max_upper = std::max(summary.max_upper, point.upper);
    summary.max_lower = std::max(summary.max_lower, point.lower);
    if (gaps[k] > 0) {
      ++apart;
      widest = std::max(widest, point.upper - point.lower);
    }
    if (!summary.tolerance) continue;
    summary.proved_within += point.upper <= *summary.tolerance;
    summary.proved_out += point.lower > *summary.tolerance;
  }
  if (apart > 0) {
    summary.unproved.push_back(std::to_string(apart) +
                               " points: the nearest place is not certified; their bounds are up "
                               "to " +
                               RoundedText(widest) + " apart");
  }
  summary.folds_proved_absent = !certificate.regularity.empty();
  for (const RegularityClaim& claim : certificate.regularity) {
    if (claim.unproved.empty()) continue;
    summary.folds_proved_absent = false;
    const ParameterBox& box = claim.unproved.front();
    summary.unproved.push_back("surface " + std::to_string(claim.index) + ": " +
                               std::to_string(claim.unproved.size()) +
                               " parts where the normal may vanish or turn over, one at u " +
                               RoundedText(box.u0) + ", v " + RoundedText(box.v0));
  }
  if (!summary.tolerance) return;
  summary.undecided = static_cast<Eigen::Index>(certificate.points.size()) - summary.proved_within -
                      summary.proved_out;
  if (summary.undecided > 0)
    summary.unproved.push_back(std::to_string(summary.undecided) +
                               " points: their bounds lie on both sides of the tolerance");
}

}  // namespace

Certificate Certify(const std::vector<Geometry>& geometry,
                    const PointCloud& cloud,
                    const Eigen::Vector3d& shift,
                    std::optional<double> tolerance,
                    ThreadPool& pool) {
  if (geometry.empty()) throw std::invalid_argument("Certify: geometry: there is none");
  Certificate certificate;
  certificate.summary.tolerance = tolerance;
  for (size_t g = 0; g < geometry.size(); ++g) {
    const auto index = static_cast<int>(g);
    std::vector<PointBounds> bounds = std::visit(
        [&](const auto& shape) { return BoundsTo(shape, cloud, shift, pool); }, geometry[g]);
    for (PointBounds& own : bounds) own.index = index;
    if (g == 0) {
      certificate.points = std::move(bounds);
    } else {
      for (size_t k = 0; k < bounds.size(); ++k) {
        const double lower = std::min(certificate.points[k].lower, bounds[k].lower);
        if (bounds[k].upper < certificate.points[k].upper) certificate.points[k] = bounds[k];
        certificate.points[k].lower = lower;
      }
    }
    if (const auto* surface = std::get_if<NurbsSurface>(&geometry[g]))
      certificate.regularity.push_back({index, UnprovedRegularity(*surface)});
  }
  std::vector<double> gaps;
  double size = 0, rounding = 0;
  for (const Geometry& one : geometry) {
    const Slack slack = std::visit(
        [&](const auto& shape) { return SlackOf(shape.control_points(), cloud, shift); }, one);
    size = std::max(size, slack.size);
    rounding = std::max(rounding, slack.rounding);
  }
  for (const PointBounds& point : certificate.points) {
    const double expected = 2.1 * kWidenOnBorder * size + 3 * rounding + 3 * kWiden * point.upper;
    gaps.push_back(std::max(0.0, point.upper - point.lower - expected));
  }
  Summarise(gaps, certificate);
  return certificate;
}

std::string ToCertificateJson(const Certificate& certificate,
                              const std::vector<Geometry>& geometry,
                              const PointCloud& cloud,
                              const Eigen::Vector3d& shift) {
  using Json = nlohmann::ordered_json;
  Json rows = Json::array();
  for (size_t k = 0; k < certificate.points.size(); ++k) {
    const PointBounds& point = certificate.points[k];
    const Eigen::Vector3d at = cloud.World(static_cast<Eigen::Index>(k)) - shift;
    rows.push_back(Json::array({at[0],
                                at[1],
                                at[2],
                                point.lower,
                                point.upper,
                                point.index,
                                point.loop,
                                point.u,
                                point.v}));
  }
  Json regularity = Json::array();
  for (const RegularityClaim& claim : certificate.regularity) {
    Json boxes = Json::array();
    for (const ParameterBox& box : claim.unproved)
      boxes.push_back(Json::array({box.u0, box.u1, box.v0, box.v1}));
    regularity.push_back({{"index", claim.index}, {"unproved", std::move(boxes)}});
  }
  const CertificateSummary& summary = certificate.summary;
  Json certified{{"max_upper", summary.max_upper},
                 {"max_lower", summary.max_lower},
                 {"folds_proved_absent", summary.folds_proved_absent},
                 {"unproved", summary.unproved}};
  if (summary.tolerance) {
    certified["tolerance"] = *summary.tolerance;
    certified["proved_within"] = summary.proved_within;
    certified["proved_out"] = summary.proved_out;
  }
  Json json{{"schema", "batten-certificate-1"},
            {"certified", std::move(certified)},
            {"regularity", std::move(regularity)},
            {"columns", {"x", "y", "z", "lower", "upper", "index", "loop", "u", "v"}},
            {"points", std::move(rows)},
            {"geometry", Json::parse(ToGeometryJson(geometry)).at("shape")}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace batten
