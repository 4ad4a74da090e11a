// SPDX-License-Identifier: MIT
#include "io/exchange/iges_solids.h"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>

#include "io/exchange/iges_shapes.h"
#include "io/exchange/iges_types.h"

namespace batten::internal {
namespace {

constexpr int kCurves[] = {100, 102, 104, 106, 110, 112, 126, 130};
constexpr int kSurfaces[] = {108, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198};

class Check {
 public:
  Check(const std::vector<IgesEntity>& entities, const IgesEntity& entity)
      : entities_(entities), in_(entity.parameters) {}

  void Solid() {
    One(kIgesShell, "shell");
    in_.Integer();
    for (int voids = in_.Integer(); voids > 0; --voids) {
      One(kIgesShell, "shell of a void");
      in_.Integer();
    }
  }
  void Shell() {
    for (int faces = AtLeastOne("face"); faces > 0; --faces) {
      One(kIgesFace, "face");
      in_.Integer();
    }
  }
  void Face() {
    Among(kSurfaces, "surface");
    const int loops = AtLeastOne("loop");
    in_.Integer();
    for (int k = 0; k < loops; ++k) One(kIgesEdgeLoop, "loop");
  }
  void Loop() {
    for (int edges = AtLeastOne("edge"); edges > 0; --edges) {
      const bool vertex = in_.Integer() == 1;
      Listed(vertex ? kIgesVertices : kIgesEdges, vertex ? "vertex" : "edge");
      in_.Integer();
      for (int curves = in_.Integer(); curves > 0; --curves) {
        in_.Integer();
        Among(kCurves, "curve in the surface's parameters");
      }
    }
  }
  void Edges() {
    for (int edges = AtLeastOne("edge"); edges > 0; --edges) {
      Among(kCurves, "curve of an edge");
      Listed(kIgesVertices, "vertex");
      Listed(kIgesVertices, "vertex");
    }
  }
  void Vertices() { in_.Reals(3 * static_cast<std::size_t>(AtLeastOne("vertex"))); }

 private:
  int AtLeastOne(const char* what) {
    const int count = in_.Integer();
    if (count == 0) throw std::invalid_argument(std::string("names no ") + what);
    return count;
  }
  const IgesEntity& Among(std::span<const int> types, const char* what) {
    const int index = in_.Entity();
    if (index >= 0 && index < static_cast<int>(entities_.size())) {
      const IgesEntity& found = entities_[static_cast<std::size_t>(index)];
      if (std::find(types.begin(), types.end(), found.type) != types.end()) return found;
    }
    throw std::invalid_argument(std::string("names no ") + what + " of the file");
  }
  const IgesEntity& One(int type, const char* what) { return Among({&type, 1}, what); }
  // A list of such entities, and the place in it, from 1.
  void Listed(int type, const char* what) {
    const IgesEntity& list = One(type, what);
    const double count = list.parameters.empty() ? 0 : list.parameters[0], place = in_.Real();
    if (!(place >= 1 && place <= count))
      throw std::invalid_argument(std::string("names no ") + what + " of its list");
  }

  const std::vector<IgesEntity>& entities_;
  IgesNumbers in_;
};

}  // namespace

void CheckIgesSolid(const std::vector<IgesEntity>& entities, const IgesEntity& entity) {
  Check check(entities, entity);
  switch (entity.type) {
    case kIgesSolid:
      return check.Solid();
    case kIgesShell:
      return check.Shell();
    case kIgesFace:
      return check.Face();
    case kIgesEdgeLoop:
      return check.Loop();
    case kIgesEdges:
      return check.Edges();
    case kIgesVertices:
      return check.Vertices();
    default:
      return;
  }
}

}  // namespace batten::internal
