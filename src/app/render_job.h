// The work of `pocketray render`, and one frame of it.
#pragma once
#include "app/coherent_sequence.h"
#include "app/render_options.h"
#include "budget/budget.h"
#include "session/aov_picture.h"
#include "session/camera_control.h"
#include "session/nothing_picture.h"
#include "session/progress.h"
#include "session/resume.h"

namespace pocketray {

struct RenderJob {
  RenderOptions options;
  RenderRequest asked;
  Servers* servers = nullptr;
  Budget* budget = nullptr;
  CoherentSequence* coherent = nullptr;  // null: frames are traced whole
  std::uint8_t* page = nullptr;          // the packed frame, for --budget-ms: packing is part of the frame time
  CameraControl camera;                  // for --orbit and --turntable
  const SceneSource* source = nullptr;
  AnimationFile* animation = nullptr;  // null: a file per picture
  Array<Span> crop_spans;              // empty: the whole picture is traced
  FrameJournal* journal = nullptr;     // null: none is kept
  std::vector<bool> is_finished;       // by an earlier run; in frame order, empty: none
};

// Results so far. Rendering a frame allocates nothing.
struct RenderedFiles {
  Progress progress;
  std::uint64_t rows_before = 0;  // of frames that the progress has already counted
  PictureOptions picture;
  AovPicture shown;
  std::uint32_t written = 0;
  double trace_ms = 0;               // over all frames
  char black[kBlackTextBytes] = "";  // why the first picture is black or shows nothing; empty: neither
};

// Renders a frame and writes it to its file, or adds it to the animation. An interrupt leaves *complete false and no
// file.
Status render_file(Renderer* renderer, const RenderJob& job, std::uint32_t frame, RenderedFiles* files, bool* complete);

}  // namespace pocketray
