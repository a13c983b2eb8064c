#pragma once

#include "storage/connection.h"

namespace uplink::robot {

/// Keeps robots' connections. Thread-safe; it never waits.
class ConnectionSink {
 public:
  virtual ~ConnectionSink() = default;
  /// A connection has begun; `item.ended` is empty.
  virtual void Begin(storage::ConnectionItem item) = 0;
  /// It goes on, and brought more; after its Begin and before its End.
  virtual void Update(storage::ConnectionItem item) = 0;
  /// It has ended. Once for each Begin, with the same robot and id.
  virtual void End(storage::ConnectionItem item) = 0;
};

}  // namespace uplink::robot
