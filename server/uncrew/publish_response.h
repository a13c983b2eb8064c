#pragma once

#include "schema/uncrew/judge.h"
#include "server/uncrew/answer.h"
#include "uncrew/v1/avatar.pb.h"

namespace uplink::uncrew {

/// The response to a sample that was judged so. For kUnavailable and kRefused the call ends with a
/// status instead. Pure.
[[nodiscard]] ::uncrew::v1::PublishResponse ResponseOf(const Answer& answer,
                                                       const Judgement& judged);

}  // namespace uplink::uncrew
