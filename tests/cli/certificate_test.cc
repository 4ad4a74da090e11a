// SPDX-License-Identifier: MIT
// Certificates: what batten proves is proved anew by batten-verify, and lies are found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/trim_loops.h"
#include "batten/io/geometry_file.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "test_clouds.h"

namespace batten::internal::certificate_test {

using ::testing::HasSubstr;

struct Verified {
  int code = -1;
  std::string out;
};

Verified Verify(const std::string& arguments) {
  const std::string command = std::string(BATTEN_VERIFY) + " " + arguments + " 2>&1";
  FILE* pipe = ::popen(command.c_str(), "r");
  Verified result;
  if (pipe == nullptr) return result;
  std::array<char, 4096> block{};
  while (std::fgets(block.data(), static_cast<int>(block.size()), pipe)) result.out += block.data();
  result.code = WEXITSTATUS(::pclose(pipe));
  return result;
}

class CertificateTest : public ::testing::Test {
 protected:
  // Compares points near the geometry and far from it, and returns the certificate.
  Json Certified(const std::vector<Geometry>& geometry,
                 const Eigen::Vector3d& middle,
                 double size,
                 int count = 60) {
    WriteGeometry(geometry, folder_.File("part.json"));
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> even(-1, 1);
    std::vector<Row> rows;
    for (int k = 0; k < count; ++k)
      rows.push_back({middle[0] + size * even(random),
                      middle[1] + size * even(random),
                      middle[2] + size * even(random)});
    const std::string cloud = folder_.With("cloud.xyz", ToText(rows));
    const ProgramRun run = Batten({"compare",
                                   folder_.File("part.json"),
                                   cloud,
                                   "--certificate",
                                   folder_.File("proof.json"),
                                   "--json"});
    EXPECT_EQ(run.code, 0) << run.err;
    report_ = Json::parse(run.out);
    return Json::parse(folder_.Text("proof.json"));
  }

  void ExpectProved() {
    const Verified verified =
        Verify(folder_.File("proof.json") + " --geometry " + folder_.File("part.json"));
    EXPECT_EQ(verified.code, 0) << verified.out;
  }

  void ExpectRefuted(const Json& certificate) {
    const std::string path = folder_.With("lie.json", certificate.dump());
    const Verified verified = Verify(path);
    EXPECT_EQ(verified.code, 3) << verified.out;
  }

  TemporaryFolder folder_;
  Json report_;
};

TEST_F(CertificateTest, OfSurfacesAreProved) {
  const Json certificate = Certified({Sphere(2)}, {0, 0, 0}, 3);
  ExpectProved();
  EXPECT_FALSE(certificate["certified"]["folds_proved_absent"]);  // its poles
  EXPECT_EQ(report_["certified"]["unproved"].size(), 1u);
}

TEST_F(CertificateTest, OfRationalSurfacesFarFromZeroAreProved) {
  RandomSplines random(3);
  const NurbsSurface sheet = random.Sheet(3, 2, 0.4);
  Eigen::VectorXd weights = random.Weights(sheet.control_points().cols(), 0.5, 2);
  const NurbsSurface surface(
      sheet.basis_u(), sheet.basis_v(), sheet.control_points(), std::move(weights));
  const Eigen::Vector3d far(5e5, 5e6, 300);
  Certified({surface.Translated(far)}, far, 2);
  ExpectProved();
}

TEST_F(CertificateTest, OfCurvesAndSeveralGeometriesAreProved) {
  Certified({Circle(2), Sphere(1)}, {0, 0, 0}, 3);
  ExpectProved();
}

TEST_F(CertificateTest, LiesAreFound) {
  const Json certificate = Certified({Sphere(2)}, {0, 0, 0}, 3, 20);
  ExpectProved();
  Json lie = certificate;
  lie["points"][3][3] = lie["points"][3][3].get<double>() + 1e-6;  // above the true distance
  ExpectRefuted(lie);
  lie = certificate;
  lie["points"][4][4] = lie["points"][4][4].get<double>() - 1e-6;  // below it
  ExpectRefuted(lie);
  lie = certificate;
  lie["points"][5][7] = lie["points"][5][7].get<double>() + 0.01;  // another place
  ExpectRefuted(lie);
  lie = certificate;
  lie["certified"]["max_upper"] = 0;
  ExpectRefuted(lie);
  lie = certificate;
  lie["regularity"][0]["unproved"] = Json::array();
  ExpectRefuted(lie);
  lie["regularity"] = Json::array();
  lie["certified"]["folds_proved_absent"] = true;  // of surfaces that nothing is said of
  ExpectRefuted(lie);
  lie = certificate;
  lie["geometry"]["data"][0]["control_points"]["points"][7][0] = 9;
  ExpectRefuted(lie);
}

TEST_F(CertificateTest, VerifierRefusesWhatItCannotUse) {
  EXPECT_EQ(Verify("").code, 2);
  EXPECT_EQ(Verify("a.json --what").code, 2);
  EXPECT_EQ(Verify("/nowhere/a.json").code, 1);
  EXPECT_EQ(Verify(folder_.With("empty.json", "")).code, 1);
  EXPECT_EQ(Verify(folder_.With("other.json", "{}")).code, 1);
  EXPECT_EQ(Verify(folder_.With("array.json", "[1, 2]")).code, 1);
  EXPECT_EQ(Verify("--help").code, 0);
}

TEST_F(CertificateTest, FitsAreCertifiedWithTheTolerance) {
  const std::string cloud = folder_.With("sheet.xyz", ToText(WavySheet(800)));
  const ProgramRun run = Batten({"fit",
                                 "surface",
                                 cloud,
                                 "-o",
                                 folder_.File("part.json"),
                                 "--tolerance",
                                 "0.05",
                                 "--certificate",
                                 folder_.File("proof.json"),
                                 "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json certified = Json::parse(run.out)["certified"];
  EXPECT_EQ(certified["proved_within"], 800);
  EXPECT_TRUE(certified["folds_proved_absent"]) << certified;
  ExpectProved();
  Json lie = Json::parse(folder_.Text("proof.json"));
  lie["certified"]["tolerance"] = 1e-9;
  ExpectRefuted(lie);
}

TEST_F(CertificateTest, MeshesOfFitsAreProvedNearTheSurface) {
  const std::string cloud = folder_.With("sheet.xyz", ToText(WavySheet(800)));
  const ProgramRun run = Batten({"fit",
                                 "surface",
                                 cloud,
                                 "-o",
                                 folder_.File("part.stl"),
                                 "--certify",
                                 "--tolerance",
                                 "0.05",
                                 "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json certified = Json::parse(run.out)["certified"];
  EXPECT_NEAR(certified["mesh_chord"].get<double>(), 0.025, 0.0125) << certified;
}

// A knife's edge has normals on both sides, and turns over between them.
TEST_F(CertificateTest, CreasesThatTurnOverAreNotProved) {
  Eigen::Matrix3Xd net(3, 6);
  net << 0, 0, 1, 1, 0, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0;
  const NurbsSurface knife(SplineBasis(1, {0, 0, 1, 2, 2}), SplineBasis(1, {0, 0, 1, 1}), net);
  const Json certificate = Certified({knife}, {0.5, 0.5, 0}, 1, 10);
  EXPECT_FALSE(certificate["certified"]["folds_proved_absent"]);
  ExpectProved();
  Json lie = certificate;
  lie["regularity"][0]["unproved"] = Json::array();
  ExpectRefuted(lie);
}

// Numbers so large that their products overflow prove nothing.
TEST_F(CertificateTest, OverflowsProveNothing) {
  Json lie = Certified({Sphere(2)}, {0, 0, 0}, 3, 3);
  for (Json& point : lie["geometry"]["data"][0]["control_points"]["points"])
    point = {1e200, -1e200, 1e300};
  const std::string path = folder_.With("huge.json", lie.dump());
  EXPECT_NE(Verify(path).code, 0);
}

TEST_F(CertificateTest, ProfileDecisionsAllowForTheNoise) {
  WriteGeometry({Sphere(10)}, folder_.File("part.json"));
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<Row> rows;
  for (int k = 0; k < 3000; ++k) {
    Eigen::Vector3d p(normal(random), normal(random), normal(random));
    p *= (10 + 0.01 * normal(random)) / p.norm();
    rows.push_back({p[0], p[1], p[2]});
  }
  const std::string cloud = folder_.With("ball.xyz", ToText(rows));
  const auto decide = [&](const std::string& zone, int code) {
    const ProgramRun run =
        Batten({"compare", folder_.File("part.json"), cloud, "--profile", zone, "--json"});
    EXPECT_EQ(run.code, code) << run.err;
    return Json::parse(run.out)["profile"]["decision"].get<std::string>();
  };
  EXPECT_EQ(decide("0.2", 0), "conforms");
  EXPECT_EQ(decide("0.07", 3), "undecided");
  EXPECT_EQ(decide("0.01", 3), "does_not_conform");
  EXPECT_EQ(decide("-0.1,0.1", 0), "conforms");
  for (const char* bad : {"0", "-1", "1,0", "x", "1,2,3"})
    EXPECT_EQ(Batten({"compare", folder_.File("part.json"), cloud, "--profile", bad}).code, 2)
        << bad;
  EXPECT_EQ(Batten({"compare", folder_.File("part.json"), cloud, "--align", "datum"}).code, 2);
  EXPECT_EQ(Batten({"compare", folder_.File("part.json"), cloud, "--datum", "0"}).code, 2);
  // Distances from curves have no sign, and points along them no noise that is known.
  WriteGeometry({Circle(10)}, folder_.File("ring.json"));
  const std::string ring = folder_.With("ring.xyz", "10 0 0.1\n0 10 -0.1\n-10 0 0.1\n0 -10 0\n");
  const ProgramRun sides = Batten({"compare", folder_.File("ring.json"), ring, "--profile", "0,1"});
  EXPECT_EQ(sides.code, 2);
  EXPECT_THAT(sides.err, HasSubstr("no side"));
  const ProgramRun unknown = Batten({"compare", folder_.File("ring.json"), ring, "--profile", "1"});
  EXPECT_EQ(unknown.code, 0);
  EXPECT_THAT(unknown.err, HasSubstr("noise of the points is not known"));
}

}  // namespace batten::internal::certificate_test
