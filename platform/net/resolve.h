// Addresses of TCP links: conversion between text and the system's form.
#pragma once
#include <netinet/in.h>
#include <sys/socket.h>

#include "platform/link.h"

namespace platform {

// A place of a LinkAddress in the system's form.
union SocketAddress {
  sockaddr any;
  sockaddr_in v4;
  sockaddr_in6 v6;
};
static_assert(sizeof(SocketAddress) <= sizeof LinkAddress().places[0], "");

SocketAddress socket_address(const LinkAddress& address, int place);
inline socklen_t socket_address_bytes(const SocketAddress& at) {
  return at.any.sa_family == AF_INET6 ? sizeof at.v6 : sizeof at.v4;
}
// "HOST:PORT" in numbers.
void socket_address_text(const SocketAddress& at, char* text, std::size_t text_bytes);

bool resolve_address(const char* text, LinkAddress* address, Error* error);

}  // namespace platform
