// SPDX-License-Identifier: MIT
// Fits of solids, and the faces of mesh files that they start from.
#include <pybind11/stl.h>

#include <cstdio>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "batten/fitting/closed_surface.h"
#include "batten/fitting/faceted_solid.h"
#include "batten/fitting/fit_solid.h"
#include "batten/fitting/refused_data.h"
#include "batten/io/polygon_reader.h"
#include "batten/io/reconstruct_surface.h"
#include "batten/io/solid_writer.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/exchange.h"
#include "python/core/explained.h"
#include "python/core/fit.h"
#include "python/core/options.h"
#include "python/core/watch.h"

namespace batten::python {
namespace {

using Indices = py::array_t<int, py::array::c_style | py::array::forcecast>;
// (vertices, corners of all faces one after the other, how many each has)
using Faces = std::tuple<Doubles, Indices, Indices>;

struct Solid : Fit {
  SolidModel solid;
  SolidAudit audit;
  QuadMesh control_mesh;
  QuadMeshSummary layout;
};
using SolidPtr = std::shared_ptr<Solid>;

// Throws ValueError naming the argument for a face without a vertex of its own.
PolygonMesh PolygonsOf(const Faces& faces, const char* name) {
  const auto& [vertices, corners, sizes] = faces;
  PolygonMesh mesh{Columns<3>(vertices, name), {}};
  const int *corner = corners.data(), *const end = corner + corners.size();
  for (py::ssize_t k = 0; k < sizes.size(); ++k) {
    const int size = sizes.data()[k];
    if (size < 3 || end - corner < size)
      throw py::value_error(std::string(name) + ": a face has fewer than three vertices");
    mesh.faces.emplace_back(corner, corner + size);
    corner += size;
    for (const int index : mesh.faces.back()) {
      if (index < 0 || index >= mesh.vertices.cols())
        throw py::value_error(std::string(name) + ": an index is not of a vertex");
    }
  }
  return mesh;
}

QuadMesh QuadsOf(const Faces& faces) {
  const PolygonMesh polygons = PolygonsOf(faces, "layout");
  QuadMesh mesh{polygons.vertices, Eigen::Matrix4Xi(4, std::ssize(polygons.faces))};
  for (std::size_t f = 0; f < polygons.faces.size(); ++f) {
    if (polygons.faces[f].size() != 4)
      throw py::value_error("layout: faces of four vertices are needed");
    mesh.faces.col(Eigen::Index(f)) = Eigen::Map<const Eigen::Vector4i>(polygons.faces[f].data());
  }
  return mesh;
}

// The faces of a file as the package takes them; None where it has none. Those of a layout are
// four-cornered.
py::object ReadFaces(const std::string& path, bool layout) {
  PolygonMesh mesh;
  if (layout) {
    const QuadMesh quads = Watched([=](Watch&) { return ReadQuadMesh(path); });
    mesh.vertices = quads.vertices;
    for (const auto face : quads.faces.colwise()) mesh.faces.emplace_back(face.begin(), face.end());
  } else if (MayHoldFaces(path)) {
    mesh = Watched([=](Watch&) { return ReadPolygons(path); });
  }
  if (mesh.faces.empty()) return py::none();
  std::vector<int> corners, sizes;
  for (const std::vector<int>& face : mesh.faces) {
    corners.insert(corners.end(), face.begin(), face.end());
    sizes.push_back(static_cast<int>(face.size()));
  }
  const py::ssize_t count = mesh.vertices.cols();
  return py::make_tuple(Owned(std::move(mesh.vertices), {count, 3}),
                        Indices(std::ssize(corners), corners.data()),
                        Indices(std::ssize(sizes), sizes.data()));
}

// Where a stage of a solid's fit is in the whole: by the seconds of a ball of 20,000 points.
Progress SolidProgress(Watch& watch, bool makes_layout) {
  const double layout = makes_layout ? 0.4 : 0;
  return [&watch, layout](const char* stage, double fraction) {
    const std::string name = stage;
    constexpr double kPrepared = 0.1, kMeasure = 0.95;
    if (name == "layout") return watch.Go("layout", layout * fraction);
    const double begin = layout + kPrepared * (1 - layout);
    if (name == "prepare") return watch.Go("prepare", layout + (begin - layout) * fraction);
    return watch.Go("fit", begin + (kMeasure - begin) * fraction);
  };
}

struct SolidTask {
  PointsPtr points;
  std::optional<PolygonMesh> mesh = {};
  std::optional<QuadMesh> layout = {};
  int faces = 0;  // 0: by the number of points
  bool chooses_outliers = false;
  double most_invented = 0.15;  // of the area
  std::optional<int> genus = {};
  bool open = false;  // the borders of the points stay
  SolidFitOptions options;
};

std::string Percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * share);
  return text;
}

void RefuseGenus(const SolidTask& task, int genus) {
  if (task.genus && genus != *task.genus) {
    throw RefusedData("its genus is " + std::to_string(genus) + ", not " +
                      std::to_string(*task.genus));
  }
}

// As `batten fit solid` does it; `warnings` of the surface that a layout is made from.
SolidFit Run(SolidTask& task, std::vector<std::string>& warnings) {
  if (task.layout) {
    SolidFit fit = FitSolid(task.points->cloud, *task.layout, task.options);
    RefuseGenus(task, fit.layout.genus);
    return fit;
  }
  PointCloud cloud = task.points->cloud;
  ClosedSurface closed;
  if (task.mesh) {
    closed = task.open ? CloseSurface(task.mesh->vertices, task.mesh->faces, 1)
                       : CloseSurface(task.mesh->vertices, task.mesh->faces);
    if (closed.filled > 0 && !task.open) {
      warnings.push_back(std::to_string(closed.filled) +
                         (closed.filled == 1 ? " hole is closed, " : " holes are closed, ") +
                         Percent(closed.filled_share) + " of the area");
    }
    TriangleSurface local = closed.surface;
    local.vertices.colwise() -= cloud.origin();
    cloud.set_normals(NormalsNear(local, cloud.points()));
    // A vertex on a sharp edge is no outlier.
    if (task.chooses_outliers) task.options.keep_outliers = true;
  }
  // Holes are closed smoothly beyond points, which triangles across them do not.
  if (!task.mesh || task.open) {
    ReconstructedSurface made =
        ReconstructSurface(cloud, task.open ? 1 : task.most_invented, task.options.threads);
    if (task.open) {
      made.closed.surface.caps = std::move(made.beyond);
    } else if (made.invented_share > 0) {
      warnings.push_back(Percent(made.invented_share) +
                         " of the surface have no points within three spacings");
    }
    closed = std::move(made.closed);
  }
  RefuseGenus(task, closed.genus);
  SolidFit fit = FitSolid(cloud, closed.surface, task.faces, task.options);
  if (task.mesh && !task.open && closed.filled == 0) {
    if (const auto doubt = VolumeDoubt(fit.audit.volume, VolumeOf(closed.surface))) {
      fit.report.doubts.push_back(*doubt);
      warnings.push_back("doubtful: " + doubt->words);
    }
  }
  return fit;
}

SolidPtr FitOneSolid(const PointsPtr& points,
                     const py::dict& values,
                     const std::optional<Faces>& mesh,
                     const std::optional<Faces>& layout,
                     const py::object& progress) {
  const Keywords keywords(values);
  SolidTask task{.points = points, .options = SolidOptionsOf(keywords)};
  Check(task.options);
  keywords.Take("faces", task.faces);
  keywords.Take("most_invented", task.most_invented);
  keywords.Take("genus", task.genus);
  keywords.Take("open", task.open);
  task.chooses_outliers = !keywords.Has("keep_outliers");
  if (points->cloud.dimension() == 2) throw py::value_error("points: a solid needs x, y and z");
  if (layout) task.layout = QuadsOf(*layout);
  if (mesh) task.mesh = PolygonsOf(*mesh, "points");
  auto [fit, warnings] = Watched(
      [task = std::move(task)](Watch& watch) mutable {
        task.options.progress = SolidProgress(watch, !task.layout);
        std::vector<std::string> said;
        SolidFit made = Explained([&] { return Run(task, said); });
        return std::pair(std::move(made), std::move(said));
      },
      progress);
  auto made = std::make_shared<Solid>();
  std::vector<NurbsSurface> faces;
  for (const SolidFace& face : fit.solid.faces) faces.push_back(face.surface);
  made->bodies = MakeBodies(std::move(faces));
  made->solid = std::move(fit.solid);
  made->audit = fit.audit;
  made->control_mesh = std::move(fit.control_mesh);
  made->layout = fit.layout;
  made->owners = std::move(fit.faces);
  fit.report.warnings.insert(fit.report.warnings.begin(), warnings.begin(), warnings.end());
  Take(fit, points, keywords, *made);
  return made;
}

py::dict Summary(const Solid& fit) {
  py::dict summary;
  summary["faces"] = fit.solid.faces.size();
  summary["edges"] = fit.solid.edges.size();
  summary["vertices"] = fit.solid.vertices.cols();
  summary["genus"] = fit.layout.genus;
  summary["bodies"] = fit.layout.components;
  summary["extraordinary"] = fit.layout.extraordinary;
  const bool open = fit.solid.open;
  summary["watertight"] = !open && fit.audit.open_edges == 0;
  summary["volume"] = open ? py::object(py::none()) : py::float_(fit.audit.volume);
  summary["area"] = fit.audit.area;
  summary["gap"] = fit.audit.gap;
  summary["angle"] = fit.audit.edge_angle;
  summary["rms"] = fit.report.judged_error().rms;
  summary["max"] = fit.report.judged_error().max;
  summary["warnings"] = fit.report.warnings;
  return summary;
}

}  // namespace

void BindSolids(py::module_& m) {
  py::class_<Solid, Fit, SolidPtr>(m, "Solid")
      .def_property_readonly("edges",
                             [](const Solid& fit) {
                               std::vector<BodyPtr> edges;
                               for (const SolidEdge& edge : fit.solid.edges)
                                 edges.push_back(MakeBody(edge.curve));
                               return edges;
                             })
      .def_property_readonly("vertices",
                             [](const py::object& self) {
                               const auto& vertices = self.cast<const Solid&>().solid.vertices;
                               return View(vertices.data(), {vertices.cols(), 3}, self);
                             })
      .def_property_readonly("control_mesh",
                             [](const py::object& self) {
                               const QuadMesh& mesh = self.cast<const Solid&>().control_mesh;
                               return py::make_tuple(
                                   View(mesh.vertices.data(), {mesh.vertices.cols(), 3}, self),
                                   View(mesh.faces.data(), {mesh.faces.cols(), 4}, self));
                             })
      .def("summary", &Summary)
      .def("write_step",
           [](const SolidPtr& fit,
              const std::string& path,
              const std::string& unit,
              const std::string& schema) {
             Watched([=](Watch&) {
               const std::lock_guard lock(ExchangeMutex());
               WriteSolid(fit->solid, path, {"step", unit, schema});
               return true;
             });
           });
  m.def("fit_solid", &FitOneSolid);
  m.def("read_faces", &ReadFaces);
}

}  // namespace batten::python
