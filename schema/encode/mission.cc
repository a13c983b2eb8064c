#include "schema/encode/encode_body.h"

namespace uplink::schema {

void EncodeMember(const model::MissionRunStatus& in, wire::UplinkMsg::Builder message) {
  auto out = message.initMissionRunStatus();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setMissionId(Text(in.mission_id));
  out.setRunId(Text(in.run_id));
  out.setStatus(Enum<wire::MissionStatus>(in.status));
  out.setHasStatusMessage(in.status_message.has_value());
  if (in.status_message) out.setStatusMessage(Text(*in.status_message));
  out.setHasProgressX100(in.progress_x100.has_value());
  out.setProgressX100(in.progress_x100.value_or(0));
  out.setHasCurrentPathId(in.current_path_id.has_value());
  if (in.current_path_id) out.setCurrentPathId(Text(*in.current_path_id));
  out.setHasCurrentTarget(in.current_target.has_value());
  if (in.current_target) EncodePose(*in.current_target, out.initCurrentTarget());
  out.setHasCurrentStep(in.current_step.has_value());
  out.setCurrentStep(in.current_step.value_or(0));
  out.setHasTotalSteps(in.total_steps.has_value());
  out.setTotalSteps(in.total_steps.value_or(0));
  out.setHasTimeStartedMs(in.time_started_ms.has_value());
  out.setTimeStartedMs(in.time_started_ms.value_or(0));
  out.setHasExpectedEndTimeMs(in.expected_end_time_ms.has_value());
  out.setExpectedEndTimeMs(in.expected_end_time_ms.value_or(0));
  out.setHasTimeCompletedMs(in.time_completed_ms.has_value());
  out.setTimeCompletedMs(in.time_completed_ms.value_or(0));
  out.setHasName(in.name.has_value());
  if (in.name) out.setName(Text(*in.name));
}

}  // namespace uplink::schema
