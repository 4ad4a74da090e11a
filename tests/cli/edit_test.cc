// SPDX-License-Identifier: MIT
// batten edit: what each operation does to a shape, what is refused, and which files there are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/edit_operations.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "test_clouds.h"
#include "tolerances.h"

namespace batten::internal::edit_test {

using ::testing::HasSubstr;

constexpr unsigned kSeed = 31;

template <int Dim>
double Gap(const NurbsCurve<Dim>& a, const NurbsCurve<Dim>& b) {
  constexpr int kSamples = 37;
  double gap = 0;
  for (int k = 0; k <= kSamples; ++k) {
    const double t = static_cast<double>(k) / kSamples;
    const double u = a.basis().lower() + t * (a.basis().upper() - a.basis().lower());
    gap = std::max(gap, (a.At(u) - b.At(u)).norm());
  }
  return gap;
}
double Gap(const NurbsSurface& a, const NurbsSurface& b) {
  constexpr int kSamples = 13;
  double gap = 0;
  for (int k = 0; k <= kSamples; ++k) {
    for (int l = 0; l <= kSamples; ++l) {
      const double s = static_cast<double>(k) / kSamples, t = static_cast<double>(l) / kSamples;
      const double u = a.basis_u().lower() + s * (a.basis_u().upper() - a.basis_u().lower());
      const double v = a.basis_v().lower() + t * (a.basis_v().upper() - a.basis_v().lower());
      gap = std::max(gap, (a.At(u, v) - b.At(u, v)).norm());
    }
  }
  return gap;
}

class EditTest : public ::testing::Test {
 protected:
  static ProgramRun Edit(const std::string& in,
                         const std::string& out,
                         const std::vector<std::string>& operations) {
    std::vector<std::string> arguments = {"edit", in, "-o", out};
    arguments.insert(arguments.end(), operations.begin(), operations.end());
    return Batten(arguments);
  }

  // What the operations make of a shape.
  template <typename To, typename From>
  To Edited(const From& shape, const std::vector<std::string>& operations) {
    WriteGeometry({shape}, folder_.File("in.json"));
    const ProgramRun run = Edit(folder_.File("in.json"), folder_.File("out.json"), operations);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    return std::get<To>(ReadGeometry(folder_.File("out.json")).at(0));
  }

  template <typename Shape>
  Shape ExpectUnchanged(const Shape& shape, const std::vector<std::string>& operations) {
    const Shape edited = Edited<Shape>(shape, operations);
    EXPECT_LT(Gap(shape, edited), kRounding * 100) << operations.front();
    return edited;
  }

  // Refused with exit code 2 in one line, with nothing written.
  void ExpectRefused(const std::string& in,
                     const std::vector<std::string>& operations,
                     const std::vector<std::string>& said) {
    const std::ptrdiff_t before = folder_.Entries();
    const ProgramRun run = Edit(in, folder_.File("never.json"), operations);
    EXPECT_EQ(run.code, 2) << operations.front() << ": " << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(run.out, "");
    for (const std::string& words : said) EXPECT_THAT(run.err, HasSubstr(words));
    EXPECT_EQ(folder_.Entries(), before) << run.err;
  }

  // The same without running the program: what its functions throw.
  static void ExpectRefusal(const std::string& in,
                            const std::vector<std::string>& operations,
                            const std::vector<std::string>& said) {
    try {
      Geometry shape = ReadGeometry(in).at(0);
      for (const std::string& text : operations) {
        shape = ApplyEdit(ParseEditOperation(text), shape).pieces.at(0);
      }
      ADD_FAILURE() << "nothing was thrown for " << operations.back();
    } catch (const UsageError& error) {
      for (const std::string& words : said) EXPECT_THAT(error.what(), HasSubstr(words));
    }
  }

  TemporaryFolder folder_;
  RandomSplines random_{kSeed};
  std::string patch_ = folder_.With("patch.json", kRationalPatch);
  std::string parabola_ = folder_.With("parabola.json", kParabola);
};

TEST_F(EditTest, KnotsAndDegreesChangeButNotTheShape) {
  const auto curve = random_.Curve<3>(3, true, {.most_spans = 1});
  const SplineBasis& basis = curve.basis();
  const auto at = [&](double t) {
    return Shortest(basis.lower() + t * (basis.upper() - basis.lower()));
  };
  const auto inserted = ExpectUnchanged(curve, {"insert-knot:at=" + at(0.3) + ",times=2"});
  EXPECT_EQ(inserted.basis().size(), basis.size() + 2);
  EXPECT_TRUE(inserted == ExpectUnchanged(curve, {"insert-knot:times=2,u=" + at(0.3)}));
  EXPECT_TRUE(inserted == ExpectUnchanged(curve, {"refine:at=" + at(0.3) + ";" + at(0.3)}));
  EXPECT_EQ(ExpectUnchanged(curve, {"refine:at=" + at(0.1) + "," + at(0.2)}).basis().size(),
            basis.size() + 2);
  const auto removed = ExpectUnchanged(
      curve, {"insert-knot:at=" + at(0.3) + ",times=2", "remove-knot:at=" + at(0.3) + ",times=2"});
  EXPECT_EQ(removed.basis(), basis);
  EXPECT_EQ(ExpectUnchanged(curve, {"elevate"}).basis().degree(), 4);
  EXPECT_EQ(ExpectUnchanged(curve, {"elevate:by=3"}).basis().degree(), 6);
  EXPECT_EQ(ExpectUnchanged(curve, {"elevate:by=2", "reduce:by=2"}).basis().degree(), 3);
  EXPECT_FALSE(ExpectUnchanged(curve, {"unclamp"}).basis().clamped());
  EXPECT_TRUE(ExpectUnchanged(curve, {"unclamp", "clamp"}).basis().clamped());
}

TEST_F(EditTest, SurfacesAreEditedInTheDirectionNamed) {
  const NurbsSurface surface = random_.Surface(2, 3, true, {.most_spans = 1});
  const auto middle = [](const SplineBasis& basis) {
    return Shortest((basis.lower() + basis.upper()) / 2);
  };
  const std::string u = middle(surface.basis_u()), v = middle(surface.basis_v());
  const NurbsSurface finer =
      ExpectUnchanged(surface, {"insert-knot:dir=u,at=" + u, "refine:at=" + v + ",dir=v"});
  EXPECT_EQ(finer.size_u(), surface.size_u() + 1);
  EXPECT_EQ(finer.size_v(), surface.size_v() + 1);
  const NurbsSurface back = ExpectUnchanged(
      surface, {"insert-knot:dir=v,at=" + v, "remove-knot:dir=v,at=" + v + ",tolerance=1e-9"});
  EXPECT_EQ(back.size_v(), surface.size_v());
  EXPECT_EQ(ExpectUnchanged(surface, {"elevate:dir=v"}).basis_v().degree(), 4);
  EXPECT_EQ(ExpectUnchanged(surface, {"elevate:dir=u", "reduce:dir=u"}).basis_u().degree(), 2);
  const NurbsSurface unclamped = ExpectUnchanged(surface, {"unclamp"});
  EXPECT_FALSE(unclamped.basis_u().clamped() || unclamped.basis_v().clamped());
  const NurbsSurface clamped = ExpectUnchanged(unclamped, {"clamp:dir=u"});
  EXPECT_TRUE(clamped.basis_u().clamped());
  EXPECT_FALSE(clamped.basis_v().clamped());
}

TEST_F(EditTest, ParametersChangeAsNamed) {
  const auto curve = random_.Curve<2>(3, true);
  const double lower = curve.basis().lower(), upper = curve.basis().upper();
  const auto reversed = Edited<NurbsCurve<2>>(curve, {"reverse"});
  const auto moved = Edited<NurbsCurve<2>>(curve, {"reparameterize:to=2;5"});
  EXPECT_EQ(moved.basis().lower(), 2);
  EXPECT_EQ(moved.basis().upper(), 5);
  for (double t : {0.0, 0.1, 0.5, 0.8, 1.0}) {
    const double u = lower + t * (upper - lower);
    EXPECT_LT((reversed.At(upper + lower - u) - curve.At(u)).norm(), kRounding * 100);
    EXPECT_LT((moved.At(2 + 3 * t) - curve.At(u)).norm(), kRounding * 100);
  }
  // u = s / (2 - s) on [0, 1].
  const auto unit = Edited<NurbsCurve<2>>(curve, {"reparameterize:to=0;1"});
  const auto mobius = Edited<NurbsCurve<2>>(unit, {"reparameterize:mobius=1;0;-1;2"});
  for (double s : {0.0, 0.3, 0.9, 1.0}) {
    EXPECT_LT((mobius.At(s) - unit.At(2 * s / (1 + s))).norm(), kRounding * 100);
  }
  const NurbsSurface surface = random_.Surface(2, 3, true);
  const NurbsSurface swapped = Edited<NurbsSurface>(surface, {"swap"});
  EXPECT_EQ(swapped.basis_u(), surface.basis_v());
  EXPECT_EQ(swapped.control_point(1, 0), surface.control_point(0, 1));
  const NurbsSurface turned = Edited<NurbsSurface>(surface, {"reverse:dir=v"});
  EXPECT_EQ(turned.control_point(0, 0), surface.control_point(0, surface.size_v() - 1));
}

TEST_F(EditTest, ShapesMoveTurnAndGrow) {
  const NurbsSurface surface = random_.Surface(2, 3, true);
  const NurbsSurface moved = Edited<NurbsSurface>(surface, {"translate:1,-2,0.5"});
  EXPECT_LT((moved.control_point(1, 1) - surface.control_point(1, 1) - Eigen::Vector3d(1, -2, 0.5))
                .norm(),
            kRounding);
  const NurbsSurface turned = Edited<NurbsSurface>(surface, {"rotate:axis=0,0,2,angle=90"});
  const Eigen::Vector3d p = surface.control_point(1, 1);
  EXPECT_LT((turned.control_point(1, 1) - Eigen::Vector3d(-p.y(), p.x(), p.z())).norm(), kRounding);
  EXPECT_LT((Edited<NurbsSurface>(surface, {"scale:-3"}).control_point(1, 1) + 3 * p).norm(),
            kRounding);
  const NurbsSurface mapped =
      Edited<NurbsSurface>(surface, {"transform:matrix=1,2,0,3,0,1,0,4,0,0,1,5,0,0,0,1"});
  EXPECT_LT(
      (mapped.control_point(1, 1) - Eigen::Vector3d(p.x() + 2 * p.y() + 3, p.y() + 4, p.z() + 5))
          .norm(),
      kRounding);
  const auto plane = random_.Curve<2>(3, false);
  const Eigen::Vector2d q = plane.control_points().col(1);
  EXPECT_LT((Edited<NurbsCurve<2>>(plane, {"translate:1;2"}).control_points().col(1) - q -
             Eigen::Vector2d(1, 2))
                .norm(),
            kRounding);
  EXPECT_LT((Edited<NurbsCurve<2>>(plane, {"rotate:axis=0,0,1,angle=-90"}).control_points().col(1) -
             Eigen::Vector2d(q.y(), -q.x()))
                .norm(),
            kRounding);
}

TEST_F(EditTest, ShapesAreChangedByHand) {
  const NurbsSurface surface = random_.Surface(2, 3, true);
  EXPECT_EQ(Edited<NurbsSurface>(surface, {"set-weight:index=1;2,value=2.5"})
                .weights()[surface.size_v() + 2],
            2.5);
  const auto curve = random_.Curve<3>(3, false);
  EXPECT_EQ(Edited<NurbsCurve<3>>(curve, {"set-weight:index=2,value=0.25"}).weights()[2], 0.25);
  const double u = (curve.basis().lower() + curve.basis().upper()) / 2;
  const auto pulled = Edited<NurbsCurve<3>>(curve, {"move-point:at=" + Shortest(u) + ",to=1;2;3"});
  EXPECT_LT((pulled.At(u) - Eigen::Vector3d(1, 2, 3)).norm(), kRounding);
  const double s = (surface.basis_u().lower() + surface.basis_u().upper()) / 2;
  const double t = (surface.basis_v().lower() + surface.basis_v().upper()) / 2;
  const NurbsSurface dented = Edited<NurbsSurface>(
      surface, {"move-point:at=" + Shortest(s) + ";" + Shortest(t) + ",to=3,2,1"});
  EXPECT_LT((dented.At(s, t) - Eigen::Vector3d(3, 2, 1)).norm(), kRounding);
}

TEST_F(EditTest, SeveralPointsAndDerivativesAreMetAtOnce) {
  const NurbsCurve<2> curve(SplineBasis::Uniform(3, 8, 0, 1), Eigen::Matrix2Xd::Random(2, 8));
  const auto moved = Edited<NurbsCurve<2>>(
      curve, {"move:at=0.2;0.2;0.7,to=1;2;3;0;5;6,order=0;1;0,keep=0.5,fix=0;7"});
  EXPECT_LT((moved.At(0.2) - Eigen::Vector2d(1, 2)).norm(), kRounding * 10);
  EXPECT_LT((moved.JetAt(0.2).first - Eigen::Vector2d(3, 0)).norm(), kRounding * 1e3);
  EXPECT_LT((moved.At(0.7) - Eigen::Vector2d(5, 6)).norm(), kRounding * 10);
  EXPECT_LT((moved.At(0.5) - curve.At(0.5)).norm(), kRounding * 10);
  EXPECT_EQ(moved.control_points().col(0), curve.control_points().col(0));
  EXPECT_EQ(moved.control_points().col(7), curve.control_points().col(7));
  const NurbsSurface surface = random_.Surface(3, 2, true, {.most_spans = 4});
  const auto at = [&](double s) {
    const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
    return std::pair(u.lower() + s * (u.upper() - u.lower()),
                     v.lower() + s * (v.upper() - v.lower()));
  };
  const auto [u1, v1] = at(0.2);
  const auto [u2, v2] = at(0.8);
  const NurbsSurface dented =
      Edited<NurbsSurface>(surface,
                           {"move:at=" + Shortest(u1) + ";" + Shortest(v1) + ";" + Shortest(u2) +
                            ";" + Shortest(v2) + ",to=1;2;3;4;5;6"});
  EXPECT_LT((dented.At(u1, v1) - Eigen::Vector3d(1, 2, 3)).norm(), kRounding * 1e3);
  EXPECT_LT((dented.At(u2, v2) - Eigen::Vector3d(4, 5, 6)).norm(), kRounding * 1e3);
}

TEST_F(EditTest, WeightsPullPointsByALength) {
  const NurbsCurve<2> arch(SplineBasis::Uniform(3, 4, 0, 1),
                           Eigen::Matrix2Xd{{0, 0, 2, 2}, {0, 2, 2, 0}});
  const auto leg = Edited<NurbsCurve<2>>(arch, {"pull:at=0.5,index=1;2,by=0.25"});
  EXPECT_LT((leg.At(0.5) - Eigen::Vector2d(1, 1.75)).norm(), kRounding);
  EXPECT_EQ(leg.weights()[1], leg.weights()[2]);
  const auto one = Edited<NurbsCurve<2>>(arch, {"pull:at=0.5,index=1,by=0.25"});
  EXPECT_NEAR((one.At(0.5) - arch.At(0.5)).norm(), 0.25, kRounding);
  const NurbsSurface surface = std::get<NurbsSurface>(ReadGeometry(patch_).at(0));
  const auto pulled = Edited<NurbsSurface>(surface, {"pull:at=0.7;0.4,index=1;1,by=0.1"});
  EXPECT_NEAR((pulled.At(0.7, 0.4) - surface.At(0.7, 0.4)).norm(), 0.1, kRounding);
}

TEST_F(EditTest, RegionsAreWarpedFlattenedAndBent) {
  const NurbsSurface surface =
      std::get<NurbsSurface>(ReadGeometry(patch_).at(0));  // [0, 2] x [0, 1]
  const auto warped = Edited<NurbsSurface>(surface, {"warp:region=0.5;1.5;0.25;0.75,by=0;0;2"});
  EXPECT_LT((warped.At(1, 0.5) - surface.At(1, 0.5) - Eigen::Vector3d(0, 0, 2)).norm(),
            kRounding * 10);
  EXPECT_LT((warped.At(0.3, 0.5) - surface.At(0.3, 0.5)).norm(), kRounding * 10);
  const auto strip =
      Edited<NurbsSurface>(surface, {"warp:dir=u,region=0.5;1.5,by=0;0;2,shape=plateau,spans=8"});
  EXPECT_EQ(strip.size_v(), surface.size_v());
  const auto flat = Edited<NurbsSurface>(
      surface, {"flatten:region=0.5;1.5;0.25;0.75,plane=0;0;1;-1,along=0;1;1"});
  EXPECT_NEAR(flat.At(0.6, 0.7).z(), 1, kRounding);
  EXPECT_LT((flat.At(0.2, 0.5) - surface.At(0.2, 0.5)).norm(), kRounding * 10);
  const NurbsCurve<2> line(SplineBasis::Uniform(1, 2, 0, 1), Eigen::Matrix2Xd{{5, 5}, {0, 6}});
  const auto arc = Edited<NurbsCurve<2>>(
      line, {"elevate:by=2", "bend:from=5;0,center=0;0,length=6,tolerance=1e-6"});
  for (int k = 0; k <= 20; ++k) EXPECT_NEAR(arc.At(k / 20.).norm(), 5, 2e-6);
}

TEST_F(EditTest, BezierCurvesAreReducedByTheirRules) {
  const NurbsCurve<2> cubic(SplineBasis::Uniform(3, 4, 1, 2),
                            Eigen::Matrix2Xd{{0, 1, 2, 3}, {0, 1, 1, 0.1}});
  const auto reduced = [&](const std::string& rule) {
    return Edited<NurbsCurve<2>>(cubic, {"reduce:tolerance=1,rule=" + rule});
  };
  EXPECT_EQ(reduced("forward").JetAt(1).first, cubic.JetAt(1).first);
  EXPECT_EQ(reduced("backward").At(2), cubic.At(2));
  EXPECT_LT((reduced("backward").JetAt(2).first - cubic.JetAt(2).first).norm(), kRounding);
  EXPECT_EQ(reduced("fixed-ends").At(1), cubic.At(1));
  EXPECT_EQ(reduced("fixed-ends").At(2), cubic.At(2));
  EXPECT_LE(Gap(cubic, reduced("least-squares")), Gap(cubic, reduced("forward")));
}

TEST_F(EditTest, ASplineOfTheParameterTracesTheSameShape) {
  const NurbsCurve<2> parabola = std::get<NurbsCurve<2>>(ReadGeometry(parabola_).at(0));
  const auto traced =
      Edited<NurbsCurve<2>>(parabola, {"compose:degree=2,knots=0;0;0;1;1;1,values=0;0.25;1"});
  EXPECT_EQ(traced.basis().degree(), 4);
  for (const double s : {0.0, 0.3, 0.8, 1.0}) {
    const double u = 2 * s * (1 - s) * 0.25 + s * s;
    EXPECT_LT((traced.At(s) - parabola.At(u)).norm(), kRounding);
  }
}

TEST_F(EditTest, AnIsoCurveLiesOnTheSurface) {
  const NurbsSurface surface = random_.Surface(2, 3, true);
  const double u = (surface.basis_u().lower() + surface.basis_u().upper()) / 2;
  const auto iso = Edited<NurbsCurve<3>>(surface, {"iso:dir=u,at=" + Shortest(u)});
  EXPECT_EQ(iso.basis(), surface.basis_v());
  for (double t : {0.0, 0.2, 0.7, 1.0}) {
    const double v = iso.basis().lower() + t * (iso.basis().upper() - iso.basis().lower());
    EXPECT_LT((iso.At(v) - surface.At(u, v)).norm(), kRounding * 100);
  }
}

TEST_F(EditTest, PiecesAreFilesOfTheirOwn) {
  const ProgramRun run = Edit(patch_, folder_.File("half.json"), {"split:dir=u,at=0.5"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("half-1.json: surface of degree 2,2, 3 x 3 control points\n"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("half.json")));
  const auto whole = std::get<NurbsSurface>(ReadGeometry(patch_)[0]);
  const auto low = std::get<NurbsSurface>(ReadGeometry(folder_.File("half-1.json"))[0]);
  const auto high = std::get<NurbsSurface>(ReadGeometry(folder_.File("half-2.json"))[0]);
  EXPECT_EQ(low.basis_u().upper(), 0.5);
  EXPECT_EQ(high.basis_u().lower(), 0.5);
  EXPECT_LT(Gap(low, whole), kRounding);
  EXPECT_LT(Gap(high, whole), kRounding);
}

TEST_F(EditTest, WhatFollowsASplitIsDoneToEveryPiece) {
  const ProgramRun run = Edit(parabola_,
                              folder_.File("part.json"),
                              {"split:at=0.5", "elevate:by=2", "insert-knot:at=0.5", "decompose"});
  // Neither piece has 0.5 inside its domain, but both have it as an end of full multiplicity.
  EXPECT_EQ(run.code, 2) << run.err;
  EXPECT_THAT(run.err, HasSubstr("(geometry of index 0)"));
  const std::ptrdiff_t before = folder_.Entries();
  EXPECT_EQ(
      Edit(parabola_, folder_.File("part.json"), {"split:at=0.5", "elevate:by=2", "reverse"}).code,
      0);
  EXPECT_EQ(folder_.Entries(), before + 2);
  for (const char* name : {"part-1.json", "part-2.json"}) {
    EXPECT_EQ(std::get<NurbsCurve<2>>(ReadGeometry(folder_.File(name))[0]).basis().degree(), 4);
  }
}

TEST_F(EditTest, DecompositionGivesBezierPieces) {
  WriteGeometry({random_.Surface(2, 3, true, {.most_spans = 5})}, folder_.File("s.json"));
  const auto whole = std::get<NurbsSurface>(ReadGeometry(folder_.File("s.json"))[0]);
  const Json files = Json::parse(
      Batten({"edit", folder_.File("s.json"), "-o", folder_.File("b.json"), "decompose", "--json"})
          .out)["files"];
  ASSERT_EQ(files.size(), whole.basis_u().Spans().size() * whole.basis_v().Spans().size());
  for (std::size_t k = 0; k < files.size(); ++k) {
    EXPECT_EQ(files[k]["path"], folder_.File("b-" + std::to_string(k + 1) + ".json"));
    EXPECT_EQ(files[k]["kind"], "surface");
    EXPECT_EQ(files[k]["control_points"], Json({3, 4}));
    const auto piece = std::get<NurbsSurface>(ReadGeometry(files[k]["path"])[0]);
    EXPECT_LT(Gap(piece, whole), kRounding * 100);
  }
}

TEST_F(EditTest, PiecesOnStandardOutputAreOneDocument) {
  const ProgramRun run = Batten({"edit", parabola_, "-o", "-", "--format", "json", "split:at=0.5"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(Json::parse(run.out)["shape"]["count"], 2);
}

TEST_F(EditTest, SeveralGeometriesAreEditedTogether) {
  Json two = Json::parse(kParabola);
  two["shape"]["data"].push_back(two["shape"]["data"][0]);
  two["shape"]["count"] = 2;
  const std::string in = folder_.With("two.json", two.dump());
  EXPECT_EQ(Edit(in, folder_.File("out.json"), {"elevate"}).code, 0);
  EXPECT_EQ(ReadGeometry(folder_.File("out.json")).size(), 2u);
  EXPECT_EQ(Edit(in, folder_.File("cut.json"), {"split:at=0.5"}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_.File("cut-4.json")));
}

TEST_F(EditTest, PeriodicShapesStayPeriodicUntilTheyAreClampedOrCut) {
  const auto round = random_.Curve<3>(3, true, {.periodic = true});
  const double middle = (round.basis().lower() + round.basis().upper()) / 2;
  EXPECT_TRUE(ExpectUnchanged(round, {"elevate"}).basis().periodic());
  EXPECT_TRUE(Edited<NurbsCurve<3>>(round, {"reverse"}).basis().periodic());
  const auto closed = ExpectUnchanged(round, {"clamp"});
  EXPECT_FALSE(closed.basis().periodic());
  EXPECT_TRUE(closed.basis().clamped());
  WriteGeometry({round}, folder_.File("in.json"));
  EXPECT_EQ(
      Edit(folder_.File("in.json"), folder_.File("p.json"), {"split:at=" + Shortest(middle)}).code,
      0);
  EXPECT_FALSE(
      std::get<NurbsCurve<3>>(ReadGeometry(folder_.File("p-1.json"))[0]).basis().periodic());
}

TEST_F(EditTest, AStepFileIsWrittenAndReadToo) {
  EXPECT_EQ(Edit(patch_, folder_.File("a.step"), {"elevate:dir=u", "translate:1,2,3"}).code, 0);
  EXPECT_EQ(Edit(folder_.File("a.step"), folder_.File("b.step"), {"split:dir=v,at=0.5"}).code, 0);
  EXPECT_EQ(ReadGeometry(folder_.File("b-2.step")).size(), 1u);
}

TEST_F(EditTest, AToleranceThatCanNotBeKeptIsExitCodeThreeAndTheBestIsWritten) {
  const NurbsCurve<3> curve = random_.Curve<3>(3, false, {.highest_multiplicity = 1});
  ASSERT_GE(curve.basis().Spans().size(), 2u);
  WriteGeometry({curve}, folder_.File("in.json"));
  const std::string knot = Shortest(curve.basis().knots()[4]);
  for (const std::string& operation :
       {"remove-knot:at=" + knot + ",tolerance=1e-6", std::string("reduce:tolerance=1e-6")}) {
    const ProgramRun run = Edit(folder_.File("in.json"), folder_.File("out.json"), {operation});
    EXPECT_EQ(run.code, 3) << run.err;
    EXPECT_THAT(run.err, HasSubstr(operation));
    EXPECT_THAT(run.err, HasSubstr("0 of 1"));
    EXPECT_EQ(run.error_lines(), 1);
    EXPECT_TRUE(ReadGeometry(folder_.File("out.json")) == ReadGeometry(folder_.File("in.json")));
  }
  // A knot put in twice over one that was there: two go, the third can't.
  const ProgramRun run = Edit(folder_.File("in.json"),
                              folder_.File("out.json"),
                              {"insert-knot:at=" + knot + ",times=2",
                               "remove-knot:at=" + knot + ",times=3,tolerance=1e-6"});
  EXPECT_EQ(run.code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("2 of 3 removed"));
  EXPECT_EQ(std::get<NurbsCurve<3>>(ReadGeometry(folder_.File("out.json"))[0]).basis(),
            curve.basis());
  EXPECT_EQ(Edit(folder_.File("in.json"),
                 folder_.File("out.json"),
                 {"remove-knot:at=" + knot + ",tolerance=100"})
                .code,
            0);
}

TEST_F(EditTest, BadOperationsAreNamedWithValueAndRule) {
  const std::string surface = patch_, curve = parabola_;  // domains [0, 2] × [0, 1] and [0, 1]
  const struct {
    std::string in;
    std::vector<std::string> operations, said;
  } cases[] = {
      {curve, {"insert-knot:at=1.5"}, {"insert-knot:at=1.5", "1.5", "[0, 1]"}},
      {curve, {"insert-knot:at=0.5,times=3"}, {"insert-knot:at=0.5,times=3", "0.5", "2"}},
      {curve, {"insert-knot:at=0"}, {"insert-knot:at=0", "0"}},
      {curve, {"insert-knot:at=0.5,times=0"}, {"times = 0 is not a whole number from 1"}},
      {curve, {"insert-knot:at=0.5,times=1.5"}, {"times = 1.5 is not a whole number"}},
      {curve, {"insert-knot:at=x"}, {"at = 'x' is not a finite number"}},
      {curve, {"insert-knot:at=nan"}, {"at = 'nan' is not a finite number"}},
      {curve, {"insert-knot:at="}, {"at = '' is not a finite number"}},
      {curve, {"insert-knot:at=0.1;0.2"}, {"'0.1;0.2' holds 2 numbers; 1 is needed"}},
      {curve, {"insert-knot"}, {"'at' is missing", "insert-knot:at=0.3"}},
      {curve, {"insert-knot:0.5"}, {"'0.5' has no key", "takes at, times, dir"}},
      {curve, {"insert-knot:at=0.5,u=0.5"}, {"'at' is given twice", "u is another name"}},
      {curve, {"insert-knot:at=0.5,tims=2"}, {"unknown key 'tims'", "did you mean 'times'?"}},
      {curve, {"insert-knot:at=0.5,dir=u"}, {"a curve has one direction"}},
      {surface, {"insert-knot:at=0.5"}, {"a surface has two directions", "dir=u or dir=v"}},
      {surface, {"insert-knot:at=0.5,dir=w"}, {"dir = 'w' is neither u nor v"}},
      {surface, {"insert-knot:at=1.5,dir=v"}, {"1.5", "[0, 1]"}},
      {curve, {"insertknot:at=0.5"}, {"unknown operation 'insertknot'", "'insert-knot'"}},
      {curve, {"frobnicate"}, {"unknown operation 'frobnicate'", "known are insert-knot, refine"}},
      {curve, {""}, {"unknown operation ''"}},
      {curve, {"refine:at=0.5;2"}, {"refine:at=0.5;2", "2", "[0, 1]"}},
      {curve, {"remove-knot:at=0.5"}, {"remove-knot:at=0.5", "0.5"}},
      {curve, {"remove-knot:at=0.5,tolerance=-1"}, {"tolerance = -1 is not 0 or more"}},
      {curve, {"reduce:tolerance=-1"}, {"tolerance = -1 is not 0 or more"}},
      {curve, {"reduce:by=2"}, {"reduce:by=2", "2"}},
      {surface, {"reduce:dir=u,rule=forward"}, {"rule is for curves"}},
      {curve, {"reduce:by=2,rule=least-squares"}, {"by = 2 is not below the degree 2"}},
      {curve, {"reduce:rule=forwards"}, {"rule = 'forwards' is not among"}},
      {curve, {"insert-knot:at=0.5", "reduce:rule=forward"}, {"decompose first"}},
      {curve, {"elevate:by=24"}, {"elevate:by=24", "25"}},
      {curve, {"elevate:by=25"}, {"by = 25 is not a whole number from 1 to 24"}},
      {curve, {"elevate:by=-1"}, {"by = -1"}},
      {curve, {"split:at=0"}, {"split:at=0", "0"}},
      {curve, {"split:at=1"}, {"split:at=1", "1"}},
      {curve, {"split:at=7"}, {"split:at=7", "7", "[0, 1]"}},
      {surface, {"split:at=2,dir=u"}, {"split:at=2,dir=u", "2"}},
      {curve, {"swap"}, {"swap", "only a surface"}},
      {curve, {"swap:dir=u"}, {"unknown key 'dir'", "takes no values"}},
      {curve, {"iso:at=0.5"}, {"iso:at=0.5", "only a surface"}},
      {surface, {"iso:at=0.5"}, {"dir=u or dir=v"}},
      {surface, {"iso:at=9,dir=u"}, {"9", "[0, 2]"}},
      {surface, {"translate:1,2"}, {"three numbers x,y,z"}},
      {curve, {"translate:1,2,3"}, {"two numbers x,y"}},
      {curve, {"translate"}, {"its numbers are missing", "translate:x,y,z"}},
      {curve, {"translate:1,,2"}, {"'1,,2' is not a list of finite numbers"}},
      {curve, {"scale:0"}, {"scale:0", "0 is zero"}},
      {curve, {"scale:inf"}, {"'inf' is not a list of finite numbers"}},
      {surface, {"scale:1e200"}, {"scale:1e200", "1e150"}},
      {surface, {"rotate:axis=0,0,0,angle=5"}, {"rotate:axis=0,0,0,angle=5", "axis"}},
      {curve, {"rotate:axis=1,0,0,angle=45"}, {"rotate:axis=1,0,0,angle=45", "plane"}},
      {surface, {"transform:matrix=1,2,3"}, {"holds 3 numbers; 16 are needed"}},
      {surface,
       {"transform:matrix=1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,0"},
       {"transform:matrix=1,0,0,0,0,1"}},
      {curve, {"reparameterize"}, {"to=a;b"}},
      {curve, {"reparameterize:to=1;0"}, {"reparameterize:to=1;0"}},
      {curve, {"reparameterize:to=0;1,mobius=1;0;0;1"}, {"one of"}},
      {curve, {"reparameterize:mobius=1;0;0;0"}, {"reparameterize:mobius=1;0;0;0"}},
      {curve, {"set-weight:index=0,value=0"}, {"value = 0 is not positive"}},
      {curve, {"set-weight:index=3,value=1"}, {"set-weight:index=3,value=1", "3"}},
      {curve, {"set-weight:index=-1,value=1"}, {"index = -1 is not a whole number of 0 or more"}},
      {curve, {"set-weight:index=0;0,value=1"}, {"one number on a curve, not 2"}},
      {surface, {"set-weight:index=0,value=1"}, {"two numbers on a surface, not 1"}},
      {surface, {"set-weight:index=9;9,value=1"}, {"set-weight:index=9;9", "9"}},
      {curve, {"move-point:at=2,to=1;1"}, {"move-point:at=2", "2", "[0, 1]"}},
      {curve, {"move-point:at=0.5,to=1;1;1"}, {"two numbers x,y"}},
      {surface, {"move-point:at=0.5,to=1;1;1"}, {"two numbers on a surface, not 1"}},
      {curve, {"move:at=0.5;0.5,to=0;0;1;0"}, {"can't be met with the others", "0.5 are missing"}},
      {curve, {"move:at=0.5,to=0;0;1;0"}, {"two numbers x,y"}},
      {curve, {"move:at=0.5;0.6,to=0;0;1"}, {"to holds 3 numbers; 4 are needed"}},
      {curve, {"move:at=0.5,to=0;0,order=0;1"}, {"order holds 2 numbers; 1 are needed"}},
      {curve, {"move:at=0.5,to=0;0,fix=3"}, {"the fixed index i = 3 is not in [0, 2]"}},
      {surface, {"move:at=0.5,to=0;0;0"}, {"at holds 1 numbers; on a surface they are pairs"}},
      {curve, {"pull:at=0.5,index=1,by=1"}, {"by = 1 is not less than 1", "infinite"}},
      {curve, {"pull:at=0.5,index=1,by=-2"}, {"by = -2 is not above -1", "zero"}},
      {curve, {"pull:at=0.5,index=0;2,by=0.1"}, {"two neighbours"}},
      {surface, {"pull:at=0.5,index=1;1,by=0.1"}, {"at takes two numbers on a surface"}},
      {curve, {"warp:region=0.5;0.5,by=0;1"}, {"the range [0.5, 0.5] of u is empty"}},
      {curve, {"warp:region=0;2,by=0;1"}, {"[0, 2] of u leaves the domain [0, 1]"}},
      {curve, {"warp:region=0;1,by=0;1,shape=bumb"}, {"shape = 'bumb' is not among"}},
      {curve, {"warp:region=0;1,by=0;1,dir=u"}, {"a curve has one direction"}},
      {surface, {"warp:region=0;1,by=0;1;1"}, {"region takes four numbers on a surface"}},
      {curve, {"flatten:region=0;1,plane=0;0;1;0"}, {"c is 0"}},
      {curve, {"flatten:region=0;1,plane=0;0;0;1"}, {"no normal"}},
      {curve, {"bend:from=0;0,center=0;0,length=1"}, {"lies on the axis"}},
      {curve, {"bend:from=1;0,center=0;0,length=7"}, {"more than once round the circle, 6.28319"}},
      {curve, {"compose:degree=1,knots=0;0;1;1,values=0;0.5"}, {"compose:degree=1"}},
      {curve, {"elevate", "insert-knot:at=0.5", "split:at=3"}, {"split:at=3"}},
      {curve, {"elevate", "splitt:at=0.3"}, {"unknown operation 'splitt'", "'split'"}},
  };
  for (const auto& [in, operations, said] : cases) ExpectRefusal(in, operations, said);
  for (const size_t k : {size_t{0}, size_t{20}, std::size(cases) - 1}) {
    ExpectRefused(cases[k].in, cases[k].operations, cases[k].said);
  }
}

TEST_F(EditTest, FilesThatCanNotBeUsedAreRefusedBeforeTheWork) {
  const std::ptrdiff_t before = folder_.Entries();
  const auto refused = [&](const std::vector<std::string>& arguments, int code) {
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(folder_.Entries(), before);
    return run.err;
  };
  EXPECT_THAT(refused({"edit", parabola_, "-o", folder_.File("x.g2"), "reverse"}, 2),
              HasSubstr(".g2"));
  EXPECT_THAT(refused({"edit", parabola_, "-o", folder_.File("x.xyz"), "reverse"}, 2),
              HasSubstr(".xyz"));
  EXPECT_THAT(refused({"edit", parabola_, "-o", folder_.File("x.json")}, 2), HasSubstr("OP"));
  EXPECT_THAT(refused({"edit", parabola_, "reverse"}, 2), HasSubstr("--output"));
  EXPECT_THAT(
      refused({"edit", parabola_, "-o", folder_.File("x.json"), "reverse", "--tolerence"}, 2),
      HasSubstr("unknown flag '--tolerence'"));
  EXPECT_THAT(
      refused({"edit", folder_.File("no.json"), "-o", folder_.File("x.json"), "reverse"}, 1),
      HasSubstr("no.json"));
  EXPECT_THAT(refused({"edit", parabola_, "-o", folder_.File("no/x.json"), "split:at=0.5"}, 1),
              HasSubstr("no/x-1.json"));
  EXPECT_THAT(refused({"edit", parabola_, "-o", "-", "--format", "json", "--json", "reverse"}, 2),
              HasSubstr("standard output"));
}

TEST_F(EditTest, PiecesAppearAllOrNone) {
  std::filesystem::create_directory(folder_.File("x-2.json"));
  const std::ptrdiff_t before = folder_.Entries();
  const ProgramRun run = Edit(parabola_, folder_.File("x.json"), {"split:at=0.5"});
  EXPECT_EQ(run.code, 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("x-2.json"));
  EXPECT_EQ(folder_.Entries(), before);
}

TEST_F(EditTest, TheInputMayBeTheOutput) {
  EXPECT_EQ(Edit(parabola_, parabola_, {"elevate"}).code, 0);
  EXPECT_EQ(std::get<NurbsCurve<2>>(ReadGeometry(parabola_)[0]).basis().degree(), 3);
}

TEST_F(EditTest, QuietIsSilentAndJsonNamesTheFiles) {
  const std::string out = folder_.File("out.json");
  const ProgramRun quiet = Batten({"edit", parabola_, "-o", out, "elevate", "--quiet"});
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_EQ(Batten({"edit", parabola_, "-o", out, "elevate"}).out,
            out + ": curve of degree 3, 4 control points\n");
  const Json files = Json::parse(Batten({"edit", parabola_, "-o", out, "elevate", "--json"}).out);
  EXPECT_EQ(files["files"][0]["path"], out);
  EXPECT_EQ(files["files"][0]["kind"], "curve");
  EXPECT_EQ(files["files"].size(), 1u);
}

TEST_F(EditTest, HelpListsEveryOperation) {
  const std::string help = Batten({"edit", "--help"}).out;
  for (const char* name : {"insert-knot:at=",
                           "refine:at=",
                           "remove-knot:at=",
                           "elevate:by=",
                           "reduce:by=",
                           "split:at=",
                           "decompose",
                           "reverse",
                           "swap",
                           "transform:matrix=",
                           "translate:",
                           "rotate:axis=",
                           "scale:",
                           "clamp",
                           "unclamp",
                           "reparameterize:to=",
                           "mobius=",
                           "iso:at=",
                           "set-weight:index=",
                           "move-point:at=",
                           "move:at=",
                           "pull:at=",
                           "warp:region=",
                           "flatten:region=",
                           "bend:from=",
                           "compose:degree="}) {
    EXPECT_THAT(help, HasSubstr(name));
  }
}

}  // namespace batten::internal::edit_test
