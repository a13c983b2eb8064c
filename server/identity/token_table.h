#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/identity/caller.h"

namespace uplink::identity {

/// What a token begins with, so that scanners for secrets find a leaked one.
inline constexpr std::string_view kTokenPrefix = "uplinkd_";
/// Random bytes of a token, which follow the prefix in base64url.
inline constexpr std::size_t kTokenRandomBytes = 32;
/// Tokens of one file, and its bytes.
inline constexpr std::size_t kTokensMax = 1'000;
inline constexpr std::size_t kTokensFileBytesMax = std::size_t{1} * 1024 * 1024;
/// Characters of a token's note.
inline constexpr std::size_t kTokenNoteMax = 200;

/// The SHA-256 of a whole token.
using TokenHash = std::array<std::uint8_t, 32>;

[[nodiscard]] TokenHash HashOfToken(std::string_view token);
/// Whether the token has this hash. Its time tells nothing of how much of it is right.
[[nodiscard]] bool HasHash(std::string_view token, const TokenHash& hash);

/// One line of a file of tokens, which is a JSON object. A value.
struct TokenEntry {
  /// 8 lower-case hexadecimal digits, the first of the hash: what people and logs call it.
  std::string id{};
  Role role = Role::kViewer;
  Scope scope = Scope::Of({});
  /// Nothing: it never expires.
  std::optional<SystemTime> expires{};
  SystemTime created{};
  /// What it is for, in the operator's words; may be empty.
  std::string note{};
  TokenHash hash{};
};

/// The tokens of a file. Immutable.
class TokenTable final {
 public:
  /// Reads a file's text; `path` stands in errors. Empty lines and lines that begin with `#` are
  /// skipped.
  ///
  /// Errors: kInvalidArgument names the line, the member and the limit.
  [[nodiscard]] static absl::StatusOr<TokenTable> Parse(std::string_view text,
                                                        std::string_view path);

  TokenTable() = default;

  enum class Finding : std::uint8_t { kUnknown, kExpired, kValid };
  struct Found {
    Finding finding = Finding::kUnknown;
    /// Null if it is unknown.
    const TokenEntry* entry = nullptr;
  };
  /// Looks for a token as it came. Its time tells nothing of how much of a token is right.
  [[nodiscard]] Found Find(std::string_view token, SystemTime now) const;

  [[nodiscard]] const std::vector<TokenEntry>& entries() const { return entries_; }

 private:
  std::vector<TokenEntry> entries_;
};

/// The line that Parse reads back, without a line end. Pure; any thread.
[[nodiscard]] std::string LineOf(const TokenEntry& entry);

/// A new token of random bytes, and its hash. A value.
struct NewToken {
  std::string token;
  TokenHash hash{};
};
/// Pure; any thread.
[[nodiscard]] NewToken MakeToken(const std::array<std::uint8_t, kTokenRandomBytes>& random);

}  // namespace uplink::identity
