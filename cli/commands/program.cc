// SPDX-License-Identifier: MIT
#include "cli/commands/program.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "batten/fitting/progress.h"
#include "batten/io/atomic_file.h"
#include "batten/io/read_error.h"
#include "cli/commands/commands.h"
#include "cli/commands/completion.h"
#include "cli/commands/manual_pages.h"
#include "cli/commands/short_forms.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/help_format.h"
#include "cli/terminal/interrupt.h"
#include "cli/terminal/nearest_name.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/terminal.h"
#include "cli/terminal/this_run.h"

namespace batten::internal {
namespace {

// Commands of the contract that later versions will have.
const std::vector<std::string> kLaterCommands = {};
const std::vector<std::string> kLaterFits = {"scan"};
const std::vector<std::string> kLaterFlags = {"--uncertainty", "--certify", "--stream"};

bool Contains(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

// The command that was being parsed when an argument was left over.
const CLI::App* Deepest(const CLI::App& app) {
  const CLI::App* deepest = &app;
  while (!deepest->get_subcommands().empty()) deepest = deepest->get_subcommands().front();
  return deepest;
}

// "batten fit surface": the command as one types it.
std::string TypedName(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* sub = &app; !sub->get_subcommands().empty();) {
    sub = sub->get_subcommands().front();
    name += " " + sub->get_name();
  }
  return name;
}

std::vector<std::string> FlagNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::vector<std::string> CommandNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(sub->get_name());
  }
  return names;
}

std::string Listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

// The commands that have a flag: "'batten fit surface', 'batten compare'".
std::string HavingFlag(const CLI::App& command, const std::string& path, const std::string& flag) {
  std::string having = Contains(FlagNames(command), flag) ? "'" + path + "'" : "";
  for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; })) {
    const std::string below = HavingFlag(*sub, path + " " + sub->get_name(), flag);
    having += (having.empty() || below.empty() ? "" : ", ") + below;
  }
  return having;
}

std::string ExplainFlag(const CLI::App& app, const std::string& flag) {
  std::error_code unknown;  // what can't be looked at is no file
  if (std::filesystem::exists(flag, unknown))
    return "'" + flag + "' is read as a flag; the file of this name is ./" + flag;
  const std::string text = "unknown flag '" + flag + "' for '" + TypedName(app) + "'; ";
  const std::string having = HavingFlag(app, app.get_name(), flag);
  if (!having.empty())
    return text + having + (having.find(',') == std::string::npos ? " has" : " have") + " it";
  if (Contains(kLaterFlags, flag)) return "'" + flag + "' is not in this version";
  const std::string whole = flag.rfind("--", 0) == 0 ? flag : "-" + flag;
  return text + DidYouMean(whole, FlagNames(*Deepest(app)), "--help lists all there are");
}

std::string ExplainWord(const CLI::App& app, const std::string& word) {
  const CLI::App* command = Deepest(app);
  std::vector<std::string> commands = CommandNames(*command);
  if (commands.empty()) {
    return "unexpected argument '" + word + "' for '" + TypedName(app) +
           "' (--help shows what it takes)";
  }
  const bool of_fit = command->get_name() == "fit";
  if (Contains(of_fit ? kLaterFits : kLaterCommands, word)) {
    return "'" + TypedName(app) + " " + word + "' is not in this version";
  }
  const std::string known = "known are " + Listed(commands);
  if (command == &app) {  // a fit's name alone is understood (short_forms.h)
    for (const std::string& fit : CommandNames(*app.get_subcommand("fit"))) commands.push_back(fit);
  }
  return "unknown command '" + TypedName(app) + " " + word + "'; " +
         DidYouMean(word, commands, known);
}

std::string ExplainExtra(const CLI::App& app, const std::string& extra) {
  const bool flag = extra.size() > 1 && extra[0] == '-';
  return flag ? ExplainFlag(app, extra.substr(0, extra.find('='))) : ExplainWord(app, extra);
}

// The parser's words for a flag with too many or too few values.
std::string ExplainCount(const std::string& words) {
  const std::string flag = words.substr(0, words.find(':'));
  if (words.find(": At Most 1 ") != std::string::npos) return flag + " is given more than once";
  return words.ends_with(" missing") ? flag + " needs a value" : words;
}

// Why the command line can't be used, in one sentence.
std::string Explain(const CLI::App& app, const CLI::ParseError& error) {
  // A word nobody knows is the better explanation where there is one.
  std::vector<std::string> extras = app.remaining(true);
  std::erase(extras, "--");  // files follow: no word of its own
  if (!extras.empty()) return ExplainExtra(app, extras.front());
  const std::vector<std::string> commands = CommandNames(*Deepest(app));
  if (!commands.empty()) {
    return "usage: " + TypedName(app) + " COMMAND ...; commands are " + Listed(commands) + " (" +
           TypedName(app) + " --help says more)";
  }
  return ExplainCount(error.what()) + " ('" + TypedName(app) + " --help' lists what there is)";
}

int Parse(CLI::App& app, std::vector<std::string> words) {
  std::reverse(words.begin(), words.end());  // the parser takes them from the end
  try {
    app.parse(std::move(words));
  } catch (const CLI::CallForHelp&) {
    // Help on a command that is not there is no help.
    const std::vector<std::string> extras = app.remaining(true);
    const bool wants_command = !CommandNames(*Deepest(app)).empty();
    if (wants_command && !extras.empty()) throw UsageError(ExplainExtra(app, extras.front()));
    std::fputs(app.help().c_str(), stdout);
    return -1;
  } catch (const CLI::CallForVersion&) {
    std::printf("batten %s\n", Version());
    return -1;
  } catch (const CLI::ParseError& error) {
    throw UsageError(Explain(app, error));
  }
  return 0;
}

// Of a command line that is short for another: what it was taken for, and the other.
void TellInFull(const std::vector<std::string>& typed, const FullCommand& full) {
  if (full.words == typed || Contains(full.words, "--quiet")) return;
  const std::string page =
      WritesPageUnasked(typed, full.words) ? "the page of the report shows how well it fits; " : "";
  const std::string taken = full.taken.empty() ? "" : full.taken + "; ";
  PrintNote(taken + page + "the command in full: " + CommandLine());
}

// Buffered output that does not arrive is an error too.
int Flushed(int code) {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
  PrintError(std::string("standard output: can't be written: ") + std::strerror(errno));
  return kBadInput;
}

// Who reads standard output has had enough (`| head`): what is whole gets its name, and the program
// ends as by the signal. The signal is raised by a write of this thread, which holds no lock.
extern "C" void EndWithReader(int) {
  constexpr int kReaderLeft = 128 + SIGPIPE;
  try {
    OutputBatch::Commit();
    AtomicFile::RemoveTemporaries();
  } catch (...) {
  }
  _exit(kReaderLeft);
}

// Does the work; its files appear when all of it is done and said, or none does.
int Carry(const Action& action) {
  const OutputBatch batch;
  std::signal(SIGPIPE, EndWithReader);
  const int code = Flushed(action());  // what is done when Ctrl-C comes too late is done
  ClearProgress();
  if (code != kBadInput) OutputBatch::Commit();
  std::signal(SIGPIPE, SIG_DFL);
  return code;
}

// Its words are another command's (short_forms.h); what is left is for help and completion.
void AddHelpCommand(CLI::App& app, Action& action) {
  CLI::App& command = *app.add_subcommand("help", "Show the help of a command");
  const auto words = std::make_shared<std::vector<std::string>>();
  Suggest(*command.add_option("COMMAND", *words, "The command, such as fit surface"),
          CommandNames(app));
  command.footer("Examples:\n  batten help\n  batten help fit surface");
  command.callback([&app, words, &action] {
    action = [&app, words] {
      std::fputs(app.help().c_str(), stdout);
      return kDone;
    };
  });
}

// Of a command that batten_first does not have, so that it is listed.
void AddNameAlone(CLI::App& parent, const char* name) {
  parent.add_subcommand(name, "Not in this first program: ./scripts/start builds the whole one");
}

// What such a command needs, before its words are looked at.
void RefuseNameAlone(const std::vector<std::string>& words) {
  for (const ProgramCommand& command : AllCommands()) {
    const std::size_t place = command.of_fit ? 1 : 0;
    const bool named = words.size() > place && words[place] == command.name &&
                       (!command.of_fit || words[0] == "fit");
    if (!named || command.add != nullptr) continue;
    throw UsageError("'batten " + std::string(command.of_fit ? "fit " : "") + command.name +
                     "' is not in this first program; ./scripts/start builds "
                     "build/release/bin/batten, which has it");
  }
}

const char* const kPurpose =
    "batten turns measured points into NURBS curves and surfaces that CAD accepts.";

void AddAll(CLI::App& app, Action& action) {
  WrapHelp(app);
  app.set_version_flag("--version", std::string("batten ") + Version(), "Print the version");
  app.set_help_flag("-h,--help", "Print this help");
  app.footer(
      "From a scan to CAD:\n"
      "  batten scan.ply                                   scan.step and a report, to begin with\n"
      "  batten scan.ply --as curve                        another kind than what it is taken for\n"
      "  batten info scan.ply                              how many points, how dense, how noisy\n"
      "  batten fit surface scan.ply -o part.step          points in, a surface for CAD out\n"
      "  batten fit surface scan.ply -o part.step --tolerance 0.05 --report part.html\n"
      "  batten compare part.step scan.ply --tolerance 0.05\n"
      "                                                    how well it fits, measured again\n"
      "  batten tessellate part.step -o part.stl           triangles for viewers and printers\n"
      "Curves, exact shapes, changes:\n"
      "  batten fit curve section.xyz -o section.step      one or several curves along points\n"
      "  batten fit primitive bore.xyz -o bore.step --kind cylinder\n"
      "  batten fit solid body.ply -o body.step --quads layout.obj\n"
      "  batten make cylinder -o pin.step --radius 3 --height 20\n"
      "  batten edit part.step -o half.json split:dir=u,at=0.5\n"
      "  batten analyze part.step                          degree, area, curvature, which shape\n"
      "  batten batch jobs.csv                             a folder of scans, a line each\n"
      "  batten COMMAND --help                             flags, defaults and more examples\n"
      "A file alone is fitted as what it holds: 'fit curve' where points lie along a line, 'fit\n"
      "solid' where a mesh closes, else 'fit surface'; of geometry 'info' is told. --as curve,\n"
      "surface, primitive, parts, solid or info makes that of it. 'batten curve FILE' and 'batten\n"
      "plane FILE' are understood too.\n"
      "Lengths are in the data's unit, angles in degrees. A file's extension says its format; rows "
      "of\n"
      "numbers are points under any name. '-' is standard input or output, with --format. --json "
      "makes\n"
      "the result one JSON object.\n"
      "Exit codes: 0 done; 1 the input can't be used; 2 usage; 3 written, but the tolerance is not "
      "reached;\n"
      "4 written, but doubtful: the first line says why (--accept-doubt makes it 0); 130 "
      "interrupted.\n"
      "Results go to standard output, everything else to standard error.");
  app.require_subcommand(1);
  CLI::App& fit = *app.add_subcommand("fit", "Fit geometry to points");
  fit.require_subcommand(1);
  fit.footer(
      "Examples:\n  batten fit surface scan.ply -o part.step\n"
      "  batten fit curve section.xyz -o section.step\n  batten fit surface --help");
  for (const ProgramCommand& command : AllCommands()) {
    CLI::App& parent = command.of_fit ? fit : app;
    if (command.add) {
      command.add(parent, action);
    } else {
      AddNameAlone(parent, command.name);
    }
  }
  AddCompletionCommand(app, action);
  AddHelpCommand(app, action);
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    command->fallthrough(false);
  }
}

}  // namespace

void CheckCommandLine(const std::vector<std::string>& words) {
  Action action;
  CLI::App app(kPurpose, "batten");
  AddAll(app, action);
  Parse(app, words);
}

bool FlagTakesNoValue(const std::string& command, const std::string& flag) {
  Action action;
  CLI::App app(kPurpose, "batten");
  AddAll(app, action);
  const CLI::App* sub = &app;
  std::istringstream names(command);
  for (std::string name; names >> name;) {
    if (!Contains(CommandNames(*sub), name)) return false;
    sub = sub->get_subcommand(name);
  }
  const CLI::Option* option = sub->get_option_no_throw(flag);
  return option != nullptr && option->get_items_expected_max() == 0;
}

int RunProgram(int argc, char** argv) {
  const std::vector<std::string> typed(argv + std::min(argc, 1), argv + argc);
  Action action;
  CLI::App app(kPurpose, "batten");
  AddAll(app, action);
  // Not a command of its own: only the script that completes words asks.
  if (!typed.empty() && typed[0] == "__complete") {
    PrintCompletion(app, {typed.begin() + 1, typed.end()});
    return Flushed(kDone);
  }
  try {
    // Nor this: the build, and scripts/make-cli-pages, ask for the manual.
    if (!typed.empty() && typed[0] == "__pages") {
      WriteManualPages(app, {typed.begin() + 1, typed.end()});
      return kDone;
    }
    const FullCommand full = InFull(app, typed);
    RefuseNameAlone(full.words);
    KeepCommandLine(argc > 0 ? argv[0] : "batten", full.words);
    if (Parse(app, full.words) < 0) return Flushed(kDone);
    WatchForInterrupt();
    if (!full.taken.empty()) TellInFull(typed, full);
    const int carried = Carry(action), code = carried == kDone && Doubtful() ? kDoubtful : carried;
    if (full.taken.empty() && code != kBadInput) TellInFull(typed, full);
    return code;
  } catch (const UsageError& error) {
    PrintError(error.what());
    return kBadUsage;
  } catch (const Cancelled&) {
    if (PastTimeLimit() && !Interrupted()) {
      PrintError("--time-limit: there was no result yet when time was up; nothing was written");
      return kBadInput;
    }
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

}  // namespace batten::internal
