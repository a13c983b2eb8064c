#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/config/address.h"
#include "server/config/config.h"
#include "server/log/logger.h"

namespace uplink::run {

/// What a server that is ready says of itself. A value.
struct Ready {
  /// Without a password: a path, or host and database.
  std::string store;
  /// Robots that the store knows; not read yet while it is away.
  std::size_t robots = 0;
  bool robots_unread = false;
  /// As they were really bound.
  config::ListenAddress relay;
  config::ListenAddress http;
  /// Not set without listen.metrics.
  config::ListenAddress metrics;
  /// Not set without listen.fleet.
  config::ListenAddress fleet{};
};

/// What its certificate says. A value.
struct ShownCertificate {
  std::vector<std::string> hosts;
  SystemTime expiry{};
};

/// Hosts of a certificate that its line names; the line counts the others.
inline constexpr std::size_t kHostsShownMax = 3;

/// `localhost, 127.0.0.1; 364 days left, until 2027-11-28T15:08:44Z`. Pure.
[[nodiscard]] std::string CertificateText(const ShownCertificate& certificate, SystemTime now);

/// Lines below the first one: store, listeners, certificate, what to try next; a broker, drones and
/// the listener for metrics where the configuration has them. They hold no secret. Pure.
[[nodiscard]] std::vector<std::string> ReadyLines(const config::Config& config, const Ready& ready,
                                                  const std::string& certificate);

/// Tells a person at a terminal in a few lines that the server starts, or why it does not, in place
/// of the log's info events. Warnings are logged after the last of these lines, errors at once.
/// Unless standard error is a terminal and the log is text of level info, it tells nothing and
/// events are logged as ever.
///
/// Thread: main; End and TellStopped from any.
class Greeting final {
 public:
  /// The references outlive it.
  struct Context {
    log::Logger& logger;
    const config::Config& config;
    /// As --config names it.
    std::string config_file;
    const Clock& clock;
    /// Where the log goes: standard error, except in tests.
    int descriptor;
  };
  explicit Greeting(Context context);

  /// The first line, which names the store: it may not answer yet. No info event is logged from now
  /// on, and warnings wait.
  void Begin();
  /// The other lines, then the warnings.
  void TellReady(const Ready& ready);
  /// The start failed, and why; elsewhere it is the event start_failed.
  void TellFailed(const absl::Status& why);
  /// A signal ended the start; elsewhere it is the event stopped_while_starting.
  void TellStopped(int signal);
  /// The start is over: info events are logged again if the level, which may be another by now,
  /// lets them through.
  void End();

 private:
  const Context context_;
  const bool active_;
};

}  // namespace uplink::run
