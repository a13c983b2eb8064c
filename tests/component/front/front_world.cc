#include "tests/component/front/front_world.h"

#include <algorithm>
#include <fstream>
#include <utility>

#include <sys/resource.h>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

constexpr std::size_t kPrefixBytes = 5;

rlimit Descriptors() {
  rlimit limit{};
  UPLINK_CHECK(getrlimit(RLIMIT_NOFILE, &limit) == 0, "the system knows its limits");
  return limit;
}

void SetDescriptors(std::uint64_t count) {
  rlimit limit = Descriptors();
  limit.rlim_cur = std::min<rlim_t>(count, limit.rlim_max);
  UPLINK_CHECK(setrlimit(RLIMIT_NOFILE, &limit) == 0, "a limit within the hard one");
}

}  // namespace

RelayWorld::Options Native(RelayWorld::Options options) {
  options.transport = config::Transport::kNative;
  return options;
}

KeyPair RobotKeys(const RelayWorld& world, int number) {
  return world.authority.Issue(RobotSpec(RuriOf(number)));
}

KeyPair GatewayKeys(const RelayWorld& world) {
  CertificateSpec spec;
  spec.units = {"gateway"};
  return world.authority.Issue(spec);
}

RawHttp2::Options ClientOf(const RelayWorld& world, const KeyPair& identity,
                           const std::string& source) {
  RawHttp2::Options options;
  options.port = const_cast<RelayWorld&>(world).server().port();
  options.server_ca = world.authority.certificate();
  options.identity = identity;
  options.source = source;
  return options;
}

http2::Fields RelayFields(const http2::Fields& changes) {
  http2::Fields fields = {{":method", "POST"},
                          {":scheme", "https"},
                          {":path", "/uplink.v1.UplinkRelay/Relay"},
                          {":authority", "localhost"},
                          {"content-type", "application/grpc"},
                          {"te", "trailers"}};
  for (const auto& change : changes) {
    const auto found = std::find_if(fields.begin(), fields.end(),
                                    [&](const auto& field) { return field.first == change.first; });
    if (found == fields.end()) {
      fields.push_back(change);
    } else {
      found->second = change.second;
    }
  }
  std::erase_if(fields, [](const auto& field) { return field.second.empty(); });
  return fields;
}

std::string OpenRelay(std::uint32_t stream, const http2::Fields& changes) {
  return http2::Headers(stream, RelayFields(changes));
}

std::string Prefix(std::uint32_t bytes, char flag) {
  std::string prefix(1, flag);
  for (int shift = 24; shift >= 0; shift -= 8) {
    prefix += static_cast<char>((bytes >> static_cast<unsigned>(shift)) & 0xFFU);
  }
  return prefix;
}

std::string WithPrefix(std::string_view message) {
  return Prefix(static_cast<std::uint32_t>(message.size())).append(message);
}

std::string HelloMessage(std::uint8_t number, const std::string& ruri) {
  v1::RelayRequest hello = HelloFrame(SessionOf(number));
  hello.mutable_hello()->set_robot_ruri(ruri);
  return WithPrefix(hello.SerializeAsString());
}

std::string FaultsMessage(model::Seq first, std::size_t count) {
  std::vector<Sent> messages;
  for (model::Seq seq = first; seq < first + count; ++seq) {
    messages.push_back({seq, FaultPayload("fault-" + std::to_string(seq))});
  }
  return WithPrefix(BatchFrame(messages).SerializeAsString());
}

std::vector<v1::RelayResponse> FramesOf(const RawStream& stream) {
  std::vector<v1::RelayResponse> frames;
  std::string_view rest = stream.data;
  while (rest.size() >= kPrefixBytes) {
    const std::size_t bytes = http2::NumberOf(rest.substr(1, 4));
    if (rest.size() - kPrefixBytes < bytes) break;
    const std::string_view message = rest.substr(kPrefixBytes, bytes);
    UPLINK_CHECK(rest.front() == '\0' && frames.emplace_back().ParseFromArray(
                                             message.data(), static_cast<int>(message.size())),
                 "the server sent no RelayResponse");
    rest.remove_prefix(kPrefixBytes + bytes);
  }
  return frames;
}

v1::Ack LastAck(const RawStream& stream) {
  v1::Ack last;
  for (const v1::RelayResponse& frame : FramesOf(stream)) {
    if (frame.has_ack()) last = frame.ack();
  }
  return last;
}

std::string StatusOf(const RawStream& stream) { return stream.Trailer("grpc-status"); }

std::int64_t TurnedAwayFor(const RelayWorld& world, transport::TurnedAway cause) {
  return world.relay_probe.turned_away_total[static_cast<std::size_t>(cause)].value();
}

bool ServesNewRobot(const RelayWorld& world, int number, std::chrono::milliseconds patience) {
  TestAgent agent(world.Channel(RuriOf(number)), {.patience = patience});
  if (!agent.Connect(SessionOf(1))) return false;
  agent.Send(BatchFrame({{1, FaultPayload("new")}}));
  if (!agent.ReadThrough(1)) return false;
  agent.HalfClose();
  return agent.End().ok();
}

std::size_t ResidentBytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    std::size_t kibibytes = 0;
    if (word == "VmRSS:" && status >> kibibytes) return kibibytes * 1024;
  }
  return 0;
}

DescriptorLimit::DescriptorLimit(std::size_t descriptors_max) : before_(Descriptors().rlim_cur) {
  SetDescriptors(descriptors_max);
}

DescriptorLimit::~DescriptorLimit() { SetDescriptors(before_); }

}  // namespace uplink::testing
