#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace uplink::ctl {

/// In rising order.
enum class Severity : std::uint8_t {
  kOk,
  /// The server works, and something is wrong or soon will be.
  kWarning,
  /// The server does not start, or does not serve or store as configured.
  kError,
};

/// What a check found. A value.
struct Finding {
  Severity severity = Severity::kOk;
  /// A key of the configuration or a place: `tls.key_file`, `disk`.
  std::string where;
  /// What is wrong, with the file, address or value that it is about.
  std::string what;
  /// What to do; empty if all is well, or if `what` says it.
  std::string remedy = {};

  friend bool operator==(const Finding&, const Finding&) = default;
};
using Findings = std::vector<Finding>;

[[nodiscard]] Finding Ok(std::string where, std::string what);
[[nodiscard]] Finding Warning(std::string where, std::string what, std::string remedy);
[[nodiscard]] Finding Error(std::string where, std::string what, std::string remedy);

/// One line: `error    listen.relay: port 7443 is held by nginx; stop it`.
[[nodiscard]] std::string ToText(const Finding& finding);

void Append(Findings& to, Findings from);

/// Exit codes of `doctor` (docs/reference/exit-codes.md).
inline constexpr int kExitWarnings = 1;
inline constexpr int kExitErrors = 2;

/// By the worst of them.
[[nodiscard]] int ExitOfFindings(const Findings& findings);

/// The last line: `2 errors, 1 warning`.
[[nodiscard]] std::string Summary(const Findings& findings);

}  // namespace uplink::ctl
