#include "storage/page_token.h"

#include <array>
#include <cstddef>

#include <absl/status/status.h>

namespace uplink::storage {
namespace {

constexpr std::string_view kHexDigits = "0123456789abcdef";
/// List and order.
constexpr std::size_t kListBytes = 2;
constexpr std::size_t kNumberBytes = 8;
constexpr std::size_t kSumBytes = 4;
constexpr std::size_t kSummedBytes = kListBytes + 2 * kNumberBytes;
constexpr std::size_t kTokenBytes = kSummedBytes + kSumBytes;

using TokenBytes = std::array<std::uint8_t, kTokenBytes>;

void Put(TokenBytes& bytes, std::size_t at, std::size_t length, std::uint64_t number) {
  for (std::size_t i = 0; i < length; ++i) {
    bytes[at + length - 1 - i] = static_cast<std::uint8_t>(number >> (8 * i));
  }
}

std::uint64_t Get(const TokenBytes& bytes, std::size_t at, std::size_t length) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < length; ++i) number = (number << 8) | bytes[at + i];
  return number;
}

// FNV-1a: finds typing errors and texts of others; a token grants nothing, so it needs no secret.
std::uint32_t Sum(const TokenBytes& bytes) {
  std::uint32_t sum = 2166136261U;
  for (std::size_t i = 0; i < kSummedBytes; ++i) sum = (sum ^ bytes[i]) * 16777619U;
  return sum;
}

std::optional<TokenBytes> FromHex(std::string_view token) {
  if (token.size() != 2 * kTokenBytes) return std::nullopt;
  TokenBytes bytes{};
  for (std::size_t i = 0; i < token.size(); ++i) {
    const std::size_t digit = kHexDigits.find(token[i]);
    if (digit == std::string_view::npos) return std::nullopt;
    bytes[i / 2] = static_cast<std::uint8_t>((std::size_t{bytes[i / 2]} << 4U) | digit);
  }
  return bytes;
}

}  // namespace

std::string EncodePageToken(PageKind kind, ListOrder order, const PagePosition& position) {
  TokenBytes bytes{};
  bytes[0] = static_cast<std::uint8_t>(kind);
  bytes[1] = static_cast<std::uint8_t>(order);
  Put(bytes, kListBytes, kNumberBytes, static_cast<std::uint64_t>(UnixMs(position.at)));
  Put(bytes, kListBytes + kNumberBytes, kNumberBytes, position.entry);
  Put(bytes, kSummedBytes, kSumBytes, Sum(bytes));
  std::string token;
  token.reserve(2 * kTokenBytes);
  for (const std::uint8_t byte : bytes) {
    token.push_back(kHexDigits[byte >> 4]);
    token.push_back(kHexDigits[byte & 0xF]);
  }
  return token;
}

absl::StatusOr<PagePosition> DecodePageToken(PageKind kind, ListOrder order,
                                             std::string_view token) {
  const std::optional<TokenBytes> bytes = FromHex(token);
  if (!bytes || Get(*bytes, kSummedBytes, kSumBytes) != Sum(*bytes)) {
    return absl::InvalidArgumentError("pageToken is not one that this server gave");
  }
  if ((*bytes)[0] != static_cast<std::uint8_t>(kind)) {
    return absl::InvalidArgumentError("pageToken belongs to another list");
  }
  if ((*bytes)[1] != static_cast<std::uint8_t>(order)) {
    return absl::InvalidArgumentError("pageToken belongs to the list in another order");
  }
  PagePosition position;
  position.at = FromUnixMs(static_cast<std::int64_t>(Get(*bytes, kListBytes, kNumberBytes)));
  position.entry = Get(*bytes, kListBytes + kNumberBytes, kNumberBytes);
  return position;
}

absl::StatusOr<std::optional<PagePosition>> PageStart(PageKind kind, const HistoryQuery& query) {
  if (query.page_size < 1 || query.page_size > kPageSizeMax) {
    return absl::InvalidArgumentError("pageSize " + std::to_string(query.page_size) +
                                      " is outside 1 to " + std::to_string(kPageSizeMax));
  }
  if (query.ruris.size() > kRurisMax) {
    return absl::InvalidArgumentError("ruri: more than " + std::to_string(kRurisMax) + " robots");
  }
  if (query.fleets.size() > kFleetsMax) {
    return absl::InvalidArgumentError("fleet: more than " + std::to_string(kFleetsMax) + " fleets");
  }
  if (query.page_token.empty()) return std::optional<PagePosition>();
  absl::StatusOr<PagePosition> position = DecodePageToken(kind, query.order, query.page_token);
  if (!position.ok()) return position.status();
  return std::optional<PagePosition>(*position);
}

}  // namespace uplink::storage
