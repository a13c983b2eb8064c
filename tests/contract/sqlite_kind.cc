#include <map>
#include <utility>

#include <absl/strings/str_split.h>

#include "schema/base/check.h"
#include "storage/sqlite/parts.h"
#include "storage/sqlite/reader.h"
#include "storage/sqlite/store.h"
#include "tests/contract/store_under_test.h"
#include "tests/support/sqlite_shell.h"
#include "tests/support/temp_folder.h"

namespace uplink::testing {
namespace {

template <typename Part>
void Keep(absl::StatusOr<std::unique_ptr<Part>> opened, std::unique_ptr<Part>& part) {
  UPLINK_CHECK(opened.ok(), opened.status().ToString());
  part = *std::move(opened);
}

class SqliteUnderTest final : public StoreUnderTest {
 public:
  explicit SqliteUnderTest(const storage::StoreRules& rules) : rules_(rules) {}

  storage::Store& Process(std::uint8_t number) override {
    One& one = processes_[number];
    if (one.store == nullptr) Open(number, one);
    return *one.store;
  }

  storage::Reader& reader() override {
    if (reader_ == nullptr) {
      static_cast<void>(Process(1));  // makes the file
      Keep(storage::sqlite::SqliteReader::Open(path_), reader_);
    }
    return *reader_;
  }

  storage::ClockMarks* clock_marks() override {
    if (marks_ == nullptr) {
      static_cast<void>(Process(1));  // makes the file
      Keep(storage::sqlite::OpenClockMarks(path_), marks_);
    }
    return marks_.get();
  }

  storage::RobotRemoval* removal() override { return &Forget().removal(); }
  storage::ForgetRequests& forget_requests() override { return Forget().requests(); }
  storage::AccessStore& access() override {
    if (access_ == nullptr) {
      static_cast<void>(Process(1));  // makes the file
      Keep(storage::sqlite::OpenAccessStore(path_), access_);
    }
    return *access_;
  }
  storage::SharedItems& shared_items() override {
    if (shared_items_ == nullptr) {
      static_cast<void>(Process(1));  // makes the file
      Keep(storage::sqlite::OpenSharedItems(path_), shared_items_);
    }
    return *shared_items_;
  }
  void AddChanges(std::size_t count) override {
    SqliteShell(path_).Run(
        "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < " +
        std::to_string(count) +
        ") INSERT INTO changes (kind, origin, id) SELECT 2, 'rcan://robots/x', 'i' FROM n");
  }
  void RemoveRobot(const std::string& ruri) override { RemoveFrom(*removal(), ruri); }
  void AgeForgetRequests(std::chrono::seconds time) override {
    SqliteShell(path_).Run("UPDATE forget_requests SET touched_s = touched_s - " +
                           std::to_string(time.count()));
  }
  std::vector<std::string> TablesOfRobots() override {
    static_cast<void>(Process(1));  // makes the schema
    return absl::StrSplit(
        SqliteShell(path_).Read(
            "SELECT t.name FROM sqlite_master AS t JOIN pragma_table_info(t.name) AS c"
            " WHERE t.type = 'table' AND c.name = 'ruri' ORDER BY 1"),
        '\n', absl::SkipEmpty());
  }
  void NoteQuarantineDropped(const std::string& ruri) override {
    SqliteShell(path_).Run("INSERT INTO quarantine_dropped (ruri, reason, count) VALUES ('" + ruri +
                           "', 1, 1)");
  }

  storage::Leases* LeasesOf(std::uint8_t /*number*/) override { return nullptr; }
  storage::TopicLeases& TopicLeasesOf(std::uint8_t number) override {
    static_cast<void>(Process(1));  // makes the file
    auto& leases = topic_leases_[number];
    if (leases == nullptr) {
      Keep(storage::sqlite::OpenTopicLeases(path_, storage::ProcessId{number}), leases);
    }
    return *leases;
  }

  void FailNextWrite(std::uint8_t number) override { processes_[number].fail_before = true; }
  void LoseNextAnswer(std::uint8_t number) override { processes_[number].fail_after = true; }

  void Reopen() override {
    reader_ = nullptr;
    marks_ = nullptr;
    forget_ = nullptr;
    access_ = nullptr;
    shared_items_ = nullptr;
    topic_leases_.clear();
    processes_.clear();
  }

  void DeleteRobotRow(const std::string& ruri) override {
    SqliteShell(path_).Run("DELETE FROM robots WHERE ruri = '" + ruri + "'");
  }

  void RefuseFault(const std::string& fault_id) override {
    static_cast<void>(Process(1));
    // The report is in the history by then, so that it shows whether that is taken back.
    SqliteShell(path_).Run(
        "CREATE TRIGGER refuse BEFORE INSERT ON faults_active WHEN NEW.fault_id"
        " = '" +
        fault_id +
        "' BEGIN SELECT RAISE(ABORT, 'the test says so');"
        " END");
  }

 private:
  storage::ForgetStore& Forget() {
    if (forget_ == nullptr) {
      static_cast<void>(Process(1));  // makes the file
      Keep(storage::sqlite::OpenForgetStore(path_), forget_);
    }
    return *forget_;
  }

  struct One {
    bool fail_before = false;
    bool fail_after = false;
    std::unique_ptr<storage::sqlite::SqliteStore> store;
  };

  static absl::Status Take(bool& order) {
    return std::exchange(order, false) ? absl::UnavailableError("the test said so")
                                       : absl::OkStatus();
  }

  void Open(std::uint8_t number, One& one) {
    storage::sqlite::StoreOptions options;
    options.process = {number};
    options.rules = rules_;
    options.exclusive = false;
    options.before_commit = [&one] { return Take(one.fail_before); };
    options.after_commit = [&one] { return Take(one.fail_after); };
    auto opened = storage::sqlite::SqliteStore::Open(path_, options);
    UPLINK_CHECK(opened.ok(), opened.status().ToString());
    one.store = *std::move(opened);
  }

  const storage::StoreRules rules_;
  TempFolder folder_;
  const std::string path_ = folder_.File("uplinkd.db");
  std::map<std::uint8_t, One> processes_;
  std::map<std::uint8_t, std::unique_ptr<storage::TopicLeases>> topic_leases_;
  std::unique_ptr<storage::sqlite::SqliteReader> reader_;
  std::unique_ptr<storage::ClockMarks> marks_;
  std::unique_ptr<storage::ForgetStore> forget_;
  std::unique_ptr<storage::AccessStore> access_;
  std::unique_ptr<storage::SharedItems> shared_items_;
};

}  // namespace

StoreKind SqliteKind() {
  return {"Sqlite", [](const storage::StoreRules& rules) {
            return std::make_unique<SqliteUnderTest>(rules);
          }};
}

}  // namespace uplink::testing
