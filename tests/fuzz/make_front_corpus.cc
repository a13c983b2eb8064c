// The seeds of fuzz_front_bytes and fuzz_front_frames: one short script for each way that a
// connection can go.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <system_error>

#include "tests/fuzz/front_steps.h"
#include "tests/fuzz/odd_headers.h"
#include "tests/support/relay_bytes.h"

namespace uplink::fuzz {
namespace {

namespace http2 = testing::http2;
using Seeds = std::map<std::string, std::string>;

/// As many bytes of the robot's at once.
FrontScript& Say(FrontScript& script, const std::string& bytes) {
  return script
      .Do(BytesStep::kMany,
          {static_cast<int>(bytes.size() % 256), static_cast<int>(bytes.size() / 256)})
      .Add(bytes);
}

std::string Begun() { return http2::Preface() + http2::Settings({}) + http2::SettingsAck(); }

Seeds BytesSeeds() {
  Seeds seeds;
  const std::string hello = http2::Data(1, testing::HelloMessage(1));
  const std::string batch = http2::Data(1, testing::FaultsMessage(1, 3));
  const std::string end = http2::Data(1, "", http2::kEndStream);
  const auto script = [&seeds](const std::string& name, const std::string& bytes) {
    FrontScript made;
    seeds[name] = Say(made, bytes).Do(BytesStep::kCommit).Do(BytesStep::kTime, {30}).bytes();
  };
  script("stream", Begun() + testing::OpenRelay(1) + hello + batch + end);
  script("two_streams", Begun() + testing::OpenRelay(1) + hello + testing::OpenRelay(3) +
                            http2::Data(3, testing::HelloMessage(1)) + batch);
  script("reset", Begun() + testing::OpenRelay(1) + hello + http2::RstStream(1, http2::kCancel));
  script("half_message", Begun() + testing::OpenRelay(1) + hello +
                             http2::Data(1, testing::Prefix(80'000) + std::string(400, 'x')));
  script("compressed", Begun() + testing::OpenRelay(1) + hello +
                           http2::Data(1, testing::Prefix(3, '\1') + "abc"));
  script("unknown_method", Begun() + testing::OpenRelay(1, {{":path", "/none"}}));
  script("no_grpc", Begun() + testing::OpenRelay(1, {{"content-type", "text/html"}}));
  script("timeout", Begun() + testing::OpenRelay(1, {{"grpc-timeout", "1S"}}) + hello);
  script("answers", Begun() + http2::Ping() + http2::Settings({{http2::kInitialWindowSize, 1}}) +
                        http2::WindowUpdate(0, 1'000) + http2::Priority(1) +
                        http2::Goaway(http2::kNoError));
  script("headers_cut", Begun() + testing::OpenRelay(1).substr(0, 60));
  script("no_http2", "GET / HTTP/1.1\r\n\r\n");

  FrontScript steps;
  Say(steps, Begun() + testing::OpenRelay(1) + hello).Do(BytesStep::kCommit);
  steps.Do(BytesStep::kStopReading);
  Say(steps, batch + http2::Ping()).Do(BytesStep::kCommit).Do(BytesStep::kReadAgain);
  steps.Do(BytesStep::kConnect, {1});
  Say(steps, Begun() + testing::OpenRelay(1) + hello).Do(BytesStep::kWakes);
  seeds["steps"] = steps.Do(BytesStep::kDrain, {20}).Do(BytesStep::kTime, {25}).bytes();
  return seeds;
}

/// A welcomed stream.
FrontScript Welcomed() {
  FrontScript script;
  script.Do(MessageStep::kOpen, {0}).Do(MessageStep::kHello, {1}).Do(WorldStep::kCommit);
  return script;
}

FrontScript& Batch(FrontScript& script) {
  return script.Do(MessageStep::kBatch, {4, 1, 0, 1, 1, 2, 2, 1, 3});
}

void AddMessageSeeds(Seeds& seeds) {
  FrontScript whole = Welcomed();
  seeds["whole"] = Batch(whole)
                       .Do(WorldStep::kCommit)
                       .Do(MessageStep::kHalfClose)
                       .Do(WorldStep::kTime, {30})
                       .bytes();
  FrontScript pieces;
  pieces.Do(WorldStep::kPieces, {3}).Do(MessageStep::kOpen, {0}).Do(MessageStep::kHello, {1});
  seeds["pieces"] = Batch(pieces).Do(WorldStep::kCommit).bytes();
  seeds["half"] = Welcomed()
                      .Do(MessageStep::kHalf, {0, 40, 0, 160})
                      .Do(MessageStep::kMore, {0, 120})
                      .Do(WorldStep::kWakes)
                      .Do(MessageStep::kMore, {0, 120})
                      .bytes();
  seeds["half_broken"] = Welcomed().Do(MessageStep::kHalf, {0, 40, 0, 160}).bytes();
  // Each begins a first message that is never whole, so that no stream takes over from another.
  FrontScript many;
  for (int i = 0; i < 7; ++i) {
    many.Do(MessageStep::kOpen, {0}).Do(MessageStep::kHalf, {0, 40, 0, 255});
  }
  seeds["many_halves"] = many.Do(WorldStep::kWakes).bytes();
  seeds["padded"] = Welcomed().Do(MessageStep::kPadded, {9}).Do(MessageStep::kData, {2}).bytes();
}

void AddHeaderSeeds(Seeds& seeds) {
  for (int odd = 0; odd < kOddHeaders; ++odd) {
    FrontScript script;
    script.Do(MessageStep::kOpen, {odd}).Do(MessageStep::kHello, {1});
    seeds["headers_" + std::to_string(odd)] =
        script.Do(FrameStep::kContinuation, {0}).Do(WorldStep::kTime, {40}).bytes();
  }
  FrontScript bomb = Welcomed();
  bomb.Do(MessageStep::kOpen, {static_cast<int>(OddHeaders::kBombFuse)});
  seeds["header_bomb"] = bomb.Do(MessageStep::kOpen, {static_cast<int>(OddHeaders::kBomb)}).bytes();
}

void AddWorldSeeds(Seeds& seeds) {
  FrontScript blocked = Welcomed().Do(WorldStep::kStopReading);
  seeds["blocked"] = Batch(blocked)
                         .Do(FrameStep::kPing)
                         .Do(FrameStep::kSettings, {4, 32})
                         .Do(WorldStep::kCommit)
                         .Do(WorldStep::kReadAgain)
                         .Do(FrameStep::kWindow, {1, 3})
                         .bytes();
  FrontScript takeover = Welcomed();
  Batch(takeover).Do(WorldStep::kConnect, {0}).Do(MessageStep::kOpen, {0});
  seeds["takeover"] = takeover.Do(MessageStep::kHello, {1})
                          .Do(WorldStep::kCommit)
                          .Do(WorldStep::kPickWire, {0})
                          .Do(FrameStep::kReset, {8})
                          .bytes();
  FrontScript aged = Welcomed();
  seeds["aged"] = Batch(aged)
                      .Do(WorldStep::kAge, {20})
                      .Do(MessageStep::kOpen, {0})
                      .Do(WorldStep::kJournal)
                      .Do(WorldStep::kWakes)
                      .Do(WorldStep::kTime, {30})
                      .bytes();
  FrontScript drained = Welcomed();
  seeds["drained"] = Batch(drained)
                         .Do(WorldStep::kStoreFails, {1})
                         .Do(WorldStep::kDrain, {20})
                         .Do(WorldStep::kCommit)
                         .Do(WorldStep::kTime, {30})
                         .bytes();
  seeds["stranger"] =
      FrontScript().Do(WorldStep::kConnect, {3}).Do(MessageStep::kOpen, {0}).bytes();
  seeds["frames"] = Welcomed()
                        .Do(FrameStep::kPing)
                        .Do(FrameStep::kPriority)
                        .Do(FrameStep::kSettingsAck)
                        .Do(FrameStep::kAny, {200, 2, 1, 7})
                        .Do(FrameStep::kGoaway)
                        .Do(WorldStep::kKeepalive)
                        .Do(WorldStep::kPickStream, {0})
                        .Do(WorldStep::kEnd)
                        .Do(WorldStep::kBreak)
                        .bytes();
}

Seeds FramesSeeds() {
  Seeds seeds;
  AddMessageSeeds(seeds);
  AddHeaderSeeds(seeds);
  AddWorldSeeds(seeds);
  // A long one, so that a fuzzer tries long ones.
  FrontScript all;
  for (const auto& [name, bytes] : seeds) all.Do(WorldStep::kConnect, {2}).Add(bytes);
  seeds["all"] = all.bytes();
  return seeds;
}

bool WriteTo(const std::filesystem::path& folder, const Seeds& seeds) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const auto& [name, bytes] : seeds) {
    std::ofstream file(folder / name, std::ios::binary);
    file << bytes;
    if (!file.flush()) {
      std::fprintf(stderr, "cannot write %s\n", name.c_str());
      return false;
    }
  }
  return true;
}

}  // namespace
}  // namespace uplink::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER_OF_CORPORA\n", argv[0]);
    return 2;
  }
  const std::filesystem::path corpora = argv[1];
  const bool done =
      uplink::fuzz::WriteTo(corpora / "fuzz_front_bytes", uplink::fuzz::BytesSeeds()) &&
      uplink::fuzz::WriteTo(corpora / "fuzz_front_frames", uplink::fuzz::FramesSeeds());
  return done ? 0 : 1;
}
