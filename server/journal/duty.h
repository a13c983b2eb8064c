#pragma once

#include "schema/base/clock.h"

namespace uplink::journal {

/// When work of the journal's own is due. Confined to the writer.
class Duty final {
 public:
  /// Of a duty that this journal does not have.
  static constexpr SteadyTime kNever = SteadyTime::max();

  explicit Duty(SteadyTime due) : due_(due) {}

  [[nodiscard]] bool IsDue(SteadyTime now) const { return now >= due_; }
  [[nodiscard]] SteadyTime due() const { return due_; }
  void DueAt(SteadyTime due) { due_ = due; }

 private:
  SteadyTime due_;
};

}  // namespace uplink::journal
