#pragma once

#include <vector>

#include "tools/uplinkctl/verbs/lists.h"

// The parts of Lists().
namespace uplink::ctl {

// verbs/robot_lists.cc
[[nodiscard]] std::vector<List> RobotLists();
// verbs/history_lists.cc
[[nodiscard]] std::vector<List> HistoryLists();
// verbs/admin_lists.cc
[[nodiscard]] std::vector<List> AdminLists();

}  // namespace uplink::ctl
