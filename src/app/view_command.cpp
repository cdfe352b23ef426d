// pocketray view: the scene on a screen, moved by buttons. Coarse first, then refined; input never waits.
#include <chrono>
#include <thread>

#include "app/budget.h"
#include "app/commands.h"
#include "app/interrupt.h"
#include "app/options.h"
#include "app/report.h"
#include "app/sharing.h"
#include "app/viewer.h"
#include "base/seal.h"

namespace pocketray {
namespace {

// Loads and builds on another thread while the screen says so.
struct Loading {
  std::unique_ptr<OpenScene> opened = std::make_unique<OpenScene>();
  Status status;
  OpenFront front;
  std::atomic<bool> done{false};
  std::thread thread;

  Loading(const CommonOptions& options, const BudgetOptions& budget, Viewer* viewer)
      : thread([this, &options, &budget, viewer] {
          Sharing* sharing = viewer->sharing;
          status = budget.ms > 0 ? open_scene_with_front(options, {budget.front}, viewer_bytes, opened.get(), &front)
                                 : open_shared_scene(sharing, options, viewer_bytes, opened.get());
          if (status.ok && sharing)
            status =
                start_sharing(sharing, &opened->renderer, viewer->format.bits_per_pixel == 16, viewer->options.dither);
          done = true;
        }) {}
  ~Loading() { thread.join(); }
};

// Shows the viewer's waiting screen until the scene is there. False: the user left before.
bool wait_for(Viewer* viewer, Loading* loading) {
  while (!loading->done) {
    if (!show_waiting(viewer, "loading") || interrupted) return false;
  }
  return true;
}

int run(CommonOptions common, ViewOptions view, const SharingOptions& sharing, const BudgetOptions& budgeted) {
  Viewer viewer;
  Settings size;
  const platform::Device* device;
  Status status = find_device(common, &device);
  if (view.rotation < 0) view.rotation = device ? device->rotation : 0;
  if (device) view.keys = device->keys;
  if (!common.emulate.empty()) view.emulated = device;
  if (status.ok && budgeted.ms > 0 && !sharing.servers.empty())
    status =
        failure("--budget-ms changes settings from frame to frame and servers keep them: leave it out, or --server");
  if (status.ok) status = picture_size(common, &size.width, &size.height);
  if (status.ok)
    status =
        open_viewer(view, common.scene.c_str(), static_cast<int>(size.width), static_cast<int>(size.height), &viewer);
  if (status.ok) status = open_sharing(sharing, view.emulated, &viewer.sharing);
  std::unique_ptr<Sharing, void (*)(Sharing*)> closing(viewer.sharing, close_sharing);
  if (!status.ok) return report(status);
  for (bool again = true; again && status.ok;) {
    again = false;
    Loading loading(common, budgeted, &viewer);
    if (!wait_for(&viewer, &loading)) {
      stop_opening(viewer.sharing);
      break;
    }
    status = loading.status;
    if (!status.ok) break;
    print_notes(*loading.opened);
    print_notes(loading.front);
    Budget budget;
    if (budgeted.ms > 0) start_budget(budgeted, loading.front, loading.opened->renderer, 4096, &budget);
    viewer.budget = budgeted.ms > 0 ? &budget : nullptr;
    seal_memory();
    status = run_viewer(&viewer, &loading.opened->renderer, &again);
    unseal_memory();
    if (viewer.budget) print_budget(budget, false);
    if (status.ok && viewer.budget) status = finish_budget(budget);
    viewer.budget = nullptr;
    if (viewer.dropped[0]) {
      common.scene = viewer.scene_path = viewer.dropped;
      viewer.dropped[0] = 0;
    }
  }
  close_viewer(&viewer);
  if (!status.ok) return report(status);
  return interrupted ? kExitInterrupted : kExitDone;
}

}  // namespace

void add_view_command(CLI::App* program, int* exit_status) {
  auto common = std::make_shared<CommonOptions>();
  auto view = std::make_shared<ViewOptions>();
  CLI::App* command =
      program->add_subcommand("view", "show a scene in the emulator's window, or on the framebuffer of a device");
  auto sharing = std::make_shared<SharingOptions>();
  add_scene_options(command, common.get());
  add_sharing_options(command, sharing.get());
  auto budget = std::make_shared<BudgetOptions>();
  add_budget_options(command, budget.get());
  command
      ->add_option("--screen", view->backend,
                   "sdl2 (window), linux (framebuffer), null (none); auto picks the first there is")
      ->capture_default_str();
  command->add_option("--framebuffer", view->device, "the framebuffer's device file, if not the usual one");
  command->add_option("--rotate", view->rotation, "turn the picture clockwise: 0, 90, 180 or 270")
      ->default_str("0, or the device's");
  command->add_option("--scale", view->scale, "window pixels per pixel; 0: as many as fit")->capture_default_str();
  command->add_flag("--dither", view->dither, "ordered dither, for screens of 16 bits");
  command->add_option("--frames", view->frame_count, "show so many finished frames, then leave; 0: until quit")
      ->capture_default_str();
  command->add_option("--screenshots", view->screenshot_folder, "where screenshots go")->capture_default_str();
  command->footer(
      "Keys: arrows turn, A/B (X, Z) nearer and farther, L/R (Q, W) sideways, select changes between orbit and fly,\n"
      "start goes back to the scene's camera, page up and down along the front of --budget-ms (start: as the budget "
      "has it),\n"
      "X pauses, Y or F1 shows the display, F12 saves a screenshot, F5 reloads, Esc leaves.");
  command->callback([=] { *exit_status = run(*common, *view, *sharing, *budget); });
}

}  // namespace pocketray
