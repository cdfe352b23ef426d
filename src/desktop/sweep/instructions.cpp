#include "desktop/sweep/instructions.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/check.h"
#include "desktop/accuracy/callgrind.h"
#include "desktop/accuracy/text.h"
#include "platform/process.h"
#include "session/interrupt.h"

namespace pocketray {

// Callgrind dumps its counts before entering this function.
__attribute__((noinline)) void begin_counted_frame() { asm volatile("" ::: "memory"); }

namespace {

constexpr const char *kJobName = "job", *kAnswerName = "answer", *kDumpName = "callgrind";
constexpr const char* kNotCounted = "instructions are not counted: this CPU or system has no counter for programs";
constexpr std::size_t kWordsBytesMax = 1 << 17;

struct TemporaryFolder {
  char path[1024] = {0};
  ~TemporaryFolder() {
    if (path[0]) platform::remove_folder(path);
  }
};

bool read_text(const std::string& path, std::string* text) {
  platform::LoadedFile file;
  platform::FileError error;
  if (!platform::load_file(path.c_str(), &file, &error)) return false;
  text->assign(reinterpret_cast<const char*>(file.bytes), file.byte_count);
  platform::unload_file(&file);
  return true;
}

struct Counting {
  std::vector<const SweepPoint*> points;
  TemporaryFolder folder;
  platform::Process process;
  bool ended_well = false;

  // Callgrind numbers its dumps from 1; the first covers everything before the first frame.
  std::string dump_path(std::size_t dump) const {
    return std::string(folder.path) + "/" + kDumpName + "." + std::to_string(dump + 1);
  }
  std::string dump_of_point(std::size_t i) const { return dump_path(i + 1); }
};

Status write_job(const Rig& rig, const Counting& counting) {
  const Renderer& renderer = rig.opened.renderer;
  std::vector<std::string> ids;
  for (const SweepPoint* point : counting.points) ids.push_back(id_of(*point));
  Json job = {{"size", std::to_string(renderer.settings.width) + "x" + std::to_string(renderer.settings.height)},
              {"exposure", renderer.view.exposure},
              {"accel", renderer.accel.info->name},
              {"configurations", ids}};
  return save_text(counting.folder.path, kJobName, job.dump(1, ' ', false, Json::error_handler_t::replace));
}

// Valgrind's arguments, then this program's own with the folder after its command.
bool command_line(const std::string& valgrind, const std::string& folder, std::vector<std::string>* words) {
  char own[1024];
  std::vector<char> own_words(kWordsBytesMax);
  std::size_t bytes = platform::own_words(own_words.data(), own_words.size());
  if (bytes == 0 || !platform::own_program(own, sizeof own)) return false;
  std::string out_file;  // valgrind expands %
  for (char c : folder + "/" + kDumpName) out_file += c == '%' ? "%%" : std::string(1, c);
  *words = {valgrind,
            "--command-line-only=yes",
            "--tool=callgrind",
            "--vgdb=no",
            "--log-file=/dev/null",
            "--callgrind-out-file=" + out_file,
            "--dump-before=pocketray::begin_counted_frame()"};
  for (const char* timed : {"trace_spans", "trace_as_rendered", "pack_rows"})
    words->push_back(std::string("--toggle-collect=pocketray::") + timed + "(*)");
  words->push_back(own);
  std::size_t at = std::string(own_words.data()).size() + 1;
  bool has_command = false;
  while (at < bytes) {
    words->push_back(&own_words[at]);
    at += words->back().size() + 1;
    if (!has_command && words->back() == "accuracy") {
      words->insert(words->end(), {"--counting-folder", folder});
      has_command = true;
    }
  }
  return has_command;
}

Status start(const Rig& rig, const char* valgrind, Counting* counting) {
  platform::FileError error;
  std::vector<std::string> words;
  std::vector<const char*> pointers;
  if (!platform::make_temporary_folder(counting->folder.path, sizeof counting->folder.path, &error))
    return failure("the folder for valgrind's counts %s", error.text);
  RETURN_IF_ERROR(write_job(rig, *counting));
  if (!command_line(valgrind, counting->folder.path, &words)) return failure("cannot read this program's own path");
  for (const std::string& word : words) pointers.push_back(word.c_str());
  pointers.push_back(nullptr);
  if (!platform::start_program(valgrind, pointers.data(), nullptr, &counting->process, &error))
    return failure("valgrind %s", error.text);
  return success();
}

void watch(Counting* counting) {
  double price = 0, done = 0;
  for (const SweepPoint* point : counting->points) price += 1000 * point->price;
  Progress progress;
  std::size_t next = 0;
  platform::ProcessState state = platform::ProcessState::running;
  while (!interrupted && (state = platform::look_at(&counting->process)) == platform::ProcessState::running) {
    if (progress.total == 0 && platform::file_stamp(counting->dump_path(0).c_str()) != 0)
      progress = start_progress("instructions", static_cast<std::uint64_t>(price));
    for (; next < counting->points.size() && platform::file_stamp(counting->dump_of_point(next).c_str()) != 0; ++next)
      done += 1000 * counting->points[next]->price;
    show_progress(&progress, static_cast<std::uint64_t>(done));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  platform::kill_process(&counting->process);
  end_progress(&progress);
  counting->ended_well = state == platform::ProcessState::succeeded;
}

// Returns the other program's report on its frames; null: nothing yet.
Json read_answer(const Counting& counting) {
  std::string text;
  if (!read_text(std::string(counting.folder.path) + "/" + kAnswerName, &text)) return nullptr;
  Json answer = Json::parse(text, nullptr, false);
  return answer.is_discarded() ? nullptr : answer;
}

// Stores the dumped counts in the state. Returns the number of counted points.
std::size_t take_counts(const Counting& counting, AccuracyState* state) {
  std::size_t count = 0;
  Json answer = read_answer(counting);
  if (answer.is_null()) return 0;
  double pixels = answer.at("pixels").get<double>();
  for (std::size_t i = 0; i < counting.points.size(); ++i) {
    std::string dump;
    std::uint64_t instructions;
    if (!read_text(counting.dump_of_point(i), &dump) || !read_callgrind_dump(dump, &instructions)) break;
    if (instructions == 0) continue;
    state->points[id_of(*counting.points[i])].instructions_per_pixel = static_cast<double>(instructions) / pixels;
    ++count;
  }
  return count;
}

std::string how_counted(const Counting& counting, const Rig& rig) {
  Json answer = read_answer(counting);
  std::uint32_t pixels = answer.at("pixels").get<std::uint32_t>();
  bool whole = pixels == rig.opened.renderer.image.count;
  return "instructions are counted by valgrind over " +
         (whole ? "the picture" : format("%u pixels across the picture", pixels)) + ", one thread, " +
         answer.at("isa").get<std::string>();
}

Status read_job(const std::string& folder, AccuracyOptions* o, float* exposure, std::vector<std::string>* ids) {
  std::string text;
  if (!read_text(folder + "/" + kJobName, &text)) return failure("%.200s has no job", folder.c_str());
  try {
    Json job = Json::parse(text);
    o->common.size = job.at("size").get<std::string>();
    o->common.accel = job.at("accel").get<std::string>();
    *exposure = job.at("exposure").get<float>();
    *ids = job.at("configurations").get<std::vector<std::string>>();
  } catch (const Json::exception&) {
    return failure("the job in %.200s is damaged", folder.c_str());
  }
  return success();
}

}  // namespace

void count_by_valgrind(const AccuracyOptions& options, const Rig& rig, const SweepPlan& plan, AccuracyState* state,
                       bool* whole, std::string* note) {
  CHECK(state != nullptr && whole != nullptr && note != nullptr);
  *whole = true;
  *note = state->counted;
  Counting counting;
  for (std::size_t i = 0; i < plan.points.size(); ++i)
    if (is_measured(plan, i) && std::isnan(state->points[id_of(plan.points[i])].instructions_per_pixel))
      counting.points.push_back(&plan.points[i]);
  if (counting.points.empty()) return;
  if (!options.starts_valgrind) {
    *note = std::string(kNotCounted) + "; --count-instructions lets valgrind count them";
    return;
  }
  char path[1024];
  if (!platform::find_program("valgrind", path, sizeof path)) {
    *note = std::string(kNotCounted) + "; install valgrind to count them";
    return;
  }
  Status started = start(rig, path, &counting);
  if (started.ok) watch(&counting);
  std::size_t count = started.ok ? take_counts(counting, state) : 0;
  if (count > 0) state->counted = how_counted(counting, rig);
  *whole = !interrupted;
  *note = state->counted;
  if (count == counting.points.size()) return;
  std::string why = !started.ok           ? started.message
                    : counting.ended_well ? "valgrind finds no symbols in this program"
                                          : "valgrind failed";
  *note = note->empty() ? std::string(kNotCounted) + ", and " + why : *note + "; some are missing: " + why;
}

Status render_for_valgrind(const AccuracyOptions& options) {
  AccuracyOptions o = options;
  float exposure = 1;
  std::vector<std::string> ids;
  RETURN_IF_ERROR(read_job(o.counting_folder, &o, &exposure, &ids));
  // The job has everything relevant of the device; neither its memory nor its speed is measured here.
  o.common.emulate = o.common.device = o.common.memory = "";
  o.common.threads = 1;  // several threads would divide the tiles of the last rows
  Isa isa;
  if (!parse_isa(o.common.isa, &isa).ok) o.common.isa = "";  // valgrind supports fewer
  Rigs rigs = {o, {}, {}};
  SweepPlan plan;
  RETURN_IF_ERROR(plan_rigs(&rigs, &plan));
  first_rig(rigs)->opened.renderer.view.exposure = exposure;
  std::map<std::string, const SweepPoint*> points;
  for (const SweepPoint& point : plan.points) points[id_of(point)] = &point;
  Rig* rig;
  for (const std::string& id : ids) {  // opens all first, since that traces, too
    if (!points.count(id)) return failure("this sweep has no configuration %.100s", id.c_str());
    RETURN_IF_ERROR(rig_for(&rigs, points[id]->configuration, &rig));
  }
  Json answer = {{"isa", isa_name(active_isa())}};
  for (auto& opened : rigs.by_scene) answer["pixels"] = take_part(opened.second.get());
  RETURN_IF_ERROR(save_text(o.counting_folder, kAnswerName, answer.dump()));
  for (const std::string& id : ids) {
    RETURN_IF_ERROR(rig_for(&rigs, points[id]->configuration, &rig));
    begin_counted_frame();
    double ns_per_pixel;
    RETURN_IF_ERROR(time_frame(rig, points[id]->configuration, o.seconds, &ns_per_pixel));
    if (interrupted) return failure("interrupted");
  }
  begin_counted_frame();
  return success();
}

}  // namespace pocketray
