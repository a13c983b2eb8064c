#include <cstddef>
#include <cstdio>
#include <iostream>
#include <span>
#include <string>
#include <string_view>

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

/// What the first arguments name wrongly: the library would say that a noun or a verb is missing.
std::string WrongName(const config::Flags& program, std::span<char* const> arguments) {
  if (arguments.empty() || arguments[0][0] == '-') return {};
  const std::string noun = arguments[0];
  const config::Flags* const verbs = program.Command(noun);
  if (verbs == nullptr) return "no such noun: " + noun + " (uplinkctl --help names them)";
  if (arguments.size() < 2 || arguments[1][0] == '-') return {};
  const std::string verb = arguments[1];
  if (verbs->Command(verb) != nullptr) return {};
  return noun + " has no verb " + verb + " (uplinkctl " + noun + " --help names them)";
}

int Run(int argc, char** argv) {
  config::Flags program("Operate uplinkd and look into it", "uplinkctl", UPLINK_VERSION);
  AddPki(program);
  AddConfig(program);
  AddStore(program);
  const std::span<char* const> arguments(argv, static_cast<std::size_t>(argc));
  if (const std::string wrong = WrongName(program, arguments.subspan(1)); !wrong.empty()) {
    fmt::print(stderr, "uplinkctl: {}\n", wrong);
    return kExitWrongUse;
  }
  return program.Parse(argc, argv).value_or(kExitWrongUse);
}

}  // namespace
}  // namespace uplink::ctl

int main(int argc, char** argv) { return uplink::ctl::Run(argc, argv); }
