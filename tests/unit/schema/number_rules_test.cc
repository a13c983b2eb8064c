#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/schema/judging.h"
#include "tests/unit/schema/samples.h"

namespace uplink::test {
namespace {

using model::Body;
using model::RejectReason;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// One number of a message, with valid and invalid values. NaN and the infinities
/// are tried for every field.
struct NumberCase {
  std::string name;
  std::string field;
  std::function<Body(double)> body;
  std::vector<double> good;
  std::vector<double> out_of_range;
  bool nan_is_absent = false;
};

template <typename T>
std::function<Body(double)> With(T sample, std::function<void(T&, double)> set) {
  return [sample, set](double value) {
    T body = sample;
    set(body, value);
    return Body(body);
  };
}

float F(double value) { return static_cast<float>(value); }

std::vector<NumberCase> MotionCases() {
  using model::MotionTelemetry;
  const auto motion = [](std::function<void(MotionTelemetry&, double)> set) {
    return With<MotionTelemetry>(SampleMotion(), std::move(set));
  };
  return {
      {"Latitude",
       "pose.latDeg",
       motion([](auto& b, double v) { b.pose->lat_deg = v; }),
       {-90, 0, 90},
       {-90.0001, 90.0001}},
      {"Longitude",
       "pose.lonDeg",
       motion([](auto& b, double v) { b.pose->lon_deg = v; }),
       {-180, 180},
       {-180.0001, 180.0001}},
      {"Altitude",
       "pose.altitudeM",
       motion([](auto& b, double v) { b.pose->altitude_m = v; }),
       {-12'000, 100'000},
       {-12'000.1, 100'000.1},
       true},
      {"Heading",
       "pose.headingDeg",
       motion([](auto& b, double v) { b.pose->heading_deg = v; }),
       {-1e9, 0, 1e9},
       {},
       true},
      {"Linear",
       "velocity.linearMps",
       motion([](auto& b, double v) { b.velocity->linear_mps = F(v); }),
       {-1000, 1000},
       {-1000.1, 1000.1}},
      {"Angular",
       "velocity.angularRps",
       motion([](auto& b, double v) { b.velocity->angular_rps = F(v); }),
       {-1000, 1000},
       {-1000.1, 1000.1}},
  };
}

std::vector<NumberCase> StatusCases() {
  using model::StatusTelemetry;
  const auto status = [](std::function<void(StatusTelemetry&, double)> set) {
    return With<StatusTelemetry>(SampleStatus(), std::move(set));
  };
  const std::vector<double> any = {-1e30, 0, 1e30};
  return {
      {"Soc",
       "battery.socPct",
       status([](auto& b, double v) { b.battery->soc_pct = F(v); }),
       {-5, 0, 100, 105},
       {-5.1, 105.1}},
      {"Voltage",
       "battery.voltageV",
       status([](auto& b, double v) { b.battery->voltage_v = F(v); }),
       any,
       {}},
      {"Current",
       "battery.currentA",
       status([](auto& b, double v) { b.battery->current_a = F(v); }),
       any,
       {},
       true},
      {"Charge",
       "battery.chargeAh",
       status([](auto& b, double v) { b.battery->charge_ah = F(v); }),
       any,
       {}},
      {"Capacity",
       "battery.capacityAh",
       status([](auto& b, double v) { b.battery->capacity_ah = F(v); }),
       any,
       {}},
      {"DesignCapacity",
       "battery.designCapacityAh",
       status([](auto& b, double v) { b.battery->design_capacity_ah = F(v); }),
       any,
       {}},
      {"Temperature",
       "battery.temperature",
       status([](auto& b, double v) { b.battery->temperature = F(v); }),
       {-273.15, 1000},
       {-273.2, 1000.1},
       true},
      {"FuelLevel",
       "fuel.levelPct",
       status([](auto& b, double v) { b.fuel->level_pct = F(v); }),
       {-5, 105},
       {-5.1, 105.1}},
      {"FuelVolume",
       "fuel.volumeRemaining",
       status([](auto& b, double v) { b.fuel->volume_remaining = F(v); }),
       any,
       {}},
      {"FuelCapacity",
       "fuel.capacity",
       status([](auto& b, double v) { b.fuel->capacity = F(v); }),
       any,
       {}},
      {"FuelEfficiency",
       "fuel.efficiency",
       status([](auto& b, double v) { b.fuel->efficiency = F(v); }),
       any,
       {}},
      {"Range",
       "rangeRemaining",
       status([](auto& b, double v) { b.range_remaining = v; }),
       {0, 1e12},
       {-0.001}},
      {"Runtime",
       "runtimeRemaining",
       status([](auto& b, double v) { b.runtime_remaining = v; }),
       {0, 1e12},
       {-0.001}},
      {"Extra",
       "kv[1].value",
       With<model::TelemetryExtras>(SampleExtras(), [](auto& b, double v) { b.kv[1].value = v; }),
       any,
       {}},
  };
}

std::vector<NumberCase> HealthCases() {
  using model::SystemHealth;
  using model::UsageTelemetry;
  const auto health = [](std::function<void(SystemHealth&, double)> set) {
    return With<SystemHealth>(SampleHealth(), std::move(set));
  };
  const auto usage = [](std::function<void(UsageTelemetry&, double)> set) {
    return With<UsageTelemetry>(SampleUsage(), std::move(set));
  };
  const std::vector<double> good_percent = {-5, 0, 100, 105};
  const std::vector<double> bad_percent = {-5.1, 105.1};
  const std::vector<double> any = {-1e30, 1e30};
  const std::vector<double> total = {0, 1e15};
  return {
      {"Cpu", "cpuPct", health([](auto& b, double v) { b.cpu_pct = F(v); }), good_percent,
       bad_percent, true},
      {"Memory", "memPct", health([](auto& b, double v) { b.mem_pct = F(v); }), good_percent,
       bad_percent, true},
      {"Disk", "diskPct", health([](auto& b, double v) { b.disk_pct = F(v); }), good_percent,
       bad_percent, true},
      {"CpuTemp", "cpuTemp", health([](auto& b, double v) { b.cpu_temp = F(v); }), any, {}, true},
      {"Signal",
       "signalStrength",
       health([](auto& b, double v) { b.signal_strength = F(v); }),
       any,
       {},
       true},
      {"SignalQuality",
       "signalQuality",
       health([](auto& b, double v) { b.signal_quality = F(v); }),
       any,
       {},
       true},
      {"TotalDistance",
       "totalDistanceM",
       usage([](auto& b, double v) { b.total_distance_m = v; }),
       total,
       {-0.1}},
      {"AutoDistance",
       "autoDistanceM",
       usage([](auto& b, double v) { b.auto_distance_m = v; }),
       total,
       {-0.1}},
      {"ManualDistance",
       "manualDistanceM",
       usage([](auto& b, double v) { b.manual_distance_m = v; }),
       total,
       {-0.1}},
      {"Uptime",
       "uptimeTotalS",
       usage([](auto& b, double v) { b.uptime_total_s = v; }),
       total,
       {-0.1}},
      {"DriveTime",
       "driveTimeTotalS",
       usage([](auto& b, double v) { b.drive_time_total_s = v; }),
       total,
       {-0.1}},
      {"AutoTime",
       "autoTimeTotalS",
       usage([](auto& b, double v) { b.auto_time_total_s = v; }),
       total,
       {-0.1}},
      {"ConsumableLevel", "levelPct",
       With<model::ConsumableStatus>(SampleConsumable(),
                                     [](auto& b, double v) { b.level_pct = F(v); }),
       good_percent, bad_percent},
      {"ConsumableAmount",
       "amountRemaining",
       With<model::ConsumableStatus>(SampleConsumable(),
                                     [](auto& b, double v) { b.amount_remaining = F(v); }),
       {0, 1e30},
       {-0.1}},
      {"Distance",
       "distanceToZoneM",
       With<model::SpatialDirectiveStatus>(SampleDirective(),
                                           [](auto& b, double v) { b.distance_to_zone_m = F(v); }),
       {0, 1e30},
       {-0.1}},
  };
}

// NOLINTNEXTLINE(readability-function-size): a table
std::vector<NumberCase> DurableCases() {
  using model::Object;
  using model::ReportedShape;
  using model::UiCapabilities;
  const auto object = [](const std::function<void(Object&, double)>& set) {
    return [set](double value) {
      Object body = SampleObject();
      set(body, value);
      return Body(model::ObjectOp{body});
    };
  };
  const auto shape = [](const std::function<void(ReportedShape&, double)>& set) {
    return [set](double value) {
      ReportedShape body = SampleShape();
      set(body, value);
      return Body(model::ShapeOp{body});
    };
  };
  const auto hole = [](ReportedShape& b) -> model::GeoPoint2& {
    return std::get<model::PolygonData>(b.data).holes[0][2];
  };
  const auto ui = [](std::function<void(UiCapabilities&, double)> set) {
    return With<UiCapabilities>(SampleCapabilities(), std::move(set));
  };
  return {
      {"TargetLatitude",
       "currentTarget.latDeg",
       With<model::MissionRunStatus>(SampleMission(),
                                     [](auto& b, double v) { b.current_target->lat_deg = v; }),
       {-90, 90},
       {-91, 91}},
      {"TargetHeading",
       "currentTarget.headingDeg",
       With<model::MissionRunStatus>(SampleMission(),
                                     [](auto& b, double v) { b.current_target->heading_deg = v; }),
       {-720, 720},
       {},
       true},
      {"Location",
       "upsert.location.lonDeg",
       object([](auto& b, double v) { b.location.lon_deg = v; }),
       {-180, 180},
       {-181, 181}},
      {"LocationAltitude",
       "upsert.location.altitudeM",
       object([](auto& b, double v) { b.location.altitude_m = v; }),
       {-12'000, 100'000},
       {-12'001, 100'001},
       true},
      {"Radius",
       "upsert.radiusM",
       object([](auto& b, double v) { b.radius_m = v; }),
       {0, 1e9},
       {-0.1}},
      {"Speed",
       "upsert.trajectory.speedMps",
       object([](auto& b, double v) { b.trajectory->speed_mps = v; }),
       {-1e9, 1e9},
       {}},
      {"Course",
       "upsert.trajectory.courseDeg",
       object([](auto& b, double v) { b.trajectory->course_deg = v; }),
       {-1e9, 1e9},
       {}},
      {"VerticalRate",
       "upsert.trajectory.verticalRateMps",
       object([](auto& b, double v) { b.trajectory->vertical_rate_mps = v; }),
       {-1e9, 1e9},
       {}},
      {"RingLatitude",
       "upsert.data.polygon.holes[0][2].lat",
       shape([hole](auto& b, double v) { hole(b).lat = v; }),
       {-90, 90},
       {-90.1, 90.1}},
      {"RingLongitude",
       "upsert.data.polygon.holes[0][2].lon",
       shape([hole](auto& b, double v) { hole(b).lon = v; }),
       {-180, 180},
       {-180.1, 180.1}},
      {"Point",
       "upsert.data.point.lat",
       shape([](auto& b, double v) { b.data = model::GeoPoint2{.lon = 1, .lat = v}; }),
       {-90, 90},
       {-90.1, 90.1}},
      {"MinZ", "upsert.minZM", shape([](auto& b, double v) { b.min_z_m = v; }), {-1e9, 2}, {2.1}},
      {"SensorMin",
       "sensors[0].rangeMin",
       ui([](auto& b, double v) { b.sensors[0].range->min = v; }),
       {-1e9, 5000},
       {5000.1}},
      {"SettingMin",
       "settings[0].range.min",
       ui([](auto& b, double v) { b.settings[0].range->min = v; }),
       {-1e9, 3},
       {3.1}},
      {"SettingStep",
       "settings[0].step",
       ui([](auto& b, double v) { b.settings[0].step = v; }),
       {-1e9, 1e9},
       {}},
      {"SettingDefault",
       "settings[0].default",
       ui([](auto& b, double v) { b.settings[0].default_value = v; }),
       {-1e9, 1e9},
       {}},
      {"CurrentSetting",
       "[0].value",
       With<model::CurrentSettings>(SampleSettings(),
                                    [](auto& b, double v) { b.settings[0].value = v; }),
       {-1e9, 1e9},
       {}},
  };
}

std::vector<NumberCase> AllCases() {
  std::vector<NumberCase> cases = MotionCases();
  for (auto make : {StatusCases, HealthCases, DurableCases}) {
    for (NumberCase& number : make()) cases.push_back(std::move(number));
  }
  return cases;
}

class NumberRuleTest : public testing::TestWithParam<NumberCase> {
 protected:
  void ExpectFault(double value, RejectReason reason) const {
    SCOPED_TRACE(value);
    const Body body = GetParam().body(value);
    const schema::Judgement judgement = JudgeBody(body);
    if (model::IsDurable(model::VariantOf(body))) {
      ExpectRejected(judgement, reason, GetParam().field);
    } else {
      ExpectThinned(judgement, reason, GetParam().field);
    }
  }
};

TEST_P(NumberRuleTest, TakesValuesUpToTheLimits) {
  for (const double value : GetParam().good) {
    SCOPED_TRACE(value);
    ExpectGood(JudgeBody(GetParam().body(value)));
  }
}

TEST_P(NumberRuleTest, FaultsValuesPastTheLimits) {
  for (const double value : GetParam().out_of_range) ExpectFault(value, RejectReason::kOutOfRange);
}

TEST_P(NumberRuleTest, FaultsWhatIsNotFinite) {
  ExpectFault(kInf, RejectReason::kNotFinite);
  ExpectFault(-kInf, RejectReason::kNotFinite);
}

TEST_P(NumberRuleTest, TakesNanAsItsFieldSays) {
  if (GetParam().nan_is_absent) {
    ExpectGood(JudgeBody(GetParam().body(kNan)));
  } else {
    ExpectFault(kNan, RejectReason::kNotFinite);
  }
}

INSTANTIATE_TEST_SUITE_P(Fields, NumberRuleTest, testing::ValuesIn(AllCases()),
                         [](const auto& test) { return test.param.name; });

TEST(PercentTest, IsClampedWithinTheSlack) {
  const std::vector<std::pair<float, float>> cases = {
      {-5.0F, 0.0F},    {-0.1F, 0.0F},    {0.0F, 0.0F},    {50.5F, 50.5F},
      {100.0F, 100.0F}, {100.1F, 100.0F}, {105.0F, 100.0F}};
  for (const auto& [sent, kept] : cases) {
    model::SystemHealth health = SampleHealth();
    health.cpu_pct = sent;
    const auto judged = BodyOf<model::SystemHealth>(JudgeBody(health));
    EXPECT_EQ(judged.cpu_pct, kept) << sent;
    EXPECT_FALSE(std::signbit(*judged.cpu_pct)) << sent;
  }
}

TEST(HeadingTest, IsKeptInOneTurn) {
  const std::vector<std::pair<double, double>> cases = {{0, 0},   {-0.0, 0},   {359.5, 359.5},
                                                        {360, 0}, {-90, 270},  {-360, 0},
                                                        {725, 5}, {-1e-18, 0}, {-720.5, 359.5}};
  for (const auto& [sent, kept] : cases) {
    model::MotionTelemetry motion = SampleMotion();
    motion.pose->heading_deg = sent;
    const auto judged = BodyOf<model::MotionTelemetry>(JudgeBody(motion));
    EXPECT_EQ(judged.pose->heading_deg, kept) << sent;
    EXPECT_FALSE(std::signbit(*judged.pose->heading_deg)) << sent;
  }
}

TEST(NanTest, MeansNotMeasuredAndIsNotReported) {
  model::StatusTelemetry status = SampleStatus();
  status.battery->current_a = F(kNan);
  status.battery->temperature = F(kNan);
  const auto judged = BodyOf<model::StatusTelemetry>(JudgeBody(status));
  EXPECT_EQ(judged.battery->current_a, std::nullopt);
  EXPECT_EQ(judged.battery->temperature, std::nullopt);
  EXPECT_EQ(judged.battery->voltage_v, 48.0F);
}

TEST(PoseTest, FallsWholeWithItsLatitude) {
  model::MotionTelemetry motion = SampleMotion();
  motion.pose->lat_deg = 91;
  motion.pose->altitude_m = kInf;
  const schema::Judgement judgement = JudgeBody(motion);
  ExpectThinned(judgement, RejectReason::kOutOfRange, "pose.latDeg");
  EXPECT_EQ(BodyOf<model::MotionTelemetry>(judgement).pose, std::nullopt);
}

TEST(PoseTest, LosesOnlyItsAltitude) {
  model::MotionTelemetry motion = SampleMotion();
  motion.pose->altitude_m = 200'000;
  const auto judged = BodyOf<model::MotionTelemetry>(JudgeBody(motion));
  ASSERT_TRUE(judged.pose.has_value());
  EXPECT_EQ(judged.pose->altitude_m, std::nullopt);
  EXPECT_EQ(judged.pose->heading_deg, 90);
}

}  // namespace
}  // namespace uplink::test
