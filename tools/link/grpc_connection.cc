#include "tools/link/grpc_connection.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/core.h>
#include <nghttp2/nghttp2.h>

namespace uplink::link {
namespace {

/// A flag and a length before each message.
constexpr std::size_t kPrefixBytes = 5;
constexpr std::size_t kKeptBytes = 4 * 1024;
/// Bytes that were taken already and still lie before the rest.
constexpr std::size_t kTakenMax = 64 * 1024;
constexpr int kHighestCode = 16;

std::uint32_t LengthOf(std::string_view prefix) {
  std::uint32_t length = 0;
  for (std::size_t i = 1; i < kPrefixBytes; ++i) {
    length = length << 8 | static_cast<unsigned char>(prefix[i]);
  }
  return length;
}

int CodeOfReset(std::uint32_t error) {
  switch (error) {
    case NGHTTP2_CANCEL:
      return kCodeCancelled;
    case NGHTTP2_REFUSED_STREAM:
      return kCodeUnavailable;
    case NGHTTP2_ENHANCE_YOUR_CALM:
      return kCodeResourceExhausted;
    case NGHTTP2_INADEQUATE_SECURITY:
      return kCodePermissionDenied;
    default:
      return kCodeInternal;
  }
}

/// grpc-message comes percent-encoded.
std::string Decoded(std::string_view text) {
  constexpr std::size_t kDigits = 2;
  constexpr int kHex = 16;
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned byte = 0;
    const std::string_view digits = text.substr(std::min(i + 1, text.size()), kDigits);
    const char* const end = digits.data() + digits.size();
    if (text[i] == '%' && digits.size() == kDigits &&
        std::from_chars(digits.data(), end, byte, kHex).ptr == end) {
      decoded += static_cast<char>(byte);
      i += kDigits;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

void GiveBack(std::string& buffer) {
  if (buffer.capacity() > kKeptBytes) {
    std::string().swap(buffer);
  } else {
    buffer.clear();
  }
}

}  // namespace

GrpcConnection::GrpcConnection(Loop& loop, LinkOptions options, StreamEvents& events)
    : events_(&events),
      authority_(options.address.text),
      record_per_message_(options.record_per_message),
      link_(std::make_shared<Http2Link>(loop, std::move(options), Http2Link::For::kOne)) {
  link_->Join(*this);
}

GrpcConnection::GrpcConnection(std::shared_ptr<Http2Link> link, std::string authority,
                               StreamEvents& events)
    : events_(&events),
      authority_(std::move(authority)),
      record_per_message_(false),
      link_(std::move(link)) {
  link_->Join(*this);
}

GrpcConnection::~GrpcConnection() {
  link_->Leave(*this);
  if (!streaming_ || ended_) return;
  link_->http2().Forget(stream_);
  if (link_->users() == Http2Link::For::kOne) return;
  link_->http2().Reset(stream_, NGHTTP2_CANCEL);
  link_->Flush();
}

bool GrpcConnection::OpenStream(const std::string& path) {
  if (streaming_ || !usable()) return false;
  stream_ = link_->http2().Open({{":method", "POST"},
                                 {":scheme", "https"},
                                 {":path", path},
                                 {":authority", authority_},
                                 {"content-type", "application/grpc"},
                                 {"te", "trailers"}},
                                *this);
  streaming_ = stream_ > 0;
  link_->Flush();
  return streaming_;
}

void GrpcConnection::Send(std::string_view message) {
  if (!streaming_ || half_closed_) return;
  std::array<char, kPrefixBytes> prefix{};
  const auto size = static_cast<std::uint32_t>(message.size());
  for (std::size_t i = 1; i < kPrefixBytes; ++i) {
    prefix[i] = static_cast<char>(size >> (8 * (kPrefixBytes - 1 - i)));
  }
  out_.append(prefix.data(), prefix.size());
  out_.append(message);
  link_->http2().Resume(stream_);
  link_->Flush();
}

void GrpcConnection::HalfClose() {
  if (!streaming_ || std::exchange(half_closed_, true)) return;
  link_->http2().Resume(stream_);
  link_->Flush();
}

void GrpcConnection::CancelStream() {
  if (!streaming_) return;
  link_->http2().Reset(stream_, NGHTTP2_CANCEL);
  link_->Flush();
}

std::size_t GrpcConnection::unsent() const {
  return out_.size() - out_taken_ + link_->link().unsent();
}

void GrpcConnection::PauseReading(bool pause) {
  if (link_->users() == Http2Link::For::kOne) return link_->link().PauseReading(pause);
  if (std::exchange(paused_, pause) == pause || pause || !streaming_) return;
  link_->http2().Consume(stream_, std::exchange(unread_, 0));
  link_->Flush();
  Soon();
}

void GrpcConnection::Freeze() {
  events_ = nullptr;
  link_->Freeze(*this);
}

void GrpcConnection::Cut() {
  events_ = nullptr;
  link_->Cut(*this);
}

void GrpcConnection::OnUp() {
  if (std::exchange(joined_, true)) return;
  if (events_ != nullptr) events_->OnConnected();
}

void GrpcConnection::AfterBytes() {
  if (std::exchange(sent_more_, false) && !ended_) OnSent();
  TellEnd();
}

void GrpcConnection::OnSent() {
  if (events_ != nullptr) events_->OnSent();
}

void GrpcConnection::OnDown(const absl::Status& why) {
  const bool between_streams = joined_ && !streaming_;
  if (between_streams) return;
  // Before the first stream too, its owner waits for something.
  if (!ended_) ended_ = StreamEnd{kCodeUnavailable, std::string(why.message())};
  TellEnd();
}

void GrpcConnection::OnHeader(std::string_view name, std::string_view value) {
  if (name == "grpc-status") {
    int code = kCodeUnknown;
    std::from_chars(value.data(), value.data() + value.size(), code);
    grpc_status_ = code >= 0 && code <= kHighestCode ? code : kCodeUnknown;
  } else if (name == "grpc-message") {
    grpc_message_ = Decoded(value);
  } else if (name == ":status") {
    http_status_ = value;
  }
}

void GrpcConnection::OnData(std::string_view bytes) {
  if (!streaming_ || ended_) return;
  in_.append(bytes);
  if (paused_) {
    unread_ += bytes.size();
    return;
  }
  if (link_->users() == Http2Link::For::kSeveral) link_->http2().Consume(stream_, bytes.size());
  DeliverMessages();
}

void GrpcConnection::DeliverMessages() {
  std::size_t at = 0;
  while (in_.size() - at >= kPrefixBytes) {
    const std::string_view rest = std::string_view(in_).substr(at);
    const std::size_t length = LengthOf(rest);
    if (length > kMessageBytesMax || rest.front() != 0) {
      ended_ = StreamEnd{kCodeResourceExhausted,
                         fmt::format("a message of {} bytes, or a compressed one", length)};
      link_->http2().Reset(stream_, NGHTTP2_CANCEL);
      link_->http2().Forget(stream_);
      link_->Touch(*this);
      break;
    }
    if (rest.size() < kPrefixBytes + length) break;
    if (events_ != nullptr) events_->OnMessage(rest.substr(kPrefixBytes, length));
    at += kPrefixBytes + length;
  }
  in_.erase(0, at);
  if (in_.empty()) GiveBack(in_);
}

void GrpcConnection::OnClosed(std::uint32_t error) {
  if (ended_) return;
  if (grpc_status_) {
    ended_ = StreamEnd{*grpc_status_, grpc_message_};
  } else if (error != NGHTTP2_NO_ERROR) {
    ended_ = StreamEnd{CodeOfReset(error), fmt::format("HTTP/2 error {}", error)};
  } else {
    ended_ = StreamEnd{kCodeUnknown, "no gRPC status; HTTP status " + http_status_};
  }
  link_->Touch(*this);
}

std::size_t GrpcConnection::TakeBody(std::uint8_t* to, std::size_t max, bool& end) {
  std::size_t taken = std::min(max, out_.size() - out_taken_);
  if (record_per_message_ && taken > 0) {
    if (message_left_ == 0) {
      message_left_ = kPrefixBytes + LengthOf(std::string_view(out_).substr(out_taken_));
    }
    taken = std::min(taken, message_left_);
    message_left_ -= taken;
  }
  std::memcpy(to, out_.data() + out_taken_, taken);
  out_taken_ += taken;
  if (taken > 0 && link_->receiving()) {
    sent_more_ = true;
    link_->Touch(*this);
  }
  if (out_taken_ == out_.size()) {
    GiveBack(out_);
    out_taken_ = 0;
    end = half_closed_;
  } else if (out_taken_ > kTakenMax) {
    out_.erase(0, out_taken_);
    out_taken_ = 0;
  }
  return taken;
}

void GrpcConnection::Soon() {
  boost::asio::post(link_->loop().io, [weak = std::weak_ptr(self_)] {
    const auto self = weak.lock();
    if (self == nullptr) return;
    // What came while it was paused.
    if (!(*self)->paused_) (*self)->DeliverMessages();
    (*self)->TellEnd();
  });
}

void GrpcConnection::TellEnd() {
  if (!ended_ || link_->busy()) return;
  const StreamEnd end = *std::exchange(ended_, std::nullopt);
  streaming_ = false;
  half_closed_ = false;
  sent_more_ = false;
  paused_ = false;
  unread_ = 0;
  GiveBack(out_);
  GiveBack(in_);
  out_taken_ = 0;
  message_left_ = 0;
  grpc_status_.reset();
  grpc_message_.clear();
  StreamEvents* const events = events_;
  // The last thing that is done: the owner may drop the connection.
  if (events != nullptr) events->OnEnded(end);
}

}  // namespace uplink::link
