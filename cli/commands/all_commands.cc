// SPDX-License-Identifier: MIT
// The table of commands. It is compiled twice: for the program, and with BATTEN_FIRST_COMMANDS for batten_first, which has
// those that cmake/FirstSurface.cmake names and knows of the others that they are still to be built.
#include "cli/commands/commands.h"

namespace batten::internal {
namespace {

#ifdef BATTEN_FIRST_COMMANDS
#define BATTEN_LATER(add) nullptr
#else
#define BATTEN_LATER(add) add
#endif

constexpr ProgramCommand kCommands[] = {
    {"surface", true, AddFitSurfaceCommand},
    {"curve", true, BATTEN_LATER(AddFitCurveCommand)},
    {"primitive", true, BATTEN_LATER(AddFitPrimitiveCommand)},
    {"parts", true, BATTEN_LATER(AddFitPartsCommand)},
    {"solid", true, BATTEN_LATER(AddFitSolidCommand)},
    {"compare", false, BATTEN_LATER(AddCompareCommand)},
    {"batch", false, BATTEN_LATER(AddBatchCommand)},
    {"evaluate", false, AddEvaluateCommand},
    {"project", false, BATTEN_LATER(AddProjectCommand)},
    {"edit", false, BATTEN_LATER(AddEditCommand)},
    {"section", false, BATTEN_LATER(AddSectionCommand)},
    {"intersect", false, BATTEN_LATER(AddIntersectCommand)},
    {"make", false, BATTEN_LATER(AddMakeCommand)},
    {"convert", false, AddConvertCommand},
    {"analyze", false, BATTEN_LATER(AddAnalyzeCommand)},
    {"info", false, BATTEN_LATER(AddInfoCommand)},
    {"sample", false, BATTEN_LATER(AddSampleCommand)},
    {"tessellate", false, AddTessellateCommand},
};

#undef BATTEN_LATER

}  // namespace

std::span<const ProgramCommand> AllCommands() { return kCommands; }

}  // namespace batten::internal
