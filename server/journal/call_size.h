#pragma once

#include <cstddef>
#include <iterator>
#include <vector>

#include "server/journal/limits.h"

namespace uplink::journal {

/// How the size of a store call follows its failures and successes.
struct CallSizeRule {
  /// What a call holds at most, and at first.
  std::size_t most = 1;
  /// Failures in a row that halve the call, and successes in a row that double it again.
  int failures_to_halve = kFailuresToHalve;
  int successes_to_double = kSuccessesToDouble;
  /// A call that held less than this is not halved: its failures still count.
  std::size_t halved_from = 0;
};

/// What the next store call of one kind may hold: a store that cannot do the whole in its time may
/// do half of it, so failures halve the call and successes double it again.
///
/// Limits: at least 1, at most CallSizeRule.most.
/// Thread: confined to the writer.
class CallSize final {
 public:
  explicit CallSize(const CallSizeRule& rule) : rule_(rule), now_(rule.most) {}

  [[nodiscard]] std::size_t now() const { return now_; }
  /// The call failed; it held `held`. True if it has been halved: now() is half of `held`, and what
  /// the call holds beyond that is to be left for later calls.
  [[nodiscard]] bool Failed(std::size_t held);
  void Succeeded();

 private:
  const CallSizeRule rule_;
  std::size_t now_;
  /// Failures in a row; below zero: successes in a row.
  int in_a_row_ = 0;
};

/// Takes what a call holds beyond its first `kept` entries, for later calls.
template <typename Entry>
[[nodiscard]] std::vector<Entry> TakeRest(std::vector<Entry>& call, std::size_t kept) {
  const auto rest = call.begin() + static_cast<std::ptrdiff_t>(kept);
  std::vector<Entry> left(std::make_move_iterator(rest), std::make_move_iterator(call.end()));
  call.erase(rest, call.end());
  return left;
}

}  // namespace uplink::journal
