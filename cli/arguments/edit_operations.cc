// SPDX-License-Identifier: MIT
#include "cli/arguments/edit_operations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>

#include "batten/geometry/bezier_curve.h"
#include "batten/geometry/bezier_reduction.h"
#include "batten/geometry/clamp.h"
#include "batten/geometry/composition.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/degree_reduction.h"
#include "batten/geometry/extend.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/remove_knots.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "batten/geometry/transform.h"
#include "cli/arguments/edit_cuts.h"
#include "cli/arguments/edit_forms.h"
#include "cli/arguments/edit_shapes.h"

namespace batten::internal {
namespace {

// f(curve) or, with the direction the operation must name, f(surface, direction).
template <typename F>
EditOutcome InDirection(const EditOperation& operation, const Geometry& shape, F f) {
  if (const auto* surface = std::get_if<NurbsSurface>(&shape)) {
    if (!operation.direction) operation.Refuse("a surface has two directions; say dir=u or dir=v");
    return f(*surface, *operation.direction);
  }
  if (operation.direction) operation.Refuse("a curve has one direction; leave dir out");
  if (const auto* plane = std::get_if<NurbsCurve<2>>(&shape)) return f(*plane);
  return f(std::get<NurbsCurve<3>>(shape));
}

// The same, in both directions of a surface where none is named.
template <typename F>
EditOutcome InEveryDirection(const EditOperation& operation, const Geometry& shape, F f) {
  const auto* surface = std::get_if<NurbsSurface>(&shape);
  if (surface && !operation.direction) {
    return One(f(f(*surface, Direction::kU), Direction::kV));
  }
  return InDirection(operation, shape, [&](const auto& one, auto... direction) {
    return One(f(one, direction...));
  });
}

const NurbsSurface& RequireSurface(const EditOperation& operation, const Geometry& shape) {
  if (const auto* surface = std::get_if<NurbsSurface>(&shape)) return *surface;
  operation.Refuse("only a surface has two directions; this is a curve");
}

// What a removal or reduction may move the shape by: what is typed, or rounding.
template <typename Shape>
double Tolerance(const EditOperation& operation, const Shape& shape) {
  if (operation.Has("tolerance")) return operation.Number("tolerance");
  return RoundingOf(shape);
}

std::string Shortfall(const EditOperation& operation,
                      int done,
                      const std::string& key,
                      const char* what,
                      double tolerance,
                      double error) {
  const int asked = operation.Whole(key);
  if (done >= asked) return "";
  return fmt::format("{}: {} of {} {} within the tolerance {:.3g} (error {:.3g})",
                     operation.typed,
                     done,
                     asked,
                     what,
                     tolerance,
                     error);
}

EditOutcome RemoveKnots(const EditOperation& op, const Geometry& shape) {
  return InDirection(op, shape, [&](const auto& one, auto... direction) -> EditOutcome {
    const double tolerance = Tolerance(op, one);
    auto removal = RemoveKnot(one, direction..., op.Number("at"), op.Whole("times"), tolerance);
    return {{std::move(removal.shape)},
            Shortfall(op, removal.removed, "times", "removed", tolerance, removal.error)};
  });
}

std::optional<BezierReductionRule> RuleOf(const EditOperation& op) {
  const std::string& word = op.Word("rule");
  if (word == "forward") return BezierReductionRule::kForward;
  if (word == "backward") return BezierReductionRule::kBackward;
  if (word == "least-squares") return BezierReductionRule::kLeastSquares;
  if (word == "fixed-ends") return BezierReductionRule::kLeastSquaresFixedEnds;
  return std::nullopt;
}

// One Bézier piece by one of its rules.
template <int Dim>
EditOutcome ReduceBezier(const EditOperation& op,
                         const NurbsCurve<Dim>& curve,
                         BezierReductionRule rule) {
  const SplineBasis& basis = curve.basis();
  if (!basis.clamped() || basis.Spans().size() != 1)
    op.Refuse("rule is for Bezier pieces; decompose first");
  if (op.Whole("by") >= basis.degree()) {
    op.Refuse(fmt::format("by = {} is not below the degree {}", op.Whole("by"), basis.degree()));
  }
  const double tolerance = Tolerance(op, curve);
  BezierCurve<Dim> piece(curve.control_points(), curve.weights());
  double error = 0, next = 0;
  int done = 0;
  for (; done < op.Whole("by"); ++done) {
    auto reduced = Reduced(piece, rule);
    if (!reduced) op.Refuse("a weight would not be positive");
    next = error + reduced->error;
    if (next > tolerance) break;
    error = next;
    piece = std::move(reduced->curve);
  }
  const double ends[] = {basis.lower(), basis.upper()};
  return {{NurbsCurve<Dim>(
              SplineBasis::Clamped(piece.degree(), ends), piece.control_points(), piece.weights())},
          Shortfall(op, done, "by", "degrees taken away", tolerance, next)};
}

EditOutcome Reduce(const EditOperation& op, const Geometry& shape) {
  if (const auto rule = RuleOf(op)) {
    if (const auto* plane = std::get_if<NurbsCurve<2>>(&shape))
      return ReduceBezier(op, *plane, *rule);
    if (const auto* curve = std::get_if<NurbsCurve<3>>(&shape))
      return ReduceBezier(op, *curve, *rule);
    op.Refuse("rule is for curves");
  }
  return InDirection(op, shape, [&](const auto& one, auto... direction) -> EditOutcome {
    const double tolerance = Tolerance(op, one);
    auto reduction = Reduced(one, direction..., op.Whole("by"), tolerance);
    return {
        {std::move(reduction.shape)},
        Shortfall(op, reduction.reduced, "by", "degrees taken away", tolerance, reduction.error)};
  });
}

EditOutcome SplitInTwo(const EditOperation& op, const Geometry& shape) {
  return InDirection(op, shape, [&](const auto& one, auto... direction) -> EditOutcome {
    auto [first, second] = Split(one, direction..., op.Number("at"));
    return {{std::move(first), std::move(second)}, ""};
  });
}

EditOutcome DecomposeAll(const EditOperation& op, const Geometry& shape) {
  EditOutcome outcome;
  const auto take = [&](auto pieces) {
    for (auto& piece : pieces) outcome.pieces.emplace_back(std::move(piece));
    return outcome;
  };
  if (!op.direction) {
    return std::visit([&](const auto& one) { return take(Decompose(one)); }, shape);
  }
  return InDirection(op, shape, [&](const auto& one, auto... direction) {
    return take(Decompose(one, direction...));
  });
}

EditOutcome Mapped(const Geometry& shape, const Eigen::Matrix4d& matrix) {
  return std::visit([&](const auto& one) { return One(Transformed(one, matrix)); }, shape);
}

EditOutcome Transform(const EditOperation& op, const Geometry& shape) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix(op.Numbers("matrix").data());
  return Mapped(shape, matrix);
}

EditOutcome Translate(const EditOperation& op, const Geometry& shape) {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  if (std::holds_alternative<NurbsCurve<2>>(shape)) {
    shift.head<2>() = PointOf<2>(op, "");
  } else {
    shift = PointOf<3>(op, "");
  }
  return Mapped(shape, Translation(shift));
}

EditOutcome Rotate(const EditOperation& op, const Geometry& shape) {
  constexpr double kDegree = std::numbers::pi / 180;
  return Mapped(shape, Rotation(PointOf<3>(op, "axis"), op.Number("angle") * kDegree));
}

EditOutcome Reparameterize(const EditOperation& op, const Geometry& shape) {
  if (op.Has("to") == op.Has("mobius")) op.Refuse("one of to=a;b and mobius=A;B;C;D is needed");
  const std::vector<double>& x = op.Numbers(op.Has("to") ? "to" : "mobius");
  return InDirection(op, shape, [&](const auto& one, auto... direction) {
    if (x.size() == 2) return One(Reparameterized(one, direction..., x[0], x[1]));
    // The book maps old to new, the library's function new to old.
    return One(MobiusReparameterized(one, direction..., x[3], -x[1], -x[2], x[0]));
  });
}

EditOutcome Iso(const EditOperation& op, const Geometry& shape) {
  const NurbsSurface& surface = RequireSurface(op, shape);
  if (!op.direction) op.Refuse("say which parameter is fixed: dir=u or dir=v");
  return One(IsoCurve(surface, *op.direction, op.Number("at")));
}

EditOutcome Compose(const EditOperation& op, const Geometry& shape) {
  const std::vector<double>& values = op.Numbers("values");
  const ScalarSpline f{SplineBasis(op.Whole("degree"), op.Numbers("knots")),
                       Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values))};
  return InDirection(op, shape, [&](const auto& one, auto... direction) {
    return One(Composed(one, direction..., f));
  });
}

EditOutcome Extend(const EditOperation& op, const Geometry& shape) {
  const bool upper = op.Word("end") == "upper";
  const Continuation how = op.Word("how") == "calm" ? Continuation::kFair : Continuation::kNatural;
  const double length = op.Number("by");
  if (const auto* surface = std::get_if<NurbsSurface>(&shape)) {
    if (!op.direction) op.Refuse("a surface has two directions; say dir=u or dir=v");
    return One(Extended(*surface, {*op.direction, upper}, length, how));
  }
  if (op.direction) op.Refuse("a curve has one direction; leave dir out");
  if (const auto* plane = std::get_if<NurbsCurve<2>>(&shape)) {
    return One(Extended(*plane, upper, length, how));
  }
  return One(Extended(std::get<NurbsCurve<3>>(shape), upper, length, how));
}

using Apply = std::function<EditOutcome(const EditOperation&, const Geometry&)>;

// An operation that is one function of the library, f(shape, direction if any, operation).
template <typename F>
Apply Directed(F f) {
  return [f](const EditOperation& op, const Geometry& shape) {
    return InDirection(op, shape, [&](const auto& one, auto... direction) {
      return One(f(op, one, direction...));
    });
  };
}

const std::map<std::string, Apply>& Table() {
  static const std::map<std::string, Apply> table = {
      {"insert-knot", Directed([](const EditOperation& op, const auto& shape, auto... direction) {
         return InsertKnot(shape, direction..., op.Number("at"), op.Whole("times"));
       })},
      {"refine", Directed([](const EditOperation& op, const auto& shape, auto... direction) {
         return RefineKnots(shape, direction..., op.Numbers("at"));
       })},
      {"remove-knot", RemoveKnots},
      {"elevate", Directed([](const EditOperation& op, const auto& shape, auto... direction) {
         return Elevated(shape, direction..., op.Whole("by"));
       })},
      {"reduce", Reduce},
      {"split", SplitInTwo},
      {"decompose", DecomposeAll},
      {"reverse", Directed([](const EditOperation&, const auto& shape, auto... direction) {
         return Reversed(shape, direction...);
       })},
      {"swap",
       [](const EditOperation& op, const Geometry& shape) {
         return One(Swapped(RequireSurface(op, shape)));
       }},
      {"transform", Transform},
      {"translate", Translate},
      {"rotate", Rotate},
      {"scale",
       [](const EditOperation& op, const Geometry& shape) {
         const std::vector<double>& factors = op.Numbers("");
         if (factors.size() == 2) op.Refuse("needs one factor, or three");
         return factors.size() == 1 ? Mapped(shape, Scaling(factors[0]))
                                    : Mapped(shape, Scaling({factors[0], factors[1], factors[2]}));
       }},
      {"clamp",
       [](const EditOperation& op, const Geometry& shape) {
         return InEveryDirection(op, shape, [](const auto& one, auto... direction) {
           return Clamped(one, direction...);
         });
       }},
      {"unclamp",
       [](const EditOperation& op, const Geometry& shape) {
         return InEveryDirection(op, shape, [](const auto& one, auto... direction) {
           return Unclamped(one, direction...);
         });
       }},
      {"reparameterize", Reparameterize},
      {"compose", Compose},
      {"iso", Iso},
      {"set-weight", SetWeight},
      {"move-point", MovePoint},
      {"move", MoveTargets},
      {"pull", PullPoint},
      {"warp", WarpRegion},
      {"flatten", FlattenRegion},
      {"bend", BendShape},
      {"extend", Extend},
      {"to-bezier",
       [](const EditOperation&, const Geometry& shape) { return One(BezierForm(shape)); }},
      {"to-bspline",
       [](const EditOperation& op, const Geometry& shape) { return One(BsplineForm(op, shape)); }},
      {"to-power",
       [](const EditOperation&, const Geometry& shape) { return One(PowerForm(shape)); }},
      {"continue",
       [](const EditOperation& op, const Geometry& shape) {
         return EditOutcome{ContinuedPieces(op, shape), ""};
       }},
      {"cut",
       [](const EditOperation& op, const Geometry& shape) {
         return EditOutcome{CutPieces(op, shape), ""};
       }},
      {"trim",
       [](const EditOperation& op, const Geometry& shape) {
         return EditOutcome{TrimmedPieces(op, RequireSurface(op, shape)), ""};
       }},
  };
  return table;
}

// A message of the library without the name of the function in front.
std::string Reason(const std::string& message) {
  const size_t colon = message.find(": ");
  const bool named = colon != std::string::npos &&
                     std::all_of(message.begin(),
                                 message.begin() + static_cast<std::ptrdiff_t>(colon),
                                 [](unsigned char c) { return std::isalnum(c); });
  return named ? message.substr(colon + 2) : message;
}

// Files hold numbers up to this.
constexpr double kLargest = 1e150;

bool Writable(const SplineBasis& basis) {
  return basis.knots().front() >= -kLargest && basis.knots().back() <= kLargest;
}
template <int Dim>
bool KnotsWritable(const NurbsCurve<Dim>& curve) {
  return Writable(curve.basis());
}
bool KnotsWritable(const NurbsSurface& surface) {
  return Writable(surface.basis_u()) && Writable(surface.basis_v());
}

void RequireWritable(const EditOperation& operation, const Geometry& shape) {
  const auto writable = [](const auto& one) {
    return one.control_points().cwiseAbs().maxCoeff() <= kLargest &&
           one.weights().maxCoeff() <= kLargest && KnotsWritable(one);
  };
  if (!std::visit(writable, shape)) {
    operation.Refuse("coordinates, weights or knots become greater than 1e150");
  }
}

// f() with what it refuses said as the operation's refusal.
template <typename F>
auto Refusing(const EditOperation& operation, const F& f) {
  try {
    return f();
  } catch (const std::invalid_argument& error) {
    operation.Refuse(Reason(error.what()));
  }
}

}  // namespace

EditOutcome ApplyEdit(const EditOperation& operation, const Geometry& shape) {
  return Refusing(operation, [&] {
    EditOutcome outcome = Table().at(operation.name)(operation, shape);
    for (const Geometry& piece : outcome.pieces) RequireWritable(operation, piece);
    return outcome;
  });
}

Geometry ApplyToAll(const EditOperation& operation, const std::vector<Geometry>& shapes) {
  return Refusing(operation, [&] { return UnifiedCurve(operation, shapes); });
}

bool TakesAll(const EditOperation& operation) { return operation.name == "unify"; }

bool CutsIntoPieces(const EditOperation& operation) {
  return operation.name == "split" || operation.name == "decompose" ||
         (operation.name == "cut" && operation.Word("keep") == "both");
}

}  // namespace batten::internal
