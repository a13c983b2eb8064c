// What the vendor's client publishes, one line after the other, against what it comes to.
#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <boost/json.hpp>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/cyberwave/twin_state.h"
#include "server/cyberwave/whose.h"
#include "server/view/twin_json.h"
#include "tests/conformance/cyberwave_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::cyberwave {
namespace {

namespace js = boost::json;

constexpr auto kExpected = "tests/conformance/cyberwave/sdk-0.7.4.state";

std::string_view WordOf(Outcome outcome) {
  switch (outcome) {
    case Outcome::kApplied:
      return "applied";
    case Outcome::kSuperseded:
      return "superseded";
    case Outcome::kObserved:
      return "observed";
    case Outcome::kStored:
      return "stored";
    case Outcome::kRejected:
      return "rejected";
    case Outcome::kIgnored:
      return "ignored";
  }
  return "";
}

/// A record in short.
struct InShort {
  std::string operator()(const model::Record& record) const {
    return std::visit(*this, record.body());
  }
  std::string operator()(const model::EventTelemetry& event) const {
    return fmt::format("event {}", model::EventKindText(event.kind));
  }
  std::string operator()(const model::Message& log) const { return "log " + log.message; }
  std::string operator()(const model::MissionRunStatus& run) const {
    return fmt::format("run {} {}", run.run_id, model::EnumText(run.status));
  }
  std::string operator()(const model::Fault& fault) const {
    return fmt::format("fault {} {}", fault.fault_id, fault.active ? "raised" : "cleared");
  }
  std::string operator()(const model::ScopeUpdate& update) const { return "scope " + update.type; }
  template <typename Other>
  std::string operator()(const Other& /*body*/) const {
    return "another kind";
  }
};

/// Without the times of arrival, which are this test's own.
void Forget(js::value& value) {
  if (js::object* object = value.if_object()) {
    object->erase("receivedAt");
    for (auto& member : *object) Forget(member.value());
  }
}

/// All lines, applied in their order.
struct Come {
  std::map<std::string, TwinState> robots;
  /// How many there are of each.
  std::map<std::string, std::size_t> outcomes;
  std::map<std::string, std::size_t> records;
  std::map<std::string, std::size_t> alive;
};

Come ApplyAll() {
  Come come;
  testing::ManualClock clock;
  for (const std::string& text : test::LinesOf(test::kCyberwaveVectors)) {
    Judgement judgement = test::JudgeLine(js::parse(text).as_object());
    clock.Advance(milliseconds(1));
    if (judgement.rejection() != nullptr) ++come.outcomes["rejected"];
    if (judgement.rejection() != nullptr || !IsOfTwin(judgement.topic.kind)) continue;
    const std::string ruri = RuriOf(judgement);
    if (SignOfLifeOf(judgement)) ++come.alive[ruri];
    TwinState& robot = come.robots.try_emplace(ruri, judgement.topic.id).first->second;
    const Applied applied =
        robot.Apply(std::move(judgement), {.steady = clock.Steady(), .system = clock.System()});
    ++come.outcomes[std::string(WordOf(applied.outcome))];
    for (const DurableRecord& record : applied.records) {
      ++come.records[ruri + " " + std::visit(InShort(), record)];
    }
  }
  return come;
}

std::vector<std::string> InWords(const Come& come) {
  std::vector<std::string> lines;
  for (const auto& [word, count] : come.outcomes)
    lines.push_back(fmt::format("{} {}", word, count));
  for (const auto& [ruri, count] : come.alive)
    lines.push_back(fmt::format("alive {} {}", ruri, count));
  for (const auto& [record, count] : come.records)
    lines.push_back(fmt::format("{} {}", record, count));
  for (const auto& [ruri, robot] : come.robots) {
    js::value all = view::TwinJson(robot.parts());
    Forget(all);
    for (const auto& part : all.as_object()) {
      const std::string key(part.key().data(), part.key().size());
      if (!part.value().is_object() || key == "position" || key == "rotation" || key == "scale") {
        lines.push_back(fmt::format("{} {} {}", ruri, key, js::serialize(part.value())));
        continue;
      }
      for (const auto& member : part.value().as_object()) {
        lines.push_back(fmt::format("{} {}.{} {}", ruri, key,
                                    std::string(member.key().data(), member.key().size()),
                                    js::serialize(member.value())));
      }
    }
  }
  return lines;
}

TEST(CyberwaveTwins, ComeToWhatIsExpectedPartByPart) {
  const std::vector<std::string> found = InWords(ApplyAll());
  const std::vector<std::string> expected = test::LinesOf(kExpected);
  for (std::size_t i = 0; i < std::max(found.size(), expected.size()); ++i) {
    EXPECT_EQ(i < found.size() ? found[i] : "nothing",
              i < expected.size() ? expected[i] : "nothing");
  }
}

}  // namespace
}  // namespace uplink::cyberwave
