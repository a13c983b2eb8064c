#include "tests/component/front/raw_robot.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace uplink::testing {

RawRobot::RawRobot(RawHttp2::Options options, std::string ruri, std::uint8_t session)
    : options_(std::move(options)), ruri_(std::move(ruri)), session_(session) {}

bool RawRobot::Connect() {
  client_ = std::make_unique<RawHttp2>(options_);
  if (!client_->Begin()) return false;
  const v1::RelayRequest hello = HelloFrame(session(), acked_, acked_);
  client_->Send(OpenRelay(kStream) + http2::Data(kStream, WithPrefix(hello.SerializeAsString())));
  const RawStream& stream = client_->At(kStream);
  const bool answered =
      client_->ReadUntil([this] { return !FramesOf(client_->At(kStream)).empty(); });
  if (!answered || stream.over()) return false;
  const v1::RelayResponse first = FramesOf(client_->At(kStream)).front();
  if (!first.has_welcome()) return false;
  // An ack may have been lost on its way.
  acked_ = std::max(acked_, first.welcome().committed_seq());
  return true;
}

bool RawRobot::StreamBatch() {
  const model::Seq last = acked_ + kBatch;
  client_->Send(http2::Data(kStream, FaultsMessage(acked_ + 1, kBatch)));
  const auto through = [this] { return LastAck(client_->At(kStream)).through_seq(); };
  static_cast<void>(
      client_->ReadUntil([&] { return through() >= last || client_->At(kStream).over(); }));
  acked_ = std::max(acked_, through());
  return acked_ == last;
}

bool RawRobot::HalfClose() {
  client_->Send(http2::Data(kStream, "", http2::kEndStream));
  return client_->ReadUntilOver(kStream) && StatusOf(client_->At(kStream)) == "0";
}

void RawRobot::Reset() {
  client_->Send(http2::RstStream(kStream, http2::kCancel));
  client_.reset();
}

}  // namespace uplink::testing
