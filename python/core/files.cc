// SPDX-License-Identifier: MIT
// Clouds, geometry and meshes from and to files. Paths come as bytes.
#include <pybind11/stl.h>

#include <chrono>
#include <mutex>
#include <optional>

#include "batten/fitting/progress.h"
#include "batten/io/geometry_file.h"
#include "batten/io/geometry_json.h"
#include "batten/io/length_unit.h"
#include "batten/io/mesh_writer.h"
#include "batten/io/read_cloud.h"
#include "batten/io/write_cloud.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"
#include "python/core/cloud.h"
#include "python/core/exchange.h"
#include "python/core/options.h"
#include "python/core/watch.h"

namespace batten::python {
namespace {

CloudReadOptions ReadOptionsOf(const py::dict& values) {
  const Keywords k(values);
  CloudReadOptions options;
  if (k.Has("format")) options.format = k.Word("format");
  if (k.Has("columns"))
    options.columns = k.Value("columns").cast<std::map<std::string, std::string>>();
  k.Take("parameters", options.parameters);
  if (k.Has("faces")) {
    const std::string word = k.Word("faces");
    if (word == "sampled") options.faces = CloudFaces::kSampled;
    if (word == "flat") options.faces = CloudFaces::kFlat;
    if (word == "measured") options.faces = CloudFaces::kMeasured;
  }
  if (k.Has("projection")) {
    try {
      TakeProjection(k.Word("projection"), options);
    } catch (const std::invalid_argument& refusal) {
      throw std::invalid_argument(std::string("projection: ") + refusal.what());
    }
  }
  if (k.Has("where")) {
    for (const auto& [column, value] :
         k.Value("where").cast<std::vector<std::pair<std::string, double>>>())
      options.where.push_back({column, value});
  }
  if (k.Has("las_classes")) options.las_classes = k.Value("las_classes").cast<std::vector<int>>();
  if (k.Has("box")) {
    const auto box = k.Numbers("box", 6);
    options.box = Eigen::AlignedBox3d(Eigen::Vector3d(box[0], box[1], box[2]),
                                      Eigen::Vector3d(box[3], box[4], box[5]));
  }
  return options;
}

PointsPtr Read(const std::vector<std::string>& paths,
               const py::dict& values,
               const py::object& progress) {
  const CloudReadOptions options = ReadOptionsOf(values);
  const auto start = std::chrono::steady_clock::now();
  CloudFile file = Watched(
      [=](Watch& watch) {
        CloudReadOptions watched = options;
        watched.progress = [&](double fraction) {
          if (!watch.Go("read", fraction)) throw Cancelled();
        };
        return ReadCloud(paths, watched);
      },
      progress);
  auto made = std::make_shared<Points>();
  made->mesh = MeshIn(file);
  made->cloud = std::move(file.cloud);
  made->files = paths;
  made->points_in_file = file.points_in_file;
  made->non_finite = file.non_finite;
  made->filtered = file.filtered;
  made->missing = std::move(file.missing);
  made->fields = std::move(file.fields);
  made->remarks = std::move(file.remarks);
  made->read_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return made;
}

py::tuple Contents(GeometryContents contents) {
  if (!contents.flattened.empty()) contents.remarks.push_back(contents.flattened);
  return py::make_tuple(MakeBodies(std::move(contents.geometry)),
                        contents.names,
                        contents.unit,
                        contents.remarks,
                        contents.unread);
}

// What sewing came to, in the order of batten.Sewing; None where nothing was sewn.
py::object SewingOf(const std::optional<SewingReport>& report) {
  if (!report) return py::none();
  return py::make_tuple(report->surfaces,
                        report->solids,
                        report->shells,
                        report->loose,
                        report->invalid,
                        report->shared_edges,
                        report->free_edges,
                        report->largest_gap,
                        report->nearest_gap,
                        report->watertight());
}

py::object Write(const std::vector<BodyPtr>& bodies,
                 const std::string& path,
                 const std::vector<std::string>& names,
                 const std::string& format,
                 const std::string& unit,
                 const std::string& schema,
                 const std::optional<double>& sew) {
  const GeometryFile file{path, GeometriesOf(bodies), names};
  return SewingOf(Watched([=](Watch&) {
    const std::lock_guard lock(ExchangeMutex());
    return WriteGeometry(file, {format, unit, schema, sew});
  }));
}

// One mesh as arrays: (vertices, faces, parameters or None, normals or None, deviations or None)
using Arrays = std::tuple<Doubles,
                          py::array_t<int, py::array::c_style | py::array::forcecast>,
                          std::optional<Doubles>,
                          std::optional<Doubles>,
                          std::optional<Doubles>>;

SurfaceMesh MeshOf(const Arrays& arrays) {
  const auto& [vertices, faces, parameters, normals, deviations] = arrays;
  if (faces.ndim() != 2 || faces.shape(1) != 3)
    throw py::value_error("faces: an array of shape (M, 3) is needed");
  SurfaceMesh made;
  made.mesh.vertices = Columns<3>(vertices, "vertices");
  const Eigen::Index count = made.mesh.vertices.cols();
  made.mesh.triangles = Eigen::Map<const Eigen::Matrix3Xi>(faces.data(), 3, faces.shape(0));
  if (faces.size() > 0 &&
      (made.mesh.triangles.minCoeff() < 0 || made.mesh.triangles.maxCoeff() >= count))
    throw py::value_error("faces: an index is not of a vertex");
  made.mesh.parameters =
      parameters ? Columns<2>(*parameters, "parameters") : Eigen::Matrix2Xd::Zero(2, count);
  if (normals) {
    made.mesh.normals = Columns<3>(*normals, "normals");
  } else {  // means of the triangles around, by area
    made.mesh.normals = Eigen::Matrix3Xd::Zero(3, count);
    for (const auto& t : made.mesh.triangles.colwise()) {
      const Eigen::Vector3d a = made.mesh.vertices.col(t[0]), b = made.mesh.vertices.col(t[1]),
                            c = made.mesh.vertices.col(t[2]);
      const Eigen::Vector3d normal = (b - a).cross(c - a);
      for (const int corner : t) made.mesh.normals.col(corner) += normal;
    }
    for (auto normal : made.mesh.normals.colwise()) {
      const double length = normal.norm();
      normal = length > 0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d::UnitZ();
    }
  }
  if (made.mesh.parameters.cols() != count || made.mesh.normals.cols() != count)
    throw py::value_error("parameters, normals: one for each vertex is needed");
  if (deviations) made.deviations = Vector(*deviations);
  return made;
}

void WriteTheMeshes(const std::vector<Arrays>& arrays,
                    const std::string& path,
                    const std::string& format,
                    const std::string& unit) {
  std::vector<SurfaceMesh> meshes;
  for (const Arrays& one : arrays) meshes.push_back(MeshOf(one));
  const double metres = LengthUnitOf(unit).millimetres / 1000;
  Watched([=](Watch&) {
    WriteMeshes(meshes, path, {.format = format, .metres = metres});
    return true;
  });
}

}  // namespace

void BindFiles(py::module_& m) {
  m.def("read_cloud", &Read);
  m.def("write_cloud",
        [](const PointsPtr& points, const std::string& path, const std::string& format) {
          Watched([=](Watch&) {
            WriteCloud(points->cloud, path, format);
            return true;
          });
        });
  m.def(
      "read_geometry",
      [](const std::string& path, const std::string& format, const std::string& unit, bool strict) {
        return Contents(Watched([=](Watch&) {
          const std::lock_guard lock(ExchangeMutex());
          return ReadGeometryContents(path, {format, unit, "", strict});
        }));
      });
  m.def("geometry_from_json", [](const std::string& text, const std::string& name) {
    return Contents(ParseJsonContents(text, name));
  });
  m.def("geometry_to_json",
        [](const std::vector<BodyPtr>& bodies) { return ToGeometryJson(GeometriesOf(bodies)); });
  m.def("write_geometry", &Write);
  m.def("write_meshes", &WriteTheMeshes);
  m.def("units", [] {
    std::vector<std::string> names;
    for (const LengthUnit& unit : LengthUnits()) names.emplace_back(unit.name);
    return names;
  });
}

}  // namespace batten::python
