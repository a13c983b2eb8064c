#pragma once

#include "server/journal/duty.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// The duty that keeps the quarantine of robots to its bound: each kTrimInterval those that are
/// noted, kTrimRobotsPerCall per call, and again after kSweepAgain where more is left. It goes by
/// no clock, and there is nothing to do where no robot is noted.
///
/// Errors:  whatever the store tells is the store's error; the robots stay noted.
/// Thread:  confined to the writer.
class QuarantineTrim final {
 public:
  explicit QuarantineTrim(const WriterContext& context)
      : context_(context), duty_(context.clock.Steady()) {}

  /// When there is something to do; Duty::kNever if there is not.
  [[nodiscard]] SteadyTime due() const;
  [[nodiscard]] Step Do();

 private:
  const WriterContext context_;
  Duty duty_;
};

}  // namespace uplink::journal
