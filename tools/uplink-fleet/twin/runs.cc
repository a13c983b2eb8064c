#include "tools/uplink-fleet/twin/runs.h"

#include <array>
#include <cmath>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

struct StatusWord {
  const char* said;
  const char* shown;
};
constexpr std::array<StatusWord, 8> kWords = {{{"queued", "ready"},
                                               {"starting", "starting"},
                                               {"running", "running"},
                                               {"paused", "paused"},
                                               {"blocked", "blocked"},
                                               {"completed", "complete"},
                                               {"failed", "error"},
                                               {"cancelled", "aborted"}}};
constexpr std::array<const char*, 4> kMiddle = {"running", "paused", "blocked", "docking"};
constexpr std::array<const char*, 3> kEnds = {"completed", "failed", "cancelled"};

}  // namespace

SentRun& Runs::Advance(Going& going, const char* name, Draft& draft) {
  Seeded& chance = speech_.voice.chance();
  if (going.step >= going.steps) {
    going = {.id = fmt::format("{} {}", name, speech_.voice.MarkOf(draft)),
             .step = 0,
             .steps = 3 + chance.Below(4)};
  }
  const std::size_t step = going.step++;
  const std::string word = step == 0                   ? "queued"
                           : step == 1                 ? "starting"
                           : going.step >= going.steps ? kEnds.at(chance.Below(kEnds.size()))
                                                       : kMiddle.at(chance.Below(kMiddle.size()));
  draft.body["status"] = word;
  SentRun& run = speech_.account.Run(going.id);
  run.updates.push_back(draft.number);
  run.status = "unknown";
  // An unknown word stands before the text.
  run.message = word;
  for (const StatusWord& each : kWords) {
    if (word != each.said) continue;
    run.status = each.shown;
    run.message.clear();
  }
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
  return run;
}

Publication Runs::Navigate() {
  const Words words{.topic = "twin/{twin}/navigate/status"};
  Draft draft = speech_.voice.Begin(words);
  SentRun& run = Advance(navigate_, "nav", draft);
  Seeded& chance = speech_.voice.chance();
  if (chance.Chance(0.5)) {
    constexpr const char* kMessage = "on its way";
    draft.body["message"] = kMessage;
    run.message += run.message.empty() ? kMessage : fmt::format(": {}", kMessage);
  }
  const double progress = std::round(chance.Between(0, 10'000)) / 100;
  run.progress_x100 = std::lround(progress * 100);
  draft.body["action_id"] = navigate_.id;
  draft.body["progress"] = progress;
  return speech_.voice.To(words, draft, Qos::k1);
}

Publication Runs::Mission() {
  const Words words{.source = "", .topic = "twin/{twin}/mission/status"};
  Draft draft = speech_.voice.Begin(words);
  SentRun& run = Advance(mission_, "mission", draft);
  run.current_step = static_cast<std::int64_t>(mission_.step);
  draft.body["mission_execution_uuid"] = mission_.id;
  draft.body["current_step"] = mission_.step;
  return speech_.voice.To(words, draft, Qos::k1);
}

}  // namespace uplink::synthetic
