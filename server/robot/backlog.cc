#include "server/robot/backlog.h"

namespace uplink::robot {

std::optional<Backlog> BacklogOf(const BatchHead& head, SystemTime now) {
  if (!head.backlog_uplinks || *head.backlog_uplinks > kBacklogUplinksMax) return std::nullopt;
  Backlog backlog{.uplinks = *head.backlog_uplinks, .said_at = now};
  // Both are positive, so that the difference does not overflow.
  if (backlog.uplinks == 0 || head.sent_unix_ms <= 0 || head.oldest_unsent_unix_ms <= 0) {
    return backlog;
  }
  const milliseconds waits(head.sent_unix_ms - head.oldest_unsent_unix_ms);
  if (waits >= milliseconds(0) && waits <= kBacklogAgeMax) backlog.oldest_unsent = now - waits;
  return backlog;
}

}  // namespace uplink::robot
