#include "tools/uplinkctl/tokens/request.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <openssl/rand.h>

#include "schema/base/utf8.h"
#include "server/config/units.h"
#include "server/identity/fleet_name.h"
#include "server/identity/token_line.h"
#include "tools/uplinkctl/tokens/change.h"

namespace uplink::ctl {
namespace {

/// How many bytes of a wrong text an error repeats.
constexpr std::size_t kShownBytesMax = 128;

absl::Status Bad(const std::string& text) { return absl::InvalidArgumentError(text); }

std::optional<std::string> FlawOf(const std::string& fleet) {
  if (!IsCleanUtf8(fleet)) return "is no text in UTF-8";
  return identity::FlawOfNewFleet(fleet);
}

absl::StatusOr<identity::Scope> ScopeOf(const std::vector<std::string>& fleets) {
  for (const std::string& fleet : fleets) {
    if (const auto flaw = FlawOf(fleet)) {
      return Bad(fmt::format("--fleet \"{}\" {}", PrintableUtf8(fleet, kShownBytesMax), *flaw));
    }
  }
  if (std::ranges::find(fleets, identity::kAllFleets) != fleets.end()) {
    if (fleets.size() > 1) return Bad("--fleet * means all fleets; leave the others out");
    return identity::Scope::All();
  }
  identity::Scope scope = identity::Scope::Of(fleets);
  if (scope.fleets().empty()) return Bad("--fleet is required; * means all fleets");
  if (scope.fleets().size() > identity::kScopeFleetsMax) {
    return Bad(fmt::format("--fleet is given {} times; one token has at most {} fleets",
                           scope.fleets().size(), identity::kScopeFleetsMax));
  }
  return scope;
}

/// What stands in the file, with whole lines.
std::string WholeLines(std::string text) {
  if (!text.empty() && text.back() != '\n') text += '\n';
  return text;
}

/// Reads one line; nothing for a comment, an empty line or a flaw.
std::optional<identity::TokenEntry> EntryIn(std::string_view line) {
  auto read = identity::ReadTokenLine(line);
  auto* const entry = std::get_if<identity::TokenEntry>(&read);
  return entry == nullptr ? std::nullopt : std::optional(std::move(*entry));
}

}  // namespace

absl::StatusOr<identity::TokenEntry> EntryOf(const TokenRequest& request, SystemTime now) {
  const std::optional<identity::Role> role = identity::AskingRoleOf(request.role);
  if (!role) return Bad("--role must be viewer, operator, admin or metrics");
  auto scope = ScopeOf(request.fleets);
  if (!scope.ok()) return scope.status();
  if (const auto flaw = identity::FlawOfTokenNote(request.note)) {
    return Bad(fmt::format("--note {}", *flaw));
  }
  identity::TokenEntry entry{.role = *role,
                             .scope = *std::move(scope),
                             .created = std::chrono::floor<std::chrono::seconds>(now),
                             .note = request.note};
  if (request.expires == kNever) return entry;
  const auto life = config::ParseDuration(request.expires);
  if (!life || *life < std::chrono::seconds(1) || *life > kTokenLifeMax) {
    return Bad(
        fmt::format("--expires \"{}\": it must be a duration such as 90d, of 1s to {}d, or "
                    "{}",
                    PrintableUtf8(request.expires, kShownBytesMax), kTokenLifeMax.count(), kNever));
  }
  entry.expires = std::chrono::floor<std::chrono::seconds>(now + *life);
  return entry;
}

absl::StatusOr<std::string> AddToken(const std::string& path, identity::TokenEntry& entry) {
  std::string token;
  const auto add = [&](const identity::ReadTokens& read) -> absl::StatusOr<std::string> {
    const auto taken = [&read](const std::string& id) {
      return std::ranges::any_of(read.table.entries(),
                                 [&id](const auto& other) { return other.id == id; });
    };
    do {
      std::array<std::uint8_t, identity::kTokenRandomBytes> random{};
      if (RAND_bytes(random.data(), static_cast<int>(random.size())) != 1) {
        return absl::InternalError("the machine has no randomness");
      }
      identity::NewToken made = identity::MakeToken(random);
      token = std::move(made.token);
      entry.hash = made.hash;
      entry.id = identity::TokenIdOf(made.hash);
    } while (taken(entry.id));
    return WholeLines(read.text) + identity::LineOf(entry) + '\n';
  };
  if (absl::Status changed = ChangeTokens(path, Missing::kIsEmpty, add); !changed.ok()) {
    return changed;
  }
  return token;
}

absl::Status RevokeToken(const std::string& path, const std::string& id) {
  const auto remove = [&](const identity::ReadTokens& read) -> absl::StatusOr<std::string> {
    std::string kept;
    bool found = false;
    for (std::string_view rest = read.text; !rest.empty();) {
      const std::size_t end = std::min(rest.find('\n'), rest.size() - 1) + 1;
      const std::string_view line = rest.substr(0, end);
      rest.remove_prefix(end);
      const auto entry = EntryIn(line);
      if (entry && entry->id == id) {
        found = true;
      } else {
        kept += line;
      }
    }
    if (found) return kept;
    return absl::NotFoundError(
        fmt::format("{}: there is no token {}; uplinkctl tokens list shows those that are there",
                    path, PrintableUtf8(id, kShownBytesMax)));
  };
  return ChangeTokens(path, Missing::kIsAnError, remove);
}

absl::StatusOr<std::string> TokensFileOf(const std::string& file, const std::string& config,
                                         const config::Environment& environment) {
  if (!file.empty()) return file;
  const std::string path = config.empty() ? std::string(config::kConfigFileDefault) : config;
  const config::LoadResult read = config::LoadConfig(path, environment);
  if (!read.readable) {
    return Bad(read.problems.empty() ? path + " cannot be read"
                                     : config::ToText(read.problems.front()));
  }
  if (!read.readable->http.tokens_file.empty()) return read.readable->http.tokens_file;
  return Bad(fmt::format(
      "{} names no http.tokens_file; set that, or name the file by --tokens-file", path));
}

}  // namespace uplink::ctl
