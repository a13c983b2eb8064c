#include "server/front/http2/http2.h"

#include <algorithm>
#include <array>
#include <optional>

#include <nghttp2/nghttp2.h>

#include "schema/base/check.h"
#include "server/front/http2/frame_kinds.h"
#include "server/front/http2/limits.h"

namespace uplink::front {
namespace {

std::string_view ViewOf(const std::uint8_t* bytes, std::size_t size) {
  // The library's bytes are unsigned char; reading them as char is always allowed.
  return {reinterpret_cast<const char*>(bytes), size};
}

Http2& Self(void* user_data) { return *static_cast<Http2*>(user_data); }

Http2Stream* StreamOf(nghttp2_session* session, std::int32_t id) {
  return static_cast<Http2Stream*>(nghttp2_session_get_stream_user_data(session, id));
}

int OnBeginFrame(nghttp2_session* /*session*/, const nghttp2_frame_hd* header, void* self) {
  Http2& http2 = Self(self);
  if (IsAnswer(*header)) {
    // An answer to SETTINGS that were not sent is an error for the library.
    if (header->type != NGHTTP2_PING) return 0;
    if (!http2.TakePong()) {
      http2.peer().OnFrame(FrameKind::kPong);
    } else if (!http2.waits_for_pong()) {
      http2.peer().OnPong();
    }
    return 0;
  }
  if (AsksForAnswer(*header)) http2.OnQuestion();
  if (const std::optional<FrameKind> kind = KindOf(*header)) http2.peer().OnFrame(*kind);
  return 0;
}

/// Drops the content of frames of unknown types; OnBeginFrame has counted them.
int OnExtension(nghttp2_session* /*session*/, void** /*payload*/,
                const nghttp2_frame_hd* /*header*/, void* /*self*/) {
  return NGHTTP2_ERR_CANCEL;
}

int OnBeginHeaders(nghttp2_session* session, const nghttp2_frame* frame, void* self) {
  Self(self).BeginHeaders();
  if (frame->hd.type != NGHTTP2_HEADERS || frame->headers.cat != NGHTTP2_HCAT_REQUEST) return 0;
  Http2Stream* stream = Self(self).peer().OnStream(frame->hd.stream_id);
  if (stream == nullptr) {
    nghttp2_submit_rst_stream(session, NGHTTP2_FLAG_NONE, frame->hd.stream_id,
                              NGHTTP2_REFUSED_STREAM);
    return 0;
  }
  nghttp2_session_set_stream_user_data(session, frame->hd.stream_id, stream);
  return 0;
}

int OnHeader(nghttp2_session* session, const nghttp2_frame* frame, const std::uint8_t* name,
             std::size_t name_size, const std::uint8_t* value, std::size_t value_size,
             std::uint8_t /*flags*/, void* self) {
  if (!Self(self).CountHeader(name_size + value_size)) {
    return NGHTTP2_ERR_TEMPORAL_CALLBACK_FAILURE;
  }
  if (frame->headers.cat != NGHTTP2_HCAT_REQUEST) return 0;  // trailers of a request mean nothing
  if (Http2Stream* stream = StreamOf(session, frame->hd.stream_id)) {
    static_cast<void>(stream->OnHeader(ViewOf(name, name_size), ViewOf(value, value_size)));
  }
  return 0;
}

int OnFrameReceived(nghttp2_session* session, const nghttp2_frame* frame, void* self) {
  const bool is_reset = frame->hd.type == NGHTTP2_RST_STREAM;
  if (!is_reset && frame->hd.type != NGHTTP2_HEADERS && frame->hd.type != NGHTTP2_DATA) return 0;
  // The library returns padding to the windows at once, so these do not bound it.
  if (IsPaddingAlone(*frame)) Self(self).peer().OnFrame(FrameKind::kEmptyData);
  if (is_reset || EndsStream(frame->hd)) Self(self).NoteEnd(frame->hd.stream_id);
  Http2Stream* stream = StreamOf(session, frame->hd.stream_id);
  if (stream == nullptr) return 0;
  if (is_reset) {
    stream->OnReset(frame->rst_stream.error_code);
    return 0;
  }
  if (frame->hd.type == NGHTTP2_HEADERS && frame->headers.cat == NGHTTP2_HCAT_REQUEST) {
    stream->OnHeadersEnd();
  }
  if (EndsStream(frame->hd)) stream->OnEnd();
  return 0;
}

int OnDataChunk(nghttp2_session* session, std::uint8_t /*flags*/, std::int32_t id,
                const std::uint8_t* bytes, std::size_t size, void* /*self*/) {
  // The connection's window opens at once: what bounds memory is the stream's.
  nghttp2_session_consume_connection(session, size);
  if (Http2Stream* stream = StreamOf(session, id)) {
    stream->OnData(ViewOf(bytes, size));
  } else {
    nghttp2_session_consume_stream(session, id, size);
  }
  return 0;
}

int OnStreamClose(nghttp2_session* session, std::int32_t id, std::uint32_t /*code*/,
                  void* /*self*/) {
  if (Http2Stream* stream = StreamOf(session, id)) {
    nghttp2_session_set_stream_user_data(session, id, nullptr);
    stream->OnClosed();
  }
  return 0;
}

int OnFrameSent(nghttp2_session* session, const nghttp2_frame* frame, void* self) {
  if (IsAnswer(frame->hd)) Self(self).OnAnswerSent();
  if (frame->hd.type == NGHTTP2_RST_STREAM && IsFault(frame->rst_stream.error_code)) {
    Self(self).peer().OnStreamFault(nghttp2_http2_strerror(frame->rst_stream.error_code));
  }
  if (frame->hd.type == NGHTTP2_GOAWAY && frame->goaway.error_code != NGHTTP2_NO_ERROR) {
    // For most rules the library ends the session itself, and Receive does not fail.
    Self(self).peer().OnFault();
  }
  if (frame->hd.type != NGHTTP2_HEADERS && frame->hd.type != NGHTTP2_DATA) return 0;
  Self(self).peer().OnSent();
  if (EndsStream(frame->hd) &&
      nghttp2_session_get_stream_remote_close(session, frame->hd.stream_id) == 0) {
    // The answer is complete, and the peer still sends: it may stop.
    nghttp2_submit_rst_stream(session, NGHTTP2_FLAG_NONE, frame->hd.stream_id, NGHTTP2_NO_ERROR);
  }
  return 0;
}

ssize_t ReadBody(nghttp2_session* /*session*/, std::int32_t /*id*/, std::uint8_t* into,
                 std::size_t size, std::uint32_t* flags, nghttp2_data_source* source,
                 void* /*self*/) {
  auto* stream = static_cast<Http2Stream*>(source->ptr);
  const Http2Stream::Body body = stream->OnBody(reinterpret_cast<char*>(into), size);
  if (body.state == Http2Stream::Body::State::kWait && body.bytes == 0) return NGHTTP2_ERR_DEFERRED;
  if (body.state == Http2Stream::Body::State::kEnd) {
    *flags |= NGHTTP2_DATA_FLAG_EOF | NGHTTP2_DATA_FLAG_NO_END_STREAM;
    stream->OnBodyEnd();
  }
  return static_cast<ssize_t>(body.bytes);
}

/// nghttp2 copies name and value; its pointers are not const, but it does not change them.
std::vector<nghttp2_nv> Fields(const Headers& headers) {
  const auto bytes = [](std::string_view text) {
    return reinterpret_cast<std::uint8_t*>(const_cast<char*>(text.data()));
  };
  std::vector<nghttp2_nv> fields;
  fields.reserve(headers.size());
  for (const auto& [name, value] : headers) {
    fields.push_back({bytes(name), bytes(value), name.size(), value.size(), NGHTTP2_NV_FLAG_NONE});
  }
  return fields;
}

/// Our calls of the library fail only without memory, or for a stream that is gone.
void Done(int result) { UPLINK_CHECK(result != NGHTTP2_ERR_NOMEM, "out of memory"); }

}  // namespace

Http2Rules::Http2Rules() {
  Done(nghttp2_session_callbacks_new(&callbacks_));
  nghttp2_session_callbacks_set_on_begin_frame_callback(callbacks_, OnBeginFrame);
  nghttp2_session_callbacks_set_on_begin_headers_callback(callbacks_, OnBeginHeaders);
  nghttp2_session_callbacks_set_on_header_callback(callbacks_, OnHeader);
  nghttp2_session_callbacks_set_on_frame_recv_callback(callbacks_, OnFrameReceived);
  nghttp2_session_callbacks_set_on_data_chunk_recv_callback(callbacks_, OnDataChunk);
  nghttp2_session_callbacks_set_on_stream_close_callback(callbacks_, OnStreamClose);
  nghttp2_session_callbacks_set_on_frame_send_callback(callbacks_, OnFrameSent);
  Done(nghttp2_option_new(&options_));
  nghttp2_option_set_no_auto_window_update(options_, 1);
  // Closed streams would stay, as many as may be open: of a drone, whose calls are a stream each.
  nghttp2_option_set_no_closed_streams(options_, 1);
  // Connection counts answers once what it read at once is processed, and sends them first.
  nghttp2_option_set_max_outbound_ack(options_, kAnswersWaitingMax + kAnswersPerRecordMax);
  // FrameRates bounds resets, by the streams that a connection may have.
  nghttp2_option_set_stream_reset_rate_limit(options_, kNoLibraryLimit, kNoLibraryLimit);
  // Without this the library skips frames of unknown types without calling OnBeginFrame.
  nghttp2_session_callbacks_set_unpack_extension_callback(callbacks_, OnExtension);
  for (unsigned type = NGHTTP2_CONTINUATION + 1; type <= 0xFF; ++type) {
    nghttp2_option_set_user_recv_extension_type(options_, static_cast<std::uint8_t>(type));
  }
}

Http2Rules::~Http2Rules() {
  nghttp2_option_del(options_);
  nghttp2_session_callbacks_del(callbacks_);
}

Http2::Http2(const Http2Rules& rules, Http2Memory& memory, Http2Peer& peer,
             std::uint32_t streams_max)
    : peer_(peer) {
  nghttp2_mem functions = memory.functions();
  Done(
      nghttp2_session_server_new3(&session_, rules.callbacks(), this, rules.options(), &functions));
  const std::array<nghttp2_settings_entry, 2> settings = {
      {{NGHTTP2_SETTINGS_MAX_CONCURRENT_STREAMS, streams_max},
       {NGHTTP2_SETTINGS_MAX_HEADER_LIST_SIZE, kHeaderBytesMax}}};
  Done(nghttp2_submit_settings(session_, NGHTTP2_FLAG_NONE, settings.data(), settings.size()));
  Done(nghttp2_session_set_local_window_size(session_, NGHTTP2_FLAG_NONE, 0,
                                             kConnectionWindowBytes));
}

Http2::~Http2() { nghttp2_session_del(session_); }

bool Http2::CountHeader(std::size_t bytes) {
  header_bytes_ += bytes + kHeaderOverheadBytes;
  if (header_bytes_ <= kHeaderBombBytes) return true;
  peer_.OnHeaderBomb();
  return false;
}

bool Http2::Receive(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::string_view part = frame_heads_.TakePart(bytes);
    if (frame_heads_.sent_past_end()) {
      End(NGHTTP2_STREAM_CLOSED, "");
      return false;
    }
    const ssize_t taken = nghttp2_session_mem_recv(
        session_, reinterpret_cast<const std::uint8_t*>(part.data()), part.size());
    if (taken >= 0) continue;
    Done(static_cast<int>(taken));
    const bool floods = taken == NGHTTP2_ERR_FLOODED;
    End(floods ? NGHTTP2_ENHANCE_YOUR_CALM : NGHTTP2_PROTOCOL_ERROR, floods ? kFloodedText : "");
    return false;
  }
  return true;
}

void Http2::Gather(std::string& into, std::size_t bytes) {
  into.clear();
  while (into.size() < bytes) {
    const std::uint8_t* next = nullptr;
    const ssize_t size = nghttp2_session_mem_send(session_, &next);
    Done(static_cast<int>(std::min<ssize_t>(size, 0)));
    if (size <= 0) return;
    into.append(ViewOf(next, static_cast<std::size_t>(size)));
  }
}

bool Http2::over() const {
  return nghttp2_session_want_read(session_) == 0 && nghttp2_session_want_write(session_) == 0;
}

void Http2::Respond(std::int32_t stream, const Headers& headers, Then then) {
  const std::vector<nghttp2_nv> fields = Fields(headers);
  nghttp2_data_provider body{};
  body.source.ptr = StreamOf(session_, stream);
  body.read_callback = ReadBody;
  Done(nghttp2_submit_response(session_, stream, fields.data(), fields.size(),
                               then == Then::kBody ? &body : nullptr));
}

void Http2::Resume(std::int32_t stream) { Done(nghttp2_session_resume_data(session_, stream)); }

void Http2::Trailers(std::int32_t stream, const Headers& headers) {
  const std::vector<nghttp2_nv> fields = Fields(headers);
  Done(nghttp2_submit_trailer(session_, stream, fields.data(), fields.size()));
}

void Http2::Reset(std::int32_t stream, std::uint32_t code) {
  Done(nghttp2_submit_rst_stream(session_, NGHTTP2_FLAG_NONE, stream, code));
}

void Http2::ConsumeStream(std::int32_t stream, std::size_t bytes) {
  Done(nghttp2_session_consume_stream(session_, stream, bytes));
}

void Http2::Ping() {
  ++pings_open_;
  Done(nghttp2_submit_ping(session_, NGHTTP2_FLAG_NONE, nullptr));
}

bool Http2::TakePong() {
  if (pings_open_ == 0) return false;
  --pings_open_;
  return true;
}

void Http2::NoticeEnd() { Done(nghttp2_submit_shutdown_notice(session_)); }

void Http2::End(std::uint32_t code, std::string_view text) {
  if (!text.empty()) {
    // The library's own, which ends the session, carries no text.
    const std::int32_t last = nghttp2_session_get_last_proc_stream_id(session_);
    Done(nghttp2_submit_goaway(session_, NGHTTP2_FLAG_NONE, last, code,
                               reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  }
  Done(nghttp2_session_terminate_session(session_, code));
}

}  // namespace uplink::front
