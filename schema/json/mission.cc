#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {

boost::json::object Render(const model::MissionRunStatus& body) {
  Fields fields;
  fields.Set("unixTimeMs", body.unix_time_ms)
      .Set("missionId", body.mission_id)
      .Set("runId", body.run_id)
      .Set("status", body.status)
      .SetIf("statusMessage", body.status_message)
      .SetIf("progressX100", body.progress_x100)
      .SetIf("currentPathId", body.current_path_id);
  if (body.current_target) fields.Set("currentTarget", Render(*body.current_target));
  return fields.SetIf("currentStep", body.current_step)
      .SetIf("totalSteps", body.total_steps)
      .SetIf("timeStartedMs", body.time_started_ms)
      .SetIf("expectedEndTimeMs", body.expected_end_time_ms)
      .SetIf("timeCompletedMs", body.time_completed_ms)
      .SetIf("name", body.name)
      .Take();
}

}  // namespace uplink::json
