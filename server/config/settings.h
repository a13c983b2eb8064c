#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/config/config.h"

namespace uplink::config {

/// How a setting is written in TOML and in the environment.
enum class Kind : std::uint8_t {
  kSwitch,    // true, false
  kCount,     // a whole number
  kBytes,     // "64KiB"
  kDuration,  // "10s"
  kText,      // a string
  kFile,      // a path; may be empty
  kChoice,    // one of a few words
  kAddress,   // "[::]:7443", "unix:/run/x.sock"
  kList,      // ["a", "b"]; in the environment a,b
  kNetworks,  // ["10.0.0.0/8", "::1"]; in the environment 10.0.0.0/8,::1
};

/// When a changed value counts.
enum class Effect : std::uint8_t {
  kRestart,  // read once, at start
  kReload,   // read again at SIGHUP
  kNone,     // checked, but what it sets does not exist in this version: setting it is noted
};

/// A word of a kChoice setting, by its place in Setting::choices.
struct Choice {
  std::size_t index = 0;

  friend bool operator==(const Choice&, const Choice&) = default;
};

/// The value of one setting; the alternative follows from its Kind (counts and sizes share one).
using Value = std::variant<bool, std::uint64_t, std::chrono::milliseconds, std::string, Choice,
                           ListenAddress, std::vector<std::string>, std::vector<Network>>;

/// Items of a kList or kNetworks setting, and bytes of one.
inline constexpr std::size_t kListItemsMax = 256;
inline constexpr std::size_t kListItemBytesMax = 256;

/// One key that an operator can set. The only list of keys: reading and printing follow from it,
/// and ReferenceTest holds the example file and the reference page to it.
struct Setting {
  std::string_view section;
  std::string_view key;
  Kind kind = Kind::kText;
  /// Bounds of counts, sizes (bytes) and durations (milliseconds).
  std::uint64_t min = 0;
  std::uint64_t max = 0;
  /// What zero means, if it is allowed below `min`.
  std::string_view zero{};
  /// What an empty text means, if a kAddress setting may be empty.
  std::string_view empty{};
  /// A kAddress setting may be a Unix socket.
  bool unix_socket = false;
  /// The words of a kChoice setting, in the order of its enumeration.
  std::span<const std::string_view> choices{};
  /// What it takes, for people, where this version takes less than `kind` and `choices` say.
  std::string_view allowed{};
  Effect effect = Effect::kRestart;
  /// An item of a list may be empty.
  bool empty_items = false;
  /// The value may hold a password: it is masked when printed and kept out of problems.
  bool secret = false;
  /// One or two sentences for an operator.
  std::string_view text{};
  Value (*get)(const Config&) = nullptr;
  void (*set)(Config&, const Value&) = nullptr;
};

/// A section of the file, in the order of the reference page.
struct Section {
  std::string_view name;
  std::string_view text;
};

[[nodiscard]] std::span<const Section> Sections();
/// All settings, grouped by section in the order of Sections().
[[nodiscard]] std::span<const Setting> Settings();
/// Null if there is no such key.
[[nodiscard]] const Setting* FindSetting(std::string_view section, std::string_view key);

/// `limits.robots_max` and `UPLINKD_LIMITS_ROBOTS_MAX`.
[[nodiscard]] std::string FullKey(const Setting& setting);
[[nodiscard]] std::string EnvironmentName(const Setting& setting);

/// A value in TOML notation (`"10s"`, `20000`, `true`); secrets are masked.
[[nodiscard]] std::string ValueText(const Setting& setting, const Value& value);
/// What the setting takes, for people: `1KiB to 16MiB`, `one of "text", "json"`.
[[nodiscard]] std::string AllowedText(const Setting& setting);

}  // namespace uplink::config
