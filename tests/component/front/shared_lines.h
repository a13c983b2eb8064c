#pragma once

#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/log/logger.h"

namespace uplink::testing {

/// The lines of a logger that several threads write to. Outlives the logger.
class SharedLines final : public log::LineSink {
 public:
  class Lines final {
   public:
    [[nodiscard]] std::vector<std::string> All() {
      const std::lock_guard lock(mutex_);
      return lines_;
    }

   private:
    friend class SharedLines;
    std::mutex mutex_;
    std::vector<std::string> lines_;
  };
  explicit SharedLines(Lines& lines) : lines_(lines) {}
  void Write(log::Level /*level*/, std::string_view line) override {
    const std::lock_guard lock(lines_.mutex_);
    lines_.lines_.emplace_back(line);
  }

 private:
  Lines& lines_;
};

}  // namespace uplink::testing
