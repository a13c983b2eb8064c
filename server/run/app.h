#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "server/config/config.h"
#include "server/config/load.h"
#include "storage/identity.h"

namespace uplink {
class BootClock;
}
namespace uplink::log {
class Logger;
}
namespace uplink::store {
class MarkedClock;
}

namespace uplink::run {

class EarlyServices;
class Greeting;

/// The server: constructs the components and connects them. The only place that knows them all;
/// start.h says in which order they start and stop.
///
/// Thread: main. Signals arrive on the thread `io`.
class App final {
 public:
  /// What main passes in; the references outlive the app.
  struct Options {
    config::Config config;
    /// Where it was read, and where its keys were set.
    std::string config_file;
    config::Places places;
    /// Reads the configuration again, for SIGHUP.
    std::function<config::LoadResult()> read_config;
    log::Logger& logger;
    /// The clock whose mark the store's clock rounds set.
    store::MarkedClock& clock;
    const BootClock& boot_clock;
    /// Whether the kernel calls its civil clock synchronised. Any thread.
    std::function<bool()> kernel_clock_synchronised;
    /// Drawn anew for each life of the process.
    storage::ProcessId process{};
    /// Evenly drawn numbers, for the backoff's jitter; called by one thread at a time.
    std::function<std::uint64_t()> random;
    std::string version;
    Greeting& greeting;
  };

  /// Answers probes, opens the store, reads the fleet, then serves robots and the rest of HTTP, and
  /// logs `listening` with the addresses that were really bound.
  ///
  /// Errors: of the store, the listeners and the certificate, each naming its file or address;
  ///         nothing is left running.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<App>> Start(Options options);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Serves until SIGTERM or SIGINT, or until a step of the store's schema shuts this program out,
  /// then drains (Drain). Returns the exit code: 0 after a signal, 1 after such a step. A second
  /// signal ends the process at once, with 1.
  [[nodiscard]] int Run();

 private:
  class Impl;
  App(std::unique_ptr<EarlyServices> early, std::unique_ptr<Impl> impl);
  /// Outlives the rest.
  std::unique_ptr<EarlyServices> early_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::run
