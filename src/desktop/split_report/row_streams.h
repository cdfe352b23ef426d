// Size of whole pictures on a connection of their own, coded in every way:
// for comparison with the rows that are sent.
#pragma once
#include "desktop/accuracy/network/row_stream.h"

namespace pocketray {

struct CountedStream {
  RowStream stream;
  double bytes = 0;    // of all pictures
  double squares = 0;  // squared error per channel, in levels of the format, summed over the pictures' means
};

struct RowStreams {
  CountedStream first;           // each picture as a connection's first
  CountedStream lossless, near;  // successive pictures
  std::uint32_t picture_count = 0;
};

void open_row_streams(const CodecShape& shape, RowStreams* streams);
// Sends a picture of unpadded rows. The first one counts only for `first`, as it changes no other.
void send_picture(RowStreams* streams, const std::uint8_t* pixels, RowCoding coding);

}  // namespace pocketray
