#include <map>
#include <utility>

#include <absl/strings/str_split.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "storage/postgres/clock_marks.h"
#include "storage/postgres/forget_store.h"
#include "storage/postgres/leases.h"
#include "storage/postgres/reader.h"
#include "storage/postgres/shared_items.h"
#include "storage/postgres/store.h"
#include "storage/postgres/topic_leases.h"
#include "tests/contract/store_under_test.h"
#include "tests/support/postgres_database.h"

namespace uplink::testing {
namespace {

class PostgresUnderTest final : public StoreUnderTest {
 public:
  explicit PostgresUnderTest(const storage::StoreRules& rules) : rules_(rules) {}

  storage::Store& Process(std::uint8_t number) override {
    One& one = processes_[number];
    if (one.store == nullptr) Open(number, one);
    return *one.store;
  }

  storage::Reader& reader() override {
    if (reader_ == nullptr) {
      storage::postgres::ReaderOptions options;
      options.url = database_.url();
      auto opened = storage::postgres::PostgresReader::Open(options, clock_);
      UPLINK_CHECK(opened.ok(), opened.status().ToString());
      reader_ = *std::move(opened);
    }
    return *reader_;
  }

  storage::Leases* LeasesOf(std::uint8_t number) override {
    static_cast<void>(Process(number));  // makes the schema
    auto& leases = leases_[number];
    if (leases == nullptr) {
      storage::postgres::StoreOptions options;
      options.url = database_.url();
      options.process = {number};
      auto made = storage::postgres::PostgresLeases::Make(options, clock_);
      UPLINK_CHECK(made.ok(), made.status().ToString());
      leases = *std::move(made);
    }
    return leases.get();
  }

  storage::TopicLeases& TopicLeasesOf(std::uint8_t number) override {
    static_cast<void>(Process(number));  // makes the schema
    auto& leases = topic_leases_[number];
    if (leases == nullptr) {
      storage::postgres::StoreOptions options;
      options.url = database_.url();
      options.process = {number};
      auto made = storage::postgres::PostgresTopicLeases::Make(options, clock_);
      UPLINK_CHECK(made.ok(), made.status().ToString());
      leases = *std::move(made);
    }
    return *leases;
  }

  storage::ClockMarks* clock_marks() override {
    static_cast<void>(Process(1));  // makes the schema
    if (marks_ == nullptr) {
      storage::postgres::StoreOptions options;
      options.url = database_.url();
      auto made = storage::postgres::PostgresClockMarks::Make(options, clock_);
      UPLINK_CHECK(made.ok(), made.status().ToString());
      marks_ = *std::move(made);
    }
    return marks_.get();
  }

  storage::RobotRemoval* removal() override { return &Forget().removal(); }
  storage::ForgetRequests& forget_requests() override { return Forget().requests(); }
  storage::SharedItems& shared_items() override {
    static_cast<void>(Process(1));  // makes the schema
    if (shared_items_ == nullptr) {
      storage::postgres::StoreOptions options;
      options.url = database_.url();
      auto made = storage::postgres::PostgresSharedItems::Make(options, clock_);
      UPLINK_CHECK(made.ok(), made.status().ToString());
      shared_items_ = *std::move(made);
    }
    return *shared_items_;
  }
  void AddChanges(std::size_t count) override {
    // Always as the same writer, as one session would.
    const std::string writer = "'0a000000-0000-0000-0000-000000000000'::uuid";
    PostgresShell shell = database_.Shell();
    shell.Run("INSERT INTO uplinkd.change_writers VALUES (" + writer + ") ON CONFLICT DO NOTHING");
    shell.Run("INSERT INTO uplinkd.changes SELECT " + writer +
              ", n + coalesce((SELECT max(number) FROM uplinkd.changes WHERE writer = " + writer +
              "), 0), now(), 2, 'rcan://robots/x', 'i' FROM generate_series(1, " +
              std::to_string(count) + ") AS n");
  }
  void RemoveRobot(const std::string& ruri) override { RemoveFrom(*removal(), ruri); }
  void AgeForgetRequests(std::chrono::seconds time) override {
    database_.Shell().Run(
        "UPDATE uplinkd.forget_requests SET touched_at = touched_at - make_interval(secs => " +
        std::to_string(time.count()) + ")");
  }
  std::vector<std::string> TablesOfRobots() override {
    static_cast<void>(Process(1));  // makes the schema
    return absl::StrSplit(
        database_.Shell().Read(
            "SELECT c.relname FROM pg_attribute AS a JOIN pg_class AS c ON c.oid = a.attrelid"
            " WHERE c.relnamespace = 'uplinkd'::regnamespace AND c.relkind IN ('r', 'p')"
            " AND NOT c.relispartition AND a.attname = 'ruri' AND NOT a.attisdropped ORDER BY 1"),
        '\n', absl::SkipEmpty());
  }
  void NoteQuarantineDropped(const std::string& ruri) override {
    database_.Shell().Run("INSERT INTO uplinkd.quarantine_dropped (ruri, reason, count) VALUES ('" +
                          ruri + "', 1, 1)");
  }

  void FailNextWrite(std::uint8_t number) override { processes_[number].fail_before = true; }
  void LoseNextAnswer(std::uint8_t number) override { processes_[number].fail_after = true; }

  void Reopen() override {
    reader_ = nullptr;
    marks_ = nullptr;
    forget_ = nullptr;
    shared_items_ = nullptr;
    leases_.clear();
    topic_leases_.clear();
    processes_.clear();
  }

  void DeleteRobotRow(const std::string& ruri) override {
    database_.Shell().Run("DELETE FROM uplinkd.robots WHERE ruri = '" + ruri + "'");
  }

  void RefuseFault(const std::string& fault_id) override {
    PostgresShell shell = database_.Shell();
    // The report is in the history by then, so that it shows whether that is taken back.
    shell.Run(
        "CREATE FUNCTION uplinkd.refuse() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
        " RAISE EXCEPTION 'the test says so'; END $$");
    shell.Run(
        "CREATE TRIGGER refuse BEFORE INSERT ON uplinkd.faults_active FOR EACH ROW WHEN"
        " (NEW.fault_id = '" +
        fault_id + "') EXECUTE FUNCTION uplinkd.refuse()");
  }

 private:
  storage::ForgetStore& Forget() {
    static_cast<void>(Process(1));  // makes the schema
    if (forget_ == nullptr) {
      storage::postgres::StoreOptions options;
      options.url = database_.url();
      auto made = storage::postgres::PostgresForgetStore::Make(options, clock_);
      UPLINK_CHECK(made.ok(), made.status().ToString());
      forget_ = *std::move(made);
    }
    return *forget_;
  }

  struct One {
    bool fail_before = false;
    bool fail_after = false;
    std::unique_ptr<storage::postgres::PostgresStore> store;
  };

  static absl::Status Take(bool& order) {
    return std::exchange(order, false) ? absl::UnavailableError("the test said so")
                                       : absl::OkStatus();
  }

  void Open(std::uint8_t number, One& one) {
    storage::postgres::StoreOptions options;
    options.url = database_.url();
    options.process = {number};
    options.rules = rules_;
    options.before_commit = [&one] { return Take(one.fail_before); };
    options.after_commit = [&one] { return Take(one.fail_after); };
    auto opened = storage::postgres::PostgresStore::Open(std::move(options), clock_);
    UPLINK_CHECK(opened.ok(), opened.status().ToString());
    UPLINK_CHECK((*opened)->open_error().ok(), (*opened)->open_error().ToString());
    one.store = *std::move(opened);
  }

  const SystemClock clock_{};
  const storage::StoreRules rules_;
  PostgresDatabase database_;
  std::map<std::uint8_t, One> processes_;
  std::map<std::uint8_t, std::unique_ptr<storage::postgres::PostgresLeases>> leases_;
  std::map<std::uint8_t, std::unique_ptr<storage::postgres::PostgresTopicLeases>> topic_leases_;
  std::unique_ptr<storage::postgres::PostgresReader> reader_;
  std::unique_ptr<storage::postgres::PostgresClockMarks> marks_;
  std::unique_ptr<storage::postgres::PostgresForgetStore> forget_;
  std::unique_ptr<storage::postgres::PostgresSharedItems> shared_items_;
};

}  // namespace

StoreKind PostgresKind() {
  return {"Postgres", [](const storage::StoreRules& rules) {
            return std::make_unique<PostgresUnderTest>(rules);
          }};
}

}  // namespace uplink::testing
