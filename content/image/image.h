// Pictures in memory and on disk, and how far two of them are apart.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace probewalk {

struct ImageRgb8 {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> rgb;  // 3 * width * height, sRGB-encoded, top row first
};

struct ImageRgbF {
  int width_px = 0, height_px = 0;
  std::vector<glm::vec3> rgb;  // scene-linear, top row first
};

// A named float channel for EXR ("R", "distance", "probe", ...).
struct ExrChannel {
  std::string name;
  std::vector<float> values;  // width * height, top row first
};

// All write a temporary file and rename it. Throw BadInput naming the file and the reason.
void write_png(const std::filesystem::path& file, const ImageRgb8& image);
void write_exr(const std::filesystem::path& file, int width_px, int height_px, const std::vector<ExrChannel>& channels);
ImageRgb8 read_png(const std::filesystem::path& file);
void write_file_atomically(const std::filesystem::path& file, const std::string& bytes);

// Exposure, tone curve, sRGB encoding: the same as the device's resolve, without dither.
ImageRgb8 display_transform(const ImageRgbF& image, float exposure_ev);

// Mean FLIP (Andersson et al. 2020, LDR) in [0, 1]; `map` receives the error per pixel when given.
float flip_mean(const ImageRgb8& reference, const ImageRgb8& test, float pixels_per_degree,
                std::vector<float>* map = nullptr);
// Peak signal-to-noise ratio over 8-bit RGB; infinity for equal pictures.
double psnr_db(const ImageRgb8& a, const ImageRgb8& b);
// A scalar map as a picture, blue (0) to yellow (maximum); values that are not finite are magenta.
ImageRgb8 false_colour(const std::vector<float>& values, int width_px, int height_px, float maximum);
// Several pictures of equal height side by side.
ImageRgb8 side_by_side(const std::vector<ImageRgb8>& images);

}  // namespace probewalk
