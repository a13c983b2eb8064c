#pragma once

#include <optional>
#include <utility>

#include "schema/model/ids.h"
#include "schema/model/rejection.h"
#include "storage/commit_record.h"

namespace uplink::session {

/// Consecutive limited numbers of a pass over messages, until they go to the journal as one range.
///
/// Bound: one range; as many numbers as a pass takes of what is costly (kCostlyPerTurn).
/// Thread: confined to the stream's thread.
class LimitedRun final {
 public:
  [[nodiscard]] bool empty() const { return !range_; }
  /// The last number of the range. It must not be empty.
  [[nodiscard]] model::Seq last() const { return last_; }
  /// The number goes on with the range at hand.
  [[nodiscard]] bool Precedes(model::Seq seq) const { return range_ && seq == last_ + 1; }
  /// Begins a range, or goes on with the one at hand. Where several kinds were limited, each by a
  /// rate of its own, the range names none of them.
  void Add(model::Seq seq, const model::Rejection& rejection) {
    if (!range_) {
      range_ = storage::LimitedRange{.first = seq, .rejection = rejection};
    } else if (range_->rejection != rejection) {
      range_->rejection.detail = "more than the rates of several kinds";
    }
    last_ = seq;
  }
  /// The range at hand, which must not be empty; the next number begins another.
  [[nodiscard]] storage::LimitedRange Take() { return *std::exchange(range_, std::nullopt); }

 private:
  std::optional<storage::LimitedRange> range_;
  model::Seq last_ = 0;
};

}  // namespace uplink::session
