#include "server/session/frames.h"

#include <algorithm>

#include "schema/base/utf8.h"

namespace uplink::session {
namespace {

using model::RejectReason;

template <RejectReason kOurs, v1::RejectReason kWire>
constexpr bool kAgree = static_cast<int>(kOurs) == static_cast<int>(kWire);

static_assert(kAgree<RejectReason::kMalformed, v1::REJECT_REASON_MALFORMED>);
static_assert(kAgree<RejectReason::kUnknownVariant, v1::REJECT_REASON_UNKNOWN_VARIANT>);
static_assert(kAgree<RejectReason::kPayloadTooLarge, v1::REJECT_REASON_PAYLOAD_TOO_LARGE>);
static_assert(kAgree<RejectReason::kTooManyItems, v1::REJECT_REASON_TOO_MANY_ITEMS>);
static_assert(kAgree<RejectReason::kTextTooLong, v1::REJECT_REASON_TEXT_TOO_LONG>);
static_assert(kAgree<RejectReason::kTextNotUtf8, v1::REJECT_REASON_TEXT_NOT_UTF8>);
static_assert(kAgree<RejectReason::kMissingField, v1::REJECT_REASON_MISSING_FIELD>);
static_assert(kAgree<RejectReason::kOutOfRange, v1::REJECT_REASON_OUT_OF_RANGE>);
static_assert(kAgree<RejectReason::kNotFinite, v1::REJECT_REASON_NOT_FINITE>);
static_assert(kAgree<RejectReason::kTypeMismatch, v1::REJECT_REASON_TYPE_MISMATCH>);
static_assert(kAgree<RejectReason::kIdentityMismatch, v1::REJECT_REASON_IDENTITY_MISMATCH>);
static_assert(kAgree<RejectReason::kNotMonotonic, v1::REJECT_REASON_NOT_MONOTONIC>);
static_assert(kAgree<RejectReason::kRateLimited, v1::REJECT_REASON_RATE_LIMITED>);
static_assert(kAgree<RejectReason::kUnsupportedContent, v1::REJECT_REASON_UNSUPPORTED_CONTENT>);
static_assert(kAgree<RejectReason::kDuplicateKey, v1::REJECT_REASON_DUPLICATE_KEY>);
static_assert(kAgree<RejectReason::kTooFewItems, v1::REJECT_REASON_TOO_FEW_ITEMS>);
static_assert(kAgree<RejectReason::kStoreRefused, v1::REJECT_REASON_STORE_REFUSED>);

v1::ResendKind ToWire(storage::LatestKind kind) {
  switch (kind) {
    case storage::LatestKind::kAgentInfo:
      return v1::RESEND_KIND_AGENT_INFO;
    case storage::LatestKind::kSettings:
      return v1::RESEND_KIND_CURRENT_SETTINGS;
    case storage::LatestKind::kUiCapabilities:
      break;
  }
  return v1::RESEND_KIND_UI_CAPABILITIES;
}

}  // namespace

v1::RejectReason ToWire(RejectReason reason) { return static_cast<v1::RejectReason>(reason); }

v1::RelayResponse WelcomeFrame(const std::string& ruri, model::Seq committed,
                               const SessionLimits& limits, SystemTime now) {
  v1::RelayResponse frame;
  v1::Welcome& welcome = *frame.mutable_welcome();
  welcome.set_robot_ruri(ruri);
  welcome.set_committed_seq(committed);
  welcome.set_server_unix_ms(UnixMs(now));
  welcome.set_server_version(limits.server_version);
  v1::Limits& told = *welcome.mutable_limits();
  told.set_payload_bytes_max(std::max(limits.payload_bytes_max, limits.message_bytes_max));
  told.set_batch_uplinks_max(limits.batch_uplinks_max);
  told.set_extras_items_max(limits.extras_items_max);
  told.set_in_flight_uplinks_max(limits.in_flight_uplinks_max);
  told.set_frame_bytes_max(limits.frame_bytes_max);
  return frame;
}

v1::RelayResponse AckFrame(model::Seq through, model::Seq judged) {
  v1::RelayResponse frame;
  frame.mutable_ack()->set_through_seq(through);
  frame.mutable_ack()->set_judged_seq(judged);
  return frame;
}

v1::RelayResponse RejectFrame(model::Seq seq, const model::Rejection& rejection,
                              std::int64_t retry_after_ms) {
  v1::RelayResponse frame;
  v1::Reject& reject = *frame.mutable_reject();
  reject.set_seq(seq);
  reject.set_reason(ToWire(rejection.reason));
  reject.set_retry_after_ms(retry_after_ms);
  reject.set_field(PrintableUtf8(rejection.field, model::kDetailBytesMax));
  reject.set_detail(PrintableUtf8(rejection.detail, model::kDetailBytesMax));
  return frame;
}

v1::RelayResponse NoticeFrame(model::Seq seq, const model::Rejection& dropped) {
  v1::RelayResponse frame;
  v1::Notice& notice = *frame.mutable_notice();
  notice.set_seq(seq);
  notice.set_reason(ToWire(dropped.reason));
  notice.set_field(PrintableUtf8(dropped.field, model::kDetailBytesMax));
  notice.set_detail(PrintableUtf8(dropped.detail, model::kDetailBytesMax));
  return frame;
}

v1::RelayResponse ResendRequestFrame(storage::LatestKindSet kinds) {
  v1::RelayResponse frame;
  v1::ResendRequest& request = *frame.mutable_resend_request();
  for (const storage::LatestKind kind : storage::kEachLatestKind) {
    if ((kinds & BitOf(kind)) != 0) request.add_kinds(ToWire(kind));
  }
  return frame;
}

v1::RelayResponse DrainFrame(milliseconds grace) {
  v1::RelayResponse frame;
  frame.mutable_drain()->set_grace_ms(grace.count());
  return frame;
}

}  // namespace uplink::session
