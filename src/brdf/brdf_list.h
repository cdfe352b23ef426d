// One line per glossy lobe. Their order is part of the .pray format: append only.
#pragma once
#include "base/limits.h"
#include "brdf/brdf.h"

namespace pocketray {

extern const BrdfInfo kPhongBrdf;
extern const BrdfInfo kGgxBrdf;

enum : std::uint32_t { kPhong, kGgx };  // values of Material::brdf
inline const BrdfInfo* const kBrdfList[] = {&kPhongBrdf, &kGgxBrdf};
constexpr std::uint32_t kBrdfCount = sizeof kBrdfList / sizeof kBrdfList[0];
static_assert(kBrdfCount <= kBrdfCountMax, "raise it in base/limits.h");

}  // namespace pocketray
