#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "server/cyberwave/twin_state.h"
#include "server/cyberwave/whose.h"
#include "tests/support/manual_clock.h"
#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::test {

/// A twin's two robots, to which messages are published as a broker passes them on.
class AppliedTwin {
 public:
  cyberwave::Applied Publish(std::string_view tail, std::string_view payload) {
    cyberwave::Judgement judgement = JudgeOn(tail, payload, terms);
    const std::optional<cyberwave::RobotKind> kind = cyberwave::RobotOf(judgement);
    if (!kind) return cyberwave::ApplyToNoRobot(std::move(judgement));
    cyberwave::TwinState& robot = Of(*kind);
    const std::size_t records_max = robot.RecordsAtMost(judgement);
    cyberwave::Applied applied =
        robot.Apply(std::move(judgement), {.steady = clock.Steady(), .system = clock.System()});
    EXPECT_LE(applied.records.size(), records_max);
    return applied;
  }
  cyberwave::Outcome Say(std::string_view tail, std::string_view payload) {
    return Publish(tail, payload).outcome;
  }

  cyberwave::TwinState& Of(cyberwave::RobotKind kind) {
    return kind == cyberwave::RobotKind::kSimulated ? sim_ : real_;
  }
  const cyberwave::TwinParts& real() const { return real_.parts(); }
  const cyberwave::TwinParts& sim() const { return sim_.parts(); }

  testing::ManualClock clock;
  cyberwave::JudgeTerms terms;

 private:
  model::cyberwave::Uuid twin_ = *model::cyberwave::Uuid::FromText(kTwin);
  cyberwave::TwinState real_{twin_};
  cyberwave::TwinState sim_{twin_};
};

}  // namespace uplink::test

namespace uplink::cyberwave {

inline void PrintTo(Outcome outcome, std::ostream* out) {
  constexpr const char* kWords[] = {"applied", "superseded", "observed",
                                    "stored",  "rejected",   "ignored"};
  *out << kWords[static_cast<std::size_t>(outcome)];
}

}  // namespace uplink::cyberwave
