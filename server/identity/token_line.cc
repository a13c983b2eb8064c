#include "server/identity/token_line.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <boost/json.hpp>
#include <fmt/core.h>

#include "schema/base/rfc3339.h"
#include "schema/base/utf8.h"
#include "schema/json/exact.h"
#include "server/identity/fleet_name.h"
#include "server/identity/invisible_characters.h"

namespace uplink::identity {
namespace {

namespace js = boost::json;

/// An object with a list in it.
constexpr std::size_t kDepthMax = 2;
/// How many bytes of a wrong word a flaw repeats.
constexpr std::size_t kShownBytesMax = 128;
/// Bytes of a hash that its id shows.
constexpr std::size_t kIdBytes = 4;
constexpr std::string_view kDigits = "0123456789abcdef";
constexpr std::array<std::string_view, 7> kMembers = {"id",      "role", "fleets", "expires",
                                                      "created", "note", "sha256"};

std::string_view ViewOf(const js::string& text) { return {text.data(), text.size()}; }

js::string_view NameOf(std::string_view name) { return {name.data(), name.size()}; }

std::string HexOf(const std::uint8_t* bytes, std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size; ++i) {
    text += kDigits[bytes[i] >> 4U];
    text += kDigits[bytes[i] & 0xFU];
  }
  return text;
}

std::optional<TokenHash> HashFromHex(std::string_view digits) {
  TokenHash hash{};
  if (digits.size() != 2 * hash.size()) return std::nullopt;
  for (std::size_t i = 0; i < hash.size(); ++i) {
    const std::size_t high = kDigits.find(digits[2 * i]);
    const std::size_t low = kDigits.find(digits[2 * i + 1]);
    if (high == std::string_view::npos || low == std::string_view::npos) return std::nullopt;
    hash[i] = static_cast<std::uint8_t>(high << 4U | low);
  }
  return hash;
}

/// Reads the members of one object, and keeps the first flaw.
class Reader {
 public:
  explicit Reader(const js::object& object) : object_(object) {}

  /// The text of a member; empty, with a flaw, if it is none.
  std::string_view Text(std::string_view name) {
    const js::value* const value = object_.if_contains(NameOf(name));
    if (value == nullptr) {
      Wrong(fmt::format("has no {}", name));
    } else if (const js::string* const text = value->if_string()) {
      return ViewOf(*text);
    } else {
      Wrong(fmt::format("{} is no string", name));
    }
    return {};
  }
  [[nodiscard]] bool Has(std::string_view name) const { return object_.contains(NameOf(name)); }

  SystemTime Time(std::string_view name) {
    const std::string_view text = Text(name);
    const std::optional<SystemTime> time = FromRfc3339(text);
    if (!time) {
      Wrong(fmt::format("{} \"{}\": it must be a time such as \"2027-03-01T00:00:00Z\"", name,
                        PrintableUtf8(text, kShownBytesMax)));
    }
    return time.value_or(SystemTime());
  }

  Scope Fleets() {
    const js::value* const value = object_.if_contains("fleets");
    const js::array* const list = value == nullptr ? nullptr : value->if_array();
    if (list == nullptr || list->empty() || list->size() > kScopeFleetsMax) {
      Wrong(fmt::format("fleets: it must be a list of 1 to {} names, or of \"*\" alone",
                        kScopeFleetsMax));
      return Scope::Of({});
    }
    std::vector<std::string> fleets;
    for (const js::value& each : *list) {
      const js::string* const name = each.if_string();
      const std::optional<std::string> flaw =
          name == nullptr ? "is no string" : FlawOfFleet(ViewOf(*name));
      if (flaw) {
        Wrong(fmt::format("fleets: one {}", *flaw));
        return Scope::Of({});
      }
      fleets.emplace_back(ViewOf(*name));
    }
    if (std::ranges::find(fleets, kAllFleets) == fleets.end()) return Scope::Of(std::move(fleets));
    if (fleets.size() > 1) Wrong("fleets: \"*\" means all of them, so it must stand alone");
    return Scope::All();
  }

  void Wrong(std::string flaw) {
    if (flaw_.empty()) flaw_ = std::move(flaw);
  }
  [[nodiscard]] std::string& flaw() { return flaw_; }

 private:
  const js::object& object_;
  std::string flaw_;
};

Role RoleOf(Reader& reader) {
  const std::string_view text = reader.Text("role");
  const std::optional<Role> role = AskingRoleOf(text);
  if (!role) {
    reader.Wrong(fmt::format("role \"{}\": it must be viewer, operator, admin or metrics",
                             PrintableUtf8(text, kShownBytesMax)));
  }
  return role.value_or(Role::kViewer);
}

std::variant<TokenEntry, TokenFlaw> ReadObject(const js::object& object) {
  for (const auto& member : object) {
    const std::string_view name(member.key().data(), member.key().size());
    if (std::ranges::find(kMembers, name) != kMembers.end()) continue;
    return TokenFlaw{
        fmt::format("{} is no member of a token", PrintableUtf8(name, kShownBytesMax))};
  }
  Reader reader(object);
  TokenEntry entry;
  entry.id = reader.Text("id");
  entry.role = RoleOf(reader);
  entry.scope = reader.Fleets();
  if (reader.Has("expires")) entry.expires = reader.Time("expires");
  entry.created = reader.Time("created");
  if (reader.Has("note")) {
    entry.note = reader.Text("note");
    if (auto flaw = FlawOfTokenNote(entry.note)) reader.Wrong(fmt::format("note {}", *flaw));
  }
  const std::optional<TokenHash> hash = HashFromHex(reader.Text("sha256"));
  if (!hash) {
    reader.Wrong("sha256: it must be 64 lower-case hexadecimal digits");
  } else if (entry.id != TokenIdOf(*hash)) {
    reader.Wrong("id: it must be the first 8 digits of sha256");
  }
  if (!reader.flaw().empty()) return TokenFlaw{std::move(reader.flaw())};
  entry.hash = *hash;
  return entry;
}

}  // namespace

std::variant<TokenEntry, TokenFlaw> ReadTokenLine(std::string_view line) {
  const json::ExactReading read = json::ReadExact(line, {.depth_max = kDepthMax, .memory = {}});
  const js::object* const object = read.error ? nullptr : read.value.if_object();
  if (object == nullptr) return TokenFlaw{"is no JSON object of a token"};
  return ReadObject(*object);
}

std::optional<std::string> FlawOfTokenNote(std::string_view note) {
  if (!IsCleanUtf8(note)) return "is no text in UTF-8";
  const auto characters = static_cast<std::size_t>(std::ranges::count_if(
      note, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
  if (characters > kTokenNoteMax) {
    return fmt::format("has {} characters, the limit is {}", characters, kTokenNoteMax);
  }
  const bool control = std::ranges::any_of(
      note, [](char c) { return static_cast<unsigned char>(c) < 0x20U || c == 0x7F; });
  if (control || InvisibleCharacter(note)) return "holds a control or an invisible character";
  return std::nullopt;
}

std::string TokenIdOf(const TokenHash& hash) { return HexOf(hash.data(), kIdBytes); }

std::string LineOf(const TokenEntry& entry) {
  js::array fleets;
  if (entry.scope.all()) fleets.emplace_back(NameOf(kAllFleets));
  for (const std::string& fleet : entry.scope.fleets()) fleets.emplace_back(fleet);
  js::object object{{"id", entry.id},
                    {"role", NameOf(ToText(entry.role))},
                    {"fleets", std::move(fleets)},
                    {"created", Rfc3339(entry.created)}};
  if (entry.expires) object["expires"] = Rfc3339(*entry.expires);
  if (!entry.note.empty()) object["note"] = entry.note;
  object["sha256"] = HexOf(entry.hash.data(), entry.hash.size());
  return js::serialize(object);
}

}  // namespace uplink::identity
