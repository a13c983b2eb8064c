#include "server/session/judged.h"

#include <cstdint>
#include <span>
#include <utility>
#include <variant>

#include "schema/rcan/judge.h"

namespace uplink::session {
namespace {

/// When an upsert of a shape or object expires, Unix milliseconds; 0: never, or another message.
std::int64_t ExpiryOf(const model::Body& body) {
  if (const auto* shape = std::get_if<model::ShapeOp>(&body)) {
    return shape->upsert() == nullptr ? 0 : shape->upsert()->expire_time_ms;
  }
  if (const auto* object = std::get_if<model::ObjectOp>(&body)) {
    return object->upsert() == nullptr ? 0 : object->upsert()->expires_unix_time_ms;
  }
  return 0;
}

Judged JudgeRoverNexus(const SessionContext& context, const UplinkView& uplink,
                       SystemTime received_at) {
  schema::Judgement judgement = context.judge.Payload(std::as_bytes(std::span(uplink.payload)));
  Judged judged{.content = model::Rejection(),
                .sign_of_life = judgement.sign_of_life,
                .odd = {.times_unknown = judgement.times_unknown,
                        .enumerants_unrecognized = judgement.enumerants_unrecognized,
                        .control_characters = judgement.control_characters}};
  if (judgement.variant) judged.kind = static_cast<std::size_t>(*judgement.variant);
  if (auto* record = std::get_if<model::Record>(&judgement.verdict)) {
    judged.expired =
        record->durable() && ExpiredOnArrival(record->body(), received_at, context.clock_trust);
    judged.content = std::move(*record);
  } else {
    judged.content = std::get<model::Rejection>(std::move(judgement.verdict));
  }
  return judged;
}

Judged JudgeRcan(const SessionContext& context, const std::string& ruri, const UplinkView& uplink) {
  schema::RcanJudgement judgement =
      schema::JudgeRcanState(uplink.payload, ruri, context.limits.message_bytes_max);
  Judged judged{.content = model::Rejection(),
                .kind = metrics::kRcanKind,
                .dropped = std::move(judgement.dropped),
                .unlisted = std::move(judgement.unlisted),
                .sign_of_life = judgement.sign_of_life && context.limits.rcan_counts_as_life,
                .odd = {.control_characters = judgement.control_characters}};
  if (auto* state = std::get_if<model::RcanState>(&judgement.verdict)) {
    judged.content = std::move(*state);
  } else {
    judged.content = std::get<model::Rejection>(std::move(judgement.verdict));
  }
  return judged;
}

}  // namespace

bool ExpiredOnArrival(const model::Body& body, SystemTime now,
                      const storage::ClockTrust& clock_trust) {
  const std::int64_t expiry_ms = ExpiryOf(body);
  return expiry_ms != 0 && expiry_ms <= UnixMs(now) && clock_trust.VouchesFor(now);
}

Judged JudgeUplink(const SessionContext& context, const std::string& ruri, const UplinkView& uplink,
                   SystemTime received_at) {
  switch (uplink.content) {
    case UplinkView::Content::kRoverNexus:
      return JudgeRoverNexus(context, uplink, received_at);
    case UplinkView::Content::kRcanRobotState:
      return JudgeRcan(context, ruri, uplink);
    case UplinkView::Content::kNone:
      break;
  }
  return {.content = model::Rejection{.reason = model::RejectReason::kUnsupportedContent,
                                      .field = "",
                                      .detail = "the uplink has no content"}};
}

}  // namespace uplink::session
