#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <sys/types.h>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/report/process_use.h"
#include "tools/uplink-fleet/report/run_figures.h"
#include "tools/uplink-fleet/robot/shared.h"

namespace uplink::synthetic {

/// What server and fleet use while the robots live, from Begin to End.
///
/// Thread: confined to main's thread.
class Measurement final {
 public:
  /// Finds the server's process, if it listens at `target` (HOST:PORT) on this machine. `shared`
  /// and `clock` must outlive this.
  Measurement(const std::string& target, const Clock& clock, const Shared& shared);

  void Begin();
  /// Writes what was used since Begin.
  void End(RunFigures& figures) const;

 private:
  const Clock& clock_;
  const Shared& shared_;
  const std::optional<pid_t> server_;
  std::optional<ProcessUse> server_before_;
  ProcessUse own_before_;
  std::uint64_t sent_before_ = 0;
  SteadyTime began_{};
};

}  // namespace uplink::synthetic
