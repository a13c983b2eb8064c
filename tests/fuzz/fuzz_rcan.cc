#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "schema/base/check.h"
#include "schema/json/render.h"
#include "schema/rcan/judge.h"
#include "tests/fuzz/check_violation.h"

namespace {

using uplink::fuzz::CheckViolation;
using uplink::model::RcanState;
using uplink::model::Rejection;
using uplink::schema::JudgeRcanState;
using uplink::schema::RcanJudgement;

constexpr std::string_view kRuri = "rcan://local.rcan/acme/arm/1";
constexpr std::size_t kBytesMax = std::size_t{64} * 1024;
/// A number may be longer when it is written again than as it came.
constexpr std::size_t kAgainBytesMax = 16 * kBytesMax;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const RcanJudgement first = JudgeRcanState(text, kRuri, kBytesMax);
  if (const Rejection* rejection = first.rejection()) {
    CheckViolation(*rejection);
    return 0;
  }
  UPLINK_CHECK(first.sign_of_life, "a good state is a sign of life");
  for (const Rejection& field : first.dropped) CheckViolation(field);
  // What was judged good is good when it is written again, and comes back as it was.
  const auto& state = std::get<RcanState>(first.verdict);
  const std::string again = boost::json::serialize(uplink::json::Render(state, kRuri));
  const RcanJudgement second =
      JudgeRcanState(again, kRuri, kAgainBytesMax, uplink::schema::TextForm::kAsKept);
  UPLINK_CHECK(second.control_characters == 0, "what was replaced stays replaced");
  UPLINK_CHECK(second.rejection() == nullptr && second.dropped.empty(), "a good state stays good");
  const auto& kept = std::get<RcanState>(second.verdict);
  UPLINK_CHECK(kept.joints.size() == state.joints.size() && kept.seq == state.seq &&
                   kept.timestamp_us == state.timestamp_us && kept.uptime_ms == state.uptime_ms &&
                   kept.battery_pct == state.battery_pct,
               "a good state stays the same");
  return 0;
}
