// progressive_cost SCENE whole|first|refined : prepares a frame of a built-in scene at 320 x 240, then renders it
// whole, or coarse first up to the first picture or to the end, in trace_for_counting(). Prints the picture's hash.
// progressive_cost_test.sh counts the instructions of that function with valgrind.
#include <cstdio>
#include <cstring>

#include "engine/frame.h"
#include "engine/progressive.h"
#include "engine/span_list.h"
#include "engine/trace_frame.h"
#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"

using namespace pocketray;

extern "C" [[gnu::noinline]] void trace_for_counting(Renderer* renderer, const char* what, Array<Span> spans) {
  if (std::strcmp(what, "whole") == 0) {
    SpanList list = whole_frame(renderer);
    trace_frame(renderer, list_source(&list));
    return;
  }
  const bool first = std::strcmp(what, "first") == 0;
  Progressive progressive;
  while (!(first && progressive.shown_coarse) && !advance_progressive(renderer, spans, 0, &progressive)) {
  }
}

int main(int argument_count, char** arguments) {
  if (argument_count != 3) return std::fprintf(stderr, "usage: %s SCENE whole|first|refined\n", arguments[0]), 2;
  auto built = build_builtin(arguments[1]);
  Settings settings;
  auto test = make_renderer(built->scene, settings);
  Renderer* renderer = &test->renderer;
  if (!begin_frame(renderer, {0.5}).ok) return 1;
  std::vector<Span> spans(progressive_spans_max(settings));
  trace_for_counting(renderer, arguments[2], {spans.data(), static_cast<std::uint32_t>(spans.size())});
  std::printf("picture %08x\n", picture_hash(renderer->image.data, renderer->image.count));
  return 0;
}
