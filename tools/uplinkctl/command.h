#pragma once

#include <functional>
#include <string_view>

#include <absl/status/status.h>

// NOLINTNEXTLINE(readability-identifier-naming): the library's own
namespace CLI {
class App;
}

namespace uplink::ctl {

/// Exit codes of the program (surface page).
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitWrongUse = 2;

/// What the parsed command line asks for; runs after parsing and returns the exit code.
using Action = std::function<int()>;

/// Adds the noun `pki` and its verbs; the chosen verb puts its work into `action`.
void AddPki(CLI::App& app, Action& action);

/// Adds the noun `config` and its verbs.
void AddConfig(CLI::App& app, Action& action);

/// Adds the noun `store` and its verbs.
void AddStore(CLI::App& app, Action& action);

/// Prints the error, if there is one, and returns the exit code that fits: bad input is wrong use.
[[nodiscard]] int ExitOf(const absl::Status& status);

/// Asks a question on the terminal. Whoever answers anything but `yes` is taken for a no.
[[nodiscard]] bool SaysYes(std::string_view question);

}  // namespace uplink::ctl
