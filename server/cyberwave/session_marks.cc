#include "server/cyberwave/session_marks.h"

#include <algorithm>
#include <iterator>

namespace uplink::cyberwave {
namespace {

using model::cyberwave::Mark;
using model::cyberwave::MarkKind;

void StartTelemetry(MarkedSession& session, const std::string& stream) {
  // A session that starts to send is connected, even if no mark said so after a reconnect.
  session.connected = true;
  session.telemetry = true;
  if (stream.empty()) {
    session.ended_streams.clear();
  } else {
    std::erase(session.ended_streams, stream);
  }
}

void EndTelemetry(MarkedSession& session, const std::string& stream) {
  auto& ended = session.ended_streams;
  if (stream.empty()) {
    session.telemetry = false;
    ended.clear();
    return;
  }
  if (std::find(ended.begin(), ended.end(), stream) != ended.end()) return;
  if (ended.size() >= kEndedStreamsMax) ended.erase(ended.begin());
  ended.push_back(stream);
}

void Apply(MarkedSession& session, const Mark& mark) {
  switch (mark.kind) {
    case MarkKind::kConnected:
      session.connected = true;
      break;
    case MarkKind::kTelemetryStart:
      if (!mark.recording_boundary) StartTelemetry(session, mark.sensor);
      break;
    case MarkKind::kTelemetryEnd:
      if (!mark.recording_boundary) EndTelemetry(session, mark.sensor);
      break;
    case MarkKind::kDisconnected:
      session.connected = false;
      EndTelemetry(session, {});
      break;
    case MarkKind::kInitialObservation:
      break;
  }
  session.last = mark.kind;
}

}  // namespace

MarkedSession* SessionMarks::Find(std::string_view session_id) {
  // Nearly always the one that was heard last.
  const auto found = std::find_if(sessions_.rbegin(), sessions_.rend(),
                                  [&](const auto& each) { return each.first == session_id; });
  if (found == sessions_.rend()) return nullptr;
  sessions_.splice(sessions_.end(), sessions_, std::prev(found.base()));
  return &sessions_.back().second;
}

void SessionMarks::Take(const Mark& mark, const std::string& session_id, const Stamp& stamp) {
  MarkedSession* session = Find(session_id);
  if (session == nullptr) {
    session = &sessions_.emplace_back(session_id, MarkedSession()).second;
    if (sessions_.size() > kMarkedSessionsMax) sessions_.pop_front();
  }
  const bool timed = stamp.timestamp_us != 0;
  if (timed && stamp.timestamp_us < session->stamp.timestamp_us) return;
  const std::int64_t last_us = timed ? stamp.timestamp_us : session->stamp.timestamp_us;
  session->stamp = {.timestamp_us = last_us, .arrived = stamp.arrived};
  Apply(*session, mark);
}

}  // namespace uplink::cyberwave
