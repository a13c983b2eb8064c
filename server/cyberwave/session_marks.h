#pragma once

#include <cstddef>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/model/cyberwave/reports.h"
#include "server/cyberwave/held.h"

namespace uplink::cyberwave {

/// The state of one publisher's session by its marks. Any client of a twin sends marks, a viewer
/// too. A value.
struct MarkedSession {
  /// Empty if no mark said so.
  std::optional<bool> connected;
  std::optional<bool> telemetry;
  /// Streams that ended since telemetry started, in the order of their ends.
  std::vector<std::string> ended_streams;
  model::cyberwave::MarkKind last = model::cyberwave::MarkKind::kConnected;
  Stamp stamp;
};

/// The state of a twin's robot by its marks, session by session. Marks may be repeated, and ends
/// may come in any order: each mark sets what it says, whatever came before. A value.
///
/// Limits:  kMarkedSessionsMax sessions, kEndedStreamsMax ended streams of each.
class SessionMarks final {
 public:
  using Sessions = std::list<std::pair<std::string, MarkedSession>>;

  /// A mark that is older than the last one of its session changes nothing. An end of telemetry
  /// that names a stream ends only that stream; a cut of a recording starts and ends nothing.
  void Take(const model::cyberwave::Mark& mark, const std::string& session_id, const Stamp& stamp);
  /// Another message of the session came: it counts as heard now.
  void Touch(std::string_view session_id) { (void)Find(session_id); }

  /// With their ids; the one heard least recently first.
  [[nodiscard]] const Sessions& sessions() const { return sessions_; }

 private:
  /// The session, which counts as heard now; null if it is unknown.
  MarkedSession* Find(std::string_view session_id);

  Sessions sessions_;
};

}  // namespace uplink::cyberwave
