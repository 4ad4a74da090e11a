// SPDX-License-Identifier: MIT
// batten evaluate, field by field.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/io/geometry_file.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "test_clouds.h"
#include "tolerances.h"

namespace batten::internal::evaluate_test {

using ::testing::HasSubstr;

constexpr unsigned kSeed = 47;

class EvaluateTest : public ::testing::Test {
 protected:
  template <typename Shape>
  Json Evaluate(const Shape& shape, std::vector<std::string> arguments) {
    WriteGeometry({shape}, folder_.File("in.json"));
    arguments.insert(arguments.begin(), {"evaluate", folder_.File("in.json"), "--json"});
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out)["results"];
  }
  template <typename Vector>
  static void ExpectSame(const Json& numbers, const Vector& expected) {
    ASSERT_EQ(static_cast<Eigen::Index>(numbers.size()), expected.size());
    for (Eigen::Index d = 0; d < expected.size(); ++d) EXPECT_EQ(numbers[d], expected[d]);
  }
  static std::vector<std::string> Keys(const Json& object) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.push_back(key);
    return keys;
  }

  TemporaryFolder folder_;
  RandomSplines random_{kSeed};
};

// A polyline with a corner at u = 1: degree 1, derivative (2, 0) before and (0, 3) after it.
NurbsCurve<2> Corner() {
  return NurbsCurve<2>(SplineBasis(1, {0, 0, 1, 2, 2}),
                       Eigen::Matrix<double, 2, 3>{{0, 2, 2}, {0, 0, 3}});
}

TEST_F(EvaluateTest, ACurvesFieldsAreThoseOfTheContract) {
  const auto curve = random_.Curve<3>(4, true);
  const double u = curve.basis().lower() * 0.3 + curve.basis().upper() * 0.7;
  for (int order = 0; order <= 6; ++order) {
    const Json one =
        Evaluate(curve, {"--at", Shortest(u), "--derivatives", std::to_string(order)})[0];
    std::vector<std::string> keys = {"at", "derivatives", "point"};
    if (order >= 2) keys.insert(keys.begin() + 1, "curvature");
    EXPECT_EQ(Keys(one), keys);
    EXPECT_EQ(one["at"], Json({u}));
    ASSERT_EQ(one["derivatives"].size(), order + 1u);
    const auto expected = curve.Derivatives(u, order);
    for (int k = 0; k <= order; ++k) ExpectSame(one["derivatives"][k], expected.col(k));
    ExpectSame(one["point"], expected.col(0));
    if (order >= 2) {
      EXPECT_EQ(Keys(one["curvature"]), (std::vector<std::string>{"curvature", "torsion"}));
    }
  }
}

TEST_F(EvaluateTest, ASurfacesFieldsAreThoseOfTheContract) {
  const NurbsSurface surface = random_.Surface(3, 2, true);
  const double u = surface.basis_u().lower(), v = surface.basis_v().upper();
  for (int order = 0; order <= 4; ++order) {
    const Json one = Evaluate(
        surface,
        {"--at", Shortest(u) + "," + Shortest(v), "--derivatives", std::to_string(order)})[0];
    std::vector<std::string> keys = {"at", "derivatives", "normal", "point"};
    if (order >= 2) keys.insert(keys.begin() + 1, "curvature");
    EXPECT_EQ(Keys(one), keys);
    EXPECT_EQ(one["at"], Json({u, v}));
    const SurfaceDerivatives expected = surface.Derivatives(u, v, order);
    ASSERT_EQ(one["derivatives"].size(), order + 1u);
    for (int k = 0; k <= order; ++k) {
      ASSERT_EQ(one["derivatives"][k].size(), order + 1u - k);
      for (int l = 0; k + l <= order; ++l) ExpectSame(one["derivatives"][k][l], expected(k, l));
    }
    ExpectSame(one["normal"], *surface.NormalAt(u, v));
    if (order < 2) continue;
    EXPECT_EQ(Keys(one["curvature"]), (std::vector<std::string>{"gaussian", "mean", "principal"}));
    EXPECT_LE(one["curvature"]["principal"][0], one["curvature"]["principal"][1]);
  }
}

TEST_F(EvaluateTest, DerivativesAreFromTheRightAtKnotsAndFromTheLeftAtTheEnd) {
  const Json results =
      Evaluate(Corner(), {"--at", "0", "--at", "1", "--at", "2", "--derivatives", "2"});
  EXPECT_EQ(results[0]["derivatives"], Json({{0.0, 0.0}, {2.0, 0.0}, {0.0, 0.0}}));
  EXPECT_EQ(results[1]["derivatives"], Json({{2.0, 0.0}, {0.0, 3.0}, {0.0, 0.0}}));
  EXPECT_EQ(results[2]["derivatives"], Json({{2.0, 3.0}, {0.0, 3.0}, {0.0, 0.0}}));
}

TEST_F(EvaluateTest, PlaneCurvesHavePairsAndNoTorsion) {
  const Json one = Evaluate(Circle(2), {"--at", "0.3", "--derivatives", "3"})[0];
  for (const Json& vector : one["derivatives"]) EXPECT_EQ(vector.size(), 2u);
  EXPECT_NEAR(one["curvature"]["curvature"].get<double>(), 0.5, kRounding);
  EXPECT_EQ(one["curvature"]["torsion"], 0.0);
}

TEST_F(EvaluateTest, WhereThereIsNoCurvatureOrNormalItIsNull) {
  const NurbsCurve<3> still(SplineBasis::Uniform(2, 3, 0, 1), Eigen::Matrix3Xd::Ones(3, 3));
  EXPECT_TRUE(Evaluate(still, {"--at", "0.5", "--derivatives", "2"})[0]["curvature"].is_null());
  const NurbsSurface point(SplineBasis::Uniform(1, 2, 0, 1),
                           SplineBasis::Uniform(1, 2, 0, 1),
                           Eigen::Matrix3Xd::Zero(3, 4));
  const Json one = Evaluate(point, {"--at", "0.5,0.5", "--derivatives", "2"})[0];
  EXPECT_TRUE(one["normal"].is_null());
  EXPECT_TRUE(one["curvature"].is_null());
}

TEST_F(EvaluateTest, APoleHasTheNormalAndCurvatureOfItsLimit) {
  const Json poles = Evaluate(Sphere(2), {"--at", "0.4,1", "--at", "0.1,0", "--derivatives", "2"});
  EXPECT_NEAR(poles[0]["normal"][2].get<double>(), 1, kRounding);
  EXPECT_NEAR(poles[1]["normal"][2].get<double>(), -1, kRounding);
  EXPECT_NEAR(poles[0]["curvature"]["gaussian"].get<double>(), 0.25, kIterated);
}

// A vector in the tangent plane is S_u du + S_v dv; what is left of others is along the normal.
TEST_F(EvaluateTest, AVectorHasItsParameterVelocities) {
  const std::string patch = folder_.With("patch.json", kRationalPatch);
  const Json result = Json::parse(Batten({"evaluate",
                                          patch,
                                          "--at",
                                          "0.7,0.4",
                                          "--derivatives",
                                          "1",
                                          "--along",
                                          "1,2,3",
                                          "--json"})
                                      .out)["results"][0];
  double left = 0;
  for (int k = 0; k < 3; ++k) {
    const double part =
        result["derivatives"][1][0][k].get<double>() * result["along"]["du"].get<double>() +
        result["derivatives"][0][1][k].get<double>() * result["along"]["dv"].get<double>();
    const double rest = k + 1 - part;
    left += rest * rest;
    EXPECT_NEAR(
        std::abs(rest),
        std::abs(result["normal"][k].get<double>()) * result["along"]["residual"].get<double>(),
        kRounding * 10);
  }
  EXPECT_NEAR(std::sqrt(left), result["along"]["residual"].get<double>(), kRounding * 10);
  EXPECT_EQ(Batten({"evaluate", patch, "--at", "0.7,0.4", "--along", "1,2"}).code, 2);
  EXPECT_EQ(
      Batten({"evaluate", folder_.With("p.json", kParabola), "--at", "0.5", "--along", "1,2,3"})
          .code,
      2);
}

TEST_F(EvaluateTest, PeriodicDirectionsTakeAnyParameter) {
  const auto round = random_.Curve<3>(3, true, {.periodic = true});
  const double period = round.basis().upper() - round.basis().lower();
  const double u = round.basis().lower() + 0.25 * period;
  const Json results = Evaluate(
      round, {"--at", Shortest(u), "--at", Shortest(u + period), "--at", Shortest(u - 2 * period)});
  EXPECT_LT(Difference(results[0]["point"], results[1]["point"]), kRounding * 100);
  EXPECT_LT(Difference(results[0]["point"], results[2]["point"]), kRounding * 100);
  const NurbsSurface tube = random_.Surface(2, 3, false, {.periodic = true}, {});
  const double v = tube.basis_v().lower();
  EXPECT_EQ(Evaluate(tube, {"--at", "100," + Shortest(v)}).size(), 1u);
  const ProgramRun run =
      Batten({"evaluate", folder_.File("in.json"), "--at", "0," + Shortest(v - 1)});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("v = "));
}

TEST_F(EvaluateTest, AParameterOutsideTheDomainIsRefusedWithValueAndDomain) {
  const std::string corner = folder_.File("corner.json");
  WriteGeometry({Corner()}, corner);
  for (const char* at : {"-0.5", "-.5", "2.5", "1e300", "2.0000000000000004"}) {
    const ProgramRun run = Batten({"evaluate", corner, "--at", "1", "--at", at});
    EXPECT_EQ(run.code, 2) << at;
    EXPECT_EQ(run.out, "") << "nothing comes before everything is known to be in order";
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr("evaluate --at: u = "));
    EXPECT_THAT(run.err, HasSubstr("[0, 2]"));
  }
  for (const std::vector<std::string>& bad :
       std::vector<std::vector<std::string>>{{"--at", "nan"},
                                             {"--at", ""},
                                             {"--at", "1,1"},
                                             {"--at", "x"},
                                             {"--derivatives", "51"},
                                             {"--derivatives", "-1"},
                                             {"--derivatives", "1.5"}}) {
    std::vector<std::string> arguments = {"evaluate", corner};
    arguments.insert(arguments.end(), bad.begin(), bad.end());
    EXPECT_EQ(Batten(arguments).code, 2) << bad[1];
  }
}

TEST_F(EvaluateTest, TheWrongNumberOfParametersNamesWhichGeometry) {
  const std::string mixed = folder_.File("mixed.json");
  WriteGeometry({Sphere(1), Corner()}, mixed);
  const ProgramRun run = Batten({"evaluate", mixed, "--at", "0.5,0.5"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("a curve has one parameter u, not 2 (geometry of index 1)"));
}

TEST_F(EvaluateTest, TheTextForPeopleHoldsTheSameNumbers) {
  WriteGeometry({Corner()}, folder_.File("in.json"));
  EXPECT_EQ(Batten({"evaluate", folder_.File("in.json"), "--at", "1", "--derivatives", "2"}).out,
            "at             1.0\n"
            "point          2.0                    0.0\n"
            "  C            2.0                    0.0\n"
            "  C'           0.0                    3.0\n"
            "  C''          0.0                    0.0\n"
            "  curvature    0.0\n"
            "  torsion      0.0\n");
  WriteGeometry({Sphere(1)}, folder_.File("sphere.json"));
  const std::string text =
      Batten({"evaluate", folder_.File("sphere.json"), "--at", "0.1,0.5", "--derivatives", "2"})
          .out;
  for (const char* name : {"\n  S  ",
                           "\n  S_v  ",
                           "\n  S_vv  ",
                           "\n  S_u  ",
                           "\n  S_uv  ",
                           "\n  S_uu  ",
                           "\nnormal  ",
                           "\n  gaussian  ",
                           "\n  principal  "}) {
    EXPECT_THAT(text, HasSubstr(name));
  }
}

TEST_F(EvaluateTest, ManyParametersStream) {
  std::string rows = "u\n";
  for (int k = 0; k < 100000; ++k) rows += Shortest(k / 50000.0) + "\n";
  WriteGeometry({Corner()}, folder_.File("in.json"));
  const ProgramRun run = Batten(
      {"evaluate", folder_.File("in.json"), "--json", "--at-file", folder_.With("many.csv", rows)});
  EXPECT_EQ(Json::parse(run.out)["results"].size(), 100000u);
  constexpr std::int64_t kBytes = std::int64_t{60} << 20;
  EXPECT_LT(run.peak_bytes, kBytes + MemoryAtStart());
}

}  // namespace batten::internal::evaluate_test
