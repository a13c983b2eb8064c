#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace uplink::broker {

/// Stray prefixes that are unsubscribed per connection; messages under further ones are ignored.
inline constexpr std::size_t kStrayPrefixesMax = 8;

/// Prefixes that the configuration no longer has, and under which the broker still delivers: the
/// kept session has old subscriptions. Confined to its owner's thread.
class StrayPrefixes final {
 public:
  /// `wanted` as cyberwave.topic_prefixes.
  explicit StrayPrefixes(std::vector<std::string> wanted) : wanted_(std::move(wanted)) {}

  /// A message came on a foreign topic. True if that shows a new stray prefix.
  [[nodiscard]] bool Add(std::string_view topic);
  [[nodiscard]] const std::vector<std::string>& prefixes() const { return stray_; }
  /// The subscriptions of the durable connection under them.
  [[nodiscard]] std::vector<std::string> Filters() const;
  /// Begins a new connection, which may have others.
  void Clear() { stray_.clear(); }

 private:
  const std::vector<std::string> wanted_;
  std::vector<std::string> stray_;
};

}  // namespace uplink::broker
