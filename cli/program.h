// SPDX-License-Identifier: MIT
// What the subcommands share: exit codes, common flags, and how a command is declared and run.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace batten {

inline constexpr int kDone = 0;
inline constexpr int kBadInput = 1;
inline constexpr int kBadUsage = 2;
inline constexpr int kToleranceMissed = 3;
inline constexpr int kInterrupted = 130;

const char* Version();

// Flags every command has.
struct CommonFlags {
  bool quiet = false;  // errors only
  bool json = false;   // standard output is one JSON object
};
void AddCommonFlags(CLI::App& command, CommonFlags& flags);

void AddThreadsFlag(CLI::App& command, int& threads);  // 0 stands for all cores

// Flags of the commands that compute for long.
struct WorkFlags {
  int threads = 0;  // 0: all cores
  std::uint64_t seed = 1;
};
void AddWorkFlags(CLI::App& command, WorkFlags& flags);
void AddSeedFlag(CLI::App& command, std::uint64_t& seed, const std::string& what);

// A command's action, run after parsing; returns the exit code.
using Action = std::function<int()>;

// Each declares its subcommand and sets `action` when that is the one chosen.
void AddFitCurveCommand(CLI::App& fit, Action& action);
void AddFitPrimitiveCommand(CLI::App& fit, Action& action);
void AddFitSurfaceCommand(CLI::App& fit, Action& action);
void AddAnalyzeCommand(CLI::App& app, Action& action);
void AddCompareCommand(CLI::App& app, Action& action);
void AddConvertCommand(CLI::App& app, Action& action);
void AddEditCommand(CLI::App& app, Action& action);
void AddEvaluateCommand(CLI::App& app, Action& action);
void AddInfoCommand(CLI::App& app, Action& action);
void AddMakeCommand(CLI::App& app, Action& action);
void AddProjectCommand(CLI::App& app, Action& action);
void AddSampleCommand(CLI::App& app, Action& action);
void AddSectionCommand(CLI::App& app, Action& action);
void AddTessellateCommand(CLI::App& app, Action& action);

// The command line, quoted so that a shell takes it again, for reports.
const std::string& CommandLine();

// Parses and runs; everything an exception can mean becomes one line on standard error and a code.
int RunProgram(int argc, char** argv);

}  // namespace batten
