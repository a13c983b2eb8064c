#include "server/uncrew/publish_response.h"

#include "schema/base/utf8.h"
#include "schema/limits.h"

namespace uplink::uncrew {
namespace {

::uncrew::v1::Outcome ToWire(Outcome outcome) {
  switch (outcome) {
    case Outcome::kStored:
      return ::uncrew::v1::OUTCOME_STORED;
    case Outcome::kApplied:
      return ::uncrew::v1::OUTCOME_APPLIED;
    case Outcome::kSuperseded:
      return ::uncrew::v1::OUTCOME_SUPERSEDED;
    case Outcome::kDuplicate:
      return ::uncrew::v1::OUTCOME_DUPLICATE;
    case Outcome::kRejected:
      return ::uncrew::v1::OUTCOME_REJECTED;
    case Outcome::kUnavailable:
    case Outcome::kRefused:
      break;
  }
  return ::uncrew::v1::OUTCOME_UNSPECIFIED;
}

/// The numbers are those of the contract.
v1::RejectReason ToWire(model::RejectReason reason) {
  return static_cast<v1::RejectReason>(reason);
}

/// Both messages that name a field have the same three members.
template <typename Message>
void Name(const model::Rejection& rejection, Message& message) {
  message.set_reason(ToWire(rejection.reason));
  message.set_field(PrintableUtf8(rejection.field, model::kDetailBytesMax));
  message.set_detail(PrintableUtf8(rejection.detail, model::kDetailBytesMax));
}

}  // namespace

::uncrew::v1::PublishResponse ResponseOf(const Answer& answer, const Judgement& judged) {
  ::uncrew::v1::PublishResponse response;
  response.set_outcome(ToWire(answer.outcome));
  if (answer.outcome == Outcome::kRejected) {
    const model::Rejection* rejection = answer.rejection ? &*answer.rejection : judged.rejection();
    if (rejection != nullptr) Name(*rejection, response);
    response.set_retry_after_ms(answer.retry_after.count());
    return response;
  }
  for (const model::DroppedField& field : judged.dropped) Name(field, *response.add_dropped());
  return response;
}

}  // namespace uplink::uncrew
