#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// Faults that are raised, reported once more while they last, and cleared, each change with its
/// event. `mark` and `source` part the reports of this run from those of others.
class Faults final {
 public:
  /// `rate_hz`: reports per second, on average.
  Faults(Seeded random, std::string mark, std::string source, double rate_hz);

  void SetRate(double rate_hz) { rate_hz_ = rate_hz; }
  void Advance(const Moment& moment, Facts& facts, Outbox& out);
  /// A report like the others, that no set follows: to be made wrong.
  [[nodiscard]] model::Fault Sample(const Moment& moment);

 private:
  void Change(const Moment& moment, Facts& facts, Outbox& out);
  [[nodiscard]] model::Fault Report(const Moment& moment, std::size_t kind, bool active);

  Seeded random_;
  std::string mark_;
  std::string source_;
  double rate_hz_;
  std::uint64_t reports_ = 0;
  std::set<std::size_t> active_;
};

}  // namespace uplink::synthetic
