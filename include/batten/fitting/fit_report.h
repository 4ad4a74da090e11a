// SPDX-License-Identifier: MIT
// The report of a fit or a comparison: errors, input, geometry, rounds, timings and warnings.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace batten {

// The termination reason of a fit, best first. The geometry returned is the best seen in every
// case.
enum class Termination {
  kToleranceReached,  // every used point is within the tolerance
  kNoiseReached,      // more freedom would only follow the noise
  kMaxControlPoints,  // the limit, by option or by the data, on control points is reached
  kMaxIterations,
  kStalled,  // another round changes nothing
  kCancelled,
};

// The report's name of a termination, such as "tolerance_reached".
const char* Name(Termination termination);

// How a fit ended, finer than its termination.
enum class EndCode {
  kToleranceReached,
  kNoiseReached,
  kCrossValidated,       // more control points would not predict left-out points better
  kDetailBelowSpacing,   // what is left is finer than the spacing of the points
  kStructuredResiduals,  // neighbours share what is left: shape that the geometry does not follow
  kMaxControlPoints,
  kMaxIterations,
  kTimeLimit,
  kCancelled,
};

// The report's name of a code, such as "cross_validated".
const char* Name(EndCode code);

// The termination that a code belongs to: cross_validated, detail_below_spacing and
// structured_residuals are `stalled`.
Termination TerminationOf(EndCode code);

struct FitEnd {
  EndCode code = EndCode::kCrossValidated;
  std::string words;  // a sentence without a full stop; empty: nothing was fitted
  std::optional<Eigen::Vector3d> where = std::nullopt;  // world: the used point farthest off, if it
                                                        // ended short of noise and tolerance
};

// Why a result that is written may be wrong.
struct Doubt {
  std::string code;   // a word for scripts, such as "faceted"
  std::string words;  // a sentence without a full stop
};

// Orthogonal distances of points to a geometry, in the data's units. Signed values are along the
// surface normal (curves: not signed, both zero).
struct ErrorSummary {
  double rms = 0, mean = 0, max = 0, p50 = 0, p95 = 0, p99 = 0, signed_p5 = 0, signed_p95 = 0;
  std::optional<double> tolerance;
  double within_tolerance = 1;        // fraction of the points; 1 without a tolerance
  Eigen::Index out_of_tolerance = 0;  // their number
  Eigen::Index points = 0;
};

// Summarises signed distances; `mask` (empty: all) selects points.
ErrorSummary Summarise(const Eigen::VectorXd& signed_distances,
                       std::optional<double> tolerance,
                       const Eigen::Array<bool, Eigen::Dynamic, 1>& mask = {});

// A mesh among what was read.
struct InputMesh {
  Eigen::Index triangles = 0;
  Eigen::Index welded = 0;        // vertices joined with another at their place
  Eigen::Index open_edges = 0;    // of one triangle
  Eigen::Index non_manifold = 0;  // edges of more than two
  Eigen::Index sampled = 0;       // points on triangles that count beside the vertices
};

// The input of a fit: points read, and what preparation found.
struct InputSummary {
  std::vector<std::string> files;
  std::optional<InputMesh> mesh = std::nullopt;           // where faces were read
  Eigen::Index points = 0;                                // read, before anything was dropped
  Eigen::Index used = 0;                                  // inliers the fit uses
  Eigen::Index non_finite = 0;                            // dropped
  Eigen::Index duplicates = 0;                            // merged into another point's weight
  Eigen::Index outliers = 0;                              // set aside
  std::optional<Eigen::Index> thinned_to = std::nullopt;  // points left by thinning
  double spacing = 0;                                     // mean distance of neighbours
  double noise = 0;                                       // estimated standard deviation
  Eigen::Vector3d box_min = Eigen::Vector3d::Zero(), box_max = Eigen::Vector3d::Zero();  // world
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

// Standard deviations and covariance of a primitive's estimated parameters. Names are those of
// ShapeEstimate; lines have direction_x, direction_y, point_x, point_y, circles axis_x, axis_y,
// center_x, center_y, center_z, radius, those of z missing in the plane. For axis, direction,
// normal, and a point on an axis, _x and _y are components along frame_x and frame_y; other _x, _y,
// _z are along the coordinates.
struct PrimitiveAccuracy {
  std::vector<std::string> names;
  Eigen::VectorXd standard_deviations;  // infinite where there is no limit
  Eigen::MatrixXd covariance;           // linear; ignores alternative solutions
  Eigen::Vector3d frame_x = Eigen::Vector3d::Zero(), frame_y = Eigen::Vector3d::Zero();
  double inflation = 1;  // factor on variances for correlation of neighbouring residuals

  // The largest standard deviation of parameters whose names begin with `name`; NaN if none.
  double Deviation(const std::string& name) const;
};

// The parameters of a primitive, in the coordinates of the geometry as written; the kind decides
// which are present. Directions have length one, angles are in radians.
struct PrimitiveSummary {
  std::string kind;  // "line", "circle", "plane", "sphere", "cylinder", "cone", "torus"
  // The point of a line, plane or axis is the one nearest to the middle of the points.
  std::optional<Eigen::Vector3d> point, direction;
  std::optional<Eigen::Vector3d> center, axis;
  std::optional<double> radius;
  std::optional<double> sweep;  // of an arc; 2π of a full circle
  double scale = 0;             // standard deviation of the inliers' distances
  std::string why;              // why this kind was chosen
  std::optional<Eigen::Vector3d> normal = std::nullopt, apex = std::nullopt;
  std::optional<double> half_angle = std::nullopt;
  std::optional<double> major_radius = std::nullopt, minor_radius = std::nullopt;
  std::optional<PrimitiveAccuracy> accuracy = std::nullopt;

  // "cylinder of radius 12.003 ± 0.002": lengths with their standard deviations.
  std::string Words() const;
};

// The sharp edges of a solid of smooth faces.
struct CreaseSummary {
  int edges = 0;
  double length = 0;                           // of all of them
  double least_angle = 0, greatest_angle = 0;  // of normals across them in their middles, radians
};

struct GeometrySummary {
  std::string kind;  // "surface" or "curve"
  std::string base;  // "plane", "sheet", …; empty in comparisons
  std::vector<int> degree;
  std::vector<int> control_points;
  bool rational = false;
  std::vector<bool> closed;
  int trims = 0;
  int count = 1;  // several curves: control_points and closed have an entry for each
  std::optional<PrimitiveSummary> primitive = std::nullopt;  // if a primitive was fitted
  std::string base_why = {};                                 // why this base was chosen
  // Distortion of the parameterization: the rms difference of lengths from those in parameters.
  double distortion = 0;
  // A plane base's axes u and v and its normal, as columns
  std::optional<Eigen::Matrix3d> base_axes = std::nullopt;
  std::vector<bool> poles = {};  // whether the edges v = low and v = high are poles
  std::optional<CreaseSummary> creases = std::nullopt;  // of a solid over a layout
};

// A parameterization that was considered for a surface.
struct BaseCandidate {
  std::string name;                            // "plane", "sheet", "revolution", …
  std::optional<double> score = std::nullopt;  // rms distance of left-out points predicted over it
  int control_points = 0;                      // with which it predicts them; 0 without a score
  std::string refused = {};                    // why it was not taken; empty: it was
};

// The joint stage.
struct OptimizeSummary {
  bool ran = false;
  std::string why;
  int iterations = 0;
  double rms_before = 0, rms_after = 0;
};

// One round of fitting.
struct RoundSummary {
  std::string stage;  // "cross-validation" (also "… of a part" of many points), "block validation",
                      // "robust", "refine", "joint"
  int control_points_u = 0, control_points_v = 0;
  double rms = 0, max = 0;
  double score = 0;  // the stage's own criterion; see the documentation of the stage
  double seconds = 0;
};

// The time of the stages; every moment of the total belongs to one.
struct StageSeconds {
  double read = 0, prepare = 0, parameterize = 0, solve = 0, project = 0, refine = 0, optimize = 0,
         trim = 0, write = 0, total = 0;

  StageSeconds& operator+=(const StageSeconds& more);  // stage by stage
};

// The errors at one of several geometries, over the points nearest to it.
struct PartError {
  std::string name, kind;  // the name may be empty; "curve" or "surface"
  ErrorSummary error;
};

// A connected part of the cloud.
struct CloudPartSummary {
  Eigen::Index points = 0;
  double share = 0;  // of the cloud's points
  Eigen::Vector3d box_min, box_max;
  bool used = false;    // it has a surface
  std::string refused;  // why not, where one was asked for
};

// A tile of a surface that was fitted tile by tile.
struct TileSummary {
  int u = 0, v = 0;                                                               // its place
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();  // parameters
  Eigen::Index points = 0, outliers = 0, out_of_tolerance = 0;  // whose feet are on it
  int control_points_u = 0, control_points_v = 0;               // of its face
  double rms = 0, max = 0;  // of the points that are no outliers
};

// How far a surface leaves its points between them (inside its trims), or a curve their box.
struct OvershootSummary {
  // Height of a surface beyond that of all points near the place, or the distance from the box of
  // the points used where of_box stands; in the data's units.
  double max = 0;
  double in_spacings = 0;                        // the most in spacings of the points there
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // where; meaningless if max is 0
  double area_without_points = 0;                // farther than three spacings from all points
  double share_without_points = 0;               // of the area
  double largest_gap = 0;  // there: greatest distance along the surface from a foot point
  bool asked_for = false;  // the surface beyond its points: trims were declined
  std::optional<double> of_box = std::nullopt;  // max over the box's diagonal, if above a half
};

// Standard deviations of the shape along its normal (uncertainty.h), the data's units.
struct UncertaintySummary {
  double sigma_max = 0, sigma_median = 0;  // where the points support the shape
  double bias_max = 0;                     // by fairness, there
  double noise = 0;                        // of a point of weight one
  double inflation = 1;                    // factor on variances for noise that neighbours share
  double freedom = 0;                      // degrees of freedom the noise was estimated by
  double unsupported_area = 0;             // fairness decides there; curves: length
  double unsupported_share = 0;
  std::string note;  // what the figures cover; or why there are none
  bool known = false;
};

struct FitReport {
  InputSummary input;
  GeometrySummary geometry;
  std::vector<BaseCandidate> base_candidates;
  ErrorSummary error;      // over the used points
  ErrorSummary error_all;  // over all finite points
  // Distances from the geometry at every point's own parameters, for fits at given parameters.
  std::optional<ErrorSummary> parameter_error;
  std::optional<OvershootSummary> overshoot;  // of surfaces, and of curves that leave their points
  std::vector<PartError> parts;               // where there are several geometries, in their order
  std::vector<CloudPartSummary> cloud_parts;  // where parts of the cloud were asked for
  std::vector<TileSummary> tiles;             // where there are any, v fastest
  bool judged_at_parameters = false;          // the tolerance applies to parameter_error
  OptimizeSummary optimize;
  std::optional<UncertaintySummary> uncertainty;  // where it was asked for
  Termination termination = Termination::kNoiseReached;
  FitEnd end;  // `termination` in full
  std::vector<RoundSummary> iterations;
  StageSeconds seconds;
  std::vector<std::string> warnings;
  std::vector<Doubt> doubts;  // told by who made the result; see Doubts
  int threads = 1;

  // The errors to which the tolerance applies: parameter_error or error.
  const ErrorSummary& judged_error() const;

  // None without a tolerance; false for a surface that leaves its points.
  std::optional<bool> tolerance_reached() const;

  // Whether a surface overshoots by more than three spacings, its errors at the points and the
  // tolerance, or a curve or an untrimmed surface leaves the box of its points by more than half
  // its diagonal; not if trims were declined.
  bool leaves_points() const;

  // Why the result may be wrong: `doubts`, and of a fit what its figures tell: it ends with
  // structured residuals, leaves out more than a tenth of the points, or misses one that it uses by
  // more than ten times the noise, a hundredth of their size, and the tolerance.
  std::vector<Doubt> Doubts() const;

  // Joins the report of another curve of the same cloud. Errors are not joined; the worse
  // termination is kept.
  void Join(const FitReport& other);

  // A one-sentence summary for a terminal or a log.
  std::string OneLine() const;
};

}  // namespace batten
