// Pictures as a device shows them whose rows come from a render server, and their bytes on the way: through both ends
// of the codec. Without a link: no messages, no losses.
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
// The next picture is the first of a connection.
void restart_row_stream(RowStream* stream);
// Sends a picture of unpadded rows, in chunks from the bottom upward, as servers do. Returns the bytes of its rows,
// without those of messages around them.
std::size_t send_picture(RowStream* stream, const std::uint8_t* pixels, RowCoding coding);
// A row of the picture that the device shows.
const std::uint8_t* shown_row(const RowStream& stream, std::uint32_t row);

}  // namespace pocketray
