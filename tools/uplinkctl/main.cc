#include <cstdio>
#include <iostream>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "server/config/version.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/doctor/finding.h"

namespace uplink::ctl {

int ExitOf(const absl::Status& status) {
  if (status.ok()) return kExitDone;
  // A database or a server may have worded it.
  fmt::print(stderr, "uplinkctl: {}\n", OneLine(std::string(status.message())));
  return absl::IsInvalidArgument(status) ? kExitWrongUse : kExitFailed;
}

bool SaysYes(std::string_view question) {
  fmt::print("{} yes/no: ", question);
  static_cast<void>(std::fflush(stdout));
  std::string answer;
  return std::getline(std::cin, answer) && answer == "yes";
}

namespace {

int Run(int argc, char** argv) {
  config::Flags program("Operate uplinkd and look into it", "uplinkctl", config::VersionText());
  program.Example("uplinkctl config check /etc/uplinkd/uplinkd.toml");
  program.Example("uplinkctl store forget --help");
  AddPki(program);
  AddConfig(program);
  AddStore(program);
  AddHealth(program);
  AddDoctor(program);
  return program.Parse(argc, argv).value_or(kExitWrongUse);
}

}  // namespace
}  // namespace uplink::ctl

int main(int argc, char** argv) { return uplink::ctl::Run(argc, argv); }
