// The stores under a writer's load beside bare loops on the same libraries, in one run.
#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <latch>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <fmt/core.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "storage/postgres/store.h"
#include "storage/sqlite/store.h"
#include "tests/bench/bare_postgres.h"
#include "tests/bench/bare_sqlite.h"
#include "tests/bench/bench_flags.h"
#include "tests/bench/relay_bench.h"
#include "tests/bench/store_load.h"

namespace uplink::bench {
namespace {

struct Arguments : BenchFlags {
  Arguments() : BenchFlags{.rounds = 5, .seconds = 2} {}

  std::string url;
  std::string folder;
  std::size_t writers = 2;
};

/// Commits one batch and returns its rows.
using Committer = std::function<std::size_t()>;

/// Runs every committer on a thread of its own; returns rows per second.
double Measure(std::vector<Committer> committers, int seconds) {
  const SystemClock clock;
  std::atomic<std::size_t> rows{0};
  std::latch ready(static_cast<std::ptrdiff_t>(committers.size()) + 1);
  std::atomic<bool> stop{false};
  std::vector<std::jthread> threads;
  threads.reserve(committers.size());
  for (Committer& commit : committers) {
    threads.emplace_back([&] {
      commit();  // plans, caches, the first page of the log
      ready.arrive_and_wait();
      std::size_t mine = 0;
      while (!stop.load()) mine += commit();
      rows.fetch_add(mine);
    });
  }
  ready.arrive_and_wait();
  const SteadyTime began = clock.Steady();
  std::mutex mutex;
  std::condition_variable never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, std::chrono::seconds(seconds), [] { return false; });
  stop.store(true);
  threads.clear();
  const std::chrono::duration<double> took = clock.Steady() - began;
  return static_cast<double>(rows.load()) / took.count();
}

/// A store and what it is given.
struct Writer {
  std::unique_ptr<storage::Store> store;
  BatchSource source;

  std::size_t CommitOne() {
    const storage::Batch& batch = source.Next();
    const auto outcomes = store->Commit(batch);
    UPLINK_CHECK(outcomes.ok(), outcomes.status().ToString());
    for (const storage::Outcome& outcome : *outcomes) {
      UPLINK_CHECK(outcome.kind == storage::OutcomeKind::kStored, "every record is new");
    }
    return outcomes->size();
  }
};

Writer WriterOf(std::unique_ptr<storage::Store> store, const LoadShape& shape, std::size_t number,
                SystemTime at) {
  Writer writer{std::move(store), BatchSource(shape, number, at)};
  const auto opened = writer.store->OpenStreams(writer.source.opens());
  UPLINK_CHECK(opened.ok(), opened.status().ToString());
  writer.source.SetHolds(*opened);
  return writer;
}

class StoreBench final {
 public:
  explicit StoreBench(const Arguments& arguments) : arguments_(arguments) {}

  Row Postgres(const std::string& name, const LoadShape& shape) {
    Row row{name, "rows/s", "bare libpq loop", {}, {}};
    std::vector<Writer> writers;
    std::vector<BarePostgres> bare;
    for (std::size_t i = 0; i < arguments_.writers; ++i) {
      storage::postgres::StoreOptions options;
      options.url = arguments_.url;
      options.process = {9};
      auto store = storage::postgres::PostgresStore::Open(options, clock_);
      UPLINK_CHECK(store.ok() && (*store)->open_error().ok(), "the store opens");
      if (i == 0) UPLINK_CHECK((*store)->Retain(clock_.System()).ok(), "partitions are made");
      writers.push_back(WriterOf(*std::move(store), shape, i, clock_.System()));
      bare.emplace_back(arguments_.url, shape, i);
    }
    for (int round = 0; round < arguments_.rounds; ++round) {
      std::vector<Committer> ours;
      std::vector<Committer> theirs;
      ours.reserve(writers.size());
      theirs.reserve(bare.size());
      for (Writer& writer : writers) ours.emplace_back([&writer] { return writer.CommitOne(); });
      for (BarePostgres& loop : bare) theirs.emplace_back([&loop] { return loop.CommitOne(); });
      row.value.Add(Measure(std::move(ours), arguments_.seconds));
      row.comparator_value.Add(Measure(std::move(theirs), arguments_.seconds));
    }
    return row;
  }

  Row Sqlite(const std::string& name, const LoadShape& shape) {
    Row row{name, "rows/s", "bare SQLite loop", {}, {}};
    storage::sqlite::StoreOptions options;
    options.process = {9};
    auto store = storage::sqlite::SqliteStore::Open(arguments_.folder + "/store.db", options);
    UPLINK_CHECK(store.ok(), store.status().ToString());
    Writer writer = WriterOf(*std::move(store), shape, 0, clock_.System());
    BareSqlite bare(arguments_.folder + "/bare.db", shape);
    for (int round = 0; round < arguments_.rounds; ++round) {
      row.value.Add(Measure({[&writer] { return writer.CommitOne(); }}, arguments_.seconds));
      row.comparator_value.Add(Measure({[&bare] { return bare.CommitOne(); }}, arguments_.seconds));
    }
    return row;
  }

 private:
  const Arguments& arguments_;
  const SystemClock clock_{};
};

/// From robots to COMMIT to Ack, beside the bare loops.
void AddRelayRows(const Arguments& arguments, std::vector<Row>& rows) {
  const Times times{arguments.rounds, arguments.seconds};
  const LoadShape frames;
  std::vector<BarePostgres> bare;
  for (std::size_t i = 0; i < arguments.writers; ++i) bare.emplace_back(arguments.url, frames, i);
  const auto bare_postgres = [&](int seconds) {
    std::vector<Committer> loops;
    loops.reserve(bare.size());
    for (BarePostgres& loop : bare) loops.emplace_back([&loop] { return loop.CommitOne(); });
    return Measure(std::move(loops), seconds);
  };
  LoadShape single;
  single.batch_records = 1;
  single.per_robot = 1;
  {
    RelayBench relay({"UPLINKD_STORE_URL=" + arguments.url});
    BarePostgres one_by_one(arguments.url, single, arguments.writers);
    for (Row& row : relay.MeasureAckRows(
             "relay_postgres_one_fault", "bare libpq commit", [&] { one_by_one.CommitOne(); },
             times)) {
      rows.push_back(std::move(row));
    }
    for (const std::size_t frame : {std::size_t{64}, std::size_t{1}}) {
      auto measured = relay.MeasureDurable("relay_postgres_" + std::to_string(frame) + "_a_frame",
                                           frame, "bare libpq loop", bare_postgres, times);
      rows.push_back(std::move(measured.rate));
      rows.push_back(std::move(measured.cpu));
    }
  }
  RelayBench relay({});
  BareSqlite bare_sqlite(arguments.folder + "/bare_relay.db", frames);
  auto measured = relay.MeasureDurable(
      "relay_sqlite_64_a_frame", 64, "bare SQLite loop",
      [&](int seconds) {
        return Measure({[&bare_sqlite] { return bare_sqlite.CommitOne(); }}, seconds);
      },
      times);
  rows.push_back(std::move(measured.rate));
  rows.push_back(std::move(measured.cpu));
}

int Run(int argc, char** argv) {
  Arguments arguments;
  constexpr auto kRequired = config::Flag::Need::kRequired;
  config::Flags flags("Benchmarks of the stores", "uplink_bench_store");
  flags.Add({"--url", "A migrated PostgreSQL database", kRequired}, arguments.url);
  flags.Add({"--folder", "An empty folder for SQLite files", kRequired}, arguments.folder);
  arguments.AddTo(flags);
  flags.Add({"--seconds"}, arguments.seconds, kSecondsRange);
  flags.Add({"--writers"}, arguments.writers, {1, 16});
  if (const auto code = flags.Parse(argc, argv)) return *code;
  StoreBench bench(arguments);
  const LoadShape frames;
  LoadShape singles;
  singles.per_robot = 1;
  std::vector<Row> rows = {bench.Postgres("postgres_64_a_robot", frames),
                           bench.Postgres("postgres_1_a_robot", singles),
                           bench.Sqlite("sqlite_64_a_robot", frames)};
  AddRelayRows(arguments, rows);
  return Publish(
      arguments,
      fmt::format(
          "store: calls of the store alone. relay: robots, TLS, the server, COMMIT, Ack, on the "
          "same {} cores; no rate is limited",
          std::thread::hardware_concurrency()),
      rows);
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) { return uplink::bench::Run(argc, argv); }
