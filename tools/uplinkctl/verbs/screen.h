#pragma once

#include <functional>
#include <string_view>

#include "schema/base/clock.h"
#include "tools/uplinkctl/show/rows.h"

namespace uplink::ctl {

/// Where a verb shows what it found. A value; the clock outlives it.
struct Screen {
  /// Takes what the verb is for.
  std::function<void(std::string_view text)> print;
  /// Takes a line about it, for standard error.
  std::function<void(std::string_view line)> note;
  /// Blocks until a verb that follows looks again; false ends it.
  std::function<bool()> wait;
  const Clock& clock;
  /// Lines may be overwritten.
  bool updates = false;
  TableTerms table;

  [[nodiscard]] RowTerms Terms() const { return {clock.System(), table}; }
};

}  // namespace uplink::ctl
