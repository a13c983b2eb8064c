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

std::optional<std::string> FlawOfForm(std::string_view ruri) {
  if (ruri.find('?') != std::string_view::npos) return "holds a query";
  if (ruri.find('#') != std::string_view::npos) return "holds a fragment";
  std::string_view host = ruri.substr(std::min(kRuriScheme.size(), ruri.size()));
  host = host.substr(0, host.find('/'));
  host = host.substr(0, host.find(':'));
  if (host.ends_with('.')) return "has a host that ends with a dot";
  if (std::ranges::any_of(host, [](char c) { return c >= 'A' && c <= 'Z'; })) {
    return "has a host with capital letters";
  }
  return std::nullopt;
}

bool NamesTwin(std::string_view ruri) { return cyberwave::IsTwinRuri(schema::NormalRuri(ruri)); }

}  // namespace uplink::identity
