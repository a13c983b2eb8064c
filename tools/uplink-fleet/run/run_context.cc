#include "tools/uplink-fleet/run/run_context.h"

#include <cstdio>
#include <random>

#include <fmt/core.h>

#include "schema/base/utf8.h"

namespace uplink::synthetic {

std::string RandomRun() {
  std::random_device random;
  return fmt::format("{:08x}", random());
}

int CannotRun(const absl::Status& status) {
  fmt::print(stderr, "uplink-fleet: {}\n",
             PrintableUtf8(std::string(status.message()), std::string::npos));
  return kExitFailed;
}

int Concluded(const std::string& report, const std::vector<CheckRow>& rows) {
  std::fputs(report.c_str(), stdout);
  return AllOk(rows) ? kExitDone : kExitMismatch;
}

}  // namespace uplink::synthetic
