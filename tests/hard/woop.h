// Body of the test by [Woop, Benthin, Wald 2013], for two compilations. Includes nothing: an inline function compiled
// with contraction could replace its twin in the rest of the program.
#pragma once

static bool woop(const float* origin, const float* direction, const float* a, const float* b, const float* c) {
  int kz = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (__builtin_fabsf(direction[axis]) > __builtin_fabsf(direction[kz])) kz = axis;
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  const float sx = direction[kx] / direction[kz], sy = direction[ky] / direction[kz], sz = 1 / direction[kz];
  float x[3], y[3], z[3];
  const float* corners[3] = {a, b, c};
  for (int i = 0; i < 3; ++i) {
    z[i] = corners[i][kz] - origin[kz];
    x[i] = (corners[i][kx] - origin[kx]) - sx * z[i];
    y[i] = (corners[i][ky] - origin[ky]) - sy * z[i];
  }
  float u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2], w = x[1] * y[0] - y[1] * x[0];
  if (u == 0 || v == 0 || w == 0) {
    u = static_cast<float>(static_cast<double>(x[2]) * y[1] - static_cast<double>(y[2]) * x[1]);
    v = static_cast<float>(static_cast<double>(x[0]) * y[2] - static_cast<double>(y[0]) * x[2]);
    w = static_cast<float>(static_cast<double>(x[1]) * y[0] - static_cast<double>(y[1]) * x[0]);
  }
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const float determinant = u + v + w;
  if (determinant == 0) return false;
  const float t = (u * z[0] + v * z[1] + w * z[2]) * sz;
  return determinant > 0 ? t > 0 : t < 0;
}
