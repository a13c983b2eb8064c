#include "tools/uplink-fleet/twin/metrics.h"

#include <utility>

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

/// Errors that metrics name at once.
constexpr std::size_t kErrorsMax = 3;

// They have no time.
constexpr Words kWords{
    .topic = "twin/{twin}/metrics",
    .body = R"({"metrics":{"power":{"battery_percent":"0..100","voltage":"22..26",)"
            R"("estimated_runtime_minutes":"0..240"},)"
            R"("load":{"cpu":"0..100","gpu":{"temperature":"30..90"},"throttled":false}}})",
    .head = Head::kTimeless};

}  // namespace

Publication Metrics::WithErrors() {
  std::set<std::string> errors;
  for (const std::string& error : errors_) {
    if (errors.size() + 1 < kErrorsMax && speech_.voice.chance().Chance(0.5)) errors.insert(error);
  }
  return Say(std::move(errors), true);
}

Publication Metrics::Say(std::set<std::string> errors, bool one_more) {
  Draft draft = speech_.voice.Begin(kWords);
  js::object& metrics = draft.body["metrics"].as_object();
  js::object load = metrics.at("load").as_object();
  const js::value temperature = load.at("gpu").as_object().at("temperature");
  load["gpu/temperature"] = temperature;
  load.erase("gpu");
  speech_.account.Live(Side::kReal, "metrics/power", metrics.at("power"));
  speech_.account.Live(Side::kReal, "metrics/load", load);
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
  if (one_more) {
    errors.insert("motor stalled " + speech_.voice.MarkOf(draft));
    js::array& named = (metrics["errors"] = js::array()).as_array();
    for (const std::string& error : errors) named.emplace_back(error);
  }
  for (const std::string& error : errors) {
    if (!errors_.contains(error)) speech_.account.FaultChange(draft.number, {error, true});
  }
  for (const std::string& error : errors_) {
    if (!errors.contains(error)) speech_.account.FaultChange(draft.number, {error, false});
  }
  errors_ = std::move(errors);
  return speech_.voice.To(kWords, draft, Qos::k1);
}

}  // namespace uplink::synthetic
