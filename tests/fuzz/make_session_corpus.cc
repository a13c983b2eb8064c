// The seeds of fuzz_session: one short script a way that a stream can go, of real frames.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <system_error>

#include "tests/fuzz/session_steps.h"
#include "tests/unit/server/session/session_bench.h"

namespace uplink::fuzz {
namespace {

using session::BatchFrame;
using session::SessionOf;

// Contents of Step::kBatch.
constexpr char kGood = 0;
constexpr char kBad = 1;
constexpr char kRefused = 2;
constexpr char kLive = 3;
constexpr char kRcan = 5;
constexpr char kEmpty = 6;

std::string Bytes(std::initializer_list<char> bytes) { return {bytes.begin(), bytes.end()}; }

/// A welcomed stream of session 1.
Script Welcomed() {
  Script script;
  script.Do(Step::kHello, Bytes({1, 0, 0})).Do(Step::kCommit);
  return script;
}

std::string EveryContent() {
  return Bytes({6, 1, kGood, 1, kBad, 1, kRefused, 1, kLive, 1, kRcan, 1, kEmpty});
}

/// A batch whose agent says how far behind it is.
std::string BacklogFrame() {
  v1::RelayRequest frame = BatchFrame({{1, session::Motion()}});
  frame.mutable_batch()->set_sent_unix_ms(2'000);
  frame.mutable_batch()->set_backlog_uplinks(12);
  frame.mutable_batch()->set_oldest_unsent_unix_ms(1'000);
  return frame.SerializeAsString();
}

/// A robot that is parked until the year 2100.
std::string GoodbyeFrame() {
  v1::RelayRequest frame;
  frame.mutable_goodbye()->set_expected_back_unix_ms(4'102'444'800'000);
  return frame.SerializeAsString();
}

/// Whole frames and pieces of them.
void AddFrameSeeds(std::map<std::string, std::string>& seeds) {
  const std::string hello = session::HelloFrame(SessionOf(1)).SerializeAsString();
  const std::string batch =
      BatchFrame({{1, session::Fault()}, {2, session::BadFault()}, {3, session::Motion()}})
          .SerializeAsString();
  seeds["frames"] = Script().Frame(hello).Do(Step::kCommit).Frame(batch).Do(Step::kCommit).bytes();
  seeds["cut_frame"] = Script().Frame(hello).Do(Step::kCommit).Frame(batch.substr(0, 40)).bytes();
  seeds["hello_twice"] = Welcomed().Frame(hello).bytes();
  seeds["batch_first"] = Script().Frame(batch).bytes();
  seeds["backlog"] = Welcomed().Frame(BacklogFrame()).Do(Step::kBreak).bytes();
  seeds["goodbye"] = Welcomed().Frame(GoodbyeFrame()).Do(Step::kHalfClose).bytes();
  seeds["every_content"] =
      Welcomed().Do(Step::kBatch, EveryContent()).Do(Step::kCommit).Do(Step::kHalfClose).bytes();
  seeds["gaps"] = Welcomed()
                      .Do(Step::kBatch, Bytes({3, 5, kLive, 9, kGood, '\xFA', kLive}))
                      .Do(Step::kTime, Bytes({20}))
                      .Do(Step::kCommit)
                      .bytes();
  seeds["too_large"] = Welcomed().Do(Step::kTooLarge).bytes();
}

/// Streams that end and sessions that go on.
void AddResumeSeeds(std::map<std::string, std::string>& seeds) {
  seeds["resume"] = Welcomed()
                        .Do(Step::kBatch, EveryContent())
                        .Do(Step::kBreak)
                        .Do(Step::kStream, Bytes({0}))
                        .Do(Step::kHello, Bytes({1, 1, 4}))
                        .Do(Step::kJournal)
                        .Do(Step::kWakes)
                        .Do(Step::kBatch, EveryContent())
                        .Do(Step::kCommit)
                        .bytes();
  seeds["restart"] = Welcomed()
                         .Do(Step::kBatch, EveryContent())
                         .Do(Step::kJournal)
                         .Do(Step::kRestart)
                         .Do(Step::kHello, Bytes({1, 0, 6}))
                         .Do(Step::kCommit)
                         .Do(Step::kBatch, EveryContent())
                         .Do(Step::kCommit)
                         .bytes();
  seeds["late_cursor"] = Welcomed()
                             .Do(Step::kBatch, EveryContent())
                             .Do(Step::kCommit)
                             .Do(Step::kRestart)
                             .Do(Step::kStoreAway)
                             .Do(Step::kHello, Bytes({1, 0, 6}))
                             .Do(Step::kTime, Bytes({20}))
                             .Do(Step::kStoreBack)
                             .Do(Step::kBatch, EveryContent())
                             .Do(Step::kCommit)
                             .bytes();
  seeds["takeover"] = Welcomed()
                          .Do(Step::kBatch, EveryContent())
                          .Do(Step::kStream, Bytes({0}))
                          .Do(Step::kHello, Bytes({1, 0, 0}))
                          .Do(Step::kStream, Bytes({0}))
                          .Do(Step::kHello, Bytes({2, 0, 0}))
                          .Do(Step::kCommit)
                          .Do(Step::kBatch, EveryContent())
                          .bytes();
  seeds["taken_by_another_process"] = Welcomed()
                                          .Do(Step::kBatch, EveryContent())
                                          .Do(Step::kTaken, Bytes({0}))
                                          .Do(Step::kJournal)
                                          .Do(Step::kJournal)
                                          .Do(Step::kBatch, EveryContent())
                                          .Do(Step::kWakes)
                                          .Do(Step::kStream, Bytes({0}))
                                          .Do(Step::kHello, Bytes({1, 0, 6}))
                                          .Do(Step::kCommit)
                                          .bytes();
}

/// A store, a reader or a server in trouble.
void AddStoreSeeds(std::map<std::string, std::string>& seeds) {
  seeds["held_back"] = Welcomed()
                           .Do(Step::kStoreAway)
                           .Do(Step::kBatch, Bytes({8, 1, kGood, 1, kGood, 1, kGood, 1, kGood, 1,
                                                    kGood, 1, kGood, 1, kGood, 1, kLive}))
                           .Do(Step::kTime, Bytes({40}))
                           .Do(Step::kStoreBack)
                           .Do(Step::kCommit)
                           .bytes();
  seeds["slow_reader"] = Script()
                             .Do(Step::kStopReading)
                             .Do(Step::kHello, Bytes({1, 0, 0}))
                             .Do(Step::kCommit)
                             .Do(Step::kBatch, EveryContent())
                             .Do(Step::kReadOne)
                             .Do(Step::kCommit)
                             .Do(Step::kReadAgain)
                             .bytes();
  seeds["drain"] = Welcomed()
                       .Do(Step::kBatch, EveryContent())
                       .Do(Step::kDrain, Bytes({10}))
                       .Do(Step::kTooLarge)
                       .Do(Step::kCommit)
                       .bytes();
  seeds["drain_timeout"] = Welcomed()
                               .Do(Step::kStoreAway)
                               .Do(Step::kBatch, EveryContent())
                               .Do(Step::kDrain, Bytes({10}))
                               .Do(Step::kTime, Bytes({20}))
                               .bytes();
  seeds["lost_answer"] = Welcomed()
                             .Do(Step::kBatch, EveryContent())
                             .Do(Step::kStoreFails, Bytes({1}))
                             .Do(Step::kJournal)
                             .Do(Step::kCommit)
                             .bytes();
}

std::map<std::string, std::string> Seeds() {
  std::map<std::string, std::string> seeds;
  AddFrameSeeds(seeds);
  AddResumeSeeds(seeds);
  AddStoreSeeds(seeds);
  return seeds;
}

int WriteTo(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const auto& [name, bytes] : Seeds()) {
    std::ofstream file(folder / name, std::ios::binary);
    file << bytes;
    if (!file.flush()) {
      std::fprintf(stderr, "cannot write %s\n", name.c_str());
      return 1;
    }
  }
  return 0;
}

}  // namespace
}  // namespace uplink::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  return uplink::fuzz::WriteTo(argv[1]);
}
