#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/journal/journal.h"
#include "server/journal/turns.h"

namespace uplink::testing {

/// Robots' streams as sessions make them, without sessions: they come, are heard, and go. For one
/// thread.
class RobotStreams final {
 public:
  /// All of them must outlive this.
  RobotStreams(fleet::Fleet& fleet, journal::Journal& journal, const Clock& clock)
      : fleet_(fleet), journal_(journal), clock_(clock) {}

  /// A stream of the robot came, and it was heard; null if it was refused.
  fleet::RobotPtr Come(const std::string& ruri) {
    const auto robot = fleet_.FindOrAdmit({ruri, "f"});
    if (!robot.ok()) return nullptr;
    (*robot)->NoteHeard(clock_.System());
    static_cast<void>((*robot)->sessions.Attach(stream_, clock_.Steady(), clock_.System()));
    const auto begun = (*robot)->sessions.Begin(model::SessionId({1}), clock_.Steady());
    (*robot)->state.Claim(clock_.Steady());
    journal_.Open(
        **robot, begun->open_id,
        {.robot = (*robot)->id(), .session = model::SessionId({1}), .at = clock_.System()});
    Write();
    (*robot)->state.SignOfLife(clock_.Steady(), clock_.System(), fleet_.presence_limits());
    return *robot;
  }
  void Go(robot::Robot& robot) {
    robot.NoteHeard(clock_.System());
    robot.sessions.Detach(stream_, clock_.Steady());
    if (!robot.HasStream()) robot.state.EndClaim();
  }
  /// All that waits for the store.
  void Write() {
    while (journal_.turns().Advance() == journal::Step::kWorked) {
    }
  }

  [[nodiscard]] const loop::StreamRef& stream() const { return stream_; }
  /// How often a stream was woken since the last call.
  [[nodiscard]] int TakeWoken() { return std::exchange(inbox_.woken, 0); }

 private:
  struct Inbox final : loop::WakeInbox {
    void Wake(std::uint64_t /*stream*/) override { ++woken; }
    int woken = 0;
  };

  fleet::Fleet& fleet_;
  journal::Journal& journal_;
  const Clock& clock_;
  Inbox inbox_;
  const loop::StreamRef stream_{&inbox_, 1};
};

}  // namespace uplink::testing
