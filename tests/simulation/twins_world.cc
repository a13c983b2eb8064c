#include "tests/simulation/twins_world.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "schema/base/check.h"

namespace uplink::simulation {
namespace {

constexpr std::uint64_t kSteps = 300;
constexpr std::uint64_t kStepsAwayMax = 60;
constexpr int kRoundsMax = 500;
constexpr const char* kTwins[] = {"11111111-2222-4333-8444-555555555555",
                                  "22222222-2222-4333-8444-555555555555"};

}  // namespace

TwinsWorld::TwinsWorld(std::uint64_t seed, Failovers failovers)
    : seed_(seed),
      failovers_(failovers),
      random_(seed),
      recorder_([this](const std::string& text) { Fail(text); }),
      broker_(clock_, [this](std::uint64_t number) { OnAcked(number); }) {
  Start();
}

TwinsResult TwinsWorld::Run() {
  while (step_ < kSteps && result_.violation.empty()) {
    ++step_;
    Step();
    broker_.Progress();
    CheckLaw();
  }
  if (result_.violation.empty()) Settle();
  if (result_.violation.empty()) CheckEnd();
  result_.redelivered = broker_.redelivered();
  return result_;
}

void TwinsWorld::Start() {
  std::vector<storage::OverHolder> over;
  if (lives_ > 0) over.push_back({.process = {lives_}, .lease_counter = 0});
  ++lives_;
  store_ = std::make_unique<testing::FakeStore>(database_, storage::ProcessId{lives_});
  recorder_.SetStore(store_.get());
  process_ = std::make_unique<TwinsProcess>(TwinsProcess::Ground{.clock = clock_,
                                                                 .database = database_,
                                                                 .recorder = recorder_,
                                                                 .broker = broker_,
                                                                 .id = {lives_},
                                                                 .over = std::move(over),
                                                                 .in_doubt = [this] { OnTold(); }});
  // A copy from before lacks the lease on the topics.
  has_copy_ = false;
}

void TwinsWorld::Step() {
  if (step_ >= back_at_step_) recorder_.SetAway(false);
  const std::size_t pick = random_.Below(100);
  if (pick < 15) return Publish();
  if (pick < 40) return static_cast<void>(Deliver());
  if (pick < 62) return process_->Write();
  if (pick < 80) return process_->TakePosted();
  if (pick < 88) return process_->ReadAgain();
  if (pick < 93) return Pass(milliseconds(100 + random_.Below(2'000)));
  Trouble();
}

void TwinsWorld::Trouble() {
  const std::size_t pick = random_.Below(100);
  if (pick < 40) return broker_.Break(random_.Below(4));
  if (pick < 60) {
    return recorder_.FailNext(random_.Percent(50) ? StoreFault::kBefore : StoreFault::kAfter);
  }
  if (pick < 70) return Kill();
  if (pick < 80) {
    copy_.CopyRowsOf(database_);
    recorder_.KeepCopy();
    has_copy_ = true;
    return;
  }
  GoBack();
}

void TwinsWorld::Publish() {
  const std::uint64_t number = ++result_.published;
  broker_.Publish({.number = number,
                   .topic = fmt::format("cyberwave/twin/{}/event", kTwins[random_.Below(2)]),
                   .payload = fmt::format(R"({{"event_type":"x","data":{{"n":{}}}}})", number)});
}

bool TwinsWorld::Deliver() {
  const bool nothing_waits = process_->counts().in_flight == 0;
  if (!broker_.Deliver()) return false;
  if (nothing_waits) {
    delivered_since_.insert(broker_.delivered());
  } else {
    delivered_since_.erase(broker_.delivered());
  }
  return true;
}

void TwinsWorld::Pass(milliseconds time) {
  clock_.Advance(time);
  process_->Tick();
}

void TwinsWorld::Kill() {
  ++result_.kills;
  broker_.Forget(random_.Below(4));
  process_.reset();
  // The next process knows nothing of what was told before.
  before_.reset();
  untold_.clear();
  NoteGone();
  Start();
}

void TwinsWorld::GoBack() {
  if (!has_copy_ || failovers_ == Failovers::kNo) return;
  ++result_.failovers;
  delivered_since_.clear();
  if (!before_) before_ = Stored();
  database_.CopyRowsOf(copy_);
  recorder_.GoBack([this] { OnReconnected(); });
  // Until a standby takes over there is none.
  recorder_.SetAway(true);
  back_at_step_ = step_ + random_.Below(kStepsAwayMax);
  // The connection to the one before is lost, and perhaps that to the broker as well.
  store_->Break();
  if (random_.Percent(50)) broker_.Break(random_.Below(4));
}

void TwinsWorld::OnReconnected() {
  // A new process connects for the first time.
  if (before_) untold_.push_back(*std::exchange(before_, std::nullopt));
}

void TwinsWorld::OnTold() {
  UPLINK_CHECK(!untold_.empty(), "the reader is told once each time");
  broker_.Progress();
  untold_.pop_front();
  NoteGone();
}

void TwinsWorld::NoteGone() {
  const std::multiset<std::uint64_t> stored = Stored();
  for (const std::uint64_t number : acked_) {
    if (!stored.contains(number)) gone_.insert(number);
  }
}

std::multiset<std::uint64_t> TwinsWorld::Stored() {
  std::multiset<std::uint64_t> numbers;
  storage::HistoryQuery query;
  query.page_size = storage::kPageSizeMax;
  for (bool more = true; more;) {
    const auto page = store_->Events({.rows = query});
    for (const storage::EventRow& row : page->rows) {
      const std::size_t at = row.detail_json.find("\"n\":");
      if (at != std::string::npos) numbers.insert(std::stoull(row.detail_json.substr(at + 4)));
    }
    query.page_token = page->next_token;
    more = !query.page_token.empty();
  }
  return numbers;
}

void TwinsWorld::OnAcked(std::uint64_t number) {
  ++result_.acked;
  acked_.insert(number);
  gone_.erase(number);
  if (Stored().contains(number)) return;
  const bool may_be_told = !delivered_since_.contains(number);
  if (may_be_told && before_ && before_->contains(number)) return;
  if (may_be_told &&
      std::ranges::any_of(untold_, [&](const auto& had) { return had.contains(number); })) {
    return;
  }
  Fail(fmt::format("message {} is acked, and the store has it not", number));
}

void TwinsWorld::CheckLaw() {
  if (!process_->counts().Balanced()) Fail("the messages' conservation law is broken");
}

void TwinsWorld::Settle() {
  recorder_.FailNext(StoreFault::kNone);
  recorder_.SetAway(false);
  for (int round = 0; round < kRoundsMax && result_.violation.empty(); ++round) {
    const bool in_doubt = before_ || !untold_.empty();
    if (broker_.waiting() == 0 && process_->idle() && !in_doubt) return;
    while (Deliver()) {
    }
    process_->Write();
    process_->TakePosted();
    process_->ReadAgain();
    Pass(milliseconds(1'000));
    broker_.Progress();
    CheckLaw();
  }
  Fail(fmt::format("faults have stopped and {} messages wait", broker_.waiting()));
}

void TwinsWorld::CheckEnd() {
  const std::multiset<std::uint64_t> stored = Stored();
  for (std::uint64_t number = 1; number <= result_.published; ++number) {
    const std::size_t times = stored.count(number);
    if (times == 1 || (times == 0 && gone_.contains(number))) continue;
    Fail(fmt::format("message {} is stored {} times", number, times));
  }
}

void TwinsWorld::Fail(const std::string& what) {
  if (result_.violation.empty()) {
    result_.violation = fmt::format("seed {} step {}: {}", seed_, step_, what);
  }
}

}  // namespace uplink::simulation
