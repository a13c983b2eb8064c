#include <algorithm>
#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "tools/uplinkctl/command.h"

namespace uplink::ctl {

int ExitOf(const absl::Status& status) {
  if (status.ok()) return kExitDone;
  fmt::print(stderr, "uplinkctl: {}\n", std::string(status.message()));
  return absl::IsInvalidArgument(status) ? kExitWrongUse : kExitFailed;
}

namespace {

int Run(int argc, char** argv) {
  CLI::App app("Operate uplinkd and look into it", "uplinkctl");
  app.set_version_flag("--version", "uplinkctl " UPLINK_VERSION);
  app.require_subcommand(1);
  Action action;
  AddPki(app, action);
  AddConfig(app, action);
  AddStore(app, action);
  // The library would say of a wrong noun that one is missing.
  const auto named = [&](const CLI::App* noun) { return noun->get_name() == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && std::ranges::none_of(app.get_subcommands({}), named)) {
    fmt::print(stderr, "uplinkctl: no such noun: {} (uplinkctl --help names them)\n", argv[1]);
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
