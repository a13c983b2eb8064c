#include <limits>
#include <set>
#include <string>
#include <utility>

#include "schema/limits.h"
#include "tests/unit/schema/judging.h"
#include "tests/unit/schema/samples.h"

namespace uplink::test {
namespace {

using model::RejectReason;
using model::UiCapabilities;
using model::ValueType;

TEST(CapabilitiesTest, NeedNamesAndKeys) {
  UiCapabilities ui = SampleCapabilities();
  ui.services[0].name.clear();
  ExpectRejected(JudgeBody(ui), RejectReason::kMissingField, "services[0].name");
  ui = SampleCapabilities();
  ui.sensors[0].key.clear();
  ExpectRejected(JudgeBody(ui), RejectReason::kMissingField, "sensors[0].key");
  ui = SampleCapabilities();
  ui.settings[0].key.clear();
  ExpectRejected(JudgeBody(ui), RejectReason::kMissingField, "settings[0].key");
}

TEST(CapabilitiesTest, AreUniqueWithinTheirList) {
  UiCapabilities ui = SampleCapabilities();
  ui.services.push_back(ui.services[0]);
  ExpectRejected(JudgeBody(ui), RejectReason::kDuplicateKey, "services[1].name");
  ui = SampleCapabilities();
  ui.sensors.push_back(ui.sensors[0]);
  ExpectRejected(JudgeBody(ui), RejectReason::kDuplicateKey, "sensors[1].key");
  ui = SampleCapabilities();
  ui.settings.push_back(ui.settings[0]);
  ExpectRejected(JudgeBody(ui), RejectReason::kDuplicateKey, "settings[1].key");
  // One key in two lists is no clash.
  ui = SampleCapabilities();
  ui.settings[0].key = ui.sensors[0].key;
  ExpectGood(JudgeBody(ui));
}

TEST(CapabilitiesTest, HaveUpTo256OfEach) {
  const auto filled = [](std::size_t services, std::size_t sensors, std::size_t settings) {
    UiCapabilities ui;
    for (std::size_t i = 0; i < services; ++i) {
      ui.services.push_back(SampleCapabilities().services[0]);
      ui.services.back().name = std::to_string(i);
    }
    for (std::size_t i = 0; i < sensors; ++i) {
      ui.sensors.push_back(SampleCapabilities().sensors[0]);
      ui.sensors.back().key = std::to_string(i);
    }
    for (std::size_t i = 0; i < settings; ++i) {
      ui.settings.push_back(SampleCapabilities().settings[0]);
      ui.settings.back().key = std::to_string(i);
    }
    return ui;
  };
  ExpectGood(JudgeBody(filled(256, 256, 256)));
  ExpectRejected(JudgeBody(filled(257, 0, 0)), RejectReason::kTooManyItems, "services");
  ExpectRejected(JudgeBody(filled(0, 257, 0)), RejectReason::kTooManyItems, "sensors");
  ExpectRejected(JudgeBody(filled(0, 0, 257)), RejectReason::kTooManyItems, "settings");
}

TEST(CapabilitiesTest, MayHaveAnEmptyRangeButNoInvertedOne) {
  UiCapabilities ui = SampleCapabilities();
  ui.sensors[0].range = model::Range{.min = 1, .max = 1};
  ui.settings[0].range = model::Range{.min = 1, .max = 1};
  ExpectGood(JudgeBody(ui));
  ui.sensors[0].range->max = std::numeric_limits<double>::infinity();
  ExpectRejected(JudgeBody(ui), RejectReason::kNotFinite, "sensors[0].rangeMax");
}

TEST(CapabilitiesTest, TakesDefaultsOfTheDeclaredType) {
  const std::vector<model::Value> values = {std::string("s"), std::int32_t{1}, 1.5, true,
                                            model::EnumName{"e"}};
  const std::set<std::pair<ValueType, ValueType>> also = {{ValueType::kNumber, ValueType::kInt},
                                                          {ValueType::kEnum, ValueType::kString}};
  for (std::size_t declared = 0; declared < values.size(); ++declared) {
    for (const model::Value& value : values) {
      UiCapabilities ui = SampleCapabilities();
      ui.settings[0].value_type = static_cast<ValueType>(declared);
      ui.settings[0].default_value = value;
      SCOPED_TRACE(model::EnumText(ui.settings[0].value_type) + " with " +
                   model::EnumText(model::TypeOf(value)));
      const schema::Judgement judgement = JudgeBody(ui);
      if (model::TypeOf(value) == ui.settings[0].value_type ||
          also.contains({ui.settings[0].value_type, model::TypeOf(value)})) {
        ExpectGood(judgement);
      } else {
        ExpectRejected(judgement, RejectReason::kTypeMismatch, "settings[0].default");
      }
    }
  }
}

TEST(CapabilitiesTest, DoNotJudgeDefaultsOfATypeWeDoNotKnow) {
  UiCapabilities ui = SampleCapabilities();
  ui.settings[0].value_type = static_cast<ValueType>(5);
  const schema::Judgement judgement = JudgeBody(ui);
  ExpectGood(judgement);
  EXPECT_EQ(judgement.enumerants_unrecognized, 1U);
}

TEST(SettingsTest, NeedUniqueKeys) {
  model::CurrentSettings settings = SampleSettings();
  settings.settings[2].key = settings.settings[0].key;
  ExpectRejected(JudgeBody(settings), RejectReason::kDuplicateKey, "[2].key");
  settings.settings[2].key.clear();
  ExpectRejected(JudgeBody(settings), RejectReason::kMissingField, "[2].key");
}

TEST(SettingsTest, AreUpTo256) {
  model::CurrentSettings settings;
  for (int i = 0; i < 256; ++i) settings.settings.push_back({std::to_string(i), i});
  ExpectGood(JudgeBody(settings));
  settings.settings.push_back({"more", true});
  ExpectRejected(JudgeBody(settings), RejectReason::kTooManyItems, "");
}

TEST(SettingsTest, MayBeNone) { ExpectGood(JudgeBody(model::CurrentSettings{})); }

}  // namespace
}  // namespace uplink::test
