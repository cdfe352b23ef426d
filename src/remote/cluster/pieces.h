// Traces and packs the pieces of a request assigned to a rank.
#pragma once
#include "remote/cluster/row_share.h"
#include "remote/server/session.h"

namespace pocketray {

// Traces a piece of the session's job, at stage `rows`; pieces of one row come from left to right. Returns how many of
// its pixels had to be traced. Once the rows are complete, keeps them for the next frame, writes the number of pixels
// traced per row to row_pixels, and packs them in the session's picture.
std::uint32_t trace_piece(Session* session, const RowPiece& piece, std::uint32_t* row_pixels);

inline std::uint32_t line_bytes(const Session& session) {
  return session.shape.width * pixel_bytes(session.shape.format);
}
inline std::uint8_t* packed_rows(const Session& session, std::uint32_t row) {
  return session.pixels.data + std::size_t(row) * line_bytes(session);
}

}  // namespace pocketray
