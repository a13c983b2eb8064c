#pragma once

#include <functional>
#include <utility>

#include "server/session/reject_source.h"
#include "storage/reader.h"

namespace uplink::store {

/// Reads Rejects from the store by jobs on a thread that may wait for it. Thread-safe.
class RejectReads final : public session::RejectSource {
 public:
  /// `post` is false where it takes no job now, and drops what waits when it ends. Both outlive
  /// this, and this outlives the jobs.
  using Post = std::function<bool(std::function<void()>)>;
  RejectReads(storage::Reader& reader, Post post) : reader_(reader), post_(std::move(post)) {}

  [[nodiscard]] bool Read(const storage::RejectsQuery& query, Done done) override;

 private:
  storage::Reader& reader_;
  const Post post_;
};

}  // namespace uplink::store
