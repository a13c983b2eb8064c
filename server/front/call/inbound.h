#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "server/front/call/message_reader.h"
#include "server/front/call/unfinished.h"
#include "server/loop/wake.h"

namespace uplink::front {

/// What has arrived for one call and its handler has not taken: its messages, how far the stream's
/// window opens for them, and the memory of an incomplete one.
///
/// Thread: confined to its connection's.
class Inbound final {
 public:
  /// The bytes by which the stream's window opens.
  using WindowBytes = std::size_t;

  Inbound(Unfinished& unfinished, const loop::StreamRef& call)
      : unfinished_(unfinished), call_(call) {}
  ~Inbound() { NoteHeld({}, 0, {}); }
  Inbound(const Inbound&) = delete;
  Inbound& operator=(const Inbound&) = delete;

  [[nodiscard]] MessageReader& reader() { return reader_; }
  /// Takes the message that reader().Peek showed.
  [[nodiscard]] WindowBytes Pop() { return Open(reader_.Pop()); }
  /// Forgets all that waits.
  [[nodiscard]] WindowBytes Drop();
  /// Notes whether the handler waits for a message. While that is incomplete, its memory counts for
  /// `key`; if it is longer than half the stream's window, the window opens early.
  [[nodiscard]] WindowBytes NoteUnfinished(bool awaited, const KeyDigest& key, SteadyTime now);
  /// The call takes no more messages: no memory counts.
  void End() { NoteHeld({}, 0, {}); }
  /// Whether the call, which was woken, must end because of the memory that it holds.
  [[nodiscard]] bool MustEnd() const { return held_ > 0 && unfinished_.MustEnd(call_); }

 private:
  [[nodiscard]] WindowBytes Open(std::size_t taken);
  void NoteHeld(const KeyDigest& key, std::size_t bytes, SteadyTime now);

  Unfinished& unfinished_;
  const loop::StreamRef call_;
  MessageReader reader_;
  /// Bytes of the unfinished message that the window was opened for already.
  std::size_t opened_early_ = 0;
  /// The bytes and the message that `unfinished_` last got.
  std::size_t held_ = 0;
  std::uint64_t held_message_ = 0;
};

}  // namespace uplink::front
