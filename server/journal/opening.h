#pragma once

#include <vector>

#include "server/journal/ask_queue.h"
#include "server/journal/call_size.h"
#include "server/journal/holds.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// The step that opens streams: calls OpenStreams for those that wait, and reports the answers.
///
/// Errors:  a failed store call is tried again as it was; after kFailuresToHalve failures its later
///          half goes back to the inbox.
/// Thread:  confined to the writer.
class Opening final {
 public:
  /// All outlive it.
  Opening(const WriterContext& context, Holds& holds);

  struct Gathered {
    /// Streams wait to be opened.
    bool opens = false;
    /// Records, gaps or changes of presence wait in the inbox.
    bool records_wait = false;
  };
  /// Adds waiting streams to the next store call.
  [[nodiscard]] Gathered Gather();
  /// Calls the store, and reports its answers. Streams of robots that are not judged yet wait on
  /// (robot::Registration): kFailed if there are only those.
  [[nodiscard]] Step Open();

 private:
  /// Ends the streams of refused robots, and puts back those of robots that are not judged yet.
  /// True if some were ended.
  bool TakeOutKeptOut();
  void Tell(const OpenEntry& open, const storage::OpenResult& result);

  const WriterContext context_;
  Holds& holds_;
  CallSize size_;
  std::vector<OpenEntry> opening_;
};

}  // namespace uplink::journal
