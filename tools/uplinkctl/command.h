#pragma once

#include <string_view>

#include <absl/status/status.h>

#include "server/config/flags.h"

namespace uplink::ctl {

/// Exit codes of the program (docs/reference/exit-codes.md).
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitWrongUse = 2;

/// Adds the noun `pki` and its verbs.
void AddPki(config::Flags& program);

/// Adds the noun `config` and its verbs.
void AddConfig(config::Flags& program);

/// Adds the noun `store` and its verbs.
void AddStore(config::Flags& program);

/// Adds the noun `tokens` and its verbs.
void AddTokens(config::Flags& program);

/// Adds `health`, which has no verbs.
void AddHealth(config::Flags& program);

/// Adds the noun `contexts` and its verbs.
void AddContexts(config::Flags& program);

/// Adds `doctor`, which has no verbs.
void AddDoctor(config::Flags& program);

/// Prints the error, if there is one, and returns the exit code that fits: bad input is wrong use.
[[nodiscard]] int ExitOf(const absl::Status& status);

/// Asks a question on the terminal. Any answer but `yes` is a no.
[[nodiscard]] bool SaysYes(std::string_view question);

}  // namespace uplink::ctl
