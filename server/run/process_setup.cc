#include "server/run/process_setup.h"

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include <google/protobuf/stubs/logging.h>

#include "schema/base/write_all.h"
#include "server/health/process.h"

namespace uplink::run {
namespace {

/// In place of the standard library's own, which blocks for ever if the reader of standard error
/// hangs.
[[noreturn]] void OnTerminate() {
  const char* why = "no exception";
  std::array<char, 512> words{};
  try {
    if (const std::exception_ptr exception = std::current_exception()) {
      why = "an exception that is none of std::exception";
      std::rethrow_exception(exception);
    }
  } catch (const std::exception& error) {
    static_cast<void>(
        std::snprintf(words.data(), words.size(), "uplinkd: terminated: %s\n", error.what()));
  } catch (...) {
  }
  if (words.front() == '\0') {
    static_cast<void>(std::snprintf(words.data(), words.size(), "uplinkd: terminated: %s\n", why));
  }
  SayLastWords(words.data());
  std::abort();
}

}  // namespace

std::size_t SetUpProcess() {
  std::set_terminate(OnTerminate);
  // Protobuf prints a line for each text of a frame that is not UTF-8: any peer could fill the log.
  google::protobuf::SetLogHandler(nullptr);
  // A peer or a log reader that went away is an error of a write, not the end of the process.
  std::signal(SIGPIPE, SIG_IGN);
  // A limit on the size of files is an error of the write, as a full disk is.
  std::signal(SIGXFSZ, SIG_IGN);
  // Until the event loop takes it: the configuration was just read.
  std::signal(SIGHUP, SIG_IGN);
  return health::RaiseDescriptorsMax();
}

}  // namespace uplink::run
