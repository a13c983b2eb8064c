// uplink-fleet: synthetic robots, twins and drones, and the comparison of what they sent with what
// the server has.
#include <csignal>

#include <sys/resource.h>
#include <unistd.h>

#include "tools/terminal/terminal.h"
#include "tools/uplink-fleet/flags.h"
#ifdef UPLINK_WITH_GRPC
#include "tools/uplink-fleet/run/drone_run.h"
#endif
#include "tools/uplink-fleet/run/run.h"
#include "tools/uplink-fleet/run/twin_run.h"

namespace {

/// A connection is a descriptor: as many as this user may have.
void RaiseDescriptorLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace

int main(int argc, char** argv) {
  RaiseDescriptorLimit();
  // A server that closes a connection is no end of the fleet.
  std::signal(SIGPIPE, SIG_IGN);
  int code = uplink::synthetic::kExitDone;
  auto options = uplink::synthetic::ReadFlags(argc, argv, code);
  if (!options) return code;
  options->output = uplink::TerminalOf(STDOUT_FILENO, environ);
  options->errors = uplink::TerminalOf(STDERR_FILENO, environ);
  if (options->twins) {
    uplink::synthetic::TwinRun run(*options);
    return run.Main();
  }
#ifdef UPLINK_WITH_GRPC
  if (options->drones) {
    uplink::synthetic::DroneRun run(*options);
    return run.Main();
  }
#endif
  uplink::synthetic::Run run(*options);
  return run.Main();
}
