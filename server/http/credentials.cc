#include "server/http/credentials.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "server/http/header_text.h"
#include "server/http/target.h"

namespace uplink::http {
namespace {

constexpr std::string_view kBearer = "Bearer";
constexpr std::array<std::string_view, 2> kTokenParameters{"access_token", "token"};

}  // namespace

std::optional<std::string_view> BearerToken(std::string_view authorization) {
  const std::size_t end = std::min(authorization.find(' '), authorization.size());
  if (!SameWord(authorization.substr(0, end), kBearer)) return std::nullopt;
  const std::size_t first =
      std::min(authorization.find_first_not_of(' ', end), authorization.size());
  return authorization.substr(first);
}

bool HasToken(std::string_view query) {
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    const auto name = PercentDecode(pair.substr(0, pair.find('=')));
    if (name && std::ranges::any_of(kTokenParameters, [&name](std::string_view each) {
          return SameWord(each, *name);
        })) {
      return true;
    }
    query.remove_prefix(std::min(query.size(), pair.size() + 1));
  }
  return false;
}

}  // namespace uplink::http
