#include "tests/support/http2_answers.h"

#include <algorithm>
#include <utility>

#include <nghttp2/nghttp2.h>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

std::string FieldOf(const http2::Fields& fields, std::string_view name) {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [name](const auto& f) { return f.first == name; });
  return found == fields.end() ? "" : found->second;
}

}  // namespace

struct Http2Answers::Inflater {
  Inflater() { UPLINK_CHECK(nghttp2_hd_inflate_new(&inflater) == 0, "nghttp2 has memory"); }
  ~Inflater() { nghttp2_hd_inflate_del(inflater); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  nghttp2_hd_inflater* inflater = nullptr;
};

std::string RawStream::Trailer(std::string_view name) const {
  return FieldOf(header_blocks > 1 ? trailers : headers, name);
}

std::string RawStream::Header(std::string_view name) const { return FieldOf(headers, name); }

Http2Answers::Http2Answers() : inflater_(std::make_unique<Inflater>()) {}

Http2Answers::~Http2Answers() = default;

void Http2Answers::Add(std::string_view bytes) {
  in_.append(bytes);
  std::string_view rest = in_;
  while (rest.size() >= http2::kHeadBytes) {
    const std::size_t size = http2::NumberOf(rest.substr(0, 3));
    UPLINK_CHECK(size <= kFrameBytesMax, "the server keeps the limit of frames");
    if (rest.size() < http2::kHeadBytes + size) break;
    constexpr std::uint32_t kReservedBit = 0x80000000U;
    OnFrame(static_cast<std::uint8_t>(rest[3]), static_cast<std::uint8_t>(rest[4]),
            http2::NumberOf(rest.substr(5, 4)) & ~kReservedBit,
            rest.substr(http2::kHeadBytes, size));
    rest.remove_prefix(http2::kHeadBytes + size);
  }
  in_.erase(0, in_.size() - rest.size());
}

void Http2Answers::OnFrame(std::uint8_t type, std::uint8_t flags, std::uint32_t id,
                           std::string_view payload) {
  if (id == 0) {
    const bool is_ack = (flags & http2::kAck) != 0;
    if (type == http2::kSettings && !is_ack) OnSettings(payload);
    if (type == http2::kPing) ++(is_ack ? pongs_ : pings_);
    if (type == http2::kGoaway) OnGoaway(payload);
    if (type == http2::kWindowUpdate) window_given_ += http2::NumberOf(payload);
    return;
  }
  if (streams_.size() >= kStreamsKeptMax && !streams_.contains(id)) return;
  RawStream& stream = streams_[id];
  if (type == http2::kRstStream) stream.reset = http2::NumberOf(payload);
  if (type == http2::kWindowUpdate) stream.window_given += http2::NumberOf(payload);
  if (type == http2::kData) {
    ++stream.data_frames;
    stream.data += payload.substr(0, kDataKeptMax - stream.data.size());
  }
  if (type == http2::kHeaders || type == http2::kContinuation) {
    header_block_ += payload;
    if ((flags & http2::kEndHeaders) != 0) OnHeaderBlock(stream, std::exchange(header_block_, {}));
  }
  if (type <= http2::kHeaders && (flags & http2::kEndStream) != 0) stream.ended = true;
}

void Http2Answers::OnHeaderBlock(RawStream& stream, std::string_view block) {
  http2::Fields& fields = stream.header_blocks++ == 0 ? stream.headers : stream.trailers;
  const auto* at = reinterpret_cast<const std::uint8_t*>(block.data());
  std::size_t left = block.size();
  for (;;) {
    nghttp2_nv field{};
    int flags = 0;
    const ssize_t taken = nghttp2_hd_inflate_hd2(inflater_->inflater, &field, &flags, at, left, 1);
    UPLINK_CHECK(taken >= 0, "the server's HPACK is sound");
    at += taken;
    left -= static_cast<std::size_t>(taken);
    if ((flags & NGHTTP2_HD_INFLATE_EMIT) != 0) {
      fields.emplace_back(std::string(reinterpret_cast<const char*>(field.name), field.namelen),
                          std::string(reinterpret_cast<const char*>(field.value), field.valuelen));
    }
    if ((flags & NGHTTP2_HD_INFLATE_FINAL) != 0) break;
  }
  nghttp2_hd_inflate_end_headers(inflater_->inflater);
}

void Http2Answers::OnGoaway(std::string_view payload) {
  if (payload.size() < 8 || goaways_.size() >= kGoawaysKeptMax) return;
  goaways_.push_back({.last_stream = http2::NumberOf(payload.substr(0, 4)),
                      .code = http2::NumberOf(payload.substr(4, 4)),
                      .text = std::string(payload.substr(8))});
}

void Http2Answers::OnSettings(std::string_view payload) {
  settings_came_ = true;
  for (; payload.size() >= 6; payload.remove_prefix(6)) {
    settings_[static_cast<std::uint16_t>(http2::NumberOf(payload.substr(0, 2)))] =
        http2::NumberOf(payload.substr(2, 4));
  }
}

const RawStream& Http2Answers::At(std::uint32_t stream) const {
  static const RawStream kNothing;
  const auto found = streams_.find(stream);
  return found == streams_.end() ? kNothing : found->second;
}

}  // namespace uplink::testing
