#include "server/view/story_token.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <optional>

#include <absl/status/status.h>
#include <fmt/core.h>

#include "schema/model/ids.h"
#include "storage/page_token.h"

namespace uplink::view {
namespace {

/// Distinguishes tokens of stories from those of lists: `s.`, order, kind, time and entry.
constexpr std::string_view kPrefix = "s.";
constexpr std::size_t kByteDigits = 2;
constexpr std::size_t kNumberDigits = 16;
constexpr std::size_t kTokenBytes = kPrefix.size() + 2 * kByteDigits + 2 * kNumberDigits;

/// Takes so many hex digits off the front of `text`.
std::optional<std::uint64_t> TakeHex(std::string_view& text, std::size_t digits) {
  std::uint64_t number = 0;
  const char* const end = text.data() + digits;
  const auto [stopped, error] = std::from_chars(text.data(), end, number, 16);
  if (error != std::errc() || stopped != end) return std::nullopt;
  text.remove_prefix(digits);
  return number;
}

}  // namespace

std::string StoryToken(storage::ListOrder order, const StoryPlace& last) {
  return fmt::format("{}{:02x}{:02x}{:016x}{:016x}", kPrefix, static_cast<unsigned>(order),
                     static_cast<unsigned>(last.kind), static_cast<std::uint64_t>(UnixMs(last.at)),
                     last.entry);
}

absl::StatusOr<StoryPlace> PlaceFromToken(storage::ListOrder order, std::string_view token) {
  const absl::Status none_of_ours =
      absl::InvalidArgumentError("pageToken is not one that this story gave");
  if (token.size() != kTokenBytes || !token.starts_with(kPrefix)) return none_of_ours;
  token.remove_prefix(kPrefix.size());
  const std::optional<std::uint64_t> in_order = TakeHex(token, kByteDigits);
  const std::optional<std::uint64_t> kind = TakeHex(token, kByteDigits);
  const std::optional<std::uint64_t> at = TakeHex(token, kNumberDigits);
  const std::optional<std::uint64_t> entry = TakeHex(token, kNumberDigits);
  if (!in_order || !kind || !at || !entry || *kind >= kStoryKinds) return none_of_ours;
  if (*in_order != static_cast<std::uint64_t>(order)) {
    return absl::InvalidArgumentError("pageToken belongs to the story in another order");
  }
  return StoryPlace{.at = FromUnixMs(static_cast<std::int64_t>(*at)),
                    .kind = static_cast<StoryKind>(*kind),
                    .entry = *entry};
}

std::string ListTokenAfter(storage::PageKind list, StoryKind of, storage::ListOrder order,
                           const StoryPlace& after) {
  // At the time of `after` a list's rows are all still to come, or all told: kinds have their
  // order.
  std::uint64_t entry = after.entry;
  if (of < after.kind) entry = model::kSeqMax;
  if (of > after.kind) entry = 0;
  return storage::EncodePageToken(list, order, {.at = after.at, .entry = entry});
}

}  // namespace uplink::view
