#pragma once

#include <optional>
#include <string>

#include <sys/types.h>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/report/process_use.h"

namespace uplink::synthetic {

/// What was used in a while. A value.
struct Measured {
  double seconds = 0;
  /// None if the server runs elsewhere.
  std::optional<ProcessUse> server;
  ProcessUse own;
};

/// What server and fleet use from Begin on.
///
/// Thread: confined to main's thread.
class Measurement final {
 public:
  /// Finds the server's process, if it listens at `address` (HOST:PORT) on this machine. `clock`
  /// must outlive this.
  Measurement(const std::string& address, const Clock& clock);

  void Begin();
  [[nodiscard]] Measured SinceBegin() const;

 private:
  const Clock& clock_;
  const std::optional<pid_t> server_;
  std::optional<ProcessUse> server_before_;
  ProcessUse own_before_;
  SteadyTime began_{};
};

}  // namespace uplink::synthetic
