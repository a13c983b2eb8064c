#include "tests/simulation/drones_process.h"

#include <utility>

#include "schema/base/check.h"
#include "server/journal/turns.h"
#include "tests/support/kept_lines.h"

namespace uplink::simulation {
namespace {

constexpr std::size_t kRobotsMax = 100;
constexpr std::size_t kPayloadBytesMax = 65'536;
constexpr std::chrono::hours kSessionIdle{1};
constexpr std::chrono::seconds kSweepEvery{1};
constexpr std::chrono::minutes kLetGoEvery{1};
/// After a start of a process that has the store alone.
constexpr std::chrono::minutes kAdoptGrace{2};

/// The leases as a process has them over its own way to the store, under its own name: all
/// processes of a simulation run in one.
class NamedLeases final : public storage::Leases {
 public:
  NamedLeases(std::unique_ptr<storage::Leases> leases, const DronesLine& line, std::string name)
      : leases_(std::move(leases)), line_(line), name_(std::move(name)) {}

  [[nodiscard]] std::string ServerRun() const override { return leases_->ServerRun(); }
  [[nodiscard]] absl::Status Renew(const storage::ProcessCard& /*card*/) override {
    if (line_.away()) return Away();
    return leases_->Renew({.name = name_, .life = name_});
  }
  [[nodiscard]] absl::Status Release() override {
    return line_.away() ? Away() : leases_->Release();
  }
  [[nodiscard]] absl::StatusOr<std::vector<storage::Lease>> Read() override {
    if (line_.away()) return Away();
    return leases_->Read();
  }
  [[nodiscard]] absl::StatusOr<std::vector<storage::ForeignRobot>> RobotsOfOthers(
      std::string_view after) override {
    if (line_.away()) return Away();
    return leases_->RobotsOfOthers(after);
  }

 private:
  static absl::Status Away() { return absl::UnavailableError("ordered"); }

  const std::unique_ptr<storage::Leases> leases_;
  const DronesLine& line_;
  const std::string name_;
};

/// True once each `every`; the next time counts from this one.
bool IsDue(std::optional<SteadyTime>& last, milliseconds every, SteadyTime now) {
  if (last && now - *last < every) return false;
  last = now;
  return true;
}

}  // namespace

DronesProcess::DronesProcess(const Ground& ground)
    : ground_(ground),
      line_(ground_.backend.Open(ground_.place, ground_.id), ground_.book, ground_.id),
      logger_(std::make_unique<testing::NoLines>(), ground_.clock, log::Format::kText,
              log::Level::kError),
      fleet_(ground_.clock, kRobotsMax, ground_.limits.presence),
      journal_(WayToStore(), ground_.limits.journal, ground_.clock, ledgers_.NewPage(),
               journal_probe_, ground_.id),
      drones_({.clock = ground_.clock,
               .fleet = fleet_,
               .journals = shards_,
               .ledger = ledgers_.NewPage(model::MessageSource::kUncrew),
               .seed = ground_.seed}),
      methods_{uncrew::AvatarMethods(ContextOfCalls())(ground_.clock),
               uncrew::AvatarMethods(ContextOfCalls())(ground_.clock)},
      loader_({.fleet = fleet_,
               .journals = shards_,
               .reader = ground_.backend.ReaderAt(ground_.place),
               .adopt_grace = ground_.backend.places() == 1
                                  ? std::optional<milliseconds>(kAdoptGrace)
                                  : std::nullopt}),
      restore_(fleet_, ground_.backend.ReaderAt(ground_.place)),
      leases_(MakeLeases(), {.fleet = fleet_,
                             .journals = shards_,
                             .clock = ground_.clock,
                             .logger = logger_,
                             .probe = lease_probe_,
                             .process = ground_.id,
                             .presence = {},
                             .is_gone = ground_.is_gone}) {
  fleet_.OnPresence(
      [this](const storage::RobotRef& robot, const storage::StoredPresence& now, auto why) {
        shards_.NotePresence(robot, now.presence, now.since, why, now.parked_until);
      });
}

storage::Store& DronesProcess::WayToStore() {
  if (ground_.trace == nullptr) return line_;
  return traced_.emplace(line_, *ground_.trace);
}

std::unique_ptr<storage::Leases> DronesProcess::MakeLeases() {
  auto leases = ground_.backend.LeasesOf(ground_.id);
  if (leases == nullptr) return nullptr;
  return std::make_unique<NamedLeases>(std::move(leases), line_, ground_.name);
}

uncrew::AvatarContext DronesProcess::ContextOfCalls() {
  return {.watch = ground_.clock,
          .drones = drones_,
          .fleet = fleet_,
          .probe = probe_,
          .ledgers = ledgers_,
          .allowances = allowances_,
          .answer_within = kAnswerWithin,
          .ruri_template = config::UncrewConfig().ruri_template,
          .in_flight_max = ground_.limits.in_flight_max,
          .payload_bytes_max = kPayloadBytesMax};
}

// --- Calls ---

void DronesProcess::Serve(std::uint64_t call, const identity::PeerIdentity& peer, SampleType type,
                          std::string_view request) {
  Served& served = calls_[call];
  served.call = std::make_unique<SimCall>(peer, loop::StreamRef{this, call});
  const std::string path =
      "/uncrew.v1.AvatarService/" + std::string(model::uncrew::RowOf(type).method);
  auto handler = methods_[call % methods_.size()].at(path).serve(*served.call);
  UPLINK_CHECK(handler.ok(), "a Publish call is served");
  served.handler = *std::move(handler);
  served.handler->Start();
  served.handler->OnMessage(request);
}

std::optional<CallEnd> DronesProcess::TakeEnd(std::uint64_t call) {
  const auto served = calls_.find(call);
  if (served == calls_.end() || !served->second.call->end()) return std::nullopt;
  std::optional<CallEnd> end = served->second.call->end();
  calls_.erase(served);
  return end;
}

void DronesProcess::Break(std::uint64_t call) {
  const auto served = calls_.find(call);
  if (served == calls_.end()) return;
  served->second.handler->OnBroken(
      {.cause = transport::EndCause::kReset, .code = absl::StatusCode::kCancelled});
  calls_.erase(served);
}

// --- Steps ---

void DronesProcess::DeliverWake(std::size_t which) {
  const auto woken = std::next(woken_.begin(), static_cast<std::ptrdiff_t>(which % woken_.size()));
  const auto served = calls_.find(*woken);
  woken_.erase(woken);
  // Waking a call that is gone does nothing.
  if (served != calls_.end() && !served->second.call->end()) served->second.handler->OnWake();
}

bool DronesProcess::Write() { return journal_.turns().Advance() == journal::Step::kWorked; }

void DronesProcess::Tick() {
  const SteadyTime now = ground_.clock.Steady();
  for (auto& [id, served] : calls_) {
    if (served.call->end()) continue;
    const auto due = served.handler->deadline();
    if (due && *due <= now) served.handler->OnTimer();
  }
  if (!line_.away()) {
    if (!loader_.done()) UPLINK_CHECK(loader_.Run(kRobotsMax).ok(), "the store can be read");
    UPLINK_CHECK(restore_.Run().ok(), "the store can be read");
  }
  if (IsDue(round_, store::kLookEvery, now)) leases_.Round();
  if (!draining_ && IsDue(sweep_, kSweepEvery, now)) {
    static_cast<void>(fleet_.Sweep(kSessionIdle));
  }
  if (IsDue(let_go_, kLetGoEvery, now)) drones_.Round();
}

void DronesProcess::Drain(milliseconds grace) {
  draining_ = true;
  for (auto& [id, served] : calls_) {
    if (!served.call->end()) served.handler->OnDrain(grace);
  }
}

void DronesProcess::Stop() {
  // As run::Drain ends.
  const bool judges = leases_.Leave() == store::LeaseRounds::Left::kToNone;
  for (const fleet::RobotPtr& robot : fleet_.Sorted()) {
    if (!judges || robot->state.held_since() == 0) continue;
    if (robot->state.presence() != model::Presence::kOnline) continue;
    shards_.NotePresence(robot->id(), model::Presence::kUnknown, ground_.clock.System());
  }
  while (Write()) {
  }
}

bool DronesProcess::HeldElsewhere(const std::string& ruri) const {
  const fleet::RobotPtr robot = fleet_.Find(ruri);
  return robot != nullptr && robot->state.foreign();
}

}  // namespace uplink::simulation
