#pragma once

#include <cstdint>

#include "metrics/exposition.h"
#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/fleet/fleet.h"
#include "server/ingest/allowances.h"
#include "server/journal/shards.h"
#include "server/robot/connection_reports.h"
#include "server/transport/methods.h"
#include "server/uncrew/drones.h"
#include "server/uncrew/probe.h"

namespace uplink::run {

/// The part of the server that drones call. Without uncrew.avatar it serves nothing.
///
/// Thread: main; what says so from any.
class UncrewSide final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    const config::Config& config;
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    metrics::LedgerBook& ledgers;
    const ingest::Allowances& allowances;
    /// For drones' sessions.
    std::uint64_t seed = 0;
    robot::ConnectionReports& reports;
  };
  explicit UncrewSide(const Context& context);

  /// What drones may call, for the listener; empty if nothing.
  [[nodiscard]] transport::MethodsMaker Methods();
  /// Lets go of drones that are silent. Call it repeatedly.
  void Round() { drones_.Round(); }

  // --- Any thread ---

  [[nodiscard]] const uncrew::Drones& drones() const { return drones_; }
  /// None if drones may call nothing.
  void AddSamples(metrics::Exposition& page) const;

 private:
  const Context context_;
  uncrew::AvatarProbe probe_;
  uncrew::Drones drones_;
};

}  // namespace uplink::run
