#pragma once

#include <optional>

#include "storage/clock_marks.h"

namespace uplink::testing {

/// The mark in memory, of a store that is as the test says. For one thread.
class FakeClockMarks final : public storage::ClockMarks {
 public:
  absl::StatusOr<storage::ClockReading> Read() override {
    if (!status.ok()) return status;
    return reading;
  }
  absl::Status Set(SystemTime mark) override {
    if (status.ok()) reading.mark = mark;
    return status;
  }
  absl::Status SetIfEmpty(SystemTime mark) override {
    if (status.ok() && empty && !reading.mark) reading.mark = mark;
    return status;
  }

  /// What Read answers.
  storage::ClockReading reading;
  /// The store has no row.
  bool empty = false;
  /// Of every call.
  absl::Status status;
};

}  // namespace uplink::testing
