#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/log/logger.h"

namespace uplink::log::testing {

/// Keeps lines for a test to look at; the vector outlives the sink. Confined to one thread.
class LineRecorder final : public LineSink {
 public:
  explicit LineRecorder(std::vector<std::string>& lines) : lines_(lines) {}
  void Write(Level /*level*/, std::string_view line) override { lines_.emplace_back(line); }

 private:
  std::vector<std::string>& lines_;
};

/// A logger whose lines end in `lines`.
struct RecordedLog {
  std::vector<std::string> lines;
  Logger logger;

  RecordedLog(const Clock& clock, Format format, Level level)
      : logger(std::make_unique<LineRecorder>(lines), clock, format, level) {}
};

}  // namespace uplink::log::testing
