#include "remote/cluster/pieces.h"

#include <algorithm>

#include "base/check.h"
#include "engine/shared_rows.h"

namespace pocketray {
namespace {

struct PieceSource {
  Renderer* renderer;
  RowPiece piece;
  std::uint32_t traced = 0;
};

// Takes as many rows at once as can be listed, from the lowest up.
void next_rows(void* context, SpanBatch* batch) {
  PieceSource* source = static_cast<PieceSource*>(context);
  RowPiece* left = &source->piece;
  SharedSpans spans;
  if (left->column_end - left->column_begin < source->renderer->settings.width) {
    spans = list_part(source->renderer, left->row_begin, left->column_begin, left->column_end);
    left->row_end = left->row_begin;
  } else {
    const std::uint32_t rows = std::min(left->row_end - left->row_begin, listed_rows_max(*source->renderer));
    spans = list_rows(source->renderer, left->row_end - rows, left->row_end);
    left->row_end -= rows;
  }
  source->traced += static_cast<std::uint32_t>(span_pixel_count(spans.spans, spans.count));
  batch->spans = spans.spans, batch->span_count = spans.count;
}

bool rows_finished(void* context, const SpanBatch&) {
  const PieceSource* source = static_cast<PieceSource*>(context);
  return source->piece.row_begin == source->piece.row_end;
}

}  // namespace

std::uint32_t trace_piece(Session* session, const RowPiece& piece, std::uint32_t* row_pixels) {
  CHECK(has_job(*session) && session->job.stage == JobStage::rows && row_pixels != nullptr);
  Renderer* renderer = &session->renderer;
  const Settings& settings = renderer->settings;
  CHECK(piece.row_begin < piece.row_end && piece.row_end <= settings.height);
  CHECK(piece.column_begin < piece.column_end && piece.column_end <= settings.width);
  PieceSource source = {renderer, piece};
  SpanSource spans = {&source, next_rows, rows_finished};
  trace_frame(renderer, spans);
  if (piece.column_end < settings.width) return source.traced;
  for (std::uint32_t row = piece.row_begin; row < piece.row_end; ++row)
    row_pixels[row - piece.row_begin] = count_pixels(*renderer, row);
  finish_shared_rows(renderer, piece.row_begin, piece.row_end);
  pack_session_rows(session, piece.row_begin, piece.row_end);
  return source.traced;
}

}  // namespace pocketray
