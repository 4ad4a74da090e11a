// SPDX-License-Identifier: MIT
#include "geometry/construction/curve_network.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "batten/geometry/closure.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "geometry/construction/curve_closure.h"
#include "geometry/construction/curve_meetings.h"
#include "geometry/numeric/construction_checks.h"

namespace batten::internal {
namespace {

constexpr const char* kGordon = "Gordon";
constexpr double kNoOverhang = 1e-9;  // of the domain: ends so near the outer curve are left alone

std::string NameOf(const char* direction, std::size_t k) {
  return std::string("curve ") + std::to_string(k + 1) + " along " + direction;
}

struct AllMeetings {
  Eigen::MatrixXd s, t;  // (k, l): parameters of curve k along u and curve l along v
  double gap = 0;
};

ClosestApproach OnlyMeeting(const SampledCurve& a,
                            const SampledCurve& b,
                            const std::string& names,
                            double tolerance) {
  const std::vector<ClosestApproach> meetings = Meetings(a, b, tolerance);
  RequireThat(meetings[0].gap <= tolerance,
              kGordon,
              names + " do not meet: they are " + RoundedText(meetings[0].gap) +
                  " apart where they are nearest, above the tolerance " + NumberText(tolerance));
  RequireThat(meetings.size() == 1,
              kGordon,
              names + " meet in " + std::to_string(meetings.size()) +
                  " places; every curve along u is to meet every curve along v once");
  return meetings[0];
}

AllMeetings MeetingsOfAll(const std::vector<NurbsCurve<3>>& along_u,
                          const std::vector<NurbsCurve<3>>& along_v,
                          double tolerance) {
  const std::vector<SampledCurve> us(along_u.begin(), along_u.end());
  const std::vector<SampledCurve> vs(along_v.begin(), along_v.end());
  AllMeetings all{Eigen::MatrixXd(us.size(), vs.size()), Eigen::MatrixXd(us.size(), vs.size())};
  for (std::size_t k = 0; k < us.size(); ++k) {
    for (std::size_t l = 0; l < vs.size(); ++l) {
      const std::string names = NameOf("u", k) + " and " + NameOf("v", l);
      const ClosestApproach meeting = OnlyMeeting(us[k], vs[l], names, tolerance);
      all.s(k, l) = meeting.s;
      all.t(k, l) = meeting.t;
      all.gap = std::max(all.gap, meeting.gap);
    }
  }
  return all;
}

// Numbers 0 … n − 1 in the order of the values.
std::vector<int> OrderOf(const Eigen::VectorXd& values) {
  std::vector<int> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](int k) { return values[k]; });
  return order;
}

// How far behind `from` the parameters lie on a closed curve, as shares of the domain.
Eigen::VectorXd SharesBehind(const Eigen::VectorXd& at, double from, const SplineBasis& basis) {
  const double length = basis.upper() - basis.lower();
  return at.unaryExpr([&](double value) { return std::fmod((value - from) / length + 1, 1.0); });
}

// Curves that cross another nearer to one another than that cross it at one place.
constexpr double kApart = 1e-7;  // of the domain

bool Increases(const Eigen::VectorXd& values) {
  const Eigen::Index steps = values.size() - 1;
  return (values.tail(steps).array() > values.head(steps).array() + kApart).all();
}

// A closed curve that begins where it meets the first of the others, and runs to the second.
void PlaceClosed(NurbsCurve<3>& curve, Eigen::Ref<Eigen::RowVectorXd> meets) {
  const Eigen::VectorXd shares = SharesBehind(meets.transpose(), meets[0], curve.basis());
  const bool turned = !Increases(shares);
  if (meets[0] > curve.basis().lower()) curve = BegunAt(curve, meets[0]);
  if (turned) curve = Reversed(curve);
  curve = Reparameterized(curve, 0, 1);
  meets = shares.transpose();
  if (turned) meets.tail(meets.size() - 1).array() = 1 - meets.tail(meets.size() - 1).array();
}

// An open one, cut off where it meets the first and the last.
void PlaceOpen(NurbsCurve<3>& curve, Eigen::Ref<Eigen::RowVectorXd> meets) {
  const Eigen::Index last = meets.size() - 1;
  if (meets[0] > meets[last]) {
    meets = (curve.basis().lower() + curve.basis().upper()) - meets.array();
    curve = Reversed(curve);
  }
  const double lower = curve.basis().lower(), upper = curve.basis().upper();
  const double near = kNoOverhang * (upper - lower);
  const double from = meets[0] - lower <= near ? lower : meets[0];
  const double to = upper - meets[last] <= near ? upper : meets[last];
  if (from < to && (from > lower || to < upper)) curve = Segment(curve, from, to);
  curve = Reparameterized(curve, 0, 1);
  meets = ((meets.array() - from) / (to - from)).eval();
  meets[0] = 0;
  meets[last] = 1;
}

// The family in order and running alike. Row k of `meets` belongs to curve k as given, its columns
// are in the order of the other family.
CurveFamily FamilyOf(const std::vector<NurbsCurve<3>>& curves,
                     const Eigen::MatrixXd& meets,
                     std::vector<int> order,
                     const char* direction) {
  CurveFamily family{
      {}, std::move(order), Eigen::MatrixXd(meets.rows(), meets.cols()), Closed(curves.front())};
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const int given = family.order[k];
    NurbsCurve<3> curve = curves[given];
    Eigen::RowVectorXd row = meets.row(given);
    family.closed ? PlaceClosed(curve, row) : PlaceOpen(curve, row);
    RequireThat(Increases(row.transpose()),
                kGordon,
                NameOf(direction, given) +
                    " meets the others in another order than the first curve along " + direction +
                    " does, or two of them in one place");
    family.curves.push_back(std::move(curve));
    family.meets.row(static_cast<Eigen::Index>(k)) = row;
  }
  return family;
}

// Two curves of one direction that meet would make the surface fold over or end in a point there.
// Neighbours in order are looked at: others that met would cross those between them.
void RefuseCrossings(const CurveFamily& family, double tolerance, const char* direction) {
  const std::vector<SampledCurve> curves(family.curves.begin(), family.curves.end());
  for (std::size_t k = 1; k < curves.size(); ++k) {
    const ClosestApproach meeting = Meetings(curves[k - 1], curves[k], tolerance)[0];
    RequireThat(meeting.gap > tolerance,
                kGordon,
                NameOf(direction, family.order[k - 1]) + " and " +
                    NameOf(direction, family.order[k]) + " come within " +
                    RoundedText(meeting.gap) + " of each other, not above the tolerance " +
                    NumberText(tolerance) + ": curves of one direction are not to meet");
  }
}

void RequireFamily(const std::vector<NurbsCurve<3>>& curves,
                   const char* direction,
                   std::size_t across) {
  RequireThat(curves.size() >= 2,
              kGordon,
              std::to_string(curves.size()) + " curves along " + direction +
                  "; at least two are needed in each direction");
  RequireSameClosedness(curves, kGordon, (std::string(direction) + " curve").c_str());
  RequireThat(across >= 3 || !Closed(curves.front()),
              kGordon,
              std::string("curves along ") + direction +
                  " are closed and two curves cross them: three tell which way round they run");
}

}  // namespace

CurveNetwork NetworkOf(const std::vector<NurbsCurve<3>>& along_u,
                       const std::vector<NurbsCurve<3>>& along_v,
                       double tolerance) {
  RequireFamily(along_u, "u", along_v.size());
  RequireFamily(along_v, "v", along_u.size());
  const AllMeetings all = MeetingsOfAll(along_u, along_v, tolerance);
  std::vector<int> order_u = OrderOf(all.t.col(0)), order_v = OrderOf(all.s.row(0).transpose());
  const Eigen::Index m = all.s.rows(), n = all.s.cols();
  CurveNetwork network;
  network.gap = all.gap;
  network.points.resize(3, m * n);
  for (Eigen::Index k = 0; k < m; ++k) {
    for (Eigen::Index l = 0; l < n; ++l) {
      const int a = order_u[k], b = order_v[l];
      network.points.col(k * n + l) = (along_u[a].At(all.s(a, b)) + along_v[b].At(all.t(a, b))) / 2;
    }
  }
  const Eigen::MatrixXd s = all.s(Eigen::all, order_v);
  const Eigen::MatrixXd t = all.t(order_u, Eigen::all).transpose();
  network.along_u = FamilyOf(along_u, s, std::move(order_u), "u");
  network.along_v = FamilyOf(along_v, t, std::move(order_v), "v");
  RefuseCrossings(network.along_u, tolerance, "u");
  RefuseCrossings(network.along_v, tolerance, "v");
  return network;
}

}  // namespace batten::internal
