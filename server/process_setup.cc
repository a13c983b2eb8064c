#include "server/process_setup.h"

#include <csignal>

#include <google/protobuf/stubs/logging.h>

#include "server/health/process.h"

namespace uplink {

std::size_t SetUpProcess() {
  // Protobuf prints a line for each text of a frame that is not UTF-8: any peer could fill the log.
  google::protobuf::SetLogHandler(nullptr);
  // A peer or a log reader that went away is an error of a write, not the end of the process.
  std::signal(SIGPIPE, SIG_IGN);
  // A limit on the size of files is an error of the write, as a full disk is.
  std::signal(SIGXFSZ, SIG_IGN);
  // A reload while the server starts is none: the configuration was just read.
  std::signal(SIGHUP, SIG_IGN);
  return health::RaiseDescriptorsMax();
}

}  // namespace uplink
