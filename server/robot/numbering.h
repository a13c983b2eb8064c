#pragma once

#include <cstddef>
#include <cstdint>

#include "schema/model/ids.h"
#include "server/robot/ack_window.h"

namespace uplink::robot {

/// The meaning of a number for its session.
enum class SeenAs : std::uint8_t {
  kNew,
  /// At or below the highest number seen.
  kDuplicate,
  /// The session was forgotten because another process holds the robot. The stream must stop.
  kVoid,
};

/// The result of looking at one number. A value.
struct Seen {
  SeenAs as = SeenAs::kNew;
  /// First and last number skipped just before it; none if first is 0.
  model::Seq missing_first = 0;
  model::Seq missing_last = 0;
  /// How many of them count as missing: all, up to kMissingPerJumpMax.
  std::uint64_t missing = 0;
  /// For a duplicate: its first copy waits for a commit, whose Ack answers it too.
  bool waits = false;
};

/// The numbers of one session: those that were seen, wait for a commit, or never came. Confined to
/// its owner's lock.
class Numbering final {
 public:
  /// Looks at a number. The caller then adds a new one by AddSettled or AddWaiting, and the gap
  /// before it by AddMissing; or looks at it again later.
  [[nodiscard]] Seen See(model::Seq seq) const;
  void AddMissing(std::uint64_t numbers) { missing_ += numbers; }
  /// A new number that was settled at once.
  void AddSettled(model::Seq seq) { window_.AddSettled(seq); }
  /// A new number that waits for its commit. Returns by how much waiting() grew.
  [[nodiscard]] std::size_t AddWaiting(model::Seq seq);
  /// The commit of the numbers from `first` to `last` is done. Returns by how much waiting()
  /// shrank: 0 if none of them waited.
  [[nodiscard]] std::size_t Settle(model::Seq first, model::Seq last);
  /// A stream resumes the session: the agent has seen everything settled up to `settled_seq` and
  /// judged up to `judged_seq`, the store up to `stored_seq`. Returns Welcome.committed_seq.
  [[nodiscard]] model::Seq Resume(model::Seq settled_seq, model::Seq judged_seq,
                                  model::Seq stored_seq);

  /// Highest number seen.
  [[nodiscard]] model::Seq seen() const { return window_.seen(); }
  /// The highest number with no waiting number at or below it: what an Ack may cover.
  [[nodiscard]] model::Seq through() const { return window_.through(); }
  /// Highest number judged, by this process or, as the agent told, by another.
  [[nodiscard]] model::Seq judged() const;
  /// How many numbers wait for their commit.
  [[nodiscard]] std::size_t waiting() const { return window_.waiting(); }
  [[nodiscard]] bool Waits(model::Seq seq) const { return window_.Waits(seq); }
  /// How many numbers never came; at most kMissingPerJumpMax of one jump.
  [[nodiscard]] std::uint64_t missing() const { return missing_; }

 private:
  AckWindow window_;
  /// Numbers up to this count as seen, only for counting missing ones.
  model::Seq missing_floor_ = 0;
  model::Seq hello_judged_ = 0;
  std::uint64_t missing_ = 0;
  /// True once a stream of this process has resumed it.
  bool known_ = false;
};

}  // namespace uplink::robot
