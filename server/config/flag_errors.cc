#include "server/config/flag_errors.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "server/config/nearest.h"

namespace uplink::config {
namespace {

/// `uplinkctl pki server`.
std::string PathOf(const CLI::App& app) {
  const CLI::App* const parent = app.get_parent();
  return parent == nullptr ? app.get_name() : PathOf(*parent) + " " + app.get_name();
}

/// The commands of an app, or the groups of its flags: the library keeps both in one list.
std::vector<const CLI::App*> PartsOf(const CLI::App& app, bool commands) {
  return app.get_subcommands(
      [commands](const CLI::App* part) { return part->get_name().empty() != commands; });
}

void AddFlagNames(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
}

std::string UnknownFlag(const CLI::App& app, const std::string& flag) {
  std::vector<std::string> names;
  AddFlagNames(app, names);
  for (const CLI::App* group : PartsOf(app, false)) AddFlagNames(*group, names);
  return flag + ": unknown flag" +
         DidYouMean(flag, names, "; " + PathOf(app) + " --help lists those that it has");
}

std::string UnknownCommand(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* command : PartsOf(app, true)) names.push_back(command->get_name());
  const std::string before = app.get_parent() == nullptr ? "" : app.get_name() + " ";
  return before + word + ": unknown command" +
         DidYouMean(word, names, "; " + PathOf(app) + " --help lists those that it has");
}

/// The last command that the arguments chose.
const CLI::App& ChosenOf(const CLI::App& app) {
  for (const CLI::App* command : PartsOf(app, true)) {
    if (command->parsed()) return ChosenOf(*command);
  }
  return app;
}

/// The flags of a group from which one must be given.
std::vector<const CLI::Option*> AlternativesIn(const CLI::App& group) {
  return group.get_options(
      [&group](const CLI::Option* option) { return option != group.get_help_ptr(); });
}

std::string OneOfText(const std::vector<const CLI::Option*>& options) {
  std::string text;
  for (const CLI::Option* option : options) {
    text += (text.empty() ? "" : " or ") + option->get_name();
  }
  return "give either " + text;
}

/// What is missing; the library says which flag.
std::string MissingText(const CLI::App& chosen, const std::string& library_says) {
  for (const CLI::App* group : PartsOf(chosen, false)) {
    const auto options = AlternativesIn(*group);
    const auto given = std::ranges::count_if(
        options, [](const CLI::Option* option) { return option->count() > 0; });
    if (group->get_require_option_min() == 1 && given != 1) {
      return OneOfText(options);
    }
  }
  if (!PartsOf(chosen, true).empty()) return "a command is missing";
  return library_says;
}

}  // namespace

std::string UnknownName(const CLI::App& program, std::span<const char* const> arguments) {
  const CLI::App* app = &program;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string word = arguments[i];
    if (word == "--") return {};
    if (word.size() > 1 && word.front() == '-') {
      const std::string flag = word.substr(0, word.find('='));
      const CLI::Option* const option = app->get_option_no_throw(flag);
      if (option == nullptr) return UnknownFlag(*app, flag);
      // Its value may look like anything.
      if (flag.size() == word.size() && option->get_expected_min() > 0) ++i;
      continue;
    }
    const auto commands = PartsOf(*app, true);
    if (commands.empty()) continue;
    const auto command = std::ranges::find_if(
        commands, [&](const CLI::App* each) { return each->get_name() == word; });
    if (command == commands.end()) return UnknownCommand(*app, word);
    app = *command;
  }
  return {};
}

std::string WrongUseText(const CLI::App& program, const CLI::ParseError& error) {
  const CLI::App& chosen = ChosenOf(program);
  const std::string help = PathOf(chosen) + " --help";
  const std::string says = error.what();
  const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
  if (code == CLI::ExitCodes::RequiredError) {
    return MissingText(chosen, says) + "; " + help + " shows what it takes";
  }
  if (code == CLI::ExitCodes::ArgumentMismatch) {
    return says.substr(0, says.find(':')) + ": a value is missing behind it; " + help +
           " shows what it takes";
  }
  if (code == CLI::ExitCodes::ExcludesError) return says + ": give one of the two";
  return says + "; see " + help;
}

}  // namespace uplink::config
