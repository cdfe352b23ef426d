// What whole pictures would take on a connection of their own, however they are coded: for comparison with the rows
// that are sent.
#pragma once
#include "accuracy/network/row_stream.h"

namespace pocketray {

struct CountedStream {
  RowStream stream;
  double bytes = 0;    // of all pictures
  double squares = 0;  // squared error of a channel, in levels of the format, summed over the pictures' means
};

struct RowStreams {
  CountedStream first;           // each picture as the first of a connection
  CountedStream lossless, near;  // one picture after the other
  std::uint32_t picture_count = 0;
};

void open_row_streams(const CodecShape& shape, RowStreams* streams);
// Sends a picture of unpadded rows. The first one counts for `first` alone, as it is no change from another.
void send_picture(RowStreams* streams, const std::uint8_t* pixels, RowCoding coding);

}  // namespace pocketray
