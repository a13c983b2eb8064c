#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "server/front/call/outbound.h"
#include "server/front/http2/http2.h"

namespace uplink::front {

/// The answer of one gRPC call on its HTTP/2 stream: headers, messages, and a final status, in
/// trailers or, without a message, in the headers.
///
/// Thread: confined to its connection's.
class Response final {
 public:
  Response(Http2& http2, std::int32_t stream) : http2_(http2), stream_(stream) {}

  /// Sends a message with its prefix, or shared ones, once the previous ones were taken.
  void Write(std::string message);
  void Write(std::vector<SharedMessage> messages);
  /// Ends the call once the message under way was taken.
  void Finish(const absl::Status& status);
  /// Drops a message that has not begun to go out.
  void DropMessage();
  /// Answers a request that is not gRPC.
  void FinishHttp(int http_status);
  /// The call's encoding is not supported: the status names those that are.
  void NameEncodings() { names_encodings_ = true; }

  /// Http2Stream::OnBody: what goes out next.
  Http2Stream::Body Take(char* into, std::size_t size);
  /// Http2Stream::OnBodyEnd.
  void SendTrailers();
  /// A message is under way.
  [[nodiscard]] bool writing() const { return writing_; }

 private:
  /// Begins to send what was set.
  void Send();
  [[nodiscard]] Headers StatusFields() const;

  Http2& http2_;
  const std::int32_t stream_;
  bool names_encodings_ = false;
  /// The headers are sent.
  bool begun_ = false;
  bool writing_ = false;
  bool finished_ = false;
  absl::Status status_;
  Outbound out_;
};

}  // namespace uplink::front
