// SPDX-License-Identifier: MIT
// Faces that share edges: their meshes share vertices there.
#include "batten/geometry/tessellate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/geometry/transform.h"
#include "refusal.h"
#include "shell_laws.h"
#include "tolerances.h"

namespace batten::internal::tessellate_shell_test {

using ::testing::HasSubstr;

struct Shell {
  std::vector<NurbsSurface> surfaces;
  std::vector<FaceBorder> borders;
  double volume, area;
};

BorderPiece Straight(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int edge) {
  Eigen::Matrix2d ends;
  ends << from, to;
  return {NurbsCurve<2>(SplineBasis(1, {0, 0, 1, 1}), ends), edge, false};
}

// A side of a box with the corners of its domain at these vertices, and an edge's number by its two
// vertices.
void AddSide(Shell& shell,
             const std::vector<Eigen::Vector3d>& corners,
             const std::array<int, 4>& at) {
  shell.surfaces.push_back(
      MakeBilinear(corners[at[0]], corners[at[1]], corners[at[3]], corners[at[2]]));
  const std::array<Eigen::Vector2d, 4> places{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  std::vector<BorderPiece> loop;
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4, from = at[k], to = at[next];
    loop.push_back(Straight(places[k], places[next], std::min(from, to) * 8 + std::max(from, to)));
    loop.back().reversed = from > to;
  }
  shell.borders.push_back({{loop}, false});
}

// Bilinear sides whose corners are moved by `twist`: then they are curved, and so are their splits.
Shell Box(const Eigen::Vector3d& sizes, double twist) {
  std::vector<Eigen::Vector3d> corners;
  for (int k = 0; k < 8; ++k) {
    corners.emplace_back(k & 1 ? sizes[0] : 0, k & 2 ? sizes[1] : 0, k & 4 ? sizes[2] : 0);
  }
  corners[7] += twist * Eigen::Vector3d(1, 2, -1);
  Shell shell{
      {}, {}, sizes.prod(), 2 * (sizes[0] * sizes[1] + sizes[1] * sizes[2] + sizes[2] * sizes[0])};
  AddSide(shell, corners, {0, 2, 3, 1});
  AddSide(shell, corners, {4, 5, 7, 6});
  AddSide(shell, corners, {0, 1, 5, 4});
  AddSide(shell, corners, {2, 6, 7, 3});
  AddSide(shell, corners, {0, 4, 6, 2});
  AddSide(shell, corners, {1, 3, 7, 5});
  return shell;
}

// A circle in the plane as a curve whose parameter is the angle, to what fine pieces leave.
NurbsCurve<2> EvenCircle(const Eigen::Vector2d& centre, double radius, int pieces) {
  Eigen::Matrix2Xd points(2, pieces + 1);
  for (int k = 0; k <= pieces; ++k) {
    const double angle = 2 * std::numbers::pi * (k % pieces) / pieces;
    points.col(k) = centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return NurbsCurve<2>(SplineBasis::Uniform(1, pieces + 1, 0, 1), points);
}

// The side of a cylinder and two trimmed planes.
Shell Can(const Frame& frame, double radius, double height, int pieces) {
  Shell shell{{}, {}, 0, 0};
  shell.volume = std::numbers::pi * radius * radius * height;
  shell.area = 2 * std::numbers::pi * radius * (radius + height);
  const double wide = 1.5 * radius;
  const NurbsSurface side = MakeCylinder(frame, radius, {0, height});
  const double u = side.basis_u().upper(), v = side.basis_v().upper();
  // At even angles.
  Eigen::Matrix2Xd around(2, pieces + 1);
  for (int k = 0; k <= pieces; ++k) {
    const double arcs = side.basis_u().Spans().size(), place = arcs * k / pieces;
    const double arc = std::min(std::floor(place), arcs - 1), half = std::numbers::pi / arcs;
    const double angle = 2 * half * (place - arc - 0.5);
    around.col(k) << u / arcs * (arc + (1 + std::tan(angle / 2) / std::tan(half / 2)) / 2), 0;
  }
  const SplineBasis basis = SplineBasis::Uniform(1, pieces + 1, 0, 1);
  Eigen::Matrix2Xd back = around.rowwise().reverse();
  back.row(1).setConstant(v);
  shell.surfaces.push_back(side);
  shell.borders.push_back({{{{NurbsCurve<2>(basis, around), 0, false},
                             Straight({u, 0}, {u, v}, 2),
                             {NurbsCurve<2>(basis, back), 1, true},
                             Straight({0, v}, {0, 0}, 2)}},
                           false});
  shell.borders[0].loops[0][3].reversed = true;
  for (const bool top : {false, true}) {
    const Frame at(frame.origin() + (top ? height : 0) * frame.axis(), frame.axis(), frame.x());
    const NurbsSurface plane = MakePlane(at, {-wide, wide}, {-wide, wide});
    const NurbsCurve<2> circle = EvenCircle({0.5, 0.5}, radius / (2 * wide), pieces);
    shell.surfaces.push_back(plane.WithTrims({circle}));
    shell.borders.push_back({{{{circle, top ? 1 : 0, false}}}, !top});
  }
  return shell;
}

TEST(TessellateShellTest, ClosedShellsAreWatertight) {
  const Frame tilted({1, 2, 3}, Eigen::Vector3d(1, 2, 2).normalized());
  const std::vector<std::pair<std::string, Shell>> shells = {
      {"box", Box({3, 2, 1}, 0)},
      {"can", Can(tilted, 2, 5, 720)},
      {"flat can", Can(tilted, 2, 1e-3, 720)}};
  for (const auto& [name, shell] : shells) {
    for (const double tolerance : {5.0, 0.1, 0.01, 0.002}) {
      SCOPED_TRACE(name + " " + std::to_string(tolerance));
      const ShellMesh mesh =
          TessellateShell(shell.surfaces, shell.borders, {.chord_tolerance = tolerance});
      ExpectWatertight(mesh);
      ExpectNear(mesh, shell.surfaces, tolerance + mesh.gap);
      EXPECT_NEAR(VolumeOf(mesh), shell.volume, tolerance * shell.area + kRounding);
      EXPECT_GT(VolumeOf(mesh), 0);
    }
  }
}

// What one face has to split on an edge the other does not need.
TEST(TessellateShellTest, AFlatFaceFollowsWhatItsCurvedNeighbourSplits) {
  const Shell box = Box({3, 2, 1}, 0.7);
  for (const double tolerance : {0.1, 1e-3, 1e-4}) {
    const ShellMesh mesh =
        TessellateShell(box.surfaces, box.borders, {.chord_tolerance = tolerance});
    ExpectWatertight(mesh);
    ExpectNear(mesh, box.surfaces, tolerance);
    EXPECT_LE(mesh.gap, tolerance / 4);
  }
}

TEST(TessellateShellTest, MovesAndScalesWithTheFaces) {
  const Shell can = Can(Frame(), 2, 5, 360);
  const ShellMesh mesh = TessellateShell(can.surfaces, can.borders, {.chord_tolerance = 0.01});
  for (const double scale : {1e-6, 1e4}) {
    Shell scaled = can;
    for (NurbsSurface& one : scaled.surfaces) {
      one = Transformed(one, Eigen::Affine3d(Eigen::Scaling(scale)).matrix());
    }
    const ShellMesh other =
        TessellateShell(scaled.surfaces, scaled.borders, {.chord_tolerance = 0.01 * scale});
    ExpectWatertight(other);
    EXPECT_NEAR(VolumeOf(other) / std::pow(scale, 3), VolumeOf(mesh), kHalfDigits * VolumeOf(mesh));
  }
  Shell far = can;
  for (NurbsSurface& one : far.surfaces) one = one.Translated({5e6, 4e5, 100});
  const ShellMesh moved = TessellateShell(far.surfaces, far.borders, {.chord_tolerance = 0.01});
  ExpectWatertight(moved);
  ExpectNear(moved, far.surfaces, 0.01);
}

// Faces farther apart than the tolerance are joined all the same, and it is said how far they are.
TEST(TessellateShellTest, SaysHowFarFacesLeaveGaps) {
  constexpr double kGap = 0.05;
  Shell box = Box({3, 2, 1}, 0);
  box.surfaces[1] = box.surfaces[1].Translated({0, 0, kGap});
  const ShellMesh mesh = TessellateShell(box.surfaces, box.borders, {.chord_tolerance = 0.01});
  ExpectWatertight(mesh);
  EXPECT_NEAR(mesh.gap, kGap, 0.01);
  ExpectNear(mesh, box.surfaces, 0.01 + kGap);
}

// Two discs on one rim: chords of the rim would lie on one another.
TEST(TessellateShellTest, NoEdgeOfTheMeshIsInMoreThanTwoTriangles) {
  Shell lens;
  const NurbsCurve<2> circle = EvenCircle({0, 0}, 1, 12);
  for (const double lift : {0.0, 1e-3}) {
    Eigen::Matrix3Xd points(3, 9);
    for (int k = 0; k < 9; ++k) {
      const double x = 2.0 * (k / 3) - 2, y = 2.0 * (k % 3) - 2;
      points.col(k) << x, y, k == 4 ? lift : 0;
    }
    const NurbsSurface cap(
        SplineBasis::Uniform(2, 3, -2, 2), SplineBasis::Uniform(2, 3, -2, 2), points);
    lens.surfaces.push_back(cap.WithTrims({circle}));
    lens.borders.push_back({{{{circle, 0, false}}}, lift == 0});
  }
  for (const double tolerance : {0.5, 0.1}) {
    ExpectWatertight(TessellateShell(lens.surfaces, lens.borders, {.chord_tolerance = tolerance}));
  }
}

TEST(TessellateShellTest, AFaceWithoutABorderIsTessellatedAlone) {
  Shell box = Box({3, 2, 1}, 0);
  box.borders[0].loops.clear();
  const ShellMesh mesh = TessellateShell(box.surfaces, box.borders);
  const TriangleMesh alone = Tessellate(box.surfaces[0], {.chord_tolerance = 0.01});
  EXPECT_EQ(mesh.faces[0].triangles, alone.triangles);
  EXPECT_THAT(mesh.joints[0], ::testing::Each(-1));
}

TEST(TessellateShellTest, RefusesWhatIsNoShell) {
  const Shell box = Box({3, 2, 1}, 0);
  EXPECT_THAT(RefusalOf([&] { TessellateShell(box.surfaces, {}); }, ""),
              HasSubstr("borders: 0 for 6"));
  EXPECT_THAT(RefusalOf([&] { TessellateShell({}, {}); }, ""), HasSubstr("borders: 0 for 0"));
  std::vector<FaceBorder> empty = box.borders;
  empty[2].loops.emplace_back();
  EXPECT_THAT(RefusalOf([&] { TessellateShell(box.surfaces, empty); }, ""),
              HasSubstr("a loop is empty"));
  EXPECT_THAT(RefusalOf(
                  [&] {
                    TessellateShell(Box({3, 2, 1}, 0.7).surfaces,
                                    box.borders,
                                    {.chord_tolerance = 1e-6, .max_triangles = 100});
                  },
                  ""),
              HasSubstr("max_triangles"));
}

}  // namespace batten::internal::tessellate_shell_test
