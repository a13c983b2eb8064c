#pragma once

#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/config/config.h"
#include "server/config/settings.h"

namespace uplink::config {

/// The place of a key that the environment sets.
inline constexpr std::string_view kEnvironment = "environment";

/// Where keys were set, by FullKey: `uplinkd.toml:12`, or kEnvironment. A key that is not in it
/// has its default.
using Places = std::map<std::string, std::string>;

/// A key and what it is in effect. A value.
struct EffectiveKey {
  /// A row of Settings().
  const Setting* setting = nullptr;
  /// As ValueText: secrets are masked.
  std::string value;
  /// Empty: nothing set it.
  std::string place;
};

/// All keys, in the order of Settings(), but those without effect while they have their default:
/// read back, they would be noted as set. Pure.
[[nodiscard]] std::vector<EffectiveKey> EffectiveKeys(const Config& config, const Places& places);

/// The configuration of a server that runs, for those who ask for it. Thread-safe.
class InEffect final {
 public:
  /// `file`: what was read.
  InEffect(std::string file, Config config, Places places);
  InEffect(const InEffect&) = delete;
  InEffect& operator=(const InEffect&) = delete;

  /// The configuration was read again: what a reload takes over changes, the rest stays.
  void TakeOver(const Config& read, const Places& places);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::vector<EffectiveKey> Keys() const;

 private:
  const std::string file_;
  mutable std::mutex mutex_;
  Config config_;
  Places places_;
};

}  // namespace uplink::config
