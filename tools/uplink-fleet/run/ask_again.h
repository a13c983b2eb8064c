#pragma once

#include <string>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/run/run_context.h"

namespace uplink::synthetic {

/// For a server that does not answer while it is looked at: a start takes a second or two.
inline constexpr milliseconds kAnswerDeadline{10'000};

/// Asks again for some seconds while the server does not answer: it may be starting. Gives the last
/// answer at the deadline, or when a signal comes. `run` is a RunContext or a TwinContext.
template <typename Context, typename Ask>
[[nodiscard]] auto AskAgain(const Context& run, const Ask& ask) -> decltype(ask()) {
  const SteadyTime start = run.clock.Steady();
  while (true) {
    auto answer = ask();
    if (answer.ok() || run.clock.Steady() - start > kAnswerDeadline) return answer;
    run.shared.first_error.Keep(std::string(answer.status().message()));
    if (run.signals.Wait(kLook)) return answer;
  }
}

}  // namespace uplink::synthetic
