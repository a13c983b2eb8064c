#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "server/journal/duty.h"
#include "server/journal/writer_context.h"
#include "storage/identity.h"

namespace uplink::journal {

/// Whether a process is over; empty: that is not known yet, ask again. Called on the writer's
/// thread: short.
using IsOver = std::function<std::optional<bool>(const storage::ProcessId& process)>;

/// The duty that ends connections of servers that are over and did not tell their end: those that a
/// crash left open. Each kSweepInterval, and again after kEndsAgain while a process is in question
/// or more is left.
///
/// Errors:  any error is the store's; the next look is due as usual.
/// Thread:  confined to the writer.
class ConnectionEnds final {
 public:
  explicit ConnectionEnds(const WriterContext& context) : context_(context), duty_(Duty::kNever) {}

  /// Due at once. Before the first Do.
  void Begin(IsOver is_over) {
    is_over_ = std::move(is_over);
    duty_.DueAt(context_.clock.Steady());
  }

  [[nodiscard]] const Duty& duty() const { return duty_; }
  [[nodiscard]] Step Do();

 private:
  const WriterContext context_;
  Duty duty_;
  IsOver is_over_;
};

}  // namespace uplink::journal
