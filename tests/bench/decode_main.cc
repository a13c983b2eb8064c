// What judging one payload costs (copy, decode, every rule, the plain record), beside Cap'n Proto's
// own walk over the same bytes.
#include <chrono>
#include <cstring>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <capnp/message.h>
#include <capnp/serialize.h>
#include <fmt/core.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "schema/judge.h"
#include "schema/uplink.capnp.h"
#include "tests/bench/figures.h"
#include "tests/support/vector_files.h"

namespace uplink::bench {
namespace {

struct Arguments {
  std::string json;
  std::string commit = "unknown";
  int rounds = 5;
  int seconds = 1;
};

constexpr double kNanosASecond = 1e9;
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
  return took.count() * kNanosASecond / static_cast<double>(calls);
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

int Run(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Benchmark of decoding and judging", "uplink_bench_decode");
  app.add_option("--json", arguments.json, "Where the figures go as JSON");
  app.add_option("--commit", arguments.commit, "What is measured");
  app.add_option("--rounds", arguments.rounds)->check(CLI::Range(1, 100));
  app.add_option("--seconds", arguments.seconds, "For a figure, all rounds together")
      ->check(CLI::Range(1, 600));
  CLI11_PARSE(app, argc, argv);
  schema::Judge judge({});
  BareWalk walk;
  const std::chrono::duration<double> each(static_cast<double>(arguments.seconds) /
                                           arguments.rounds / 2);
  std::vector<Row> rows;
  for (const std::string& name : test::VectorNames()) {
    const std::string payload = test::ReadVector(name, ".bin");
    const auto judged = [&] {
      const auto judgement = judge.Payload(std::as_bytes(std::span(payload)));
      UPLINK_CHECK(judgement.record() != nullptr, name + " is good");
    };
    Row row{fmt::format("{} ({} B)", name, payload.size()), "ns", "Cap'n Proto's walk", {}, {}};
    for (int round = 0; round < arguments.rounds; ++round) {
      row.value.Add(NanosOf(judged, each));
      row.comparator_value.Add(NanosOf([&] { walk(payload); }, each));
    }
    rows.push_back(std::move(row));
  }
  const std::string good = test::ReadVector("motionTelemetry", ".bin");
  const std::string cut = good.substr(0, good.size() - sizeof(capnp::word));
  Row malformed{"cut off: rejected", "ns", "", {}, {}};
  for (int round = 0; round < arguments.rounds; ++round) {
    malformed.value.Add(NanosOf(
        [&] {
          const auto judgement = judge.Payload(std::as_bytes(std::span(cut)));
          UPLINK_CHECK(judgement.rejection() != nullptr, "what is cut off is rejected");
        },
        each));
  }
  rows.push_back(std::move(malformed));
  UPLINK_CHECK(walk.seen() > 0, "the walk is not left out");
  fmt::print("decode: one payload judged, on one core; {} rounds\n{}", arguments.rounds,
             TableOf(rows));
  if (!arguments.json.empty()) std::ofstream(arguments.json) << JsonOf(rows, arguments.commit);
  return 0;
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) { return uplink::bench::Run(argc, argv); }
