#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "server/fleet/fleet.h"
#include "server/journal/live_source.h"

namespace uplink::fleet {

/// The live states of a fleet's robots, of those that one journal is to write.
///
/// Thread: as journal::LiveSource.
class Checkpoint final : public journal::LiveSource {
 public:
  /// `fleet` outlives it. `writes` says whether a robot, by its RURI, is this journal's.
  Checkpoint(const Fleet& fleet, std::function<bool(std::string_view)> writes)
      : fleet_(fleet), writes_(std::move(writes)) {}

  [[nodiscard]] std::vector<storage::LiveRow> TakeChanged() override;
  void PutBack(std::span<const storage::LiveRow> rows) override;

 private:
  const Fleet& fleet_;
  const std::function<bool(std::string_view)> writes_;
  /// The robots of the round, and which is next; empty between two.
  std::vector<Robot*> round_;
  std::size_t next_ = 0;
};

}  // namespace uplink::fleet
