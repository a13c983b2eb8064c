#include "tools/uplinkctl/command.h"

#include <cstdio>
#include <iostream>
#include <string>

#include <fmt/core.h>

#include "tools/uplinkctl/show/one_line.h"

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

}  // namespace uplink::ctl
