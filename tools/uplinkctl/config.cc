#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "schema/base/clock.h"
#include "server/config/load.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/verbs/records.h"

namespace uplink::ctl {
namespace {

int Check(const std::string& path) {
  // With the variables of this environment, as a server that is started here would read them.
  config::LoadResult result =
      config::WithFiles(config::LoadConfig(path, config::ProcessEnvironment()));
  if (result.readable) {
    for (config::Note& note : config::ExpiredFiles(*result.readable, SystemClock().System())) {
      result.notes.push_back(std::move(note));
    }
  }
  for (const config::Note& note : result.notes) {
    fmt::print(stderr, "note: {}\n", config::ToText(note));
  }
  for (const config::Problem& problem : result.problems) {
    fmt::print(stderr, "{}\n", config::ToText(problem));
  }
  if (!result.problems.empty()) return kExitWrongUse;
  fmt::print("{}: good\n", path);
  return kExitDone;
}

}  // namespace

void AddConfig(config::Flags& program) {
  config::Flags& noun = program.AddCommand("config", "The server's settings");
  struct Request {
    std::string file;
    std::string config;
  };
  const auto request = std::make_shared<Request>();
  config::Flags& check =
      noun.AddCommand("check", "Report every problem of a file at once", [request] {
        if (!request->file.empty()) return Check(request->file);
        return Check(request->config.empty() ? config::kConfigFileDefault : request->config);
      });
  check.Add({"FILE", "The configuration file, as --config"}, request->file);
  check.Add({"--config", fmt::format("The server's configuration file (without it {})",
                                     config::kConfigFileDefault)},
            request->config);
  check.AtMostOne({"FILE", "--config"});
  check.Example("uplinkctl config check --config /etc/uplinkd/uplinkd.toml");
  AddConfigShow(noun);
}

}  // namespace uplink::ctl
