#pragma once

#include <utility>

#include "server/journal/shards.h"
#include "server/robot/connection_sink.h"

namespace uplink::journal {

/// Notes robots' connections for the store, in the robot's journal, where they wait behind what
/// opens its stream. Thread-safe; the journals outlive it.
class ConnectionNotes final : public robot::ConnectionSink {
 public:
  explicit ConnectionNotes(const Shards& journals) : journals_(journals) {}

  void Begin(storage::ConnectionItem item) override { journals_.NoteConnection(std::move(item)); }
  void Update(storage::ConnectionItem item) override { journals_.NoteConnection(std::move(item)); }
  void End(storage::ConnectionItem item) override { journals_.NoteConnection(std::move(item)); }

 private:
  const Shards& journals_;
};

}  // namespace uplink::journal
