// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <opencv2/core/types.hpp>
#include <span>
#include <utility>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/live/opencv.h"
#include "slamdb/model/features.h"

// The columns of Features with the faces that ORB-SLAM3's members have. They copy nothing, are read only, and hold as
// long as the features that they look at.
namespace slamdb::live {

// What an arrow gives that points to a value made on the spot.
template <class Value>
class Arrow {
 public:
  explicit Arrow(Value value) : value_(std::move(value)) {}
  const Value* operator->() const { return &value_; }

 private:
  Value value_;
};

// Goes through a view that has operator[].
template <class View>
class RowIterator {
 public:
  using value_type = typename View::value_type;
  using reference = value_type;
  using pointer = Arrow<value_type>;
  using difference_type = std::ptrdiff_t;
  using iterator_category = std::input_iterator_tag;
  using iterator_concept = std::random_access_iterator_tag;

  RowIterator() = default;
  RowIterator(const View* view, std::size_t row) : view_(view), row_(row) {}

  value_type operator*() const { return (*view_)[row_]; }
  pointer operator->() const { return pointer(**this); }
  value_type operator[](difference_type n) const { return *(*this + n); }
  RowIterator& operator++() { return *this += 1; }
  RowIterator& operator--() { return *this -= 1; }
  RowIterator operator++(int) { return std::exchange(*this, *this + 1); }
  RowIterator operator--(int) { return std::exchange(*this, *this - 1); }
  RowIterator& operator+=(difference_type n) {
    row_ = static_cast<std::size_t>(static_cast<difference_type>(row_) + n);
    return *this;
  }
  RowIterator& operator-=(difference_type n) { return *this += -n; }
  friend RowIterator operator+(RowIterator i, difference_type n) { return i += n; }
  friend RowIterator operator+(difference_type n, RowIterator i) { return i += n; }
  friend RowIterator operator-(RowIterator i, difference_type n) { return i -= n; }
  friend difference_type operator-(const RowIterator& a, const RowIterator& b) {
    return static_cast<difference_type>(a.row_) - static_cast<difference_type>(b.row_);
  }
  friend auto operator<=>(const RowIterator& a, const RowIterator& b) { return a.row_ <=> b.row_; }
  friend bool operator==(const RowIterator& a, const RowIterator& b) { return a.row_ == b.row_; }

 private:
  const View* view_ = nullptr;
  std::size_t row_ = 0;
};

// A column of keypoints in place of `const std::vector<cv::KeyPoint>`, to which it converts.
class KeyPointView {
 public:
  using value_type = cv::KeyPoint;
  using const_iterator = RowIterator<KeyPointView>;

  explicit KeyPointView(const Column<Keypoint>& column) : column_(column) {}

  std::size_t size() const { return column_.size(); }
  bool empty() const { return column_.empty(); }
  cv::KeyPoint operator[](std::size_t row) const { return ToOpenCv(column_[row]); }
  cv::KeyPoint at(std::size_t row) const { return ToOpenCv(column_.at(row)); }  // throws std::out_of_range
  const_iterator begin() const { return {this, 0}; }
  const_iterator end() const { return {this, size()}; }
  operator std::vector<cv::KeyPoint>() const { return ToOpenCv(column_); }  // NOLINT(google-explicit-constructor)

 private:
  const Column<Keypoint>& column_;
};

// A bag of words in place of DBoW2::BowVector: pairs of word and weight by rising word. Converts to any class that is a
// std::map of them, as DBoW2's is.
class SLAMDB_EXPORT BowView {
 public:
  using value_type = std::pair<std::uint32_t, double>;
  using const_iterator = RowIterator<BowView>;

  explicit BowView(const BagOfWords& bag) : bag_(bag) {}

  std::size_t size() const { return bag_.words.size(); }
  bool empty() const { return bag_.words.empty(); }
  value_type operator[](std::size_t row) const { return {bag_.words[row], bag_.weights[row]}; }
  const_iterator begin() const { return {this, 0}; }
  const_iterator end() const { return {this, size()}; }
  // The first word that is not less; end(): there is none. O(log words).
  const_iterator lower_bound(std::uint32_t word) const;

  template <class Bow>
  requires std::derived_from<Bow, std::map<std::uint32_t, double>>
  operator Bow() const {  // NOLINT(google-explicit-constructor)
    Bow bow;
    for (const value_type& entry : *this) bow.emplace_hint(bow.end(), entry);
    return bow;
  }

 private:
  const BagOfWords& bag_;
};

// Keypoint rows at one node, in place of `std::vector<unsigned int>`, to which they convert.
struct FeatureRows : std::span<const std::uint32_t> {
  using std::span<const std::uint32_t>::span;
  operator std::vector<std::uint32_t>() const { return {begin(), end()}; }  // NOLINT(google-explicit-constructor)
};

// A feature vector in place of DBoW2::FeatureVector: pairs of node and keypoint rows by rising node. Converts to any
// class that is a std::map of them, as DBoW2's is.
class SLAMDB_EXPORT FeatureVectorView {
 public:
  class const_iterator {
   public:
    using value_type = std::pair<std::uint32_t, FeatureRows>;
    using reference = value_type;
    using pointer = Arrow<value_type>;
    using difference_type = std::ptrdiff_t;
    using iterator_category = std::input_iterator_tag;
    using iterator_concept = std::forward_iterator_tag;

    const_iterator() = default;
    const_iterator(const FeatureVector* features, std::size_t row) : features_(features), row_(row) {}

    value_type operator*() const {
      return {features_->nodes[row_], FeatureRows(features_->features.data() + first_, features_->sizes[row_])};
    }
    pointer operator->() const { return pointer(**this); }
    const_iterator& operator++() {
      first_ += features_->sizes[row_++];
      return *this;
    }
    const_iterator operator++(int) {
      const const_iterator before = *this;
      ++*this;
      return before;
    }
    friend bool operator==(const const_iterator& a, const const_iterator& b) { return a.row_ == b.row_; }

   private:
    const FeatureVector* features_ = nullptr;
    std::size_t row_ = 0, first_ = 0;
  };

  using value_type = const_iterator::value_type;

  explicit FeatureVectorView(const FeatureVector& features) : features_(features) {}

  std::size_t size() const { return features_.nodes.size(); }
  bool empty() const { return features_.nodes.empty(); }
  const_iterator begin() const { return {&features_, 0}; }
  const_iterator end() const { return {&features_, size()}; }
  // The first node that is not less; end(): there is none. O(nodes), which are few.
  const_iterator lower_bound(std::uint32_t node) const;

  template <class Map>
  requires std::derived_from<Map, std::map<std::uint32_t, std::vector<std::uint32_t>>>
  operator Map() const {  // NOLINT(google-explicit-constructor)
    Map map;
    for (const auto& [node, rows] : *this) map.emplace_hint(map.end(), node, rows);
    return map;
  }

 private:
  const FeatureVector& features_;
};

inline BowView::const_iterator BowView::lower_bound(std::uint32_t word) const {
  const auto found = std::lower_bound(bag_.words.begin(), bag_.words.end(), word);
  return {this, static_cast<std::size_t>(found - bag_.words.begin())};
}

inline FeatureVectorView::const_iterator FeatureVectorView::lower_bound(std::uint32_t node) const {
  const_iterator place = begin();
  while (place != end() && place->first < node) ++place;
  return place;
}

}  // namespace slamdb::live
