#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace uplink::broker {

/// Prefixes of a connection that are taken back; further ones go on being ignored.
inline constexpr std::size_t kStrayPrefixesMax = 8;

/// Prefixes under which a broker delivers though nobody wants them any more: the kept session has
/// subscriptions from before the configuration changed. Confined to its owner's thread.
class StrayPrefixes final {
 public:
  /// `wanted` as cyberwave.topic_prefixes.
  explicit StrayPrefixes(std::vector<std::string> wanted) : wanted_(std::move(wanted)) {}

  /// A message came on a topic that is none of ours. True if it shows a prefix that was not known
  /// as stray.
  [[nodiscard]] bool Add(std::string_view topic);
  [[nodiscard]] const std::vector<std::string>& prefixes() const { return stray_; }
  /// What was subscribed to under them on the durable connection.
  [[nodiscard]] std::vector<std::string> Filters() const;
  /// A new connection, which may have others.
  void Clear() { stray_.clear(); }

 private:
  const std::vector<std::string> wanted_;
  std::vector<std::string> stray_;
};

}  // namespace uplink::broker
