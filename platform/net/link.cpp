#include <cstdio>
#include <cstring>

#include "platform/check.h"

#include "platform/link.h"

namespace platform {

bool link_parse_address(const char* text, char* host, std::size_t host_bytes, int* port, Error* error) {
  // 1. The last colon separates host and port, unless the host contains colons itself and is in brackets.
  PLATFORM_CHECK(text != nullptr && port != nullptr);
  PLATFORM_CHECK_GE(host_bytes, sizeof "127.0.0.1");
  const char *host_begin = text, *host_end = text, *digits = text;
  if (text[0] == '[') {
    host_begin = text + 1;
    host_end = std::strchr(text, ']');
    if (!host_end || host_end[1] != ':') {
      std::snprintf(error->text, sizeof error->text, "'%.80s' is not an address: write it as [HOST]:PORT", text);
      return false;
    }
    digits = host_end + 2;
  } else if (const char* colon = std::strchr(text, ':')) {
    if (std::strchr(colon + 1, ':')) {
      std::snprintf(error->text, sizeof error->text, "'%.80s' has several colons: write an IPv6 address as [HOST]:PORT",
                    text);
      return false;
    }
    host_end = colon;
    digits = colon + 1;
  }

  // 2. The port, in at most five digits.
  int value = 0;
  std::size_t digit_count = std::strspn(digits, "0123456789");
  if (digit_count <= 5)
    for (std::size_t i = 0; i < digit_count; ++i) value = value * 10 + (digits[i] - '0');
  if (digit_count == 0 || digit_count > 5 || digits[digit_count] || value > 65535) {
    std::snprintf(error->text, sizeof error->text, "'%.80s' has no port from 0 to 65535: write it as HOST:PORT", text);
    return false;
  }
  *port = value;

  // 3. The host; none means this machine, invisible to others.
  std::size_t length = static_cast<std::size_t>(host_end - host_begin);
  if (length >= host_bytes) {
    std::snprintf(error->text, sizeof error->text, "'%.80s…' is too long for a host name: check it", text);
    return false;
  }
  std::memcpy(host, host_begin, length);
  host[length] = 0;
  if (length == 0) std::snprintf(host, host_bytes, "127.0.0.1");
  return true;
}

}  // namespace platform
