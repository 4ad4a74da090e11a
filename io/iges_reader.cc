// SPDX-License-Identifier: MIT
#include "batten/io/iges_reader.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "batten/geometry/split.h"
#include "batten/io/file_loops.h"
#include "batten/io/iges_text.h"
#include "batten/io/read_error.h"
#include "batten/io/trim_pieces.h"
#include "batten/io/whole_file.h"

namespace batten {
namespace {

constexpr double kLargestCoordinate = 1e150;

// Entity types of the specification.
enum Type { kComposite = 102, kLine = 110, kMatrix = 124, kCurve = 126, kSurface = 128 };
enum TrimType { kCurveOnSurface = 142, kTrimmedSurface = 144 };

// The parameters of an entity, in order.
class Numbers {
 public:
  explicit Numbers(const std::vector<double>& numbers) : numbers_(numbers) {}

  double Real() { return next_ < numbers_.size() ? numbers_[next_++] : 0; }

  // A count or degree; the numbers it promises must be there, so it is below their number.
  int Integer() {
    const double value = Real();
    if (!(value >= 0 && value <= static_cast<double>(numbers_.size()))) {
      throw std::invalid_argument("promises more numbers than it has");
    }
    return static_cast<int>(value);
  }

  int Entity() { return IgesIndex(Real()); }

  std::vector<double> Reals(size_t count) {
    if (count > numbers_.size() - std::min(next_, numbers_.size())) {
      throw std::invalid_argument("promises more numbers than it has");
    }
    const auto begin = numbers_.begin() + static_cast<std::ptrdiff_t>(next_);
    next_ += count;
    return {begin, begin + static_cast<std::ptrdiff_t>(count)};
  }

 private:
  const std::vector<double>& numbers_;
  size_t next_ = 0;
};

// Throws where a knot, weight or coordinate is not finite or too large to be calculated with.
template <class Numbers>
void RequireWithinLimits(const Numbers& numbers, const char* what) {
  for (const double number : numbers) {
    if (!(std::abs(number) <= kLargestCoordinate)) {
      throw std::invalid_argument(std::string("has a ") + what + " above 1e150 in magnitude");
    }
  }
}

Eigen::Matrix3Xd Points(const std::vector<double>& numbers) {
  RequireWithinLimits(numbers, "coordinate");
  return Eigen::Map<const Eigen::Matrix3Xd>(
      numbers.data(), 3, static_cast<Eigen::Index>(numbers.size() / 3));
}

std::vector<double> Knots(std::vector<double> numbers) {
  RequireWithinLimits(numbers, "knot");
  return numbers;
}

Eigen::VectorXd Weights(const std::vector<double>& numbers) {
  RequireWithinLimits(numbers, "weight");
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

// The range of parameters that counts, within the domain; all of it where none is given.
std::array<double, 2> Range(const SplineBasis& basis, double from, double to) {
  constexpr double kSame = 1e-12;
  const double slack = kSame * (basis.upper() - basis.lower());
  std::array<double, 2> range = {basis.lower(), basis.upper()};
  if (!(from < to)) return range;
  if (from > range[0] + slack && from < range[1]) range[0] = from;
  if (to < range[1] - slack && to > range[0]) range[1] = to;
  return range;
}

NurbsCurve<3> ReadCurve(const std::vector<double>& parameters) {
  Numbers in(parameters);
  const int size = in.Integer() + 1, degree = in.Integer();
  for (int i = 0; i < 4; ++i) in.Real();
  const auto count = static_cast<size_t>(size);
  std::vector<double> knots = Knots(in.Reals(count + static_cast<size_t>(degree) + 1));
  Eigen::VectorXd weights = Weights(in.Reals(count));
  Eigen::Matrix3Xd points = Points(in.Reals(3 * count));
  NurbsCurve<3> curve(SplineBasis(degree, std::move(knots)), std::move(points), std::move(weights));
  const double from = in.Real(), to = in.Real();
  const auto range = Range(curve.basis(), from, to);
  if (range[0] == curve.basis().lower() && range[1] == curve.basis().upper()) return curve;
  return Segment(curve, range[0], range[1]);
}

// The file's points run through u first.
NurbsSurface ReadSurface(const std::vector<double>& parameters) {
  Numbers in(parameters);
  const int size_u = in.Integer() + 1, size_v = in.Integer() + 1;
  const int degree_u = in.Integer(), degree_v = in.Integer();
  for (int i = 0; i < 5; ++i) in.Real();
  const auto nu = static_cast<size_t>(size_u), nv = static_cast<size_t>(size_v);
  std::vector<double> knots_u = Knots(in.Reals(nu + static_cast<size_t>(degree_u) + 1));
  std::vector<double> knots_v = Knots(in.Reals(nv + static_cast<size_t>(degree_v) + 1));
  const Eigen::VectorXd weights = Weights(in.Reals(nu * nv));
  const Eigen::Matrix3Xd points = Points(in.Reals(3 * nu * nv));
  Eigen::Matrix3Xd net(3, points.cols());
  Eigen::VectorXd net_weights(points.cols());
  for (int i = 0; i < size_u; ++i) {
    for (int j = 0; j < size_v; ++j) {
      const Eigen::Index to = Eigen::Index{i} * size_v + j, from = Eigen::Index{j} * size_u + i;
      net.col(to) = points.col(from);
      net_weights[to] = weights[from];
    }
  }
  NurbsSurface surface(SplineBasis(degree_u, std::move(knots_u)),
                       SplineBasis(degree_v, std::move(knots_v)),
                       std::move(net),
                       std::move(net_weights));
  const double u0 = in.Real(), u1 = in.Real(), v0 = in.Real(), v1 = in.Real();
  const auto u = Range(surface.basis_u(), u0, u1), v = Range(surface.basis_v(), v0, v1);
  if (u[0] == surface.basis_u().lower() && u[1] == surface.basis_u().upper() &&
      v[0] == surface.basis_v().lower() && v[1] == surface.basis_v().upper()) {
    return surface;
  }
  return Segment(surface, u[0], u[1], v[0], v[1]);
}

NurbsCurve<3> ReadLine(const std::vector<double>& parameters) {
  Numbers in(parameters);
  const Eigen::Matrix3Xd ends = Points(in.Reals(6));
  return NurbsCurve<3>(SplineBasis(1, {0, 0, 1, 1}), ends);
}

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
  Reader(const std::vector<IgesEntity>& entities, const std::string& path)
      : entities_(entities), path_(path) {
    for (const IgesEntity& entity : entities) {
      numbers_ += static_cast<std::int64_t>(entity.parameters.size());
    }
  }

  std::vector<Geometry> All() {
    for (size_t i = 0; i < entities_.size(); ++i) {
      const IgesEntity& entity = entities_[i];
      if (entity.dependent || !entity.geometry) continue;
      const int index = static_cast<int>(i);
      try {
        Add(index);
      } catch (const std::invalid_argument& error) {
        throw ReadError(path_, IgesName(entities_, index) + ": " + error.what());
      }
    }
    if (result_.empty()) throw ReadError(path_, "holds no curves or surfaces that can be read");
    return std::move(result_);
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
    constexpr int kFirstShape = 100, kLastShape = 198, kPoint = 116;
    switch (entity.type) {
      case kSurface:
        result_.emplace_back(Placed(entity, ReadSurface(entity.parameters)));
        return;
      case kTrimmedSurface:
        result_.emplace_back(Trimmed(entity));
        return;
      case kCurve:
      case kLine:
      case kComposite:
        for (NurbsCurve<3>& curve : Curves(entity)) {
          result_.emplace_back(std::move(curve));
        }
        return;
      case kMatrix:
      case kPoint:
      case kCurveOnSurface:
        return;
      default:
        if (entity.type < kFirstShape || entity.type > kLastShape) return;
        throw std::invalid_argument(
            "is of a type that is not in this version; B-spline surfaces (128, 144) and curves "
            "(126, 110, 102) are");
    }
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
    if (entity.type == kCurve) {
      curves.push_back(ReadCurve(entity.parameters));
    } else if (entity.type == kLine) {
      curves.push_back(ReadLine(entity.parameters));
    } else if (entity.type == kComposite && composite) {
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

  NurbsSurface Trimmed(const IgesEntity& entity) {
    Numbers in(entity.parameters);
    const IgesEntity& base = At(in.Entity(), "surface");
    if (base.type != kSurface) {
      throw std::invalid_argument("trims a surface of type " + std::to_string(base.type) +
                                  ", which is not in this version");
    }
    CountWork(base);
    NurbsSurface surface = Placed(base, ReadSurface(base.parameters));
    const bool outer = in.Integer() != 0;
    const int holes = in.Integer(), boundary = in.Entity();
    std::vector<NurbsCurve<2>> loops;
    if (outer) {
      loops.push_back(Loop(At(boundary, "boundary"), surface));
    } else if (holes > 0) {
      loops.push_back(DomainBoundary(surface));
    }
    for (int i = 0; i < holes; ++i) loops.push_back(Loop(At(in.Entity(), "boundary"), surface));
    if (loops.size() == 1 && RunsRoundDomain(surface, loops[0])) loops.clear();
    try {
      return Placed(entity, WithTurnedLoops(surface, std::move(loops), kCadGap));
    } catch (const LoopError& error) {
      throw std::invalid_argument("loop " + std::to_string(error.loop() + 1) + " " + error.what());
    }
  }

  NurbsCurve<2> Loop(const IgesEntity& entity, const NurbsSurface& surface) {
    if (entity.type != kCurveOnSurface) throw std::invalid_argument("has no curve for a boundary");
    Numbers in(entity.parameters);
    in.Real();
    in.Real();
    const int in_parameters = in.Entity();
    const Eigen::Array2d sides = DomainSides(surface);
    std::vector<NurbsCurve<2>> pieces;
    for (const NurbsCurve<3>& piece :
         Curves(At(in_parameters, "curve in the surface's parameters"))) {
      pieces.push_back(InPlane(piece));
    }
    return Shut(Chained(std::move(pieces), sides, kCadGap, true), sides, kCadGap);
  }

  static constexpr int kMostLevels = 8;

  const std::vector<IgesEntity>& entities_;
  const std::string& path_;
  std::vector<Geometry> result_;
  std::int64_t numbers_ = 0, work_ = 0;
};

}  // namespace

std::vector<Geometry> ReadIges(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  const std::string text = ReadWholeFile(path);
  const std::vector<IgesEntity> entities = ParseIges(text, name);
  return Reader(entities, name).All();
}

}  // namespace batten
