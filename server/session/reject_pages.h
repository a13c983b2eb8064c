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

/// Has the Rejects read that the store's answer to the opening left out, page by page: the next one
/// once the one before was written. A read that fails is tried again (kRejectsReadAgain).
///
/// Thread: confined to the stream's thread; what is read comes from another.
class RejectPages final {
 public:
  /// All of them outlive it.
  struct Sources {
    const SessionContext& context;
    Attachment& robot;
    StreamTimers& timers;
  };
  explicit RejectPages(const Sources& sources) : sources_(sources) {}

  /// A page that was read becomes part of the stream's progress. False if there is none.
  bool Collect();
  /// Asks for the next page, unless one is asked for, or `outgoing` frames wait. From Welcome on.
  void Ask(std::size_t outgoing);

 private:
  using Page = absl::StatusOr<std::vector<storage::StoredReject>>;
  /// Where the reading thread leaves a page; it may outlive the stream.
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
  /// Of the page that is asked for; null: none is.
  std::shared_ptr<Box> asked_;
  storage::RejectsQuery query_;
};

}  // namespace uplink::session
