// SPDX-License-Identifier: MIT
#include "io/exchange/json_trims.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "io/exchange/file_loops.h"
#include "io/exchange/json_splines.h"

namespace batten::internal {
namespace {

using TrimKind = JsonValue::Kind;

// The entries of the member `data`, whose number `count` must be where it is given.
std::vector<JsonField> Entries(const JsonField& holder) {
  const JsonField data = holder.Member("data");
  std::vector<JsonField> entries;
  if (data.value().kind != TrimKind::kNumbers || !data.value().numbers.empty()) {
    data.Expect(TrimKind::kList);
    for (size_t i = 0; i < data.value().items.size(); ++i) entries.push_back(data.Item(i));
  }
  if (holder.Has("count") &&
      holder.Member("count").Integer(0, 1'000'000'000) != static_cast<int>(entries.size())) {
    holder.Member("count").Fail("is not the number of entries in data, " +
                                std::to_string(entries.size()));
  }
  return entries;
}

std::string TypeOf(const JsonField& entry) {
  entry.Expect(TrimKind::kObject);
  if (!entry.Has("type")) return "spline";
  const JsonField type = entry.Member("type");
  type.Expect(TrimKind::kText);
  return type.value().text;
}

// The polygon through the points of a "freeform".
NurbsCurve<2> ReadPolygon(const JsonField& entry) {
  const Eigen::Matrix2Xd points = ReadJsonPoints(entry);
  if (points.cols() < 2) entry.Member("points").Fail("a curve needs two points at least");
  const auto size = static_cast<int>(points.cols());
  return NurbsCurve<2>(SplineBasis::Uniform(1, size, 0, size - 1), points);
}

NurbsCurve<2> ReadPiece(const JsonField& entry) {
  if (entry.Has("dimension")) entry.Member("dimension").Integer(2, 2);
  const std::string type = TypeOf(entry);
  if (type == "spline") return ReadJsonCurve<2>(entry);
  if (type == "freeform") return ReadPolygon(entry);
  entry.Member("type").Fail("\"" + type + "\" is not a curve; \"spline\" and \"freeform\" are");
}

// Whether the loop cuts away what is outside it: the outer boundary of a region.
bool KeepsItsInside(const JsonField& entry) {
  return entry.Has("reversed") && entry.Member("reversed").value().kind == TrimKind::kNumber &&
         entry.Member("reversed").value().number == 1;
}

NurbsCurve<2> ReadLoop(const JsonField& entry, const Eigen::Array2d& sides) {
  std::vector<NurbsCurve<2>> pieces;
  if (TypeOf(entry) == "container") {
    for (const JsonField& piece : Entries(entry)) pieces.push_back(ReadPiece(piece));
  } else {
    pieces.push_back(ReadPiece(entry));
  }
  return Shut(Chained(std::move(pieces), sides, kFileGap, true), sides, kFileGap);
}

}  // namespace

NurbsSurface ReadTrimmed(const JsonField& entry, NurbsSurface surface) {
  if (!entry.Has("trims")) return surface;
  const JsonField trims = entry.Member("trims");
  trims.Expect(TrimKind::kObject);
  if (!trims.Has("data") && (!trims.Has("count") || trims.Member("count").Integer(0, 0) == 0)) {
    return surface;
  }
  const std::vector<JsonField> entries = Entries(trims);
  std::vector<NurbsCurve<2>> loops;
  int kept_inside = 0;
  for (const JsonField& one : entries) {
    kept_inside += KeepsItsInside(one) ? 1 : 0;
    try {
      loops.push_back(ReadLoop(one, DomainSides(surface)));
    } catch (const std::invalid_argument& error) {
      one.Fail(error.what());
    }
  }
  const LoopRole role = kept_inside > 1 ? LoopRole::kByNesting : LoopRole::kHolesInTheLargest;
  const bool holes_only = role == LoopRole::kHolesInTheLargest && !OneHoldsAll(loops);
  if (holes_only) loops.insert(loops.begin(), DomainBoundary(surface));
  try {
    return WithTurnedLoops(surface, std::move(loops), kFileGap, role);
  } catch (const LoopError& error) {
    if (!holes_only) entries[error.loop()].Fail(error.what());
    // The boundary of the domain stands before the holes.
    if (error.loop() == 0) trims.Fail(std::string("the domain of the surface ") + error.what());
    entries[error.loop() - 1].Fail(error.what());
  }
}

}  // namespace batten::internal
