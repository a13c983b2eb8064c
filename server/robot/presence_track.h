#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "schema/base/clock.h"
#include "server/robot/presence.h"
#include "storage/adopt.h"
#include "storage/presence.h"

namespace uplink::robot {

/// The facts on which a robot's presence depends, and what PresenceOf said of them last. Confined
/// to its owner's lock.
class PresenceTrack final {
 public:
  /// Told of each change, in order, under the owner's lock: it must be short and take no lock that
  /// is held while the owner is asked.
  using Changed = std::function<void(Presence presence, SystemTime at)>;

  /// `known_since` and `system_now` are the same moment.
  PresenceTrack(SteadyTime server_started, SteadyTime known_since, SystemTime system_now,
                Changed changed)
      : server_started_(server_started),
        known_since_(known_since),
        changed_(std::move(changed)),
        since_(system_now) {}

  /// The relay listens from now on: until then no robot could be heard, and none counts as silent.
  void BeginListening(SteadyTime now);

  /// What a sign of life was beside those before it.
  enum class Sign : std::uint8_t { kLatest, kOlder };
  /// A sign of life that arrived at this time. It may have waited since: presence is judged at the
  /// latest time that any call named.
  Sign AddSign(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  /// The server stopped (true) or began again to read the robot's stream.
  enum class Reading : std::uint8_t { kHeldBack, kFlowing };
  void SetReading(Reading reading, SteadyTime now);
  /// The server itself stood still or was behind with reading until this time, or makes a stream of
  /// the robot wait until then: what it does not hear meanwhile proves nothing. Who was offline
  /// before stays so until it is heard; then the same holds of it.
  void AddStall(SteadyTime until);
  /// The store was replaced by one that may lack the last commits: other processes may hear the
  /// robot until `until`, and have heard it since `doubted`. As AddStall; and a robot that became
  /// offline here since then is unknown again, until it is heard or a timeout after `until` ends.
  struct Replaced {
    SteadyTime doubted;
    SteadyTime until;
    SystemTime system_now;
  };
  void NoteReplaced(const Replaced& replaced);
  /// A stream of the robot begins here. What the robot said before, another process may have heard.
  void BeginStream(SteadyTime now) { stream_began_ = now; }
  /// Other processes may hear the robot and cannot tell, and it has a stream here. It is offline
  /// only if it said nothing on that stream for a timeout, and the stream's peer answered a ping
  /// after that; until then it is unknown, and a timeout longer. True if the peer is to be asked
  /// now.
  bool AskBeforeOffline(SteadyTime now, const PresenceLimits& limits);
  /// The peer of the robot's stream answered a ping.
  void NotePeerAnswered(SteadyTime now, const PresenceLimits& limits);
  /// What was heard here counts no more: a robot that was online is unknown until it is heard
  /// again, and at most until `unknown_until`.
  void ForgetSigns(SteadyTime unknown_until, SystemTime system_now);
  /// Brings presence up to date and returns it.
  Presence Sweep(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  /// What an earlier life of the server heard; it changes no presence.
  void Restore(std::optional<SystemTime> last_sign);

  // --- Who judges ---

  /// A stream of the robot is here, and another process judged it last. What was heard here in time
  /// stands, and a robot that the other heard to the last is online for a timeout from now. Else
  /// the presence is what the other wrote, and no change: what was told here never reached the
  /// store, and may be older than that.
  void Claim(const storage::StoredPresence& stored, SteadyTime now);
  /// The robot's holder was over, and it is ours. What was heard here in time stands. Else a robot
  /// that was offline stays so until it is heard, as the holder wrote it. Every other robot is
  /// unknown until it is heard, and at most until `unknown_until`. If the holder only fell silent,
  /// it may have heard since who was offline, and could not write that: such a robot is shown as
  /// unknown for as long, and is then offline as before. None of that is told as a change.
  struct Adoption {
    storage::StoredPresence stored;
    storage::HolderEnd end = storage::HolderEnd::kEnded;
    SteadyTime unknown_until;
    SteadyTime now;
    SystemTime system_now;
  };
  void Adopt(const Adoption& adoption);
  /// Another process judges the robot, and wrote this. What was heard here counts again only if the
  /// robot is claimed or adopted in time; what is told until then changes nothing.
  void Follow(const storage::StoredPresence& stored);

  [[nodiscard]] Presence presence() const { return presence_; }
  [[nodiscard]] SystemTime since() const { return since_; }
  [[nodiscard]] std::optional<SystemTime> last_sign() const { return last_sign_system_; }
  /// The robot's own stream is not read now; or when that ended.
  [[nodiscard]] bool held_back() const { return held_back_; }
  [[nodiscard]] std::optional<SteadyTime> stream_held_back_until() const {
    return stream_held_back_until_;
  }

 private:
  void Reach(SteadyTime steady, SystemTime system);
  void Update(const PresenceLimits& limits);
  void Show(Presence presence, SystemTime since);
  /// Shows and tells it.
  void Change(Presence presence, SystemTime at);
  /// But for silence that needs an answer of the peer.
  [[nodiscard]] PresenceFacts Facts() const;
  /// From when on an answer of the stream's peer shows that the robot itself is silent.
  [[nodiscard]] SteadyTime AnswerCountsFrom(const PresenceLimits& limits) const;
  /// A sign of life came here, and not too long ago.
  [[nodiscard]] bool HeardInTime(SteadyTime now) const;
  /// The store has `stored`, and what was heard here in time stands: the robot is online.
  void GoOnFrom(const storage::StoredPresence& stored);
  /// The store has `stored`, and nothing was heard here.
  void BeginFrom(const storage::StoredPresence& stored);

  SteadyTime server_started_;
  SteadyTime known_since_;
  const Changed changed_;
  Presence presence_ = Presence::kUnknown;
  SystemTime since_;
  /// The latest time that a call named.
  std::optional<SteadyTime> reached_;
  SystemTime reached_system_;
  std::optional<SteadyTime> last_sign_;
  std::optional<SystemTime> last_sign_system_;
  /// When this process last judged it offline.
  std::optional<SteadyTime> judged_offline_;
  /// Means nothing without a last sign.
  SteadyTime online_until_;
  bool held_back_ = false;
  /// Also until when the server itself stood still, was behind, or makes a stream wait: the latest.
  std::optional<SteadyTime> held_back_until_;
  std::optional<SteadyTime> stream_held_back_until_;
  /// The same as held_back_until_, of a robot that is offline and was not heard since.
  std::optional<SteadyTime> stall_while_offline_;
  /// When the robot's present or last stream began, when its peer answered last, and until when the
  /// robot's silence had no such answer.
  std::optional<SteadyTime> stream_began_;
  std::optional<SteadyTime> peer_answered_;
  std::optional<SteadyTime> unanswered_until_;
  std::optional<PresenceFacts::Claimed> claimed_;
  std::optional<SteadyTime> unknown_until_;
  /// Unknown is in place of offline since then, as the store has it, until the robot is heard.
  std::optional<SystemTime> offline_since_;
  /// Another process judges it.
  bool foreign_ = false;
};

}  // namespace uplink::robot
