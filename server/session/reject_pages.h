#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "server/session/attachment.h"
#include "server/session/context.h"
#include "server/session/stream_timers.h"
#include "storage/rejects.h"

namespace uplink::session {

/// Reads the Rejects that the store's answer to the opening left out, page by page: the next one
/// once the last was written. A failed read is tried again (kRejectsReadAgain).
///
/// Thread: confined to the stream's thread; the pages come from another.
class RejectPages final {
 public:
  /// All of them outlive it.
  struct Sources {
    const SessionContext& context;
    Attachment& robot;
    StreamTimers& timers;
  };
  explicit RejectPages(const Sources& sources) : sources_(sources) {}

  /// Adds a page that was read to the stream's progress. False if there is none.
  bool Collect();
  /// Asks for the next page, unless one is under way or `outgoing` frames wait. From Welcome on.
  void Ask(std::size_t outgoing);

 private:
  using Page = absl::StatusOr<std::vector<storage::StoredReject>>;
  /// The reading thread puts a page here; it may outlive the stream.
  class Box final {
   public:
    void Put(Page page) {
      const std::lock_guard lock(mutex_);
      page_.emplace(std::move(page));
    }
    std::optional<Page> Take() {
      const std::lock_guard lock(mutex_);
      return std::exchange(page_, std::nullopt);
    }

   private:
    std::mutex mutex_;
    std::optional<Page> page_;
  };

  /// Asks again after a pause.
  void SetTry();

  const Sources sources_;
  /// For the page that was asked for; null if none was.
  std::shared_ptr<Box> asked_;
  storage::RejectsQuery query_;
};

}  // namespace uplink::session
