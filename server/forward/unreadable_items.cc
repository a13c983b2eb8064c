#include "server/forward/unreadable_items.h"

#include <chrono>
#include <string>

#include "server/forward/limits.h"

namespace uplink::forward {

UnreadableItems::UnreadableItems(const log::Logger& logger, ForwardProbe& probe)
    : probe_(probe), lines_(logger, kForwardLinesMax, std::chrono::minutes(1)) {}

void UnreadableItems::Note(const ItemKey& key, const absl::Status& why) {
  if (items_.contains(key)) return;
  probe_.unreadable.Add();
  lines_.Write(log::Level::kWarn, "forward_unreadable",
               {{"robot", key.ruri}, {"id", key.id}, {"why", std::string(why.message())}});
  if (items_.size() >= kUnreadableMax) return;
  items_.insert(key);
  Show();
}

void UnreadableItems::Forget(const ItemKey& key) {
  if (items_.erase(key) > 0) Show();
}

void UnreadableItems::KeepOnly(const std::function<bool(const ItemKey&)>& there) {
  std::erase_if(items_, [&](const ItemKey& key) { return !there(key); });
  Show();
}

void UnreadableItems::Show() {
  probe_.unreadable_now.Set(static_cast<std::int64_t>(items_.size()));
}

}  // namespace uplink::forward
