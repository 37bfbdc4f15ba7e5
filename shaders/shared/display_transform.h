// From scene-linear radiance to what the display shows: exposure, one fixed tone curve, sRGB encoding. C++ and GLSL.
// Tone curve: Khronos PBR Neutral (Khronos ToneMapping specification, 2024): 1:1 below 0.8 minus a small toe, hue kept.
#ifndef PROBEWALK_SHADERS_SHARED_DISPLAY_TRANSFORM_H
#define PROBEWALK_SHADERS_SHARED_DISPLAY_TRANSFORM_H

#include "dialect.h"

#ifdef __cplusplus
#include <algorithm>
#include <cmath>
#endif

PW_SHARED_BEGIN

#ifdef __cplusplus
inline float pw_min(float a, float b) { return std::min(a, b); }
inline float pw_max(float a, float b) { return std::max(a, b); }
inline float pw_pow(float a, float b) { return std::pow(a, b); }
inline float pw_sqrt(float a) { return std::sqrt(a); }
#else
#define pw_min min
#define pw_max max
#define pw_pow pow
#define pw_sqrt sqrt
#endif

PW_CONSTANT float kToneStart = 0.76f;         // 0.8 - F90: where compression starts
PW_CONSTANT float kToneDesaturation = 0.15f;  // how fast highlights lose colour

PW_FUNCTION pw_vec3 tone_curve(pw_vec3 color) {
  float low = pw_min(color.x, pw_min(color.y, color.z));
  float offset = low < 0.08f ? low - 6.25f * low * low : 0.04f;
  color = color - pw_vec3(offset);
  float peak = pw_max(color.x, pw_max(color.y, color.z));
  if (peak < kToneStart) return color;
  float span = 1.0f - kToneStart;
  float new_peak = 1.0f - span * span / (peak + span - kToneStart);
  color = color * (new_peak / peak);
  float keep = 1.0f / (kToneDesaturation * (peak - new_peak) + 1.0f);
  return color * keep + pw_vec3(new_peak * (1.0f - keep));
}

// The color that tone_curve shows as `shown`; of several the darkest, and the most similar where none is.
PW_FUNCTION pw_vec3 tone_curve_inverse(pw_vec3 shown) {
  float new_peak = pw_min(pw_max(shown.x, pw_max(shown.y, shown.z)), 0.999999f);
  pw_vec3 color = shown;
  if (new_peak >= kToneStart) {
    float span = 1.0f - kToneStart;
    float peak = span * span / (1.0f - new_peak) - span + kToneStart;
    float keep = 1.0f / (kToneDesaturation * (peak - new_peak) + 1.0f);
    color = (shown - pw_vec3(new_peak * (1.0f - keep))) * (peak / (new_peak * keep));
  }
  color = pw_vec3(pw_max(color.x, 0.0f), pw_max(color.y, 0.0f), pw_max(color.z, 0.0f));
  float low = pw_min(color.x, pw_min(color.y, color.z));
  float offset = low < 0.04f ? 0.4f * pw_sqrt(low) - low : 0.04f;
  return color + pw_vec3(offset);
}

PW_FUNCTION float srgb_encode(float linear) {
  linear = pw_min(pw_max(linear, 0.0f), 1.0f);
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * pw_pow(linear, 1.0f / 2.4f) - 0.055f;
}

PW_FUNCTION float srgb_decode(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : pw_pow((encoded + 0.055f) / 1.055f, 2.4f);
}

// Factor on cd/m^2 for an exposure value at ISO 100 (ISO 12232 saturation-based): 1 / (1.2 * 2^ev).
PW_FUNCTION float exposure_from_ev(float ev) { return 1.0f / (1.2f * pw_pow(2.0f, ev)); }

PW_SHARED_END

#endif
