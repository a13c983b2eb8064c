#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "metrics/ledger.h"
#include "server/journal/appended_by.h"
#include "server/robot/robot.h"
#include "server/session/context.h"
#include "server/session/limited_run.h"
#include "server/session/number_run.h"

namespace uplink::session {

/// What of a stream's messages goes to the journal, in the order of their numbers: each waits in
/// the robot's sessions from here on, and is counted before the writer can settle it.
///
/// Thread: confined to the stream's thread.
class Appending final {
 public:
  /// All of it outlives this, but the values.
  struct Sources {
    const SessionContext& context;
    robot::Robot& robot;
    NumberRun& numbers;
    metrics::MessageCounts& counts;
    model::SessionId session;
    journal::AppendedBy by;
  };
  explicit Appending(Sources sources)
      : sources_(std::move(sources)),
        id_(sources_.robot.id()),
        journal_(sources_.context.journals.Of(id_->ruri)) {}

  /// What follows came with a frame that arrived at this time.
  void Begin(SteadyTime arrived, SystemTime received_at) {
    arrived_ = arrived;
    received_at_ = received_at;
  }
  /// The numbers that are missing before the one just seen.
  void AddGap(const robot::Seen& seen);
  /// A durable message with the number just seen, or a rejected one.
  void Add(model::Seq seq, storage::CommitContent content, std::string payload,
           std::size_t payload_bytes);
  /// The number just seen, of a durable message that was limited: it goes with its range.
  void AddLimited(robot::RejectedSeq limited);
  /// The number of a limited message goes on with the range at hand.
  [[nodiscard]] bool Continues(model::Seq seq) const { return limited_.Precedes(seq); }
  /// The range at hand goes too. Ends a pass.
  void Flush();
  /// Tells the ledger what was counted.
  void Publish();

 private:
  /// The number waits; false if another process took the robot since it was seen.
  bool Wait(model::Seq seq, std::size_t bytes);
  void Append(storage::CommitRecord record);

  const Sources sources_;
  const storage::RobotRef id_;
  journal::Journal& journal_;
  LimitedRun limited_;
  SteadyTime arrived_;
  SystemTime received_at_;
};

}  // namespace uplink::session
