#include "server/front/call/call_set.h"

#include <algorithm>
#include <utility>

namespace uplink::front {

Call& CallSet::Open(std::unique_ptr<Call> call) {
  auto& place = calls_[call->stream()];
  place = std::move(call);
  return *place;
}

void CallSet::Touch(Call& call) {
  if (std::exchange(call.touched, true)) return;
  touched_.push_back(&call);
}

void CallSet::Settle(const std::function<void(const Call&)>& settled) {
  // Calls that are touched meanwhile are appended.
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    Call& call = *touched_[i];
    call.touched = false;
    call.Settle();
    settled(call);
    if (!call.finished()) continue;
    touched_.erase(
        std::remove(touched_.begin() + static_cast<std::ptrdiff_t>(i) + 1, touched_.end(), &call),
        touched_.end());
    calls_.erase(call.stream());
  }
  touched_.clear();
}

void CallSet::TellPeerAnswered() {
  for (const auto& [id, call] : calls_) call->OnPeerAnswered();
}

void CallSet::Fail(const absl::Status& status, transport::EndCause cause) {
  for (const auto& [id, call] : calls_) {
    call->Fail(status, cause);
    Touch(*call);
  }
}

void CallSet::Break() {
  for (const auto& [id, call] : calls_) call->Break();
}

void CallSet::Drain(const transport::DrainSpread& spread, std::size_t first, SteadyTime end) {
  for (const auto& [id, call] : calls_) call->DrainAt(spread.At(first++), end);
}

}  // namespace uplink::front
