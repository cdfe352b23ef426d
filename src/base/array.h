// A view of `count` elements owned elsewhere (an arena, a loaded file).
#pragma once
#include <cstddef>
#include <cstdint>

namespace pocketray {

template <class T>
struct Array {
  T* data = nullptr;
  std::uint32_t count = 0;
  T& operator[](std::size_t index) const { return data[index]; }
  T* begin() const { return data; }
  T* end() const { return data + count; }
  bool empty() const { return count == 0; }
  std::size_t bytes() const { return sizeof(T) * static_cast<std::size_t>(count); }
  operator Array<const T>() const { return {data, count}; }
};

}  // namespace pocketray
