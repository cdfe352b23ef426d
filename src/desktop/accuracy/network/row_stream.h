// Pictures as shown by a device whose rows come from a render server, and their bytes on the wire: through both ends of
// the codec. Without a link: no messages, no losses.
#pragma once
#include <vector>

#include "wire/codec.h"

namespace pocketray {

struct RowStream {
  std::vector<unsigned char> memory;
  std::vector<std::uint8_t> chunk;
  RowEncoder* encoder = nullptr;
  RowDecoder* decoder = nullptr;
  std::uint32_t picture_count = 0;
};

void open_row_stream(const CodecShape& shape, RowStream* stream);
// Treats the next picture as the first of a connection.
void restart_row_stream(RowStream* stream);
// Sends a picture of unpadded rows, in chunks from the bottom upward, as servers do. Returns the bytes of its rows,
// excluding message overhead.
std::size_t send_picture(RowStream* stream, const std::uint8_t* pixels, RowCoding coding);
// Returns a row of the picture that the device shows.
const std::uint8_t* shown_row(const RowStream& stream, std::uint32_t row);

}  // namespace pocketray
