#include "platform/net/tls/tls_stream.h"

#include <cstdio>
#include <cstring>

#include "platform/check.h"

namespace platform {
namespace {

constexpr int kSuites[] = {MBEDTLS_TLS_ECDHE_PSK_WITH_CHACHA20_POLY1305_SHA256, 0};
constexpr mbedtls_ecp_group_id kCurves[] = {MBEDTLS_ECP_DP_CURVE25519, MBEDTLS_ECP_DP_NONE};

// Our own codes, outside the library's ranges.
constexpr int kLinkFailed = -0x7F01, kNotTls = -0x7F02, kNoRandom = -0x7F03;

// A fatal alert, unexpected_message, as the library does not yet know which version to send it in.
constexpr unsigned char kPlainAlert[] = {21, 3, 3, 0, 2, 2, 10};

// Types of records [RFC 5246, sec. 6.2.1]: change_cipher_spec, alert, handshake, application_data.
bool is_record_type(unsigned char byte) { return byte >= 20 && byte <= 23; }

int fill_random(void* config, unsigned char* bytes, std::size_t byte_count) {
  return static_cast<TlsConfig*>(config)->random(bytes, byte_count) ? 0 : kNoRandom;
}

int send_below(void* context, const unsigned char* bytes, std::size_t byte_count) {
  auto* tls = static_cast<TlsStream*>(context);
  std::size_t count = 0;
  LinkResult result = tls->below->backend->write(tls->below, tls->stream, bytes, byte_count, &count, &tls->error);
  PLATFORM_CHECK_LE(count, byte_count);
  if (result == LinkResult::later) return MBEDTLS_ERR_SSL_WANT_WRITE;
  return result == LinkResult::done ? static_cast<int>(count) : kLinkFailed;
}

int receive_below(void* context, unsigned char* bytes, std::size_t byte_count) {
  auto* tls = static_cast<TlsStream*>(context);
  std::size_t count = 0;
  LinkResult result = tls->below->backend->read(tls->below, tls->stream, bytes, byte_count, &count, &tls->error);
  PLATFORM_CHECK_LE(count, byte_count);
  if (result == LinkResult::later) return MBEDTLS_ERR_SSL_WANT_READ;
  if (result == LinkResult::ended) return 0;
  if (result == LinkResult::failed) return kLinkFailed;
  if (!tls->has_read && !is_record_type(bytes[0])) return kNotTls;
  tls->has_read = true;
  return static_cast<int>(count);
}

// Alerts [RFC 5246, sec. 7.2] that indicate a different key; unknown_psk_identity is in RFC 4279, sec. 2.
bool tells_of_key(int alert) {
  return alert == MBEDTLS_SSL_ALERT_MSG_BAD_RECORD_MAC || alert == MBEDTLS_SSL_ALERT_MSG_DECRYPT_ERROR ||
         alert == MBEDTLS_SSL_ALERT_MSG_UNKNOWN_PSK_IDENTITY;
}

TlsFault fault_of(const TlsStream& tls, int code) {
  const bool greets = tls.ssl.state != MBEDTLS_SSL_HANDSHAKE_OVER;
  if (tls.heap.refused) return TlsFault::memory;
  switch (code) {
    case kLinkFailed:
    case MBEDTLS_ERR_SSL_CONN_EOF:
      return TlsFault::link;
    case kNotTls:
      return TlsFault::plain;
    case kNoRandom:
      return TlsFault::random;
    case MBEDTLS_ERR_SSL_INVALID_MAC:
    case MBEDTLS_ERR_SSL_UNKNOWN_IDENTITY:
    case MBEDTLS_ERR_SSL_BAD_HS_FINISHED:
      return greets ? TlsFault::wrong_key : TlsFault::broken;
    case MBEDTLS_ERR_SSL_FATAL_ALERT_MESSAGE:  // the alert's number is the second byte of its message
      if (greets) return tells_of_key(tls.ssl.in_msg[1]) ? TlsFault::wrong_key : TlsFault::refused;
      return TlsFault::broken;
    case MBEDTLS_ERR_SSL_NO_CIPHER_CHOSEN:
    case MBEDTLS_ERR_SSL_BAD_HS_PROTOCOL_VERSION:
      return TlsFault::refused;
    default:
      return TlsFault::broken;
  }
}

// Converts a result of the library: `later`, or the fault.
LinkResult result_of(TlsStream* tls, int code) {
  PLATFORM_CHECK_LE(code, 0);
  tls->wants_write = code == MBEDTLS_ERR_SSL_WANT_WRITE;
  if (tls->wants_write || code == MBEDTLS_ERR_SSL_WANT_READ) return LinkResult::later;
  if (code == MBEDTLS_ERR_SSL_PEER_CLOSE_NOTIFY && tls->ssl.state == MBEDTLS_SSL_HANDSHAKE_OVER)
    return LinkResult::ended;
  tls->fault = fault_of(*tls, code);
  tls->code = code;
  // From this answer, a program without a key can tell what it lacks.
  if (tls->fault == TlsFault::plain) (void)send_below(tls, kPlainAlert, sizeof kPlainAlert);
  return LinkResult::failed;
}

bool start_side(mbedtls_ssl_config* side, int endpoint, const SharedKey& key, TlsConfig* config) {
  mbedtls_ssl_config_init(side);
  if (mbedtls_ssl_config_defaults(side, endpoint, MBEDTLS_SSL_TRANSPORT_STREAM, MBEDTLS_SSL_PRESET_DEFAULT) != 0)
    return false;
  mbedtls_ssl_conf_rng(side, fill_random, config);
  mbedtls_ssl_conf_min_version(side, MBEDTLS_SSL_MAJOR_VERSION_3, MBEDTLS_SSL_MINOR_VERSION_3);
  mbedtls_ssl_conf_max_version(side, MBEDTLS_SSL_MAJOR_VERSION_3, MBEDTLS_SSL_MINOR_VERSION_3);
  mbedtls_ssl_conf_authmode(side, MBEDTLS_SSL_VERIFY_NONE);  // no certificates: both have the key
  mbedtls_ssl_conf_ciphersuites(side, kSuites);
  mbedtls_ssl_conf_curves(side, kCurves);
#ifdef MBEDTLS_SSL_SESSION_TICKETS
  mbedtls_ssl_conf_session_tickets(side, MBEDTLS_SSL_SESSION_TICKETS_DISABLED);
#endif
  return mbedtls_ssl_conf_psk(side, key.bytes, sizeof key.bytes, reinterpret_cast<const unsigned char*>(kTlsIdentity),
                              sizeof kTlsIdentity - 1) == 0;
}

}  // namespace

bool tls_config_start(TlsConfig* config, const SharedKey& key, bool (*random)(void*, std::size_t), void* memory,
                      Error* error) {
  PLATFORM_CHECK(config != nullptr && random != nullptr);
  config->heap = make_tls_heap(memory, kTlsConfigHeapBytes);
  config->random = random;
  TlsHeapUse use(&config->heap);
  bool client = start_side(&config->client, MBEDTLS_SSL_IS_CLIENT, key, config);
  bool server = start_side(&config->server, MBEDTLS_SSL_IS_SERVER, key, config);
  if (client && server) return true;
  std::snprintf(error->text, sizeof error->text, "TLS needs more memory than was planned, or lacks its cipher");
  tls_config_end(config);
  return false;
}

void tls_config_end(TlsConfig* config) {
  TlsHeapUse use(&config->heap);
  mbedtls_ssl_config_free(&config->client);
  mbedtls_ssl_config_free(&config->server);
  PLATFORM_CHECK_EQ(config->heap.used, std::size_t(0));
}

bool tls_begin(TlsStream* tls, TlsConfig* config, bool as_server, Link* below, int stream, void* memory,
               std::size_t byte_count) {
  PLATFORM_CHECK(config != nullptr && below != nullptr && stream >= 0);
  *tls = TlsStream();
  tls->heap = make_tls_heap(memory, byte_count);
  tls->below = below, tls->stream = stream, tls->config = config;
  TlsHeapUse use(&tls->heap);
  mbedtls_ssl_init(&tls->ssl);
  int code = mbedtls_ssl_setup(&tls->ssl, as_server ? &config->server : &config->client);
  if (code != 0) return (void)result_of(tls, code), false;
  mbedtls_ssl_set_bio(&tls->ssl, tls, send_below, receive_below, nullptr);
  return true;
}

LinkResult tls_handshake(TlsStream* tls) {
  PLATFORM_CHECK(tls->fault == TlsFault::none);
  TlsHeapUse use(&tls->heap);
  int code = mbedtls_ssl_handshake(&tls->ssl);
  return code == 0 ? LinkResult::done : result_of(tls, code);
}

LinkResult tls_read(TlsStream* tls, void* bytes, std::size_t byte_count_max, std::size_t* byte_count) {
  PLATFORM_CHECK(tls->fault == TlsFault::none && byte_count_max > 0);
  TlsHeapUse use(&tls->heap);
  *byte_count = 0;
  int count = mbedtls_ssl_read(&tls->ssl, static_cast<unsigned char*>(bytes), byte_count_max);
  if (count == 0) count = MBEDTLS_ERR_SSL_CONN_EOF;
  if (count < 0) return result_of(tls, count);
  *byte_count = static_cast<std::size_t>(count);
  PLATFORM_CHECK_LE(*byte_count, byte_count_max);
  return LinkResult::done;
}

LinkResult tls_flush(TlsStream* tls) {
  if (!tls_keeps_output(*tls)) return LinkResult::done;
  PLATFORM_CHECK(tls->fault == TlsFault::none);
  TlsHeapUse use(&tls->heap);
  int code = mbedtls_ssl_write(&tls->ssl, nullptr, 0);  // takes no bytes while some are kept
  return code < 0 ? result_of(tls, code) : LinkResult::done;
}

LinkResult tls_write(TlsStream* tls, const void* bytes, std::size_t byte_count_max, std::size_t* byte_count) {
  PLATFORM_CHECK(tls->fault == TlsFault::none);
  *byte_count = 0;
  LinkResult flushed = tls_flush(tls);
  if (flushed != LinkResult::done) return flushed;
  TlsHeapUse use(&tls->heap);
  auto* from = static_cast<const unsigned char*>(bytes);
  while (*byte_count < byte_count_max && !tls_keeps_output(*tls)) {
    std::size_t rest = byte_count_max - *byte_count, take = rest < kTlsRecordBytes ? rest : kTlsRecordBytes;
    int code = mbedtls_ssl_write(&tls->ssl, from + *byte_count, take);
    // Without room below, the record is created and kept all the same.
    if (code == MBEDTLS_ERR_SSL_WANT_WRITE) {
      PLATFORM_CHECK(tls_keeps_output(*tls));
    } else if (code <= 0) {
      return result_of(tls, code);
    }
    *byte_count += take;
  }
  return *byte_count > 0 ? LinkResult::done : LinkResult::later;
}

bool tls_has_input(const TlsStream& tls) { return mbedtls_ssl_check_pending(&tls.ssl) != 0; }

LinkResult tls_farewell(TlsStream* tls) {
  PLATFORM_CHECK(tls->fault == TlsFault::none);
  LinkResult flushed = tls_flush(tls);
  if (flushed != LinkResult::done || tls->said_farewell) return flushed;
  TlsHeapUse use(&tls->heap);
  tls->said_farewell = true;
  int code = mbedtls_ssl_close_notify(&tls->ssl);
  return code == 0 ? LinkResult::done : result_of(tls, code);
}

void tls_end(TlsStream* tls) {
  TlsHeapUse use(&tls->heap);
  mbedtls_ssl_free(&tls->ssl);
  PLATFORM_CHECK_EQ(tls->heap.used, std::size_t(0));
}

void tls_tell(const TlsStream& tls, const char* peer, Error* error) {
  const char* what = nullptr;
  switch (tls.fault) {
    case TlsFault::link:
      if (tls.code != MBEDTLS_ERR_SSL_CONN_EOF) {
        *error = tls.error;
        return;
      }
      what = "the peer closed the connection: it was stopped, or rejected what it received";
      break;
    case TlsFault::plain:
      what = "it does not use TLS: give it the key, too, or use none here (--key)";
      break;
    case TlsFault::wrong_key:
      what = "its key differs: copy the same key file to both sides (--key)";
      break;
    case TlsFault::refused:
      what = "it offers no TLS with this cipher and a shared key: update one of the two";
      break;
    case TlsFault::memory:
      what = "its handshake needs more memory than was planned: update one of the two";
      break;
    case TlsFault::random:
      what = "this system has no random bytes yet: try again later";
      break;
    case TlsFault::none:
    case TlsFault::broken:
      break;
  }
  if (what) {
    std::snprintf(error->text, sizeof error->text, "%.95s: %s", peer, what);
  } else {
    std::snprintf(error->text, sizeof error->text, "%.95s: it sent bytes that TLS does not allow (-0x%04X)", peer,
                  static_cast<unsigned>(-tls.code));
  }
}

}  // namespace platform
