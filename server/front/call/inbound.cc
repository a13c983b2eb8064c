#include "server/front/call/inbound.h"

#include <utility>

#include "server/front/http2/limits.h"

namespace uplink::front {

Inbound::WindowBytes Inbound::Open(std::size_t taken) {
  const std::size_t early = std::exchange(opened_early_, 0);
  return taken > early ? taken - early : 0;
}

Inbound::WindowBytes Inbound::Drop() {
  const WindowBytes opens = Open(reader_.waiting());
  reader_.Clear();
  return opens;
}

Inbound::WindowBytes Inbound::NoteUnfinished(bool awaited, const KeyDigest& key, SteadyTime now) {
  const std::optional<std::size_t> whole = awaited ? reader_.unfinished() : std::nullopt;
  NoteHeld(key, whole ? reader_.held() : 0, now);
  // nghttp2 announces a window only once half of it was given back, so a message may have to do
  // with that much less.
  if (!whole || *whole <= static_cast<std::size_t>(kStreamWindowBytes) / 2) return 0;
  // Everything that waits belongs to it.
  const std::size_t waiting = reader_.waiting();
  return waiting - std::exchange(opened_early_, waiting);
}

void Inbound::NoteHeld(const KeyDigest& key, std::size_t bytes, SteadyTime now) {
  const std::uint64_t message = bytes > 0 ? reader_.popped() : 0;
  if (bytes == held_ && message == held_message_) return;
  held_ = bytes;
  held_message_ = message;
  unfinished_.Set(call_, key, message, bytes, now);
}

}  // namespace uplink::front
