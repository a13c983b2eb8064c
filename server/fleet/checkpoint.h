#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "server/fleet/fleet.h"
#include "server/fleet/live_source.h"

namespace uplink::fleet {

/// Bytes of parts that one round writes; the rest goes first in the next round.
inline constexpr std::size_t kCheckpointRoundBytesMax = std::size_t{64} * 1024 * 1024;

/// The live states of the robots of one journal, and how far their sessions are settled.
///
/// Thread: as LiveSource.
class Checkpoint final : public LiveSource {
 public:
  struct Sources {
    const Fleet& fleet;
    /// Whether this journal writes the robot with this RURI.
    std::function<bool(std::string_view ruri)> writes;
  };
  /// The fleet outlives it.
  explicit Checkpoint(Sources sources) : sources_(std::move(sources)) {}

  void BeginRound() override;
  [[nodiscard]] std::vector<storage::LiveRow> TakeChanged(std::size_t rows_max) override;
  void PutBack(std::span<const storage::LiveRow> rows) override;
  void PassedOver(const storage::LiveRow& row) override;

 private:
  const Sources sources_;
  /// The robots that the round has not looked at yet, the next one last.
  std::vector<RobotPtr> left_;
  std::size_t round_bytes_ = 0;
  /// How many robots earlier rounds looked at: each begins where the last one ended.
  std::size_t looked_at_ = 0;
};

}  // namespace uplink::fleet
