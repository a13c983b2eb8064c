#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "schema/base/utf8.h"
#include "schema/encode.h"
#include "schema/judge.h"
#include "schema/model/ids.h"
#include "tests/support/records.h"

/// Judging in tests: a body goes the way of an agent's message, through bytes.
namespace uplink::test {

[[nodiscard]] inline schema::Judgement JudgeBytes(std::string_view bytes,
                                                  const schema::JudgeLimits& limits = {}) {
  schema::Judge judge(limits);
  return judge.Payload(AsPayload(bytes));
}

[[nodiscard]] inline schema::Judgement JudgeBody(const model::Body& body,
                                                 const schema::JudgeLimits& limits = {}) {
  return JudgeBytes(schema::Encode(body), limits);
}

/// What every violation owes to the person who reads it.
inline void ExpectReadable(const model::Rejection& violation) {
  EXPECT_FALSE(violation.detail.empty());
  EXPECT_LE(violation.detail.size(), model::kDetailBytesMax);
  EXPECT_TRUE(IsCleanUtf8(violation.detail)) << violation.detail;
  EXPECT_TRUE(IsCleanUtf8(violation.field)) << violation.field;
}

inline void ExpectGood(const schema::Judgement& judgement) {
  if (judgement.rejection() != nullptr) {
    ADD_FAILURE() << judgement.rejection()->field << ": " << judgement.rejection()->detail;
    return;
  }
  for (const model::DroppedField& field : judgement.record()->dropped()) {
    ADD_FAILURE() << "dropped " << field.field << ": " << field.detail;
  }
}

inline void ExpectRejected(const schema::Judgement& judgement, model::RejectReason reason,
                           const std::string& field) {
  if (judgement.rejection() == nullptr) {
    ADD_FAILURE() << "not rejected; expected " << model::ToText(reason) << " at " << field;
    return;
  }
  EXPECT_EQ(model::ToText(judgement.rejection()->reason), model::ToText(reason));
  EXPECT_EQ(judgement.rejection()->field, field);
  ExpectReadable(*judgement.rejection());
}

/// The message was applied without exactly this one field.
inline void ExpectThinned(const schema::Judgement& judgement, model::RejectReason reason,
                          const std::string& field) {
  if (judgement.record() == nullptr) {
    ADD_FAILURE() << judgement.rejection()->field << ": " << judgement.rejection()->detail;
    return;
  }
  ASSERT_EQ(judgement.record()->dropped().size(), 1U);
  const model::DroppedField& dropped = judgement.record()->dropped().front();
  EXPECT_EQ(model::ToText(dropped.reason), model::ToText(reason));
  EXPECT_EQ(dropped.field, field);
  ExpectReadable(dropped);
}

/// The body of a judgement that must be good.
template <typename T>
[[nodiscard]] T BodyOf(const schema::Judgement& judgement) {
  if (judgement.record() == nullptr) {
    ADD_FAILURE() << judgement.rejection()->field << ": " << judgement.rejection()->detail;
    return T();
  }
  return std::get<T>(judgement.record()->body());
}

}  // namespace uplink::test
