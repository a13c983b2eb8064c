#include "server/identity/token_table.h"

#include <algorithm>
#include <map>
#include <utility>
#include <variant>

#include <fmt/core.h>
#include <openssl/crypto.h>
#include <openssl/sha.h>

#include "server/identity/token_line.h"

namespace uplink::identity {
namespace {

static_assert(std::tuple_size_v<TokenHash> == SHA256_DIGEST_LENGTH);

absl::Status Wrong(std::string_view path, std::size_t line, std::string_view flaw) {
  return absl::InvalidArgumentError(fmt::format("{}: line {}: {}", path, line, flaw));
}

/// RFC 4648, section 5, without padding.
std::string Base64Url(const std::array<std::uint8_t, kTokenRandomBytes>& bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  constexpr unsigned kDigitBits = 6;
  constexpr unsigned kDigitMask = (1U << kDigitBits) - 1;
  std::string text;
  std::uint32_t pending = 0;
  unsigned bits = 0;
  for (const std::uint8_t byte : bytes) {
    pending = pending << 8U | byte;
    for (bits += 8; bits >= kDigitBits; bits -= kDigitBits) {
      text += kAlphabet[pending >> (bits - kDigitBits) & kDigitMask];
    }
  }
  if (bits > 0) text += kAlphabet[pending << (kDigitBits - bits) & kDigitMask];
  return text;
}

}  // namespace

absl::StatusOr<TokenTable> TokenTable::Parse(std::string_view text, std::string_view path) {
  if (text.size() > kTokensFileBytesMax) {
    return absl::InvalidArgumentError(
        fmt::format("{}: has {} bytes, the limit is {}", path, text.size(), kTokensFileBytesMax));
  }
  TokenTable table;
  std::map<std::string, std::size_t> line_of;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.find_first_not_of(" \t") == std::string_view::npos || line.front() == '#') continue;
    auto read = ReadTokenLine(line);
    if (const auto* flaw = std::get_if<TokenFlaw>(&read)) return Wrong(path, number, flaw->text);
    auto& entry = std::get<TokenEntry>(read);
    const auto [other, is_new] = line_of.emplace(entry.id, number);
    if (!is_new) {
      return Wrong(
          path, number,
          fmt::format("id {}: line {} has it too; revoke one of them", entry.id, other->second));
    }
    if (table.entries_.size() == kTokensMax) {
      return Wrong(path, number, fmt::format("there are more than {} tokens", kTokensMax));
    }
    table.entries_.push_back(std::move(entry));
  }
  return table;
}

TokenTable::Found TokenTable::Find(std::string_view token, SystemTime now) const {
  const TokenHash hash = HashOfToken(token);
  const TokenEntry* found = nullptr;
  // All of them are looked at, whichever it is.
  for (const TokenEntry& entry : entries_) {
    if (CRYPTO_memcmp(entry.hash.data(), hash.data(), hash.size()) == 0) found = &entry;
  }
  if (found == nullptr) return {};
  const bool expired = found->expires && *found->expires <= now;
  return {expired ? Finding::kExpired : Finding::kValid, found};
}

TokenHash HashOfToken(std::string_view token) {
  TokenHash hash{};
  // The library's bytes are unsigned char; looking at chars as such is always allowed.
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), hash.data());
  return hash;
}

bool HasHash(std::string_view token, const TokenHash& hash) {
  return CRYPTO_memcmp(HashOfToken(token).data(), hash.data(), hash.size()) == 0;
}

NewToken MakeToken(const std::array<std::uint8_t, kTokenRandomBytes>& random) {
  NewToken made{.token = std::string(kTokenPrefix) + Base64Url(random), .hash = {}};
  made.hash = HashOfToken(made.token);
  return made;
}

}  // namespace uplink::identity
