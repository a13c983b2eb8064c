#include "server/robot/numbering.h"

#include <algorithm>

#include "server/robot/limits.h"

namespace uplink::robot {

Seen Numbering::See(model::Seq seq) const {
  if (seq <= window_.seen()) return {.as = SeenAs::kDuplicate, .waits = window_.Waits(seq)};
  Seen seen;
  const model::Seq floor = std::max(window_.seen(), missing_floor_);
  if (seq > floor + 1) {
    seen.missing_first = floor + 1;
    seen.missing_last = seq - 1;
    seen.missing = std::min<std::uint64_t>(seq - 1 - floor, kMissingPerJumpMax);
  }
  return seen;
}

std::size_t Numbering::AddWaiting(model::Seq seq) {
  const std::size_t before = window_.waiting();
  window_.AddWaiting(seq);
  return window_.waiting() - before;
}

std::size_t Numbering::Settle(model::Seq first, model::Seq last) {
  const std::size_t before = window_.waiting();
  if (!window_.Settle(first, last)) return 0;
  return before - window_.waiting();
}

model::Seq Numbering::Resume(model::Seq settled_seq, model::Seq judged_seq, model::Seq stored_seq) {
  model::Seq committed = std::max(settled_seq, stored_seq);
  if (known_) committed = std::max(committed, window_.through());
  known_ = true;
  window_.Raise(committed);
  missing_floor_ = std::max({missing_floor_, committed, judged_seq});
  hello_judged_ = std::max(hello_judged_, judged_seq);
  return committed;
}

model::Seq Numbering::judged() const { return std::max(window_.seen(), hello_judged_); }

}  // namespace uplink::robot
