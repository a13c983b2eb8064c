#pragma once

#include <vector>

#include "server/journal/ask_queue.h"
#include "server/journal/call_size.h"
#include "server/journal/holds.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// The step that opens streams: OpenStreams for those that wait, and the telling of its answers.
///
/// Errors:  a store call that failed is tried again with what it held; after kFailuresToHalve of
///          them its later half goes back to the inbox.
/// Thread:  confined to the writer.
class Opening final {
 public:
  /// All outlive it.
  Opening(const WriterContext& context, Holds& holds);

  struct Gathered {
    /// There is something to open.
    bool opens = false;
    /// Records, gaps or changes of presence wait in the inbox.
    bool records_wait = false;
  };
  /// Adds what waits to the next store call.
  [[nodiscard]] Gathered Gather();
  /// Calls the store, and tells its answers.
  [[nodiscard]] Step Open();

 private:
  void Tell(const OpenEntry& open, const storage::OpenResult& result);

  const WriterContext context_;
  Holds& holds_;
  CallSize size_;
  std::vector<OpenEntry> opening_;
};

}  // namespace uplink::journal
