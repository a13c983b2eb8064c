#include "server/http/entity_tag.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <fmt/format.h>
#include <openssl/sha.h>

#include "schema/base/check.h"

namespace uplink::http {
namespace {

/// Of the hash. Robots choose parts of a text, so this is enough that none makes two texts alike.
constexpr std::size_t kTagBytes = 16;
constexpr std::string_view kWeak = "W/";

std::string_view WithoutWeak(std::string_view tag) {
  if (tag.starts_with(kWeak)) tag.remove_prefix(kWeak.size());
  return tag;
}

}  // namespace

std::string EntityTag(std::string_view text) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash{};
  UPLINK_CHECK(SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(),
                      hash.data()) != nullptr,
               "OpenSSL can hash");
  const auto end = hash.begin() + kTagBytes;
  return fmt::format("{}\"{:02x}\"", kWeak, fmt::join(hash.begin(), end, ""));
}

bool NamesTag(std::string_view if_none_match, std::string_view tag) {
  std::string_view rest = if_none_match;
  const auto skip = [&rest](std::string_view what) {
    rest.remove_prefix(std::min(rest.find_first_not_of(what), rest.size()));
  };
  skip(" \t");
  if (rest.starts_with('*')) {
    rest.remove_prefix(1);
    skip(" \t");
    return rest.empty();
  }
  while (true) {
    skip(" \t,");
    rest = WithoutWeak(rest);
    if (!rest.starts_with('"')) return false;
    const std::size_t end = rest.find('"', 1);
    if (end == std::string_view::npos) return false;
    if (rest.substr(0, end + 1) == WithoutWeak(tag)) return true;
    rest.remove_prefix(end + 1);
  }
}

}  // namespace uplink::http
