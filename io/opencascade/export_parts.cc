// SPDX-License-Identifier: MIT
#include "io/opencascade/export_parts.h"

#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <variant>

#include "io/exchange/geometry_names.h"
#include "io/opencascade/sewn_faces.h"
#include "io/opencascade/valid_shape.h"

namespace batten::internal {
namespace {

// Surfaces that are sewn together.
struct Group {
  std::vector<size_t> surfaces;
  double tolerance;
  std::string name;
  bool solid;
};

std::string NameOf(const GeometryFile& file, size_t index) {
  return index < file.names.size() ? CleanName(file.names[index]) : "";
}

std::vector<Group> Groups(const GeometryFile& file, const std::optional<double>& sew) {
  std::vector<Group> groups;
  if (sew && *sew == 0) return groups;
  std::vector<bool> taken(file.geometry.size());
  for (const GeometryBody& body : file.bodies) {
    const double tolerance = sew.value_or(body.tolerance);
    if (body.surfaces.empty() || !(tolerance > 0)) continue;
    groups.push_back({body.surfaces, tolerance, CleanName(body.name), body.solid});
    for (const size_t k : body.surfaces) taken[k] = true;
  }
  if (!sew) return groups;
  std::vector<size_t> others;
  for (size_t k = 0; k < file.geometry.size(); ++k) {
    if (!taken[k] && std::holds_alternative<NurbsSurface>(file.geometry[k])) others.push_back(k);
  }
  if (!others.empty()) groups.push_back({std::move(others), *sew, "", false});
  return groups;
}

// A failure tells which of several it is.
TopoDS_Shape ShapeOf(const GeometryFile& file, size_t index) {
  try {
    return ValidShape(file.geometry[index]);
  } catch (const Standard_Failure& failure) {
    if (file.geometry.size() == 1) throw;
    const std::string name = NameOf(file, index);
    throw Standard_Failure(
        ("number " + std::to_string(index + 1) + " of " + std::to_string(file.geometry.size()) +
         (name.empty() ? "" : ", '" + name + "'") + ": " + failure.GetMessageString())
            .c_str());
  }
}

// The name that all surfaces bear.
std::string SharedName(const GeometryFile& file, const std::vector<size_t>& surfaces) {
  const std::string name = NameOf(file, surfaces[0]);
  const bool all = std::all_of(
      surfaces.begin(), surfaces.end(), [&](size_t k) { return NameOf(file, k) == name; });
  return all ? name : "";
}

void Add(SewingReport& sum, const SewingReport& one) {
  sum.surfaces += one.surfaces;
  sum.solids += one.solids;
  sum.shells += one.shells;
  sum.loose += one.loose;
  sum.invalid += one.invalid;
  sum.shared_edges += one.shared_edges;
  sum.free_edges += one.free_edges;
  sum.largest_gap = std::max(sum.largest_gap, one.largest_gap);
  if (one.nearest_gap) {
    sum.nearest_gap = std::min(*one.nearest_gap, sum.nearest_gap.value_or(*one.nearest_gap));
  }
}

void AddSewn(const GeometryFile& file,
             const Group& group,
             std::vector<ExportPart>& parts,
             SewingReport& report) {
  std::vector<TopoDS_Face> faces;
  std::vector<size_t> surfaces;  // of each face
  for (const size_t k : group.surfaces) {
    const TopoDS_Shape shape = ShapeOf(file, k);
    for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) {
      faces.push_back(TopoDS::Face(each.Current()));
      surfaces.push_back(k);
    }
  }
  SewnFaces sewn = SewFaces(faces, group.tolerance, group.solid);
  sewn.report.surfaces = group.surfaces.size();
  Add(report, sewn.report);
  const std::string body = group.name.empty() ? SharedName(file, group.surfaces) : group.name;
  for (const SewnFaces::Piece& piece : sewn.pieces) {
    ExportPart part{piece.shape, body, {}};
    for (const auto& [face, index] : piece.faces) {
      part.faces.emplace_back(face, NameOf(file, surfaces[index]));
    }
    if (part.shape.ShapeType() == TopAbs_FACE) part.name = part.faces[0].second;
    parts.push_back(std::move(part));
  }
}

}  // namespace

std::vector<ExportPart> ExportParts(const GeometryFile& file,
                                    const std::optional<double>& sew,
                                    std::optional<SewingReport>& report) {
  const std::vector<Group> groups = Groups(file, sew);
  std::vector<const Group*> group_of(file.geometry.size());
  for (const Group& group : groups) {
    for (const size_t k : group.surfaces) group_of[k] = &group;
  }
  if (!groups.empty()) report.emplace();
  std::vector<ExportPart> parts;
  for (size_t k = 0; k < file.geometry.size(); ++k) {
    const Group* const group = group_of[k];
    if (group == nullptr) {
      parts.push_back({ShapeOf(file, k), NameOf(file, k)});
    } else if (*std::min_element(group->surfaces.begin(), group->surfaces.end()) == k) {
      AddSewn(file, *group, parts, *report);
    }
  }
  return parts;
}

}  // namespace batten::internal
