#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "tests/bench/fair/misbehaviour.h"

namespace uplink::bench {

/// Sends frames on one stream, and opens the next when it ends.
class Flood final : public Misbehaviour {
 public:
  struct Style {
    /// Messages of the next frame.
    std::function<std::vector<BadMessage>()> frame;
    /// How far the numbers of the next frame's messages are apart.
    std::function<std::uint64_t()> step = [] { return std::uint64_t{1}; };
    /// Bytes of payloads per second; 0: as fast as the server reads.
    std::size_t bytes_per_second = 0;
    /// Between frames; zero: none.
    milliseconds pause{0};
    /// How long a stream stays before it is left as it is, and another is opened; zero: as long as
    /// it lives.
    milliseconds left_after{0};
  };

  Flood(BadWorld& world, Style style)
      : world_(world), style_(std::move(style)), session_(NewBadSession()) {}

  void Act() override;
  [[nodiscard]] bool at_work() const override { return at_work_; }

 private:
  void Leave();
  void OpenIfOver(SteadyTime now);
  void SendWhatIsDue(SteadyTime now);

  BadWorld& world_;
  const Style style_;
  BadSession session_;
  std::unique_ptr<BadStream> stream_;
  /// Connections that were left as they are, the oldest first.
  std::deque<std::unique_ptr<BadStream>> left_;
  bool at_work_ = false;
  SteadyTime tried_{};
  /// When the next byte, or frame, is due.
  SteadyTime due_{};
};

}  // namespace uplink::bench
