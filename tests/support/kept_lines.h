#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/log/logger.h"

namespace uplink::testing {

/// Adds each line to a list of the test's, which outlives it. For one thread.
class KeptLines final : public log::LineSink {
 public:
  explicit KeptLines(std::vector<std::string>& lines) : lines_(lines) {}
  void Write(log::Level /*level*/, std::string_view line) override { lines_.emplace_back(line); }

 private:
  std::vector<std::string>& lines_;
};

/// Drops each line, for parts that want a logger where a test looks at none.
class NoLines final : public log::LineSink {
 public:
  void Write(log::Level /*level*/, std::string_view /*line*/) override {}
};

}  // namespace uplink::testing
