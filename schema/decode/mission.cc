#include "schema/decode/decode.h"
#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/rules/numbers.h"
#include "schema/rules/texts.h"

/// Mission runs: durable, so every violation rejects.
namespace uplink::schema {
namespace {

void DecodeRunDetails(wire::MissionRunStatus::Reader in, Violations& violations,
                      model::MissionRunStatus& out) {
  const Path root;
  if (in.getHasStatusMessage()) {
    out.status_message = DurableText(violations, root.Field("statusMessage"),
                                     View(in.getStatusMessage()), kDescriptionBytesMax);
  }
  if (in.getHasProgressX100()) {
    out.progress_x100 = in.getProgressX100();
    if (*out.progress_x100 > kProgressX100Max) {
      violations.Content(
          OutOfRange(root.Field("progressX100"), in.getProgressX100(), 0, kProgressX100Max));
    }
  }
  if (in.getHasCurrentPathId()) {
    out.current_path_id = DurableText(violations, root.Field("currentPathId"),
                                      View(in.getCurrentPathId()), kIdBytesMax);
  }
  // Announced and null is read as absent: no rule asks for it, and 0/0 would be a place.
  if (in.getHasCurrentTarget() && in.hasCurrentTarget()) {
    out.current_target =
        JudgePose(violations, root.Field("currentTarget"), Raw(in.getCurrentTarget()));
  }
  if (in.getHasCurrentStep()) out.current_step = in.getCurrentStep();
  if (in.getHasTotalSteps()) out.total_steps = in.getTotalSteps();
  if (in.getHasTimeStartedMs()) out.time_started_ms = Time(violations, in.getTimeStartedMs());
  if (in.getHasExpectedEndTimeMs()) {
    out.expected_end_time_ms = Time(violations, in.getExpectedEndTimeMs());
  }
  if (in.getHasTimeCompletedMs()) out.time_completed_ms = Time(violations, in.getTimeCompletedMs());
  if (in.getHasName()) {
    out.name = DurableText(violations, root.Field("name"), View(in.getName()), kNameBytesMax);
  }
}

}  // namespace

model::MissionRunStatus DecodeMissionRunStatus(wire::MissionRunStatus::Reader in,
                                               Violations& violations) {
  const Path root;
  model::MissionRunStatus out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  out.mission_id =
      DurableText(violations, root.Field("missionId"), View(in.getMissionId()), kIdBytesMax);
  out.run_id = RequiredText(violations, root.Field("runId"), View(in.getRunId()), kIdBytesMax);
  out.status = Enum<model::MissionStatus>(violations, in.getStatus());
  DecodeRunDetails(in, violations, out);
  return out;
}

}  // namespace uplink::schema
