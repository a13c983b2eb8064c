#include "server/front/source_lines.h"

#include <utility>

namespace uplink::front {

void SourceLines::Write(std::string_view event, std::string_view kind, const std::string& why,
                        const Origin& origin, SteadyTime now) {
  if (logger_ == nullptr) return;
  std::uint64_t suppressed = 0;
  {
    const std::lock_guard lock(mutex_);
    Window& window =
        WindowOf({origin.source, origin.gateway.empty() ? origin.robot : origin.gateway, kind});
    if (!Take(window, kLinesPerSource, now) || !Take(all_, kLinesMax, now)) {
      ++window.suppressed;
      return;
    }
    suppressed = std::exchange(window.suppressed, 0);
  }
  logger_->Write(log::Level::kWarn, event,
                 {{"source", origin.source.ToText()},
                  {"peer", origin.text},
                  {"robot", origin.robot},
                  {"gateway", origin.gateway},
                  {"why", why},
                  {"suppressed", suppressed}});
}

bool SourceLines::Take(Window& window, std::uint32_t lines_max, SteadyTime now) {
  if (window.lines == 0 || now >= window.start + kSpan) {
    window.start = now;
    window.lines = 0;
  }
  if (window.lines >= lines_max) return false;
  ++window.lines;
  return true;
}

SourceLines::Window& SourceLines::WindowOf(const Key& key) {
  if (const auto found = by_key_.find(key); found != by_key_.end()) {
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->window;
  }
  if (entries_.size() >= kSourcesMax) {
    by_key_.erase(entries_.back().key);
    entries_.pop_back();
  }
  entries_.push_front({key, {}});
  by_key_.emplace(key, entries_.begin());
  return entries_.front().window;
}

}  // namespace uplink::front
