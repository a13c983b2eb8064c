#include "tools/uplinkctl/question.h"

#include <cstdio>
#include <iostream>
#include <string>

#include <fmt/core.h>

namespace uplink::ctl {

bool SaysYes(std::string_view question) {
  fmt::print("{} yes/no: ", question);
  static_cast<void>(std::fflush(stdout));
  std::string answer;
  return std::getline(std::cin, answer) && answer == "yes";
}

}  // namespace uplink::ctl
