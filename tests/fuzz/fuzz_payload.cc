#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "schema/base/check.h"
#include "schema/encode.h"
#include "schema/judge.h"
#include "tests/fuzz/check_violation.h"

namespace {

using uplink::fuzz::CheckViolation;
using uplink::model::Rejection;
using uplink::schema::Judge;
using uplink::schema::JudgeLimits;
using uplink::schema::Judgement;

/// What was judged good is good when it is read again as it was kept, and comes back as it was.
void CheckAgain(const Judgement& first) {
  if (!first.record()->dropped().empty()) return;
  const std::string encoded = uplink::schema::Encode(first.record()->body());
  Judge judge{JudgeLimits{.texts = uplink::schema::TextForm::kAsKept}};
  const Judgement second = judge.Payload(std::as_bytes(std::span(encoded.data(), encoded.size())));
  if (second.record() == nullptr) {
    // Shared pointers let a message hold more than its bytes; unshared it may pass the size limit.
    UPLINK_CHECK(second.rejection()->reason == uplink::model::RejectReason::kPayloadTooLarge,
                 "a good message stays good");
    return;
  }
  UPLINK_CHECK(second.control_characters == 0, "what was replaced stays replaced");
  UPLINK_CHECK(second.record()->body() == first.record()->body(), "a good message stays the same");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Judge judge{JudgeLimits()};
  const Judgement judgement = judge.Payload(std::as_bytes(std::span(data, size)));
  const auto variant = judge.VariantOf(std::as_bytes(std::span(data, size)));
  UPLINK_CHECK(
      !judgement.variant || size > JudgeLimits().message_bytes_max || variant == judgement.variant,
      "the variant is the same without decoding");
  if (judgement.rejection() != nullptr) {
    CheckViolation(*judgement.rejection());
    return 0;
  }
  UPLINK_CHECK(!judgement.record()->durable() || judgement.record()->dropped().empty(),
               "nothing is dropped from a durable message");
  for (const Rejection& field : judgement.record()->dropped()) CheckViolation(field);
  UPLINK_CHECK(judgement.record()->dropped().size() <= uplink::schema::kDroppedFieldsListedMax,
               "no more is told than may be");
  CheckAgain(judgement);
  return 0;
}
