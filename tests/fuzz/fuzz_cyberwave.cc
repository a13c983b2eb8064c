// A message of MQTT: its topic up to the first line feed, then its payload.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <boost/json.hpp>

#include "schema/base/check.h"
#include "schema/base/utf8.h"
#include "schema/cyberwave/judge.h"
#include "schema/cyberwave/pong.h"
#include "schema/cyberwave/ruri.h"
#include "schema/limits.h"
#include "schema/model/ids.h"
#include "tests/fuzz/check_violation.h"

namespace {

namespace cw = uplink::model::cyberwave;
using uplink::cyberwave::Judgement;
using uplink::cyberwave::JudgeMessage;
using uplink::cyberwave::JudgeTerms;
using uplink::cyberwave::MessageClass;
using uplink::fuzz::CheckViolation;

void CheckNumber(const std::optional<double>& number) {
  UPLINK_CHECK(!number || std::isfinite(*number), "a kept number is finite");
}

void CheckText(std::string_view text) { UPLINK_CHECK(uplink::IsCleanUtf8(text), "a clean text"); }

// NOLINTNEXTLINE(misc-no-recursion): as deep as a payload
void CheckValue(const boost::json::value& value) {
  if (const auto* object = value.if_object()) {
    for (const auto& member : *object) {
      CheckText({member.key().data(), member.key().size()});
      CheckValue(member.value());
    }
  } else if (const auto* items = value.if_array()) {
    for (const auto& item : *items) CheckValue(item);
  } else if (const auto* text = value.if_string()) {
    CheckText({text->data(), text->size()});
  } else if (const auto* number = value.if_double()) {
    UPLINK_CHECK(std::isfinite(*number), "a finite number");
  }
}

void CheckDetail(const std::string& detail) {
  boost::json::error_code error;
  const boost::json::value value = boost::json::parse(detail, error);
  UPLINK_CHECK(!error && value.is_object(), "a detail is a JSON object");
  CheckValue(value);
}

/// What every body keeps to, whatever the input was.
struct Checking {
  void operator()(const cw::Joints& joints) const {
    UPLINK_CHECK(joints.joints.size() <= uplink::cyberwave::kJointsMax, "joints have their bound");
    for (const cw::Joint& joint : joints.joints) {
      UPLINK_CHECK(!joint.name.empty() && uplink::IsCleanUtf8(joint.name), "a joint has a name");
      CheckNumber(joint.position);
      CheckNumber(joint.velocity);
      CheckNumber(joint.effort);
    }
  }
  void operator()(const cw::Position& position) const {
    for (const double axis : {position.x_m, position.y_m, position.z_m}) {
      UPLINK_CHECK(std::abs(axis) <= uplink::cyberwave::kPositionMMax, "a position has its bound");
    }
  }
  void operator()(const cw::Rotation& rotation) const {
    UPLINK_CHECK(rotation.w != 0 || rotation.x != 0 || rotation.y != 0 || rotation.z != 0,
                 "a rotation is never all 0");
  }
  void operator()(const cw::Metrics& metrics) const {
    UPLINK_CHECK(metrics.metrics.size() <= uplink::cyberwave::kMetricsMax, "metrics are bounded");
    UPLINK_CHECK(!metrics.errors || metrics.errors->size() <= uplink::cyberwave::kErrorsMax,
                 "errors are bounded");
    for (const cw::Metric& metric : metrics.metrics) {
      if (const auto* number = std::get_if<double>(&metric.value)) CheckNumber(*number);
    }
  }
  void operator()(const cw::EdgeHealth& health) const {
    UPLINK_CHECK(!health.edge_id.empty(), "an edge has an id");
    UPLINK_CHECK(health.streams.size() <= uplink::cyberwave::kStreamsMax, "streams are bounded");
  }
  void operator()(const cw::Gps& gps) const {
    UPLINK_CHECK(gps.latitude_deg.has_value() == gps.longitude_deg.has_value(), "both or neither");
    CheckNumber(gps.compass_heading_deg);
  }
  void operator()(const cw::Report& report) const { CheckDetail(report.detail); }
  void operator()(const cw::Mark& mark) const { CheckDetail(mark.detail); }
  void operator()(const cw::Event& event) const { CheckDetail(event.detail); }
  void operator()(const cw::ScopeUpdate& update) const { CheckDetail(update.detail); }
  void operator()(const cw::DriverLog& log) const {
    UPLINK_CHECK(!log.message.empty() && uplink::IsCleanUtf8(log.message), "a log line is text");
    CheckDetail(log.detail);
  }
  void operator()(const cw::RunStatus& run) const {
    UPLINK_CHECK(!run.run_id.empty() && !run.status_text.empty(), "a run has an id and a status");
  }
  template <typename Other>
  void operator()(const Other& /*body*/) const {}
};

void CheckTopic(const uplink::cyberwave::Topic& topic) {
  if (!uplink::cyberwave::IsOfTwin(topic.kind)) return;
  for (const auto kind :
       {uplink::cyberwave::RobotKind::kReal, uplink::cyberwave::RobotKind::kSimulated}) {
    const std::string ruri = uplink::cyberwave::TwinRuri(topic.prefix, topic.id, kind);
    UPLINK_CHECK(ruri.size() <= uplink::model::kRuriBytesMax, "a RURI has its bound");
    UPLINK_CHECK(uplink::cyberwave::IsTwinRuri(ruri), "a twin's RURI is known as one");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(input.find('\n'), input.size());
  const std::string_view topic = input.substr(0, end);
  const std::string_view payload = input.substr(std::min(end + 1, input.size()));
  const JudgeTerms terms = {.prefixes = {"", "local", "site/a/"}, .prismatic_joints = {"lift"}};
  const Judgement judgement = JudgeMessage(topic, payload, terms);
  CheckTopic(judgement.topic);
  for (const auto& field : judgement.dropped) CheckViolation(field);
  UPLINK_CHECK(judgement.dropped.size() <= uplink::schema::kDroppedFieldsListedMax,
               "the listed fields are few");
  UPLINK_CHECK(!judgement.sign_of_life || judgement.message_class == MessageClass::kLive ||
                   judgement.message_class == MessageClass::kDurable,
               "nothing else is a sign of life");
  UPLINK_CHECK(!judgement.may_be_kept || uplink::cyberwave::MayBeKept(judgement.message_class),
               "what may hold secrets is not kept");
  UPLINK_CHECK(judgement.message_class != MessageClass::kDurable || judgement.dropped.empty(),
               "a durable message is whole");
  if (judgement.rejection() != nullptr) {
    CheckViolation(*judgement.rejection());
    return 0;
  }
  std::visit(Checking(), *judgement.body());
  return 0;
}
