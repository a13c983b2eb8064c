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

/// What the marks of one publisher's session said: any client of a twin sends them, a viewer too.
/// A value.
struct MarkedSession {
  /// Nothing if no mark said so.
  std::optional<bool> connected;
  std::optional<bool> telemetry;
  /// Streams that ended since telemetry started, the first that ended first.
  std::vector<std::string> ended_streams;
  model::cyberwave::MarkKind last = model::cyberwave::MarkKind::kConnected;
  Stamp stamp;
};

/// What the marks of a twin's robot say, by session. Marks come again, and ends in either order:
/// whatever came before, each makes true what it says. A value.
///
/// Limits:  kMarkedSessionsMax sessions, kEndedStreamsMax ended streams of each.
class SessionMarks final {
 public:
  using Sessions = std::list<std::pair<std::string, MarkedSession>>;

  /// One that is older than the last mark of its session changes nothing. An end of telemetry that
  /// names a stream ends that one; a cut of a recording starts and ends nothing.
  void Take(const model::cyberwave::Mark& mark, const std::string& session_id, const Stamp& stamp);
  /// Something else was heard of the session: it is not the one that goes next.
  void Touch(std::string_view session_id) { (void)Find(session_id); }

  /// By session id; the one heard least recently first.
  [[nodiscard]] const Sessions& sessions() const { return sessions_; }

 private:
  /// As the one heard last; null if it is not known.
  MarkedSession* Find(std::string_view session_id);

  Sessions sessions_;
};

}  // namespace uplink::cyberwave
