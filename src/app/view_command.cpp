// pocketray view: shows a scene on a screen, controlled by buttons: coarse first, then refined. Input never waits.
#include <chrono>
#include <thread>

#include "app/coherent_sequence.h"
#include "app/commands.h"
#include "app/options.h"
#include "base/seal.h"
#include "budget/budget.h"
#include "platform/null/null.h"
#include "platform/standard_streams.h"
#include "session/interrupt.h"
#include "session/output.h"
#include "session/quality_dial.h"
#include "session/report.h"
#include "session/servers.h"
#include "viewer/picker.h"
#include "viewer/viewer.h"

namespace pocketray {
namespace {

// Loads and builds on another thread while the screen shows a message.
struct Loading {
  Servers* servers;
  std::unique_ptr<OpenScene> opened = std::make_unique<OpenScene>();
  Status status;
  OpenFront front;
  QualityDial dial;
  std::atomic<bool> done{false};
  std::thread thread;

  Loading(const CommonOptions& options, const BudgetOptions& budget, Viewer* viewer)
      : servers(viewer->servers), thread([this, &options, &budget, viewer] {
          status = chooses_settings(budget)
                       ? open_scene_with_front(options, front_source(budget, false), viewer_bytes, opened.get(), &front)
                   : servers ? open_scene_with(servers, options, viewer_bytes, opened.get())
                             : open_scene_with_dial(options, viewer_bytes, opened.get(), &dial);
          if (status.ok && servers)
            status = servers->backend->start(servers, &opened->renderer, viewer->format.bits_per_pixel == 16,
                                             viewer->options.dither);
          done = true;
        }) {}
  ~Loading() {
    thread.join();
    if (servers) servers->backend->stop(servers);
  }
};

// Shows the waiting screen until the scene is loaded. Returns false if the user quit first.
bool wait_for(Viewer* viewer, Loading* loading) {
  while (!loading->done) {
    if (!show_waiting(viewer, "loading") || interrupted) return false;
  }
  return true;
}

struct ViewCommand {
  CommonOptions common;
  ViewOptions view;
  ServersOptions servers;
  BudgetOptions budget;
  SideBySideOptions side_by_side;
  OptionalParts parts;
  bool no_hud = false;
  std::string log, scenes = ".";
};

// Shows the loaded scene until the user quits or a reload is due.
Status show(const ViewCommand& o, Loading* loading, Viewer* viewer, bool* again) {
  Renderer* renderer = &loading->opened->renderer;
  print_notes(*loading->opened);
  print_notes(loading->front);
  Budget budget;
  if (chooses_settings(o.budget)) start_budget(o.budget, loading->front, *renderer, 4096, &budget);
  viewer->budget = chooses_settings(o.budget) ? &budget : nullptr;
  viewer->dial = viewer->budget || viewer->servers ? nullptr : &loading->dial;
  viewer->focus = loading->opened->source.focus;
  viewer->material_names = loading->opened->source.material_names;
  if (!o.side_by_side.reference.empty())
    viewer->side_by_side =
        o.parts.side_by_side->open(o.side_by_side, *renderer, viewer->format.bits_per_pixel, o.view.dither);
  seal_memory();
  Status status = run_viewer(viewer, renderer, again);
  unseal_memory();
  if (viewer->budget) print_budget(budget, false);
  if (status.ok && viewer->budget) finish_budget(budget);
  if (viewer->side_by_side) {
    viewer->side_by_side->backend->print(*viewer->side_by_side);
    viewer->side_by_side->backend->close(viewer->side_by_side);
  }
  viewer->budget = nullptr;
  viewer->dial = nullptr;
  viewer->side_by_side = nullptr;
  return status;
}

// Prints the lag of the screen behind the buttons, if any were used.
void print_latency(const Viewer& viewer) {
  const Motion& motion = viewer.motion;
  if (motion.total_ns == 0) return;
  std::printf("  motion to photon: %.1f ms median, %.1f ms 99th percentile, over %.1f s of motion\n",
              latency_ns(motion, 0.5) * 1e-6, latency_ns(motion, 0.99) * 1e-6,
              static_cast<double>(motion.total_ns) * 1e-9);
}

// Fails, leaving the file unchanged, if the log is one of the files that the scene was read from.
Status check_log(const ViewCommand& o, const OpenScene& opened) {
  if (o.log.empty()) return success();
  Status status = check_not_read(opened.source.files, {{"--log", o.log}});
  if (!status.ok) platform::withdraw_log();
  return status;
}

// Loads and shows the scene, with news as a message. Returns false if the user quit while it was loading.
bool load_and_show(const ViewCommand& o, const std::string& news, Viewer* viewer, Status* status, bool* again) {
  watch_scene(viewer);
  Loading loading(o.common, o.budget, viewer);
  if (!wait_for(viewer, &loading)) {
    if (viewer->servers) viewer->servers->backend->stop_opening(viewer->servers);
    return false;
  }
  *status = loading.status;
  if (status->ok) *status = check_log(o, *loading.opened);
  if (status->ok && !news.empty()) tell(viewer, news.c_str());
  if (status->ok) *status = show(o, &loading, viewer, again);
  return true;
}

// Recovers from a scene that failed to load: returns to the previous one if it was dropped on the window, otherwise
// keeps the last picture and waits for another. Returns false if there is no picture to keep or the user quit.
bool goes_on_without(const Status& status, std::string* previous, std::string* news, ViewCommand* o, Viewer* viewer) {
  if (!viewer->has_picture) return false;
  std::string why = status.message;
  if (previous->empty()) {
    why += "; keeping the last picture until the file changes";
    tell(viewer, why.c_str());
    return wait_for_another(viewer, why.c_str());
  }
  *news = why + "; back to " + *previous;
  o->common.scene = viewer->scene_path = *previous;
  previous->clear();
  return true;
}

// Shows one scene after another. A scene's memory is freed before the next one loads, since a device has no room for
// two; if the next one is broken, only the last picture remains until another loads.
Status view_scenes(ViewCommand* o, Viewer* viewer) {
  std::string previous, news;
  Status status;
  for (bool again = true; again;) {
    again = false;
    status = success();
    if (!load_and_show(*o, news, viewer, &status, &again)) break;
    news = o->common.scene + " reloaded";
    if (status.ok)
      previous.clear();
    else
      again = goes_on_without(status, &previous, &news, o, viewer);
    if (viewer->quit) status = success();
    if (!again || !viewer->dropped[0]) continue;
    news.clear();
    previous = o->common.scene;
    o->common.scene = viewer->scene_path = viewer->dropped;
    viewer->dropped[0] = 0;
  }
  return status;
}

// Refuses contradictory options, and creates the folder for screenshots.
Status check_options(const ViewCommand& o) {
  Uses uses;
  uses.add(Use::servers, !o.servers.addresses.empty());
  add_budget_uses(o.budget, &uses);
  uses.add(Use::side_by_side, !o.side_by_side.reference.empty());
  RETURN_IF_ERROR(check_uses(uses));
  if (o.common.scene.empty() && o.view.backend == "null")
    return failure("nothing can be chosen on --screen null: name a SCENE");
  bool asked = o.view.screenshot_folder != ViewOptions().screenshot_folder;
  return asked ? make_output_folder(o.view.screenshot_folder) : success();
}

// Lets the user choose the scene, or quit.
Status let_pick(ViewCommand* o, Viewer* viewer) {
  std::vector<PickerEntry> entries;
  RETURN_IF_ERROR(list_scenes_to_pick(o->scenes, &entries));
  int chosen;
  pick_scene(viewer, entries, &chosen);
  if (chosen >= 0) o->common.scene = viewer->scene_path = entries[static_cast<std::size_t>(chosen)].scene;
  return success();
}

// Redirects messages to the file of --log from here on.
Status start_log(const ViewCommand& o) {
  if (o.log.empty()) return success();
  RETURN_IF_ERROR(check_not_input({{"SCENE", o.common.scene}, {"--front", o.budget.front}, {"--key", o.servers.key}},
                                  {"--log", o.log}));
  platform::FileError error;
  if (!platform::log_to_file(o.log.c_str(), &error)) return failure("--log: %.300s %s", o.log.c_str(), error.text);
  return success();
}

// Nobody can press a button on the null screen: while it rests, so does the program. Counted frames never rest.
void let_null_screen_rest(const ViewCommand& o) {
  platform::NullSettings settings;
  if (o.view.frame_count == 0) settings.rest_ns = kSystemClock.sleep_ns;
  platform::null_configure(settings);
}

int run(ViewCommand o) {
  if (Status logged = start_log(o); !logged.ok) return report(logged);
  o.view.hud = !o.no_hud;
  const SettingOption& samples = o.common.settings["samples"];
  o.view.keeps_samples = samples.given && samples.given();
  Viewer viewer;
  Settings size;
  const platform::Device* device;
  Status status = find_device(o.common, &device);
  if (o.view.rotation < 0) o.view.rotation = device ? device->rotation : 0;
  if (device) o.view.keys = device->keys;
  if (!o.common.emulate.empty()) o.view.emulated = device;
  if (status.ok) status = check_options(o);
  if (status.ok) status = picture_size(o.common, &size.width, &size.height);
  let_null_screen_rest(o);
  if (status.ok)
    status = open_viewer(o.view, o.common.scene.c_str(), static_cast<int>(size.width), static_cast<int>(size.height),
                         &viewer);
  if (status.ok && o.common.scene.empty()) status = let_pick(&o, &viewer);
  if (status.ok) status = open_servers(o.parts, o.servers, o.view.emulated, &viewer.servers);
  std::unique_ptr<Viewer, void (*)(Viewer*)> closing_screen(&viewer, close_viewer);
  ServersHandle closing_servers(viewer.servers);
  if (status.ok && !viewer.quit) status = view_scenes(&o, &viewer);
  closing_screen.reset();
  print_latency(viewer);
  if (!status.ok) return report(status);
  return interrupted ? kExitInterrupted : kExitDone;
}

void add_screen_options(Command command, ViewCommand* o) {
  command.chapter("Viewer");
  command.add_option("--screen NAME", o->view.backend, "where to show it")
      .one_of({"auto", "sdl2", "linux", "null"})
      .capture_default_str()
      .details(
          "sdl2 is a window, linux the framebuffer, null nothing, for tests; auto takes a window or the framebuffer, "
          "whichever there is.");
  command.add_option("--framebuffer FILE", o->view.device, "the framebuffer's device file").default_str("the system's");
  command.add_option("--rotate DEGREES", o->view.rotation, "rotation, clockwise")
      .one_of({"0", "90", "180", "270"})
      .default_str("the device's");
  command.add_option("--scale N", o->view.scale, "screen pixels per picture pixel; 0: the most that fit")
      .range(0, 64)
      .capture_default_str();
  command.add_flag("--dither", o->view.dither, "apply ordered dithering on 16-bit screens");
  command.add_flag("--no-hud", o->no_hud, "start without the overlay");
  command.add_option("--screenshots DIR", o->view.screenshot_folder, "folder for screenshots; created if missing")
      .capture_default_str();
  command.add_option("--log FILE", o->log, "append all messages to this file instead of printing them");
  command.add_option("--frames N", o->view.frame_count, "exit after N frames; 0: run until quit").capture_default_str();
}

}  // namespace

void add_view_command(Command program, const OptionalParts& parts, int* exit_status) {
  auto o = std::make_shared<ViewCommand>();
  o->parts = parts;
  o->view.has_reference = parts.side_by_side != nullptr;
  o->servers.coarse_first = true;
  Command command = program.add_subcommand("view", "show a scene in a window or on a device's framebuffer");
  add_scene_options(command, &o->common, false);
  command.chapter("Picture");
  command.add_option("--scenes DIR", o->scenes, "without SCENE: folder of .pray files to choose from")
      .capture_default_str();
  add_budget_options(command, &o->budget);
  add_look_options(command, &o->common, {"--budget-ms", "--flip-max"});
  add_coherence_options(command, &o->common);
  if (parts.servers) add_servers_options(command, &o->servers);
  add_screen_options(command, o.get());
  if (parts.side_by_side) add_side_by_side_option(command, &o->side_by_side);
  command.everyday("Picture", {"--size", "--quality", "--budget-ms"});
  command.everyday("View", {"--camera", "--focus", "--animation"});
  command.everyday("Light", {"--environment", "--background"});
  command.everyday("Screen", {"--scale", "--rotate", "--emulate"});
  command.everyday("Servers", {"--server"});
  command.footer(std::string("Keys, with a device's buttons in brackets\n"
                             "  arrows [pad]          turn the camera\n"
                             "  X, Z [A, B]           move nearer, farther\n"
                             "  Q, W [L, R]           move left, right\n"
                             "  right shift [select]  switch between orbit and fly\n"
                             "  return [start]        the scene's camera, and what --budget-ms chooses\n"
                             "  +, - [select + pad]   quality, or settings of --budget-ms\n"
                             "  S [X]                 pause\n"
                             "  F1, A [Y]             show what a frame costs\n") +
                 (parts.side_by_side ? "  V                     show or hide the reference of --side-by-side\n" : "") +
                 "  N                     play the next animation, or none\n"
                 "  T                     dim the pixels that the last frame did not retrace\n"
                 "  F12                   save a screenshot\n"
                 "  F5                    reload the scene\n"
                 "  Esc [start + select]  quit");
  command.example("pocketray view seesaw --emulate pi-zero");
  command.callback([=] { *exit_status = run(*o); });
}

}  // namespace pocketray
