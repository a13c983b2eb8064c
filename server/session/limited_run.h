#pragma once

#include <optional>
#include <utility>

#include "schema/model/ids.h"
#include "schema/model/rejection.h"
#include "storage/commit_record.h"

namespace uplink::session {

/// Consecutive limited numbers of one pass, until they go to the journal as one range.
///
/// Bound: one range; as many numbers as a pass takes of costly messages (kCostlyPerTurn).
/// Thread: confined to the stream's thread.
class LimitedRun final {
 public:
  [[nodiscard]] bool empty() const { return !range_; }
  /// The last number of the range. It must not be empty.
  [[nodiscard]] model::Seq last() const { return last_; }
  /// Whether the number continues the current range.
  [[nodiscard]] bool Precedes(model::Seq seq) const { return range_ && seq == last_ + 1; }
  /// Begins a range, or continues the current one. If several kinds were limited, each by its own
  /// rate, the range names none of them.
  void Add(model::Seq seq, const model::Rejection& rejection) {
    if (!range_) {
      range_ = storage::LimitedRange{.first = seq, .rejection = rejection};
    } else if (range_->rejection != rejection) {
      range_->rejection.detail = "more than the rates of several kinds";
    }
    last_ = seq;
  }
  /// Takes the current range, which must not be empty; the next number begins another.
  [[nodiscard]] storage::LimitedRange Take() { return *std::exchange(range_, std::nullopt); }

 private:
  std::optional<storage::LimitedRange> range_;
  model::Seq last_ = 0;
};

}  // namespace uplink::session
