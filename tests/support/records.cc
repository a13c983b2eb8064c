#include "tests/support/records.h"

#include <utility>
#include <variant>

#include "schema/base/check.h"
#include "schema/encode.h"
#include "schema/judge.h"

namespace uplink::test {

model::Record RecordOf(const model::Body& body) {
  const std::string payload = schema::Encode(body);
  schema::Judge judge{schema::JudgeLimits()};
  schema::Judgement judgement = judge.Payload(AsPayload(payload));
  const model::Rejection* rejection = judgement.rejection();
  UPLINK_CHECK(rejection == nullptr, rejection->field + ": " + rejection->detail);
  return std::get<model::Record>(std::move(judgement.verdict));
}

}  // namespace uplink::test
