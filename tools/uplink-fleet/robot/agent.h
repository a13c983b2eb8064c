#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/robot/account.h"
#include "tools/uplink-fleet/robot/agent_model.h"
#include "tools/uplink-fleet/robot/forward_table.h"
#include "tools/uplink-fleet/robot/histogram.h"
#include "tools/uplink-fleet/robot/script.h"
#include "tools/uplink-fleet/robot/shared.h"

namespace uplink::synthetic {

/// What a robot in a flood has on its way: enough for 16 frames of 64.
inline constexpr std::size_t kFloodAhead = 1024;

/// One robot without its connection: its script feeds its model, and what the model learns goes
/// into the account. The connection (robot.h) moves the frames.
///
/// Thread: confined to the robot's thread; `shared` is the whole run's.
class Agent final {
 public:
  /// `phase` is the first; `latencies` outlives the agent and is of the same thread.
  Agent(const Phase& phase, std::size_t index, const model::SessionId& session, Shared& shared,
        Latencies& latencies);

  /// The robot's RURI (RobotScript::Name).
  void Name(std::string ruri) { script_.Name(std::move(ruri)); }
  /// The robot takes what others share, as `reader` reads it, which outlives the agent and is of
  /// the same thread; without it declines that.
  void Receive(const std::string& ruri, ForwardReader& reader);
  /// It joins a fleet that is at work.
  void JoinLate() { late_ = true; }
  /// Goes on as this phase says.
  void Adopt(const Phase& phase);
  /// Lives `age` without a connection, up to `now`, tick by tick: live messages give way to newer
  /// ones, durable ones are kept.
  void LiveOffline(milliseconds age, SteadyTime::duration tick, SystemTime now);
  /// The run begins: waits count from `start`, since what was kept could not be sent before.
  void Begin(SteadyTime start) { model_.DueAt(start); }
  /// Makes the messages of the tick that was due at `due`, as the stage asks.
  void Tick(SteadyTime due, SystemTime system_now);
  /// In a flood: makes motion messages until kFloodAhead have no Ack.
  void Fill(SteadyTime now, SystemTime system_now);
  /// The next frame to send; none if nothing is due.
  [[nodiscard]] std::optional<v1::RelayRequest> NextFrame(SteadyTime now, SystemTime system_now);
  [[nodiscard]] v1::RelayRequest BeginStream();
  [[nodiscard]] absl::Status OnFrame(const v1::RelayResponse& frame, SteadyTime now);
  void EndStream() { model_.EndStream(); }
  /// The last frame: the robot is parked until then.
  [[nodiscard]] v1::RelayRequest SayGoodbye(std::int64_t expected_back_ms);
  /// The stream ended OK after our half-close.
  void OnEndedOk();

  /// Everything is settled and the stage says to close.
  [[nodiscard]] bool may_close() const;
  [[nodiscard]] bool ended_ok() const { return ended_ok_; }
  [[nodiscard]] bool welcomed() const { return model_.welcomed(); }
  [[nodiscard]] RobotOutcome TakeOutcome(const std::string& ruri);

 private:
  void Offer(Outgoing message, SteadyTime due);
  /// What the script makes in one tick, within the room that is left.
  [[nodiscard]] std::vector<Outgoing> LifeAt(std::int64_t now_ms);
  void NoteGaveWay(SteadyTime now);
  /// Room is left for what the script makes in one tick.
  [[nodiscard]] bool HasRoom() const;
  void TakeForward(const v1::Forward& forward, SteadyTime now);
  void ShowForwards();

  RobotScript script_;
  AgentModel model_;
  Account account_;
  Shared& shared_;
  Latencies& latencies_;
  std::size_t batch_;
  bool flood_;
  std::optional<SteadyTime> waiting_since_;
  SteadyTime next_idle_motion_{};
  std::string mark_;
  std::optional<SteadyTime> last_sent_;
  std::uint64_t silences_ = 0;
  /// Rounds of kLast that were begun, and settled.
  std::size_t last_offered_ = 0;
  bool reported_settled_ = false;
  bool only_moves_ = false;
  /// Of the last round of kLast.
  Outgoing last_motion_;
  std::size_t reported_last_ = 0;
  bool ended_ok_ = false;
  /// 0: it said no Goodbye.
  std::int64_t parked_until_ms_ = 0;
  /// None: the robot declines what others share.
  std::optional<ForwardTable> table_;
  bool late_ = false;
  /// When the stream was welcomed whose first snapshot is not whole.
  std::optional<SteadyTime> snapshot_since_;
  /// Which time of asking for the table was answered.
  std::size_t shown_ = 0;
};

}  // namespace uplink::synthetic
