#include <map>
#include <optional>
#include <variant>

#include "storage/refusal.h"
#include "tests/contract/store_under_test.h"
#include "tests/support/fake_access_store.h"
#include "tests/support/fake_forget_store.h"
#include "tests/support/fake_leases.h"
#include "tests/support/fake_shared_items.h"
#include "tests/support/fake_store.h"

namespace uplink::testing {
namespace {

class FakeUnderTest final : public StoreUnderTest {
 public:
  explicit FakeUnderTest(const storage::StoreRules& rules) : store_rules_(rules) {
    requests_.hold_of = [this](const std::string& ruri) { return HoldOf(ruri); };
  }

  storage::Store& Process(std::uint8_t number) override { return Fake(number); }
  storage::Reader& reader() override { return Fake(0); }
  storage::Leases* LeasesOf(std::uint8_t number) override {
    auto& leases = leases_[number];
    if (leases == nullptr) {
      leases = std::make_unique<FakeLeases>(database_, storage::ProcessId{number});
    }
    return leases.get();
  }
  storage::TopicLeases& TopicLeasesOf(std::uint8_t number) override {
    auto& leases = topic_leases_[number];
    if (leases == nullptr) {
      leases = std::make_unique<FakeTopicLeases>(database_, storage::ProcessId{number});
    }
    return *leases;
  }
  storage::ClockMarks* clock_marks() override { return nullptr; }
  storage::RobotRemoval* removal() override { return nullptr; }
  storage::ForgetRequests& forget_requests() override { return requests_; }
  storage::AccessStore& access() override { return access_; }
  storage::SharedItems& shared_items() override { return shared_items_; }
  void AddChanges(std::size_t count) override {
    for (std::size_t i = 0; i < count; ++i) {
      database_.NoteChange({storage::PresentKind::kObject, "rcan://robots/x", "i"});
    }
  }
  void RemoveRobot(const std::string& ruri) override { database_.RemoveRobot(ruri); }
  void AgeForgetRequests(std::chrono::seconds time) override { requests_.Age(time); }
  std::vector<std::string> TablesOfRobots() override { return {}; }
  void NoteQuarantineDropped(const std::string& /*ruri*/) override {}
  void FailNextWrite(std::uint8_t number) override { Fake(number).FailNext(1, FailAt::kBefore); }
  void LoseNextAnswer(std::uint8_t number) override { Fake(number).FailNext(1, FailAt::kAfter); }

  void Reopen() override { stores_.clear(); }
  void DeleteRobotRow(const std::string& ruri) override { database_.DeleteRobotRow(ruri); }

  void RefuseFault(const std::string& fault_id) override {
    rules_.refuse =
        [fault_id](const storage::CommitRecord& record) -> std::optional<model::Rejection> {
      const auto* good = std::get_if<model::Record>(&record.content);
      const auto* fault = good == nullptr ? nullptr : std::get_if<model::Fault>(&good->body());
      if (fault == nullptr || fault->fault_id != fault_id) return std::nullopt;
      return storage::StoreRefused("the test says so");
    };
    for (auto& [number, store] : stores_) store->SetRules(rules_);
  }

 private:
  FakeStore& Fake(std::uint8_t number) {
    auto& store = stores_[number];
    if (store == nullptr) {
      store = std::make_unique<FakeStore>(database_, storage::ProcessId{number}, store_rules_);
      store->SetRules(rules_);
    }
    return *store;
  }

  std::optional<storage::RobotHold> HoldOf(const std::string& ruri) const {
    for (const storage::ForeignRobot& robot : database_.RobotsOfOthers(storage::ProcessId{}, "")) {
      if (robot.robot.ruri == ruri)
        return storage::RobotHold{robot.holder, database_.EpochOf(ruri)};
    }
    return std::nullopt;
  }

  const storage::StoreRules store_rules_;
  FakeDatabase database_;
  FakeAccessStore access_{database_};
  FakeSharedItems shared_items_{database_};
  FakeForgetRequests requests_;
  FakeRules rules_;
  std::map<std::uint8_t, std::unique_ptr<FakeStore>> stores_;
  std::map<std::uint8_t, std::unique_ptr<FakeLeases>> leases_;
  std::map<std::uint8_t, std::unique_ptr<FakeTopicLeases>> topic_leases_;
};

}  // namespace

StoreKind FakeKind() {
  return {"Fake",
          [](const storage::StoreRules& rules) { return std::make_unique<FakeUnderTest>(rules); }};
}

}  // namespace uplink::testing
