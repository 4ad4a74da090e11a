// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_solid.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "batten/fitting/solid_layout.h"
#include "fitting/core/stage_clock.h"
#include "fitting/solid/field_layout.h"
#include "fitting/solid/solid_fitter.h"
#include "fitting/solid/surface_fit.h"

namespace batten {
using namespace internal;

namespace {

// Whether points left out are met better than by another fit, but for chance.
bool MeetsBetter(const SolidFit& fit, const SolidFit& other) {
  if (fit.held_out.size() != other.held_out.size()) {
    return fit.report.error.rms < other.report.error.rms;
  }
  return Worse(other.held_out, fit.held_out) > 1;
}

// Whether one with three times as many faces may do: that takes most of what is not noise.
bool IsNearNoise(const SolidFit& fit) {
  constexpr double kTaken = 0.1;  // of the variance that is left; of a smooth shape 1/81
  const double noise = fit.report.input.noise * fit.report.input.noise;
  return kTaken * (fit.held_out.mean() - noise) < noise;
}

// By half as many again, from the last on: over creases a layout is too coarse here and there, and
// the next one seldom in the same place.
std::vector<int> CountsAbove(int count, int most) {
  std::vector<int> counts;
  for (double next = most; next > 1.2 * count; next /= 1.5) counts.push_back(int(next));
  return counts;
}

// The stages of a fit, and beside them its layouts' and those of the fits that were not as good.
StageSeconds WithOthers(StageSeconds own, const StageSeconds& all) {
  own.prepare += all.prepare;
  own.parameterize += all.parameterize;
  own.refine += all.refine - own.total;
  own.total = all.total;
  return own;
}

}  // namespace

SolidFit FitSolid(const PointCloud& cloud, const QuadMesh& layout, const SolidFitOptions& options) {
  return SolidFitter(cloud, layout, options).Refined();
}

SolidFit FitSolid(const PointCloud& cloud,
                  const TriangleSurface& surface,
                  int faces,
                  const SolidFitOptions& options) {
  Check(options);
  StageClock clock;
  const auto layout_of = [&](int count) {
    clock.Enter(&StageSeconds::parameterize);
    return LayoutOf(surface, count, options.progress);
  };
  const auto fitted = [&](const QuadMesh& layout) {
    clock.Enter(&StageSeconds::refine);
    return std::make_unique<SolidFitter>(cloud, layout, options);
  };
  bool cancelled = false;
  const auto finished = [&](SolidFitter& fitter) {
    clock.Enter(&StageSeconds::refine);
    SolidFit fit = cancelled ? std::move(fitter).Coarse() : std::move(fitter).Refined();
    if (cancelled) fit.report.termination = Termination::kCancelled;
    fit.report.seconds = WithOthers(fit.report.seconds, clock.Seconds());
    return fit;
  };
  if (faces > 0) return finished(*fitted(layout_of(faces)));
  const int most = LayoutFaces(cloud.size() - MergeDuplicates(cloud).duplicates);
  std::vector<int> counts;  // from the last on
  for (const int coarse : {1, 3, 9}) {
    if (coarse == 1 || (!options.smoothing && most / coarse >= kFewestFaces)) {
      counts.push_back(most / coarse);
    }
  }
  std::unique_ptr<SolidFitter> best;
  std::string why;
  bool creased = false;
  while (!counts.empty()) {
    const int count = counts.back();
    counts.pop_back();
    try {
      const QuadMesh layout = layout_of(count);
      // A border is no sharp edge: layouts are not too coarse here and there for it.
      if (layout.creases.cols() > 0 && layout.caps.empty() && !creased) {
        creased = true;
        counts = CountsAbove(count, most);
      }
      // Edges that were sharp stay so.
      if (best && best->coarse().audit.sharp_edges > 0 && layout.creases.cols() == 0) continue;
      auto fit = fitted(layout);
      if (best && !MeetsBetter(fit->coarse(), best->coarse())) break;
      best = std::move(fit);
      if (count == most) break;
      // The finest next; the one between only if that is refused.
      if (counts.size() > 1 && !creased && !IsNearNoise(best->coarse()))
        std::swap(counts.front(), counts.back());
    } catch (const Cancelled&) {
      if (!best) throw;
      cancelled = true;
      break;
    } catch (const RefusedData& refusal) {
      why = refusal.what();  // too coarse for the shape, or too fine for the points
    }
  }
  if (!best) throw RefusedData(why);
  return finished(*best);
}

}  // namespace batten
