#include "server/identity/ruri.h"

#include <algorithm>

#include <fmt/format.h>

#include "schema/base/utf8.h"
#include "schema/cyberwave/ruri.h"
#include "schema/model/ids.h"
#include "schema/rcan/ruri.h"

namespace uplink::identity {
namespace {

/// How many bytes of a RURI a message repeats.
constexpr std::size_t kShownBytesMax = 128;

}  // namespace

std::optional<std::string> FlawOfRuri(std::string_view ruri) {
  if (!ruri.starts_with(kRuriScheme)) return fmt::format("does not begin {}", kRuriScheme);
  if (ruri.find('\0') != std::string_view::npos) return "holds a NUL byte";
  if (ruri.size() > model::kRuriBytesMax) {
    return fmt::format("has {} bytes, the limit is {}", ruri.size(), model::kRuriBytesMax);
  }
  if (ruri.size() == kRuriScheme.size()) return "names nothing";
  const bool clean = std::ranges::all_of(ruri, [](char c) { return c > 0x20 && c < 0x7F; });
  if (clean) return std::nullopt;
  return fmt::format("holds white space, a control character or a byte beyond ASCII: {}",
                     PrintableUtf8(ruri, kShownBytesMax));
}

bool NamesTwin(std::string_view ruri) { return cyberwave::IsTwinRuri(schema::NormalRuri(ruri)); }

}  // namespace uplink::identity
