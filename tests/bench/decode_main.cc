// What judging one payload costs (copy, decode, every rule, the plain record), beside Cap'n Proto's
// own walk over the same bytes.
#include <chrono>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <capnp/message.h>
#include <capnp/serialize.h>
#include <fmt/core.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "schema/judge.h"
#include "schema/uplink.capnp.h"
#include "tests/bench/bench_flags.h"
#include "tests/support/vector_files.h"

namespace uplink::bench {
namespace {

constexpr double kNanosPerSecond = 1e9;
constexpr int kTurns = 1000;

/// Nanoseconds that one call takes.
double NanosOf(const std::function<void()>& call, std::chrono::duration<double> duration) {
  const SystemClock clock;
  const SteadyTime began = clock.Steady();
  std::chrono::duration<double> took{0};
  std::uint64_t calls = 0;
  while (took < duration) {
    for (int i = 0; i < kTurns; ++i) call();
    calls += kTurns;
    took = clock.Steady() - began;
  }
  return took.count() * kNanosPerSecond / static_cast<double>(calls);
}

/// Copies to aligned words, and follows every pointer.
class BareWalk final {
 public:
  void operator()(const std::string& payload) {
    const std::size_t words = payload.size() / sizeof(capnp::word);
    if (words_.size() < words) words_.resize(words);
    std::memcpy(words_.data(), payload.data(), payload.size());
    capnp::FlatArrayMessageReader reader(
        kj::arrayPtr(reinterpret_cast<const capnp::word*>(words_.data()), words));
    seen_ += reader.getRoot<wire::UplinkMsg>().totalSize().wordCount;
  }
  [[nodiscard]] std::uint64_t seen() const { return seen_; }

 private:
  std::vector<std::uint64_t> words_;
  std::uint64_t seen_ = 0;
};

/// A figure for each vector.
class DecodeBench final {
 public:
  explicit DecodeBench(const BenchFlags& arguments)
      : rounds_(arguments.rounds),
        each_(static_cast<double>(arguments.seconds) / arguments.rounds / 2) {}

  Row Good(const std::string& name) {
    const std::string payload = test::ReadVector(name, ".bin");
    Row row{fmt::format("{} ({} B)", name, payload.size()), "ns", "Cap'n Proto's walk", {}, {}};
    for (int round = 0; round < rounds_; ++round) {
      row.value.Add(NanosOf([&] { Take(payload); }, each_));
      row.comparator_value.Add(NanosOf([&] { walk_(payload); }, each_));
    }
    UPLINK_CHECK(walk_.seen() > 0, "the walk is not left out");
    return row;
  }

  Row CutOff() {
    std::string payload = test::ReadVector("motionTelemetry", ".bin");
    payload.resize(payload.size() - sizeof(capnp::word));
    Row row{"cut off: rejected", "ns", "", {}, {}};
    for (int round = 0; round < rounds_; ++round) {
      row.value.Add(NanosOf([&] { Refuse(payload); }, each_));
    }
    return row;
  }

 private:
  void Take(const std::string& payload) {
    const auto judgement = judge_.Payload(std::as_bytes(std::span(payload)));
    UPLINK_CHECK(judgement.record() != nullptr, "a vector is good");
  }
  void Refuse(const std::string& payload) {
    const auto judgement = judge_.Payload(std::as_bytes(std::span(payload)));
    UPLINK_CHECK(judgement.rejection() != nullptr, "what is cut off is rejected");
  }

  int rounds_;
  std::chrono::duration<double> each_;
  schema::Judge judge_{{}};
  BareWalk walk_;
};

int Run(int argc, char** argv) {
  BenchFlags arguments{.rounds = 5, .seconds = 1};
  config::Flags flags("Benchmark of decoding and judging", "uplink_bench_decode");
  arguments.AddTo(flags);
  flags.Add({"--seconds", "For a figure, all rounds together"}, arguments.seconds, kSecondsRange);
  if (const auto code = flags.Parse(argc, argv)) return *code;
  DecodeBench bench(arguments);
  std::vector<Row> rows;
  for (const std::string& name : test::VectorNames()) rows.push_back(bench.Good(name));
  rows.push_back(bench.CutOff());
  return Publish(
      arguments,
      fmt::format("decode: one payload judged, on one core; {} rounds", arguments.rounds), rows);
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) { return uplink::bench::Run(argc, argv); }
