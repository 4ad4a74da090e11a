// SPDX-License-Identifier: MIT
// batten section, and what batten edit extends, cuts and trims.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "angles.h"
#include "batten/geometry/arc_length.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/surface_area.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/edit_operations.h"
#include "run_program.h"
#include "tolerances.h"

namespace batten::internal::cut_test {

using ::testing::HasSubstr;

class CutTest : public ::testing::Test {
 protected:
  std::string Written(const std::string& name, const Geometry& shape) {
    WriteGeometry({shape}, folder_.File(name));
    return folder_.File(name);
  }

  static std::vector<Geometry> Applied(const std::string& operation, const Geometry& shape) {
    return ApplyEdit(ParseEditOperation(operation), shape).pieces;
  }

  static void ExpectRefusal(const std::string& operation,
                            const Geometry& shape,
                            const std::string& said) {
    try {
      Applied(operation, shape);
      ADD_FAILURE() << "nothing was thrown for " << operation;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr(said));
    }
  }

  TemporaryFolder folder_;
  NurbsSurface plate_ = MakePlane({}, {0, 2}, {0, 1});
  NurbsSurface cylinder_ = MakeCylinder({}, 1, {0, 4});
};

TEST_F(CutTest, TheSectionOfACylinderIsACircle) {
  const std::string in = Written("cylinder.json", cylinder_), out = folder_.File("circle.json");
  const ProgramRun run =
      Batten({"section", in, "--plane", "0,0,2,-3", "-o", out, "--tolerance", "1e-8"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("circle.json: curve of degree 3"));
  const std::vector<Geometry> curves = ReadGeometry(out);
  ASSERT_EQ(curves.size(), 1u);
  const auto& circle = std::get<NurbsCurve<3>>(curves[0]);
  EXPECT_NEAR(ArcLength(circle), 2 * kPi, 1e-7);
  EXPECT_NEAR(circle.At(circle.basis().lower())[2], 1.5, kRounding);
  const ProgramRun json = Batten({"section", in, "--plane", "0,1,0,0", "-o", out, "--json"});
  EXPECT_EQ(json.code, 0) << json.err;
  EXPECT_THAT(json.out, HasSubstr("\"count\": 2"));
}

// A line of a drawing has few control points unless more is asked for.
TEST_F(CutTest, SectionsKeepATenThousandthOfTheSizeUnlessToldOtherwise) {
  const std::string in = Written("bent.json", Applied("elevate:by=1,dir=v", cylinder_).at(0));
  const std::string out = folder_.File("oblique.json");
  const double size = std::sqrt(4 + 4 + 16);
  const auto points = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"section", in, "--plane", "1,0.3,1,-2", "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun run = Batten(words);
    EXPECT_EQ(run.code, 0) << run.err;
    const std::vector<Geometry> curves = ReadGeometry(out);
    EXPECT_EQ(curves.size(), 1u);
    const auto& curve = std::get<NurbsCurve<3>>(curves.at(0));
    double off = 0;
    for (int k = 0; k <= 1000; ++k) {
      const auto& basis = curve.basis();
      const Eigen::Vector3d x =
          curve.At(basis.lower() + k / 1000.0 * (basis.upper() - basis.lower()));
      off = std::max(off, std::abs(x.head<2>().norm() - 1));
    }
    EXPECT_LE(off, 1e-4 * size);
    return curve.basis().size();
  };
  EXPECT_LT(points({}), 60);
  EXPECT_GT(points({"--tolerance", "1e-9"}), 200);
}

TEST_F(CutTest, SectionsPassByCurvesAndSayHowMany) {
  const std::string in = folder_.File("mixed.json"), out = folder_.File("out.json");
  WriteGeometry({MakeArc(Frame(), 1, {0, 1}), cylinder_, MakeArc(Frame(), 2, {0, 1})}, in);
  const ProgramRun run = Batten({"section", in, "--plane", "0,0,1,-1", "-o", out});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.error_lines(), 1);
  EXPECT_THAT(run.err, HasSubstr("2 curves are left out: only surfaces have sections"));
  EXPECT_EQ(ReadGeometry(out).size(), 1u);
  WriteGeometry({MakeArc(Frame(), 1, {0, 1})}, in);
  const ProgramRun none = Batten({"section", in, "--plane", "0,0,1,-1", "-o", out});
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.err, HasSubstr("no surface"));
}

TEST_F(CutTest, SectionsRefuseWhatTheyCannotCut) {
  const std::string in = Written("cylinder.json", cylinder_), out = folder_.File("no.json");
  const auto refused = [&](const std::vector<std::string>& more, int code, const char* said) {
    std::vector<std::string> arguments = {"section", in, "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const std::ptrdiff_t before = folder_.Entries();
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(said));
    EXPECT_EQ(folder_.Entries(), before);
  };
  refused({}, 2, "--plane");
  refused({"--plane", "0,0,1"}, 2, "4 are needed");
  refused({"--plane", "0,0,0,1"}, 2, "no normal");
  refused({"--plane", "0,0,1,x"}, 2, "--plane");
  refused({"--plane", "0,0,1,9"}, 1, "does not cut it");
  refused({"--plane", "0,0,1,1", "--tolerance", "0"}, 2, "--tolerance");
}

TEST_F(CutTest, ExtendGrowsSurfacesAndCurves) {
  const auto longer =
      std::get<NurbsSurface>(Applied("extend:dir=u,end=upper,by=0.5", plate_).at(0));
  EXPECT_NEAR(longer.At(longer.basis_u().upper(), 0)[0], 2.5, kIterated);
  const auto lower =
      std::get<NurbsSurface>(Applied("extend:by=0.5,dir=v,end=lower,how=natural", plate_).at(0));
  EXPECT_NEAR(lower.At(0, lower.basis_v().lower())[1], -0.5, kIterated);
  const auto arc =
      std::get<NurbsCurve<3>>(Applied("extend:end=lower,by=1", MakeArc(Frame(), 1, {0, 1})).at(0));
  EXPECT_NEAR(ArcLength(arc), 2, kIterated);
  ExpectRefusal("extend:end=upper,by=1", plate_, "dir=u or dir=v");
  ExpectRefusal("extend:dir=u,by=1", plate_, "'end' is missing");
  ExpectRefusal("extend:dir=u,end=top,by=1", plate_, "end = 'top' is not among upper, lower");
  ExpectRefusal("extend:dir=u,end=upper,by=-1", plate_, "by = -1 is not positive");
  ExpectRefusal("extend:dir=u,end=upper,by=1", cylinder_, "closed in u");
}

TEST_F(CutTest, CutWritesThePiecesOnBothSides) {
  const std::string in = Written("plate.json", plate_);
  const ProgramRun run =
      Batten({"edit", in, "-o", folder_.File("part.json"), "cut:plane=1;0;0;-0.5"});
  EXPECT_EQ(run.code, 0) << run.err;
  const auto above = std::get<NurbsSurface>(ReadGeometry(folder_.File("part-1.json")).at(0));
  const auto below = std::get<NurbsSurface>(ReadGeometry(folder_.File("part-2.json")).at(0));
  EXPECT_NEAR(Area(above), 1.5, kIterated);
  EXPECT_NEAR(Area(below), 0.5, kIterated);
  const auto kept = Applied("cut:plane=1,0,0,-0.5,keep=below", plate_);
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_NEAR(Area(std::get<NurbsSurface>(kept[0])), 0.5, kIterated);
  ExpectRefusal("cut:plane=1,0,0,-9,keep=above", plate_, "nothing of it lies above the plane");
  ExpectRefusal("cut:plane=1,0,0", plate_, "4 are needed");
  ExpectRefusal("cut:plane=0,0,0,1", plate_, "plane.normal is zero");
  const auto arcs = Applied("cut:plane=1,0,0,-0.5", MakeArc(Frame(), 1));
  ASSERT_EQ(arcs.size(), 3u);  // the part above begins and ends where the circle does
  double length = 0;
  for (const Geometry& arc : arcs) length += ArcLength(std::get<NurbsCurve<3>>(arc));
  EXPECT_NEAR(length, 2 * kPi, kIterated);
}

TEST_F(CutTest, TrimKeepsTheInsideOrTheOutsideOfACurve) {
  const std::string disc = Written("disc.json", MakeArc(Eigen::Vector2d(0.5, 0.5), 0.25));
  const double hole = 2 * kPi / 16;
  const auto inside = Applied("trim:curve=" + disc, plate_);
  ASSERT_EQ(inside.size(), 1u);
  EXPECT_NEAR(Area(std::get<NurbsSurface>(inside[0])), hole, 1e-8);
  const auto outside = Applied("trim:curve=" + disc + ",keep=outside", plate_);
  ASSERT_EQ(outside.size(), 1u);
  EXPECT_NEAR(Area(std::get<NurbsSurface>(outside[0])), 2 - hole, 1e-8);
  const std::string above = Written("above.json", MakeArc(Frame({1, 0.5, 3}, {0, 0, 1}), 0.25));
  const auto projected = Applied("trim:curve=" + above, plate_);
  ASSERT_EQ(projected.size(), 1u);
  EXPECT_NEAR(Area(std::get<NurbsSurface>(projected[0])), kPi / 16, 1e-7);
  const std::string away = Written("away.json", MakeArc(Eigen::Vector2d(5, 5), 0.25));
  ExpectRefusal("trim:curve=" + away, plate_, "does not pass");
  ExpectRefusal("trim:keep=inside", plate_, "'curve' is missing");
  EXPECT_THROW(Applied("trim:curve=" + folder_.File("none.json"), plate_), ReadError);
}

}  // namespace batten::internal::cut_test
