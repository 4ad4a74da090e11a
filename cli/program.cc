// SPDX-License-Identifier: MIT
#include "batten/cli/program.h"

#include <charconv>
#include <cstdio>
#include <stdexcept>

#include "batten/cli/nearest_name.h"
#include "batten/cli/terminal.h"
#include "batten/io/read_error.h"

namespace batten {
namespace {

std::string command_line;

// Commands of the contract that later versions will have.
const std::vector<std::string> kLaterCommands = {"project", "edit", "make", "analyze", "section", "tessellate"};
const std::vector<std::string> kLaterFits = {"curve", "primitive", "scan"};
const std::vector<std::string> kLaterFlags = {"--grid", "--domain", "--boundary", "--symmetric", "--thin", "--snap",
                                              "--las-class", "--uncertainty", "--certify", "--stream"};

bool Contains(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

// The command that was being parsed when an argument was left over.
const CLI::App* Deepest(const CLI::App& app) {
  const CLI::App* deepest = &app;
  while (!deepest->get_subcommands().empty()) deepest = deepest->get_subcommands().front();
  return deepest;
}

std::vector<std::string> Names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; })) names.push_back(sub->get_name());
  return names;
}

std::string ExplainExtra(const CLI::App& app, const std::string& extra) {
  const CLI::App* command = Deepest(app);
  const std::string word = extra.substr(0, extra.find('='));
  const bool flag = !word.empty() && word[0] == '-';
  const bool later = Contains(kLaterFlags, word) ||
                     (!flag && command == &app && Contains(kLaterCommands, word)) ||
                     (!flag && command->get_name() == "fit" && Contains(kLaterFits, word));
  const std::string place = command == &app ? "" : " for '" + command->get_display_name() + "'";
  if (later) return "'" + word + "' is not in this version";
  const std::string nearest = NearestName(word, Names(*command));
  std::string text = (flag ? "unknown flag '" : "unexpected argument '") + word + "'" + place;
  if (!nearest.empty()) text += "; did you mean '" + nearest + "'?";
  return text + " (--help lists what there is)";
}

int Parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::fputs(Deepest(app)->help().c_str(), stdout);
    return -1;
  } catch (const CLI::CallForVersion&) {
    std::printf("batten %s\n", Version());
    return -1;
  } catch (const CLI::ParseError& error) {
    // A word nobody knows is the better explanation where there is one.
    const std::vector<std::string> extras = app.remaining(true);
    if (!extras.empty()) throw UsageError(ExplainExtra(app, extras.front()));
    throw UsageError(std::string(error.what()) + " (--help lists what there is)");
  }
  return 0;
}

}  // namespace

const char* Version() { return BATTEN_VERSION; }

const std::string& CommandLine() { return command_line; }

void AddCommonFlags(CLI::App& command, CommonFlags& flags) {
  command.add_flag("--quiet", flags.quiet, "Print nothing but errors");
  command.add_flag("--json", flags.json, "Make standard output one JSON object");
}

void AddWorkFlags(CLI::App& command, WorkFlags& flags) {
  command.add_option("--threads", flags.threads, "Threads to use [all cores]")
      ->type_name("N")->check(CLI::Range(1, 1024));
  command.add_option("--seed", flags.seed, "Seed of every random choice")->capture_default_str()->type_name("N");
}

std::vector<double> ParseNumbers(const std::string& flag, const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (;;) {
    while (at != end && (*at == ' ' || *at == '\t')) ++at;
    if (at != end && *at == '+') ++at;
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !(value - value == 0)) {
      throw UsageError(flag + ": '" + text + "' is not a list of finite numbers");
    }
    numbers.push_back(value);
    at = next;
    while (at != end && (*at == ' ' || *at == '\t')) ++at;
    if (at == end) return numbers;
    if (*at != ',' && *at != ';') throw UsageError(flag + ": '" + text + "' is not a list of finite numbers");
    ++at;
  }
}

std::pair<int, int> ParsePair(const std::string& flag, const std::string& text) {
  const std::vector<double> numbers = ParseNumbers(flag, text);
  for (const double number : numbers) {
    if (numbers.size() > 2 || number != static_cast<int>(number) || number < 1 || number > 1e6) {
      throw UsageError(flag + ": '" + text + "' is not one or two positive whole numbers");
    }
  }
  return {static_cast<int>(numbers.front()), static_cast<int>(numbers.back())};
}

int RunProgram(int argc, char** argv) {
  for (int k = 0; k < argc; ++k) command_line += (k > 0 ? " " : "") + std::string(argv[k]);
  Action action;
  CLI::App app("batten turns measured points into NURBS curves and surfaces that CAD accepts.", "batten");
  app.set_version_flag("--version", std::string("batten ") + Version(), "Print the version");
  app.set_help_flag("-h,--help", "Print this help");
  app.footer(
      "Start with:\n"
      "  batten fit surface scan.ply -o part.step          points in, a surface for CAD out\n"
      "  batten compare part.step scan.ply                 how well it fits, measured again\n"
      "  batten COMMAND --help                             flags, defaults and examples\n"
      "Exit codes: 0 done; 1 the input can't be used; 2 usage; 3 written, but the tolerance is not reached;\n"
      "130 interrupted. Results go to standard output, everything else to standard error.");
  app.require_subcommand(1);
  CLI::App& fit = *app.add_subcommand("fit", "Fit geometry to points");
  fit.require_subcommand(1);
  fit.footer("Examples:\n  batten fit surface scan.ply -o part.step\n  batten fit surface --help");
  AddFitSurfaceCommand(fit, action);
  AddCompareCommand(app, action);
  AddEvaluateCommand(app, action);
  AddConvertCommand(app, action);
  AddInfoCommand(app, action);
  AddSampleCommand(app, action);
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    command->fallthrough(false);
  }
  try {
    if (Parse(app, argc, argv) < 0) return kDone;
    WatchForInterrupt();
    const int code = action();
    return Interrupted() ? kInterrupted : code;
  } catch (const UsageError& error) {
    PrintError(error.what());
    return kBadUsage;
  } catch (const Cancelled&) {
    PrintError("interrupted; nothing was written");
    return kInterrupted;
  } catch (const std::bad_alloc&) {
    PrintError("not enough memory for this input");
    return kBadInput;
  } catch (const std::exception& error) {
    PrintError(Interrupted() ? "interrupted; nothing was written" : error.what());
    return Interrupted() ? kInterrupted : kBadInput;
  }
}

}  // namespace batten
