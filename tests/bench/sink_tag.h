#pragma once

namespace uplink::bench {

/// Something that a sink's completion queue brings to its end. Confined to the queue's thread.
class SinkTag {
 public:
  virtual ~SinkTag() = default;
  virtual void Proceed(bool ok) = 0;
  /// What the queue is given, and gives back.
  [[nodiscard]] void* tag() { return this; }
};

}  // namespace uplink::bench
