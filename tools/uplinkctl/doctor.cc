#include <cstdio>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "schema/base/clock.h"
#include "server/config/load.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/doctor/checks.h"
#include "tools/uplinkctl/doctor/config_check.h"
#include "tools/uplinkctl/doctor/finding.h"
#include "tools/uplinkctl/doctor/machine_facts.h"
#include "tools/uplinkctl/doctor/service_user.h"

namespace uplink::ctl {
namespace {

struct Arguments {
  std::string config;
  std::string user;
};

Finding UserFinding(const User& user, const Arguments& arguments) {
  if (user.uid == 0 && arguments.user.empty()) {
    return Warning("user", "files are looked at as root, who may read all",
                   "name the server's user by --user");
  }
  return Ok("user", fmt::format("files are looked at as {}", user.name));
}

/// Nothing was checked. Not the 1 of other verbs, which here means that there were only warnings.
int Fail(const absl::Status& status) {
  static_cast<void>(ExitOf(status));
  return kExitErrors;
}

int Doctor(const Arguments& arguments) {
  const absl::StatusOr<User> user = UserToCheckAs(arguments.user);
  if (!user.ok()) return Fail(user.status());
  // While root: only root sees who holds a port.
  const MachineFacts machine = ReadMachine();
  if (absl::Status became = Become(*user); !became.ok()) return Fail(became);
  const SystemClock clock;
  const config::LoadResult read =
      config::WithFiles(config::LoadConfig(arguments.config, config::ProcessEnvironment()));
  Findings findings{UserFinding(*user, arguments)};
  Append(findings, ConfigFindings(read, arguments.config, user->name));
  Append(findings, CheckAll({read, machine, user->name, user->uid, clock}));
  for (const Finding& finding : findings) fmt::print("{}\n", ToText(finding));
  fmt::print("{}\n", Summary(findings));
  return ExitOfFindings(findings);
}

}  // namespace

void AddDoctor(config::Flags& program) {
  const auto arguments = std::make_shared<Arguments>();
  config::Flags& noun = program.AddCommand("doctor",
                                           "Check configuration, certificates, store, disk, ports, "
                                           "descriptors and clock; 1 for warnings, 2 for errors",
                                           [arguments] { return Doctor(*arguments); });
  noun.Add({"--config", "The server's configuration file", config::Flag::Need::kRequired},
           arguments->config);
  noun.Add(
      {"--user", "As root: look at the files as this user (default: uplinkd, if there is one)"},
      arguments->user);
  noun.Example("uplinkctl doctor --config /etc/uplinkd/uplinkd.toml");
}

}  // namespace uplink::ctl
