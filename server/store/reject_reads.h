#pragma once

#include <utility>

#include "server/loop/one_at_a_time.h"
#include "server/session/reject_source.h"
#include "storage/reader.h"

namespace uplink::store {

/// Reads Rejects from the store on a thread that may wait for it. Thread-safe.
class RejectReads final : public session::RejectSource {
 public:
  /// `post` drops what waits when it ends. Both outlive this, and this outlives the jobs.
  RejectReads(storage::Reader& reader, loop::Post post) : reader_(reader), post_(std::move(post)) {}

  [[nodiscard]] bool Read(const storage::RejectsQuery& query, Done done) override {
    return post_([this, query, done = std::move(done)] { done(reader_.Rejects(query)); });
  }

 private:
  storage::Reader& reader_;
  const loop::Post post_;
};

}  // namespace uplink::store
