#include "server/robot/resends.h"

#include <algorithm>
#include <cstddef>

#include "server/robot/limits.h"

namespace uplink::robot {
namespace {

using storage::LatestKind;

std::size_t IndexOf(LatestKind kind) { return static_cast<std::size_t>(kind); }

}  // namespace

void Resends::Answer(storage::LatestKindSet held,
                     const std::function<bool(const SentMessage&)>& waits) {
  storage::LatestKindSet missing = 0;
  for (const LatestKind kind : storage::kEachLatestKind) {
    if ((held & BitOf(kind)) != 0) continue;
    const std::optional<SentMessage>& sent = sent_[IndexOf(kind)];
    if (!sent || !waits(*sent)) missing |= BitOf(kind);
  }
  Set(missing, asked_ & missing);
}

void Resends::AddGood(LatestKind kind, const SentMessage& message) {
  sent_[IndexOf(kind)] = message;
  Set(missing_ & ~BitOf(kind), asked_ & ~BitOf(kind));
}

Resends::Due Resends::Take(SteadyTime now) {
  Due due;
  for (const LatestKind kind : storage::kEachLatestKind) {
    if ((missing_ & BitOf(kind)) == 0) continue;
    std::optional<SteadyTime>& asked_at = asked_at_[IndexOf(kind)];
    if (!asked_at || now >= *asked_at + kResendEvery) {
      due.kinds |= BitOf(kind);
      asked_at = now;
    }
    const SteadyTime again = *asked_at + kResendEvery;
    due.next = std::min(due.next.value_or(again), again);
  }
  Set(missing_, asked_ | due.kinds);
  return due;
}

void Resends::Set(storage::LatestKindSet missing, storage::LatestKindSet asked) {
  missing_ = missing;
  asked_ = asked;
  view_.store({missing, missing & asked});
}

}  // namespace uplink::robot
