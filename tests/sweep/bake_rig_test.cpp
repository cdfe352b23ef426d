// Scenes baked for a sweep, and radiosity predicted.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <cmath>
#include <fstream>

#include "desktop/sweep/bake_rig.h"
#include "desktop/sweep/references.h"
#include "desktop/sweep/rigs.h"
#include "scene/baked.h"
#include "session/heap_scene.h"
#include "sweep/folder.h"

using namespace pocketray;

namespace {

AccuracyOptions tiny(const std::string& scene, const Folder& folder) {
  setenv("XDG_CACHE_HOME", folder.cache().c_str(), 1);
  AccuracyOptions o;
  o.common.scene = scene, o.common.size = "16x12", o.common.threads = 2;
  o.folder = folder.path, o.reference_samples = 16, o.rounds = 1, o.price_limit = 1;
  return o;
}

const Measured& measured_as(const Sweep& sweep, const std::string& knob, const std::string& value) {
  for (const Measured& m : sweep.measured)
    if (m.knob == knob && m.value == value) return m;
  REQUIRE_MESSAGE(false, knob, " ", value);
  return sweep.measured[0];
}

Sweep measure(const AccuracyOptions& options) {
  Sweep sweep;
  bool whole;
  const Status status = measure_sweep(options, &sweep, &whole);
  REQUIRE_MESSAGE(status.ok, status.message);
  REQUIRE(whole);
  return sweep;
}

void write_text(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

// A bent strip of two squares, with a texture of 128 × 128 texels.
void write_strip(const Folder& folder) {
  std::string texels(18, '\0');
  texels[2] = 2, texels[12] = texels[14] = static_cast<char>(128), texels[16] = 24;
  for (int i = 0; i < 128 * 128; ++i) texels += i * 7 % 32 < 16 ? "\x20\x60\xd0" : "\x90\x30\x10";
  write_text(folder.file("strip.tga"), texels);
  write_text(folder.file("strip.mtl"), "newmtl m\nKd 1 1 1\nmap_Kd strip.tga\n");
  write_text(folder.file("strip.obj"),
             "mtllib strip.mtl\nusemtl m\nv -1 0 1\nv 0 0 1\nv .866 .5 1\nv -1 0 -1\nv 0 0 -1\nv .866 .5 -1\n"
             "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 5/3 4/4\nf 2/1 3/2 6/3 5/4\n");
}

}  // namespace

// Goal: radiosity is swept by patches, and predicted where none is stored: bytes exactly, error about as the bake of
// all patches has it; both are nearer to the truth than the baseline. Method: `cube`, which is opened with radiosity,
// and a file of it that stores none.
TEST_CASE("accuracy_bakes_radiosity_of_few_to_many_patches") {
  Folder folder, plain;
  AccuracyOptions o = tiny("cube", folder);
  o.bakes = true;
  const Sweep sweep = measure(o);
  const Measured &few = measured_as(sweep, "radiosity", "75 patches"),
                 &usual = measured_as(sweep, "radiosity", "1200 patches");
  CHECK(few.indirect == "radiosity");
  CHECK(few.stored_bytes < usual.stored_bytes);
  CHECK(few.bake_seconds > 0);
  CHECK_FALSE(usual.pareto);
  CHECK(sweep.radiosity.why_not == "the scene stores it");
  HeapScene heap;
  REQUIRE(read_heap_scene("cube", ModelOptions(), &heap).ok);
  std::string bytes(baked_size(heap.scene), 0);
  baked_write(heap.scene, reinterpret_cast<std::uint8_t*>(&bytes[0]));
  write_text(plain.file("plain.pray"), bytes);
  const Sweep without = measure(tiny(plain.file("plain.pray"), plain));
  const double none = without.measured.front().truth.flip;
  for (const Measured& m : without.measured) CHECK(m.knob != "radiosity");
  CHECK(usual.truth.flip < 0.7 * none);
  const RadiosityPrediction& p = without.radiosity;
  CHECK(p.why_not == "");
  CHECK(p.flip == few.truth.flip);
  CHECK(p.flip_without == none);
  CHECK(std::fabs(p.flip - usual.truth.flip) < 0.25 * (none - usual.truth.flip));
  CHECK(p.bytes == doctest::Approx(usual.stored_bytes - static_cast<double>(bytes.size())).epsilon(0.01));
  CHECK(p.seconds > 0);
  CHECK(p.ns_per_pixel > 0);
}

// Goal: where radiosity would change nothing or cannot be solved, a reason stands in place of a prediction.
TEST_CASE("accuracy_says_why_radiosity_is_not_predicted") {
  Folder folder, other, third;
  write_text(folder.file("dark.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  CHECK(measure(tiny(folder.file("dark.obj"), folder)).radiosity.why_not == "the scene has no light of its own");
  AccuracyOptions asked = tiny("cube", other);
  asked.common.settings["indirect"].count = 1, asked.common.settings["indirect"].choice = "none";
  CHECK(measure(asked).radiosity.why_not == "--indirect asks for another method");
  AccuracyOptions changed = tiny("seesaw", third);
  changed.common.background = "1,1,1";
  CHECK(measure(changed).radiosity.why_not == "the scene's light is overridden");
}

#ifdef POCKETRAY_HAVE_IMPORT
// Goal: textures are baked as asked, and what they store differs as it should. Method: a strip whose texture has 128
// texels a side.
TEST_CASE("accuracy_bakes_models_otherwise") {
  Folder folder;
  write_strip(folder);
  AccuracyOptions o = tiny(folder.file("strip.obj"), folder);
  o.bakes = true;
  const Sweep sweep = measure(o);
  const double usual = measured_as(sweep, "baseline", "").stored_bytes;
  CHECK(measured_as(sweep, "texture-max", "64 texels").stored_bytes == usual - 4 * 128 * 128);
  CHECK(measured_as(sweep, "texture-max", "1024 texels").missing == "no texture has more than 128 texels a side");
  CHECK(measured_as(sweep, "texture-max", "2048 texels").is_default);
  CHECK(measured_as(sweep, "mip-maps", "none").stored_bytes < usual - 4 * 128 * 128 / 4);
  CHECK(measured_as(sweep, "textures", "compressed").stored_bytes < usual / 3);
}

// Goal: baked as usual, a scene is what it was when opened. Method: the same picture and bytes, of a model and of a
// built-in scene.
TEST_CASE("baked_scenes_look_as_opened") {
  Folder folder;
  write_strip(folder);
  for (const std::string& scene : {folder.file("strip.obj"), std::string("cornell")}) {
    CAPTURE(scene);
    AccuracyOptions o = tiny(scene, folder);
    std::unique_ptr<Rig> opened, baked;
    REQUIRE(open_rig(o, SceneChoice(), &opened).ok);
    SceneChoice choice;
    choice.bake.texture_side_max = 511;  // which changes nothing
    REQUIRE(open_rig(o, choice, &baked).ok);
    double ns;
    for (Rig* rig : {opened.get(), baked.get()}) REQUIRE(time_frame(rig, rig->baseline, 0, &ns).ok);
    const Array<Vec3>&a = opened->opened.renderer.image, &b = baked->opened.renderer.image;
    REQUIRE(a.count == b.count);
    for (std::uint32_t i = 0; i < a.count; ++i) CHECK(a[i] == b[i]);
    CHECK(baked->stored_bytes == opened->stored_bytes);
    CHECK(baked->bake_seconds > 0);
  }
}
#endif
