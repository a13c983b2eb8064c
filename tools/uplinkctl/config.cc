#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "server/config/load.h"
#include "tools/uplinkctl/command.h"

namespace uplink::ctl {
namespace {

int Check(const std::string& path) {
  // The file alone: the environment of this shell is not the server's.
  const config::LoadResult result = config::LoadConfig(path, {});
  std::vector<config::Problem> problems = result.problems;
  if (result.ok()) problems = config::ValidateFiles(*result.config);
  for (const config::Problem& note : result.notes) {
    fmt::print(stderr, "note: {}\n", config::ToText(note));
  }
  for (const config::Problem& problem : problems) {
    fmt::print(stderr, "{}\n", config::ToText(problem));
  }
  if (!problems.empty()) return kExitWrongUse;
  fmt::print("{}: good\n", path);
  return kExitDone;
}

}  // namespace

void AddConfig(CLI::App& app, Action& action) {
  CLI::App* const noun = app.add_subcommand("config", "The server's configuration file");
  noun->require_subcommand(1);
  CLI::App* const check = noun->add_subcommand("check", "Report every problem of a file at once");
  const auto path = std::make_shared<std::string>();
  check->add_option("FILE", *path, "The configuration file")->required();
  check->callback([path, &action] { action = [path] { return Check(*path); }; });
}

}  // namespace uplink::ctl
