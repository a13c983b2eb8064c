#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace uplink::synthetic {

/// What became of the changes that a server forwarded, by one page of its metrics. A value.
struct ForwardCounts {
  std::uint64_t due = 0;
  std::uint64_t written = 0;
  std::uint64_t coalesced = 0;
  std::uint64_t snapshot = 0;
  std::uint64_t dropped = 0;
  std::uint64_t waiting = 0;

  [[nodiscard]] std::uint64_t sum() const {
    return written + coalesced + snapshot + dropped + waiting;
  }
};

/// Nothing if one of them is not on the page. Pure; any thread.
[[nodiscard]] std::optional<ForwardCounts> ForwardCountsOf(std::string_view page);

}  // namespace uplink::synthetic
