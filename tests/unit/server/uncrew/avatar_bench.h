#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/check.h"
#include "server/fleet/fleet.h"
#include "server/ingest/allowances.h"
#include "server/journal/journal.h"
#include "server/journal/turns.h"
#include "server/journal/writer_context.h"
#include "server/uncrew/avatar_methods.h"
#include "tests/support/fake_store.h"
#include "tests/support/manual_clock.h"
#include "tests/unit/schema/uncrew/requests.h"
#include "uncrew/v1/avatar.pb.h"

namespace uplink::uncrew {

using model::uncrew::SampleType;

/// A call as its handler sees it, without a wire.
class FakeCall final : public transport::ServedCall {
 public:
  FakeCall(identity::PeerIdentity peer, loop::StreamRef self)
      : peer_(std::move(peer)), self_(self) {}

  void RequestMessage() override {}
  void Write(std::string message_with_prefix) override {
    UPLINK_CHECK(response_.ParseFromString(message_with_prefix.substr(transport::kPrefixBytes)),
                 "an answer is a PublishResponse");
  }
  void Write(std::vector<transport::SharedMessage> /*messages*/) override {}
  void Finish(const absl::Status& status) override {
    UPLINK_CHECK(!status_, "a call ends once");
    status_ = status;
  }
  void FinishRefused(const absl::Status& status) override { Finish(status); }
  void Cancel() override {}
  void AskPeer() override {}
  [[nodiscard]] const identity::PeerIdentity& peer() const override { return peer_; }
  [[nodiscard]] std::optional<SteadyTime> give_up_at() const override { return std::nullopt; }
  [[nodiscard]] loop::StreamRef self() const override { return self_; }

  /// `waits`, the name of the outcome, or the code of the status.
  [[nodiscard]] std::string End() const {
    if (!status_) return "waits";
    if (!status_->ok()) return std::string(absl::StatusCodeToString(status_->code()));
    return ::uncrew::v1::Outcome_Name(response_.outcome()).substr(sizeof("OUTCOME_") - 1);
  }
  [[nodiscard]] const ::uncrew::v1::PublishResponse& response() const { return response_; }
  [[nodiscard]] const absl::Status& status() const { return *status_; }

 private:
  const identity::PeerIdentity peer_;
  const loop::StreamRef self_;
  ::uncrew::v1::PublishResponse response_;
  std::optional<absl::Status> status_;
};

/// A process with drones' calls, on a store in memory that several may share.
class AvatarBench final : public loop::WakeInbox {
 public:
  AvatarBench(testing::ManualClock& clock, testing::FakeDatabase& database, std::uint8_t process)
      : clock_(clock),
        store_(database, storage::ProcessId{process}),
        fleet_(clock, 10, robot::PresenceLimits{}),
        journal_(store_, {}, clock, book_.NewPage(), journal_probe_, storage::ProcessId{process}),
        drones_({.clock = clock,
                 .fleet = fleet_,
                 .journals = shards_,
                 .ledger = book_.NewPage(model::MessageSource::kUncrew)}),
        methods_(AvatarMethods({.watch = clock,
                                .drones = drones_,
                                .fleet = fleet_,
                                .probe = probe_,
                                .ledgers = book_,
                                .allowances = allowances_,
                                .answer_within = std::chrono::seconds(5),
                                .ruri_template = config::UncrewConfig().ruri_template,
                                .in_flight_max = 1000,
                                .payload_bytes_max = 65'536})(clock)) {}
  ~AvatarBench() override { handlers_.clear(); }
  AvatarBench(const AvatarBench&) = delete;
  AvatarBench& operator=(const AvatarBench&) = delete;

  void Wake(std::uint64_t call) override { woken_.insert(call); }

  /// A call with this certificate, and these bytes.
  FakeCall& CallBytes(const identity::PeerIdentity& peer, SampleType type,
                      std::string_view request) {
    const std::uint64_t id = ++last_;
    calls_.push_back(std::make_unique<FakeCall>(peer, loop::StreamRef{this, id}));
    FakeCall& call = *calls_.back();
    const std::string path =
        "/uncrew.v1.AvatarService/" + std::string(model::uncrew::RowOf(type).method);
    auto handler = methods_.at(path).serve(call);
    UPLINK_CHECK(handler.ok(), "a call is served");
    handlers_[id] = *std::move(handler);
    handlers_[id]->Start();
    handlers_[id]->OnMessage(request);
    return call;
  }
  FakeCall& Call(SampleType type, std::string_view text) {
    return CallBytes(Drone("1"), type, test::RequestOf(type, text));
  }
  /// The certificate of the drone with this id.
  [[nodiscard]] static identity::PeerIdentity Drone(const std::string& id) {
    return {
        .role = identity::Role::kRobot, .fleet = "f", .ruri = "rcan://local.rcan/uncrew/uav/" + id};
  }
  /// All that the store and the calls can do now.
  void Commit() {
    do {
      Deliver();
    } while (journal_.turns().Advance() == journal::Step::kWorked || !woken_.empty());
  }
  /// One call of the store.
  void Advance() { static_cast<void>(journal_.turns().Advance()); }
  void Deliver() {
    for (const std::uint64_t id : std::exchange(woken_, {})) handlers_.at(id)->OnWake();
  }
  void Pass(milliseconds time) {
    clock_.Advance(time);
    for (const auto& [id, handler] : handlers_) {
      const auto due = handler->deadline();
      if (due && *due <= clock_.Steady()) handler->OnTimer();
    }
  }

  /// The server is to end within `grace`.
  void Drain(milliseconds grace) {
    for (const auto& [id, handler] : handlers_) handler->OnDrain(grace);
  }
  /// A call whose message has too many bytes.
  FakeCall& CallTooLarge(std::uint64_t bytes) {
    FakeCall& call = CallWithoutRequest();
    handlers_[last_]->OnTooLarge(bytes);
    return call;
  }
  /// A call whose message does not come.
  FakeCall& CallWithoutRequest() {
    const std::uint64_t id = ++last_;
    calls_.push_back(std::make_unique<FakeCall>(Drone("1"), loop::StreamRef{this, id}));
    auto handler = methods_.at("/uncrew.v1.AvatarService/PublishHeading").serve(*calls_.back());
    UPLINK_CHECK(handler.ok(), "a call is served");
    handlers_[id] = *std::move(handler);
    handlers_[id]->Start();
    return *calls_.back();
  }

  [[nodiscard]] testing::FakeStore& store() { return store_; }
  [[nodiscard]] Drones& drones() { return drones_; }
  [[nodiscard]] fleet::Fleet& fleet() { return fleet_; }
  [[nodiscard]] transport::Methods& methods() { return methods_; }
  [[nodiscard]] metrics::MessageCounts counts() const {
    return book_.Sum(model::MessageSource::kUncrew).messages;
  }

 private:
  testing::ManualClock& clock_;
  testing::FakeStore store_;
  metrics::LedgerBook book_;
  journal::JournalProbe journal_probe_;
  const ingest::Allowances allowances_;
  fleet::Fleet fleet_;
  journal::Journal journal_;
  journal::Shards shards_{{&journal_}};
  AvatarProbe probe_;
  Drones drones_;
  transport::Methods methods_;
  std::vector<std::unique_ptr<FakeCall>> calls_;
  std::map<std::uint64_t, std::unique_ptr<transport::CallHandler>> handlers_;
  std::uint64_t last_ = 0;
  std::set<std::uint64_t> woken_;
};

}  // namespace uplink::uncrew
