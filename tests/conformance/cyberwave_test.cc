// What the vendor's client publishes, line by line, against what each line is for us.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <boost/json.hpp>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "schema/cyberwave/judge.h"
#include "tests/conformance/cyberwave_lines.h"

namespace uplink::cyberwave {
namespace {

namespace js = boost::json;
namespace cw = model::cyberwave;

constexpr auto kExpected = "tests/conformance/cyberwave/sdk-0.7.4.expected";

std::string_view WordOf(MessageClass message_class) {
  switch (message_class) {
    case MessageClass::kDurable:
      return "durable";
    case MessageClass::kLive:
      return "live";
    case MessageClass::kObserved:
      return "observed";
    case MessageClass::kMedia:
      return "media";
    case MessageClass::kPing:
      return "ping";
    case MessageClass::kOther:
      return "other";
  }
  return "";
}

template <typename T>
std::string Maybe(const std::optional<T>& value) {
  return value ? fmt::format("{}", *value) : "-";
}

/// A body in short, so that a line of the expectations says what matters of it.
struct InShort {
  std::string operator()(const cw::Ignored& /*body*/) const { return "ignored"; }
  std::string operator()(const cw::Position& p) const {
    return fmt::format("position {} {} {}", p.x_m, p.y_m, p.z_m);
  }
  std::string operator()(const cw::Rotation& r) const {
    return fmt::format("rotation {} {} {} {}", r.w, r.x, r.y, r.z);
  }
  std::string operator()(const cw::Scale& s) const {
    return fmt::format("scale {} {} {}", s.x, s.y, s.z);
  }
  std::string operator()(const cw::Joints& joints) const {
    std::string text = fmt::format("joints setpoints={}", joints.setpoints);
    for (const cw::Joint& joint : joints.joints) {
      text += fmt::format(" {}={}/{}/{}", joint.name, Maybe(joint.position), Maybe(joint.velocity),
                          Maybe(joint.effort));
    }
    return text;
  }
  std::string operator()(const cw::Metrics& metrics) const {
    return fmt::format("metrics {} errors={}", metrics.metrics.size(),
                       metrics.errors ? std::to_string(metrics.errors->size()) : "-");
  }
  std::string operator()(const cw::EdgeHealth& health) const {
    std::string text = fmt::format(
        "edge_health {} up={} streams={}/{} mem={} cpu={} disk={} temp={}", health.edge_id,
        Maybe(health.uptime_s), Maybe(health.healthy_streams), Maybe(health.stream_count),
        Maybe(health.host_memory_percent), Maybe(health.host_cpu_percent),
        Maybe(health.host_disk_percent), Maybe(health.cpu_temp_c));
    for (const cw::EdgeStream& stream : health.streams) text += " " + stream.id;
    return text;
  }
  std::string operator()(const cw::Gps& gps) const {
    return fmt::format("gps {} {} {} heading={} sats={} fix={}", Maybe(gps.latitude_deg),
                       Maybe(gps.longitude_deg), Maybe(gps.altitude_m),
                       Maybe(gps.compass_heading_deg), Maybe(gps.satellite_count), gps.fix_type);
  }
  std::string operator()(const cw::BatteryStatus& battery) const {
    return fmt::format("battery {} {}", Maybe(battery.percentage), Maybe(battery.voltage_v));
  }
  std::string operator()(const cw::Report& report) const {
    return fmt::format("report {} battery={} {}", report.name, Maybe(report.battery_percent),
                       report.detail);
  }
  std::string operator()(const cw::Mark& mark) const {
    return fmt::format("mark {}{}{}", cw::ToText(mark.kind),
                       mark.sensor.empty() ? "" : " sensor=" + mark.sensor,
                       mark.recording_boundary ? " boundary" : "");
  }
  std::string operator()(const cw::Event& event) const {
    return fmt::format("event {} source={} bytes={}", event.type, event.source,
                       event.detail.size());
  }
  std::string operator()(const cw::DriverLog& log) const {
    return fmt::format("log {} \"{}\" {}", static_cast<int>(log.level), log.message,
                       log.container_name);
  }
  std::string operator()(const cw::RunStatus& run) const {
    return fmt::format("run {} {}={} progress={} step={} \"{}\"", run.run_id, run.status_text,
                       model::EnumText(run.status), Maybe(run.progress_percent),
                       Maybe(run.current_step), run.message);
  }
  std::string operator()(const cw::ScopeUpdate& update) const {
    return fmt::format("scope {} {}", update.type, update.detail);
  }
  std::string operator()(const cw::CommandHead& head) const {
    return fmt::format("command \"{}\" status=\"{}\"", head.command, head.status);
  }
  std::string operator()(const cw::Commanded& commanded) const {
    return fmt::format("commanded {}", commanded.setpoints);
  }
  std::string operator()(const cw::Signalling& /*body*/) const { return "signalling"; }
  std::string operator()(const cw::Media& media) const {
    return fmt::format("media {}", media.bytes);
  }
  std::string operator()(const cw::Ping& /*body*/) const { return "ping"; }
};

std::string InWords(const Judgement& judgement) {
  std::string text =
      fmt::format("{} {}{}", ToText(judgement.topic.kind), WordOf(judgement.message_class),
                  judgement.sign_of_life ? " alive" : "");
  if (!judgement.topic.prefix.empty()) text += " under " + judgement.topic.prefix;
  if (cw::IsSimulated(judgement.head.source.type)) text += " simulated";
  if (!judgement.head.source.text.empty()) text += " by " + judgement.head.source.text;
  for (const model::DroppedField& field : judgement.dropped) {
    text += fmt::format(" without {} ({})", field.field, ToText(field.reason));
  }
  text += judgement.head.timestamp_us == 0 ? " untimed: " : ": ";
  if (const model::Rejection* rejection = judgement.rejection()) {
    return text + fmt::format("{} {}", ToText(rejection->reason), rejection->field);
  }
  return text + std::visit(InShort(), *judgement.body());
}

TEST(CyberwaveVectors, AreWhatIsExpectedLineByLine) {
  const std::vector<std::string> lines = test::LinesOf(test::kCyberwaveVectors);
  const std::vector<std::string> expected = test::LinesOf(kExpected);
  ASSERT_GT(lines.size(), 100U);
  EXPECT_EQ(lines.size(), expected.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const js::object line = js::parse(lines[i]).as_object();
    const std::string found = InWords(test::JudgeLine(line));
    EXPECT_EQ(found, i < expected.size() ? expected[i] : "nothing")
        << "line " << i + 1 << ": " << line.at("call").as_string();
  }
}

TEST(CyberwaveVectors, BelongToTheTwinOfTheirTopic) {
  for (const std::string& text : test::LinesOf(test::kCyberwaveVectors)) {
    const js::object line = js::parse(text).as_object();
    const std::string topic(line.at("topic").as_string().c_str());
    const Judgement judgement = test::JudgeLine(line);
    if (!IsOfTwin(judgement.topic.kind)) continue;
    std::string lower = topic;
    for (char& c : lower) c = c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
    EXPECT_NE(lower.find(judgement.topic.id.ToText()), std::string::npos) << topic;
  }
}

}  // namespace
}  // namespace uplink::cyberwave
