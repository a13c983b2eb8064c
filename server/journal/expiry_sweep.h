#pragma once

#include "server/journal/duty.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// The duty that deletes expired shapes and objects from the store, and closes mission runs that
/// were open for too long: each kSweepInterval, and again after kSweepAgain if more is left.
///
/// Errors:  any error is the store's; the next sweep is due as usual.
/// Thread:  confined to the writer.
class ExpirySweep final {
 public:
  /// Due first at `due`.
  ExpirySweep(const WriterContext& context, SteadyTime due) : context_(context), duty_(due) {}

  [[nodiscard]] const Duty& duty() const { return duty_; }
  [[nodiscard]] Step Do();

 private:
  const WriterContext context_;
  Duty duty_;
};

}  // namespace uplink::journal
