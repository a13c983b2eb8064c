#pragma once

#include <cstdint>
#include <optional>

#include "storage/types.h"

namespace uplink::robot {

/// The store's answer to the last OpenStream of a robot, until Welcome has used it. Confined to its
/// owner's lock.
class Opening final {
 public:
  /// A stream asks anew, and answers to older questions are ignored. Returns the question's id.
  [[nodiscard]] std::uint64_t Ask();
  /// The store has answered. Kept only if Welcome still waits for this one. False if it answers an
  /// older question.
  bool Answer(std::uint64_t open_id, const storage::OpenResult& result);
  [[nodiscard]] bool answered(std::uint64_t open_id) const;
  /// Welcome goes out now, with the answer if it is here; a later one is not wanted any more.
  [[nodiscard]] std::optional<storage::OpenResult> Take(std::uint64_t open_id);
  /// Another process holds the robot: what the store said is void.
  void Forget() { answer_.reset(); }

 private:
  std::uint64_t open_id_ = 0;
  std::optional<storage::OpenResult> answer_;
  /// Welcome still waits for it.
  bool wanted_ = false;
};

}  // namespace uplink::robot
