#include "tests/simulation/days.h"

#include <filesystem>

#include <fmt/core.h>

#include "schema/base/check.h"
#include "schema/encode.h"
#include "server/journal/turns.h"
#include "tests/support/sqlite_shell.h"

namespace uplink::simulation {
namespace {

/// Later sweeps the server takes for a stall of its own (fleet::Fleet::kSweepLate).
constexpr std::chrono::seconds kSweep = fleet::Fleet::kSweepLate;
constexpr std::chrono::hours kHour{1};
constexpr std::int64_t kObjectLifeMs = 1'800'000;
constexpr std::int64_t kBytesAKiB = 1024;
constexpr const char* kTables[] = {
    "robots",  "sessions", "faults_history",   "faults_active",   "quarantine",
    "events",  "messages", "mission_reports",  "mission_runs",    "shapes",
    "objects", "latest",   "presence_changes", "presence_latest", "live"};

std::string RuriOf(int robot) { return fmt::format("rcan://days/{}", robot); }

model::SessionId SessionOf(int robot, int day) {
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  bytes[0] = static_cast<std::uint8_t>(robot);
  bytes[1] = static_cast<std::uint8_t>(day);
  bytes[2] = 1;
  return model::SessionId(bytes);
}

/// What a robot tells in an hour: one of most kinds, and something wrong.
std::vector<std::string> PayloadsAt(std::int64_t now_ms, int robot, int hour) {
  std::vector<std::string> payloads;
  const auto add = [&](const model::Body& body) { payloads.push_back(schema::Encode(body)); };
  model::MotionTelemetry motion;
  motion.unix_time_ms = now_ms;
  motion.pose = model::Pose{.lat_deg = 52, .lon_deg = 13, .altitude_m = 40, .heading_deg = 1};
  add(motion);
  model::Fault fault;
  fault.unix_time_ms = now_ms;
  fault.fault_id = "lidar.blocked";
  fault.source = "days";
  fault.active = hour % 2 == 0;
  add(fault);
  add(model::EventTelemetry{now_ms, model::FaultClearedEvent{"lidar.blocked"}});
  model::Message message;
  message.unix_time_ms = now_ms;
  message.message = fmt::format("hour {}", hour);
  add(message);
  model::MissionRunStatus mission;
  mission.unix_time_ms = now_ms;
  mission.mission_id = "mow";
  mission.run_id = fmt::format("{}-{}", robot, hour);
  mission.status = model::MissionStatus::kComplete;
  add(mission);
  model::Object object;
  object.id = fmt::format("seen-{}-{}", robot, hour);
  object.unix_time_ms = now_ms;
  object.expires_unix_time_ms = now_ms + kObjectLifeMs;
  object.location = model::Pose{.lat_deg = 52, .lon_deg = 13, .altitude_m = 40, .heading_deg = 1};
  object.radius_m = 1;
  add(model::ObjectOp{object});
  payloads.emplace_back("not a payload");
  return payloads;
}

}  // namespace

Days::Days(const DaysOptions& options)
    : options_(options), recorder_([](const std::string& text) { UPLINK_CHECK(false, text); }) {
  storage::sqlite::StoreOptions store;
  store.process = {1};
  store.rules.retain_history = std::chrono::days(options.history_days);
  store.rules.retain_quarantine = std::chrono::days(options.quarantine_days);
  auto opened = storage::sqlite::SqliteStore::Open(folder_.File("days.db"), store);
  UPLINK_CHECK(opened.ok(), opened.status().ToString());
  store_ = *std::move(opened);
  recorder_.SetStore(store_.get());
  ServerLimits limits;
  limits.journal.retains = true;
  const Ground ground{.clock = clock_, .store = recorder_};
  server_ = std::make_unique<SimServer>(ground, limits, storage::ProcessId{1});
}

void Days::Settle() {
  do {
    while (server_->HasWakes()) server_->DeliverWake(0);
    for (auto& [id, stream] : server_->streams()) {
      while (stream->Writing()) stream->CompleteWrite();
      while (stream->CanReceive()) static_cast<void>(stream->Receive());
      while (stream->CanDeliver()) stream->DeliverToServer();
    }
  } while (server_->HasWakes() || server_->journal().turns().Advance() == journal::Step::kWorked);
}

void Days::Pass(milliseconds time) {
  clock_.Advance(time);
  server_->FireTimers();
  server_->fleet().Sweep(kHour);
  Settle();
}

void Days::Visit(int robot, int hour) {
  const std::uint64_t id = server_->Open({.ruri = RuriOf(robot), .fleet = "sim"});
  SimStream& stream = *server_->Find(id);
  v1::RelayRequest hello;
  hello.mutable_hello()->set_session_id(std::string(SessionOf(robot, hour / 24).AsBytes()));
  hello.mutable_hello()->set_schema(v1::PAYLOAD_SCHEMA_ROVER_NEXUS_0_1);
  stream.Send(hello);
  Settle();
  model::Seq& seq = last_seq_[robot * 10'000 + hour / 24];
  v1::RelayRequest frame;
  for (const std::string& payload : PayloadsAt(UnixMs(clock_.System()), robot, hour)) {
    v1::Uplink& uplink = *frame.mutable_batch()->add_uplinks();
    uplink.set_seq(++seq);
    uplink.set_rover_nexus(payload);
  }
  stream.Send(frame);
  Settle();
  stream.Break();
  if (stream.CanTellBroken()) stream.TellBroken();
  Settle();
  server_->Forget(id);
}

void Days::Hour(int hour) {
  for (int robot = 0; robot < options_.robots; ++robot) {
    if ((hour + robot) % 3 != 0) Visit(robot, hour);
  }
  for (milliseconds left = kHour; left.count() > 0; left -= kSweep) Pass(kSweep);
}

DayFigures Days::Figures(int day) {
  DayFigures figures;
  figures.day = day;
  testing::SqliteShell shell(folder_.File("days.db"));
  for (const char* table : kTables) {
    figures.rows[table] = std::stoll(shell.Read(fmt::format("SELECT count(*) FROM {}", table)));
  }
  figures.file_kib =
      static_cast<std::int64_t>(std::filesystem::file_size(folder_.File("days.db"))) / kBytesAKiB;
  return figures;
}

std::vector<DayFigures> Days::Run() {
  std::vector<DayFigures> days;
  for (int day = 0; day < options_.days; ++day) {
    for (int hour = day * 24; hour < (day + 1) * 24; ++hour) Hour(hour);
    days.push_back(Figures(day));
  }
  return days;
}

}  // namespace uplink::simulation
