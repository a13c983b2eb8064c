#pragma once

#include "schema/uncrew/judge.h"
#include "server/uncrew/answer.h"
#include "uncrew/v1/avatar.pb.h"

namespace uplink::uncrew {

/// What a drone is told of a sample that was judged so. Of kUnavailable and kRefused it is told a
/// status instead. Pure.
[[nodiscard]] ::uncrew::v1::PublishResponse ResponseOf(const Answer& answer,
                                                       const Judgement& judged);

}  // namespace uplink::uncrew
