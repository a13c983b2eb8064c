#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "schema/model/ids.h"
#include "server/robot/reject_memory.h"
#include "server/robot/rejected_seq.h"
#include "storage/open_stream.h"
#include "storage/rejects.h"

namespace uplink::robot {

/// The store's state of a session.
struct StoredSession {
  /// The cursor; 0 without an answer.
  model::Seq through = 0;
  /// Rejected numbers up to it, ascending: the first ones.
  std::vector<RejectedSeq> rejects;
  /// How many more there are up to it, and their range.
  std::size_t more = 0;
  UnreadRejects unread;
};
[[nodiscard]] std::vector<RejectedSeq> RejectedOf(std::vector<storage::StoredReject> stored);
[[nodiscard]] StoredSession StoredOf(std::optional<storage::OpenResult> answer);

/// The store's answer to the last OpenStream of a robot, until Welcome has used it. Confined to its
/// owner's lock.
class OpenAnswer final {
 public:
  /// A stream asks anew; answers to older questions are ignored. Returns the question's id.
  [[nodiscard]] std::uint64_t Ask();
  /// The store has answered. The answer is kept only if Welcome still waits for it. False if it
  /// answers an older question.
  bool Answer(std::uint64_t open_id, const storage::OpenResult& result);
  [[nodiscard]] bool answered(std::uint64_t open_id) const;
  /// No newer stream has asked.
  [[nodiscard]] bool IsLast(std::uint64_t open_id) const { return open_id == open_id_; }
  /// Welcome goes out now, with the answer if it has come; otherwise a later one is no longer
  /// wanted.
  [[nodiscard]] std::optional<storage::OpenResult> Take(std::uint64_t open_id);
  /// After a Take without an answer: it is still wanted when it comes.
  void WantLate() { wanted_ = late_ = true; }
  /// The answer that WantLate asked for has come and was not taken.
  [[nodiscard]] bool came_late() const { return late_ && answer_.has_value(); }
  /// Another process holds the robot: the answer is void.
  void Forget() { answer_.reset(); }

 private:
  std::uint64_t open_id_ = 0;
  std::optional<storage::OpenResult> answer_;
  /// Welcome waits for it, or went out without it and it is wanted late.
  bool wanted_ = false;
  bool late_ = false;
};

}  // namespace uplink::robot
