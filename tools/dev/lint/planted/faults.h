// Faults in a header; see faults.cc.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace uplink::planted {

class badly_named {  // finds: readability-identifier-naming
 public:
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

template <typename T>
std::size_t SizeAfterMove(T value) {
  const T moved = std::move(value);
  return moved.size() + value.size();  // finds: bugprone-use-after-move
}

inline std::size_t Characters(const std::vector<std::string>& texts) {
  std::size_t sum = 0;
  // clang-format off
  for (const std::string each : texts) {  // finds: clang-diagnostic-range-loop-construct, performance-for-range-copy
    // clang-format on
    sum += each.size();
  }
  return sum;
}

}  // namespace uplink::planted
