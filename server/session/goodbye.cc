#include "server/session/goodbye.h"

#include <algorithm>

#include <fmt/format.h>

#include "server/session/frames.h"

namespace uplink::session {

ExpectedBack JudgeGoodbye(std::int64_t expected_back_unix_ms, SystemTime now,
                          milliseconds parked_max) {
  constexpr const char* kField = "goodbye.expected_back_unix_ms";
  if (expected_back_unix_ms == 0) {
    return {.until = {},
            .dropped = model::Rejection{.reason = model::RejectReason::kMissingField,
                                        .field = kField,
                                        .detail = "it says no time, and changes nothing"}};
  }
  if (expected_back_unix_ms <= UnixMs(now)) {
    return {.until = {},
            .dropped = model::Rejection{
                .reason = model::RejectReason::kOutOfRange,
                .field = kField,
                .detail = fmt::format("{} is not after the server's {}, and changes nothing",
                                      expected_back_unix_ms, UnixMs(now))}};
  }
  return {.until = FromUnixMs(std::min(expected_back_unix_ms, UnixMs(now + parked_max))),
          .dropped = {}};
}

bool TakeGoodbye(std::string_view bytes, const SessionContext& context, Attachment& robot,
                 Outgoing& outgoing) {
  v1::RelayRequest frame;
  if (!frame.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return false;
  const ExpectedBack back =
      JudgeGoodbye(frame.goodbye().expected_back_unix_ms(), context.clock.System(),
                   context.fleet.presence_limits_of(robot.robot()).parked_max);
  if (back.until) robot.Park(*back.until);
  if (back.dropped &&
      robot.robot().sessions.MayNotice(back.dropped->field, context.clock.Steady())) {
    context.probe.notices_total.Add();
    outgoing.Push(NoticeFrame(0, *back.dropped));
  }
  return true;
}

}  // namespace uplink::session
