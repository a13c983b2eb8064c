#pragma once

#include <functional>
#include <string>

namespace uplink::http {

/// The body of an answer that goes on: events as they happen, in the form of server-sent events.
class EventStream {
 public:
  virtual ~EventStream() = default;

  struct Taken {
    /// Empty: there is nothing now.
    std::string text;
    /// Nothing follows it.
    bool over = false;
  };
  /// What has happened since the last call; never waits for long. On Lane::kWatch.
  [[nodiscard]] virtual Taken Take() = 0;
  /// `ready` is called on any thread once there is something after a Take that found nothing. Call
  /// it once, before the first Take.
  virtual void OnReady(std::function<void()> ready) = 0;
  /// What tells its caller from others; empty: nothing does.
  [[nodiscard]] virtual const std::string& caller() const = 0;
  /// Its end is that its caller may not see it any more. Not beside a Take.
  virtual void NoteDenied() = 0;
};

}  // namespace uplink::http
