#pragma once

namespace uplink::relay {

/// What a completion queue gives back: one step of somebody's work. Called on the queue's thread.
class Tag {
 public:
  virtual ~Tag() = default;
  /// `ok` is what gRPC says of the operation.
  virtual void Proceed(bool ok) = 0;
};

}  // namespace uplink::relay
