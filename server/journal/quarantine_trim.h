#pragma once

#include "server/journal/duty.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// The duty that keeps the quarantine of robots to its bound: each kTrimInterval for noted robots,
/// kTrimRobotsPerCall per call, and again after kSweepAgain if more is left. It needs no civil
/// time, and does nothing if no robot is noted.
///
/// Errors:  any error is the store's; the robots stay noted.
/// Thread:  confined to the writer.
class QuarantineTrim final {
 public:
  explicit QuarantineTrim(const WriterContext& context)
      : context_(context), duty_(context.clock.Steady()) {}

  /// When it is due; Duty::kNever if there is nothing to do.
  [[nodiscard]] SteadyTime due() const;
  [[nodiscard]] Step Do();

 private:
  const WriterContext context_;
  Duty duty_;
};

}  // namespace uplink::journal
