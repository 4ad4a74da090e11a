// SPDX-License-Identifier: MIT
// The limit surface of Catmull-Clark subdivision, evaluated exactly anywhere.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <span>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "geometry/subdivision/catmull_clark.h"
#include "geometry/subdivision/extraordinary_ring.h"

namespace batten::internal {

// A place on the limit surface: parameters in [0,1]² of a patch. Patch 4f + k is the quarter of
// face f at its corner k; its u runs from that corner along half-edge k, its v along half-edge
// k − 1 the other way round.
struct LimitPlace {
  int patch = 0;
  double u = 0, v = 0;
};

// The 4 × 4 vertices about a face whose corners' fans are plain: index 4i + j, i along half-edge h,
// the face's lower left corner at i = j = 1; −1 beyond creases.
struct PlainNet {
  std::array<int, 16> vertices;
  NetBorders beyond;
};
PlainNet PlainNetOf(const QuadTopology& mesh, int h);

// The vertices of a net about the origin of a half-edge, sector 0 to the left of it, by place;
// fans inside the net are plain.
std::vector<int> RingVertices(const QuadTopology& mesh, int first, const RingPlaces& places);

// The stencils of a mesh, whatever its points are. Exact: a patch is a uniform bicubic B-spline or,
// at a vertex whose fan is not plain, one of a net refined about that vertex. [Stam 1998]
class LimitStencils {
 public:
  explicit LimitStencils(const QuadTopology& mesh);
  // With Support and WeightsAt of the patches of some of its faces only; others support nothing.
  LimitStencils(const QuadTopology& mesh, const std::vector<char>& faces);

  const QuadTopology& mesh() const { return mesh_; }
  const SubdividedMesh& finer() const { return finer_; }  // whose faces are the patches
  int patches() const { return finer_.topology.faces(); }

  // The vertices of the control mesh on which a patch depends, ascending.
  std::span<const int> Support(int patch) const { return patches_[patch].support; }

  // Weights on Support(place.patch) of S, S_u, S_v, S_uu, S_uv, S_vv; the first `kinds` of them
  // (1, 3 or 6) as columns. Derivatives are with respect to the patch's u and v. At a vertex
  // whose fan is not plain they are those 2^-20 beside it.
  Eigen::MatrixXd WeightsAt(const LimitPlace& place, int kinds) const;

  // The place of the parameters (u, v) of a whole face, u along half-edge 4f, in [0,1]².
  static LimitPlace PlaceOnFace(int face, double u, double v);

 private:
  friend class LimitSurface;
  struct Patch {
    const ExtraordinaryRing* ring = nullptr;  // none: a plain bicubic
    int net = -1, sector = 0;                 // of the ring, in net_first_
    NetBorders beyond;                        // of a plain bicubic
    std::vector<int> places;   // vertices of the finer mesh: 4 × 4, or the net of two rings
    std::vector<int> support;  // of the control mesh
    Eigen::MatrixXd stencils;  // places × support
  };
  void MakePatch(int patch, std::map<int, int>& nets, bool stencils);
  void MakeStencils(Patch& patch) const;

  QuadTopology mesh_;
  SubdividedMesh finer_;
  std::vector<Patch> patches_;
  std::vector<int> net_first_;  // the first half-edges of fans that are not plain
};

// The limit surface of given control points. Keeps a reference to the stencils.
class LimitSurface {
 public:
  // Control points are columns, one for each vertex.
  LimitSurface(const LimitStencils& stencils, const Eigen::Matrix3Xd& control_points);

  SurfaceJet JetAt(const LimitPlace& place) const;
  Eigen::Vector3d At(const LimitPlace& place) const { return JetAt(place).point; }
  // Unit normals at the places (u, v) of a patch, u and v out of some parameters: that of u's i-th
  // and v's j-th in column i · size + j.
  Eigen::Matrix3Xd NormalsOn(int patch, std::span<const double> parameters) const;

  // The place after a step (du, dv) from a place: where it leaves the patch, it goes on in the one
  // beside, at most through `crossings` of them; it ends at the last border otherwise. Along
  // creases it slides.
  LimitPlace Moved(const LimitPlace& from, double du, double dv, int crossings = 3) const;

  // Whether a place is on a crease that its patch has at v = 0 or at u = 0.
  struct Creases {
    bool down = false, left = false;
  };
  Creases CreasesAt(const LimitPlace& place) const;
  // The same places on the other sides of these.
  std::vector<LimitPlace> Beyond(const LimitPlace& place) const;

 private:
  Eigen::Matrix<double, 3, 16> PointsOf(const LimitStencils::Patch& plain) const;

  const LimitStencils& stencils_;
  Eigen::Matrix3Xd finer_points_;
  // The net of every fan with a ring, and some of the refined ones, by level.
  std::vector<std::vector<Eigen::Matrix3Xd>> rings_;
};

}  // namespace batten::internal
