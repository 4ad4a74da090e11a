// SPDX-License-Identifier: MIT
#include "batten/io/write_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "batten/fitting/fit_surface.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "glb_checker.h"
#include "temporary_folder.h"
#include "tolerances.h"

namespace batten::internal::write_uncertainty_test {

// A sheet with a void in a corner, where fairness decides.
class WriteUncertaintyTest : public testing::Test {
 protected:
  WriteUncertaintyTest() : fit_(Fitted()), of_(fit_, cloud_, 1) {
    map_ = MapUncertainty(of_, fit_.surface);
  }

  SurfaceFit Fitted() {
    std::mt19937_64 engine(3);
    std::uniform_real_distribution<double> even(0, 1);
    std::normal_distribution<double> noise(0, 0.01);
    Eigen::Matrix3Xd points(3, 900);
    for (Eigen::Index k = 0; k < points.cols();) {
      const double x = even(engine), y = even(engine);
      if (x > 0.55 && y > 0.55 && x < 0.95 && y < 0.95) continue;
      points.col(k++) << x, y, std::sin(3 * x) * y + noise(engine);
    }
    cloud_ = PointCloud::FromWorld(points);
    SurfaceFitOptions options;
    options.control_points = {14, 14};
    options.threads = 1;
    return FitSurface(cloud_, options);
  }

  std::string Write(const std::string& name) {
    const std::string path = folder_.File(name);
    WriteUncertainty(path, map_, fit_.surface, 1)->Commit();
    return path;
  }

  // The rows under the header: u, v, x, y, z, sigma, bias, support, area.
  std::vector<std::vector<double>> Rows() {
    std::ifstream file(Write("map.csv"));
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line, "u,v,x,y,z,sigma,bias,support,area");
    std::vector<std::vector<double>> rows;
    while (std::getline(file, line)) {
      std::vector<double>& row = rows.emplace_back();
      std::istringstream numbers(line);
      for (std::string word; std::getline(numbers, word, ',');) row.push_back(std::stod(word));
    }
    return rows;
  }

  TemporaryFolder folder_;
  PointCloud cloud_;
  SurfaceFit fit_;
  Uncertainty of_;
  UncertaintyMap map_;
};

TEST_F(WriteUncertaintyTest, TablesHaveDeviationsOfPlacesOfTheSurface) {
  const auto rows = Rows();
  ASSERT_GT(rows.size(), 100U);
  int unsupported = 0;
  for (const auto& row : rows) {
    ASSERT_EQ(row.size(), 9U);
    EXPECT_EQ(fit_.surface.At(row[0], row[1]), Eigen::Vector3d(row[2], row[3], row[4]));
    const PlaceUncertainty place = of_.At(row[0], row[1]);
    EXPECT_NEAR(row[5], place.deviation, kIterated * place.deviation);
    EXPECT_NEAR(row[7], place.support, kIterated);
    unsupported += place.support < kLeastSupport;
  }
  EXPECT_GT(unsupported, 0);
}

TEST_F(WriteUncertaintyTest, MeshesHaveThePlacesAndColoursByTheirDeviations) {
  const auto rows = Rows();
  const PointCloud ply = ReadCloud({Write("map.ply")}).cloud;
  std::ifstream file(Write("map.glb"), std::ios::binary);
  const auto shown = GlbChecker({std::istreambuf_iterator<char>(file), {}}).Meshes();
  ASSERT_EQ(shown.size(), 1U);
  const GlbMesh& mesh = shown[0];
  ASSERT_EQ(mesh.vertices.cols(), std::ssize(rows));
  ASSERT_EQ(mesh.colours.cols(), std::ssize(rows));
  ASSERT_EQ(ply.size(), std::ssize(rows));
  std::vector<std::pair<double, double>> redness;  // by deviation
  for (Eigen::Index k = 0; k < mesh.vertices.cols(); ++k) {
    const auto& row = rows[static_cast<size_t>(k)];
    const Eigen::Vector3d at(mesh.vertices(0, k), -mesh.vertices(2, k), mesh.vertices(1, k));
    EXPECT_LT((at - Eigen::Vector3d(row[2], row[3], row[4])).norm(), 1e-6);  // floats
    EXPECT_EQ(ply.World(k), Eigen::Vector3d(row[2], row[3], row[4]));
    const Eigen::Vector3d colour = mesh.colours.col(k).head<3>();
    const bool grey = colour[0] == colour[1] && colour[1] == colour[2];
    if (row[7] < kLeastSupport) {
      EXPECT_TRUE(grey);
    } else {
      redness.emplace_back(row[5], colour[0] - colour[2]);
    }
  }
  std::sort(redness.begin(), redness.end());
  EXPECT_LT(redness.front().second, 0);
  EXPECT_GT(redness.back().second, 0);
}

TEST_F(WriteUncertaintyTest, OtherNamesAreRefused) {
  EXPECT_THROW(CheckUncertaintyName("map.stl", false), UsageError);
  EXPECT_THROW(CheckUncertaintyName("map.ply", true), UsageError);
  EXPECT_THROW(CheckUncertaintyName("map.glb", true), UsageError);
  EXPECT_NO_THROW(CheckUncertaintyName("map.GLB", false));
  EXPECT_NO_THROW(CheckUncertaintyName("map.csv", true));
}

}  // namespace batten::internal::write_uncertainty_test
