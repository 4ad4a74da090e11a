// SPDX-License-Identifier: MIT
// What a STEP file calls its faces and curves. Not installed; includes OpenCASCADE.
#pragma once

#include <STEPControl_Reader.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <unordered_map>

namespace batten::internal {

// The names of what a reader has transferred.
class StepNames {
 public:
  explicit StepNames(const STEPControl_Reader& reader);

  // Of a face or edge: its own, else that of its surface or curve, of the solid, shell or set it
  // belongs to, of its product; empty where none has one.
  std::string Of(const TopoDS_Shape& shape) const;

 private:
  // How near a name is to the shape it is of.
  enum class Rank { kOwn, kGeometry, kBody, kProduct };
  struct Named {
    std::string name;
    Rank rank;
    int shapes;  // that bear the name
  };
  void Add(const TopoDS_Shape& shape, const std::string& name, Rank rank);

  std::unordered_map<const void*, Named> names_;  // by the place-less shape
};

}  // namespace batten::internal
