#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"
#include "server/robot/agent_facts.h"
#include "server/robot/calls.h"
#include "server/robot/commit_client.h"
#include "server/robot/connection_lines.h"
#include "server/robot/durable_flow.h"
#include "server/robot/rates.h"
#include "server/robot/robot_sessions.h"
#include "server/robot/robot_state.h"
#include "server/robot/throttle.h"
#include "server/robot/traffic.h"
#include "storage/identity.h"
#include "storage/open_stream.h"

namespace uplink::robot {

/// Called for each change of a robot's presence, and of until when it is parked, in order for one
/// robot, on any thread, under a lock of the robot. It must be short, and never call back into the
/// fleet. `why`: as RobotState::PresenceChanged's.
using PresenceChanged =
    std::function<void(const storage::RobotRef& robot, const storage::StoredPresence& now,
                       std::optional<model::ConnectionEnd> why)>;

/// One robot that this process knows. Shared: a pointer keeps it alive beyond one look. Its parts
/// are thread-safe. As a CommitClient it passes the journal's calls to its sessions, and news of
/// its holder to its state. Records of its calls have a client of their own (ClaimClient).
class Robot final : public CommitClient {
 public:
  /// `changed` outlives the robot.
  Robot(storage::RobotRef id, SteadyTime server_started, const Clock& clock,
        const PresenceChanged& changed);

  /// Its identity now. The fleet changes when the robot gets a certificate of another fleet.
  [[nodiscard]] storage::RobotRef id() const;
  void SetFleet(std::string_view fleet);
  /// As SetFleet, unless it is no longer in fleet `from`.
  void MoveFleet(std::string_view from, std::string_view to);
  /// The store has it in fleet `actual`, and the claim of `claimed` does not move it. Unless this
  /// process holds it, its live state here is forgotten.
  void Disown(std::string_view claimed, std::string_view actual);
  [[nodiscard]] const std::string& ruri() const { return ruri_; }
  /// The source of its messages, by its RURI.
  [[nodiscard]] model::MessageSource source() const { return sessions.source(); }

  /// A stream of it begins, by this gateway's certificate, or by its own if empty. The live state
  /// from now on, also between streams, came by that certificate.
  void SetSpeaker(std::string_view gateway);
  /// The speaker of its last stream, which may have ended. Empty if none came since the server's
  /// start: who brought restored state is unknown.
  [[nodiscard]] std::optional<std::string> speaker() const;

  /// An operator blocked it: no message of it is taken. Fleet alone sets it.
  [[nodiscard]] bool blocked() const { return blocked_.load(); }
  void SetBlocked(bool blocked) { blocked_.store(blocked); }

  [[nodiscard]] Registration registration() const override { return registration_.load(); }
  /// Fleet alone sets it.
  void SetRegistration(Registration registration) { registration_.store(registration); }
  /// kRefused, if it is still unjudged.
  void RefuseUnjudged() {
    Registration unjudged = Registration::kUnjudged;
    registration_.compare_exchange_strong(unjudged, Registration::kRefused);
  }
  /// It is blocked, or refused: no message of it is taken.
  [[nodiscard]] bool kept_out() const {
    return blocked() || registration() == Registration::kRefused;
  }

  // --- Leaving memory ---

  /// When a stream of it last came or ended, also before the server's start.
  [[nodiscard]] SystemTime heard_at() const { return FromUnixMs(heard_at_ms_.load()); }
  /// Never goes back.
  void NoteHeard(SystemTime at);
  /// It has a stream, or its calls are served.
  [[nodiscard]] bool speaks() const { return HasStream() || calls.open(); }
  /// It does not speak, and no record of its streams waits for the store.
  [[nodiscard]] bool idle() const { return !speaks() && sessions.in_flight() == 0; }
  enum class LeaveWhen : std::uint8_t {
    /// Once it is not online any more.
    kNotOnline,
    kAtOnce,
  };
  /// The records that wait for the store, of its streams and its calls.
  [[nodiscard]] JournalUse journal_use() const { return sessions.journal_use() + calls.waiting(); }
  /// Begins to remove it from memory, once the journal has let go of it. False if that has begun
  /// before.
  bool BeginLeaving(LeaveWhen when = LeaveWhen::kNotOnline);
  /// Cancels that. False if it was not leaving.
  bool Stay();
  [[nodiscard]] bool leaving() const { return leaving_.load() != Leaving::kNo; }
  /// The journal has forgotten it.
  [[nodiscard]] bool left() const { return leaving_.load() == Leaving::kLeft; }

  // --- CommitClient ---

  void OnHeld(const HoldNews& news) override;
  void OnHeldElsewhere(const std::optional<storage::StoredPresence>& presence) override;
  [[nodiscard]] bool HasStream() const override { return sessions.HasStream(); }
  [[nodiscard]] bool MayLeave() const override;
  void OnLeft() override;
  loop::StreamRef OnOpened(std::uint64_t open_id, const storage::OpenResult& result) override {
    return sessions.OnOpened(open_id, result);
  }
  loop::StreamRef OnOtherFleet(std::uint64_t open_id, const std::string& fleet,
                               metrics::Ledger& ledger) override;
  loop::StreamRef OnSettled(std::span<const Settled> settled, metrics::Ledger& ledger) override {
    return sessions.OnSettled(settled, ledger);
  }
  loop::StreamRef OnGapsWritten(std::size_t count) override {
    return sessions.OnGapsWritten(count);
  }
  loop::StreamRef OnFenced(metrics::Ledger& ledger) override;
  loop::StreamRef OnRefused(metrics::Ledger& ledger) override;
  [[nodiscard]] std::vector<storage::CommittedSession> Committed() const override {
    return sessions.Committed();
  }
  loop::StreamRef OnWentBack(metrics::Ledger& ledger) override;
  [[nodiscard]] std::uint64_t generation() const override { return sessions.generation(); }

  RobotState state;
  RobotSessions sessions;
  Calls calls;
  DurableFlow flow;
  Rates rates;
  /// For its stream alone: one for malformed messages, one for messages over their rate.
  Throttle throttle;
  Throttle limited_throttle;
  ConnectionLines connection_lines;
  AgentFacts agent;
  Traffic traffic;

 private:
  enum class Leaving : std::uint8_t { kNo, kAsked, kLeft };

  const Clock& clock_;
  const std::string ruri_;
  std::atomic<std::int64_t> heard_at_ms_{0};
  std::atomic<Leaving> leaving_{Leaving::kNo};
  std::atomic<bool> leaves_at_once_{false};
  std::atomic<bool> blocked_{false};
  std::atomic<Registration> registration_{Registration::kFits};
  mutable std::mutex mutex_;
  storage::RobotRef id_;
  std::optional<std::string> speaker_;
};

}  // namespace uplink::robot
