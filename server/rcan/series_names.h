#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "schema/base/clock.h"
#include "server/limits/token_bucket.h"

namespace uplink::rcan {

/// Which series of one robot may be shown, of those that carry a word of its own (the name of a
/// joint, a computer, a key of extras). Each new one costs whoever stores the series memory for as
/// long as it keeps any, so a robot that names its joints anew at each scrape is to add few.
///
/// A name is a series with its label. The first `names_max` names of a robot are free: an honest
/// one is complete at its first scrape, and so again after it restarted or was away, since a name
/// is forgotten only for another one. Further names take the place of names that were not said for
/// `forget_after`, at most `new_per_hour` at once and per hour.
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
  /// The series of one label as bits: of a joint its position, its velocity and so on.
  using Set = std::uint8_t;
  static constexpr std::size_t kOfLabelMax = 8;

  /// What may be shown of a label.
  struct Answer {
    Set shown = 0;
    /// Of the rest: those for which no place is free. For others there were too many new ones.
    Set no_place = 0;
  };

  /// Before the first label of a scrape.
  void BeginScrape(SteadyTime now);
  /// `label` stands for one label of this robot, a number that another one does not have.
  [[nodiscard]] Answer Admit(std::uint64_t label, Set wanted, const Limits& limits);

  /// Names that are known now.
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
  /// Forgets the label that was said last before all others, if that is long ago.
  bool ForgetOne(milliseconds forget_after);
  [[nodiscard]] std::vector<Label>::iterator Find(std::uint64_t label);
  void Keep(std::uint64_t label, Set names, std::size_t names_max);

  /// By label.
  std::vector<Label> labels_;
  std::size_t names_ = 0;
  /// Names that were free so far.
  std::size_t free_taken_ = 0;
  limits::TokenBucket bucket_;
  /// Of this scrape and of the one before it.
  SteadyTime now_{};
  SteadyTime before_{};
  /// At this scrape all names were said too lately.
  bool none_to_forget_ = false;
};

}  // namespace uplink::rcan
