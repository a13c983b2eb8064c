#pragma once

#include <cstdint>
#include <memory>

#include <absl/status/status.h>

#include "server/forward/forwards.h"
#include "server/forward/rounds.h"
#include "tests/simulation/forward_fault.h"
#include "tests/simulation/random.h"
#include "tests/support/fake_trust.h"

namespace uplink::simulation {

/// What forwarding gets in a simulation.
struct ForwardSetup {
  /// Null: nothing is forwarded.
  storage::SharedItems* items = nullptr;
  forward::ReceiverLimits receivers;
  /// Of the numbers of commands.
  std::uint64_t seed = 0;
  ForwardFault fault = ForwardFault::kNone;
};

/// The real forwarding of one life of the server process; a round is a step of the schedule.
class SimForwards final : public session::ForwardSource {
 public:
  /// `setup.items` is not null, and outlives it.
  SimForwards(const Clock& clock, const ForwardSetup& setup);

  [[nodiscard]] std::unique_ptr<session::ForwardReceiver> Join(const model::RobotId& robot,
                                                               loop::StreamRef stream) override;
  absl::Status Round() { return rounds_.Round(); }
  [[nodiscard]] forward::Forwards::Sum sum() const { return forwards_.sum(); }

 private:
  const ForwardFault fault_;
  Random random_;
  const testing::FakeTrust clock_trust_;
  const log::Logger logger_;
  forward::Forwards forwards_;
  forward::ForwardProbe probe_;
  forward::Rounds rounds_;
};

}  // namespace uplink::simulation
