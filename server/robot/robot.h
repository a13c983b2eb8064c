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
#include "server/robot/calls.h"
#include "server/robot/commit_client.h"
#include "server/robot/durable_flow.h"
#include "server/robot/rates.h"
#include "server/robot/robot_sessions.h"
#include "server/robot/robot_state.h"
#include "server/robot/throttle.h"
#include "storage/identity.h"
#include "storage/open_stream.h"

namespace uplink::robot {

/// Told of each change of a robot's presence, a robot's in order. Called on any thread, under a
/// lock of the robot: short, and never back into the fleet.
using PresenceChanged =
    std::function<void(const storage::RobotRef& robot, Presence presence, SystemTime at)>;

/// One robot that this process knows. Shared: whoever keeps it beyond one look keeps it alive. Its
/// parts are thread-safe. As a CommitClient it passes on what the journal tells: to its sessions,
/// and to its state what is news of its holder. What waits of its calls has a client of its own
/// (ClaimClient).
class Robot final : public CommitClient {
 public:
  /// `changed` outlives the robot.
  Robot(storage::RobotRef id, SteadyTime server_started, const Clock& clock,
        const PresenceChanged& changed);

  /// Identity now. The fleet part may change when the robot gets a certificate of another fleet.
  [[nodiscard]] storage::RobotRef id() const;
  void SetFleet(std::string_view fleet);
  /// The same, unless it is in another fleet than `from` by now.
  void MoveFleet(std::string_view from, std::string_view to);
  /// The store has it in fleet `actual`, and the word for `claimed` moves nothing: what was said of
  /// it here meanwhile counts no more, unless this process holds it.
  void Disown(std::string_view claimed, std::string_view actual);
  [[nodiscard]] const std::string& ruri() const { return ruri_; }
  /// By which way its messages come: its RURI says so.
  [[nodiscard]] model::MessageSource source() const { return sessions.source(); }

  /// A stream of it begins: by this gateway's certificate, or by its own if that is empty. What it
  /// holds from now on, whether it has a stream or not, is what that certificate brought.
  void SetSpeaker(std::string_view gateway);
  /// That of its last stream, which may have ended. Nothing if none came in this life of the
  /// server: who brought what was restored is not known.
  [[nodiscard]] std::optional<std::string> speaker() const;

  // --- Leaving memory ---

  /// When a stream of it came or ended last, or what the store says of an earlier life.
  [[nodiscard]] SystemTime heard_at() const { return FromUnixMs(heard_at_ms_.load()); }
  /// Never goes back.
  void NoteHeard(SystemTime at);
  /// It has a stream, or its calls are served.
  [[nodiscard]] bool speaks() const { return HasStream() || calls.open(); }
  /// It does not speak, and nothing of it waits for the store.
  [[nodiscard]] bool idle() const { return !speaks() && sessions.in_flight() == 0; }
  enum class LeaveWhen : std::uint8_t {
    /// Once it is not online any more.
    kNotOnline,
    kAtOnce,
  };
  /// What of it waits for the store: of its streams and of its calls.
  [[nodiscard]] JournalUse journal_use() const { return sessions.journal_use() + calls.waiting(); }
  /// It is to leave memory once the journal has let go of it. False if that was asked before.
  bool BeginLeaving(LeaveWhen when = LeaveWhen::kNotOnline);
  /// It stays after all. False if it was not leaving.
  bool Stay();
  [[nodiscard]] bool leaving() const { return leaving_.load() != Leaving::kNo; }
  /// The journal knows it no more.
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
  /// Of its stream alone.
  /// Of malformed messages, and of those over their rate.
  Throttle throttle;
  Throttle limited_throttle;

 private:
  enum class Leaving : std::uint8_t { kNo, kAsked, kLeft };

  const Clock& clock_;
  const std::string ruri_;
  std::atomic<std::int64_t> heard_at_ms_{0};
  std::atomic<Leaving> leaving_{Leaving::kNo};
  std::atomic<bool> leaves_at_once_{false};
  mutable std::mutex mutex_;
  storage::RobotRef id_;
  std::optional<std::string> speaker_;
};

}  // namespace uplink::robot
