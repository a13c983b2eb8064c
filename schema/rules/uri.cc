#include "schema/rules/uri.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace uplink::schema {
namespace {

constexpr std::array<std::string_view, 6> kSecretParameters = {"user",   "username", "pass",
                                                               "passwd", "password", "pwd"};

bool IsSecret(std::string_view name) {
  return std::any_of(kSecretParameters.begin(), kSecretParameters.end(), [&](auto secret) {
    return std::equal(name.begin(), name.end(), secret.begin(), secret.end(), [](char a, char b) {
      return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b;
    });
  });
}

/// A part between separators, without the value of a parameter that is secret.
std::string_view Kept(std::string_view part) {
  const std::size_t equals = part.find('=');
  if (equals == std::string_view::npos || !IsSecret(part.substr(0, equals))) return part;
  return part.substr(0, equals + 1);
}

}  // namespace

std::string WithoutCredentials(std::string_view uri) {
  std::string kept;
  const std::size_t scheme = uri.find("://");
  if (scheme != std::string_view::npos) {
    kept.assign(uri.substr(0, scheme + 3));
    uri.remove_prefix(scheme + 3);
  }
  const std::string_view authority = uri.substr(0, uri.find_first_of("/?#"));
  const std::size_t at = authority.rfind('@');
  if (at != std::string_view::npos) uri.remove_prefix(at + 1);
  // Cameras take parameters in their path, too: `/user=a&password=b&channel=1`.
  while (!uri.empty()) {
    const std::size_t end = std::min(uri.find_first_of("/?#&;"), uri.size());
    kept.append(Kept(uri.substr(0, end)));
    kept.append(uri.substr(end, 1));
    uri.remove_prefix(std::min(end + 1, uri.size()));
  }
  return kept;
}

}  // namespace uplink::schema
