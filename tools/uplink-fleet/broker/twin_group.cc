#include "tools/uplink-fleet/broker/twin_group.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

/// A turn waits no longer, so that a stage that ends is seen.
constexpr milliseconds kTurnMax{20};
/// What is due longer is left out.
constexpr milliseconds kBehindMax{1'000};
/// A ping without a pong for that long is lost.
constexpr milliseconds kPongWithin{10'000};

}  // namespace

TwinGroup::TwinGroup(const TwinGroupOptions& options, const Clock& clock, TwinsShared& shared)
    : options_(options),
      clock_(clock),
      shared_(shared),
      period_(std::chrono::duration_cast<SteadyTime::duration>(
          std::chrono::duration<double>(1 / options.rate_hz))),
      queued_(options.twins),
      due_(options.twins, clock.Steady()),
      ping_name_(fmt::format("fleet-{}-{}", options.run, options.first)) {
  twins_.reserve(options.twins);
  for (std::size_t i = 0; i < options.twins; ++i) {
    const TwinOptions twin{.seed = options.seed,
                           .index = options.first + i,
                           .run = options.run,
                           .prefix = options.prefix};
    twins_.push_back(std::make_unique<TwinScript>(twin));
    for (Publication& each : twins_.back()->First(NowUs())) queued_[i].push_back(std::move(each));
    // Not all of them at once.
    due_[i] += period_ * static_cast<int>(i) / static_cast<int>(options.twins);
  }
}

std::int64_t TwinGroup::NowUs() const {
  constexpr std::int64_t kUsPerMs = 1'000;
  return UnixMs(clock_.System()) * kUsPerMs;
}

void TwinGroup::Run() {
  auto link = BrokerLink::Create(options_.broker, *this);
  if (!link.ok()) return shared_.first_error.Keep(std::string(link.status().message()));
  link_ = *std::move(link);
  // Where nothing is read, nothing wakes: the wait is the link's own.
  while (!shared_.abandon.load()) {
    const TwinStage stage = shared_.stage.load();
    if (stage != stage_) EnterStage(stage);
    if (stage == TwinStage::kClose) break;
    const SteadyTime now = clock_.Steady();
    if (!Connected(now)) continue;
    if (absl::Status status = link_->Turn(UntilDue(now)); !status.ok()) {
      Ended(status);
      continue;
    }
    if (connected_) Work(clock_.Steady());
  }
  link_->Disconnect();
}

bool TwinGroup::Connected(SteadyTime now) {
  if (opened_) return true;
  if (now < connect_at_) {
    // No connection, so a turn ends at once: nothing to wait for but time.
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable never;
    never.wait_for(lock, kTurnMax);
    return false;
  }
  if (absl::Status status = link_->Connect(); !status.ok()) {
    Ended(status);
    return false;
  }
  opened_ = true;
  return true;
}

void TwinGroup::Ended(const absl::Status& status) {
  shared_.first_error.Keep(std::string(status.message()));
  if (connected_) shared_.breaks.fetch_add(1);
  connected_ = false;
  opened_ = false;
  pinged_.reset();
  for (const auto& twin : twins_) twin->account().Broke();
  connect_at_ = clock_.Steady() + kReconnectAfter;
}

void TwinGroup::OnConnected() {
  connected_ = true;
  shared_.connections.fetch_add(1);
  const std::string pong = fmt::format("{}cyberwave/pong/{}/response", options_.prefix, ping_name_);
  if (absl::Status status = link_->Subscribe(pong); !status.ok()) {
    shared_.first_error.Keep(std::string(status.message()));
  }
}

void TwinGroup::OnAcked(int id, std::string_view refused) {
  const auto found = unacked_.find(id);
  if (found == unacked_.end()) return;
  TwinAccount& account = twins_[found->second.twin]->account();
  if (refused.empty()) {
    account.Acked(found->second.number);
    shared_.acked.fetch_add(1);
  } else {
    account.Refused(found->second.number);
    shared_.first_error.Keep(fmt::format("the broker refused a publication: {}", refused));
  }
  unacked_.erase(found);
}

void TwinGroup::OnMessage(std::string_view /*topic*/, std::string_view /*payload*/) {
  if (!pinged_) return;
  pong_.Record(clock_.Steady() - *pinged_);
  pinged_.reset();
  shared_.pongs.fetch_add(1);
}

void TwinGroup::EnterStage(TwinStage stage) {
  stage_ = stage;
  told_ = false;
  if (stage == TwinStage::kSend || stage == TwinStage::kClose) return;
  for (std::size_t i = 0; i < twins_.size(); ++i) {
    if (stage == TwinStage::kLast) {
      for (Publication& each : twins_[i]->Last(NowUs())) queued_[i].push_back(std::move(each));
    }
    due_[i] = clock_.Steady();
  }
}

void TwinGroup::Work(SteadyTime now) {
  Ping(now);
  PublishDue(now);
  if (told_ || stage_ == TwinStage::kSend || !NothingQueued() || !AllAcked()) return;
  told_ = true;
  (stage_ == TwinStage::kLast ? shared_.quiet_groups : shared_.settled_groups).fetch_add(1);
}

bool TwinGroup::MayPublish() const {
  return connected_ && unacked_.size() < kGroupUnackedMax && link_->HasRoom();
}

void TwinGroup::PublishDue(SteadyTime now) {
  for (std::size_t i = 0; i < twins_.size(); ++i) {
    if (stage_ != TwinStage::kSend && queued_[i].empty()) continue;
    while (due_[i] <= now && MayPublish() && PublishOf(i)) due_[i] += period_;
    if (now - due_[i] <= kBehindMax) continue;
    const auto behind = static_cast<std::uint64_t>((now - due_[i]) / period_);
    due_[i] = now;
    if (stage_ == TwinStage::kSend) shared_.skipped.fetch_add(behind);
  }
}

bool TwinGroup::PublishOf(std::size_t twin) {
  if (queued_[twin].empty()) {
    if (stage_ != TwinStage::kSend) return false;
    queued_[twin].push_back(twins_[twin]->Next(NowUs()));
  }
  const Publication publication = std::move(queued_[twin].front());
  queued_[twin].pop_front();
  TwinAccount& account = twins_[twin]->account();
  if (publication.qos == Qos::k1) account.Published(publication.number);
  const absl::StatusOr<int> id = link_->Publish(publication);
  if (!id.ok()) {
    // At QoS 1 nothing is known of it then: it waits for ever, and the run says so.
    shared_.first_error.Keep(std::string(id.status().message()));
    return false;
  }
  shared_.published.fetch_add(1);
  if (publication.qos == Qos::k1) {
    shared_.published_qos1.fetch_add(1);
    unacked_[*id] = {twin, publication.number};
  }
  return true;
}

void TwinGroup::Ping(SteadyTime now) {
  if (pinged_ && now - *pinged_ > kPongWithin) pinged_.reset();
  if (now < ping_at_ || pinged_ || !MayPublish()) return;
  ping_at_ = now + kPingEvery;
  Publication ping;
  ping.topic = fmt::format("{}cyberwave/ping/{}/request", options_.prefix, ping_name_);
  ping.payload = R"({"type":"ping"})";
  if (!link_->Publish(ping).ok()) return;
  pinged_ = now;
  shared_.pings.fetch_add(1);
  shared_.published.fetch_add(1);
}

bool TwinGroup::AllAcked() const {
  return std::ranges::all_of(twins_,
                             [](const auto& twin) { return twin->account().waiting() == 0; });
}

bool TwinGroup::NothingQueued() const {
  return std::ranges::all_of(queued_, [](const auto& queue) { return queue.empty(); });
}

milliseconds TwinGroup::UntilDue(SteadyTime now) const {
  if (stage_ != TwinStage::kSend && NothingQueued()) return kTurnMax;
  if (!MayPublish()) return milliseconds(1);
  const SteadyTime next = *std::ranges::min_element(due_);
  const auto wait = std::chrono::ceil<milliseconds>(next - now);
  return std::clamp(wait, milliseconds(0), kTurnMax);
}

}  // namespace uplink::synthetic
