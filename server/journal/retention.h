#pragma once

#include "server/journal/duty.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// The duty that keeps histories to their age: each kRetainInterval, and again after kSweepAgain if
/// more is left.
///
/// Errors:  kUnavailable is the store's error: tried again after kRetainAgain. Any other is the
///          duty's own: commits go on, and it is tried again after kRetainLater.
/// Thread:  confined to the writer.
class Retention final {
 public:
  /// Due first at `due`.
  Retention(const WriterContext& context, SteadyTime due) : context_(context), duty_(due) {}

  [[nodiscard]] const Duty& duty() const { return duty_; }
  [[nodiscard]] Step Do();

 private:
  const WriterContext context_;
  Duty duty_;
};

}  // namespace uplink::journal
