// SPDX-License-Identifier: MIT
// Prints, as Markdown tables, how near surface fits with nothing given come to kinds of sheets that
// a plane or a flat layout serves badly: twisted blades, helicoidal ramps, screw flights, ribbons,
// minimal surfaces, uneven density, scan lines, clutter. Shape, turn in space and noise differ from
// seed to seed. A row tells, as medians and worst of the seeds, the rms and largest distance of the
// noise-free sheet from the fitted surface and the control points over those of the oracle: the
// best uniform bicubic at the true parameters of the same points.
//   kind_fitting [--seeds N] [--first SEED] [--points SHARE] [--write FOLDER] [--each] [--alone]
//                [KIND…]
// `KIND…` prints only kinds whose names contain one of the words; `--each` every seed, too;
// `--alone` goes without the oracle, which takes most of the time; `--write` leaves the clouds and
// the truth's places as text.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "ablation.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/statistics.h"
#include "known_sheets.h"
#include "known_wings.h"
#include "random_sheets.h"

using namespace batten;
using namespace batten::internal;

namespace batten::internal {
namespace {

constexpr int kPlaces = 101;  // of the truth, a direction
constexpr double kSigma = 1e-3;
constexpr double kGood = 1.4, kFalseClaim = 2;  // of the oracle's rms
using std::numbers::pi;

// Numbers that differ from seed to seed.
class Variation {
 public:
  explicit Variation(std::uint64_t seed) : engine_(0x9e3779b97f4a7c15u * (seed + 1)) {}
  // A factor within 1 ± share.
  double About(double share) { return 1 + share * (2 * Uniform() - 1); }
  double Uniform() { return std::uniform_real_distribution<double>(0, 1)(engine_); }
  double Normal() { return std::normal_distribution<double>(0, 1)(engine_); }

 private:
  std::mt19937_64 engine_;
};

// A kind of sheet: `make` draws one.
struct Kind {
  std::string name;
  Eigen::Index count;
  std::function<KnownSheet(Variation&)> make;
  std::function<double(double, double)> density = {};  // of points over area, at most 1
  int lines = 0;                                       // v takes so many values only
  Eigen::Index ball = 0, strays = 0;                   // clutter
  double sigma = kSigma;
  bool sharp_edge = false;                          // u = 0 and u = 1 are one sharp edge
  std::function<bool(double, double)> within = {};  // the sheet's outline in the unit square
  int objects = 0;                                  // balls anywhere beside the sheet
  bool random = false;                              // all of it is drawn anew
};

// A wing's mean surface turned along its span, with camber and taper.
KnownSheet Blade(Variation& vary, double degrees) {
  const double twist = Radians(degrees) * vary.About(0.1), span = 2 * vary.About(0.15),
               chord = 0.6 * vary.About(0.15), camber = 0.08 * vary.About(0.5),
               taper = 0.15 + 0.3 * vary.Uniform(), pitch = 0.5 * vary.Uniform();
  const auto at = [=](double u, double v) {
    const double width = chord * (1 - taper * u), across = (v - 0.4) * width,
                 off = camber * 4 * v * (1 - v) * width / chord, angle = pitch + twist * u;
    return Eigen::Vector3d(span * u,
                           across * std::cos(angle) - off * std::sin(angle),
                           across * std::sin(angle) + off * std::cos(angle));
  };
  return {"", at, {span, chord * (1 - taper / 2)}, {}};
}

// A helicoid between two radii.
KnownSheet Ramp(Variation& vary, double turns, double inner, double outer, double pitch) {
  const double all = 2 * pi * turns * vary.About(0.08), low = inner * vary.About(0.2),
               high = outer * vary.About(0.1), rise = pitch * vary.About(0.15) / (2 * pi),
               bank = 0.15 * (2 * vary.Uniform() - 1);
  const auto at = [=](double u, double v) {
    const double radius = low + (high - low) * v, angle = all * u;
    return Eigen::Vector3d(
        radius * std::cos(angle), radius * std::sin(angle), rise * angle + bank * (radius - low));
  };
  return {"", at, {all * std::hypot((low + high) / 2, rise), high - low}, {}};
}

// A band along a bent centre line that turns about it.
KnownSheet Ribbon(Variation& vary) {
  const double length = 5.5 * vary.About(0.1), width = 0.5 * vary.About(0.1),
               twist = 2 * pi * 1.1 * vary.About(0.1), bend = 0.6 * vary.About(0.3);
  const auto at = [=](double u, double v) {
    const double angle = twist * u, across = (v - 0.5) * width;
    return Eigen::Vector3d(length * u + 0.1 * across * std::cos(angle),
                           bend * std::sin(2 * u) + across * std::cos(angle),
                           bend * u * u + across * std::sin(angle));
  };
  return {"", at, {length, width}, {}};
}

// x = u − u³/3 + uv², y = v − v³/3 + vu², z = u² − v² over a square. [Enneper 1864]
KnownSheet Enneper(Variation& vary) {
  const double reach = 1.05 * vary.About(0.1), stretch = vary.About(0.15);
  const auto at = [=](double s, double t) {
    const double u = reach * stretch * (2 * s - 1), v = reach * (2 * t - 1);
    return Eigen::Vector3d(
        u - u * u * u / 3 + u * v * v, v - v * v * v / 3 + v * u * u, u * u - v * v);
  };
  return {"", at, {2 * reach * stretch, 2 * reach}, {}};
}

KnownSheet WavySheet(Variation& vary) {
  const double height = 0.06 * vary.About(0.3), phase = pi * vary.Uniform(),
               width = 0.8 * vary.About(0.2);
  const auto at = [=](double u, double v) {
    return Eigen::Vector3d(
        u, width * v, height * std::sin(3 * pi * u + phase) * std::cos(2 * pi * v));
  };
  return {"", at, {1, width}, {}};
}

// Long, so that few lines across it hold many points each.
KnownSheet ScannedSheet(Variation& vary) {
  const double length = 4 * vary.About(0.2), width = length * 500 / (80.0 * 40),
               height = 0.15 * vary.About(0.3);
  const auto at = [=](double u, double v) {
    return Eigen::Vector3d(
        length * v, width * u, height * std::sin(5 * v) * (1 + 0.2 * std::cos(2 * u)));
  };
  return {"", at, {width, length}, {}};
}

// The mean surface of a wing, little twisted and swept: data of a kind nobody fits badly.
KnownSheet WingMean(Variation& vary) {
  const double span = 3 * vary.About(0.1), sweep = 0.4 * vary.About(0.3);
  const auto at = [=](double u, double v) {
    const double chord = 1 - 0.5 * u;
    return Eigen::Vector3d(
        sweep * span * u + chord * v, span * u, 0.12 * chord * v * (1 - v) + 0.1 * u * u);
  };
  return {"", at, {span, 0.75}, {}};
}

// A wing with its whole section: thickness 9 to 18 %.
KnownSheet WholeWing(Variation& vary) {
  WingShape shape;
  shape.thickness = 0.135 + 0.045 * (2 * vary.Uniform() - 1);
  shape.camber = 0.03 * vary.Uniform();
  shape.span = 2.4 * vary.About(0.25);
  shape.taper = 0.4 + 0.5 * vary.Uniform();
  shape.sweep = 0.8 * vary.Uniform();
  shape.twist = Radians(8) * (2 * vary.Uniform() - 1);
  shape.dihedral = 0.3 * vary.Uniform();
  shape.fullness = 0.8 + 0.5 * vary.Uniform();
  return ClosedWing(shape);
}

std::vector<Kind> Kinds() {
  const auto blade = [](double degrees) {
    return [degrees](Variation& vary) { return Blade(vary, degrees); };
  };
  const auto ramp = [](double turns, double inner, double outer, double pitch) {
    return [=](Variation& vary) { return Ramp(vary, turns, inner, outer, pitch); };
  };
  const auto thinning = [](double u, double) { return std::pow(100, -u); };
  return {{"blade 75", 25000, blade(75)},
          {"blade 270", 25000, blade(270)},
          {"ramp 1.15", 30000, ramp(1.15, 1, 2, 2)},
          {"ramp 2.5", 50000, ramp(2.5, 1, 2, 2)},
          {"flight 3", 60000, ramp(3, 0.35, 1, 0.8)},
          {"stairs 1.5", 40000, ramp(1.5, 0.4, 1.6, 3)},
          {"ribbon", 40000, Ribbon},
          {"Enneper", 30000, Enneper},
          {"thinning", 60000, WavySheet, thinning},
          {"lines", 40000, ScannedSheet, {}, 80},
          {"cluttered blade", 25000, blade(75), {}, 0, 1500, 700},
          {"noisy ramp 1.15", 30000, ramp(1.15, 1, 2, 2), {}, 0, 0, 0, 5e-3},
          {"wing", 30000, WingMean},
          {"closed wing", 40000, WholeWing, {}, 0, 0, 0, 5e-4, true},
          {"closed wing, few", 15000, WholeWing, {}, 0, 0, 0, 3e-4, true},
          {"closed wing, many", 60000, WholeWing, {}, 0, 0, 0, 3e-4, true},
          {"closed wing, noisy", 30000, WholeWing, {}, 0, 0, 0, 8e-4, true},
          {.name = "random sheet", .count = 0, .make = {}, .random = true}};
}

// What a draw of a random sheet is as a kind of its own.
Kind AsKind(const RandomSheet& drawn) {
  constexpr double kBallShare = 0.04;  // of the sheet's points
  const auto share = [&](double part) {
    return static_cast<Eigen::Index>(part * static_cast<double>(drawn.count));
  };
  return {.name = drawn.sheet.name,
          .count = drawn.count,
          .make = [sheet = drawn.sheet](Variation&) { return sheet; },
          .density = drawn.density,
          .ball = drawn.clutter * share(kBallShare),
          .strays = share(drawn.outliers),
          .sigma = drawn.sigma,
          .within = drawn.within,
          .objects = drawn.clutter};
}

// Area that the unit square covers near a place, per its own.
double Stretch(const KnownSheet& sheet, double u, double v) {
  constexpr double kStep = 1e-4;
  const Eigen::Vector3d du = sheet.at(u + kStep, v) - sheet.at(u - kStep, v),
                        dv = sheet.at(u, v + kStep) - sheet.at(u, v - kStep);
  return du.cross(dv).norm() / (4 * kStep * kStep);
}

struct DrawnCloud {
  SheetCloud cloud;
  Eigen::Matrix3Xd places;  // of the truth
  Eigen::Matrix3Xd edge;    // places of a sharp edge, none without
};

// The places of a sheet that lie within its outline.
Eigen::Matrix3Xd PlacesWithin(const Kind& kind, const KnownSheet& sheet) {
  const Eigen::Matrix3Xd all = PlacesOf(sheet, kPlaces);
  if (!kind.within) return all;
  std::vector<Eigen::Index> inner;
  for (Eigen::Index k = 0; k < all.cols(); ++k)
    if (kind.within((static_cast<double>(k / kPlaces) + 0.5) / kPlaces,
                    (static_cast<double>(k % kPlaces) + 0.5) / kPlaces))
      inner.push_back(k);
  return all(Eigen::all, inner);
}

DrawnCloud Draw(const Kind& described, double share, std::uint64_t seed) {
  Variation vary(seed);
  const Kind kind = described.random ? AsKind(DrawRandomSheet(vary)) : described;
  const KnownSheet sheet = kind.make(vary);
  double most = 0;
  constexpr int kLooks = 30;
  for (int i = 0; i <= kLooks; ++i)
    for (int j = 0; j <= kLooks; ++j)
      most = std::max(
          most, Stretch(sheet, static_cast<double>(i) / kLooks, static_cast<double>(j) / kLooks));
  most *= 1.1;
  const auto count = static_cast<Eigen::Index>(share * static_cast<double>(kind.count));
  DrawnCloud drawn{
      {Eigen::Matrix3Xd(3, count + kind.ball + kind.strays), Eigen::Matrix2Xd(2, count)},
      PlacesWithin(kind, sheet),
      Eigen::Matrix3Xd(3, kind.sharp_edge ? kPlaces : 0)};
  for (Eigen::Index k = 0; k < drawn.edge.cols(); ++k)
    drawn.edge.col(k) = sheet.at(0, (static_cast<double>(k) + 0.5) / kPlaces);
  const double sigma = kind.sigma * vary.About(0.3);
  const auto noisy = [&](Eigen::Vector3d point) {
    for (double& x : point) x += sigma * vary.Normal();
    return point;
  };
  for (Eigen::Index k = 0; k < count;) {
    const double u = vary.Uniform();
    double v = vary.Uniform();
    if (kind.lines > 0) v = (std::floor(v * kind.lines) + 0.5) / kind.lines;
    if (kind.within && !kind.within(u, v)) continue;
    const double density = kind.density ? kind.density(u, v) : 1;
    if (vary.Uniform() * most > density * Stretch(sheet, u, v)) continue;
    drawn.cloud.points.col(k) = noisy(sheet.at(u, v));
    drawn.cloud.parameters.col(k++) << u * sheet.sides[0], v * sheet.sides[1];
  }
  // A ball beside the sheet, and points anywhere in the box of both.
  const Eigen::AlignedBox3d box(drawn.places.rowwise().minCoeff(),
                                drawn.places.rowwise().maxCoeff());
  const double size = box.sizes().maxCoeff(), radius = 0.08 * size;
  Eigen::AlignedBox3d wide(box.min() - 0.2 * size * Eigen::Vector3d::Ones(),
                           box.max() + 0.2 * size * Eigen::Vector3d::Ones());
  const Eigen::Vector3d middle(box.center()[0], box.max()[1] + 0.15 * size, box.center()[2]);
  std::vector<Eigen::Vector3d> balls;
  for (int k = 0; k < kind.objects; ++k) {
    Eigen::Vector3d way(vary.Normal(), vary.Normal(), vary.Normal());
    way.normalize();
    const double out = 0.5 * (way.cwiseAbs().cwiseProduct(box.sizes())).sum();  // the box's reach
    balls.emplace_back(box.center() + (out + (1.5 + vary.Uniform()) * radius) * way);
  }
  for (Eigen::Index k = 0; k < kind.ball; ++k) {
    const Eigen::Vector3d way(vary.Normal(), vary.Normal(), vary.Normal());
    drawn.cloud.points.col(count + k) =
        noisy((kind.objects > 0 ? balls[k % kind.objects] : middle) + radius * way.normalized());
  }
  for (Eigen::Index k = 0; k < kind.strays; ++k) {
    const Eigen::Vector3d part(vary.Uniform(), vary.Uniform(), vary.Uniform());
    drawn.cloud.points.col(count + kind.ball + k) = wide.min() + part.cwiseProduct(wide.sizes());
  }
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(vary.Normal(), vary.Normal(), vary.Normal(), vary.Normal()).normalized();
  drawn.cloud.points = turn.toRotationMatrix() * drawn.cloud.points;
  drawn.places = turn.toRotationMatrix() * drawn.places;
  drawn.edge = turn.toRotationMatrix() * drawn.edge;
  return drawn;
}

struct Settings {
  int seeds = 3, first = 1;
  double share = 1;
  std::string folder;
  bool each = false, alone = false;
  std::vector<std::string> words;
};

struct Runs {
  std::vector<double> rms, rms_ratio, max_ratio, control_ratio, seconds;
  std::string ends, why;
  int false_claims = 0;  // fits that say they reached the noise and are twice the oracle's away
};

void Write(const std::string& path, const Eigen::Matrix3Xd& points) {
  std::ofstream file(path);
  file.precision(12);
  for (const auto point : points.colwise())
    file << point[0] << ' ' << point[1] << ' ' << point[2] << '\n';
}

double ProcessorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Distances of the true edge from the surface's edge u = lower, rms and largest, and the gap to its
// edge u = upper.
struct EdgeError {
  double rms = 0, max = 0, gap = 0;
};
EdgeError EdgeErrorOf(const Eigen::Matrix3Xd& truth, const NurbsSurface& surface) {
  constexpr int kSteps = 5000;
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  EdgeError error;
  Eigen::Matrix3Xd edge(3, kSteps + 1);
  for (int k = 0; k <= kSteps; ++k) {
    const double at = v.lower() + (v.upper() - v.lower()) * k / kSteps;
    edge.col(k) = surface.At(u.lower(), at);
    error.gap = std::max(error.gap, (edge.col(k) - surface.At(u.upper(), at)).norm());
  }
  for (const auto place : truth.colwise()) {
    const double distance = (edge.colwise() - place).colwise().norm().minCoeff();
    error.rms += distance * distance / static_cast<double>(truth.cols());
    error.max = std::max(error.max, distance);
  }
  error.rms = std::sqrt(error.rms);
  return error;
}

void RunSeed(const Kind& kind, const Settings& settings, int seed, Runs& runs) {
  ThreadPool pool(0);
  const DrawnCloud drawn = Draw(kind, settings.share, static_cast<std::uint64_t>(seed));
  if (!settings.folder.empty()) {
    std::string name = kind.name + "-" + std::to_string(seed);
    std::replace(name.begin(), name.end(), ' ', '_');
    Write(settings.folder + "/" + name + ".xyz", drawn.cloud.points);
    Write(settings.folder + "/" + name + "-truth.xyz", drawn.places);
  }
  const BestUniform oracle = settings.alone ? BestUniform{1, 1, {1, 1}}
                                            : UniformOracle(drawn.cloud, drawn.places, pool).Best();
  const double oracle_points = oracle.size_u * oracle.size_v;
  try {
    const double before = ProcessorSeconds();
    const SurfaceFit fit = FitSurface(PointCloud::FromWorld(drawn.cloud.points));
    const double seconds = ProcessorSeconds() - before;
    const SheetError error = ErrorAt(drawn.places, fit.surface, pool);
    const double points = fit.surface.size_u() * fit.surface.size_v();
    runs.rms.push_back(error.rms);
    runs.rms_ratio.push_back(error.rms / oracle.error.rms);
    runs.max_ratio.push_back(error.max / oracle.error.max);
    runs.control_ratio.push_back(points / oracle_points);
    runs.seconds.push_back(seconds);
    runs.false_claims +=
        fit.report.end.code == EndCode::kNoiseReached && error.rms > kFalseClaim * oracle.error.rms;
    runs.ends += (runs.ends.empty() ? "" : ", ") + fit.report.geometry.base + " " +
                 Name(fit.report.end.code);
    if (settings.each) {
      std::printf(
          "  %s %d: rms %.2e / %.2e, max %.1e / %.1e, control points %dx%d / %dx%d, %s, "
          "%s, %.2f s\n",
          kind.name.c_str(),
          seed,
          error.rms,
          oracle.error.rms,
          error.max,
          oracle.error.max,
          fit.surface.size_u(),
          fit.surface.size_v(),
          oracle.size_u,
          oracle.size_v,
          fit.report.geometry.base.c_str(),
          Name(fit.report.end.code),
          seconds);
      if (drawn.edge.cols() > 0) {
        const EdgeError edge = EdgeErrorOf(drawn.edge, fit.surface);
        std::printf("      edge: rms %.1e, max %.1e, gap %.1e; spacing %.1e, noise %.1e\n",
                    edge.rms,
                    edge.max,
                    edge.gap,
                    fit.report.input.spacing,
                    fit.report.input.noise);
        std::printf("      rms from edge to edge:");
        const Eigen::VectorXd d = DistancesTo(fit.surface, drawn.places, pool).distances;
        constexpr int kParts = 15;
        for (int part = 0; part < kParts; ++part) {
          const Eigen::Index first = kPlaces * part / kParts, last = kPlaces * (part + 1) / kParts;
          const auto some = d.segment(first * kPlaces, (last - first) * kPlaces);
          std::printf(" %.0e", std::sqrt(some.squaredNorm() / static_cast<double>(some.size())));
        }
        std::printf("; tips");
        for (const Eigen::Index column : {0, 1, 2, 98, 99, 100}) {
          const Eigen::VectorXd some = d(Eigen::seqN(column, kPlaces, kPlaces));
          std::printf(" %.0e", std::sqrt(some.squaredNorm() / static_cast<double>(some.size())));
        }
        std::printf("; outliers %ld of %ld\n",
                    static_cast<long>(fit.outliers.count()),
                    static_cast<long>(fit.outliers.size()));
      }
      for (const BaseCandidate& row : fit.report.base_candidates)
        std::printf("      %s: %.3e, %d: %s\n",
                    row.name.c_str(),
                    row.score.value_or(0),
                    row.control_points,
                    row.refused.c_str());
      std::fflush(stdout);
    }
  } catch (const std::exception& failure) {
    runs.rms.push_back(HUGE_VAL);
    runs.rms_ratio.push_back(HUGE_VAL);
    runs.max_ratio.push_back(HUGE_VAL);
    runs.control_ratio.push_back(HUGE_VAL);
    runs.ends += std::string(runs.ends.empty() ? "" : ", ") + "refused";
    runs.why = failure.what();
    if (settings.each) std::printf("  %s %d: %s\n", kind.name.c_str(), seed, failure.what());
  }
}

double Most(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

void PrintKind(const Kind& kind, const Settings& settings) {
  constexpr int kFewSeeds = 10;  // whose ends are all told
  Runs runs;
  for (int k = 0; k < settings.seeds; ++k) RunSeed(kind, settings, settings.first + k, runs);
  std::printf("| %s | %.2e | %.2f (%.2f) | %.2f (%.2f) | %.2f (%.2f) | %.2f | %s |\n",
              kind.name.c_str(),
              Median(runs.rms),
              Median(runs.rms_ratio),
              Most(runs.rms_ratio),
              Median(runs.max_ratio),
              Most(runs.max_ratio),
              Median(runs.control_ratio),
              Most(runs.control_ratio),
              runs.seconds.empty() ? 0 : Median(runs.seconds),
              settings.seeds <= kFewSeeds ? runs.ends.c_str() : "");
  if (settings.seeds > kFewSeeds) {
    const auto good = std::count_if(
        runs.rms_ratio.begin(), runs.rms_ratio.end(), [](double r) { return r <= kGood; });
    std::printf("(%ld of %d within %.1f of the oracle's; %d say `noise_reached` beyond %.0f)\n",
                static_cast<long>(good),
                settings.seeds,
                kGood,
                runs.false_claims,
                kFalseClaim);
  }
  if (!runs.why.empty()) std::printf("(%s)\n", runs.why.c_str());
  std::fflush(stdout);
}

Settings Read(int argc, char** argv) {
  Settings settings;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const bool more = k + 1 < argc;
    if (word == "--seeds" && more) {
      settings.seeds = std::atoi(argv[++k]);
    } else if (word == "--first" && more) {
      settings.first = std::atoi(argv[++k]);
    } else if (word == "--points" && more) {
      settings.share = std::atof(argv[++k]);
    } else if (word == "--write" && more) {
      settings.folder = argv[++k];
    } else if (word == "--alone") {
      settings.alone = true;
    } else if (word == "--each") {
      settings.each = true;
    } else {
      settings.words.push_back(word);
    }
  }
  return settings;
}

void PrintKinds(const Settings& settings) {
  std::printf(
      "| kind | truth rms | over the oracle's (worst) | max (worst) | control points (worst) "
      "| processor's seconds | base, end of each seed |\n|---|---|---|---|---|---|---|\n");
  for (const Kind& kind : Kinds()) {
    bool chosen = settings.words.empty();
    for (const std::string& word : settings.words)
      chosen |= kind.name.find(word) != std::string::npos;
    if (chosen) PrintKind(kind, settings);
  }
}

}  // namespace
}  // namespace batten::internal

int main(int argc, char** argv) {
  try {
    PrintKinds(Read(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kind_fitting: %s\n", error.what());
    return 1;
  }
  return 0;
}
