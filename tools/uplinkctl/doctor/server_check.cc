#include "tools/uplinkctl/doctor/server_check.h"

#include <string>

#include "schema/base/doc_page.h"
#include "tools/uplinkctl/probe.h"

namespace uplink::ctl {

Finding ServerFinding(const absl::StatusOr<link::HttpAnswer>& answer) {
  constexpr const char* kWhere = "server";
  if (!answer.ok()) {
    return Error(kWhere, std::string(answer.status().message()),
                 "look into its log: journalctl -u uplinkd");
  }
  const ProbeWord word = JudgeAnswer(Probe::kReady, *answer);
  if (!word.good) {
    return Error(kWhere, word.line, DocPage("docs/operate/server.md") + " has each word");
  }
  if (answer->body == R"({"degraded":[]})") return Ok(kWhere, word.line);
  return Warning(kWhere, word.line,
                 DocPage("docs/reference/degraded.md") + " has the first step for each word");
}

}  // namespace uplink::ctl
