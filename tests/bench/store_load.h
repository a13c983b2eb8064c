#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "storage/batch.h"
#include "storage/open_stream.h"

namespace uplink::bench {

/// The shape of what one writer commits.
struct LoadShape {
  std::size_t batch_records = 1000;
  /// Records of one robot that follow one another in a batch: the messages of a frame.
  std::size_t per_robot = 64;
  std::size_t text_bytes = 120;
};

/// Batches of messages for people, each with new numbers: what a journal hands to its store.
/// Confined to one thread.
class BatchSource final {
 public:
  /// Robots are named by `writer`, so that two writers share none.
  BatchSource(const LoadShape& shape, std::size_t writer, SystemTime at);

  [[nodiscard]] const std::vector<storage::OpenRequest>& opens() const { return opens_; }
  /// `held_since` of the robots, in the order of opens().
  void SetHolds(const std::vector<storage::OpenResult>& opened);
  /// The batch with the next numbers; valid until the next call.
  [[nodiscard]] const storage::Batch& Next();

 private:
  std::vector<storage::OpenRequest> opens_;
  storage::Batch batch_;
};

}  // namespace uplink::bench
