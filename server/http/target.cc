#include "server/http/target.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "server/http/header_text.h"

namespace uplink::http {
namespace {

constexpr std::array<std::string_view, 2> kSchemes{"http://", "https://"};

/// Bytes of the scheme that a target in absolute-form begins with; 0: it begins with none.
std::size_t SchemeBytes(std::string_view target) {
  for (const std::string_view scheme : kSchemes) {
    if (SameWord(target.substr(0, scheme.size()), scheme)) return scheme.size();
  }
  return 0;
}

int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

std::optional<std::string> PercentDecode(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    if (text.size() - i < 3) return std::nullopt;
    const int high = HexDigit(text[i + 1]);
    const int low = HexDigit(text[i + 2]);
    if (high < 0 || low < 0 || (high == 0 && low == 0)) return std::nullopt;
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

Target SplitTarget(std::string_view target) {
  const std::size_t mark = target.find('?');
  if (mark == std::string_view::npos) return {target, {}};
  return {target.substr(0, mark), target.substr(mark + 1)};
}

bool IsAbsolute(std::string_view target) { return SchemeBytes(target) > 0; }

std::optional<AbsoluteTarget> SplitAbsolute(std::string_view target) {
  target.remove_prefix(SchemeBytes(target));
  const std::size_t end = std::min(target.find_first_of("/?"), target.size());
  const std::string_view authority = target.substr(0, end);
  if (authority.empty() || authority.front() == ':' || authority.find('@') != authority.npos) {
    return std::nullopt;
  }
  const std::string_view rest = target.substr(end);
  return AbsoluteTarget{std::string(authority),
                        (rest.starts_with('/') ? "" : "/") + std::string(rest)};
}

std::optional<PathMatch> MatchPath(std::string_view pattern, std::string_view path) {
  const std::size_t hole = pattern.find("{}");
  if (hole == std::string_view::npos) {
    if (pattern != path) return std::nullopt;
    return PathMatch{};
  }
  const std::string_view before = pattern.substr(0, hole);
  const std::string_view after = pattern.substr(hole + 2);
  if (!path.starts_with(before)) return std::nullopt;
  path.remove_prefix(before.size());
  const std::size_t end = path.find('/');
  const std::string_view rest = end == std::string_view::npos ? "" : path.substr(end);
  if (rest != after) return std::nullopt;
  std::optional<std::string> segment = PercentDecode(path.substr(0, end));
  if (!segment || segment->empty()) return std::nullopt;
  return PathMatch{std::move(*segment)};
}

}  // namespace uplink::http
