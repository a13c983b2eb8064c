#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/config/effective.h"

namespace uplink::config {

/// Which file the server reads, and `uplinkctl health` if it is there, unless a flag names another.
inline constexpr const char* kConfigFileDefault = "/etc/uplinkd/uplinkd.toml";

/// One thing that is wrong in a configuration.
struct Problem {
  /// `file:line` or `environment`; or a file alone: the configuration's, or one that it names.
  std::string where;
  /// `limits.robots_max`; empty for what concerns the whole file or the environment.
  std::string key;
  /// One sentence: what is wrong, and what is allowed or what to do.
  std::string text;

  friend bool operator==(const Problem&, const Problem&) = default;
};

/// What is not wrong, but worth a warning at start.
struct Note : Problem {
  /// The event of the log line.
  std::string event;
};

/// `where: key: text`, as --check-config prints it.
[[nodiscard]] std::string ToText(const Problem& problem);

/// The process environment as name and value pairs; passed in, so that tests need none.
using Environment = std::vector<std::pair<std::string, std::string>>;

/// The environment of this process, only the names that begin with `UPLINKD_`.
[[nodiscard]] Environment ProcessEnvironment();

/// The variable by which a service manager names the machine's boot, where it hides that part of
/// /proc (ProcSubset=pid).
inline constexpr const char* kBootIdVariable = "UPLINK_BOOT_ID";
/// What that variable holds; empty if it is not set.
[[nodiscard]] std::string BootIdOfManager();

/// JOURNAL_STREAM, by which systemd names the stream to its journal; empty if it is not set.
[[nodiscard]] std::string JournalStream();

struct LoadResult {
  /// Present only if `problems` is empty.
  std::optional<Config> config;
  /// What could be read beside the problems: invalid keys hold their defaults. Absent if the text
  /// does not parse. For checks that report their problems together with those.
  std::optional<Config> readable;
  /// All of them: in the order of the file, then of the environment, then relations, then files.
  std::vector<Problem> problems;
  /// Such as keys that are set but have no effect in this version.
  std::vector<Note> notes;
  Places places{};

  [[nodiscard]] bool ok() const { return config.has_value(); }
};

/// Reads the file at `path` and lays the environment over it. Every problem is reported at once,
/// also that everybody may write the file.
///
/// Thread: any; reads one file of at most kConfigBytesMax.
[[nodiscard]] LoadResult LoadConfig(const std::string& path, const Environment& environment);

/// The same for text that is already read; `name` stands in `Problem::where`.
[[nodiscard]] LoadResult ParseConfig(std::string_view toml, const std::string& name,
                                     const Environment& environment);

/// Bytes of the largest configuration file that is read.
inline constexpr std::size_t kConfigBytesMax = 1 * kMiB;

/// What the files and folders that the configuration names have wrong: certificates and keys that
/// are missing, unreadable, not PEM or do not belong together, password files that are empty, a
/// store folder that is missing. Opens files and changes nothing.
[[nodiscard]] std::vector<Problem> ValidateFiles(const Config& config);

/// The result with what ValidateFiles and CheckFileModes (file_modes.h) find beside its own.
[[nodiscard]] LoadResult WithFiles(LoadResult result);

/// Certificates that have expired: the server's, and the one that it shows to a broker. No
/// problems: the server starts with them and says so in /readyz, since the clock may be wrong, and
/// takes over new files without a restart.
[[nodiscard]] std::vector<Note> ExpiredFiles(const Config& config, SystemTime now);

/// The effective configuration as TOML that LoadConfig reads back; secrets are masked,
/// and keys without effect are left out while they have their default.
[[nodiscard]] std::string PrintConfig(const Config& config);

}  // namespace uplink::config
