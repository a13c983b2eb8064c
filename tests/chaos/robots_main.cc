// Robots of the crash campaign: each says its script over a stream of its own, forever, and writes
// down what was acked. Killed at any moment, they go on where the file of acks ends.
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <fmt/core.h>
#include <grpc/support/log.h>

#include "schema/base/clock.h"
#include "server/config/flags.h"
#include "tests/chaos/acked_file.h"
#include "tests/chaos/script.h"
#include "tests/support/test_agent.h"
#include "tools/pki/directory.h"

namespace uplink::chaos {
namespace {

struct Arguments {
  std::uint16_t port = 0;
  std::string pki = "pki";
  std::string acked = "acked.log";
  std::uint32_t robots = 20;
  std::uint64_t seed = 1;
  int pace_ms = 100;
};

constexpr int kCertificateDays = 2;
/// Frames on their way before a robot waits for an answer: robots with an even index know of each
/// Ack at once, the others keep the server busy.
constexpr model::Seq kFramesAhead = 4;
/// Messages of the largest frame; the smallest has one.
constexpr model::Seq kFrameMax = 7;
constexpr std::chrono::hours kStreamPatience{10};
constexpr milliseconds kReconnectPause{50};

/// One robot; its thread.
class Robot final {
 public:
  Robot(const Arguments& arguments, std::uint32_t index, testing::ChannelSpec spec,
        AckedFile& acked)
      : pace_(arguments.pace_ms),
        index_(index),
        session_(SessionOf(arguments.seed, index)),
        spec_(std::move(spec)),
        acked_(acked),
        ahead_max_(index % 2 == 0 ? 0 : (kFramesAhead - 1) * kFrameMax),
        settled_(acked.Found(index)) {}

  void Run() {
    while (true) {
      Stream();
      Pause(kReconnectPause);
    }
  }

 private:
  /// Until the stream ends.
  void Stream() {
    testing::TestAgent::Options options;
    options.patience = kStreamPatience;
    testing::TestAgent agent(testing::MakeChannel(spec_), options);
    const auto welcome = agent.Connect(session_, settled_, settled_);
    // What Welcome says is committed may be forgotten, too.
    if (!welcome || !Settle(welcome->committed_seq())) return;
    model::Seq next = settled_ + 1;
    while (true) {
      std::vector<testing::Sent> frame;
      for (model::Seq i = 0; i <= next % kFrameMax; ++i) frame.push_back({next + i, {}});
      for (testing::Sent& message : frame) message.payload = PayloadOf(message.seq);
      next += frame.size();
      if (!agent.Send(testing::BatchFrame(frame))) return;
      while (next - 1 - settled_ > ahead_max_) {
        if (!Read(agent)) return;
      }
      Pause(pace_);
    }
  }
  bool Read(testing::TestAgent& agent) {
    const auto frame = agent.Read();
    if (!frame || frame->has_drain()) return false;
    return !frame->has_ack() || Settle(frame->ack().through_seq());
  }
  /// False if it cannot be written down.
  bool Settle(model::Seq through) {
    if (through <= settled_) return true;
    if (!acked_.Write(index_, through).ok()) return false;
    settled_ = through;
    return true;
  }
  static void Pause(milliseconds duration) {
    std::mutex mutex;
    std::condition_variable never;
    std::unique_lock lock(mutex);
    never.wait_for(lock, duration);
  }

  const milliseconds pace_;
  const std::uint32_t index_;
  const model::SessionId session_;
  const testing::ChannelSpec spec_;
  AckedFile& acked_;
  /// Numbers that may be unsettled when it waits no more.
  const model::Seq ahead_max_;
  model::Seq settled_ = 0;
};

absl::StatusOr<testing::ChannelSpec> SpecOf(const Arguments& arguments, std::uint32_t index,
                                            const pki::Authority& authority) {
  const auto profile = pki::RobotProfile(fmt::format("rcan://chaos/robot-{:03}", index), "chaos",
                                         fmt::format("robot-{:03}", index));
  if (!profile.ok()) return profile.status();
  const auto credentials = authority.Issue(*profile, kCertificateDays);
  if (!credentials.ok()) return credentials.status();
  testing::ChannelSpec spec;
  spec.port = arguments.port;
  spec.server_ca = authority.credentials().certificate_pem;
  spec.identity = {credentials->certificate_pem, credentials->key_pem};
  return spec;
}

absl::Status Run(const Arguments& arguments) {
  gpr_set_log_function([](gpr_log_func_args* /*line*/) {});
  const auto authority = pki::Directory(arguments.pki).LoadAuthority();
  if (!authority.ok()) return authority.status();
  const auto acked = AckedFile::Open(arguments.acked);
  if (!acked.ok()) return acked.status();
  std::vector<std::unique_ptr<Robot>> robots;
  for (std::uint32_t index = 0; index < arguments.robots; ++index) {
    auto spec = SpecOf(arguments, index, **authority);
    if (!spec.ok()) return spec.status();
    robots.push_back(std::make_unique<Robot>(arguments, index, *std::move(spec), **acked));
  }
  std::vector<std::jthread> threads;
  threads.reserve(robots.size());
  for (const auto& robot : robots) threads.emplace_back([&robot] { robot->Run(); });
  std::puts("running");
  std::fflush(stdout);
  return absl::OkStatus();
}

}  // namespace
}  // namespace uplink::chaos

int main(int argc, char** argv) {
  uplink::chaos::Arguments arguments;
  uplink::config::Flags flags("Robots of the crash campaign; they run until they are killed");
  flags.Add({"--port", "The relay's port on loopback", uplink::config::Flag::Need::kRequired},
            arguments.port);
  flags.Add({"--pki", "Folder with the authority"}, arguments.pki);
  flags.Add({"--acked", "The file of acks"}, arguments.acked);
  flags.Add({"--robots", "How many"}, arguments.robots);
  flags.Add({"--seed", "Draws the sessions"}, arguments.seed);
  flags.Add({"--pace-ms", "Between two frames of a robot"}, arguments.pace_ms);
  if (const auto code = flags.Parse(argc, argv)) return *code;
  const absl::Status status = uplink::chaos::Run(arguments);
  fmt::print(stderr, "{}\n", status.ToString());
  return 1;
}
