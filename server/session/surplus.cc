#include "server/session/surplus.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace uplink::session {

std::optional<std::size_t> Surplus::PlaceOf(std::size_t kind) {
  const auto found = std::ranges::find(metrics::kTelemetryKinds, kind);
  if (found == metrics::kTelemetryKinds.end()) return std::nullopt;
  return static_cast<std::size_t>(found - metrics::kTelemetryKinds.begin());
}

bool Surplus::Put(std::size_t place, const UplinkView& uplink) {
  if (slots_ == nullptr) slots_ = std::make_unique<Slots>();
  Slot& slot = (*slots_)[place];
  slot.is_kept = false;
  return std::exchange(slot.uplink, uplink).has_value();
}

bool Surplus::Drop(std::size_t place) { return Take(place).has_value(); }

std::optional<UplinkView> Surplus::Take(std::size_t place) {
  if (slots_ == nullptr) return std::nullopt;
  return std::exchange((*slots_)[place].uplink, std::nullopt);
}

void Surplus::Keep() {
  if (slots_ == nullptr) return;
  for (Slot& slot : *slots_) {
    if (!slot.uplink || slot.is_kept) continue;
    slot.bytes.assign(slot.uplink->payload);
    slot.uplink->payload = slot.bytes;
    slot.is_kept = true;
  }
}

void Surplus::Shrink() {
  if (slots_ == nullptr) return;
  const auto is_free = [](const Slot& slot) { return !slot.uplink; };
  if (std::ranges::all_of(*slots_, is_free)) slots_.reset();
}

}  // namespace uplink::session
