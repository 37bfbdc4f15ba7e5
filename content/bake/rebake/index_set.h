// A set of small numbers, as bits.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace probewalk {

class IndexSet {
 public:
  IndexSet() = default;
  explicit IndexSet(std::size_t count) : words_((count + 63) / 64, 0) {}
  explicit IndexSet(std::vector<std::uint64_t> words) : words_(std::move(words)) {}

  // Thread-safe. index is below the count that the set was made for.
  void insert(std::size_t index) {
    std::atomic_ref<std::uint64_t> word(words_[index / 64]);
    const std::uint64_t bit = std::uint64_t(1) << index % 64;
    if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
  }
  bool contains(std::size_t index) const {
    return index / 64 < words_.size() && (words_[index / 64] >> index % 64 & 1) != 0;
  }
  // Takes what the other has, too; an empty set takes its size.
  void join(const IndexSet& other) {
    if (words_.size() < other.words_.size()) words_.resize(other.words_.size(), 0);
    for (std::size_t k = 0; k < other.words_.size(); ++k) words_[k] |= other.words_[k];
  }
  bool meets(const IndexSet& other) const {
    for (std::size_t k = 0; k < words_.size() && k < other.words_.size(); ++k) {
      if ((words_[k] & other.words_[k]) != 0) return true;
    }
    return false;
  }
  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t k = 0; k < words_.size(); ++k) {
      for (std::uint64_t rest = words_[k]; rest != 0; rest &= rest - 1)
        visit(64 * k + std::size_t(std::countr_zero(rest)));
    }
  }
  const std::vector<std::uint64_t>& words() const { return words_; }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace probewalk
