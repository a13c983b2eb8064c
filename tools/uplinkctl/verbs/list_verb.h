#pragma once

#include <deque>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/config/flags.h"
#include "tools/uplinkctl/ask/api.h"
#include "tools/uplinkctl/verbs/common.h"
#include "tools/uplinkctl/verbs/lists.h"

namespace uplink::ctl {

/// What was given for one Filter.
struct FilterValue {
  std::string text;
  bool on = false;
};

/// What was given for a list. A value.
struct ListFlags {
  CommonFlags common;
  std::string fleet;
  /// RURIs or short names.
  std::vector<std::string> robots;
  /// The one of List::of_one_robot.
  std::string robot;
  std::string since;
  std::string until;
  bool oldest = false;
  int limit = 0;
  /// One for each filter of the list.
  std::deque<FilterValue> filters;
};

/// Adds the list's verb with its flags to its noun.
void AddList(config::Flags& noun, const List& list);

/// The request of a list, for robots with these RURIs.
///
/// Errors: kInvalidArgument for a time that cannot be read.
/// Thread: pure; any thread.
[[nodiscard]] absl::StatusOr<Query> QueryOf(const List& list, const ListFlags& flags,
                                            const std::vector<std::string>& ruris, SystemTime now);

/// RURIs from which a table of the list tells robots by short names; none where it names no robot.
[[nodiscard]] std::vector<std::string> NamedBeside(const List& list, const CommonFlags& flags,
                                                   Api& api);

/// Asks for the rows and shows them, once or with --follow until the screen's wait ends it.
[[nodiscard]] absl::Status ShowList(const List& list, const ListFlags& flags, Api& api,
                                    const Screen& screen);

}  // namespace uplink::ctl
