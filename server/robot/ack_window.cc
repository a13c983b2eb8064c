#include "server/robot/ack_window.h"

#include <algorithm>

#include "schema/base/check.h"

namespace uplink::robot {

void AckWindow::Raise(model::Seq seq) {
  if (seq <= seen_) return;
  seen_ = seq;
  Advance();
}

void AckWindow::AddSettled(model::Seq seq) {
  UPLINK_CHECK(seq > seen_, "a settled number must be above all seen");
  seen_ = seq;
  Advance();
}

void AckWindow::AddWaiting(model::Seq seq) {
  UPLINK_CHECK(seq > seen_, "a waiting number must be above all seen");
  waiting_.push_back({.seq = seq, .seen_before = seen_});
  seen_ = seq;
}

bool AckWindow::Waits(model::Seq seq) const {
  const auto found = std::ranges::lower_bound(waiting_, seq, {}, &Waiting::seq);
  return found != waiting_.end() && found->seq == seq;
}

bool AckWindow::Settle(model::Seq first, model::Seq last) {
  const auto begin = std::ranges::lower_bound(waiting_, first, {}, &Waiting::seq);
  const auto end = std::ranges::upper_bound(begin, waiting_.end(), last, {}, &Waiting::seq);
  if (begin == end) return false;
  waiting_.erase(begin, end);
  Advance();
  return true;
}

void AckWindow::Advance() {
  const model::Seq settled = waiting_.empty() ? seen_ : waiting_.front().seen_before;
  through_ = std::max(through_, settled);
}

}  // namespace uplink::robot
