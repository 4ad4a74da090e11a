// SPDX-License-Identifier: MIT
// batten project: the foot of every point, in order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/trim_loops.h"
#include "batten/io/geometry_file.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "test_clouds.h"
#include "tolerances.h"

namespace batten::internal::project_test {

using ::testing::HasSubstr;

class ProjectTest : public ::testing::Test {
 protected:
  static Json RunJson(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "project");
    arguments.push_back("--json");
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out)["results"];
  }
  std::string Stored(const std::string& name, const std::vector<Geometry>& geometry) {
    WriteGeometry(geometry, folder_.File(name));
    return folder_.File(name);
  }
  void ExpectRefused(const std::vector<std::string>& arguments,
                     int code,
                     const std::vector<std::string>& said) {
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(run.out, "");
    for (const std::string& words : said) EXPECT_THAT(run.err, HasSubstr(words));
  }

  TemporaryFolder folder_;
  std::string circle_ = Stored("circle.json", {Circle(2)});
  std::string sphere_ = Stored("sphere.json", {Sphere(1)});
};

TEST_F(ProjectTest, GivesOneCertifiedFootForEachPointInOrder) {
  const std::string points = folder_.With("p.xyz", "3 0 0\n0 0.5 0\n1 2 2\n0 0 -4\n");
  const Json results = RunJson({sphere_, points});
  const double expected[] = {2, 0.5, 2, 3};
  ASSERT_EQ(results.size(), 4u);
  const NurbsSurface sphere = Sphere(1);
  for (size_t k = 0; k < 4; ++k) {
    const Json& one = results[k];
    EXPECT_EQ(one.size(), 6u) << one;
    EXPECT_TRUE(one["certified"]);
    EXPECT_NEAR(one["distance"].get<double>(), expected[k], kIterated);
    EXPECT_LE(one["lower_bound"], one["distance"]);
    EXPECT_NEAR(one["lower_bound"].get<double>(), expected[k], kIterated);
    const Eigen::Vector3d foot = sphere.At(one["at"][0], one["at"][1]);
    for (int d = 0; d < 3; ++d) EXPECT_NEAR(one["foot"][d].get<double>(), foot[d], kRounding);
  }
  EXPECT_EQ(results[2]["point"], Json({1.0, 2.0, 2.0}));
}

TEST_F(ProjectTest, PlaneCurvesAndPointsArePairs) {
  const std::string points = folder_.With("p.xy", "3 0\n0 1\n");
  const Json results = RunJson({circle_, points});
  EXPECT_EQ(results[0]["point"], Json({3.0, 0.0}));
  EXPECT_EQ(results[0]["at"].size(), 1u);
  EXPECT_EQ(results[0]["foot"].size(), 2u);
  EXPECT_NEAR(results[0]["distance"].get<double>(), 1, kIterated);
  EXPECT_NEAR(results[1]["distance"].get<double>(), 1, kIterated);
  // Points in space at height zero stand for points of the plane.
  EXPECT_EQ(RunJson({circle_, folder_.With("p.xyz", "3 0 0\n0 1 0\n")}), results);
}

TEST_F(ProjectTest, PointsOfTheWrongDimensionAreRefused) {
  ExpectRefused({"project", circle_, folder_.With("p.xyz", "3 0 0\n0 1 2\n")},
                1,
                {"p.xyz", "point 1 has z = 2", "plane curve"});
  ExpectRefused({"project", sphere_, folder_.With("p.xy", "3 0\n")},
                1,
                {"p.xy", "two coordinates", "three are needed"});
  const std::string both = Stored("both.json", {Circle(1), Sphere(1)});
  ExpectRefused({"project", both, folder_.File("p.xy")}, 1, {"both.json", "plane curves beside"});
}

TEST_F(ProjectTest, OfSeveralGeometriesTheNearestAnswers) {
  NurbsSurface far = Sphere(1).Translated({10, 0, 0});
  const NurbsCurve<3> line(SplineBasis::Uniform(1, 2, 0, 1),
                           Eigen::Matrix<double, 3, 2>{{5, 5}, {-1, 1}, {0, 0}});
  const std::string path = Stored("three.json", {Sphere(1), far, line});
  const Json results = RunJson({path, folder_.With("p.xyz", "1.5 0 0\n8 0 0\n5.5 0.5 0\n")});
  ASSERT_EQ(results.size(), 3u);
  for (size_t k = 0; k < 3; ++k) EXPECT_EQ(results[k]["index"], k);
  EXPECT_EQ(results[2]["at"].size(), 1u);
  EXPECT_NEAR(results[2]["distance"].get<double>(), 0.5, kIterated);
  EXPECT_NEAR(results[2]["lower_bound"].get<double>(), 0.5, kIterated);
}

// A square with a round hole: over the hole its rim is nearest, beyond the sides they are.
TEST_F(ProjectTest, OfATrimmedSurfaceThePartInsideTheLoopsCounts) {
  const NurbsCurve<2> sides(SplineBasis(1, {0, 0, 1, 2, 3, 4, 4}),
                            Eigen::Matrix<double, 2, 5>{{0, 1, 1, 0, 0}, {0, 0, 1, 1, 0}});
  const NurbsSurface square =
      MakePlane({}, {-1, 1}, {-1, 1})
          .WithTrims(TurnedLoops({sides, MakeArc(Eigen::Vector2d(0.5, 0.5), 0.25)}));
  const std::string path = Stored("pierced.json", {square});
  const std::string points =
      folder_.With("p.xyz", "0.1 0 0\n0 0 1.2\n0.7 0.7 2\n0.75 0 -0.25\n2 0 0\n");
  const double expected[] = {0.4, 1.3, 2, 0.25, 1};
  const Json results = RunJson({path, points});
  ASSERT_EQ(results.size(), 5u);
  for (size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(results[k]["distance"].get<double>(), expected[k], kIterated) << k;
    EXPECT_NEAR(results[k]["lower_bound"].get<double>(), expected[k], kIterated) << k;
  }
  EXPECT_NEAR(results[0]["foot"][0].get<double>(), 0.5, kIterated);
  const ProgramRun compared = Batten({"compare", path, points, "--json"});
  EXPECT_EQ(compared.code, 0) << compared.err;
  EXPECT_NEAR(Json::parse(compared.out)["error"]["max"].get<double>(), 2, kIterated);
  EXPECT_NEAR(Json::parse(compared.out)["error"]["mean"].get<double>(), 4.95 / 5, kIterated);
}

TEST_F(ProjectTest, TheTableForPeopleIsACloudAgain) {
  const std::string points = folder_.With("p.xyz", "3 0 0\n0 0.5 0\n1 2 2\n");
  const ProgramRun run = Batten({"project", sphere_, points});
  EXPECT_EQ(run.code, 0) << run.err;
  std::istringstream words(run.out);
  for (const char* name :
       {"x", "y", "z", "u", "v", "foot_x", "foot_y", "foot_z", "distance", "lower_bound"}) {
    std::string word;
    words >> word;
    EXPECT_EQ(word, name);
  }
  const std::string table = folder_.With("table.txt", run.out);
  const ProgramRun back =
      Batten({"convert", table, "-", "--format", "csv", "--columns", "x=foot_x,y=foot_y,z=foot_z"});
  EXPECT_EQ(back.code, 0) << back.err;
  EXPECT_EQ(std::count(back.out.begin(), back.out.end(), '\n'), 1 + 3);
}

TEST_F(ProjectTest, FarCoordinatesKeepTheirDigits) {
  const Eigen::Vector3d place(5.4e6, 4.1e6, 300);
  const std::string path = Stored("far.json", {Sphere(1).Translated(place)});
  const Json one =
      RunJson({path, folder_.With("p.xyz", "5400003 4100000 300\n5400000 4100000 302\n")})[0];
  EXPECT_NEAR(one["distance"].get<double>(), 2, 1e-8);  // coordinates carry 1e-9
  EXPECT_EQ(one["point"], Json({5400003.0, 4100000.0, 300.0}));
  EXPECT_NEAR(one["foot"][0].get<double>(), 5400001, 1e-8);
}

TEST_F(ProjectTest, PointsMayComeFromStandardInput) {
  const ProgramRun run =
      Batten({"project", circle_, "-", "--format", "text", "--json"}, {"3 0\n", {}});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(Json::parse(run.out)["results"].size(), 1u);
  ExpectRefused({"project", "-", "-", "--format", "json"}, 2, {"standard input"});
}

TEST_F(ProjectTest, PointsThatAreNotFiniteAreCountedOnStandardError) {
  const ProgramRun run =
      Batten({"project", sphere_, folder_.With("p.xyz", "3 0 0\nnan 0 0\n0 3 0\n"), "--json"});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.err, HasSubstr("1 of 3 points are not finite"));
  EXPECT_EQ(Json::parse(run.out)["results"].size(), 2u);
}

TEST_F(ProjectTest, AnyCloudFormatAndFilterServes) {
  const std::string points = folder_.With("p.xyz", "3 0.5 0\n0 0.5 0\n1 2 2\n");
  EXPECT_EQ(Batten({"convert", points, folder_.File("p.ply")}).code, 0);
  const Json all = RunJson({sphere_, points});
  EXPECT_EQ(RunJson({sphere_, folder_.File("p.ply")}), all);
  const Json boxed = RunJson({sphere_, points, "--box", "2,-1,-1,4,1,1"});
  EXPECT_LT(Difference(boxed, Json::array({all[0]})), kIterated);  // from another origin
  EXPECT_EQ(RunJson({sphere_, points, "--threads", "1"}), all);
}

TEST_F(ProjectTest, BadInputIsRefused) {
  const std::string points = folder_.With("p.xyz", "3 0 0\n");
  ExpectRefused({"project", sphere_, folder_.File("no.xyz")}, 1, {"no.xyz"});
  ExpectRefused({"project", folder_.File("no.json"), points}, 1, {"no.json"});
  ExpectRefused({"project", points, sphere_}, 2, {"p.xyz"});
  ExpectRefused({"project", sphere_}, 2, {"POINTS is required"});
  ExpectRefused({"project", sphere_, points, "--thread", "2"}, 2, {"did you mean '--threads'?"});
  ExpectRefused({"project", sphere_, points, "--tolerance", "2"}, 2, {"unknown flag"});
}

TEST_F(ProjectTest, ManyPointsStream) {
  const std::string cloud = folder_.File("many.ply");
  ASSERT_EQ(Batten({"sample", sphere_, "-o", cloud, "--count", "100000", "--noise", "0.01"}).code,
            0);
  const ProgramRun run = Batten({"project", sphere_, cloud});
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 100001);
  constexpr std::int64_t kBytes = std::int64_t{60} << 20;
  EXPECT_LT(run.peak_bytes, kBytes + MemoryAtStart());
  EXPECT_EQ(Batten({"project", sphere_, cloud, "--quiet"}).out, "");
}

}  // namespace batten::internal::project_test
