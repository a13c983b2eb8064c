#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace uplink::http {

/// Resolves `%XX`; nothing for a broken sequence or a NUL. A plus sign is itself.
[[nodiscard]] std::optional<std::string> PercentDecode(std::string_view text);

/// The two halves of a request's target, still encoded. Views of the target.
struct Target {
  std::string_view path;
  std::string_view query;
};

/// Cuts at the first question mark.
[[nodiscard]] Target SplitTarget(std::string_view target);

/// The two parts of a target in absolute-form (`http://host:7480/livez?x=1`). A value.
struct AbsoluteTarget {
  /// Never empty, without a user.
  std::string authority;
  /// In origin-form (RFC 9112, 3.2.1): `/livez?x=1`; `/` for none.
  std::string target;
};

/// Whether a target begins with `http://` or `https://`, in any case.
[[nodiscard]] bool IsAbsolute(std::string_view target);
/// Takes such a target apart; nothing if its host is empty or it names a user.
[[nodiscard]] std::optional<AbsoluteTarget> SplitAbsolute(std::string_view target);

/// What a route's pattern found in a path: the decoded `{}` segment, if the pattern has one.
struct PathMatch {
  std::string segment;
};

/// Matches an encoded path against a pattern such as `/api/v1/robots/{}/gaps`, where `{}` stands
/// for one segment that is not empty (a slash in it must be encoded).
[[nodiscard]] std::optional<PathMatch> MatchPath(std::string_view pattern, std::string_view path);

}  // namespace uplink::http
