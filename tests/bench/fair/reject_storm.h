#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "tests/bench/fair/misbehaviour.h"

namespace uplink::bench {

/// Rejects of its session that the robot never confirms.
inline constexpr std::uint64_t kUnconfirmedRejects = 4000;

/// Has thousands of messages rejected, then opens stream after stream that confirms none of them,
/// and leaves each at its Welcome, or as soon as the server has begun to say them again.
class RejectStorm final : public Misbehaviour {
 public:
  explicit RejectStorm(BadWorld& world) : world_(world), session_(NewBadSession()) {}

  void Act() override;
  [[nodiscard]] bool at_work() const override { return stage_ == Stage::kStorming; }

 private:
  enum class Stage : std::uint8_t { kCollecting, kStorming };

  void Collect(SteadyTime now);
  void Storm(SteadyTime now);
  void OpenNext();

  BadWorld& world_;
  BadSession session_;
  Stage stage_ = Stage::kCollecting;
  std::unique_ptr<BadStream> stream_;
  std::size_t sent_ = 0;
  std::size_t opened_ = 0;
  bool cancelled_ = false;
  SteadyTime began_{};
};

}  // namespace uplink::bench
