#include "platform/net/resolve.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <stdio.h>
#include <string.h>

#include "platform/check.h"

namespace platform {
namespace {

bool is_loopback(const SocketAddress& at) {
  if (at.any.sa_family == AF_INET6) return IN6_IS_ADDR_LOOPBACK(&at.v6.sin6_addr);
  return ntohl(at.v4.sin_addr.s_addr) >> 24 == 127;
}

void add_place(LinkAddress* address, const SocketAddress& at) {
  if (address->place_count == LinkAddress::kPlacesMax) return;
  if (!is_loopback(at)) address->loopback = false;
  memcpy(address->places[address->place_count++], &at, sizeof at);
}

bool add_number(LinkAddress* address, const char* host, int port) {
  SocketAddress at = {};
  if (inet_pton(AF_INET, host, &at.v4.sin_addr) == 1) {
    at.v4.sin_family = AF_INET;
    at.v4.sin_port = htons(static_cast<uint16_t>(port));
  } else if (inet_pton(AF_INET6, host, &at.v6.sin6_addr) == 1) {
    at.v6.sin6_family = AF_INET6;
    at.v6.sin6_port = htons(static_cast<uint16_t>(port));
  } else {
    return false;
  }
  add_place(address, at);
  return true;
}

#ifdef POCKETRAY_NUMERIC_ADDRESSES
// The C library loads its resolver at run time, which a static program cannot rely on.
bool add_name(LinkAddress*, const char* host, int port, Error* error) {
  snprintf(error->text, sizeof error->text,
           "this build cannot resolve names: give the numeric address of '%.64s', as in 192.168.1.2:%d", host, port);
  return false;
}
#else
bool add_name(LinkAddress* address, const char* host, int port, Error* error) {
  addrinfo hints = {}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  int outcome = getaddrinfo(host, nullptr, &hints, &found);
  if (outcome == EAI_AGAIN) {
    snprintf(error->text, sizeof error->text,
             "no name server answers for '%.64s': is the network up? A numeric address needs none", host);
    return false;
  }
  for (addrinfo* i = outcome == 0 ? found : nullptr; i; i = i->ai_next) {
    if ((i->ai_family != AF_INET && i->ai_family != AF_INET6) || i->ai_addrlen > sizeof(SocketAddress)) continue;
    SocketAddress at = {};
    memcpy(&at, i->ai_addr, i->ai_addrlen);
    (i->ai_family == AF_INET ? at.v4.sin_port : at.v6.sin6_port) = htons(static_cast<uint16_t>(port));
    add_place(address, at);
  }
  if (outcome == 0) freeaddrinfo(found);
  if (address->place_count == 0)
    snprintf(error->text, sizeof error->text, "host '%.64s' is unknown: check the name, or give a numeric address",
             host);
  return address->place_count > 0;
}
#endif

}  // namespace

SocketAddress socket_address(const LinkAddress& address, int place) {
  PLATFORM_CHECK(place >= 0 && place < LinkAddress::kPlacesMax);
  SocketAddress at;
  memcpy(&at, address.places[place], sizeof at);
  return at;
}

void socket_address_text(const SocketAddress& at, char* text, std::size_t text_bytes) {
  char number[INET6_ADDRSTRLEN] = "?";
  if (at.any.sa_family == AF_INET6) {
    inet_ntop(AF_INET6, &at.v6.sin6_addr, number, sizeof number);
    snprintf(text, text_bytes, "[%s]:%d", number, ntohs(at.v6.sin6_port));
  } else {
    inet_ntop(AF_INET, &at.v4.sin_addr, number, sizeof number);
    snprintf(text, text_bytes, "%s:%d", number, ntohs(at.v4.sin_port));
  }
}

bool resolve_address(const char* text, LinkAddress* address, Error* error) {
  PLATFORM_CHECK(text != nullptr && address != nullptr && error != nullptr);
  *address = LinkAddress();
  address->loopback = true;
  snprintf(address->text, sizeof address->text, "%s", text);
  char host[256];
  int port;
  if (!link_parse_address(text, host, sizeof host, &port, error)) return false;
  if (add_number(address, host, port)) return true;
  if (strcmp(host, "localhost") == 0) return add_number(address, "127.0.0.1", port) && add_number(address, "::1", port);
  return add_name(address, host, port, error);
}

}  // namespace platform
