#include "tools/uplink-fleet/drone/script.h"

namespace uplink::synthetic {
namespace {

/// Of seconds, those in which a request to operators comes or goes.
constexpr double kRequestShare = 0.1;

}  // namespace

DroneScript::DroneScript(const DroneOptions& options)
    : voice_(options),
      samples_({voice_, account_}),
      sets_({voice_, account_}, samples_.lines()),
      wrongs_({voice_, account_}, sets_.requests_line() + 1),
      chance_(voice_.ChanceOf(wrongs_.line() + 1)) {}

std::vector<AvatarCall> DroneScript::Second(std::int64_t now_us, const ScenarioOptions& options,
                                            const std::function<bool(std::size_t)>& busy) {
  voice_.SetNow(now_us);
  std::vector<AvatarCall> calls = samples_.Second(busy, account_.Full());
  // Both sets come each second; `faults_hz` is how often an alert comes or goes.
  if (!busy(sets_.alerts_line())) calls.push_back(sets_.Alerts(options.faults_hz));
  if (!busy(sets_.requests_line())) calls.push_back(sets_.Requests(kRequestShare));
  const bool wrong = chance_.Chance(options.malformed_share);
  if (wrong && !busy(wrongs_.line()) && !account_.Full()) calls.push_back(wrongs_.Next());
  return calls;
}

std::vector<AvatarCall> DroneScript::Last(std::int64_t now_us) {
  voice_.SetNow(now_us);
  std::vector<AvatarCall> calls = samples_.All();
  calls.push_back(sets_.Alerts(0));
  calls.push_back(sets_.Requests(0));
  return calls;
}

}  // namespace uplink::synthetic
