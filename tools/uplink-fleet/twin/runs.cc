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

std::string Runs::Advance(Going& going, const Draft& draft, const char* name) {
  if (going.step >= going.steps) {
    going.id = fmt::format("{} {}", name, speech_.voice.MarkOf(draft));
    going.step = 0;
    going.steps = 3 + speech_.chance.Below(4);
  }
  const std::size_t step = going.step++;
  if (step == 0) return "queued";
  if (step == 1) return "starting";
  if (going.step >= going.steps) return kEnds.at(speech_.chance.Below(kEnds.size()));
  return kMiddle.at(speech_.chance.Below(kMiddle.size()));
}

SentRun& Runs::Note(const Going& going, const Draft& draft, const std::string& word,
                    const std::string& message) {
  SentRun& run = speech_.account.Run(going.id);
  run.updates.push_back(draft.number);
  run.status = "unknown";
  // A word that nobody knows stands before the text.
  run.message = message.empty() ? word : word + ": " + message;
  for (const StatusWord& each : kWords) {
    if (word != each.said) continue;
    run.status = each.shown;
    run.message = message;
  }
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
  return run;
}

Publication Runs::Navigate() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  const std::string word = Advance(navigate_, draft, "nav");
  const std::string message = speech_.chance.Chance(0.5) ? "on its way" : "";
  SentRun& run = Note(navigate_, draft, word, message);
  const double progress = std::round(speech_.chance.Between(0, 10'000)) / 100;
  run.progress_x100 = std::lround(progress * 100);
  draft.body["action_id"] = navigate_.id;
  draft.body["status"] = word;
  draft.body["progress"] = progress;
  if (!message.empty()) draft.body["message"] = message;
  return speech_.voice.ToTwin(draft, "navigate/status", Qos::k1);
}

Publication Runs::Mission() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "");
  const std::string word = Advance(mission_, draft, "mission");
  SentRun& run = Note(mission_, draft, word, "");
  run.current_step = static_cast<std::int64_t>(mission_.step);
  draft.body["mission_execution_uuid"] = mission_.id;
  draft.body["status"] = word;
  draft.body["current_step"] = mission_.step;
  return speech_.voice.ToTwin(draft, "mission/status", Qos::k1);
}

}  // namespace uplink::synthetic
