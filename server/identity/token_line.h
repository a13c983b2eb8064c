#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "server/identity/token_table.h"

namespace uplink::identity {

/// What is wrong with a line, as the end of a sentence: it names the member and repeats no hash.
struct TokenFlaw {
  std::string text;
};

/// One line of a file of tokens. A member that is not known is a flaw: misspelt, `expires` would
/// make a token that never expires.
///
/// Thread: pure; any thread.
[[nodiscard]] std::variant<TokenEntry, TokenFlaw> ReadTokenLine(std::string_view line);

/// Why this is no note of a token, as the end of a sentence; nothing if it is one.
[[nodiscard]] std::optional<std::string> FlawOfTokenNote(std::string_view note);

/// The id of the token with this hash.
[[nodiscard]] std::string TokenIdOf(const TokenHash& hash);

}  // namespace uplink::identity
