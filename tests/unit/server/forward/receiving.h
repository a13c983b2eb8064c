#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/forward/item.h"
#include "server/loop/wake.h"

namespace uplink::forward {

/// Notes which streams were woken, in order.
class Woken final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t stream) override { streams.push_back(stream); }
  [[nodiscard]] std::vector<std::uint64_t> Take() { return std::exchange(streams, {}); }

  std::vector<std::uint64_t> streams;
};

[[nodiscard]] inline ItemKey KeyOf(std::string_view robot, std::string_view id) {
  return {storage::PresentKind::kShape, std::string(robot), std::string(id)};
}

/// Stands for a frame: its text.
[[nodiscard]] inline EncodedFrame Text(std::string_view text) {
  return std::make_shared<const std::string>(text);
}

/// The frames' texts.
[[nodiscard]] inline std::vector<std::string> Texts(const std::vector<EncodedFrame>& frames) {
  std::vector<std::string> texts;
  texts.reserve(frames.size());
  for (const EncodedFrame& frame : frames) texts.push_back(*frame);
  return texts;
}

}  // namespace uplink::forward
