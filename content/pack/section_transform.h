// The transforms of pack_format.h that make sections compress well: prediction and byte planes, and their inverses.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

namespace probewalk {

template <class Word>
constexpr Word zigzag_encode(Word residual) {
  constexpr int top = std::numeric_limits<Word>::digits - 1;
  const Word sign = static_cast<Word>(-static_cast<int>(residual >> top));
  return static_cast<Word>(static_cast<Word>(residual << 1) ^ sign);
}

template <class Word>
constexpr Word zigzag_decode(Word code) {
  return static_cast<Word>((code >> 1) ^ static_cast<Word>(-static_cast<int>(code & 1)));
}

// Prediction of word (i, j) of a grid of `side` columns from its neighbours to the left and above.
template <class Word>
constexpr Word predict(const Word* words, std::size_t side, std::size_t i, std::size_t j) {
  const Word* here = words + j * side + i;
  if (i == 0) return j == 0 ? Word{0} : *(here - side);
  if (j == 0) return *(here - 1);
  return static_cast<Word>(*(here - 1) + *(here - side) - *(here - side - 1));
}

// Zig-zag codes of the residuals; words.size() is a multiple of side.
template <class Word>
std::vector<Word> residuals_of(std::span<const Word> words, std::size_t side) {
  std::vector<Word> residuals(words.size());
  for (std::size_t j = 0; j < words.size() / side; ++j) {
    for (std::size_t i = 0; i < side; ++i) {
      const std::size_t at = j * side + i;
      residuals[at] = zigzag_encode(static_cast<Word>(words[at] - predict(words.data(), side, i, j)));
    }
  }
  return residuals;
}

// Inverse of residuals_of, in place.
template <class Word>
void restore_from_residuals(std::span<Word> words, std::size_t side) {
  for (std::size_t j = 0; j < words.size() / side; ++j) {
    for (std::size_t i = 0; i < side; ++i) {
      const std::size_t at = j * side + i;
      words[at] = static_cast<Word>(zigzag_decode(words[at]) + predict(words.data(), side, i, j));
    }
  }
}

// Writes the words' byte planes, most significant first; planes.size() == words.size() * sizeof(Word).
template <class Word>
void split_byte_planes(std::span<const Word> words, std::span<std::byte> planes) {
  for (std::size_t plane = 0; plane < sizeof(Word); ++plane) {
    const auto shift = static_cast<int>(8 * (sizeof(Word) - 1 - plane));
    std::byte* out = planes.data() + plane * words.size();
    for (std::size_t k = 0; k < words.size(); ++k) out[k] = static_cast<std::byte>((words[k] >> shift) & 0xff);
  }
}

template <class Word>
void join_byte_planes(std::span<const std::byte> planes, std::span<Word> words) {
  std::fill(words.begin(), words.end(), Word{0});
  for (std::size_t plane = 0; plane < sizeof(Word); ++plane) {
    const auto shift = static_cast<int>(8 * (sizeof(Word) - 1 - plane));
    const std::byte* in = planes.data() + plane * words.size();
    for (std::size_t k = 0; k < words.size(); ++k) {
      words[k] = static_cast<Word>(words[k] | static_cast<Word>(static_cast<Word>(in[k]) << shift));
    }
  }
}

}  // namespace probewalk
