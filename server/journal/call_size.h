#pragma once

#include <cstddef>
#include <iterator>
#include <vector>

#include "server/journal/limits.h"

namespace uplink::journal {

/// Rules by which the size of a store call follows its failures and successes.
struct CallSizeRule {
  /// The size at most, and at first.
  std::size_t most = 1;
  /// Failures in a row that halve the call, and successes in a row that double it again.
  int failures_to_halve = kFailuresToHalve;
  int successes_to_double = kSuccessesToDouble;
  /// A call smaller than this is not halved, but its failures count.
  std::size_t halved_from = 0;
};

/// The size of the next store call of one kind. A store that cannot do a whole call in time may do
/// half of it, so failures halve the call and successes double it again.
///
/// Limits: at least 1, at most CallSizeRule.most.
/// Thread: confined to the writer.
class CallSize final {
 public:
  explicit CallSize(const CallSizeRule& rule) : rule_(rule), now_(rule.most) {}

  [[nodiscard]] std::size_t now() const { return now_; }
  /// A call of size `held` failed. True if it has been halved: now() is half of `held`, and the
  /// rest must be left for later calls.
  [[nodiscard]] bool Failed(std::size_t held);
  void Succeeded();

 private:
  const CallSizeRule rule_;
  std::size_t now_;
  /// Failures in a row; below zero: successes in a row.
  int in_a_row_ = 0;
};

/// Takes the entries behind the first `kept` of a call, for later calls.
template <typename Entry>
[[nodiscard]] std::vector<Entry> TakeRest(std::vector<Entry>& call, std::size_t kept) {
  const auto rest = call.begin() + static_cast<std::ptrdiff_t>(kept);
  std::vector<Entry> left(std::make_move_iterator(rest), std::make_move_iterator(call.end()));
  call.erase(rest, call.end());
  return left;
}

}  // namespace uplink::journal
