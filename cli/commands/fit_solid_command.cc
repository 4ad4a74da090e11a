// SPDX-License-Identifier: MIT
// batten fit solid: points of a whole body in, a watertight solid of smooth faces and its report
// out.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/closed_surface.h"
#include "batten/fitting/faceted_solid.h"
#include "batten/fitting/fit_solid.h"
#include "batten/fitting/refused_data.h"
#include "batten/fitting/solid_layout.h"
#include "batten/geometry/quad_mesh.h"
#include "batten/geometry/triangle_samples.h"
#include "batten/io/file_format.h"
#include "batten/io/mesh_writer.h"
#include "batten/io/polygon_reader.h"
#include "batten/io/read_error.h"
#include "batten/io/reconstruct_surface.h"
#include "cli/arguments/cad_solid.h"
#include "cli/arguments/faceted_solid.h"
#include "cli/arguments/fit_arguments.h"
#include "cli/arguments/mesh_output.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/help_format.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/shell_words.h"
#include "cli/terminal/terminal.h"
#include "cli/terminal/written_format.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

struct FitSolidArguments : FitArguments {
  FitSolidArguments() { may_keep_all = true; }
  std::string quads, layout_out, mesh_out;
  std::string kind = "auto";
  int faces = 0;
  SolidDemands demands;
  bool keep_outliers = false, every_face = false;
  bool open = false;  // the borders of the points stay
};

SolidFitOptions ToFitSolidOptions(const FitSolidArguments& a) {
  SolidFitOptions options;
  options.tolerance = a.tolerance;
  options.smoothing = ToSmoothing(a.smoothing);
  options.keep_outliers = a.keep_outliers || ToCleaning(a.clean).keep_outliers;
  options.merge_faces = !a.every_face;
  return WithWork(std::move(options), a);
}

std::string SharpWords(const SolidAudit& audit) {
  constexpr double kDegree = std::numbers::pi / 180;
  return fmt::format("over {} sharp edge{} of length {:.6g} at {:.3g}° to {:.3g}°",
                     audit.sharp_edges,
                     audit.sharp_edges == 1 ? "" : "s",
                     audit.sharp_length,
                     audit.least_sharp / kDegree,
                     audit.greatest_sharp / kDegree);
}

std::string SolidWords(const SolidFit& fit) {
  const int bodies = fit.layout.components;
  const bool open = !fit.control_mesh.caps.empty();
  return fmt::format(
      "{} of {} faces, {} edges and {} vertices, {}, area {:.6g}; faces meet within {:.2g} and "
      "{:.2g}°{}{}",
      open          ? "an open shell"
      : bodies == 1 ? "a watertight solid"
                    : fmt::format("{} watertight solids", bodies),
      fit.solid.faces.size(),
      fit.solid.edges.size(),
      fit.solid.vertices.cols(),
      open ? fmt::format("borders of length {:.6g}", fit.audit.open_length)
           : fmt::format("genus {}; volume {:.6g}", fit.layout.genus, fit.audit.volume),
      fit.audit.area,
      fit.audit.gap,
      fit.audit.edge_angle * 180 / std::numbers::pi,
      fit.audit.sharp_edges == 0 ? "" : ", " + SharpWords(fit.audit),
      fit.held_out.size() == 0 ? ""
                               : fmt::format("; points left out are met within rms {:.4g}",
                                             std::sqrt(fit.held_out.mean())));
}

// The faces of the file, closed; none where it has none.
std::optional<ClosedSurface> FacesOf(const FitSolidArguments& a, const FitFiles& files) {
  if (files.faces() == nullptr || a.clouds.size() != 1) return std::nullopt;
  ClosedSurface closed = a.open ? CloseSurface(*files.faces(), 1) : CloseSurface(*files.faces());
  if (closed.filled > 0 && !a.open) {
    PrintWarning(fmt::format("{}: {} hole{} closed, {:.1f} % of the area",
                             JoinedNames(a.clouds),
                             closed.filled,
                             closed.filled == 1 ? " is" : "s are",
                             100 * closed.filled_share));
  }
  return closed;
}

// The same for a solid; the refusal of an open surface says which command takes that.
std::optional<ClosedSurface> FacesToClose(const FitSolidArguments& a, const FitFiles& files) {
  try {
    return FacesOf(a, files);
  } catch (const RefusedData& refusal) {
    if (refusal.remedy() != Remedy::kLeaveOpen) throw;
    throw RefusedData(refusal.what() + ("; 'batten fit surface " + ShellWord(a.clouds.front()) +
                                        "' fits open sheets"),
                      refusal.remedy());
  }
}

// A mesh is a surface: beside its vertices count points on its triangles, where these are large.
struct MeshPoints {
  PointCloud cloud;          // the vertices, then the points on triangles
  Eigen::Matrix3Xd normals;  // of those
};

MeshPoints PointsOn(const ClosedSurface& faces, const PointCloud& vertices) {
  TriangleSurface local = faces.surface;
  local.vertices.colwise() -= vertices.origin();
  TriangleSamples samples = SamplesBesideVertices(local);
  Eigen::Matrix3Xd points(3, vertices.size() + samples.points.cols());
  points << vertices.points(), samples.points;
  return {PointCloud(std::move(points), vertices.origin()), std::move(samples.normals)};
}

// The points have the normals of the faces, the last of them those of `on`.
void TakeFaces(const ClosedSurface& faces,
               PointCloud& cloud,
               SolidFitOptions& options,
               const Eigen::Matrix3Xd& on = {}) {
  TriangleSurface local = faces.surface;
  local.vertices.colwise() -= cloud.origin();
  Eigen::Matrix3Xd normals(3, cloud.size());
  normals << NormalsNear(local, cloud.points().leftCols(cloud.size() - on.cols())), on;
  cloud.set_normals(std::move(normals));
  // A vertex on a sharp edge is no outlier.
  options.keep_outliers = true;
}

// The layout of the user with the sharp edges of the faces, where these close.
QuadMesh LayoutOnFaces(const FitSolidArguments& a,
                       const FitFiles& files,
                       const QuadMesh& layout,
                       PointCloud& cloud,
                       SolidFitOptions& options) {
  std::optional<ClosedSurface> faces;
  try {
    faces = FacesOf(a, files);
    CheckQuadMesh(layout);
  } catch (const RefusedData& refusal) {
    PrintWarning(std::string("sharp edges are not looked for: ") + refusal.what());
  } catch (const std::invalid_argument&) {
    return layout;  // refused by the fit
  }
  if (!faces) return layout;
  QuadMesh creased = WithCreases(layout, faces->surface);
  if (creased.creases.cols() > 0) TakeFaces(*faces, cloud, options);
  return creased;
}

// A surface about the points.
ClosedSurface SurfaceAbout(const FitSolidArguments& a,
                           const FitFiles& files,
                           const PointCloud& cloud) {
  ReconstructedSurface made = files.Explained([&] {
    try {
      return ReconstructSurface(cloud, a.open ? 1 : a.demands.most_invented, a.work.threads);
    } catch (const RefusedData& refusal) {
      if (refusal.remedy() != Remedy::kFitPart) throw;
      throw RefusedData(refusal.what() + std::string(" (--box, --where)"));  // there is no --part
    }
  });
  if (a.open) {
    made.closed.surface.caps = std::move(made.beyond);
  } else if (made.invented_share > 0) {
    PrintWarning(fmt::format("{:.1f} % of the surface have no points within three spacings",
                             100 * made.invented_share));
  }
  return made.closed;
}

// Handles that were closed or made from what the points leave open.
void RefuseGenus(const FitSolidArguments& a, const FitFiles& files, int genus) {
  if (a.demands.genus && genus != *a.demands.genus)
    files.Refuse("makes another solid: " + GenusWords(genus, *a.demands.genus));
}

// What readers of STEP can't tell from a point would be drawn without end.
void RefuseTinyBody(const FitFiles& files, const PointCloud& cloud) {
  const double size =
      (cloud.points().rowwise().maxCoeff() - cloud.points().rowwise().minCoeff()).norm();
  constexpr double kLeast = 1e-4;
  if (!(size > 0)) files.Refuse("all points are at one place: a body has points all round it");
  if (size < kLeast) {
    files.Refuse(fmt::format(
        "the body measures {:g}, and readers of STEP take points within 1e-7 for one: use a "
        "smaller unit",
        size));
  }
}

// The road asked for; flags of the one over a layout ask for that.
SolidKind KindOf(const FitSolidArguments& a) {
  const SolidKind kind = ToSolidKind(a.kind);
  const bool layout = !a.quads.empty() || a.faces > 0 || !a.mesh_out.empty() ||
                      !a.layout_out.empty() || a.every_face || a.keep_outliers || a.open ||
                      a.smoothing != "auto" || a.clean == "none";
  if (layout && (kind == SolidKind::kCad || kind == SolidKind::kFaceted)) {
    throw UsageError("--kind " + a.kind +
                     ": --quads, --faces, --mesh-out, --layout-out, --open, --every-face, "
                     "--smoothing, "
                     "--keep-outliers and --clean none are of --kind organic");
  }
  const bool triangles = NamesMesh(a.out, a.out_format);
  if (triangles && (kind == SolidKind::kCad || kind == SolidKind::kFaceted))
    throw UsageError("-o " + a.out + ": --kind " + a.kind +
                     " writes .step; batten tessellate makes triangles of it");
  return layout || triangles ? SolidKind::kOrganic : kind;
}

// The mesh of the file, whose triangles count; none where only points do, or it does not close.
struct MeshOfFile {
  std::optional<ClosedSurface> closed;
  std::string refused;  // why it does not close
};

MeshOfFile ReadMesh(const FitSolidArguments& a, const FitFiles& files) {
  if (a.points == "vertices" || !a.quads.empty() || a.open || files.picked()) return {};
  try {
    return {FacesOf(a, files), ""};
  } catch (const RefusedData& refusal) {
    return {std::nullopt, refusal.what()};
  }
}

// Whether the faces of the body are those of the mesh: every edge is flat or sharp, and nothing is
// open. Meshes of more triangles than there may be faces are no CAD program's.
bool IsPolyhedron(const ClosedSurface& mesh, double chord_height) {
  return chord_height == 0 && mesh.filled == 0 && mesh.surface.triangles.cols() <= kMostFacets;
}

int RunFitSolid(const FitSolidArguments& a) {
  const SolidKind kind = KindOf(a);
  SolidFitOptions options = ToFitSolidOptions(a);
  const bool mesh = NamesMesh(a.out, a.out_format);
  const std::string written =
      "a solid is written as .step, or as triangles into .stl .obj .ply .glb; "
      "batten convert makes .brep of a STEP file";
  if (!mesh && WrittenFormat(a.out, a.out_format, written) != FileFormat::kStep)
    throw UsageError("-o " + a.out + ": " + written);
  FitFiles files(a,
                 a.quads.empty() ? std::vector<std::string>() : std::vector<std::string>{a.quads});
  if (a.open && a.demands.genus)
    throw UsageError("--genus is of closed solids, --open leaves borders: give one of them");
  for (const std::string& path : {a.layout_out, a.mesh_out}) {
    if (!path.empty()) CheckWritable(path);
  }
  if (!a.quads.empty() && (a.faces > 0 || !a.mesh_out.empty() || a.open)) {
    throw UsageError(
        "--faces, --mesh-out and --open are of a layout that is made, --quads gives one");
  }
  QuadMesh layout;
  if (!a.quads.empty()) layout = ReadQuadMesh(a.quads);
  PointCloud cloud = files.Read(false);
  options.shift = files.shift();
  if (!mesh) RefuseTinyBody(files, cloud);
  const MeshOfFile mesh_given = ReadMesh(a, files);
  Eigen::Matrix3Xd on;  // normals of the points on triangles
  SolidDemands demands = a.demands;
  const PointCloud vertices = cloud;
  if (mesh_given.closed) {
    const double chord = ChordHeight(mesh_given.closed->surface);
    if (kind == SolidKind::kFaceted ||
        (kind != SolidKind::kOrganic && IsPolyhedron(*mesh_given.closed, chord))) {
      RefuseGenus(a, files, mesh_given.closed->genus);
      return WriteFacetedSolid(a, files, *mesh_given.closed, cloud, "");
    }
    MeshPoints points = PointsOn(*mesh_given.closed, cloud);
    files.TakePoints(points.cloud, points.normals.cols());
    cloud = std::move(points.cloud);
    on = std::move(points.normals);
    if (on.cols() > 0) demands.least_noise = ChordDeviation(mesh_given.closed->surface);
    if (mesh_given.closed->filled == 0) demands.volume = VolumeOf(mesh_given.closed->surface);
    if (!a.flags.quiet && on.cols() > 0)
      PrintNote(
          fmt::format("{}: a mesh of {} triangles; {} points on them count beside its vertices",
                      a.clouds.front(),
                      mesh_given.closed->surface.triangles.cols(),
                      on.cols()));
  } else if (kind == SolidKind::kFaceted) {
    files.Refuse("makes no solid of plane faces: " +
                 (mesh_given.refused.empty()
                      ? std::string("no faces count (--kind auto fits points)")
                      : mesh_given.refused));
  }
  const CadOutcome cad = RunCadSolid(a, kind, demands, files, cloud);
  if (cad.code) {
    if (demands.least_noise > 0 && !a.flags.quiet)
      PrintNote(
          "round faces follow the chords of the mesh: its vertices lie farther out, most by " +
          RoundedText(ChordHeight(mesh_given.closed->surface)) + " at most");
    return *cad.code;
  }
  if (on.cols() > 0) {
    if (!IsSparse(mesh_given.closed->surface)) {
      cloud = vertices;  // which stand for the surface, with their noise
      files.TakePoints(cloud);
      on.resize(3, 0);
    } else if (kind == SolidKind::kAuto) {
      return WriteFacetedSolid(
          a,
          files,
          *mesh_given.closed,
          cloud,
          "with exact faces: " + cad.reason +
              "; smooth ones (--kind organic) are for meshes whose vertices are "
              "as dense everywhere");
    }
  }
  const bool may_be_faceted = kind == SolidKind::kAuto && mesh_given.closed;
  std::optional<TriangleSurface> over;  // from which layouts are made
  if (!a.quads.empty()) {
    layout = LayoutOnFaces(a, files, layout, cloud, options);
  } else {
    const std::optional<ClosedSurface> faces =
        mesh_given.closed ? mesh_given.closed
                          : files.Explained([&] { return FacesToClose(a, files); });
    if (faces) TakeFaces(*faces, cloud, options, on);
    // Holes are closed smoothly beyond points, which triangles across them do not.
    const ClosedSurface closed = faces && !a.open ? *faces : SurfaceAbout(a, files, cloud);
    RefuseGenus(a, files, closed.genus);
    if (!a.mesh_out.empty()) {
      TriangleMesh made;
      made.vertices = closed.surface.vertices.colwise() - options.shift;
      made.parameters = Eigen::Matrix2Xd::Zero(2, made.vertices.cols());
      made.normals = Eigen::Matrix3Xd::Zero(3, made.vertices.cols());
      made.triangles = closed.surface.triangles;
      WriteMesh(made, a.mesh_out);
    }
    over = closed.surface;
  }
  files.NotePrepared();
  std::optional<Doubt> doubt;
  SolidFit fit = files.Explained([&]() -> SolidFit {
    try {
      return over ? FitSolid(cloud, *over, a.faces, options) : FitSolid(cloud, layout, options);
    } catch (const RefusedData& refusal) {
      if (!may_be_faceted) throw;
      doubt = Doubt{"refused", refusal.what()};
      return {};
    }
  });
  if (!doubt && demands.volume) doubt = VolumeDoubt(fit.audit.volume, *demands.volume);
  if (may_be_faceted && doubt) {
    return WriteFacetedSolid(
        a,
        files,
        *mesh_given.closed,
        cloud,
        fmt::format("with exact faces: {}; with smooth ones: {}", cad.reason, doubt->words));
  }
  if (doubt) fit.report.doubts.push_back(*doubt);
  RefuseGenus(a, files, fit.layout.genus);
  std::vector<Geometry> faces;
  for (const SolidFace& face : fit.solid.faces) faces.emplace_back(face.surface);
  files.KeepSolid(fit.solid);
  if (!a.layout_out.empty()) WriteQuadMesh(fit.control_mesh, a.layout_out);
  const int code =
      files.Write(faces, fit.residuals, fit.parameters, fit.outliers, fit.report, fit.faces);
  if (!a.flags.quiet) {
    PrintNote(a.out + ": " + SolidWords(fit));
    if (!cad.reason.empty()) PrintNote("--kind auto: organic, for " + cad.reason);
  }
  return code;
}

}  // namespace

void AddFitSolidCommand(CLI::App& fit, Action& action) {
  auto a = std::make_shared<FitSolidArguments>();
  CLI::App& command = *fit.add_subcommand(
      "solid", "Fit a watertight solid of smooth faces to the points of a whole body");
  AddEveryFitsArguments(command, *a, "CLOUD", nullptr);
  command.get_option("--output")
      ->description("Where to write: .step, or the triangles of .stl .obj .ply .glb");
  command.get_option("--tolerance")
      ->description(
          "Distance every point should keep, in the data's unit: where points are farther, "
          "faces get finer control points [none: where they miss them by more than noise]");
  Suggest(*command.get_option("--output-format")
               ->description("Format of OUT where its name does not tell"),
          {"step", "stl", "obj", "ply", "glb"});
  Allow(*command
             .add_option(
                 "--kind",
                 a->kind,
                 "organic: smooth faces over a layout; cad: planes, cylinders, cones, spheres "
                 "and tori with sharp edges; faceted: the plane faces of a closed mesh; auto: cad "
                 "where the faces close, else organic where it has the mesh's volume, else faceted")
             ->capture_default_str()
             ->type_name("KIND"),
        {"auto", "cad", "organic", "faceted"});
  command
      .add_option(
          "--quads",
          a->quads,
          "The layout: a closed mesh of quadrilaterals near the points, .obj .off .ply [made]")
      ->type_name("LAYOUT");
  command
      .add_option_function<std::string>(
          "--faces",
          [a](const std::string& text) {
            const double number = ParseNumber("--faces", text, Sign::kPositive);
            constexpr double kMost = 20000;
            if (number != std::floor(number) || number < 6 || number > kMost) {
              throw UsageError("--faces: '" + text + "' is not a whole number from 6 to 20000");
            }
            a->faces = int(number);
          },
          "About how many quadrilaterals the layout that is made has [chosen by points left out; "
          "at most one for 8 points, 2500]")
      ->type_name("N");
  command
      .add_option_function<std::string>(
          "--genus",
          [a](const std::string& text) {
            constexpr int kMost = 100000;
            a->demands.genus = int(ParseWhole("--genus", text, 0, kMost));
          },
          "How many handles the solid has, of all bodies together: 0 of a ball, 1 of a ring; one "
          "of "
          "another number is refused")
      ->type_name("G");
  command
      .add_option(
          "--mesh-out",
          a->mesh_out,
          "Where to write the closed surface from which the layout is made: .ply .obj .stl .glb")
      ->type_name("M");
  command
      .add_option("--layout-out",
                  a->layout_out,
                  "Where to write the control mesh of the surface, a subdivision mesh: .obj")
      ->type_name("Q.obj");
  Suggest(*command
               .add_option(
                   "--smoothing",
                   a->smoothing,
                   "Fairness relative to the data: auto (by points left out) or a number, with the "
                   "layout's control points alone")
               ->capture_default_str()
               ->type_name("L"),
          {"auto"});
  command.add_flag(
      "--open",
      a->open,
      "The borders of an open scan stay, with a shell between them that is not closed; "
      "holes of less than a hundredth of its area are closed");
  command.add_flag("--keep-outliers", a->keep_outliers, "All points count");
  command.add_flag(
      "--every-face",
      a->every_face,
      "A face for each of the layout's; else as few as its extraordinary vertices allow");
  GroupFitFlags(command);
  GroupFlags(command,
             "Which shape",
             {"--kind", "--quads", "--faces", "--genus", "--open", "--every-face"});
  GroupFlags(command, "What is written", {"--layout-out", "--mesh-out"});
  command.footer(
      "Examples:\n"
      "  batten fit solid scan.ply -o part.step\n"
      "  batten fit solid mesh.obj -o part.step --faces 800 --report part-report.json\n"
      "  batten fit solid scan.xyz -o part.step --quads layout.obj\n"
      "  batten fit solid machined.ply -o part.step --kind cad\n"
      "A closed mesh is a surface: points on its triangles count where vertices are sparse, and "
      "the\n"
      "solid has its volume.\n"
      "The layout is made from the faces of the file, repaired where they nearly close, or else "
      "from a\n"
      "Poisson reconstruction about the points, which have to go all round the body. One that is\n"
      "given may come from a quadrilateral remesher or be drawn by hand; its vertices need not "
      "lie\n"
      "on the points. It is closed, each edge between two faces, faces counter-clockwise seen "
      "from\n"
      "outside.\n"
      "Sharp edges of a mesh, longer than three faces of the layout, become creases of it.\n"
      "One subdivision surface over it is fitted to all points and written as bicubic faces with\n"
      "continuous tangent planes that share their edges, those on creases sharp: a\n"
      "MANIFOLD_SOLID_BREP. With --kind cad "
      "the\n"
      "faces are those of fit parts --regularise, and their edges where these meet. Before the "
      "file\n"
      "gets its name the solid is found closed, valid, without folds and the same when it is read "
      "back;\n"
      "else nothing is written, and the reason is said. Triangles are watertight too, within the\n"
      "chord tolerance of batten tessellate or half of T.\n"
      "Exit code 3 says the solid is written, but the tolerance is not reached, or one point in\n"
      "twenty is farther from it than points are from one another; 4 that it is doubtful, such as "
      "one\n"
      "in plane faces of a mesh of which neither exact nor smooth faces keep the volume.");
  command.callback([a, &action] { action = [a] { return RunFitSolid(*a); }; });
}

}  // namespace batten::internal
