// SPDX-License-Identifier: MIT
// Hundreds of random shapes through STEP, IGES and JSON and back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reverse.h"
#include "io/exchange/closed_form.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "loop_distance.h"
#include "random_geometry.h"
#include "random_trims.h"
#include "temporary_folder.h"

namespace batten::internal::round_trip_test {

using ::testing::HasSubstr;

constexpr unsigned kSeed = 25060;
// The promise, relative to the largest coordinate, weight and knot.
constexpr double kPromised = 1e-12;
// Of loops through STEP, as a share of the domain.
constexpr double kLoops = 1e-6;

template <typename A, typename B>
double Relative(const A& a, const B& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return 1;
  return (a - b).cwiseAbs().maxCoeff() / std::max(b.cwiseAbs().maxCoeff(), 1e-300);
}

double Relative(const SplineBasis& a, const SplineBasis& b) {
  if (a.degree() != b.degree() || a.knots().size() != b.knots().size()) return 1;
  const auto knots = [](const SplineBasis& basis) {
    return Eigen::Map<const Eigen::VectorXd>(basis.knots().data(),
                                             static_cast<Eigen::Index>(basis.knots().size()));
  };
  return Relative(knots(a), knots(b));
}

template <int Dim>
double Difference(const NurbsCurve<Dim>& a, const NurbsCurve<Dim>& b) {
  return std::max({Relative(a.basis(), b.basis()),
                   Relative(a.control_points(), b.control_points()),
                   Relative(a.weights(), b.weights())});
}

double Difference(const NurbsSurface& a, const NurbsSurface& b) {
  return std::max({Relative(a.basis_u(), b.basis_u()),
                   Relative(a.basis_v(), b.basis_v()),
                   Relative(a.control_points(), b.control_points()),
                   Relative(a.weights(), b.weights())});
}

double Difference(const Geometry& a, const Geometry& b) {
  if (a.index() != b.index()) return 1;
  return std::visit(
      [&](const auto& one) { return Difference(one, std::get<std::decay_t<decltype(one)>>(b)); },
      a);
}

// Free shapes of any degree, moved far away or made small.
class Shapes {
 public:
  Geometry Any(int k) {
    const int degree = k % 5 == 0 ? random_.Integer(8, kMaxDegree) : random_.Integer(1, 7);
    const bool clamped = k % 4 != 1, rational = k % 2 == 0;
    if (k % 3 == 0) return Placed(random_.Curve<3>(degree, clamped, rational), k);
    const int other = random_.Integer(1, 4);
    return Placed(random_.Surface(degree, other, clamped, rational), k);
  }

  // Closed and periodic ones, with seams and poles.
  Geometry Round(int k) {
    const Frame frame({random_.Real(-9, 9), random_.Real(-9, 9), random_.Real(-9, 9)},
                      {random_.Real(-1, 1), random_.Real(-1, 1), random_.Real(0.5, 1)});
    const double r = random_.Real(0.5, 5);
    switch (k % 6) {
      case 0:
        return MakeSphere(frame, r);
      case 1:
        return Reversed(MakeCylinder(frame, r, {0, 2 * r}), Direction::kV);
      case 2:
        return Reversed(MakeTorus(frame, 2 * r, r), Direction::kU);
      case 3:
        return Swapped(MakeCone(frame, 0, r, {0, r}));
      case 4:
        return Revolve(MakeArc(Frame(frame.At(3 * r, 0, 0), frame.y(), frame.x()), r, {0.3, 2}),
                       frame);
      default:
        return MakeArc(frame, r);
    }
  }

  NurbsSurface Trimmed(int k) {
    RandomTrims trims(kSeed + static_cast<unsigned>(k));
    return trims.Trimmed(random_.Surface(random_.Integer(1, 6), random_.Integer(1, 6), true, k % 2),
                         1 + k % 4);
  }

 private:
  template <int Dim>
  Geometry Placed(const NurbsCurve<Dim>& curve, int k) {
    return NurbsCurve<Dim>(curve.basis(), Moved(curve.control_points(), k), curve.weights());
  }
  Geometry Placed(const NurbsSurface& surface, int k) {
    return NurbsSurface(surface.basis_u(),
                        surface.basis_v(),
                        Moved(surface.control_points(), k),
                        surface.weights());
  }
  Eigen::Matrix3Xd Moved(const Eigen::Matrix3Xd& points, int k) {
    if (k % 7 == 3) return points.colwise() + Eigen::Vector3d(4e5, -3e5, 120);
    if (k % 7 == 5) return 1e-3 * points;
    return points;
  }

  RandomGeometry random_{kSeed};
};

// The largest difference of what comes back from what STEP and IGES are to hold.
double Worst(const std::vector<Geometry>& geometry, const std::string& extension) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a" + extension);
  WriteGeometry(geometry, path);
  const std::vector<Geometry> back = ReadGeometry(path);
  EXPECT_EQ(back.size(), geometry.size());
  double worst = 0;
  for (size_t i = 0; i < std::min(back.size(), geometry.size()); ++i) {
    const bool as_it_is = extension == ".json";
    const double difference = Difference(back[i], as_it_is ? geometry[i] : ClosedForm(geometry[i]));
    EXPECT_LE(difference, kPromised) << extension << " case " << i;
    worst = std::max(worst, difference);
  }
  return worst;
}

// Those that STEP takes. OpenCASCADE calls the B-rep of one in 240 (degrees 25 and 3) not valid,
// and the writer refuses it; why is not known.
std::vector<Geometry> WithoutRefused(const std::vector<Geometry>& geometry) {
  std::vector<Geometry> taken;
  const TemporaryFolder folder;
  for (const Geometry& one : geometry) {
    try {
      WriteGeometry({one}, folder.File("a.step"));
      taken.push_back(one);
    } catch (const WriteError& error) {
      EXPECT_THAT(error.what(), HasSubstr("its B-rep is not valid"));
    }
  }
  EXPECT_GE(taken.size(), geometry.size() - geometry.size() / 100);
  return taken;
}

TEST(RoundTripTest, FreeShapesComeBackToTwelveDigits) {
  SCOPED_TRACE(kSeed);
  Shapes shapes;
  std::vector<Geometry> geometry;
  for (int k = 0; k < 240; ++k) geometry.push_back(shapes.Any(k));
  EXPECT_EQ(Worst(geometry, ".json"), 0);
  EXPECT_EQ(Worst(geometry, ".igs"), 0);
  RecordProperty("worst_step", std::to_string(Worst(WithoutRefused(geometry), ".step")));
}

TEST(RoundTripTest, RoundShapesComeBackToTwelveDigits) {
  SCOPED_TRACE(kSeed);
  Shapes shapes;
  std::vector<Geometry> geometry;
  for (int k = 0; k < 60; ++k) geometry.push_back(shapes.Round(k));
  EXPECT_EQ(Worst(geometry, ".json"), 0);
  EXPECT_EQ(Worst(geometry, ".igs"), 0);
  Worst(geometry, ".step");
}

TEST(RoundTripTest, LoopsComeBackInNumberAndOrder) {
  SCOPED_TRACE(kSeed);
  Shapes shapes;
  std::vector<Geometry> geometry;
  for (int k = 0; k < 60; ++k) geometry.push_back(shapes.Trimmed(k));
  for (const std::string extension : {".json", ".igs", ".step"}) {
    const TemporaryFolder folder;
    WriteGeometry(geometry, folder.File("a" + extension));
    const std::vector<Geometry> back = ReadGeometry(folder.File("a" + extension));
    ASSERT_EQ(back.size(), geometry.size());
    for (size_t i = 0; i < geometry.size(); ++i) {
      SCOPED_TRACE(testing::Message() << extension << " case " << i);
      const auto& got = std::get<NurbsSurface>(back[i]);
      const auto& made = std::get<NurbsSurface>(geometry[i]);
      if (extension == ".step") {
        ExpectSameLoops(got, made, kLoops);
      } else {
        EXPECT_EQ(got.trims(), made.trims());
      }
    }
  }
}

}  // namespace batten::internal::round_trip_test
