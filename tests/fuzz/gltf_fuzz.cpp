// An untrusted glTF document, changed where a number, a member or an element stands.
#ifdef POCKETRAY_HAVE_IMPORT
#include <algorithm>
#include <cstring>

#include "fuzz/fuzz.h"
#include "support/gltf_documents.h"
#include "support/gltf_mutation.h"

POCKETRAY_FUZZ_TARGET(fuzz_gltf)

#if defined(POCKETRAY_FUZZ)
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t byte_count, std::size_t byte_count_max);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t byte_count, std::size_t byte_count_max,
                                               unsigned seed);
// Changes the structure of what is JSON, any bytes of the rest, and of one document in sixteen.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t byte_count, std::size_t byte_count_max,
                                               unsigned seed) {
  using namespace pocketray;
  Rng rng = make_rng(seed);
  GltfJson document = GltfJson::parse(bytes, bytes + byte_count, nullptr, false);
  if (document.is_discarded() || !document.is_object() || next_u32(&rng) % 16 == 0)
    return LLVMFuzzerMutate(bytes, byte_count, byte_count_max);
  for (std::uint32_t changes = 1 + next_u32(&rng) % 3; changes-- > 0;) mutate_gltf(&document, &rng);
  const std::string text = document.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
  if (text.size() > byte_count_max) return byte_count;
  std::memcpy(bytes, text.data(), text.size());
  return text.size();
}
#endif

namespace pocketray {

void fuzz_gltf(const std::uint8_t* bytes, std::size_t byte_count) { fuzz_model("gltf", bytes, byte_count); }

std::vector<FuzzSeed> gltf_seeds() {
  std::vector<FuzzSeed> seeds;
  for (const std::string& text : gltf_documents())
    seeds.push_back({"document" + std::to_string(seeds.size()), std::vector<std::uint8_t>(text.begin(), text.end())});
  return seeds;
}

}  // namespace pocketray
#endif
