#pragma once

#include <mutex>
#include <string>

namespace uplink::synthetic {

/// The first of many texts of one kind, for the report. Thread-safe.
class FirstText final {
 public:
  void Keep(const std::string& text) {
    const std::scoped_lock lock(mutex_);
    if (text_.empty()) text_ = text;
  }
  /// Empty: there was none.
  [[nodiscard]] std::string Read() const {
    const std::scoped_lock lock(mutex_);
    return text_;
  }

 private:
  mutable std::mutex mutex_;
  std::string text_;
};

}  // namespace uplink::synthetic
