// SPDX-License-Identifier: MIT
// The module libbatten_opencascade.so hands out its functions.
#include "io/exchange/opencascade_functions.h"
#include "io/opencascade/brep_export.h"
#include "io/opencascade/brep_import.h"
#include "io/opencascade/cad_shapes.h"
#include "io/opencascade/iges_export.h"
#include "io/opencascade/iges_import.h"
#include "io/opencascade/solid_export.h"
#include "io/opencascade/step_export.h"
#include "io/opencascade/step_import.h"
#include "io/opencascade/trimmed_solid_export.h"

extern "C" __attribute__((visibility("default"))) const batten::internal::OpenCascadeFunctions*
batten_opencascade_functions() {
  using namespace batten::internal;
  static constexpr OpenCascadeFunctions kFunctions = {ImportStep,
                                                      ExportStep,
                                                      ExportSolid,
                                                      ExportTrimmedSolid,
                                                      ExportIges,
                                                      ImportBrep,
                                                      MeasureShapes,
                                                      ImportIges,
                                                      ExportBrep};
  return &kFunctions;
}
