#include "server/process_setup.h"

#include <csignal>

#include <absl/synchronization/mutex.h>

#include "server/health/process.h"
#include "server/relay/environment.h"
#include "server/relay/grpc_log.h"

namespace uplink {

std::size_t SetUpProcess(const config::Config& config) {
  relay::ApplyTlsMinimum(config.tls.min_version);
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  relay::SilenceProtobuf();
  // A peer or a log reader that went away is an error of a write, not the end of the process.
  std::signal(SIGPIPE, SIG_IGN);
  // A limit on the size of files is an error of the write, as a full disk is.
  std::signal(SIGXFSZ, SIG_IGN);
  // A reload while the server starts is none: the configuration was just read.
  std::signal(SIGHUP, SIG_IGN);
  return health::RaiseDescriptorsMax();
}

}  // namespace uplink
