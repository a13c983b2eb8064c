#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <iostream>
#include <span>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "tools/uplinkctl/command.h"

namespace uplink::ctl {

int ExitOf(const absl::Status& status) {
  if (status.ok()) return kExitDone;
  fmt::print(stderr, "uplinkctl: {}\n", std::string(status.message()));
  return absl::IsInvalidArgument(status) ? kExitWrongUse : kExitFailed;
}

bool SaysYes(std::string_view question) {
  fmt::print("{} yes/no: ", question);
  static_cast<void>(std::fflush(stdout));
  std::string answer;
  return std::getline(std::cin, answer) && answer == "yes";
}

namespace {

bool Names(const CLI::App& app, std::string_view name) {
  return std::ranges::any_of(app.get_subcommands({}),
                             [name](const CLI::App* each) { return each->get_name() == name; });
}

/// What the first arguments name wrongly: the library would say that a noun or a verb is missing.
std::string WrongName(const CLI::App& app, std::span<char* const> arguments) {
  if (arguments.empty() || arguments[0][0] == '-') return {};
  const std::string noun = arguments[0];
  if (!Names(app, noun)) return "no such noun: " + noun + " (uplinkctl --help names them)";
  if (arguments.size() < 2 || arguments[1][0] == '-') return {};
  const std::string verb = arguments[1];
  if (Names(*app.get_subcommand(noun), verb)) return {};
  return noun + " has no verb " + verb + " (uplinkctl " + noun + " --help names them)";
}

int Run(int argc, char** argv) {
  CLI::App app("Operate uplinkd and look into it", "uplinkctl");
  app.set_version_flag("--version", "uplinkctl " UPLINK_VERSION);
  app.require_subcommand(1);
  Action action;
  AddPki(app, action);
  AddConfig(app, action);
  AddStore(app, action);
  const std::span<char* const> arguments(argv, static_cast<std::size_t>(argc));
  if (const std::string wrong = WrongName(app, arguments.subspan(1)); !wrong.empty()) {
    fmt::print(stderr, "uplinkctl: {}\n", wrong);
    return kExitWrongUse;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitDone : kExitWrongUse;
  }
  return action ? action() : kExitWrongUse;
}

}  // namespace
}  // namespace uplink::ctl

int main(int argc, char** argv) { return uplink::ctl::Run(argc, argv); }
