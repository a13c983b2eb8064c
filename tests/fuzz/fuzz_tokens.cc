#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "schema/base/check.h"
#include "schema/base/utf8.h"
#include "server/identity/token_table.h"

namespace {

namespace identity = uplink::identity;

/// Bytes of the longest sentence: the name, a line's number, a word that is cut.
constexpr std::size_t kSentenceBytesMax = 512;

void CheckEntry(const identity::TokenEntry& entry) {
  UPLINK_CHECK(entry.scope.all() || !entry.scope.fleets().empty(), "a token sees something");
  UPLINK_CHECK(entry.scope.fleets().size() <= identity::kScopeFleetsMax, "within its bound");
  UPLINK_CHECK(entry.role != identity::Role::kRobot && entry.role != identity::Role::kGateway,
               "robots have no tokens");
}

bool Same(const identity::TokenEntry& a, const identity::TokenEntry& b) {
  return a.id == b.id && a.role == b.role && a.scope == b.scope && a.expires == b.expires &&
         a.created == b.created && a.note == b.note && a.hash == b.hash;
}

}  // namespace

/// Any text as a file of tokens: what is taken is whole, and comes back as it was when it is
/// written again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto table = identity::TokenTable::Parse(text, "t");
  if (!table.ok()) {
    const std::string said(table.status().message());
    UPLINK_CHECK(absl::IsInvalidArgument(table.status()) && said.starts_with("t: "), "its name");
    UPLINK_CHECK(said.size() <= kSentenceBytesMax && uplink::IsCleanUtf8(said), "a line of text");
    return 0;
  }
  UPLINK_CHECK(table->entries().size() <= identity::kTokensMax, "within their bound");
  std::string again;
  for (const identity::TokenEntry& entry : table->entries()) {
    CheckEntry(entry);
    again += identity::LineOf(entry) + '\n';
  }
  // A text may be longer when it is written again than as it came.
  if (again.size() > identity::kTokensFileBytesMax) return 0;
  const auto second = identity::TokenTable::Parse(again, "t");
  UPLINK_CHECK(second.ok() && second->entries().size() == table->entries().size(), "still good");
  for (std::size_t i = 0; i < second->entries().size(); ++i) {
    UPLINK_CHECK(Same(table->entries()[i], second->entries()[i]), "the same");
  }
  return 0;
}
