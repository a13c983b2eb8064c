// Any program of HTTP/2 frames, right and odd, on several connections of few robots: nothing
// crashes, what a peer may hold stays bounded, nothing is acked that was not sent, and in the end
// everything is given back.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "schema/base/check.h"
#include "tests/fuzz/front_bench.h"
#include "tests/fuzz/front_steps.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/odd_headers.h"
#include "tests/support/attack_bytes.h"
#include "tests/support/relay_bytes.h"

namespace uplink::fuzz {
namespace {

namespace http2 = testing::http2;

/// Of one input; more would only cost time.
constexpr std::size_t kStepsMax = 400;
constexpr std::size_t kPiecesMax = 4'096;
constexpr std::uint8_t kSessions = 4;

const std::string& ContentOf(std::uint8_t which) {
  static const std::array<std::string, 4> contents{
      testing::FaultPayload("a"), testing::MotionPayload(), "garbage", testing::FaultPayload("")};
  return contents[which % contents.size()];
}

/// What a robot has sent in one session, over all its streams.
struct SentSoFar {
  model::Seq last_seq = 0;
  /// It sent bytes whose meaning we do not know.
  bool unknown = false;
};

/// What a connection's client knows.
struct Client {
  FrontWire* wire = nullptr;
  std::uint32_t next_stream = 1;
  std::uint32_t stream = 1;
  std::size_t piece = 0;
  /// By stream, the session that its first Hello named.
  std::map<std::uint32_t, std::uint8_t> sessions;
};

class World final {
 public:
  World() { Connect(0); }

  void Do(std::uint8_t step, Input& input);
  void Check();
  void End() { bench_.End(); }

 private:
  void Connect(std::uint8_t robot);
  void Send(const std::string& bytes);
  void SendData(std::string_view bytes) { Send(http2::Data(client().stream, bytes)); }
  void Open(OddHeaders odd);
  void Hello(std::uint8_t number);
  void Batch(Input& input);
  void Setting(std::uint8_t setting, std::uint8_t power);
  void Any(Input& input);
  void Do(MessageStep step, Input& input);
  void Do(FrameStep step, Input& input);
  void Do(WorldStep step, Input& input);
  void CheckAcks(const Client& of);
  /// What was said in the stream's session; nothing before its Hello.
  [[nodiscard]] SentSoFar* SentOn(const Client& client, std::uint32_t stream);
  void NoteUnknown();
  [[nodiscard]] Client& client() { return clients_[picked_]; }

  FrontBench bench_;
  std::vector<Client> clients_;
  std::size_t picked_ = 0;
  std::map<std::pair<std::uint8_t, std::uint8_t>, SentSoFar> said_;
};

void World::Connect(std::uint8_t robot) {
  FrontWire& wire = bench_.Connect(robot);
  // Some may have gone for it.
  std::erase_if(clients_, [this](const Client& each) {
    return std::ranges::none_of(bench_.wires(),
                                [&](const auto& left) { return left.get() == each.wire; });
  });
  clients_.push_back({.wire = &wire});
  picked_ = clients_.size() - 1;
  Send(http2::Preface() + http2::Settings({}) + http2::SettingsAck());
}

void World::Send(const std::string& bytes) {
  const std::size_t piece = client().piece;
  if (piece == 0 || bytes.size() / piece > kPiecesMax) return client().wire->Receive(bytes);
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    client().wire->Receive(std::string_view(bytes).substr(at, piece));
  }
}

void World::Open(OddHeaders odd) {
  Client& to = client();
  std::uint8_t flags = odd == OddHeaders::kNotWhole ? http2::kNone : http2::kEndHeaders;
  if (odd == OddHeaders::kHalfClosed) flags |= http2::kEndStream;
  if (odd != OddHeaders::kOldStream) {
    to.stream = to.next_stream;
    to.next_stream += 2;
  }
  if (odd == OddHeaders::kBombFuse) return Send(testing::attack::HeaderBombFuse(to.stream));
  if (odd == OddHeaders::kBomb) return Send(testing::attack::HeaderBomb(to.stream));
  Send(http2::Headers(to.stream, FieldsOf(odd), flags));
}

SentSoFar* World::SentOn(const Client& of, std::uint32_t stream) {
  const auto session = of.sessions.find(stream);
  if (session == of.sessions.end()) return nullptr;
  return &said_[{of.wire->robot(), session->second}];
}

void World::NoteUnknown() {
  // It may even be a Hello of any session.
  for (std::uint8_t session = 0; session < kSessions; ++session) {
    said_[{client().wire->robot(), session}].unknown = true;
  }
}

void World::Hello(std::uint8_t number) {
  Client& to = client();
  const std::uint8_t session = number % kSessions;
  to.sessions.emplace(to.stream, session);
  SendData(testing::HelloMessage(session));
}

void World::Batch(Input& input) {
  Client& to = client();
  SentSoFar* const said = SentOn(to, to.stream);
  model::Seq seq = said == nullptr ? 0 : said->last_seq;
  std::vector<testing::Sent> messages;
  for (int left = input.Byte() % 18; left > 0; --left) {
    const std::uint8_t above = input.Byte();
    seq += above < 240 ? above : model::Seq{1} << (above - 240) * 4U;
    messages.push_back({seq, ContentOf(input.Byte())});
  }
  if (said != nullptr) said->last_seq = std::max(said->last_seq, seq);
  SendData(testing::WithPrefix(testing::BatchFrame(messages).SerializeAsString()));
}

void World::Setting(std::uint8_t setting, std::uint8_t power) {
  Send(http2::Settings({{setting, power % 33 == 32 ? 0 : std::uint32_t{1} << (power % 33)}}));
}

void World::Any(Input& input) {
  const std::uint8_t type = input.Byte();
  const std::uint8_t flags = input.Byte();
  const std::string payload = input.Bytes(input.Byte());
  NoteUnknown();
  Send(http2::Frame(type, flags, flags % 2 == 0 ? client().stream : 0, payload));
}

void World::Do(MessageStep step, Input& input) {
  switch (step) {
    case MessageStep::kOpen:
      Open(static_cast<OddHeaders>(input.Byte() % kOddHeaders));
      return;
    case MessageStep::kHello:
      Hello(input.Byte());
      return;
    case MessageStep::kBatch:
      Batch(input);
      return;
    case MessageStep::kHalf: {
      const std::uint32_t whole = input.Word() * std::uint32_t{8};
      SendData(testing::Prefix(whole) + std::string(std::min<std::size_t>(input.Word(), whole), 0));
      return;
    }
    case MessageStep::kMore:
      SendData(std::string(input.Word(), '\0'));
      return;
    case MessageStep::kData:
      NoteUnknown();
      SendData(input.Bytes(input.Byte()));
      return;
    case MessageStep::kPadded: {
      const std::uint8_t padding = input.Byte();
      Send(http2::Frame(http2::kData, http2::kPadded, client().stream,
                        static_cast<char>(padding) + std::string(padding, '\0')));
      return;
    }
    case MessageStep::kHalfClose:
      Send(http2::Data(client().stream, "", http2::kEndStream));
      return;
  }
}

void World::Do(FrameStep step, Input& input) {
  switch (step) {
    case FrameStep::kReset:
      Send(http2::RstStream(client().stream, input.Byte()));
      return;
    case FrameStep::kPing:
      Send(http2::Ping());
      return;
    case FrameStep::kSettings: {
      const std::uint8_t setting = input.Byte();
      Setting(setting, input.Byte());
      return;
    }
    case FrameStep::kSettingsAck:
      Send(http2::SettingsAck());
      return;
    case FrameStep::kWindow: {
      const std::uint32_t stream = input.Byte() % 2 == 1 ? client().stream : 0;
      Send(http2::WindowUpdate(stream, std::uint32_t{1} << (input.Byte() % 32)));
      return;
    }
    case FrameStep::kPriority:
      Send(http2::Priority(client().stream));
      return;
    case FrameStep::kContinuation:
      Send(http2::Frame(http2::kContinuation, http2::kEndHeaders, client().stream,
                        input.Bytes(input.Byte())));
      return;
    case FrameStep::kGoaway:
      Send(http2::Goaway(http2::kNoError));
      return;
    case FrameStep::kAny:
      Any(input);
      return;
  }
}

void World::Do(WorldStep step, Input& input) {
  FrontWire& wire = *client().wire;
  switch (step) {
    case WorldStep::kConnect:
      return Connect(input.Byte());
    case WorldStep::kPickWire:
      picked_ = input.Byte() % clients_.size();
      return;
    case WorldStep::kPickStream:
      client().stream = 1 + 2 * (input.Byte() % (client().next_stream / 2 + 1));
      return;
    case WorldStep::kPieces:
      client().piece = input.Byte();
      return;
    case WorldStep::kStopReading:
      return wire.StopReading();
    case WorldStep::kReadAgain:
      return wire.ReadAgain();
    case WorldStep::kBreak:
      return wire.Break();
    case WorldStep::kTime:
      return bench_.Pass(milliseconds(50) * input.Byte());
    case WorldStep::kWakes:
      return bench_.DeliverWakes();
    case WorldStep::kJournal:
      static_cast<void>(bench_.Advance());
      return;
    case WorldStep::kCommit:
      return bench_.Commit();
    case WorldStep::kStoreFails:
      return bench_.store().FailNext(
          1, input.Byte() % 2 == 0 ? testing::FailAt::kBefore : testing::FailAt::kAfter);
    case WorldStep::kAge:
      return wire.Drain(milliseconds(50) * input.Byte());
    case WorldStep::kDrain:
      return bench_.Drain(milliseconds(50) * input.Byte());
    case WorldStep::kKeepalive:
      return wire.Keepalive();
    case WorldStep::kEnd:
      return wire.EndNow();
  }
}

void World::Do(std::uint8_t step, Input& input) {
  constexpr int kBeforeWorld = kMessageSteps + kFrameSteps;
  const int number = step % kFramesSteps;
  if (number < kMessageSteps) return Do(static_cast<MessageStep>(number), input);
  if (number < kBeforeWorld) return Do(static_cast<FrameStep>(number - kMessageSteps), input);
  Do(static_cast<WorldStep>(number - kBeforeWorld), input);
}

void World::Check() {
  bench_.Check();
  for (const Client& each : clients_) CheckAcks(each);
}

void World::CheckAcks(const Client& of) {
  for (const auto& [stream, session] : of.sessions) {
    const SentSoFar& said = said_[{of.wire->robot(), session}];
    UPLINK_CHECK(said.unknown || of.wire->JudgedOn(stream) <= said.last_seq,
                 "nothing is acked that was not sent");
  }
}

}  // namespace
}  // namespace uplink::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  uplink::fuzz::Input input(data, size);
  uplink::fuzz::World world;
  for (std::size_t steps = 0; input.more() && steps < uplink::fuzz::kStepsMax; ++steps) {
    world.Do(input.Byte(), input);
    world.Check();
  }
  world.End();
  return 0;
}
