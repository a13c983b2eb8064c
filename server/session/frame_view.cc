#include "server/session/frame_view.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include "uplink/v1/relay.pb.h"

namespace uplink::session {
namespace {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedInputStream;

/// Views whose memory is kept for the next frame: a frame of empty messages can need a thousand
/// times as many.
constexpr std::size_t kViewsKeptMax = 4096;
/// Unknown fields of a frame. Protobuf's own parser keeps each as an object: half a million fit
/// into a frame, and take it 40 ms (measured).
constexpr std::size_t kUnknownFieldsMax = 256;
/// Fields of a frame itself, known or not.
constexpr std::size_t kPartsMax = kUnknownFieldsMax + 16;

constexpr std::uint32_t LengthDelimited(int field) {
  return WireFormatLite::MakeTag(field, WireFormatLite::WIRETYPE_LENGTH_DELIMITED);
}
constexpr std::uint32_t Varint(int field) {
  return WireFormatLite::MakeTag(field, WireFormatLite::WIRETYPE_VARINT);
}

constexpr std::uint32_t kHelloTag = LengthDelimited(v1::RelayRequest::kHelloFieldNumber);
constexpr std::uint32_t kBatchTag = LengthDelimited(v1::RelayRequest::kBatchFieldNumber);
constexpr std::uint32_t kGoodbyeTag = LengthDelimited(v1::RelayRequest::kGoodbyeFieldNumber);
constexpr std::uint32_t kUplinksTag = LengthDelimited(v1::UplinkBatch::kUplinksFieldNumber);
constexpr std::uint32_t kSentTag = Varint(v1::UplinkBatch::kSentUnixMsFieldNumber);
constexpr std::uint32_t kBacklogTag = Varint(v1::UplinkBatch::kBacklogUplinksFieldNumber);
constexpr std::uint32_t kOldestTag = Varint(v1::UplinkBatch::kOldestUnsentUnixMsFieldNumber);
constexpr std::uint32_t kSeqTag = Varint(v1::Uplink::kSeqFieldNumber);
constexpr std::uint32_t kRoverNexusTag = LengthDelimited(v1::Uplink::kRoverNexusFieldNumber);
constexpr std::uint32_t kRcanTag = LengthDelimited(v1::Uplink::kRcanRobotStateFieldNumber);

/// Walks the bytes of one frame.
class Walk {
 public:
  explicit Walk(std::string_view bytes)
      : bytes_(bytes),
        input_(reinterpret_cast<const std::uint8_t*>(bytes.data()),
               static_cast<int>(bytes.size())) {}

  FrameContent Request(BatchView& batch) {
    FrameContent content = FrameContent::kNothing;
    while (const std::uint32_t tag = NextTag()) {
      bool good = CountPart();
      if (!good) return FrameContent::kMalformed;
      if (tag == kBatchTag) {
        // A hello before it no longer counts; another batch before it does.
        if (content != FrameContent::kBatch) Clear(batch);
        content = FrameContent::kBatch;
        good = Within([&] { return Batch(batch); });
      } else if (tag == kHelloTag || tag == kGoodbyeTag) {
        content = tag == kHelloTag ? FrameContent::kHello : FrameContent::kGoodbye;
        unusual_ = true;
        std::string_view ignored;
        good = Bytes(ignored);
      } else {
        good = SkipUnknown(tag);
      }
      if (!good) return FrameContent::kMalformed;
    }
    return input_.ConsumedEntireMessage() ? content : FrameContent::kMalformed;
  }

  /// The frame has something that current agents do not send: protobuf's own parser decides.
  [[nodiscard]] bool unusual() const { return unusual_; }
  /// The frame has more than any version of the protocol sends.
  [[nodiscard]] bool foreign() const { return foreign_; }

  static void Clear(BatchView& batch) {
    batch.uplinks.clear();
    batch.head = {};
  }

 private:
  bool Batch(BatchView& batch) {
    while (const std::uint32_t tag = NextTag()) {
      bool good = true;
      std::uint64_t number = 0;
      if (tag == kUplinksTag) {
        UplinkView& uplink = batch.uplinks.emplace_back();
        good = Within([&] { return Uplink(uplink); });
      } else if (tag == kSentTag) {
        good = input_.ReadVarint64(&number);
        batch.head.sent_unix_ms = static_cast<std::int64_t>(number);
      } else if (tag == kBacklogTag) {
        good = input_.ReadVarint64(&number);
        batch.head.backlog_uplinks = number;
      } else if (tag == kOldestTag) {
        good = input_.ReadVarint64(&number);
        batch.head.oldest_unsent_unix_ms = static_cast<std::int64_t>(number);
      } else {
        good = SkipUnknown(tag);
      }
      if (!good) return false;
    }
    return input_.ConsumedEntireMessage();
  }

  bool Uplink(UplinkView& uplink) {
    while (const std::uint32_t tag = NextTag()) {
      bool good = true;
      if (tag == kSeqTag) {
        good = input_.ReadVarint64(&uplink.seq);
      } else if (tag == kRoverNexusTag) {
        uplink.content = UplinkView::Content::kRoverNexus;
        good = Bytes(uplink.payload);
      } else if (tag == kRcanTag) {
        uplink.content = UplinkView::Content::kRcanRobotState;
        good = Bytes(uplink.payload);
      } else {
        good = SkipUnknown(tag);
      }
      if (!good) return false;
    }
    return input_.ConsumedEntireMessage();
  }

  /// 0 at the end of the current message. All our tags have one byte.
  std::uint32_t NextTag() {
    const int before = input_.CurrentPosition();
    const std::uint32_t tag = input_.ReadTag();
    unusual_ = unusual_ || input_.CurrentPosition() > before + 1;
    return tag;
  }

  /// A normal frame has one hello or one batch. Each is parsed.
  bool CountPart() {
    ++parts_;
    foreign_ = foreign_ || parts_ > kPartsMax;
    return !foreign_;
  }

  bool SkipUnknown(std::uint32_t tag) {
    unusual_ = true;
    ++unknown_;
    // Our messages have no groups, and fields within one would not be counted.
    const bool group = WireFormatLite::GetTagWireType(tag) == WireFormatLite::WIRETYPE_START_GROUP;
    foreign_ = foreign_ || group || unknown_ > kUnknownFieldsMax;
    return !foreign_ && WireFormatLite::SkipField(&input_, tag);
  }

  bool Size(int& size) {
    constexpr int kUsualBytes = 5;
    const int before = input_.CurrentPosition();
    const bool good = input_.ReadVarintSizeAsInt(&size);
    unusual_ = unusual_ || input_.CurrentPosition() > before + kUsualBytes;
    return good;
  }

  bool Bytes(std::string_view& to) {
    int size = 0;
    if (!Size(size)) return false;
    const auto at = static_cast<std::size_t>(input_.CurrentPosition());
    if (!input_.Skip(size)) return false;
    to = bytes_.substr(at, static_cast<std::size_t>(size));
    return true;
  }

  /// Bytes until the current message ends.
  [[nodiscard]] int Left() const {
    const int within = input_.BytesUntilLimit();
    return within >= 0 ? within : static_cast<int>(bytes_.size()) - input_.CurrentPosition();
  }

  /// A message within the message.
  template <typename Read>
  bool Within(const Read& read) {
    int size = 0;
    if (!Size(size) || size > Left()) return false;
    const auto [limit, depth] = input_.IncrementRecursionDepthAndPushLimit(size);
    if (depth < 0 || !read()) return false;
    return input_.DecrementRecursionDepthAndPopLimit(limit);
  }

  std::string_view bytes_;
  CodedInputStream input_;
  bool unusual_ = false;
  bool foreign_ = false;
  std::size_t unknown_ = 0;
  std::size_t parts_ = 0;
};

}  // namespace

FrameContent ReadFrame(std::string_view bytes, BatchView& batch, std::size_t uplinks_max) {
  if (batch.uplinks.capacity() > kViewsKeptMax) std::vector<UplinkView>().swap(batch.uplinks);
  Walk::Clear(batch);
  Walk walk(bytes);
  const FrameContent content = walk.Request(batch);
  if (walk.foreign()) return FrameContent::kForeign;
  const bool small = content == FrameContent::kHello || content == FrameContent::kGoodbye;
  if (small && bytes.size() > kHelloFrameBytesMax) return FrameContent::kForeign;
  // It is refused for that, even if protobuf accepts it.
  if (content == FrameContent::kBatch && batch.uplinks.size() > uplinks_max) return content;
  if (!walk.unusual() || content == FrameContent::kMalformed) return content;
  v1::RelayRequest whole;
  return whole.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))
             ? content
             : FrameContent::kMalformed;
}

}  // namespace uplink::session
