// SPDX-License-Identifier: MIT
#include "io/exchange/brep_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"
#include "io/exchange/brep_geometry.h"
#include "io/exchange/brep_scanner.h"

namespace batten::internal {
namespace {

constexpr std::string_view kVersion = "CASCADE Topology V";
constexpr std::string_view kFirstVersion = "CASCADE Topology V1, (c) Matra-Datavision\n";
constexpr std::int64_t kMost = 100'000'000;  // of anything, far above what a file can hold
constexpr std::int64_t kLargestPower = 16;   // of a placement in a product of placements
constexpr std::int64_t kLongestProduct = 4096;
constexpr std::int64_t kMostNested = 256;           // shapes inside shapes
constexpr std::int64_t kMostVisits = 1'000'000;  // of shapes, each wherever it stands
constexpr std::int64_t kVisitsOfEach = 64;
constexpr std::array<std::string_view, 8> kShapes = {
    "Ve", "Ed", "Wi", "Fa", "Sh", "So", "CS", "Co"};
constexpr std::array<std::string_view, 7> kContinuity = {"C0", "G1", "C1", "G2", "C2", "C3", "CN"};

template <typename List>
bool IsIn(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

class BrepChecker {
 public:
  BrepChecker(std::string_view text, size_t at, int version, const std::string& path)
      : in_(text, at, path), version_(version) {
    in_.Emit(kFirstVersion);
  }

  // [OpenCASCADE, BRep format, §2 to §4]
  std::string Checked() && {
    Locations();
    curves_2d_ = Table("Curve2ds", [this] { CheckBrepCurve(in_, 2); });
    curves_ = Table("Curves", [this] { CheckBrepCurve(in_, 3); });
    const std::int64_t polygons = Left("Polygon3D", [this] { Polygon(); });
    const std::int64_t chains = Left("PolygonOnTriangulations", [this] { Chain(); });
    surfaces_ = Table("Surfaces", [this] { CheckBrepSurface(in_); });
    triangulations_ = Left("Triangulations", [this] { Triangulation(); });
    polygons_ = polygons;
    chains_ = chains;
    Shapes();
    return std::move(in_.copied());
  }

 private:
  void EndLine() { in_.Emit("\n"); }

  // A section: its name, how many, and each.
  template <typename Each>
  std::int64_t Table(const char* name, Each each) {
    in_.Expect(name);
    const std::int64_t count = in_.Integer("a number of entries", 0, kMost);
    EndLine();
    for (std::int64_t i = 0; i < count; ++i) {
      each();
      EndLine();
    }
    return count;
  }

  // One that is read over.
  template <typename Each>
  std::int64_t Left(const char* name, Each each) {
    in_.Copy(false);
    in_.Expect(name);
    const std::int64_t count = in_.Integer("a number of entries", 0, kMost);
    for (std::int64_t i = 0; i < count; ++i) each();
    in_.Copy(true);
    in_.Emit(name);
    in_.Emit(" 0\n");
    return count;
  }

  void Reals(std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) in_.Real("a number");
  }

  std::int64_t Index(const char* what, std::int64_t least, std::int64_t most) {
    return in_.Integer(what, least, most);
  }
  void Place() { Index("a placement", 0, static_cast<std::int64_t>(factors_.size())); }
  std::int64_t Surface() { return Index("a surface", 1, surfaces_); }

  // Placements: matrices of three rows, and products of those before them.
  void Locations() {
    Table("Locations", [this] {
      if (in_.Integer("the kind of a placement", 1, 2) == 1) {
        Reals(12);
        factors_.push_back(1);
        return;
      }
      std::int64_t factors = 0;
      const auto known = static_cast<std::int64_t>(factors_.size());
      while (const std::int64_t index = Index("a placement", 0, known)) {
        const std::int64_t power = in_.Integer("a power", -kLargestPower, kLargestPower);
        factors += factors_[static_cast<size_t>(index - 1)] * (power < 0 ? -power : power);
        if (factors > kLongestProduct) in_.Fail("a placement is a product of more than 4096");
      }
      factors_.push_back(factors);
    });
  }

  void Polygon() {
    const std::int64_t nodes = in_.Integer("a number of nodes", 0, kMost);
    const bool parameters = in_.Flag("the sign of parameters");
    Reals(1 + 3 * nodes + (parameters ? nodes : 0));
  }

  void Chain() {
    const std::int64_t nodes = in_.Integer("a number of nodes", 0, kMost);
    for (std::int64_t i = 0; i < nodes; ++i) in_.Integer("a node", 0, kMost);
    in_.Expect("p");
    Reals(1);
    if (in_.Flag("the sign of parameters")) Reals(nodes);
  }

  void Triangulation() {
    const std::int64_t nodes = in_.Integer("a number of nodes", 0, kMost);
    const std::int64_t triangles = in_.Integer("a number of triangles", 0, kMost);
    const bool parameters = in_.Flag("the sign of parameters");
    const bool normals = version_ >= 3 && in_.Flag("the sign of normals");
    Reals(1 + 3 * nodes + (parameters ? 2 * nodes : 0));
    for (std::int64_t i = 0; i < 3 * triangles; ++i) in_.Integer("a node", 0, kMost);
    if (normals) Reals(3 * nodes);
  }

  void Continuity(std::string_view word) {
    if (!IsIn(kContinuity, word)) in_.Fail("'" + std::string(word) + "' is no continuity");
  }

  // A vertex: where it is, and where it lies on curves and surfaces.
  void Vertex() {
    Reals(4);
    EndLine();
    for (;;) {
      in_.Real("a parameter");
      const std::int64_t kind = in_.Integer("the kind of a place", 0, 3);
      if (kind == 0) break;
      if (kind == 1) Index("a curve", 1, curves_);
      if (kind == 2) Index("a curve of the plane", 1, curves_2d_);
      if (kind == 3) in_.Real("a parameter");
      if (kind != 1) Surface();
      Place();
      EndLine();
    }
    EndLine();
  }

  // A number and a continuity, which OpenCASCADE writes without a blank between.
  void CurveAndContinuity() {
    in_.Copy(false);
    std::string_view word = in_.Word("a curve of the plane");
    std::int64_t curve = 0;
    const char* const end = word.data() + word.size();
    const char* const rest = std::from_chars(word.data(), end, curve).ptr;
    if (rest == word.data() || curve < 1 || curve > curves_2d_) {
      in_.Fail("'" + std::string(word) + "' is no curve of the plane from 1 to " +
               std::to_string(curves_2d_));
    }
    word.remove_prefix(static_cast<size_t>(rest - word.data()));
    if (word.empty()) word = in_.Word("a continuity");
    Continuity(word);
    in_.Copy(true);
    in_.Emit(std::to_string(curve) + ' ' + std::string(word) + ' ');
  }

  // An edge: its tolerance, flags, and curves in space and on surfaces.
  void Edge() {
    Reals(1);
    for (int k = 0; k < 3; ++k) in_.Flag("a flag of an edge");
    EndLine();
    for (;;) {
      const std::string_view next = in_.Peek();
      const bool copies = next != "5" && next != "6" && next != "7";
      in_.Copy(copies);
      const std::int64_t kind = in_.Integer("the kind of an edge's curve", 0, 7);
      if (kind == 0) break;
      EdgeCurve(kind);
      if (copies) EndLine();
      in_.Copy(true);
    }
    EndLine();
  }

  void EdgeCurve(std::int64_t kind) {
    switch (kind) {
      case 1:
        Index("a curve", 1, curves_);
        Place();
        Reals(2);
        return;
      case 2:
      case 3:
        Index("a curve of the plane", 1, curves_2d_);
        if (kind == 3) CurveAndContinuity();
        Surface();
        Place();
        Reals(2);
        if (version_ != 2) return;
        in_.Copy(false);
        Reals(4);
        in_.Copy(true);
        return;
      case 4:
        Continuity(in_.Word("a continuity"));
        for (int k = 0; k < 2; ++k) {
          Surface();
          Place();
        }
        return;
      case 5:
        Index("a polygon", 0, polygons_);
        Place();
        return;
      default:
        Index("a polygon", 0, chains_);
        if (kind == 7) Index("a polygon", 0, chains_);
        Index("a triangulation", 0, triangulations_);
        Place();
    }
  }

  // A face: its surface, or its triangles, which are left out.
  void Face() {
    if (in_.Peek() == "2") in_.Fail("a face of triangles alone is no geometry: use .stl or .obj");
    in_.Flag("the sign of a natural boundary");
    Reals(1);
    Index("a surface", 0, surfaces_);
    Place();
    EndLine();
    if (in_.Peek() != "2") return EndLine();
    in_.Copy(false);
    in_.Integer("a sign of triangles", 2, 2);
    Index("a triangulation", 1, triangulations_);
    in_.Copy(true);
    EndLine();
  }

  void Flags() {
    const std::string_view flags = in_.Word("the flags of a shape");
    if (flags.size() != 7 || flags.find_first_not_of("01") != flags.npos) {
      in_.Fail("'" + std::string(flags) + "' is not the seven flags of a shape");
    }
    EndLine();
  }

  // What a shape holds, by the numbers of shapes before it, which count down in the file.
  struct Held {
    std::int64_t visits = 1, depth = 1;
  };
  Held Reference(std::string_view word, std::int64_t before) {
    std::int64_t number = 0;
    const char* const end = word.data() + word.size();
    const bool sign =
        !word.empty() && std::string_view("+-ie").find(word[0]) != std::string_view::npos;
    const auto total = static_cast<std::int64_t>(total_);
    if (!sign || std::from_chars(word.data() + 1, end, number).ptr != end || number < 1 ||
        number > total || total - number >= before) {
      in_.Fail("'" + std::string(word) + "' is no shape that stands before");
    }
    Place();
    return held_[static_cast<size_t>(total - number)];
  }

  void Shape() {
    const std::string_view type = in_.Word("the kind of a shape");
    EndLine();
    if (!IsIn(kShapes, type)) in_.Fail("'" + std::string(type) + "' is no kind of shape");
    if (type == "Ve") Vertex();
    if (type == "Ed") Edge();
    if (type == "Fa") Face();
    EndLine();
    Flags();
    Held held;
    for (;;) {
      const std::string_view word = in_.Word("a shape or *");
      if (word == "*") break;
      const Held part = Reference(word, static_cast<std::int64_t>(held_.size()));
      held.visits = std::min(held.visits + part.visits, kMost);
      held.depth = std::max(held.depth, part.depth + 1);
      if (held.depth > kMostNested) in_.Fail("shapes stand in shapes more than 256 deep");
    }
    EndLine();
    held_.push_back(held);
  }

  void Shapes() {
    in_.Expect("TShapes");
    total_ = static_cast<size_t>(in_.Integer("a number of shapes", 1, kMost));
    EndLine();
    for (size_t i = 0; i < total_; ++i) Shape();
    const Held whole = Reference(in_.Word("a shape"), static_cast<std::int64_t>(total_));
    if (whole.visits > kMostVisits + kVisitsOfEach * static_cast<std::int64_t>(total_)) {
      in_.Fail("its shapes stand in more places than a reader can visit");
    }
    EndLine();
  }

  BrepScanner in_;
  int version_;
  std::int64_t curves_2d_ = 0, curves_ = 0, surfaces_ = 0;
  std::int64_t polygons_ = 0, chains_ = 0, triangulations_ = 0;
  std::vector<std::int64_t> factors_;  // of every placement
  std::vector<Held> held_;             // by every shape so far
  size_t total_ = 0;
};

}  // namespace

std::string CheckedBrep(std::string_view text, const std::string& path) {
  constexpr std::string_view kBinary = "Open CASCADE Topology V";
  if (text.substr(0, 64).find(kBinary) != text.npos) {
    throw ReadError(path, "is a binary B-rep, which is not read: save it as text");
  }
  // What DRAW writes begins with a line of its own.
  const size_t found = text.substr(0, 4096).find(kVersion);
  if (found == text.npos) {
    throw ReadError(path, "is not a .brep file: it does not begin with CASCADE Topology");
  }
  const size_t digit = found + kVersion.size();
  const size_t end = text.find('\n', found);
  if (end == text.npos || text[digit] < '1' || text[digit] > '3' || text[digit + 1] != ',') {
    throw ReadError(path, "is of a version of CASCADE Topology that is none of 1 to 3");
  }
  return BrepChecker(text, end, text[digit] - '0', path).Checked();
}

}  // namespace batten::internal
