#include "server/fleet/odd_fleets.h"

#include "server/identity/invisible_characters.h"

namespace uplink::fleet {

void OddFleets::Know(std::string_view fleet) {
  if (!identity::InvisibleCharacter(fleet)) return;
  const std::lock_guard lock(mutex_);
  if (known_.size() < kOddFleetsMax) known_.emplace(fleet);
}

void OddFleets::SetRead() {
  const std::lock_guard lock(mutex_);
  read_ = true;
}

OddFleets::Verdict OddFleets::Judge(std::string_view fleet) const {
  if (!identity::InvisibleCharacter(fleet)) return Verdict::kFits;
  const std::lock_guard lock(mutex_);
  if (known_.contains(fleet)) return Verdict::kFits;
  return read_ ? Verdict::kRefused : Verdict::kUnread;
}

}  // namespace uplink::fleet
