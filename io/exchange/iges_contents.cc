// SPDX-License-Identifier: MIT
#include "io/exchange/iges_contents.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/clamp.h"
#include "batten/geometry/frame.h"
#include "batten/geometry/join.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "geometry/nurbs/placed_curve.h"
#include "io/exchange/file_loops.h"
#include "io/exchange/iges_header.h"
#include "io/exchange/iges_shapes.h"
#include "io/exchange/iges_solids.h"
#include "io/exchange/iges_text.h"
#include "io/exchange/iges_types.h"
#include "io/exchange/parameter_map.h"
#include "io/exchange/trim_pieces.h"

namespace batten::internal {
namespace {

using Numbers = IgesNumbers;

NurbsCurve<2> InPlane(const NurbsCurve<3>& curve) {
  return NurbsCurve<2>(curve.basis(), curve.control_points().topRows<2>(), curve.weights());
}

// Whether a loop is the boundary of the domain.
bool RunsRoundDomain(const NurbsSurface& surface, const NurbsCurve<2>& loop) {
  const auto pieces = TrimPieces(surface, loop);
  return std::all_of(pieces.begin(), pieces.end(), [](const TrimPiece& piece) {
    return piece.side != Side::kNone;
  });
}

class Reader {
 public:
  explicit Reader(const std::vector<IgesEntity>& entities) : entities_(entities) {
    for (const IgesEntity& entity : entities) {
      numbers_ += static_cast<std::int64_t>(entity.parameters.size());
    }
  }

  // The curves and surfaces with their names.
  IgesContents All() {
    IgesContents found;
    for (size_t i = 0; i < entities_.size(); ++i) {
      const IgesEntity& entity = entities_[i];
      // Shells that no solid names are called dependent all the same.
      const bool shell = entity.type == kIgesShell;
      if ((entity.dependent && !shell) || !entity.geometry) continue;
      const int index = static_cast<int>(i);
      try {
        const size_t before = result_.size();
        Add(index);
        names_.resize(result_.size(), result_.size() > before ? NameOfIges(entities_, entity) : "");
      } catch (const std::invalid_argument& error) {
        found.contents.unread.push_back(IgesName(entities_, index) + ": " + error.what());
      }
    }
    found.contents.geometry = std::move(result_);
    found.contents.names = std::move(names_);
    found.points = points_;
    if (beyond_ >= 0) {
      found.beyond = IgesName(entities_, beyond_) + ": " + why_beyond_;
      found.fault = Fault();
    }
    return found;
  }

 private:
  const IgesEntity& At(int index, const char* what) const {
    if (index >= 0 && index < static_cast<int>(entities_.size())) {
      return entities_[static_cast<size_t>(index)];
    }
    throw std::invalid_argument(std::string("names no ") + what + " of the file");
  }

  void Add(int index) {
    const IgesEntity& entity = entities_[static_cast<size_t>(index)];
    constexpr int kFirstShape = 100, kLastShape = 198, kPointSet = 3;
    switch (entity.type) {
      case kIgesSurface:
      case kIgesRuled:
      case kIgesRevolution:
      case kIgesTabulated:
        result_.emplace_back(SurfaceOf(entity).surface);
        return;
      case kIgesTrimmedSurface:
        result_.emplace_back(Trimmed(entity));
        return;
      case kIgesPlane:
        if (entity.form == 1) result_.emplace_back(BoundedPlane(entity));
        return;
      case kIgesBounded:
        result_.emplace_back(Bounded(entity));
        return;
      case kIgesPoint:
        ++points_;
        return;
      case kIgesMatrix:
      case kIgesBoundary:
      case kIgesCurveOnSurface:
        return;
      case kIgesInstance:
      case kIgesRectangularArray:
      case kIgesCircularArray:
      case kIgesNetworkInstance:
        return Beyond(index, "places a subfigure that can't be read: have it exploded on export");
      case kIgesExternal:
        throw std::invalid_argument(
            "stands for geometry in another file, which is not in this version: have it exported "
            "in one file");
      case kIgesSolid:
      case kIgesAssembly:
      case kIgesSolidInstance:
      case kIgesVertices:
      case kIgesEdges:
      case kIgesEdgeLoop:
      case kIgesFace:
      case kIgesShell:
        return Beyond(
            index,
            "is of a B-rep solid that can't be read: have it exported as trimmed surfaces "
            "(144)");
      default:
        if (entity.type == kIgesPolyline && entity.form >= 1 && entity.form <= kPointSet) {
          ++points_;
          return;
        }
        if (entity.type != kIgesComposite && !IsIgesCurve(entity)) {
          if (entity.type < kFirstShape || entity.type > kLastShape) return;
          return Beyond(index,
                        "is of a type that can't be read; surfaces 108, 114, 118, 120, 122, 128, "
                        "140, 143, 144, solids 186 and curves 100, 102, 104, 106, 110, 112, 126 "
                        "can");
        }
        for (NurbsCurve<3>& curve : Curves(entity)) result_.emplace_back(std::move(curve));
    }
  }

  // The first entity that a solid could not be made of, and why; empty: there is none.
  std::string Fault() const {
    for (size_t i = 0; i < entities_.size(); ++i) {
      const IgesEntity& entity = entities_[i];
      try {
        CheckIgesSolid(entities_, entity);
        if (IsIgesCurve(entity)) ReadIgesCurve(entity);
        if (entity.type == kIgesSurface) ReadIgesSurface(entity);
      } catch (const std::invalid_argument& error) {
        return IgesName(entities_, static_cast<int>(i)) + ": " + error.what();
      }
    }
    return "";
  }

  void Beyond(int index, const char* why) {
    if (beyond_ >= 0) return;
    beyond_ = index;
    why_beyond_ = why;
  }

  // Hostile files name one long entity over and over.
  void CountWork(const IgesEntity& entity) {
    constexpr std::int64_t kMostRepeats = 64, kAlwaysAllowed = 1'000'000;
    work_ += static_cast<std::int64_t>(entity.parameters.size());
    if (work_ > kMostRepeats * numbers_ + kAlwaysAllowed) {
      throw std::invalid_argument("names the same entities over and over");
    }
  }

  // The parts of a curve, itself or those of a composite, which are not composites.
  std::vector<NurbsCurve<3>> Curves(const IgesEntity& entity, bool composite = true) {
    std::vector<NurbsCurve<3>> curves;
    CountWork(entity);
    if (IsIgesCurve(entity)) {
      curves.push_back(ReadIgesCurve(entity));
    } else if (entity.type == kIgesComposite && composite) {
      Numbers in(entity.parameters);
      for (int count = in.Integer(); count > 0; --count) {
        for (NurbsCurve<3>& part : Curves(At(in.Entity(), "curve"), false)) {
          curves.push_back(std::move(part));
        }
      }
    } else {
      throw std::invalid_argument("has a curve of type " + std::to_string(entity.type) +
                                  ", which is not in this version");
    }
    for (NurbsCurve<3>& curve : curves) {
      curve = NurbsCurve<3>(curve.basis(), Moved(entity, curve.control_points()), curve.weights());
    }
    return curves;
  }

  NurbsSurface Placed(const IgesEntity& entity, const NurbsSurface& surface) const {
    if (entity.transform < 0) return surface;
    return NurbsSurface(surface.basis_u(),
                        surface.basis_v(),
                        Moved(entity, surface.control_points()),
                        surface.weights())
        .WithTrims(surface.trims());
  }

  // By the entity's matrices, the innermost first.
  Eigen::Matrix3Xd Moved(const IgesEntity& entity, Eigen::Matrix3Xd points) const {
    int index = entity.transform;
    for (int level = 0; index >= 0; ++level) {
      if (level == kMostLevels) throw std::invalid_argument("is placed by too many matrices");
      const IgesEntity& matrix = entities_[static_cast<size_t>(index)];
      Numbers in(matrix.parameters);
      const std::vector<double> rows = in.Reals(12);
      const Eigen::Matrix<double, 3, 4> m =
          Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(rows.data());
      points = ((m.leftCols<3>() * points).colwise() + m.col(3)).eval();
      index = matrix.transform;
    }
    RequireWithinLimits(points.reshaped(), "coordinate");
    return points;
  }

  // A surface with the maps of the file's parameters to its own.
  struct Base {
    NurbsSurface surface;
    std::optional<ParameterMap> u, v;  // none: they are the same
    bool swapped = false;              // the file's first parameter is v
    bool skewed = false;               // they are others, which no map brings back
  };

  // The only part of a curve that spans a surface.
  NurbsCurve<3> Rail(int index) {
    std::vector<NurbsCurve<3>> parts = Curves(At(index, "curve"));
    if (parts.empty()) throw std::invalid_argument("has a composite curve without a part");
    NurbsCurve<3> rail = Clamped(parts[0]);
    for (size_t i = 1; i < parts.size(); ++i) {
      const double size = (parts[i].control_points().colwise() - rail.control_points().col(0))
                              .colwise()
                              .norm()
                              .maxCoeff();
      rail = Join(rail, parts[i], kCadGap * size);
    }
    return rail;
  }

  Base SurfaceOf(const IgesEntity& entity) {
    CountWork(entity);
    Numbers in(entity.parameters);
    switch (entity.type) {
      case kIgesSurface:
        return {Placed(entity, ReadIgesSurface(entity)), {}, {}};
      case kIgesRuled: {
        const int rails[] = {in.Entity(), in.Entity()};
        const NurbsCurve<3> first = Rail(rails[0]);
        NurbsCurve<3> second = Rail(rails[1]);
        if (in.Real() != 0) second = Reversed(second);
        const NurbsSurface surface = Ruled(first, second);
        return {Placed(entity, surface),
                {},
                {},
                false,
                !AlikeWeights(surface) || !KeepsParameters(At(rails[0], "curve")) ||
                    !KeepsParameters(At(rails[1], "curve"))};
      }
      case kIgesTabulated: {
        const int directrix = in.Entity();
        const NurbsCurve<3> rail = Reparameterized(Rail(directrix), 0, 1);
        const std::vector<double> end = in.Reals(3);
        const Eigen::Vector3d by = Eigen::Map<const Eigen::Vector3d>(end.data()) - rail.At(0);
        return {Placed(entity, Ruled(rail, Translated(rail, by))),
                {},
                {},
                false,
                !KeepsParameters(At(directrix, "curve"))};
      }
      case kIgesRevolution: {
        const NurbsCurve<3> axis = Rail(in.Entity());
        const int generatrix = in.Entity();
        const NurbsCurve<3> profile = Rail(generatrix);
        const double from = in.Real(), to = in.Real();
        const Eigen::Vector3d origin = axis.At(axis.basis().lower());
        const Frame frame(origin, axis.At(axis.basis().upper()) - origin);
        const NurbsSurface surface = Revolve(profile, frame, {from, FullTurn(to - from)});
        const ParameterMap u(from, to, surface.basis_u(), true);
        const IgesEntity& curve = At(generatrix, "curve");
        if (curve.type == kIgesArc) {
          const AngleRange angles = IgesArcAngles(curve);
          const ParameterMap v(angles.start, angles.start + angles.sweep, surface.basis_v(), true);
          return {Placed(entity, surface), u, v, true};
        }
        const SplineBasis& v = surface.basis_v();
        return {Placed(entity, surface),
                u,
                ParameterMap(v.lower(), v.upper(), v, false),
                true,
                !KeepsParameters(curve)};
      }
      default:
        throw std::invalid_argument("trims a surface of type " + std::to_string(entity.type) +
                                    ", which is not in this version");
    }
  }

  // Whether a curve's parameters are those of the file: lines and splines.
  static bool KeepsParameters(const IgesEntity& curve) {
    return curve.type == kIgesLine || curve.type == kIgesParametric || curve.type == kIgesCurve;
  }

  // A turn that is whole but for the digits of the file.
  static double FullTurn(double angle) {
    constexpr double kWhole = 2 * std::numbers::pi, kDigits = 1e-9;
    return std::abs(angle - kWhole) <= kDigits ? kWhole : angle;
  }

  NurbsSurface Trimmed(const IgesEntity& entity) {
    Numbers in(entity.parameters);
    if (!entity.parameters.empty()) {
      const IgesEntity& surface = At(IgesIndex(entity.parameters[0]), "surface");
      if (surface.type == kIgesPlane) return TrimmedPlane(entity, surface);
    }
    const Base base = SurfaceOf(At(in.Entity(), "surface"));
    const bool outer = in.Integer() != 0;
    const int holes = in.Integer(), boundary = in.Entity();
    std::vector<NurbsCurve<2>> loops;
    if (outer) {
      loops.push_back(Loop(At(boundary, "boundary"), base));
    } else if (holes > 0) {
      loops.push_back(DomainBoundary(base.surface));
    }
    for (int i = 0; i < holes; ++i) loops.push_back(Loop(At(in.Entity(), "boundary"), base));
    return WithLoops(entity, base, std::move(loops));
  }

  // The frame of a plane, A x + B y + C z = D, where its matrix puts it.
  Frame FrameOf(const IgesEntity& plane) const {
    Numbers in(plane.parameters);
    const std::vector<double> numbers = in.Reals(4);
    const Eigen::Vector3d normal(numbers[0], numbers[1], numbers[2]);
    if (!(normal.norm() > 0)) throw std::invalid_argument("is a plane without a normal");
    const Frame frame(normal * (numbers[3] / normal.squaredNorm()), normal);
    if (plane.transform < 0) return frame;
    Eigen::Matrix3Xd points(3, 3);
    points << frame.origin(), frame.At(1, 0, 0), frame.At(0, 1, 0);
    points = Moved(plane, std::move(points));
    const Eigen::Vector3d x = points.col(1) - points.col(0), y = points.col(2) - points.col(0);
    return Frame(points.col(0), x.cross(y), x);
  }

  // The part of a plane inside loops that are curves in space: a plane has no parameters of its
  // own.
  NurbsSurface PlaneInside(const Frame& frame, const std::vector<int>& curves) {
    std::vector<std::vector<NurbsCurve<2>>> loops;
    Eigen::AlignedBox2d box;
    for (const int curve : curves) {
      std::vector<NurbsCurve<2>> pieces;
      for (const NurbsCurve<3>& part : Curves(At(curve, "boundary in space"))) {
        Eigen::Matrix2Xd flat(2, part.control_points().cols());
        const Eigen::Matrix3Xd from = part.control_points().colwise() - frame.origin();
        flat.row(0) = frame.x().transpose() * from;
        flat.row(1) = frame.y().transpose() * from;
        pieces.emplace_back(part.basis(), std::move(flat), part.weights());
        box.extend(BoundingBox(pieces.back()));
      }
      loops.push_back(std::move(pieces));
    }
    const Eigen::Vector2d sides = box.sizes();
    if (!(sides.minCoeff() > 0)) throw std::invalid_argument("encloses no part of its plane");
    const Base base{
        MakePlane(frame, {box.min().x(), box.max().x()}, {box.min().y(), box.max().y()}), {}, {}};
    std::vector<NurbsCurve<2>> inside;
    for (std::vector<NurbsCurve<2>>& pieces : loops) {
      for (NurbsCurve<2>& piece : pieces) {
        const Eigen::Matrix2Xd places =
            (piece.control_points().colwise() - box.min()).array().colwise() / sides.array();
        piece = NurbsCurve<2>(piece.basis(), places, piece.weights());
      }
      inside.push_back(InOne(std::move(pieces), base));
    }
    return WithLoops(IgesEntity(), base, std::move(inside));
  }

  NurbsSurface TrimmedPlane(const IgesEntity& entity, const IgesEntity& plane) {
    constexpr size_t kSpaceCurve = 3;
    const auto in_space = [&](int boundary) {
      const IgesEntity& curve = At(boundary, "boundary");
      if (curve.type != kIgesCurveOnSurface || curve.parameters.size() <= kSpaceCurve) {
        throw std::invalid_argument("has no curve for a boundary");
      }
      return IgesIndex(curve.parameters[kSpaceCurve]);
    };
    Numbers in(entity.parameters);
    in.Entity();
    if (in.Integer() == 0) throw std::invalid_argument("is a plane without an outer boundary");
    const int holes = in.Integer();
    std::vector<int> curves = {in_space(in.Entity())};
    for (int i = 0; i < holes; ++i) curves.push_back(in_space(in.Entity()));
    return Placed(entity, PlaneInside(FrameOf(plane), curves));
  }

  NurbsSurface BoundedPlane(const IgesEntity& entity) {
    constexpr size_t kBoundingCurve = 4;
    if (entity.parameters.size() <= kBoundingCurve) throw std::invalid_argument("has no boundary");
    return PlaneInside(FrameOf(entity), {IgesIndex(entity.parameters[kBoundingCurve])});
  }

  // Its boundaries are the loops, the outer one among them.
  NurbsSurface Bounded(const IgesEntity& entity) {
    Numbers in(entity.parameters);
    const bool in_parameters = in.Integer() != 0;
    if (!in_parameters) {
      throw std::invalid_argument("is bounded by curves in space alone, not in parameters");
    }
    const Base base = SurfaceOf(At(in.Entity(), "surface"));
    std::vector<NurbsCurve<2>> loops;
    for (int count = in.Integer(); count > 0; --count) {
      const IgesEntity& boundary = At(in.Entity(), "boundary");
      if (boundary.type != kIgesBoundary) throw std::invalid_argument("has no boundary for a loop");
      Numbers of(boundary.parameters);
      for (int i = 0; i < 3; ++i) of.Real();
      std::vector<NurbsCurve<2>> pieces;
      for (int curves = of.Integer(); curves > 0; --curves) {
        of.Real();
        of.Real();
        for (int parts = of.Integer(); parts > 0; --parts) AddPieces(of.Entity(), base, pieces);
      }
      loops.push_back(InOne(std::move(pieces), base));
    }
    return WithLoops(entity, base, std::move(loops));
  }

  // Whether the weights along v = 1 are those along v = 0, up to a factor.
  static bool AlikeWeights(const NurbsSurface& ruled) {
    constexpr double kSame = 1e-12;
    const Eigen::VectorXd& w = ruled.weights();
    for (Eigen::Index i = 0; i + 1 < w.size(); i += 2) {
      if (std::abs(w[i] * w[1] - w[i + 1] * w[0]) > kSame * w[i] * w[1]) return false;
    }
    return true;
  }

  NurbsSurface WithLoops(const IgesEntity& entity,
                         const Base& base,
                         std::vector<NurbsCurve<2>> loops) {
    if (base.skewed) {
      throw std::invalid_argument(
          "is trimmed on a surface whose parameters are not those of a NURBS surface");
    }
    if (loops.size() == 1 && RunsRoundDomain(base.surface, loops[0])) loops.clear();
    try {
      return Placed(entity, WithTurnedLoops(base.surface, std::move(loops), kCadGap));
    } catch (const LoopError& error) {
      throw std::invalid_argument("loop " + std::to_string(error.loop() + 1) + " " + error.what());
    }
  }

  NurbsCurve<2> Loop(const IgesEntity& entity, const Base& base) {
    if (entity.type != kIgesCurveOnSurface)
      throw std::invalid_argument("has no curve for a boundary");
    Numbers in(entity.parameters);
    in.Real();
    in.Real();
    std::vector<NurbsCurve<2>> pieces;
    AddPieces(in.Entity(), base, pieces);
    return InOne(std::move(pieces), base);
  }

  void AddPieces(int index, const Base& base, std::vector<NurbsCurve<2>>& pieces) {
    constexpr double kMapping = 1e-8;  // of the domain
    for (const NurbsCurve<3>& part : Curves(At(index, "curve in the surface's parameters"))) {
      NurbsCurve<2> piece = InPlane(part);
      if (base.swapped) {
        piece = NurbsCurve<2>(
            piece.basis(), piece.control_points().colwise().reverse(), piece.weights());
      }
      if (base.u) piece = Mapped(piece, *base.u, *base.v, DomainSides(base.surface), kMapping);
      pieces.push_back(std::move(piece));
    }
  }

  // Where a loop passes a pole, an edge of the domain that is one point, files leave the edge out.
  static std::vector<NurbsCurve<2>> WithPoles(std::vector<NurbsCurve<2>> pieces,
                                              const NurbsSurface& surface) {
    constexpr double kOnePoint = 1e-6;
    const Eigen::Matrix3Xd& net = surface.control_points();
    const double size = (net.rowwise().maxCoeff() - net.rowwise().minCoeff()).norm();
    const Eigen::Array2d sides = DomainSides(surface);
    const auto in_space = [&](const Eigen::Vector2d& at) {
      const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
      return surface.At(std::clamp(at[0], u.lower(), u.upper()),
                        std::clamp(at[1], v.lower(), v.upper()));
    };
    std::vector<NurbsCurve<2>> result;
    for (size_t i = 0; i < pieces.size(); ++i) {
      const NurbsCurve<2>& next = pieces[(i + 1) % pieces.size()];
      const Eigen::Vector2d end = pieces[i].At(pieces[i].basis().upper());
      const Eigen::Vector2d start = next.At(next.basis().lower());
      result.push_back(pieces[i]);
      const Eigen::Vector2d gap = start - end;
      if (!((gap.array().abs() / sides).maxCoeff() > kCadGap)) continue;
      bool pole = true;
      for (const double share : {0.0, 0.3, 0.7, 1.0}) {
        pole = pole && (in_space(end + share * gap) - in_space(end)).norm() <= kOnePoint * size;
      }
      if (pole) {
        Eigen::Matrix2d ends;
        ends << end, start;
        result.emplace_back(SplineBasis(1, {0, 0, 1, 1}), ends);
      }
    }
    return result;
  }

  static NurbsCurve<2> InOne(std::vector<NurbsCurve<2>> pieces, const Base& base) {
    const Eigen::Array2d sides = DomainSides(base.surface);
    pieces = WithPoles(std::move(pieces), base.surface);
    return Shut(Chained(std::move(pieces), sides, kCadGap, true), sides, kCadGap);
  }

  static constexpr int kMostLevels = 8;

  const std::vector<IgesEntity>& entities_;
  std::vector<Geometry> result_;
  std::vector<std::string> names_;
  int points_ = 0;
  int beyond_ = -1;  // the first that is not read here
  std::string why_beyond_;
  std::int64_t numbers_ = 0, work_ = 0;
};

}  // namespace

IgesContents ParseIgesContents(const std::string& text, const std::string& name) {
  const std::vector<IgesEntity> entities = ParseIges(text, name);
  IgesContents found = Reader(entities).All();
  ReadIgesUnit(ParseIgesGlobal(text, name), found.contents);
  return found;
}

}  // namespace batten::internal
