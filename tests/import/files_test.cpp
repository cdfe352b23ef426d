// Which files an import reads.
#include "desktop/import/files.h"

#include <algorithm>

#include "desktop/import/import_error.h"
#include "import/gltf_writer.h"
#include "import/import_testing.h"

using namespace pocketray;

namespace {

// The smallest picture: a TGA file of one texel.
const std::string kTexel("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0\1\2\3", 21);

// Names, without the folder, of the files read for a model.
std::vector<std::string> files_of(const TemporaryFolder& folder, const std::string& name) {
  std::vector<std::string> names = load(folder.path + "/" + name).files;
  for (std::string& file : names) {
    CHECK(file.compare(0, folder.path.size() + 1, folder.path + "/") == 0);
    file.erase(0, folder.path.size() + 1);
  }
  std::sort(names.begin(), names.end());
  return names;
}

using Names = std::vector<std::string>;

}  // namespace

// Goal: every file that was opened is listed once, as it is called, even if it could not be used; others are not.
// Method: a glTF file with a buffer and an image used twice, an OBJ file with materials, textures written in another
// case and a damaged one.
TEST_CASE("import_lists_the_files_it_read") {
  TemporaryFolder folder;
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.vec2s({0, 0, 1, 0, 0, 1});
  std::string text = w.gltf(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"material\":0}]}],\"nodes\":[{"
      "\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"images\":[{\"uri\":\"a%20b.tga\"},{\"uri\":\"unused.tga\"}],"
      "\"textures\":[{\"source\":0}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},"
      "\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":0}}]");
  const std::size_t begin = text.find("data:"), end = text.find('"', begin);
  text.replace(begin, end - begin, "a.bin");
  folder.write("a.gltf", text);
  folder.write("a.bin", std::string(w.bytes.begin(), w.bytes.end()));
  for (const char* image : {"a b.tga", "unused.tga", "C.tga"}) folder.write(image, kTexel);
  CHECK(files_of(folder, "a.gltf") == Names{"a b.tga", "a.bin", "a.gltf"});

  folder.write("broken.png", "PNG");
  folder.write("b.mtl", "newmtl one\nmap_Kd c.TGA\nmap_Ke broken.png\nmap_d absent.png\n");
  folder.write("b.obj", "mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl one\nf 1/1 2/2 3/3\n");
  CHECK(files_of(folder, "b.obj") == Names{"C.tga", "b.mtl", "b.obj", "broken.png"});
  folder.write("c.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  CHECK(files_of(folder, "c.ply") == Names{"c.ply"});
}

// Goal: the list comes from a reader in a process of its own, too. Method: COLLADA with a texture, if it can be read.
TEST_CASE("import_lists_the_files_that_assimp_read") {
  if (!contains(" " + import_formats() + " ", " dae ")) return;
  TemporaryFolder folder;
  folder.write("t.tga", kTexel);
  folder.write("a.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset>
<library_images><image id="i"><init_from>t.tga</init_from></image></library_images>
<library_effects><effect id="fx"><profile_COMMON><newparam sid="su"><surface type="2D"><init_from>i</init_from></surface></newparam>
<newparam sid="sa"><sampler2D><source>su</source></sampler2D></newparam><technique sid="t"><lambert><diffuse>
<texture texture="sa" texcoord="c"/></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="mat" name="mat"><instance_effect url="#fx"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"><bind_material>
<technique_common><instance_material symbol="m" target="#mat"/></technique_common></bind_material></instance_geometry></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  CHECK(files_of(folder, "a.dae") == Names{"a.dae", "t.tga"});
}

// Goal: the list takes bounded memory, however many files a model names, and a file named often counts once. Method:
// one name a million times; then others until they are refused.
TEST_CASE("import_refuses_to_read_endless_files") {
  FilesRead files;
  for (int i = 0; i < 1000000; ++i) note_file(&files, "again.png");
  CHECK(files.paths.size() == 1);
  std::string told;
  for (int i = 0; told.empty() && i < 1000000; ++i) try {
      note_file(&files, "texture-" + std::to_string(i));
    } catch (const ImportError& error) {
      told = error.what();
    }
  CHECK(told == "it names too many files; merge some");
  CHECK(files.paths.size() > 5000);
  CHECK(files.paths.size() < kFilesReadBytesMax / 16);
}
