#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "schema/base/clock.h"
#include "server/robot/flaps.h"
#include "server/robot/parking.h"
#include "server/robot/presence.h"
#include "storage/adopt.h"
#include "storage/presence.h"

namespace uplink::robot {

/// The facts on which a robot's presence depends, and its last presence. Confined to its owner's
/// lock.
class PresenceTrack final {
 public:
  /// Called for each change of presence, and of until when the robot is parked, in order, under the
  /// owner's lock. It must be short, and take no lock that is held while the owner is called.
  using Changed = std::function<void(const storage::StoredPresence& now)>;

  /// `known_since` and `system_now` are the same moment.
  PresenceTrack(SteadyTime server_started, SteadyTime known_since, SystemTime system_now,
                Changed changed)
      : server_started_(server_started),
        known_since_(known_since),
        changed_(std::move(changed)),
        since_(system_now) {}

  /// The relay listens from now on; before, no robot could be heard, so none counts as silent.
  void BeginListening(SteadyTime now);

  /// Whether a sign of life is later than those before it.
  enum class Sign : std::uint8_t { kLatest, kOlder };
  /// A sign of life that arrived at this time, and may have waited since: presence is judged at the
  /// latest time that any call named.
  Sign AddSign(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  /// The server stopped or resumed reading the robot's stream.
  enum class Reading : std::uint8_t { kHeldBack, kFlowing };
  void SetReading(Reading reading, SteadyTime now);
  /// Until this time the server stood still, was behind with reading, or makes a stream of the
  /// robot wait: silence until then proves nothing. A robot that was offline stays so until it is
  /// heard; then the same holds for it.
  void AddStall(SteadyTime until);
  /// The store was replaced by one that may have lost commits: other processes may hear the robot
  /// until `until`, and may have heard it since `doubted`. As AddStall; in addition a robot that
  /// became offline here since then is unknown again, until it is heard or a timeout after `until`
  /// ends.
  struct Replaced {
    SteadyTime doubted;
    SteadyTime until;
    SystemTime system_now;
  };
  void NoteReplaced(const Replaced& replaced);
  /// A stream of the robot begins here. Another process may have heard what the robot said before.
  void BeginStream(SteadyTime now) { stream_began_ = now; }
  /// Other processes may hear the robot without our knowledge, and it has a stream here. It becomes
  /// offline only if it was silent on that stream for a timeout and the stream's peer answered a
  /// ping after that. Until then, and for a timeout longer, it is unknown. True if the peer must be
  /// asked now.
  bool AskBeforeOffline(SteadyTime now, const PresenceLimits& limits);
  /// The peer of the robot's stream answered a ping.
  void NotePeerAnswered(SteadyTime now, const PresenceLimits& limits);
  /// Earlier signs of life no longer count: a robot that was online is unknown until it is heard
  /// again, and at most until `unknown_until`.
  void ForgetSigns(SteadyTime unknown_until, SystemTime system_now);
  /// The robot says that it leaves until `until`; signs of life before `signs_count_from` were on
  /// their way (Parking::Begin).
  void Park(SystemTime until, SteadyTime signs_count_from, SteadyTime now);
  /// As Parking::EndStream.
  void EndParkingStream(SteadyTime now) { parking_.EndStream(now); }
  /// Until when it is parked, and whether it comes and goes. Holds for a robot that another process
  /// judges, too.
  void SweepAround(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  /// Updates presence and returns it.
  Presence Sweep(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  /// The last sign of life before the server's start; changes no presence.
  void Restore(std::optional<SystemTime> last_sign);

  // --- Who judges ---

  /// A stream of the robot is here, and another process last judged the robot. Recent signs of life
  /// here stay valid, and a robot that the other heard to the last is online for a timeout from
  /// now. Otherwise the presence is what the other wrote, without a change: changes here never
  /// reached the store, and may be older.
  void Claim(const storage::StoredPresence& stored, SteadyTime now);
  /// The robot's holder was over, and the robot is ours. Recent signs of life here stay valid.
  /// Otherwise a robot that was offline stays so until it is heard, as the holder wrote it; any
  /// other robot is unknown until it is heard, and at most until `unknown_until`. If the holder
  /// only fell silent, it may have heard offline robots without writing that: they are shown as
  /// unknown for as long, and are then offline as before. None of this counts as a change.
  struct Adoption {
    storage::StoredPresence stored;
    storage::HolderEnd end = storage::HolderEnd::kEnded;
    SteadyTime unknown_until;
    SteadyTime now;
    SystemTime system_now;
  };
  void Adopt(const Adoption& adoption);
  /// Another process judges the robot, and wrote this. Earlier signs of life here count again only
  /// if the robot is claimed or adopted in time; calls until then change nothing.
  void Follow(const storage::StoredPresence& stored);

  [[nodiscard]] Presence presence() const { return presence_; }
  [[nodiscard]] SystemTime since() const { return since_; }
  /// Empty: it is not parked. As of the last call of SweepAround.
  [[nodiscard]] std::optional<SystemTime> parked_until() const { return parking_.until(); }
  [[nodiscard]] bool flapping() const { return flaps_.flapping(); }
  /// What a store that follows has of it.
  [[nodiscard]] storage::StoredPresence now() const {
    return {presence_, since_, parking_.until()};
  }
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
  void Tell() const;
  /// Takes over until when it is parked, unless its present stream here has said or shown more.
  /// Call it before signs of life here are forgotten.
  void FollowParking(const storage::StoredPresence& stored);
  /// Shows and tells it.
  void Change(Presence presence, SystemTime at);
  /// The facts, without silence that needs an answer of the peer.
  [[nodiscard]] PresenceFacts Facts() const;
  /// From when an answer of the stream's peer shows that the robot itself is silent.
  [[nodiscard]] SteadyTime AnswerCountsFrom(const PresenceLimits& limits) const;
  /// A recent sign of life came here.
  [[nodiscard]] bool HeardInTime(SteadyTime now) const;
  /// The store has `stored`, and a recent sign of life came here: the robot is online.
  void GoOnFrom(const storage::StoredPresence& stored);
  /// The store has `stored`, and no recent sign of life came here.
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
  /// Meaningless without a last sign.
  SteadyTime online_until_;
  bool held_back_ = false;
  /// The latest end of holding back, of a stall of the server, or of a stream's wait.
  std::optional<SteadyTime> held_back_until_;
  std::optional<SteadyTime> stream_held_back_until_;
  /// As held_back_until_, for a robot that is offline and was not heard since.
  std::optional<SteadyTime> stall_while_offline_;
  /// When the robot's current or last stream began, when its peer last answered, and until when the
  /// robot's silence had no such answer.
  std::optional<SteadyTime> stream_began_;
  std::optional<SteadyTime> peer_answered_;
  std::optional<SteadyTime> unanswered_until_;
  std::optional<PresenceFacts::Claimed> claimed_;
  std::optional<SteadyTime> unknown_until_;
  /// Since when unknown stands for the offline that the store has, until the robot is heard.
  std::optional<SystemTime> offline_since_;
  Parking parking_;
  /// When this process last learned from the robot itself that it leaves.
  std::optional<SteadyTime> parking_said_;
  Flaps flaps_;
  /// Another process judges it.
  bool foreign_ = false;
};

}  // namespace uplink::robot
