#include "tools/uplink-fleet/compare/forward_counts.h"

#include <charconv>
#include <string>
#include <system_error>

namespace uplink::synthetic {
namespace {

/// The value of the line that begins with this series.
std::optional<std::uint64_t> ValueOf(std::string_view page, const std::string& series) {
  const std::string begin = series + " ";
  std::size_t at = 0;
  while (!page.substr(at).starts_with(begin)) {
    at = page.find('\n', at);
    if (at == std::string_view::npos) return std::nullopt;
    ++at;
  }
  std::string_view text = page.substr(at + begin.size());
  text = text.substr(0, text.find('\n'));
  std::uint64_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<ForwardCounts> ForwardCountsOf(std::string_view page) {
  const auto settled = [page](const char* outcome) {
    return ValueOf(page,
                   std::string("uplinkd_forwards_settled_total{outcome=\"") + outcome + "\"}");
  };
  const auto due = ValueOf(page, "uplinkd_forwards_due_total");
  const auto waiting = ValueOf(page, "uplinkd_forwards_waiting");
  const auto written = settled("written");
  const auto coalesced = settled("coalesced");
  const auto snapshot = settled("snapshot");
  const auto dropped = settled("dropped");
  if (!due || !waiting || !written || !coalesced || !snapshot || !dropped) return std::nullopt;
  return ForwardCounts{*due, *written, *coalesced, *snapshot, *dropped, *waiting};
}

}  // namespace uplink::synthetic
