// A small model in each format, written by hand or by code: seeds for fuzzing the importers.
#ifdef POCKETRAY_HAVE_IMPORT
#include <algorithm>
#include <cstring>

#include "fuzz/fuzz.h"
#include "import/gltf_writer.h"

namespace pocketray {
namespace {

template <class T>
void put(std::string* file, T value) {
  file->append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string animated_glb() {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.indices({0, 1, 2, 0});
  w.floats({0, 1});
  w.vec3s({0, 0, 0, 1, 2, 3});
  return w.glb(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":5}]}],\"nodes\":[{\"mesh\":"
      "0}],\"scenes\":[{\"nodes\":[0]}],\"animations\":[{\"samplers\":[{\"input\":2,\"output\":3}],\"channels\":[{"
      "\"sampler\":0,\"target\":{\"node\":0,\"path\":\"scale\"}}]}]");
}

// Textures that use either set of texture coordinates.
std::string two_sets_gltf() {
  return triangle_gltf(
      "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},\"occlusionTexture\":{\"index\":0,\"texCoord\":1}"
      "}",
      ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"data:image/png;base64,"
      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNoaPj/HwAGggL/bOBDIwAAAABJRU5ErkJggg==\"}]");
}

// A clear coat with all its textures.
std::string coated_gltf() {
  const std::string texture = "Texture\":{\"index\":0,\"texCoord\":0}";
  return triangle_gltf(
      "{\"extensions\":{\"KHR_materials_clearcoat\":{\"clearcoatFactor\":0.5,\"clearcoatRoughnessFactor\":0.5,"
      "\"clearcoat" +
          texture + ",\"clearcoatRoughness" + texture + ",\"clearcoatNormal" + texture + "}}}",
      ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"data:image/png;base64,"
      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNoaPj/HwAGggL/bOBDIwAAAABJRU5ErkJggg==\"}]");
}

// A sheen with both its textures.
std::string cloth_gltf() {
  const std::string texture = "Texture\":{\"index\":0,\"texCoord\":0}";
  return triangle_gltf(
      "{\"extensions\":{\"KHR_materials_sheen\":{\"sheenColorFactor\":[0.5,0.4,0.3],\"sheenRoughnessFactor\":0.5,"
      "\"sheenColor" +
          texture + ",\"sheenRoughness" + texture + "}}}",
      ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"data:image/png;base64,"
      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNoaPj/HwAGggL/bOBDIwAAAABJRU5ErkJggg==\"}]");
}

// Rough glass under a film, with all their textures.
std::string glass_gltf() {
  const std::string texture = "Texture\":{\"index\":0,\"texCoord\":0}";
  return triangle_gltf(
      "{\"pbrMetallicRoughness\":{\"roughnessFactor\":0.4,\"metallicFactor\":0},\"extensions\":{"
      "\"KHR_materials_transmission\":{\"transmissionFactor\":0.9,\"transmission" +
          texture + "},\"KHR_materials_volume\":{\"thicknessFactor\":0.5,\"attenuationDistance\":2,\"thickness" +
          texture + "},\"KHR_materials_iridescence\":{\"iridescenceFactor\":0.8,\"iridescenceIor\":1.4,\"iridescence" +
          texture + ",\"iridescenceThickness" + texture + "}}}",
      ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"data:image/png;base64,"
      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNoaPj/HwAGggL/bOBDIwAAAABJRU5ErkJggg==\"}]");
}

// A leaf with both its textures, and a volume.
std::string leaf_gltf() {
  const std::string texture = "Texture\":{\"index\":0,\"texCoord\":0}";
  return triangle_gltf(
      "{\"extensions\":{\"KHR_materials_volume\":{\"thicknessFactor\":0.5},\"KHR_materials_diffuse_transmission\":{"
      "\"diffuseTransmissionFactor\":0.7,\"diffuseTransmissionColorFactor\":[0.5,0.9,0.1],\"diffuseTransmission" +
          texture + ",\"diffuseTransmissionColor" + texture + "}}}",
      ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"data:image/png;base64,"
      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNoaPj/HwAGggL/bOBDIwAAAABJRU5ErkJggg==\"}]");
}

std::string ply(const char* format, const char* count_type, bool binary) {
  std::string file =
      std::string("ply\nformat ") + format + " 1.0\nelement vertex 4\nproperty float x\nproperty float y\n" +
      "property float z\nelement face 2\nproperty list " + count_type + " int vertex_indices\nend_header\n";
  if (!binary) return file + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 2 3\n";
  for (float x : {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) put(&file, x);
  for (int face = 0; face < 2; ++face) {
    file += '\3';
    for (std::int32_t vertex : {0, 1 + face, 2 + face}) put(&file, vertex);
  }
  return file;
}

std::string binary_stl() {
  std::string file(80, ' ');
  put(&file, std::uint32_t(1));
  for (float x : {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) put(&file, x);
  return file + std::string(2, '\0');
}

// A chunk of .3ds: kind, length, content.
std::string chunk(std::uint16_t kind, const std::string& content) {
  std::string bytes;
  put(&bytes, kind), put(&bytes, static_cast<std::uint32_t>(6 + content.size()));
  return bytes + content;
}
std::string three_ds() {
  std::string vertices, faces;
  put(&vertices, std::uint16_t(3));
  for (float x : {0, 0, 0, 1, 0, 0, 0, 1, 0}) put(&vertices, x);
  put(&faces, std::uint16_t(1));
  for (std::uint16_t word : {0, 1, 2, 7}) put(&faces, word);
  std::string object = std::string("a\0", 2) + chunk(0x4100, chunk(0x4110, vertices) + chunk(0x4120, faces));
  return chunk(0x4D4D, chunk(0x3D3D, chunk(0x4000, object)));
}

const char kDae[] =
    "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset/>"
    "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"q\" count=\"9\">0 0 0 1 0 0 0 1 0"
    "</float_array><technique_common><accessor source=\"#q\" count=\"3\" stride=\"3\"><param name=\"X\" "
    "type=\"float\"/>"
    "<param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
    "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"1\"><input "
    "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>"
    "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\"><instance_geometry url=\"#g\"/></node></visual_scene>"
    "</library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";

struct Model {
  const char *name, *ending;
  std::string content;
};

std::vector<Model> models() {
  std::string corner = "0 0 0 0 0 0 1 0 0 0\n";
  return {
      {"triangle.gltf", "gltf", triangle_gltf("{}")},
      {"two_sets.gltf", "gltf", two_sets_gltf()},
      {"coated.gltf", "gltf", coated_gltf()},
      {"cloth.gltf", "gltf", cloth_gltf()},
      {"glass.gltf", "gltf", glass_gltf()},
      {"leaf.gltf", "gltf", leaf_gltf()},
      {"animated.glb", "glb", animated_glb()},
      {"square.obj", "obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/1 -1\nl 1 2\n"},
      {"forms.obj", "obj",
       "\xEF\xBB\xBFv 0 0 0\nv 1 0 \\\n0\nv 1 1 0\r\nv 0 1 0\rf 1// 2// 3//\nf 1/1/ 2/ \\\r\n3//\n#\\\nf 1 2 4\\"},
      {"concave.obj", "obj",
       "mtllib a b.mtl\nv 0 0 0\nv 2 2 0\nv 4 0 0\nv 4 4 0\nv 2 2 0\nv 0 4 nan\nv 1e-3 1 0 1 .5 0\nusemtl a b\ns 1\nf "
       "1 2 3 4 "
       "5 7\ns off\nf 1 3 5 7 2 4 # odd\nf 6 1 2\ng a b\no c\np 1\n"},
      {"tangle.obj", "obj",
       "v 0 0 0\nv 3 1 0\nv 1 3 0\nv 1 0 0\nv 3 3 0\nv 0 2 0\nf 1 2 3 4 5 6 1 3 5 2 4 6\nf 1 4 1 4\nf 1 2 2 3 3 3 4\n"},
      {"wide.obj", "obj", std::string("\xFF\xFEv\0 \0", 6)},
      {"shining.mtl", "mtl", "newmtl m\nKd 1 0 0\nKs 1 1 1\nNs 20\nd 0.5\nmap_Kd a.png\nPc 0.5\nPcr 0.25\n"},
      {"maps.mtl", "mtl",
       "newmtl m\nillum 4\nKd .5\nKs spectral a.rfl 1\nd -halo .5\nTr 1\nmap_Kd -s 2 2 -o .5 -mm 0 1 -clamp on -blendu "
       "off "
       "a b.png\nmap_d -imfchan l -texres 8 C:\\m.png\nbump -bm 1 b.png\nnewmtl a b # c\nxyz 1\n"},
      {"colors.ply", "ply",
       "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty float "
       "y\nproperty "
       "float z\nproperty float s\nproperty float t\nelement face 2\nproperty list uchar int vertex_indices\nproperty "
       "list "
       "uchar float texcoord\nproperty uchar texnumber\nproperty uchar red\nproperty uchar green\nproperty uchar "
       "blue\nend_header\n0 0 0 0 0\n2 0 nan 1 0\n1 1 0 1 1\n0 2 0 0 1\n4 0 1 2 3 8 0 0 1 0 1 1 0 1 0 255 0 0\n3 0 2 3 "
       "0 1 0 "
       "255 0\n"},
      {"ascii.ply", "ply", ply("ascii", "uchar", false)},
      {"binary.ply", "ply", ply("binary_little_endian", "uchar", true)},
      {"strips.ply", "ply",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
       "tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 2 "
       "3\n"},
      {"no_corners.ply", "ply", ply("ascii", "uchar", false).replace(ply("ascii", "uchar", false).size() - 8, 7, "0")},
      {"ascii.stl", "stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
       "endsolid a\n"},
      {"binary.stl", "stl", binary_stl()},
      {"triangle.off", "off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"triangle.dae", "dae", kDae},
      {"triangle.3ds", "3ds", three_ds()},
      {"triangle.x", "x", "xof 0303txt 0032\nMesh a {\n3;\n0;0;0;,\n1;0;0;,\n0;1;0;;\n1;\n3;0,1,2;;\n}\n"},
      {"triangle.ac", "ac",
       "AC3Db\nMATERIAL \"\" rgb 1 1 1  amb 0 0 0  emis 0 0 0  spec 0 0 0  shi 0  trans 0\nOBJECT world\nkids "
       "1\nOBJECT "
       "poly\nnumvert 3\n0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 0 0\n2 0 0\nkids 0\n"},
      {"triangle.smd", "smd",
       "version 1\nnodes\n0 \"a\" -1\nend\nskeleton\ntime 0\n0 0 0 0 0 0 0\nend\ntriangles\nm\n" + corner + corner +
           corner + "end\n"},
      {"triangle.ase", "ase",
       "*3DSMAX_ASCIIEXPORT 200\n*GEOMOBJECT {\n*NODE_NAME \"a\"\n*MESH {\n*MESH_NUMVERTEX 3\n*MESH_NUMFACES 1\n"
       "*MESH_VERTEX_LIST {\n*MESH_VERTEX 0 0 0 0\n*MESH_VERTEX 1 1 0 0\n*MESH_VERTEX 2 0 1 0\n}\n*MESH_FACE_LIST {\n"
       "*MESH_FACE 0: A: 0 B: 1 C: 2 AB: 1 BC: 1 CA: 1 *MESH_SMOOTHING 1 *MESH_MTLID 0\n}\n}\n}\n"},
      {"triangle.x3d", "x3d",
       "<?xml version=\"1.0\"?><X3D version=\"3.3\"><Scene><Shape><IndexedFaceSet coordIndex=\"0 1 2 -1\"><Coordinate "
       "point=\"0 0 0 1 0 0 0 1 0\"/></IndexedFaceSet></Shape></Scene></X3D>"},
      // For the rest only their magic bytes; the fuzzer continues from there.
      {"head.fbx", "fbx", std::string("Kaydara FBX Binary  \0\x1A\0\xE8\x1C\0\0", 27) + std::string(64, '\0')},
      {"head.lwo", "lwo", std::string("FORM\0\0\0\x14LWO2PNTS\0\0\0\x0C", 20) + std::string(12, '\0')},
      {"head.b3d", "b3d", std::string("BB3D\x0C\0\0\0\1\0\0\0TEXS\0\0\0\0", 20)},
      {"head.ms3d", "ms3d", std::string("MS3D000000\4\0\0\0\0\0", 16) + std::string(16, '\0')},
      {"head.md2", "md2", std::string("IDP2\x08\0\0\0", 8) + std::string(60, '\0')},
      {"head.md3", "md3", std::string("IDP3\x0F\0\0\0", 8) + std::string(100, '\0')},
      {"head.3mf", "3mf", std::string("PK\5\6", 4) + std::string(18, '\0')},
  };
}

}  // namespace

std::vector<FuzzSeed> import_seeds() {
  std::vector<std::string> endings = import_endings();
  std::vector<FuzzSeed> seeds;
  for (const Model& model : models()) {
    auto found = std::find(endings.begin(), endings.end(), model.ending);
    if (found == endings.end()) continue;
    std::string bytes = static_cast<char>(found - endings.begin()) + model.content;
    seeds.push_back({model.name, std::vector<std::uint8_t>(bytes.begin(), bytes.end())});
  }
  return seeds;
}

}  // namespace pocketray
#endif
