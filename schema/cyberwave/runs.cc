#include <array>
#include <string_view>

#include "schema/cyberwave/families.h"
#include "schema/limits.h"

namespace uplink::cyberwave {
namespace {

using model::MissionStatus;
using model::cyberwave::RunStatus;

struct StatusWord {
  std::string_view word;
  MissionStatus status;
};
constexpr std::array kWords = {
    StatusWord{"queued", MissionStatus::kReady},
    StatusWord{"starting", MissionStatus::kStarting},
    StatusWord{"running", MissionStatus::kRunning},
    StatusWord{"paused", MissionStatus::kPaused},
    StatusWord{"blocked", MissionStatus::kBlocked},
    StatusWord{"completed", MissionStatus::kComplete},
    StatusWord{"failed", MissionStatus::kError},
    StatusWord{"cancelled", MissionStatus::kAborted},
};

MissionStatus StatusOf(std::string_view text) {
  for (const StatusWord& each : kWords) {
    if (each.word == text) return each.status;
  }
  return MissionStatus::kUnknown;
}

RunStatus RunOf(Reader& in, std::string_view id) {
  RunStatus run;
  run.run_id = in.Text(id, schema::kIdBytesMax, Need::kMust);
  run.status_text = in.Text("status", schema::kNameBytesMax, Need::kMust);
  run.status = StatusOf(run.status_text);
  run.message = in.Text("message", schema::kMessageTextBytesMax);
  return run;
}

}  // namespace

RunStatus ReadNavigateStatus(Reader& in) {
  RunStatus run = RunOf(in, "action_id");
  run.progress_percent = in.Percent("progress");
  return run;
}

RunStatus ReadMissionStatus(Reader& in) {
  RunStatus run = RunOf(in, "mission_execution_uuid");
  run.current_step = in.Count("current_step");
  return run;
}

}  // namespace uplink::cyberwave
