#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "schema/base/clock.h"
#include "server/limits/token_bucket.h"

namespace uplink::rcan {

/// Which series with a name of the robot's own (of a joint, a computer, a key of extras) may be
/// shown. Each new series costs the store of metrics memory for as long as it keeps any, so a robot
/// that renames its joints at each scrape must add only few.
///
/// A name is a series with its label. The first `names_max` names of a robot are free: an honest
/// one is complete at its first scrape, and again after it restarted or was away, since a name is
/// forgotten only for another one. Further names take the place of names that were not reported for
/// `forget_after`: at most `new_per_hour` at once, and per hour.
///
/// Limits:  names_max names, hashed, of 24 bytes per label; no allocation unless a name is new.
/// Thread:  confined to its owner.
class SeriesNames final {
 public:
  struct Limits {
    /// rcan.robot_series_max.
    std::size_t names_max = 0;
    /// rcan.robot_new_names_max.
    std::size_t new_per_hour = 0;
    /// rcan.series_ttl.
    milliseconds forget_after{0};
  };
  /// The series of one label as bits: a joint's position, its velocity and so on.
  using Set = std::uint8_t;
  static constexpr std::size_t kOfLabelMax = 8;

  /// What may be shown of a label.
  struct Answer {
    Set shown = 0;
    /// Those of the others that found no free place. The rest are too many new ones.
    Set no_place = 0;
  };

  /// Call it before the first label of a scrape.
  void BeginScrape(SteadyTime now);
  /// `label`: the hash of one label of this robot.
  [[nodiscard]] Answer Admit(std::uint64_t label, Set wanted, const Limits& limits);

  /// Known names.
  [[nodiscard]] std::size_t size() const { return names_; }

 private:
  struct Label {
    std::uint64_t label = 0;
    SteadyTime said_at;
    Set names = 0;
  };
  enum class Place : std::uint8_t { kTaken, kNone, kTooManyNew };

  [[nodiscard]] Answer AdmitNew(std::uint64_t label, Set wanted, Set fresh, const Limits& limits);
  [[nodiscard]] Place TakePlace(const Limits& limits);
  /// Forgets the label that was reported least recently, if that is long ago.
  bool ForgetOne(milliseconds forget_after);
  [[nodiscard]] std::vector<Label>::iterator Find(std::uint64_t label);
  void Keep(std::uint64_t label, Set names, std::size_t names_max);

  /// By label.
  std::vector<Label> labels_;
  std::size_t names_ = 0;
  /// Free names that were taken so far.
  std::size_t free_taken_ = 0;
  limits::TokenBucket bucket_;
  /// The times of this scrape and of the one before.
  SteadyTime now_{};
  SteadyTime before_{};
  /// At this scrape, all names were reported too lately to be forgotten.
  bool none_to_forget_ = false;
};

}  // namespace uplink::rcan
