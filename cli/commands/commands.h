// SPDX-License-Identifier: MIT
// Each command declares itself to the parser.
#pragma once

#include <functional>
#include <span>

#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// A command's action, run after parsing; returns the exit code.
using Action = std::function<int()>;

// Each declares its subcommand and sets `action` when that is the one chosen.
void AddFitCurveCommand(CLI::App& fit, Action& action);
void AddFitPrimitiveCommand(CLI::App& fit, Action& action);
void AddFitPartsCommand(CLI::App& fit, Action& action);
void AddFitSolidCommand(CLI::App& fit, Action& action);
void AddFitSurfaceCommand(CLI::App& fit, Action& action);
void AddAnalyzeCommand(CLI::App& app, Action& action);
void AddBatchCommand(CLI::App& app, Action& action);
void AddCompareCommand(CLI::App& app, Action& action);
void AddConvertCommand(CLI::App& app, Action& action);
void AddEditCommand(CLI::App& app, Action& action);
void AddEvaluateCommand(CLI::App& app, Action& action);
void AddInfoCommand(CLI::App& app, Action& action);
void AddIntersectCommand(CLI::App& app, Action& action);
void AddMakeCommand(CLI::App& app, Action& action);
void AddMakeOffsetCommand(CLI::App& make, Action& action);
void AddProjectCommand(CLI::App& app, Action& action);
void AddSampleCommand(CLI::App& app, Action& action);
void AddSectionCommand(CLI::App& app, Action& action);
void AddTessellateCommand(CLI::App& app, Action& action);

// A command of the program.
struct ProgramCommand {
  const char* name;
  bool of_fit;                              // `batten fit NAME`, else `batten NAME`
  void (*add)(CLI::App& parent, Action&);  // null: not in this build (batten_first)
};

// All commands, in the order in which help lists them.
std::span<const ProgramCommand> AllCommands();

}  // namespace batten::internal
